//! Scenes in which one part of the memory after another is the largest.

use std::fmt::Write;
use std::fs;
use std::path::Path;

/// A run of `knotdock dock`.
pub struct Scene {
    pub name: &'static str,
    pub arguments: &'static str,
}

/// Scenes, small enough to be quick. Threads are fixed, for each takes memory.
pub const SCENES: &[Scene] = &[
    Scene {
        name: "all effects",
        arguments: "receptor.pdb ligand.pdb --rotations 40 -j 1",
    },
    Scene {
        name: "two threads",
        arguments: "receptor.pdb ligand.pdb --rotations 40 --resolution 6 -j 2",
    },
    Scene {
        name: "double precision",
        arguments: "receptor.pdb ligand.pdb --rotations 8 --precision double --resolution 6 -j 1",
    },
    Scene {
        name: "shape, refined",
        arguments: "receptor.pdb ligand.pdb --rotations 40 --effects shape --poses 50 -j 1",
    },
    Scene {
        name: "all effects, refined",
        arguments: "receptor.pdb ligand.pdb --rotations 40 --refine 10 --resolution 6 -j 1",
    },
    Scene {
        name: "ring",
        arguments: "copy.pdb --symmetry C2 --rotations 20 --poses 20 --resolution 6 -j 1",
    },
    Scene {
        name: "ring of rings",
        arguments: "dimer.pdb --symmetry D2 --rotations 20 --poses 20 --resolution 8 -j 1",
    },
    Scene {
        name: "many rows",
        arguments: "piece.pdb piece.pdb --rotations 8000 --per-rotation 5 --poses 40000 --no-cluster \
                    --effects shape --refine 0 --resolution 8 -j 1",
    },
    Scene {
        name: "many poses in clusters",
        arguments: "piece.pdb piece.pdb --rotations 8000 --per-rotation 5 --poses 40000 --cluster-radius 12 \
                    --effects shape --refine 0 --resolution 8 -j 1",
    },
    Scene {
        name: "finer search",
        arguments: "piece.pdb piece.pdb --rotations 200 --fine-rotations 40000 --fine-share 1 --per-rotation 20 \
                    --effects shape --refine 0 --resolution 8 -j 1",
    },
    Scene {
        name: "meshes",
        arguments: "ball.obj part.obj --rotations 40 --sample-grid 2^15 --poses 50 -j 1",
    },
    Scene {
        name: "meshes on a fine grid",
        arguments: "ball.obj part.obj --rotations 40 --sample-grid 2^18 --poses 50 -j 1",
    },
    Scene {
        name: "mesh of many triangles",
        arguments: "large.obj part.obj --rotations 40 --sample-grid 2^15 --poses 50 -j 1",
    },
];

/// Writes the files that the scenes name.
pub fn write_inputs(folder: &Path) {
    let examples =
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("structures/examples");
    for (name, example) in [
        ("receptor.pdb", "1ppe_receptor_unbound.pdb"),
        ("ligand.pdb", "1ppe_ligand_unbound.pdb"),
        ("copy.pdb", "4e43_molecule.pdb"),
        ("dimer.pdb", "4e43_dimer.pdb"),
    ] {
        fs::copy(examples.join(example), folder.join(name)).unwrap();
    }
    let ligand = fs::read_to_string(folder.join("ligand.pdb")).unwrap();
    let lines = ligand
        .lines()
        .filter(|line| line.starts_with("ATOM"))
        .take(40);
    let piece: String = lines.map(|line| format!("{line}\n")).collect();
    fs::write(folder.join("piece.pdb"), piece).unwrap();
    for (name, radius, rings) in [
        ("ball.obj", 1.0, 20),
        ("part.obj", 0.7, 20),
        ("large.obj", 1.0, 120),
    ] {
        fs::write(folder.join(name), bumpy_ball(radius, rings)).unwrap();
    }
}

/// A ball with bumps as OBJ: `rings` circles of latitude of twice as many vertices, and the poles.
fn bumpy_ball(radius: f64, rings: usize) -> String {
    let around = 2 * rings;
    let mut text = String::new();
    let mut vertex = |polar: f64, angle: f64| {
        let bump = 1.0 + 0.15 * (3.0 * polar).sin() * (2.0 * angle).cos() * polar.sin().powi(2);
        let (r, z) = (radius * bump * polar.sin(), radius * bump * polar.cos());
        writeln!(text, "v {} {} {z}", r * angle.cos(), r * angle.sin()).unwrap();
    };
    let step = std::f64::consts::PI / (rings + 1) as f64;
    for ring in 1..=rings {
        for place in 0..around {
            vertex(
                ring as f64 * step,
                std::f64::consts::TAU * place as f64 / around as f64,
            );
        }
    }
    vertex(0.0, 0.0);
    vertex(std::f64::consts::PI, 0.0);
    let number = |ring: usize, place: usize| ring * around + place % around + 1;
    let (top, bottom) = (rings * around + 1, rings * around + 2);
    for place in 0..around {
        writeln!(
            text,
            "f {top} {} {}",
            number(0, place),
            number(0, place + 1)
        )
        .unwrap();
        let last = rings - 1;
        writeln!(
            text,
            "f {bottom} {} {}",
            number(last, place + 1),
            number(last, place)
        )
        .unwrap();
        for ring in 0..last {
            let (a, b) = (number(ring, place), number(ring + 1, place));
            let (c, d) = (number(ring + 1, place + 1), number(ring, place + 1));
            writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
        }
    }
    text
}
