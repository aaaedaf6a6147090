//! The two sides of a complex file: as named, as knotdock wrote them, or the two chains that there are.

use std::path::PathBuf;

use knotdock_structures::molecule::{InputSpec, Molecule, ReadOptions, file_bytes, read_bytes};

use rayon::prelude::*;

use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;

/// A complex as two molecules where they stand.
pub struct ComplexSides {
    /// The file.
    pub path: PathBuf,
    /// Chains of each side, with commas between them.
    pub chains: [String; 2],
    /// The sides.
    pub molecules: [Molecule; 2],
}

impl ComplexSides {
    /// Reads a file, with the chains of both sides or without.
    ///
    /// # Errors
    /// [`Failure`] for a file that cannot be read, and for one that does not say which chains belong together.
    pub fn read(
        file: &str,
        chains: Option<&[String; 2]>,
        options: &ReadOptions,
    ) -> Result<Self, Failure> {
        let path = PathBuf::from(file);
        let bytes = file_bytes(&path)?;
        let chains = match chains {
            Some(chains) => chains.clone(),
            None => match written_sides(&String::from_utf8_lossy(&bytes)) {
                Some(chains) => chains,
                None => two_chains(&path, bytes.clone(), options)?,
            },
        };
        let side = |names: &String| -> Result<Molecule, Failure> {
            let spec = InputSpec {
                chains: Some(names.split(',').map(str::to_owned).collect()),
                ..InputSpec::whole(&path)
            };
            Ok(read_bytes(&spec, bytes.clone(), options)?)
        };
        let molecules = [side(&chains[0])?, side(&chains[1])?];
        Ok(Self {
            path,
            chains,
            molecules,
        })
    }
}

/// The files that words name, and the chains of both sides where they stand behind them.
///
/// # Errors
/// [`Failure`] where the words name no file, or the chains of one side or of more than two.
pub fn files_and_chains<'a>(
    words: &'a [String],
    command: &str,
) -> Result<(&'a [String], Option<[String; 2]>), Failure> {
    let last = words.iter().rev();
    let named = last.take_while(|word| is_chains(word)).count();
    let (files, chains) = words.split_at(words.len() - named);
    let chains = match chains {
        [] => None,
        [first, second] => Some([first.clone(), second.clone()]),
        others => {
            let sides = match others.len() {
                1 => "one side".to_owned(),
                count => format!("{count} sides"),
            };
            return Err(Failure::input(format!(
                "chains of {sides} are given, and a complex has two sides"
            ))
            .remedy(format!(
                "name the chains of both sides behind the files, as in `knotdock {command} x.pdb H,L A`"
            )));
        }
    };
    if files.is_empty() {
        return Err(Failure::input("no complex is given")
            .remedy("give a file; its name needs a point or a folder, as in ./complex"));
    }
    Ok((files, chains))
}

/// What is made of each file, in their order, and the exit code. A file of which nothing can be made is reported and costs
/// no other.
///
/// # Errors
/// The [`Failure`] of a file that is the only one.
pub fn for_each_file<T: Send>(
    files: &[String],
    console: Console,
    make: impl Fn(&str) -> Result<T, Failure> + Sync,
) -> Result<(Vec<T>, u8), Failure> {
    let made: Vec<Result<T, Failure>> = files.par_iter().map(|file| make(file)).collect();
    let (mut rows, mut code) = (Vec::new(), 0);
    for one in made {
        match one {
            Ok(row) => rows.push(row),
            Err(failure) if files.len() == 1 => return Err(failure),
            Err(failure) => {
                console.error(failure.text());
                code = code.max(failure.exit_code());
            }
        }
    }
    Ok((rows, code))
}

/// Whether a word names chains and no file: it has neither a point nor a folder.
fn is_chains(word: &str) -> bool {
    !word.contains(['.', '/', '\\'])
}

/// The sides that the remarks of a complex of knotdock name: `chain B is ligand chain I`. Of a ring all copies but the
/// first are the second side.
fn written_sides(text: &str) -> Option<[String; 2]> {
    let mut sides = [Vec::new(), Vec::new()];
    for line in text.lines() {
        let line = line.strip_prefix("REMARK  99 ").unwrap_or(line).trim();
        let Some((name, rest)) = line
            .strip_prefix("chain ")
            .and_then(|rest| rest.split_once(" is "))
        else {
            continue;
        };
        if rest.starts_with("receptor chain ") {
            sides[0].push(name);
        } else if rest.starts_with("ligand chain ") || rest.starts_with("copy ") {
            sides[1].push(name);
        }
    }
    let is_whole = sides.iter().all(|side| !side.is_empty());
    is_whole.then(|| sides.map(|side| side.join(",")))
}

/// The chains of a file that has two.
fn two_chains(
    path: &PathBuf,
    bytes: Vec<u8>,
    options: &ReadOptions,
) -> Result<[String; 2], Failure> {
    let molecule = read_bytes(&InputSpec::whole(path), bytes, options)?;
    let chains = molecule.report.chains.iter();
    let names: Vec<String> = chains
        .map(|chain| match chain.name.as_str() {
            "" => "_".to_owned(),
            name => name.to_owned(),
        })
        .collect();
    <[String; 2]>::try_from(names).map_err(|names| {
        Failure::input(format!(
            "it is not known which chains belong together; the file has {}",
            names.join(", ")
        ))
        .at(path)
        .remedy("name the chains of both sides behind the files, as in `knotdock interface x.pdb H,L A`")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn complexes_of_knotdock_name_their_sides() {
        let pdb = "REMARK  99 knotdock 0.1.0, rank 1\n\
                   REMARK  99 chain A is receptor chain A\nREMARK  99 chain H is ligand chain H\n\
                   REMARK  99 chain L is ligand chain L\nATOM\n";
        assert_eq!(written_sides(pdb), Some(["A".into(), "H,L".into()]));
        let cif = ";\nchain A is receptor chain A\nchain B is ligand chain A\nchain C is copy 3 chain A\n;\n";
        assert_eq!(written_sides(cif), Some(["A".into(), "B,C".into()]));
        assert_eq!(
            written_sides("REMARK  99 chain A is receptor chain A\n"),
            None
        );
    }

    #[test]
    fn words_without_a_point_are_chains() {
        assert!(is_chains("H,L") && is_chains("A"));
        assert!(!is_chains("x.pdb") && !is_chains("./complex"));
    }
}
