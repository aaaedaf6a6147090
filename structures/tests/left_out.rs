//! What is left out of a molecule whatever the other options say: records that are no atoms, and residues that are
//! named.

#![cfg(feature = "molecule")]

use crate::pdb_text::{Line, names, text};
use knotdock_structures::Error;
use knotdock_structures::molecule::{
    DropKind, Dropped, InputSpec, Molecule, ReadOptions, Waters, read,
};

fn read_by(lines: &[Line], options: &ReadOptions) -> Result<Molecule, Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pdb");
    std::fs::write(&path, text(lines)).unwrap();
    read(&InputSpec::whole(path), options)
}

/// An arginine, spread along x.
fn arginine() -> Vec<Line> {
    [
        (" N  ", " N"),
        (" CA ", " C"),
        (" C  ", " C"),
        (" O  ", " O"),
        (" CB ", " C"),
        (" CG ", " C"),
        (" CD ", " C"),
        (" NE ", " N"),
        (" CZ ", " C"),
        (" NH1", " N"),
        (" NH2", " N"),
    ]
    .into_iter()
    .zip(0..)
    .map(|((name, element), place)| Line {
        x: 1.5 * f64::from(place),
        ..Line::of("ATOM", name, "ARG", 1, element)
    })
    .collect()
}

fn with(more: &[Line]) -> Vec<Line> {
    [&arginine()[..], more].concat()
}

fn dropped(molecule: &Molecule, kind: DropKind) -> Vec<(String, usize)> {
    let of_kind = |dropped: &&Dropped| dropped.kind == kind;
    let found = molecule.report.dropped.iter().find(of_kind);
    found.map_or(Vec::new(), |dropped| {
        dropped.names.clone().into_iter().collect()
    })
}

/// Found by a user: the membrane planes that OPM writes into a file were docked as solid; HADDOCK's own example was
/// refused for two mass centres.
#[test]
fn records_that_are_no_atoms_are_dropped_and_reported() {
    let hetero = |name, residue, element| Line::of("HETATM", name, residue, 90, element);
    let site = |name| Line::of("ATOM", name, "ARG", 1, "  ");
    for (records, expected) in [
        // OPM's, at one number; the wwPDB's.
        (
            vec![hetero(" N  ", "DUM", "  "), hetero(" O  ", "DUM", "  ")],
            vec![("DUM", 2)],
        ),
        (vec![hetero(" X  ", "DUM", " X")], vec![("DUM", 1)]),
        (vec![hetero(" BJ ", "MMB", "  ")], vec![("MMB", 1)]),
        (vec![hetero("SHA ", "SHA", "  ")], vec![("SHA", 1)]),
        (vec![hetero(" PS1", "PSD", "PS")], vec![("PSD", 1)]),
        (
            ["THKN", "CNTR", "NORM"]
                .map(|name| hetero(name, "MEM", " X"))
                .to_vec(),
            vec![("MEM", 3)],
        ),
        (
            ["MPct", "MPnm", "MPtk"]
                .map(|name| hetero(name, "MEM", "  "))
                .to_vec(),
            vec![("MEM", 3)],
        ),
        (vec![hetero("ORIG", "VRT", " X")], vec![("VRT", 1)]),
        (
            vec![hetero("APOL", "STP", "Ve"), hetero(" POL", "STP", "Ve")],
            vec![("STP", 2)],
        ),
        // Sites of a residue: GROMACS, CHARMM, AMBER, Rosetta, CYANA, and one that nobody knows.
        (
            vec![site(" MN1"), site(" MN2")],
            vec![("MN1", 1), ("MN2", 1)],
        ),
        (vec![site("MCB1")], vec![("MCB1", 1)]),
        (
            vec![site("LPOA"), site(" EP1")],
            vec![("EP1", 1), ("LPOA", 1)],
        ),
        (
            vec![Line::of("ATOM", " CEN", "ARG", 1, " X")],
            vec![("CEN", 1)],
        ),
        (
            vec![Line::of("ATOM", " NV ", "ARG", 1, " X")],
            vec![("NV", 1)],
        ),
        (
            vec![site(" V1 "), site("ORB1")],
            vec![("ORB1", 1), ("V1", 1)],
        ),
        (
            vec![site(" QB "), site(" ZZ1")],
            vec![("QB", 1), ("ZZ1", 1)],
        ),
        // The Drude particle of the first atom, which is where that is; a deuteron would be at 1 Å.
        (
            vec![Line {
                x: 0.1,
                ..site(" DN ")
            }],
            vec![("Drude particle", 1)],
        ),
        // Of a ligand.
        (
            vec![hetero(" C1 ", "LIG", " C"), hetero(" LP1", "LIG", "  ")],
            vec![("LP1", 1)],
        ),
    ] {
        let molecule = read_by(&with(&records), &ReadOptions::default()).unwrap();
        let expected: Vec<(String, usize)> = expected
            .into_iter()
            .map(|(name, count)| (name.to_owned(), count))
            .collect();
        assert_eq!(dropped(&molecule, DropKind::PseudoAtom), expected);
        let ligand = usize::from(molecule.atoms.iter().any(|atom| atom.name == "C1"));
        assert_eq!(molecule.atoms.len(), 11 + ligand);
        let count: usize = expected.iter().map(|(_, count)| count).sum();
        let shown = molecule.report.to_string();
        assert!(shown.contains(&format!("{count} pseudo-atom")), "{shown}");
    }
}

/// Ligands have the names of markers, and their atoms those of sites: salicylhydroxamic acid, meropenem, manganese.
#[test]
fn atoms_are_kept_whatever_they_are_called() {
    let hetero = |name, residue, element| Line::of("HETATM", name, residue, 90, element);
    for records in [
        vec![hetero(" C1 ", "SHA", " C"), hetero(" O6 ", "SHA", " O")],
        vec![hetero(" C24", "MEM", " C"), hetero(" X  ", "MEM", " N")],
        vec![hetero(" N  ", "DUM", " N"), hetero(" C1 ", "DUM", " C")],
        vec![hetero(" C1 ", "LIG", " C"), hetero(" LP1", "LIG", " N")],
        vec![hetero("MN1 ", "OEX", "MN"), hetero(" O1 ", "OEX", " O")],
        vec![hetero("MN1 ", "OEX", "  "), hetero(" O1 ", "OEX", "  ")],
        vec![hetero(" V1 ", "DVT", " V"), hetero(" O1 ", "DVT", " O")],
        vec![
            Line::of("ATOM", " V1 ", "ARG", 1, " V"),
            hetero(" EP1", "LIG", " O"),
        ],
    ] {
        let molecule = read_by(&with(&records), &ReadOptions::default()).unwrap();
        assert_eq!(molecule.atoms.len(), 13, "{:?}", names(&molecule));
        assert_eq!(dropped(&molecule, DropKind::PseudoAtom), []);
    }
    // What is neither an atom nor a site is refused as before, with a way out.
    let odd = [hetero(" XX1", "LIG", "  ")];
    let error = read_by(&with(&odd), &ReadOptions::default()).unwrap_err();
    assert!(error.message().contains("element of atom XX1"), "{error}");
    assert!(error.remedy().unwrap().contains("--drop-residue"));
    let options = ReadOptions {
        drop_residue: vec!["LIG".to_owned()],
        ..ReadOptions::default()
    };
    assert_eq!(read_by(&with(&odd), &options).unwrap().atoms.len(), 11);
}

#[test]
fn the_fourth_site_of_a_water_goes_and_the_water_stays() {
    let water = |name, element| Line::of("HETATM", name, "SOL", 80, element);
    let records = [
        water(" OW ", "  "),
        water(" HW1", "  "),
        water(" MW ", "  "),
    ];
    let options = ReadOptions {
        waters: Waters::Keep,
        ..ReadOptions::default()
    };
    let molecule = read_by(&with(&records), &options).unwrap();
    assert_eq!(molecule.atoms.len(), 12);
    assert_eq!(
        dropped(&molecule, DropKind::PseudoAtom),
        [("MW".to_owned(), 1)]
    );
    let molecule = read_by(&with(&records), &ReadOptions::default()).unwrap();
    assert_eq!(dropped(&molecule, DropKind::Water), [("SOL".to_owned(), 3)]);
}

/// Found by a user: an inhibitor kept in the site kept the partner out of it, without a word.
#[test]
fn a_ligand_of_unknown_chemistry_is_warned_of_and_dropped_by_name() {
    let ligand = |record, residue: &'static str| {
        [" C1 ", " C2 ", " C3 ", " C4 ", " O1 ", " N1 "].map(|name| {
            Line::of(
                record,
                name,
                residue,
                90,
                if name == " O1 " { " O" } else { " C" },
            )
        })
    };
    let warned = |lines: &[Line], options: &ReadOptions| -> Vec<String> {
        let molecule = read_by(lines, options).unwrap();
        let warnings = molecule.report.warnings.into_iter();
        warnings
            .filter(|text| text.contains("--drop-residue"))
            .collect()
    };
    let default = ReadOptions::default();
    let kept = warned(&with(&ligand("HETATM", "XK2")), &default);
    assert_eq!(kept.len(), 1);
    for part in [
        "1 XK2 (6 heavy atoms)",
        "--hetatm drop or --drop-residue XK2",
    ] {
        assert!(kept[0].contains(part), "{kept:?}");
    }
    // ATOM records stay under --hetatm drop.
    let kept = warned(&with(&ligand("ATOM", "XK2")), &default);
    assert!(!kept[0].contains("--hetatm"), "{kept:?}");
    // A sugar, a heme and a cap are no such ligands.
    for residue in ["NAG", "HEM"] {
        assert_eq!(warned(&with(&ligand("HETATM", residue)), &default), [""; 0]);
    }
    let cap = &ligand("HETATM", "ACE")[..3];
    assert_eq!(warned(&with(cap), &default), [""; 0]);

    let options = ReadOptions {
        drop_residue: vec!["XK2".to_owned(), "ZN".to_owned()],
        ..ReadOptions::default()
    };
    let both = [
        &ligand("ATOM", "XK2")[..],
        &[Line::of("HETATM", "ZN  ", "ZN", 91, "ZN")],
    ]
    .concat();
    let molecule = read_by(&with(&both), &options).unwrap();
    assert_eq!(molecule.atoms.len(), 11);
    assert_eq!(molecule.report.warnings, [""; 0]);
    assert_eq!(
        dropped(&molecule, DropKind::Residue),
        [("XK2".to_owned(), 6), ("ZN".to_owned(), 1)]
    );
}
