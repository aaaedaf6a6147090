//! Shape complementarity Sc (Lawrence & Colman, J. Mol. Biol. 234 (1993) 946-950): 1 where surfaces match, about 0.7 in most
//! interfaces of proteins.
//!
//! Both molecular surfaces are made alone. The part of each that the other keeps from the probe counts, but for a band of
//! 1.5 Å about its rim. At a dot the surfaces match by -(n . n') exp(-0.5 d^2), in which d is the distance to the nearest
//! dot of the other side and n, n' are the outward normals of both. Sc is the mean of both sides' medians. Radii of atoms are
//! those of this program, which differ a little from the authors'.

use knotdock_structures::molecule::Molecule;
use knotdock_structures::neighbours::{CellList, Member};
use nalgebra::Vector3;

use super::surface_dots::{Sphere, SurfaceDot, surface_dots};

/// Radius of the probe, in Å.
const PROBE: f64 = 1.7;
/// Dots to an Å^2.
const DENSITY: f64 = 15.0;
/// Width of the rim that is left out, in Å.
const BAND: f64 = 1.5;
/// Weight of the squared distance, in 1/Å^2.
const WEIGHT: f64 = 0.5;
/// Atoms farther than this from the other side have no effect, in Å.
const NEAR: f64 = 8.0;

/// Shape complementarity of two molecules in place; `None` if neither buries a part of the other.
pub fn shape_complementarity(molecules: [&Molecule; 2]) -> Option<f64> {
    let heavy = |molecule: &Molecule| -> Vec<(Vector3<f64>, f64)> {
        let atoms = molecule.atoms.iter().filter(|atom| !atom.is_hydrogen());
        let balls = atoms.map(|atom| (Vector3::from(atom.position), atom.radius));
        balls.collect()
    };
    let all = molecules.map(heavy);
    let balls = || all.iter().flatten();
    let count = balls().count().max(1) as f64;
    let middle = balls().map(|(center, _)| center).sum::<Vector3<f64>>() / count;
    // Dots are within NEAR of the other side. Balls that a probe touches with theirs are one step farther, and those that
    // keep it from there another one.
    let largest = balls().fold(0.0, |largest: f64, (_, radius)| largest.max(*radius));
    let reach = NEAR + 4.0 * (largest + PROBE);
    let [first, second] = molecules;
    let sides = [first.near(second, reach), second.near(first, reach)];
    let sides = sides
        .each_ref()
        .map(heavy)
        .map(|side| -> Vec<(Vector3<f64>, f64)> {
            let balls = side.into_iter();
            balls
                .map(|(center, radius)| (center - middle, radius))
                .collect()
        });
    of_balls([&sides[0], &sides[1]])
}

/// The shape complementarity of balls about the origin.
fn of_balls(sides: [&[(Vector3<f64>, f64)]; 2]) -> Option<f64> {
    let cells = sides.map(|side| {
        let members = side.iter().map(|&(center, radius)| Member {
            position: center.into(),
            item: radius,
        });
        CellList::new(members.collect(), NEAR)
    });
    let of_side = |side: usize| -> Vec<SurfaceDot> {
        let spheres = sides[side].iter().map(|&(center, radius)| {
            let mut has_dots = false;
            cells[1 - side].visit_within(center.into(), NEAR, |_, _| has_dots = true);
            Sphere {
                center,
                radius,
                has_dots,
            }
        });
        let dots = surface_dots(&spheres.collect::<Vec<_>>(), PROBE, DENSITY);
        without_rim(dots, &cells[1 - side])
    };
    let buried: [Vec<SurfaceDot>; 2] = rayon::join(|| of_side(0), || of_side(1)).into();
    let medians = [0, 1].map(|side| median(&buried[side], &buried[1 - side]));
    Some(0.5 * (medians[0]? + medians[1]?))
}

/// The dots whose probe would meet the other side, but for those near one whose would not.
fn without_rim(dots: Vec<SurfaceDot>, other: &CellList<f64>) -> Vec<SurfaceDot> {
    let is_buried = |dot: &SurfaceDot| {
        let probe = dot.at + dot.normal * PROBE;
        let mut is_buried = false;
        other.visit_within(probe.into(), NEAR, |&radius, square| {
            is_buried |= square < (radius + PROBE) * (radius + PROBE);
        });
        is_buried
    };
    let (buried, open): (Vec<SurfaceDot>, Vec<SurfaceDot>) = dots.into_iter().partition(is_buried);
    let open = cells_of(&open, BAND);
    let is_inner = |dot: &SurfaceDot| {
        let mut is_inner = true;
        open.visit_within(dot.at.into(), BAND, |_, _| is_inner = false);
        is_inner
    };
    buried.into_iter().filter(is_inner).collect()
}

fn cells_of(dots: &[SurfaceDot], edge: f64) -> CellList<Vector3<f64>> {
    let members = dots.iter().map(|dot| Member {
        position: dot.at.into(),
        item: dot.normal,
    });
    CellList::new(members.collect(), edge)
}

/// The median match of some dots with those of the other side; `None` if either has none.
fn median(dots: &[SurfaceDot], others: &[SurfaceDot]) -> Option<f64> {
    if others.is_empty() {
        return None;
    }
    let cells = cells_of(others, 1.0);
    let match_of = |dot: &SurfaceDot| {
        let mut reach = 1.0;
        loop {
            let mut nearest: Option<(f64, Vector3<f64>)> = None;
            cells.visit_within(dot.at.into(), reach, |&normal, square| {
                if nearest.is_none_or(|(least, _)| square < least) {
                    nearest = Some((square, normal));
                }
            });
            if let Some((square, normal)) = nearest {
                return -dot.normal.dot(&normal) * (-WEIGHT * square).exp();
            }
            reach *= 2.0;
        }
    };
    let mut matches: Vec<f64> = dots.iter().map(match_of).collect();
    matches.sort_by(f64::total_cmp);
    let half = matches.len() / 2;
    match matches.len() % 2 {
        _ if matches.is_empty() => None,
        1 => Some(matches[half]),
        _ => Some(0.5 * (matches[half - 1] + matches[half])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square sheet of balls at a height, so close that it is nearly flat.
    fn sheet(height: f64) -> Vec<(Vector3<f64>, f64)> {
        let places = (-7..=7).flat_map(|i| (-7..=7).map(move |j| (f64::from(i), f64::from(j))));
        places
            .map(|(i, j)| (Vector3::new(0.7 * i, 0.7 * j, height), 1.7))
            .collect()
    }

    /// Flat sheets a gap apart match by exp(-gap^2 / 2) everywhere, but for the remainders of their balls.
    #[test]
    fn flat_sheets_match_by_their_gap() {
        for gap in [0.0, 1.0] {
            let [one, other] = [sheet(0.0), sheet(3.4 + gap)];
            let found = of_balls([&one, &other]).unwrap();
            let expected = (-0.5 * gap * gap).exp();
            assert!((found - expected).abs() < 0.06, "{gap}: {found} {expected}");
            let turned = of_balls([&other, &one]).unwrap();
            assert!((found - turned).abs() < 1e-9);
        }
        assert_eq!(of_balls([&sheet(0.0), &sheet(20.0)]), None);
        assert_eq!(of_balls([&sheet(0.0), &[]]), None);
    }
}
