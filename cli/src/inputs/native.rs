//! The known complex that poses are measured against: its options, its files, and its match with the docked molecules.

use std::path::Path;

use clap::{Args, ValueHint};
use rayon::prelude::*;

use crate::inputs::molecules::Input;
use crate::messages::console::Console;
use crate::tables::report::counted;
use knotdock::evaluate::{
    ChainChoice, Evaluator, MatchReport, Native, NativeComplex, PoseQuality, SideMatch,
};
use knotdock::output::records::input_record::{InputRecord, NativeRecord};
use knotdock::output::tables::poses::PoseRow;
use knotdock::refine::Refined;
use knotdock_structures::Error;
use knotdock_structures::molecule::{Molecule, ReadOptions};

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
    /// Receptor of the known complex, in its own file.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, requires = "native_ligand", help_heading = HEADING)]
    native_receptor: Option<String>,
    /// Ligand of the known complex, in the frame of its receptor.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, requires = "native_receptor", help_heading = HEADING)]
    native_ligand: Option<String>,
}

const HEADING: &str = "Known complex";

/// The files of the known complex: one with both partners, or one for each.
#[derive(Clone)]
pub struct NativeFiles {
    /// Both partners, or the receptor.
    first: Input,
    ligand: Option<Input>,
}

impl NativeArguments {
    pub fn read(&self) -> Result<Option<NativeFiles>, Error> {
        let Some(first) = self.native.as_ref().or(self.native_receptor.as_ref()) else {
            return Ok(None);
        };
        let ligand = self.native_ligand.as_ref();
        let ligand = ligand.map(|file| NativeFiles::complex(file)).transpose()?;
        Ok(Some(NativeFiles {
            ligand: ligand.map(|file| file.first),
            ..NativeFiles::complex(first)?
        }))
    }
}

impl NativeFiles {
    /// A complex that is docked again.
    pub fn of_pair([receptor, ligand]: &[Input; 2]) -> Self {
        Self {
            first: receptor.clone(),
            ligand: Some(ligand.clone()),
        }
    }

    /// Reads one file with both partners.
    pub fn complex(file: &str) -> Result<Self, Error> {
        let [first] = Input::read_all([file], &ReadOptions::default())?;
        Ok(Self {
            first,
            ligand: None,
        })
    }

    /// Reads the files that a run recorded.
    pub fn recorded(record: &NativeRecord, run: &Path) -> Result<Self, Error> {
        let read = |record: &InputRecord| {
            let [input] = Input::recorded([record], run, &ReadOptions::default())?;
            Ok::<_, Error>(input)
        };
        let (first, ligand) = match record {
            NativeRecord::Complex(complex) => (complex, None),
            NativeRecord::Partners { receptor, ligand } => (receptor, Some(ligand)),
        };
        Ok(Self {
            first: read(first)?,
            ligand: ligand.map(read).transpose()?,
        })
    }

    pub fn inputs(&self) -> impl Iterator<Item = &Input> {
        std::iter::once(&self.first).chain(&self.ligand)
    }

    pub fn record(&self) -> NativeRecord {
        let first = self.first.record.clone();
        match &self.ligand {
            None => NativeRecord::Complex(first),
            Some(ligand) => NativeRecord::Partners {
                receptor: first,
                ligand: ligand.record.clone(),
            },
        }
    }

    /// Matches the complex with receptor and ligand as docked, and reports the match.
    pub fn matched(&self, pair: [&Molecule; 2], console: Console) -> Result<Evaluator, Error> {
        let evaluator = self.evaluator(pair, &ChainChoice::default())?;
        self.warn(console);
        announce(&evaluator, console);
        Ok(evaluator)
    }

    /// Matches the complex with receptor and ligand, by chains that the user chooses.
    pub fn evaluator(
        &self,
        [receptor, ligand]: [&Molecule; 2],
        choice: &ChainChoice,
    ) -> Result<Evaluator, Error> {
        let choice = ChainChoice {
            named: choice.named || self.inputs().any(|input| input.record.chains.is_some()),
            ..choice.clone()
        };
        let first = &self.first.molecule;
        let native = match &self.ligand {
            None => Native::Complex(first),
            Some(ligand) => Native::Pair {
                receptor: first,
                ligand: &ligand.molecule,
            },
        };
        Evaluator::with_chains(receptor, ligand, native, &choice).map_err(|error| {
            let with_notes = self.notes().fold(error, |error, note| error.and(note));
            with_notes.at(&self.first.record.path)
        })
    }

    /// The quality of a refined pose. Contacts are of all heavy atoms, so molecules whose atoms moved are matched anew.
    pub fn quality(&self, pair: [&Molecule; 2], refined: &Refined) -> Result<PoseQuality, Error> {
        let moved = [0, 1].map(|side| refined.molecule(side, pair[side]));
        let evaluator = self.evaluator(moved.each_ref(), &ChainChoice::default())?;
        Ok(evaluator.evaluate(&refined.pose))
    }

    /// Omissions and warnings of reading the files.
    fn notes(&self) -> impl Iterator<Item = String> {
        self.inputs()
            .flat_map(|input| reading_notes(&input.molecule))
    }

    pub fn warn(&self, console: Console) {
        for note in self.notes() {
            console.warn(note);
        }
    }
}

/// Omissions and warnings of reading a file, which may explain an error that follows.
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
    let mut text =
        format!("Known complex: {share:.0}% of its interface is in the docked molecules");
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
