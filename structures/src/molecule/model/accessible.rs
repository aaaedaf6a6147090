//! Solvent-accessible surface area of each atom (Lee & Richards, J. Mol. Biol. 55 (1971) 379-400), by counting points
//! on the atoms' expanded spheres that no other sphere covers (Shrake & Rupley, J. Mol. Biol. 79 (1973) 351-371).

use crate::molecule::model::atom::squared_distance;
use crate::molecule::model::molecule::Molecule;
use crate::neighbours::SpatialHash;

/// Radius of the water probe, in Å.
pub const PROBE: f64 = 1.4;

impl Molecule {
    /// Accessible area of each atom in Å^2, from `points` points a sphere (a spiral of Fibonacci); 200 give a total
    /// within about 1%. O(atoms x points x neighbours).
    pub fn accessible_areas(&self, points: usize) -> Vec<f64> {
        let sphere = spiral(points.max(1));
        let grown: Vec<f64> = self.atoms.iter().map(|atom| atom.radius + PROBE).collect();
        let reach = 2.0 * grown.iter().copied().fold(0.0, f64::max);
        let cells = SpatialHash::of_points(self.atoms.iter().map(|atom| atom.position), reach);
        let mut near: Vec<usize> = Vec::new();
        self.atoms
            .iter()
            .zip(&grown)
            .enumerate()
            .map(|(index, (atom, &radius))| {
                near.clear();
                near.extend(cells.around(atom.position).copied().filter(|&other| {
                    let touch = radius + grown[other];
                    let at = self.atoms[other].position;
                    other != index && squared_distance(atom.position, at) < touch * touch
                }));
                let free = sphere.iter().filter(|direction| {
                    let point =
                        std::array::from_fn(|axis| atom.position[axis] + radius * direction[axis]);
                    near.iter().all(|&other| {
                        squared_distance(point, self.atoms[other].position)
                            >= grown[other] * grown[other]
                    })
                });
                let share = free.count() as f64 / sphere.len() as f64;
                4.0 * std::f64::consts::PI * radius * radius * share
            })
            .collect()
    }
}

/// Directions spread evenly over the sphere.
fn spiral(count: usize) -> Vec<[f64; 3]> {
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
    use crate::molecule::model::atom::Atom;
    use crate::molecule::model::format::Format;
    use std::f64::consts::PI;

    fn balls(places: &[([f64; 3], f64)]) -> Molecule {
        let atoms = places.iter().map(|&(position, radius)| Atom {
            name: "C".to_owned(),
            residue_name: "LIG".to_owned(),
            chain: String::new(),
            residue_number: 1,
            insertion_code: None,
            alternate_location: None,
            element: "C".to_owned(),
            position,
            occupancy: 1.0,
            b_factor: 0.0,
            hetero: true,
            radius,
            line: 1,
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
        // A sphere inside another has none, one that coincides shows all or nothing of itself.
        let inside = balls(&[([0.0; 3], 1.0), ([0.1, 0.0, 0.0], 3.0)]).accessible_areas(100);
        assert_eq!(inside[0], 0.0);
    }
}
