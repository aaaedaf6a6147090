//! Mutated inputs for every reader, by a fixed sequence of pseudo-random numbers: the n-th input of a reader is the
//! same everywhere.

/// A sequence of pseudo-random numbers: SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `end`; 0 where `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % (end.max(1) as u64)) as usize
    }
}

/// Words that mean something to one of the formats, and numbers that break arithmetic.
const WORDS: [&str; 56] = [
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-308",
    "1e400",
    "0",
    "-0",
    "-1",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551616",
    "1e15",
    "99999999",
    "?",
    ".",
    "\"",
    "'",
    ";",
    "#",
    "_",
    "loop_\n",
    "data_\n",
    "_atom_site.id\n",
    "_atom_site.Cartn_x\n",
    "ATOM  ",
    "HETATM",
    "MODEL     ",
    "ENDMDL\n",
    "END\n",
    "TER\n",
    "\n",
    "\r",
    "\r\n",
    "\t",
    "\0",
    "\u{feff}",
    "\u{e9}",
    "solid\n",
    "facet normal ",
    "vertex ",
    "endfacet\n",
    "v ",
    "f ",
    "f 1//1 2//2 3//3\n",
    "f -1 -2 -3\n",
    "OFF\n",
    "ply\n",
    "element vertex ",
    "property list uchar int ",
    "end_header\n",
    "null",
    "[",
];

/// The mutated input number `index` of a reader: one of its seeds with up to eight changes.
pub fn mutated(seeds: &[Vec<u8>], reader: u64, index: u64) -> Vec<u8> {
    let mut random = Random::new(reader.wrapping_mul(0x1000_0000_0000).wrapping_add(index));
    // Neighbouring starts of SplitMix64 differ widely after one step.
    let mut random = Random::new(random.next());
    let mut bytes = seeds[random.below(seeds.len())].clone();
    for _ in 0..1 + random.below(8) {
        change(&mut bytes, seeds, &mut random);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, seeds: &[Vec<u8>], random: &mut Random) {
    let at = random.below(bytes.len());
    let length = random.below(bytes.len() - at).min(random.below(64));
    match random.below(10) {
        0 if !bytes.is_empty() => bytes[at] = random.next() as u8,
        1 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
        2 => bytes.insert(at, random.next() as u8),
        3 => drop(bytes.drain(at..at + length)),
        4 => {
            let copy: Vec<u8> = bytes[at..at + length].to_vec();
            let to = random.below(bytes.len());
            bytes.splice(to..to, copy);
        }
        5 => bytes.truncate(at),
        6 | 7 => {
            let word = WORDS[random.below(WORDS.len())].as_bytes();
            let end = (at + random.below(word.len() + 1)).min(bytes.len());
            bytes.splice(at..end, word.iter().copied());
        }
        8 => swap_lines(bytes, random),
        _ => {
            // The tail of another seed.
            let other = &seeds[random.below(seeds.len())];
            let from = random.below(other.len());
            bytes.truncate(at);
            bytes.extend_from_slice(&other[from..]);
        }
    }
}

/// A line to another place, twice or once.
fn swap_lines(bytes: &mut Vec<u8>, random: &mut Random) {
    let mut lines: Vec<Vec<u8>> = bytes
        .split_inclusive(|byte| *byte == b'\n')
        .map(<[u8]>::to_vec)
        .collect();
    if lines.is_empty() {
        return;
    }
    let from = random.below(lines.len());
    let line = if random.below(2) == 0 {
        lines[from].clone()
    } else {
        lines.remove(from)
    };
    lines.insert(random.below(lines.len() + 1), line);
    *bytes = lines.concat();
}
