//! Files that belong together: a structure and the confidence files beside it, by the names that each program gives.
//!
//! - AlphaFold 3, local: `X_model.cif` has `X_summary_confidences.json` and `X_confidences.json`.
//! - AlphaFold 3, server: `X_model_N.cif` has `X_summary_confidences_N.json` and `X_full_data_N.json`.
//! - Boltz: `X.cif` has `confidence_X.json`, `pae_X.npz` and `plddt_X.npz`.
//! - ColabFold: `X_unrelaxed_Y.pdb` and `X_relaxed_Y.pdb` have `X_scores_Y.json`.
//! - Chai: `pred.model_idx_N.cif` has `scores.model_idx_N.npz`, and `pae.model_idx_N.npz` or `.npy`.
//! - Protenix: `X_sample_N.cif` has `X_summary_confidence_sample_N.json` and `X_full_data_sample_N.json`.
//!
//! JSON files may be packed (`.json.gz`). Names are those in the sources of the programs: AlphaFold 3
//! `docs/output.md`, Boltz `src/boltz/data/write/writer.py`, ColabFold `colabfold/batch.py`, Chai
//! `chai_lab/chai1.py`, Protenix `runner/dumper.py`. Chai itself writes no PAE; the names here are for scripts that save
//! `candidates.pae`.

use std::fs;
use std::path::{Path, PathBuf};

use knotdock_structures::Error;
use serde::Serialize;

/// Deepest folder below the one given in which models are found.
const MAX_DEPTH: usize = 8;

/// A program that predicts structures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Program {
    /// AlphaFold 3, local or of the server.
    AlphaFold3,
    /// Boltz-1 and Boltz-2.
    Boltz,
    /// ColabFold, with AlphaFold-Multimer.
    ColabFold,
    /// Chai-1.
    Chai,
    /// Protenix.
    Protenix,
}

/// The confidence files beside a structure, and the program whose names they have. Empty if there is none.
pub fn confidence_files(structure: &Path) -> (Option<Program>, Vec<PathBuf>) {
    let name = structure.file_name().unwrap_or_default().to_string_lossy();
    let Some(stem) = structure_stem(&name) else {
        return (None, Vec::new());
    };
    for (program, names) in candidates(stem) {
        let mut found = Vec::new();
        for name in names {
            let plain = structure.with_file_name(&name);
            let packed = structure.with_file_name(format!("{name}.gz"));
            found.extend([plain, packed].into_iter().find(|path| path.is_file()));
        }
        if !found.is_empty() {
            return (Some(program), found);
        }
    }
    (None, Vec::new())
}

/// The name of a structure file without its ending; `None` for other files.
fn structure_stem(name: &str) -> Option<&str> {
    let name = name.strip_suffix(".gz").unwrap_or(name);
    let endings = [".cif", ".mmcif", ".pdb", ".ent"];
    endings.iter().find_map(|ending| name.strip_suffix(ending))
}

/// Names that the confidence files of a structure may have, by program.
fn candidates(stem: &str) -> Vec<(Program, Vec<String>)> {
    let mut all = Vec::new();
    let numbered = |mark: &str| {
        let (before, number) = stem.rsplit_once(mark)?;
        let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
        is_number.then_some((before, number))
    };
    if let Some((_, number)) = numbered("model_idx_") {
        let name = |kind: &str| format!("{kind}.model_idx_{number}");
        let names = [
            format!("{}.npz", name("scores")),
            format!("{}.npz", name("pae")),
            format!("{}.npy", name("pae")),
        ];
        all.push((Program::Chai, names.into()));
    }
    for mark in ["_unrelaxed_", "_relaxed_"] {
        if let Some((before, after)) = stem.split_once(mark) {
            let names = vec![format!("{before}_scores_{after}.json")];
            all.push((Program::ColabFold, names));
        }
    }
    if let Some((before, number)) = numbered("_sample_") {
        let names = [
            format!("{before}_summary_confidence_sample_{number}.json"),
            format!("{before}_full_data_sample_{number}.json"),
        ];
        all.push((Program::Protenix, names.into()));
    }
    if let Some((before, number)) = numbered("_model_") {
        let names = [
            format!("{before}_summary_confidences_{number}.json"),
            format!("{before}_full_data_{number}.json"),
        ];
        all.push((Program::AlphaFold3, names.into()));
    }
    if let Some(before) = stem.strip_suffix("model") {
        let names = [
            format!("{before}summary_confidences.json"),
            format!("{before}confidences.json"),
        ];
        all.push((Program::AlphaFold3, names.into()));
    }
    let names = [
        format!("confidence_{stem}.json"),
        format!("pae_{stem}.npz"),
        format!("plddt_{stem}.npz"),
    ];
    all.push((Program::Boltz, names.into()));
    all
}

/// The models of a file or a folder, by name. In a folder and those below it, models are the structures with
/// confidence files; if none has any, all structures.
///
/// # Errors
/// [`Error`] for a folder that cannot be read or has no structure.
pub fn model_files(path: &Path) -> Result<Vec<PathBuf>, Error> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut structures = Vec::new();
    list(path, MAX_DEPTH, &mut structures)?;
    structures.sort_by_cached_key(|path| natural(&path.to_string_lossy()));
    let is_rated = |path: &PathBuf| !confidence_files(path).1.is_empty();
    let rated: Vec<PathBuf> = structures
        .iter()
        .filter(|path| is_rated(path))
        .cloned()
        .collect();
    match (rated.is_empty(), structures.is_empty()) {
        (false, _) => Ok(rated),
        (true, false) => Ok(structures),
        (true, true) => Err(Error::input("the folder has no structure")
            .at(path)
            .help("name a folder with .cif or .pdb files, or the files themselves")),
    }
}

/// Adds the structures of a folder and, down to a depth, of those in it. Links to folders are not followed.
fn list(folder: &Path, depth: usize, structures: &mut Vec<PathBuf>) -> Result<(), Error> {
    let unreadable = |error: std::io::Error| {
        Error::input(format!("the folder cannot be read: {error}"))
            .at(folder)
            .help("check its permissions, or name the models themselves")
    };
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() && !path.is_symlink() && depth > 0 {
            list(&path, depth - 1, structures)?;
        } else if path.is_file() && structure_stem(&name).is_some() {
            structures.push(path);
        }
    }
    Ok(())
}

/// A key that sorts `seed_9` before `seed_10`: runs of digits by their length first.
fn natural(name: &str) -> Vec<(usize, String)> {
    let characters: Vec<char> = name.chars().collect();
    let runs = characters.chunk_by(|a, b| a.is_ascii_digit() == b.is_ascii_digit());
    let key = |run: &[char]| {
        let text: String = run.iter().collect();
        let digits = text.trim_start_matches('0').len();
        match run.first().is_some_and(char::is_ascii_digit) {
            true => (digits, text),
            false => (usize::MAX, text),
        }
    };
    runs.map(key).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each program's names, with others' files beside them.
    #[test]
    fn files_are_found_by_the_names_of_each_program() {
        for (structure, program, names) in [
            (
                "fold_x_model_0.cif",
                Program::AlphaFold3,
                &[
                    "fold_x_summary_confidences_0.json",
                    "fold_x_full_data_0.json.gz",
                ] as &[&str],
            ),
            (
                "x_seed-1_sample-0_model.cif.gz",
                Program::AlphaFold3,
                &[
                    "x_seed-1_sample-0_summary_confidences.json",
                    "x_seed-1_sample-0_confidences.json",
                ],
            ),
            ("model.cif", Program::AlphaFold3, &["confidences.json"]),
            (
                "x_model_0.cif",
                Program::Boltz,
                &[
                    "confidence_x_model_0.json",
                    "pae_x_model_0.npz",
                    "plddt_x_model_0.npz",
                ],
            ),
            (
                "x_unrelaxed_rank_001_model_3_seed_000.pdb",
                Program::ColabFold,
                &["x_scores_rank_001_model_3_seed_000.json"],
            ),
            (
                "pred.model_idx_2.cif",
                Program::Chai,
                &["scores.model_idx_2.npz", "pae.model_idx_2.npy"],
            ),
            (
                "x_seed_42_sample_1.cif",
                Program::Protenix,
                &[
                    "x_seed_42_summary_confidence_sample_1.json",
                    "x_seed_42_full_data_sample_1.json",
                ],
            ),
        ] {
            let folder = tempfile::tempdir().unwrap();
            let at = |name: &str| folder.path().join(name);
            assert_eq!(confidence_files(&at(structure)), (None, Vec::new()));
            for name in names {
                fs::write(at(name), "").unwrap();
            }
            fs::write(at("pae_x_model_1.npz"), "").unwrap();
            fs::write(at("x_summary_confidences_1.json"), "").unwrap();
            let expected: Vec<PathBuf> = names.iter().map(|name| at(name)).collect();
            assert_eq!(
                confidence_files(&at(structure)),
                (Some(program), expected),
                "{structure}"
            );
        }
        assert_eq!(confidence_files(Path::new("x.json")), (None, Vec::new()));
    }

    /// Several seeds in one folder, in their order; the template beside them is no model.
    #[test]
    fn folders_hold_many_models() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str| {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        };
        write("template.cif");
        assert_eq!(model_files(folder.path()).unwrap().len(), 1);
        for seed in [10, 9] {
            for sample in [0, 1] {
                write(&format!("seed_{seed}/x_sample_{sample}.cif"));
                write(&format!(
                    "seed_{seed}/x_summary_confidence_sample_{sample}.json"
                ));
            }
        }
        let found = model_files(folder.path()).unwrap();
        let names = [
            "9/x_sample_0",
            "9/x_sample_1",
            "10/x_sample_0",
            "10/x_sample_1",
        ];
        let expected = names.map(|name| folder.path().join(format!("seed_{name}.cif")));
        assert_eq!(found, expected);
        let empty = tempfile::tempdir().unwrap();
        assert!(model_files(empty.path()).unwrap_err().remedy().is_some());
    }
}
