//! The tables of the terminal.

use crate::tables::field;
use knotdock::output::tables::fields::Column;
use knotdock::output::tables::poses::PoseTable;
use knotdock::output::tables::quality::OF_COMPLEXES;
use knotdock::rank::ranking::RankedPose;

/// Rows of the table of best clusters.
pub const BEST: usize = 10;

/// The best clusters as a table: rank, score, size of the cluster, pose score and z-score of its best pose, and
/// whatever columns are appended to the poses.
///
/// `ranking` is best first; of each cluster its first pose is shown, under the rank it has in `ranking`.
pub fn best_clusters(ranking: &[RankedPose], appended: &[Column]) -> String {
    // Those of complexes would make lines longer than most terminals show.
    let shown = appended
        .iter()
        .filter(|column| !OF_COMPLEXES.contains(&column.name.as_str()));
    let appended: Vec<&Column> = shown.collect();
    let names = appended.iter().map(|column| format!("|{}", column.name));
    let header =
        "rank|score|cluster_size|pose_score|z_score".to_owned() + &names.collect::<String>();
    let tenths = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.1}"));
    let lines = firsts(ranking).into_iter().take(BEST).map(|index| {
        let row = &ranking[index];
        let size = row.cluster_size.map(|size| size.to_string());
        let mut line = vec![
            (index + 1).to_string(),
            tenths(Some(row.score)),
            size.unwrap_or_default(),
            tenths(row.pose_score),
            tenths(row.z_score),
        ];
        line.extend(appended.iter().map(|column| {
            let field = column.fields.get(index).map_or("", String::as_str);
            // A column of counts has none but whole numbers.
            let is_count = column
                .fields
                .iter()
                .all(|field| field.parse::<u64>().is_ok());
            match field.parse::<f64>() {
                Ok(value) if !is_count => format!("{value:.2}"),
                _ => field.to_owned(),
            }
        }));
        line
    });
    text_table(&header, lines)
}

/// Columns of a table of an ensemble's poses that the terminal shows, if the table has them.
const OF_ENSEMBLES: &str = "rank score cluster_size receptor_model ligand_model pose_score z_score restraints_met \
                            irmsd lrmsd fnat dockq capri";

/// The first of these rows of a table that joins runs, with its main columns.
pub fn best_rows(table: &PoseTable, rows: Vec<usize>) -> String {
    let has = |name: &&str| table.header.iter().any(|column| column == *name);
    let columns: Vec<&str> = OF_ENSEMBLES.split_whitespace().filter(has).collect();
    let rows = table.objects(rows.into_iter().take(BEST));
    let lines = rows.iter().map(|row| {
        let field = |name: &&str| match (row[*name].as_f64(), *name) {
            (Some(value), "score" | "pose_score" | "z_score") => format!("{value:.1}"),
            (Some(value), "irmsd" | "lrmsd" | "fnat" | "dockq") => format!("{value:.2}"),
            (_, name) => field(&row[name]),
        };
        columns.iter().map(field).collect()
    });
    text_table(&columns.join("|"), lines)
}

/// Places of the poses that stand for their clusters: the first of each, and each pose that belongs to none.
pub fn firsts(ranking: &[RankedPose]) -> Vec<usize> {
    let mut seen = std::collections::HashSet::new();
    let mut firsts: Vec<usize> = (0..ranking.len())
        .filter(|&index| {
            ranking[index]
                .cluster
                .is_none_or(|cluster| seen.insert(cluster))
        })
        .collect();
    firsts.sort_by_key(|&index| ranking[index].cluster.unwrap_or(usize::MAX));
    firsts
}

/// A number of things, in the singular for one.
pub fn counted(number: usize, thing: &str) -> String {
    match number {
        1 => format!("1 {thing}"),
        _ => format!("{number} {thing}s"),
    }
}

/// A table as text, each column flush right: a `header` of names with `|` between them, and rows of fields.
pub fn text_table(header: &str, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut lines: Vec<Vec<String>> = vec![header.split('|').map(str::to_owned).collect()];
    lines.extend(rows);
    let columns = lines.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let fields = lines.iter().filter_map(|line| line.get(column));
        fields.map(|field| field.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let text = lines.iter().map(|line| {
        let fields = line.iter().zip(&widths);
        let fields = fields.map(|(field, &width)| format!("  {field:>width$}"));
        fields.collect::<String>().trim_end().to_owned()
    });
    text.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_scoring::se3::Pose;
    use knotdock_scoring::terms::pose::TermValues;

    fn pose(score: f64, cluster: Option<usize>) -> RankedPose {
        RankedPose {
            pose: Pose::identity(),
            score,
            search_score: Some(score),
            cluster,
            cluster_score: None,
            cluster_size: cluster.map(|_| 2),
            refined: false,
            sharp: None,
            rotation: 0,
            score_grid: score,
            terms: [Some(score), None, None, None],
            shape: None,
            pose_terms: TermValues::default(),
            other_copies: None,
            pose_score: Some(score),
            z_score: None,
        }
    }

    #[test]
    fn one_row_a_cluster_under_the_rank_of_its_best_pose() {
        let ranking = [
            pose(9.0, Some(1)),
            pose(8.0, Some(1)),
            pose(7.0, None),
            pose(6.0, Some(2)),
            pose(5.0, None),
            pose(4.0, Some(2)),
        ];
        // In the order of the clusters; what belongs to none comes last.
        assert_eq!(firsts(&ranking), [0, 3, 2, 4]);
        let irmsd = Column {
            name: "irmsd".to_owned(),
            fields: ["1.234", "", "", "3.5"].map(str::to_owned).to_vec(),
        };
        let met = Column {
            name: "met".to_owned(),
            fields: ["3", "0", "1", "2", "3", "0"].map(str::to_owned).to_vec(),
        };
        assert!(
            best_clusters(&ranking, &[met])
                .contains("   4    6.0             2         6.0             2")
        );
        assert_eq!(
            best_clusters(&ranking, &[irmsd]),
            "  rank  score  cluster_size  pose_score  z_score  irmsd\n\
             \x20    1    9.0             2         9.0            1.23\n\
             \x20    4    6.0             2         6.0            3.50\n\
             \x20    3    7.0                       7.0\n\
             \x20    5    5.0                       5.0"
        );
    }

    /// Clusters are ordered by their own scores, not by those of their best poses: without the first the order looked
    /// wrong.
    #[test]
    fn clusters_show_the_score_that_orders_them() {
        let in_company = |score: f64, cluster, cluster_score: f64| RankedPose {
            score: cluster_score,
            pose_score: Some(score),
            ..pose(score, Some(cluster))
        };
        let ranking = [in_company(8.0, 1, 11.0), in_company(9.0, 2, 10.0)];
        assert_eq!(
            best_clusters(&ranking, &[]),
            "  rank  score  cluster_size  pose_score  z_score\n\
             \x20    1   11.0             2         8.0\n\
             \x20    2   10.0             2         9.0"
        );
    }
}
