//! Conformations as read: each aligned with the first of its side.

use serde_json::{Value, json};

use crate::inputs::bodies::Bodies;
use crate::inputs::conformations::Conformation;
use crate::inputs::molecules::Input;
use crate::records::joined;
use knotdock::dock::run::molecule_points;
use knotdock::evaluate::{Superposed, superpose};
use knotdock::options::DockOptions;
use knotdock::output::records::input_record::InputRecord;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use knotdock_structures::molecule::{InputSpec, Molecule};

/// A conformation aligned with the first of its side.
pub struct AlignedConformation {
    pub name: String,
    pub spec: InputSpec,
    record: InputRecord,
    /// Its place on the first.
    pub place: Superposed,
    /// Largest distance in Å of an atom from the middle: the larger, the larger the grid.
    pub radius: f64,
}

impl AlignedConformation {
    fn new(conformation: &Conformation, input: &Input, first: &Molecule) -> Result<Self, Error> {
        let place =
            superpose(&input.molecule, first).map_err(|error| error.at(&input.record.path))?;
        Ok(Self {
            name: conformation.name.clone(),
            spec: conformation.spec.clone(),
            record: input.record.clone(),
            place,
            radius: radius(&input.molecule),
        })
    }

    /// The entry of ensemble.json: the file, the motion onto the first conformation, and the RMSD from it.
    pub fn record(&self) -> Value {
        let Pose { translation, .. } = self.place.motion;
        let [w, x, y, z] = self.place.motion.quaternion();
        joined([
            json!({ "name": self.name }),
            json!(self.record),
            json!({
                "to_first": [w, x, y, z, translation.x, translation.y, translation.z],
                "rmsd_from_first": self.place.rmsd,
                "residues_matched": self.place.matched,
            }),
        ])
    }

    pub fn line(&self) -> String {
        let model = self.spec.model;
        format!(
            "  {}: {}{}, {:.2} Å RMSD from the first over {} residues",
            self.name,
            self.record.path.display(),
            model.map_or(String::new(), |model| format!(" model {model}")),
            self.place.rmsd,
            self.place.matched
        )
    }
}

/// The conformations of both sides, receptor first, and the points (Å) of the first ligand that make clusters.
pub struct AlignedSides {
    /// Those of each side, the first first.
    pub sides: [Vec<AlignedConformation>; 2],
    /// Points of the first ligand.
    pub points: Vec<[f64; 3]>,
}

impl AlignedSides {
    /// Reads all conformations as they will be read for docking, and aligns each with the first of its side.
    pub fn read(sides: &[Vec<Conformation>; 2], options: &DockOptions) -> Result<Self, Error> {
        let pair = |receptor: &Conformation, ligand: &Conformation| {
            read_pair([&receptor.spec, &ligand.spec], options)
        };
        let [receptors, ligands] = sides;
        let ([receptor, ..], [ligand, ..]) = (receptors.as_slice(), ligands.as_slice()) else {
            return Err(Error::machine("a side of the ensemble has no conformation"));
        };
        let firsts = pair(receptor, ligand)?;
        let firsts = firsts.each_ref().map(|input| &input.molecule);
        let laid = |side: usize, conformation: &Conformation| {
            let inputs = match side {
                0 => pair(conformation, ligand)?,
                _ => pair(receptor, conformation)?,
            };
            AlignedConformation::new(conformation, &inputs[side], firsts[side])
        };
        let of_side = |side: usize| -> Result<Vec<AlignedConformation>, Error> {
            let conformations = sides[side].iter();
            conformations.map(|one| laid(side, one)).collect()
        };
        Ok(Self {
            sides: [of_side(0)?, of_side(1)?],
            points: molecule_points(firsts[1]),
        })
    }
}

fn read_pair(specs: [&InputSpec; 2], options: &DockOptions) -> Result<Box<[Input; 2]>, Error> {
    match Bodies::of(specs.map(InputSpec::clone), options)? {
        Bodies::Molecules(inputs) => Ok(inputs),
        Bodies::Meshes(_) => Err(Error::input(
            "only molecules can be docked as ensembles, and these are meshes",
        )),
    }
}

/// Largest distance in Å of an atom from the mean of all.
fn radius(molecule: &Molecule) -> f64 {
    let count = molecule.atoms.len().max(1) as f64;
    let atoms = || molecule.atoms.iter();
    let middle: [f64; 3] =
        std::array::from_fn(|axis| atoms().map(|atom| atom.position[axis]).sum::<f64>() / count);
    let square = |position: [f64; 3]| -> f64 {
        let axes = 0..3;
        axes.map(|axis| (position[axis] - middle[axis]).powi(2))
            .sum()
    };
    let squares = atoms().map(|atom| square(atom.position));
    squares.fold(0.0, f64::max).sqrt()
}
