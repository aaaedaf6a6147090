//! Reports of predicted models: a table of their pairs of chains, the structures, and maps of PAE.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use csv::StringRecord;
use serde_json::{Value, json};

use crate::report::MAX_ROWS;
use crate::report::columns::of_table;
use crate::report::html::{Page, paragraph, section};
use crate::report::shown::rows;
use crate::report::viewer::{Viewer, on_request};
use knotdock::models::Prediction;
use knotdock::models::confidence::Pae;
use knotdock::models::tokens::PolymerChain;
use knotdock_structures::molecule::{Format, Molecule, fits, write_renamed};

/// Most bytes of structures in a report, before they are packed.
const MAX_STRUCTURES: usize = 24 << 20;
/// Most cells of all maps of a report.
const MAX_CELLS: usize = 8 << 20;
/// Most cells of a map along either axis.
const MAX_SIDE: usize = 320;
/// Cells of a map count PAE in steps of this many Å; the last one of 255 stands for all above.
const STEP: f64 = 0.125;

/// Models as a report shows them, gathered one after another within its bounds.
#[derive(Default)]
pub struct ShownModels {
    models: Vec<Value>,
    /// Of each pair of chains its model, chains and map.
    pairs: Vec<Value>,
    bytes: usize,
    cells: usize,
    structures_left_out: usize,
    maps_left_out: usize,
}

impl ShownModels {
    /// Adds a model with all its pairs of chains.
    pub fn add(&mut self, prediction: &Prediction) {
        let text = structure(&prediction.molecules);
        let (format, text) = match text {
            (format, text) if self.bytes + text.len() <= MAX_STRUCTURES => {
                self.bytes += text.len();
                (format, Some(text))
            }
            (format, _) => {
                self.structures_left_out += 1;
                (format, None)
            }
        };
        let chains = &prediction.polymers.chains;
        let of_chain = |(chain, molecule): (&PolymerChain, &Molecule)| {
            let numbers = chain.residues.iter().map(|residue| &residue.number);
            json!({ "name": chain.name, "atoms": molecule.atoms.len(), "numbers": numbers.collect::<Vec<_>>() })
        };
        let has_plddt = chains
            .iter()
            .all(|chain| chain.residues.iter().all(|one| one.plddt.is_some()));
        let pae = prediction.confidence.as_ref();
        let pae = pae.and_then(|found| found.pae.as_ref());
        for pair in prediction.pairs() {
            let map = pae.and_then(|pae| {
                let tokens = pair.iter().flat_map(|&at| &chains[at].residues);
                let tokens: Vec<usize> = tokens.map(|residue| residue.token).collect();
                let cells = tokens.len().min(MAX_SIDE).pow(2);
                if self.cells + cells > MAX_CELLS {
                    self.maps_left_out += 1;
                    return None;
                }
                self.cells += cells;
                Some(STANDARD.encode(map(pae, &tokens)))
            });
            self.pairs.push(
                json!({ "model": self.models.len(), "chains": pair, "map": map, "has_pae": pae.is_some() }),
            );
        }
        let shown = chains.iter().zip(&prediction.molecules).map(of_chain);
        self.models.push(json!({
            "text": text,
            "format": format.extension(),
            "has_plddt": has_plddt,
            "chains": shown.collect::<Vec<_>>(),
        }));
    }

    /// Sentences on the structures and maps that the bounds leave out.
    fn left_out(&self) -> Vec<String> {
        let sentence = |count: usize, things: &str, bound: String| {
            (count > 0).then(|| {
                format!("The report has no {things} of the last {count}: it holds {bound}.")
            })
        };
        let structures = sentence(
            self.structures_left_out,
            "structures",
            format!("{} MB of coordinates", MAX_STRUCTURES >> 20),
        );
        let maps = sentence(
            self.maps_left_out,
            "maps of PAE",
            format!("{} million cells", MAX_CELLS >> 20),
        );
        structures.into_iter().chain(maps).collect()
    }
}

/// The chains of a model as text in PDB, or in mmCIF if they do not fit.
fn structure(chains: &[Molecule]) -> (Format, String) {
    let atoms = chains.iter().flat_map(|chain| chain.atoms.iter().cloned());
    let molecule = Molecule::new(atoms.collect(), Format::Pdb);
    let format = match fits(Format::Pdb, &molecule) {
        Ok(()) => Format::Pdb,
        Err(_) => Format::Mmcif,
    };
    let mut text = Vec::new();
    // Writing to memory does not fail, and the format fits.
    let written = write_renamed(&mut text, format, &molecule, &[]);
    assert!(written.is_ok(), "{written:?}");
    (format, String::from_utf8_lossy(&text).into_owned())
}

/// The PAE of some tokens among themselves as a square of cells, row-major; each cell is the mean of its tokens.
fn map(pae: &Pae, tokens: &[usize]) -> Vec<u8> {
    let side = tokens.len().min(MAX_SIDE);
    let bounds = |cell: usize| cell * tokens.len() / side..(cell + 1) * tokens.len() / side;
    let mut cells = Vec::with_capacity(side * side);
    for row in 0..side {
        for column in 0..side {
            let (mut sum, mut count) = (0.0, 0.0);
            for &aligned in &tokens[bounds(row)] {
                let errors = pae.row(aligned);
                for &scored in &tokens[bounds(column)] {
                    sum += errors.get(scored).copied().map_or(0.0, f64::from);
                    count += 1.0;
                }
            }
            cells.push((sum / count / STEP).round().min(255.0) as u8);
        }
    }
    cells
}

/// The report of predicted models.
pub struct ModelsReport<'a> {
    pub title: String,
    pub sentences: Vec<String>,
    pub header: StringRecord,
    /// A row for each pair of chains of each model, in the order in which they were added.
    pub records: Vec<StringRecord>,
    /// Columns that are shown at first.
    pub main: &'a [&'a str],
    pub shown: ShownModels,
}

impl ModelsReport<'_> {
    /// The page, whole. Without a viewer it says how to get the view.
    pub fn text(mut self, viewer: Option<&Viewer>) -> String {
        let all = self.records.len();
        assert_eq!(all, self.shown.pairs.len(), "one row per pair of chains");
        self.sentences.extend(self.shown.left_out());
        if all > MAX_ROWS {
            self.sentences.push(format!(
                "This report shows the first {MAX_ROWS} of {all} rows."
            ));
            self.records.truncate(MAX_ROWS);
            self.shown.pairs.truncate(MAX_ROWS);
        }
        let columns = of_table(&self.header, &self.records, self.main);
        let data = json!({
            "kind": "models",
            "caption": "Pairs of chains. Choose a row to see it.",
            "columns": columns,
            "rows": rows(&columns, &self.records),
            "models": self.shown.models,
            "pairs": self.shown.pairs,
            "step": STEP,
        });
        let words: String = self
            .sentences
            .iter()
            .map(|sentence| paragraph(std::slice::from_ref(sentence)))
            .collect();
        let explorer = include_str!("page/models.html");
        let explorer = explorer.replace("{{lacking}}", &on_request(viewer));
        Page {
            title: self.title,
            sections: vec![
                section("summary", "Summary", &words),
                section("models", "Models", &explorer),
            ],
            data: &data,
            viewer,
        }
        .text()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cells are in steps of 0.125 Å, and those of more tokens than cells are means of equal shares.
    #[test]
    fn maps_are_means_of_blocks() {
        let pae = |tokens: usize, error: fn(usize, usize) -> f32| Pae {
            tokens,
            values: (0..tokens * tokens)
                .map(|at| error(at / tokens, at % tokens))
                .collect(),
        };
        let small = pae(3, |i, j| (i + 10 * j) as f32);
        // Tokens 2 and 0, in this order; row 2 is aligned.
        assert_eq!(map(&small, &[2, 0]), [176, 16, 160, 0]);
        let large = pae(2 * MAX_SIDE, |i, _| if i % 2 == 0 { 1.0 } else { 40.0 });
        let tokens: Vec<usize> = (0..2 * MAX_SIDE).collect();
        let cells = map(&large, &tokens);
        assert_eq!(cells.len(), MAX_SIDE * MAX_SIDE);
        assert!(cells.iter().all(|&cell| cell == 164));
        assert_eq!(map(&pae(1, |_, _| 40.0), &[0]), [255]);
    }
}
