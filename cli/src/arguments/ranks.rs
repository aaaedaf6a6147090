//! Lists of ranks such as `37,40-45`.

use std::collections::HashMap;
use std::path::Path;
use std::str::FromStr;

use knotdock::output::tables::poses::PoseTable;
use knotdock_structures::Error;

/// Ranks as the user lists them, in that order, each once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ranks(pub Vec<usize>);

impl Ranks {
    /// Places of their rows in the table read from a path, in their order.
    pub fn places(&self, table: &PoseTable, table_path: &Path) -> Result<Vec<usize>, Error> {
        let rows = table.rows().iter().enumerate();
        let of_rank: HashMap<usize, usize> = rows.map(|(place, row)| (row.rank, place)).collect();
        let places = self.0.iter().map(|rank| {
            of_rank.get(rank).copied().ok_or_else(|| {
                let count = table.rows().len();
                Error::input(format!("there is no rank {rank} among the {count} rows"))
                    .at(table_path)
                    .help("choose ranks that the table lists; `knotdock dock --no-cluster` lists every pose")
            })
        });
        places.collect()
    }
}

/// More complexes than this are no list that somebody meant.
const MAX_RANKS: usize = 100_000;

impl FromStr for Ranks {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut ranks = Vec::new();
        for part in text.split(',') {
            let (first, last) = match part.split_once('-') {
                Some((first, last)) => (rank(first)?, rank(last)?),
                None => (rank(part)?, rank(part)?),
            };
            if first > last {
                return Err(format!("the range {part} runs backwards"));
            }
            if last - first >= MAX_RANKS {
                return Err(format!(
                    "the range {part} holds more than {MAX_RANKS} ranks"
                ));
            }
            ranks.extend(first..=last);
        }
        let mut seen = std::collections::HashSet::new();
        ranks.retain(|&rank| seen.insert(rank));
        Ok(Self(ranks))
    }
}

fn rank(text: &str) -> Result<usize, String> {
    match text.trim().parse() {
        Ok(rank) if rank > 0 => Ok(rank),
        _ => Err(format!(
            "`{text}` is no rank; ranks are counted from 1, as in 37,40-45"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_ranges() {
        assert_eq!("37,40-43,41".parse(), Ok(Ranks(vec![37, 40, 41, 42, 43])));
        for text in ["", "0", "1,", "5-3", "1-999999999999", "-4", "a"] {
            assert!(text.parse::<Ranks>().is_err(), "{text}");
        }
    }
}
