//! Bandwidth of the machine's memory as one thread sees it: McCalpin's STREAM triad, a = b + s c.
//!
//! Bytes are counted as STREAM does: two arrays are read and one is written. That a processor loads a line before it
//! writes to it does not count (McCalpin, IEEE TCCA Newsletter 1995).

use std::fs;
use std::hint::black_box;
use std::time::Instant;

/// Arrays are this many times as long as the last cache: STREAM's rule.
const TIMES_THE_CACHE: usize = 4;
/// Bytes of an array, at the least and at the most: three must fit into the memory of a small machine.
const BYTES: [usize; 2] = [64 << 20, 512 << 20];
/// Runs; the fastest counts, and the first only touches the memory.
const RUNS: usize = 12;

/// What the triad reached.
pub struct Bandwidth {
    /// Bytes a second.
    pub bytes_per_second: f64,
    /// Bytes of each of the three arrays.
    pub array: usize,
    /// Bytes of the last cache, where the system names it.
    pub cache: Option<usize>,
}

/// Runs the triad.
pub fn bandwidth() -> Bandwidth {
    let cache = last_cache();
    let [least, most] = BYTES;
    let array = (TIMES_THE_CACHE * cache.unwrap_or(least)).clamp(least, most);
    let length = array / size_of::<f64>();
    let mut a = vec![0.0f64; length];
    let (b, c) = (vec![1.0f64; length], vec![2.0f64; length]);
    let mut best = f64::INFINITY;
    for run in 0..RUNS {
        let scale = black_box(3.0);
        let start = Instant::now();
        for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
            *a = b + scale * c;
        }
        black_box(&mut a);
        if run > 0 {
            best = best.min(start.elapsed().as_secs_f64());
        }
    }
    Bandwidth {
        bytes_per_second: 3.0 * array as f64 / best,
        array,
        cache,
    }
}

/// Bytes of the largest cache of the first processor; Linux alone says.
fn last_cache() -> Option<usize> {
    let caches = fs::read_dir("/sys/devices/system/cpu/cpu0/cache").ok()?;
    let size = |path: std::path::PathBuf| {
        let text = fs::read_to_string(path.join("size")).ok()?;
        let kilobytes: usize = text.trim().strip_suffix('K')?.parse().ok()?;
        Some(kilobytes << 10)
    };
    caches
        .flatten()
        .filter_map(|entry| size(entry.path()))
        .max()
}
