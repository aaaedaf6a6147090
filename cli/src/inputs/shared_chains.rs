//! The warnings that one molecule to dock is in the file of the other, or is the other.

use knotdock::evaluate::{SharedChains, shared_chains};
use knotdock_structures::molecule::Molecule;

use crate::inputs::bodies::Bodies;
use crate::inputs::molecules::Input;

impl Bodies {
    /// Adds a warning to the report of a molecule that holds the other one already, with further chains beside, or is
    /// the same.
    pub fn note_shared_chains(&mut self) {
        let Self::Molecules(inputs) = self else {
            return;
        };
        let [receptor, ligand] = inputs.as_mut();
        if let Some(shared) = shared_chains(&ligand.molecule, &receptor.molecule) {
            let text = warning(&shared, ["receptor", "ligand"], receptor);
            receptor.molecule.report.warnings.push(text);
        } else if let Some(shared) = shared_chains(&receptor.molecule, &ligand.molecule) {
            let text = warning(&shared, ["ligand", "receptor"], ligand);
            ligand.molecule.report.warnings.push(text);
        } else if receptor.record.is_like(&ligand.record)
            || are_alike(&receptor.molecule, &ligand.molecule)
        {
            let text = "it is the same molecule as the receptor: if the two are related by a rotation, as in a \
                        homodimer, dock one file with --symmetry C2, which searches such poses alone";
            ligand.molecule.report.warnings.push(text.to_owned());
        }
    }
}

/// Whether two molecules have the same peptides by their sequences, and some.
fn are_alike(one: &Molecule, other: &Molecule) -> bool {
    let sequences = |molecule: &Molecule| {
        let chains = molecule.peptide_chains().into_iter();
        let mut sequences: Vec<String> = chains.map(|chain| chain.sequence()).collect();
        sequences.sort_unstable();
        sequences
    };
    let sequences = [one, other].map(sequences);
    !sequences[0].is_empty() && sequences[0] == sequences[1]
}

/// What one side holds of the other, and how to leave it out; `holder` is the side that holds it.
fn warning(shared: &SharedChains, [side, other]: [&str; 2], holder: &Input) -> String {
    let shown = |name: &str| if name.is_empty() { "_" } else { name }.to_owned();
    let names: Vec<String> = shared.pairs.iter().map(|(_, own)| shown(own)).collect();
    let others: Vec<String> = shared.pairs.iter().map(|(one, _)| shown(one)).collect();
    let plural = |count: usize| if count == 1 { "chain" } else { "chains" };
    let has = if names.len() == 1 { "has" } else { "have" };
    let remedy = match shared.rest.as_slice() {
        [] => "split the file, whose chains share one name".to_owned(),
        rest => {
            let rest: Vec<String> = rest.iter().map(|name| shown(name)).collect();
            let file = holder.record.path.file_name().unwrap_or_default();
            format!(
                "pick the rest with {}:{}",
                file.to_string_lossy(),
                rest.join(",")
            )
        }
    };
    format!(
        "the {side} holds the {other} already: its {} {} {has} the sequence of {} {} of the {other}, and fills \
         the place where that would dock; {remedy}",
        plural(names.len()),
        names.join(", "),
        plural(others.len()),
        others.join(", "),
    )
}
