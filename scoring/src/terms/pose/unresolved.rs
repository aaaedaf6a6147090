//! Pose term `unresolved`: clashes with unresolved segments, which cost.
//!
//! The positions of unresolved residues are not known. So each atom of the other side is charged by the share of the
//! loop conformers of a segment that pass within 5 Å. The term can only cost: free space where residues may be says
//! nothing in favour of a pose. For that reason unresolved residues are no part of shape, where their skins would
//! earn.

use super::bodies::Side;
use super::{PoseTerm, TermDefinition, UNRELAXED};
use crate::blocks::NearPoints;
use crate::rigid_move::center;
use crate::se3::Pose;
use knotdock_structures::{Conformers, Knots};
use nalgebra::{Matrix3, Vector3};

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "unresolved",
    label: "unresolved residues",
    unit: "score",
    time_share: UNRELAXED,
    is_shown_always: true,
    reads: "segments",
    count: |inputs| inputs.unresolved.map(<[_]>::len),
    applies: |inputs| inputs.unresolved.iter().any(|side| !side.is_empty()),
    build: |inputs, weight| term(inputs.bodies, inputs.unresolved, weight),
};

/// Distance in Å from a residue's CA within which an atom clashes with the residue.
///
/// It is 3.2 Å, the radius of a ball of a residue's volume, and 1.8 Å, the radius of an atom. The mean volume is 134
/// Å³ (over proteins, by the volumes of Zamyatnin, Prog. Biophys. Mol. Biol. 24 (1972) 107-123).
const REACH: f64 = 5.0;

/// The atoms of one side, in cells and by index, relative to their centre.
struct Body {
    side: Side,
    center: [f64; 3],
    atoms: Vec<Vector3<f64>>,
}

/// Number of conformers of a segment within [`REACH`] of the centre of each cell, in a grid of 1 Å about the segment.
struct Occupancy {
    /// Frame of the segment, without conformers.
    frame: Conformers,
    /// Corner of the first cell in that frame (Å).
    low: [f64; 3],
    /// Number of cells along each axis.
    counts: [usize; 3],
    /// Conformers by cell, row-major.
    passing: Vec<u16>,
    /// Share of one conformer: 1 over their number.
    share: f64,
    /// Centre of the grid in the file's frame (Å).
    center: [f64; 3],
    /// Radius in Å about the centre that contains every occupied cell.
    radius: f64,
}

/// Minus the weight times the clashes of both sides; each atom counts by its share of the conformers of each segment
/// of the other side.
fn term(bodies: [&Knots; 2], segments: [&[Conformers]; 2], weight: f64) -> PoseTerm {
    let of_side = |side: &[Conformers]| side.iter().map(Occupancy::new).collect::<Vec<_>>();
    let segments = segments.map(of_side);
    let [receptor, ligand] = bodies.map(Body::new);
    Box::new(move |pose, _| {
        let inverse = pose.inverse();
        let clashes = clashes(&ligand, &segments[0], pose, &inverse)
            + clashes(&receptor, &segments[1], &inverse, pose);
        // Without clashes the score is 0, not -0.
        0.0 - weight * clashes
    })
}

impl Body {
    fn new(knots: &Knots) -> Self {
        let center = center(knots);
        let atoms = knots.centers.iter().map(|x| Vector3::from(*x) - center);
        Self {
            side: Side::new(knots),
            atoms: atoms.collect(),
            center: center.into(),
        }
    }
}

/// Sum over atoms of a body and segments of the other side of the share of conformers within reach.
///
/// `pose` carries the body into the frame of the segments, and `inverse` carries them into its own.
fn clashes(body: &Body, segments: &[Occupancy], pose: &Pose, inverse: &Pose) -> f64 {
    let mut sum = 0.0;
    let mut near = NearPoints::default();
    for segment in segments {
        let (rotation, translation) = segment.cells_from(pose, body.center);
        body.side
            .near(inverse, segment.center, segment.radius, &mut near, |atom| {
                sum += segment.share(rotation * body.atoms[atom] + translation);
            });
    }
    sum
}

impl Occupancy {
    fn new(segment: &Conformers) -> Self {
        let alphas = || segment.traces.iter().flatten();
        let end = |pick: fn(f64, f64) -> f64, start: f64| {
            alphas().fold([start; 3], |end, alpha| {
                std::array::from_fn(|axis| pick(end[axis], alpha[axis]))
            })
        };
        let (first, last) = (
            end(f64::min, f64::INFINITY),
            end(f64::max, f64::NEG_INFINITY),
        );
        let low = first.map(|x| x - REACH);
        let counts: [usize; 3] =
            std::array::from_fn(|axis| (last[axis] + REACH - low[axis]).ceil() as usize);
        let center: [f64; 3] = std::array::from_fn(|axis| 0.5 * counts[axis] as f64 + low[axis]);
        let from_center = |alpha: &[f64; 3]| (Vector3::from(*alpha) - Vector3::from(center)).norm();
        let mut occupancy = Self {
            frame: Conformers {
                traces: Vec::new(),
                ..*segment
            },
            low,
            counts,
            passing: vec![0; counts.iter().product()],
            share: 1.0 / segment.traces.len() as f64,
            center: segment.in_file(center),
            // An occupied cell reaches up to half its diagonal farther than its centre.
            radius: alphas().map(from_center).fold(0.0, f64::max) + REACH + 1.0,
        };
        occupancy.fill(&segment.traces);
        occupancy
    }

    /// Counts for each cell the conformers within reach, each once.
    fn fill(&mut self, conformers: &[Vec<[f64; 3]>]) {
        let mut last_counted = vec![0; self.passing.len()];
        for (conformer, alphas) in (1..).zip(conformers) {
            for alpha in alphas {
                let at: [f64; 3] = std::array::from_fn(|axis| alpha[axis] - self.low[axis]);
                let range = |axis: usize| {
                    let from = (at[axis] - REACH).floor().max(0.0) as usize;
                    let to = (at[axis] + REACH).ceil() as usize;
                    from..to.min(self.counts[axis])
                };
                let square = |axis: usize, cell: usize| (cell as f64 + 0.5 - at[axis]).powi(2);
                for x in range(0) {
                    for y in range(1) {
                        let beside = square(0, x) + square(1, y);
                        for z in range(2) {
                            let cell = (x * self.counts[1] + y) * self.counts[2] + z;
                            let within = beside + square(2, z) < REACH * REACH;
                            if within && last_counted[cell] != conformer {
                                last_counted[cell] = conformer;
                                self.passing[cell] += 1;
                            }
                        }
                    }
                }
            }
        }
    }

    /// Rotation and translation that carry a body, relative to its centre, with a pose into units of cells.
    fn cells_from(&self, pose: &Pose, center: [f64; 3]) -> (Matrix3<f64>, Vector3<f64>) {
        let axes = Matrix3::from_fn(|row, column| self.frame.axes[row][column]);
        let center = Vector3::from(self.frame.local(pose.apply(center)));
        let rotation = pose.rotation.to_rotation_matrix().into_inner();
        (axes * rotation, center - Vector3::from(self.low))
    }

    /// Share of the conformers within reach of a point in units of cells.
    fn share(&self, point: Vector3<f64>) -> f64 {
        let mut cell = 0;
        for axis in 0..3 {
            // NaN lies in no cell.
            if !(point[axis] >= 0.0 && point[axis] < self.counts[axis] as f64) {
                return 0.0;
            }
            cell = cell * self.counts[axis] + point[axis] as usize;
        }
        f64::from(self.passing[cell]) * self.share
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::pose::Workspace;
    use std::slice::from_ref;

    const TURNED: [[f64; 3]; 3] = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];

    fn segment(traces: Vec<Vec<[f64; 3]>>) -> Conformers {
        Conformers {
            origin: [10.0, 20.0, 30.0],
            axes: TURNED,
            traces,
        }
    }

    /// An atom counts by the share of conformers within reach, however many residues of one are, on either side.
    #[test]
    fn atoms_count_by_the_share_of_conformers_within_reach() {
        // Two of three conformers run along the file's y axis, one of them twice, and the third lies elsewhere.
        let along = vec![[0.0; 3], [3.8, 0.0, 0.0], [0.5, 0.0, 0.0]];
        let one = segment(vec![
            along.clone(),
            along[..2].to_vec(),
            vec![[-8.0, 0.0, 0.0]],
        ]);
        let atoms = |y: &[f64]| {
            let centers: Vec<[f64; 3]> = y.iter().map(|y| [10.0, 20.0 + y, 30.0]).collect();
            Knots::new(centers.clone(), vec![1.9; centers.len()]).unwrap()
        };
        // Within reach of two; two; the third; all three; none.
        let places = [4.0, 8.0, -12.0, -4.0, 10.0];
        let (receptor, ligand) = (atoms(&[-30.0]), atoms(&places));
        let passing = |y: f64| -> f64 {
            let passed =
                |conformer: &Vec<[f64; 3]>| conformer.iter().any(|a| (a[0] - y).abs() < 5.0);
            one.traces
                .iter()
                .filter(|conformer| passed(conformer))
                .count() as f64
                / 3.0
        };
        assert!((places.map(passing).iter().sum::<f64>() - 8.0 / 3.0).abs() < 1e-12);
        let score = |bodies: [&Knots; 2], segments: [&[Conformers]; 2], pose: &Pose| {
            term(bodies, segments, 6.0)(pose, &mut Workspace::default())
        };
        let of_first = |pose: &Pose| score([&receptor, &ligand], [from_ref(&one), &[]], pose);
        let of_second = |pose: &Pose| score([&ligand, &receptor], [&[], from_ref(&one)], pose);
        for shift in [0.0, -8.0, 4.0, -300.0] {
            let [there, back] =
                [shift, -shift].map(|y| Pose::from_parts([1.0, 0.0, 0.0, 0.0], [0.0, y, 0.0]));
            let expected: f64 = places.map(|y| -6.0 * passing(y + shift)).iter().sum();
            assert!((of_first(&there) - expected).abs() < 1e-12);
            assert!((of_second(&back) - expected).abs() < 1e-12);
        }
        let far = Pose::from_parts([0.0, 0.0, 0.0, 1.0], [900.0, 0.0, 0.0]);
        assert!(of_first(&far) == 0.0 && of_first(&far).is_sign_positive());
    }

    /// Cells agree with distances to all residues, but for a shell of half a cell's diagonal about the reach.
    #[test]
    fn cells_agree_with_distances() {
        let conformer = |k: usize| -> Vec<[f64; 3]> {
            let x = |step: usize| [3.1, 1.7, 0.9][(k + step) % 3] * (step as f64 - 1.0);
            (0..6)
                .map(|step| [x(step), x(step + k), x(2 * step)])
                .collect()
        };
        let segment = segment((0..9).map(conformer).collect());
        let occupancy = Occupancy::new(&segment);
        let half = 0.5 * 3f64.sqrt();
        let share = |local: [f64; 3], reach: f64| {
            let near = |alpha: &[f64; 3]| {
                (0..3)
                    .map(|axis| (alpha[axis] - local[axis]).powi(2))
                    .sum::<f64>()
                    < reach * reach
            };
            let passing = segment
                .traces
                .iter()
                .filter(|conformer| conformer.iter().any(near));
            passing.count() as f64 / 9.0
        };
        for at in 0..9261 {
            let local = [at / 441, at / 21 % 21, at % 21].map(|x| 1.37 * f64::from(x) - 14.0);
            let cell = Vector3::from(local) - Vector3::from(occupancy.low);
            let found = occupancy.share(cell);
            let bounds = [share(local, REACH - half), share(local, REACH + half)];
            assert!(
                bounds[0] - 1e-12 <= found && found <= bounds[1] + 1e-12,
                "{local:?}"
            );
        }
    }
}
