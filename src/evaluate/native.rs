//! The native complex, as two groups of chains.

use knotdock_structures::molecule::Molecule;

use super::EvaluateError;
use super::matching::{align_all, pair_chains};
use super::residues::Residues;

/// The known answer that poses are judged by.
#[derive(Clone, Copy, Debug)]
pub enum Native<'a> {
    /// One file with the whole complex. Its chains go to the side whose chains they match; where receptor and ligand
    /// are the same chain, both ways round are tried for every pose.
    Complex(&'a Molecule),
    /// The two sides apart, in one common frame.
    Pair {
        /// The native's receptor.
        receptor: &'a Molecule,
        /// The native's ligand.
        ligand: &'a Molecule,
    },
}

/// The native's two sides.
#[derive(Clone, Debug)]
pub(super) struct Groups {
    pub receptor: Residues,
    pub ligand: Residues,
    /// Names of chains that belong to neither.
    pub unused: Vec<String>,
}

/// The ways to see the native as two sides, the likeliest first: one, or two where the sides may be exchanged.
///
/// # Errors
/// [`EvaluateError::NoResidues`], [`EvaluateError::NotFinite`], and [`EvaluateError::Unmatched`] when no chain of a
/// whole complex is the receptor's or none the ligand's.
pub(super) fn groups(
    receptor: &Residues,
    ligand: &Residues,
    native: Native,
) -> Result<Vec<Groups>, EvaluateError> {
    match native {
        Native::Pair { receptor, ligand } => Ok(vec![Groups {
            receptor: Residues::of(receptor, "native receptor")?,
            ligand: Residues::of(ligand, "native ligand")?,
            unused: Vec::new(),
        }]),
        Native::Complex(complex) => {
            let found = split(receptor, ligand, &Residues::of(complex, "native")?)?;
            let exchanged = Groups {
                receptor: found.ligand.clone(),
                ligand: found.receptor.clone(),
                unused: found.unused.clone(),
            };
            Ok(vec![found, exchanged])
        }
    }
}

/// Gives each chain of the complex to the side with which it shares most residues.
fn split(
    receptor: &Residues,
    ligand: &Residues,
    complex: &Residues,
) -> Result<Groups, EvaluateError> {
    let user = receptor.followed_by(ligand);
    let first_of_ligand = receptor.segments.len();
    let pairs = pair_chains(&user, complex, &align_all(&user, complex));
    let (mut receptors, mut ligands, mut unused) = (Vec::new(), Vec::new(), Vec::new());
    for (index, segment) in complex.segments.iter().enumerate() {
        let shared = |of_ligand: bool| -> usize {
            pairs
                .iter()
                .filter(|pair| pair.native == index && (pair.user >= first_of_ligand) == of_ligand)
                .map(|pair| pair.pairs.len())
                .sum()
        };
        match (shared(false), shared(true)) {
            (0, 0) => unused.push(segment.name.clone()),
            (with_receptor, with_ligand) if with_receptor >= with_ligand => receptors.push(index),
            _ => ligands.push(index),
        }
    }
    for (side, chains) in [("receptor", &receptors), ("ligand", &ligands)] {
        if chains.is_empty() {
            return Err(EvaluateError::Unmatched { side });
        }
    }
    Ok(Groups {
        receptor: complex.only(&receptors),
        ligand: complex.only(&ligands),
        unused,
    })
}
