//! Statements that are read, and statements that are refused by line and column.

use super::*;
use crate::test_molecules::molecules;

fn read(text: &str) -> Result<Vec<NamedRestraint>, Error> {
    let [receptor, ligand] = molecules();
    let read = parse(text, [&receptor, &ligand], TblBounds::Written)?;
    Ok(read.list)
}

/// The atoms of a selection of the receptor, by residue and name.
fn chosen(selection: &str) -> Result<Vec<String>, Error> {
    let [receptor, _] = molecules();
    let restraints = read(&format!("assign {selection} (segid B) 3 3 0"))?;
    let [atoms, _] = &restraints[0].pairs[0];
    let atoms = atoms.iter().map(|&index| &receptor.atoms[index]);
    let name = |atom: &knotdock_structures::molecule::Atom| {
        let insertion = atom.insertion_code.map_or_else(String::new, String::from);
        format!("{}{insertion}.{}", atom.residue_number, atom.name)
    };
    Ok(atoms.map(name).collect())
}

#[test]
fn a_statement_is_a_restraint() {
    let read = read(
        "! AIR\nASSIgn (resid 10 and segid A)\n  { two } (resi 21 and name ca and segi B)\n 5.0 2.0 1.5 ! Å\n\
         assi (chain B and resid 20 and name CA) (resid 11 and name CB and segid A) 2 2 0\n",
    )
    .unwrap();
    let expected =
        |name: &str, line, pair: [&[usize]; 2], [lower, target, upper]: [f64; 3]| NamedRestraint {
            name: name.to_owned(),
            line,
            pairs: vec![pair.map(<[usize]>::to_vec)],
            lower,
            target: Some(target),
            upper,
            written_upper: upper,
        };
    assert_eq!(
        read,
        [
            expected("restraint 1", 2, [&[0, 1, 2, 3], &[6]], [3.0, 5.0, 6.5]),
            // The first selection is the ligand's.
            expected("restraint 2", 5, [&[8], &[1]], [0.0, 2.0, 2.0]),
        ]
    );
}

#[test]
fn alternatives_and_what_aria_writes_are_read() {
    let text = "assign {1} ((segid A and resid 10 and name CA)) ((segid B and resid 20 and name CA)) 3.0 1.0 2.0 \
        peak 12 weight 0.1E+01 volume 0.35E+00 ppm1 8.25 ppm2 4.1 CV 1\n\
        OR {1} ((segid B and resid 21 and name CA)) ((segid A and resid 10 and name CA))\n\
        or (segid A and resid 10 and name CA) (segid B and resid 20 and name CA)\n\
        assign (segid D and name CB) (segid B and name CB and resid 21) 1 1 0";
    let read = read(text).unwrap();
    // The last alternative is the first.
    assert_eq!(read[0].pairs, [[vec![1], vec![1]], [vec![1], vec![6]]]);
    assert_eq!((read[0].lower, read[0].upper), (2.0, 5.0));
    assert_eq!((read[1].line, read.len()), (4, 2));
}

#[test]
fn tests_pick_what_they_name() {
    for (selection, expected) in [
        ("(resid 10 and segid A)", "10.N 10.CA 10.C 10.CB"),
        ("(resid 10 and segid A and hydrogen)", "10.H"),
        ("(resid 10 and segid A and name h#)", "10.H"),
        (
            "(resid 10 and segid A and name H or resid 11 and segid A and name CA)",
            "11.CA",
        ),
        ("(resname LYS and segid A and name C%)", "10.CA 10.CB"),
        ("(atom A 11 C*)", "11.CA 11.C 11.CB"),
        ("(atom A 1+ CA)", "10.CA 11.CA"),
        ("(segid A and name CA and resid 11:52)", "11.CA 52.CA"),
        ("(segid A and name CA and resid 52 : 52a)", "52.CA 52A.CA"),
        ("(segid A and name CA and resid 52a)", "52A.CA"),
        ("(segid A and name CA and resid 5*)", "52.CA 52A.CA"),
        ("(segid A and name CA and resid = \"52\")", "52.CA"),
        ("(resid -3 and segid D)", "-3.CA -3.CB"),
        ("(segid D and resid -5:-2 and name CA)", "-3.CA"),
        ("(segid \"D\" and all)", "-3.CA -3.CB"),
        ("(segid d)", "-3.CA -3.CB"),
    ] {
        let chosen = chosen(selection).unwrap().join(" ");
        assert_eq!(chosen, expected, "{selection}");
    }
}

/// `not` binds more than `and`, and `and` more than `or`; parentheses change it.
#[test]
fn operators_bind_as_in_cns() {
    for (selection, expected) in [
        (
            "(segid D and name CA or segid D and name CB)",
            "-3.CA -3.CB",
        ),
        (
            "(segid D and (name CA or name CB) and not name CA)",
            "-3.CB",
        ),
        ("(not name CA and segid D)", "-3.CB"),
        ("(segid D and not not name CA)", "-3.CA"),
        ("(segid D and not (name CA or name N))", "-3.CB"),
        (
            "(segid D and name CB or segid A and name CA and resid 10)",
            "10.CA -3.CB",
        ),
        (
            "(segid D and (name CB or segid A) and (name CA or name CB))",
            "-3.CB",
        ),
        ("(((segid D)and((name CA))))", "-3.CA"),
    ] {
        assert_eq!(
            chosen(selection).unwrap().join(" "),
            expected,
            "{selection}"
        );
    }
}

/// Chains that only one molecule has decide; of names that differ by case the one as written is meant.
#[test]
fn chains_decide_the_molecule() {
    let pair = |first: &str, second: &str| {
        let text = format!("assign {first} {second} 3 3 0");
        read(&text).map(|read| read[0].pairs[0].clone())
    };
    assert_eq!(
        pair("(segid D)", "(segid b)"),
        Ok([vec![15, 16], vec![8, 9]])
    );
    assert_eq!(
        pair("(segid b)", "(segid D)"),
        Ok([vec![15, 16], vec![8, 9]])
    );
    assert_eq!(
        pair("(segid D)", "(segid b and name \"O5'\")"),
        Ok([vec![15, 16], vec![9]])
    );
    for blank in ["_", "\"\"", "\"    \""] {
        let ligand = pair("(segid D)", &format!("(segid {blank})"));
        assert_eq!(ligand, Ok([vec![15, 16], vec![11]]));
    }
    // No chain is needed where the rest decides.
    assert_eq!(
        pair("(resid 11 and name CA)", "(resid 7)"),
        Ok([vec![6], vec![11]])
    );
}

#[test]
fn malformed_files_are_refused_by_line_and_column() {
    let nested = format!("assign {}segid A", "(".repeat(100_000));
    let negated = format!("assign ({} segid A)", "not ".repeat(100_000));
    let deep = "the selection is nested more than 100 deep";
    for (text, place, message) in [
        (
            "noe\nassign",
            [1, 1],
            "there must be a statement that begins with `assign`, not `noe`",
        ),
        (
            "assign resid 10",
            [1, 8],
            "there must be a selection in parentheses, not `resid`",
        ),
        (
            "assign\n\n",
            [1, 7],
            "there must be a selection in parentheses, not the end of the file",
        ),
        (
            "assign ()",
            [1, 9],
            "there must be a test such as `resid 10`, not `)`",
        ),
        (
            "assign (resid 10 segid A)",
            [1, 18],
            "there must be `and`, `or` or `)`, not `segid`",
        ),
        (
            "assign (resid 10 and",
            [1, 21],
            "there must be a test such as `resid 10`, not the end of the file",
        ),
        (
            "assign (resid 10\n",
            [1, 17],
            "there must be `and`, `or` or `)`, not the end of the file",
        ),
        (
            "assign (resid)",
            [1, 14],
            "there must be the number of a residue, not `)`",
        ),
        (
            "assign (name (CA))",
            [1, 14],
            "there must be the name of an atom, not `(`",
        ),
        (
            "assign (resid 10 around 5)",
            [1, 18],
            "there must be `and`, `or` or `)`, not `around`",
        ),
        (
            "assign (bonded 10)",
            [1, 9],
            "there must be a test such as `resid 10`, not `bonded`",
        ),
        (
            "assign (segid A:B)",
            [1, 16],
            "there must be `and`, `or` or `)`, not `:`",
        ),
        (
            "assign (resid 20:10)",
            [1, 15],
            "`20:10` is no range of residues",
        ),
        (
            "assign (resid 20 : CA)",
            [1, 15],
            "`20 : CA` is no range of residues",
        ),
        (
            "! a\n{ b\n",
            [2, 1],
            "the comment that begins here does not end",
        ),
        (
            "assign (segid \"A)\n",
            [1, 15],
            "the quoted word that begins here does not end",
        ),
        (&nested, [1, 108], deep),
        (&negated, [1, 405], deep),
        (
            "assign (resid 99 and segid A) (segid B) 2 2 0",
            [1, 8],
            "(resid 99 and segid A) selects no atom; the receptor has A:10-52, D:-3--3, S:1-1; the ligand has _:7-7",
        ),
        (
            "assign (segid D) (resid 21 and name CX and segid B) 2 2 0",
            [1, 18],
            "(resid 21 and name CX and segid B) selects no atom; B:21 of the ligand has N, CA, CB",
        ),
        (
            "assign (resid 1 and segid S) (segid B) 2 2 0",
            [1, 8],
            "(resid 1 and segid S) selects atoms of chain S, and both receptor and ligand have",
        ),
        (
            "assign (segid A or\nsegid B) (segid B) 2 2 0",
            [1, 8],
            "(segid A or segid B) selects atoms of both molecules: of the receptor's chain A and the ligand's chain B",
        ),
        (
            "\nassign (segid A) (segid D) 2 2 0",
            [2, 1],
            "the restraint is within one molecule, which docking does not change",
        ),
        (
            "\nassign (segid B) (segid b) 2 2 0\nassign (segid B) (segid B) 2 2 0",
            [2, 1],
            "all 2 restraints are within one molecule, which docking does not change",
        ),
        (
            "assign (segid A) (segid B) 2 2",
            [1, 31],
            "there must be three distances",
        ),
        (
            "assign (segid A) (segid B) 2 2 assign",
            [1, 32],
            "the tolerance above is `assign`",
        ),
        (
            "assign (segid A) (segid B) 2 x 0",
            [1, 30],
            "the tolerance below is `x`",
        ),
        (
            "assign (segid A) (segid B) nan 2 0",
            [1, 28],
            "the distance is `nan`",
        ),
        (
            "assign (segid A) (segid B) inf 2 0",
            [1, 28],
            "the distance is `inf`",
        ),
        (
            "assign (segid A) (segid B) 2 -2 0",
            [1, 30],
            "the tolerance below is `-2`",
        ),
        (
            "assign (segid A) (segid B) 0 0 0",
            [1, 1],
            "the upper bound is 0",
        ),
        (
            "assign (segid A) (segid B) 2 2 0 weight 0.5",
            [1, 41],
            "the weight is `0.5`",
        ),
        (
            "assign (segid A) (segid B) 2 2 0 volume x",
            [1, 41],
            "there must be a number, not `x`",
        ),
        (
            "assign (segid A) (segid B) 2 2 0 or (segid A)",
            [1, 46],
            "there must be a selection in parentheses",
        ),
        (
            "assign (segid A) (segid B) 2 2 0 5",
            [1, 34],
            "there must be a statement that begins with `assign`, not `5`",
        ),
        (
            "assign (segid A) (segid B) 2 2 0 }",
            [1, 34],
            "there must be a { before it",
        ),
    ] {
        let error = read(text).unwrap_err();
        let shown = text.get(..80).unwrap_or(text);
        let [line, column] = place;
        assert_eq!(error.line(), Some(line), "{shown}");
        let message_with_place = error.message();
        assert!(message_with_place.starts_with(message), "{shown}: {error}");
        assert!(
            message_with_place.ends_with(&format!("(column {column})")),
            "{shown}: {error}"
        );
        assert!(error.remedy().is_some());
    }
}

/// HADDOCK writes distances within a molecule beside those between two, and one of them stopped a run. Of an ambiguous
/// restraint one alternative within a molecule may be what satisfies it.
#[test]
fn restraints_within_a_molecule_are_left_out() {
    let [receptor, ligand] = molecules();
    let text = "assign (segid A and resid 10) (segid A and resid 52) 14 1 1\n\
        assign (segid A and resid 10) (segid B and resid 20) 2 2 0\n\
        assign (segid B and resid 20) (segid B and resid 21) 2 2 0 or (segid A) (segid B)\n\
        assign (segid A) (segid B) 2 2 0 or (segid D) (segid A)";
    let read = parse(text, [&receptor, &ligand], TblBounds::Written).unwrap();
    assert_eq!((read.list.len(), read.within_one_molecule), (1, 3));
    // By its place in the file.
    assert_eq!(read.list[0].name, "restraint 2");
    let faulty = format!("{text}\nassign (segid A) (segid D) 2 x 0");
    assert!(parse(&faulty, [&receptor, &ligand], TblBounds::Written).is_err());
}

/// Bounds are widened for the hydrogens that a selection holds, not for those that it leaves out.
#[test]
fn bounds_are_widened_for_the_hydrogens_selected() {
    let [receptor, ligand] = molecules();
    let upper = |first: &str, second: &str, bounds: TblBounds| {
        let text = format!("assign {first} {second} 2 2 0");
        let read = parse(&text, [&receptor, &ligand], bounds).unwrap();
        assert_eq!((read.list[0].lower, read.list[0].written_upper), (0.0, 2.0));
        read.list[0].upper
    };
    let whole = "(segid A and resid 10)";
    for (first, sides) in [
        (whole, 2),
        ("(segid A and resid 10 and not name CA)", 2),
        ("(segid A and resid 10 and (name CB or name HB#))", 2),
        ("(segid A and resid 10 and (name N or name HN))", 2),
        ("(segid A and resid 10 and name CA)", 1),
        ("(segid A and resid 10 and name C*)", 1),
        ("(segid A and resid 10 and not hydrogen)", 1),
        // The only atom of this name, which is in the file.
        ("(segid A and resid 10 and name H)", 1),
    ] {
        let found = upper(first, "(segid B and resid 20)", TblBounds::Widened);
        assert_eq!(found, widened(2.0, sides), "{first}");
    }
    let alpha = "(segid B and resid 20 and name CA)";
    assert_eq!(upper(whole, alpha, TblBounds::Widened), widened(2.0, 1));
    let alphas = upper("(segid A and name CA)", alpha, TblBounds::Widened);
    assert!((alphas - 2.0).abs() < 1e-12);
    assert_eq!(
        upper(
            whole,
            whole.replace('A', "B").replace("10", "20").as_str(),
            TblBounds::Written
        ),
        2.0
    );
    // One alternative with hydrogens is enough.
    let text = format!("assign (segid A and name CA) {alpha} 2 2 0 or {whole} (segid B)");
    let read = parse(&text, [&receptor, &ligand], TblBounds::Widened).unwrap();
    assert_eq!(read.list[0].upper, widened(2.0, 2));
}

/// A hundred levels are read, and one more is refused.
#[test]
fn nesting_has_a_bound() {
    let nested = |depth: usize| {
        format!(
            "assign {}segid A{} (segid B) 2 2 0",
            "(".repeat(depth),
            ")".repeat(depth)
        )
    };
    assert!(read(&nested(100)).is_ok());
    assert!(read(&nested(101)).is_err());
    // Long chains are no nesting.
    let long = format!(
        "assign (segid A{}) (segid B) 2 2 0",
        " or segid D".repeat(100_000)
    );
    assert!(read(&long).is_ok());
}
