//! A run as the page requests it, and the command line that makes it.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::folder::{Folder, INPUTS};
use crate::inputs::molecules::label;
use crate::messages::shown::shell_word;
use knotdock::options::definition::Form;
use knotdock::options::{Preset, option_named};
use knotdock_structures::Error;

/// A run to make.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RunRequest {
    pub receptor: Side,
    /// None in a ring, whose copies are all of the receptor.
    pub ligand: Option<Side>,
    pub preset: Option<String>,
    /// Options of `knotdock dock` by their names.
    pub options: BTreeMap<String, String>,
}

/// The files of a side: a structure, and others that are further conformations of it.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Side {
    pub upload: String,
    pub files: Vec<String>,
    /// Chains as after the colon of a file's name; empty for all.
    pub chains: String,
}

impl Side {
    /// The files with their chains, as a command names them.
    fn words(&self, folder: &Folder) -> Result<Vec<String>, Error> {
        if self.files.is_empty() || self.chains.contains(['/', '\\']) {
            return Err(Error::input("a file and names of its chains are needed")
                .help("drop a structure, and pick its chains"));
        }
        let chains = match self.chains.is_empty() {
            true => String::new(),
            false => format!(":{}", self.chains),
        };
        let word = |file: &String| match folder.input(&self.upload, file) {
            Some(_) => Ok(format!("{INPUTS}/{}/{file}{chains}", self.upload)),
            None => Err(Error::input(format!("{file} is not among the uploads"))
                .help("drop the file again")),
        };
        self.files.iter().map(word).collect()
    }

    fn label(&self) -> String {
        let chains = (!self.chains.is_empty()).then(|| vec![self.chains.clone()]);
        let file = self.files.first().map_or("", String::as_str);
        label(Path::new(file), chains.as_deref())
    }
}

impl RunRequest {
    /// A name for the folder of the run.
    pub fn label(&self) -> String {
        let labels = [Some(&self.receptor), self.ligand.as_ref()];
        let labels = labels.into_iter().flatten().map(Side::label);
        labels.collect::<Vec<_>>().join("_")
    }

    /// The arguments of the program, in the folder that is served.
    pub fn words(&self, folder: &Folder, run: &str) -> Result<Vec<String>, Error> {
        let receptors = self.receptor.words(folder)?;
        let ligands = match &self.ligand {
            Some(ligand) => ligand.words(folder)?,
            None => Vec::new(),
        };
        let mut words = vec!["dock".to_owned()];
        let sides = [("receptor", &receptors), ("ligand", &ligands)];
        words.extend(sides.iter().filter_map(|(_, files)| files.first().cloned()));
        for (side, files) in sides {
            let others = files.iter().skip(1);
            words.extend(others.map(|file| format!("--{side}-also={file}")));
        }
        words.push(format!("--output={run}"));
        if let Some(preset) = &self.preset {
            let known = Preset::named(preset).ok_or_else(|| unknown("preset", preset))?;
            words.push(format!("--preset={}", known.name));
        }
        for (name, value) in &self.options {
            let option = option_named(name).filter(|option| option.form() != Form::File);
            let option = option.ok_or_else(|| unknown("option of the page", name))?;
            words.push(match (option.is_of_files(), option.form()) {
                (true, _) => format!("--config={}", option.line(value)),
                (_, Form::Flag) => format!("--{}", option.long()),
                _ => format!("--{}={value}", option.long()),
            });
        }
        Ok(words)
    }
}

fn unknown(kind: &str, name: &str) -> Error {
    Error::input(format!("{name} is no {kind}"))
        .help("options that name files are given on the command line")
}

/// A command line to type, by its words after the program's name.
pub fn typed(words: &[String]) -> String {
    let words = words.iter().map(|word| shell_word(word).into_owned());
    format!("knotdock {}", words.collect::<Vec<_>>().join(" "))
}
