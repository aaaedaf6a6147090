//! The known complex that poses are measured against: its options, its files, and its match with what was docked.

use std::path::Path;

use crate::tables::report::counted;
use clap::{Args, ValueHint};
use knotdock::evaluate::{
    ChainChoice, Evaluator, MatchReport, Native, NativeComplex, PoseQuality, SideMatch,
};
use knotdock::output::records::input_record::NativeRecord;
use knotdock::output::tables::poses::PoseRow;
use knotdock_structures::molecule::{Molecule, ReadOptions};
use rayon::prelude::*;

use crate::inputs::molecules::Input;
use crate::messages::console::Console;
use knotdock_structures::Error;

/// Options that name the known complex.
#[derive(Args, Clone, Debug)]
pub struct NativeArguments {
    /// Known complex, against which poses are measured.
    ///
    /// One file has both partners. Of several copies each pose is measured by the one with its best DockQ; FILE:A,B picks
    /// chains.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = HEADING)]
    #[arg(conflicts_with_all = ["native_receptor", "native_ligand"])]
    native: Option<String>,
    /// Receptor of the known complex, in a file of its own.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, requires = "native_ligand", help_heading = HEADING)]
    native_receptor: Option<String>,
    /// Ligand of the known complex, in the frame of its receptor.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, requires = "native_receptor", help_heading = HEADING)]
    native_ligand: Option<String>,
}

const HEADING: &str = "Known complex";

/// The files of the known complex.
#[derive(Clone)]
pub enum NativeFiles {
    /// One file with both partners.
    Complex(Box<Input>),
    /// A file for each.
    Partners {
        /// The receptor's.
        receptor: Box<Input>,
        /// The ligand's.
        ligand: Box<Input>,
    },
}

impl NativeArguments {
    /// Reads the files that are named, if any.
    pub fn read(&self) -> Result<Option<NativeFiles>, Error> {
        let by_default = ReadOptions::default();
        match (&self.native, &self.native_receptor, &self.native_ligand) {
            (Some(complex), _, _) => Ok(Some(NativeFiles::Complex(Box::new(Input::read(
                complex,
                &by_default,
            )?)))),
            (None, Some(receptor), Some(ligand)) => Ok(Some(NativeFiles::Partners {
                receptor: Box::new(Input::read(receptor, &by_default)?),
                ligand: Box::new(Input::read(ligand, &by_default)?),
            })),
            _ => Ok(None),
        }
    }
}

impl NativeFiles {
    /// Reads the files that a run recorded.
    pub fn recorded(record: &NativeRecord, run: &Path) -> Result<Self, Error> {
        let by_default = ReadOptions::default();
        Ok(match record {
            NativeRecord::Complex(complex) => {
                Self::Complex(Box::new(Input::recorded(complex, run, &by_default)?))
            }
            NativeRecord::Partners { receptor, ligand } => Self::Partners {
                receptor: Box::new(Input::recorded(receptor, run, &by_default)?),
                ligand: Box::new(Input::recorded(ligand, run, &by_default)?),
            },
        })
    }

    /// The files as read.
    pub fn inputs(&self) -> impl Iterator<Item = &Input> {
        let (first, second) = match self {
            Self::Complex(complex) => (complex, None),
            Self::Partners { receptor, ligand } => (receptor, Some(ligand)),
        };
        [Some(first), second]
            .into_iter()
            .flatten()
            .map(AsRef::as_ref)
    }

    /// The files for run.json.
    pub fn record(&self) -> NativeRecord {
        match self {
            Self::Complex(complex) => NativeRecord::Complex(complex.record.clone()),
            Self::Partners { receptor, ligand } => NativeRecord::Partners {
                receptor: receptor.record.clone(),
                ligand: ligand.record.clone(),
            },
        }
    }

    /// Matches the complex with the molecules docked.
    pub fn evaluator(&self, receptor: &Molecule, ligand: &Molecule) -> Result<Evaluator, Error> {
        self.evaluator_by(receptor, ligand, &ChainChoice::default())
    }

    /// Matches the complex with the molecules docked, by chains that the user chooses.
    pub fn evaluator_by(
        &self,
        receptor: &Molecule,
        ligand: &Molecule,
        choice: &ChainChoice,
    ) -> Result<Evaluator, Error> {
        let choice = ChainChoice {
            named: choice.named || self.inputs().any(|input| input.record.chains.is_some()),
            ..choice.clone()
        };
        let (native, file) = match self {
            Self::Complex(complex) => (Native::Complex(&complex.molecule), complex.as_ref()),
            Self::Partners {
                receptor: native_receptor,
                ligand: native_ligand,
            } => (
                Native::Pair {
                    receptor: &native_receptor.molecule,
                    ligand: &native_ligand.molecule,
                },
                native_receptor.as_ref(),
            ),
        };
        Evaluator::with_chains(receptor, ligand, native, &choice).map_err(|error| {
            let with_notes = self.notes().fold(error, |error, note| error.and(note));
            with_notes.at(&file.record.path)
        })
    }

    /// What reading the files left out or warned of.
    fn notes(&self) -> impl Iterator<Item = String> {
        self.inputs()
            .flat_map(|input| reading_notes(&input.molecule))
    }

    /// Warns of what reading the files left out.
    pub fn warn(&self, console: Console) {
        for note in self.notes() {
            console.warn(note);
        }
    }
}

/// What reading a file left out or warned of: an error that follows may come of it.
fn reading_notes(molecule: &Molecule) -> Vec<String> {
    let report = &molecule.report;
    let last = report.altered.models_ignored + 1;
    let models = match last {
        1 => None,
        2 => Some("MODEL 2 of the native's file was not read".to_owned()),
        last => Some(format!(
            "MODEL 2 to {last} of the native's file were not read"
        )),
    };
    let remedy = " (put both partners into one model, or name a file for each)";
    let models = models.map(|models| models + remedy);
    let warnings = report.warnings.iter();
    models
        .into_iter()
        .chain(warnings.map(|warning| format!("reading the native's file: {warning}")))
        .collect()
}

/// Every pose's quality, with the report of how it is matched.
pub fn measure<'a>(
    evaluator: &'a Evaluator,
    rows: &[PoseRow],
) -> Vec<(PoseQuality, &'a MatchReport)> {
    rows.par_iter()
        .map(|row| evaluator.best(&row.pose))
        .collect()
}

/// Says what was matched, and warns where little was.
pub fn announce(evaluator: &Evaluator, console: Console) {
    let report = evaluator.report();
    console.say(match console.verbose {
        true => match_text(report),
        false => brief_match_text(report),
    });
    for warning in &evaluator.report().warnings {
        console.warn(warning);
    }
}

/// What was matched, in a line.
fn brief_match_text(report: &MatchReport) -> String {
    let share = 100.0 * report.interface_share;
    let mut text = format!("Known complex: {share:.0}% of its interface is in what is docked");
    if let Some(others) = others_text(report) {
        text += &format!("; {others}");
    }
    if !report.unused_native_chains.is_empty() {
        let chains = report.unused_native_chains.join(", ");
        text += &format!("; not compared: chains {chains} (--native FILE:A,B picks others)");
    }
    text
}

/// What was matched, in a line for each side.
fn match_text(report: &MatchReport) -> String {
    let mut text = format!(
        "Matched with the native ({:.0}% of its interface):\n{}\n{}",
        100.0 * report.interface_share,
        side_text("receptor", &report.receptor),
        side_text("ligand", &report.ligand)
    );
    if let Some(others) = others_text(report) {
        text += &format!("\n  {others}");
    }
    if !report.unused_native_chains.is_empty() {
        text += &format!(
            "\n  left aside of the native: {}; if another copy is meant, name its chains, as in --native FILE:A,B",
            report.unused_native_chains.join(", ")
        );
    }
    text
}

/// Complexes that are shown.
const COMPLEXES_SHOWN: usize = 4;

/// The complexes of a native that holds several, and how one is chosen.
pub fn others_text(report: &MatchReport) -> Option<String> {
    let complexes = &report.complexes;
    if complexes.len() < 2 {
        return None;
    }
    let shown = complexes.iter().take(COMPLEXES_SHOWN).map(complex_text);
    let shown = shown.collect::<Vec<_>>().join(", ");
    let more = if complexes.len() > COMPLEXES_SHOWN {
        ", ..."
    } else {
        ""
    };
    let by = match report.permutations {
        1 => format!("measured by {}", complex_text(&complexes[0])),
        _ => "each pose is measured by the one with its best DockQ".to_owned(),
    };
    Some(format!(
        "the native holds {} complexes of these chains ({shown}{more}); {by}",
        complexes.len()
    ))
}

fn complex_text(complex: &NativeComplex) -> String {
    format!(
        "{} with {} ({})",
        complex.receptor.join("+"),
        complex.ligand.join("+"),
        counted(complex.contacts, "contact")
    )
}

fn side_text(name: &str, side: &SideMatch) -> String {
    let mut chains: Vec<&str> = Vec::new();
    for chain in &side.chains {
        if !chains.contains(&chain.native_chain.as_str()) {
            chains.push(&chain.native_chain);
        }
    }
    let mut text = format!(
        "  {name}, as the native's {}: {} of {} residues ({:.0}% of the {} docked), {} of {} at the interface; the docked \
         backbone lies {:.2} Å RMSD from it",
        chains.join(", "),
        side.matched,
        side.native_residues,
        100.0 * side.docked_share,
        side.residues,
        side.interface_matched,
        side.interface_residues,
        side.backbone_rmsd
    );
    for (whose, chains) in [
        ("docked", &side.unmatched_chains),
        ("native", &side.unmatched_native_chains),
    ] {
        if !chains.is_empty() {
            text += &format!("; {whose} chains without a match: {}", chains.join(", "));
        }
    }
    text
}
