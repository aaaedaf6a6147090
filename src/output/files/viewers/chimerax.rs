//! The script for ChimeraX (its commands `open`, `color`, `select`, `show`), which runs it in the directory of the file.

use super::{CHIMERAX, INTERFACE, RECEPTOR, ViewedComplex, colour};

/// The script.
pub(super) fn script(complexes: &[ViewedComplex]) -> String {
    let mut text =
        format!("# The best poses in ChimeraX: open this file, as by\n#     chimerax {CHIMERAX}\n");
    if complexes.is_empty() {
        return text;
    }
    text += "set bgColor white\n";
    for (place, complex) in complexes.iter().enumerate() {
        let id = place + 1;
        let [receptor, ligand] = complex.chains.each_ref().map(|chains| chosen(id, chains));
        text += &format!(
            "open top/{file} id {id} name \"rank {rank}\"\ncolor {receptor} #{RECEPTOR}\ncolor {ligand} #{colour}\n\
             name interface{rank} ({receptor} & (({ligand}) :< {INTERFACE})) | ({ligand} & (({receptor}) :< \
             {INTERFACE}))\n",
            file = complex.file,
            rank = complex.rank,
            colour = colour(place),
        );
    }
    text += &format!(
        "hide atoms\nshow cartoons\nshow interface{rank} atoms\nstyle stick\ncolor byhetero\nhide #2-{last} models\n\
         view #1\n",
        rank = complexes[0].rank,
        // A range that begins behind the last model names none.
        last = complexes.len().max(2),
    );
    text
}

/// The atoms of some chains of a model.
fn chosen(id: usize, chains: &[String]) -> String {
    let chains: Vec<String> = chains.iter().map(|name| format!("#{id}/{name}")).collect();
    format!("({})", chains.join(" | "))
}
