//! The options of a docking run, each defined once.
//!
//! An option is a field of one of the structs here, a struct a subject. The field's doc comment is its help.
//! `default_value_t` is its default, `value_parser` its range, `value_name` its unit. From the field come:
//!
//! | what | how |
//! |---|---|
//! | the command line, its help and its refusals | `#[derive(clap::Args)]` |
//! | [`DockOptions::default`] | an empty command line ([`text`]) |
//! | the file of `--config` | its values are read as if they were typed ([`mod@file`]) |
//! | `options` in `run.json` | `#[derive(Serialize, Deserialize)]` |
//! | the check of options from elsewhere | the values are read as if they were typed ([`check`]) |
//! | what `--rerun` repeats, which options a kind of input has | [`definitions`] |
//! | what `tradeoff` varies | [`DockOptions::with`], by name |
//!
//! # To add an option
//!
//! Add a field, and the code that uses it. The field, the option on the command line and the key in files have the
//! same name. The heading of the struct is the name of its table in files; `(molecules)` or `(meshes)` behind it says
//! what the options have an effect on. The tests of [`definition`] hold both, and let an option of a struct of their
//! own arrive everywhere.

pub mod check;
pub mod definition;
pub mod effect_choice;
pub mod file;
mod input;
mod kernel;
mod machine;
pub mod membrane;
mod output;
mod potential_file;
mod preset;
mod ranking;
mod restraints;
mod sampling;
mod search;
pub mod term_weights;
mod terms;
pub mod text;
pub mod values;

pub use crate::mesh::SampleWeights;
pub use effect_choice::EffectChoice;
pub use input::InputOptions;
pub use kernel::{KernelOptions, PASS_RATIO};
pub use machine::{MachineOptions, Threads};
pub use output::OutputOptions;
pub use potential_file::PotentialFileError;
pub use preset::Preset;
pub use ranking::{RankingOptions, SharpChoice};
pub(crate) use restraints::PEPTIDASE_WEIGHT;
pub use restraints::{AntibodySurface, RestraintOptions};
pub use sampling::{MAX_PER_AXIS, SampleGrid, SamplingOptions};
pub use search::{AXES, AXES_ACROSS, EngineChoice, Precision, REFINED_BY_SHAPE, SearchOptions};
pub use term_weights::TermWeights;
pub use terms::TermOptions;

use std::sync::OnceLock;

use clap::Args;
use definition::{Definition, definitions_of};
use serde::{Deserialize, Serialize};

/// Options of a docking run. Lengths in Å, or in the files' unit where meshes are docked.
#[derive(Args, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DockOptions {
    /// What is read of a molecule.
    #[command(flatten)]
    pub input: InputOptions,
    /// How meshes are sampled.
    #[command(flatten)]
    pub sampling: SamplingOptions,
    /// What the search correlates.
    #[command(flatten)]
    pub kernel: KernelOptions,
    /// Weights and tables of the terms of the score.
    #[command(flatten)]
    pub terms: TermOptions,
    /// What is known of the contacts.
    #[command(flatten)]
    pub restraints: RestraintOptions,
    /// How densely and on what is searched.
    #[command(flatten)]
    pub search: SearchOptions,
    /// How poses become rows.
    #[command(flatten)]
    pub ranking: RankingOptions,
    /// What is written.
    #[command(flatten)]
    pub output: OutputOptions,
    /// Threads and memory, which change no result and are recorded elsewhere.
    #[command(flatten)]
    #[serde(skip)]
    pub machine: MachineOptions,
    /// Where a run within a time stopped: no option, but a fact that a run which repeats it needs. `None`: nowhere.
    #[arg(skip)]
    pub stopped: Option<Stopped>,
}

impl DockOptions {
    /// The options with a change.
    pub fn changed(&self, change: impl FnOnce(&mut Self)) -> Self {
        let mut options = self.clone();
        change(&mut options);
        options
    }
}

/// Where a run within a time stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stopped {
    /// Rotations that were searched, evenly spread over the set.
    pub rotations: usize,
    /// Poses that were kept of the search, the best ones.
    pub poses: usize,
}

impl Default for DockOptions {
    fn default() -> Self {
        static DEFAULT: OnceLock<DockOptions> = OnceLock::new();
        DEFAULT.get_or_init(text::defaults).clone()
    }
}

/// Definitions of all options, in their order.
pub fn definitions() -> &'static [Definition] {
    static ALL: OnceLock<Vec<Definition>> = OnceLock::new();
    ALL.get_or_init(definitions_of::<DockOptions>)
}

/// What is known of the option with a name.
pub fn option_named(name: &str) -> Option<&'static Definition> {
    definitions().iter().find(|option| option.name() == name)
}

/// The defaults of single subjects, as of all options.
macro_rules! defaults_of_subjects {
    ($($options:ident),+) => {
        $(impl Default for $options {
            fn default() -> Self {
                text::defaults()
            }
        })+
    };
}

defaults_of_subjects!(
    InputOptions,
    SamplingOptions,
    KernelOptions,
    TermOptions,
    RestraintOptions,
    SearchOptions,
    RankingOptions,
    OutputOptions,
    MachineOptions
);

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::OsString;

    /// Every option, with a value that is not its default.
    const GIVEN: &str = "--waters=keep --hetatm=drop --drop-residue=HEM --drop-residue=XK2 --hydrogens=keep --altloc=B --model=all \
        --assembly=1 --min-plddt=50 --sample-grid=2^12 --sample-weights=unit --sampler=bi --effects=contact --lambda=0.30000000000000004 --offset=1 \
        --alpha=3 --resolution=6 --pass-length=15 --spacing=0.3333333333333333 --tolerance=1e-3 --core-weight=2 \
        --electrostatics-weight=0 --contact-weight=1e5 --fine-contact-weight=1 --atom-pair-weight=2 --relaxed-weight=0 \
        --unresolved-weight=1 --termini-weight=0 --ph=5.5 --restraint-weight=3 --antibody=whole --block-receptor=A:1-3 \
        --block-ligand=B --active-weight=1 --active-receptor=A:5 --active-ligand=B:7,9 --restraints-need=60% --tbl-bounds=written --crosslink=BS3 --violation-weight=9 --interface-receptor=bfactor --interface-ligand=bfactor --interface-weight=1 --membrane=-15,15 --membrane-weight=2 --peptidase-weight=0 --rotations=17 \
        --fine-rotations=15deg --fine-share=0.5 --precision=double --engine=gpu --per-rotation=1 --poses=9 --refine=0 --symmetry=C3 \
        --cluster-radius=0 --sharp=off --no-cluster --write-top=0 --diagnostics --no-report";

    /// Options without a value that this test can name: tables, which are files, and the machine's.
    const ELSEWHERE: [&str; 6] = [
        "contact_potential",
        "fine_contact_potential",
        "atom_pair_potential",
        "restraints",
        "threads",
        "memory",
    ];

    #[test]
    fn options_survive_the_record_and_the_check_unchanged() {
        let words = GIVEN.split_whitespace().map(OsString::from);
        let options: DockOptions = text::read(words).unwrap();
        let given = text::given(&options, &DockOptions::default(), definitions());
        assert_eq!(given.count() + ELSEWHERE.len(), definitions().len());
        assert!(options.check_ranges().is_ok());
        let record = serde_json::to_string(&options).unwrap();
        assert_eq!(
            serde_json::from_str::<DockOptions>(&record).unwrap(),
            options
        );
        let machine = options.changed(|options| options.machine.threads = 7.into());
        assert_eq!(serde_json::to_string(&machine).unwrap(), record);
        let varied = machine.with("rotations", "15").unwrap();
        assert_eq!(varied.with("rotations", "17").unwrap(), machine);
    }

    #[test]
    fn an_option_of_a_later_version_is_refused_not_ignored() {
        let mut record = serde_json::to_value(DockOptions::default()).unwrap();
        record["terms"]["charges"] = true.into();
        let error = serde_json::from_value::<DockOptions>(record).unwrap_err();
        assert!(error.to_string().contains("charges"));
    }
}
