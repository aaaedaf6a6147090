use super::*;
use knotdock_structures::molecule::{InputSpec, ReadOptions, read_bytes};

/// An atom: name, residue, chain, number, element and x, y, z.
type AtomRow = (
    &'static str,
    &'static str,
    char,
    i32,
    &'static str,
    [f64; 3],
);

fn molecule(atoms: &[AtomRow]) -> Molecule {
    let line = |&(name, residue, chain, number, element, [x, y, z]): &AtomRow| {
        format!(
            "ATOM      1  {name:<3} {residue} {chain}{number:>4}    {x:8.3}{y:8.3}{z:8.3}  1.00 10.00          {element:>2}\n"
        )
    };
    let text: String = atoms.iter().map(line).collect();
    let options = ReadOptions::default();
    read_bytes(&InputSpec::whole("x.pdb"), text.into_bytes(), &options).unwrap()
}

/// Lysine's amine 2.9 Å from a carboxylate: a contact, a bond and a bridge. The same behind the carbon is no bond, and
/// at 4.5 Å it is a contact alone.
#[test]
fn a_lysine_and_an_aspartate_hold_together() {
    let lysine = |x: f64| {
        molecule(&[
            ("CE", "LYS", 'A', 10, "C", [x - 1.5, 0.0, 0.0]),
            ("NZ", "LYS", 'A', 10, "N", [x, 0.0, 0.0]),
        ])
    };
    let aspartate = molecule(&[
        ("CG", "ASP", 'B', 7, "C", [1.25, 0.0, 0.0]),
        ("OD1", "ASP", 'B', 7, "O", [0.0, 0.0, 0.0]),
        ("OD2", "ASP", 'B', 7, "O", [1.25, 0.0, 1.25]),
    ]);
    let found = Interface::of([&lysine(-2.9), &aspartate], 7.0).unwrap();
    assert_eq!((found.pairs.len(), found.residues), (1, [1, 1]));
    assert_eq!((found.hydrogen_bonds, found.salt_bridges), (1, 1));
    assert!((found.pairs[0].distance - 2.9).abs() < 1e-9);
    assert!((found.pairs[0].hydrogen_bond_distance.unwrap() - 2.9).abs() < 1e-9);
    assert_eq!(found.pairs[0].residues[0].number, "10");
    assert_eq!(found.pairs[0].residues[1].name, "ASP");
    let apart = Interface::of([&lysine(-4.5), &aspartate], 7.0).unwrap();
    assert_eq!(
        (apart.pairs.len(), apart.hydrogen_bonds, apart.salt_bridges),
        (1, 0, 0)
    );
    let far = Interface::of([&lysine(-5.1), &aspartate], 7.0).unwrap();
    assert!(far.pairs.is_empty() && far.residues == [0, 0]);
    // From behind: nearer to the carbon than to the oxygen.
    let beyond = molecule(&[
        ("CE", "LYS", 'A', 10, "C", [5.3, 0.0, 0.0]),
        ("NZ", "LYS", 'A', 10, "N", [3.8, 0.0, 0.0]),
    ]);
    let behind = Interface::of([&aspartate, &beyond], 7.0).unwrap();
    assert_eq!((behind.hydrogen_bonds, behind.salt_bridges), (0, 1));
}

/// A bond between atoms 1.4 Å apart was counted; they overlap.
#[test]
fn clashes_are_no_bonds() {
    let aspartate = molecule(&[
        ("CG", "ASP", 'B', 7, "C", [1.25, 0.0, 0.0]),
        ("OD1", "ASP", 'B', 7, "O", [0.0, 0.0, 0.0]),
    ]);
    for (x, bonds) in [(-1.4, 0), (-2.1, 0), (-2.3, 1)] {
        let lysine = molecule(&[
            ("CE", "LYS", 'A', 10, "C", [x - 1.5, 0.0, 0.0]),
            ("NZ", "LYS", 'A', 10, "N", [x, 0.0, 0.0]),
        ]);
        let found = Interface::of([&lysine, &aspartate], 7.0).unwrap();
        assert_eq!(
            (found.hydrogen_bonds, found.salt_bridges),
            (bonds, 1),
            "{x}"
        );
        let distance = found.pairs[0].hydrogen_bond_distance;
        assert_eq!(distance.is_some(), bonds == 1);
    }
}

/// ARG beside O6 of a guanine was a salt bridge, since the nucleotide has a charge: its phosphate has. So it was with
/// the ester oxygen of phosphoserine, the sugar, and the oxygens of a terminus under CHARMM's names.
#[test]
fn salt_bridges_are_of_charged_atoms() {
    let arginine = molecule(&[
        ("CZ", "ARG", 'A', 10, "C", [-4.3, 0.0, 0.0]),
        ("NH1", "ARG", 'A', 10, "N", [-3.0, 0.0, 0.0]),
    ]);
    let is_bridge = |residue, name| {
        let atoms = [
            ("P", residue, 'B', 7, "P", [9.0, 0.0, 0.0]),
            (name, residue, 'B', 7, "O", [0.0, 0.0, 0.0]),
        ];
        Interface::of([&arginine, &molecule(&atoms)], 7.0)
            .unwrap()
            .salt_bridges
            == 1
    };
    for (residue, charged, others) in [
        (
            " DG",
            &["OP1", "OP2"] as &[&str],
            &["O6", "O4'", "O5'"] as &[&str],
        ),
        ("  A", &["O1P"], &["O2'"]),
        ("ASP", &["OD1", "OD2"], &["O", "OT1"]),
    ] {
        assert!(
            charged.iter().all(|name| is_bridge(residue, name)),
            "{residue}"
        );
        assert!(
            !others.iter().any(|name| is_bridge(residue, name)),
            "{residue}"
        );
    }
    let modified = |residue, name| {
        let atom = |name, element, at| (name, residue, 'B', 7, element, at);
        let atoms = [
            atom("N", "N", [20.0, 0.0, 0.0]),
            atom("CA", "C", [21.4, 0.0, 0.0]),
            atom("C", "C", [22.8, 0.0, 0.0]),
            atom(name, "O", [0.0, 0.0, 0.0]),
        ];
        Interface::of([&arginine, &molecule(&atoms)], 7.0)
            .unwrap()
            .salt_bridges
            == 1
    };
    for (residue, name, expected) in [
        ("SEP", "O1P", true),
        ("SEP", "OG", false),
        ("TPO", "OG1", false),
        ("PTR", "O3P", true),
        ("PTR", "OH", false),
        ("TYS", "O2", true),
    ] {
        assert_eq!(modified(residue, name), expected, "{residue} {name}");
    }
}

/// The last residue's carboxylate under CHARMM's names took the charge of its lysine away.
#[test]
fn termini_leave_side_chains_their_charge() {
    let lysine = molecule(&[
        ("N", "LYS", 'A', 10, "N", [-9.0, 0.0, 0.0]),
        ("CA", "LYS", 'A', 10, "C", [-9.0, 1.4, 0.0]),
        ("C", "LYS", 'A', 10, "C", [-9.0, 2.9, 0.0]),
        ("OT1", "LYS", 'A', 10, "O", [-9.0, 3.5, 1.0]),
        ("OT2", "LYS", 'A', 10, "O", [-9.0, 3.5, -1.0]),
        ("CE", "LYS", 'A', 10, "C", [-4.4, 0.0, 0.0]),
        ("NZ", "LYS", 'A', 10, "N", [-2.9, 0.0, 0.0]),
    ]);
    let glutamate = molecule(&[("OE1", "GLU", 'B', 7, "O", [0.0, 0.0, 0.0])]);
    let found = Interface::of([&lysine, &glutamate], 7.0).unwrap();
    assert_eq!(found.salt_bridges, 1);
}

/// Two equal atoms take the same from each other, but for the points by which areas are counted.
#[test]
fn buried_surface_is_shared_alike() {
    let carbon = |chain, x| molecule(&[("CA", "GLY", chain, 1, "C", [x, 0.0, 0.0])]);
    let found = Interface::of([&carbon('A', 0.0), &carbon('B', 4.0)], 7.0).unwrap();
    assert!(found.buried[0] > 1.0);
    assert!((found.buried[0] - found.buried[1]).abs() < 0.06 * found.buried[0]);
    let apart = Interface::of([&carbon('A', 0.0), &carbon('B', 9.0)], 7.0).unwrap();
    assert_eq!(apart.buried, [0.0, 0.0]);
}

/// In any pose, near and far, the contacts are those of all pairs of atoms.
#[test]
fn contacts_of_poses_are_those_of_all_pairs() {
    let block = |chain, count: i32| {
        let places = (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
        let atoms: Vec<AtomRow> = places
            .map(|(i, j)| {
                let at = [
                    3.9 * f64::from(i),
                    4.1 * f64::from(j),
                    f64::from((i * j) % 5),
                ];
                ("CA", "GLY", chain, 20 * i + j, "C", at)
            })
            .collect();
        molecule(&atoms)
    };
    let (fixed, moved) = (block('A', 9), block('B', 4));
    let finder = ContactFinder::new([&fixed, &moved], 7.0);
    let mut touching = 0;
    for step in 0..200 {
        let turn = f64::from(step);
        let quaternion = [turn.cos(), 0.6 * turn.sin(), 0.8 * turn.sin(), 0.0];
        let translation = [
            0.4 * turn - 20.0,
            17.0 * (0.1 * turn).sin(),
            0.2 * turn - 25.0,
        ];
        let pose = Pose::from_parts(quaternion, translation);
        let mut expected = Vec::new();
        for (i, one) in fixed.atoms.iter().enumerate() {
            for (j, other) in moved.atoms.iter().enumerate() {
                let at = pose.apply(other.position);
                let square: f64 = (0..3)
                    .map(|axis| (at[axis] - one.position[axis]).powi(2))
                    .sum();
                if square.sqrt() < CONTACT {
                    expected.push(([i, j], square.sqrt()));
                }
            }
        }
        let found = finder.contacts(&[pose]);
        assert_eq!(found.len(), expected.len(), "{step}");
        for (contact, (residues, distance)) in found.iter().zip(&expected) {
            assert_eq!(contact.residues, *residues);
            assert!((contact.distance - distance).abs() < 1e-9);
        }
        touching += usize::from(!found.is_empty());
    }
    assert!((50..200).contains(&touching), "{touching}");
}
