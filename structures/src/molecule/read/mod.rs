//! Reading a structure, from path to molecule.

pub(crate) mod alternate;
pub(crate) mod assemblies;
pub(crate) mod assembly;
pub(crate) mod coincidence;
pub(crate) mod completeness;
pub(crate) mod confidence;
pub(crate) mod error;
pub(crate) mod foreign;
pub(crate) mod input;
pub(crate) mod lines;
pub(crate) mod models;
pub(crate) mod overlap;
pub(crate) mod parse;
pub(crate) mod policy;
pub(crate) mod pseudo_atoms;
pub(crate) mod record_filter;
pub(crate) mod scope;
pub(crate) mod select;
pub(crate) mod source;
pub(crate) mod wanted;

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use crate::molecule::chemistry::{ligands, radii};
use crate::molecule::model::atom::Atom;
use crate::molecule::model::format::Format;
use crate::molecule::model::groups::{GroupKind, Residue, residues};
use crate::molecule::model::molecule::Molecule;
use crate::molecule::model::report::{ChainCount, DropKind, GroupCount, OtherName, ReadReport};
use crate::molecule::model::wording::count;
use crate::molecule::read::error::ReadError;
use crate::molecule::read::input::InputSpec;
use crate::molecule::read::parse::Parsed;
use crate::molecule::read::policy::{ModelChoice, ReadOptions};
use crate::molecule::read::record_filter::record::FilteredRecords;

/// An atom of the model that was read, and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct AtomFate {
    /// The atom; its radius is 0 and its element may be empty where it was dropped.
    pub atom: Atom,
    /// Why it was dropped; nothing where it was kept.
    pub dropped: Option<DropKind>,
}

/// Reads the atoms to dock from a PDB or mmCIF file, plain or gzip-compressed.
///
/// By default it keeps the first model, the chains requested, atoms of zero occupancy, cofactors, metals, glycans,
/// modified residues and nucleic acids. It leaves out hydrogens, waters and a known set of buffer and cryo additives.
/// Of alternate locations it keeps one a residue: that of the highest summed occupancy, and the alphabetically first of
/// equals.
///
/// The molecule's report says what was kept, dropped and altered.
///
/// # Errors
/// [`ReadError`], with the file, the line where there is one, and a remedy.
pub fn read(spec: &InputSpec, options: &ReadOptions) -> Result<Molecule, ReadError> {
    read_bytes(spec, source::file_bytes(&spec.path)?, options)
}

/// As [`read`], of a file's bytes ([`file_bytes`](super::file_bytes)).
///
/// # Errors
/// As [`read`].
pub fn read_bytes(
    spec: &InputSpec,
    bytes: Vec<u8>,
    options: &ReadOptions,
) -> Result<Molecule, ReadError> {
    read_telling(spec, bytes, options, &mut |_, _| {})
}

/// Number of models in a file's bytes, at least 1.
///
/// # Errors
/// [`ReadError`] where the bytes are of no known format, or their records cannot be told apart.
pub fn model_count(file: &Path, bytes: Vec<u8>) -> Result<usize, ReadError> {
    let source = source::unpack(file, bytes)?;
    let format = source::format_of(file, &source.text).ok_or_else(|| not_a_structure(file))?;
    let filtered = filter(file, format, &source.text, ModelChoice::Number(1))?;
    Ok(filtered.models.max(1))
}

/// Reads like [`read`], and returns the fate of every atom of the model in file order, kept or dropped.
///
/// # Errors
/// As [`read`].
pub fn read_with_fates(
    spec: &InputSpec,
    options: &ReadOptions,
) -> Result<(Molecule, Vec<AtomFate>), ReadError> {
    read_bytes_with_fates(spec, source::file_bytes(&spec.path)?, options)
}

/// As [`read_with_fates`], of a file's bytes.
///
/// # Errors
/// As [`read`].
pub fn read_bytes_with_fates(
    spec: &InputSpec,
    bytes: Vec<u8>,
    options: &ReadOptions,
) -> Result<(Molecule, Vec<AtomFate>), ReadError> {
    let mut fates = Vec::new();
    let molecule = read_telling(spec, bytes, options, &mut |atom, kind| {
        fates.push(AtomFate {
            atom,
            dropped: Some(kind),
        });
    })?;
    fates.extend(molecule.atoms.iter().map(|atom| AtomFate {
        atom: atom.clone(),
        dropped: None,
    }));
    fates.sort_by_key(|entry| entry.atom.line);
    Ok((molecule, fates))
}

/// Reads a file's bytes, and calls `dropped` for each atom that is left out.
fn read_telling(
    spec: &InputSpec,
    bytes: Vec<u8>,
    options: &ReadOptions,
    dropped: &mut dyn FnMut(Atom, DropKind),
) -> Result<Molecule, ReadError> {
    let file = spec.path.as_path();
    let source = source::unpack(file, bytes)?;
    let format = source::format_of(file, &source.text).ok_or_else(|| not_a_structure(file))?;
    let model = spec.model.map_or(options.model, ModelChoice::Number);
    let mut filtered = filter(file, format, &source.text, model)?;
    if let Some(model) = spec.model.filter(|&model| model > filtered.models.max(1)) {
        return Err(ReadError::UnknownModel {
            file: file.to_path_buf(),
            model,
            models: filtered.models.max(1),
        });
    }
    drop(source.text);
    if filtered.records.is_empty() {
        return Err(if filtered.recognised {
            ReadError::NoAtoms {
                file: file.to_path_buf(),
            }
        } else {
            not_a_structure(file)
        });
    }

    let mut report = ReadReport {
        file: file.display().to_string(),
        source: Some(spec.clone()),
        format: Some(format),
        compressed: source.compressed,
        ..ReadReport::default()
    };
    let is_joined = model == ModelChoice::All && filtered.models > 1;
    report_filtered(&filtered, is_joined, &mut report);
    let provenance = filtered.provenance;
    let (models, ignored) = (filtered.models, std::mem::take(&mut filtered.ignored));
    let assemblies = std::mem::take(&mut filtered.assemblies);
    let chain_breaks = std::mem::take(&mut filtered.chain_breaks);
    let mut parsed = parse::parse(file, format, filtered)?;
    let is_assembly = options.assembly.is_some() && !assemblies.list.is_empty();
    if is_joined && is_assembly {
        return Err(ReadError::AssemblyOfModels {
            file: file.to_path_buf(),
        });
    }
    if models > 1 {
        parsed = resolve_models(parsed, models, &ignored, is_joined, &mut report);
    }
    if let Some(wanted) = &options.assembly {
        parsed = assembly::build(file, parsed, &assemblies, wanted, &mut report, dropped)?;
    } else if spec.chains.is_none() && !is_joined {
        report
            .warnings
            .extend(assembly::warning(&parsed, &assemblies));
    }
    let atoms = select::select(
        file,
        parsed,
        spec.chains.as_deref(),
        options,
        provenance,
        &mut report,
        dropped,
    )?;
    Ok(Molecule {
        chain_breaks,
        ..finish(format, atoms, report)
    })
}

/// The error of a file whose text shows no known format.
fn not_a_structure(file: &Path) -> ReadError {
    match foreign::by_name(file) {
        Some(foreign) => ReadError::Foreign {
            file: file.to_path_buf(),
            what: foreign.what,
            remedy: foreign.remedy,
        },
        None => ReadError::NotAStructure {
            file: file.to_path_buf(),
        },
    }
}

/// Filters the records of the models that are wanted; model 1 names the only one of a file, whatever was asked for.
fn filter(
    file: &Path,
    format: Format,
    text: &str,
    model: ModelChoice,
) -> Result<FilteredRecords, ReadError> {
    let filter = |model: ModelChoice| match format {
        Format::Pdb => record_filter::pdb::filter(file, text, model),
        Format::Mmcif => record_filter::mmcif::filter(file, text, model),
    };
    let filtered = filter(model)?;
    match model {
        ModelChoice::Number(number) if filtered.models == 1 && number != 1 => {
            filter(ModelChoice::Number(1))
        }
        ModelChoice::Number(number)
            if filtered.models > 1 && !(1..=filtered.models).contains(&number) =>
        {
            Err(ReadError::UnknownModel {
                file: file.to_path_buf(),
                model: number,
                models: filtered.models,
            })
        }
        _ => Ok(filtered),
    }
}

/// Reports what the filter left out and altered.
fn report_filtered(filtered: &FilteredRecords, is_joined: bool, report: &mut ReadReport) {
    if !is_joined {
        report.altered.models_ignored = filtered.models.saturating_sub(1);
    }
    report.altered.defaults_filled = filtered.defaults_filled;
    report.altered.chains_from_segids = filtered.chains_from_segids;
    report.drop_atoms(DropKind::Model, "", filtered.atoms_ignored);

    if let Some((line, name)) = filtered.other_blocks.first() {
        report.warnings.push(format!(
            "only the first structure is read: {} with atoms, the first, data_{name}, at line {line}",
            count(filtered.other_blocks.len(), "further data block")
        ));
    }
    if let Some(first) = filtered.displaced.first() {
        report.warnings.push(format!(
            "{} out of the columns of the format, the first at line {first}: moved and read",
            count(filtered.displaced.len(), "atom record")
        ));
    }
}

/// Joins several models where all are read, and warns where parts of a molecule are ignored.
fn resolve_models(
    parsed: Vec<Parsed>,
    models: usize,
    ignored: &[(usize, [f64; 3])],
    is_joined: bool,
    report: &mut ReadReport,
) -> Vec<Parsed> {
    let read = parsed.iter();
    let read = read.map(|record| (record.raw.model, record.exact.position));
    let relation = models::relation(read.chain(ignored.iter().copied()));
    if is_joined {
        if relation == models::Relation::Alternatives {
            report.warnings.push(models::ALTERNATIVES_JOINED.to_owned());
        }
        let (joined, shown) = models::join(parsed, relation);
        report.joined_models = Some(shown);
        return joined;
    }
    if relation == models::Relation::Parts {
        report.altered.models_are_parts = true;
        let read = parsed.first().map_or(1, |record| record.raw.model);
        report
            .warnings
            .push(models::warning(models, read, ignored.len()));
    }
    parsed
}

/// Gives the atoms their radii and the report its counts.
fn finish(format: Format, mut atoms: Vec<Atom>, mut report: ReadReport) -> Molecule {
    let groups = residues(&atoms);
    report
        .warnings
        .extend(completeness::warnings(&atoms, &groups));
    report.warnings.extend(ligands::warning(&atoms, &groups));
    report.warnings.extend(overlap::warnings(&atoms, &groups));
    report.warnings.extend(scope::warnings(&atoms, &groups));
    report.chains = count_chains(&groups);
    report.groups = count_groups(&groups);
    report.other_names = count_other_names(&groups);
    let all_atom = atoms.iter().any(Atom::is_hydrogen);
    let mut all_radii = vec![0.0; atoms.len()];
    for group in &groups {
        for &index in &group.atoms {
            if let (Some(atom), Some(radius)) = (atoms.get(index), all_radii.get_mut(index)) {
                *radius = if all_atom {
                    radii::all_atom_radius(&atom.element)
                } else {
                    radii::radius(group.known_as, &atom.name, &atom.element, group.kind)
                };
            }
        }
    }
    for (atom, radius) in atoms.iter_mut().zip(all_radii) {
        atom.radius = radius;
    }
    Molecule {
        report,
        ..Molecule::new(atoms, format)
    }
}

fn count_chains(groups: &[Residue<'_>]) -> Vec<ChainCount> {
    let mut chains: Vec<ChainCount> = Vec::new();
    let mut places: HashMap<&str, usize> = HashMap::new();
    for group in groups {
        let at = *places.entry(group.key.0).or_insert_with(|| {
            chains.push(ChainCount {
                name: group.key.0.to_string(),
                residues: 0,
                atoms: 0,
            });
            chains.len() - 1
        });
        if let Some(chain) = chains.get_mut(at) {
            chain.residues += 1;
            chain.atoms += group.atoms.len();
        }
    }
    chains
}

fn count_groups(groups: &[Residue<'_>]) -> Vec<GroupCount> {
    let mut counts: BTreeMap<(GroupKind, &str), [usize; 2]> = BTreeMap::new();
    for group in groups.iter().filter(|g| g.kind != GroupKind::AminoAcid) {
        let [residues, atoms] = counts.entry((group.kind, group.key.3)).or_default();
        *residues += 1;
        *atoms += group.atoms.len();
    }
    let counts = counts.into_iter();
    counts
        .map(|((kind, name), [residues, atoms])| GroupCount {
            name: name.to_owned(),
            kind,
            residues,
            atoms,
        })
        .collect()
}

fn count_other_names(groups: &[Residue<'_>]) -> Vec<OtherName> {
    let mut counts: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for group in groups.iter().filter(|group| group.known_as != group.key.3) {
        *counts.entry((group.key.3, group.known_as)).or_default() += 1;
    }
    let counts = counts.into_iter();
    counts
        .map(|((name, read_as), residues)| OtherName {
            name: name.to_owned(),
            read_as: read_as.to_owned(),
            residues,
        })
        .collect()
}
