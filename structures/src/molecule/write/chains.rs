//! Unique chain names for a complex.

use std::collections::HashSet;
use std::fmt;

use serde::{Serialize, Serializer};

use crate::Error;
use crate::molecule::model::{Format, Molecule, show_chain};
use crate::molecule::write::does_not_fit;

/// One of the molecules of a complex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Partner {
    /// The molecule that stays.
    Receptor,
    /// The molecule that is placed.
    Ligand,
    /// A further copy in a ring of one molecule; the receptor is the first and the ligand the second.
    Copy(usize),
}

impl Partner {
    /// The molecule by its place in a complex, counted from 0.
    pub(crate) fn at(place: usize) -> Self {
        match place {
            0 => Self::Receptor,
            1 => Self::Ligand,
            _ => Self::Copy(place + 1),
        }
    }
}

impl fmt::Display for Partner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Receptor => f.write_str("receptor"),
            Self::Ligand => f.write_str("ligand"),
            Self::Copy(number) => write!(f, "copy {number}"),
        }
    }
}

impl Serialize for Partner {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// One chain's name before and after.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ChainName {
    /// The molecule that the chain belongs to.
    pub partner: Partner,
    /// Its author name in the input; may be empty.
    pub original: String,
    /// Its name in the complex.
    pub written: String,
}

/// The chain names of a complex: (partner, original) -> written. Written names are unique.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct ChainMap {
    /// Receptor's chains first, then the ligand's, then those of further copies, each in order of first appearance.
    pub chains: Vec<ChainName>,
}

/// Names that PDB's one column offers, in the order in which they are given out.
const SINGLE: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789";

impl ChainMap {
    /// The name that a chain has in the complex; its own where it is not in the map.
    pub fn written<'a>(&'a self, partner: Partner, original: &'a str) -> &'a str {
        self.chains
            .iter()
            .find(|chain| chain.partner == partner && chain.original == original)
            .map_or(original, |chain| &chain.written)
    }

    /// Gives every chain of a complex a unique name of letters and digits. Scripts select chains by these names, so that
    /// nothing else of an input file may reach them.
    pub(crate) fn of_complex(format: Format, molecules: &[&Molecule]) -> Result<Self, Error> {
        let is_word = |name: &str| name.bytes().all(|byte| byte.is_ascii_alphanumeric());
        Self::assign(format, molecules, is_word)
    }

    /// Gives every chain of one molecule a unique name that the format can hold.
    pub(crate) fn of_molecule(format: Format, molecule: &Molecule) -> Result<Self, Error> {
        let is_graphic = |name: &str| name.bytes().all(|byte| byte.is_ascii_graphic());
        match format {
            Format::Pdb => Self::assign(format, &[molecule], is_graphic),
            Format::Mmcif => Self::assign(format, &[molecule], |_| true),
        }
    }

    /// Lets the names stay that a rule allows and no chain before has, and gives the others fresh ones.
    fn assign(
        format: Format,
        molecules: &[&Molecule],
        may_stay: impl Fn(&str) -> bool,
    ) -> Result<Self, Error> {
        let mut chains: Vec<ChainName> = Vec::new();
        for (place, molecule) in molecules.iter().enumerate() {
            let partner = Partner::at(place);
            let mut seen: HashSet<&str> = HashSet::new();
            for atom in &molecule.atoms {
                if seen.insert(&atom.chain) {
                    chains.push(ChainName {
                        partner,
                        original: atom.chain.clone(),
                        written: String::new(),
                    });
                }
            }
        }
        let mut taken: HashSet<String> = HashSet::new();
        for chain in &mut chains {
            let fits = match format {
                Format::Pdb => chain.original.len() == 1,
                Format::Mmcif => !chain.original.is_empty(),
            };
            if fits && may_stay(&chain.original) && taken.insert(chain.original.clone()) {
                chain.written.clone_from(&chain.original);
            }
        }
        let mut fresh = fresh_names(format);
        for chain in chains.iter_mut().filter(|chain| chain.written.is_empty()) {
            let name = fresh.find(|name| !taken.contains(name));
            chain.written = name.ok_or_else(|| does_not_fit("more than 62 chains"))?;
            taken.insert(chain.written.clone());
        }
        Ok(Self { chains })
    }

    pub(crate) fn remarks(&self) -> Vec<String> {
        self.chains
            .iter()
            .map(|chain| {
                let (partner, original) = (chain.partner, show_chain(&chain.original));
                format!("chain {} is {partner} chain {original}", chain.written)
            })
            .collect()
    }
}

/// Names to give out: the 62 single ones, and in mmCIF those of two, then of three letters and so on without end.
fn fresh_names(format: Format) -> impl Iterator<Item = String> {
    let count = match format {
        Format::Pdb => SINGLE.len(),
        Format::Mmcif => usize::MAX,
    };
    (0..count).map(name_at)
}

/// The name at a place, from 0, among all in order of their lengths and then of [`SINGLE`].
fn name_at(mut place: usize) -> String {
    let mut letters = Vec::new();
    loop {
        letters.extend(SINGLE.chars().nth(place % SINGLE.len()));
        // The next letter, if there is one, begins at the first again: A, ..., 9, AA, AB, ...
        match (place / SINGLE.len()).checked_sub(1) {
            Some(next) => place = next,
            None => return letters.iter().rev().collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Found by an audit: of 3,906 names mmCIF ran out, at the end of a search.
    #[test]
    fn mmcif_never_runs_out_of_names() {
        let names: Vec<String> = fresh_names(Format::Mmcif).take(250_000).collect();
        let at = |places: [usize; 6]| places.map(|place| names[place].as_str());
        assert_eq!(
            at([0, 61, 62, 3905, 3906, 3907]),
            ["A", "9", "AA", "99", "AAA", "AAB"]
        );
        assert_eq!(names.iter().collect::<HashSet<_>>().len(), names.len());
        assert_eq!(fresh_names(Format::Pdb).count(), 62);
    }
}
