//! What the columns of `poses.csv` are called in a report.

use csv::StringRecord;
use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::POSE_TERMS;
use serde::Serialize;

/// A column as a report shows it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct ShownColumn {
    /// Its name in the file.
    pub name: String,
    /// Its name for people.
    pub label: String,
    /// What it is, with its unit.
    pub help: &'static str,
    /// Decimals that are shown; `None` of text.
    pub digits: Option<usize>,
    /// Whether it is shown at first.
    pub main: bool,
}

/// Name, label, help, decimals and whether it is shown at first.
type Known = (
    &'static str,
    &'static str,
    &'static str,
    Option<usize>,
    bool,
);

const KNOWN: [Known; 20] = [
    ("rank", "rank", "Rank: 1 is the best", Some(0), true),
    (
        "score",
        "score",
        "What orders the rows: of a cluster, its poses together",
        Some(1),
        true,
    ),
    (
        "cluster",
        "cluster",
        "Number of the cluster",
        Some(0),
        false,
    ),
    (
        "cluster_size",
        "poses",
        "Poses in the cluster",
        Some(0),
        true,
    ),
    (
        "pose_score",
        "pose score",
        "Score of the pose itself",
        Some(1),
        false,
    ),
    (
        "search_score",
        "search score",
        "Exact correlation at the pose",
        Some(1),
        false,
    ),
    (
        "z_score",
        "z-score",
        "Standard deviations above the mean of the run",
        Some(1),
        true,
    ),
    (
        "irmsd",
        "i-RMSD",
        "Interface RMSD from the known complex, Å",
        Some(2),
        true,
    ),
    (
        "lrmsd",
        "L-RMSD",
        "Ligand RMSD from the known complex, Å",
        Some(2),
        true,
    ),
    (
        "fnat",
        "fnat",
        "Share of the known contacts",
        Some(2),
        false,
    ),
    (
        "dockq",
        "DockQ",
        "DockQ: 1 is the known complex",
        Some(2),
        true,
    ),
    (
        "capri",
        "CAPRI class",
        "Class by the rules of CAPRI",
        None,
        true,
    ),
    (
        "restraints_met",
        "restraints met",
        "Restraints that the pose satisfies",
        None,
        true,
    ),
    (
        "sharp_energy",
        "sharp energy",
        "Energy of the optimum at atomic resolution, RT",
        Some(1),
        false,
    ),
    (
        "sharp_clashes",
        "sharp clashes",
        "Pairs of atoms of the optimum at atomic resolution that overlap by more than 0.5 Å",
        Some(0),
        false,
    ),
    ("member", "member", "Member of the ensemble", None, true),
    (
        "member_rank",
        "rank there",
        "Rank in the member's run",
        Some(0),
        false,
    ),
    (
        "receptor_model",
        "receptor model",
        "Conformation of the receptor",
        None,
        true,
    ),
    (
        "ligand_model",
        "ligand model",
        "Conformation of the ligand",
        None,
        true,
    ),
    (
        "other_copies",
        "other copies",
        "Contacts with further copies of a ring",
        Some(1),
        false,
    ),
];

/// The column of a name.
pub(super) fn shown(name: &str) -> ShownColumn {
    let known = KNOWN.iter().find(|known| known.0 == name);
    match known {
        Some(&(name, label, help, digits, main)) => ShownColumn {
            name: name.to_owned(),
            label: label.to_owned(),
            help,
            digits,
            main,
        },
        None => ShownColumn {
            name: name.to_owned(),
            label: term_label(name),
            help: match is_term(name) {
                true => "Part of the score",
                false => "",
            },
            digits: Some(if is_placement(name) { 4 } else { 1 }),
            main: false,
        },
    }
}

/// The columns of a table of any kind: those of `main` are shown at first. What a column holds is seen from its fields.
pub(super) fn of_table(
    header: &StringRecord,
    records: &[StringRecord],
    main: &[&str],
) -> Vec<ShownColumn> {
    let column = |(place, name): (usize, &str)| {
        let fields = records.iter().filter_map(|record| record.get(place));
        let known = KNOWN.iter().any(|known| known.0 == name);
        let mut column = shown(name);
        if !known {
            column.digits = digits_of(fields);
        }
        column.main = main.contains(&name);
        column
    };
    header.iter().enumerate().map(column).collect()
}

/// Decimals that show three digits of the middle one of the numbers that are not zero; `None` if some are no numbers.
fn digits_of<'a>(fields: impl Iterator<Item = &'a str>) -> Option<usize> {
    let mut sizes = Vec::new();
    let (mut any, mut are_whole) = (false, true);
    for field in fields.filter(|field| !field.is_empty()) {
        let value: f64 = field.parse().ok().filter(|value: &f64| value.is_finite())?;
        any = true;
        are_whole &= value.fract() == 0.0;
        sizes.extend((value != 0.0).then_some(value.abs()));
    }
    if !any {
        return None;
    }
    sizes.sort_by(f64::total_cmp);
    let middle = sizes
        .get(sizes.len() / 2)
        .map_or(1.0, |size| size.max(1e-6));
    match are_whole {
        true => Some(0),
        false => Some((2 - middle.log10().floor() as i32).clamp(0, 8) as usize),
    }
}

/// Whether a column places the ligand.
fn is_placement(name: &str) -> bool {
    ["qw", "qx", "qy", "qz", "tx", "ty", "tz"].contains(&name)
}

/// Whether a column is a summand of the pose score.
pub(super) fn is_term(name: &str) -> bool {
    Effect::ALL.iter().any(|effect| effect.name() == name)
        || POSE_TERMS.iter().any(|term| term.id == name)
        || ["other_copies", "sharp"].contains(&name)
}

/// The name of a column in words.
fn term_label(name: &str) -> String {
    name.replace('_', " ")
}
