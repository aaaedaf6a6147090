//! The table of peptidase families that are detected from their sequence.

use std::sync::LazyLock;

/// The table; its head says what the columns hold and where they come from.
const TABLE: &str = include_str!("peptidase_families.csv");

/// Amino acids allowed at each place of a segment; none stands for any.
type Pattern = Vec<String>;

/// A conserved segment about catalytic residues.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Anchor {
    /// What the segment may look like; of several that fit at one place the first counts.
    pub patterns: Vec<Pattern>,
    /// Places of the catalytic residues in it, from 0.
    pub catalytic: Vec<usize>,
}

/// A family of peptidases.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Family {
    /// Name in MEROPS.
    pub name: String,
    /// An enzyme of it that the field knows.
    pub known_by: String,
    /// Segments that its members have, all of them.
    pub anchors: Vec<Anchor>,
}

/// A row of the table that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("row {row} of the peptidase families: {problem}")]
struct TableError {
    /// Row, from 1, comments and the head not counted.
    row: usize,
    problem: String,
}

/// The families, in the order of the table.
pub(super) fn families() -> &'static [Family] {
    static FAMILIES: LazyLock<Vec<Family>> = LazyLock::new(|| {
        // The table is part of the program, and a test reads it.
        parse(TABLE).unwrap_or_else(|error| unreachable!("{error}"))
    });
    &FAMILIES
}

fn parse(table: &str) -> Result<Vec<Family>, TableError> {
    let mut families: Vec<Family> = Vec::new();
    let mut rows = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(table.as_bytes());
    for (record, row) in rows.records().zip(1..) {
        let error = |problem: String| TableError { row, problem };
        let record = record.map_err(|problem| error(problem.to_string()))?;
        let fields: Vec<&str> = record.iter().collect();
        let [name, known_by, patterns, catalytic] = fields[..] else {
            return Err(error(format!("{} fields, not 4", fields.len())));
        };
        let anchor = anchor(patterns, catalytic).map_err(error)?;
        match families.last_mut() {
            Some(family) if family.name == name => family.anchors.push(anchor),
            _ => families.push(Family {
                name: name.to_owned(),
                known_by: known_by.to_owned(),
                anchors: vec![anchor],
            }),
        }
    }
    Ok(families)
}

fn anchor(patterns: &str, catalytic: &str) -> Result<Anchor, String> {
    let patterns: Vec<Pattern> = patterns
        .split('|')
        .map(|pattern| pattern.trim().split('-').map(allowed).collect())
        .collect::<Result<_, _>>()?;
    let shortest = patterns.iter().map(Vec::len).min().unwrap_or(0);
    let place = |text: &str| match text.parse::<usize>() {
        Ok(place) if (1..=shortest).contains(&place) => Ok(place - 1),
        _ => Err(format!("`{text}` is no place of the pattern")),
    };
    let catalytic: Vec<usize> = catalytic
        .split_whitespace()
        .map(place)
        .collect::<Result<_, _>>()?;
    if catalytic.is_empty() {
        return Err("no catalytic residue".to_owned());
    }
    Ok(Anchor {
        patterns,
        catalytic,
    })
}

/// The amino acids allowed at one place of a pattern: `x`, one letter, or letters in brackets.
fn allowed(place: &str) -> Result<String, String> {
    let letters = place
        .strip_prefix('[')
        .and_then(|rest| rest.strip_suffix(']'))
        .unwrap_or(place);
    let are_letters = letters.chars().all(|letter| letter.is_ascii_uppercase());
    match letters {
        "x" => Ok(String::new()),
        "" => Err("a place without a letter".to_owned()),
        _ if are_letters && (letters.len() == 1 || place != letters) => Ok(letters.to_owned()),
        _ => Err(format!("`{place}` is no place of a pattern")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_read() {
        let families = parse(TABLE).unwrap();
        let names: Vec<&str> = families.iter().map(|family| family.name.as_str()).collect();
        assert_eq!(names, ["S1", "S8", "C1", "A1", "M10", "M14"]);
        let serine = &families[0].anchors[1];
        assert_eq!(serine.patterns[0], ["G", "D", "", "G", "GS"]);
        assert_eq!(serine.patterns[1].len(), 4);
        assert_eq!(serine.catalytic, [2]);
        assert_eq!(families[5].anchors[0].catalytic, [0, 3]);
    }

    #[test]
    fn a_row_that_cannot_be_read_is_refused() {
        let problem = |row: &str| {
            let table =
                format!("# comment\nfamily,known_by,patterns,catalytic\nS1,a,H-x,1\n{row}\n");
            parse(&table).unwrap_err().to_string()
        };
        for (row, expected) in [
            ("S1,trypsin,H-E,3", "`3` is no place of the pattern"),
            ("S1,trypsin,H-E | H,2", "`2` is no place of the pattern"),
            ("S1,trypsin,H-E,one", "`one` is no place of the pattern"),
            ("S1,trypsin,H-E,", "no catalytic residue"),
            ("S1,trypsin,H--E,1", "a place without a letter"),
            ("S1,trypsin,H-ST,1", "`ST` is no place of a pattern"),
            ("S1,trypsin,H-[St],1", "`[St]` is no place of a pattern"),
        ] {
            let problem = problem(row);
            assert_eq!(
                problem,
                format!("row 2 of the peptidase families: {expected}")
            );
        }
        assert!(problem("S1,trypsin,H-E").contains("row 2"));
    }
}
