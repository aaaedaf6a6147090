//! The sections of a run's report that are words.

use std::fmt::Write as _;

use serde_json::Value;

use crate::options::{DockOptions, definitions, text};
use crate::output::tables::report::counted;
use crate::report::MAX_ROWS;
use crate::report::html::{escaped, table};
use crate::report::run::RunReport;
use crate::report::run_data::active;

/// Name of a file without its folder.
fn file_name(path: &Value) -> &str {
    let path = path.as_str().unwrap_or_default();
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

pub(super) fn title(report: &RunReport) -> String {
    let inputs = &report.record["inputs"];
    let [receptor, ligand] = ["receptor", "ligand"].map(|side| file_name(&inputs[side]["path"]));
    match report.options.search.symmetry {
        Some(symmetry) => format!("{receptor} as a ring of {symmetry}"),
        None => format!("{ligand} docked to {receptor}"),
    }
}

/// What was docked and what came of it.
pub(super) fn summary(report: &RunReport) -> String {
    let mut sentences = Vec::new();
    let record = report.record;
    let side = |side: &str| {
        let entry = &record["inputs"][side];
        let chains = entry["report"]["chains"]
            .as_array()
            .map_or(&[][..], Vec::as_slice);
        let names: Vec<&str> = chains
            .iter()
            .filter_map(|chain| chain["name"].as_str())
            .collect();
        let atoms = entry["atoms"].as_u64();
        match (atoms, names.len()) {
            (Some(atoms), 1) => format!(
                "{} (chain {}, {atoms} atoms)",
                file_name(&entry["path"]),
                names[0]
            ),
            (Some(atoms), _) => format!(
                "{} (chains {}, {atoms} atoms)",
                file_name(&entry["path"]),
                names.join(", ")
            ),
            (None, _) => file_name(&entry["path"]).to_owned(),
        }
    };
    sentences.push(match report.options.search.symmetry {
        Some(symmetry) => format!(
            "Copies of {} were put together as {symmetry}.",
            side("receptor")
        ),
        None => format!(
            "The ligand is {}, the receptor {}.",
            side("ligand"),
            side("receptor")
        ),
    });
    let results = &record["results"];
    let [rotations, poses, clusters, rows] = ["rotations", "poses", "clusters", "rows"]
        .map(|name| results[name].as_u64().unwrap_or(0) as usize);
    sentences.push(format!(
        "The search tried {}, and kept {}, which form {}.",
        counted(rotations, "orientation"),
        counted(poses, "pose"),
        counted(clusters, "cluster"),
    ));
    let shown = report.table.rows().len().min(MAX_ROWS);
    if shown < rows {
        sentences.push(format!(
            "This report shows the first {shown} of {rows} rows; poses.csv has all."
        ));
    }
    if record["sharp"]["finding"] == "exact-fit" {
        sentences.push(
            "One fit at atomic resolution stands out, and the poses are ranked by it.".to_owned(),
        );
    }
    for (index, side) in ["receptor", "ligand"].into_iter().enumerate() {
        let residues: Vec<String> = active(report, index)
            .into_iter()
            .map(String::from)
            .collect();
        if !residues.is_empty() {
            sentences.push(format!(
                "Poses that touch residues {} of the {side} rank higher.",
                residues.join(", ")
            ));
        }
    }
    sentences.push(found(report, shown));
    let words: String = sentences
        .iter()
        .map(|sentence| escaped(sentence) + " ")
        .collect();
    let mut html = format!("<p>{}</p>\n", words.trim_end());
    html += &warnings(record);
    html
}

/// What a known complex says of the rows.
fn found(report: &RunReport, shown: usize) -> String {
    let is_good = |row: &usize| {
        let class = report.table.field(*row, "capri");
        class.is_some_and(|class| class != "incorrect")
    };
    let good: Vec<usize> = (0..shown).filter(is_good).collect();
    let has_native = shown > 0 && report.table.field(0, "capri").is_some();
    match (has_native, good.first()) {
        (false, _) => "No known complex was given, so that nothing here says which pose is right: look at the best \
                       clusters, not at the first alone."
            .to_owned(),
        (true, None) => "By the known complex no row is acceptable.".to_owned(),
        (true, Some(&first)) => format!(
            "By the known complex the first acceptable row has rank {}, and {} of the first ten rows {} acceptable.",
            report.table.rows()[first].rank,
            good.iter().filter(|&&row| row < 10).count(),
            match good.iter().filter(|&&row| row < 10).count() {
                1 => "is",
                _ => "are",
            }
        ),
    }
}

/// Warnings of the readers.
fn warnings(record: &Value) -> String {
    let mut items = String::new();
    for side in ["receptor", "ligand"] {
        let warnings = record["inputs"][side]["report"]["warnings"].as_array();
        for warning in warnings.into_iter().flatten().filter_map(Value::as_str) {
            let _ = writeln!(items, "<li>{}: {}</li>", capital(side), escaped(warning));
        }
    }
    match items.is_empty() {
        true => items,
        false => format!("<ul class=\"warnings\">\n{items}</ul>\n"),
    }
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    let first = letters.next().map(|letter| letter.to_ascii_uppercase());
    first.into_iter().chain(letters).collect()
}

/// Effects, errors and times.
pub(super) fn cost(report: &RunReport) -> String {
    let record = report.record;
    let mut html = String::new();
    let error = &record["error"];
    let share = |value: &Value| {
        value.as_f64().map_or_else(
            || "not measured".to_owned(),
            |value| format!("{:.2}%", 100.0 * value),
        )
    };
    let lines = [
        ["error", "share of the best score"]
            .map(str::to_owned)
            .to_vec(),
        vec![
            "fast path against the exact sum, rms over the best poses".to_owned(),
            share(&error["rms"]),
        ],
        vec!["the same, largest".to_owned(), share(&error["worst"])],
        vec![
            "what the low-pass took".to_owned(),
            share(&error["low_pass_share"]),
        ],
        vec![
            "compression of the lifted axis".to_owned(),
            share(&error["lifted_axis"]),
        ],
    ];
    html += &table("Measured errors", &lines);
    let times = record["timing"]["effects"].as_array();
    let time_of = |effect: &Value| {
        let mut times = times.into_iter().flatten();
        let found = times.find(|time| time["effect"] == *effect)?;
        found["milliseconds_per_rotation"].as_f64()
    };
    let mut lines = vec![
        ["effect", "on", "why", "functions", "CPU ms a rotation"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for effect in record["effects"].as_array().into_iter().flatten() {
        let time = time_of(&effect["effect"]);
        lines.push(vec![
            words(&effect["effect"]),
            match effect["on"] == true {
                true => "on".to_owned(),
                false => "off".to_owned(),
            },
            words(&effect["reason"]),
            words(&effect["rank"]),
            time.map_or_else(String::new, |time| format!("{time:.2}")),
        ]);
    }
    html += &table("Effects of the search", &lines);
    let mut lines = vec![
        ["term of the pose score", "weight", "unit"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for term in record["pose_terms"].as_array().into_iter().flatten() {
        lines.push(vec![
            words(&term["id"]).replace('_', " "),
            words(&term["weight"]),
            words(&term["unit"]),
        ]);
    }
    if lines.len() > 1 {
        html += &table("Terms beside them", &lines);
    }
    let mut lines = vec![
        ["stage", "seconds", "CPU seconds"]
            .map(str::to_owned)
            .to_vec(),
    ];
    let seconds = |value: &Value| {
        value
            .as_f64()
            .map_or_else(String::new, |value| format!("{value:.2}"))
    };
    for stage in record["timing"]["stages"].as_array().into_iter().flatten() {
        lines.push(vec![
            words(&stage["name"]),
            seconds(&stage["wall_seconds"]),
            seconds(&stage["cpu_seconds"]),
        ]);
    }
    html += &table("Times", &lines);
    let plan = &record["plan"];
    let grid: Vec<String> = plan["grid"]
        .as_array()
        .into_iter()
        .flatten()
        .map(words)
        .collect();
    let _ = writeln!(
        html,
        "<p>Orientations lie at most {:.1} degrees from one that was searched. The grid is {} at {} {}. The run used {} \
         of {} hardware threads{}.</p>",
        plan["covering_radius_degrees"].as_f64().unwrap_or(f64::NAN),
        grid.join(" × "),
        words(&plan["spacing"]),
        match plan["unit"] == "angstrom" {
            true => "Å",
            false => "units of the files",
        },
        words(&record["machine"]["threads"]),
        words(&record["machine"]["hardware_threads"]),
        record["timing"]["peak_memory_bytes"]
            .as_f64()
            .map_or_else(String::new, |bytes| format!(
                " and at most {:.0} MB of memory",
                bytes / 1e6
            )),
    );
    html
}

/// A value of JSON in words.
fn words(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => "none".to_owned(),
        other => other.to_string(),
    }
}

/// The options, and how to repeat the run.
pub(super) fn options(report: &RunReport) -> String {
    let directory = report.directory;
    let command: Vec<&str> = report.record["machine"]["command"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect();
    let lines = [
        ("The command was", command.join(" ")),
        (
            "The same run again, with its inputs checked",
            format!("knotdock dock --rerun {directory}/run.json -o again"),
        ),
        (
            "Further complexes",
            format!("knotdock export {directory} --rank 11-20"),
        ),
        (
            "Contacts and score of one",
            format!("knotdock interface {directory}/top/rank_0001.pdb"),
        ),
        (
            "Distance of all poses from one that you think is right",
            format!("knotdock evaluate {directory} --native {directory}/top/rank_0001.pdb"),
        ),
    ];
    let is_of_solids = report.record["plan"]["unit"] != "angstrom";
    let mut html = "<dl>\n".to_owned();
    for (what, command) in &lines[..if is_of_solids { 3 } else { lines.len() }] {
        let _ = writeln!(
            html,
            "<dt>{what}</dt><dd><code>{}</code></dd>",
            escaped(command)
        );
    }
    html += "</dl>\n";
    let record = &report.record["options"];
    let line = |option: &crate::options::definition::Definition| {
        let value = &record[option.subject()][option.name()];
        vec![option.long().to_owned(), words(value)]
    };
    let head = ["option", "value"].map(str::to_owned).to_vec();
    let given: Vec<Vec<String>> =
        text::given(report.options, &DockOptions::default(), definitions())
            .map(line)
            .collect();
    html += &match given.is_empty() {
        true => "<p>All options have their defaults.</p>\n".to_owned(),
        false => table(
            "Options that differ from their defaults",
            &[vec![head.clone()], given].concat(),
        ),
    };
    let recorded = definitions()
        .iter()
        .filter(|option| option.subject() != "machine");
    let all: Vec<Vec<String>> = std::iter::once(head).chain(recorded.map(line)).collect();
    let _ = write!(
        html,
        "<details><summary>All options</summary>\n{}</details>\n",
        table("All options", &all)
    );
    html
}
