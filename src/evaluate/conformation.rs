//! Superposition of another conformation of a molecule on the first: an NMR model, a snapshot, a crystal with a partner bound.

use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;

use super::chain_choice::ChainChoice;
use super::matching::placements::{Placement, placements};
use super::matching::superposition::MAX_FIT_RMSD;
use super::residues::Residues;

/// Least share of the smaller molecule's residues that two conformations of one molecule have in common.
const MIN_SHARE: f64 = 0.5;
/// Placements that fit worse than the best by less than this (Å RMSD) fit as well: of two equal chains either may be
/// the first.
const ALIKE: f64 = 1.0;

/// Superposition of a conformation on the first one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Superposed {
    /// From the frame of its file to that of the first one's.
    pub motion: Pose,
    /// RMSD in Å of the backbone atoms that both have, after the motion.
    pub rmsd: f64,
    /// Residues that both have.
    pub matched: usize,
}

/// Superposes a conformation on the first one by their backbones. Residues are matched by chain, number and sequence, as
/// with a known complex; names of chains decide if equal chains can be matched in several ways that fit alike.
///
/// # Errors
/// [`Error`] if a molecule has no residues to compare, less than half of the residues are the same, or the shapes differ
/// by more than a change of conformation.
pub fn superpose(conformation: &Molecule, first: &Molecule) -> Result<Superposed, Error> {
    let moved = Residues::of(conformation, "conformation")?;
    let fixed = Residues::of(first, "first conformation")?;
    let mut found = placements(&moved, &fixed, &ChainChoice::default());
    let most = found.iter().map(Placement::matched).max().unwrap_or(0);
    let residues = moved.residues.len().min(fixed.residues.len());
    if most == 0 || (most as f64) < MIN_SHARE * residues as f64 {
        return Err(not_alike(format!(
            "this is another molecule than the first of its side: {most} of {residues} residues are the same, and \
             half are needed"
        )));
    }
    found.retain(|placement| placement.matched() as f64 >= 0.9 * most as f64);
    let rmsds = found.iter().map(|placement| placement.rmsd);
    let least = rmsds.fold(f64::INFINITY, f64::min);
    found.retain(|placement| placement.rmsd <= least + ALIKE);
    let same_named = |placement: &Placement| placement.same_named(&moved, &fixed);
    found.sort_by(|a, b| {
        let names = same_named(b).cmp(&same_named(a));
        names.then(a.rmsd.total_cmp(&b.rmsd))
    });
    let best = found.swap_remove(0);
    if best.rmsd > MAX_FIT_RMSD {
        return Err(not_alike(format!(
            "this does not fit on the first molecule of its side: the backbones are {:.1} Å RMSD apart, and \
             {MAX_FIT_RMSD:.0} Å is the most",
            best.rmsd
        )));
    }
    Ok(Superposed {
        motion: best.motion,
        rmsd: best.rmsd,
        matched: best.matched(),
    })
}

/// Two molecules that are no conformations of one.
fn not_alike(message: String) -> Error {
    Error::input(message).help(
        "give conformations of one molecule, with the same chains (FILE:A,B picks them); dock other molecules with \
         `knotdock batch`",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::test_molecules::{chain_of, molecule, moved, numbers, random_sequence};
    use knotdock_structures::molecule::Atom;

    fn pose() -> Pose {
        Pose::from_parts([0.7, -0.3, 0.5, 0.4], [12.0, -30.0, 5.0])
    }

    fn two_chains(names: [&str; 2]) -> Vec<Atom> {
        let letters = random_sequence(7, 40);
        let chain = |name| chain_of(name, &letters, &numbers(1, 40));
        let aside = Pose::from_parts([0.9, 0.0, 0.4, 0.1], [18.0, 2.0, 0.0]);
        [chain(names[0]), moved(&chain(names[1]), &aside)].concat()
    }

    /// The motion is undone whatever the names; chains that are the same molecule keep their names.
    #[test]
    fn a_moved_molecule_is_moved_back() {
        let first = two_chains(["A", "B"]);
        for names in [["A", "B"], ["H", "L"], ["B", "A"]] {
            let other = molecule(moved(&two_chains(names), &pose()));
            let found = superpose(&other, &molecule(first.clone())).unwrap();
            let back = found.motion.after(&pose());
            assert!(found.rmsd < 1e-6 && found.matched == 80);
            assert!(back.angle_to(&Pose::identity()) < 1e-6);
            assert!(back.translation.norm() < 1e-4);
        }
    }

    #[test]
    fn other_molecules_are_refused() {
        let one = chain_of("A", &random_sequence(1, 60), &numbers(1, 60));
        let other = chain_of("A", &random_sequence(2, 60), &numbers(1, 60));
        let refused = superpose(&molecule(other), &molecule(one)).unwrap_err();
        assert!(refused.message().contains("another molecule"), "{refused}");
    }
}
