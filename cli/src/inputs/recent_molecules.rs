//! Molecules that were read last, for batches in which a receptor comes again with one ligand after another.
//!
//! A molecule is known again by the content of its file, so that a file which changes meanwhile is read anew.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use knotdock_structures::Error;
use knotdock_structures::molecule::{InputSpec, Molecule, ReadOptions, read_bytes};

use knotdock::output::records::input_record::InputRecord;

/// Molecules that are held: those of a few pairs that are docked side by side.
const HELD: usize = 8;

/// What was read, and how.
struct Recent {
    spec: InputSpec,
    record: InputRecord,
    options: ReadOptions,
    molecule: Arc<Molecule>,
}

static IS_KEPT: AtomicBool = AtomicBool::new(false);
static RECENT: Mutex<Vec<Recent>> = Mutex::new(Vec::new());

/// From now on molecules are held that are read.
pub fn keep_recent() {
    IS_KEPT.store(true, Ordering::Relaxed);
}

/// Reads a molecule from the bytes of its file, unless it is one of those that are held.
///
/// # Errors
/// As [`read_bytes`].
pub fn read_recent(
    (spec, record): (&InputSpec, &InputRecord),
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<Molecule, Error> {
    if !IS_KEPT.load(Ordering::Relaxed) {
        return read_bytes(spec, bytes.to_vec(), options);
    }
    let is_same = |recent: &Recent| {
        recent.record == *record && recent.spec == *spec && recent.options == *options
    };
    // A list whose holder panicked is as good as it was.
    let held = || {
        RECENT
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    };
    let found = {
        let mut list = held();
        let place = list.iter().position(is_same);
        // The one that was used last is the last to go.
        place.map(|place| {
            let recent = list.remove(place);
            let molecule = Arc::clone(&recent.molecule);
            list.push(recent);
            molecule
        })
    };
    if let Some(molecule) = found {
        return Ok(Molecule::clone(&molecule));
    }
    let molecule = read_bytes(spec, bytes.to_vec(), options)?;
    let mut list = held();
    if list.len() >= HELD {
        list.remove(0);
    }
    list.push(Recent {
        spec: spec.clone(),
        record: record.clone(),
        options: options.clone(),
        molecule: Arc::new(molecule.clone()),
    });
    Ok(molecule)
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_structures::molecule::Waters;

    /// A file that changes under its name is read anew, and other options read another molecule.
    #[test]
    fn a_molecule_is_known_by_the_content_of_its_file() {
        keep_recent();
        let spec = InputSpec::whole("recent.pdb");
        let atom = |x: f64| {
            format!(
                "ATOM      1  CA  ALA A   1    {x:8.3}   2.000   3.000  1.00 10.00           C\n"
            )
        };
        let read = |x: f64, options: &ReadOptions| {
            let bytes = atom(x).into_bytes();
            let record = InputRecord::new(&spec, &bytes);
            read_recent((&spec, &record), &bytes, options)
                .unwrap()
                .atoms[0]
                .position[0]
        };
        let options = ReadOptions::default();
        for x in [1.0, 1.0, 4.0, 1.0] {
            assert_eq!(read(x, &options), x);
        }
        for number in 0..2 * HELD {
            assert_eq!(read(number as f64, &options), number as f64);
        }
        assert!(RECENT.lock().unwrap().len() <= HELD);
        let other = ReadOptions {
            waters: Waters::Keep,
            ..options.clone()
        };
        assert_eq!(read(1.0, &other), 1.0);
    }
}
