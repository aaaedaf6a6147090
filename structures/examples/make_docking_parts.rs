//! Writes pairs of parts that fit together, to try `knotdock dock` on.
//!
//! The files are FOLDER/peg_receptor.stl, FOLDER/peg_ligand.stl and so on, each ligand turned and moved away.
//! FOLDER/parts.json has the symmetries of each and the pose that puts it back.
//!
//!     cargo run -p knotdock-structures --example make_docking_parts -- FOLDER [CLEARANCE]
//!
//! The clearance is the smallest gap between the two parts of a pair in their right pose, in shares of about one part's
//! length. The default .055 is 2 (eps_A + eps_B) of grids of 2^18 nodes and a little more.

mod docking_parts;

use docking_parts::{HalfTurnAxis, pairs};
use std::path::PathBuf;

fn main() -> std::io::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let Some(folder) = arguments.next().map(PathBuf::from) else {
        eprintln!("usage: make_docking_parts FOLDER [CLEARANCE]");
        std::process::exit(2);
    };
    let clearance = match arguments.next().map(|text| text.parse::<f64>()) {
        None => 0.055,
        Some(Ok(value)) if (0.0..=0.08).contains(&value) => value,
        Some(_) => {
            eprintln!("the clearance must be a number from 0 to 0.08");
            std::process::exit(2);
        }
    };
    std::fs::create_dir_all(&folder)?;
    // 115 degrees about (1, 2, 3), then away: the answer is the way back.
    let (half, length) = (115f64.to_radians() / 2.0, 14f64.sqrt());
    let away = [
        half.cos(),
        half.sin() / length,
        2.0 * half.sin() / length,
        3.0 * half.sin() / length,
    ];
    let back = [away[0], -away[1], -away[2], -away[3]];
    let shift = [2.0, -1.5, 0.7];
    let mut records = Vec::new();
    for pair in pairs(clearance) {
        let ligand = pair.ligand.moved(|point| {
            let turned = rotate(away, point);
            [0, 1, 2].map(|axis| turned[axis] + shift[axis])
        });
        for (side, part) in [("receptor", &pair.receptor), ("ligand", &ligand)] {
            std::fs::write(folder.join(format!("{}_{side}.stl", pair.name)), part.stl())?;
        }
        let t = rotate(back, shift).map(|x| -x);
        records.push(format!(
            "  {{\"name\": {:?}, \"clearance\": {clearance}, \"pose\": {:?}, \"receptor_half_turns\": {}, \"ligand_half_turns_before_the_move\": {}}}",
            pair.name,
            [back[0], back[1], back[2], back[3], t[0], t[1], t[2]],
            axes(&pair.receptor_symmetry),
            axes(&pair.ligand_symmetry),
        ));
    }
    std::fs::write(
        folder.join("parts.json"),
        format!("[\n{}\n]\n", records.join(",\n")),
    )
}

fn axes(axes: &[HalfTurnAxis]) -> String {
    let axes = axes.iter().map(|axis| {
        format!(
            "{{\"point\": {:?}, \"direction\": {:?}}}",
            axis.point, axis.direction
        )
    });
    format!("[{}]", axes.collect::<Vec<_>>().join(", "))
}

/// A point turned by a unit quaternion (w, x, y, z).
fn rotate([w, x, y, z]: [f64; 4], p: [f64; 3]) -> [f64; 3] {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let u = [x, y, z];
    let once = cross(u, p);
    let twice = cross(u, once);
    [0, 1, 2].map(|axis| p[axis] + 2.0 * (w * once[axis] + twice[axis]))
}
