//! Room for reading and sampling, checked before either fills the memory.
//!
//! What a run takes is known once its inputs are read, and is refused then. So only what alone takes much more than any
//! process does is refused beforehand, by the least that it takes.

use std::fs;

use knotdock::geometry::obstacle::reduce::BYTES_REDUCED;
use knotdock::memory_size::{as_size, in_words, named};
use knotdock_structures::molecule::InputSpec;

use knotdock_structures::Error;

/// Reading and sampling may take this many bytes whatever the limit: the whole run is refused after them.
const ALWAYS: u64 = 256 << 20;
/// Least bytes that reading takes for each byte of a file: 12 of binary STL, 15 of OBJ, 9 of PDB as measured.
const BYTE_READ: u64 = 8;
/// Least bytes that sampling takes for each node of its grid: 60 as measured of a ball.
const NODE_SAMPLED: u64 = 40;

/// Refuses files that memory has no room for.
pub fn room_to_read(specs: &[InputSpec], allowed: Option<u64>) -> Result<(), Error> {
    let size = |spec: &InputSpec| {
        let metadata = fs::metadata(&spec.path).ok()?;
        metadata.is_file().then_some(metadata.len())
    };
    let needed = |spec: &InputSpec| BYTE_READ.saturating_mul(size(spec).unwrap_or(0));
    let all = specs.iter().map(needed).fold(0, u64::saturating_add);
    let largest = specs.iter().max_by_key(|spec| needed(spec));
    match (refused("reading", all, allowed), largest) {
        (Some(failure), Some(spec)) => Err(failure.at(&spec.path)),
        _ => Ok(()),
    }
}

/// Refuses a grid of so many nodes along each axis that memory has no room for.
pub fn room_to_sample(per_axis: usize, allowed: Option<u64>) -> Result<(), Error> {
    let nodes = (per_axis as u64).saturating_pow(3);
    let failure = refused("sampling", NODE_SAMPLED.saturating_mul(nodes), allowed);
    failure.map_or(Ok(()), Err)
}

/// Refuses so many balls of a sum that memory has no room for, if none lay in another one.
pub fn room_for_balls(balls: u64, allowed: Option<u64>) -> Result<(), Error> {
    let needed = BYTES_REDUCED.saturating_mul(balls);
    let Some(allowed) = allowed.filter(|&allowed| needed > allowed.max(ALWAYS)) else {
        return Ok(());
    };
    let least = as_size(named(needed));
    let error = format!(
        "{balls} pairs of balls need up to {} of memory, and {} are allowed",
        in_words(needed),
        in_words(allowed)
    );
    Err(Error::input(error).help(format!(
        "use a coarser --grid, or allow at least --memory {least}"
    )))
}

/// The refusal of work that takes more than is allowed, and more than always is.
fn refused(work: &str, needed: u64, allowed: Option<u64>) -> Option<Error> {
    let allowed = allowed.filter(|&allowed| needed > allowed.max(ALWAYS))?;
    let least = as_size(named(needed));
    let remedy = match work {
        "sampling" => format!("use a coarser --sample-grid, or allow at least --memory {least}"),
        _ => format!("give a smaller file, or allow at least --memory {least}"),
    };
    let error = format!(
        "{work} alone needs {} of memory or more, and {} are allowed",
        in_words(needed),
        in_words(allowed)
    );
    Some(Error::input(error).help(remedy))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of 2^30 nodes took 60 GB whatever the limit, which was compared with the search alone.
    #[test]
    fn grids_are_refused_before_they_are_made() {
        assert!(room_to_sample(1024, Some(1 << 30)).is_err());
        assert!(room_to_sample(1024, Some(1 << 36)).is_ok());
        assert!(room_to_sample(1024, None).is_ok());
        // Small ones are left to the refusal that names what the whole run takes.
        assert!(room_to_sample(64, Some(1)).is_ok());
    }

    /// A file of 4 GB that holds nothing: its size is enough to refuse it.
    #[test]
    fn files_are_refused_by_their_size() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large.stl");
        fs::File::create(&path).unwrap().set_len(4 << 30).unwrap();
        let spec = InputSpec::parse(path.to_str().unwrap()).unwrap();
        assert!(room_to_read(std::slice::from_ref(&spec), Some(1 << 30)).is_err());
        assert!(room_to_read(&[spec], Some(1 << 40)).is_ok());
    }
}
