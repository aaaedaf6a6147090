//! Test data that unit tests of several modules share.

use crate::molecule::{Atom, Format, InputSpec, Molecule, ReadOptions, read};

/// A box of these half sides about the origin.
pub fn cuboid(half: [f64; 3]) -> crate::mesh::Solid {
    cuboid_between(half.map(|side| -side), half)
}

/// A box from its lowest to its highest corner.
#[cfg(feature = "mesh")]
pub fn cuboid_between(low: [f64; 3], high: [f64; 3]) -> crate::mesh::Solid {
    let positions: Vec<[f64; 3]> = (0..8)
        .map(|i| {
            [0, 1, 2].map(|axis| {
                if i >> axis & 1 == 1 {
                    high[axis]
                } else {
                    low[axis]
                }
            })
        })
        .collect();
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles: Vec<[u32; 3]> = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    let (mesh, _) = crate::mesh::from_triangles(&positions, &triangles).unwrap();
    crate::mesh::Solid::new(&mesh).unwrap()
}

/// A side of the example pair, `receptor` or `ligand`: trypsin or its inhibitor, unbound.
pub fn example(side: &str) -> Molecule {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/");
    let file = format!("{folder}1ppe_{side}_unbound.pdb");
    read(&InputSpec::whole(file), &ReadOptions::default()).unwrap()
}

/// A molecule without some residues, by their places in it, and the atoms of these.
pub fn without(molecule: &Molecule, left_out: std::ops::Range<usize>) -> (Molecule, Vec<Atom>) {
    let key = |atom: &Atom| (atom.chain.clone(), atom.residue_number, atom.insertion_code);
    let runs = molecule.atoms.chunk_by(|a, b| key(a) == key(b));
    let (mut kept, mut taken) = (Vec::new(), Vec::new());
    for (place, run) in runs.enumerate() {
        let to = if left_out.contains(&place) {
            &mut taken
        } else {
            &mut kept
        };
        to.extend_from_slice(run);
    }
    (Molecule::new(kept, Format::Pdb), taken)
}

/// A molecule with an amide at its last C.
pub fn capped(mut molecule: Molecule) -> Molecule {
    let last = molecule
        .atoms
        .iter()
        .rfind(|atom| atom.name == "C")
        .unwrap();
    let cap = Atom {
        name: "N".to_owned(),
        residue_name: "NH2".to_owned(),
        residue_number: 900,
        element: "N".to_owned(),
        position: [last.position[0] + 1.3, last.position[1], last.position[2]],
        hetero: true,
        ..last.clone()
    };
    molecule.atoms.push(cap);
    molecule
}
