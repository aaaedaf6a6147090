//! Every reader with its seeds, and what may come of any input: a value that can be used, or an error that says what
//! is wrong.

use std::fs;
use std::path::Path;

use knotdock::models::confidence::{ChainPairIptm, Confidence};
use knotdock::models::tokens::polymers;
use knotdock::output::tables::poses::PoseTable;
use knotdock_cli::records::recorded_run::RecordedRun;
use knotdock_cli::tables::pair_table::read_pairs;
use knotdock_scoring::terms::effect::contact::{Potential, TYPES};
use knotdock_scoring::terms::pose::{AtomPairPotential, DistanceBinnedPotential};
use knotdock_structures::ball_union::union_volume;
use knotdock_structures::mesh::{MeshFormat, parse};
use knotdock_structures::molecule::{
    AlternateLocation, Format, Hetatm, Hydrogens, InputSpec, ModelChoice, ReadOptions, Waters,
    atom_kinds, read_with_fates, write_molecule,
};

/// A reader under test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reader {
    Pdb,
    Mmcif,
    Gzip,
    Stl,
    Obj,
    Ply,
    Off,
    Poses,
    Run,
    Contact,
    FineContact,
    AtomPair,
    Pairs,
    Confidence,
}

impl Reader {
    pub const ALL: [Self; 14] = [
        Self::Pdb,
        Self::Mmcif,
        Self::Gzip,
        Self::Stl,
        Self::Obj,
        Self::Ply,
        Self::Off,
        Self::Poses,
        Self::Run,
        Self::Contact,
        Self::FineContact,
        Self::AtomPair,
        Self::Pairs,
        Self::Confidence,
    ];

    /// Reads an input; says whether it was taken, or panics where a promise is broken. `scratch` is a folder to write
    /// into, and `index` chooses the options.
    pub fn read(self, bytes: &[u8], scratch: &Path, index: u64) -> bool {
        match self {
            Self::Pdb | Self::Mmcif | Self::Gzip => {
                let ending = if self == Self::Mmcif { "cif" } else { "pdb" };
                let path = scratch.join("input").with_extension(ending);
                replace(&path, bytes);
                molecule(&path, index)
            }
            Self::Stl => mesh(bytes, MeshFormat::Stl),
            Self::Obj => mesh(bytes, MeshFormat::Obj),
            Self::Ply => mesh(bytes, MeshFormat::Ply),
            Self::Off => mesh(bytes, MeshFormat::Off),
            Self::Poses => {
                let path = scratch.join("poses.csv");
                replace(&path, bytes);
                match PoseTable::read(&path) {
                    Ok(table) => {
                        for row in table.rows() {
                            let norm = row.pose.rotation.quaternion().norm();
                            assert!((norm - 1.0).abs() < 1e-6 && row.rank > 0);
                            assert!(row.pose.translation.iter().all(|x| x.is_finite()));
                        }
                        true
                    }
                    Err(error) => {
                        assert!(!error.to_string().is_empty() && error.remedy().is_some());
                        assert_eq!(error.file(), Some(path.as_path()));
                        false
                    }
                }
            }
            Self::Run => {
                let path = scratch.join("run.json");
                replace(&path, bytes);
                match RecordedRun::read(&path) {
                    Ok(_) => true,
                    Err(error) => {
                        assert!(!error.to_string().is_empty());
                        assert_eq!(error.file(), Some(path.as_path()));
                        false
                    }
                }
            }
            Self::Confidence => confidence(bytes),
            Self::Contact => table(bytes, |text| Ok(vec![Potential::parse(text)?])),
            Self::FineContact => table(bytes, |text| {
                Ok(DistanceBinnedPotential::parse(text)?.ranges.into())
            }),
            Self::AtomPair => pair_table(bytes),
            Self::Pairs => {
                let path = scratch.join("pairs.csv");
                replace(&path, bytes);
                // At least one: a table without a line end may be wrong in its first.
                let lines = 1 + bytes.iter().filter(|&&byte| byte == b'\n').count() as u64;
                match read_pairs(&path, false) {
                    Ok(rows) => {
                        assert!(!rows.is_empty());
                        for row in &rows {
                            assert!(!row.receptor.is_empty() && !row.ligand.is_empty());
                            // A carriage return alone ends a row, and no line.
                            assert!((1..=lines).contains(&row.line), "line {}", row.line);
                        }
                        true
                    }
                    Err(error) => {
                        assert!(!error.to_string().is_empty());
                        assert_eq!(error.file(), Some(path.as_path()));
                        let line = error.line();
                        assert!(
                            line.is_none_or(|line| (1..=lines).contains(&line)),
                            "{error}"
                        );
                        false
                    }
                }
            }
        }
    }
}

/// Reads the confidence of a model, whose numbers must be possible.
fn confidence(bytes: &[u8]) -> bool {
    match Confidence::parse(bytes.to_vec()) {
        Ok(found) => {
            if let Some(pae) = &found.pae {
                assert!(pae.tokens > 0 && pae.values.len() == pae.tokens * pae.tokens);
                assert!(
                    pae.values
                        .iter()
                        .all(|value| (0.0..=1000.0).contains(value))
                );
            }
            let plddt = found.plddt.iter().flatten();
            assert!(plddt.into_iter().all(|value| (0.0..=100.0).contains(value)));
            if let Some(ChainPairIptm::Matrix(rows)) = &found.chain_pair_iptm {
                assert!(rows.iter().all(|row| row.len() == rows.len()));
            }
            true
        }
        Err(error) => {
            assert!(!error.message().is_empty() && error.remedy().is_some());
            false
        }
    }
}

/// Puts an input where the last one was. As a new file: some file systems flush one that is cut short and written
/// again, which took fifty times as long as reading it.
fn replace(path: &Path, bytes: &[u8]) {
    // There is none before the first input.
    let _ = fs::remove_file(path);
    fs::write(path, bytes).unwrap();
}

/// Reads tables of energies, which must be finite and symmetric.
fn table(
    bytes: &[u8],
    parse: fn(&str) -> Result<Vec<Potential>, knotdock_structures::Error>,
) -> bool {
    let Ok(text) = str::from_utf8(bytes) else {
        return false;
    };
    match parse(text) {
        Ok(tables) => {
            for table in tables {
                for a in 0..TYPES.len() {
                    for b in 0..=a {
                        let energy = table.energy(a, b);
                        assert!(energy.is_finite() && energy == table.energy(b, a));
                    }
                }
            }
            true
        }
        Err(error) => refused(text, &error),
    }
}

/// The same of energies of kinds of atoms.
fn pair_table(bytes: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(bytes) else {
        return false;
    };
    match AtomPairPotential::parse(text) {
        Ok(table) => {
            for a in 0..atom_kinds().len() {
                for b in 0..=a {
                    let energies = table.energies(a, b);
                    assert!(energies.iter().all(|energy| energy.is_finite()));
                    assert_eq!(energies, table.energies(b, a));
                }
            }
            true
        }
        Err(error) => refused(text, &error),
    }
}

fn refused(text: &str, error: &knotdock_structures::Error) -> bool {
    assert!((1..=text.lines().count().max(1)).contains(&(error.line().unwrap_or(0) as usize)));
    assert!(!error.message().is_empty());
    false
}

/// Reads a structure by options that go round with the index, and uses what comes of it.
fn molecule(path: &Path, index: u64) -> bool {
    let options = ReadOptions {
        waters: if index & 1 == 0 {
            Waters::Drop
        } else {
            Waters::Keep
        },
        hetatm: [Hetatm::NoAdditives, Hetatm::Keep, Hetatm::Drop][(index / 2 % 3) as usize],
        hydrogens: if (index / 6) & 1 == 0 {
            Hydrogens::Drop
        } else {
            Hydrogens::Keep
        },
        altloc: if (index / 12) & 1 == 0 {
            AlternateLocation::Occupancy
        } else {
            AlternateLocation::Named('B')
        },
        model: match index / 24 % 3 {
            0 => ModelChoice::All,
            number => ModelChoice::Number(number as usize),
        },
        assembly: ((index / 96) & 1 == 1).then(|| "1".to_owned()),
        min_plddt: ((index / 48) & 1 == 1).then_some(15.0),
        trust_plddt: (index / 192) & 1 == 1,
        ..ReadOptions::default()
    };
    match read_with_fates(&InputSpec::whole(path), &options) {
        Ok((molecule, entries)) => {
            assert!(!molecule.atoms.is_empty() && entries.len() >= molecule.atoms.len());
            let knots = molecule.knots().unwrap();
            assert!(!molecule.report.to_string().is_empty());
            let labels = molecule.labels(7.0);
            assert_eq!(labels.charges.len(), molecule.atoms.len());
            let polymers = polymers(&molecule, None).unwrap();
            assert!(polymers.chains.iter().all(|chain| chain.residues.len() > 1));
            // What is slow is computed for a few.
            if index.is_multiple_of(16) {
                let _ = union_volume(&knots);
                let areas = molecule.accessible_areas(8);
                assert_eq!(areas.len(), molecule.atoms.len());
                let mut text = Vec::new();
                // It may refuse what the format cannot hold.
                let _ = write_molecule(&mut text, Format::Pdb, &molecule, &[]);
                let _ = write_molecule(&mut text, Format::Mmcif, &molecule, &[]);
            }
            true
        }
        Err(error) => {
            // The repairs passed something that the parser after them refused or broke down on.
            assert!(!error.message().contains("the parser refused"), "{error}");
            assert!(!error.message().is_empty() && error.remedy().is_some());
            assert_eq!(error.file(), Some(path));
            false
        }
    }
}

fn mesh(bytes: &[u8], format: MeshFormat) -> bool {
    match parse(bytes, format) {
        Ok((mesh, _)) => {
            assert!(mesh.positions().iter().flatten().all(|x| x.is_finite()));
            let corners = mesh.triangles().iter().flatten();
            assert!(
                corners
                    .copied()
                    .all(|index| (index as usize) < mesh.positions().len())
            );
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            false
        }
    }
}
