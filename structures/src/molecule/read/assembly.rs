//! Biological assemblies: the molecule as it works, built from the copies that a file says of its chains.
//!
//! What stands in a crystal structure's file is the asymmetric unit, which may be half of a dimer or hold four copies
//! of a monomer. The file says which chains, moved how, make the biological assembly (REMARK 350 of PDB,
//! `_pdbx_struct_assembly_gen` and `_pdbx_struct_oper_list` of mmCIF). The first copy of a chain keeps its name and the
//! k-th of chain A is called `A-k`, as the archive's own files of assemblies have it.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use crate::molecule::chemistry::atom_names::links_nucleotides;
use crate::molecule::chemistry::residues::{is_amino_acid, is_nucleotide};
use crate::molecule::model::atom::Atom;
use crate::molecule::model::report::BuiltAssembly;
use crate::molecule::model::report::{DropKind, ReadReport};
use crate::molecule::model::wording::{count, show_chain};
use crate::molecule::read::assemblies::{Assemblies, Assembly, Operator, Part};
use crate::molecule::read::coincidence::Copies;
use crate::molecule::read::error::ReadError;
use crate::molecule::read::parse::Parsed;
use crate::molecule::read::record_filter::record::is_place;
use crate::molecule::read::select;

/// Most atoms of an assembly: the largest capsids have some ten million.
const MAX_ATOMS: usize = 50_000_000;

/// The name by which assemblies know the chain of an atom.
fn part_name(record: &Parsed) -> &str {
    let raw = &record.raw;
    raw.archive_chain.as_deref().unwrap_or(&raw.chain)
}

/// Chains, by the names that assemblies know, that are protein or nucleic acid.
fn polymers(parsed: &[Parsed]) -> HashSet<&str> {
    let is_polymer = |record: &&Parsed| {
        let name = record.raw.residue_name.as_str();
        is_amino_acid(name) || is_nucleotide(name) && links_nucleotides(&record.name)
    };
    parsed.iter().filter(is_polymer).map(part_name).collect()
}

/// Builds the assembly of this name, where the file says anything of assemblies; where it does not, its atoms stay as
/// they are.
///
/// `dropped` hears of atoms whose chains have no part in it.
///
/// # Errors
/// [`ReadError::UnknownAssembly`] and [`ReadError::BrokenAssembly`].
pub(crate) fn build(
    file: &Path,
    parsed: Vec<Parsed>,
    assemblies: &Assemblies,
    wanted: &str,
    report: &mut ReadReport,
    dropped: &mut dyn FnMut(Atom, DropKind),
) -> Result<Vec<Parsed>, ReadError> {
    let Some(assembly) = find(file, assemblies, wanted)? else {
        return Ok(parsed);
    };
    let mut of_chain: HashMap<&str, Vec<usize>> = HashMap::new();
    for (index, record) in parsed.iter().enumerate() {
        of_chain.entry(part_name(record)).or_default().push(index);
    }
    let in_file: HashSet<&str> = parsed
        .iter()
        .map(|record| record.raw.chain.as_str())
        .collect();
    let mut copies: HashMap<&str, usize> = HashMap::new();
    let mut images = vec![Copies::default(); parsed.len()];
    let mut built: Vec<Parsed> = Vec::new();
    let mut on_axes = 0;
    for part in &assembly.parts {
        let members = members(part, &of_chain);
        if built.len() + members.len().saturating_mul(part.operators.len()) > MAX_ATOMS {
            let what = format!("assembly {wanted} has more than {MAX_ATOMS} atoms");
            return Err(broken(file, None, what));
        }
        for operator in &part.operators {
            for name in &part.chains {
                *copies.entry(name).or_default() += 1;
            }
            for &index in &members {
                let (Some(record), Some(images)) = (parsed.get(index), images.get_mut(index))
                else {
                    continue;
                };
                let position = operator.moved(record.exact.position);
                if !is_place(position) {
                    let what =
                        format!("an operator of assembly {wanted} takes an atom out of all bounds");
                    return Err(broken(file, Some(record.raw.line), what));
                }
                if images.has(position, |()| true) {
                    on_axes += 1;
                    continue;
                }
                images.push((), position);
                let mut record = record.clone();
                record.exact.position = position;
                let copy = copies.get(part_name(&record)).copied().unwrap_or(1);
                record.raw.chain = copy_name(&record.raw.chain, copy, &in_file);
                built.push(record);
            }
        }
    }
    report.assembly = Some(BuiltAssembly {
        id: wanted.to_owned(),
        chains: distinct_chains(&built),
        chains_in_file: distinct_chains(&parsed),
        on_axes,
    });
    for (record, images) in parsed.into_iter().zip(images) {
        if images.is_empty() {
            report.drop_atoms(DropKind::Assembly, show_chain(&record.raw.chain), 1);
            dropped(select::atom(record, ""), DropKind::Assembly);
        }
    }
    Ok(built)
}

/// The assembly of this name; `None` where the file describes no assembly.
fn find<'a>(
    file: &Path,
    assemblies: &'a Assemblies,
    wanted: &str,
) -> Result<Option<&'a Assembly>, ReadError> {
    if let Some((line, what)) = &assemblies.broken {
        return Err(broken(file, *line, what.clone()));
    }
    let found = assemblies.list.iter().find(|one| one.id == wanted);
    if found.is_none() && !assemblies.list.is_empty() {
        return Err(ReadError::UnknownAssembly {
            file: file.to_path_buf(),
            assembly: wanted.to_owned(),
            present: assemblies.list.iter().map(|one| one.id.clone()).collect(),
        });
    }
    Ok(found)
}

/// Records of the chains of a part, each once, in file order.
fn members(part: &Part, of_chain: &HashMap<&str, Vec<usize>>) -> Vec<usize> {
    let members = part
        .chains
        .iter()
        .filter_map(|name| of_chain.get(name.as_str()));
    let mut members: Vec<usize> = members.flatten().copied().collect();
    members.sort_unstable();
    members.dedup();
    members
}

fn broken(file: &Path, line: Option<usize>, what: String) -> ReadError {
    ReadError::BrokenAssembly {
        file: file.to_path_buf(),
        line,
        what,
    }
}

/// Protein and nucleic acid chains, by the author's names.
fn distinct_chains(parsed: &[Parsed]) -> usize {
    let polymers = polymers(parsed);
    let of_polymers = parsed
        .iter()
        .filter(|record| polymers.contains(part_name(record)));
    let names: HashSet<&str> = of_polymers
        .map(|record| record.raw.chain.as_str())
        .collect();
    names.len()
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

/// A warning where the first assembly is something else than what stands in the file.
pub(crate) fn warning(parsed: &[Parsed], assemblies: &Assemblies) -> Option<String> {
    let first = assemblies.list.first()?;
    let in_file = polymers(parsed);
    let mut operators: HashMap<&str, Vec<&Operator>> = HashMap::new();
    for part in &first.parts {
        for chain in part
            .chains
            .iter()
            .filter(|chain| in_file.contains(chain.as_str()))
        {
            operators.entry(chain).or_default().extend(&part.operators);
        }
    }
    let copies: usize = operators.values().map(Vec::len).sum();
    let stays =
        |operators: &Vec<&Operator>| operators.iter().all(|one| **one == Operator::IDENTITY);
    let as_it_stands =
        copies == in_file.len() && operators.len() == copies && operators.values().all(stays);
    (copies > 0 && !as_it_stands).then(|| {
        let id = &first.id;
        let has = count(in_file.len(), "chain");
        format!(
            "what stands in this file is not its biological assembly {id} ({has} in the file, {copies} in the \
             assembly): --assembly {id} builds it, \
             or pick chains"
        )
    })
}
