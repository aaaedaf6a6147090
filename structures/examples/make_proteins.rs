//! Makes the example proteins in this folder from their sources; see README.md beside it.
//!
//! ```text
//! cargo run -p knotdock-structures --example make_proteins -- 1ppe RECEPTOR_UNBOUND LIGAND_UNBOUND COMPLEX FOLDER
//! cargo run -p knotdock-structures --example make_proteins -- 4e43 DIMER FOLDER
//! ```
//!
//! Everything goes through the crate's own reader and writer. What is docked, the unbound ligand or one molecule of the
//! dimer, is turned by a rotation drawn once from a seed, and its centroid is moved to the origin. So its start says
//! nothing of where it binds. The bound pair stays in its common frame; the bound receptor takes the residue numbers of
//! the unbound one.

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use knotdock_structures::molecule::{
    Atom, Format, Hetatm, InputSpec, Molecule, ReadOptions, read, write_molecule,
};

/// Seeds of the rotations of the unbound ligand and of the dimer's molecule.
const SEEDS: [u64; 2] = [1, 2];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["1ppe", receptor, ligand, complex, folder] => {
            pair([receptor, ligand, complex], Path::new(folder))
        }
        ["4e43", dimer, folder] => ring(dimer, Path::new(folder)),
        _ => Err("usage: make_proteins 1ppe RECEPTOR_UNBOUND LIGAND_UNBOUND COMPLEX FOLDER, or 4e43 DIMER FOLDER".into()),
    }
}

/// Trypsin and its inhibitor, free and bound.
fn pair([receptor, ligand, complex]: [&str; 3], folder: &Path) -> Result<(), Box<dyn Error>> {
    let receptor = load(receptor)?;
    let ligand = load(ligand)?;
    let receptor_bound = renumbered(&load(&format!("{complex}:A"))?, &receptor)?;
    let ligand_bound = load(&format!("{complex}:B"))?;

    let turned = turned(&ligand, SEEDS[0]);
    let unbound = "coordinates of the free molecule, PDB entry";
    let bound = "coordinates in the complex, PDB entry 1PPE";
    let files = [
        (
            "1ppe_receptor_unbound.pdb",
            receptor,
            format!("bovine beta-trypsin, {unbound} 1BTP"),
        ),
        (
            "1ppe_ligand_unbound.pdb",
            turned,
            format!("squash inhibitor CMTI-I, {unbound} 1LU0, turned and moved"),
        ),
        (
            "1ppe_receptor_bound.pdb",
            receptor_bound,
            format!("bovine beta-trypsin, {bound}"),
        ),
        (
            "1ppe_ligand_bound.pdb",
            ligand_bound,
            format!("squash inhibitor CMTI-I, {bound}"),
        ),
    ];
    for (name, molecule, remark) in files {
        save(&folder.join(name), &molecule, remark)?;
    }
    Ok(())
}

/// The dimer of HIV-1 protease, and one of its two molecules by itself.
fn ring(dimer: &str, folder: &Path) -> Result<(), Box<dyn Error>> {
    let reading = ReadOptions {
        hetatm: Hetatm::Drop,
        ..ReadOptions::default()
    };
    let load = |text: &str| load_with(text, &reading);
    let what = "HIV-1 protease, coordinates in the dimer, PDB entry 4E43";
    let one = turned(&load(&format!("{dimer}:A"))?, SEEDS[1]);
    save(
        &folder.join("4e43_molecule.pdb"),
        &one,
        format!("{what}, turned and moved"),
    )?;
    let both = load(&format!("{dimer}:A,B"))?;
    save(&folder.join("4e43_dimer.pdb"), &both, what.to_owned())
}

fn load(text: &str) -> Result<Molecule, Box<dyn Error>> {
    load_with(text, &ReadOptions::default())
}

fn load_with(text: &str, reading: &ReadOptions) -> Result<Molecule, Box<dyn Error>> {
    let molecule = read(&InputSpec::parse(text)?, reading)?;
    println!("{}", molecule.report);
    Ok(molecule)
}

fn save(path: &Path, molecule: &Molecule, remark: String) -> Result<(), Box<dyn Error>> {
    let mut writer = BufWriter::new(File::create(path)?);
    write_molecule(&mut writer, Format::Pdb, molecule, &[remark])?;
    Ok(())
}

/// The molecule turned at random about its centroid, which is moved to the origin.
fn turned(molecule: &Molecule, seed: u64) -> Molecule {
    let rotation = random_quaternion(seed);
    println!("turned by w, x, y, z = {rotation:?}");
    let centroid = centroid(molecule);
    molecule.map_positions(|x| rotate(rotation, subtract(x, centroid)))
}

/// The molecule with its residues numbered as those of another of the same sequence.
fn renumbered(molecule: &Molecule, numbers: &Molecule) -> Result<Molecule, Box<dyn Error>> {
    let own = residues(molecule);
    let others = residues(numbers);
    if own.len() != others.len() {
        return Err("the receptors differ in length".into());
    }
    let mut renumbered = molecule.clone();
    let mut atoms = renumbered.atoms.iter_mut();
    for (own, other) in own.iter().zip(&others) {
        let (Some(first), Some(named)) = (own.first(), other.first()) else {
            continue;
        };
        if first.residue_name != named.residue_name {
            return Err("the receptors differ in sequence".into());
        }
        for atom in atoms.by_ref().take(own.len()) {
            atom.residue_number = named.residue_number;
            atom.insertion_code = named.insertion_code;
        }
    }
    Ok(renumbered)
}

/// Runs of atoms that share a residue.
fn residues(molecule: &Molecule) -> Vec<&[Atom]> {
    let key = |atom: &Atom| (atom.residue_number, atom.insertion_code);
    molecule.atoms.chunk_by(|a, b| key(a) == key(b)).collect()
}

fn centroid(molecule: &Molecule) -> [f64; 3] {
    let count = molecule.atoms.len() as f64;
    let sum = molecule.atoms.iter().fold([0.0; 3], |sum, atom| {
        let [x, y, z] = atom.position;
        [sum[0] + x, sum[1] + y, sum[2] + z]
    });
    sum.map(|total| total / count)
}

fn subtract([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [a - x, b - y, c - z]
}

/// Turns x by the unit quaternion (w, x, y, z): active, right-handed.
fn rotate([w, a, b, c]: [f64; 4], [x, y, z]: [f64; 3]) -> [f64; 3] {
    // v + 2 w (q x v) + 2 q x (q x v), with q the vector part.
    let cross = |[x, y, z]: [f64; 3]| [b * z - c * y, c * x - a * z, a * y - b * x];
    let once = cross([x, y, z]);
    let twice = cross(once);
    [
        x + 2.0 * (w * once[0] + twice[0]),
        y + 2.0 * (w * once[1] + twice[1]),
        z + 2.0 * (w * once[2] + twice[2]),
    ]
}

/// A uniform random rotation: Shoemake, Graphics Gems III (1992) 124-132, on SplitMix64 (Steele, Lea & Flood, OOPSLA
/// 2014).
fn random_quaternion(seed: u64) -> [f64; 4] {
    let mut state = seed;
    let mut uniform = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (u, first, second) = (uniform(), uniform(), uniform());
    let (sin_1, cos_1) = (std::f64::consts::TAU * first).sin_cos();
    let (sin_2, cos_2) = (std::f64::consts::TAU * second).sin_cos();
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    [b * cos_2, a * sin_1, a * cos_1, b * sin_2]
}
