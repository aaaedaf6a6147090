//! Names in files that a terminal or a spreadsheet would obey: escape sequences are shown and not sent, formulas are
//! quoted and not run.

use crate::molecules;
use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;

/// Clears the screen and retitles the window; the second is a C1 control, the third turns the direction of writing.
const HOSTILE: [&str; 3] = ["\u{1b}[2J", "\u{9b}31m", "\u{202e}"];

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = cargo_bin_cmd!("knotdock");
    let command = command.current_dir(folder).args(arguments);
    command.output().unwrap()
}

/// Runs a command for people and for programs; neither may send a control character. Returns all that was written.
fn sends_nothing(folder: &Path, arguments: &[&str]) -> String {
    let mut all = String::new();
    for json in [&[][..], &["--json"][..]] {
        let output = run(folder, &[arguments, json].concat());
        let code = output.status.code();
        assert!(matches!(code, Some(0 | 2)), "{arguments:?} {code:?}");
        for stream in [output.stdout, output.stderr] {
            let text = String::from_utf8(stream).unwrap();
            let sent = text.chars().find(|&c| {
                c.is_control() && c != '\n' && c != '\t' || ('\u{202a}'..='\u{202e}').contains(&c)
            });
            assert_eq!(sent, None, "{arguments:?}: {text:?}");
            all += &text;
        }
    }
    all
}

const CIF: &str = "data_x\nloop_\n_atom_site.id\n_atom_site.type_symbol\n_atom_site.label_atom_id\n\
    _atom_site.label_comp_id\n_atom_site.label_asym_id\n_atom_site.auth_seq_id\n_atom_site.Cartn_x\n\
    _atom_site.Cartn_y\n_atom_site.Cartn_z\n";

/// A chain name such as ESC [2J cleared the screen of whoever inspected the file.
#[test]
fn control_characters_of_files_do_not_reach_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("receptor.pdb"), molecules::receptor()).unwrap();
    fs::write(folder.join("ligand.pdb"), molecules::ligand()).unwrap();
    for hostile in HOSTILE {
        let escaped = hostile.chars().next().unwrap().escape_unicode().to_string();
        let json = format!("\\u{:04x}", u32::from(hostile.chars().next().unwrap()));
        let is_shown = |text: &str| {
            assert!(text.contains(&escaped) || text.contains(&json), "{text}");
        };
        // A chain, a residue and an atom of mmCIF; what is not ASCII is refused with an excerpt.
        for row in [
            format!("1 C CA GLY '{hostile}' 1 1 2 3\n"),
            format!("1 C CA '{hostile}' A 1 1 2 3\n"),
            format!("1 C '{hostile}' GLY A 1 1 2 3\n"),
            format!("1 C CA GLY A 1 {hostile} 2 3\n"),
        ] {
            fs::write(folder.join("x.cif"), format!("{CIF}{row}")).unwrap();
            is_shown(&sends_nothing(folder, &["inspect", "x.cif"]));
        }
        let header = format!("HEADER    {hostile}\n{}", molecules::ligand());
        fs::write(folder.join("x.pdb"), header).unwrap();
        sends_nothing(folder, &["inspect", "x.pdb"]);
        let columns = format!("ATOM      1  CA  GLY A   1    {hostile:<8}   2.000   3.000\n");
        fs::write(folder.join("x.pdb"), columns).unwrap();
        sends_nothing(folder, &["inspect", "x.pdb"]);
        // A group and a word of a mesh.
        let obj = format!("g {hostile}\nv 0 0 {hostile}\n");
        fs::write(folder.join("x.obj"), obj).unwrap();
        sends_nothing(folder, &["sample", "x.obj"]);
        // A cell of a table of pairs and one of poses.
        let pairs = format!("receptor,ligand\n{hostile}.pdb,ligand.pdb\n");
        fs::write(folder.join("pairs.csv"), pairs).unwrap();
        sends_nothing(folder, &["batch", "pairs.csv", "-o", "out"]);
        let poses = format!("rank,qw,qx,qy,qz,tx,ty,tz\n1,1,0,0,0,0,0,{hostile}\n");
        fs::write(folder.join("poses.csv"), poses).unwrap();
        let evaluate = ["evaluate", "poses.csv", "--native", "ligand.pdb"];
        sends_nothing(folder, &evaluate);
        // A file's name, a word of the command line, a value of an option.
        let name = format!("{hostile}.pdb");
        is_shown(&sends_nothing(folder, &["inspect", &name]));
        for arguments in [
            vec!["inspect", "ligand.pdb", "--waters", hostile],
            vec!["dock", "receptor.pdb", "ligand.pdb", "--spacing", hostile],
            vec![hostile],
            vec!["inspect", "ligand.pdb", hostile],
        ] {
            is_shown(&sends_nothing(folder, &arguments));
        }
    }
}

/// A chain `=cmd|...` was a formula for the spreadsheet that opened the table of atoms.
#[test]
fn names_that_are_formulas_are_quoted_in_tables() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let rows: String = ["=1+1", "@A", "+B", "-C", "-7"]
        .iter()
        .zip(1..)
        .map(|(chain, number)| format!("{number} C CA GLY '{chain}' {number} {number} -2 3\n"))
        .collect();
    fs::write(folder.join("x.cif"), format!("{CIF}{rows}")).unwrap();
    let output = run(folder, &["inspect", "x.cif", "--atoms", "atoms.csv"]);
    assert!(output.status.success());
    let mut table = csv::Reader::from_path(folder.join("atoms.csv")).unwrap();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    let chains: Vec<&str> = rows.iter().map(|row| &row[5]).collect();
    assert_eq!(chains, ["'=1+1", "'@A", "'+B", "'-C", "-7"]);
    // Numbers stay numbers.
    assert!(rows.iter().all(|row| &row[10] == "-2"));
}
