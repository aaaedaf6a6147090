//! What a run cost, its options, and how to repeat it.

use std::fmt::Write as _;

use serde_json::Value;

use crate::report::html::{escaped, table};
use crate::report::run_parts::RunReport;
use crate::shell_word::shell_word;
use knotdock::options::definitions;

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
            "score removed by the low-pass filter".to_owned(),
            share(&error["low_pass_share"]),
        ],
        vec![
            "compression of the radius axis".to_owned(),
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
        ["effect", "on", "why", "functions", "ms a rotation"]
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
            effect["functions"]
                .as_f64()
                .map_or_else(String::new, |functions| format!("{functions:.1}")),
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
        html += &table("Other score terms", &lines);
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
    let quoted = |end: &str| shell_word(&format!("{}{end}", report.directory)).into_owned();
    let [directory, record, first] = ["", "/run.json", "/top/rank_0001.pdb"].map(quoted);
    let command: Vec<_> = report.record["machine"]["command"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .map(shell_word)
        .collect();
    let lines = [
        ("The command was", command.join(" ")),
        (
            "The same run again, with its inputs checked",
            format!("knotdock dock --rerun {record} -o again"),
        ),
        (
            "Further complexes",
            format!("knotdock export {directory} --rank 11-20"),
        ),
        (
            "Contacts and score of one",
            format!("knotdock interface {first}"),
        ),
        (
            "Distance of all poses from one that you think is right",
            format!("knotdock evaluate {directory} --native {first}"),
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
    let line = |option: &knotdock::options::definition::Definition| {
        let value = &record[option.subject()][option.name()];
        vec![option.long().to_owned(), words(value)]
    };
    let head = ["option", "value"].map(str::to_owned).to_vec();
    let given: Vec<Vec<String>> = report.options.given().map(line).collect();
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
        table("Every option with its value", &all)
    );
    html
}
