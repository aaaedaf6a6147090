//! The mmCIF writer: one `_atom_site` table (PDBx/mmCIF dictionary 5).

use std::borrow::Cow;
use std::io::{self, Write};

use crate::Error;
use crate::molecule::write::{Row, plain, rounded};

const COLUMNS: &str = "group_PDB id type_symbol label_atom_id label_alt_id label_comp_id label_asym_id label_entity_id \
    label_seq_id pdbx_PDB_ins_code Cartn_x Cartn_y Cartn_z occupancy B_iso_or_equiv auth_seq_id auth_comp_id auth_asym_id \
    auth_atom_id pdbx_PDB_model_num";

pub(super) fn write_head<W: Write>(writer: &mut W, remarks: &[String]) -> io::Result<()> {
    writeln!(writer, "data_knotdock\n_entry.id knotdock")?;
    if !remarks.is_empty() {
        writeln!(
            writer,
            "_pdbx_database_remark.id 99\n_pdbx_database_remark.text\n;"
        )?;
        for remark in remarks {
            // A semicolon at the start of a line would end the text.
            let guard = if remark.starts_with(';') { " " } else { "" };
            writeln!(writer, "{guard}{}", plain(remark))?;
        }
        writeln!(writer, ";")?;
    }
    writeln!(writer, "loop_")?;
    for column in COLUMNS.split(' ') {
        writeln!(writer, "_atom_site.{column}")?;
    }
    Ok(())
}

pub(super) fn write_end<W: Write>(writer: &mut W) -> io::Result<()> {
    writeln!(writer, "#")
}

/// Writes the rows of a model with its number, after that many rows of others.
pub(super) fn write_model<W: Write>(
    writer: &mut W,
    rows: &[Row<'_>],
    number: usize,
    before: usize,
) -> io::Result<()> {
    for (index, row) in rows.iter().enumerate() {
        let atom = row.atom;
        let group = if atom.hetero { "HETATM" } else { "ATOM" };
        let element = atom.element.to_ascii_uppercase();
        let name = value(&atom.name)?;
        let residue = value(&atom.residue_name)?;
        let chain = value(row.chain)?;
        let insertion = atom.insertion_code.map(String::from);
        let insertion = insertion.as_deref().map_or(Ok("?".into()), value)?;
        let [x, y, z] = atom.position.map(|x| rounded(x, 1000.0));
        writeln!(
            writer,
            "{group:<6} {} {element} {name} . {residue} {chain} ? . {insertion} {x:.3} {y:.3} {z:.3} {:.2} {:.2} {} \
             {residue} {chain} {name} {number}",
            before + index + 1,
            rounded(atom.occupancy, 100.0),
            rounded(atom.b_factor, 100.0),
            atom.residue_number,
        )?;
    }
    Ok(())
}

/// A text as a CIF value: bare where it can be, quoted where it must be, `.` where it is empty.
fn value(text: &str) -> io::Result<Cow<'_, str>> {
    if text.is_empty() {
        return Ok(Cow::Borrowed("."));
    }
    let lower = text.to_ascii_lowercase();
    let mut reserved = ["data_", "save_", "loop_", "stop_", "global_"].iter();
    let is_bare = text.bytes().all(|byte| byte.is_ascii_graphic())
        && !text.starts_with(['_', '#', '$', '\'', '"', '[', ']', ';'])
        && !reserved.any(|word| lower.starts_with(word))
        && !matches!(text, "." | "?");
    let is_writable = text.bytes().all(|byte| (32..127).contains(&byte));
    match (text.contains('\''), text.contains('"')) {
        _ if is_bare => Ok(Cow::Borrowed(text)),
        (false, _) if is_writable => Ok(Cow::Owned(format!("'{text}'"))),
        (true, false) if is_writable => Ok(Cow::Owned(format!("\"{text}\""))),
        _ => {
            let message = format!("'{text}' cannot be written as an mmCIF value");
            Err(io::Error::other(Error::input(message)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_quoted_where_they_would_mean_something_else() {
        let of = |text| value(text).unwrap().into_owned();
        assert_eq!(of("O5'"), "O5'");
        assert_eq!(of("A-2"), "A-2");
        assert_eq!(of("."), "'.'");
        assert_eq!(of("_x"), "'_x'");
        assert_eq!(of("loop_1"), "'loop_1'");
        assert_eq!(of("'"), "\"'\"");
        assert_eq!(of(""), ".");
        assert!(value("'\"").is_err());
        assert!(value("a\nb").is_err());
    }
}
