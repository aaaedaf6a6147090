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
    let found = Interface::of([&lysine(-2.9), &aspartate], 7.0);
    assert_eq!((found.pairs.len(), found.residues), (1, [1, 1]));
    assert_eq!((found.hydrogen_bonds, found.salt_bridges), (1, 1));
    assert!((found.pairs[0].distance - 2.9).abs() < 1e-9);
    assert_eq!(found.pairs[0].residues[0].number, "10");
    assert_eq!(found.pairs[0].residues[1].name, "ASP");
    let apart = Interface::of([&lysine(-4.5), &aspartate], 7.0);
    assert_eq!(
        (apart.pairs.len(), apart.hydrogen_bonds, apart.salt_bridges),
        (1, 0, 0)
    );
    let far = Interface::of([&lysine(-5.1), &aspartate], 7.0);
    assert!(far.pairs.is_empty() && far.residues == [0, 0]);
    // From behind: nearer to the carbon than to the oxygen.
    let behind = Interface::of([&aspartate, &lysine(3.4)], 7.0);
    assert_eq!((behind.hydrogen_bonds, behind.salt_bridges), (0, 1));
}

/// Two equal atoms take the same from each other, but for the points by which areas are counted.
#[test]
fn buried_surface_is_shared_alike() {
    let carbon = |chain, x| molecule(&[("CA", "GLY", chain, 1, "C", [x, 0.0, 0.0])]);
    let found = Interface::of([&carbon('A', 0.0), &carbon('B', 4.0)], 7.0);
    assert!(found.buried[0] > 1.0);
    assert!((found.buried[0] - found.buried[1]).abs() < 0.06 * found.buried[0]);
    let apart = Interface::of([&carbon('A', 0.0), &carbon('B', 9.0)], 7.0);
    assert_eq!(apart.buried, [0.0, 0.0]);
}
