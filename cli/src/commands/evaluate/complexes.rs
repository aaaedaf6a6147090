//! Complex files against a known complex: models of any program.

use std::path::PathBuf;

use crate::tables::complexes::{EvaluatedComplex, objects, write_complexes};
use crate::tables::report::text_table;
use knotdock::evaluate::ChainChoice;
use knotdock::output::files::whole_file::write_whole;
use knotdock_scoring::se3::Pose;
use serde_json::json;

use super::Evaluate;
use crate::arguments::output_file::check_output;
use crate::inputs::complex_sides::{ComplexSides, files_and_chains, for_each_model};
use crate::inputs::native::{NativeFiles, others_text};
use crate::messages::console::Console;
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
        let Some(native) = self.native.read()? else {
            return Err(Error::input("no known complex is given").help(
                "name it with --native FILE, or with --native-receptor FILE and --native-ligand FILE",
            ));
        };
        if let Some(path) = &self.output {
            let complexes: Vec<PathBuf> = files.iter().map(PathBuf::from).collect();
            let natives = native.inputs().map(|input| input.record.path.as_path());
            let read = complexes.iter().map(PathBuf::as_path).chain(natives);
            check_output(path, read, self.force, console)?;
        }
        native.warn(console);
        let choice = self.chain_choice(chains.is_some());
        let files = (files, chains.as_ref());
        let reading = self.input.options.input.reading();
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
    let [receptor, ligand] = &sides.molecules;
    let evaluator = native.evaluator_by(receptor, ligand, choice)?;
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

/// Many complexes as a table.
fn listing(rows: &[EvaluatedComplex]) -> String {
    let lines = rows.iter().map(|row| {
        let quality = &row.quality;
        vec![
            row.file.clone(),
            row.model.to_string(),
            row.chains.join(" "),
            row.native_chains.clone(),
            format!("{:.2}", quality.irmsd),
            format!("{:.2}", quality.lrmsd),
            format!("{:.3}", quality.fnat),
            format!("{:.3}", quality.dockq),
            quality.capri.name().to_owned(),
            format!("{:.0}%", 100.0 * row.matched),
        ]
    });
    let header = "file|model|chains|native|irmsd|lrmsd|fnat|dockq|capri|matched";
    text_table(header, lines)
}
