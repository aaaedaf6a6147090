//! Atoms of one molecule as a table names them: `A:57`, `A:57.CA`, `A:57,60-65.CB`.

use std::collections::HashMap;

use knotdock_structures::Error;
use knotdock_structures::molecule::{Atom, Molecule, ResidueSelection};

use crate::table_text::named_columns::{listed, shortened};

/// Remedy for a field that names no residues of the molecule.
const RESIDUES: &str = "name residues by chain and number, as in A:57, A:52A or A:1-50, and atoms as in A:57.CA; a chain \
    without a name is _";
/// Remedy for atoms that the molecule lacks.
pub(super) const NO_ATOM: &str = "correct the names and numbers. What the file of the molecule lacks, or the options \
    leave out, cannot be restrained: hydrogens need --hydrogens keep";

/// Reads the fields of one column.
pub(super) struct SideAtoms<'a> {
    molecule: &'a Molecule,
    /// `receptor` or `ligand`.
    side: &'static str,
    /// The atom that represents a residue; `None` for all heavy atoms.
    residue_atom: Option<&'static str>,
    /// Fields that were read: those of a group name one residue in many rows.
    known: HashMap<String, Vec<usize>>,
}

impl<'a> SideAtoms<'a> {
    pub(super) fn new(
        molecule: &'a Molecule,
        side: &'static str,
        residue_atom: Option<&'static str>,
    ) -> Self {
        Self {
            molecule,
            side,
            residue_atom,
            known: HashMap::new(),
        }
    }

    /// The atoms that a field names, rising. Parts with commas or semicolons between are residues as in
    /// [`ResidueSelection`], each perhaps with the name of an atom after a full stop.
    pub(super) fn read(&mut self, field: &str) -> Result<Vec<usize>, Error> {
        if !self.known.contains_key(field) {
            let atoms = self.parse(field)?;
            self.known.insert(field.to_owned(), atoms);
        }
        Ok(self.known[field].clone())
    }

    /// Number of fields that were looked up.
    #[cfg(test)]
    pub(super) fn known_fields(&self) -> usize {
        self.known.len()
    }

    fn parse(&self, field: &str) -> Result<Vec<usize>, Error> {
        let parts = field.split([',', ';']).map(|part| {
            let part = part.trim();
            match part.rsplit_once('.') {
                Some((residues, atom)) => (residues.trim_end(), Some(atom.trim_start())),
                None => (part, None),
            }
        });
        let (residues, names): (Vec<&str>, Vec<Option<&str>>) = parts.unzip();
        let selection = residues.join(",").parse::<ResidueSelection>();
        let selection = selection.map_err(|_| {
            let (side, text) = (self.side, shortened(field));
            let message = format!("{side} is `{text}`, which does not name residues or atoms");
            Error::input(message).help(RESIDUES)
        })?;
        let mut chosen = vec![false; self.molecule.atoms.len()];
        for (part, name) in selection.parts().zip(names) {
            for index in self.part(&part, name)? {
                chosen[index] = true;
            }
        }
        Ok((0..chosen.len()).filter(|&index| chosen[index]).collect())
    }

    /// The atoms of one part.
    fn part(&self, residues: &ResidueSelection, name: Option<&str>) -> Result<Vec<usize>, Error> {
        let atoms = &self.molecule.atoms;
        let selected = self.molecule.selected(residues);
        let selected = selected.map_err(|unknown| {
            let (side, residue) = (self.side, shortened(&unknown.part));
            let present = unknown.present();
            let message = format!("the {side} has no residue {residue}; it has {present}");
            Error::input(message).help(RESIDUES)
        })?;
        let of_residues: Vec<usize> = (0..atoms.len()).filter(|&index| selected[index]).collect();
        let Some(name) = name.or(self.residue_atom) else {
            return Ok(heavy(atoms, of_residues));
        };
        let is_named = |index: &usize| atoms[*index].name.eq_ignore_ascii_case(name);
        let named: Vec<usize> = of_residues.iter().copied().filter(is_named).collect();
        match of_residues.first() {
            Some(&first) if named.is_empty() => {
                let (own, side, name) = (residue(&atoms[first]), self.side, shortened(name));
                let others = of_residues.iter().map(|&index| &atoms[index]);
                let of_own = others.filter(|atom| residue(atom) == own);
                let present = listed(of_own.map(|atom| atom.name.as_str()));
                let message = format!("{own} of the {side} has no atom {name}; it has {present}");
                Err(Error::input(message).help(NO_ATOM))
            }
            _ => Ok(named),
        }
    }
}

/// Atoms without the hydrogens; all, where there is nothing but hydrogens.
pub(super) fn heavy(atoms: &[Atom], chosen: Vec<usize>) -> Vec<usize> {
    let is_heavy = |index: &usize| !atoms[*index].is_hydrogen();
    let heavy: Vec<usize> = chosen.iter().copied().filter(is_heavy).collect();
    if heavy.is_empty() { chosen } else { heavy }
}

/// A residue as messages name it: `A:57`, `_:52A`.
pub(super) fn residue(atom: &Atom) -> String {
    let chain = if atom.chain.is_empty() {
        "_"
    } else {
        &atom.chain
    };
    let insertion = atom.insertion_code.map_or_else(String::new, String::from);
    format!("{chain}:{}{insertion}", atom.residue_number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_molecules::molecules;

    fn names(field: &str, residue_atom: Option<&'static str>) -> Result<String, Error> {
        let [receptor, _] = molecules();
        let atoms = SideAtoms::new(&receptor, "receptor", residue_atom).read(field)?;
        let name = |index: usize| {
            let atom = &receptor.atoms[index];
            format!("{}.{}", residue(atom), atom.name)
        };
        Ok(atoms.into_iter().map(name).collect::<Vec<_>>().join(" "))
    }

    #[test]
    fn residues_are_their_heavy_atoms() {
        assert_eq!(
            names("A:10", None).unwrap(),
            "A:10.N A:10.CA A:10.C A:10.CB"
        );
        assert_eq!(names("A:10.H", None).unwrap(), "A:10.H");
        assert_eq!(names("A:10.ca", None).unwrap(), "A:10.CA");
        assert_eq!(names("A:10", Some("CA")).unwrap(), "A:10.CA");
        assert_eq!(names("A:10.CB", Some("CA")).unwrap(), "A:10.CB");
    }

    #[test]
    fn lists_and_ranges_are_sets() {
        assert_eq!(names("A:10.CA;A:11.CB", None).unwrap(), "A:10.CA A:11.CB");
        // The chain goes on, and what is named twice is one atom.
        assert_eq!(
            names("A:11.CB, 10.CA, A:10.CA", None).unwrap(),
            "A:10.CA A:11.CB"
        );
        assert_eq!(
            names("A:10-52.CA", None).unwrap(),
            "A:10.CA A:11.CA A:52.CA A:52A.CA"
        );
        assert_eq!(names("A:52A.CA", None).unwrap(), "A:52A.CA");
        assert_eq!(names("D.CA", None).unwrap(), "D:-3.CA");
    }

    #[test]
    fn what_is_not_there_is_listed() {
        let message = |field: &str| names(field, None).unwrap_err().to_string();
        assert_eq!(
            message("A:99"),
            "the receptor has no residue A:99; it has A:10-52, D:-3--3, S:1-1"
        );
        assert_eq!(
            message("A:10.CX"),
            "A:10 of the receptor has no atom CX; it has N, CA, C, CB, H"
        );
        for field in ["", "A:", "A:10,", ".CA", "A:9-3"] {
            assert_eq!(
                message(field),
                format!("receptor is `{field}`, which does not name residues or atoms")
            );
        }
    }
}
