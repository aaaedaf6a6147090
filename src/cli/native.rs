//! The known complex that poses are measured against: its options, its files, and its match with what was docked.

use std::path::Path;

use clap::Args;
use knotdock::evaluate::{Evaluator, Native, PoseQuality};
use knotdock::output::input_record::NativeRecord;
use knotdock::output::poses::PoseRow;
use knotdock_structures::molecule::{Molecule, ReadOptions};

use super::failure::Failure;
use super::input::Input;

/// Options that name the known complex.
#[derive(Args, Debug)]
pub struct NativeArguments {
    /// Known complex with both partners in one file, to measure the poses against.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["native_receptor", "native_ligand"], help_heading = HEADING)]
    native: Option<String>,
    /// Receptor of the known complex; FILE:H,L picks chains.
    #[arg(long, value_name = "FILE", requires = "native_ligand", help_heading = HEADING)]
    native_receptor: Option<String>,
    /// Ligand of the known complex, in the frame of its receptor; FILE:H,L picks chains.
    #[arg(long, value_name = "FILE", requires = "native_receptor", help_heading = HEADING)]
    native_ligand: Option<String>,
}

const HEADING: &str = "Known complex";

/// The files of the known complex.
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
    pub fn read(&self) -> Result<Option<NativeFiles>, Failure> {
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
    pub fn recorded(record: &NativeRecord, run: &Path) -> Result<Self, Failure> {
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
    pub fn evaluator(&self, receptor: &Molecule, ligand: &Molecule) -> Result<Evaluator, Failure> {
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
        Evaluator::new(receptor, ligand, native).map_err(|error| {
            Failure::input(&error)
                .at(&file.record.path)
                .remedy(error.remedy())
        })
    }
}

/// Every pose's quality.
pub fn measure(evaluator: &Evaluator, rows: &[PoseRow]) -> Vec<PoseQuality> {
    rows.iter()
        .map(|row| evaluator.evaluate(&row.pose))
        .collect()
}

/// What was matched, in a line for each side.
pub fn match_text(evaluator: &Evaluator) -> String {
    let report = evaluator.report();
    let chains = |side: &knotdock::evaluate::SideMatch| {
        let mut names: Vec<&str> = Vec::new();
        for chain in &side.chains {
            if !names.contains(&chain.native_chain.as_str()) {
                names.push(&chain.native_chain);
            }
        }
        names.join(", ")
    };
    let side = |name: &str, side: &knotdock::evaluate::SideMatch| {
        let mut text = format!(
            "  {name}, as the native's {}: {} of {} residues, {} of {} at the interface; the docked backbone lies {:.2} Å RMSD from it",
            chains(side),
            side.matched,
            side.native_residues,
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
    };
    let mut text = format!(
        "Matched with the native ({:.0}% of its interface):\n{}\n{}",
        100.0 * report.interface_share,
        side("receptor", &report.receptor),
        side("ligand", &report.ligand)
    );
    if !report.unused_native_chains.is_empty() {
        text += &format!(
            "\n  left aside of the native: {}; if another copy is meant, name its chains, as in --native FILE:A,B",
            report.unused_native_chains.join(", ")
        );
    }
    text
}
