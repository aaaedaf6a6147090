//! Files that hold very many of one thing: each step of reading once compared it with all before it, which took minutes
//! to hours at these sizes.

#![cfg(feature = "molecule")]

use std::fmt::Write;

use knotdock_structures::Error;
use knotdock_structures::molecule::{InputSpec, Molecule, ReadOptions, read};

const HEAD: &str = "data_x\nloop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.type_symbol\n\
    _atom_site.label_atom_id\n_atom_site.label_alt_id\n_atom_site.label_comp_id\n_atom_site.label_asym_id\n\
    _atom_site.auth_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n\
    _atom_site.pdbx_PDB_model_num\n";

const MANY: usize = 60_000;

fn read_text(text: &str, options: &ReadOptions) -> Result<Molecule, Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.cif");
    std::fs::write(&path, text).unwrap();
    read(&InputSpec::whole(path), options)
}

/// Atoms on a grid of 4 Å, each with the fields of `row`: its name, alternate location, residue's name, chain and
/// number.
fn atoms(count: usize, row: impl Fn(usize) -> String) -> String {
    let mut text = HEAD.to_owned();
    for index in 0..count {
        let [x, y, z] = [index % 100, index / 100 % 100, index / 10_000].map(|at| 4 * at);
        writeln!(text, "HETATM {index} C {} {x} {y} {z} 1", row(index)).unwrap();
    }
    text
}

#[test]
fn many_chains_residues_and_names() {
    let options = ReadOptions::default();
    let chains = read_text(&atoms(MANY, |i| format!("C1 . LIG C{i} 1")), &options).unwrap();
    assert_eq!(chains.report.chains.len(), MANY);
    let names = read_text(&atoms(MANY, |i| format!("C1 . X{i} A 1")), &options).unwrap();
    assert_eq!(names.report.groups.len(), MANY);
    let one = read_text(&atoms(MANY, |i| format!("C{i} . LIG A 1")), &options).unwrap();
    assert_eq!(one.report.chains[0].residues, 1);
    // Two residues whose atoms take turns.
    let turns = read_text(
        &atoms(MANY, |i| format!("C{i} . LIG A {}", i % 2)),
        &options,
    )
    .unwrap();
    assert_eq!(turns.report.chains[0].residues, 2);
}

#[test]
fn many_alternate_locations_of_one_residue() {
    let row = |i: usize| format!("C{} {} LIG A 1", i / 2, ['A', '.'][i % 2]);
    let molecule = read_text(&atoms(MANY, row), &ReadOptions::default()).unwrap();
    let choices = &molecule.report.altered.alternate_locations;
    assert_eq!(choices.len(), 1);
}

/// Operators of an assembly by the hundred thousand, each of one copy.
#[test]
fn many_assemblies_and_copies() {
    let mut text = atoms(10, |i| format!("CA . GLY A {i}"));
    text += "loop_\n_pdbx_struct_oper_list.id\n";
    for item in ["matrix", "vector"] {
        for row in 1..=3 {
            match item {
                "vector" => writeln!(text, "_pdbx_struct_oper_list.vector[{row}]").unwrap(),
                _ => (1..=3).for_each(|column| {
                    writeln!(text, "_pdbx_struct_oper_list.matrix[{row}][{column}]").unwrap();
                }),
            }
        }
    }
    let copies = 20_000;
    for number in 1..=copies {
        writeln!(text, "{number} 1 0 0 0 1 0 0 0 1 0 0 {}", 10 * number).unwrap();
    }
    text += "loop_\n_pdbx_struct_assembly_gen.assembly_id\n_pdbx_struct_assembly_gen.oper_expression\n\
             _pdbx_struct_assembly_gen.asym_id_list\n";
    writeln!(text, "all (1-{copies}) A").unwrap();
    (0..copies).for_each(|number| writeln!(text, "n{number} 1 A").unwrap());
    let options = ReadOptions {
        assembly: Some("all".to_owned()),
        ..ReadOptions::default()
    };
    let molecule = read_text(&text, &options).unwrap();
    assert_eq!(molecule.atoms.len(), 10 * copies);
    assert_eq!(molecule.report.chains.len(), copies);
}

/// One atom at 1e308 was read; the scene that it made overflowed later, without a word on the file.
#[test]
fn an_atom_out_of_all_bounds_is_refused_by_its_line() {
    for value in ["1e308", "-1e30", "1e11", "inf", "nan", "1e400"] {
        let text = atoms(3, |i| format!("CA . GLY A {i}")) + "ATOM 4 C CA . GLY A 9 0 0 1 1\n";
        let text = text.replace(" 0 0 1 1\n", &format!(" 0 {value} 1 1\n"));
        let error = read_text(&text, &ReadOptions::default()).unwrap_err();
        assert_eq!(
            error.line(),
            Some(HEAD.lines().count() as u64 + 4),
            "{error}"
        );
        assert!(error.to_string().contains("Cartn_y"), "{error}");
        assert!(error.file().is_some() && error.remedy().is_some());
    }
    let record =
        "ATOM      1  CA  GLY A   1       0.000   1e308   0.000  1.00  0.00           C  \n";
    let error = read_text(record, &ReadOptions::default()).unwrap_err();
    assert_eq!(error.line(), Some(1));
    assert!(error.to_string().contains("1e308"), "{error}");
}
