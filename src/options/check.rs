//! Checks of options. They refuse values out of range, and options that do not go together.

use super::definition::{Definition, Scope};
use super::text::{self, OptionError};
use super::{
    AXES, AXES_ACROSS, DockOptions, EngineChoice, Precision, SearchOptions, Stopped, definitions,
    option_named,
};
use crate::error::SearchError;
use clap::ValueEnum;

impl DockOptions {
    /// The options with the value of one changed, by the name of its field and its value as it is typed.
    ///
    /// # Errors
    /// [`SearchError::Option`] for a value out of range.
    pub fn with(&self, name: &str, text: &str) -> Result<Self, SearchError> {
        let options = text::with(self, name, text).map_err(search_error)?;
        Ok(Self {
            machine: self.machine.clone(),
            ..options
        })
    }

    /// The options of a search for rings: residues are alike on both sides, and rotations are axes, of which there
    /// are fewer unless their number is given.
    pub fn of_rings(mut self, rotations_given: bool) -> Self {
        let Some(symmetry) = self.search.symmetry else {
            return self;
        };
        if !rotations_given {
            self.search.rotations = match symmetry.folds() {
                Some(_) => AXES_ACROSS,
                None => AXES,
            };
        }
        // A side of its own is refused by the check.
        let restraints = &mut self.restraints;
        for (receptor, ligand) in [
            (&restraints.block_receptor, &mut restraints.block_ligand),
            (&restraints.active_receptor, &mut restraints.active_ligand),
        ] {
            if ligand.is_none() {
                ligand.clone_from(receptor);
            }
        }
        if restraints.interface_ligand.is_none() {
            restraints
                .interface_ligand
                .clone_from(&restraints.interface_receptor);
        }
        self
    }

    /// The first option that differs from its default and has no effect on meshes, or on molecules.
    pub fn without_effect(&self, are_meshes: bool) -> Option<&'static Definition> {
        let other = if are_meshes {
            Scope::Molecules
        } else {
            Scope::Meshes
        };
        let mut given = text::given(self, &Self::default(), definitions());
        given.find(|option| option.scope() == other)
    }

    /// Refuses values out of range.
    pub(crate) fn check_ranges(&self) -> Result<(), SearchError> {
        text::check(self).map_err(search_error)
    }

    /// Refuses what no run can do.
    pub(crate) fn check(&self) -> Result<(), SearchError> {
        self.check_ranges()?;
        let SearchOptions {
            rotations,
            fine_rotations,
            precision,
            ..
        } = self.search;
        if let Some(stopped) = self.stopped
            && !((1..=rotations).contains(&stopped.rotations)
                && (1..=self.search.poses).contains(&stopped.poses))
        {
            let Stopped { rotations, poses } = stopped;
            return Err(SearchError::Option {
                name: "stopped",
                value: format!("{rotations} rotations and {poses} poses"),
                bound: "at least one of each, and no more than rotations and poses".to_owned(),
            });
        }
        if let Some(finer) = fine_rotations
            && finer < rotations
        {
            return Err(SearchError::Option {
                name: "fine-rotations",
                value: finer.to_string(),
                bound: "no fewer than the rotations".to_owned(),
            });
        }
        let share = self.search.fine_share;
        if fine_rotations.is_none() && share != SearchOptions::default().fine_share {
            return Err(SearchError::Option {
                name: "fine-share",
                value: share.to_string(),
                bound: "left out without --fine-rotations".to_owned(),
            });
        }
        let tolerance = self.kernel.tolerance;
        if tolerance < precision.finest_tolerance() {
            return Err(SearchError::Option {
                name: "tolerance",
                value: tolerance.to_string(),
                bound: match precision {
                    Precision::Single => {
                        "1e-4 or more in single precision (1e-6 with --precision double)"
                    }
                    Precision::Double => "1e-6 or more",
                }
                .to_owned(),
            });
        }
        self.check_rings()?;
        self.check_restraints()?;
        self.check_engine()
    }

    /// Refuses what distance restraints and membranes have no part in.
    fn check_restraints(&self) -> Result<(), SearchError> {
        let (restraints, default) = (&self.restraints, Self::default().restraints);
        let refused = |name, value: String, bound: &str| SearchError::Option {
            name,
            value,
            bound: bound.to_owned(),
        };
        let file = restraints.restraints.as_ref();
        let of_search = [
            (
                "restraints",
                file.map(|file| file.path.display().to_string()),
            ),
            ("membrane", restraints.membrane.map(|of| of.to_string())),
        ];
        for (name, value) in of_search {
            let Some(value) = value else { continue };
            if let Some(symmetry) = self.search.symmetry {
                let bound = format!("left out with --symmetry {symmetry}");
                return Err(refused(name, value, &bound));
            }
            if self.search.engine != EngineChoice::Cpu {
                let bound = format!("cpu with --{name}");
                return Err(refused("engine", name_of(self.search.engine), &bound));
            }
        }
        if file.is_some() {
            return Ok(());
        }
        let bound = "left out without --restraints";
        if restraints.restraints_need != default.restraints_need {
            let value = restraints.restraints_need.to_string();
            return Err(refused("restraints-need", value, bound));
        }
        if restraints.tbl_bounds != default.tbl_bounds {
            return Err(refused("tbl-bounds", name_of(restraints.tbl_bounds), bound));
        }
        match restraints.crosslink {
            Some(crosslink) => Err(refused("crosslink", crosslink.to_string(), bound)),
            None => Ok(()),
        }
    }

    /// Refuses what a search for rings has no part for.
    fn check_rings(&self) -> Result<(), SearchError> {
        let Some(symmetry) = self.search.symmetry else {
            return Ok(());
        };
        let without = |name, value: String, bound: &str| SearchError::Option {
            name,
            value,
            bound: format!("{bound} with --symmetry {symmetry}"),
        };
        if let Some(finer) = self.search.fine_rotations {
            return Err(without("fine-rotations", finer.to_string(), "left out"));
        }
        if let Some(refined) = self.search.refine {
            let bound = "left out, for every ring is refined,";
            return Err(without("refine", refined.to_string(), bound));
        }
        if self.search.engine != EngineChoice::Cpu {
            return Err(without("engine", name_of(self.search.engine), "cpu"));
        }
        // A ring's poses score as their inverses do.
        let restraints = &self.restraints;
        let sides = [
            (
                "block-ligand",
                &restraints.block_receptor,
                &restraints.block_ligand,
            ),
            (
                "active-ligand",
                &restraints.active_receptor,
                &restraints.active_ligand,
            ),
        ];
        for (name, receptor, ligand) in sides {
            if receptor != ligand {
                let value = match ligand {
                    Some(residues) => residues.clone().into(),
                    None => "left out".to_owned(),
                };
                return Err(without(name, value, "the receptor's"));
            }
        }
        if restraints.interface_receptor != restraints.interface_ligand {
            let value = restraints.interface_ligand.as_ref();
            let value = value.map_or_else(|| "left out".to_owned(), ToString::to_string);
            return Err(without("interface-ligand", value, "the receptor's"));
        }
        Ok(())
    }

    fn check_engine(&self) -> Result<(), SearchError> {
        let search = &self.search;
        if search.engine == EngineChoice::Cpu {
            return Ok(());
        }
        if !cfg!(feature = "gpu") {
            return Err(SearchError::Option {
                name: "engine",
                value: name_of(search.engine),
                bound: "cpu in this build, which was made without the feature `gpu`".to_owned(),
            });
        }
        if search.precision == Precision::Double {
            return Err(SearchError::Option {
                name: "precision",
                value: name_of(search.precision),
                bound: "single with --engine gpu".to_owned(),
            });
        }
        Ok(())
    }
}

/// The error of a search that has such an option.
fn search_error(error: OptionError) -> SearchError {
    let known = option_named(&error.name.replace('-', "_"));
    SearchError::Option {
        name: known.map_or("option", Definition::long),
        value: error.value,
        bound: error.bound,
    }
}

/// The name of a choice on the command line.
pub fn name_of(choice: impl ValueEnum) -> String {
    let value = choice.to_possible_value();
    value.map_or_else(String::new, |value| value.get_name().to_owned())
}
