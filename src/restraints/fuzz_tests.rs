//! Any bytes are read or refused, and restraints that are written as a file come back.

use knotdock_structures::molecule::Molecule;
use proptest::prelude::*;

use super::{CROSSLINKS, NamedRestraint, TblBounds, parse};
use crate::test_molecules::molecules;

/// Reads a text in both formats; what is read must be usable.
fn reads_or_refuses(text: &str) {
    let [receptor, ligand] = molecules();
    for (is_tbl, crosslink) in [(true, None), (false, None), (false, Some(CROSSLINKS[0]))] {
        let bounds = TblBounds::Widened;
        match parse(text, is_tbl, [&receptor, &ligand], crosslink, bounds) {
            Ok(restraints) => {
                for restraint in restraints.list {
                    check(&restraint, [&receptor, &ligand]);
                }
            }
            Err(error) => {
                let ends = text.bytes().filter(|byte| b"\r\n".contains(byte));
                let lines = 1 + ends.count() as u64;
                let line = error.line();
                assert!(
                    line.is_none_or(|line| (1..=lines).contains(&line)),
                    "{line:?}"
                );
                assert!(!error.message().is_empty() && error.remedy().is_some());
            }
        }
    }
}

fn check(restraint: &NamedRestraint, molecules: [&Molecule; 2]) {
    assert!(!restraint.pairs.is_empty() && !restraint.name.is_empty() && restraint.line > 0);
    for pair in &restraint.pairs {
        for (atoms, molecule) in pair.iter().zip(molecules) {
            assert!(!atoms.is_empty() && atoms.is_sorted_by(|a, b| a < b));
            assert!(atoms.iter().all(|&atom| atom < molecule.atoms.len()));
        }
    }
    let target = restraint.target.unwrap_or(restraint.lower);
    assert!(0.0 <= restraint.lower && restraint.lower <= target && target <= restraint.upper);
    assert!(restraint.upper > 0.0 && restraint.upper.is_finite());
}

/// Words of both formats, so that many mixtures come near to valid files.
fn word() -> impl Strategy<Value = String> {
    let words = [
        "assign", "resid", "segid", "name", "resname", "chain", "atom", "all", "and", "or", "not",
        "hydrogen", "(", ")", "(", ")", ":", "\"", "{", "}", "!", "\n", "\r\n", "A", "B", "b", "S",
        "10", "20", "52A", "-3", "CA", "C*", "#", "%", "+", "2.0", "0.0", "1e9", "nan", "weight",
        "1", "receptor", "ligand", "upper", "lower", "target", "group", ",", ",", ";", "\t",
        "A:10", "B:20.CA", "A:10-52", "sep=;", "\u{feff}", "é", "\0",
    ];
    prop::sample::select(words.to_vec()).prop_map(str::to_owned)
}

/// A residue of each side with the names of its atoms.
const RESIDUES: [&[(&str, i64, &[&str])]; 2] = [
    &[
        ("A", 10, &["N", "CA", "C", "CB"]),
        ("A", 11, &["N", "CA", "C", "CB"]),
        ("D", -3, &["CA", "CB"]),
    ],
    &[
        ("B", 20, &["N", "CA", "C", "CB"]),
        ("B", 21, &["N", "CA", "CB"]),
        ("b", 20, &["CA", "O5'"]),
    ],
];

/// A residue or atom of a side, by places in [`RESIDUES`].
fn site(side: usize) -> impl Strategy<Value = (&'static str, i64, Option<&'static str>)> {
    let residues = RESIDUES[side];
    (0..residues.len(), prop::option::of(0..2usize)).prop_map(move |(residue, atom)| {
        let (chain, number, names) = residues[residue];
        (chain, number, atom.map(|atom| names[atom]))
    })
}

/// The atoms of a site, found one by one.
fn atoms(molecule: &Molecule, (chain, number, name): (&str, i64, Option<&str>)) -> Vec<usize> {
    let atoms = molecule.atoms.iter().enumerate();
    let is_meant = |atom: &knotdock_structures::molecule::Atom| {
        atom.chain == chain
            && atom.residue_number == number
            && name.map_or(!atom.is_hydrogen(), |name| atom.name == name)
    };
    atoms
        .filter(|(_, atom)| is_meant(atom))
        .map(|(index, _)| index)
        .collect()
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        reads_or_refuses(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn any_text_is_read_or_refused(text in any::<String>()) {
        reads_or_refuses(&text);
        reads_or_refuses(&format!("receptor,ligand,upper\n{text}"));
        reads_or_refuses(&format!("assign ({text}"));
    }

    #[test]
    fn any_words_are_read_or_refused(words in prop::collection::vec(word(), 0..40)) {
        for gap in ["", " "] {
            let text = words.join(gap);
            reads_or_refuses(&text);
            reads_or_refuses(&format!("receptor,ligand\n{text}"));
            reads_or_refuses(&format!("assign (segid A) (segid B) 2 2 0 {text}"));
            reads_or_refuses(&format!("assign ({text}) (segid B) 2 2 0"));
        }
    }

    /// Files of rows and of statements with one meaning are read alike, and with that meaning.
    #[test]
    fn what_is_written_comes_back(
        rows in prop::collection::vec((site(0), site(1), 0.0..9.0f64, 0.0..9.0f64, any::<bool>()), 1..20),
    ) {
        let [receptor, ligand] = molecules();
        let mut table = "upper,target,lower,ligand,receptor\n".to_owned();
        let mut statements = String::new();
        let mut expected = Vec::new();
        for (own, other, lower, more, exchanged) in rows {
            let target = lower + 0.1 + more;
            let upper = target + more;
            let field = |(chain, number, name): (&str, i64, Option<&str>)| {
                format!("{chain}:{number}{}", name.map_or_else(String::new, |name| format!(".{name}")))
            };
            table += &format!("{upper},{target},{lower},{},{}\n", field(other), field(own));
            let selection = |(chain, number, name): (&str, i64, Option<&str>)| {
                let name = name.map_or_else(String::new, |name| format!(" and name {name}"));
                format!("(segid {chain} and resid {number}{name})")
            };
            let mut selections = [selection(own), selection(other)];
            if exchanged {
                selections.reverse();
            }
            statements += &format!("assign {} {target} {} {more}\n", selections.join("\n  "), target - lower);
            expected.push(([atoms(&receptor, own), atoms(&ligand, other)], [lower, target, upper]));
        }
        for (is_tbl, text) in [(true, statements), (false, table)] {
            let bounds = TblBounds::Written;
            let read = parse(&text, is_tbl, [&receptor, &ligand], None, bounds);
            let read = read.unwrap().list;
            prop_assert_eq!(read.len(), expected.len());
            for (restraint, (pair, bounds)) in read.iter().zip(&expected) {
                check(restraint, [&receptor, &ligand]);
                prop_assert_eq!(&restraint.pairs, &vec![pair.clone()]);
                let own = [restraint.lower, restraint.target.unwrap(), restraint.upper];
                for (own, written) in own.into_iter().zip(bounds) {
                    prop_assert!((own - written).abs() < 1e-12);
                }
            }
        }
    }
}
