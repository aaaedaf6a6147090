//! The options of a docking run, each defined once.
//!
//! An option is a field of one of the structs here, a struct a subject. The field's doc comment is its help. `default_value_t` is its
//! default, `value_parser` its range, `value_name` its unit. From the field come:
//!
//! | what | how |
//! |---|---|
//! | the command line, its help and its refusals | `#[derive(clap::Args)]` |
//! | [`DockOptions::default`] | an empty command line ([`text::defaults`]) |
//! | the file of `--config` | its values are read as if they were typed ([`file`]) |
//! | `options` in `run.json` | `#[derive(Serialize, Deserialize)]` |
//! | the check of options from elsewhere | the values are read as if they were typed ([`check`]) |
//! | what `--rerun` repeats, which options a kind of input has | [`definition::definitions`] |
//! | what `tradeoff` varies | [`DockOptions::with`], by name |
//!
//! To add an option, add a field (and the code that uses it). The name of the field, the name on the command line and the key in files are
//! the same word; the heading of the struct in the help is the name of its table in files. The tests of [`definition`] hold both, and see
//! an option of a struct of their own arrive everywhere.

pub mod check;
pub mod definition;
pub mod effect_choice;
pub mod file;
mod input;
mod kernel;
mod machine;
mod output;
mod potential_file;
mod ranking;
mod restraints;
mod sampling;
mod search;
mod terms;
pub mod text;
pub mod values;

pub use effect_choice::EffectChoice;
pub use input::InputOptions;
pub use kernel::{KernelOptions, PASS_RATIO};
pub use machine::{MachineOptions, Threads};
pub use output::OutputOptions;
pub use potential_file::PotentialFileError;
pub use ranking::RankingOptions;
pub use restraints::{AntibodySurface, RestraintOptions};
pub use sampling::{MAX_PER_AXIS, SampleGrid, SampleWeights, SamplingOptions};
pub use search::{AXES, AXES_ACROSS, EngineChoice, Precision, REFINED_BY_SHAPE, SearchOptions};
pub use terms::TermOptions;

use std::sync::OnceLock;

use clap::Args;
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
