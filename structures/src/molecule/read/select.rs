//! From the records of a file to the atoms that are docked: the requested chains with one alternate location per residue.
//! Hydrogens, waters, additives and residues of low confidence are left out by default or on request.

use std::collections::{BTreeSet, HashMap, HashSet};

use crate::Error;
use crate::molecule::chemistry::{
    NameColumn, Origin, Resolved, is_additive, is_amino_acid, is_hydrogen, is_water, known_as,
    resolve,
};
use crate::molecule::model::{
    Atom, DropKind, Picked, ResidueKey, ResidueSelection, cut_ends, residue_key, show_chain,
};
use crate::molecule::read::alternate::choose;
use crate::molecule::read::confidence::{Provenance, weigh};
use crate::molecule::read::pseudo_atoms;
use crate::molecule::read::{Drops, Hetatm, Hydrogens, ReadOptions, Record, Waters, bad_selection};

/// Applies all selections, and notes what they drop. Radii are left at zero: they need whole residues.
pub(crate) fn select(
    records: Vec<Record>,
    chains: Option<&[String]>,
    options: &ReadOptions,
    provenance: Provenance,
    drops: &mut Drops,
) -> Result<Vec<Atom>, Error> {
    let chains = chains.map(|parts| RequestedChains::new(&records, parts, &drops.report.warnings));
    let chains = chains.transpose()?;
    let known = known_names(&records);
    let aligned = keeps_alignment(&records, &known);
    let pseudo_atoms = pseudo_atoms::find(&records, &known);
    drops.report.membrane = membrane(&records, &pseudo_atoms);
    let modified = match options.hetatm {
        Hetatm::Drop => modified_residues(&records),
        Hetatm::NoAdditives | Hetatm::Keep => HashSet::new(),
    };
    let elements = records.iter().zip(&known).map(|(record, known)| {
        let (name, column) = (&record.atom.name, &record.atom.element);
        resolve(known, name, column, record.name_column, aligned)
    });
    let elements: Vec<Option<Resolved>> = elements.collect();
    let unwanted = records
        .iter()
        .zip(&pseudo_atoms)
        .map(|(record, pseudo_atom)| {
            let is_elsewhere = chains
                .as_ref()
                .and_then(|chains| chains.leaves_out(&record.atom));
            is_elsewhere
                .or_else(|| unwanted(&record.atom, pseudo_atom.is_some(), options, &modified))
        });
    let unwanted: Vec<Option<DropKind>> = unwanted.collect();
    let mut atoms = Vec::with_capacity(records.len());
    let mut left_out = Vec::new();
    let facts = elements.into_iter().zip(unwanted).zip(pseudo_atoms);
    for (record, ((element, unwanted), pseudo_atom)) in records.into_iter().zip(facts) {
        let mut atom = record.atom;
        let symbol = element.as_ref().map_or("", |element| element.symbol);
        symbol.clone_into(&mut atom.element);
        if let Some(kind) = unwanted {
            match pseudo_atom.filter(|_| kind == DropKind::PseudoAtom) {
                Some(name) => drops.add_named(&atom, kind, &name),
                None => drops.add(&atom, kind),
            }
            if kind == DropKind::OtherResidue {
                left_out.push(atom);
            }
            continue;
        }
        let element = element.ok_or_else(|| unknown_element(&atom))?;
        if options.hydrogens == Hydrogens::Drop && is_hydrogen(element.symbol) {
            drops.add(&atom, DropKind::Hydrogen);
            continue;
        }
        match element.origin {
            Origin::Column => {}
            Origin::Derived => drops.report.altered.elements_derived += 1,
            Origin::Corrected => drops.report.altered.elements_corrected += 1,
        }
        atoms.push(atom);
    }
    drops.report.cut_ends = cut_ends(&atoms, &left_out);
    let atoms = choose(atoms, options.altloc, drops);
    let atoms = weigh(atoms, provenance, options, drops);
    if atoms.is_empty() {
        let dropped = drops.report.atoms_dropped();
        let message =
            format!("no atom is left after what is not wanted is dropped ({dropped} atoms)");
        return Err(Error::input(message).help(
            "pick other chains, or keep what is dropped: --hetatm keep, --waters keep, --hydrogens keep, a lower \
             --min-plddt",
        ));
    }
    Ok(atoms)
}

fn unknown_element(atom: &Atom) -> Error {
    let residue = format!(
        "{} {}{}",
        atom.residue_name,
        show_chain(&atom.chain),
        atom.residue_number
    );
    let message = format!(
        "the element of atom {} of {residue} is not known",
        atom.name
    );
    Error::input(message).on_line(atom.line as u64).help(
        "write the element symbol in columns 77-78 (PDB) or in _atom_site.type_symbol (mmCIF), remove the atom, or \
         leave its residue out with --drop-residue NAME",
    )
}

/// The chains and residues that are requested of a file: of some chains all, of others some residues.
struct RequestedChains(HashMap<String, Vec<Picked>>);

impl RequestedChains {
    /// Reads the parts of a selection among the chains of a file. `warnings` go with the error of a chain that is not
    /// there: what was not read may hold it.
    ///
    /// # Errors
    /// A part names nothing of the file.
    fn new(records: &[Record], parts: &[String], warnings: &[String]) -> Result<Self, Error> {
        let mut present: Vec<&str> = Vec::new();
        let mut names: BTreeSet<&str> = BTreeSet::new();
        for Record { atom, .. } in records {
            if names.insert(&atom.chain) {
                present.push(&atom.chain);
            }
        }
        let text = parts.join(",");
        let selection: ResidueSelection = text.parse().map_err(|_| bad_selection(&text))?;
        let mut requested: HashMap<String, Vec<Picked>> = HashMap::new();
        for picked in selection.read_among(&names) {
            let atoms = records.iter().map(|record| &record.atom);
            let of_chain: Vec<&Atom> = atoms.filter(|atom| atom.chain == picked.chain).collect();
            if of_chain.is_empty() {
                return Err(unknown_chain(&picked.written, &present, warnings));
            }
            let is_there = |atom: &&Atom| picked.holds(atom.residue_number, atom.insertion_code);
            if !of_chain.iter().any(is_there) {
                let numbers = || of_chain.iter().map(|atom| atom.residue_number);
                let (first, last) = (numbers().min().unwrap_or(0), numbers().max().unwrap_or(0));
                let (part, chain) = (&picked.written, show_chain(&picked.chain));
                return Err(Error::input(format!(
                    "there is no residue {part}; chain {chain} of the file has {first} to {last}"
                ))
                .help(
                    "pick residues that the file has, by the author's numbers: FILE:A:1-120 or FILE:A:52A, with all \
                     parts of a list after commas",
                ));
            }
            requested
                .entry(picked.chain.clone())
                .or_default()
                .push(picked);
        }
        Ok(Self(requested))
    }

    fn leaves_out(&self, atom: &Atom) -> Option<DropKind> {
        let Some(parts) = self.0.get(&atom.chain) else {
            return Some(DropKind::Chain);
        };
        let holds = |part: &Picked| part.holds(atom.residue_number, atom.insertion_code);
        (!parts.iter().any(holds)).then_some(DropKind::OtherResidue)
    }
}

fn unknown_chain(chain: &str, present: &[&str], warnings: &[String]) -> Error {
    let names: Vec<&str> = present.iter().map(|name| show_chain(name)).collect();
    let present = match names.as_slice() {
        [] => "none".to_owned(),
        [one] => format!("only {one}"),
        several => several.join(", "),
    };
    let warnings: String = warnings.iter().map(|text| format!("; {text}")).collect();
    Error::input(format!("there is no chain '{chain}'; the file has {present}{warnings}")).help(
        "pick one of the chains listed; names are the author's and case-sensitive, _ is the blank name; residues are \
         picked as in FILE:A:1-120",
    )
}

/// Why an atom is dropped whatever chain it is of, hydrogens aside. `modified` are modified residues, if only these of
/// the HETATM records are kept.
fn unwanted(
    atom: &Atom,
    is_pseudo_atom: bool,
    options: &ReadOptions,
    modified: &HashSet<ResidueKey<'_>>,
) -> Option<DropKind> {
    let name = &atom.residue_name;
    let is_kept_by_name = options.keep.contains(name);
    if options.drop_residue.contains(name) {
        Some(DropKind::Residue)
    } else if is_water(name) && options.waters == Waters::Drop && !is_kept_by_name {
        Some(DropKind::Water)
    } else if is_pseudo_atom {
        Some(DropKind::PseudoAtom)
    } else if is_kept_by_name || is_water(name) {
        None
    } else if options.hetatm != Hetatm::Keep && is_additive(name) {
        Some(DropKind::Additive)
    } else {
        let is_dropped =
            options.hetatm == Hetatm::Drop && atom.hetero && !modified.contains(&residue_key(atom));
        is_dropped.then_some(DropKind::Hetatm)
    }
}

/// Lowest and highest z of membrane planes: of marks (`DUM`) that all are in two planes across the z axis.
fn membrane(records: &[Record], pseudo_atoms: &[Option<String>]) -> Option<[f64; 2]> {
    // OPM writes three decimals, and rounds the thickness to one.
    const FLAT: f64 = 0.1;
    let all = records.iter().zip(pseudo_atoms);
    let marks = all.filter(|(_, pseudo_atom)| pseudo_atom.as_deref() == Some("DUM"));
    let z: Vec<f64> = marks.map(|(record, _)| record.atom.position[2]).collect();
    let low = z.iter().copied().reduce(f64::min)?;
    let high = z.iter().copied().reduce(f64::max)?;
    let is_flat = z.iter().all(|z| z - low <= FLAT || high - z <= FLAT);
    (is_flat && high - low > FLAT).then_some([low, high])
}

/// The name of each record's residue in the tables.
fn known_names(records: &[Record]) -> Vec<&str> {
    let mut known: Vec<&str> = Vec::with_capacity(records.len());
    let mut others: HashMap<ResidueKey<'_>, Vec<usize>> = HashMap::new();
    for (index, Record { atom, .. }) in records.iter().enumerate() {
        known.push(&atom.residue_name);
        if !(is_amino_acid(&atom.residue_name) || is_water(&atom.residue_name)) {
            others.entry(residue_key(atom)).or_default().push(index);
        }
    }
    for (key, members) in others {
        let atoms = members.iter().map(|&index| &records[index].atom);
        let names = atoms.map(|atom| (atom.name.as_str(), atom.element.as_str()));
        let name = known_as(key.name, names);
        for index in members {
            known[index] = name;
        }
    }
    known
}

/// Residues in HETATM records that have an amino acid's N, CA and C.
fn modified_residues(records: &[Record]) -> HashSet<ResidueKey<'_>> {
    let mut found: HashMap<ResidueKey<'_>, [bool; 3]> = HashMap::new();
    for atom in records
        .iter()
        .map(|record| &record.atom)
        .filter(|atom| atom.hetero)
    {
        if let Some(place) = ["N", "CA", "C"].iter().position(|name| *name == atom.name) {
            found.entry(residue_key(atom)).or_default()[place] = true;
        }
    }
    found.retain(|_, seen| *seen == [true; 3]);
    found.into_keys().collect()
}

/// Whether the file aligns atom names as the wwPDB does: alpha carbons of amino acids leave column 13 blank. `known`
/// are the names under which the tables have the records' residues.
fn keeps_alignment(records: &[Record], known: &[&str]) -> bool {
    let all = records.iter().zip(known);
    all.filter(|(record, known)| record.atom.name == "CA" && is_amino_acid(known))
        .all(|(record, _)| record.name_column == NameColumn::Blank)
}
