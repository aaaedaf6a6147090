//! Reading a structure, from path to molecule.

mod alternate;
mod assembly;
mod cif;
mod confidence;
mod input;
mod mmcif;
mod models;
mod pdb;
mod pdb_columns;
mod pdbtbx;
mod policy;
mod pseudo_atoms;
mod record;
mod select;
mod source;
mod warnings;

pub use self::confidence::LOW;
pub use self::policy::{AlternateLocation, Hetatm, Hydrogens, ModelChoice, ReadOptions, Waters};
pub use self::source::file_bytes;
use crate::molecule::model::InputSpec;

use self::input::bad_selection;
use self::models::Relation;
use self::record::{COORDINATE, FileContents, Record, coordinate, field_error, is_place, number};

use std::path::Path;

use crate::Error;
use crate::molecule::chemistry::{all_atom_radius, radius};
use crate::molecule::model::{Atom, DropKind, Format, Molecule, ReadReport, residues};

/// An atom of the model that was read, and whether it was kept.
#[derive(Clone, Debug, PartialEq)]
pub struct AtomFate {
    /// The atom; its radius is 0 and its element may be empty if it was dropped.
    pub atom: Atom,
    /// Why it was dropped; nothing if it was kept.
    pub dropped: Option<DropKind>,
}

/// Atoms that are dropped: counted in the report, and collected if their fates are requested.
#[derive(Debug, Default)]
pub(crate) struct Drops {
    pub(crate) report: ReadReport,
    fates: Option<Vec<AtomFate>>,
}

impl Drops {
    pub(crate) fn add(&mut self, atom: &Atom, kind: DropKind) {
        self.add_named(atom, kind, kind.counted_by(atom));
    }

    pub(crate) fn add_named(&mut self, atom: &Atom, kind: DropKind, name: &str) {
        self.report.drop_atoms(kind, name, 1);
        if let Some(fates) = &mut self.fates {
            fates.push(AtomFate {
                atom: atom.clone(),
                dropped: Some(kind),
            });
        }
    }
}

/// Reads the atoms to dock from a PDB or mmCIF file, plain or gzip-compressed.
///
/// By default it keeps the first model, the chains requested, atoms of zero occupancy, cofactors, metals, glycans,
/// modified residues and nucleic acids. It leaves out hydrogens, waters and a known set of buffer and cryo additives.
/// Of alternate locations it keeps one per residue: that of the highest summed occupancy, and the alphabetically first
/// of equals.
///
/// The molecule's report counts the atoms kept, dropped and altered.
///
/// # Errors
/// With the file, the line where there is one, and a remedy.
pub fn read(spec: &InputSpec, options: &ReadOptions) -> Result<Molecule, Error> {
    read_bytes(spec, source::file_bytes(&spec.path)?, options)
}

impl Molecule {
    /// Reads `FILE` (PDB or mmCIF, also gzip-compressed) or `FILE:H,L`, which picks chains, by the default options:
    /// see [`read`].
    ///
    /// ```
    /// use knotdock_structures::molecule::Molecule;
    ///
    /// # let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    /// let molecule = Molecule::read(&format!("{folder}/1ppe_ligand_unbound.pdb"))?;
    /// assert_eq!(molecule.atoms.len(), 221);
    /// # Ok::<(), knotdock_structures::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`read`].
    pub fn read(file: &str) -> Result<Self, Error> {
        read(&InputSpec::parse(file)?, &ReadOptions::default())
    }
}

/// Reads a molecule from a file's bytes ([`file_bytes`](super::file_bytes)), as [`read`] does.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(
    spec: &InputSpec,
    bytes: Vec<u8>,
    options: &ReadOptions,
) -> Result<Molecule, Error> {
    let read = read_parts(spec, bytes, options, None);
    read.map(|(molecule, _)| molecule)
        .map_err(|error| error.at(&spec.path))
}

/// Number of models in a file's bytes, at least 1.
///
/// # Errors
/// The bytes are of no known format, or their records cannot be read.
pub fn model_count(file: &Path, bytes: Vec<u8>) -> Result<usize, Error> {
    let count = || {
        let source = source::unpack(file, bytes)?;
        let contents = read_text(source.format, &source.text, ModelChoice::Number(1))?;
        Ok(contents.models.max(1))
    };
    count().map_err(|error: Error| error.at(file))
}

/// Reads like [`read`], and returns the fate of every atom of the model in file order, kept or dropped.
///
/// # Errors
/// As [`read`].
pub fn read_with_fates(
    spec: &InputSpec,
    options: &ReadOptions,
) -> Result<(Molecule, Vec<AtomFate>), Error> {
    read_bytes_with_fates(spec, source::file_bytes(&spec.path)?, options)
}

/// Reads a file's bytes as [`read_with_fates`] does.
///
/// # Errors
/// As [`read`].
pub fn read_bytes_with_fates(
    spec: &InputSpec,
    bytes: Vec<u8>,
    options: &ReadOptions,
) -> Result<(Molecule, Vec<AtomFate>), Error> {
    let read = read_parts(spec, bytes, options, Some(Vec::new()));
    let (molecule, fates) = read.map_err(|error| error.at(&spec.path))?;
    let mut fates = fates.unwrap_or_default();
    let kept = molecule.atoms.iter().cloned();
    fates.extend(kept.map(|atom| AtomFate {
        atom,
        dropped: None,
    }));
    fates.sort_by_key(|fate| fate.atom.line);
    Ok((molecule, fates))
}

/// Reads a file's bytes, and adds to `fates` the atoms that are dropped.
fn read_parts(
    spec: &InputSpec,
    bytes: Vec<u8>,
    options: &ReadOptions,
    fates: Option<Vec<AtomFate>>,
) -> Result<(Molecule, Option<Vec<AtomFate>>), Error> {
    let source = source::unpack(&spec.path, bytes)?;
    let format = source.format;
    let model = spec.model.map_or(options.model, ModelChoice::Number);
    let mut contents = read_text(format, &source.text, model)?;
    let models = contents.models.max(1);
    if let Some(model) = spec.model.filter(|&model| model > models) {
        return Err(unknown_model(model, models));
    }
    drop(source.text);
    if contents.records.is_empty() {
        return Err(match contents.recognised {
            true => Error::input("the file holds no atoms")
                .help("give a file with ATOM or HETATM records, or an _atom_site table"),
            false => source::not_a_structure(&spec.path),
        });
    }
    let mut records = pdbtbx::records(format, &mut contents)?;
    let mut drops = Drops {
        report: std::mem::take(&mut contents.report),
        fates,
    };
    drops.report.file = spec.path.display().to_string();
    drops.report.source = Some(spec.clone());
    drops.report.format = Some(format);
    drops.report.compressed = source.compressed;
    let is_joined = model == ModelChoice::All && models > 1;
    if is_joined && options.assembly.is_some() && !contents.assemblies.is_empty() {
        let message = "--assembly builds copies of one model, and --model all reads all models as one molecule";
        return Err(Error::input(message).help("leave one of the two out"));
    }
    if models > 1 {
        records = resolve_models(records, &contents, is_joined, &mut drops.report);
    }
    if let Some(id) = &options.assembly {
        records = assembly::build(records, &contents.assemblies, id, &mut drops)?;
    } else if spec.chains.is_none() && !is_joined {
        drops
            .report
            .warnings
            .extend(contents.assemblies.warning(&records));
    }
    let provenance = contents.provenance;
    let chains = spec.chains.as_deref();
    let atoms = select::select(records, chains, options, provenance, &mut drops)?;
    let chain_breaks = contents.chain_breaks;
    let molecule = Molecule {
        chain_breaks,
        ..finish(format, atoms, drops.report)
    };
    Ok((molecule, drops.fates))
}

fn unknown_model(model: usize, models: usize) -> Error {
    Error::input(format!("there is no model {model}; the file has {models}")).help(
        "ask for one of the models that the file has, which count from 1 in the order of the file, or for --model all",
    )
}

/// Reads the requested models; a file's only model whatever number was requested.
fn read_text(format: Format, text: &str, model: ModelChoice) -> Result<FileContents, Error> {
    let read = |model| match format {
        Format::Pdb => pdb::read(text, model),
        Format::Mmcif => mmcif::read(text, model),
    };
    let contents = read(model)?;
    match model {
        ModelChoice::Number(number) if contents.models == 1 && number != 1 => {
            read(ModelChoice::Number(1))
        }
        ModelChoice::Number(number)
            if contents.models > 1 && !(1..=contents.models).contains(&number) =>
        {
            Err(unknown_model(number, contents.models))
        }
        _ => Ok(contents),
    }
}

/// Joins several models where all are read, and warns where parts of a molecule are ignored.
fn resolve_models(
    records: Vec<Record>,
    contents: &FileContents,
    is_joined: bool,
    report: &mut ReadReport,
) -> Vec<Record> {
    let read = records
        .iter()
        .map(|record| (record.model, record.atom.position));
    let relation = models::relation(read.chain(contents.ignored.iter().copied()));
    if is_joined {
        if relation == Relation::Alternatives {
            report.warnings.push(models::ALTERNATIVES_JOINED.to_owned());
        }
        let (joined, shown) = models::join(records, relation);
        report.joined_models = Some(shown);
        return joined;
    }
    report.altered.models_ignored = contents.models - 1;
    if relation == Relation::Parts {
        let read = records.first().map_or(1, |record| record.model);
        let warning = models::warning(contents.models, read, contents.ignored.len());
        report.warnings.push(warning);
    }
    records
}

/// Gives the atoms their radii and the report its counts.
fn finish(format: Format, mut atoms: Vec<Atom>, mut report: ReadReport) -> Molecule {
    let groups = residues(&atoms);
    report.warnings.extend(warnings::warnings(&atoms, &groups));
    report.count(&groups);
    let all_atom = atoms.iter().any(Atom::is_hydrogen);
    let mut radii = vec![0.0; atoms.len()];
    for group in &groups {
        for &index in &group.atoms {
            let Atom { name, element, .. } = &atoms[index];
            radii[index] = match all_atom {
                true => all_atom_radius(element),
                false => radius(group.known_as, name, element, group.kind),
            };
        }
    }
    for (atom, radius) in atoms.iter_mut().zip(radii) {
        atom.radius = radius;
    }
    Molecule {
        report,
        ..Molecule::new(atoms, format)
    }
}
