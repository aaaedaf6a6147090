//! Effect `electrostatics`: Coulomb energy of two sets of charges with a distance-dependent dielectric, smoothed at
//! short range.
//!
//! E = sum_ij 332.0637 q_i q_j / (eps(s) s) kcal/mol with s = (d^2 + 2^2)^(1/2) in Å. The smoothing keeps charges
//! that overlap in a rigid docking finite, and k even and smooth in d. The dielectric is the sigmoid of Mehler &
//! Solmajer (Protein Eng. 4 (1991) 903-910), which AutoDock uses. It is eps(s) = A + B / (1 + k exp(-l B s)) with A =
//! -8.5525, B = 78.4 - A, k = 7.7839 and l = 0.003627 per Å. With this screening little is left beyond 8 Å. k falls
//! to 0 from 6 to 12 Å with all derivatives continuous.

use super::{Effect, EffectDefinition, Label, RadialFunction, Term};
use crate::kernel::smooth_step_down;
use knotdock_structures::Knots;

/// Definition of the effect.
pub(super) const EFFECT: EffectDefinition = EffectDefinition {
    id: "electrostatics",
    of_meshes: "meshes carry no charges",
    components: 2.0,
    lacks: |inputs| {
        let uncharged = inputs.sides().find(|(_, labels)| labels.charged == 0);
        uncharged.map(|(side, _)| format!("no atom of the {side} carries a charge"))
    },
    reason: |_| "both sides carry charges".to_owned(),
    term: |[receptor, ligand], _, weight| Some(term(receptor, ligand, weight)),
};

/// Coulomb's constant in kcal Å / (mol e^2).
const COULOMB: f64 = 332.0637;
/// Smoothing length in Å.
const SMOOTHING: f64 = 2.0;
/// Distances in Å at which the taper begins and ends.
const TAPER: [f64; 2] = [6.0, 12.0];

/// Radial function: energy of two unit charges in kcal/mol.
pub const RADIAL: RadialFunction = RadialFunction {
    value: energy,
    support: TAPER[1],
};

/// Dielectric of Mehler and Solmajer at a distance in Å.
fn dielectric(distance: f64) -> f64 {
    let low = -8.5525;
    let rise = 78.4 - low;
    low + rise / (1.0 + 7.7839 * (-0.003627 * rise * distance).exp())
}

fn energy(distance: f64) -> f64 {
    let smoothed = distance.hypot(SMOOTHING);
    COULOMB / (dielectric(smoothed) * smoothed) * smooth_step_down(distance, TAPER[0], TAPER[1])
}

/// Term of two sets of knots with charges: minus `weight` (score per kcal/mol) times the energy.
pub fn term(receptor: &Knots, ligand: &Knots, weight: f64) -> Term {
    let labels = |knots: &Knots| {
        (0..knots.len())
            .map(|index| Label {
                class: 0,
                value: knots.charges.get(index).copied().unwrap_or(0.0)
                    * knots.weights.get(index).copied().unwrap_or(0.0),
            })
            .collect()
    };
    Term {
        effect: Effect::Electrostatics,
        radial: RADIAL,
        matrix: vec![vec![-weight]],
        receptor: labels(receptor),
        ligand: labels(ligand),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distances in Å with their dielectrics.
    const DIELECTRIC: [(f64, f64); 6] = [
        (2.5, 10.607665703223),
        (4.0, 18.581066853769),
        (6.0, 31.457431586060),
        (8.0, 44.976333835785),
        (12.0, 65.333405071482),
        (20.0, 77.183718199702),
    ];

    /// Distances in Å with the energies of two unit charges, kcal/mol.
    const ENERGY: [(f64, f64); 4] = [
        (0.0, 19.869675837503),
        (3.0, 5.645031590875),
        (5.0, 2.257540055030),
        (9.0, 0.343250780475),
    ];

    #[test]
    fn the_dielectric_goes_from_that_of_contact_to_that_of_water() {
        assert!((dielectric(0.0) - 1.3465).abs() < 1e-3);
        assert!((dielectric(1e3) - 78.4).abs() < 1e-9);
        assert_eq!(energy(12.0), 0.0);
    }

    /// Coulomb's law at the smoothed distance (d^2 + 4)^(1/2), halfway down the taper at 9 Å: in 50-digit decimal
    /// arithmetic.
    #[test]
    fn the_energy_is_that_of_smoothed_charges() {
        for (distance, expected) in ENERGY {
            let found = energy(distance);
            assert!(
                (found - expected).abs() < 1e-9 * expected,
                "{distance}: {found}"
            );
        }
    }

    /// Between contact and water the dielectric is a sigmoid of Mehler & Solmajer: it solves d eps/ds = l (eps - A)
    /// (A + B - eps).
    ///
    /// The values are those of their equation in 50-digit decimal arithmetic.
    #[test]
    fn the_dielectric_is_the_published_sigmoid_at_distances_of_contacts() {
        for (distance, expected) in DIELECTRIC {
            let found = dielectric(distance);
            assert!((found - expected).abs() < 1e-9, "{distance}: {found}");
            let step = 1e-4;
            let slope = (dielectric(distance + step) - dielectric(distance - step)) / (2.0 * step);
            let logistic = 0.003627 * (found + 8.5525) * (78.4 - found);
            assert!(
                (slope - logistic).abs() < 1e-6,
                "{distance}: {slope} {logistic}"
            );
        }
    }
}
