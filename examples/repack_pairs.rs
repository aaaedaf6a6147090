//! Packs interface side chains of pairs whose answer is known, and measures them against the bound ones:
//! `cargo run --release --example repack_pairs -- FOLDER ID...`.
//!
//! FOLDER holds one folder per pair with `receptor_unbound`, `ligand_unbound`, `receptor_bound` and `ligand_bound`
//! (`.pdb.gz`), the unbound files superposed on the bound ones, residue numbers matched. The output is one row of CSV
//! per pair, and one of all pairs together:
//!
//! - `residues`: side chains with chi angles that in the bound complex have an atom within 6 Å of the other molecule,
//!   complete in both;
//! - `rmsd`: of their heavy atoms in Å, each residue superposed by N, CA and C, names of equal atoms exchanged if that
//!   is better;
//! - `chi1`: share of them whose chi1 is within 40 degrees of the bound one;
//! - `clashes`: pairs of atoms across the interface nearer than 0.8 of the sum of their radii.
//!
//! `--threshold` and `--rotamer-weight` set the options of these names (`--threshold=2`). With `--bound` the bound
//! molecules themselves are packed, which shows how far packing leads away from the answer.

use std::process::ExitCode;
use std::time::Instant;

use knotdock::side_chains::{RepackOptions, Repacked, Repacker};
use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::{InputSpec, Molecule, ReadOptions, SideChain, read};
use nalgebra::{Matrix3, Vector3};

/// Distance in Å of the interface.
const INTERFACE: f64 = 6.0;
/// Atoms that are alike but for their names.
const ALIKE: [(&str, [&str; 2]); 6] = [
    ("PHE", ["CD1", "CD2"]),
    ("PHE", ["CE1", "CE2"]),
    ("TYR", ["CD1", "CD2"]),
    ("TYR", ["CE1", "CE2"]),
    ("ASP", ["OD1", "OD2"]),
    ("GLU", ["OE1", "OE2"]),
];

/// Sums over residues.
#[derive(Clone, Copy, Default)]
struct Sums {
    residues: usize,
    atoms: usize,
    squares: [f64; 2],
    chi1: [usize; 2],
    clashes: [usize; 2],
    moved: usize,
    seconds: f64,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (flags, rest): (Vec<_>, Vec<_>) = arguments.iter().partition(|one| one.starts_with("--"));
    let Some((folder, ids)) = rest.split_first() else {
        eprintln!("usage: repack_pairs [--bound] FOLDER ID...");
        return ExitCode::from(2);
    };
    let is_bound = flags.iter().any(|flag| *flag == "--bound");
    let kind = if is_bound { "bound" } else { "unbound" };
    let number = |name: &str, default: f64| {
        let mut values = flags
            .iter()
            .filter_map(|flag| flag.strip_prefix(name)?.parse().ok());
        values.next_back().unwrap_or(default)
    };
    let default = RepackOptions::default();
    let options = RepackOptions {
        threshold: number("--threshold=", default.threshold),
        rotamer_weight: number("--rotamer-weight=", default.rotamer_weight),
        ..default
    };
    println!(
        "id,residues,rmsd_before,rmsd_after,chi1_before,chi1_after,clashes_before,clashes_after,moved,seconds"
    );
    let mut all = Sums::default();
    for id in ids {
        let file = |name: &str| {
            let path = format!("{folder}/{id}/{name}.pdb.gz");
            read(&InputSpec::whole(path), &ReadOptions::default())
        };
        let names = [format!("receptor_{kind}"), format!("ligand_{kind}")];
        let molecules = (
            file(&names[0]),
            file(&names[1]),
            file("receptor_bound"),
            file("ligand_bound"),
        );
        let (Ok(receptor), Ok(ligand), Ok(bound_receptor), Ok(bound_ligand)) = molecules else {
            eprintln!("{id}: a file is missing or cannot be read");
            return ExitCode::FAILURE;
        };
        let start = Instant::now();
        let repacker = Repacker::new(&receptor, &ligand, options);
        let packed = repacker.repack(&Pose::identity());
        let mut sums = Sums {
            seconds: start.elapsed().as_secs_f64(),
            clashes: [packed.clashes_before, packed.clashes_after],
            moved: packed.moved.len(),
            ..Sums::default()
        };
        let Repacked {
            receptor: new_receptor,
            ligand: new_ligand,
            ..
        } = &packed;
        sums.add([&receptor, new_receptor], &bound_receptor, &bound_ligand);
        sums.add([&ligand, new_ligand], &bound_ligand, &bound_receptor);
        sums.print(id);
        all.merge(&sums);
    }
    all.print("all");
    ExitCode::SUCCESS
}

impl Sums {
    /// Adds one molecule's residues, before and after, against the bound ones.
    fn add(&mut self, molecules: [&Molecule; 2], bound: &Molecule, partner: &Molecule) {
        let mut answers = bound.side_chains();
        answers.retain(|one| !one.bonds.is_empty() && is_near(bound, one, partner));
        let key = |one: &SideChain| (one.chain.clone(), one.number.clone(), one.residue);
        for side_chain in molecules[0].side_chains() {
            let answer = answers
                .iter()
                .find(|answer| key(answer) == key(&side_chain));
            let Some(answer) = answer.filter(|_| !side_chain.bonds.is_empty()) else {
                continue;
            };
            self.residues += 1;
            self.atoms += side_chain.atoms.len();
            for (k, molecule) in molecules.into_iter().enumerate() {
                self.squares[k] += deviation((molecule, &side_chain), (bound, answer));
                let chi = |molecule: &Molecule, of: &SideChain| {
                    let places: Vec<_> = molecule.atoms.iter().map(|atom| atom.position).collect();
                    of.chi(&places)[0].to_degrees()
                };
                let off = (chi(molecule, &side_chain) - chi(bound, answer)).abs();
                self.chi1[k] += usize::from(off.min(360.0 - off) <= 40.0);
            }
        }
    }

    fn merge(&mut self, other: &Self) {
        self.residues += other.residues;
        self.atoms += other.atoms;
        self.moved += other.moved;
        self.seconds += other.seconds;
        for k in 0..2 {
            self.squares[k] += other.squares[k];
            self.chi1[k] += other.chi1[k];
            self.clashes[k] += other.clashes[k];
        }
    }

    fn print(&self, id: &str) {
        let rmsd = self
            .squares
            .map(|sum| (sum / self.atoms.max(1) as f64).sqrt());
        let chi1 = self
            .chi1
            .map(|count| count as f64 / self.residues.max(1) as f64);
        println!(
            "{id},{},{:.2},{:.2},{:.3},{:.3},{},{},{},{:.2}",
            self.residues,
            rmsd[0],
            rmsd[1],
            chi1[0],
            chi1[1],
            self.clashes[0],
            self.clashes[1],
            self.moved,
            self.seconds
        );
    }
}

/// Whether an atom of a side chain lies within the interface distance of the other molecule.
fn is_near(molecule: &Molecule, side_chain: &SideChain, partner: &Molecule) -> bool {
    let place = |atom: usize| Vector3::from(molecule.atoms[atom].position);
    side_chain.atoms.iter().any(|&atom| {
        let near = |other: &Vector3<f64>| (other - place(atom)).norm() < INTERFACE;
        partner
            .atoms
            .iter()
            .any(|other| near(&Vector3::from(other.position)))
    })
}

/// Sum of squared distances in Å^2 of a side chain's atoms from the answer's, each in its residue's frame.
fn deviation(own: (&Molecule, &SideChain), answer: (&Molecule, &SideChain)) -> f64 {
    let places =
        |(molecule, side_chain): (&Molecule, &SideChain), exchanged: bool| -> Vec<Vector3<f64>> {
            let (origin, frame) = frame(molecule, side_chain);
            let name = |atom: usize| {
                let name = molecule.atoms[atom].name.as_str();
                let pair = ALIKE
                    .iter()
                    .find(|(residue, pair)| *residue == side_chain.residue && pair.contains(&name));
                match pair {
                    Some((_, [a, b])) if exchanged => {
                        if name == *a {
                            *b
                        } else {
                            *a
                        }
                    }
                    _ => name,
                }
            };
            let find = |wanted: &str| side_chain.atoms.iter().find(|&&atom| name(atom) == wanted);
            let local = |&atom: &usize| {
                let atom = find(&molecule.atoms[atom].name).unwrap_or(&atom);
                frame.transpose() * (Vector3::from(molecule.atoms[*atom].position) - origin)
            };
            side_chain.atoms.iter().map(local).collect()
        };
    let bound = places(answer, false);
    let sum = |exchanged: bool| -> f64 {
        places(own, exchanged)
            .iter()
            .zip(&bound)
            .map(|(a, b)| (a - b).norm_squared())
            .sum()
    };
    sum(false).min(sum(true))
}

/// CA, and the axes that N, CA and C span.
fn frame(molecule: &Molecule, side_chain: &SideChain) -> (Vector3<f64>, Matrix3<f64>) {
    let place = |name: &str| {
        let own = side_chain
            .near_bonds
            .iter()
            .map(|&atom| &molecule.atoms[atom]);
        let ca = &molecule.atoms[side_chain.bonds[0].atoms[1]];
        let same = own.filter(|atom| {
            atom.residue_number == ca.residue_number && atom.insertion_code == ca.insertion_code
        });
        let mut named = same.filter(|atom| atom.name == name);
        named
            .next()
            .map_or_else(Vector3::zeros, |atom| Vector3::from(atom.position))
    };
    let (n, ca, c) = (place("N"), place("CA"), place("C"));
    let x = (c - ca).normalize();
    let y = (n - ca - x * x.dot(&(n - ca))).normalize();
    (ca, Matrix3::from_columns(&[x, y, x.cross(&y)]))
}
