//! Arrangements: the bodies of a run, as far as its options decide them.

use knotdock_scoring::se3::Pose;
use knotdock_scoring::symmetry::Symmetry;

/// Arrangement of the bodies of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrangement {
    /// A receptor and a ligand.
    Pair,
    /// Copies of one molecule in a ring (Cn), or two such rings (Dn).
    Ring(Symmetry),
}

impl From<Option<Symmetry>> for Arrangement {
    fn from(symmetry: Option<Symmetry>) -> Self {
        symmetry.map_or(Self::Pair, Self::Ring)
    }
}

impl Arrangement {
    /// Whether its bodies are copies of one molecule.
    pub fn is_ring(self) -> bool {
        matches!(self, Self::Ring(_))
    }

    /// Names of the molecules that are read.
    pub fn sides(self) -> &'static [&'static str] {
        match self {
            Self::Pair => &["receptor", "ligand"],
            Self::Ring(_) => &["molecule"],
        }
    }

    /// Number of bodies that are placed beside the receptor.
    pub fn placed(self) -> usize {
        match self {
            Self::Pair => 1,
            Self::Ring(symmetry) => symmetry.copies() - 1,
        }
    }

    /// Poses of the bodies that are placed beside the receptor, the row's own first; `None` if `pose` forms no ring.
    pub fn images(self, pose: &Pose) -> Option<Vec<Pose>> {
        match self {
            Self::Pair => Some(vec![*pose]),
            Self::Ring(symmetry) => symmetry.ring(pose).map(|ring| ring[1..].to_vec()),
        }
    }

    /// The body that a pose moves, as text calls it.
    pub fn moved(self) -> &'static str {
        match self {
            Self::Pair => "ligand",
            Self::Ring(symmetry) if symmetry.folds().is_some() => "ring",
            Self::Ring(_) => "copy",
        }
    }

    /// The symmetry's name after a word, such as ` of C3`; empty for a pair.
    pub fn suffix(self) -> String {
        match self {
            Self::Pair => String::new(),
            Self::Ring(symmetry) => format!(" of {symmetry}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_places_all_copies_but_the_receptor() {
        let ring = Arrangement::from(Some("C4".parse::<Symmetry>().unwrap()));
        let quarter = std::f64::consts::FRAC_PI_4;
        let pose = Pose::from_parts([quarter.cos(), 0.0, 0.0, quarter.sin()], [5.0, 5.0, 0.0]);
        let images = ring.images(&pose).unwrap();
        assert_eq!((ring.placed(), images.len()), (3, 3));
        assert!((images[0].translation - pose.translation).norm() < 1e-9);
        let sliding = Pose::from_parts(pose.quaternion(), [5.0, 5.0, 3.0]);
        assert_eq!(ring.images(&sliding), None);
        assert_eq!(Arrangement::Pair.images(&sliding).unwrap().len(), 1);
    }
}
