//! Atoms from filtered text, by pdbtbx.
//!
//! Names, record kinds (ATOM or HETATM) and, of PDB files, coordinates, occupancies and temperature factors are taken
//! from pdbtbx. All else it changes, as the table of the record filter lists, and comes from the [`AtomRecord`] of the
//! same serial number.
//!
//! pdbtbx panics on much that files hold. The record filter gives it nothing of that kind, so a panic here is a defect
//! of the filter: it becomes [`ReadError::Parser`], which asks to report the file. Panic hooks belong to the program
//! and stay as they are.

use std::io::BufReader;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use pdbtbx::{ContainsAtomConformer, Context, PDB, PDBError, ReadOptions, StrictnessLevel};

use crate::molecule::model::format::Format;
use crate::molecule::read::error::ReadError;
use crate::molecule::read::record_filter::record::{AtomRecord, Exact, FilteredRecords};

/// One atom as pdbtbx and the record filter together know it.
#[derive(Clone)]
pub(crate) struct Parsed {
    pub(crate) name: String,
    pub(crate) hetero: bool,
    pub(crate) exact: Exact,
    pub(crate) raw: AtomRecord,
}

/// Reads filtered text by pdbtbx and joins the carried facts by serial number, in file order.
pub(crate) fn parse(
    file: &Path,
    format: Format,
    filtered: FilteredRecords,
) -> Result<Vec<Parsed>, ReadError> {
    let pdb = read_guarded(&filtered.text, format).map_err(|refusal| ReadError::Parser {
        file: file.to_path_buf(),
        line: refusal
            .record
            .and_then(|record| filtered.records.get(record))
            .map(|raw| raw.line),
        what: refusal.what,
    })?;
    let mut facts: Vec<Option<Facts>> = Vec::new();
    facts.resize_with(filtered.records.len(), || None);
    for placed in pdb.atoms_with_hierarchy() {
        let atom = placed.atom();
        let (x, y, z) = atom.pos();
        if let Some(place) = facts.get_mut(atom.serial_number()) {
            *place = Some(Facts {
                name: atom.name().to_string(),
                hetero: atom.hetero(),
                exact: Exact {
                    position: [x, y, z],
                    occupancy: atom.occupancy(),
                    b_factor: atom.b_factor(),
                },
            });
        }
    }
    let joined = filtered.records.into_iter().zip(facts);
    joined
        .map(|(raw, facts)| match facts {
            Some(facts) => Ok(Parsed {
                name: facts.name,
                hetero: facts.hetero,
                exact: raw.exact.unwrap_or(facts.exact),
                raw,
            }),
            None => Err(ReadError::Parser {
                file: file.to_path_buf(),
                line: Some(raw.line),
                what: "it lost this atom".to_string(),
            }),
        })
        .collect()
}

/// Data taken from pdbtbx.
struct Facts {
    name: String,
    hetero: bool,
    exact: Exact,
}

/// Why pdbtbx gave nothing.
struct Refusal {
    /// Index of the atom record, where known.
    record: Option<usize>,
    what: String,
}

fn read_guarded(text: &str, format: Format) -> Result<PDB, Refusal> {
    guarded(|| {
        let mut options = ReadOptions::new();
        options
            .set_level(StrictnessLevel::Loose)
            .set_only_atomic_coords(true)
            .set_format(match format {
                Format::Pdb => pdbtbx::Format::Pdb,
                Format::Mmcif => pdbtbx::Format::Mmcif,
            });
        options.read_raw(BufReader::new(text.as_bytes()))
    })?
    .map(|(pdb, _)| pdb)
    .map_err(|errors| refusal(&errors))
}

/// Runs what may panic; a panic becomes a refusal.
fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, Refusal> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        let said = payload
            .downcast_ref::<&str>()
            .map(|text| (*text).to_string())
            .or_else(|| payload.downcast_ref::<String>().cloned())
            .unwrap_or_default();
        Refusal {
            record: None,
            what: format!("it broke down ({said})"),
        }
    })
}

/// The first error that counts, with the record it belongs to.
fn refusal(errors: &[PDBError]) -> Refusal {
    let Some(error) = errors
        .iter()
        .find(|error| error.fails(StrictnessLevel::Loose))
    else {
        return Refusal {
            record: None,
            what: "it gave no reason".to_string(),
        };
    };
    let line = match error.context() {
        Context::Line { linenumber, .. } | Context::FullLine { linenumber, .. } => {
            linenumber.checked_sub(1)
        }
        _ => None,
    };
    Refusal {
        record: line,
        what: format!(
            "{}: {}",
            error.short_description(),
            error.long_description()
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_refusal() {
        let refusal = guarded(|| panic!("boom {}", 1)).map(|(): ()| ()).err();
        assert_eq!(
            refusal.map(|refusal| refusal.what).as_deref(),
            Some("it broke down (boom 1)")
        );
    }

    #[test]
    fn pdbtbx_itself_panics_where_the_record_filter_guards() {
        // A blank residue name panics in pdbtbx 0.12 ("Invalid characters in Conformer creation"). When this test fails
        // the guard is no longer needed for it.
        let line =
            "ATOM      0  N       A   1       0.000   0.000   0.000  1.00  0.00              \n";
        let refusal = read_guarded(line, Format::Pdb).err().unwrap();
        assert!(refusal.what.contains("broke down"), "{}", refusal.what);
    }
}
