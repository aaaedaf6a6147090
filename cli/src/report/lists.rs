//! Reports of batches, ensembles and sweeps, from the files of their directories: a table of results, each perhaps with
//! its own page.

use std::fmt::Display;
use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use csv::StringRecord;
use serde_json::{Value, json};

use crate::records::{ENSEMBLE_RECORD, MEMBERS};
use crate::report::columns::of_table;
use crate::report::html::{Page, escaped, paragraph, section};
use crate::report::shown::rows;
use crate::tables::batch_results::RESULTS;
use crate::tables::report::counted;
use knotdock::bounded_read::{MAX_POSES, MAX_RECORD, read_bounded_file};
use knotdock::output::files::file_error;
use knotdock::output::files::seal::REPORT;
use knotdock::table_text::cells::unquoted_row;
use knotdock_structures::Error;

/// A file of a directory that cannot be read, with its fault.
fn unreadable(path: &Path, fault: impl Display) -> Error {
    file_error::refused(
        path,
        format!("cannot read {}: {fault}", path.display()),
        "name a directory that `knotdock dock`, `batch` or `tradeoff` wrote, with its files as they were",
    )
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectoryKind {
    Batch,
    Ensemble,
    Tradeoff,
}

impl DirectoryKind {
    /// The kind of a directory, if it is one of these.
    pub fn of(directory: &Path) -> Option<Self> {
        if directory.join("run.json").is_file() {
            return None;
        }
        let kinds = [
            (ENSEMBLE_RECORD, Self::Ensemble),
            ("tradeoff.json", Self::Tradeoff),
            (RESULTS, Self::Batch),
        ];
        let found = kinds
            .into_iter()
            .find(|(name, _)| directory.join(name).is_file());
        found.map(|(_, kind)| kind)
    }

    /// The page of a directory named `name`, from files in a folder, perhaps a staging folder.
    pub fn report(self, directory: &Path, files: &Path, name: &str) -> Result<String, Error> {
        let report = match self {
            Self::Batch => batch(directory, name)?,
            Self::Ensemble => ensemble(directory, files, name)?,
            Self::Tradeoff => tradeoff(files, name)?,
        };
        Ok(report.text())
    }
}

type Table = (StringRecord, Vec<StringRecord>);

/// A table, read without interpretation.
fn table(path: &Path) -> Result<Table, Error> {
    let bytes = read_bounded_file(path, MAX_POSES).map_err(|error| unreadable(path, error))?;
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let read = reader.headers().map(unquoted_row).and_then(|header| {
        let rows = reader
            .records()
            .map(|row| row.map(|row| unquoted_row(&row)));
        Ok((header, rows.collect::<Result<Vec<_>, _>>()?))
    });
    read.map_err(|error| unreadable(path, error))
}

fn record(path: &Path) -> Result<Value, Error> {
    let bytes = read_bounded_file(path, MAX_RECORD).map_err(|error| unreadable(path, error))?;
    serde_json::from_slice(&bytes).map_err(|error| unreadable(path, error))
}

/// The fields of a column, empty where there is none.
fn fields<'a>((header, records): &'a Table, name: &str) -> impl Iterator<Item = &'a str> + use<'a> {
    let place = header.iter().position(|column| column == name);
    let field = move |record: &'a StringRecord| place.and_then(|place| record.get(place));
    records
        .iter()
        .map(move |record| field(record).unwrap_or_default())
}

/// The page of a row below a directory, if it exists. Names that lead out of the directory have none.
fn link(directory: &Path, folder: &str, name: &str) -> Option<String> {
    let is_plain = !name.is_empty() && !name.starts_with('.') && !name.contains(['/', '\\', ':']);
    let is_there = || directory.join(folder).join(name).join(REPORT).is_file();
    let escape = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' => {
            char::from(byte).to_string()
        }
        byte => format!("%{byte:02X}"),
    };
    (is_plain && is_there()).then(|| {
        let name: String = name.bytes().map(escape).collect();
        match folder {
            "" => format!("{name}/{REPORT}"),
            folder => format!("{folder}/{name}/{REPORT}"),
        }
    })
}

fn batch(directory: &Path, name: &str) -> Result<ListReport, Error> {
    let table = table(&directory.join(RESULTS))?;
    let count = |status: &str| {
        fields(&table, "status")
            .filter(|field| *field == status)
            .count()
    };
    let [done, failed, pending] = ["done", "failed", "pending"].map(count);
    let mut sentences = vec![format!(
        "Of {}, {done} are done, {failed} failed and {pending} are pending.",
        counted(table.1.len(), "pair")
    )];
    let classes = fields(&table, "capri")
        .filter(|class| !class.is_empty())
        .count();
    if classes > 0 {
        let within = |most: usize| {
            let ranks = fields(&table, "first_acceptable_rank");
            ranks
                .filter(|rank| rank.parse().is_ok_and(|rank: usize| rank <= most))
                .count()
        };
        sentences.push(format!(
            "A known complex was given for {classes} of them. An acceptable row is first for {}, among the first 10 for {} \
             and among the first 100 for {}.",
            within(1),
            within(10),
            within(100)
        ));
    }
    let links = fields(&table, "name")
        .map(|name| link(directory, "", name))
        .collect();
    Ok(ListReport {
        title: format!("Batch {name}"),
        sentences,
        caption: "Pairs, each with the best row of its run. A name leads to the report of the pair.",
        header: table.0,
        records: table.1,
        main: "name status error clusters score z_score irmsd dockq capri first_acceptable_rank",
        links,
        picture: None,
    })
}

fn ensemble(directory: &Path, files: &Path, name: &str) -> Result<ListReport, Error> {
    let record = record(&files.join(ENSEMBLE_RECORD))?;
    let table = table(&files.join("poses.csv"))?;
    let size = |side: &str| record[side].as_array().map_or(0, Vec::len);
    let members = record["members"].as_array().map_or(0, Vec::len);
    let sentences = vec![
        format!(
            "{} of the receptor and {} of the ligand were docked in {}.",
            counted(size("receptor"), "conformation"),
            counted(size("ligand"), "conformation"),
            counted(members, "run")
        ),
        format!(
            "Their poses form {} in all. A rank leads to the report of the run that the pose is of, where `rank there` is \
             its rank.",
            counted(
                record["results"]["clusters"].as_u64().unwrap_or(0) as usize,
                "cluster"
            )
        ),
    ];
    let links = fields(&table, "member")
        .map(|member| link(directory, MEMBERS, member))
        .collect();
    Ok(ListReport {
        title: format!("Ensemble {name}"),
        sentences,
        caption: "Ranked poses of all members",
        header: table.0,
        records: table.1,
        main: "rank score cluster_size member member_rank receptor_model ligand_model z_score irmsd lrmsd dockq capri",
        links,
        picture: None,
    })
}

fn tradeoff(files: &Path, name: &str) -> Result<ListReport, Error> {
    let record = record(&files.join("tradeoff.json"))?;
    let table = table(&files.join("tradeoff.csv"))?;
    let path = files.join("tradeoff.svg");
    let picture = fs::read(&path).map_err(|error| unreadable(&path, error))?;
    let mut sentences = vec![format!(
        "{} were measured.",
        counted(table.1.len(), "setting")
    )];
    sentences.extend(record["advice"]["text"].as_str().map(str::to_owned));
    Ok(ListReport {
        title: format!("Accuracy against time, {name}"),
        sentences,
        caption: "Settings as they were measured",
        links: vec![None; table.1.len()],
        header: table.0,
        records: table.1,
        main: "setting options wall_seconds error_rms agreement first_acceptable acceptable_in_100 front_error \
               front_agreement",
        picture: Some((picture, "Error and agreement against time")),
    })
}

const MAX_LIST_ROWS: usize = 10_000;

struct ListReport {
    title: String,
    /// Sentences before the table.
    sentences: Vec<String>,
    /// Caption of the table.
    caption: &'static str,
    header: StringRecord,
    records: Vec<StringRecord>,
    /// Columns that are shown at first, with blanks between them.
    main: &'static str,
    /// The page of each row, from the directory of the report.
    links: Vec<Option<String>>,
    /// A picture as SVG, and its caption.
    picture: Option<(Vec<u8>, &'static str)>,
}

impl ListReport {
    /// The page, whole.
    fn text(mut self) -> String {
        let all = self.records.len();
        if all > MAX_LIST_ROWS {
            self.sentences.push(format!(
                "The table shows the first {MAX_LIST_ROWS} of {all} rows."
            ));
            self.records.truncate(MAX_LIST_ROWS);
        }
        let main: Vec<&str> = self.main.split_whitespace().collect();
        let columns = of_table(&self.header, &self.records, &main);
        let rows = rows(&columns, &self.records);
        let data = json!({
            "kind": "list",
            "caption": self.caption,
            "columns": columns,
            "rows": rows,
            "links": self.links,
        });
        let words = paragraph(&self.sentences);
        let mut sections = vec![section("summary", "Summary", &words)];
        if let Some((svg, what)) = &self.picture {
            // As an image, so that no script in the file runs.
            let image = format!(
                "<img class=\"picture\" alt=\"{}\" src=\"data:image/svg+xml;base64,{}\">\n",
                escaped(what),
                STANDARD.encode(svg)
            );
            sections.push(section("picture", what, &image));
        }
        sections.push(section(
            "results",
            "Results",
            include_str!("page/list.html"),
        ));
        Page {
            title: self.title,
            sections,
            data: &data,
            viewer: None,
        }
        .text()
    }
}
