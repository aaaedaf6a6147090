//! Biological assemblies: copies of chains as REMARK 350 and mmCIF describe them.

#![cfg(feature = "molecule")]

use std::path::Path;

use crate::pdb_text::{ATOM, Line, text};
use knotdock_structures::Error;
use knotdock_structures::molecule::{
    BuiltAssembly, DropKind, InputSpec, Molecule, ReadOptions, read, read_with_fates,
};

/// Two glycine carbons of chain A, at (5, 1, 2) and (6, 1, 2), one of chain B and a zinc of chain A on the axis, (0, 0,
/// 2).
fn chains() -> String {
    let zinc = "HETATM    9 ZN    ZN A 301       0.000   0.000   2.000  0.50 20.00          ZN  \n";
    let atoms = [
        Line { x: 5.0, ..ATOM },
        Line {
            x: 6.0,
            number: 2,
            ..ATOM
        },
        Line { x: 9.0, ..ATOM }.in_chain('B'),
    ];
    text(&atoms) + zinc
}

/// Lines of an operator: a turn by 180 degrees about z and a shift along z.
fn half_turn(number: usize, shift: f64) -> String {
    format!(
        "REMARK 350   BIOMT1 {number:>3} -1.000000  0.000000  0.000000        0.00000            \n\
         REMARK 350   BIOMT2 {number:>3}  0.000000 -1.000000  0.000000        0.00000            \n\
         REMARK 350   BIOMT3 {number:>3}  0.000000  0.000000  1.000000     {shift:>10.5}            \n"
    )
}

const IDENTITY: &str = "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n\
REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n\
REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n";

/// Assembly 1 is a dimer of A, assembly 2 is B as it stands.
fn dimer() -> String {
    format!(
        "REMARK 350\nREMARK 350 COORDINATES FOR A COMPLETE MULTIMER REPRESENTING THE KNOWN\n\
         REMARK 350 BIOMOLECULE: 1\nREMARK 350 AUTHOR DETERMINED BIOLOGICAL UNIT: DIMERIC\n\
         REMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n\
         {IDENTITY}{}REMARK 350 BIOMOLECULE: 2\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: B\n{IDENTITY}{}",
        half_turn(2, 0.0),
        chains()
    )
}

fn read_as(
    folder: &Path,
    name: &str,
    text: &str,
    picked: &str,
    assembly: Option<&str>,
) -> Result<Molecule, Error> {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    let options = ReadOptions {
        assembly: assembly.map(str::to_owned),
        ..ReadOptions::default()
    };
    read(
        &InputSpec::parse(&format!("{}{picked}", path.display()))?,
        &options,
    )
}

/// Chain, residue number and position of every atom.
fn placed(molecule: &Molecule) -> Vec<(&str, i64, [f64; 3])> {
    molecule
        .atoms
        .iter()
        .map(|atom| (atom.chain.as_str(), atom.residue_number, atom.position))
        .collect()
}

#[test]
fn a_dimer_is_built_of_one_chain() {
    let folder = tempfile::tempdir().unwrap();
    let built = |picked: &str, assembly: &str| {
        read_as(folder.path(), "x.pdb", &dimer(), picked, Some(assembly))
    };
    let molecule = built("", "1").unwrap();
    // The zinc lies on the axis, where its copy coincides with it.
    assert_eq!(
        placed(&molecule),
        [
            ("A", 1, [5.0, 1.0, 2.0]),
            ("A", 2, [6.0, 1.0, 2.0]),
            ("A", 301, [0.0, 0.0, 2.0]),
            ("A-2", 1, [-5.0, -1.0, 2.0]),
            ("A-2", 2, [-6.0, -1.0, 2.0]),
        ]
    );
    let report = &molecule.report;
    let expected = BuiltAssembly {
        id: "1".to_owned(),
        chains: 2,
        chains_in_file: 2,
        on_axes: 1,
    };
    assert_eq!(report.assembly, Some(expected));
    let shown = report.to_string();
    assert!(
        shown.contains(
            "biological assembly 1: 2 chains, of 2 in the file; 1 atom on its axes kept once"
        ),
        "{shown}"
    );
    assert!(
        shown.contains("1 atom of chains outside the assembly (B)"),
        "{shown}"
    );
    assert!(
        report
            .warnings
            .iter()
            .all(|warning| !warning.contains("--assembly")),
        "{shown}"
    );

    let second = built("", "2").unwrap();
    assert_eq!(placed(&second), [("B", 1, [9.0, 1.0, 2.0])]);
    // Copies are picked by their names.
    assert_eq!(built(":A-2", "1").unwrap().atoms.len(), 2);
    let unknown = built(":B", "1").unwrap_err();
    assert!(
        unknown
            .message()
            .contains("no chain 'B'; the file has A, A-2"),
        "{unknown}"
    );
}

#[test]
fn every_atom_has_a_fate_with_the_copies() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pdb");
    std::fs::write(&path, dimer()).unwrap();
    let options = ReadOptions {
        assembly: Some("1".to_owned()),
        ..ReadOptions::default()
    };
    let (molecule, entries) = read_with_fates(&InputSpec::whole(&path), &options).unwrap();
    let outside: Vec<_> = entries
        .iter()
        .filter(|entry| entry.dropped.is_some())
        .collect();
    assert_eq!(entries.len(), molecule.atoms.len() + 1);
    assert_eq!(
        (outside[0].dropped, outside[0].atom.chain.as_str()),
        (Some(DropKind::Assembly), "B")
    );
}

/// Docking an asymmetric unit gives a warning that it is not the assembly; a user who picks chains gets none.
#[test]
fn a_unit_that_is_no_assembly_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let warned = |text: &str, picked: &str| {
        let molecule = read_as(folder.path(), "x.pdb", text, picked, None).unwrap();
        assert_eq!(molecule.report.assembly, None);
        let warnings = molecule.report.warnings.into_iter();
        let of_assemblies: Vec<String> = warnings
            .filter(|warning| warning.contains("assembly"))
            .collect();
        of_assemblies.join(" ")
    };
    let shown = warned(&dimer(), "");
    assert!(
        shown.contains(
            "assembly 1 (2 chains in the file, 2 in the assembly): --assembly 1 builds it"
        ),
        "{shown}"
    );
    assert_eq!(warned(&dimer(), ":A"), "");
    let whole = format!(
        "REMARK 350 BIOMOLECULE: 1\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A, B\n{IDENTITY}{}",
        chains()
    );
    assert_eq!(warned(&whole, ""), "");
    let moved = whole.replace(IDENTITY, &half_turn(1, 0.0));
    assert!(warned(&moved, "").contains("--assembly 1"));
    let part = whole.replace("CHAINS: A, B", "CHAINS: A");
    assert!(warned(&part, "").contains("(2 chains in the file, 1 in the assembly)"));
    assert_eq!(warned(&chains(), ""), "");
    // What cannot be understood is no ground for a warning, nor an error where nothing is to be built.
    assert_eq!(warned(&whole.replace("BIOMT2", "BIOMT9"), ""), "");
}

/// A chain named in two lines, two assemblies of one description, two groups each with its operators.
#[test]
fn lines_of_the_remark_belong_together() {
    let folder = tempfile::tempdir().unwrap();
    let built = |text: &str, assembly: &str| {
        read_as(folder.path(), "x.pdb", text, "", Some(assembly)).unwrap()
    };
    let lines = format!(
        "REMARK 350 BIOMOLECULE: 1, 2\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A,\n\
         REMARK 350                    AND CHAINS: B\n{IDENTITY}{}",
        chains()
    );
    for assembly in ["1", "2"] {
        assert_eq!(built(&lines, assembly).atoms.len(), 4);
    }
    let groups = format!(
        "REMARK 350 BIOMOLECULE: 1\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n\
         {IDENTITY}REMARK 350 APPLY THE FOLLOWING TO CHAINS: B\n{}{}",
        half_turn(2, 4.0),
        chains()
    );
    let molecule = built(&groups, "1");
    assert_eq!(placed(&molecule).last(), Some(&("B", 1, [-9.0, -1.0, 6.0])));
}

#[test]
fn what_cannot_be_built_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |text: &str, assembly: &str| {
        let error = read_as(folder.path(), "x.pdb", text, "", Some(assembly)).unwrap_err();
        assert!(error.file().is_some() && error.remedy().unwrap().contains("--assembly"));
        (error.line(), error.to_string())
    };
    let (line, shown) = refused(&dimer(), "3");
    assert_eq!(
        (line, shown.as_str()),
        (None, "there is no assembly '3'; the file has 1, 2")
    );
    for (from, to, expected_line, what) in [
        ("BIOMT2   1", "BIOMT3   1", 7, "BIOMT2 is due"),
        (
            "BIOMT1   1  1.000000",
            "BIOMT1   1  1.0a",
            6,
            "four numbers",
        ),
        (
            "BIOMT1   1  1.000000",
            "BIOMT1   1      nan ",
            6,
            "four numbers",
        ),
        (
            "REMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n",
            "",
            7,
            "before the chains",
        ),
    ] {
        let (line, shown) = refused(&dimer().replacen(from, to, 1), "1");
        assert_eq!(line, Some(expected_line), "{shown}");
        assert!(shown.contains(what), "{shown}");
    }
    // An operator that no coordinates survive.
    let far = dimer().replacen("BIOMT1   2 -1.000000", "BIOMT1   2  9e307   ", 1);
    let (line, shown) = refused(&far, "1");
    assert!(
        line.is_some() && shown.contains("out of all bounds"),
        "{shown}"
    );
    let cut = dimer()
        .replacen(IDENTITY.lines().last().unwrap(), "", 3)
        .replace("REMARK 350   BIOMT3", "REMARK 900");
    assert!(refused(&cut, "1").1.contains("due"));
    // A file that describes no assembly is read as it is: the other of two molecules may have one.
    let plain = read_as(folder.path(), "x.pdb", &chains(), "", Some("1")).unwrap();
    assert_eq!((plain.atoms.len(), plain.report.assembly), (4, None));
}

/// Atoms of a chain that the archive calls `X` and the author `A`, and of a ligand of it, `Y` to the archive.
fn mmcif(parts: &str) -> String {
    let mut operators = String::new();
    // 1 leaves all in place, 2 turns by 90 degrees about z, 3 shifts by 10 along x, P turns by 180 degrees about x.
    for (id, matrix, shift) in [
        ("1", [[1, 0, 0], [0, 1, 0], [0, 0, 1]], 0),
        ("2", [[0, -1, 0], [1, 0, 0], [0, 0, 1]], 0),
        ("3", [[1, 0, 0], [0, 1, 0], [0, 0, 1]], 10),
        ("P", [[1, 0, 0], [0, -1, 0], [0, 0, -1]], 0),
    ] {
        let numbers: Vec<String> = matrix.iter().flatten().map(i32::to_string).collect();
        operators += &format!("{id} {} {shift} 0 0\n", numbers.join(" "));
    }
    let mut tags = "_pdbx_struct_oper_list.id\n".to_owned();
    for row in 1..=3 {
        for column in 1..=3 {
            tags += &format!("_pdbx_struct_oper_list.matrix[{row}][{column}]\n");
        }
    }
    for axis in 1..=3 {
        tags += &format!("_pdbx_struct_oper_list.vector[{axis}]\n");
    }
    format!(
        "data_x\n{parts}\nloop_\n{tags}{operators}#\nloop_\n_atom_site.group_PDB\n_atom_site.type_symbol\n\
         _atom_site.label_atom_id\n\
         _atom_site.label_comp_id\n_atom_site.label_asym_id\n_atom_site.auth_asym_id\n_atom_site.auth_seq_id\n\
         _atom_site.Cartn_x\n\
         _atom_site.Cartn_y\n_atom_site.Cartn_z\nATOM C CA GLY X A 1 5 1 2\nHETATM ZN ZN ZN Y A 301 7 1 2\n\
         ATOM C CA GLY Z B 1 9 1 2\n"
    )
}

fn generated(assembly: &str, expression: &str, chains: &str) -> String {
    format!(
        "_pdbx_struct_assembly_gen.assembly_id {assembly}\n_pdbx_struct_assembly_gen.oper_expression {expression}\n\
         _pdbx_struct_assembly_gen.asym_id_list {chains}"
    )
}

#[test]
fn mmcif_goes_by_the_names_of_the_archive() {
    let folder = tempfile::tempdir().unwrap();
    let built = |parts: &str, assembly: &str| {
        read_as(folder.path(), "x.cif", &mmcif(parts), "", Some(assembly)).unwrap()
    };
    let molecule = built(&generated("1", "1,3", "X,Y"), "1");
    assert_eq!(
        placed(&molecule),
        [
            ("A", 1, [5.0, 1.0, 2.0]),
            ("A", 301, [7.0, 1.0, 2.0]),
            ("A-2", 1, [15.0, 1.0, 2.0]),
            ("A-2", 301, [17.0, 1.0, 2.0]),
        ]
    );
    // Lists that are text fields of several lines, rows of a loop that add up to one assembly, names that are no
    // numbers.
    let rows = "loop_\n_pdbx_struct_assembly_gen.assembly_id\n_pdbx_struct_assembly_gen.oper_expression\n\
        _pdbx_struct_assembly_gen.asym_id_list\n\
                PAU 1-3\n;X,\nY\n;\nPAU P Z";
    let molecule = built(rows, "PAU");
    let names: Vec<&str> = placed(&molecule).iter().map(|one| one.0).collect();
    assert_eq!(names, ["A", "A", "A-2", "A-2", "A-3", "A-3", "B"]);
    assert_eq!(placed(&molecule)[6].2, [9.0, -1.0, -2.0]);
    // A name that the file has already is not given again.
    let taken = mmcif(&generated("1", "1,3", "X,Z")).replace(" Z B 1", " Z A-2 1");
    let molecule = read_as(folder.path(), "x.cif", &taken, "", Some("1")).unwrap();
    let names: Vec<&str> = placed(&molecule).iter().map(|one| one.0).collect();
    assert_eq!(names, ["A", "A-2", "A-2+", "A-2-2"]);
}

/// `(2)(3)` is the shift first and then the turn; `(3)(2)` the other way; of groups every combination.
#[test]
fn operators_combine_from_the_last_to_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let of = |expression: &str| -> Vec<[f64; 3]> {
        let text = mmcif(&generated("1", expression, "X"));
        let molecule = read_as(folder.path(), "x.cif", &text, "", Some("1")).unwrap();
        molecule.atoms.iter().map(|atom| atom.position).collect()
    };
    assert_eq!(of("'(2)(3)'"), [[-1.0, 15.0, 2.0]]);
    assert_eq!(of("'(3)(2)'"), [[9.0, 5.0, 2.0]]);
    assert_eq!(of("'(P)(1,3)'"), [[5.0, -1.0, -2.0], [15.0, -1.0, -2.0]]);
    assert_eq!(of("'(1,P)(1,3)'").len(), 4);
    let refused = |expression: &str| {
        let text = mmcif(&generated("1", expression, "X"));
        let error = read_as(folder.path(), "x.cif", &text, "", Some("1")).unwrap_err();
        (error.line(), error.to_string())
    };
    let (line, shown) = refused("1-5");
    assert!(
        line == Some(2) && shown.contains("operator 4 is not in"),
        "{line:?} {shown}"
    );
    assert!(refused("Q").1.contains("operator Q"));
    let many = format!("'{}'", "(1,2,3,P)".repeat(9));
    assert!(refused(&many).1.contains("copies"));
}

/// Building an assembly that is the coordinates as they stand changes no byte of them.
#[test]
fn the_identity_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let text = mmcif(&generated("1", "1", "X,Y,Z"));
    let built = read_as(folder.path(), "x.cif", &text, "", Some("1")).unwrap();
    let plain = read_as(folder.path(), "x.cif", &text, "", None).unwrap();
    assert_eq!(built.atoms, plain.atoms);
    assert!(plain.report.warnings.is_empty());
}
