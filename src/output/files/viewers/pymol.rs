//! The script for PyMOL (its commands `load`, `color`, `select`, `show`).

use super::{INTERFACE, PYMOL, RECEPTOR, ViewedComplex, colour};

/// The script.
pub(super) fn script(complexes: &[ViewedComplex]) -> String {
    let mut text = format!(
        "# The best poses in PyMOL: go to this directory, then\n#     pymol {PYMOL}\nbg_color white\n"
    );
    for (place, complex) in complexes.iter().enumerate() {
        let name = object(complex);
        let [receptor, ligand] = complex
            .chains
            .each_ref()
            .map(|chains| chosen(&name, chains));
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
        let name = object(first);
        // What is no polymer, such as a cofactor, has no cartoon.
        text += &format!(
            "group poses, rank_*\ngroup interfaces, interface_*\nshow sticks, interface_{rank:04} and {name} and not \
             hydrogens\nshow sticks, {name} and organic\nutil.cnc {name}\nenable {name}\ndeselect\norient {name}\n",
            rank = first.rank,
        );
    }
    text
}

fn object(complex: &ViewedComplex) -> String {
    format!("rank_{:04}", complex.rank)
}

/// The atoms of some chains of an object.
fn chosen(object: &str, chains: &[String]) -> String {
    let chains: Vec<String> = chains
        .iter()
        .map(|name| format!("chain \"{name}\""))
        .collect();
    match chains.is_empty() {
        true => "none".to_owned(),
        false => format!("({object} and ({}))", chains.join(" or ")),
    }
}
