//! What fuzzing found, each with its story. No mutated input has made a reader panic; promises were broken otherwise.

use knotdock_scoring::terms::effect::contact::Potential;
use knotdock_scoring::terms::pose::{AtomPairPotential, DistanceBinnedPotential};

/// The first runs on tables of potentials accepted too many inputs. Whatever followed the last row, a copied line or
/// a cut-off second table, was never read. So a table joined to another by mistake was half used without a warning.
#[test]
fn rows_after_a_table_are_refused() {
    let coarse = include_str!("../../scoring/src/terms/effect/contact_potential.csv");
    assert!(Potential::parse(coarse).is_ok());
    let again = coarse.lines().next_back().unwrap();
    let refused = Potential::parse(&format!("{coarse}{again}\n")).unwrap_err();
    assert_eq!(refused.line(), Some(coarse.lines().count() as u64 + 1));
    let fine = include_str!("../../scoring/src/terms/pose/fine_contact_potential.csv");
    assert!(DistanceBinnedPotential::parse(fine).is_ok());
    let again = fine.lines().next_back().unwrap();
    assert!(DistanceBinnedPotential::parse(&format!("{fine}{again}\n")).is_err());
    assert!(
        DistanceBinnedPotential::parse(&format!("{fine}\n\n")).is_ok(),
        "blank lines may follow"
    );
    let pairs = include_str!("../../scoring/src/terms/pose/atom_pair_potential.csv");
    assert!(AtomPairPotential::parse(pairs).is_ok());
    let again = pairs.lines().next_back().unwrap();
    assert!(AtomPairPotential::parse(&format!("{pairs}{again}\n")).is_err());
}
