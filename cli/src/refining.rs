//! Poses of a run refined, measured and written, many at once.

use std::path::Path;

use crate::tables::refined::RefinedRow;
use crate::tables::report::align;
use cpu_time::ProcessTime;
use knotdock::evaluate::{Evaluator, PoseQuality};
use knotdock::output::files::complexes::write_complexes;
use knotdock::output::tables::poses::PoseRow;
use knotdock::pose_space::arrangement::Arrangement;
use knotdock::progress::Progress;
use knotdock::refine::{RefineOptions, Refined, Refiner};
use knotdock_scoring::sharp::PairList;
use knotdock_structures::Error;
use knotdock_structures::molecule::{ChainMap, Molecule};
use rayon::prelude::*;

use crate::inputs::native::{NativeFiles, announce};
use crate::messages::console::Console;

/// A known complex, matched with the molecules as docked.
pub struct Known {
    files: NativeFiles,
    /// Of the molecules as docked.
    pub evaluator: Evaluator,
}

impl Known {
    /// Matches the complex with receptor and ligand; warns if it does not match.
    pub fn new(
        files: NativeFiles,
        [receptor, ligand]: [&Molecule; 2],
        console: Console,
    ) -> Option<Self> {
        match files.evaluator(receptor, ligand) {
            Ok(evaluator) => {
                files.warn(console);
                announce(&evaluator, console);
                Some(Self { files, evaluator })
            }
            Err(failure) => {
                console.warn(format!("no pose is measured: {}", failure.in_one_line()));
                None
            }
        }
    }

    /// Qualities of a pose and of what it was refined to.
    fn qualities(&self, row: &PoseRow, refined: &Refined) -> Result<[PoseQuality; 2], Error> {
        let after = match &refined.packed {
            None => self.evaluator.evaluate(&refined.pose),
            // Contacts are of all heavy atoms, so packed molecules are matched anew.
            Some([receptor, ligand]) => self
                .files
                .evaluator(receptor, ligand)?
                .evaluate(&refined.pose),
        };
        Ok([self.evaluator.evaluate(&row.pose), after])
    }
}

/// What poses are refined with.
pub struct Refining<'a> {
    refiner: Refiner<'a>,
    pair: [&'a Molecule; 2],
    known: Option<&'a Known>,
    /// Folder that complexes are written into.
    staged: &'a Path,
}

/// What was written of some poses.
pub struct Written {
    /// Rows of the table, without molecules.
    pub table: Vec<RefinedRow>,
    /// Names of the complexes, in the order of the rows.
    pub names: Vec<String>,
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
        known: Option<&'a Known>,
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
            names: Vec::new(),
            chains: None,
        };
        for (row, name, chains) in written {
            all.table.push(row);
            all.names.push(name);
            all.chains = chains;
        }
        Ok(all)
    }

    /// Refines and writes a pose; its row, and name and chains of the complex. The packed molecules are dropped: those
    /// of many poses may not fit into the memory.
    fn one(
        &self,
        row: &PoseRow,
        list: &mut PairList,
    ) -> Result<(RefinedRow, String, Option<ChainMap>), Error> {
        let refined = self.refiner.refine(&row.pose, list);
        let mut refined = refined?;
        let quality = self.known.map(|known| known.qualities(row, &refined));
        let quality = quality.transpose()?;
        let packed = refined.packed.take();
        let molecules = match &packed {
            Some([receptor, ligand]) => [receptor, ligand],
            None => self.pair,
        };
        let placed = [PoseRow {
            rank: row.rank,
            pose: refined.pose,
        }];
        let pair = Arrangement::Pair;
        let mut written =
            write_complexes(molecules, pair, &placed, ", refined", (self.staged, None))?;
        let row = RefinedRow {
            rank: row.rank,
            refined,
            quality,
        };
        let name = written.names.pop().unwrap_or_default();
        Ok((row, name, written.chains))
    }
}

impl Written {
    /// The poses as a table for the terminal.
    pub fn listing(&self) -> String {
        let has_native = self.table.iter().any(|row| row.quality.is_some());
        let mut header = vec!["rank", "moved", "energy", "clashes", "side chains"];
        if has_native {
            header.extend(["irmsd", "dockq"]);
        }
        let mut lines = vec![header.into_iter().map(str::to_owned).collect()];
        for row in &self.table {
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
            lines.push(line);
        }
        align(&lines)
    }
}
