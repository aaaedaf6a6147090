//! The options of a docking run, each defined once.
//!
//! An option is a line of one of the lists here ([`mod@definition`]): its doc comment is its help, followed by name,
//! type, default and range. From the list come:
//!
//! | from the list | by |
//! |---|---|
//! | a struct of plain fields, its defaults and its form in `run.json` | serde |
//! | name, help and default in command lines and in Python | [`definitions`] |
//! | values from text: typed, in a file of `--config`, in a table of pairs | [`definition::Definition::read`] |
//! | the check of ranges | [`DockOptions::validate`] |
//!
//! # To add an option
//!
//! Add a line, and the code that uses it. The field, the option on the command line and the key in files have the same
//! name. The heading of the list is the name of its table in files.

mod by_input;
pub mod definition;
pub mod effect_choice;
pub mod file;
mod input;
mod kernel;
mod machine;
pub mod membrane;
mod preset;
mod ranking;
mod restraints;
mod sampling;
mod search;
mod terms;
mod validate;
pub mod values;

pub use crate::mesh::SampleWeights;
pub use effect_choice::EffectChoice;
pub use input::InputOptions;
pub use kernel::{KernelOptions, PASS_RATIO};
pub use machine::MachineOptions;
pub use preset::Preset;
pub use ranking::{OutputOptions, RankingOptions, SharpChoice};
pub use restraints::{AntibodySurface, RestraintOptions};
pub use sampling::{MAX_PER_AXIS, SampleGrid, SamplingOptions};
pub use search::{AXES, AXES_ACROSS, EngineChoice, Precision, REFINED_BY_SHAPE, SearchOptions};
pub use terms::TermOptions;
pub(crate) use validate::refused;

use std::sync::LazyLock;

use definition::{Definition, Scope};
use knotdock_structures::Error;
use serde::{Deserialize, Serialize};

/// Options of a docking run. Lengths in Å, or in the files' unit where meshes are docked.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DockOptions {
    /// Reading of molecules.
    pub input: InputOptions,
    /// Sampling of meshes.
    pub sampling: SamplingOptions,
    /// The score of the search.
    pub kernel: KernelOptions,
    /// Weights and tables of the terms of the score.
    pub terms: TermOptions,
    /// Known contacts.
    pub restraints: RestraintOptions,
    /// Density of the search, and the hardware that it runs on.
    pub search: SearchOptions,
    /// From poses to rows.
    pub ranking: RankingOptions,
    /// Files of the run.
    pub output: OutputOptions,
    /// Threads and memory, which change no result and are recorded elsewhere.
    #[serde(skip)]
    pub machine: MachineOptions,
    /// Stop of a run within a time: no option, but needed to repeat the run. `None`: it did not stop early.
    pub stopped: Option<Stopped>,
}

/// Stop of a run within a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stopped {
    /// Rotations that were searched, evenly spread over the set.
    pub rotations: usize,
    /// Poses that were kept of the search, the best ones.
    pub poses: usize,
}

/// Definitions of all options, in their order.
pub fn definitions() -> &'static [Definition] {
    static ALL: LazyLock<Vec<Definition>> = LazyLock::new(|| {
        let subjects = [
            InputOptions::definitions(),
            SamplingOptions::definitions(),
            KernelOptions::definitions(),
            TermOptions::definitions(),
            RestraintOptions::definitions(),
            SearchOptions::definitions(),
            RankingOptions::definitions(),
            OutputOptions::definitions(),
            MachineOptions::definitions(),
        ];
        subjects.into_iter().flatten().collect()
    });
    &ALL
}

/// The definition of the option with a name.
pub fn option_named(name: &str) -> Option<&'static Definition> {
    definitions().iter().find(|option| option.name() == name)
}

impl DockOptions {
    /// The options with a change.
    #[must_use]
    pub fn changed(&self, change: impl FnOnce(&mut Self)) -> Self {
        let mut options = self.clone();
        change(&mut options);
        options
    }

    /// The options with the value of one changed, by its name and its value as text.
    ///
    /// # Errors
    /// [`Error`] for a name that is no option's and a value out of range.
    pub fn with(&self, name: &str, text: &str) -> Result<Self, Error> {
        let option = option_named(name)
            .ok_or_else(|| Error::input(format!("there is no option `{name}`")))?;
        let mut options = self.clone();
        option.set(&mut options, text)?;
        Ok(options)
    }

    /// The options that differ from their defaults, in their order, without those of the machine, which change no
    /// result.
    pub fn given(&self) -> impl Iterator<Item = &'static Definition> {
        let default = Self::default();
        let of_run = definitions()
            .iter()
            .filter(|option| option.subject() != "machine");
        of_run.filter(move |option| !option.is_same(self, &default))
    }

    /// The first option that differs from its default and has no effect on meshes, or on molecules.
    pub fn without_effect(&self, are_meshes: bool) -> Option<&'static Definition> {
        let other = [Scope::Meshes, Scope::Molecules][usize::from(are_meshes)];
        self.given().find(|option| option.scope() == other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every option that takes a word, with a value that is not its default.
    const GIVEN: &str = "waters=keep hetatm=drop drop_residue=HEM,XK2 hydrogens=keep altloc=B model=all assembly=1 \
        min_plddt=50 sample_grid=2^12 sample_weights=unit sampler=bi effects=contact lambda=0.30000000000000004 offset=1 \
        alpha=3 resolution=6 pass_length=15 spacing=0.3333333333333333 tolerance=1e-3 core_weight=2 \
        electrostatics_weight=0 contact_weight=1e5 fine_contact_weight=1 atom_pair_weight=2 relaxed_weight=0 \
        unresolved_weight=1 termini_weight=0 ph=5.5 restraint_weight=3 antibody=whole block_receptor=A:1-3 \
        block_ligand=B active_weight=1 active_receptor=A:5 active_ligand=B:7,9 site_receptor=A:6 site_ligand=B:8 restraints_need=60% tbl_bounds=written \
        crosslink=BS3 violation_weight=9 interface_receptor=bfactor interface_ligand=bfactor interface_weight=1 \
        membrane=-15,15 membrane_weight=2 peptidase_weight=0 rotations=17 fine_rotations=15deg fine_share=0.5 \
        precision=double engine=gpu per_rotation=1 poses=9 refine=0 symmetry=C3 cluster_radius=0 sharp=off \
        no_cluster=true exact=all write_top=0 raw=true diagnostics=true no_report=true threads=7 memory=1GiB";

    /// Options whose value is a file.
    const FILES: [&str; 4] = [
        "contact_potential",
        "fine_contact_potential",
        "atom_pair_potential",
        "restraints",
    ];

    fn given() -> DockOptions {
        GIVEN
            .split_whitespace()
            .fold(DockOptions::default(), |options, word| {
                let (name, text) = word.split_once('=').unwrap();
                options.with(name, text).unwrap()
            })
    }

    #[test]
    fn options_survive_the_record_and_the_check_unchanged() {
        let options = given();
        let of_machine = 2;
        let given = options.given().count();
        assert_eq!(given + FILES.len() + of_machine, definitions().len());
        assert!(options.check_ranges().is_ok());
        let record = serde_json::to_string(&options).unwrap();
        let read: DockOptions = serde_json::from_str(&record).unwrap();
        let machine = options.machine.clone();
        assert_eq!(read.changed(|options| options.machine = machine), options);
        let varied = options.with("rotations", "15").unwrap();
        assert_eq!(varied.with("rotations", "17").unwrap(), options);
        assert!(options.with("rotation", "15").is_err());
    }

    /// The text of a value gives the value back.
    #[test]
    fn values_are_read_as_they_are_written() {
        let options = given();
        for option in options.given() {
            let text = option.text(&options).unwrap_or_default();
            if option.name().starts_with("interface_") && text.is_empty() {
                continue;
            }
            let mut again = DockOptions::default();
            option.set(&mut again, &text).unwrap();
            assert!(
                option.is_same(&again, &options),
                "{}: {text}",
                option.name()
            );
        }
    }

    /// The heading of each option is the name of its struct's field, and its name that of the option's field: so the
    /// command line, files and records agree. Options of the machine are in no record.
    #[test]
    fn names_and_headings_are_those_of_the_fields() {
        let record = serde_json::to_value(DockOptions::default()).unwrap();
        let mut recorded: Vec<String> = Vec::new();
        for (subject, options) in record.as_object().unwrap() {
            let options = options.as_object().into_iter().flatten();
            recorded.extend(options.map(|(name, _)| format!("{subject}.{name}")));
        }
        let defined: Vec<String> = definitions()
            .iter()
            .filter(|option| option.subject() != "machine")
            .map(|option| format!("{}.{}", option.subject(), option.name()))
            .collect();
        assert_eq!(recorded, defined);
        assert!(definitions().iter().all(|option| !option.help().is_empty()));
    }

    #[test]
    fn values_out_of_range_are_refused_by_name() {
        for (name, text, value) in [
            ("lambda", "-1", -1.0),
            ("lambda", "nan", f64::NAN),
            ("lambda", "inf", f64::INFINITY),
        ] {
            let typed = DockOptions::default().with(name, text).unwrap_err();
            let set = DockOptions::default().changed(|options| options.kernel.lambda = value);
            let checked = set.check_ranges().unwrap_err();
            for error in [typed, checked] {
                let message = error.to_string();
                assert!(message.starts_with("--lambda is "), "{message}");
                assert!(
                    message.ends_with("must be a finite number of 0 or more"),
                    "{message}"
                );
                assert!(error.remedy().unwrap().contains("--lambda"));
            }
        }
    }

    #[test]
    fn an_option_of_a_later_version_is_refused_not_ignored() {
        let mut record = serde_json::to_value(DockOptions::default()).unwrap();
        record["terms"]["charges"] = true.into();
        let error = serde_json::from_value::<DockOptions>(record).unwrap_err();
        assert!(error.to_string().contains("charges"));
    }
}
