//! Scripts that show the complexes of a run in PyMOL and ChimeraX.
//!
//! Both load the complexes that lie in `top/`. The receptor is grey and each ligand has a colour of its own, after Okabe
//! and Ito's palette, which colour-blind people can tell apart (K. Ito and M. Okabe, Color Universal Design, 2008). The
//! first pose is shown with the residues of its interface as sticks; the others are loaded and hidden.

mod chimerax;
mod pymol;

use std::io::{self, Write};

use knotdock_structures::molecule::{ChainMap, Partner};

/// Name of the script for PyMOL.
pub const PYMOL: &str = "view.pml";
/// Name of the script for ChimeraX.
pub const CHIMERAX: &str = "view.cxc";

/// Residues with an atom within this distance of the other side are the interface, Å.
const INTERFACE: f64 = 5.0;

/// Colours of the ligands in the order of the ranks, then again.
const COLOURS: [&str; 7] = [
    "e69f00", "56b4e9", "009e73", "cc79a7", "0072b2", "d55e00", "f0e442",
];
/// Colour of the receptor.
const RECEPTOR: &str = "bfbfbf";

/// A complex to look at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ViewedComplex {
    /// Its rank.
    pub rank: usize,
    /// Name of its file in `top/`.
    pub file: String,
    /// Names of the chains of the receptor, and of all that was placed.
    pub chains: [Vec<String>; 2],
}

impl ViewedComplex {
    /// A complex with the chains of a map, as [`knotdock_structures::molecule::write_complex`] returns it.
    ///
    /// # Panics
    /// If a written name is no word of letters and digits, which no complex has: in a script it might be a command.
    pub fn new(rank: usize, file: &str, map: &ChainMap) -> Self {
        let names = |is_receptor: bool| -> Vec<String> {
            let of_side = map
                .chains
                .iter()
                .filter(|chain| (chain.partner == Partner::Receptor) == is_receptor);
            let words = of_side.inspect(|chain| {
                let mut bytes = chain.written.bytes();
                assert!(
                    !chain.written.is_empty() && bytes.all(|byte| byte.is_ascii_alphanumeric())
                );
            });
            words.map(|chain| chain.written.clone()).collect()
        };
        Self {
            rank,
            file: file.to_owned(),
            chains: [names(true), names(false)],
        }
    }
}

/// Colour of the complex at a place among those shown.
fn colour(place: usize) -> &'static str {
    COLOURS[place % COLOURS.len()]
}

/// Writes the script for PyMOL.
///
/// # Errors
/// Those of the stream.
pub fn write_pymol(stream: &mut dyn Write, complexes: &[ViewedComplex]) -> io::Result<()> {
    stream.write_all(pymol::script(complexes).as_bytes())
}

/// Writes the script for ChimeraX.
///
/// # Errors
/// Those of the stream.
pub fn write_chimerax(stream: &mut dyn Write, complexes: &[ViewedComplex]) -> io::Result<()> {
    stream.write_all(chimerax::script(complexes).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complexes() -> Vec<ViewedComplex> {
        let complex = |rank: usize| ViewedComplex {
            rank,
            file: format!("rank_{rank:04}.pdb"),
            chains: [vec!["A".to_owned()], vec!["H".to_owned(), "L2".to_owned()]],
        };
        (1..=9).map(complex).collect()
    }

    /// Every complex is loaded and coloured once, and only the first is shown.
    #[test]
    fn scripts_load_every_complex() {
        let (pymol, chimerax) = (pymol::script(&complexes()), chimerax::script(&complexes()));
        for rank in 1..=9 {
            assert_eq!(
                pymol
                    .matches(&format!("load top/rank_{rank:04}.pdb"))
                    .count(),
                1
            );
            assert_eq!(
                chimerax
                    .matches(&format!("open top/rank_{rank:04}.pdb"))
                    .count(),
                1
            );
        }
        assert!(pymol.contains("enable rank_0001\n") && !pymol.contains("enable rank_0002"));
        // The eighth has the colour of the first again.
        assert_eq!(pymol.matches("0xe69f00").count(), 2);
        assert_eq!(chimerax.matches("#e69f00").count(), 2);
    }

    /// Found by an audit: a chain called `A")) ; cmd.system("...") #` ran a shell command in PyMOL. Whatever the chains of
    /// an input are called, the scripts are those of chains called by words.
    #[test]
    fn no_name_of_an_input_reaches_a_script() {
        use crate::test_molecules::molecules;
        use knotdock_structures::molecule::{Atom, Format, Molecule, write_complex};
        use proptest::prelude::*;
        let template = &molecules()[0].atoms[0];
        let molecule = |names: Vec<String>| {
            let atoms = names.into_iter().map(|chain| Atom {
                chain,
                ..template.clone()
            });
            Molecule::new(atoms.collect(), Format::Mmcif)
        };
        let names = proptest::collection::vec(
            r#"[A-Za-z0-9]{0,3}|[ -~\n\té;"'\\()#/]{0,12}|\PC{0,4}"#,
            1..6,
        );
        proptest!(|(receptor in names.clone(), ligand in names)| {
            let [receptor, ligand] = [receptor, ligand].map(molecule);
            for format in [Format::Pdb, Format::Mmcif] {
                let mut file = Vec::new();
                let map = write_complex(&mut file, format, &[&receptor, &ligand], &[]).unwrap();
                let complex = ViewedComplex::new(1, "rank_0001.pdb", &map);
                let (mut plain, mut words) = (complex.clone(), ('A'..='Z').map(String::from));
                for names in &mut plain.chains {
                    names.iter_mut().for_each(|name| *name = words.next().unwrap());
                }
                let (complex, plain) = ([complex], [plain]);
                for write in [pymol::script, chimerax::script] {
                    let marks = |text: String| text.replace(|c: char| c.is_ascii_alphanumeric(), "");
                    prop_assert_eq!(marks(write(&complex)), marks(write(&plain)));
                }
            }
        });
    }

    /// Where no complex was written there is nothing to show, and the scripts are whole.
    #[test]
    fn no_complex_is_an_empty_scene() {
        assert!(!pymol::script(&[]).contains("\nload "));
        assert!(!chimerax::script(&[]).contains("\nopen "));
    }
}
