//! From parsed records to the atoms that are docked: chains requested, by default no hydrogens, no waters, no
//! additives, one alternate location a residue, of predictions the residues that they are sure enough of.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use crate::molecule::chemistry::additives::is_additive;
use crate::molecule::chemistry::elements;
use crate::molecule::chemistry::elements::{NameColumn, Origin};
use crate::molecule::chemistry::other_names::known_as;
use crate::molecule::chemistry::residues::{is_amino_acid, is_water};
use crate::molecule::model::atom::Atom;
use crate::molecule::model::cut_ends::cut_ends;
use crate::molecule::model::report::{DropKind, ReadReport};
use crate::molecule::model::wording::show_chain;
use crate::molecule::read::alternate::choose;
use crate::molecule::read::confidence::weigh;
use crate::molecule::read::error::ReadError;
use crate::molecule::read::parse::Parsed;
use crate::molecule::read::policy::{Hetatm, Hydrogens, ReadOptions, Waters};
use crate::molecule::read::pseudo_atoms;
use crate::molecule::read::record_filter::provenance::Provenance;
use crate::molecule::read::wanted::Wanted;

/// Applies all selections and notes in the report what they dropped.
///
/// Radii are left at zero: they need to know whole residues. `dropped` hears of every atom that is left out, in file
/// order but for alternate locations and residues of low confidence, which come last.
pub(crate) fn select(
    file: &Path,
    parsed: Vec<Parsed>,
    chains: Option<&[String]>,
    options: &ReadOptions,
    provenance: Provenance,
    report: &mut ReadReport,
    dropped: &mut dyn FnMut(Atom, DropKind),
) -> Result<Vec<Atom>, ReadError> {
    let wanted = wanted(file, &parsed, chains, report)?;
    let other_names = other_names(&parsed);
    let (aligned, pseudo_atoms) = {
        let names = parsed.iter().zip(&other_names);
        let known: Vec<&str> = names
            .map(|(record, other)| other.as_deref().unwrap_or(&record.raw.residue_name))
            .collect();
        (
            keeps_alignment(&parsed, &known),
            pseudo_atoms::find(&parsed, &known),
        )
    };
    report.membrane = membrane(&parsed, &pseudo_atoms);
    let criteria = Criteria::new(&parsed, wanted, options);
    let mut atoms = Vec::with_capacity(parsed.len());
    let mut left_out = Vec::new();
    let facts = other_names.into_iter().zip(pseudo_atoms);
    for (record, (other_name, pseudo_atom)) in parsed.into_iter().zip(facts) {
        let raw = &record.raw;
        let name = raw.residue_name.as_str();
        let known = other_name.as_deref().unwrap_or(name);
        let resolved = || {
            let column = &raw.element;
            elements::resolve(known, &record.name, column, raw.name_column, aligned)
        };
        if let Some((kind, of)) = criteria.unwanted(&record, pseudo_atom.as_deref()) {
            report.drop_atoms(kind, of, 1);
            let symbol = resolved().map_or("", |element| element.symbol);
            let atom = atom(record, symbol);
            if kind == DropKind::OtherResidue {
                left_out.push(atom.clone());
            }
            dropped(atom, kind);
            continue;
        }
        let element = resolved().ok_or_else(|| ReadError::UnknownElement {
            file: file.to_path_buf(),
            line: raw.line,
            atom: record.name.clone(),
            residue: format!("{name} {}{}", show_chain(&raw.chain), raw.residue_number),
        })?;
        if options.hydrogens == Hydrogens::Drop && elements::is_hydrogen(element.symbol) {
            report.drop_atoms(DropKind::Hydrogen, "", 1);
            dropped(atom(record, element.symbol), DropKind::Hydrogen);
            continue;
        }
        match element.origin {
            Origin::Column => {}
            Origin::Derived => report.altered.elements_derived += 1,
            Origin::Corrected => report.altered.elements_corrected += 1,
        }
        atoms.push(atom(record, element.symbol));
    }
    report.cut_ends = cut_ends(&atoms, &left_out);
    let atoms = choose(atoms, options.altloc, report, dropped);
    let atoms = weigh(
        atoms,
        provenance,
        options.min_plddt,
        options.trust_plddt,
        report,
        dropped,
    );
    if atoms.is_empty() {
        return Err(ReadError::EmptySelection {
            file: file.to_path_buf(),
            dropped: report.atoms_dropped(),
        });
    }
    Ok(atoms)
}

/// Lowest and highest z of membrane planes: of marks (`DUM`) that all lie in two planes across the z axis.
fn membrane(parsed: &[Parsed], pseudo_atoms: &[Option<String>]) -> Option<[f64; 2]> {
    // OPM writes three decimals, and rounds the thickness to one.
    const FLAT: f64 = 0.1;
    let marks = parsed
        .iter()
        .zip(pseudo_atoms)
        .filter(|(_, pseudo_atom)| pseudo_atom.as_deref() == Some("DUM"));
    let z: Vec<f64> = marks.map(|(record, _)| record.exact.position[2]).collect();
    let low = z.iter().copied().reduce(f64::min)?;
    let high = z.iter().copied().reduce(f64::max)?;
    let is_flat = z.iter().all(|z| z - low <= FLAT || high - z <= FLAT);
    (is_flat && high - low > FLAT).then_some([low, high])
}

/// The chains and residues that are requested; `None` for all.
fn wanted(
    file: &Path,
    parsed: &[Parsed],
    chains: Option<&[String]>,
    report: &ReadReport,
) -> Result<Option<Wanted>, ReadError> {
    let wanted = chains.map(|chains| Wanted::new(file, parsed, chains));
    wanted.transpose().map_err(|mut error| {
        // What was not read may hold the chain.
        if let ReadError::UnknownChain { warnings, .. } = &mut error {
            warnings.clone_from(&report.warnings);
        }
        error
    })
}

/// What a record is kept or dropped by, hydrogens aside.
struct Criteria<'a> {
    wanted: Option<Wanted>,
    options: &'a ReadOptions,
    /// Modified residues, where only these of the HETATM records are kept.
    modified: HashSet<ResidueKey>,
}

impl<'a> Criteria<'a> {
    fn new(parsed: &[Parsed], wanted: Option<Wanted>, options: &'a ReadOptions) -> Self {
        let modified = match options.hetatm {
            Hetatm::Drop => modified_residues(parsed),
            Hetatm::NoAdditives | Hetatm::Keep => HashSet::new(),
        };
        Self {
            wanted,
            options,
            modified,
        }
    }

    /// Why a record is dropped, and the name by which the report counts it.
    fn unwanted<'r>(
        &self,
        record: &'r Parsed,
        pseudo_atom: Option<&'r str>,
    ) -> Option<(DropKind, &'r str)> {
        let options = self.options;
        let raw = &record.raw;
        let name = raw.residue_name.as_str();
        let is_kept_by_name = options.keep.iter().any(|keep| keep == name);
        let is_elsewhere = self
            .wanted
            .as_ref()
            .and_then(|wanted| wanted.leaves_out(raw));
        if let Some(kind) = is_elsewhere {
            Some((kind, show_chain(&raw.chain)))
        } else if options.drop_residue.iter().any(|unwanted| unwanted == name) {
            Some((DropKind::Residue, name))
        } else if is_water(name) && options.waters == Waters::Drop && !is_kept_by_name {
            Some((DropKind::Water, name))
        } else if let Some(of) = pseudo_atom {
            Some((DropKind::PseudoAtom, of))
        } else if is_kept_by_name || is_water(name) {
            None
        } else if options.hetatm != Hetatm::Keep && is_additive(name) {
            Some((DropKind::Additive, name))
        } else if options.hetatm == Hetatm::Drop
            && record.hetero
            && !self.modified.contains(&residue_key(record))
        {
            Some((DropKind::Hetatm, name))
        } else {
            None
        }
    }
}

/// The atom of a record, its radius left at zero.
pub(crate) fn atom(record: Parsed, element: &str) -> Atom {
    let raw = record.raw;
    Atom {
        name: record.name,
        residue_name: raw.residue_name,
        chain: raw.chain,
        residue_number: raw.residue_number,
        insertion_code: raw.insertion_code,
        alternate_location: raw.alternate_location,
        element: element.to_string(),
        position: record.exact.position,
        occupancy: record.exact.occupancy,
        b_factor: record.exact.b_factor,
        hetero: record.hetero,
        radius: 0.0,
        line: raw.line,
    }
}

/// Of each record the name under which the tables have its residue, where that is not its own.
fn other_names(parsed: &[Parsed]) -> Vec<Option<String>> {
    let mut residues: HashMap<(&str, i64, Option<char>, &str), Vec<usize>> = HashMap::new();
    for (index, record) in parsed.iter().enumerate() {
        let raw = &record.raw;
        let name = raw.residue_name.as_str();
        if !(is_amino_acid(name) || is_water(name)) {
            let number = (raw.residue_number, raw.insertion_code);
            let key = (raw.chain.as_str(), number.0, number.1, name);
            residues.entry(key).or_default().push(index);
        }
    }
    let mut found = vec![None; parsed.len()];
    for ((.., name), records) in residues {
        let atoms = records.iter().filter_map(|&index| parsed.get(index));
        let known = known_as(
            name,
            atoms.map(|record| (record.name.as_str(), record.raw.element.as_str())),
        );
        if known != name {
            for index in records {
                if let Some(place) = found.get_mut(index) {
                    *place = Some(known.to_owned());
                }
            }
        }
    }
    found
}

/// Key of a residue.
type ResidueKey = (String, i64, Option<char>, String);

fn residue_key(record: &Parsed) -> ResidueKey {
    let raw = &record.raw;
    (
        raw.chain.clone(),
        raw.residue_number,
        record.raw.insertion_code,
        raw.residue_name.clone(),
    )
}

/// Residues in HETATM records that have an amino acid's N, CA and C.
fn modified_residues(parsed: &[Parsed]) -> HashSet<ResidueKey> {
    let mut found: HashMap<ResidueKey, [bool; 3]> = HashMap::new();
    for record in parsed.iter().filter(|record| record.hetero) {
        if let Some(place) = ["N", "CA", "C"]
            .iter()
            .position(|name| *name == record.name)
            && let Some(seen) = found.entry(residue_key(record)).or_default().get_mut(place)
        {
            *seen = true;
        }
    }
    let whole = found.into_iter().filter(|(_, seen)| *seen == [true; 3]);
    whole.map(|(key, _)| key).collect()
}

/// Whether the file aligns atom names as the wwPDB does: alpha carbons of amino acids leave column 13 blank. `known`
/// are the names under which the tables have the records' residues.
fn keeps_alignment(parsed: &[Parsed], known: &[&str]) -> bool {
    parsed
        .iter()
        .zip(known)
        .filter(|(record, known)| record.name == "CA" && is_amino_acid(known))
        .all(|(record, _)| record.raw.name_column == NameColumn::Blank)
}
