//! Refusal of options out of range, and of options that do not go together.

use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;
use nalgebra::Vector3;

use super::definition::{Definition, name_of};
use super::{
    AXES, AXES_ACROSS, DockOptions, EngineChoice, Precision, SearchOptions, definitions,
    option_named,
};

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

/// Radius of gyration in Å below which a ligand needs fewer rotations than the default.
const SMALL: f64 = 14.0;
/// Rotations of the smallest ligands.
const FEWEST_ROTATIONS: usize = 1000;

/// Radius of gyration of a molecule's heavy atoms, Å.
fn radius_of_gyration(molecule: &Molecule) -> f64 {
    let heavy = molecule.atoms.iter().filter(|atom| !atom.is_hydrogen());
    let places: Vec<Vector3<f64>> = heavy.map(|atom| Vector3::from(atom.position)).collect();
    let count = places.len().max(1) as f64;
    let middle = places.iter().sum::<Vector3<f64>>() / count;
    let squares = places.iter().map(|place| (place - middle).norm_squared());
    (squares.sum::<f64>() / count).sqrt()
}

impl DockOptions {
    /// The options of a search for rings: residues are alike on both sides, and rotations are axes, of which there
    /// are fewer unless their number is given.
    #[must_use]
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
        // Other residues of the ligand are refused by the check.
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

    /// The options of a search with a ligand: fewer rotations of a small one, unless `is_given` names an option that
    /// decides on them.
    ///
    /// Their number falls with the cube of the radius of gyration, so that neighbouring rotations move a ligand's
    /// surface by one length, whatever its size (docs/research/defaults.md).
    #[must_use]
    pub fn of_ligand(mut self, ligand: &Molecule, is_given: impl Fn(&str) -> bool) -> Self {
        if ["rotations", "fine_rotations", "symmetry"]
            .into_iter()
            .any(is_given)
        {
            return self;
        }
        let share = (radius_of_gyration(ligand) / SMALL).powi(3);
        let most = self.search.rotations;
        let count = (most as f64 * share).round() as usize;
        self.search.rotations = count.clamp(FEWEST_ROTATIONS.min(most), most);
        self
    }

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
            if self.search.engine != EngineChoice::Cpu {
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
        if self.search.engine != EngineChoice::Cpu {
            let value = name_of(self.search.engine);
            return Err(refused("engine", &value, &format!("cpu {with}")));
        }
        // A ring's poses score as their inverses do.
        let of = &self.restraints;
        for (name, differs) in [
            ("block_ligand", of.block_receptor != of.block_ligand),
            ("active_ligand", of.active_receptor != of.active_ligand),
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

    fn check_engine(&self) -> Result<(), Error> {
        let search = &self.search;
        if search.engine == EngineChoice::Cpu {
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
