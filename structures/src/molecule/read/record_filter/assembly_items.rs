//! Biological assemblies of mmCIF files: `_pdbx_struct_assembly_gen` names chains and the operators that copy them,
//! `_pdbx_struct_oper_list` has the operators.

use std::collections::HashMap;

use crate::molecule::read::assemblies::{Assemblies, Assembly, Operator, Part};
use crate::molecule::read::record_filter::record::number;
use crate::molecule::read::record_filter::tokens::Token;

/// Most copies that one row may ask for.
const MAX_COPIES: usize = 100_000;

/// Collects the two categories value by value, from loops and from single items alike.
#[derive(Default)]
pub(crate) struct Items<'a> {
    parts: Rows<'a>,
    operators: Rows<'a>,
}

/// Rows of a category: values by their items. A row ends where an item comes again.
#[derive(Default)]
struct Rows<'a> {
    rows: Vec<HashMap<String, Token<'a>>>,
}

impl<'a> Rows<'a> {
    fn note(&mut self, item: &str, value: Token<'a>) {
        let item = item.to_ascii_lowercase();
        match self.rows.last_mut() {
            Some(row) if !row.contains_key(&item) => {
                row.insert(item, value);
            }
            _ => self.rows.push(HashMap::from([(item, value)])),
        }
    }
}

/// The text of a value; nothing for `.` and `?`.
fn text<'a>(row: &HashMap<String, Token<'a>>, item: &str) -> Option<&'a str> {
    row.get(item)?.kind.value()
}

impl<'a> Items<'a> {
    /// Takes the value of an item, of whatever category.
    pub(crate) fn note(&mut self, tag: &str, value: Token<'a>) {
        let Some((category, item)) = tag.split_once('.') else {
            return;
        };
        if category.eq_ignore_ascii_case("_pdbx_struct_assembly_gen") {
            self.parts.note(item, value);
        } else if category.eq_ignore_ascii_case("_pdbx_struct_oper_list") {
            self.operators.note(item, value);
        }
    }

    /// Assemblies that all items describe.
    pub(crate) fn assemblies(&self) -> Assemblies {
        let mut assemblies = Assemblies::default();
        let mut operators = HashMap::new();
        let mut places: HashMap<&str, usize> = HashMap::new();
        for row in &self.operators.rows {
            if let (Some(id), Some(operator)) = (text(row, "id"), operator(row)) {
                operators.insert(id, operator);
            }
        }
        for row in &self.parts.rows {
            match part(row, &operators) {
                Ok((id, part)) => {
                    let place = *places.entry(id).or_insert_with(|| {
                        assemblies.list.push(Assembly {
                            id: id.to_owned(),
                            parts: Vec::new(),
                        });
                        assemblies.list.len() - 1
                    });
                    if let Some(assembly) = assemblies.list.get_mut(place) {
                        assembly.parts.push(part);
                    }
                }
                Err(what) => {
                    let line = row.values().map(|token| token.line).min();
                    assemblies.broken.get_or_insert((line, what));
                }
            }
        }
        assemblies
    }
}

fn operator(row: &HashMap<String, Token<'_>>) -> Option<Operator> {
    let read = |item: String| number(text(row, &item)?);
    let mut operator = Operator::IDENTITY;
    for (i, shift) in operator.shift.iter_mut().enumerate() {
        *shift = read(format!("vector[{}]", i + 1))?;
    }
    for (i, numbers) in operator.rotation.iter_mut().enumerate() {
        for (j, entry) in numbers.iter_mut().enumerate() {
            *entry = read(format!("matrix[{}][{}]", i + 1, j + 1))?;
        }
    }
    Some(operator)
}

/// The assembly that a row belongs to, and its part of it.
fn part<'a>(
    row: &HashMap<String, Token<'a>>,
    operators: &HashMap<&str, Operator>,
) -> Result<(&'a str, Part), String> {
    let value = |item: &str| {
        text(row, item).ok_or_else(|| format!("a row of _pdbx_struct_assembly_gen has no {item}"))
    };
    let chains = value("asym_id_list")?
        .split(',')
        .map(|name| name.trim().to_owned());
    let part = Part {
        chains: chains.filter(|name| !name.is_empty()).collect(),
        operators: expression(value("oper_expression")?, operators)?,
    };
    Ok((value("assembly_id")?, part))
}

/// Operators of an expression such as `1`, `1,3`, `(1-60)`, `(X0)(1-5,9)`: of groups in brackets every combination, the
/// last group first.
fn expression(text: &str, operators: &HashMap<&str, Operator>) -> Result<Vec<Operator>, String> {
    let mut combined = vec![Operator::IDENTITY];
    let groups = text
        .split(['(', ')'])
        .map(str::trim)
        .filter(|group| !group.is_empty());
    for group in groups {
        let members = group_members(group, operators)?;
        if combined.len().saturating_mul(members.len()) > MAX_COPIES {
            return Err(format!(
                "oper_expression `{text}` makes more than {MAX_COPIES} copies"
            ));
        }
        combined = combined
            .iter()
            .flat_map(|before| members.iter().map(|member| before.after(member)))
            .collect();
    }
    Ok(combined)
}

fn group_members(
    group: &str,
    operators: &HashMap<&str, Operator>,
) -> Result<Vec<Operator>, String> {
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
            "operator {id} is not in _pdbx_struct_oper_list, or lacks numbers"
        )),
    };
    for name in group
        .split(',')
        .map(str::trim)
        .filter(|name| !name.is_empty())
    {
        let range = name.split_once('-').and_then(|(first, last)| {
            Some((
                first.trim().parse::<u32>().ok()?,
                last.trim().parse::<u32>().ok()?,
            ))
        });
        match range {
            Some((first, last)) if !operators.contains_key(name) => {
                for id in first..=last {
                    add(&id.to_string())?;
                }
            }
            _ => add(name)?,
        }
    }
    Ok(members)
}
