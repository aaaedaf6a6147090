//! Complex files against a known complex: models of any program.

use std::io;
use std::path::Path;

use serde_json::{Value, json};

use super::{Evaluate, no_native, quality_fields};
use crate::arguments::output_file::check_outputs;
use crate::inputs::complex_sides::{ComplexSides, files_and_chains, for_each_model};
use crate::inputs::native::{NativeFiles, others_text};
use crate::messages::console::Console;
use crate::tables::report::text_table;
use crate::tables::{Column, object, write_table};
use knotdock::evaluate::{ChainChoice, Criterion, PoseQuality};
use knotdock::output::files::whole_file::write_whole;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;

impl Evaluate {
    /// Evaluates complex files; the exit code: 2 if some could not be evaluated.
    pub(super) fn complexes(&self, console: Console) -> Result<u8, Error> {
        let (files, chains) = files_and_chains(&self.words, "evaluate")?;
        if self.receptor.is_some() || self.ligand.is_some() {
            let error = "--receptor and --ligand name what poses move, and these are complexes";
            return Err(Error::input(error)
                .help("leave them out; chains of the sides go behind the files, such as H,L A"));
        }
        let native = self.native.read()?.ok_or_else(no_native)?;
        let natives = native.inputs().map(|input| input.record.path.as_path());
        let read: Vec<&Path> = files.iter().map(Path::new).chain(natives).collect();
        check_outputs(&self.output, &read, self.force, console)?;
        native.warn(console);
        let choice = self.chain_choice(chains.is_some());
        let files = (files, chains.as_ref());
        let reading = self.input.given()?.options.input.reading();
        let (found, code) = for_each_model(files, &reading, console, |file, sides| {
            evaluated(file, sides, &native, &choice)
        })?;
        let mut noted = Vec::new();
        let mut rows = Vec::new();
        for (row, notes) in found {
            for note in notes {
                if !noted.contains(&note) {
                    console.warn(&note);
                    noted.push(note);
                }
            }
            rows.push(row);
        }
        if let Some(path) = &self.output {
            write_whole(path, |file| write_complexes(&rows, file))?;
        }
        console.say(listing(&rows));
        console.result(&json!({ "complexes": objects(&rows) }))?;
        Ok(code)
    }
}

/// The quality of a model of a file, its sides in place, and notes on its match with the known complex.
fn evaluated(
    file: &str,
    sides: ComplexSides,
    native: &NativeFiles,
    choice: &ChainChoice,
) -> Result<(EvaluatedComplex, Vec<String>), Error> {
    let evaluator = native.evaluator(sides.molecules.each_ref(), choice)?;
    let (quality, report) = evaluator.best(&Pose::identity());
    let warnings = report.warnings.iter();
    let notes = warnings.map(|warning| format!("{file}: {warning}"));
    let others = others_text(report).map(|others| format!("{others}; --map chooses"));
    Ok((
        EvaluatedComplex {
            file: file.to_owned(),
            model: sides.model,
            chains: sides.chains,
            native_chains: report.native_chains.clone(),
            fits: [report.receptor.backbone_rmsd, report.ligand.backbone_rmsd],
            matched: report.interface_share,
            quality,
        },
        notes.chain(others).collect(),
    ))
}

fn listing(rows: &[EvaluatedComplex]) -> String {
    let lines = rows.iter().map(|row| {
        let mut line = vec![
            row.file.clone(),
            row.model.to_string(),
            row.chains.join(" "),
            row.native_chains.clone(),
        ];
        line.extend(quality_fields(&row.quality));
        line.push(format!("{:.0}%", 100.0 * row.matched));
        line
    });
    let header = "file|model|chains|native|irmsd|lrmsd|fnat|dockq|capri|matched";
    text_table(header, lines)
}

/// A complex, and how near it is to the known one.
#[derive(Clone, Debug)]
pub struct EvaluatedComplex {
    pub file: String,
    /// Its place among the models of the file, from 1.
    pub model: usize,
    pub chains: [String; 2],
    /// Its chains with those of the known complex, as `A:E,B:F`.
    pub native_chains: String,
    /// Backbone RMSD in Å of each side by itself with the known complex's.
    pub fits: [f64; 2],
    /// Share of the interface residues of the known complex that it has.
    pub matched: f64,
    pub quality: PoseQuality,
}

/// The columns, in order; those of [`JSON_ALONE`] are not in the file.
const COLUMNS: [Column<EvaluatedComplex>; 15] = [
    ("file", |row| json!(row.file)),
    ("model", |row| json!(row.model)),
    ("chains_1", |row| json!(row.chains[0])),
    ("chains_2", |row| json!(row.chains[1])),
    ("irmsd", |row| json!(row.quality.irmsd)),
    ("lrmsd", |row| json!(row.quality.lrmsd)),
    ("fnat", |row| json!(row.quality.fnat)),
    ("dockq", |row| json!(row.quality.dockq)),
    ("capri", |row| json!(row.quality.capri.name())),
    ("acceptable", |row| {
        json!(Criterion::Acceptable.is_met(&row.quality))
    }),
    ("near_native", |row| {
        json!(Criterion::NearNative.is_met(&row.quality))
    }),
    ("interface_share", |row| json!(row.matched)),
    ("native_chains", |row| json!(row.native_chains)),
    ("backbone_rmsd_1", |row| json!(row.fits[0])),
    ("backbone_rmsd_2", |row| json!(row.fits[1])),
];

const JSON_ALONE: [&str; 4] = [
    "acceptable",
    "near_native",
    "backbone_rmsd_1",
    "backbone_rmsd_2",
];

pub fn objects(rows: &[EvaluatedComplex]) -> Vec<Value> {
    let objects = rows.iter().map(|row| object(&COLUMNS, row).into());
    objects.collect()
}

pub fn write_complexes(rows: &[EvaluatedComplex], stream: &mut dyn io::Write) -> io::Result<()> {
    let columns = COLUMNS.iter();
    let columns = columns.filter(|(name, _)| !JSON_ALONE.contains(name));
    write_table(stream, columns, rows)
}
