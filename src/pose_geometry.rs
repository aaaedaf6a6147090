//! Geometry of a pose as two solids: surface that it buries, volume that it lets overlap.

use knotdock_scoring::se3::Pose;
use knotdock_structures::ball_union;
use knotdock_structures::knots::KnotsError;
use knotdock_structures::molecule::Molecule;
use serde::Serialize;

/// Points a sphere for areas: a buried area comes within about 1%.
pub const SURFACE_POINTS: usize = 960;

/// Areas and volumes of a placed pair, by the atoms' balls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PoseGeometry {
    /// Accessible area in Å^2 (probe of 1.4 Å) that the two bury, both sides together.
    pub buried_area: f64,
    /// The receptor's part of it.
    pub buried_area_receptor: f64,
    /// The ligand's part of it.
    pub buried_area_ligand: f64,
    /// Volume of the union of the receptor's balls, in Å^3.
    pub volume_receptor: f64,
    /// Volume of the union of the ligand's balls, in Å^3.
    pub volume_ligand: f64,
    /// Volume in both, in Å^3.
    pub volume_shared: f64,
    /// Bound of the error of each volume, in Å^3.
    pub volume_error: f64,
    /// Tanimoto similarity of the two solids: shared volume over that of both together.
    pub shape_tanimoto: f64,
    /// Share of the smaller solid outside the other.
    pub protrusion: f64,
}

impl PoseGeometry {
    /// Measures a pose.
    pub fn of(receptor: &Molecule, ligand: &Molecule, pose: &Pose) -> Result<Self, KnotsError> {
        let placed = ligand.map_positions(|x| pose.apply(x));
        let [receptor_area, ligand_area] = receptor.buried_areas(&placed, SURFACE_POINTS);
        let overlap = ball_union::overlap(&receptor.knots()?, &placed.knots()?);
        Ok(Self {
            buried_area: receptor_area + ligand_area,
            buried_area_receptor: receptor_area,
            buried_area_ligand: ligand_area,
            volume_receptor: overlap.first,
            volume_ligand: overlap.second,
            volume_shared: overlap.shared,
            volume_error: overlap.error,
            shape_tanimoto: overlap.tanimoto(),
            protrusion: overlap.protrusion(),
        })
    }
}
