//! Structures named on the command line or in a run.json: read, recorded, described.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::inputs::solids::is_mesh;
use crate::records::MEMBERS;
use knotdock::output::records::input_record::InputRecord;
use knotdock::output::records::manifest::InputEntry;
use knotdock_structures::Error;
use knotdock_structures::molecule::{
    AtomFate, DropKind, InputSpec, ModelChoice, Molecule, ReadOptions, file_bytes, read_bytes,
    read_bytes_with_fates,
};

/// Folders in which moved inputs are searched: of the run and above it; for a member, of its ensemble too.
pub fn folders_of(run: &Path) -> Vec<PathBuf> {
    // A relative path may not name the one above.
    let run = std::path::absolute(run).unwrap_or_else(|_| run.to_owned());
    let above = run.ancestors().nth(2).and_then(Path::file_name);
    let levels = if above.is_some_and(|name| name == MEMBERS) {
        4
    } else {
        2
    };
    let folders = run.ancestors().skip(1).take(levels);
    folders.map(Path::to_owned).collect()
}

#[derive(Clone)]
pub struct Input {
    /// File, chains and checksum.
    pub record: InputRecord,
    /// Its atoms, with a report on atoms kept, dropped and altered.
    pub molecule: Molecule,
}

impl Input {
    /// Reads what a specification names.
    pub fn of(spec: &InputSpec, options: &ReadOptions) -> Result<Self, Error> {
        // Read once: the recorded bytes are the ones that were read, from a pipe, too.
        let bytes = file_bytes(&spec.path)?;
        Ok(Self {
            record: InputRecord::new(spec, &bytes),
            molecule: read_bytes(spec, bytes, options)?,
        })
    }

    /// Reads one structure, and the fate of every atom. With `--min-plddt` the B column counts as pLDDT.
    pub fn read_with_fates(
        text: &str,
        options: &ReadOptions,
    ) -> Result<(Self, Vec<AtomFate>), Error> {
        let spec = InputSpec::parse(text)?;
        refuse_mesh(&spec)?;
        let bytes = file_bytes(&spec.path)?;
        let record = InputRecord::new(&spec, &bytes);
        let options = ReadOptions {
            trust_plddt: options.min_plddt.is_some(),
            ..options.clone()
        };
        let (molecule, fates) = read_bytes_with_fates(&spec, bytes, &options)?;
        check_used(&options, [&molecule])?;
        Ok((Self { record, molecule }, fates))
    }

    /// Reads structures that are docked together, `FILE` or `FILE:H,L` each.
    pub fn read_all<const N: usize>(
        texts: [&str; N],
        options: &ReadOptions,
    ) -> Result<[Self; N], Error> {
        let specs = texts.into_iter().map(InputSpec::parse);
        Self::all(&specs.collect::<Result<Vec<_>, _>>()?, options)
    }

    /// Reads what the run.json at `run` records, checking that the files are still the same.
    pub fn recorded<const N: usize>(
        records: [&InputRecord; N],
        run: &Path,
        options: &ReadOptions,
    ) -> Result<[Self; N], Error> {
        let folders = folders_of(run);
        let specs = records
            .into_iter()
            .map(|record| Ok(record.locate(&folders)?.spec()));
        Self::all(&specs.collect::<Result<Vec<_>, Error>>()?, options)
    }

    /// Reads the structures that are docked together. `--min-plddt` holds for those of them that are known as
    /// predictions; where none is, the user's word is taken for all whose B values can be pLDDT.
    pub fn all<const N: usize>(
        specs: &[InputSpec],
        options: &ReadOptions,
    ) -> Result<[Self; N], Error> {
        let mut files: Vec<(&InputSpec, Vec<u8>)> = Vec::new();
        for spec in specs {
            refuse_mesh(spec)?;
            // Twice the same, as of a ring, may be a pipe, which can be read but once.
            let before = files.iter().find(|(other, _)| other.path == spec.path);
            let bytes = match before {
                Some((_, bytes)) => bytes.clone(),
                None => file_bytes(&spec.path)?,
            };
            files.push((spec, bytes));
        }
        let read = |options: &ReadOptions| -> Result<Vec<Self>, Error> {
            let inputs = files.iter().map(|(spec, bytes)| {
                let record = InputRecord::new(spec, bytes);
                let molecule = read_bytes(spec, bytes.clone(), options)?;
                Ok(Self { record, molecule })
            });
            inputs.collect()
        };
        let mut inputs = read(options)?;
        let is_known = |input: &Self| input.molecule.report.confidence.is_some();
        if options.min_plddt.is_some() && !inputs.iter().any(is_known) {
            inputs = read(&ReadOptions {
                trust_plddt: true,
                ..options.clone()
            })?;
        }
        check_used(options, inputs.iter().map(|input| &input.molecule))?;
        inputs
            .try_into()
            .map_err(|_| Error::machine("structures were lost on reading"))
    }

    pub fn entry(&self) -> Result<InputEntry, Error> {
        InputEntry::of_molecule(self.record.clone(), &self.molecule)
    }
}

/// Refuses options without effect on the molecules read with them: `--min-plddt`, `--assembly`, `--model` and
/// `--drop-residue`.
fn check_used<'a>(
    options: &ReadOptions,
    molecules: impl IntoIterator<Item = &'a Molecule>,
) -> Result<(), Error> {
    let (mut predicted, mut built, mut several) = (false, false, false);
    let (mut left_out, mut kept) = (BTreeSet::new(), BTreeSet::new());
    let mut reasons = Vec::new();
    for molecule in molecules {
        let report = &molecule.report;
        let by_name = report
            .dropped
            .iter()
            .filter(|dropped| dropped.kind == DropKind::Residue);
        left_out.extend(by_name.flat_map(|dropped| dropped.names.keys().map(String::as_str)));
        kept.extend(report.groups.iter().map(|group| group.name.as_str()));
        reasons.extend(
            report
                .no_confidence
                .as_ref()
                .map(|reason| format!("{reason} ({})", report.file)),
        );
        predicted |= report.confidence.is_some();
        built |= report.assembly.is_some();
        several |= report.altered.models_ignored > 0 || report.joined_models.is_some();
    }
    if let Some(name) = options
        .drop_residue
        .iter()
        .find(|name| !left_out.contains(name.as_str()))
    {
        let kept: Vec<&str> = kept.into_iter().collect();
        return Err(Error::input(format!(
            "--drop-residue names {name}, and no residue read here has that name"
        ))
        .help(match kept.join(", ") {
            none if none.is_empty() => {
                "leave it out: all residues here are standard amino acids".to_owned()
            }
            names => format!(
                "leave it out, or name one of those that are kept beside standard amino acids: {names}"
            ),
        }));
    }
    if options.min_plddt.is_some() && !predicted {
        return Err(Error::input(format!(
            "--min-plddt is for predicted models, and no B values here can be pLDDT: {}",
            reasons.join("; ")
        ))
        .help(
            "leave it out, or give the file as the predictor wrote it, with pLDDT from 0 to 100 or from 0 to 1 in the place of B values; \
             mmCIF names it in `_ma_qa_metric`",
        ));
    }
    if options.assembly.is_some() && !built {
        return Err(Error::input(
            "--assembly is for files that describe their biological assemblies, and none does here",
        )
        .help(
            "leave it out, or give the file as the archive has it: assemblies are in REMARK 350 (PDB) or in \
             _pdbx_struct_assembly_gen (mmCIF)",
        ));
    }
    if options.model != ModelChoice::default() && !several {
        return Err(Error::input(format!(
            "--model {} is for files of several models, and these have one",
            options.model
        ))
        .help("leave it out: the one model of a file is read"));
    }
    Ok(())
}

fn refuse_mesh(spec: &InputSpec) -> Result<(), Error> {
    if is_mesh(&spec.path) {
        return Err(Error::input("this is a mesh, where a molecule is needed")
            .at(&spec.path)
            .help("give a .pdb, .ent or .cif file; meshes are for `knotdock dock` and `knotdock sample`"));
    }
    Ok(())
}

/// A name for directories: that of a file without its endings, and the chains that are picked.
pub fn label(path: &Path, chains: Option<&[String]>) -> String {
    let name = path.file_name().unwrap_or_default();
    // File systems allow names of 255 bytes, and two of these make one.
    let cut = |text: &str, bytes: usize| -> String {
        let fits = |&(start, c): &(usize, char)| start + c.len_utf8() <= bytes;
        text.char_indices()
            .take_while(fits)
            .map(|(_, c)| c)
            .collect()
    };
    let chains = chains
        .into_iter()
        .flatten()
        .map(|chain| format!("_{chain}"));
    let mut label = cut(stem(&name.to_string_lossy()), MAX_NAME_LENGTH);
    label += &cut(&chains.collect::<String>(), MAX_CHAINS_LENGTH);
    label
        .chars()
        .map(|c| {
            if c.is_alphanumeric() || "._-".contains(c) {
                c
            } else {
                '-'
            }
        })
        .collect()
}

/// Most bytes of a file's part of a directory's name, and of its chains'.
const MAX_NAME_LENGTH: usize = 80;
const MAX_CHAINS_LENGTH: usize = 30;

/// A file's name without the endings of structure and mesh files.
fn stem(name: &str) -> &str {
    let lower = name.to_ascii_lowercase();
    let mut end = name.len();
    for ending in [
        ".gz", ".pdb", ".ent", ".cif", ".mmcif", ".stl", ".obj", ".ply", ".off",
    ] {
        if let Some(rest) = lower
            .get(..end)
            .and_then(|lower| lower.strip_suffix(ending))
            && !rest.is_empty()
        {
            end = rest.len();
        }
    }
    name.get(..end).unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An ensemble that is moved with its inputs finds them beside itself.
    #[test]
    fn inputs_lie_beside_a_run_or_its_ensemble() {
        let folders = |run: &str| -> Vec<String> {
            let found = folders_of(Path::new(run));
            found
                .iter()
                .map(|folder| folder.display().to_string())
                .collect()
        };
        assert_eq!(folders("/a/b/run.json"), ["/a/b", "/a"]);
        let of_member = ["/a/b/members/r1_l1", "/a/b/members", "/a/b", "/a"];
        assert_eq!(folders("/a/b/members/r1_l1/run.json"), of_member);
    }

    #[test]
    fn long_names_leave_room_for_another() {
        assert_eq!(label(Path::new("short.pdb"), None), "short");
        let long = format!("{}.pdb", "é".repeat(120));
        assert_eq!(label(Path::new(&long), None), "é".repeat(40));
        let chains = ["H".to_owned(), "L".to_owned()];
        let expected = "é".repeat(40) + "_H_L";
        assert_eq!(label(Path::new(&long), Some(&chains)), expected);
    }

    #[test]
    fn endings_of_structure_files_go_and_others_stay() {
        for (name, expected) in [
            ("1ppe.pdb", "1ppe"),
            ("1ppe.CIF.gz", "1ppe"),
            ("pdb1ppe.ent.gz", "pdb1ppe"),
            ("model.v2", "model.v2"),
            ("peg.STL", "peg"),
            (".pdb", ".pdb"),
            ("é.pdb", "é"),
        ] {
            assert_eq!(stem(name), expected);
        }
    }
}
