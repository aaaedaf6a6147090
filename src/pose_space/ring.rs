//! Rings of copies: their score by the fast path and its ascent, about any axis (Cn) or about axes across a ring's
//! own (Dn).

use super::refine::{AscentLimits, maximize};
use knotdock_scoring::exact::PoseGradient;
use knotdock_scoring::exact_sum::ExactSum;
use knotdock_scoring::potential_grid::PotentialGrid;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::symmetry::{RingAxis, Symmetry, conjugated, conjugated_gradient};
use nalgebra::Vector3;

/// Maximizes the score of a ring from `start`, which must be a ring's pose. Returned are the best pose and its score.
///
/// The score is the fast path's for each pair of neighbours, that of copies beyond them included. With an axis only
/// moves are made that keep it crossed (Dn).
pub(super) fn maximum(
    (symmetry, axis): (Symmetry, Option<&RingAxis>),
    field: &PotentialGrid,
    center: Vector3<f64>,
    start: Pose,
    limits: &AscentLimits,
) -> (Pose, f64) {
    maximize(
        start,
        center,
        limits,
        |pose| {
            let (score, gradient) = whole(symmetry, field, center, pose);
            match axis {
                Some(axis) => (score, axis.along(center, &gradient)),
                None => (score, gradient),
            }
        },
        |pose, rotation, shift| match axis {
            Some(axis) => axis.moved(pose, rotation, shift),
            None => conjugated(pose, center, rotation, shift),
        },
    )
}

/// Score of a ring for each pair of neighbours, with its gradient by moves of the molecule under the axis.
fn whole(
    symmetry: Symmetry,
    field: &PotentialGrid,
    center: Vector3<f64>,
    pose: &Pose,
) -> (f64, PoseGradient) {
    let of = |pose: &Pose| {
        let (score, gradient) = field.gradient(pose);
        (score, conjugated_gradient(pose, center, &gradient))
    };
    symmetry
        .beyond(pose)
        .fold(of(pose), |(score, gradient), (other, pairs)| {
            let (more, slope) = of(&other);
            let gradient = PoseGradient {
                force: gradient.force + pairs * slope.force,
                torque: gradient.torque + pairs * slope.torque,
            };
            (score + pairs * more, gradient)
        })
}

/// Exact score between copies that are no neighbours, for each pair of neighbours; `None` where all are.
pub(super) fn other_copies(symmetry: Symmetry, scorer: &ExactSum, pose: &Pose) -> Option<f64> {
    let score = |(pose, pairs): (Pose, f64)| pairs * scorer.score_only(&pose);
    symmetry
        .has_beyond()
        .then(|| symmetry.beyond(pose).map(score).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dock::plan::plan;
    use crate::options::DockOptions;
    use crate::pose_space::PoseSpace;
    use crate::pose_space::refine::RefinedPose;
    use crate::priors::residue_roles::tests::peptide;
    use crate::progress::NoProgress;
    use crate::search::scan::scan;
    use crate::search::scan_engine::ScanEngine;
    use knotdock_scoring::Precision;
    use knotdock_scoring::engine::{Plan, ReceptorSpectra, choose_rank};
    use knotdock_scoring::quantity::Quantity;
    use knotdock_structures::Knots;
    use knotdock_structures::molecule::{Format, Molecule};
    use nalgebra::{Unit, UnitQuaternion};
    use std::f64::consts::PI;

    /// Four copies so near the axis that those across it interact. The gradient agrees with moves of the molecule by
    /// the exact sum over all pairs. An ascent ends higher, on a ring.
    #[test]
    fn copies_across_the_axis_are_maximized_with_the_rest() {
        let centers = vec![
            [0.0, 0.0, 0.0],
            [2.6, 0.4, 1.1],
            [-1.9, 2.2, -0.7],
            [0.8, -2.5, 2.0],
        ];
        let knots = Knots::new(centers, vec![1.7, 1.8, 1.9, 1.7]).unwrap();
        let engine = DockOptions::default().kernel.engine();
        let plan = Plan::new(&knots, &knots, engine).unwrap();
        let spectra =
            ReceptorSpectra::new(&plan, &knots, &knots, Quantity::Score, Precision::Double);
        let field = PotentialGrid::new(&plan, &spectra, &knots);
        let scorer = ExactSum::of(&plan, &knots, &knots).unwrap();
        let exact = |symmetry: Symmetry, pose: &Pose| {
            scorer.score_only(pose) + other_copies(symmetry, &scorer, pose).unwrap_or(0.0)
        };
        let symmetry: Symmetry = "C4".parse().unwrap();
        let axis = Unit::new_normalize(Vector3::new(0.4, -0.3, 0.9));
        let rotation = symmetry.rotation(&axis);
        let point = 3.4 * axis.cross(&Vector3::x()).normalize();
        let start = Pose {
            rotation,
            translation: point - rotation * point,
        };
        assert!(other_copies(symmetry, &scorer, &start).unwrap().abs() > 1.0);
        assert_eq!(other_copies("C3".parse().unwrap(), &scorer, &start), None);

        let center = plan.ligand_center();
        let (_, gradient) = whole(symmetry, &field, center, &start);
        let step = 1e-3;
        let slope = |turn: Vector3<f64>, shift: Vector3<f64>| {
            let at = |sign: f64| {
                let turn = UnitQuaternion::new(sign * turn);
                exact(symmetry, &conjugated(&start, center, turn, sign * shift))
            };
            (at(1.0) - at(-1.0)) / (2.0 * step)
        };
        for axis in 0..3 {
            let unit = Vector3::ith(axis, step);
            let (shifted, turned) = (slope(Vector3::zeros(), unit), slope(unit, Vector3::zeros()));
            let near = |a: f64, b: f64, whole: f64| (a - b).abs() < 0.02 * whole;
            assert!(near(gradient.force[axis], shifted, gradient.force.norm()));
            assert!(near(gradient.torque[axis], turned, gradient.torque.norm()));
        }

        let limits = AscentLimits {
            evaluations: 40,
            distance: 3.0,
            angle: 0.3,
            gyration: 3.0,
            angstrom: 1.0,
        };
        let space = PoseSpace::Cyclic(symmetry);
        let RefinedPose {
            pose: top, score, ..
        } = space.refined(&field, center, (&start, 0.0), &limits);
        assert!(symmetry.ring(&top).is_some());
        assert!(exact(symmetry, &top) > exact(symmetry, &start) + 1.0);
        assert!((score - exact(symmetry, &top)).abs() < 0.02 * score.abs());
    }

    fn turn(angle: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle)
    }

    /// A ring of two strands.
    fn two_strands() -> Molecule {
        let strand = |chain: &str, angle: f64| {
            let tilt = UnitQuaternion::new(Vector3::new(0.2, -0.5, 0.3));
            let place = |x| turn(angle) * (tilt * x + Vector3::new(2.0, 6.0, 1.0));
            let mut strand = peptide(4.0).map_positions(|x| place(Vector3::from(x)).into());
            strand
                .atoms
                .iter_mut()
                .for_each(|atom| atom.chain = chain.to_owned());
            strand.atoms
        };
        let atoms = [strand("A", 0.0), strand("B", PI)].concat();
        let ring = Molecule::new(atoms, Format::Pdb);
        // Off the file's origin.
        ring.map_positions(|[x, y, z]| [x + 30.0, y - 20.0, z + 9.0])
    }

    /// Two rings of two strands: the grid's peaks lie by half turns across the ring's axis. The ascent from one ends
    /// at a maximum of the exact sum, by rotation about that axis and by shift along it.
    #[test]
    fn of_two_rings_peaks_are_dihedral_and_ascents_end_on_maxima() {
        let ring = two_strands();
        let options = DockOptions::default().changed(|options| {
            options.search.symmetry = Some("D2".parse().unwrap());
            options.search.rotations = 12;
            options.machine.threads = 1.into();
        });
        let plan = plan(&ring, &ring, &options).unwrap();
        let space = plan.search.space;
        let spectra = ReceptorSpectra::new(
            &plan.search.engine,
            &plan.receptor,
            &plan.ligand,
            Quantity::Score,
            Precision::Single,
        );
        let search = &plan.search;
        let chosen = choose_rank(
            &search.engine,
            &spectra,
            &plan.ligand,
            &search.rotations.coarse,
        );
        let engine = ScanEngine::new(search, chosen.engine).unwrap();
        let groups = search.rotations.groups();
        let peaks = scan(search, &engine, &groups, 20, None, &NoProgress)
            .unwrap()
            .peaks;
        assert_eq!(peaks.len(), 20);
        let center = search.engine.ligand_center();
        let starts: Vec<Pose> = peaks
            .iter()
            .map(|peak| {
                let place =
                    search.engine.receptor_center() + engine.cpu.position(peak.voxel as usize);
                Pose::about(
                    search.rotations.rotation(peak.rotation as usize).0,
                    center,
                    place,
                )
            })
            .collect();
        for start in &starts {
            let off = space.nearest(start).translation - start.translation;
            assert!(off.norm() < 1.8 * plan.spacing, "{off}");
        }

        let field = PotentialGrid::new(&plan.search.engine, &spectra, &plan.ligand);
        let scorer = plan.exact_scorer().unwrap();
        let limits = AscentLimits {
            evaluations: 60,
            distance: 6.0,
            angle: 0.5,
            gyration: 8.0,
            angstrom: 1.0,
        };
        let top = space
            .refined(&field, center, (&starts[4], 0.0), &limits)
            .pose;
        let highest = scorer.score_only(&top);
        assert!(highest > scorer.score_only(&space.nearest(&starts[4])) + 1.0);
        for sign in [-1.0, 1.0] {
            let aside = [(sign * 0.05, 0.0), (0.0, sign * 0.3)];
            for (turned, shifted) in aside {
                let shift = Vector3::new(0.0, 0.0, shifted);
                let moved = space.axis().unwrap().moved(&top, turn(turned), shift);
                assert!(scorer.score_only(&moved) < highest, "{turned} {shifted}");
            }
        }
    }
}
