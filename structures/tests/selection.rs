//! Selection of atoms: alternate locations, hydrogens, waters, additives, chains; and the warnings.

#![cfg(feature = "molecule")]

use crate::pdb_text::{ATOM, Line, names, read_bytes, read_text, text};
use knotdock_structures::Error;
use knotdock_structures::molecule::{DropKind, GroupKind, InputSpec, ReadOptions, read};

#[test]
fn alternate_locations_go_by_summed_occupancy_and_then_alphabet() {
    // Residue 1: B wins, 0.9 to 0.7, though A's first atom is the fuller. Residue 2: a tie of sums that differ in the
    // last bit in floating point (0.1 + 0.2 and 0.3 + 0.0), so A. Atoms without a location stay once.
    let lines = [
        Line::at(1, " N  ", ' ', 1.0),
        Line::at(1, " CA ", 'A', 0.6),
        Line::at(1, " CA ", 'B', 0.4),
        Line::at(1, " C  ", 'A', 0.1),
        Line::at(1, " C  ", 'B', 0.5),
        Line::at(2, " CA ", 'B', 0.1),
        Line::at(2, " CA ", 'A', 0.3),
        Line::at(2, " C  ", 'B', 0.2),
        Line::at(2, " C  ", 'A', 0.0),
    ];
    let molecule = read_text(&text(&lines)).unwrap();
    let kept: Vec<_> = molecule
        .atoms
        .iter()
        .map(|a| (a.name.as_str(), a.alternate_location))
        .collect();
    let expected = [
        ("N", None),
        ("CA", Some('B')),
        ("C", Some('B')),
        ("CA", Some('A')),
        ("C", Some('A')),
    ];
    assert_eq!(kept, expected);
    // pdbtbx copies atoms without a location into each conformer, and divides their occupancy among the copies.
    assert_eq!(molecule.atoms[0].occupancy, 1.0);
    let choices = &molecule.report.altered.alternate_locations;
    assert_eq!(choices.len(), 2);
    assert_eq!(
        (choices[0].chosen, choices[0].offered.as_str()),
        ('B', "AB")
    );
    assert_eq!(molecule.report.dropped[0].kind, DropKind::AlternateLocation);
    assert_eq!(molecule.report.dropped[0].atoms, 4);
}

#[test]
fn microheterogeneity_keeps_one_residue_name() {
    // 1EJG and others: SER and PRO at one position, each with its own location. One choice must hold for both.
    let of = |residue, alternate, occupancy| Line {
        residue,
        ..Line::at(1, " CA ", alternate, occupancy)
    };
    let molecule = read_text(&text(&[of("SER", 'A', 0.4), of("PRO", 'B', 0.6)])).unwrap();
    assert_eq!(molecule.atoms.len(), 1);
    assert_eq!(molecule.atoms[0].residue_name, "PRO");
}

#[test]
fn hydrogens_waters_and_additives_go_and_the_rest_stays() {
    let lines = [
        ATOM,
        Line::of("ATOM", " HA2", "GLY", 1, " H"),
        Line::of("ATOM", " D  ", "GLY", 1, " D"),
        Line::of("ATOM", "1HA3", "GLY", 1, "  "),
        Line::of("HETATM", " O  ", "HOH", 90, " O"),
        Line::of("HETATM", " O  ", "DOD", 91, " O"),
        Line::of("HETATM", " S  ", "SO4", 92, " S"),
        Line::of("HETATM", "ZN  ", " ZN", 93, "ZN"),
        Line::of("HETATM", "FE  ", "HEM", 94, "FE"),
        Line::of("HETATM", " NA ", "HEM", 94, " N"),
        Line::of("HETATM", " C1 ", "NAG", 95, " C"),
        Line::of("HETATM", "SE  ", "MSE", 96, "SE"),
        Line::of("ATOM", " P  ", " DG", 97, " P"),
        // Zero occupancy says that the density is poor, not that the atom is absent.
        Line {
            occupancy: 0.0,
            ..Line::of("ATOM", " O  ", "GLY", 1, " O")
        },
    ];
    let molecule = read_text(&text(&lines)).unwrap();
    assert_eq!(
        names(&molecule),
        ["CA", "ZN", "FE", "NA", "C1", "SE", "P", "O"]
    );
    let dropped: Vec<_> = molecule
        .report
        .dropped
        .iter()
        .map(|d| (d.kind, d.atoms))
        .collect();
    assert_eq!(
        dropped,
        [
            (DropKind::Hydrogen, 3),
            (DropKind::Water, 2),
            (DropKind::Additive, 1)
        ]
    );
    let groups: Vec<_> = molecule
        .report
        .groups
        .iter()
        .map(|g| (g.kind, g.name.as_str()))
        .collect();
    let expected = [
        (GroupKind::ModifiedResidue, "MSE"),
        (GroupKind::Nucleotide, "DG"),
        (GroupKind::Glycan, "NAG"),
        (GroupKind::Metal, "ZN"),
        (GroupKind::Cofactor, "HEM"),
    ];
    assert_eq!(groups, expected);
    let shown = molecule.report.to_string();
    for part in [
        "8 atoms",
        "1 ZN (metal)",
        "3 hydrogens",
        "2 water atoms",
        "additives (SO4)",
    ] {
        assert!(shown.contains(part), "{part} in:\n{shown}");
    }
}

#[test]
fn a_kept_name_is_not_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pdb");
    std::fs::write(&path, Line::of("HETATM", " S  ", "SO4", 1, " S").text()).unwrap();
    let options = ReadOptions {
        keep: vec!["SO4".to_string()],
        ..ReadOptions::default()
    };
    assert_eq!(
        read(&InputSpec::whole(&path), &options)
            .unwrap()
            .atoms
            .len(),
        1
    );
}

#[test]
fn chains_are_picked_by_case_and_blank_ones_by_an_underscore() {
    let lines = ['A', 'a', ' '].map(|chain| ATOM.in_chain(chain));
    let file = text(&lines);
    let chains = |pick: &str| -> Vec<String> {
        let molecule = read_bytes("x.pdb", file.as_bytes(), pick).unwrap();
        molecule.atoms.into_iter().map(|atom| atom.chain).collect()
    };
    assert_eq!(chains(":a"), ["a"]);
    assert_eq!(chains(":_,A"), ["A", ""]);
    assert_eq!(chains(""), ["A", "a", ""]);
    let error = read_bytes("x.pdb", file.as_bytes(), ":A,H").unwrap_err();
    assert_eq!(
        error.to_string(),
        "there is no chain 'H'; the file has A, a, _"
    );
}

#[test]
fn an_unknown_element_names_atom_and_line() {
    let line = Line::of("ATOM", " X1 ", "LIG", 1, " X");
    let error = read_text(&text(&[ATOM, line.clone()])).unwrap_err();
    assert_eq!(error.line(), Some(2));
    assert_eq!(
        error.to_string(),
        "the element of atom X1 of LIG A1 is not known"
    );
    // In a chain that is not docked it does no harm.
    let elsewhere = text(&[ATOM, line.in_chain('B')]);
    assert!(read_bytes("x.pdb", elsewhere.as_bytes(), ":A").is_ok());
}

#[test]
fn a_trace_and_missing_side_chains_are_warned_of() {
    let trace = [1, 2, 3, 4, 5].map(|number| Line::of("ATOM", " CA ", "LEU", number, " C"));
    let molecule = read_text(&text(&trace)).unwrap();
    assert_eq!(molecule.report.warnings.len(), 1);
    assert!(molecule.report.warnings[0].contains("chain A is a trace: 5 residues"));
    // LEU lacks CG, CD1 and CD2; GLY lacks nothing.
    let lines = [
        Line::of("ATOM", " CA ", "LEU", 1, " C"),
        Line::of("ATOM", " CB ", "LEU", 1, " C"),
        Line::of("ATOM", " N  ", "GLY", 2, " N"),
        Line::of("ATOM", " C  ", "GLY", 2, " C"),
    ];
    let molecule = read_text(&text(&lines)).unwrap();
    let expected = "1 residue lacks side-chain atoms (3 in all: LEU A1)";
    assert_eq!(molecule.report.warnings, [expected]);
    let nowhere: Vec<Line> = (1..=10)
        .map(|number| Line::of("ATOM", " N  ", "GLY", number, " N"))
        .collect();
    let warnings = read_text(&text(&nowhere)).unwrap().report.warnings;
    assert!(
        warnings.iter().any(|shown| shown.contains("in one place")),
        "{warnings:?}"
    );
    // The same atom twice: two chains of one name in a file put together by hand.
    let warnings = read_text(&text(&[ATOM, ATOM])).unwrap().report.warnings;
    assert!(warnings[0].starts_with("1 atom repeats"), "{warnings:?}");
}

/// Residues 1 to 9 of chain A, 1 to 3 of chain B, spaced by a bond's length, and a zinc numbered 301 in chain A.
fn two_chains() -> String {
    let residue = |chain: char, number: i64| {
        let at = |name: &'static str, element: &'static str, x: f64| Line {
            name,
            chain,
            number,
            element,
            x: 3.8 * number as f64 + x + if chain == 'B' { 100.0 } else { 0.0 },
            ..ATOM
        };
        [
            at(" N  ", " N", 0.0),
            at(" CA ", " C", 1.4),
            at(" C  ", " C", 2.5),
            at(" O  ", " O", 2.9),
        ]
    };
    let mut lines: Vec<Line> = (1..10).flat_map(|number| residue('A', number)).collect();
    lines.extend((1..4).flat_map(|number| residue('B', number)));
    lines.push(Line {
        x: 300.0,
        ..Line::of("HETATM", "ZN  ", " ZN", 301, "ZN")
    });
    text(&lines)
}

/// Requested by users: a domain of a chain is docked without editing the file.
#[test]
fn residues_are_picked_by_their_numbers() {
    let picked = |selection: &str| {
        let molecule = read_bytes("x.pdb", two_chains().as_bytes(), selection)?;
        let mut residues: Vec<(String, i64)> = Vec::new();
        for atom in &molecule.atoms {
            let residue = (atom.chain.clone(), atom.residue_number);
            if residues.last() != Some(&residue) {
                residues.push(residue);
            }
        }
        let names = residues
            .iter()
            .map(|(chain, number)| format!("{chain}{number}"));
        Ok::<_, Error>((names.collect::<Vec<_>>().join(" "), molecule))
    };
    for (selection, expected) in [
        (":A:1-3", "A1 A2 A3"),
        (":A:1-2,B", "A1 A2 B1 B2 B3"),
        (":A:2,4,6-7", "A2 A4 A6 A7"),
        (":B:3,A:9", "A9 B3"),
        (":A:301,B:1-1", "B1 A301"),
        (":B,B:1", "B1 B2 B3"),
    ] {
        assert_eq!(picked(selection).unwrap().0, expected, "{selection}");
    }
    let (_, molecule) = picked(":A:1-3").unwrap();
    let dropped = &molecule.report.dropped;
    let of_kind = |kind: DropKind| {
        dropped
            .iter()
            .find(|one| one.kind == kind)
            .map(|one| one.atoms)
    };
    assert_eq!(of_kind(DropKind::OtherResidue), Some(25));
    assert_eq!(of_kind(DropKind::Chain), Some(12));
    // The end that the cut made stands for a bond, and has no charge; the chain's own has.
    assert_eq!(molecule.labels(7.0).report.termini, [1, 0]);
    assert_eq!(
        picked(":A:4-6").unwrap().1.labels(7.0).report.termini,
        [0, 0]
    );
    assert_eq!(picked(":B").unwrap().1.labels(7.0).report.termini, [1, 1]);
    let two = picked(":A:1-3,6-9").unwrap().1.labels(7.0).report;
    assert_eq!((two.termini, two.gaps), ([1, 1], 0));

    let refused = |selection: &str| picked(selection).map(|_| ()).unwrap_err();
    let error = refused(":A:400-500");
    assert_eq!(
        error.to_string(),
        "there is no residue A:400-500; chain A of the file has 1 to 301"
    );
    let error = refused(":A:1-3,20");
    assert!(
        error.to_string().contains("there is no residue A:20;"),
        "{error}"
    );
    assert!(refused(":K:1").message().contains("no chain 'K:1'"));
    assert!(refused(":A,5").message().contains("no chain '5'"));
    assert!(
        refused(":A:x")
            .message()
            .contains("names no chain and no residues")
    );
}

/// Chains without a name are `_`, and names of several letters are distinguished from numbers.
#[test]
fn residues_of_blank_and_long_chain_names_are_picked() {
    let blank = two_chains().replace(" A ", "   ");
    let molecule = read_bytes("x.pdb", blank.as_bytes(), ":_:1-2").unwrap();
    assert_eq!(molecule.atoms.len(), 8);
    let cif = "data_x\nloop_\n_atom_site.label_atom_id\n_atom_site.label_comp_id\n_atom_site.type_symbol\n\
        _atom_site.auth_asym_id\n\
        _atom_site.label_asym_id\n_atom_site.auth_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n\
        CA ALA C AA A 5 0 0 0\nCA ALA C AA A 6 4 0 0\nCA ALA C 6 B 1 9 0 0\n";
    let of = |selection: &str| {
        let molecule = read_bytes("x.cif", cif.as_bytes(), selection).unwrap();
        let atoms = molecule.atoms.iter();
        atoms.map(|atom| atom.position[0]).collect::<Vec<f64>>()
    };
    assert_eq!(of(":AA:5-6"), [0.0, 4.0]);
    // 6 is a chain here.
    assert_eq!(of(":AA:5,6"), [0.0, 9.0]);
    assert_eq!(of(":AA:5,AA:6"), [0.0, 4.0]);
}
