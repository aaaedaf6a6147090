//! The refusal of traces: molecules of whose residues the file has CA atoms alone, or as few.
//!
//! The score is of all heavy atoms. It would rank poses of a trace, of a body that is mostly air, by nothing.

use std::collections::BTreeMap;

use crate::inputs::molecules::Input;
use knotdock::interface::heavy_residues;
use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;

/// Most heavy atoms of a residue of a trace; a backbone has four.
const MOST: usize = 2;

/// Fewest residues that make a trace.
const FEWEST: usize = 3;

/// Atoms that a residue of a trace has one of, in proteins and nucleic acids. Beads of other coarse-grained models have
/// a warning of their own.
const TRACED: [&str; 7] = ["CA", "CB", "P", "C1'", "C3'", "C4'", "C5'"];

/// Refuses molecules with a chain that is a trace for the most part; `sides` are their names.
pub fn refuse_traces<'a>(
    inputs: impl IntoIterator<Item = (&'a str, &'a Input)>,
) -> Result<(), Error> {
    for (side, input) in inputs {
        if let Some(chain) = trace(&input.molecule) {
            let chain = match chain.as_str() {
                "" => "its chain without a name".to_owned(),
                name => format!("its chain {name}"),
            };
            return Err(Error::input(format!(
                "the {side} is no all-atom model: of most residues of {chain} the file has one or two atoms, such as CA \
                 alone, and the score is of all heavy atoms"
            ))
            .at(&input.record.path)
            .help(
                "rebuild the missing atoms first, as PULCHRA and MODELLER do, give an all-atom model, or pick other chains \
                 as in FILE:A,B",
            ));
        }
    }
    Ok(())
}

/// The first chain that is a trace for the most part.
fn trace(molecule: &Molecule) -> Option<String> {
    // Of each chain, residues that are traced, and those that have more atoms.
    let mut chains: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for atoms in heavy_residues(molecule) {
        let first = atoms.first().map(|&at| &molecule.atoms[at])?;
        let is_traced = |&at: &usize| {
            let atom = &molecule.atoms[at];
            // Calcium is named CA, too.
            TRACED.contains(&atom.name.as_str()) && atom.element != "Ca"
        };
        let [traced, whole] = chains.entry(&first.chain).or_default();
        if atoms.len() > MOST {
            *whole += 1;
        } else if atoms.iter().any(is_traced) {
            *traced += 1;
        }
    }
    let is_trace = |[traced, whole]: &[usize; 2]| *traced >= FEWEST && traced > whole;
    let found = chains.into_iter().find(|(_, counts)| is_trace(counts));
    found.map(|(chain, _)| chain.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_structures::molecule::{InputSpec, ReadOptions, read};

    fn example(keep: impl Fn(&str, &str) -> bool) -> Molecule {
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
        let path = format!("{root}/structures/examples/1ppe_ligand_unbound.pdb");
        let whole = read(&InputSpec::whole(path), &ReadOptions::default()).unwrap();
        let atoms = whole.atoms.into_iter();
        let kept = atoms.filter(|atom| keep(&atom.name, &atom.residue_name));
        Molecule::new(kept.collect(), knotdock_structures::molecule::Format::Pdb)
    }

    /// A file of CA atoms alone was ranked, and the run ended well.
    #[test]
    fn traces_are_found_and_backbones_are_none() {
        assert!(trace(&example(|name, _| name == "CA")).is_some());
        assert!(trace(&example(|name, _| ["CA", "CB"].contains(&name))).is_some());
        assert!(trace(&example(|_, _| true)).is_none());
        assert!(trace(&example(|name, _| ["N", "CA", "C", "O"].contains(&name))).is_none());
        // A few residues of which only the CA is resolved.
        let few = example(|name, residue| name == "CA" || residue != "CYS");
        assert!(trace(&few).is_none());
    }

    #[test]
    fn calcium_is_no_trace() {
        let mut ions = example(|name, _| name == "CA");
        for atom in &mut ions.atoms {
            atom.element = "Ca".to_owned();
        }
        assert!(trace(&ions).is_none());
    }
}
