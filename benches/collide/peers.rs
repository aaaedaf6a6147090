//! The same questions to other libraries: parry3d here, coal (PyPI) by `scripts/benchmark/collide_peers.py`.

use knotdock_scoring::se3::Pose;
use knotdock_structures::mesh::Mesh;
use parry3d_f64::math::{Pose as ParryPose, Rotation, Vector};
use parry3d_f64::query::{Unsupported, contact, distance, intersection_test};
use parry3d_f64::shape::TriMesh;
use std::error::Error;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Two meshes of parry's.
pub struct Parry {
    meshes: [TriMesh; 2],
}

/// A mesh of parry's, in the file's unit.
fn parry_mesh(mesh: &Mesh) -> Result<TriMesh, Box<dyn Error>> {
    let positions = mesh.positions().iter();
    let positions = positions.map(|place| Vector::from_array(*place)).collect();
    Ok(TriMesh::new(positions, mesh.triangles().to_vec())?)
}

/// A pose as parry has it.
fn parry_pose(pose: &Pose) -> ParryPose {
    let q = pose.rotation.quaternion();
    let t = pose.translation;
    ParryPose::from_parts(
        Vector::new(t.x, t.y, t.z),
        Rotation::from_xyzw(q.i, q.j, q.k, q.w),
    )
}

impl Parry {
    pub fn new(meshes: [&Mesh; 2]) -> Result<Self, Box<dyn Error>> {
        let [first, second] = meshes.map(parry_mesh);
        Ok(Self {
            meshes: [first?, second?],
        })
    }

    /// Whether the surfaces meet: a solid within another is none.
    pub fn meet(&self, pose: &Pose) -> Result<bool, Unsupported> {
        let [first, second] = &self.meshes;
        let found = intersection_test(&ParryPose::IDENTITY, first, &parry_pose(pose), second)?;
        Ok(found.intersecting)
    }

    /// Distance of the surfaces, zero where they meet.
    pub fn distance(&self, pose: &Pose) -> Result<f64, Unsupported> {
        let [first, second] = &self.meshes;
        Ok(distance(&ParryPose::IDENTITY, first, &parry_pose(pose), second)?.distance)
    }

    /// Signed distance of the deepest pair of triangles, if any meet.
    pub fn contact(&self, pose: &Pose) -> Result<Option<f64>, Unsupported> {
        let [first, second] = &self.meshes;
        let found = contact(&ParryPose::IDENTITY, first, &parry_pose(pose), second, 0.0)?;
        Ok(found.map(|contact| contact.dist))
    }
}

/// What coal says of one pose.
#[derive(Clone, Copy, Debug)]
pub struct CoalRow {
    /// Microseconds of verdict, distance and contacts.
    pub micros: [f64; 3],
    /// Whether the surfaces meet.
    pub meet: bool,
    /// Their distance.
    pub distance: f64,
}

/// Times coal on every `stride`th pose of a path; the reason where it cannot be had.
pub fn coal(
    python: &Path,
    meshes: &[PathBuf; 2],
    path: &Path,
    stride: usize,
    runs: usize,
) -> Result<Vec<CoalRow>, String> {
    let script = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .join("scripts/benchmark/collide_peers.py");
    let table = path.with_file_name("coal.csv");
    let done = Command::new(python)
        .arg(&script)
        .args([&meshes[0], &meshes[1], path, table.as_path()])
        .args(["--stride", &stride.to_string(), "--runs", &runs.to_string()])
        .output();
    let done = match done {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return Err(format!("there is no {}", python.display()));
        }
        done => done.map_err(|error| error.to_string())?,
    };
    if !done.status.success() {
        return Err(String::from_utf8_lossy(&done.stderr).trim().to_owned());
    }
    let text = fs::read_to_string(&table).map_err(|error| error.to_string())?;
    text.lines().skip(1).map(coal_row).collect()
}

fn coal_row(line: &str) -> Result<CoalRow, String> {
    let numbers = line.split(',').map(str::parse::<f64>);
    let numbers: Vec<f64> = numbers
        .collect::<Result<_, _>>()
        .map_err(|e| e.to_string())?;
    match numbers[..] {
        [_, meet, distance, a, b, c] => Ok(CoalRow {
            micros: [a, b, c],
            meet: meet != 0.0,
            distance,
        }),
        _ => Err(format!("a row of {} numbers", numbers.len())),
    }
}

/// The Python of the reference checks, which has coal, where they were run; else the system's.
pub fn python() -> PathBuf {
    let checks = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../python/others/bin/python");
    match checks.exists() {
        true => checks,
        false => "python3".into(),
    }
}
