//! Residues as a user picks them: `H:1-50,52A,L`.

use crate::molecule::model::{Molecule, residue_runs, show_chain};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Residues by chain and number, as the files' authors name them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ResidueSelection(Vec<Part>);

/// One part of a selection as written: a chain, and which of its residues.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Part {
    chain: String,
    residues: Range,
    /// What else it may be where no chain has its name: residues of the chain of the part before it.
    continued: Option<(String, Range)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Range {
    /// The whole chain.
    Chain,
    /// One number without an insertion code.
    Plain(i64),
    /// Numbers from the first to the last, whatever their insertion codes.
    Numbers(i64, i64),
    /// One number with one insertion code.
    Inserted(i64, char),
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", self.chain, self.residues)
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Chain => Ok(()),
            Self::Plain(number) => write!(f, ":{number}"),
            Self::Numbers(first, last) => write!(f, ":{first}-{last}"),
            Self::Inserted(number, insertion) => write!(f, ":{number}{insertion}"),
        }
    }
}

impl Range {
    fn holds(self, number: i64, insertion: Option<char>) -> bool {
        match self {
            Self::Chain => true,
            Self::Plain(own) => (own, None) == (number, insertion),
            Self::Numbers(first, last) => (first..=last).contains(&number),
            Self::Inserted(own, code) => (own, Some(code)) == (number, insertion),
        }
    }
}

impl std::str::FromStr for ResidueSelection {
    type Err = String;

    /// Reads parts with commas between them:
    ///
    /// - `H` for a chain, `H:52` for a residue, `H:52A` for an inserted one;
    /// - `H:1-50` for a range of numbers with all that is inserted among them, `H:52-52` for one number so;
    /// - `_:12` or `:12` where chains have no name.
    ///
    /// After residues of a chain its name may be left out, as in `H:52,54,60-65`, unless a chain is called so.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts: Vec<Part> = Vec::new();
        for part in text.split(',') {
            let (chain, residues) = match part.trim().split_once(':') {
                Some((chain, residues)) => (chain, range(residues)),
                None => (part.trim(), Some(Range::Chain)),
            };
            let empty = chain.is_empty() && residues == Some(Range::Chain);
            let Some(residues) = residues.filter(|_| !empty) else {
                return Err(format!(
                    "`{part}` names no residues; a chain is needed, or residues as in H:12, H:52A or H:1-50"
                ));
            };
            let before = parts.last().and_then(Part::chain_of_residues);
            let continued = (residues == Range::Chain)
                .then(|| Some((before?.to_owned(), range(chain)?)))
                .flatten();
            parts.push(Part {
                chain: chain.to_owned(),
                residues,
                continued,
            });
        }
        Ok(Self(parts))
    }
}

impl Part {
    /// The chain whose residues a number after this part may be of.
    fn chain_of_residues(&self) -> Option<&str> {
        match (&self.continued, self.residues) {
            (Some((chain, _)), _) => Some(chain),
            (None, Range::Chain) => None,
            (None, _) => Some(&self.chain),
        }
    }

    /// The chain, and which of its residues, in a molecule of these chains.
    fn read_among(&self, chains: &BTreeSet<&str>) -> Picked {
        let name = |chain: &str| match chain {
            // Where a chain has no name reports say `_`.
            "_" if !chains.contains("_") => String::new(),
            chain => chain.to_owned(),
        };
        let (chain, residues) = match &self.continued {
            Some((chain, residues)) if !chains.contains(self.chain.as_str()) => (chain, *residues),
            _ => (&self.chain, self.residues),
        };
        Picked {
            chain: name(chain),
            residues,
            written: format!("{chain}{residues}"),
        }
    }
}

/// A part of a selection as it is read in one molecule.
pub(crate) struct Picked {
    pub(crate) chain: String,
    residues: Range,
    /// As a user would write it in full.
    pub(crate) written: String,
}

impl Picked {
    pub(crate) fn holds(&self, number: i64, insertion: Option<char>) -> bool {
        self.residues.holds(number, insertion)
    }
}

impl ResidueSelection {
    /// Its parts in the order written, each as a selection. A part keeps the chain that it goes on with.
    pub fn parts(&self) -> impl Iterator<Item = ResidueSelection> + '_ {
        self.0.iter().map(|part| Self(vec![part.clone()]))
    }

    /// Its parts as they are read in a molecule of these chains.
    pub(crate) fn read_among(&self, chains: &BTreeSet<&str>) -> Vec<Picked> {
        self.0.iter().map(|part| part.read_among(chains)).collect()
    }
}

impl TryFrom<String> for ResidueSelection {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<ResidueSelection> for String {
    fn from(selection: ResidueSelection) -> Self {
        let parts = selection.0.iter().map(Part::to_string);
        parts.collect::<Vec<_>>().join(",")
    }
}

/// `12`, `52A`, `-3`, `1-50` or `-5--2`.
fn range(text: &str) -> Option<Range> {
    if let Ok(number) = text.parse() {
        return Some(Range::Plain(number));
    }
    // A minus that is not the first character parts two numbers.
    let dash = text.char_indices().skip(1).find(|(_, c)| *c == '-');
    if let Some((dash, _)) = dash {
        let (first, last) = (text[..dash].parse().ok()?, text[dash + 1..].parse().ok()?);
        return (first <= last).then_some(Range::Numbers(first, last));
    }
    let insertion = text.chars().last().filter(char::is_ascii_alphabetic)?;
    let number = text.strip_suffix(insertion)?.parse().ok()?;
    Some(Range::Inserted(number, insertion))
}

impl Molecule {
    /// Whether each atom is of a selected residue.
    ///
    /// # Errors
    /// The first part that no atom belongs to, with the chains and numbers that there are.
    pub fn selected(&self, selection: &ResidueSelection) -> Result<Vec<bool>, UnknownResidues> {
        let chains: BTreeSet<&str> = self.atoms.iter().map(|atom| atom.chain.as_str()).collect();
        let mut chosen = vec![false; self.atoms.len()];
        for picked in selection.read_among(&chains) {
            let mut found = false;
            for (atom, chosen) in self.atoms.iter().zip(&mut chosen) {
                let meant = atom.chain == picked.chain
                    && picked.holds(atom.residue_number, atom.insertion_code);
                found |= meant;
                *chosen |= meant;
            }
            if !found {
                return Err(UnknownResidues {
                    part: picked.written,
                    present: self.numbers_by_chain(),
                });
            }
        }
        Ok(chosen)
    }

    /// The places of the chosen atoms, residue by residue in file order; residues without any are left out.
    pub fn atoms_by_residue(&self, chosen: &[bool]) -> Vec<Vec<usize>> {
        let is_chosen = |index: &usize| chosen.get(*index) == Some(&true);
        let runs = residue_runs(&self.atoms).into_iter();
        let runs = runs.map(|residue| residue.atoms.into_iter().filter(is_chosen).collect());
        runs.filter(|atoms: &Vec<usize>| !atoms.is_empty())
            .collect()
    }

    /// The chains with their smallest and largest residue number, in words: `H:51-53, L:1-107`.
    pub fn chains_in_words(&self) -> String {
        in_words(&self.numbers_by_chain())
    }

    fn numbers_by_chain(&self) -> BTreeMap<String, [i64; 2]> {
        let mut chains = BTreeMap::new();
        for atom in &self.atoms {
            let number = atom.residue_number;
            let [first, last] = chains.entry(atom.chain.clone()).or_insert([number, number]);
            *first = number.min(*first);
            *last = number.max(*last);
        }
        chains
    }
}

/// Chains with their smallest and largest residue number, in words.
fn in_words(chains: &BTreeMap<String, [i64; 2]>) -> String {
    let chains = chains.iter().map(|(chain, [first, last])| {
        let chain = show_chain(chain);
        format!("{chain}:{first}-{last}")
    });
    chains.collect::<Vec<_>>().join(", ")
}

/// Residues were requested that a molecule does not have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownResidues {
    /// What no atom belongs to, as `H:1-50`.
    pub part: String,
    /// Smallest and largest residue number of each chain.
    pub present: BTreeMap<String, [i64; 2]>,
}

impl UnknownResidues {
    /// The chains and numbers that there are, in words, and how to name a residue where a number stands without its
    /// chain.
    pub fn present(&self) -> String {
        let mut text = in_words(&self.present);
        let (chain, residue) = match self.part.split_once(':') {
            Some((chain, residue)) => (Some(chain), residue),
            None => (None, self.part.as_str()),
        };
        // The chain is left out, or is another than the only one.
        let is_elsewhere = chain.is_some_and(|chain| {
            let is_there = self
                .present
                .keys()
                .any(|name| show_chain(name) == show_chain(chain));
            !is_there && self.present.len() == 1
        });
        if let Some((own, _)) = self.present.first_key_value()
            && range(residue).is_some()
            && (chain.is_none() || is_elsewhere)
        {
            let own = show_chain(own);
            text += &format!("; for residue {residue} of chain {own} write {own}:{residue}");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::model::{Atom, Format};

    fn molecule() -> Molecule {
        let residues = [
            ("H", 51, None),
            ("H", 52, None),
            ("H", 52, Some('A')),
            ("H", 53, None),
            ("L", -2, None),
            ("", 7, None),
        ];
        let atom = |(chain, residue_number, insertion_code): (&str, i64, Option<char>)| Atom {
            name: "CA".to_owned(),
            residue_name: "GLY".to_owned(),
            chain: chain.to_owned(),
            residue_number,
            insertion_code,
            element: "C".to_owned(),
            position: [0.0; 3],
            ..Atom::default()
        };
        Molecule::new(residues.into_iter().map(atom).collect(), Format::Pdb)
    }

    fn chosen(text: &str) -> Result<Vec<usize>, String> {
        let selection: ResidueSelection = text.parse()?;
        assert_eq!(String::from(selection.clone()), text);
        let chosen = molecule()
            .selected(&selection)
            .map_err(|unknown| format!("{} of {}", unknown.part, unknown.present()))?;
        Ok((0..chosen.len()).filter(|&index| chosen[index]).collect())
    }

    #[test]
    fn parts_pick_what_they_name() {
        assert_eq!(chosen("H"), Ok(vec![0, 1, 2, 3]));
        assert_eq!(chosen("H:52"), Ok(vec![1]));
        assert_eq!(chosen("H:52-52"), Ok(vec![1, 2]));
        assert_eq!(chosen("H:52A"), Ok(vec![2]));
        assert_eq!(chosen("H:40-51,L:-2"), Ok(vec![0, 4]));
        assert_eq!(chosen("L:-5--2"), Ok(vec![4]));
        assert_eq!(chosen(":7"), Ok(vec![5]));
    }

    /// Found by a user: numbers after a chain's residue were taken for chains, and the message named them in a form
    /// that looked right.
    #[test]
    fn the_chain_goes_on_where_its_name_is_left_out() {
        assert_eq!(chosen("H:51,52,53"), Ok(vec![0, 1, 3]));
        assert_eq!(chosen("H:51,52A"), Ok(vec![0, 2]));
        assert_eq!(chosen("L:-2,H:40-51,52-60"), Ok(vec![0, 1, 2, 3, 4]));
        assert_eq!(chosen("_:7"), Ok(vec![5]));
        let said = chosen("H:51,99").unwrap_err();
        assert!(said.starts_with("H:99 of "), "{said}");
        // No chain went before.
        let said = chosen("52").unwrap_err();
        assert!(
            said.contains("for residue 52 of chain _ write _:52"),
            "{said}"
        );
        assert!(chosen("H,52").unwrap_err().starts_with("52 of "));
        // Another chain than the only one.
        let mut only = molecule();
        only.atoms.truncate(4);
        let unknown = |text: &str| only.selected(&text.parse().unwrap()).unwrap_err();
        assert_eq!(
            unknown("B:52").present(),
            "H:51-53; for residue 52 of chain H write H:52"
        );
        assert_eq!(unknown("H:99").present(), "H:51-53");
        // A chain of that name is meant.
        let mut named = molecule();
        named.atoms[4].chain = "52".to_owned();
        let both = named.selected(&"H:51,52".parse().unwrap()).unwrap();
        assert_eq!(both, [true, false, false, false, true, false]);
    }

    #[test]
    fn each_part_is_a_selection_of_its_own() {
        let parts = |text: &str| -> Vec<Vec<bool>> {
            let selection: ResidueSelection = text.parse().unwrap();
            let parts = selection.parts();
            parts
                .map(|part| molecule().selected(&part).unwrap())
                .collect()
        };
        let expected = [[1, 0, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, 0, 0, 0, 1]];
        assert_eq!(
            parts("H:51,52A,_:7"),
            expected.map(|row| row.map(|x| x == 1).to_vec())
        );
    }

    #[test]
    fn what_is_not_there_is_named() {
        let present = "_:7-7, H:51-53, L:-2--2";
        assert_eq!(chosen("H:52B"), Err(format!("H:52B of {present}")));
        assert_eq!(chosen("H:51,K"), Err(format!("K of {present}")));
        assert_eq!(chosen("_:9"), Err(format!("_:9 of {present}")));
        for bad in ["", "H:", "H:x", "H:5-3", "H:5-", "H:5A-7", "H,", "H:1é"] {
            assert!(bad.parse::<ResidueSelection>().is_err(), "{bad}");
        }
    }
}
