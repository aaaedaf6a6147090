//! Tables that are read, and tables that are refused by line.

use super::*;
use crate::restraints::CROSSLINKS;
use crate::test_molecules::molecules;

fn read_with(text: &str, crosslink: Option<Crosslink>) -> Result<Vec<NamedRestraint>, Error> {
    let [receptor, ligand] = molecules();
    parse(text.into(), [&receptor, &ligand], crosslink)
}

fn read(text: &str) -> Result<Vec<NamedRestraint>, Error> {
    read_with(text, None)
}

// Places of atoms: of the receptor A:10 has 0 to 4 (the last a hydrogen), A:11 has 5 to 8; of the ligand B:20 has 0 to
// 4 (the last a hydrogen), B:21 has 5 to 7.

#[test]
fn a_row_is_a_restraint() {
    let read = read("receptor,ligand,lower,target,upper,group\nA:10,B:21.CA,2,5,8.5,\n").unwrap();
    let expected = NamedRestraint {
        name: "A:10 - B:21.CA".to_owned(),
        line: 2,
        pairs: vec![[vec![0, 1, 2, 3], vec![6]]],
        lower: 2.0,
        target: Some(5.0),
        upper: 8.5,
        written_upper: 8.5,
    };
    assert_eq!(read, [expected]);
}

#[test]
fn columns_go_by_name_and_comments_are_skipped() {
    let text = "# of March\n\nupper, Ligand ,receptor\n8,B:21.CA,A:10.CA\n  \n # no more\n\
        9,B:20.CA,\"A:10.CA,11.CA\"\n,,\n";
    let read = read(text).unwrap();
    assert_eq!(read.len(), 2);
    assert_eq!((read[0].line, read[1].line), (4, 7));
    assert_eq!(read[0].pairs, [[vec![1], vec![6]]]);
    assert_eq!(read[1].pairs, [[vec![1, 6], vec![1]]]);
    assert_eq!(
        (read[0].lower, read[0].target, read[0].upper),
        (0.0, None, 8.0)
    );
}

#[test]
fn tables_of_spreadsheets_are_read() {
    let plain = read("receptor,ligand,upper\nA:10,B:21,8\n").unwrap();
    for text in [
        "receptor;ligand;upper\nA:10;B:21;8\n",
        "receptor\tligand\tupper\nA:10\tB:21\t8\n",
        "\u{feff}\"Receptor\";\"LIGAND\";\"upper\"\n\"A:10\";\"B:21\";\"8\"\n;;\n",
    ] {
        assert_eq!(read(text).unwrap(), plain, "{text:?}");
    }
}

#[test]
fn rows_of_a_group_are_one_restraint() {
    let text = "receptor,ligand,upper,group\nA:10.CA,B:20.CA,6,loop\nA:11.CA,B:20.CA,9,\n\
        A:10.CA,B:21.CA,6,loop\nA:10.CA,B:20.CA,6.0,loop\n";
    let read = read(text).unwrap();
    assert_eq!(read.len(), 2);
    assert_eq!((read[0].name.as_str(), read[0].line), ("loop", 2));
    // The last row says what the first does.
    assert_eq!(read[0].pairs, [[vec![1], vec![1]], [vec![1], vec![6]]]);
    assert_eq!(read[1].pairs, [[vec![6], vec![1]]]);
}

#[test]
fn a_preset_gives_atom_and_upper_bound() {
    let text = "receptor,ligand\nA:10,B:20\nA:10.CB,B:20\n";
    for crosslink in CROSSLINKS {
        let read = read_with(text, Some(crosslink)).unwrap();
        assert_eq!((read[0].lower, read[0].upper), (0.0, 30.0));
        assert_eq!(read[0].pairs, [[vec![1], vec![1]]]);
        assert_eq!(read[1].pairs, [[vec![3], vec![1]]]);
        let own = read_with(
            "receptor,ligand,upper\nA:10,B:20,25\nA:10,B:20,\n",
            Some(crosslink),
        );
        let uppers: Vec<f64> = own.unwrap().iter().map(|own| own.upper).collect();
        assert_eq!(uppers, [25.0, 30.0]);
    }
}

#[test]
fn malformed_tables_are_refused_by_line() {
    for (text, line, message) in [
        (
            "receptor,upper\nA:10,8\n",
            1,
            "there is no column `ligand`; the header has receptor, upper",
        ),
        (
            "# a\nreceptor,ligand,weight\n",
            2,
            "column `weight` is not known",
        ),
        (
            "receptor,ligand,ligand\n",
            1,
            "there are two columns `ligand`",
        ),
        ("A:10,B:20,8\n", 1, "column `a:10` is not known"),
        (
            "receptor,ligand,upper\n\nA:10,B:20\n",
            3,
            "the row has 2 fields and the header 3",
        ),
        (
            "receptor,ligand,upper\nA:10,A:11,B:20,8\n",
            2,
            "the row has 4 fields and the header 3",
        ),
        (
            "receptor,ligand,upper\nA:10,,8\n",
            2,
            "the row has no ligand",
        ),
        (
            "receptor,ligand,upper\n,B:20,8\n",
            2,
            "the row has no receptor",
        ),
        ("receptor,ligand\nA:10,B:20\n", 2, "the row has no upper"),
        (
            "receptor,ligand,upper\n\"A:10\n\",B:20,8\nA:10,B:20,x\n",
            4,
            "upper is `x`; it must be a number",
        ),
        (
            "receptor,ligand,upper\nA:10,B:20,nan\n",
            2,
            "upper is `nan`",
        ),
        (
            "receptor,ligand,upper\nA:10,B:20,inf\n",
            2,
            "upper is `inf`",
        ),
        (
            "receptor,ligand,lower,upper\nA:10,B:20,-1,8\n",
            2,
            "lower is `-1`",
        ),
        (
            "receptor,ligand,lower,upper\nA:10,B:20,9,8\n",
            2,
            "lower is 9, above upper, which is 8",
        ),
        (
            "receptor,ligand,target,upper\nA:10,B:20,9,8\n",
            2,
            "target is 9, outside the bounds 0 and 8",
        ),
        (
            "receptor,ligand,upper\nA:10,B:20,0\n",
            2,
            "the upper bound is 0",
        ),
        (
            "receptor,ligand,upper\nA:10,B:99,8\n",
            2,
            "the ligand has no residue B:99; it has _:7-7, B:20-21, S:1-1, b:20-20",
        ),
        (
            "receptor,ligand,upper\nB:20,A:10,8\n",
            2,
            "the receptor has no residue B:20",
        ),
        (
            "receptor,ligand,upper\nA:10,B:21.CX,8\n",
            2,
            "B:21 of the ligand has no atom CX; it has N, CA, CB",
        ),
        (
            "receptor,ligand,upper\nA:x,B:21,8\n",
            2,
            "receptor is `A:x`, which does not name residues or atoms",
        ),
        (
            "receptor,ligand,upper,group\nA:10,B:20,8,g\nA:11,B:20,9,g\n",
            3,
            "the bounds differ from those of group `g` on line 2",
        ),
    ] {
        let error = read(text).unwrap_err();
        assert_eq!(error.line(), Some(line), "{text:?}");
        assert!(error.message().starts_with(message), "{text:?}: {error}");
        assert!(error.remedy().is_some());
    }
}

#[test]
fn the_remedy_for_columns_names_all() {
    let error = read("receptor,ligand,weight\n").unwrap_err();
    assert!(
        error.remedy().unwrap().contains(&COLUMNS.names.join(", ")),
        "{error}"
    );
}

/// Rows of ambiguous restraints name few residues many times, and a look-up goes through all atoms.
#[test]
fn a_residue_is_looked_up_once() {
    let [receptor, ligand] = molecules();
    let mut rows = Rows::new([&receptor, &ligand], None);
    for line in 2..5 {
        rows.add(line, &["A:10", "B:20", "", "", "8", ""]).unwrap();
    }
    assert_eq!(rows.restraints.len(), 3);
    assert!(rows.sides.iter().all(|side| side.known_fields() == 1));
}
