//! Table 1 and Figures 5 to 9 and 11 of Behandish and Ilieş (CAD 70, 2016) on the paper's grid sizes: the Stanford bunny
//! against a keyed peg.
//!
//! `cargo bench --bench paper_figures` prints the tables. It writes them (Markdown, CSV) and the pictures (SVG, PNG)
//! to `paper_figures` in the folder of Cargo's temporary files.
//!
//! - `-- --out FOLDER` writes them elsewhere.
//! - `--images $PWD/docs/images` writes the pictures to that folder as well.
//! - `--grids 12,15` takes fewer grid sizes, `--figures 5,6` fewer figures; Table 1 belongs to Figure 6.
//!
//! The page docs/results/paper_figures.md describes the measurements and shows the results.
//!
//! - Figure 5 ([`figure5`]): two samples and their Minkowski sum.
//! - Table 1 and Figure 6 ([`figure6`]): counts, memory and time of Minkowski sums by pairs.
//! - Figure 7 ([`figure7`]): the gap function by FFT, and its truncation to m' modes.
//! - Figure 8 ([`figure8`]): a body's spectrum by rasterising and FFT, or from its balls by direct and fast transforms.
//! - Figure 9 ([`figure9`]): one configuration from m' modes.
//! - Figure 11 ([`figure11`]): the bunny's balls by grid and protrusion factor.
//!
//! Everything timed runs on one thread in double precision; times are processor time, the least of several runs. Columns
//! of the card are wall time on a graphics processor, in single precision ([`card`]).

mod card;
mod crossing;
#[path = "../../structures/examples/docking_parts/mod.rs"]
#[allow(dead_code)] // Only the peg is used.
mod docking_parts;
mod figure11;
mod figure5;
mod figure6;
mod figure7;
mod figure8;
mod figure9;
mod panels;
mod report;
mod scene;
mod sections;
mod table;
mod timing;
mod ways_measured;
mod whole;

use card::Card;
use clap::Parser;
use knotdock::geometry::gap::spectrum::Kernel;
use scene::Scene;
use std::error::Error;
use std::fs;
use std::io;
use std::path::PathBuf;
use whole::Whole;

/// The paper's Table 1 and Figures 5 to 9 and 11, done again.
#[derive(Parser)]
struct Options {
    /// Folder for tables and pictures.
    #[arg(long, default_value = concat!(env!("CARGO_TARGET_TMPDIR"), "/paper_figures"))]
    out: PathBuf,
    /// Folder that the documentation's pictures are written to besides.
    #[arg(long)]
    images: Option<PathBuf>,
    /// Grid sizes m, as powers of two divisible by three.
    #[arg(long, value_delimiter = ',', default_value = "12,15,18,21",
          value_parser = clap::value_parser!(u32).range(9..=24))]
    grids: Vec<u32>,
    /// Figures to do.
    #[arg(long, value_delimiter = ',', default_value = "5,6,7,8,9,11",
          value_parser = clap::value_parser!(u32).range(5..=11))]
    figures: Vec<u32>,
    /// What Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    if let Some(power) = options.grids.iter().find(|&power| power % 3 != 0) {
        return Err(format!("2^{power} is no cube of a power of two").into());
    }
    fs::create_dir_all(&options.out)?;
    let scenes = options
        .grids
        .iter()
        .map(|power| Scene::new(1 << (power / 3)))
        .collect::<Result<Vec<_>, _>>()?;
    for scene in &scenes {
        println!(
            "m = {}^3: bunny {} balls ({} nodes inside), peg {} ({}), cube of edge {:.3}",
            scene.per_axis,
            scene.bunny.radii.len(),
            scene.nodes[0].len(),
            scene.peg.radii.len(),
            scene.nodes[1].len(),
            scene.edge
        );
    }
    println!();
    let card = Card::open();
    let card = card.as_ref();
    let images = options.images.as_deref();
    if options.figures.contains(&5) {
        // Of the largest grid but two, whose balls the eye can still resolve.
        if let Some(scene) = scenes.iter().rfind(|scene| scene.per_axis <= 32) {
            write_picture("fig5", &figure5::picture(scene), &options)?;
        }
    }
    if options.figures.contains(&6) {
        figure6::figure(&scenes, card).write(&options.out, images)?;
    }
    if options.figures.contains(&11) {
        let per_axis: Vec<usize> = scenes.iter().map(|scene| scene.per_axis).collect();
        write_picture("fig11", &figure11::picture(&per_axis)?, &options)?;
    }
    if options
        .figures
        .iter()
        .any(|figure| (7..=9).contains(figure))
    {
        correlate(&scenes, card, &options)?;
    }
    if let Some(card) = card {
        println!("{}", card.note());
    }
    eprintln!("written to {}", options.out.display());
    Ok(())
}

/// Writes a picture that is no chart.
fn write_picture(name: &str, picture: &str, options: &Options) -> io::Result<()> {
    let folders = [Some(&options.out), options.images.as_ref()];
    for folder in folders.into_iter().flatten() {
        fs::write(folder.join(format!("{name}.svg")), picture)?;
    }
    Ok(())
}

/// Figures 7, 8 and 9, which share kernels, correlations or both.
fn correlate(
    scenes: &[Scene],
    card: Option<&Card>,
    options: &Options,
) -> Result<(), Box<dyn Error>> {
    let images = options.images.as_deref();
    let wanted = |figure| options.figures.contains(&figure);
    let kernels = scenes.iter().map(kernel).collect::<Result<Vec<_>, _>>()?;
    let pairs: Vec<(&Scene, &Kernel)> = scenes.iter().zip(&kernels).collect();
    if wanted(7) || wanted(9) {
        let wholes: Vec<Whole> = pairs
            .iter()
            .map(|(scene, kernel)| Whole::new(scene, kernel))
            .collect();
        if wanted(7) {
            let correlations: Vec<(&Scene, &Whole)> = scenes.iter().zip(&wholes).collect();
            figure7::figure(&correlations, card).write(&options.out, images)?;
            // Of the largest grid but one, whose points the eye can still resolve.
            if let Some(whole) = wholes.iter().rfind(|whole| whole.grid().per_axis <= 64) {
                write_picture("fig7_sections", &sections::sections(whole), options)?;
            }
        }
        if wanted(9) {
            let correlations: Vec<(&Scene, &Kernel, &Whole)> = pairs
                .iter()
                .zip(&wholes)
                .map(|((scene, kernel), whole)| (*scene, *kernel, whole))
                .collect();
            figure9::figure(&correlations, card)?.write(&options.out, images)?;
        }
    }
    if wanted(8) {
        figure8::figure(&pairs, card)?.write(&options.out, images)?;
    }
    Ok(())
}

/// A kernel for all radii of a scene, those that the series along the radius continues to included, and all
/// frequencies of its grid.
fn kernel(scene: &Scene) -> Result<Kernel, Box<dyn Error>> {
    let largest = scene.bunny.radius_range()[1].max(scene.peg.radius_range()[1]);
    let frequency = 0.5 * 3f64.sqrt() * scene.per_axis as f64 / scene.edge;
    Ok(Kernel::new(2.1 * largest * frequency)?)
}
