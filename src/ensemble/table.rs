//! One table of the poses of all members, in the columns of their tables.
//!
//! Beside these it has `receptor_model`, `ligand_model`, `member` and `member_rank`: the conformations, the run, and the
//! row of its table. Poses are those of the member's files. `z_score` is the member's own; `score`,
//! `cluster` and `cluster_size` are of the ensemble.

use std::collections::HashSet;
use std::path::PathBuf;

use csv::StringRecord;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;

use crate::ensemble::joined::{JoinedRow, MemberRow, join};
use crate::output::tables::fields::number;
use crate::output::tables::poses::{PoseRow, PoseTable};
use crate::output::tables::poses_reader::{column_place, no_value};
use crate::output::tables::quality::OF_COMPLEXES;
use crate::rank::cluster::RigidBody;

/// Columns that name the conformations, receptor first.
const CONFORMATIONS: [&str; 2] = ["receptor_model", "ligand_model"];
/// Column of the member's name.
pub const MEMBER: &str = "member";
/// Column of the row's rank in the member's own table.
const MEMBER_RANK: &str = "member_rank";

/// A member that has been docked.
#[derive(Clone, Debug)]
pub struct DockedMember {
    /// Its name, and that of the folder of its run.
    pub name: String,
    /// Names of its conformations, receptor first.
    pub conformations: [String; 2],
    /// From the frames of its files to those of the first ones, receptor first.
    pub to_first: [Pose; 2],
    /// Path of its table.
    pub path: PathBuf,
    /// Its table.
    pub table: PoseTable,
}

/// The joint table, with its members and clusters.
#[derive(Clone, Debug)]
pub struct JointTable {
    /// The table.
    pub table: PoseTable,
    /// Member (its place among those given) of each row.
    pub members: Vec<usize>,
    /// Clusters of all members' poses.
    pub clusters: usize,
}

impl JointTable {
    /// Places of the first row of each cluster, in the order of the table.
    pub fn firsts(&self) -> Vec<usize> {
        let mut seen = HashSet::new();
        let rows = 0..self.table.records.len();
        rows.filter(|&row| seen.insert(self.table.field(row, "cluster")))
            .collect()
    }
}

/// Joins the members' tables; poses cluster within `radius` (Å RMSD) of `body`, the first ligand.
///
/// # Errors
/// [`Error`] if a member's table lacks a column or a number.
pub fn joint(
    members: &[DockedMember],
    body: &RigidBody,
    radius: f64,
    every_pose: bool,
) -> Result<JointTable, Error> {
    let mut rows = Vec::new();
    let mut places = Vec::new();
    for (index, member) in members.iter().enumerate() {
        rows.extend(member_rows(member)?);
        places.extend((0..member.table.rows.len()).map(|row| (index, row)));
    }
    let joined = join(&rows, body, radius, every_pose);
    let columns = Columns::of(members);
    let mut joint = JointTable {
        table: PoseTable {
            header: columns.header(),
            records: Vec::with_capacity(joined.len()),
            rows: Vec::with_capacity(joined.len()),
        },
        members: Vec::with_capacity(joined.len()),
        clusters: joined.iter().map(|row| row.cluster).max().unwrap_or(0),
    };
    for (row, rank) in joined.iter().zip(1..) {
        let (index, place) = places[row.row];
        let member = &members[index];
        let record = columns.record(member, (index, place), row, rank);
        joint.table.records.push(record);
        let pose = member.table.rows[place].pose;
        joint.table.rows.push(PoseRow { rank, pose });
        joint.members.push(index);
    }
    Ok(joint)
}

/// A member's rows in the frame of the first conformations.
fn member_rows(member: &DockedMember) -> Result<Vec<MemberRow>, Error> {
    let table = &member.table;
    let column = |name: &str| column_place(&member.path, &table.header, name);
    let (score, pose_score) = (column("score")?, column("pose_score")?);
    let size = column("cluster_size")?;
    let sharp = column("sharp").ok();
    let [receptor, ligand] = &member.to_first;
    let back = ligand.inverse();
    let rows = table.records.iter().zip(&table.rows).zip(2..);
    rows.map(|((record, row), line)| {
        let value = |place: usize, name: &str| {
            let field = record.get(place).unwrap_or_default();
            let value = field.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| no_value(&member.path, line, name, field, "a finite number"))
        };
        // Only poses that have a sharp fit have a score of one.
        let has_sharp = |place: &usize| record.get(*place).is_some_and(|field| !field.is_empty());
        Ok(MemberRow {
            pose: receptor.after(&row.pose).after(&back),
            score: value(score, "score")?,
            pose_score: value(pose_score, "pose_score")?,
            sharp: match sharp.filter(has_sharp) {
                Some(place) => value(place, "sharp")?,
                None => 0.0,
            },
            size: value(size, "cluster_size")? as usize,
        })
    })
    .collect()
}

/// Columns that the ensemble fills, which come first.
const OWN: [&str; 4] = ["rank", "score", "cluster", "cluster_size"];

/// The columns of the joint table.
struct Columns {
    /// Those of the members' tables that are copied, in order.
    copied: Vec<String>,
    /// The place of each in each member's table.
    places: Vec<Vec<Option<usize>>>,
}

impl Columns {
    /// All columns that any member has, but those of its own complexes, each after the one that it follows there.
    fn of(members: &[DockedMember]) -> Self {
        let mut copied: Vec<String> = Vec::new();
        for member in members {
            let mut after = 0;
            let header = member.table.header.iter();
            let is_copied = |name: &&str| !OWN.contains(name) && !OF_COMPLEXES.contains(name);
            for name in header.filter(is_copied) {
                match copied.iter().position(|known| known == name) {
                    Some(place) => after = place + 1,
                    None => {
                        copied.insert(after, name.to_owned());
                        after += 1;
                    }
                }
            }
        }
        let places = members.iter().map(|member| {
            let place = |name: &String| member.table.header.iter().position(|own| own == name);
            copied.iter().map(place).collect()
        });
        Self {
            places: places.collect(),
            copied,
        }
    }

    fn header(&self) -> StringRecord {
        let own = OWN.into_iter().chain(CONFORMATIONS);
        let own = own.chain([MEMBER, MEMBER_RANK]);
        own.chain(self.copied.iter().map(String::as_str)).collect()
    }

    /// A row of the joint table.
    fn record(
        &self,
        member: &DockedMember,
        (index, place): (usize, usize),
        joined: &JoinedRow,
        rank: usize,
    ) -> StringRecord {
        let mut record = StringRecord::new();
        record.push_field(&rank.to_string());
        record.push_field(&number(joined.score));
        record.push_field(&joined.cluster.to_string());
        record.push_field(&joined.size.to_string());
        for name in member.conformations.iter().chain([&member.name]) {
            record.push_field(name);
        }
        record.push_field(&member.table.rows[place].rank.to_string());
        let source = &member.table.records[place];
        for place in &self.places[index] {
            let field = place.and_then(|place| source.get(place));
            record.push_field(field.unwrap_or_default());
        }
        record
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn member(name: &str, further: &str, to_first: [Pose; 2], rows: &str) -> DockedMember {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("poses.csv");
        let header = format!(
            "rank,score,cluster,cluster_size,pose_score,{further},z_score,qw,qx,qy,qz,tx,ty,tz\n"
        );
        std::fs::write(&path, header + rows).unwrap();
        DockedMember {
            name: name.to_owned(),
            conformations: ["1".to_owned(), name.to_owned()],
            to_first,
            table: PoseTable::read(&path).unwrap(),
            path,
        }
    }

    /// The second member's files are the first's, moved; its poses are the first's therefore, and its further column
    /// stays in its place.
    #[test]
    fn moved_files_give_the_same_clusters() {
        let to_first = [
            Pose::from_parts([0.5, 0.5, 0.5, 0.5], [10.0, -4.0, 2.0]),
            Pose::from_parts([0.6, 0.0, 0.8, 0.0], [-7.0, 1.0, 30.0]),
        ];
        let poses = [
            Pose::from_parts([1.0, 0.0, 0.0, 0.0], [25.0, 0.0, 0.0]),
            Pose::from_parts([0.0, 1.0, 0.0, 0.0], [0.0, 30.0, 0.0]),
        ];
        let text = |poses: &[Pose], further: &str| -> String {
            let line = |(pose, rank): (&Pose, i32)| {
                let q = pose.quaternion().map(|part| part.to_string()).join(",");
                let t = pose.translation;
                let score = 100 / rank;
                format!(
                    "{rank},{score},{rank},3,{score},{further},2,{q},{},{},{}\n",
                    t[0], t[1], t[2]
                )
            };
            poses.iter().zip(1..).map(line).collect()
        };
        // S_r P S_l^-1 is the pose in the first frame.
        let there = poses.map(|pose| to_first[0].inverse().after(&pose).after(&to_first[1]));
        let members = [
            member("a", "shape", [Pose::identity(); 2], &text(&poses, "7")),
            member("b", "shape,capri", to_first, &text(&there, "7,high")),
        ];
        let body = RigidBody::new(&[[0.0; 3], [9.0, 1.0, 0.0], [0.0, 8.0, -3.0]]);
        let joint = joint(&members, &body, 5.0, false).unwrap();
        assert_eq!(joint.clusters, 2);
        assert_eq!(
            joint.table.header,
            "rank,score,cluster,cluster_size,receptor_model,ligand_model,member,member_rank,pose_score,shape,capri,\
             z_score,qw,qx,qy,qz,tx,ty,tz"
                .split(',')
                .collect::<Vec<_>>()
        );
        let first = joint.table.objects(0..2);
        assert_eq!(first[0]["cluster_size"], 6);
        assert_eq!(
            (&first[0]["member"], &first[0]["capri"]),
            (&"a".into(), &serde_json::Value::Null)
        );
        let score = 100.0 + 10.0 * 2f64.ln();
        assert!((first[0]["score"].as_f64().unwrap() - score).abs() < 1e-9);
        assert_eq!(joint.members, [0, 0]);
    }
}
