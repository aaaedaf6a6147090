//! Conformations as read: each laid on the first of its side.

use crate::records::ensemble_record::ConformationRecord;
use knotdock::dock::run::molecule_points;
use knotdock::evaluate::{Superposed, superpose};
use knotdock::options::DockOptions;
use knotdock::output::records::input_record::InputRecord;
use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::{InputSpec, Molecule};

use crate::inputs::bodies::Bodies;
use crate::inputs::conformations::Conformation;
use crate::inputs::molecules::Input;
use knotdock_structures::Error;

/// A conformation that lies on the first of its side.
pub struct Laid {
    /// Its name in tables.
    pub name: String,
    /// What is read.
    pub spec: InputSpec,
    /// Its file.
    record: InputRecord,
    /// Its place on the first.
    pub place: Superposed,
    /// Largest distance in Å of an atom from the middle: the larger, the larger the grid.
    pub radius: f64,
}

impl Laid {
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

    /// The conformation for ensemble.json.
    pub fn record(&self) -> ConformationRecord {
        let Pose { translation, .. } = self.place.motion;
        let [w, x, y, z] = self.place.motion.quaternion();
        ConformationRecord {
            name: self.name.clone(),
            record: self.record.clone(),
            to_first: [w, x, y, z, translation.x, translation.y, translation.z],
            rmsd_from_first: self.place.rmsd,
            residues_matched: self.place.matched,
        }
    }

    /// What it is, in a line.
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
pub struct LaidSides {
    /// Those of each side, the first first.
    pub sides: [Vec<Laid>; 2],
    /// Points of the first ligand.
    pub points: Vec<[f64; 3]>,
}

impl LaidSides {
    /// Reads all conformations as they will be read for docking, and lays each on the first of its side.
    ///
    /// # Errors
    /// [`Error`] where one cannot be read or is another molecule.
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
            Laid::new(conformation, &inputs[side], firsts[side])
        };
        let of_side = |side: usize| -> Result<Vec<Laid>, Error> {
            let conformations = sides[side].iter();
            conformations.map(|one| laid(side, one)).collect()
        };
        Ok(Self {
            sides: [of_side(0)?, of_side(1)?],
            points: molecule_points(firsts[1]),
        })
    }
}

/// The molecules of a pair.
fn read_pair(specs: [&InputSpec; 2], options: &DockOptions) -> Result<Box<[Input; 2]>, Error> {
    match Bodies::of(specs.map(InputSpec::clone), options)? {
        Bodies::Molecules(inputs) => Ok(inputs),
        Bodies::Meshes(_) => Err(Error::input(
            "only molecules can be docked as ensembles, and these are meshes",
        )),
    }
}

fn radius(molecule: &Molecule) -> f64 {
    let count = molecule.atoms.len().max(1) as f64;
    let middle: [f64; 3] = std::array::from_fn(|axis| {
        molecule
            .atoms
            .iter()
            .map(|atom| atom.position[axis])
            .sum::<f64>()
            / count
    });
    let square = |position: [f64; 3]| -> f64 {
        (0..3)
            .map(|axis| (position[axis] - middle[axis]).powi(2))
            .sum()
    };
    let squares = molecule.atoms.iter().map(|atom| square(atom.position));
    squares.fold(0.0, f64::max).sqrt()
}
