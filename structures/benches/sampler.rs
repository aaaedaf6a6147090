//! The paper's Tables 1 and 2 again, on the Stanford bunny: how many balls each sampler needs, how near they come, and
//! the time.
//!
//! `cargo bench -p knotdock-structures --bench sampler` prints the tables of docs/method/sampling.md; `-- 15` goes no further
//! than m = 2^15. Counts are given only where the inclusions and the Hausdorff bounds were measured to hold; anything
//! else ends the run with an error.

use std::path::Path;

use cpu_time::ProcessTime;
use knotdock_structures::mesh::{Solid, read};
use knotdock_structures::numeric::Bump;
use knotdock_structures::sampling::ball_tree::BallTree;
use knotdock_structures::sampling::decomposition::DecompositionOptions;
use knotdock_structures::sampling::hausdorff::{Fit, HausdorffMeter};
use knotdock_structures::sampling::weights;
use knotdock_structures::sampling::{Method, Sampling, SetName, sample};

const MUS: [f64; 3] = [0.25, 0.5, 1.0];

/// The paper's figures of one grid: |X| (Table 1), n1 and n3 by mu, and Weller and Zachmann's n (Table 2).
struct Paper {
    power: u32,
    inside: usize,
    n1: [usize; 3],
    n3: [usize; 3],
    wz: usize,
}

const PAPER: [Paper; 4] = [
    Paper {
        power: 12,
        inside: 666,
        n1: [318, 307, 275],
        n3: [36, 53, 67],
        wz: 334,
    },
    Paper {
        power: 15,
        inside: 5_921,
        n1: [1_552, 1_445, 1_295],
        n3: [161, 251, 324],
        wz: 1_024,
    },
    Paper {
        power: 18,
        inside: 49_981,
        n1: [6_842, 6_374, 5_436],
        n3: [1_024, 1_048, 1_311],
        wz: 15_592,
    },
    Paper {
        power: 21,
        inside: 409_058,
        n1: [26_217, 23_891, 20_674],
        n3: [3_686, 4_422, 5_160],
        wz: 89_030,
    },
];

/// A sampled solid and how it fits.
struct Run {
    sampling: Sampling,
    fits: Vec<Fit>,
    wall: f64,
    cpu: f64,
}

fn run(solid: &Solid, per_axis: usize, method: Method) -> Run {
    let (start, cpu) = (std::time::Instant::now(), ProcessTime::now());
    let sampling = sample(solid, per_axis, method).expect("the bunny has an inside");
    let (wall, cpu) = (start.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
    let meter = HausdorffMeter::new(solid, &sampling.field);
    let fits = sampling
        .sets
        .iter()
        .map(|set| meter.measure(&set.balls))
        .collect();
    Run {
        sampling,
        fits,
        wall,
        cpu,
    }
}

/// S(A1) in S in S(A2), S(A1) in S(A3) in S(A2), each within eps of S, every node covered.
fn bounds_hold(run: &Run) -> bool {
    let epsilon = run.sampling.field.grid.epsilon();
    let near = run.sampling.sets.iter().zip(&run.fits).all(|(set, fit)| {
        fit.nodes_missed == 0
            && fit.hausdorff_inward <= epsilon
            && fit.outward_bound <= epsilon * (1.0 + 1e-12)
            && (set.name != SetName::A1 || fit.outward_bound < 1e-14)
            && (set.name != SetName::A2 || fit.hausdorff_inward == 0.0)
    });
    let [a1, a2, a3] = &run.sampling.sets[..] else {
        return false;
    };
    let kept = BallTree::new(&a3.balls);
    // A ball of A1 at depth no less than its radius in the union lies in a single ball of A3.
    let held = a1
        .balls
        .iter()
        .all(|ball| kept.distance(ball.center, -ball.radius) <= -ball.radius + 1e-14);
    let all: std::collections::HashSet<[u64; 4]> = a2.balls.iter().map(bits).collect();
    near && held && a3.balls.iter().all(|ball| all.contains(&bits(ball)))
}

fn bits(ball: &knotdock_structures::sampling::Ball) -> [u64; 4] {
    let [x, y, z] = ball.center;
    [x, y, z, ball.radius].map(f64::to_bits)
}

fn main() {
    let last = std::env::args()
        .skip(1)
        .find_map(|argument| argument.parse().ok())
        .unwrap_or(21);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bunny.obj");
    let (mesh, report) = read(&path).expect("the bunny is in the repository");
    let solid = Solid::new(&mesh).expect("the bunny is a solid");
    println!("{report}\n");
    let edge = solid.half_sides().into_iter().fold(0.0, f64::max) * 2.0;
    let (mut cells, mut at_or_below, mut within) = (0, 0, 0);
    let mut sound = true;
    let mut others = vec![
        "| m | sampler | balls | paper | inward, eps | outward, eps | missed, % | outside, % | \
         wall, s | CPU, s |"
            .to_owned(),
    ];
    others.push(format!("|{}", "---|".repeat(10)));
    println!(
        "| m | eps, box edges | \\|X\\| | paper | mu | n1 | paper | n3 | paper | ratio | inward, eps (A1, A2, \
         A3) | outward, eps (A3) | bounds | wall, s | CPU, s |"
    );
    println!("|{}", "---|".repeat(15));
    for paper in PAPER.iter().filter(|paper| paper.power <= last) {
        let per_axis = 1usize << (paper.power / 3);
        for (index, mu) in MUS.into_iter().enumerate() {
            let run = run(
                &solid,
                per_axis,
                Method::BehandishIlies(DecompositionOptions {
                    mu,
                    ..Default::default()
                }),
            );
            let epsilon = run.sampling.field.grid.epsilon();
            let holds = bounds_hold(&run);
            let inside = run.sampling.inside_nodes;
            sound &= holds && (inside as f64 / paper.inside as f64 - 1.0).abs() < 0.05;
            let [n1, _, n3] = [0, 1, 2].map(|set| run.sampling.sets[set].balls.len());
            let ratio = n3 as f64 / paper.n3[index] as f64;
            if holds {
                cells += 1;
                at_or_below += usize::from(ratio <= 1.0);
                within += usize::from(ratio <= 1.5);
            }
            let inward: Vec<String> = run
                .fits
                .iter()
                .map(|fit| format!("{:.3}", fit.hausdorff_inward / epsilon))
                .collect();
            println!(
                "| 2^{} | {:.4} | {inside} | {} | {mu} | {n1} | {} | {n3} | {} | {ratio:.2} | {} | {:.3} | {} | \
                 {:.1} | {:.1} |",
                paper.power,
                epsilon / edge,
                paper.inside,
                paper.n1[index],
                paper.n3[index],
                inward.join(", "),
                run.fits[2].hausdorff_outward / epsilon,
                if holds { "hold" } else { "BROKEN" },
                run.wall,
                run.cpu
            );
            if index == 0 {
                let meter = HausdorffMeter::new(&solid, &run.sampling.field);
                others.push(row(
                    paper,
                    "B&I A3, mu 0.25",
                    &format!("{}", paper.n3[0]),
                    &run,
                    2,
                    meter.volume(),
                ));
            }
        }
        for (name, method, theirs) in [
            ("W&Z packing", Method::WellerZachmann, paper.wz.to_string()),
            ("octree", Method::Octree, String::new()),
            ("medial axis", Method::MedialAxis, String::new()),
            ("voxels", Method::Voxels, paper.inside.to_string()),
        ] {
            let run = run(&solid, per_axis, method);
            let volume = HausdorffMeter::new(&solid, &run.sampling.field).volume();
            others.push(row(paper, name, &theirs, &run, 0, volume));
        }
    }
    println!(
        "\nBounds hold in {cells} cells; n3 is at or below the paper's in {at_or_below} and within 1.5 times in \
         {within}.\n"
    );
    println!("{}", others.join("\n"));
    println!(
        "\n| m | balls | rms off one, weights 1 | fitted | integral / volume, weights 1 | fitted | zeros |\n|{}",
        "---|".repeat(7)
    );
    let bump = Bump::new(2.0).expect("above zero");
    for paper in PAPER.iter().filter(|paper| paper.power <= last.min(18)) {
        let run = run(
            &solid,
            1 << (paper.power / 3),
            Method::BehandishIlies(DecompositionOptions::default()),
        );
        let volume = HausdorffMeter::new(&solid, &run.sampling.field).volume();
        let balls = &run.sampling.sets[2].balls;
        let fitted = weights::fit(&run.sampling.field, balls, bump, volume);
        println!(
            "| 2^{} | {} | {:.3} | {:.3} | {:.2} | {:.3} | {} |",
            paper.power,
            balls.len(),
            fitted.rms_unit,
            fitted.rms_fitted,
            fitted.volume_unit,
            fitted.volume_fitted,
            fitted.zeros
        );
    }
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        println!(
            "\nPeak memory of the whole run: {}",
            peak.unwrap_or("?").trim()
        );
    }
    if !sound {
        eprintln!("error: a bound or |X| does not hold");
        std::process::exit(1);
    }
}

/// A row of the table that compares samplers.
fn row(paper: &Paper, name: &str, theirs: &str, run: &Run, set: usize, volume: f64) -> String {
    let epsilon = run.sampling.field.grid.epsilon();
    let fit = &run.fits[set];
    format!(
        "| 2^{} | {name} | {} | {theirs} | {:.2} | {:.2} | {:.2} | {:.2} | {:.1} | {:.1} |",
        paper.power,
        run.sampling.sets[set].balls.len(),
        fit.hausdorff_inward / epsilon,
        fit.hausdorff_outward / epsilon,
        100.0 * fit.volume_missed / volume,
        100.0 * fit.volume_outside / volume,
        run.wall,
        run.cpu
    )
}
