//! Buffer and cryo additives: residue names that are dropped, and reported, on reading.
//!
//! These come from the crystallisation drop, not from the molecule. Names and formulas are those of the wwPDB Chemical
//! Component Dictionary. That such ligands are artefacts of the experiment is argued in Yang, Roy & Zhang, "BioLiP",
//! Nucleic Acids Res. 41 (2013) D1096-D1103. Its longer list also holds compounds that may well matter to the shape
//! (lipids, detergents, amino acids, sugars), so those are kept here. Metal ions are kept too.

/// Residue names by kind of compound.
const ADDITIVES: [(&str, &[&str]); 7] = [
    (
        "salts",
        &[
            "SO4", "PO4", "PI", "2HP", "NO3", "SCN", "AZI", "CL", "BR", "IOD", "NH4", "ACT", "ACY",
            "FMT", "MLI", "MLA", "CIT", "FLC", "TLA", "TAR", "CAC", "CAD",
        ],
    ),
    (
        "polyols and alcohols",
        &[
            "GOL", "EDO", "EGL", "PGO", "PGR", "PDO", "BU1", "BU2", "BU3", "HEZ", "MPD", "MRD",
            "MOH", "EOH", "POL", "IPA", "IOH", "TBU",
        ],
    ),
    ("solvents", &["DMS", "DMF", "ACN", "CCN", "DIO"]),
    (
        "polyethylene glycols and their ethers",
        &[
            "PEG", "PGE", "PG4", "1PE", "P6G", "2PE", "7PE", "12P", "15P", "P33", "PE3", "PE4",
            "PE5", "PE7", "PE8", "PEU", "XPE", "P4G", "PG0", "PG5", "PG6", "1PG", "ETE", "M2M",
            "MXE",
        ],
    ),
    (
        "buffers",
        &[
            "TRS", "BTB", "B3P", "TAM", "EPE", "MES", "MPO", "PIN", "NHE", "CXS", "BCN", "IMD",
        ],
    ),
    (
        "reducing agents and denaturants",
        &["BME", "DTT", "DTU", "TCE", "GAI", "URE"],
    ),
    // A blob of density that the depositors could not name; it has no element either.
    ("unknown atoms or ions", &["UNX"]),
];

pub(crate) fn is_additive(residue_name: &str) -> bool {
    ADDITIVES
        .iter()
        .any(|(_, names)| names.contains(&residue_name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::chemistry::{is_amino_acid, is_nucleotide};

    #[test]
    fn nothing_that_makes_a_molecule_is_an_additive() {
        for name in ADDITIVES.iter().flat_map(|(_, names)| *names) {
            assert!(!is_amino_acid(name) && !is_nucleotide(name), "{name}");
        }
        for name in ["HEM", "ATP", "NAG", "ZN", "NA", "MSE", "SEP", "FAD"] {
            assert!(!is_additive(name), "{name}");
        }
    }
}
