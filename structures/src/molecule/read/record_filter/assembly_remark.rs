//! Biological assemblies of PDB files: REMARK 350 (wwPDB format 3.3, "Remarks 300 to 399").

use crate::molecule::read::assemblies::{Assemblies, Assembly, Operator, Part};

/// Reads REMARK 350 line by line.
#[derive(Default)]
pub(crate) struct Remark {
    assemblies: Assemblies,
    /// How many assemblies at the end of the list the lines now speak of.
    current: usize,
    /// Rows of the operator in the making.
    rows: Vec<[f64; 4]>,
    /// The last line that spoke of assemblies.
    line: usize,
}

impl Remark {
    /// Takes a record; those of other kinds pass by.
    pub(crate) fn note(&mut self, line: usize, record: &str) {
        let Some(text) = record.strip_prefix("REMARK 350") else {
            return;
        };
        self.line = line;
        if let Err(what) = self.take(text.trim())
            && self.assemblies.broken.is_none()
        {
            self.assemblies.broken = Some((Some(line), what));
        }
    }

    /// Assemblies that all lines describe.
    pub(crate) fn assemblies(mut self) -> Assemblies {
        if !self.rows.is_empty() && self.assemblies.broken.is_none() {
            self.assemblies.broken = Some((
                Some(self.line),
                "the last BIOMT operator lacks rows".to_owned(),
            ));
        }
        self.assemblies
    }

    fn take(&mut self, text: &str) -> Result<(), String> {
        if let Some(ids) = text.strip_prefix("BIOMOLECULE:") {
            let ids = names(ids);
            self.current = ids.len();
            self.assemblies
                .list
                .extend(ids.into_iter().map(|id| Assembly {
                    id,
                    parts: Vec::new(),
                }));
        } else if let Some((_, chains)) = text.split_once("APPLY THE FOLLOWING TO CHAINS:") {
            for assembly in self.current() {
                assembly.parts.push(Part {
                    chains: names(chains),
                    operators: Vec::new(),
                });
            }
        } else if let Some(chains) = text.strip_prefix("AND CHAINS:") {
            for part in self.parts() {
                part.chains.extend(names(chains));
            }
        } else if let Some(row) = text.strip_prefix("BIOMT") {
            self.row(row)?;
        }
        Ok(())
    }

    /// A row of an operator: its number, the operator's, three numbers of R and one of t.
    fn row(&mut self, text: &str) -> Result<(), String> {
        let mut words = text.split_ascii_whitespace();
        let number = words.next().and_then(|word| word.parse().ok());
        if number != Some(self.rows.len() + 1) {
            return Err(format!(
                "a BIOMT{} row where BIOMT{} is due",
                text.get(..1).unwrap_or(""),
                self.rows.len() + 1
            ));
        }
        let numbers: Vec<f64> = words
            .skip(1)
            .filter_map(|word| word.parse().ok())
            .filter(|number: &f64| number.is_finite())
            .collect();
        let row = <[f64; 4]>::try_from(numbers).map_err(|_| {
            "a BIOMT row does not have four numbers after the operator's".to_owned()
        })?;
        self.rows.push(row);
        if let [a, b, c] = *self.rows.as_slice() {
            self.rows.clear();
            let operator = Operator {
                rotation: [a, b, c].map(|row| [row[0], row[1], row[2]]),
                shift: [a[3], b[3], c[3]],
            };
            let mut placed = false;
            for part in self.parts() {
                part.operators.push(operator);
                placed = true;
            }
            if !placed {
                return Err(
                    "a BIOMT operator stands before the chains that it applies to".to_owned(),
                );
            }
        }
        Ok(())
    }

    fn current(&mut self) -> impl Iterator<Item = &mut Assembly> {
        self.assemblies.list.iter_mut().rev().take(self.current)
    }

    fn parts(&mut self) -> impl Iterator<Item = &mut Part> {
        self.current()
            .filter_map(|assembly| assembly.parts.last_mut())
    }
}

/// Names with commas between them; a blank chain is called NULL.
fn names(text: &str) -> Vec<String> {
    let names = text
        .split(',')
        .map(str::trim)
        .filter(|name| !name.is_empty());
    names
        .map(|name| if name == "NULL" { "" } else { name }.to_owned())
        .collect()
}
