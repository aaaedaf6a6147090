//! Restraints of one docking: distances between receptor and ligand, residues that are likely in contact, and a membrane.

use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::pose::{DistanceRestraints, Membrane, PredictedResidue};
use knotdock_structures::molecule::Molecule;

use crate::options::RestraintOptions;
use crate::restraints::FileRestraints;
use knotdock_structures::Error;

/// Distance restraints with the number that a pose has to satisfy, predictions of the interface, and a membrane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Restrained {
    /// Atoms, bounds, and the number that has to be satisfied.
    pub distances: DistanceRestraints,
    /// Their names, in the same order.
    pub names: Vec<String>,
    /// Restraints that are left out, since they are, or may be, within one molecule.
    pub within_one_molecule: usize,
    /// Least and most that upper bounds are widened by for hydrogens, in Å; `None` if none is.
    pub widened: Option<[f64; 2]>,
    /// Residues of receptor and ligand with predictions.
    pub predicted: [Vec<PredictedResidue>; 2],
    /// A membrane of one side, which the other is to stay out of.
    pub membrane: Option<Membrane>,
}

impl Restrained {
    /// The restraints and predictions of the options; none without files.
    ///
    /// # Errors
    /// [`Error`] for a file that does not fit the molecules, or has fewer restraints than have to be satisfied.
    pub(crate) fn new(
        molecules: [&Molecule; 2],
        options: &RestraintOptions,
    ) -> Result<Self, Error> {
        let sources = [&options.interface_receptor, &options.interface_ligand];
        let mut predicted = [Vec::new(), Vec::new()];
        for (side, source) in sources.into_iter().enumerate() {
            if let Some(source) = source {
                let residues = source.residues(molecules[side]);
                predicted[side] = residues.map_err(|error| {
                    error.within(format!("of the {}", ["receptor", "ligand"][side]))
                })?;
            }
        }
        let membrane = options.membrane.map(|choice| choice.of(molecules));
        let membrane = membrane.transpose()?;
        let Some(file) = &options.restraints else {
            return Ok(Self {
                predicted,
                membrane,
                ..Self::default()
            });
        };
        let FileRestraints {
            list,
            within_one_molecule,
        } = file.between(molecules, options.crosslink, options.tbl_bounds)?;
        let (needed, count) = (options.restraints_need, list.len());
        let needed = needed.of(count).ok_or_else(|| {
            let message =
                format!("{needed} restraints have to be satisfied, and there are {count}");
            let remedy = format!("give --restraints-need a number up to {count}, or a share");
            Error::input(message).help(remedy)
        })?;
        let more = list.iter().map(|one| one.upper - one.written_upper);
        let widened = more.filter(|more| *more > 0.0);
        let least = widened.clone().reduce(f64::min);
        Ok(Self {
            widened: least.zip(widened.reduce(f64::max)).map(Into::into),
            within_one_molecule,
            distances: DistanceRestraints {
                list: list.iter().map(|restraint| restraint.distance()).collect(),
                needed,
            },
            names: list.into_iter().map(|restraint| restraint.name).collect(),
            predicted,
            membrane,
        })
    }

    /// Whether there are no restraints.
    pub fn is_empty(&self) -> bool {
        self.distances.list.is_empty()
    }

    /// Effective distance of each restraint at a pose in Å, with whether it is satisfied. Positions are those of all
    /// atoms of receptor and ligand, each in its own file.
    pub fn at(
        &self,
        [receptor, ligand]: [&[[f64; 3]]; 2],
        pose: &Pose,
    ) -> impl Iterator<Item = (f64, bool)> {
        self.distances.list.iter().map(move |restraint| {
            let distance = restraint.effective_distance(receptor, ligand, pose);
            (distance, restraint.violation(distance) == 0.0)
        })
    }
}
