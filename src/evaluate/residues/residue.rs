//! A residue as the evaluation sees it: its name, its backbone and its heavy atoms.

use knotdock_structures::molecule::{
    Atom, plain_atom_name, plain_residue_name, standard_residue_name,
};
use nalgebra::Point3;

/// Backbone atom names, those of DockQ 2.1.3 (`constants.py`): the first four for proteins, the rest for nucleic acids.
pub(in crate::evaluate) const BACKBONE_ATOMS: [&str; 16] = [
    "CA", "C", "N", "O", "P", "OP1", "OP2", "O2'", "O3'", "O4'", "O5'", "C1'", "C2'", "C3'", "C4'",
    "C5'",
];

/// Identifier of a residue in its file: number and insertion code.
pub(in crate::evaluate) type Number = (i64, Option<char>);

/// Number of the [`BACKBONE_ATOMS`] that are of proteins.
const OF_PROTEINS: usize = 4;
/// Places of P and O3' among the [`BACKBONE_ATOMS`].
pub(in crate::evaluate) const PHOSPHORUS: usize = 4;
pub(in crate::evaluate) const LINKING_OXYGEN: usize = 8;
/// Longest distance in Å of O3' from the next nucleotide's P: a bond of 1.6 Å, with room for poor structures.
pub(in crate::evaluate) const PHOSPHATE_BOND: f64 = 2.5;

/// One residue with its heavy atoms.
#[derive(Clone, Debug)]
pub(in crate::evaluate) struct Residue {
    /// Author number and insertion code.
    pub number: Number,
    /// Residue name without its chemical variants, so that equal strings mean the same residue (see [`kind`]).
    pub kind: String,
    /// Coordinates of the backbone atoms, in the order of [`BACKBONE_ATOMS`], in Å; `None` where the file has none.
    pub backbone: [Option<Point3<f64>>; BACKBONE_ATOMS.len()],
    /// Whether its records are HETATM.
    pub hetero: bool,
    /// 1-based lines of its first and last atom in the file.
    pub lines: (usize, usize),
    /// Coordinates of all heavy atoms, in Å; never empty.
    pub heavy: Vec<Point3<f64>>,
    /// Centre of a ball that holds all of `heavy`, in Å.
    pub center: Point3<f64>,
    /// Radius of that ball, in Å.
    pub radius: f64,
}

impl Residue {
    /// Whether it has an amino acid's backbone.
    pub fn is_amino_acid(&self) -> bool {
        self.backbone[..3].iter().all(Option::is_some)
    }

    /// Whether it is a nucleotide, as [`knotdock_structures::molecule::GroupKind`] has it: with P, C1', C3' and O3'.
    fn is_nucleotide(&self) -> bool {
        ["P", "C1'", "C3'", "O3'"].iter().all(|name| {
            let mut atoms = BACKBONE_ATOMS.iter().zip(&self.backbone);
            atoms.any(|(atom, place)| atom == name && place.is_some())
        })
    }

    /// The residue made of these atoms; `None` if they are no residue of a polymer.
    pub fn of(atoms: &[&Atom]) -> Option<Self> {
        let first = atoms.first()?;
        let mut backbone = BACKBONE_ATOMS.map(|name| {
            let mut atoms = atoms.iter();
            let atom = atoms.find(|atom| plain_atom_name(&atom.name) == name)?;
            Some(Point3::from(atom.position))
        });
        // The phosphate of a phosphoserine, say, is no backbone.
        if backbone[..3].iter().all(Option::is_some) {
            backbone[OF_PROTEINS..].fill(None);
        }
        let positions = atoms.iter().map(|atom| Point3::from(atom.position));
        let heavy: Vec<Point3<f64>> = positions.collect();
        let sum: nalgebra::Vector3<f64> = heavy.iter().map(|point| point.coords).sum();
        let center = Point3::from(sum / heavy.len() as f64);
        let distances = heavy.iter().map(|point| nalgebra::distance(point, &center));
        let name = standard_residue_name(first.residue_name.trim(), atoms.iter().copied());
        let residue = Self {
            number: (first.residue_number, first.insertion_code),
            kind: kind(name),
            backbone,
            hetero: first.hetero,
            lines: (
                first.line,
                atoms.last().map_or(first.line, |last| last.line),
            ),
            radius: distances.fold(0.0, f64::max),
            heavy,
            center,
        };
        (!residue.hetero || residue.is_amino_acid() || residue.is_nucleotide()).then_some(residue)
    }
}

/// The name under which residues are compared.
///
/// `name` is the standard name by its atoms or its own name ([`standard_residue_name`]). Selenomethionine counts as
/// methionine and S,S-(2-hydroxyethyl)thiocysteine as cysteine, as in DockQ 2.1.3. Other amino acids that are modified
/// after translation count as their parents (wwPDB Chemical Component Dictionary, `mon_nstd_parent_comp_id`). Names of
/// force fields count as the plain residue's, and nucleotides as their base ([`plain_residue_name`]).
pub(in crate::evaluate) fn kind(name: &str) -> String {
    let plain = match name {
        "MSE" | "FME" | "SME" => "MET",
        "CME" | "CSO" | "CSD" | "CSX" | "CSS" | "OCS" | "SMC" | "SNC" | "CAF" | "CAS" | "YCM"
        | "SEC" => "CYS",
        "SEP" | "SAC" => "SER",
        "TPO" => "THR",
        "PTR" | "TYS" | "IYR" => "TYR",
        "MLY" | "MLZ" | "M3L" | "KCX" | "ALY" | "LLP" | "LYZ" => "LYS",
        "HYP" => "PRO",
        "CGU" => "GLU",
        "PHD" | "IAS" => "ASP",
        "AGM" | "CIR" | "2MR" | "DA2" => "ARG",
        "HIC" | "NEP" | "MHS" => "HIS",
        "MEN" => "ASN",
        "MGN" => "GLN",
        other => plain_residue_name(other),
    };
    plain.to_owned()
}
