//! Places of the two bodies of a pair, and the box.

use nalgebra::{UnitQuaternion, Vector3};

/// Where the two bodies lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub receptor_center: Vector3<f64>,
    pub ligand_center: Vector3<f64>,
    /// Half the box, Å.
    pub half: Vector3<f64>,
}

impl Frame {
    /// The ligand's centre relative to the receptor's, Å; `None` outside the box.
    pub fn position(
        &self,
        rotation: &UnitQuaternion<f64>,
        translation: &Vector3<f64>,
    ) -> Option<Vector3<f64>> {
        let position = rotation * self.ligand_center + translation - self.receptor_center;
        (0..3)
            .all(|axis| position[axis].abs() <= self.half[axis])
            .then_some(position)
    }
}
