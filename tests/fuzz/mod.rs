//! Fuzzing of every reader: mutated inputs are read or refused, and nothing panics.
//!
//! Here 3,000 inputs per reader; a million by `cargo run --release --example fuzz_readers -- 1000000`. Its findings are
//! in [`found`], each with its story.

mod found;
mod mutations;
mod readers;
pub mod seeds;

use readers::Reader;

/// Inputs a reader.
const INPUTS: u64 = 3_000;

#[test]
fn mutated_inputs_are_read_or_refused() {
    std::thread::scope(|scope| {
        for (number, reader) in Reader::ALL.into_iter().enumerate() {
            scope.spawn(move || {
                let scratch = tempfile::tempdir().unwrap();
                let seeds = reader.seeds();
                for seed in &seeds {
                    assert!(
                        reader.read(seed, scratch.path(), 0),
                        "a seed of {reader:?} is refused"
                    );
                }
                let mut taken = 0;
                for index in 0..INPUTS {
                    let bytes = mutations::mutated(&seeds, number as u64, index);
                    let shown =
                        std::panic::AssertUnwindSafe(|| reader.read(&bytes, scratch.path(), index));
                    match std::panic::catch_unwind(shown) {
                        Ok(was_taken) => taken += u64::from(was_taken),
                        Err(_) => panic!(
                            "{reader:?}, input {index}: {:?}",
                            String::from_utf8_lossy(&bytes)
                        ),
                    }
                }
                // Were all refused, or all taken, the changes would reach nothing.
                assert!(
                    (INPUTS / 500..INPUTS - INPUTS / 50).contains(&taken),
                    "{reader:?} took {taken}"
                );
            });
        }
    });
}
