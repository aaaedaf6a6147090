//! Policies of reading: waters, HETATM records, hydrogens, alternate locations and models.

#![cfg(feature = "molecule")]

use crate::pdb_text::{ATOM, Line, names, text};
use knotdock_structures::Error;
use knotdock_structures::molecule::{
    AlternateLocation, DropKind, Hetatm, Hydrogens, InputSpec, ModelChoice, Molecule, ReadOptions,
    Waters, read, read_with_fates,
};

fn read_by(text: &str, options: &ReadOptions) -> Result<Molecule, Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pdb");
    std::fs::write(&path, text).unwrap();
    read(&InputSpec::whole(path), options)
}

/// A glycine, a modified residue, a ligand, a metal, an additive, a water, a hydrogen.
fn mixture() -> String {
    text(&[
        ATOM,
        Line::of("ATOM", " HA ", "GLY", 1, " H"),
        Line::of("HETATM", " N  ", "MSE", 2, " N"),
        Line::of("HETATM", " CA ", "MSE", 2, " C"),
        Line::of("HETATM", " C  ", "MSE", 2, " C"),
        Line::of("HETATM", "SE  ", "MSE", 2, "SE"),
        Line::of("HETATM", " C1 ", "LIG", 3, " C"),
        Line::of("HETATM", "ZN  ", "ZN", 4, "ZN"),
        Line::of("HETATM", " S  ", "SO4", 5, " S"),
        Line::of("HETATM", " O  ", "HOH", 6, " O"),
    ])
}

#[test]
fn groups_are_kept_and_dropped_as_requested() {
    let read = |options: ReadOptions| {
        let molecule = read_by(&mixture(), &options).unwrap();
        names(&molecule).join(" ")
    };
    let default = ReadOptions::default();
    assert_eq!(read(default.clone()), "CA N CA C SE C1 ZN");
    assert_eq!(
        read(ReadOptions {
            hetatm: Hetatm::Keep,
            ..default.clone()
        }),
        "CA N CA C SE C1 ZN S"
    );
    // Modified amino acids belong to the chain, whatever their record.
    assert_eq!(
        read(ReadOptions {
            hetatm: Hetatm::Drop,
            ..default.clone()
        }),
        "CA N CA C SE"
    );
    assert_eq!(
        read(ReadOptions {
            hetatm: Hetatm::Drop,
            waters: Waters::Keep,
            ..default.clone()
        }),
        "CA N CA C SE O"
    );
    assert_eq!(
        read(ReadOptions {
            hydrogens: Hydrogens::Keep,
            ..default
        }),
        "CA HA N CA C SE C1 ZN"
    );
}

/// United-atom radii stand for hydrogens; where these are there, each atom has its own (Bondi 1964; Rowland and Taylor
/// 1996).
#[test]
fn radii_are_all_atom_ones_only_where_hydrogens_are() {
    let options = ReadOptions {
        hydrogens: Hydrogens::Keep,
        ..ReadOptions::default()
    };
    let with = read_by(&mixture(), &options).unwrap();
    let radius = |name: &str| {
        with.atoms
            .iter()
            .find(|atom| atom.name == name)
            .unwrap()
            .radius
    };
    assert_eq!(
        (radius("CA"), radius("HA"), radius("N"), radius("SE")),
        (1.70, 1.10, 1.55, 1.90)
    );
    assert!(with.atoms[1].is_hydrogen() && !with.atoms[0].is_hydrogen());
    let without = read_by(&text(&[ATOM]), &options).unwrap();
    assert_eq!(without.atoms[0].radius, 1.88);
}

#[test]
fn a_named_location_is_taken_where_it_is_offered() {
    let file = text(&[
        Line::at(1, " CA ", 'A', 0.7),
        Line::at(1, " CA ", 'B', 0.3),
        Line::at(2, " CA ", 'C', 0.4),
        Line::at(2, " CA ", 'D', 0.6),
    ]);
    let chosen = |altloc| {
        let options = ReadOptions {
            altloc,
            ..ReadOptions::default()
        };
        let molecule = read_by(&file, &options).unwrap();
        let locations = molecule
            .atoms
            .iter()
            .filter_map(|atom| atom.alternate_location);
        locations.collect::<String>()
    };
    assert_eq!(chosen(AlternateLocation::Occupancy), "AD");
    assert_eq!(chosen(AlternateLocation::Named('B')), "BD");
    assert_eq!(chosen(AlternateLocation::Named('C')), "AC");
}

#[test]
fn models_are_counted_from_one_whatever_their_numbers() {
    let model = |number: i64, x: f64| {
        format!(
            "MODEL     {number:>4}\n{}ENDMDL\n",
            Line { x, ..ATOM }.text()
        )
    };
    let file = [model(7, 1.0), model(3, 2.0), model(9, 3.0)].concat();
    let place = |model: usize| {
        let options = ReadOptions {
            model: ModelChoice::Number(model),
            ..ReadOptions::default()
        };
        read_by(&file, &options).map(|molecule| molecule.atoms[0].position[0])
    };
    assert_eq!(
        [1, 2, 3].map(|model| place(model).unwrap()),
        [1.0, 2.0, 3.0]
    );
    for wrong in [0, 4] {
        let error = place(wrong).unwrap_err();
        assert!(error.message().ends_with("the file has 3"), "{error}");
        assert!(error.remedy().is_some() && error.file().is_some());
    }
    let second = read_by(
        &file,
        &ReadOptions {
            model: ModelChoice::Number(2),
            ..ReadOptions::default()
        },
    )
    .unwrap();
    assert_eq!(second.report.altered.models_ignored, 2);
    assert_eq!(second.report.atoms_dropped(), 2);
    // A ligand of one model beside a receptor of several.
    let options = ReadOptions {
        model: ModelChoice::Number(2),
        ..ReadOptions::default()
    };
    assert_eq!(read_by(&text(&[ATOM]), &options).unwrap().atoms.len(), 1);
}

/// mmCIF rows of one model need not stand together.
#[test]
fn models_of_mmcif_go_by_their_column() {
    let rows = [(5, 1.0), (2, 2.0), (5, 3.0), (2, 4.0)];
    let rows = rows
        .map(|(model, x)| format!("C CA GLY A 1 {x} 0 0 {model}\n"))
        .concat();
    let file = format!(
        "data_x\nloop_\n_atom_site.type_symbol\n_atom_site.label_atom_id\n_atom_site.label_comp_id\n\
         _atom_site.label_asym_id\n\
         _atom_site.label_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n\
         _atom_site.pdbx_PDB_model_num\n{rows}"
    );
    for (model, expected) in [(1, [1.0, 3.0]), (2, [2.0, 4.0])] {
        let options = ReadOptions {
            model: ModelChoice::Number(model),
            ..ReadOptions::default()
        };
        let molecule = read_by(&file, &options).unwrap();
        let found: Vec<f64> = molecule.atoms.iter().map(|atom| atom.position[0]).collect();
        assert_eq!(found, expected);
    }
}

/// What becomes of every atom, in the order of the file.
#[test]
fn every_atom_has_a_fate_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pdb");
    let file = mixture() + &text(&[Line::at(7, " CB ", 'A', 0.2), Line::at(7, " CB ", 'B', 0.8)]);
    std::fs::write(&path, file).unwrap();
    let options = ReadOptions {
        hetatm: Hetatm::Drop,
        ..ReadOptions::default()
    };
    let (molecule, entries) = read_with_fates(&InputSpec::whole(&path), &options).unwrap();
    let reasons: Vec<Option<DropKind>> = entries.iter().map(|entry| entry.dropped).collect();
    let dropped = |kind| Some(kind);
    assert_eq!(
        reasons,
        [
            None,
            dropped(DropKind::Hydrogen),
            None,
            None,
            None,
            None,
            dropped(DropKind::Hetatm),
            dropped(DropKind::Hetatm),
            dropped(DropKind::Additive),
            dropped(DropKind::Water),
            dropped(DropKind::AlternateLocation),
            None,
        ]
    );
    assert!(
        entries
            .windows(2)
            .all(|pair| pair[0].atom.line < pair[1].atom.line)
    );
    let kept: Vec<_> = entries
        .iter()
        .filter(|entry| entry.dropped.is_none())
        .map(|entry| &entry.atom)
        .collect();
    assert!(kept.into_iter().eq(molecule.atoms.iter()));
}
