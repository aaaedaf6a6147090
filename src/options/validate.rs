//! Refusal of options out of range, and of options that do not go together.

use knotdock_structures::Error;

use super::definition::{Definition, name_of};
use super::{DockOptions, EngineChoice, Precision, SearchOptions, definitions, option_named};

/// The refusal of an option by name; `bound` states the demand on it.
pub(crate) fn refused(name: &str, value: &str, bound: &str) -> Error {
    let bound = format!("it must be {bound}");
    match option_named(name) {
        Some(option) => option.refusal(value, &bound),
        None => Error::input(format!("{name} is {value}; {bound}")),
    }
}

/// The refusal of an option without effect in a run; `context` states why.
pub(crate) fn left_out(name: &str, value: &str, context: &str) -> Error {
    refused(name, value, &format!("left out {context}")).help("leave the option out")
}

impl DockOptions {
    /// Refuses values out of range.
    pub(crate) fn check_ranges(&self) -> Result<(), Error> {
        definitions()
            .iter()
            .try_for_each(|option| option.check(self))
    }

    /// Refuses values out of range, and options that do not go together.
    pub fn validate(&self) -> Result<(), Error> {
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
            let value = format!(
                "{} rotations and {} poses",
                stopped.rotations, stopped.poses
            );
            let bound = "at least one of each, and no more than rotations and poses";
            return Err(refused("stopped", &value, bound));
        }
        if let Some(finer) = fine_rotations
            && finer < rotations
        {
            let bound = "no fewer than the rotations";
            return Err(refused("fine_rotations", &finer.to_string(), bound));
        }
        let share = self.search.fine_share;
        if fine_rotations.is_none() && share != SearchOptions::default().fine_share {
            let context = "without --fine-rotations";
            return Err(left_out("fine_share", &share.to_string(), context));
        }
        let tolerance = self.kernel.tolerance;
        if tolerance < precision.finest_tolerance() {
            let bound = match precision {
                Precision::Single => {
                    "1e-4 or more in single precision (1e-6 with --precision double)"
                }
                Precision::Double => "1e-6 or more",
            };
            return Err(refused("tolerance", &tolerance.to_string(), bound));
        }
        self.check_rings()?;
        self.check_restraints()?;
        self.check_engine()
    }

    /// The value of an option as text, or "left out".
    fn written(&self, option: &Definition) -> String {
        option.text(self).unwrap_or_else(|| "left out".to_owned())
    }

    /// Refuses options that do not go with distance restraints and membranes.
    fn check_restraints(&self) -> Result<(), Error> {
        let (restraints, default) = (&self.restraints, Self::default());
        let file = restraints.restraints.as_ref();
        let path = file.map(|file| file.path.display().to_string());
        let of_search = [
            ("restraints", path),
            ("membrane", restraints.membrane.map(String::from)),
        ];
        for (name, value) in of_search {
            let Some(value) = value else { continue };
            if let Some(symmetry) = self.search.symmetry {
                let context = format!("with --symmetry {symmetry}");
                return Err(left_out(name, &value, &context));
            }
            if self.search.engine == EngineChoice::Gpu {
                let bound = format!("cpu with --{name}");
                return Err(refused("engine", &name_of(self.search.engine), &bound));
            }
        }
        let of_file = ["restraints_need", "tbl_bounds", "crosslink"];
        let mut given = of_file.into_iter().filter_map(option_named);
        match given.find(|option| file.is_none() && !option.is_same(self, &default)) {
            Some(option) => {
                let value = self.written(option);
                Err(left_out(option.name(), &value, "without --restraints"))
            }
            None => Ok(()),
        }
    }

    /// Refuses options that do not go with a search for rings.
    fn check_rings(&self) -> Result<(), Error> {
        let Some(symmetry) = self.search.symmetry else {
            return Ok(());
        };
        let with = format!("with --symmetry {symmetry}");
        if let Some(finer) = self.search.fine_rotations {
            return Err(left_out("fine_rotations", &finer.to_string(), &with));
        }
        if let Some(refined) = self.search.refine {
            let context = format!("{with}, for every ring is refined");
            return Err(left_out("refine", &refined.to_string(), &context));
        }
        if self.search.engine == EngineChoice::Gpu {
            let value = name_of(self.search.engine);
            return Err(refused("engine", &value, &format!("cpu {with}")));
        }
        // A ring's poses score as their inverses do.
        let of = &self.restraints;
        for (name, differs) in [
            ("block_ligand", of.block_receptor != of.block_ligand),
            ("active_ligand", of.active_receptor != of.active_ligand),
            ("site_ligand", of.site_receptor != of.site_ligand),
            (
                "interface_ligand",
                of.interface_receptor != of.interface_ligand,
            ),
        ] {
            if let Some(option) = option_named(name).filter(|_| differs) {
                let bound = format!("the receptor's {with}");
                return Err(refused(name, &self.written(option), &bound));
            }
        }
        Ok(())
    }

    /// The engine that these options can have: under `auto` a graphics processor only if nothing asks for the CPU.
    pub fn engine(&self) -> EngineChoice {
        let mut on_card = self.clone();
        on_card.search.engine = EngineChoice::Gpu;
        match self.search.engine {
            EngineChoice::Auto if on_card.validate().is_err() => EngineChoice::Cpu,
            engine => engine,
        }
    }

    fn check_engine(&self) -> Result<(), Error> {
        let search = &self.search;
        if search.engine != EngineChoice::Gpu {
            return Ok(());
        }
        if !cfg!(feature = "gpu") {
            let bound = "cpu in this build, which was made without the feature `gpu`";
            return Err(refused("engine", &name_of(search.engine), bound));
        }
        if search.precision == Precision::Double {
            let bound = "single with --engine gpu";
            return Err(refused("precision", &name_of(search.precision), bound));
        }
        Ok(())
    }
}
