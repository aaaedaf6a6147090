//! The distance restraints of a docking.

use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::pose::DistanceRestraints;
use knotdock_structures::molecule::Molecule;

use crate::error::SearchError;
use crate::options::RestraintOptions;

/// The distance restraints of a docking, and how many of them a pose has to satisfy.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Restrained {
    /// Atoms, bounds, and how many have to be satisfied.
    pub distances: DistanceRestraints,
    /// Their names, in the same order.
    pub names: Vec<String>,
}

impl Restrained {
    /// The restraints of the options between receptor and ligand; none without a file.
    ///
    /// # Errors
    /// [`SearchError`] where the file does not fit the molecules, or has fewer restraints than have to be satisfied.
    pub(crate) fn new(
        molecules: [&Molecule; 2],
        options: &RestraintOptions,
    ) -> Result<Self, SearchError> {
        let Some(file) = &options.restraints else {
            return Ok(Self::default());
        };
        let list = file.between(molecules, options.crosslink)?;
        let (needed, count) = (options.restraints_need, list.len());
        let needed = needed
            .of(count)
            .ok_or(SearchError::RestraintsNeed { needed, count })?;
        Ok(Self {
            distances: DistanceRestraints {
                list: list.iter().map(|restraint| restraint.distance()).collect(),
                needed,
            },
            names: list.into_iter().map(|restraint| restraint.name).collect(),
        })
    }

    /// Whether there are none.
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
