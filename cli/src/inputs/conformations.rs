//! The conformations of a side that the command line names: models of a file, and further files.

use std::collections::HashSet;

use crate::arguments::conformations::ModelList;
use crate::inputs::solids::is_shape;
use knotdock::output::files::whole_file::is_stream;
use knotdock_structures::Error;
use knotdock_structures::molecule::{InputSpec, file_bytes, model_count};

#[derive(Clone, Debug)]
pub struct Conformation {
    /// Its name in tables: the number of the model, or of the file, or both as FILE.MODEL.
    pub name: String,
    pub spec: InputSpec,
}

/// The conformations of a side, the first one first: each file, and of it the models that are listed.
pub fn conformations(
    first: &str,
    also: &[String],
    models: Option<&ModelList>,
) -> Result<Vec<Conformation>, Error> {
    let mut found: Vec<Conformation> = Vec::new();
    let mut seen = HashSet::new();
    let files = std::iter::once(first).chain(also.iter().map(String::as_str));
    for (text, number) in files.zip(1..) {
        let spec = InputSpec::parse(text)?;
        check(&spec)?;
        for model in chosen(&spec, models)? {
            let name = match (also.is_empty(), model) {
                (true, model) => model.unwrap_or(1).to_string(),
                (false, None) => format!("{number}"),
                (false, Some(model)) => format!("{number}.{model}"),
            };
            let spec = match model {
                Some(model) => spec.clone().of_model(model),
                None => spec.clone(),
            };
            let path = spec
                .path
                .canonicalize()
                .unwrap_or_else(|_| spec.path.clone());
            if !seen.insert((path, spec.chains.clone(), model)) {
                return Err(Error::input("the same conformation is named twice")
                    .at(&spec.path)
                    .help("name each conformation once"));
            }
            found.push(Conformation { name, spec });
        }
    }
    Ok(found)
}

/// Refuses files other than molecules, and those that can be read only once.
fn check(spec: &InputSpec) -> Result<(), Error> {
    if is_shape(&spec.path) {
        return Err(
            Error::input("only molecules can be docked as ensembles, and this is a mesh")
                .at(&spec.path)
                .help("dock two meshes without --receptor-models, --receptor-also and their like"),
        );
    }
    if is_stream(&spec.path) && !spec.path.is_dir() {
        return Err(Error::input(
            "a pipe can be read once, and an ensemble reads its files several times",
        )
        .at(&spec.path)
        .help("give a file"));
    }
    Ok(())
}

/// The models of a file that are docked; `None` is the default one.
fn chosen(spec: &InputSpec, models: Option<&ModelList>) -> Result<Vec<Option<usize>>, Error> {
    let Some(models) = models else {
        return Ok(vec![None]);
    };
    let count = model_count(&spec.path, file_bytes(&spec.path)?)?;
    match models {
        ModelList::All if count == 1 => Ok(vec![None]),
        ModelList::All => Ok((1..=count).map(Some).collect()),
        ModelList::These(numbers) => match numbers.iter().find(|&&number| number > count) {
            Some(number) => Err(Error::input(format!(
                "there is no model {number}; the file has {count}"
            ))
            .at(&spec.path)
            .help("list models that the file has, which count from 1 in its order, or give all")),
            None => Ok(numbers.iter().copied().map(Some).collect()),
        },
    }
}
