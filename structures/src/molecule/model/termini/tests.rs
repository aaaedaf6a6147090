//! Tests of residues near termini.

use super::*;
use crate::molecule::model::format::Format;
use crate::molecule::model::groups::residue_runs;
use crate::test_support::{capped, example, without};

/// The places of the residues near ends, all of whose atoms must be there.
fn near(molecule: &Molecule) -> Vec<usize> {
    let ends = molecule.termini();
    let mut near = Vec::new();
    for (place, run) in residue_runs(&molecule.atoms).iter().enumerate() {
        let there = run.atoms.iter().filter(|atom| ends.atoms.contains(atom));
        match there.count() {
            0 => {}
            count if count == run.atoms.len() => near.push(place),
            count => panic!("{count} atoms of residue {place}"),
        }
    }
    assert_eq!(near.len(), ends.residues);
    near
}

/// Trypsin is long enough for eight residues at each end; of the inhibitor's 29 one is near each.
#[test]
fn a_short_chain_has_fewer() {
    let trypsin = near(&example("receptor"));
    assert_eq!(trypsin, (0..8).chain(215..223).collect::<Vec<_>>());
    assert_eq!(near(&example("ligand")), [0, 28]);
}

#[test]
fn both_sides_of_a_gap_count() {
    let broken = near(&without(&example("receptor"), 100..110).0);
    // Of 213 residues.
    let expected = (0..8).chain(92..108).chain(205..213);
    assert_eq!(broken, expected.collect::<Vec<_>>());
}

#[test]
fn an_end_that_something_is_bonded_to_is_none() {
    let capped = capped(example("receptor"));
    assert_eq!(near(&capped), (0..8).collect::<Vec<_>>());
}

#[test]
fn no_chains_have_no_ends() {
    let nothing = Molecule::new(Vec::new(), Format::Pdb);
    assert_eq!(nothing.termini(), Termini::default());
    let (peptide, _) = without(&example("receptor"), 19..223);
    assert_eq!(near(&peptide), [0usize; 0]);
}
