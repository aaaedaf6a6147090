//! Damaged files are read or refused, and never break the parser after the repairs.

#![cfg(feature = "molecule")]

use knotdock_structures::molecule::{Format, InputSpec, ReadOptions, read, write_molecule};
use proptest::prelude::*;

/// The first atoms of the example in one format, as bytes.
fn sample(format: Format) -> Vec<u8> {
    let path =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/1ppe_ligand_bound.pdb");
    let mut molecule = read(&InputSpec::whole(path), &ReadOptions::default()).unwrap();
    molecule.atoms.truncate(12);
    let mut text = Vec::new();
    write_molecule(&mut text, format, &molecule, &["a remark".to_string()]).unwrap();
    text
}

/// One change: overwrite, remove or insert a byte at a place (as a share of the length).
type Change = (u8, f64, u8);

fn damaged(mut bytes: Vec<u8>, changes: &[Change]) -> Vec<u8> {
    for &(kind, share, byte) in changes {
        if bytes.is_empty() {
            break;
        }
        let at = ((share * bytes.len() as f64) as usize).min(bytes.len().saturating_sub(1));
        match kind {
            0 => bytes[at] = byte,
            1 => drop(bytes.remove(at)),
            2 => bytes.insert(at, byte),
            _ => bytes.truncate(at + 1),
        }
    }
    bytes
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    // Bytes that mean something to one of the formats come up more often than others.
    let byte = prop_oneof![
        any::<u8>(),
        prop::sample::select(b"\n\r\t '\"#_;.?-+0E~A".to_vec())
    ];
    let kind = prop_oneof![8 => 0..3_u8, 1 => Just(3_u8)];
    prop::collection::vec((kind, 0.0..1.0_f64, byte), 1..12)
}

fn check(format: Format, changes: &[Change]) -> Result<(), TestCaseError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x").with_extension(format.extension());
    std::fs::write(&path, damaged(sample(format), changes)).unwrap();
    match read(&InputSpec::whole(path), &ReadOptions::default()) {
        Ok(molecule) => {
            prop_assert!(molecule.knots().is_ok());
        }
        Err(error) => {
            // The repairs let something through that pdbtbx refused or panicked on.
            prop_assert!(!error.message().contains("the parser refused"), "{error}");
            prop_assert!(!error.to_string().is_empty() && error.file().is_some());
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_pdb(changes in changes()) {
        check(Format::Pdb, &changes)?;
    }

    #[test]
    fn damaged_mmcif(changes in changes()) {
        check(Format::Mmcif, &changes)?;
    }
}
