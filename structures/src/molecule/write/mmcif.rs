//! The mmCIF writer: one `_atom_site` table (PDBx/mmCIF dictionary 5).

use std::borrow::Cow;
use std::io::Write;

use crate::molecule::write::error::WriteError;
use crate::molecule::write::row::{Row, plain, rounded};

const COLUMNS: [&str; 20] = [
    "group_PDB",
    "id",
    "type_symbol",
    "label_atom_id",
    "label_alt_id",
    "label_comp_id",
    "label_asym_id",
    "label_entity_id",
    "label_seq_id",
    "pdbx_PDB_ins_code",
    "Cartn_x",
    "Cartn_y",
    "Cartn_z",
    "occupancy",
    "B_iso_or_equiv",
    "auth_seq_id",
    "auth_comp_id",
    "auth_asym_id",
    "auth_atom_id",
    "pdbx_PDB_model_num",
];

/// Writes rows and remarks.
pub(crate) fn write<W: Write>(
    writer: &mut W,
    rows: &[Row<'_>],
    remarks: &[String],
) -> Result<(), WriteError> {
    write_head(writer, remarks)?;
    write_model(writer, rows, (1, 0))?;
    write_end(writer)
}

/// Writes remarks and the names of the columns.
pub(crate) fn write_head<W: Write>(writer: &mut W, remarks: &[String]) -> Result<(), WriteError> {
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
    for column in COLUMNS {
        writeln!(writer, "_atom_site.{column}")?;
    }
    Ok(())
}

/// Writes the end of the table.
pub(crate) fn write_end<W: Write>(writer: &mut W) -> Result<(), WriteError> {
    writeln!(writer, "#")?;
    Ok(())
}

/// Writes the rows of a model with its number, after so many rows of others.
pub(crate) fn write_model<W: Write>(
    writer: &mut W,
    rows: &[Row<'_>],
    (number, before): (usize, usize),
) -> Result<(), WriteError> {
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
fn value(text: &str) -> Result<Cow<'_, str>, WriteError> {
    if text.is_empty() {
        return Ok(Cow::Borrowed("."));
    }
    let lower = text.to_ascii_lowercase();
    let is_reserved = ["data_", "save_", "loop_", "stop_", "global_"]
        .iter()
        .any(|word| lower.starts_with(word));
    let is_null = text == "." || text == "?";
    let is_bare = text.bytes().all(|byte| byte.is_ascii_graphic())
        && !text.starts_with(['_', '#', '$', '\'', '"', '[', ']', ';']);
    if is_bare && !is_reserved && !is_null {
        return Ok(Cow::Borrowed(text));
    }
    if !text.bytes().all(|byte| (32..127).contains(&byte)) {
        return Err(WriteError::Unwritable {
            text: text.to_string(),
        });
    }
    match (text.contains('\''), text.contains('"')) {
        (false, _) => Ok(Cow::Owned(format!("'{text}'"))),
        (true, false) => Ok(Cow::Owned(format!("\"{text}\""))),
        (true, true) => Err(WriteError::Unwritable {
            text: text.to_string(),
        }),
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
