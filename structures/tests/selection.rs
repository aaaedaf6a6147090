//! What is kept and what is dropped: alternate locations, hydrogens, waters, additives, chains; and what is warned of.

#![cfg(feature = "molecule")]

mod pdb_text;

use knotdock_structures::molecule::{DropKind, GroupKind, InputSpec, ReadError, ReadOptions, read};
use pdb_text::{ATOM, Line, names, read_bytes, read_text, text};

#[test]
fn alternate_locations_go_by_summed_occupancy_and_then_alphabet() {
    // Residue 1: B wins, 0.9 to 0.7, though A's first atom is the fuller. Residue 2: a tie of sums that differ in the last
    // bit in floating point (0.1 + 0.2 and 0.3 + 0.0), so A. Atoms without a location stay once.
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
    assert!(matches!(error, ReadError::UnknownElement { .. }));
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
        warnings.iter().any(|told| told.contains("in one place")),
        "{warnings:?}"
    );
    // The same atom twice: two chains of one name in a file put together by hand.
    let warnings = read_text(&text(&[ATOM, ATOM])).unwrap().report.warnings;
    assert!(warnings[0].starts_with("1 atom repeats"), "{warnings:?}");
}
