//! Detection of the atom lines of a PDB file.

/// Whether a record is an atom's.
pub(crate) fn is_atom(record: &str) -> bool {
    record.starts_with("ATOM  ") || record.starts_with("HETATM") || has_wide_serial(record)
}

/// Whether an ATOM record's serial number has grown beyond 99,999 to the left, into columns 6 and 5, as some programs
/// write it.
fn has_wide_serial(record: &str) -> bool {
    let columns = record.strip_prefix("ATOM").and_then(|rest| rest.get(..7));
    columns.is_some_and(|columns| {
        let serial = columns.trim_start_matches(' ');
        serial.len() > 5 && serial.bytes().all(|byte| byte.is_ascii_digit())
    })
}
