//! A molecule as the evaluation sees it: residues of protein or nucleic acid, in file order, in segments.
//!
//! A **segment** is matched as one chain: the residues of one chain name, in file order, cut where several
//! chains were written under one name ([`segments`](crate::evaluate::residues::segments)).

pub(super) mod residue;
pub(super) mod segments;

use std::collections::HashMap;

use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use knotdock_structures::molecule::{Atom, Molecule};
use nalgebra::Point3;

use crate::evaluate::residues::residue::{LINKING_OXYGEN, PHOSPHATE_BOND, PHOSPHORUS, Residue};
use crate::evaluate::residues::segments::{in_bonded_order, segments};

/// Longest distances in Å from CA to the next CA and from P to the next P: 3.8 and 7 of bonded residues, with room for
/// poor structures.
const CA_STEP: f64 = 5.0;
const P_STEP: f64 = 8.5;

/// Lines through CA, or P of nucleotides, Å. A line ends where the next residue is not bonded.
pub type Trace = Vec<Vec<[f64; 3]>>;

/// Residues matched as one chain.
#[derive(Clone, Debug)]
pub(in crate::evaluate) struct Segment {
    /// Author chain name, with `/2`, `/3` ... appended for the further segments of one name.
    pub name: String,
    /// Indices into [`Residues::residues`], in file order.
    pub members: Vec<usize>,
}

impl Segment {
    /// Author chain name.
    pub fn chain(&self) -> &str {
        chain_of(&self.name)
    }
}

/// Author chain name of a segment's name.
pub(in crate::evaluate) fn chain_of(segment: &str) -> &str {
    match segment.rsplit_once('/') {
        Some((chain, piece)) if piece.bytes().all(|byte| byte.is_ascii_digit()) => chain,
        _ => segment,
    }
}

/// All residues of a molecule that the evaluation uses.
#[derive(Clone, Debug, Default)]
pub(in crate::evaluate) struct Residues {
    /// The residues, segment by segment.
    pub residues: Vec<Residue>,
    /// The segments, in order of first appearance.
    pub segments: Vec<Segment>,
}

impl Residues {
    /// Reads the residues of `molecule`; `role` names it in errors, e.g. "native ligand".
    ///
    /// Kept: every ATOM residue with a heavy atom, and of HETATM residues those with N, CA and C, which are modified
    /// amino acids (selenomethionine), and nucleotides bonded to a neighbour, which are modified ones (pseudouridine).
    /// Cofactors, FMN and AMP among them, ions and glycans play no part, as in DockQ.
    ///
    /// # Errors
    /// [`Error`] for coordinates that are not finite, and for a molecule without such residues.
    pub fn of(molecule: &Molecule, role: &'static str) -> Result<Self, Error> {
        let mut chains: Vec<(&str, Vec<&Atom>)> = Vec::new();
        let mut places: HashMap<&str, usize> = HashMap::new();
        for atom in &molecule.atoms {
            if !atom.position.iter().all(|part| part.is_finite()) {
                return Err(Error::input(format!(
                    "the {role} has an atom (line {}) whose coordinates are not finite",
                    atom.line
                ))
                .help("correct the coordinates in the file"));
            }
            if atom.element.eq_ignore_ascii_case("H") || atom.element.eq_ignore_ascii_case("D") {
                continue;
            }
            let next = chains.len();
            let place = *places.entry(atom.chain.as_str()).or_insert(next);
            match chains.get_mut(place) {
                Some((_, atoms)) => atoms.push(atom),
                None => chains.push((&atom.chain, vec![atom])),
            }
        }
        let mut all = Self::default();
        for (name, atoms) in chains {
            all.add_chain(name, &atoms, &molecule.chain_breaks);
        }
        if all.residues.is_empty() {
            return Err(Error::input(format!(
                "the {role} has no residue of protein or nucleic acid"
            ))
            .help("name chains of protein or nucleic acid; waters, ions and cofactors are not compared"));
        }
        Ok(all)
    }

    /// The residues with these indices.
    pub fn at(&self, members: &[usize]) -> Vec<&Residue> {
        let members = members.iter();
        members.map(|&member| &self.residues[member]).collect()
    }

    /// Names of the segments that are not used.
    pub fn unused(&self, is_used: impl Fn(usize) -> bool) -> Vec<String> {
        let segments = self.segments.iter().enumerate();
        segments
            .filter(|&(index, _)| !is_used(index))
            .map(|(_, segment)| segment.name.clone())
            .collect()
    }

    /// Cuts one chain's atoms into residues and appends them as one or more segments; `ends` are the lines at which
    /// the file ends a chain.
    fn add_chain(&mut self, name: &str, atoms: &[&Atom], ends: &[usize]) {
        let runs = residue_runs(atoms).into_iter();
        let found = without_free_nucleotides(runs.filter_map(Residue::of).collect());
        let pieces = segments(in_bonded_order(found), ends).into_iter();
        for (piece, residues) in pieces.enumerate() {
            let first = self.residues.len();
            self.residues.extend(residues);
            let name = match piece {
                0 => name.to_owned(),
                later => format!("{name}/{}", later + 1),
            };
            self.segments.push(Segment {
                name,
                members: (first..self.residues.len()).collect(),
            });
        }
    }

    /// The trace of the residues after a motion.
    pub fn trace(&self, motion: &Pose) -> Trace {
        let mut lines = Vec::new();
        for segment in &self.segments {
            let mut line: Vec<Point3<f64>> = Vec::new();
            for residue in self.at(&segment.members) {
                let [ca, p] = [0, PHOSPHORUS].map(|place| residue.backbone[place]);
                let Some(at) = ca.or(p) else { continue };
                let longest = if ca.is_some() { CA_STEP } else { P_STEP };
                let is_bonded = |last: &Point3<f64>| nalgebra::distance(last, &at) < longest;
                if !line.last().is_none_or(is_bonded) {
                    lines.push(std::mem::take(&mut line));
                }
                line.push(at);
            }
            lines.push(line);
        }
        lines.retain(|line| line.len() > 1);
        let moved =
            |line: Vec<Point3<f64>>| line.iter().map(|&at| motion.apply(at.into())).collect();
        lines.into_iter().map(moved).collect()
    }

    /// Only the given residues of the segments with the given indices, in the order given; a segment keeps its name.
    pub fn only(&self, segments: &[(usize, Vec<usize>)]) -> Self {
        let mut some = Self::default();
        for (segment, members) in segments {
            let first = some.residues.len();
            some.residues
                .extend(members.iter().map(|&member| self.residues[member].clone()));
            some.segments.push(Segment {
                name: self.segments[*segment].name.clone(),
                members: (first..some.residues.len()).collect(),
            });
        }
        some
    }
}

/// Splits a chain's atoms where the residue changes, or an atom name comes again: merged chains may meet between two
/// residues of the same number and name.
fn residue_runs<'a>(atoms: &'a [&'a Atom]) -> Vec<&'a [&'a Atom]> {
    let residue = |atom: &'a Atom| (atom.residue_number, atom.insertion_code, &atom.residue_name);
    let mut runs = Vec::new();
    let mut start = 0;
    for index in 1..=atoms.len() {
        let run = &atoms[start..index];
        let ends = atoms.get(index).is_none_or(|atom| {
            residue(run[0]) != residue(atom) || run.iter().any(|other| other.name == atom.name)
        });
        if ends {
            runs.push(run);
            start = index;
        }
    }
    runs
}

/// Leaves out the nucleotides of HETATM records that are bonded to neither neighbour: they are cofactors.
fn without_free_nucleotides(found: Vec<Residue>) -> Vec<Residue> {
    let bonded = |before: Option<&Residue>, after: Option<&Residue>| {
        let ends = before.zip(after).and_then(|(before, after)| {
            before.backbone[LINKING_OXYGEN].zip(after.backbone[PHOSPHORUS])
        });
        ends.is_some_and(|(oxygen, phosphorus)| {
            nalgebra::distance(&oxygen, &phosphorus) < PHOSPHATE_BOND
        })
    };
    let stays = |place: usize| {
        let residue = found.get(place);
        let before = place.checked_sub(1).and_then(|before| found.get(before));
        residue.is_none_or(|one| !one.hetero || one.is_amino_acid())
            || bonded(before, residue)
            || bonded(residue, found.get(place + 1))
    };
    let keep: Vec<bool> = (0..found.len()).map(stays).collect();
    let kept = found.into_iter().zip(keep);
    kept.filter_map(|(residue, keep)| keep.then_some(residue))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::test_molecules::{atom, molecule};
    use super::*;
    use crate::evaluate::residues::residue::kind;

    /// A phosphoserine's phosphate is no backbone; a nucleotide's is.
    #[test]
    fn phosphates_are_backbone_of_nucleotides_alone() {
        let residue = |number, kind, names: &[&str]| {
            let atoms = names.iter().enumerate();
            atoms
                .map(|(place, name)| atom("A", number, kind, name, [place as f64, 0.0, 0.0]))
                .collect::<Vec<_>>()
        };
        let serine = ["N", "CA", "C", "O", "CB", "OG", "P", "O1P", "O2P"];
        let nucleotide = ["P", "OP1", "OP2", "C1'", "C3'", "O3'"];
        let atoms = [residue(1, "SEP", &serine), residue(2, "DA", &nucleotide)].concat();
        let residues = Residues::of(&molecule(atoms), "receptor").unwrap();
        let backbone = |place: usize| residues.residues[place].backbone.iter().flatten().count();
        assert_eq!([backbone(0), backbone(1)], [4, 6]);
    }

    #[test]
    fn hetero_groups_count_only_as_amino_acids() {
        let mut atoms = Vec::new();
        for (number, residue, names) in [
            (1, "MSE", &["N", "CA", "C", "O", "SE"][..]),
            (2, "GDP", &["PA", "C1'", "O3'"][..]),
            (3, "CA", &["CA"][..]),
        ] {
            for (place, name) in names.iter().enumerate() {
                let mut one = atom("A", number, residue, name, [place as f64, 0.0, 0.0]);
                one.hetero = true;
                atoms.push(one);
            }
        }
        let residues = Residues::of(&molecule(atoms), "receptor").unwrap();
        assert_eq!(residues.residues.len(), 1, "calcium is no alpha carbon");
        assert_eq!(residues.residues[0].kind, "MET");
    }

    /// Found by a review: of force fields' names only some were known, and of old files' the atoms of the backbone
    /// were not.
    #[test]
    fn names_of_force_fields_and_old_files_are_known() {
        for (name, plain) in [("LSN", "LYS"), ("ASPP", "ASP"), ("RU", "U"), ("DA5", "A")] {
            assert_eq!(kind(name), plain);
        }
        let names = ["P", "O1P", "O2P", "C1*", "O3*"];
        let atoms = names.map(|name| atom("A", 1, "DA", name, [0.0; 3]));
        let residues = Residues::of(&molecule(atoms.to_vec()), "receptor").unwrap();
        let backbone = residues.residues[0].backbone.iter().flatten();
        assert_eq!(backbone.count(), names.len());
    }

    /// Found by a user: of a file with GROMOS's names 19 of 29 residues were matched, of one with D-amino acids fewer.
    #[test]
    fn standard_residues_are_known_under_other_names() {
        let serine = ["N", "CA", "C", "O", "CB", "OG"];
        for (name, plain) in [
            ("DSN", "SER"),
            ("X", "SER"),
            ("CSER", "SER"),
            ("SEP", "SER"),
        ] {
            let atoms = serine.map(|atom_name| atom("A", 1, name, atom_name, [0.0; 3]));
            let residues = Residues::of(&molecule(atoms.to_vec()), "receptor").unwrap();
            assert_eq!(residues.residues[0].kind, plain, "{name}");
        }
    }

    /// Pseudouridine within a strand counts, and AMP beside it does not.
    #[test]
    fn modified_nucleotides_count_where_they_are_linked() {
        let mut atoms = Vec::new();
        for (number, residue, hetero) in [(1, "U", false), (2, "PSU", true), (9, "AMP", true)] {
            for (name, along) in [("P", 0.0), ("C1'", 3.0), ("C3'", 4.0), ("O3'", 5.0)] {
                let position = [6.6 * number as f64 + along, 0.0, 0.0];
                let mut one = atom("A", number, residue, name, position);
                one.hetero = hetero;
                atoms.push(one);
            }
        }
        let residues = Residues::of(&molecule(atoms), "receptor").unwrap();
        let kinds: Vec<&str> = residues
            .residues
            .iter()
            .map(|one| one.kind.as_str())
            .collect();
        assert_eq!(kinds, ["U", "PSU"]);
    }

    #[test]
    fn hydrogens_and_nothing_at_all() {
        let mut hydrogen = atom("A", 1, "ALA", "H", [0.0; 3]);
        hydrogen.element = "H".into();
        let refused = |one, role| Residues::of(&molecule(vec![one]), role).unwrap_err();
        let error = refused(hydrogen, "native ligand");
        assert!(
            error
                .message()
                .starts_with("the native ligand has no residue"),
            "{error}"
        );
        let lost = atom("A", 1, "ALA", "CA", [0.0, f64::NAN, 0.0]);
        let error = refused(lost, "receptor");
        assert!(error.message().contains("not finite"), "{error}");
    }
}
