//! Atoms by pdbtbx, which reads their names, kinds of record and, of PDB files, coordinates, occupancies and
//! temperature factors.
//!
//! pdbtbx 0.12 refuses or panics on much content of real files. Examples are free-form REMARK, short ATOM lines, odd
//! charge columns, old DBREF and SEQADV, dummy CRYST1, blank residue names, and mmCIF values that a number or a quote
//! breaks. So it is given the atoms of the wanted models alone, each as a repaired record with a serial number. The
//! [`Record`](crate::molecule::read::record::Record) of that number keeps what pdbtbx would change:
//!
//! | fact | what pdbtbx 0.12 does with it |
//! |---|---|
//! | line number, order | regroups atoms by chain, residue and conformer |
//! | blank chain name | invents `A`, `B`, ... |
//! | residue number | adds 10,000 after 9999, for all chains that follow; does not know hybrid-36 |
//! | residue name | cuts it to three letters (PDB), to upper case |
//! | insertion code | makes it a capital |
//! | alternate location | copies the atoms without one into every conformer |
//! | element | guesses calcium for CA when the column is blank |
//! | mmCIF decimals | off by an ulp, and wrong above 2^32 |
//!
//! A panic of pdbtbx, or a record that it refuses, is a defect of these repairs. It becomes an error that asks to report
//! the file. Panic hooks belong to the program and stay as they are.

use std::io::BufReader;
use std::panic::{AssertUnwindSafe, catch_unwind};

use pdbtbx::{ContainsAtomConformer, Context, PDB, PDBError, ReadOptions, StrictnessLevel};

use crate::Error;
use crate::molecule::model::Format;
use crate::molecule::read::{FileContents, Record};

/// Alternate location given to pdbtbx for all atoms, so that it does not copy them into other conformers.
pub(crate) const NO_ALTERNATE: char = '~';

/// How many different residue numbers pdbtbx is shown: few make it fast, and more than one keep residues small.
pub(crate) const SHOWN_NUMBERS: usize = 1000;

/// The header of the atom table that pdbtbx is shown.
pub(crate) const MMCIF_HEADER: &str = "data_atoms\nloop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.label_atom_id\n\
_atom_site.label_alt_id\n_atom_site.label_comp_id\n_atom_site.label_asym_id\n_atom_site.label_seq_id\n\
_atom_site.pdbx_PDB_ins_code\n_atom_site.type_symbol\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n";

/// Takes the records of a file's contents, with the text that pdbtbx reads.
pub(crate) fn records(format: Format, contents: &mut FileContents) -> Result<Vec<Record>, Error> {
    let text = std::mem::take(&mut contents.text);
    let mut records = std::mem::take(&mut contents.records);
    let pdb = read_guarded(&text, format).map_err(|(record, what)| {
        let line = record.and_then(|record| records.get(record));
        refused(&what).on_line(line.map(|record| record.atom.line as u64))
    })?;
    let mut read = 0;
    for placed in pdb.atoms_with_hierarchy() {
        let found = placed.atom();
        let Some(Record { atom, .. }) = records.get_mut(found.serial_number()) else {
            continue;
        };
        read += 1;
        atom.name = found.name().to_owned();
        atom.hetero = found.hetero();
        if format == Format::Pdb {
            atom.position = found.pos().into();
            atom.occupancy = found.occupancy();
            atom.b_factor = found.b_factor();
        }
    }
    if read != records.len() {
        return Err(refused("it lost atoms"));
    }
    Ok(records)
}

fn refused(what: &str) -> Error {
    Error::input(format!("the parser refused the file: {what}"))
        .help("please report this file: the repairs before the parser should have caught it")
}

/// Reads text; where pdbtbx refuses it, the index of the record at fault, if known, and the reason.
fn read_guarded(text: &str, format: Format) -> Result<PDB, (Option<usize>, String)> {
    let read = || {
        let mut options = ReadOptions::new();
        options
            .set_level(StrictnessLevel::Loose)
            .set_only_atomic_coords(true)
            .set_format(match format {
                Format::Pdb => pdbtbx::Format::Pdb,
                Format::Mmcif => pdbtbx::Format::Mmcif,
            });
        options.read_raw(BufReader::new(text.as_bytes()))
    };
    match guarded(read) {
        Ok(Ok((pdb, _))) => Ok(pdb),
        Ok(Err(errors)) => Err(refusal(&errors)),
        Err(panic) => Err((None, panic)),
    }
}

/// Runs what may panic; a panic becomes its message.
fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        let text = payload.downcast_ref::<&str>().map(ToString::to_string);
        let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
        format!("it broke down ({})", text.unwrap_or_default())
    })
}

/// The first error that counts, with the record it belongs to.
fn refusal(errors: &[PDBError]) -> (Option<usize>, String) {
    let error = errors
        .iter()
        .find(|error| error.fails(StrictnessLevel::Loose));
    let Some(error) = error else {
        return (None, "it gave no reason".to_owned());
    };
    let record = match error.context() {
        Context::Line { linenumber, .. } | Context::FullLine { linenumber, .. } => {
            linenumber.checked_sub(1)
        }
        _ => None,
    };
    let (short, long) = (error.short_description(), error.long_description());
    (record, format!("{short}: {long}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_refusal() {
        let refusal = guarded(|| panic!("boom {}", 1)).map(|(): ()| ()).err();
        assert_eq!(refusal.as_deref(), Some("it broke down (boom 1)"));
    }

    /// A blank residue name panics in pdbtbx 0.12 ("Invalid characters in Conformer creation"). When this test fails the
    /// guard is no longer needed for it.
    #[test]
    fn pdbtbx_itself_panics_without_the_repairs() {
        let line =
            "ATOM      0  N       A   1       0.000   0.000   0.000  1.00  0.00              \n";
        let (_, what) = read_guarded(line, Format::Pdb).err().unwrap();
        assert!(what.contains("broke down"), "{what}");
    }
}
