//! Time of one rotation of a pair beside bare Fourier transforms of the planned sizes, in the same run.
//!
//! `cargo bench --bench rotation [-- RECEPTOR LIGAND]` takes the example pair unless two files are named. It prints medians
//! over rotations: each stage, the whole rotation, and the stock transforms for comparison. Those are q forward real
//! transforms of the fine grid and one inverse of the mode grid, unpruned and out of place. They are computed by realfft
//! and rustfft, with the `transpose` crate between axes.

mod example;

use knotdock_scoring::Precision;
use knotdock_scoring::engine::ReceptorSpectra;
use knotdock_scoring::engine::{CpuEngine, Plan};
use knotdock_scoring::quantity::Quantity;
use num_complex::Complex32;
use realfft::RealFftPlanner;
use rustfft::FftPlanner;
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

const ROTATIONS: usize = 101;
/// Shape alone takes 2 or 3 components, and all effects of proteins about 7.
const RANKS: [usize; 3] = [2, 3, 7];

fn main() -> Result<(), Box<dyn Error>> {
    let files: Vec<String> = std::env::args()
        .skip(1)
        .filter(|argument| !argument.starts_with("--"))
        .collect();
    let [receptor, ligand] = match files.as_slice() {
        [] => example::knots()?,
        [receptor, ligand] => [example::load(receptor)?, example::load(ligand)?],
        _ => return Err("name a receptor and a ligand, or neither".into()),
    };
    let options = knotdock::options::DockOptions::default().kernel.engine();
    let plan = Arc::new(Plan::new(&receptor, &ligand, options)?.fitted(&receptor)?);
    let spectra = ReceptorSpectra::new(
        &plan,
        &receptor,
        &ligand,
        Quantity::Score,
        Precision::Single,
    );
    for rank in RANKS {
        let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &ligand, rank);
        let mut work = engine.workspace_of(engine.turns().len());
        let images = engine.turns().len() as f64;
        let mut stages: [Vec<f64>; 6] = Default::default();
        for rotation in knotdock_scoring::so3::rotation_set(ROTATIONS) {
            let seconds = engine.stage_seconds(&rotation, &mut work);
            for (times, value) in stages.iter_mut().zip(seconds) {
                times.push(value);
            }
            // Spreading and the forward transform serve all images.
            let [spread, planes, columns, product, rows] = seconds;
            stages[5].push((spread + planes + columns) / images + product + rows);
        }
        let [spread, planes, columns, product, rows, whole] = stages.map(median);
        let forward = stock(plan.fine());
        let inverse = stock(plan.size());
        let bare = rank as f64 * forward + inverse;
        println!(
            "rank {rank}: grid {:?}, fine grid {:?}, {} modes",
            plan.size(),
            plan.fine(),
            plan.modes().count
        );
        println!(
            "  ms for {images} rotations: spreading {:.3}, forward z and y {:.3}, x {:.3}; for each: \
             product with inverse x {:.3}, \
             inverse y and z {:.3}; a rotation in all {:.3}",
            1e3 * spread,
            1e3 * planes,
            1e3 * columns,
            1e3 * product,
            1e3 * rows,
            1e3 * whole
        );
        println!(
            "  stock real transforms: {rank} x {:.3} + {:.3} = {:.3} ms; ratio {:.2}, without spreading {:.2}",
            1e3 * forward,
            1e3 * inverse,
            1e3 * bare,
            whole / bare,
            (whole - spread / images) / bare
        );
    }
    Ok(())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Median seconds of one three-dimensional real transform, unpruned and out of place.
fn stock([nx, ny, nz]: [usize; 3]) -> f64 {
    let half = nz / 2 + 1;
    let along_z = RealFftPlanner::<f32>::new().plan_fft_forward(nz);
    let mut planner = FftPlanner::<f32>::new();
    let (along_y, along_x) = (planner.plan_fft_forward(ny), planner.plan_fft_forward(nx));
    let mut input: Vec<f32> = (0..nx * ny * nz).map(|i| (i % 17) as f32).collect();
    let zero = Complex32::default();
    let (mut a, mut b) = (vec![zero; nx * ny * half], vec![zero; nx * ny * half]);
    let mut scratch = vec![zero; 4 * nx.max(ny).max(nz)];
    let mut row = along_z.make_output_vec();
    let times = (0..ROTATIONS)
        .map(|_| {
            let start = Instant::now();
            for (values, out) in input.chunks_exact_mut(nz).zip(a.chunks_exact_mut(half)) {
                let _ = along_z.process_with_scratch(values, &mut row, &mut scratch);
                out.copy_from_slice(&row);
            }
            // (x, y, z) -> (x, z, y) plane by plane, then (x, zy) -> (zy, x).
            for (from, to) in a.chunks_exact(ny * half).zip(b.chunks_exact_mut(ny * half)) {
                transpose::transpose(from, to, half, ny);
            }
            along_y.process_with_scratch(&mut b, &mut scratch);
            transpose::transpose(&b, &mut a, ny * half, nx);
            along_x.process_with_scratch(&mut a, &mut scratch);
            start.elapsed().as_secs_f64()
        })
        .collect();
    median(times)
}
