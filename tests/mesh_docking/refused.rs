//! What cannot be docked is refused before the search, with exit code 2, the file at fault and a remedy.

use super::parts::{Part, broken_block};
use super::run::Place;
use serde_json::Value;

fn refused(place: &Place, arguments: &[&str]) -> Value {
    let arguments = [&["dock", "--json", "-o", "run"], arguments].concat();
    let output = place.command(&arguments).output().unwrap();
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {words}");
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    let error = object["error"].clone();
    assert!(!error["remedy"].as_str().unwrap().is_empty(), "{error}");
    assert!(!place.path("run").exists());
    error
}

fn says(error: &Value, word: &str) {
    let message = error["message"].as_str().unwrap();
    assert!(message.contains(word), "{message:?} should say {word:?}");
}

fn of_file(error: &Value, name: &str) {
    let file = error["file"].as_str().unwrap_or_default();
    assert!(file.ends_with(name), "{error} should name {name}");
}

const ATOM: &str =
    "ATOM      1  CA  GLY A   1       0.000   0.000   0.000  1.00  0.00           C\nEND\n";

#[test]
fn a_mesh_does_not_dock_with_a_molecule() {
    let place = Place::of(&broken_block(0.05));
    place.write("one.pdb", ATOM);
    for pair in [["receptor.stl", "one.pdb"], ["one.pdb", "ligand.stl"]] {
        let error = refused(&place, &pair);
        says(&error, "molecule");
        of_file(&error, ".stl");
    }
    says(
        &refused(&place, &["receptor.stl:A", "ligand.stl"]),
        "chains",
    );
    let native = ["receptor.stl", "ligand.stl", "--native", "one.pdb"];
    says(&refused(&place, &native), "known complex");
}

#[test]
fn meshes_that_bound_no_solid_are_refused_with_their_file() {
    let place = Place::of(&broken_block(0.05));
    place.write("empty.stl", "solid nothing\nendsolid nothing\n");
    place.write(
        "flat.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n",
    );
    place.write("broken.obj", "v 0 0 0\nv 1 0 zero\nf 1 2 3\n");
    for (name, word) in [
        ("empty.stl", "triangles"),
        ("flat.obj", "flat"),
        ("none.ply", "no such"),
    ] {
        let error = refused(&place, &["receptor.stl", name]);
        says(&error, word);
        of_file(&error, name);
    }
    let error = refused(&place, &["broken.obj", "ligand.stl"]);
    of_file(&error, "broken.obj");
    assert_eq!(error["line"], 2);
}

/// Nothing is left of a small part at the resolution that the grid of a part a hundred times as long allows.
#[test]
fn parts_too_different_in_size_are_refused() {
    let place = Place::of(&broken_block(0.05));
    let scaled = |factor: f64| {
        let part: Part = broken_block(0.05).ligand;
        part.moved(|point| point.map(|value| factor * value)).stl()
    };
    place.write("small.stl", &scaled(0.01));
    place.write("tiny.stl", &scaled(1e-9));
    let error = refused(&place, &["receptor.stl", "small.stl"]);
    says(&error, "too thin");
    of_file(&error, "small.stl");
    let error = refused(&place, &["tiny.stl", "ligand.stl"]);
    says(&error, "across");
    of_file(&error, "tiny.stl");
}

#[test]
fn options_that_meshes_or_molecules_do_not_have_are_refused() {
    let place = Place::of(&broken_block(0.05));
    place.write("one.pdb", ATOM);
    let meshes = ["receptor.stl", "ligand.stl", "--sample-grid", "20^3"];
    for (more, word) in [
        (["--offset", "1e-3"], "finer"),
        (["--offset", "0.6"], "coarse"),
        (["--effects", "electrostatics"], "charges"),
        (["--effects", "contact"], "atom types"),
        (["--effects", "restraint"], "residues"),
        (["--block-ligand", "A:1"], "for molecules"),
        (["--active-receptor", "A:1"], "for molecules"),
        (["--config", "terms.core_weight=2"], "for molecules"),
        (["--config", "terms.contact_weight=5"], "for molecules"),
        (["--ph", "5"], "for molecules"),
        (["--resolution", "0"], "above 0"),
        (["--alpha", "0"], "above zero"),
        (["--rotations", "0"], "between 1 and 10000000"),
        (["--sampler", "voxels"], "lattice or bi"),
    ] {
        says(&refused(&place, &[&meshes[..], &more].concat()), word);
    }
    let molecules = ["one.pdb", "one.pdb"];
    for more in [
        ["--sample-grid", "2^15"],
        ["--sample-weights", "unit"],
        ["--sampler", "bi"],
    ] {
        says(
            &refused(&place, &[&molecules[..], &more].concat()),
            "meshes",
        );
    }
    let evaluated = place
        .command(&["interface", "ligand.stl"])
        .output()
        .unwrap();
    assert_eq!(evaluated.status.code(), Some(2));
}
