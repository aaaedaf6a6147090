//! Pose term `restraints_penalty`: the cost of violated distance restraints.
//!
//! A restraint is on the effective distance of its pairs of atoms ([`super::effective_distance`]). It is satisfied
//! within its bounds, and otherwise violated by the distance to them. If some restraints may be false, only a number of
//! them has to be satisfied: those that are violated least count, and the others are free.
//!
//! The penalty grows in proportion to the violation. A pose of the search may be 2 to 4 Å from the nearest sampled
//! one, so that a penalty by squares would refuse poses for the coarseness of the search.

use super::{PoseTerm, TermDefinition, UNRELAXED};
use crate::se3::Pose;

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "restraints_penalty",
    label: "distance restraints",
    unit: "score per Å",
    time_share: UNRELAXED,
    is_shown_always: false,
    reads: "restraints",
    count: |inputs| [inputs.distance_restraints.list.len(); 2],
    applies: |inputs| !inputs.distance_restraints.list.is_empty(),
    build: |inputs, weight| {
        let positions = inputs.bodies.map(|knots| knots.centers.clone());
        term(inputs.distance_restraints.clone(), positions, weight)
    },
};

/// A restraint on the effective distance between atoms of the receptor and atoms of the ligand.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceRestraint {
    /// Alternatives, each as indices of atoms of receptor and ligand. Every atom of the one set pairs with every atom
    /// of the other. A pair of atoms that is in two alternatives counts twice.
    pub pairs: Vec<[Vec<usize>; 2]>,
    /// Smallest effective distance that satisfies it, in Å.
    pub lower: f64,
    /// Largest effective distance that satisfies it, in Å.
    pub upper: f64,
}

/// Restraints of which a number has to be satisfied.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DistanceRestraints {
    /// The restraints.
    pub list: Vec<DistanceRestraint>,
    /// How many of them; no more than there are.
    pub needed: usize,
}

impl DistanceRestraints {
    /// No restraints.
    pub fn none() -> &'static Self {
        static NONE: DistanceRestraints = DistanceRestraints {
            list: Vec::new(),
            needed: 0,
        };
        &NONE
    }
}

/// Minus the weight times the violations that count; `positions` of the atoms are those of each side's file (Å).
fn term(restraints: DistanceRestraints, positions: [Vec<[f64; 3]>; 2], weight: f64) -> PoseTerm {
    Box::new(move |pose, workspace| {
        let [receptor, ligand] = &positions;
        let violations = &mut workspace.violations;
        violations.clear();
        violations.extend(restraints.list.iter().map(|restraint| {
            restraint.violation(restraint.effective_distance(receptor, ligand, pose))
        }));
        violations.sort_unstable_by(f64::total_cmp);
        let counted = violations.iter().take(restraints.needed);
        // Without violations the score is 0, not -0.
        0.0 - weight * counted.sum::<f64>()
    })
}

impl DistanceRestraint {
    /// Effective distance (sum of d^-6)^(-1/6) at a pose, in Å: 0 where two atoms coincide, infinite without pairs.
    ///
    /// Positions (Å) are those of all atoms of the receptor and of the ligand, each in its own file. An index without
    /// a position is left out.
    pub fn effective_distance(
        &self,
        receptor_positions: &[[f64; 3]],
        ligand_positions: &[[f64; 3]],
        pose: &Pose,
    ) -> f64 {
        let of_pair = |[receptor, ligand]: &[Vec<usize>; 2]| -> f64 {
            let moved = ligand.iter().filter_map(|&atom| ligand_positions.get(atom));
            let moved = moved.map(|&position| pose.apply(position));
            let near = |place: [f64; 3]| -> f64 {
                let receptor = receptor.iter();
                let others = receptor.filter_map(|&atom| receptor_positions.get(atom));
                others.map(|&other| inverse_sixth(place, other)).sum()
            };
            moved.map(near).sum()
        };
        let sum: f64 = self.pairs.iter().map(of_pair).sum();
        sum.powf(-1.0 / 6.0)
    }

    /// Distance in Å by which an effective distance misses the bounds: 0 within them.
    pub fn violation(&self, effective_distance: f64) -> f64 {
        if effective_distance < self.lower {
            self.lower - effective_distance
        } else if effective_distance <= self.upper {
            0.0
        } else {
            effective_distance - self.upper
        }
    }
}

/// d^-6 of two points.
fn inverse_sixth(a: [f64; 3], b: [f64; 3]) -> f64 {
    let squared: f64 = (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum();
    squared.powi(3).recip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::pose::Workspace;

    /// Three restraints of 2 to 5 Å between single atoms.
    #[test]
    fn the_least_violations_count() {
        let restraint = |atom: usize| DistanceRestraint {
            pairs: vec![[vec![atom], vec![0]]],
            lower: 2.0,
            upper: 5.0,
        };
        let at = |needed: usize, x: f64| {
            let list = [2, 0, 1].map(restraint).to_vec();
            let receptor = vec![[0.0; 3], [0.0, 10.0, 0.0], [0.0, 20.0, 0.0]];
            let positions = [receptor, vec![[0.0; 3]]];
            let term = term(DistanceRestraints { list, needed }, positions, 2.0);
            let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
            term(&pose, &mut Workspace::default())
        };
        // At 0, 10 and 20 Å: 2 Å too near, 5 and 15 Å too far.
        for (needed, violation) in [(1, 2.0), (2, 7.0), (3, 22.0)] {
            assert!((at(needed, 0.0) + 2.0 * violation).abs() < 1e-12);
        }
        let satisfied = at(1, 3.0);
        assert!(satisfied == 0.0 && satisfied.is_sign_positive());
    }
}

#[cfg(test)]
mod effective_distance_tests {
    use super::*;

    fn restraint(pairs: &[[&[usize]; 2]]) -> DistanceRestraint {
        let pairs = pairs.iter();
        DistanceRestraint {
            pairs: pairs.map(|sides| sides.map(<[usize]>::to_vec)).collect(),
            lower: 2.0,
            upper: 8.0,
        }
    }

    /// The receptor's atoms at 3, 6 and -3 Å on x; the ligand's at the origin and far off.
    fn distance(pairs: &[[&[usize]; 2]], pose: &Pose) -> f64 {
        let receptor = [[3.0, 0.0, 0.0], [6.0, 0.0, 0.0], [-3.0, 0.0, 0.0]];
        let ligand = [[0.0; 3], [0.0, 1e5, 0.0]];
        restraint(pairs).effective_distance(&receptor, &ligand, pose)
    }

    fn assert_close(value: f64, expected: f64) {
        assert!((value / expected - 1.0).abs() < 1e-14, "{value} {expected}");
    }

    #[test]
    fn one_pair_gives_its_distance() {
        let still = Pose::identity();
        assert_close(distance(&[[&[0], &[0]]], &still), 3.0);
        assert_close(distance(&[[&[1], &[0]]], &still), 6.0);
    }

    #[test]
    fn equal_pairs_bring_it_down_by_the_sixth_root_of_their_number() {
        let still = Pose::identity();
        let expected = 3.0 * 2f64.powf(-1.0 / 6.0);
        assert_close(distance(&[[&[0, 2], &[0]]], &still), expected);
        // One set of two atoms, or two alternatives.
        let alternatives: [[&[usize]; 2]; 2] = [[&[0], &[0]], [&[2], &[0]]];
        assert_close(distance(&alternatives, &still), expected);
        let eight = vec![[&[0usize] as &[usize], &[0]]; 64];
        assert_close(distance(&eight, &still), 1.5);
    }

    /// 3^-6 + 6^-6 = 3^-6 (1 + 2^-6).
    #[test]
    fn unequal_pairs_add_their_inverse_sixth_powers() {
        let expected = 3.0 * (65.0 / 64.0f64).powf(-1.0 / 6.0);
        let still = Pose::identity();
        assert_close(distance(&[[&[0, 1], &[0]]], &still), expected);
        // What is far off hardly counts.
        let far: [[&[usize]; 2]; 1] = [[&[0, 1], &[0, 1]]];
        assert_close(distance(&far, &still), expected);
    }

    #[test]
    fn the_pose_moves_the_ligand() {
        let half = std::f64::consts::FRAC_PI_4;
        // A quarter turn about z brings the far atom from y to -x.
        let pose = Pose::from_parts([half.cos(), 0.0, 0.0, half.sin()], [1e5 - 1.0, 4.0, 0.0]);
        let value = distance(&[[&[0], &[1]]], &pose);
        assert!((value - 32f64.sqrt()).abs() < 1e-9, "{value}");
        let moved = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [3.0, 0.0, 0.0]);
        assert_eq!(distance(&[[&[0], &[0]]], &moved), 0.0);
    }

    #[test]
    fn without_pairs_it_is_infinite() {
        let still = Pose::identity();
        assert_eq!(distance(&[], &still), f64::INFINITY);
        assert_eq!(distance(&[[&[9], &[0]]], &still), f64::INFINITY);
    }

    #[test]
    fn violations_are_what_is_missing_to_the_bounds() {
        let restraint = restraint(&[]);
        for (distance, expected) in [(0.5, 1.5), (2.0, 0.0), (5.0, 0.0), (8.0, 0.0), (9.5, 1.5)] {
            assert_eq!(restraint.violation(distance), expected);
        }
        assert_eq!(restraint.violation(f64::INFINITY), f64::INFINITY);
        assert!(restraint.violation(f64::NAN).is_nan());
    }
}
