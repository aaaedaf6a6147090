//! The pairs of a batch: rows of a table as command lines of `knotdock dock`.

use std::collections::HashMap;
use std::path::Path;

use crate::messages::suggestions::first_paragraph;
use crate::shards::record::RECORD;
use crate::shards::{ATTEMPTS, POSES, SHARDS, Shard};
use crate::tables::batch_results::RESULTS;
use crate::tables::pair_table::{PairRow, read_pairs};
use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser, ValueHint};
use knotdock::options::definition::Form;
use knotdock::options::option_named;
use knotdock::output::files::checksum::sha256;
use knotdock::output::files::seal::REPORT;
use knotdock::plain_path::plain_path;
use knotdock_structures::molecule::InputSpec;

use crate::arguments::options::CONFIG;
use crate::arguments::program::with_negative_numbers;
use crate::commands::dock::{Dock, PLACE, refusing_recorded};
use crate::inputs::bodies::spec_of;
use crate::inputs::molecules::label;
use crate::messages::suggestions;
use knotdock_structures::Error;

/// One pair's command line.
#[derive(Parser, Debug)]
#[command(name = "knotdock dock")]
struct PairCommand {
    #[command(flatten)]
    dock: Dock,
}

/// A pair that is to be docked.
pub struct Pair {
    /// Its row in the table, from 1.
    pub index: usize,
    /// Its name, and that of the directory of its run.
    pub name: String,
    /// Its row of the table.
    pub row: PairRow,
    /// Its command line.
    pub dock: Dock,
    /// What it is expected to cost beside others: the bytes of its files.
    pub cost: f64,
}

/// The pairs of a table that a shard has.
pub struct Pairs {
    /// They, in the order of the table.
    pub own: Vec<Pair>,
    /// How many there are in all.
    pub total: usize,
    /// SHA-256 of what all rows say.
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
            let wrong = |message: String, remedy: &str| {
                Error::input(message)
                    .at(table)
                    .on_line(Some(row.line))
                    .help(remedy)
            };
            let name = match row.name.as_str() {
                "" => format!("{}_{}", part(&row.receptor)?, partner(&row, symmetry)?),
                name => name.to_owned(),
            };
            if !is_name(&name) {
                return Err(wrong(
                    format!("'{name}' cannot be the name of a directory"),
                    "name the pair with letters, digits, `.`, `_` and `-`; a letter or a digit comes first",
                ));
            }
            if OF_BATCH.contains(&name.to_lowercase().as_str()) {
                return Err(wrong(
                    format!("a file of the batch is called {name}, so no pair can be"),
                    "give the pair another name in a column `name`",
                ));
            }
            // Letters of either case are one where file systems think so.
            if let Some(line) = names.insert(name.to_lowercase(), row.line) {
                return Err(wrong(
                    format!("the pair on line {line} has the same name, {name}"),
                    "give each pair a name of its own in a column `name`",
                ));
            }
            if !shard.has(index) {
                return Ok(None);
            }
            let dock = command(&row, &directory.join(&name), folder, options);
            let dock = dock.map_err(|(message, suggested)| {
                const COLUMNS: &str = "name columns as the options that `knotdock dock --help` lists, and give each option once: \
                                       in a column or after --";
                match suggested {
                    Some(text) => wrong(message, &format!("{text}; {COLUMNS}")),
                    None => wrong(message, COLUMNS),
                }
            })?;
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

/// Stand for a row's files where only the options are looked at.
const FILLED_IN: [&str; 2] = ["knotdock-row-receptor", "knotdock-row-ligand"];

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

/// Refuses options after `--` that no pair's command line could have: a row of the table is not at fault then.
fn check_options(options: &[String]) -> Result<(), Error> {
    let remedy = "after -- come options of `knotdock dock`, which `knotdock dock --help` lists";
    let of_no_row = ["knotdock dock"].into_iter().map(str::to_owned);
    let files = ["--"].iter().chain(&FILLED_IN).map(ToString::to_string);
    let words = of_no_row.chain(options.iter().cloned()).chain(files);
    match parse(words) {
        Ok(command) if command.dock.names_its_run() => Err(Error::input(
            "--output cannot stand after --: the batch chooses the directories of its runs",
        )
        .help("name the batch's own directory with -o before --")),
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
            ) =>
        {
            Err(Error::input("--help cannot stand after --").help(remedy))
        }
        Err(error)
            if error.kind() == ErrorKind::UnknownArgument
                && FILLED_IN
                    .iter()
                    .any(|file| first_paragraph(&error).contains(*file)) =>
        {
            Err(Error::input("files cannot stand after --: the table names them").help(remedy))
        }
        // In conflict with the files are --rerun, which no row can do with, and --symmetry, which a row without a
        // ligand asks for.
        Err(error) if first_paragraph(&error).contains("--rerun") => Err(Error::input(
            "--rerun cannot stand after --: the table says what is docked",
        )
        .help(remedy)),
        Err(error)
            if error.kind() == ErrorKind::ArgumentConflict
                && !first_paragraph(&error).contains("LIGAND") =>
        {
            Err(Error::input(format!("after --: {}", first_paragraph(&error))).help(remedy))
        }
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::UnknownArgument
                    | ErrorKind::InvalidValue
                    | ErrorKind::ValueValidation
                    | ErrorKind::NoEquals
                    | ErrorKind::TooManyValues
                    | ErrorKind::TooFewValues
            ) =>
        {
            let suggested = suggestions::suggested(&error);
            let remedy =
                suggested.map_or_else(|| remedy.to_owned(), |text| format!("{text}; {remedy}"));
            Err(Error::input(format!("after --: {}", first_paragraph(&error))).help(remedy))
        }
        Ok(command) => command.dock.check_config(),
        // What is missing or in conflict here may be otherwise beside a row's own options.
        _ => Ok(()),
    }
}

/// The command line of a pair; an error comes with a remedy if one is known.
fn command(
    row: &PairRow,
    run: &Path,
    folder: &Path,
    options: &[String],
) -> Result<Dock, (String, Option<String>)> {
    let mut words = vec!["knotdock dock".to_owned()];
    for (column, value) in &row.options {
        if PLACE.contains(&column.as_str()) {
            return Err((format!("a column cannot be `{column}`"), None));
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
    words.extend(
        files
            .filter(|file| !file.is_empty())
            .map(|file| at(folder, file)),
    );
    let wrong = |error: clap::Error| (first_paragraph(&error), suggestions::suggested(&error));
    Ok(parse(words).map_err(wrong)?.dock)
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

/// A file of the table as seen from here, its chains behind it.
fn at(folder: &Path, file: &str) -> String {
    let path = plain_path(&folder.join(file));
    path.to_string_lossy().into_owned()
}

/// A file's part of a pair's name.
fn part(file: &str) -> Result<String, Error> {
    let spec = InputSpec::parse(file)?;
    Ok(label(&spec.path, spec.chains.as_deref()))
}

/// What the receptor is docked to, for the pair's name: the ligand, or into which ring.
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

/// Whether a pair may be called so.
fn is_name(name: &str) -> bool {
    name.starts_with(char::is_alphanumeric)
        && name
            .chars()
            .all(|c| c.is_alphanumeric() || "._-".contains(c))
}

/// Names of a batch's own files and folders.
const OF_BATCH: [&str; 6] = [RECORD, RESULTS, POSES, ATTEMPTS, REPORT, SHARDS];
