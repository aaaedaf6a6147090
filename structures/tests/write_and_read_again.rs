//! A written molecule is read again the same, and values that a format cannot hold are not squeezed into it.

#![cfg(feature = "molecule")]

use std::path::Path;

use knotdock_structures::molecule::{
    Atom, Format, InputSpec, Molecule, Partner, ReadOptions, complex_format, read, write_complex,
    write_molecule,
};
use proptest::prelude::*;

fn atom(chain: &str, number: i64, x: f64) -> Atom {
    Atom {
        name: "CA".to_string(),
        residue_name: "GLY".to_string(),
        chain: chain.to_string(),
        residue_number: number,
        insertion_code: None,
        alternate_location: None,
        element: "C".to_string(),
        position: [x, 1.0, 2.0],
        occupancy: 0.5,
        b_factor: 12.34,
        hetero: false,
        radius: 1.88,
        line: 0,
    }
}

fn molecule(atoms: Vec<Atom>) -> Molecule {
    Molecule::new(atoms, Format::Pdb)
}

fn example(name: &str) -> Molecule {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name);
    read(&InputSpec::whole(path), &ReadOptions::default()).unwrap()
}

fn read_again(text: &[u8], format: Format) -> Molecule {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x").with_extension(format.extension());
    std::fs::write(&path, text).unwrap();
    read(&InputSpec::whole(path), &ReadOptions::default()).unwrap()
}

/// Whether two atoms are the same but for the last decimal of coordinates, occupancy and temperature factor.
fn assert_same(written: &Atom, found: &Atom) {
    let key = |a: &Atom| {
        (
            a.name.clone(),
            a.residue_name.clone(),
            a.residue_number,
            a.insertion_code,
            a.element.clone(),
            a.hetero,
        )
    };
    assert_eq!(key(written), key(found));
    for axis in 0..3 {
        assert!((written.position[axis] - found.position[axis]).abs() < 5.01e-4);
    }
    assert!((written.occupancy - found.occupancy).abs() < 5.01e-3);
    assert!((written.b_factor - found.b_factor).abs() < 5.01e-3);
}

#[test]
fn a_complex_comes_back_under_unique_chain_names() {
    let receptor = example("1ppe_receptor_unbound.pdb");
    // The same chain on both sides: the ligand's copy gets another name.
    let mut ligand = example("1ppe_ligand_unbound.pdb").map_positions(|[x, y, z]| [x + 5.0, y, -z]);
    ligand
        .atoms
        .iter_mut()
        .for_each(|atom| atom.chain = "A".to_string());
    for format in [Format::Pdb, Format::Mmcif] {
        let mut text = Vec::new();
        let map = write_complex(
            &mut text,
            format,
            &[&receptor, &ligand],
            &["pose 1".to_string()],
        )
        .unwrap();
        assert_eq!(map.written(Partner::Receptor, "A"), "A");
        assert_eq!(map.written(Partner::Ligand, "A"), "B");
        let found = read_again(&text, format);
        let chains: Vec<_> = found
            .report
            .chains
            .iter()
            .map(|c| (c.name.as_str(), c.residues))
            .collect();
        assert_eq!(chains, [("A", 223), ("B", 29)]);
        assert_eq!(found.atoms.len(), 1628 + 221);
        for (written, found) in receptor.atoms.iter().chain(&ligand.atoms).zip(&found.atoms) {
            assert_same(written, found);
        }
        let text = String::from_utf8(text).unwrap();
        assert!(text.contains("chain B is ligand chain A"));
        // Chymotrypsinogen numbering has residue 184A before 184.
        assert!(
            found
                .atoms
                .iter()
                .any(|a| (a.residue_number, a.insertion_code) == (184, Some('A')))
        );
    }
}

#[test]
fn pdb_columns_are_those_of_the_format() {
    let mut zinc = atom("A", -3, -12.3456);
    (zinc.name, zinc.residue_name, zinc.element) = ("ZN".into(), "ZN".into(), "Zn".into());
    zinc.hetero = true;
    let mut inserted = atom("A", 10, 1.0);
    inserted.insertion_code = Some('B');
    let mut text = Vec::new();
    write_molecule(&mut text, Format::Pdb, &molecule(vec![inserted, zinc]), &[]).unwrap();
    let text = String::from_utf8(text).unwrap();
    let expected = [
        "ATOM      1  CA  GLY A  10B      1.000   1.000   2.000  0.50 12.34           C  ",
        "TER       2      GLY A  10B                                                     ",
        "HETATM    3 ZN    ZN A  -3     -12.346   1.000   2.000  0.50 12.34          ZN  ",
        "END                                                                             ",
    ];
    assert_eq!(text.lines().collect::<Vec<_>>(), expected);
}

#[test]
fn ter_ends_the_polymer_and_not_the_cofactors() {
    // A modified residue at the end of a chain belongs to it; a free amino acid after the cofactor does not.
    let mut lines = vec![atom("A", 1, 0.0)];
    for name in ["N", "CA", "C"] {
        let mut modified = atom("A", 2, 1.0);
        (modified.name, modified.residue_name, modified.hetero) = (name.into(), "SEP".into(), true);
        modified.element = name[..1].to_string();
        lines.push(modified);
    }
    let mut cofactor = atom("A", 90, 2.0);
    (cofactor.name, cofactor.residue_name, cofactor.hetero) = ("C1".into(), "LIG".into(), true);
    lines.push(cofactor);
    let mut free = atom("A", 91, 3.0);
    free.hetero = true;
    lines.push(free);
    lines.push(atom("B", 1, 4.0));
    let mut text = Vec::new();
    write_molecule(&mut text, Format::Pdb, &molecule(lines), &[]).unwrap();
    let text = String::from_utf8(text).unwrap();
    let ends: Vec<usize> = text
        .lines()
        .enumerate()
        .filter(|(_, l)| l.starts_with("TER"))
        .map(|(i, _)| i)
        .collect();
    assert_eq!(ends, [4, 8], "{text}");
}

#[test]
fn what_does_not_fit_pdb_becomes_mmcif() {
    let one = molecule(vec![atom("A", 1, 0.0)]);
    let with = |change: &dyn Fn(&mut Atom)| {
        let mut changed = atom("A", 1, 0.0);
        change(&mut changed);
        molecule(vec![changed])
    };
    assert_eq!(complex_format(&[&one, &one]), Format::Pdb);
    let unfits = [
        ("1e6 Å", with(&|a| a.position[1] = 1e6)),
        ("-1000 Å", with(&|a| a.position[2] = -1000.0)),
        (
            "rounds up to 10000.000",
            with(&|a| a.position[0] = 9999.9996),
        ),
        ("residue 10,000", with(&|a| a.residue_number = 10_000)),
        (
            "long residue name",
            with(&|a| a.residue_name = "A1CDE".into()),
        ),
        ("B of 1,000", with(&|a| a.b_factor = 1000.0)),
    ];
    for (what, unfit) in &unfits {
        assert_eq!(complex_format(&[&one, unfit]), Format::Mmcif, "{what}");
        let refused = write_complex(&mut Vec::new(), Format::Pdb, &[&one, unfit], &[]);
        assert!(
            refused
                .unwrap_err()
                .to_string()
                .contains("does not fit the PDB format"),
            "{what}"
        );
        let mut text = Vec::new();
        write_complex(&mut text, Format::Mmcif, &[&one, unfit], &[]).unwrap();
        assert_same(&unfit.atoms[0], &read_again(&text, Format::Mmcif).atoms[1]);
    }
    let mut mmcif = one.clone();
    mmcif.format = Format::Mmcif;
    assert_eq!(complex_format(&[&mmcif, &one]), Format::Mmcif);
    let broken = with(&|a| a.position[0] = f64::NAN);
    let refused = write_complex(&mut Vec::new(), Format::Mmcif, &[&one, &broken], &[]);
    assert!(refused.unwrap_err().to_string().contains("not finite"));
}

#[test]
fn the_limits_of_pdb_are_exact() {
    let chains = |count: usize| {
        molecule(
            (0..count)
                .map(|index| atom(&format!("c{index}"), 1, 0.0))
                .collect::<Vec<_>>(),
        )
    };
    assert_eq!(complex_format(&[&chains(31), &chains(31)]), Format::Pdb);
    assert_eq!(complex_format(&[&chains(31), &chains(32)]), Format::Mmcif);
    let mut text = Vec::new();
    let map = write_complex(&mut text, Format::Pdb, &[&chains(31), &chains(31)], &[]).unwrap();
    let mut names: Vec<_> = map
        .chains
        .iter()
        .map(|chain| chain.written.clone())
        .collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), 62);
    assert!(names.iter().all(|name| name.len() == 1));
    // In mmCIF they keep their names, and only the second 31 change.
    let map = write_complex(
        &mut Vec::new(),
        Format::Mmcif,
        &[&chains(31), &chains(31)],
        &[],
    )
    .unwrap();
    assert_eq!(map.written(Partner::Receptor, "c7"), "c7");
    assert_ne!(map.written(Partner::Ligand, "c7"), "c7");

    let atoms = |count: usize| {
        molecule(
            (0..count)
                .map(|index| atom("A", index as i64 / 20, 0.0))
                .collect(),
        )
    };
    let one = molecule(vec![atom("B", 1, 0.0)]);
    assert_eq!(complex_format(&[&atoms(99_998), &one]), Format::Pdb);
    assert_eq!(complex_format(&[&atoms(99_999), &one]), Format::Mmcif);
    // 99,999 atoms leave no serial number for TER.
    let mut text = Vec::new();
    write_complex(&mut text, Format::Pdb, &[&atoms(99_998), &one], &[]).unwrap();
    let text = String::from_utf8(text).unwrap();
    assert!(text.lines().all(|line| line.len() == 80));
    assert!(text.lines().any(|line| line.starts_with("ATOM  99999")));
}

/// Every copy of a ring has its own chain, whatever chains its molecule has, and the map names each.
#[test]
fn copies_of_a_ring_have_chains_of_their_own() {
    let one = molecule(vec![atom("B", 1, 0.0), atom("A", 1, 1.0)]);
    let mut text = Vec::new();
    let map = write_complex(&mut text, Format::Pdb, &[&one, &one, &one, &one], &[]).unwrap();
    let third = Partner::Copy(3);
    let names = [
        (Partner::Receptor, "B", "B"),
        (Partner::Receptor, "A", "A"),
        (Partner::Ligand, "B", "C"),
        (Partner::Ligand, "A", "D"),
        (third, "B", "E"),
        (third, "A", "F"),
        (Partner::Copy(4), "B", "G"),
        (Partner::Copy(4), "A", "H"),
    ];
    for (partner, original, written) in names {
        assert_eq!(map.written(partner, original), written);
    }
    let found = read_again(&text, Format::Pdb);
    let chains: Vec<&str> = found.atoms.iter().map(|a| a.chain.as_str()).collect();
    assert_eq!(chains, names.map(|(_, _, written)| written));
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("chain F is copy 3 chain A"));
}

#[test]
fn names_that_are_free_stay_and_blank_ones_are_filled() {
    let receptor = molecule(vec![atom("B", 1, 0.0), atom("", 1, 1.0)]);
    let ligand = molecule(vec![atom("A", 1, 2.0), atom("B", 1, 3.0)]);
    let map = write_complex(&mut Vec::new(), Format::Pdb, &[&receptor, &ligand], &[]).unwrap();
    let names: Vec<_> = map
        .chains
        .iter()
        .map(|c| (c.partner, c.original.as_str(), c.written.as_str()))
        .collect();
    let expected = [
        (Partner::Receptor, "B", "B"),
        (Partner::Receptor, "", "C"),
        (Partner::Ligand, "A", "A"),
        (Partner::Ligand, "B", "D"),
    ];
    assert_eq!(names, expected);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_atom_comes_back(
        position in prop::array::uniform3(-2e6..2e6_f64),
        scale in prop::sample::select(vec![1e-6, 1e-3, 1.0]),
        number in -2000..20_000_i64,
        insertion in prop::option::of(prop::char::range('A', 'Z')),
        occupancy in 0.0..=1.0_f64,
        b_factor in -10.0..2000.0_f64,
        chain in "[A-Za-z0-9]{0,3}",
        hetero: bool,
    ) {
        let mut one = atom(&chain, number, 0.0);
        one.position = position.map(|x| x * scale);
        (one.insertion_code, one.occupancy, one.b_factor, one.hetero) = (insertion, occupancy, b_factor, hetero);
        let receptor = molecule(vec![one]);
        let format = complex_format(&[&receptor, &receptor]);
        let mut text = Vec::new();
        let map = write_complex(&mut text, format, &[&receptor, &receptor], &[]).unwrap();
        let found = read_again(&text, format);
        prop_assert_eq!(found.atoms.len(), 2);
        assert_same(&receptor.atoms[0], &found.atoms[0]);
        prop_assert_eq!(&found.atoms[1].chain, map.written(Partner::Ligand, &chain));
    }
}
