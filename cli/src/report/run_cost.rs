//! The cost of a run, its options, and how to repeat it.

use std::fmt::Write as _;

use serde_json::Value;

use crate::messages::shown::shell_word;
use crate::report::html::{escaped, table};
use crate::report::run::RunReport;
use knotdock::options::definition::Definition;
use knotdock::options::definitions;

/// The objects of a list in JSON.
fn items(list: &Value) -> impl Iterator<Item = &Value> {
    list.as_array().into_iter().flatten()
}

/// A number with `digits` decimals; empty if there is none.
fn decimals(value: &Value, digits: usize) -> String {
    let value = value.as_f64();
    value.map_or_else(String::new, |value| format!("{value:.digits$}"))
}

/// Effects, errors and times.
pub(super) fn cost(report: &RunReport) -> String {
    let record = report.record;
    let errors = [
        (
            "fast path against the exact sum, rms over the best poses",
            "rms",
        ),
        ("the same, largest", "worst"),
        ("score removed by the low-pass filter", "low_pass_share"),
        ("compression of the radius axis", "lifted_axis"),
    ];
    let errors = errors.map(|(what, name)| {
        let share = record["error"][name].as_f64();
        let share = share.map(|share| format!("{:.2}%", 100.0 * share));
        vec![what.to_owned(), share.unwrap_or("not measured".to_owned())]
    });
    let times = &record["timing"];
    let effects = items(&record["effects"]).map(|effect| {
        let time = items(&times["effects"]).find(|time| time["effect"] == effect["effect"]);
        let time = time.map(|time| decimals(&time["milliseconds_per_rotation"], 2));
        vec![
            words(&effect["effect"]),
            if effect["on"] == true { "on" } else { "off" }.to_owned(),
            words(&effect["reason"]),
            decimals(&effect["functions"], 1),
            time.unwrap_or_default(),
        ]
    });
    let terms = items(&record["pose_terms"]).map(|term| {
        let name = words(&term["id"]).replace('_', " ");
        vec![name, words(&term["weight"]), words(&term["unit"])]
    });
    let mut terms = terms.peekable();
    let stages = items(&times["stages"]).map(|stage| {
        let [wall, cpu] = ["wall_seconds", "cpu_seconds"].map(|name| decimals(&stage[name], 2));
        vec![words(&stage["name"]), wall, cpu]
    });
    let mut html = table("Measured errors", "error|share of the best score", errors);
    let header = "effect|on|why|functions|ms a rotation";
    html += &table("Effects of the search", header, effects);
    if terms.peek().is_some() {
        let header = "term of the pose score|weight|unit";
        html += &table("Other score terms", header, terms);
    }
    html += &table("Times", "stage|seconds|CPU seconds", stages);
    let plan = &record["plan"];
    let grid: Vec<String> = items(&plan["grid"]).map(words).collect();
    let _ = writeln!(
        html,
        "<p>Orientations are at most {:.1} degrees from one that was searched. The grid is {} at {} {}. The run used {} \
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
    let command = items(&report.record["machine"]["command"]).filter_map(Value::as_str);
    let command: Vec<_> = command.map(shell_word).collect();
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
    let line = |option: &Definition| {
        let value = &record[option.subject()][option.name()];
        vec![option.long().to_owned(), words(value)]
    };
    let mut given = report.options.given().map(line).peekable();
    html += &match given.peek() {
        None => "<p>All options have their defaults.</p>\n".to_owned(),
        Some(_) => table(
            "Options that differ from their defaults",
            "option|value",
            given,
        ),
    };
    let recorded = definitions().iter();
    let recorded = recorded.filter(|option| option.subject() != "machine");
    let all = table(
        "Every option with its value",
        "option|value",
        recorded.map(line),
    );
    let _ = write!(
        html,
        "<details><summary>All options</summary>\n{all}</details>\n"
    );
    html
}
