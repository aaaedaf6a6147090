//! Collision of two meshes along one recorded path, beside parry3d and coal (PyPI) in the same run.
//!
//! `cargo bench --bench collide` prints the tables and writes them (Markdown, CSV) to `collide` in the folder of Cargo's
//! temporary files.
//!
//! - `-- --out FOLDER` writes them elsewhere.
//! - `--meshes A B` takes two other meshes than the Stanford bunny and itself.
//! - `--accuracy` shows what the balls' accuracy costs instead: eps, undecided share, error of the force and microseconds
//!   for grids of 2^9 to 2^18 nodes; `--images $PWD/docs/images` writes its picture there as well.
//! - `--python PYTHON` names the Python that has coal (scripts/checks/requirements_solids.txt); without, that of
//!   scripts/reference_checks.sh or the system's is tried.
//!
//! One thread asks each question of one pose after another. A time is wall time, the least of three runs of the pose:
//! of knotdock for all poses, of the others for every `--stride`th. The page docs/method/collision.md shows the results.

mod accuracy;
mod measured;
mod path;
mod peers;
#[path = "../paper_figures/report.rs"]
#[allow(dead_code)]
mod report;
#[path = "../paper_figures/table.rs"]
#[allow(dead_code)]
mod table;
mod versus;

use clap::Parser;
use knotdock_scoring::se3::Pose;
use knotdock_structures::ball_solid::BallSolid;
use knotdock_structures::mesh::{Mesh, read};
use nalgebra::Vector3;
use std::error::Error;
use std::fs;
use std::path::PathBuf;

/// Collision of two meshes along one path, beside other libraries.
#[derive(Parser)]
pub struct Options {
    /// Folder for tables and pictures.
    #[arg(long, default_value = concat!(env!("CARGO_TARGET_TMPDIR"), "/collide"))]
    out: PathBuf,
    /// Folder that the documentation's pictures are written to besides.
    #[arg(long)]
    images: Option<PathBuf>,
    /// What accuracy costs, instead of the comparison.
    #[arg(long)]
    accuracy: bool,
    /// The mesh that stands and the one that moves.
    #[arg(long, num_args = 2, value_names = ["A", "B"], default_values_t = [BUNNY.to_owned(), BUNNY.to_owned()])]
    meshes: Vec<String>,
    /// Nodes of the sampling grid, as a power of two.
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u32).range(9..=24))]
    grid: u32,
    /// Poses of the path.
    #[arg(long, default_value_t = path::POSES)]
    poses: usize,
    /// Every how manieth pose the other libraries get.
    #[arg(long, default_value_t = 20)]
    stride: usize,
    /// Poses of the batch.
    #[arg(long, default_value_t = 100_000)]
    batch: usize,
    /// Python that has coal.
    #[arg(long)]
    python: Option<PathBuf>,
    /// What Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

const BUNNY: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../structures/examples/bunny.obj"
);

/// Two meshes, their files and the path.
pub struct Setting {
    files: [PathBuf; 2],
    meshes: [Mesh; 2],
    path: Vec<Pose>,
}

impl Setting {
    fn new(files: &[String], poses: usize) -> Result<Self, Box<dyn Error>> {
        let files = [0, 1].map(|side| PathBuf::from(&files[side]));
        let [(a, _), (b, _)] = [read(&files[0])?, read(&files[1])?];
        let middles = [&a, &b].map(|mesh| {
            let (low, high) = mesh.bounds();
            0.5 * (Vector3::from(low) + Vector3::from(high))
        });
        let path = path::path(middles, a.extent(), poses);
        Ok(Self {
            files,
            meshes: [a, b],
            path,
        })
    }

    /// The solids as balls.
    fn balls(&self, per_axis: usize) -> Result<[BallSolid; 2], Box<dyn Error>> {
        let [a, b] = self.meshes.each_ref().map(Mesh::solid);
        let first = BallSolid::from_mesh(&a?, per_axis)?.0;
        let second = match self.files[0] == self.files[1] {
            true => first.clone(),
            false => BallSolid::from_mesh(&b?, per_axis)?.0,
        };
        Ok([first, second])
    }

    /// The longest edge of the standing mesh.
    fn edge(&self) -> f64 {
        self.meshes[0].extent()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    fs::create_dir_all(&options.out)?;
    let setting = Setting::new(&options.meshes, options.poses)?;
    let figure = match options.accuracy {
        true => accuracy::figure(&setting)?,
        false => versus::figure(&setting, &options)?,
    };
    figure.write(&options.out, options.images.as_deref())?;
    eprintln!("written to {}", options.out.display());
    Ok(())
}
