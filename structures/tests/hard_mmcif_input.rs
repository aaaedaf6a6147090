//! mmCIF files as they come, and that both formats give the same atoms.

#![cfg(feature = "molecule")]

use std::path::Path;

use knotdock_structures::Error;
use knotdock_structures::molecule::{
    Format, InputSpec, Molecule, ReadOptions, read, write_molecule,
};

const HEAD: &str = "data_X\nloop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.type_symbol\n\
_atom_site.label_atom_id\n_atom_site.label_alt_id\n_atom_site.label_comp_id\n_atom_site.label_asym_id\n\
_atom_site.label_seq_id\n_atom_site.pdbx_PDB_ins_code\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n\
_atom_site.occupancy\n_atom_site.B_iso_or_equiv\n_atom_site.auth_seq_id\n_atom_site.auth_asym_id\n\
_atom_site.pdbx_PDB_model_num\n";

fn read_text(text: &str, chains: &str) -> Result<Molecule, Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.cif");
    std::fs::write(&path, text).unwrap();
    let spec = InputSpec::parse(&format!("{}{chains}", path.display()))?;
    read(&spec, &ReadOptions::default())
}

fn chains(molecule: &Molecule) -> Vec<&str> {
    molecule
        .atoms
        .iter()
        .map(|atom| atom.chain.as_str())
        .collect()
}

#[test]
fn names_are_the_authors_and_survive_that_they_look_like_numbers() {
    // pdbtbx reads 01 as 1 and 1E5 as 100000; both are chain names in large ribosome files.
    let file = format!(
        "{HEAD}ATOM 1 C CA . GLY A 1 ? 1 2 3 1 9 -7 01 1\nATOM 2 C CA . GLY B 2 B 1 2 3 1 9 7 1E5 1\n\
         ATOM 3 C CA . GLY C 3 ? 1 2 3 1 9 8 aA-2 1\nATOM 4 C CA . GLY D 4 ? 1 2 3 1 9 9 \"A'\" 1\n"
    );
    let molecule = read_text(&file, "").unwrap();
    assert_eq!(chains(&molecule), ["01", "1E5", "aA-2", "A'"]);
    assert_eq!(molecule.atoms[0].residue_number, -7);
    assert_eq!(molecule.atoms[1].insertion_code, Some('B'));
    assert_eq!(molecule.format, Format::Mmcif);
    assert_eq!(chains(&read_text(&file, ":aA-2").unwrap()), ["aA-2"]);
    let error = read_text(&file, ":A").unwrap_err();
    assert_eq!(
        error.to_string(),
        "there is no chain 'A'; the file has 01, 1E5, aA-2, A'"
    );
}

#[test]
fn further_data_blocks_with_atoms_are_warned_of() {
    let block = format!("{HEAD}ATOM 1 C CA . GLY A 1 ? 1 2 3 1 9 1 A 1\n");
    assert!(read_text(&block, "").unwrap().report.warnings.is_empty());
    let without = format!("{block}data_note\n_struct.title 'no atoms'\n");
    assert!(read_text(&without, "").unwrap().report.warnings.is_empty());
    let molecule = read_text(&format!("{without}{block}{block}"), "").unwrap();
    assert_eq!(molecule.atoms.len(), 1);
    let line = without.lines().count() + 1;
    let expected = format!(
        "only the first structure is read: 2 further data blocks with atoms, the first, data_X, at line {line}"
    );
    assert_eq!(molecule.report.warnings, [expected]);
}

#[test]
fn archive_names_stand_in_for_missing_author_names() {
    let file = "data_x\nloop_\n_ATOM_SITE.label_asym_id\n_atom_site.label_atom_id\n_atom_site.label_comp_id\n\
                _atom_site.label_seq_id\n_atom_site.cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n\
                Q CA GLY 5 1 2 3\n";
    let molecule = read_text(file, "").unwrap();
    let atom = &molecule.atoms[0];
    assert_eq!((atom.chain.as_str(), atom.residue_number), ("Q", 5));
    assert_eq!((atom.element.as_str(), atom.occupancy), ("C", 1.0));
}

#[test]
fn decimals_are_read_exactly() {
    // pdbtbx sums decimals digit by digit, which is off by an ulp, and wraps integers above 2^32; the number in
    // brackets is a standard uncertainty.
    let file =
        format!("{HEAD}ATOM 1 C CA . GLY A 1 ? 14.219 -5000000000.5 1.25e1(3) 0.37 37.59 1 A 1\n");
    let atom = &read_text(&file, "").unwrap().atoms[0];
    assert_eq!(atom.position, [14.219, -5_000_000_000.5, 12.5]);
    assert_eq!((atom.occupancy, atom.b_factor), (0.37, 37.59));
}

#[test]
fn quotes_text_fields_and_rows_over_several_lines() {
    let file = format!(
        "data_x\n_entry.id 'it''s'\n_struct.title\n;ATOM 1 loop_\n_atom_site.id\n;\nloop_\n_a.b\n_a.c\n1 'x y'\n{}\
         HETATM 1 O \"O5'\" . GLY\n# comment\nA 1 ?\n1 2 3 1 9 1 A 1 # end\n",
        HEAD.trim_start_matches("data_X\n")
    );
    let molecule = read_text(&file, "").unwrap();
    let atom = &molecule.atoms[0];
    assert_eq!((atom.name.as_str(), atom.hetero), ("O5'", true));
    assert_eq!(
        atom.line,
        file.lines().position(|l| l.starts_with("HETATM")).unwrap() + 1
    );
}

#[test]
fn a_single_atom_may_stand_as_pairs() {
    let pairs: String = HEAD
        .lines()
        .filter(|line| line.starts_with("_atom"))
        .zip("ATOM 1 C CA . GLY A 1 ? 1 2 3 1 9 1 A 1".split(' '))
        .map(|(tag, value)| format!("{tag} {value}\n"))
        .collect();
    assert_eq!(
        read_text(&format!("data_x\n{pairs}"), "")
            .unwrap()
            .atoms
            .len(),
        1
    );
}

#[test]
fn only_the_first_model_and_the_first_block_with_atoms_are_read() {
    let row =
        |id: usize, model: usize| format!("ATOM {id} C CA . GLY A 1 ? 1 2 3 1 9 1 A {model}\n");
    let file = format!(
        "data_dictionary\n_x.y 1\n{HEAD}{}{}{}{HEAD}{}",
        row(1, 4),
        row(2, 7),
        row(3, 9),
        row(4, 4)
    );
    let molecule = read_text(&file, "").unwrap();
    assert_eq!(molecule.atoms.len(), 1);
    assert_eq!(molecule.report.altered.models_ignored, 2);
}

#[test]
fn broken_files_name_their_line() {
    let bad = |row: &str| read_text(&format!("{HEAD}{row}\n"), "").unwrap_err();
    let line = HEAD.lines().count() as u64 + 1;
    for x in ["nan", "?", "1.2.3", "-", "1,5"] {
        let error = bad(&format!("ATOM 1 C CA . GLY A 1 ? {x} 2 3 1 9 1 A 1"));
        assert_eq!(error.line(), Some(line));
        assert!(error.to_string().contains("Cartn_x"), "{error}");
    }
    let short = bad("ATOM 1 C CA . GLY A 1 ? 1 2 3 1 9 1 A");
    assert!(short.message().contains("mmCIF text is broken") && short.line() == Some(line));
    let open = bad("ATOM 1 C 'CA . GLY A 1 ? 1 2 3 1 9 1 A 1");
    assert!(open.message().contains("never closed") && open.line() == Some(line));
    let number = bad("ATOM 1 C CA . GLY A 1 ? 1 2 3 1 9 1x A 1");
    assert!(
        number.to_string().contains("auth_seq_id is '1x'"),
        "{number}"
    );
    let element = bad("HETATM 1 ? QQ . LIG A 1 ? 1 2 3 1 9 1 A 1");
    assert!(element.message().contains("element of atom QQ") && element.line() == Some(line));
    let column = read_text(
        &HEAD
            .replace("Cartn_z", "other")
            .replace("data_X", "data_X\n#"),
        "",
    );
    assert!(column.unwrap_err().message().contains("no atoms"));
    let row = "ATOM 1 C CA . GLY A 1 ? 1 2 3 1 9 1 A 1\n";
    let column = read_text(&format!("{}{row}", HEAD.replace("Cartn_z", "other")), "").unwrap_err();
    assert!(column.to_string().contains("no column Cartn_z"), "{column}");
    let none = read_text("data_x\n_cell.a 1\n", "").unwrap_err();
    assert!(none.message().contains("no atoms"), "{none}");
}

#[test]
fn mmcif_under_a_pdb_name_is_known_by_its_content() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pdb");
    std::fs::write(
        &path,
        format!("{HEAD}ATOM 1 C CA . GLY A 1 ? 1 2 3 1 9 1 A 1\n"),
    )
    .unwrap();
    let molecule = read(&InputSpec::whole(&path), &ReadOptions::default()).unwrap();
    assert_eq!(molecule.format, Format::Mmcif);
}

/// A unit test of the reader holds that their time grows with their number alone.
#[test]
fn many_residues_in_a_chain_are_all_counted() {
    let waters: String = (1..=200_000)
        .map(|number| format!("HETATM {number} O O . HOH A . ? 1 2 3 1 9 {number} W 1\n"))
        .collect();
    let file = format!("{HEAD}ATOM 0 C CA . GLY A 1 ? 1 2 3 1 9 -7 A 1\n{waters}");
    let molecule = read_text(&file, ":A,W").unwrap();
    let dropped: usize = molecule.report.dropped.iter().map(|one| one.atoms).sum();
    assert_eq!((molecule.atoms.len(), dropped), (1, 200_000));
}

#[test]
fn both_formats_give_the_same_atoms() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/1ppe_receptor_unbound.pdb");
    let from_pdb = read(&InputSpec::whole(example), &ReadOptions::default()).unwrap();
    let mut text = Vec::new();
    write_molecule(&mut text, Format::Mmcif, &from_pdb, &[]).unwrap();
    let from_cif = read_text(std::str::from_utf8(&text).unwrap(), "").unwrap();
    assert_eq!(from_pdb.atoms.len(), 1628);
    for (a, b) in from_pdb.atoms.iter().zip(&from_cif.atoms) {
        // To the bit, positions included: only the line differs.
        let mut moved = b.clone();
        moved.line = a.line;
        assert_eq!(a, &moved);
    }
}

/// PyMOL writes each object as a data block: for a chain in the second one the error said only "the file has only A".
#[test]
fn a_chain_of_a_block_that_was_not_read_is_answered_with_the_block() {
    let atom = |chain: &str| format!("ATOM 1 C CA . GLY {chain} 1 ? 1 2 3 1 9 1 {chain} 1\n");
    let second = HEAD.replacen("data_", "data_second_", 1);
    let file = format!("{HEAD}{}{second}{}", atom("A"), atom("B"));
    let error = read_text(&file, ":B").unwrap_err().to_string();
    assert!(
        error.contains("only A") && error.contains("data_second_"),
        "{error}"
    );
}
