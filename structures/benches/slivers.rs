//! Meshes that searches find hard, beside a ball of as many triangles: a cylinder of long thin triangles, straight
//! and oblique, and a block with many pores.
//!
//!     cargo bench -p knotdock-structures --bench slivers
//!
//! CPU seconds of reading, sampling (Algorithm 1, 2^12 nodes) and measuring, and their ratio to those of the ball.

use std::f64::consts::PI;

use cpu_time::ProcessTime;
use knotdock_structures::mesh::{Solid, from_triangles};
use knotdock_structures::sampling::decomposition::DecompositionOptions;
use knotdock_structures::sampling::hausdorff::HausdorffMeter;
use knotdock_structures::sampling::{Method, sample};

type Surface = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// A disk of radius 10 and height 4 with `sides` sides, its caps cut from their middles; its axis is (0, s, c).
fn cylinder(sides: u32, (s, c): (f64, f64)) -> Surface {
    let mut positions = vec![[0.0, 0.0, -2.0], [0.0, 0.0, 2.0]];
    let mut triangles = Vec::new();
    for side in 0..sides {
        let angle = 2.0 * PI * f64::from(side) / f64::from(sides);
        let at = |z: f64| [10.0 * angle.cos(), 10.0 * angle.sin(), z];
        positions.extend([at(-2.0), at(2.0)]);
        let (a, b) = (2 + 2 * side, 2 + 2 * ((side + 1) % sides));
        triangles.extend([
            [0, b, a],
            [1, a + 1, b + 1],
            [a, b, b + 1],
            [a, b + 1, a + 1],
        ]);
    }
    for [_, y, z] in &mut positions {
        (*y, *z) = (c * *y + s * *z, c * *z - s * *y);
    }
    (positions, triangles)
}

/// A sphere in rings of `2 * rings` sectors.
fn sphere(center: [f64; 3], radius: f64, rings: u32) -> Surface {
    let sectors = 2 * rings;
    let at = |theta: f64, phi: f64| {
        let unit = [
            theta.sin() * phi.cos(),
            theta.sin() * phi.sin(),
            theta.cos(),
        ];
        [0, 1, 2].map(|axis| center[axis] + radius * unit[axis])
    };
    let mut positions = vec![at(0.0, 0.0), at(PI, 0.0)];
    for ring in 1..rings {
        let theta = PI * f64::from(ring) / f64::from(rings);
        positions.extend(
            (0..sectors).map(|sector| at(theta, PI * f64::from(sector) / f64::from(rings))),
        );
    }
    let name = |ring: u32, sector: u32| 2 + (ring - 1) * sectors + sector % sectors;
    let mut triangles = Vec::new();
    for sector in 0..sectors {
        triangles.push([0, name(1, sector), name(1, sector + 1)]);
        triangles.push([1, name(rings - 1, sector + 1), name(rings - 1, sector)]);
        for ring in 1..rings - 1 {
            let [a, b] = [name(ring, sector), name(ring + 1, sector)];
            let [c, d] = [name(ring + 1, sector + 1), name(ring, sector + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (positions, triangles)
}

/// A ball with `count`^3 pores of 20 or so triangles.
fn pores(count: u32) -> Surface {
    let mut surface = sphere([0.0; 3], 10.0, 56);
    let pitch = 11.0 / f64::from(count);
    for number in 0..count.pow(3) {
        let place = [
            number % count,
            number / count % count,
            number / count.pow(2),
        ];
        let center = place.map(|n| pitch * (f64::from(n) - 0.5 * f64::from(count - 1)));
        let (positions, triangles) = sphere(center, 0.3 * pitch, 3);
        let first = surface.0.len() as u32;
        surface.0.extend(positions);
        surface.1.extend(
            triangles
                .iter()
                .map(|&[a, b, c]| [first + a, first + c, first + b]),
        );
    }
    surface
}

/// CPU seconds of reading, sampling and measuring, and the number of triangles.
fn seconds((positions, triangles): &Surface) -> [f64; 4] {
    let start = ProcessTime::now();
    let (mesh, report) = from_triangles(positions, triangles).expect("a mesh");
    let read = start.elapsed();
    let solid = Solid::new(&mesh).expect("a solid");
    let method = Method::BehandishIlies(DecompositionOptions::default());
    let sampling = sample(&solid, 16, method).expect("it has an inside");
    let sampled = start.elapsed();
    let meter = HausdorffMeter::new(&solid, &sampling.field);
    for set in &sampling.sets {
        meter.measure(&set.balls);
    }
    let judged = start.elapsed();
    let [read, sampled, judged] = [read, sampled, judged].map(|time| time.as_secs_f64());
    [
        read,
        sampled - read,
        judged - sampled,
        report.triangles as f64,
    ]
}

fn main() {
    let oblique = (0.6f64.sin(), 0.6f64.cos());
    let ball = seconds(&sphere([0.0; 3], 10.0, 64));
    println!("| mesh | triangles | reading | sampling | measuring | times the ball's |");
    println!("|---|---|---|---|---|---|");
    for (name, times) in [
        ("ball", ball),
        (
            "cylinder of 4000 sides",
            seconds(&cylinder(4000, (0.0, 1.0))),
        ),
        ("the same, oblique", seconds(&cylinder(4000, oblique))),
        ("216 pores", seconds(&pores(6))),
        ("1728 pores", seconds(&pores(12))),
    ] {
        let whole = |times: [f64; 4]| times[..3].iter().sum::<f64>();
        println!(
            "| {name} | {} | {:.2} | {:.2} | {:.2} | {:.1} |",
            times[3],
            times[0],
            times[1],
            times[2],
            whole(times) / whole(ball)
        );
    }
}
