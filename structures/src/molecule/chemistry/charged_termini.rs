//! Termini of peptide chains, which are charged where nothing is bonded to them.
//!
//! A chain's termini are charged, the ends at a gap in it are not. Two peptide residues in a row belong to two chains
//! if C and N are farther than 2.5 Å from each other, in three cases:
//!
//! - the name of the chain changes;
//! - the first has its second carboxyl oxygen, and the gap in the numbering does not fit;
//! - there is no gap in the numbering.
//!
//! Else residues are unresolved between them, and the open ends stand for neutral bonds. Chain names alone do not
//! decide, since many files have chains merged.

use crate::molecule::chemistry::{CARBOXYL, Labels, TERMINI_PKA, amino_terminus};
use crate::molecule::model::{Atom, GroupKind, MAX_CAP_LENGTH, Molecule, Residue, ResidueKey};
use crate::neighbours::SpatialHash;
use crate::vector::squared_distance;

/// Longest C-N distance in Å of a peptide bond, with room for poor structures.
pub(crate) const BOND: f64 = 2.5;

/// An atom that may be bonded to the end of a chain.
struct Cap<'a> {
    position: [f64; 3],
    /// Of peptide residues the end, N or C, which takes the other of another residue; of all else none.
    end: Option<&'static str>,
    residue: ResidueKey<'a>,
}

pub(crate) struct Caps<'a> {
    atoms: Vec<Cap<'a>>,
    cells: SpatialHash<usize>,
}

impl Molecule {
    pub(crate) fn charge_termini(&self, groups: &[Residue<'_>], ph: f64, labels: &mut Labels) {
        let peptide = groups.iter().filter(|residue| residue.is_peptide());
        let peptide: Vec<&Residue<'_>> = peptide.collect();
        let caps = self.caps(groups);
        for (place, residue) in peptide.iter().enumerate() {
            let before = place.checked_sub(1).and_then(|place| peptide.get(place));
            let after = peptide.get(place + 1).copied();
            let begins = before.is_none_or(|before| {
                self.separate(before, residue) || self.follows_an_end(before, residue, after)
            });
            let ends = after.is_none_or(|after| self.separate(residue, after));
            if begins && !self.capped(&caps, residue, "N") && ph < TERMINI_PKA[0] {
                self.charge_amino(residue, labels);
            }
            if (ends || self.has_last_oxygen(residue))
                && !self.capped(&caps, residue, "C")
                && ph >= TERMINI_PKA[1]
            {
                self.charge_carboxyl(residue, labels);
            }
            let broken = before.is_some_and(|before| {
                !begins
                    && self.distance(before, residue).is_some_and(|d| d > BOND)
                    && !self.capped(&caps, residue, "N")
            });
            labels.report.gaps += usize::from(broken);
        }
    }

    /// Distance in Å of the C of one residue from the N of the next.
    fn distance(&self, before: &Residue<'_>, after: &Residue<'_>) -> Option<f64> {
        let (c, n) = (self.atom(before, "C")?, self.atom(after, "N")?);
        Some(squared_distance(c.position, n.position).sqrt())
    }

    fn separate(&self, before: &Residue<'_>, after: &Residue<'_>) -> bool {
        let is_broken = self.distance(before, after).is_some_and(|d| d > BOND);
        let (chain, number) = (before.key.chain, before.key.number);
        let (next_chain, next_number) = (after.key.chain, after.key.number);
        is_broken && (chain != next_chain || next_number <= number.saturating_add(1))
    }

    /// Whether a residue has the second oxygen of a carboxyl end.
    pub(crate) fn has_last_oxygen(&self, residue: &Residue<'_>) -> bool {
        let mut names = ["OXT", "OT2", "O2", "OC2"].iter();
        names.any(|name| self.atom(residue, name).is_some())
    }

    /// Whether a residue begins a chain because the one before it ended one: that has its second oxygen, and no
    /// residues that the numbers leave out fit between. Some programs write such an oxygen before a gap. Ligands that
    /// have an amino acid's atoms follow chains, too; of these none but standard residues in ATOM records and those
    /// bonded to the next are of a chain.
    fn follows_an_end(
        &self,
        before: &Residue<'_>,
        residue: &Residue<'_>,
        after: Option<&Residue<'_>>,
    ) -> bool {
        let bonded = |from: &Residue<'_>, to: &Residue<'_>| {
            self.distance(from, to)
                .is_some_and(|distance| distance <= BOND)
        };
        let is_of_chain = || {
            let first = residue.members(&self.atoms).next();
            residue.kind == GroupKind::AminoAcid && first.is_some_and(|atom| !atom.hetero)
                || after.is_some_and(|after| bonded(residue, after))
        };
        self.has_last_oxygen(before)
            && self.distance(before, residue).is_some_and(|distance| {
                distance > BOND && !Self::may_be_gap(before, residue, distance)
            })
            && is_of_chain()
    }

    /// Whether an atom of another group is bonded to a terminal atom, N or C: an acetyl, an amide, a sugar, or a
    /// residue that was not picked.
    ///
    /// It may also be the other end of a residue that stands elsewhere in the file: in a cyclic peptide, or where
    /// residues are not in the order of the chain.
    pub(crate) fn capped(&self, caps: &Caps<'_>, residue: &Residue<'_>, name: &str) -> bool {
        let Some(end) = self.atom(residue, name) else {
            return true;
        };
        let mut cut_ends = self.report.cut_ends.iter();
        if cut_ends.any(|cut| cut.is(residue.key, name)) {
            return true;
        }
        caps.cells.around(end.position).copied().any(|index| {
            let cap = &caps.atoms[index];
            let fits = cap
                .end
                .is_none_or(|other_end| other_end != name && cap.residue != residue.key);
            fits && squared_distance(cap.position, end.position) < MAX_CAP_LENGTH * MAX_CAP_LENGTH
        })
    }

    pub(crate) fn caps<'a>(&self, groups: &[Residue<'a>]) -> Caps<'a> {
        let mut atoms = Vec::new();
        for group in groups {
            let mut add = |atom: &Atom, end| {
                atoms.push(Cap {
                    position: atom.position,
                    end,
                    residue: group.key,
                });
            };
            match group.kind {
                GroupKind::Cofactor | GroupKind::Glycan => {
                    group.members(&self.atoms).for_each(|atom| add(atom, None));
                }
                GroupKind::AminoAcid | GroupKind::ModifiedResidue => {
                    for end in ["N", "C"] {
                        if let Some(atom) = self.atom(group, end) {
                            add(atom, Some(end));
                        }
                    }
                }
                _ => {}
            }
        }
        Caps {
            cells: SpatialHash::of_points(atoms.iter().map(|cap| cap.position), MAX_CAP_LENGTH),
            atoms,
        }
    }

    fn charge_amino(&self, residue: &Residue<'_>, labels: &mut Labels) {
        // Pyroglutamate's amide carries no proton to share.
        if residue.key.name != "PCA" {
            self.set(residue, amino_terminus(residue.known_as), labels);
            labels.report.termini[0] += 1;
        }
    }

    fn charge_carboxyl(&self, residue: &Residue<'_>, labels: &mut Labels) {
        const OXYGENS: [&str; 8] = ["O", "OXT", "OT1", "OT2", "O1", "O2", "OC1", "OC2"];
        let is_oxygen = |&&index: &&usize| OXYGENS.contains(&self.atoms[index].name.as_str());
        let oxygens: Vec<usize> = residue.atoms.iter().filter(is_oxygen).copied().collect();
        if oxygens.is_empty() {
            return;
        }
        // Where the second oxygen was not seen, the first stands for both.
        for &index in &oxygens {
            labels.charges[index] = CARBOXYL[1] / oxygens.len() as f64;
        }
        self.set(residue, &[("C", CARBOXYL[0])], labels);
        labels.report.termini[1] += 1;
    }
}
