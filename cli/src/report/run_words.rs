//! The summary of a run's report, in words.

use std::fmt::Write as _;

use serde::Deserialize;
use serde_json::Value;

use crate::messages::dock::redocking_text;
use crate::messages::shown::shell_word;
use crate::report::html::{escaped, paragraph};
use crate::report::run::{RunReport, active};
use crate::tables::report::counted;
use knotdock::interface::ResidueName;
use knotdock::pose_space::arrangement::Arrangement;
use knotdock::redock::Redocking;
use knotdock::table_text::named_columns::listed;

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

/// The inputs and the results, if `shown` rows are shown.
pub(super) fn summary(report: &RunReport, shown: usize) -> String {
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
        let file = file_name(&entry["path"]);
        let chains = if names.len() == 1 { "chain" } else { "chains" };
        match entry["atoms"].as_u64() {
            Some(atoms) => format!("{file} ({chains} {}, {atoms} atoms)", names.join(", ")),
            None => file.to_owned(),
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
    if shown < rows {
        sentences.push(format!(
            "This report shows the first {shown} of {rows} rows; poses.csv has all."
        ));
    }
    if record["sharp"]["finding"] == "exact-fit" {
        let rewarded = (0..shown).filter(|&row| {
            let sharp = report.table.field(row, "sharp");
            sharp.is_some_and(|sharp| sharp.parse().is_ok_and(|sharp: f64| sharp > 0.0))
        });
        let ranks: Vec<String> = rewarded
            .map(|row| report.table.rows()[row].rank.to_string())
            .collect();
        if !ranks.is_empty() {
            sentences.push(format!(
                "A fit at atomic resolution stands out and earns score for {} {}.",
                if ranks.len() == 1 { "rank" } else { "ranks" },
                listed(ranks.iter().map(String::as_str))
            ));
        }
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
    let answer = touched(report).into_iter().chain([found(report, shown)]);
    let answer: Vec<String> = answer.collect();
    if let Some(Err(reason)) = report.known {
        sentences.push(format!("The known complex is not shown: {reason}."));
    }
    paragraph(&answer) + &next(report) + &paragraph(&sentences) + &warnings(record)
}

/// Residues of a side that are named as those that the best clusters touch.
const NAMED: usize = 5;

/// The residues that most of the best clusters touch.
fn touched(report: &RunReport) -> Option<String> {
    let contacts = report.contacts?;
    let sides = contacts.shares().map(|mut shares| {
        shares.sort_by_key(|share| std::cmp::Reverse(share.clusters));
        let named = shares.iter().filter(|share| share.clusters > 0).take(NAMED);
        let words = named.map(|share| {
            let ResidueName {
                chain,
                number,
                name,
            } = &share.residue;
            let chain = if chain.is_empty() { "_" } else { chain };
            format!("{chain}:{number} {name} ({:.0}%)", 100.0 * share.share)
        });
        words.collect::<Vec<_>>().join(", ")
    });
    let [receptor, ligand] = sides;
    (!receptor.is_empty()).then(|| {
        let [first, second] = match Arrangement::from(report.options.search.symmetry).is_ring() {
            true => ["one copy", "the next one"],
            false => ["the receptor", "the ligand"],
        };
        let count = contacts.firsts.len();
        format!(
            "Of the best {}, most touch {receptor} of {first}, and {ligand} of {second}.",
            counted(count, "cluster")
        )
    })
}

/// What to do next, with the commands.
fn next(report: &RunReport) -> String {
    if report.contacts.is_none() || Arrangement::from(report.options.search.symmetry).is_ring() {
        return String::new();
    }
    let path = |side: &str| {
        let input = &report.record["inputs"][side];
        let path = input["path"].as_str().unwrap_or_default();
        let chains = input["chains"].as_str().map(|chains| format!(":{chains}"));
        shell_word(&format!("{path}{}", chains.unwrap_or_default())).into_owned()
    };
    let directory = shell_word(report.directory).into_owned();
    let lines = [
        (
            "If you know residues of the interface, dock with them: nothing helps as much",
            format!(
                "knotdock dock {} {} --active-receptor CHAIN:NUMBERS --active-ligand CHAIN:NUMBERS -o guided",
                path("receptor"),
                path("ligand")
            ),
        ),
        (
            "Refine further rows, as those in top/ are",
            format!("knotdock refine {directory} --ranks 1-50"),
        ),
    ];
    let mut html = "<dl id=\"next\">\n".to_owned();
    for (what, command) in lines {
        let _ = writeln!(
            html,
            "<dt>{what}</dt><dd><code>{}</code></dd>",
            escaped(&command)
        );
    }
    html + "</dl>\n"
}

/// What the answer of a predicted complex that is docked again means.
const REDOCKING_LIMITS: &str = "A model's side chains are placed for each other, so agreement says less than \
                                disagreement does.";

/// The rows in the light of a known complex.
fn found(report: &RunReport, shown: usize) -> String {
    if let Ok(redocking) = Redocking::deserialize(&report.record["redocking"]) {
        return format!(
            "{}. {REDOCKING_LIMITS}",
            redocking_text(&redocking).replace('\n', ". ")
        );
    }
    let is_good = |row: &usize| {
        let class = report.table.field(*row, "capri");
        class.is_some_and(|class| class != "incorrect")
    };
    let good: Vec<usize> = (0..shown).filter(is_good).collect();
    let has_native = shown > 0 && report.table.field(0, "capri").is_some();
    match (has_native, good.first()) {
        (false, _) => "No known complex measures the poses, so nothing here says which one is right. Of unbound pairs \
                       about a third have a right one among the first ten clusters: look at all of them, and at what is known of \
                       the interface."
            .to_owned(),
        (true, None) => "By the known complex no row is acceptable or better.".to_owned(),
        (true, Some(&first)) => {
            let rank = report.table.rows()[first].rank;
            let among_ten = good.iter().filter(|&&row| row < 10).count();
            let are = if among_ten == 1 { "is" } else { "are" };
            format!(
                "By the known complex the first acceptable row has rank {rank}, and {among_ten} of the first ten rows \
                 {are} acceptable or better."
            )
        }
    }
}

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
