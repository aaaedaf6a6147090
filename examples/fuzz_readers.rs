//! Fuzzes every reader on stable Rust: `cargo run --release --example fuzz_readers -- 1000000 [READER]`.
//!
//! The n-th input of a reader is the same everywhere, so that what is reported can be repeated. Exit code 1 when anything broke.

#[path = "../tests/fuzz/mutations.rs"]
mod mutations;
#[path = "../tests/fuzz/readers.rs"]
mod readers;
#[path = "../tests/fuzz/seeds.rs"]
mod seeds;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;
use readers::Reader;

/// An input that takes longer than this is reported too: processor time, whatever else the machine does.
const SLOW: Duration = Duration::from_secs(2);
/// Faults shown of each reader.
const SHOWN: usize = 10;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let Some(inputs) = arguments.next().and_then(|count| count.parse::<u64>().ok()) else {
        eprintln!("usage: fuzz_readers INPUTS [READER]");
        return ExitCode::from(2);
    };
    let only = arguments.next();
    let wanted = |reader: &Reader| {
        let name = format!("{reader:?}");
        only.as_ref()
            .is_none_or(|only| name.eq_ignore_ascii_case(only))
    };
    let faults: Vec<usize> = std::thread::scope(|scope| {
        let numbered = Reader::ALL.into_iter().enumerate();
        let threads: Vec<_> = numbered
            .filter(|(_, reader)| wanted(reader))
            .map(|(number, reader)| scope.spawn(move || fuzz(reader, number as u64, inputs)))
            .collect();
        threads
            .into_iter()
            .map(|thread| thread.join().unwrap_or(1))
            .collect()
    });
    if faults.is_empty() {
        eprintln!("there is no such reader; there are {:?}", Reader::ALL);
        return ExitCode::from(2);
    }
    ExitCode::from(u8::from(faults.iter().any(|count| *count > 0)))
}

/// Faults found in a reader.
fn fuzz(reader: Reader, number: u64, inputs: u64) -> usize {
    let scratch = match tempfile::tempdir() {
        Ok(folder) => folder,
        Err(error) => {
            eprintln!("no folder to write into: {error}");
            return 1;
        }
    };
    let seeds = reader.seeds();
    let (mut taken, mut faults) = (0u64, 0);
    let start = Instant::now();
    for index in 0..inputs {
        let bytes = mutations::mutated(&seeds, number, index);
        let begun = ThreadTime::now();
        let done = catch_unwind(AssertUnwindSafe(|| {
            reader.read(&bytes, scratch.path(), index)
        }));
        let fault = match done {
            Ok(was_taken) => {
                taken += u64::from(was_taken);
                (begun.elapsed() > SLOW).then_some("slow")
            }
            Err(_) => Some("panicked"),
        };
        if let Some(fault) = fault {
            faults += 1;
            if faults <= SHOWN {
                println!(
                    "{reader:?}, input {index}, {fault}: {:?}",
                    String::from_utf8_lossy(&bytes)
                );
            }
        }
    }
    println!(
        "{reader:?}: {inputs} inputs, {taken} read, {} refused, {faults} faults, {:.0} s",
        inputs - taken - faults as u64,
        start.elapsed().as_secs_f64()
    );
    faults
}
