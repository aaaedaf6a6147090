//! The two sides of a complex file: as named, as knotdock wrote them, or the two chains that there are.

use std::path::PathBuf;

use rayon::prelude::*;

use crate::messages::console::{Console, failure_text};
use knotdock_structures::Error;
use knotdock_structures::molecule::{
    InputSpec, ModelChoice, Molecule, ReadOptions, file_bytes, model_count, read_bytes,
};

/// A model of a complex file as two molecules where they stand.
pub struct ComplexSides {
    pub path: PathBuf,
    /// Place of the model in the file, from 1.
    pub model: usize,
    /// Chains of each side, with commas between them.
    pub chains: [String; 2],
    pub molecules: [Molecule; 2],
}

impl ComplexSides {
    /// Reads a model of a file, with the chains of both sides or without.
    fn read(
        file: &ModelFile,
        model: usize,
        chains: Option<&[String; 2]>,
        options: &ReadOptions,
    ) -> Result<Self, Error> {
        let whole = InputSpec {
            // Of one, the options of reading say what is read.
            model: (file.models.len() > 1).then_some(model),
            ..InputSpec::whole(&file.path)
        };
        let chains = match chains {
            Some(chains) => chains.clone(),
            None => match written_sides(&String::from_utf8_lossy(&file.bytes)) {
                Some(chains) => chains,
                None => two_chains(&whole, file.bytes.clone(), options)?,
            },
        };
        let side = |names: &String| -> Result<Molecule, Error> {
            let spec = InputSpec {
                chains: Some(names.split(',').map(str::to_owned).collect()),
                ..whole.clone()
            };
            read_bytes(&spec, file.bytes.clone(), options)
        };
        let molecules = [side(&chains[0])?, side(&chains[1])?];
        Ok(Self {
            path: whole.path,
            model,
            chains,
            molecules,
        })
    }

    /// Warnings of the reader on both sides, each once.
    fn warnings(&self) -> Vec<String> {
        let mut warnings: Vec<String> = Vec::new();
        for warning in self.molecules.iter().flat_map(|one| &one.report.warnings) {
            let warning = format!("{}: {warning}", self.path.display());
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
        warnings
    }
}

/// A file with its bytes, unpacked once, and the places of the models that are read of it, from 1.
struct ModelFile {
    path: PathBuf,
    bytes: Vec<u8>,
    models: Vec<usize>,
}

impl ModelFile {
    /// Reads a file. If a file has several models, every one counts, unless the options of reading choose.
    fn read(file: &str, options: &ReadOptions) -> Result<Self, Error> {
        let path = PathBuf::from(file);
        let bytes = file_bytes(&path)?;
        let models = match options.model {
            choice if choice == ModelChoice::default() => {
                (1..=model_count(&path, bytes.clone())?).collect()
            }
            ModelChoice::Number(model) => vec![model],
            ModelChoice::All => vec![1],
        };
        Ok(Self {
            path,
            bytes,
            models,
        })
    }
}

/// The files that words name, and the chains of both sides if they follow.
pub fn files_and_chains<'a>(
    words: &'a [String],
    command: &str,
) -> Result<(&'a [String], Option<[String; 2]>), Error> {
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
            return Err(Error::input(format!(
                "chains of {sides} are given, and a complex has two sides"
            ))
            .help(format!(
                "name the chains of both sides behind the files, as in `knotdock {command} x.pdb H,L A`"
            )));
        }
    };
    if files.is_empty() {
        return Err(Error::input("no complex is given")
            .help("give a file; its name needs a point or a folder, as in ./complex"));
    }
    Ok((files, chains))
}

/// Makes something of each model of each file, in order; the exit code. Failures of several models are reported.
pub fn for_each_model<T: Send>(
    (files, chains): (&[String], Option<&[String; 2]>),
    options: &ReadOptions,
    console: Console,
    make: impl Fn(&str, ComplexSides) -> Result<T, Error> + Sync,
) -> Result<(Vec<T>, u8), Error> {
    type ModelResult<T> = (Vec<String>, Result<T, Error>);
    let of_model = |name: &str, file: &ModelFile, model: usize| -> ModelResult<T> {
        let (warnings, made) = match ComplexSides::read(file, model, chains, options) {
            Ok(sides) => (sides.warnings(), make(name, sides)),
            Err(failure) => (Vec::new(), Err(failure)),
        };
        let made = made.map_err(|failure| match file.models.len() {
            1 => failure,
            _ => failure.within(format!("model {model}")),
        });
        (warnings, made)
    };
    let of_file = |name: &String| -> Vec<ModelResult<T>> {
        match ModelFile::read(name, options) {
            Ok(file) => {
                let models = file.models.par_iter();
                models.map(|&model| of_model(name, &file, model)).collect()
            }
            Err(failure) => vec![(Vec::new(), Err(failure))],
        }
    };
    let made: Vec<Vec<ModelResult<T>>> = files.par_iter().map(of_file).collect();
    let is_only = made.iter().map(Vec::len).sum::<usize>() == 1;
    let (mut rows, mut code, mut warned) = (Vec::new(), 0, Vec::new());
    for (warnings, one) in made.into_iter().flatten() {
        for warning in warnings {
            if !warned.contains(&warning) {
                console.warn(&warning);
                warned.push(warning);
            }
        }
        match one {
            Ok(row) => rows.push(row),
            Err(failure) if is_only => return Err(failure),
            Err(failure) => {
                console.error(failure_text(&failure));
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

/// Sides by the remarks of a knotdock complex: `chain B is ligand chain I`; of a ring, the first copy and the others.
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
    whole: &InputSpec,
    bytes: Vec<u8>,
    options: &ReadOptions,
) -> Result<[String; 2], Error> {
    let molecule = read_bytes(whole, bytes, options)?;
    let chains = molecule.report.chains.iter();
    let names: Vec<String> = chains
        .map(|chain| match chain.name.as_str() {
            "" => "_".to_owned(),
            name => name.to_owned(),
        })
        .collect();
    <[String; 2]>::try_from(names).map_err(|names| {
        Error::input(match names.as_slice() {
            [name] => format!("a complex has two sides, and the file has one chain, {name}"),
            names => format!(
                "it is not known which chains belong together; the file has {}",
                names.join(", ")
            ),
        })
        .at(&whole.path)
        .help("name the chains of both sides behind the files, as in `knotdock interface x.pdb H,L A`")
    })
}

/// Receptor and ligand of a complex to dock again, by its file and perhaps the chains of both: `model.cif`, whose first
/// of two chains is the receptor, `model.cif:A,B`, or `model.cif`, `H,L` and `A`.
pub fn sides_of_model(words: &[String], options: &ReadOptions) -> Result<[InputSpec; 2], Error> {
    const REMEDY: &str = "give a complex, and the chains of its receptor and ligand, as in `--from-model model.cif H,L A`";
    let (files, chains) = files_and_chains(words, "dock --from-model")?;
    let [file] = files else {
        let message = format!(
            "--from-model takes one file, and {} are given",
            files.join(" and ")
        );
        return Err(Error::input(message).help(REMEDY));
    };
    let InputSpec {
        path,
        chains: picked,
        ..
    } = InputSpec::parse(file)?;
    let whole = InputSpec::whole(path);
    let sides = match (chains, picked.as_deref()) {
        (Some(sides), None) => sides,
        (None, Some([first, second])) => [first.clone(), second.clone()],
        (None, None) => two_chains(&whole, file_bytes(&whole.path)?, options)
            .map_err(|error| error.help(REMEDY))?,
        (_, Some(_)) => {
            let message = format!("{file} does not say which chains are the receptor's");
            return Err(Error::input(message).at(&whole.path).help(REMEDY));
        }
    };
    Ok(sides.map(|names| InputSpec {
        chains: Some(names.split(',').map(str::to_owned).collect()),
        ..whole.clone()
    }))
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
