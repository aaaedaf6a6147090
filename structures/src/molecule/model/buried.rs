//! Surface that two molecules bury in each other: accessible area alone less accessible area together.

use crate::molecule::model::molecule::Molecule;

impl Molecule {
    /// Accessible area in Å^2 that this molecule and `other`, where they stand, take from each other: of this one, and
    /// of the other. `points` a sphere as in [`Molecule::accessible_areas`]; the same points are used alone and
    /// together, so that only those near the interface count.
    pub fn buried_areas(&self, other: &Molecule, points: usize) -> [f64; 2] {
        let atoms = self.atoms.iter().chain(&other.atoms).cloned().collect();
        let together = Molecule::new(atoms, self.format).accessible_areas(points);
        let (first, second) = together.split_at(self.atoms.len().min(together.len()));
        let lost = |alone: Vec<f64>, together: &[f64]| -> f64 {
            alone.iter().zip(together).map(|(a, b)| a - b).sum()
        };
        [
            lost(self.accessible_areas(points), first),
            lost(other.accessible_areas(points), second),
        ]
    }
}

#[cfg(test)]
mod tests {
    use crate::molecule::model::accessible::PROBE;
    use crate::molecule::model::atom::Atom;
    use crate::molecule::model::format::Format;
    use crate::molecule::model::molecule::Molecule;
    use std::f64::consts::PI;

    fn ball(x: f64, radius: f64) -> Molecule {
        let atom = Atom {
            name: "C".to_owned(),
            residue_name: "LIG".to_owned(),
            chain: String::new(),
            residue_number: 1,
            insertion_code: None,
            alternate_location: None,
            element: "C".to_owned(),
            position: [x, 0.0, 0.0],
            occupancy: 1.0,
            b_factor: 0.0,
            hetero: true,
            radius,
            line: 1,
        };
        Molecule::new(vec![atom], Format::Pdb)
    }

    /// Closed form: two expanded spheres cut caps of height h off each other (2 pi R h); far ones take nothing.
    #[test]
    fn two_balls_bury_caps() {
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
