//! Each pair, its ligand turned and taken away, is put together again by `knotdock dock`: rank 1 is right to one grid step and 5 degrees.

use super::parts::Pair;
use super::run::{Place, dock, rank_one};
use super::scenes::{broken, error, peg, torus};
use serde_json::Value;

/// Docks a pair with the defaults but for the numbers of rotations and poses, and holds rank 1 to the answer.
fn put_together((pair, clearance): (Pair, f64)) {
    let place = Place::of(&pair);
    let run: Value = dock(
        &place,
        &[
            "receptor.stl",
            "ligand.stl",
            "-o",
            "run",
            "--rotations",
            "1200",
            "--poses",
            "100",
            "--refine",
            "40",
            "--write-top",
            "1",
        ],
    );
    let run = &run["run"];
    // The clearance is what the sampling asks for: twice the sum of eps.
    let epsilon = |side: &str| run["inputs"][side]["sampling"]["epsilon"].as_f64().unwrap();
    let needed = 2.0 * (epsilon("receptor") + epsilon("ligand"));
    assert!(
        clearance >= needed && clearance < 1.1 * needed,
        "{clearance} {needed}"
    );
    let step = run["plan"]["spacing"].as_f64().unwrap();
    let pose = rank_one(&place.path("run/poses.csv"));
    let (distance, degrees) = error(&pair, &pose);
    println!(
        "{}: clearance {clearance:.4}; rank 1 is off by {distance:.4} ({:.2} grid steps of {step:.4}) and {degrees:.2} degrees; {} and {} balls, {:.1} s",
        pair.name,
        distance / step,
        run["inputs"]["receptor"]["sampling"]["balls"],
        run["inputs"]["ligand"]["sampling"]["balls"],
        run["timing"]["wall_seconds"].as_f64().unwrap(),
    );
    assert!(
        distance <= step && degrees <= 5.0,
        "{}: {distance} {degrees}",
        pair.name
    );
}

#[test]
fn a_keyed_peg_goes_into_its_blind_hole() {
    put_together(peg());
}

#[test]
fn linked_halves_of_a_torus_close() {
    put_together(torus());
}

#[test]
fn a_broken_block_is_mended() {
    put_together(broken());
}
