//! Collision of two Stanford bunnies along one recorded path, beside parry3d and coal (PyPI) in the same run.
//!
//! `cargo bench --bench collide` prints the tables and writes them (Markdown, CSV) to `collide` in the folder of Cargo's
//! temporary files.
//!
//! - `-- --out FOLDER` writes them elsewhere.
//! - `--accuracy` shows what accuracy costs instead: eps, undecided share and microseconds for grids of 2^9 to 2^21
//!   nodes; `--images docs/images` writes its picture there as well.
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
use knotdock_structures::mesh::{Mesh, Solid, read};
use nalgebra::Vector3;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// Collision of two bunnies along one path, beside other libraries.
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
    /// Nodes of the sampling grid, as a power of two.
    #[arg(long, default_value_t = 18, value_parser = clap::value_parser!(u32).range(9..=24))]
    grid: u32,
    /// Poses of the path.
    #[arg(long, default_value_t = path::POSES)]
    poses: usize,
    /// Every how manieth pose the other libraries get.
    #[arg(long, default_value_t = 20)]
    stride: usize,
    /// Poses of the batch.
    #[arg(long, default_value_t = 1_000_000)]
    batch: usize,
    /// Python that has coal.
    #[arg(long)]
    python: Option<PathBuf>,
    /// What Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

/// The mesh, its file and the path.
pub struct Setting {
    file: PathBuf,
    mesh: Mesh,
    solid: Solid,
    path: Vec<Pose>,
}

impl Setting {
    fn new(poses: usize) -> Result<Self, Box<dyn Error>> {
        let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
            .join("structures/examples/bunny.obj");
        let (mesh, _) = read(&file)?;
        let solid = Solid::new(&mesh)?;
        let (low, high) = mesh.bounds();
        let middle = 0.5 * (Vector3::from(low) + Vector3::from(high));
        let path = path::path(middle, mesh.extent(), poses);
        Ok(Self {
            file,
            mesh,
            solid,
            path,
        })
    }

    /// The solid as balls.
    fn balls(&self, per_axis: usize) -> Result<BallSolid, Box<dyn Error>> {
        Ok(BallSolid::from_mesh(&self.solid, per_axis)?.0)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    fs::create_dir_all(&options.out)?;
    let setting = Setting::new(options.poses)?;
    let figure = match options.accuracy {
        true => accuracy::figure(&setting)?,
        false => versus::figure(&setting, &options)?,
    };
    figure.write(&options.out, options.images.as_deref())?;
    eprintln!("written to {}", options.out.display());
    Ok(())
}
