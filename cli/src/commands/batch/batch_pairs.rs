//! The pairs of a batch: rows of a table as command lines of `knotdock dock`.

use std::collections::HashMap;
use std::path::Path;

use clap::error::{ContextKind, ErrorKind};
use clap::{CommandFactory, FromArgMatches, Parser, ValueHint};

use crate::arguments::options::CONFIG;
use crate::arguments::with_negative_numbers;
use crate::commands::dock::{Dock, PLACE, refusing_recorded};
use crate::inputs::bodies::spec_of;
use crate::inputs::molecules::label;
use crate::messages::suggestions::{first_paragraph, suggested};
use crate::shards::record::RECORD;
use crate::shards::{ATTEMPTS, POSES, SHARDS, Shard};
use crate::tables::batch_results::RESULTS;
use crate::tables::pair_table::{PairRow, read_pairs};
use knotdock::options::definition::Form;
use knotdock::options::option_named;
use knotdock::output::files::checksum::sha256;
use knotdock::output::files::seal::REPORT;
use knotdock::plain_path::plain_path;
use knotdock_structures::Error;
use knotdock_structures::molecule::InputSpec;

/// One pair's command line.
#[derive(Parser, Debug)]
#[command(name = "knotdock dock")]
struct PairCommand {
    #[command(flatten)]
    dock: Dock,
}

pub struct Pair {
    /// Its row in the table, from 1.
    pub index: usize,
    /// Its name, and that of the directory of its run.
    pub name: String,
    pub row: PairRow,
    pub dock: Dock,
    /// Expected cost relative to others: the bytes of its files.
    pub cost: f64,
}

pub struct Pairs {
    /// The pairs of the shard, in the order of the table.
    pub own: Vec<Pair>,
    pub total: usize,
    /// SHA-256 of all rows.
    pub sha256: String,
}

/// The pairs of the table that a shard has, with their command lines, each checked as far as words go.
pub fn pairs(
    table: &Path,
    shard: Shard,
    directory: &Path,
    options: &[String],
) -> Result<Pairs, Error> {
    let folder = table.parent().unwrap_or(Path::new(""));
    let mut names: HashMap<String, u64> = HashMap::new();
    check_options(options)?;
    let symmetry = symmetry(options);
    let rows = read_pairs(table, symmetry.is_some())?;
    let total = rows.len();
    let sums: String = rows.iter().map(PairRow::checksum).collect();
    let pairs = (1..).zip(rows).map(|(index, row)| {
        let refused = |error: Error| error.at(table).on_line(Some(row.line));
        let name = match row.name.as_str() {
            "" => format!("{}_{}", part(&row.receptor)?, partner(&row, symmetry)?),
            name => name.to_owned(),
        };
        check_name(&name).map_err(refused)?;
        // Some file systems do not distinguish upper and lower case.
        if let Some(line) = names.insert(name.to_lowercase(), row.line) {
            let message = format!("the pair on line {line} has the same name, {name}");
            let error =
                Error::input(message).help("give each pair its own name in a column `name`");
            return Err(refused(error));
        }
        if !shard.has(index) {
            return Ok(None);
        }
        let dock = command(&row, &directory.join(&name), folder, options).map_err(refused)?;
        let cost = cost(&row, folder);
        Ok(Some(Pair {
            index,
            name,
            row,
            dock,
            cost,
        }))
    });
    let pairs: Result<Vec<Pair>, Error> = pairs.filter_map(Result::transpose).collect();
    Ok(Pairs {
        own: pairs?,
        total,
        sha256: sha256(sums.as_bytes()),
    })
}

/// Refuses names that cannot be those of a directory, or are those of the batch's files and folders.
fn check_name(name: &str) -> Result<(), Error> {
    let is_plain = |c: char| c.is_alphanumeric() || "._-".contains(c);
    if !name.starts_with(char::is_alphanumeric) || !name.chars().all(is_plain) {
        return Err(Error::input(format!("'{name}' cannot be the name of a directory")).help(
            "name the pair with letters, digits, `.`, `_` and `-`; a letter or a digit comes first",
        ));
    }
    if [RECORD, RESULTS, POSES, ATTEMPTS, REPORT, SHARDS].contains(&name.to_lowercase().as_str()) {
        let message = format!("a file of the batch is called {name}, so no pair can be");
        return Err(Error::input(message).help("give the pair another name in a column `name`"));
    }
    Ok(())
}

/// Files in place of a row's, when the options after `--` are checked alone.
const PLACEHOLDERS: [&str; 2] = ["knotdock-row-receptor", "knotdock-row-ligand"];

fn pair_command() -> clap::Command {
    refusing_recorded(PairCommand::command())
}

/// Whether a column names files.
fn names_files(column: &str) -> bool {
    let command = pair_command();
    let mut arguments = command.get_arguments();
    arguments.any(|argument| {
        argument.get_id() == column && argument.get_value_hint() == ValueHint::FilePath
    })
}

fn parse(words: impl IntoIterator<Item = String>) -> Result<PairCommand, clap::Error> {
    let matches = with_negative_numbers(pair_command()).try_get_matches_from(words)?;
    PairCommand::from_arg_matches(&matches)
}

fn with_suggestion(error: &clap::Error, remedy: &str) -> String {
    suggested(error).map_or(remedy.to_owned(), |text| format!("{text}; {remedy}"))
}

/// Refuses options after `--` that no pair's command line could have, so that no row of the table is blamed.
fn check_options(options: &[String]) -> Result<(), Error> {
    const REMEDY: &str =
        "after -- come options of `knotdock dock`, which `knotdock dock --help` lists";
    let files = ["--"].iter().chain(&PLACEHOLDERS).map(ToString::to_string);
    let program = std::iter::once("knotdock dock".to_owned());
    let error = match parse(program.chain(options.iter().cloned()).chain(files)) {
        Ok(command) if command.dock.names_its_run() => {
            let message =
                "--output cannot come after --: the batch chooses the directories of its runs";
            return Err(Error::input(message).help("name the batch's directory with -o before --"));
        }
        Ok(command) => return command.dock.check_config(),
        Err(error) => error,
    };
    let names = |argument: &str| {
        let named = [ContextKind::InvalidArg, ContextKind::PriorArg];
        let mut named = named.into_iter().filter_map(|kind| error.get(kind));
        named.any(|named| named.to_string().contains(argument))
    };
    let message = match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            "--help cannot come after --".to_owned()
        }
        ErrorKind::UnknownArgument if PLACEHOLDERS.into_iter().any(names) => {
            "files cannot come after --: the table names them".to_owned()
        }
        _ if names("--rerun") => {
            "--rerun cannot come after --: the table lists the pairs to dock".to_owned()
        }
        // Rows without a ligand need --symmetry, which conflicts with a ligand.
        ErrorKind::ArgumentConflict if names("LIGAND") => return Ok(()),
        ErrorKind::ArgumentConflict
        | ErrorKind::UnknownArgument
        | ErrorKind::InvalidValue
        | ErrorKind::ValueValidation
        | ErrorKind::NoEquals
        | ErrorKind::TooManyValues
        | ErrorKind::TooFewValues => format!("after --: {}", first_paragraph(&error)),
        // The options of a row may add what is missing.
        _ => return Ok(()),
    };
    Err(Error::input(message).help(with_suggestion(&error, REMEDY)))
}

fn command(row: &PairRow, run: &Path, folder: &Path, options: &[String]) -> Result<Dock, Error> {
    const COLUMNS: &str = "name columns as the options that `knotdock dock --help` lists, and give each option once: \
                           in a column or after --";
    let mut words = vec!["knotdock dock".to_owned()];
    for (column, value) in &row.options {
        if PLACE.contains(&column.as_str()) {
            return Err(Error::input(format!("a column cannot be `{column}`")).help(COLUMNS));
        }
        let of_files = option_named(column).filter(|option| option.is_of_files());
        let is_file = match of_files {
            Some(option) => option.form() == Form::File,
            None => names_files(column) && !(column == CONFIG && value.contains('=')),
        };
        let value = if is_file {
            at(folder, value)
        } else {
            value.clone()
        };
        words.push(match of_files {
            Some(option) => format!("--{CONFIG}={}", option.line(&value)),
            None => format!("--{}={value}", column.replace('_', "-")),
        });
    }
    words.push(format!("--output={}", run.display()));
    words.extend(options.iter().cloned());
    words.push("--".to_owned());
    let files = [&row.receptor, &row.ligand].into_iter();
    let files = files.filter(|file| !file.is_empty());
    words.extend(files.map(|file| at(folder, file)));
    let command = parse(words).map_err(|error| {
        Error::input(first_paragraph(&error)).help(with_suggestion(&error, COLUMNS))
    })?;
    Ok(command.dock)
}

/// Bytes of a pair's files, packed ones as they may be unpacked: the time of a run grows about as its atoms.
fn cost(row: &PairRow, folder: &Path) -> f64 {
    let bytes = |file: &String| {
        let spec = spec_of(&at(folder, file)).ok()?;
        let bytes = std::fs::metadata(&spec.path).ok()?.len() as f64;
        let is_packed = spec.path.extension().is_some_and(|ending| ending == "gz");
        Some(if is_packed { PACKED * bytes } else { bytes })
    };
    [&row.receptor, &row.ligand]
        .into_iter()
        .filter_map(bytes)
        .sum()
}

/// Bytes of a structure file for each byte of it that is packed by gzip.
const PACKED: f64 = 4.0;

fn at(folder: &Path, file: &str) -> String {
    let path = plain_path(&folder.join(file));
    path.to_string_lossy().into_owned()
}

/// A file's part of a pair's name.
fn part(file: &str) -> Result<String, Error> {
    let spec = InputSpec::parse(file)?;
    Ok(label(&spec.path, spec.chains.as_deref()))
}

/// The partner of the receptor in the pair's name: the ligand, or the symmetry of the ring.
fn partner(row: &PairRow, of_all: Option<&str>) -> Result<String, Error> {
    let own = row.options.iter().find(|(name, _)| name == "symmetry");
    match own.map(|(_, symmetry)| symmetry.as_str()).or(of_all) {
        Some(symmetry) if row.ligand.is_empty() => Ok(symmetry.to_owned()),
        _ => part(&row.ligand),
    }
}

/// The symmetry that all pairs are docked with.
fn symmetry(options: &[String]) -> Option<&str> {
    let at = options
        .iter()
        .position(|word| word.starts_with("--symmetry"))?;
    match options[at].strip_prefix("--symmetry")? {
        "" => options.get(at + 1).map(String::as_str),
        value => value.strip_prefix('='),
    }
}
