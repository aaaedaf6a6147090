//! Biological assemblies: the working molecule, built of copies of the file's chains.
//!
//! The file of a crystal structure holds the asymmetric unit, which may be half of a dimer or four copies of a monomer.
//! The file says which chains, moved how, make the biological assembly. The first copy of a chain keeps its name and the
//! k-th of chain A is called `A-k`, as the archive's own files of assemblies have it.

use std::collections::{HashMap, HashSet};

use crate::Error;
use crate::molecule::chemistry::{is_amino_acid, is_nucleotide, links_nucleotides};
use crate::molecule::model::{Atom, BuiltAssembly, DropKind, count};
use crate::molecule::read::mmcif::Row;
use crate::molecule::read::models::Images;
use crate::molecule::read::{Drops, Record, is_place, number};
use crate::motion::Motion;

/// Most atoms of an assembly: the largest capsids have some ten million.
const MAX_ATOMS: usize = 50_000_000;

/// Most copies that one row of an mmCIF file may request.
const MAX_COPIES: usize = 100_000;

/// Chains of an assembly that are moved alike.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    /// Names of the chains, in mmCIF the archive's (`label_asym_id`).
    chains: Vec<String>,
    /// A copy of all of them for each.
    operators: Vec<Motion>,
}

#[derive(Clone, Debug, PartialEq)]
struct Assembly {
    /// Its name, mostly a number from 1 on.
    id: String,
    parts: Vec<Part>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Assemblies {
    list: Vec<Assembly>,
    /// 1-based line and fault of the first that cannot be understood.
    broken: Option<(Option<usize>, String)>,
}

impl Assemblies {
    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The assembly of this name; `None` where the file describes no assembly.
    fn find(&self, id: &str) -> Result<Option<&Assembly>, Error> {
        if let Some((line, what)) = &self.broken {
            return Err(broken(*line, what));
        }
        let found = self.list.iter().find(|one| one.id == id);
        if found.is_none() && !self.list.is_empty() {
            let present: Vec<&str> = self.list.iter().map(|one| one.id.as_str()).collect();
            let present = present.join(", ");
            let message = format!("there is no assembly '{id}'; the file has {present}");
            return Err(Error::input(message).help(
                "ask for one of these, or leave --assembly out to read the coordinates as they stand",
            ));
        }
        Ok(found)
    }

    /// A warning where the first assembly is not what the file holds.
    pub(crate) fn warning(&self, records: &[Record]) -> Option<String> {
        let first = self.list.first()?;
        let in_file = polymers(records);
        let mut operators: HashMap<&str, Vec<&Motion>> = HashMap::new();
        for part in &first.parts {
            let chains = part.chains.iter().map(String::as_str);
            for chain in chains.filter(|chain| in_file.contains(chain)) {
                operators.entry(chain).or_default().extend(&part.operators);
            }
        }
        let copies: usize = operators.values().map(Vec::len).sum();
        let mut all = operators.values().flatten();
        let is_as_in_file = copies == in_file.len()
            && operators.len() == copies
            && all.all(|one| **one == Motion::IDENTITY);
        (copies > 0 && !is_as_in_file).then(|| {
            let id = &first.id;
            let has = count(in_file.len(), "chain");
            format!(
                "what stands in this file is not its biological assembly {id} ({has} in the file, {copies} in the \
                 assembly): --assembly {id} builds it, or pick chains"
            )
        })
    }
}

fn broken(line: Option<usize>, what: &str) -> Error {
    Error::input(format!("the biological assemblies cannot be built: {what}"))
        .on_line(line.map(|line| line as u64))
        .help("fetch the file again, or leave --assembly out to read the coordinates as they stand")
}

/// The name by which assemblies know the chain of an atom.
fn part_name(record: &Record) -> &str {
    record.archive_chain.as_ref().unwrap_or(&record.atom.chain)
}

/// Chains, by the names that assemblies know, that are protein or nucleic acid.
fn polymers(records: &[Record]) -> HashSet<&str> {
    let is_polymer = |record: &&Record| {
        let name = record.atom.residue_name.as_str();
        is_amino_acid(name) || is_nucleotide(name) && links_nucleotides(&record.atom.name)
    };
    records.iter().filter(is_polymer).map(part_name).collect()
}

fn distinct_chains(records: &[Record]) -> usize {
    let polymers = polymers(records);
    let of_polymers = records
        .iter()
        .filter(|record| polymers.contains(part_name(record)));
    of_polymers
        .map(|record| record.atom.chain.as_str())
        .collect::<HashSet<_>>()
        .len()
}

/// Builds the assembly of this name. If the file describes no assembly, its atoms stay as they are.
///
/// # Errors
/// The file has other assemblies alone, or they cannot be understood.
pub(crate) fn build(
    records: Vec<Record>,
    assemblies: &Assemblies,
    id: &str,
    drops: &mut Drops,
) -> Result<Vec<Record>, Error> {
    let Some(assembly) = assemblies.find(id)? else {
        return Ok(records);
    };
    let mut of_chain: HashMap<&str, Vec<usize>> = HashMap::new();
    for (index, record) in records.iter().enumerate() {
        of_chain.entry(part_name(record)).or_default().push(index);
    }
    let in_file: HashSet<&str> = records
        .iter()
        .map(|record| record.atom.chain.as_str())
        .collect();
    let mut copies: HashMap<&str, usize> = HashMap::new();
    let mut images = vec![Images::default(); records.len()];
    let mut built: Vec<Record> = Vec::new();
    let mut on_axes = 0;
    for part in &assembly.parts {
        // Each record once, in file order.
        let chains = part.chains.iter().map(String::as_str);
        let members = chains.filter_map(|name| of_chain.get(name)).flatten();
        let mut members: Vec<usize> = members.copied().collect();
        members.sort_unstable();
        members.dedup();
        if built.len() + members.len().saturating_mul(part.operators.len()) > MAX_ATOMS {
            let what = format!("assembly {id} has more than {MAX_ATOMS} atoms");
            return Err(broken(None, &what));
        }
        for operator in &part.operators {
            for name in &part.chains {
                *copies.entry(name).or_default() += 1;
            }
            for &index in &members {
                let (record, images) = (&records[index], &mut images[index]);
                let position = operator.apply(record.atom.position);
                if !is_place(position) {
                    let what =
                        format!("an operator of assembly {id} takes an atom out of all bounds");
                    return Err(broken(Some(record.atom.line), &what));
                }
                if images.has(position, |()| true) {
                    on_axes += 1;
                    continue;
                }
                images.push((), position);
                let copy = copies.get(part_name(record)).copied().unwrap_or(1);
                let mut record = record.clone();
                record.atom.position = position;
                record.atom.chain = copy_name(&record.atom.chain, copy, &in_file);
                built.push(record);
            }
        }
    }
    drops.report.assembly = Some(BuiltAssembly {
        id: id.to_owned(),
        chains: distinct_chains(&built),
        chains_in_file: distinct_chains(&records),
        on_axes,
    });
    for (record, images) in records.into_iter().zip(images) {
        if images.is_empty() {
            let atom = Atom {
                element: String::new(),
                ..record.atom
            };
            drops.add(&atom, DropKind::Assembly);
        }
    }
    Ok(built)
}

/// The name of a chain's copy, counted from 1: one that the file does not have.
pub(crate) fn copy_name(chain: &str, copy: usize, in_file: &HashSet<&str>) -> String {
    if copy == 1 {
        return chain.to_owned();
    }
    let mut name = format!("{chain}-{copy}");
    while in_file.contains(name.as_str()) {
        name.push('+');
    }
    name
}

/// Category of an mmCIF file that names chains and the operators that copy them.
pub(crate) const GENERATORS: &str = "_pdbx_struct_assembly_gen";
/// Category of an mmCIF file that has the operators.
pub(crate) const OPERATORS: &str = "_pdbx_struct_oper_list";

/// Assemblies of an mmCIF file, from its rows of [`GENERATORS`] and [`OPERATORS`].
pub(crate) fn assemblies(generators: &[Row<'_>], operators: &[Row<'_>]) -> Assemblies {
    let mut assemblies = Assemblies::default();
    let operators = operators
        .iter()
        .filter_map(|row| Some((text(row, "id")?, operator(row)?)));
    let operators: HashMap<&str, Motion> = operators.collect();
    let mut places: HashMap<&str, usize> = HashMap::new();
    for row in generators {
        match part(row, &operators) {
            Ok((id, part)) => {
                let place = *places.entry(id).or_insert(assemblies.list.len());
                if place == assemblies.list.len() {
                    assemblies.list.push(Assembly {
                        id: id.to_owned(),
                        parts: Vec::new(),
                    });
                }
                assemblies.list[place].parts.push(part);
            }
            Err(what) => {
                let line = row.values().map(|token| token.line).min();
                assemblies.broken.get_or_insert((line, what));
            }
        }
    }
    assemblies
}

/// The text of a value; nothing for `.` and `?`.
fn text<'a>(row: &Row<'a>, item: &str) -> Option<&'a str> {
    row.get(item)?.kind.value()
}

fn operator(row: &Row<'_>) -> Option<Motion> {
    let read = |item: String| number(text(row, &item)?);
    let mut operator = Motion::IDENTITY;
    for (i, shift) in operator.shift.iter_mut().enumerate() {
        *shift = read(format!("vector[{}]", i + 1))?;
    }
    for (i, numbers) in operator.rows.iter_mut().enumerate() {
        for (j, entry) in numbers.iter_mut().enumerate() {
            *entry = read(format!("matrix[{}][{}]", i + 1, j + 1))?;
        }
    }
    Some(operator)
}

/// The assembly that a row belongs to, and its part of it.
fn part<'a>(row: &Row<'a>, operators: &HashMap<&str, Motion>) -> Result<(&'a str, Part), String> {
    let value =
        |item: &str| text(row, item).ok_or_else(|| format!("a row of {GENERATORS} has no {item}"));
    let part = Part {
        chains: items(value("asym_id_list")?).map(str::to_owned).collect(),
        operators: expression(value("oper_expression")?, operators)?,
    };
    Ok((value("assembly_id")?, part))
}

fn items(text: &str) -> impl Iterator<Item = &str> {
    text.split(',')
        .map(str::trim)
        .filter(|name| !name.is_empty())
}

/// Operators of an expression such as `1`, `1,3`, `(1-60)`, `(X0)(1-5,9)`: of groups in brackets every combination, the
/// last group first.
fn expression(text: &str, operators: &HashMap<&str, Motion>) -> Result<Vec<Motion>, String> {
    let mut combined = vec![Motion::IDENTITY];
    let groups = text.split(['(', ')']).map(str::trim);
    for group in groups.filter(|group| !group.is_empty()) {
        let members = group_members(group, operators)?;
        if combined.len().saturating_mul(members.len()) > MAX_COPIES {
            return Err(format!(
                "oper_expression `{text}` makes more than {MAX_COPIES} copies"
            ));
        }
        let pairs = combined
            .iter()
            .flat_map(|outer| members.iter().map(move |inner| (outer, inner)));
        combined = pairs.map(|(outer, inner)| outer.after(inner)).collect();
    }
    Ok(combined)
}

fn group_members(group: &str, operators: &HashMap<&str, Motion>) -> Result<Vec<Motion>, String> {
    let mut members = Vec::new();
    let mut add = |id: &str| match operators.get(id) {
        Some(_) if members.len() == MAX_COPIES => Err(format!(
            "an oper_expression makes more than {MAX_COPIES} copies"
        )),
        Some(operator) => {
            members.push(*operator);
            Ok(())
        }
        None => Err(format!(
            "operator {id} is not in {OPERATORS}, or lacks numbers"
        )),
    };
    let number = |text: &str| text.trim().parse::<u32>().ok();
    for name in items(group) {
        let range = name.split_once('-');
        match range.and_then(|(first, last)| Some(number(first)?..=number(last)?)) {
            Some(range) if !operators.contains_key(name) => {
                for id in range {
                    add(&id.to_string())?;
                }
            }
            _ => add(name)?,
        }
    }
    Ok(members)
}

/// Reads REMARK 350 of PDB files line by line (wwPDB format 3.3, "Remarks 300 to 399").
#[derive(Default)]
pub(crate) struct Remark350 {
    assemblies: Assemblies,
    /// How many assemblies at the end of the list the current lines describe.
    current: usize,
    /// Rows of the operator in the making.
    rows: Vec<[f64; 4]>,
    line: usize,
}

impl Remark350 {
    /// Takes a record; those of other kinds pass by.
    pub(crate) fn note(&mut self, line: usize, record: &str) {
        if let Some(text) = record.strip_prefix("REMARK 350") {
            self.line = line;
            if let Err(what) = self.take(text.trim()) {
                self.assemblies.broken.get_or_insert((Some(line), what));
            }
        }
    }

    pub(crate) fn assemblies(mut self) -> Assemblies {
        if !self.rows.is_empty() {
            let what = "the last BIOMT operator lacks rows".to_owned();
            self.assemblies
                .broken
                .get_or_insert((Some(self.line), what));
        }
        self.assemblies
    }

    fn take(&mut self, text: &str) -> Result<(), String> {
        if let Some(ids) = text.strip_prefix("BIOMOLECULE:") {
            let ids = chain_names(ids);
            self.current = ids.len();
            let new = ids.into_iter().map(|id| Assembly {
                id,
                parts: Vec::new(),
            });
            self.assemblies.list.extend(new);
        } else if let Some((_, chains)) = text.split_once("APPLY THE FOLLOWING TO CHAINS:") {
            for assembly in self.current() {
                assembly.parts.push(Part {
                    chains: chain_names(chains),
                    operators: Vec::new(),
                });
            }
        } else if let Some(chains) = text.strip_prefix("AND CHAINS:") {
            for part in self.parts() {
                part.chains.extend(chain_names(chains));
            }
        } else if let Some(row) = text.strip_prefix("BIOMT") {
            self.row(row)?;
        }
        Ok(())
    }

    /// A row of an operator: its number, the operator's, three numbers of R and one of t.
    fn row(&mut self, text: &str) -> Result<(), String> {
        let mut words = text.split_ascii_whitespace();
        let due = self.rows.len() + 1;
        if words.next().and_then(|word| word.parse().ok()) != Some(due) {
            let found = text.get(..1).unwrap_or("");
            return Err(format!("a BIOMT{found} row where BIOMT{due} is due"));
        }
        let numbers: Vec<f64> = words.skip(1).filter_map(number).collect();
        let row = <[f64; 4]>::try_from(numbers)
            .map_err(|_| "a BIOMT row does not have four numbers after the operator's")?;
        self.rows.push(row);
        if let [a, b, c] = *self.rows.as_slice() {
            self.rows.clear();
            let operator = Motion {
                rows: [a, b, c].map(|row| [row[0], row[1], row[2]]),
                shift: [a[3], b[3], c[3]],
            };
            let placed = self
                .parts()
                .map(|part| part.operators.push(operator))
                .count();
            if placed == 0 {
                return Err("a BIOMT operator stands before the chains that it applies to".into());
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

/// Names of chains with commas between them; a blank chain is called NULL.
fn chain_names(text: &str) -> Vec<String> {
    let name = |name| if name == "NULL" { "" } else { name }.to_owned();
    items(text).map(name).collect()
}
