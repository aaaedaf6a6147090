//! Missing residues: what a pose costs in which atoms of one side lie where the other may have residues that its file does not show.
//!
//! Where they are is not known, so each atom counts by the share of the courses they may take that pass within its reach. They can only cost: that
//! a place is free where they may be says nothing good of a pose. So they have no part in shape, which would earn by their skins.

use super::side::Side;
use crate::exact::center;
use crate::se3::Pose;
use knotdock_structures::{Conformers, Knots};
use nalgebra::{Matrix3, Vector3};

/// Distance in Å from a residue's CA within which an atom lies where the residue is: radii of 3.2, that of a ball of a residue's volume of 134 Å³
/// (the mean over proteins of the volumes of Zamyatnin, Prog. Biophys. Mol. Biol. 24 (1972) 107-123), and 1.8.
const WITHIN: f64 = 5.0;

/// Where both sides' missing residues may be, and the atoms that should not lie there.
pub struct MissingContacts {
    /// Of receptor and ligand.
    stretches: [Vec<Occupancy>; 2],
    receptor: Body,
    ligand: Body,
    weight: f64,
}

/// The atoms of one side, by place and by number, these relative to their middle.
struct Body {
    side: Side,
    middle: [f64; 3],
    atoms: Vec<Vector3<f64>>,
}

/// Of every cell of 1 Å about a stretch how many of its courses pass within reach of the cell's middle.
struct Occupancy {
    /// Its frame, without courses.
    frame: Conformers,
    /// Corner of the first cell in that frame, and how many cells there are along each axis.
    low: [f64; 3],
    counts: [usize; 3],
    passing: Vec<u16>,
    /// What one course is of all.
    share: f64,
    /// Middle of all cells in the file's frame, and a radius about it within which are all that are passed (Å).
    middle: [f64; 3],
    radius: f64,
}

impl MissingContacts {
    /// Stretches of receptor and ligand; `weight` is what an atom costs that lies where all courses of one of the other side's pass.
    pub fn new(
        receptor: &Knots,
        ligand: &Knots,
        stretches: [&[Conformers]; 2],
        weight: f64,
    ) -> Self {
        Self {
            stretches: stretches.map(|side| side.iter().map(Occupancy::new).collect()),
            receptor: Body::new(receptor),
            ligand: Body::new(ligand),
            weight,
        }
    }

    /// Minus the weight times the atoms of both sides that lie where the other has residues, each by the share of a stretch's courses that pass it;
    /// shares of several stretches add up.
    pub fn score(&self, pose: &Pose) -> f64 {
        let [receptor, ligand] = &self.stretches;
        let inverse = pose.inverse();
        let atoms = inside(&self.ligand, receptor, pose, &inverse)
            + inside(&self.receptor, ligand, &inverse, pose);
        // Of none nothing, not minus nothing.
        0.0 - self.weight * atoms
    }
}

impl Body {
    fn new(knots: &Knots) -> Self {
        let middle = center(knots);
        let atoms = knots.centers.iter().map(|x| Vector3::from(*x) - middle);
        Self {
            side: Side::new(knots),
            atoms: atoms.collect(),
            middle: middle.into(),
        }
    }
}

/// How many atoms of a body lie where the other side's residues may be. `pose` carries the body into the frame of these, `back` them into its own.
fn inside(body: &Body, stretches: &[Occupancy], pose: &Pose, back: &Pose) -> f64 {
    let mut atoms = 0.0;
    for stretch in stretches {
        let (turn, shift) = stretch.cells_from(pose, body.middle);
        body.side
            .near(back, stretch.middle, stretch.radius, |atom| {
                atoms += stretch.share(turn * body.atoms[atom] + shift);
            });
    }
    atoms
}

impl Occupancy {
    fn new(stretch: &Conformers) -> Self {
        let alphas = || stretch.traces.iter().flatten();
        let end = |pick: fn(f64, f64) -> f64, start: f64| {
            alphas().fold([start; 3], |end, alpha| {
                std::array::from_fn(|axis| pick(end[axis], alpha[axis]))
            })
        };
        let (first, last) = (
            end(f64::min, f64::INFINITY),
            end(f64::max, f64::NEG_INFINITY),
        );
        let low = first.map(|x| x - WITHIN);
        let counts: [usize; 3] =
            std::array::from_fn(|axis| (last[axis] + WITHIN - low[axis]).ceil() as usize);
        let middle: [f64; 3] = std::array::from_fn(|axis| 0.5 * counts[axis] as f64 + low[axis]);
        let from_middle = |alpha: &[f64; 3]| (Vector3::from(*alpha) - Vector3::from(middle)).norm();
        let mut occupancy = Self {
            frame: Conformers {
                traces: Vec::new(),
                ..*stretch
            },
            low,
            counts,
            passing: vec![0; counts.iter().product()],
            share: 1.0 / stretch.traces.len() as f64,
            middle: stretch.in_file(middle),
            // A cell that is passed may hold an atom that is not.
            radius: alphas().map(from_middle).fold(0.0, f64::max) + WITHIN + 1.0,
        };
        occupancy.fill(&stretch.traces);
        occupancy
    }

    /// Counts for each cell the courses that pass it, each once.
    fn fill(&mut self, courses: &[Vec<[f64; 3]>]) {
        let mut passed = vec![0; self.passing.len()];
        for (course, alphas) in (1..).zip(courses) {
            for alpha in alphas {
                let at: [f64; 3] = std::array::from_fn(|axis| alpha[axis] - self.low[axis]);
                let range = |axis: usize| {
                    let from = (at[axis] - WITHIN).floor().max(0.0) as usize;
                    let to = (at[axis] + WITHIN).ceil() as usize;
                    from..to.min(self.counts[axis])
                };
                let square = |axis: usize, cell: usize| (cell as f64 + 0.5 - at[axis]).powi(2);
                for x in range(0) {
                    for y in range(1) {
                        let beside = square(0, x) + square(1, y);
                        for z in range(2) {
                            let cell = (x * self.counts[1] + y) * self.counts[2] + z;
                            if beside + square(2, z) < WITHIN * WITHIN && passed[cell] != course {
                                passed[cell] = course;
                                self.passing[cell] += 1;
                            }
                        }
                    }
                }
            }
        }
    }

    /// What carries a body, about its middle, with a pose into cells: a turn and then a shift.
    fn cells_from(&self, pose: &Pose, middle: [f64; 3]) -> (Matrix3<f64>, Vector3<f64>) {
        let axes = Matrix3::from_fn(|row, column| self.frame.axes[row][column]);
        let middle = Vector3::from(self.frame.local(pose.apply(middle)));
        let turn = pose.rotation.to_rotation_matrix().into_inner();
        (axes * turn, middle - Vector3::from(self.low))
    }

    /// The share of courses that pass within reach of a point, which is given in cells.
    fn share(&self, point: Vector3<f64>) -> f64 {
        let mut cell = 0;
        for axis in 0..3 {
            // What is no number lies in no cell.
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
    use std::slice;

    use super::*;

    const TURNED: [[f64; 3]; 3] = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];

    fn stretch(courses: Vec<Vec<[f64; 3]>>) -> Conformers {
        Conformers {
            origin: [10.0, 20.0, 30.0],
            axes: TURNED,
            traces: courses,
        }
    }

    /// Atoms count by the share of courses that pass them, however many residues of one do, and those of both sides count.
    #[test]
    fn atoms_count_by_the_share_of_courses_that_pass_them() {
        // Two of three courses pass along the file's y axis, one of these twice, and the third stays behind.
        let along = vec![[0.0; 3], [3.8, 0.0, 0.0], [0.5, 0.0, 0.0]];
        let one = stretch(vec![
            along.clone(),
            along[..2].to_vec(),
            vec![[-8.0, 0.0, 0.0]],
        ]);
        let atoms = |y: &[f64]| {
            let centers: Vec<[f64; 3]> = y.iter().map(|y| [10.0, 20.0 + y, 30.0]).collect();
            Knots::new(centers.clone(), vec![1.9; centers.len()]).unwrap()
        };
        // By two; by two; by the third; between, by all three; by none.
        let places = [4.0, 8.0, -12.0, -4.0, 10.0];
        let (receptor, ligand) = (atoms(&[-30.0]), atoms(&places));
        let passing = |y: f64| -> f64 {
            let passed = |course: &Vec<[f64; 3]>| course.iter().any(|a| (a[0] - y).abs() < 5.0);
            one.traces.iter().filter(|course| passed(course)).count() as f64 / 3.0
        };
        assert!((places.map(passing).iter().sum::<f64>() - 8.0 / 3.0).abs() < 1e-12);
        let missing = MissingContacts::new(&receptor, &ligand, [slice::from_ref(&one), &[]], 6.0);
        let swapped = MissingContacts::new(&ligand, &receptor, [&[], slice::from_ref(&one)], 6.0);
        for shift in [0.0, -8.0, 4.0, -300.0] {
            let [there, back] =
                [shift, -shift].map(|y| Pose::from_parts([1.0, 0.0, 0.0, 0.0], [0.0, y, 0.0]));
            let expected: f64 = places.map(|y| -6.0 * passing(y + shift)).iter().sum();
            assert!((missing.score(&there) - expected).abs() < 1e-12);
            assert!((swapped.score(&back) - expected).abs() < 1e-12);
        }
        let far = Pose::from_parts([0.0, 0.0, 0.0, 1.0], [900.0, 0.0, 0.0]);
        assert!(missing.score(&far) == 0.0 && missing.score(&far).is_sign_positive());
    }

    /// Cells tell what distances to all residues do, but for a shell of half a cell's diagonal about their reach.
    #[test]
    fn cells_tell_what_distances_do() {
        let course = |k: usize| -> Vec<[f64; 3]> {
            let x = |step: usize| [3.1, 1.7, 0.9][(k + step) % 3] * (step as f64 - 1.0);
            (0..6)
                .map(|step| [x(step), x(step + k), x(2 * step)])
                .collect()
        };
        let stretch = stretch((0..9).map(course).collect());
        let occupancy = Occupancy::new(&stretch);
        let half = 0.5 * 3f64.sqrt();
        let share = |local: [f64; 3], reach: f64| {
            let near = |alpha: &[f64; 3]| {
                (0..3)
                    .map(|axis| (alpha[axis] - local[axis]).powi(2))
                    .sum::<f64>()
                    < reach * reach
            };
            let passing = stretch
                .traces
                .iter()
                .filter(|course| course.iter().any(near));
            passing.count() as f64 / 9.0
        };
        for at in 0..9261 {
            let local = [at / 441, at / 21 % 21, at % 21].map(|x| 1.37 * f64::from(x) - 14.0);
            let cell = Vector3::from(local) - Vector3::from(occupancy.low);
            let told = occupancy.share(cell);
            let bounds = [share(local, WITHIN - half), share(local, WITHIN + half)];
            assert!(
                bounds[0] - 1e-12 <= told && told <= bounds[1] + 1e-12,
                "{local:?}"
            );
        }
    }
}
