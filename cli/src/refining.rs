//! Poses of a run refined, measured and written, many at once.

use std::io;
use std::path::Path;

use cpu_time::ProcessTime;
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use crate::inputs::native::NativeFiles;
use crate::messages::console::Console;
use crate::tables::report::text_table;
use crate::tables::{self, Column, object};
use knotdock::evaluate::{Evaluator, PoseQuality};
use knotdock::output::files::complexes::{PosedPair, write_complexes};
use knotdock::output::tables::poses::PoseRow;
use knotdock::pose_space::arrangement::Arrangement;
use knotdock::progress::Progress;
use knotdock::refine::{RefineOptions, Refined, Refiner};
use knotdock_scoring::sharp::PairList;
use knotdock_structures::Error;
use knotdock_structures::molecule::{ChainMap, Molecule};

/// A known complex, matched with the molecules as docked.
pub struct MatchedNative {
    files: NativeFiles,
    /// Of the molecules as docked.
    pub evaluator: Evaluator,
}

impl MatchedNative {
    /// Matches the complex with receptor and ligand; warns if it does not match.
    pub fn new(files: NativeFiles, pair: [&Molecule; 2], console: Console) -> Option<Self> {
        match files.matched(pair, console) {
            Ok(evaluator) => Some(Self { files, evaluator }),
            Err(failure) => {
                console.warn(format!("no pose is measured: {}", failure.in_one_line()));
                None
            }
        }
    }

    fn qualities(
        &self,
        pair: [&Molecule; 2],
        row: &PoseRow,
        refined: &Refined,
    ) -> Result<[PoseQuality; 2], Error> {
        let after = self.files.quality(pair, refined)?;
        Ok([self.evaluator.evaluate(&row.pose), after])
    }
}

pub struct Refining<'a> {
    refiner: Refiner<'a>,
    pair: [&'a Molecule; 2],
    known: Option<&'a MatchedNative>,
    /// Folder that complexes are written into.
    staged: &'a Path,
}

pub struct Written {
    /// Rows of the table.
    pub table: Vec<RefinedRow>,
    /// Chain names in complexes; the same in all.
    pub chains: Option<ChainMap>,
    /// Mean processor time of a pose; `None` where the system does not report it.
    pub cpu_seconds_per_pose: Option<f64>,
}

impl<'a> Refining<'a> {
    /// Prepares receptor and ligand.
    pub fn new(
        pair: [&'a Molecule; 2],
        options: RefineOptions,
        known: Option<&'a MatchedNative>,
        staged: &'a Path,
    ) -> Result<Self, Error> {
        Ok(Self {
            refiner: Refiner::new(pair, options)?,
            pair,
            known,
            staged,
        })
    }

    /// Refines and writes the poses of some rows, in their order.
    pub fn all(&self, rows: &[PoseRow], console: Console) -> Result<Written, Error> {
        let cpu = ProcessTime::try_now().ok();
        let progress = console.progress();
        progress.stage("refining", rows.len() as u64);
        let one = |list: &mut PairList, row: &PoseRow| {
            let written = self.one(row, list);
            progress.advance(1);
            written
        };
        let written = rows.par_iter().map_init(PairList::default, one);
        let written: Vec<_> = written.collect::<Result<_, Error>>()?;
        let cpu = cpu.and_then(|cpu| cpu.try_elapsed().ok());
        let mut all = Written {
            cpu_seconds_per_pose: cpu.map(|cpu| cpu.as_secs_f64() / rows.len().max(1) as f64),
            table: Vec::new(),
            chains: None,
        };
        for (row, chains) in written {
            all.table.push(row);
            all.chains = chains;
        }
        Ok(all)
    }

    /// Refines and writes a pose; its row and the complex's chains.
    fn one(
        &self,
        row: &PoseRow,
        list: &mut PairList,
    ) -> Result<(RefinedRow, Option<ChainMap>), Error> {
        let refined = self.refiner.refine(&row.pose, list)?;
        let quality = self
            .known
            .map(|known| known.qualities(self.pair, row, &refined));
        let quality = quality.transpose()?;
        let kind = (self.pair, Arrangement::Pair);
        let complex = (std::slice::from_ref(row), std::slice::from_ref(&refined));
        let mut written =
            write_complexes(kind, &PosedPair::of(kind, complex), (self.staged, None))?;
        let row = RefinedRow {
            rank: row.rank,
            refined,
            quality,
            file: written.names.pop().unwrap_or_default(),
        };
        Ok((row, written.chains))
    }
}

impl Written {
    /// The poses as a table for the terminal.
    pub fn listing(&self) -> String {
        let has_native = self.table.iter().any(|row| row.quality.is_some());
        let of_native = if has_native { "|irmsd|dockq" } else { "" };
        let lines = self.table.iter().map(|row| {
            let Refined { before, after, .. } = &row.refined;
            let packing = row.refined.packing.as_ref();
            let mut line = vec![
                row.rank.to_string(),
                format!("{:.2}", row.refined.rmsd_moved),
                format!("{:.1} -> {:.1}", before.total(), after.total()),
                format!("{} -> {}", before.clashes, after.clashes),
                packing.map_or(String::new(), |packing| packing.moved.to_string()),
            ];
            if let Some([before, after]) = &row.quality {
                line.push(format!("{:.2} -> {:.2}", before.irmsd, after.irmsd));
                line.push(format!("{:.3} -> {:.3}", before.dockq, after.dockq));
            }
            line
        });
        let header = format!("rank|moved|energy|clashes|side chains{of_native}");
        text_table(&header, lines)
    }
}

/// A refined pose, with its qualities before and after where there is a known complex.
pub struct RefinedRow {
    pub rank: usize,
    pub refined: Refined,
    pub quality: Option<[PoseQuality; 2]>,
    /// Name of the complex's file.
    pub file: String,
}

const COLUMNS: [Column<RefinedRow>; 15] = [
    ("rank", |row| json!(row.rank)),
    ("qw", |row| quaternion(row, 0)),
    ("qx", |row| quaternion(row, 1)),
    ("qy", |row| quaternion(row, 2)),
    ("qz", |row| quaternion(row, 3)),
    ("tx", |row| json!(row.refined.pose.translation.x)),
    ("ty", |row| json!(row.refined.pose.translation.y)),
    ("tz", |row| json!(row.refined.pose.translation.z)),
    ("rmsd_moved", |row| json!(row.refined.rmsd_moved)),
    ("energy_before", |row| json!(row.refined.before.total())),
    ("energy_after", |row| json!(row.refined.after.total())),
    ("clashes_before", |row| json!(row.refined.before.clashes)),
    ("clashes_after", |row| json!(row.refined.after.clashes)),
    ("side_chains_moved", |row| {
        json!(row.refined.packing.map(|packing| packing.moved))
    }),
    ("exact", |row| {
        json!(row.refined.packing.map(|packing| packing.exact))
    }),
];

/// The columns that a known complex adds.
const OF_NATIVE: [Column<RefinedRow>; 10] = [
    ("irmsd_before", |row| of(row, 0, |q| json!(q.irmsd))),
    ("irmsd_after", |row| of(row, 1, |q| json!(q.irmsd))),
    ("lrmsd_before", |row| of(row, 0, |q| json!(q.lrmsd))),
    ("lrmsd_after", |row| of(row, 1, |q| json!(q.lrmsd))),
    ("fnat_before", |row| of(row, 0, |q| json!(q.fnat))),
    ("fnat_after", |row| of(row, 1, |q| json!(q.fnat))),
    ("dockq_before", |row| of(row, 0, |q| json!(q.dockq))),
    ("dockq_after", |row| of(row, 1, |q| json!(q.dockq))),
    ("capri_before", |row| of(row, 0, |q| json!(q.capri.name()))),
    ("capri_after", |row| of(row, 1, |q| json!(q.capri.name()))),
];

fn quaternion(row: &RefinedRow, part: usize) -> Value {
    json!(row.refined.pose.quaternion()[part])
}

/// A value of a row's quality, before (0) or after (1).
fn of(row: &RefinedRow, time: usize, value: fn(&PoseQuality) -> Value) -> Value {
    let quality = row.quality.as_ref();
    quality.map_or(Value::Null, |quality| value(&quality[time]))
}

fn columns(rows: &[RefinedRow]) -> Vec<Column<RefinedRow>> {
    let has_native = rows.iter().any(|row| row.quality.is_some());
    let of_native: &[_] = if has_native { &OF_NATIVE } else { &[] };
    [&COLUMNS, of_native].concat()
}

pub fn write_table(stream: &mut dyn io::Write, rows: &[RefinedRow]) -> io::Result<()> {
    tables::write_table(stream, &columns(rows), rows)
}

/// The rows as JSON objects with the names of the columns.
pub fn objects(rows: &[RefinedRow]) -> Vec<Map<String, Value>> {
    let columns = columns(rows);
    rows.iter().map(|row| object(&columns, row)).collect()
}
