//! The complexes that are written of some rows of a run: refined, or as they were searched.

use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;

use crate::options::DockOptions;
use crate::output::run_folder::Bodies;
use crate::output::tables::fields::Column;
use crate::output::tables::poses::PoseRow;
use crate::output::tables::quality::OF_COMPLEXES;
use crate::pose_space::arrangement::Arrangement;
use crate::refine::{RefineOptions, Refined, Refiner};

/// The complexes of some rows. Rings and solids have none: they are written as they were searched.
#[derive(Clone, Debug, Default)]
pub struct TopComplexes {
    /// The poses, refined or as they were searched, with their energies.
    poses: Vec<Refined>,
    is_raw: bool,
}

impl TopComplexes {
    /// The complexes of all these rows.
    pub fn new(bodies: Bodies, rows: &[PoseRow], options: &DockOptions) -> Result<Self, Error> {
        let is_ring = Arrangement::from(options.search.symmetry).is_ring();
        let molecules = match bodies {
            Bodies::Molecules(molecules) if !is_ring && !rows.is_empty() => molecules,
            _ => return Ok(Self::default()),
        };
        let (is_raw, ph) = (options.output.raw, options.terms.ph);
        let refining = match is_raw {
            true => RefineOptions::none(ph),
            false => RefineOptions::usual(ph),
        };
        let poses: Vec<Pose> = rows.iter().map(|row| row.pose).collect();
        let poses = Refiner::new(molecules, refining)?.all(&poses)?;
        Ok(Self { poses, is_raw })
    }

    /// The refined poses of the rows; none if these are written as they were searched.
    pub fn refined(&self) -> &[Refined] {
        match self.is_raw {
            true => &[],
            false => &self.poses,
        }
    }

    /// The first column of [`OF_COMPLEXES`].
    pub fn clashes(&self) -> Option<Column> {
        let clashes = self.poses.iter().map(|pose| pose.after.clashes.to_string());
        (!self.poses.is_empty()).then(|| Column {
            name: OF_COMPLEXES[0].to_owned(),
            fields: clashes.collect(),
        })
    }
}
