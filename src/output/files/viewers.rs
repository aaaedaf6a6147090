//! Scripts that show the complexes of a run in PyMOL and ChimeraX.
//!
//! Both load the complexes of `top/`. The receptor is grey and each ligand has its own colour, after Okabe and Ito's
//! palette, which colour-blind people can distinguish (K. Ito and M. Okabe, Color Universal Design, 2008). The first pose
//! is shown with the residues of its interface as sticks; the others are loaded and hidden.

use knotdock_structures::molecule::{ChainMap, Partner};

/// Name of the script for PyMOL.
pub(crate) const PYMOL: &str = "view.pml";
/// Name of the script for ChimeraX.
pub(crate) const CHIMERAX: &str = "view.cxc";

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
    chains: [Vec<String>; 2],
}

impl ViewedComplex {
    /// A complex by its rank and its file in `top/`, with the chains of a map, as
    /// [`knotdock_structures::molecule::write_complex`] returns it.
    ///
    /// # Panics
    /// If a written name is no word of letters and digits, which no complex has: in a script it might be a command.
    pub fn new(rank: usize, file: &str, map: &ChainMap) -> Self {
        let names = |is_receptor: bool| -> Vec<String> {
            let chains = map.chains.iter();
            let of_side =
                chains.filter(|chain| (chain.partner == Partner::Receptor) == is_receptor);
            let words = of_side.map(|chain| chain.written.clone());
            let is_word = |name: &String| {
                !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric())
            };
            words.inspect(|name| assert!(is_word(name))).collect()
        };
        Self {
            rank,
            file: file.to_owned(),
            chains: [names(true), names(false)],
        }
    }

    /// Its name in PyMOL.
    fn object(&self) -> String {
        format!("rank_{:04}", self.rank)
    }
}

/// Colour of the complex at a place among those shown.
fn colour(place: usize) -> &'static str {
    COLOURS[place % COLOURS.len()]
}

/// The script for PyMOL (its commands `load`, `color`, `select`, `show`).
pub(crate) fn pymol_script(complexes: &[ViewedComplex]) -> String {
    let mut text = format!(
        "# The best poses in PyMOL: go to this directory, then\n#     pymol {PYMOL}\nbg_color white\n"
    );
    for (place, complex) in complexes.iter().enumerate() {
        let name = complex.object();
        let sides = complex.chains.each_ref();
        let [receptor, ligand] = sides.map(|chains| atoms_in_pymol(&name, chains));
        text += &format!(
            "load top/{file}, {name}\nhide everything, {name}\nshow cartoon, {name}\n\
             color 0x{RECEPTOR}, {receptor}\ncolor 0x{colour}, {ligand}\n\
             select interface_{rank:04}, byres (({receptor} within {INTERFACE} of {ligand}) or ({ligand} within \
             {INTERFACE} of {receptor}))\n",
            file = complex.file,
            colour = colour(place),
            rank = complex.rank,
        );
        if place > 0 {
            text += &format!("disable {name}\n");
        }
    }
    if let Some(first) = complexes.first() {
        let name = first.object();
        // What is no polymer, such as a cofactor, has no cartoon.
        text += &format!(
            "group poses, rank_*\ngroup interfaces, interface_*\nshow sticks, interface_{rank:04} and {name} and not \
             hydrogens\nshow sticks, {name} and organic\nutil.cnc {name}\nenable {name}\ndeselect\n\
             # The interface from its side.\norient interface_{rank:04}\nturn x, 90\nzoom interface_{rank:04}, 8\n",
            rank = first.rank,
        );
    }
    text
}

/// The atoms of some chains of an object.
fn atoms_in_pymol(object: &str, chains: &[String]) -> String {
    let names = chains.iter().map(|name| format!("chain \"{name}\""));
    let chains: Vec<String> = names.collect();
    match chains.is_empty() {
        true => "none".to_owned(),
        false => format!("({object} and ({}))", chains.join(" or ")),
    }
}

/// The script for ChimeraX (its commands `open`, `color`, `select`, `show`), which runs it in the directory of the file.
pub(crate) fn chimerax_script(complexes: &[ViewedComplex]) -> String {
    let mut text =
        format!("# The best poses in ChimeraX: open this file, as by\n#     chimerax {CHIMERAX}\n");
    if complexes.is_empty() {
        return text;
    }
    text += "set bgColor white\n";
    for (place, complex) in complexes.iter().enumerate() {
        let id = place + 1;
        let [receptor, ligand] = complex
            .chains
            .each_ref()
            .map(|chains| atoms_in_chimerax(id, chains));
        text += &format!(
            "open top/{file} id {id} name \"rank {rank}\"\ncolor {receptor} #{RECEPTOR}\ncolor {ligand} #{colour}\n\
             name interface{rank} ({receptor} & (({ligand}) :< {INTERFACE})) | ({ligand} & (({receptor}) :< \
             {INTERFACE}))\n",
            file = complex.file,
            rank = complex.rank,
            colour = colour(place),
        );
    }
    let [receptor, ligand] = complexes[0].chains.each_ref();
    let [receptor, ligand] = [receptor, ligand].map(|chains| atoms_in_chimerax(1, chains));
    text += &format!(
        "hide atoms\nshow cartoons\nshow interface{rank} atoms\nstyle stick\ncolor byhetero\nhide #2-{last} models\n\
         # The interface from its side.\nview zalign {receptor} inFrontOf {ligand}\nturn y 90\nview interface{rank} pad 0.2\n",
        rank = complexes[0].rank,
        // A range that begins after the last model names none.
        last = complexes.len().max(2),
    );
    text
}

/// The atoms of some chains of a model.
fn atoms_in_chimerax(id: usize, chains: &[String]) -> String {
    let chains: Vec<String> = chains.iter().map(|name| format!("#{id}/{name}")).collect();
    format!("({})", chains.join(" | "))
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
        let (pymol, chimerax) = (pymol_script(&complexes()), chimerax_script(&complexes()));
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
                for write in [pymol_script, chimerax_script] {
                    let marks = |text: String| text.replace(|c: char| c.is_ascii_alphanumeric(), "");
                    prop_assert_eq!(marks(write(&complex)), marks(write(&plain)));
                }
            }
        });
    }

    /// Without complexes there is nothing to show, and the scripts are whole.
    #[test]
    fn no_complex_is_an_empty_scene() {
        assert!(!pymol_script(&[]).contains("\nload "));
        assert!(!chimerax_script(&[]).contains("\nopen "));
    }
}
