//! Rings of copies of a molecule.
//!
//! Known ones are found again, poses make rings to rounding, and copies are written in their places. Options that a
//! ring cannot have are refused.

mod cyclic;
mod dihedral;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::program::succeed;
use assert_cmd::cargo::cargo_bin_cmd;
use knotdock::dock::scene::Scene;
use knotdock::options::{DockOptions, EffectChoice};
use knotdock_scoring::engine::Plan;
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::symmetry::Symmetry;
use knotdock_scoring::terms::effect::Effect;
use knotdock_structures::molecule::{
    Format, InputSpec, Molecule, ReadOptions, read, write_molecule,
};
use nalgebra::{Unit, Vector3};
use serde_json::Value;

type Row = BTreeMap<String, String>;

fn example(name: &str) -> String {
    format!(
        "{}/structures/examples/1ppe_{name}.pdb",
        concat!(env!("CARGO_MANIFEST_DIR"), "/..")
    )
}

fn molecule(path: &str) -> Molecule {
    read(&InputSpec::whole(path), &ReadOptions::default()).unwrap()
}

fn rows(run: &Path) -> Vec<Row> {
    let mut table = csv::Reader::from_path(run.join("poses.csv")).unwrap();
    table.deserialize().map(Result::unwrap).collect()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap()
}

fn pose(row: &Row) -> Pose {
    Pose::from_parts(
        ["qw", "qx", "qy", "qz"].map(|column| number(row, column)),
        ["tx", "ty", "tz"].map(|column| number(row, column)),
    )
}

fn symmetry(text: &str) -> Symmetry {
    text.parse().unwrap()
}

/// Root mean square distance of a molecule's atoms in two poses.
fn rmsd(molecule: &Molecule, a: &Pose, b: &Pose) -> f64 {
    let squares = molecule.atoms.iter().map(|atom| {
        let [a, b] = [a, b].map(|pose| Vector3::from(pose.apply(atom.position)));
        (a - b).norm_squared()
    });
    (squares.sum::<f64>() / molecule.atoms.len() as f64).sqrt()
}

fn center(molecule: &Molecule) -> Vector3<f64> {
    let positions = molecule
        .atoms
        .iter()
        .map(|atom| Vector3::from(atom.position));
    positions.sum::<Vector3<f64>>() / molecule.atoms.len() as f64
}

/// The standard error of a command that is bad input.
fn refused(folder: &Path, command: &str) -> String {
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args(command.split(' '))
        .output()
        .unwrap();
    let reported = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{command}: {reported}");
    reported
}

/// The exact sum of shape over two copies of a molecule, as `score` has it.
fn scorer_of_shape(molecule: &Molecule) -> ExactScorer {
    let options = DockOptions::default()
        .changed(|options| options.kernel.effects = EffectChoice::Only(vec![Effect::Shape]));
    let scene = Scene::new(molecule, molecule, &options).unwrap();
    let engine = options.kernel.engine();
    let plan = Plan::new(&scene.receptor, &scene.ligand, engine).unwrap();
    ExactScorer::new(plan.kernel(), &scene.receptor, &scene.ligand).unwrap()
}
