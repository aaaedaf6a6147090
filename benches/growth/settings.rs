//! What is docked: the example pair, with one quantity changed at a time.

use knotdock::dock::plan::plan;
use knotdock::options::DockOptions;
use knotdock_structures::molecule::{Atom, InputSpec, Molecule, ReadOptions, read};
use std::error::Error;
use std::path::Path;

/// Rotations and poses of a docking where neither is changed: about a sixth of the defaults, so that all dockings take
/// less than three minutes.
const ROTATIONS: usize = 640;
const POSES: usize = 350;
/// Shares of the receptor's residues that are left.
const SHARES: [f64; 4] = [0.0625, 0.125, 0.25, 0.5];
/// Doublings of the grid's points.
const DOUBLINGS: [i32; 3] = [1, 2, 3];
/// Further sizes of the rotation set, multiples of eight, so that each transform of the ligand serves eight.
const SETS: [usize; 4] = [160, 320, 1280, 2560];

/// A quantity that is changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Varied {
    /// Nothing: the point that all curves share.
    Nothing,
    /// Atoms of the receptor.
    Atoms,
    /// Points of the grid.
    Grid,
    /// Rotations of the set.
    Rotations,
}

/// One docking.
pub struct Setting {
    /// The quantity that is changed.
    pub varied: Varied,
    /// Share of the receptor's residues that is left.
    share: f64,
    /// Options of the run.
    pub options: DockOptions,
}

/// The two molecules, in Å.
pub struct Pair {
    receptor: Molecule,
    /// The second molecule, which is never cut.
    pub ligand: Molecule,
}

impl Pair {
    /// Reads the example pair.
    pub fn example() -> Result<Self, Box<dyn Error>> {
        let folder =
            Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("structures/examples");
        let load = |name: &str| -> Result<Molecule, Box<dyn Error>> {
            let spec = InputSpec::whole(folder.join(name));
            Ok(read(&spec, &ReadOptions::default())?)
        };
        Ok(Self {
            receptor: load("1ppe_receptor_unbound.pdb")?,
            ligand: load("1ppe_ligand_unbound.pdb")?,
        })
    }

    /// The receptor of a setting.
    pub fn receptor(&self, setting: &Setting) -> Molecule {
        core(&self.receptor, setting.share)
    }

    /// All settings, the shared one first.
    pub fn settings(&self) -> Result<Vec<Setting>, Box<dyn Error>> {
        let base = DockOptions::default().changed(|options| {
            options.machine.threads = 1.into();
            options.search.rotations = ROTATIONS;
            options.search.poses = POSES;
            // A molecule has no such ends before it is cut.
            options.terms.unresolved_weight = 0.0;
            options.terms.termini_weight = 0.0;
        });
        let spacing = plan(&self.receptor, &self.ligand, &base)?.spacing;
        let setting = |varied, share, change: &dyn Fn(&mut DockOptions)| Setting {
            varied,
            share,
            options: base.changed(change),
        };
        let mut settings = vec![setting(Varied::Nothing, 1.0, &|_| ())];
        settings.extend(SHARES.map(|share| setting(Varied::Atoms, share, &|_| ())));
        settings.extend(DOUBLINGS.map(|doublings| {
            let finer = spacing * f64::from(-doublings).exp2().cbrt();
            setting(Varied::Grid, 1.0, &|options| {
                options.kernel.spacing = Some(finer);
            })
        }));
        settings.extend(SETS.map(|rotations| {
            setting(Varied::Rotations, 1.0, &|options| {
                options.search.rotations = rotations;
            })
        }));
        Ok(settings)
    }
}

/// The share of a molecule's residues whose middles lie nearest to its own, in the order of the file.
fn core(molecule: &Molecule, share: f64) -> Molecule {
    let middle = middle(&molecule.atoms);
    let residues: Vec<(f64, &[Atom])> = molecule
        .atoms
        .chunk_by(|a, b| {
            let key = |atom: &Atom| (atom.residue_number, atom.insertion_code);
            a.chain == b.chain && key(a) == key(b)
        })
        .map(|atoms| (squared_distance(self::middle(atoms), middle), atoms))
        .collect();
    let mut distances: Vec<f64> = residues.iter().map(|(distance, _)| *distance).collect();
    distances.sort_by(f64::total_cmp);
    let kept = ((share * distances.len() as f64).ceil() as usize).clamp(1, distances.len());
    let radius = distances[kept - 1];
    let nearest = residues.iter().filter(|(distance, _)| *distance <= radius);
    Molecule {
        atoms: nearest.flat_map(|(_, atoms)| atoms.to_vec()).collect(),
        ..molecule.clone()
    }
}

/// Mean position of atoms, Å.
fn middle(atoms: &[Atom]) -> [f64; 3] {
    let sum = |axis: usize| atoms.iter().map(|atom| atom.position[axis]).sum::<f64>();
    [0, 1, 2].map(|axis| sum(axis) / atoms.len() as f64)
}

fn squared_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum()
}
