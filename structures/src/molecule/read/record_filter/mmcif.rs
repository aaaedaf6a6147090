//! The record filter for mmCIF files: the `_atom_site` table of the first data block that has one, and what the file
//! says beside it.

use std::path::Path;

use crate::molecule::read::error::ReadError;
use crate::molecule::read::policy::ModelChoice;
use crate::molecule::read::record_filter::assembly_items::Items;
use crate::molecule::read::record_filter::atom_site::{Table, item};
use crate::molecule::read::record_filter::provenance::ProvenanceItems;
use crate::molecule::read::record_filter::record::FilteredRecords;
use crate::molecule::read::record_filter::tokens::{Kind, Token, tokens};

/// Sieves the text of an mmCIF file; of the models those that `model` takes.
pub(crate) fn filter(
    file: &Path,
    text: &str,
    model: ModelChoice,
) -> Result<FilteredRecords, ReadError> {
    let mut filtered = FilteredRecords::default();
    let mut table = Table::default();
    let mut items = ProvenanceItems::default();
    let mut assemblies = Items::default();
    let mut stream = tokens(text).peekable();
    while let Some(token) = stream.next() {
        match token.kind {
            Kind::Data(name) if !table.values.is_empty() => {
                filtered.other_blocks = blocks_with_atoms((token.line, name), stream);
                break;
            }
            Kind::Data(_) => filtered.recognised = true,
            Kind::Loop => {
                let mut tags = Vec::new();
                while let Some(Kind::Tag(tag)) = stream.peek().map(|next| next.kind) {
                    tags.push(tag);
                    stream.next();
                }
                let is_atoms = tags.iter().any(|tag| item(tag).is_some());
                if is_atoms {
                    table = Table::new(token.line, &tags);
                }
                let mut columns = tags.iter().cycle();
                while let Some(next) = stream.next_if(|next| is_value(next.kind)) {
                    check_closed(file, next)?;
                    if is_atoms {
                        table.values.push(next);
                    } else if let Some(tag) = columns.next() {
                        items.note(tag, next.kind);
                        assemblies.note(tag, next);
                    }
                }
            }
            // A single atom may stand as pairs of tag and value.
            Kind::Tag(tag) => {
                let value = stream.next_if(|next| is_value(next.kind));
                if let Some(value) = value {
                    check_closed(file, value)?;
                    items.note(tag, value.kind);
                    assemblies.note(tag, value);
                    if let Some(item) = item(tag) {
                        table.line = token.line;
                        table.items.push(item.to_ascii_lowercase());
                        table.values.push(value);
                    }
                }
            }
            Kind::Unclosed => check_closed(file, token)?,
            Kind::Bare(_) | Kind::Quoted(_) => {}
        }
    }
    filtered.provenance = items.provenance();
    filtered.assemblies = assemblies.assemblies();
    table.filter(file, model, &mut filtered)?;
    Ok(filtered)
}

/// Lines and names of the data blocks that have an atom table, from the one given on.
fn blocks_with_atoms<'a>(
    first: (usize, &'a str),
    rest: impl Iterator<Item = Token<'a>>,
) -> Vec<(usize, String)> {
    let (mut block, mut found) = (first, Vec::<(usize, String)>::new());
    for token in rest {
        match token.kind {
            Kind::Data(name) => block = (token.line, name),
            Kind::Tag(tag)
                if item(tag).is_some() && found.last().is_none_or(|last| last.0 != block.0) =>
            {
                found.push((block.0, block.1.to_owned()));
            }
            _ => {}
        }
    }
    found
}

fn is_value(kind: Kind<'_>) -> bool {
    matches!(kind, Kind::Bare(_) | Kind::Quoted(_) | Kind::Unclosed)
}

fn check_closed(file: &Path, token: Token<'_>) -> Result<(), ReadError> {
    if token.kind == Kind::Unclosed {
        return Err(ReadError::BrokenCif {
            file: file.to_path_buf(),
            line: token.line,
            what: "a quoted value or text field is never closed".to_string(),
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// pdbtbx goes through all residues of a chain for each new one: 200,000 waters took 10.9 s. So it is shown few of
    /// them, whatever their number, and the others' numbers pass it by.
    #[test]
    fn pdbtbx_is_shown_a_bounded_number_of_residues() {
        let head = "data_x\nloop_\n_atom_site.id\n_atom_site.label_atom_id\n_atom_site.label_comp_id\n\
                    _atom_site.auth_asym_id\n_atom_site.auth_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n\
                    _atom_site.Cartn_z\n";
        let shown = |waters: usize| {
            let rows = (1..=waters).map(|number| format!("{number} O HOH W {number} 1 2 3\n"));
            let text = head.to_owned() + &rows.collect::<String>();
            let model = ModelChoice::Number(1);
            let filtered = filter(Path::new("x.cif"), &text, model).unwrap();
            assert_eq!(filtered.records.len(), waters);
            let numbers = filtered
                .text
                .lines()
                .filter(|line| line.starts_with("ATOM"));
            let number = |line: &str| line.split_whitespace().nth(6).map(str::to_owned);
            numbers.filter_map(number).collect::<HashSet<_>>().len()
        };
        assert_eq!(shown(900), 900);
        assert_eq!(shown(3000), shown(9000));
    }
}
