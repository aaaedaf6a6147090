//! Small made-up proteins: ideal alpha helices of alanine, enough for residues, chains, contacts and a score.

use std::fmt::Write;

/// A helix: chain name, first residue number, length in residues, and where its axis (along z) crosses z = 0, in Å.
pub struct Helix {
    pub chain: char,
    pub first: usize,
    pub residues: usize,
    pub axis: [f64; 2],
}

/// Cylinder coordinates (radius in Å, angle in degrees, height in Å) of a residue's atoms about the helix axis, rounded
/// from Arnott & Dover, J. Mol. Biol. 30 (1967) 209. They only have to look like a helix.
const ATOMS: [(&str, f64, f64, f64); 5] = [
    ("N", 1.55, -27.8, -0.87),
    ("CA", 2.29, 0.0, 0.0),
    ("C", 1.69, 26.4, 1.07),
    ("O", 2.02, 24.0, 2.28),
    ("CB", 3.30, -19.2, -0.60),
];

/// PDB text of helices; every residue turns by 100 degrees and rises by 1.5 Å.
pub fn pdb(helices: &[Helix]) -> String {
    let mut text = String::new();
    let mut serial = 0;
    for helix in helices {
        for index in 0..helix.residues {
            for (name, radius, angle, height) in ATOMS {
                serial += 1;
                let turn = (angle + 100.0 * index as f64).to_radians();
                let [x, y] = helix.axis;
                writeln!(
                    text,
                    "ATOM  {serial:>5}  {name:<3} ALA {}{:>4}    {:>8.3}{:>8.3}{:>8.3}  1.00 10.00          {:>2}",
                    helix.chain,
                    helix.first + index,
                    x + radius * turn.cos(),
                    y + radius * turn.sin(),
                    height + 1.5 * index as f64,
                    &name[..1],
                )
                .unwrap();
            }
        }
    }
    text.push_str("END\n");
    text
}

/// Two helices side by side, chains A and B.
pub fn receptor() -> String {
    pdb(&[
        Helix {
            chain: 'A',
            first: 1,
            residues: 16,
            axis: [0.0, 0.0],
        },
        Helix {
            chain: 'B',
            first: 101,
            residues: 14,
            axis: [9.5, 0.0],
        },
    ])
}

/// One helix in the groove of [`receptor`], chain A.
pub fn ligand() -> String {
    pdb(&[Helix {
        chain: 'A',
        first: 1,
        residues: 12,
        axis: [4.75, 8.2],
    }])
}
