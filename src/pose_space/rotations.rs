//! The rotations that a search samples, in groups that share a transform of the ligand.

use knotdock_scoring::grid_turn::GridTurn;
use nalgebra::UnitQuaternion;

/// Rotations of a search: a set, and a finer one for a second search about the best rotations.
///
/// Rotations of the finer set are numbered after those of the first.
#[derive(Clone, Debug)]
pub struct RotationSample {
    /// The set.
    pub coarse: Vec<UnitQuaternion<f64>>,
    /// The finer set; empty without a finer search.
    pub fine: Vec<UnitQuaternion<f64>>,
    /// Rotations in a row that differ by turns of the grid, and share a transform of the ligand: eight, four or one.
    pub images: usize,
    /// Name of the set.
    pub name: &'static str,
    /// Largest angle in radians from any rotation (of rings: axis) to the nearest of the set.
    pub covering_radius: f64,
}

/// Rotations that differ by turns of the grid, so that one transform of the ligand serves them all.
#[derive(Clone, Copy, Debug)]
pub struct RotationGroup {
    /// Index of the first.
    pub first: usize,
    /// Whether each of its images is searched.
    pub wanted: [bool; GridTurn::ALL.len()],
}

impl RotationGroup {
    /// The images that are searched, by their place in the group.
    pub fn images(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.wanted.len()).filter(|&image| self.wanted[image])
    }

    /// Number of rotations that are searched.
    pub fn count(&self) -> usize {
        self.images().count()
    }
}

impl RotationSample {
    /// A rotation by its index, with its turn from the first of its group.
    pub fn rotation(&self, index: usize) -> (UnitQuaternion<f64>, GridTurn) {
        let (set, index) = match index.checked_sub(self.coarse.len()) {
            None => (&self.coarse, index),
            Some(fine) => (&self.fine, fine),
        };
        (set[index], GridTurn::ALL[index % self.images])
    }

    /// All groups of the coarse set.
    pub fn groups(&self) -> Vec<RotationGroup> {
        self.groups_of((0, self.coarse.len()), |_| true)
    }

    /// Groups of the finer set, less the rotations that `is_wanted` (by their place in the finer set) leaves out.
    pub fn fine_groups(&self, is_wanted: impl Fn(usize) -> bool) -> Vec<RotationGroup> {
        self.groups_of((self.coarse.len(), self.fine.len()), is_wanted)
    }

    /// Groups of the `count` rotations from index `start` on.
    fn groups_of(
        &self,
        (start, count): (usize, usize),
        is_wanted: impl Fn(usize) -> bool,
    ) -> Vec<RotationGroup> {
        let group = |first: usize| RotationGroup {
            first: start + first,
            wanted: std::array::from_fn(|image| {
                image < self.images && first + image < count && is_wanted(first + image)
            }),
        };
        let groups = (0..count).step_by(self.images).map(group);
        groups.filter(|group| group.count() > 0).collect()
    }
}
