//! Electrostatics: the Coulomb energy of two sets of charges with a distance-dependent dielectric, smoothed at short range.
//!
//! E = sum_ij 332.0637 q_i q_j / (eps(s) s) kcal/mol, s = (d^2 + 2^2)^(1/2) in Å, which keeps charges that overlap in a rigid docking
//! finite and k even and smooth in d. The dielectric is the sigmoid of Mehler & Solmajer, Protein Eng. 4 (1991) 903-910 (AutoDock's),
//! eps(s) = A + B / (1 + k exp(-l B s)) with A = -8.5525, B = 78.4 - A, k = 7.7839, l = 0.003627 per Å: about 10 at 2.5 Å and 45 at 8 Å.
//! Screened so, little is left beyond 8 Å; k falls C-infinity to 0 from 6 to 12 Å.

use super::{Effect, Label, RadialFunction, Term};
use crate::kernel::low_pass::smooth_step_down;
use knotdock_structures::Knots;

/// Coulomb's constant in kcal Å / (mol e^2).
const COULOMB: f64 = 332.0637;
/// Smoothing length in Å.
const SMOOTHING: f64 = 2.0;
/// Where the taper begins and ends, Å.
const TAPER: [f64; 2] = [6.0, 12.0];

/// The energy of two unit charges, kcal/mol.
pub const RADIAL: RadialFunction = RadialFunction {
    value: energy,
    support: TAPER[1],
};

/// Mehler and Solmajer's dielectric at a distance in Å.
fn dielectric(distance: f64) -> f64 {
    let low = -8.5525;
    let rise = 78.4 - low;
    low + rise / (1.0 + 7.7839 * (-0.003627 * rise * distance).exp())
}

fn energy(distance: f64) -> f64 {
    let smoothed = distance.hypot(SMOOTHING);
    COULOMB / (dielectric(smoothed) * smoothed) * smooth_step_down(distance, TAPER[0], TAPER[1])
}

/// The term for two sets of knots with charges: `weight` times minus the energy in kcal/mol.
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

    #[test]
    fn the_dielectric_goes_from_that_of_contact_to_that_of_water() {
        assert!((dielectric(0.0) - 1.3465).abs() < 1e-3);
        assert!((dielectric(1e3) - 78.4).abs() < 1e-9);
        // Over its whole range: AutoGrid's formula (distdepdiel.cpp) with its constants, evaluated in Python.
        let published = [
            (1.0, 4.467335),
            (2.0, 8.356042),
            (3.0, 13.066582),
            (4.0, 18.581067),
            (5.0, 24.784426),
            (6.0, 31.457432),
            (7.0, 38.298952),
            (8.0, 44.976334),
            (10.0, 56.712334),
            (12.0, 65.333405),
            (15.0, 72.813441),
            (20.0, 77.183718),
            (30.0, 78.347371),
        ];
        for (distance, value) in published {
            let ours = dielectric(distance);
            assert!((ours - value).abs() < 1e-6, "{distance} Å: {ours}");
        }
        // Half-way between its limits at ln k / (l B), where the slope is l B^2 / 4.
        let (rise, middle) = (86.9525f64, 7.7839f64.ln() / (0.003627 * 86.9525));
        assert!((dielectric(middle) - (-8.5525 + 0.5 * rise)).abs() < 1e-12);
        let slope = (dielectric(middle + 1e-4) - dielectric(middle - 1e-4)) / 2e-4;
        assert!((slope - 0.25 * 0.003627 * rise * rise).abs() < 1e-6);
        // Without smoothing and taper it would be Coulomb's law: at 5 Å both are slight.
        let plain = COULOMB / (dielectric(5.0) * 5.0);
        assert!(energy(5.0) < plain && energy(5.0) > 0.75 * plain);
        assert_eq!(energy(12.0), 0.0);
    }
}
