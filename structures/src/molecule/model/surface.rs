//! Solvent-accessible surface area of each atom (Lee & Richards, J. Mol. Biol. 55 (1971) 379-400), by counting points
//! on the atoms' expanded spheres that no other sphere covers (Shrake & Rupley, J. Mol. Biol. 79 (1973) 351-371).

use crate::molecule::model::{Atom, Molecule};
use crate::neighbours::SpatialHash;
use crate::vector::{along, squared_distance};
use std::collections::HashSet;

/// Radius of the water probe, in Å.
pub const PROBE: f64 = 1.4;

/// Atoms about one that are all looked at: protein has about 750 in 27 cells, hydrogens included. Of more, an even
/// selection of this many is tried first, which nearly always covers a point.
const CROWD: usize = 2048;

impl Molecule {
    /// Accessible area of each atom in Å^2, from `points` points on each sphere ([`spiral`]); 200 give a total within
    /// about 1%. Among atoms with one position and one radius the first has the area of all. O(atoms x points x
    /// neighbours).
    pub fn accessible_areas(&self, points: usize) -> Vec<f64> {
        let sphere = spiral(points.max(1));
        let grown: Vec<f64> = self.atoms.iter().map(|atom| atom.radius + PROBE).collect();
        let reach = 2.0 * grown.iter().copied().fold(0.0, f64::max);
        let mut cells = SpatialHash::new(reach);
        let distinct = self.distinct();
        for &index in &distinct {
            cells.push(self.atoms[index].position, index);
        }
        let mut near: Vec<usize> = Vec::new();
        let mut areas = vec![0.0; self.atoms.len()];
        for &index in &distinct {
            let (center, radius) = (self.atoms[index].position, grown[index]);
            let others = || cells.around(center).filter(|&&other| other != index);
            let is_within = |point: [f64; 3], other: usize, reach: f64| {
                squared_distance(point, self.atoms[other].position) < reach * reach
            };
            let step = cells.around(center).count().div_ceil(CROWD);
            let some = cells.around(center).step_by(step);
            let touches = |&&other: &&usize| {
                other != index && is_within(center, other, radius + grown[other])
            };
            near.clear();
            near.extend(some.filter(touches));
            let is_free = |direction: &&[f64; 3]| {
                let point = along(center, radius, **direction);
                let covers = |&other: &usize| is_within(point, other, grown[other]);
                !near.iter().any(covers) && (step == 1 || !others().any(covers))
            };
            let free = sphere.iter().filter(is_free).count();
            let share = free as f64 / sphere.len() as f64;
            areas[index] = 4.0 * std::f64::consts::PI * radius * radius * share;
        }
        areas
    }

    /// Accessible area in Å^2 that this molecule and `other`, in one frame, take from each other: of this one, and of
    /// the other. The same `points` on each sphere are used alone and together, so that only those near the interface
    /// count.
    pub fn buried_areas(&self, other: &Molecule, points: usize) -> [f64; 2] {
        let radii = self.atoms.iter().chain(&other.atoms);
        let largest = radii.map(|atom| atom.radius + PROBE).fold(0.0, f64::max);
        // Atoms within two radii of the other side can lose area, and that much farther are those beside them.
        let [first, second] =
            [(self, other), (other, self)].map(|(one, other)| one.near(other, 4.0 * largest));
        let atoms = first.atoms.iter().chain(&second.atoms).cloned().collect();
        let together = Molecule::new(atoms, self.format).accessible_areas(points);
        let (one, two) = together.split_at(first.atoms.len().min(together.len()));
        let lost = |alone: Vec<f64>, together: &[f64]| -> f64 {
            alone.iter().zip(together).map(|(a, b)| a - b).sum()
        };
        [
            lost(first.accessible_areas(points), one),
            lost(second.accessible_areas(points), two),
        ]
    }

    /// The atoms within `reach` Å of any of another molecule, in one frame.
    pub fn near(&self, other: &Molecule, reach: f64) -> Molecule {
        let mut cells = SpatialHash::new(reach);
        for atom in &other.atoms {
            cells.push(atom.position, atom.position);
        }
        let is_near = |atom: &&Atom| {
            let mut around = cells.around(atom.position);
            around.any(|&at| squared_distance(at, atom.position) <= reach * reach)
        };
        let atoms = self.atoms.iter().filter(is_near).cloned();
        Molecule::new(atoms.collect(), self.format)
    }

    /// The atoms but for those that have the position and the radius of an earlier one.
    fn distinct(&self) -> Vec<usize> {
        let mut seen = HashSet::with_capacity(self.atoms.len());
        let bits = |atom: &Atom| {
            let [x, y, z] = atom.position;
            [x, y, z, atom.radius].map(|value| (value + 0.0).to_bits())
        };
        (0..self.atoms.len())
            .filter(|&index| seen.insert(bits(&self.atoms[index])))
            .collect()
    }
}

/// Directions spread evenly over the sphere: a spiral of Fibonacci, of `count` > 0 unit vectors.
pub fn spiral(count: usize) -> Vec<[f64; 3]> {
    let golden = std::f64::consts::PI * (1.0 + 5f64.sqrt());
    (0..count)
        .map(|k| {
            let height = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
            let side = (1.0 - height * height).sqrt();
            let turn = golden * (k as f64 + 0.5);
            [side * turn.cos(), side * turn.sin(), height]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::model::Format;
    use std::f64::consts::PI;

    fn balls(places: &[([f64; 3], f64)]) -> Molecule {
        let atoms = places.iter().map(|&(position, radius)| Atom {
            element: "C".to_owned(),
            position,
            radius,
            ..Atom::default()
        });
        Molecule::new(atoms.collect(), Format::Pdb)
    }

    /// Closed forms: a lone sphere, and two that cut a cap of height h off each other (2 pi R h).
    #[test]
    fn spheres_and_caps() {
        let lone = balls(&[([1e6, 0.0, 0.0], 1.6)]).accessible_areas(100);
        assert!((lone[0] - 4.0 * PI * 9.0).abs() < 1e-9);
        let areas = balls(&[([0.0; 3], 1.6), ([3.0, 0.0, 0.0], 2.1)]).accessible_areas(20_000);
        for (area, [own, other]) in areas.iter().zip([[3.0, 3.5], [3.5, 3.0f64]]) {
            // The plane of the cut lies at x from the own centre.
            let x = (9.0 + own * own - other * other) / 6.0;
            let exact = 4.0 * PI * own * own - 2.0 * PI * own * (own - x);
            assert!((area - exact).abs() < 2e-3 * exact, "{area} {exact}");
        }
        // A sphere inside another has none.
        let inside = balls(&[([0.0; 3], 1.0), ([0.1, 0.0, 0.0], 3.0)]).accessible_areas(100);
        assert_eq!(inside[0], 0.0);
    }

    /// Coincident atoms made `inspect` quadratic: 100,000 took over an hour, for each looked at all others for each of
    /// its points. Crowded ones, which differ, have the area of one sphere all together.
    #[test]
    fn coincident_and_crowded_atoms_take_no_longer_than_others() {
        let exact = 4.0 * PI * 9.0;
        let coincident = balls(&[([0.0; 3], 1.6); 200_000]).accessible_areas(100);
        assert_eq!(coincident.iter().sum::<f64>(), coincident[0]);
        assert!((coincident[0] - exact).abs() < 1e-9);
        let within = |step: f64, i: usize| 1e-3 * (step * i as f64).sin();
        let crowd = (0..20_000).map(|i| ([within(1.3, i), within(2.1, i), within(0.7, i)], 1.6));
        let crowd: Vec<_> = crowd.collect();
        let area: f64 = balls(&crowd).accessible_areas(100).iter().sum();
        assert!((area - exact).abs() < 0.1 * exact, "{area}");
    }

    /// A crowd has the same area as by every pair, point by point.
    #[test]
    fn a_crowd_has_the_area_that_every_pair_gives() {
        let place = |step: f64, i: usize| 6.0 * (step * i as f64).sin();
        let list = (0..4000).map(|i| ([place(1.3, i), place(2.1, i), place(0.7, i)], 1.6));
        let list: Vec<_> = list.collect();
        let found = balls(&list).accessible_areas(50);
        let sphere = spiral(50);
        for (index, (center, radius)) in list.iter().enumerate().step_by(97) {
            let grown = radius + PROBE;
            let free = sphere.iter().filter(|direction| {
                let point = std::array::from_fn(|axis| center[axis] + grown * direction[axis]);
                let mut others = list.iter().enumerate();
                !others.any(|(other, (at, _))| {
                    other != index && squared_distance(point, *at) < grown * grown
                })
            });
            let share = free.count() as f64 / 50.0;
            assert!((found[index] - 4.0 * PI * grown * grown * share).abs() < 1e-9);
        }
    }

    /// Atoms that are far from the other side lose nothing: without them the area is the same, to the last bit.
    #[test]
    fn buried_areas_are_those_of_whole_molecules() {
        let place = |step: f64, i: usize| 40.0 * (step * i as f64).sin();
        let side = |far: f64| {
            let place = |i: usize| [place(1.3, i) + far, place(2.1, i), place(0.7, i)];
            let list: Vec<_> = (0..3000)
                .map(|i| (place(i), 1.2 + 0.1 * (i % 8) as f64))
                .collect();
            balls(&list)
        };
        let (a, b) = (side(0.0), side(75.0));
        let both = Molecule::new([a.atoms.clone(), b.atoms.clone()].concat(), a.format);
        let together = both.accessible_areas(100);
        let lost = |one: &Molecule, from: usize| -> f64 {
            let alone = one.accessible_areas(100).into_iter();
            alone.zip(&together[from..]).map(|(a, b)| a - b).sum()
        };
        let buried = a.buried_areas(&b, 100);
        assert_eq!(buried, [lost(&a, 0), lost(&b, 3000)]);
        assert!(buried[0] > 100.0 && a.near(&b, 10.0).atoms.len() < 1000);
    }

    /// Closed form: two expanded spheres cut caps of height h off each other (2 pi R h); far ones take nothing.
    #[test]
    fn two_balls_bury_caps() {
        let ball = |x: f64, radius: f64| balls(&[([x, 0.0, 0.0], radius)]);
        let (a, b) = (ball(0.0, 1.6), ball(4.0, 2.1));
        let buried = a.buried_areas(&b, 20_000);
        for (area, [own, other]) in buried.into_iter().zip([[1.6, 2.1], [2.1, 1.6]]) {
            let (own, other) = (own + PROBE, other + PROBE);
            let plane = (16.0 + own * own - other * other) / 8.0;
            let exact = 2.0 * PI * own * (own - plane);
            assert!((area - exact).abs() < 5e-3 * exact, "{area} {exact}");
        }
        assert_eq!(a.buried_areas(&ball(7.0, 2.1), 200), [0.0, 0.0]);
    }
}
