//! Growth of time: a rotation and a whole docking against atoms, grid points and rotations, with fitted exponents.
//!
//! `cargo bench --bench growth` prints the tables. It writes them (Markdown, CSV) and the picture (SVG) to `growth` in
//! the folder of Cargo's temporary files.
//!
//! - `-- --out FOLDER` writes them elsewhere.
//! - `--images $PWD/docs/images` writes the picture to that folder as well.
//!
//! All is measured on the example pair, one quantity changed at a time ([`settings`]):
//!
//! - atoms: the receptor is cut to its residues nearest to its middle, so that the box shrinks with it;
//! - grid points: the spacing of the grid is finer;
//! - rotations: the set is smaller or larger.
//!
//! A docking has about a sixth of the default rotations and poses. It is timed in memory: planning and docking of
//! molecules that are read, without files written. A rotation is the search stage over its rotations, peaks
//! included. Times are processor seconds on one thread, medians of three rounds through all settings.

mod figure;
mod measured;
#[path = "../paper_figures/report.rs"]
#[allow(dead_code)] // The colours of grid sizes are of the paper's figures.
mod report;
mod settings;
#[path = "../paper_figures/table.rs"]
#[allow(dead_code)] // Nothing here is scaled up, or a share.
mod table;

use clap::Parser;
use knotdock::threads::stay_on_main;
use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

/// Time of a rotation and of a docking against atoms, grid points and rotations.
#[derive(Parser)]
struct Options {
    /// Folder for tables and pictures.
    #[arg(long, default_value = concat!(env!("CARGO_TARGET_TMPDIR"), "/growth"))]
    out: PathBuf,
    /// Folder that the documentation's picture is written to besides.
    #[arg(long)]
    images: Option<PathBuf>,
    /// What Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    fs::create_dir_all(&options.out)?;
    stay_on_main()?;
    let start = Instant::now();
    let pair = settings::Pair::example()?;
    let settings = pair.settings()?;
    let measured = measured::measure(&pair, &settings)?;
    figure::figure(&settings, &measured).write(&options.out, options.images.as_deref())?;
    eprintln!(
        "{} settings in {:.0} s, written to {}",
        settings.len(),
        start.elapsed().as_secs_f64(),
        options.out.display()
    );
    Ok(())
}
