//! Bounds for heavy atoms in place of bounds for all atoms.
//!
//! HADDOCK and CNS sum d^-6 over hydrogens, too, which are not read here. So the effective distance of heavy atoms is
//! longer than theirs, and their bounds have to be widened.
//!
//! # Derivation
//!
//! Proteins have as many hydrogens as heavy atoms. Give each heavy atom one, at a distance b that is the length of its
//! bond, in any direction. Two heavy atoms D apart then stand for four pairs. With β = b / D and x = 2β the means of
//! (d / D)^-6 over all directions are
//!
//! | pair | mean |
//! |---|---|
//! | heavy, heavy | 1 |
//! | heavy, hydrogen | (1 + β²) / (1 - β²)^4 |
//! | hydrogen, hydrogen | (1 - x²/2 + x⁴/6) / (1 - x²)³ |
//!
//! The sum of the four, F(D), is the factor of a sum of d^-6 by the hydrogens. It falls from 7.2 at contact to 4 far
//! away: the effective distance falls by F^(1/6), which is 1.39 to 1.26. So a bound u for all atoms is the bound
//! U = u F(D)^(1/6) for heavy atoms.
//!
//! D is the distance of the pairs that decide, which is about the effective distance U itself, but not less than that
//! of atoms in contact. A bound of 2 Å becomes 2.78 Å, and one of 5 Å 6.46 Å.
//!
//! If the selection of one side leaves out the hydrogens, as `name CA` does, F is the sum of the first two.
//!
//! This is an estimate, since hydrogens have directions. In 13 complexes of Docking Benchmark 5 with RDKit's hydrogens,
//! a residue of the interface and all those across are 0.8 ± 0.2 Å farther apart by heavy atoms near a bound of 2 Å.
//! All atoms satisfy 444 of 580 such restraints, heavy atoms 437 with the widened bound and 56 without.

/// Length of a bond of carbon and hydrogen, in Å.
const BOND: f64 = 1.09;
/// Distance in Å of two carbons in contact: those that carry hydrogens have radii of 1.76 and 1.88 Å.
const CONTACT: f64 = 3.7;

/// The upper bound (Å) of the effective distance of heavy atoms for one of all atoms. `sides` is how many of the two
/// selections have hydrogens that count, 0 to 2.
pub(super) fn widened(upper: f64, sides: usize) -> f64 {
    let at = |distance: f64| upper * factor(distance.max(CONTACT), sides).powf(1.0 / 6.0);
    // `at` falls with the distance, so that it meets the distance once.
    let (mut low, mut high) = (upper, at(upper));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if middle < at(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// What hydrogens on one or both of two heavy atoms at a distance (Å) multiply d^-6 by.
fn factor(distance: f64, sides: usize) -> f64 {
    let square = (BOND / distance).powi(2);
    let one = (1.0 + square) / (1.0 - square).powi(4);
    let x = 4.0 * square;
    let both = (1.0 - x / 2.0 + x * x / 6.0) / (1.0 - x).powi(3);
    match sides {
        0 => 1.0,
        1 => 1.0 + one,
        _ => 1.0 + 2.0 * one + both,
    }
}

/// Names that the hydrogens of a heavy atom may have: of `CB` `HB`, `HB1` and so on, of `N` also `HN`.
pub(super) fn hydrogen_names(heavy: &str) -> Vec<String> {
    let place: String = heavy.chars().skip(1).collect();
    let mut names = vec![format!("H{place}")];
    names.extend((1..=3).map(|number| format!("H{place}{number}")));
    if heavy == "N" {
        names.push("HN".to_owned());
    }
    names
}

#[cfg(test)]
mod tests;
