//! Names and formats of the columns of `poses.csv` in a report.

use csv::StringRecord;
use serde::Serialize;

use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::POSE_TERMS;

#[derive(Clone, Debug, Serialize)]
pub(super) struct ShownColumn {
    /// Its name, as in the file.
    pub name: String,
    /// Its description, with the unit.
    pub help: &'static str,
    /// Decimals that are shown; `None` of text.
    pub digits: Option<usize>,
    /// Whether it is shown at first.
    pub main: bool,
}

/// Columns, one per line: name, help, decimals (`-` for text), and whether it is shown at first.
const DESCRIBED: &str = "\
rank|Rank: 1 is the best|0|main
score|What orders the rows: of a cluster, its poses together|1|main
cluster|Number of the cluster|0|
cluster_size|Poses in the cluster|0|main
pose_score|Score of the pose itself|1|
search_score|Exact correlation at the pose|1|
z_score|Standard deviations above the mean of the run|1|main
irmsd|Interface RMSD from the known complex, Å|2|main
lrmsd|Ligand RMSD from the known complex, Å|2|main
fnat|Share of the known contacts|2|
dockq|DockQ: 1 is the known complex|2|main
capri|Class by the rules of CAPRI|-|main
complex_clashes|Pairs of atoms of the complex in top/ that overlap by more than 0.5 Å|0|main
complex_irmsd|Interface RMSD of the complex in top/ from the known one, Å|2|
restraints_met|Restraints that the pose satisfies|-|main
sharp_energy|Energy of the optimum at atomic resolution, RT|1|
sharp_clashes|Pairs of atoms of the optimum at atomic resolution that overlap by more than 0.5 Å|0|
member|Member of the ensemble|-|main
member_rank|Rank in the member's run|0|
receptor_model|Conformation of the receptor|-|main
ligand_model|Conformation of the ligand|-|main
trust|Trust in the pair: likely, uncertain or doubtful|-|main
evidence|Verdicts of confidence, agreement and coordinates|-|
chain_1|First chain|-|main
chain_2|Second chain|-|main
iptm|ipTM of the pair, as the program reports it|2|main
ipsae|ipSAE, the larger one of both directions|3|main
pdockq2|pDockQ2, the larger one of both directions|3|main
interface_pae|Mean PAE of residues in contact, Å|1|
interface_plddt|Mean pLDDT of residues in contact|0|
buried_area|Accessible surface that the chains take from each other, Å²|0|main
shape_complementarity|Sc: about 0.7 in most interfaces|2|main
agreement|Share of contacts in common with the other models|2|main
other_copies|Contacts with further copies of a ring|1|";

fn described(name: &str) -> Option<ShownColumn> {
    DESCRIBED.lines().find_map(|line| {
        let mut parts = line.split('|');
        let is_it = parts.next() == Some(name);
        let [help, digits, main] = std::array::from_fn(|_| parts.next().unwrap_or_default());
        is_it.then(|| ShownColumn {
            name: name.to_owned(),
            help,
            digits: digits.parse().ok(),
            main: main == "main",
        })
    })
}

pub(super) fn shown(name: &str) -> ShownColumn {
    described(name).unwrap_or_else(|| ShownColumn {
        name: name.to_owned(),
        help: if is_term(name) {
            "Part of the score"
        } else {
            ""
        },
        digits: Some(if is_placement(name) { 4 } else { 1 }),
        main: false,
    })
}

/// Columns of any table, formatted by their fields; those of `main` are shown at first.
pub(super) fn of_table(
    header: &StringRecord,
    records: &[StringRecord],
    main: &[&str],
) -> Vec<ShownColumn> {
    let column = |(place, name): (usize, &str)| {
        let fields = records.iter().filter_map(|record| record.get(place));
        let mut column = described(name).unwrap_or_else(|| ShownColumn {
            digits: digits_of(fields),
            ..shown(name)
        });
        column.main = main.contains(&name);
        column
    };
    header.iter().enumerate().map(column).collect()
}

/// Decimals that show three digits of the middle one of the numbers that are not zero; `None` if some are no numbers.
fn digits_of<'a>(fields: impl Iterator<Item = &'a str>) -> Option<usize> {
    let mut sizes = Vec::new();
    for field in fields.filter(|field| !field.is_empty()) {
        let value: f64 = field.parse().ok().filter(|value: &f64| value.is_finite())?;
        sizes.push(value.abs());
    }
    if sizes.is_empty() {
        return None;
    }
    if sizes.iter().all(|size| size.fract() == 0.0) {
        return Some(0);
    }
    sizes.retain(|size| *size > 0.0);
    sizes.sort_by(f64::total_cmp);
    let middle = sizes[sizes.len() / 2].max(1e-6);
    Some((2 - middle.log10().floor() as i32).clamp(0, 8) as usize)
}

fn is_placement(name: &str) -> bool {
    ["qw", "qx", "qy", "qz", "tx", "ty", "tz"].contains(&name)
}

/// Whether a column is a summand of the pose score.
pub(super) fn is_term(name: &str) -> bool {
    Effect::ALL.iter().any(|effect| effect.name() == name)
        || POSE_TERMS.iter().any(|term| term.id == name)
        || ["other_copies", "sharp"].contains(&name)
}
