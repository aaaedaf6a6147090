//! Records that are not in their columns, and atoms on top of one another.

#![cfg(feature = "molecule")]

use crate::pdb_text::{ATOM, Line, names, read_bytes, read_text, text};
use knotdock_structures::molecule::{AlternateLocation, InputSpec, Molecule, ReadOptions, read};

fn example(name: &str) -> String {
    let path = format!("{}/examples/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap()
}

/// The atom records of the free inhibitor, chain B, 29 residues and 221 atoms.
fn inhibitor() -> Vec<String> {
    let text = example("1ppe_ligand_unbound.pdb");
    let records = text.lines().filter(|line| line.starts_with("ATOM"));
    records.map(str::to_owned).collect()
}

fn joined(lines: &[String]) -> String {
    lines.iter().map(|line| format!("{line}\n")).collect()
}

fn warnings(molecule: &Molecule) -> String {
    molecule.report.warnings.join("\n")
}

/// Found by a user: a blank before the first record, as copying leaves it, cost the first atom and with it the charge
/// of the amino end, without a word.
#[test]
fn a_shifted_record_is_read_and_named() {
    let sound = read_text(&joined(&inhibitor())).unwrap();
    assert_eq!(sound.atoms.len(), 221);
    assert!(!warnings(&sound).contains("columns"));
    let changes: [fn(&str) -> String; 6] = [
        |line| format!(" {line}"),
        |line| format!("    {line}"),
        |line| format!("\t{line}"),
        |line| line.replace("ATOM  ", "atom  "),
        |line| line.replacen("ATOM      ", "ATOM     ", 1),
        |line| line.replacen("ATOM      ", "ATOM       ", 1),
    ];
    for change in changes {
        for ending in ["\n", "\r\n"] {
            let mut lines = inhibitor();
            lines[0] = change(&lines[0]);
            let molecule = read_text(&joined(&lines).replace('\n', ending)).unwrap();
            assert_eq!(molecule.atoms, sound.atoms, "{}", lines[0]);
            assert_eq!(molecule.labels(7.0).report.net_charge, -1.0);
            let warned = warnings(&molecule);
            assert!(
                warned.contains(
                    "1 atom record out of the columns of the format, the first at line 1"
                ),
                "{warned}"
            );
        }
    }
    // All of them, in a file whose name says nothing.
    let all: Vec<String> = inhibitor().iter().map(|line| format!("  {line}")).collect();
    let molecule = read_bytes("x", joined(&all).as_bytes(), "").unwrap();
    assert_eq!(molecule.atoms, sound.atoms);
    let small: Vec<String> = inhibitor()
        .iter()
        .map(|line| {
            let (head, chain, tail) = (&line[..21], &line[21..22], &line[22..]);
            format!("{}{chain}{}", head.to_lowercase(), tail.to_lowercase())
        })
        .collect();
    let molecule = read_bytes("x", joined(&small).as_bytes(), "").unwrap();
    assert_eq!(molecule.atoms, sound.atoms);
    assert!(warnings(&molecule).contains("221 atom records out of the columns"));
}

/// What holds an atom and cannot be moved to its columns is refused with its line, not left out.
#[test]
fn a_record_without_columns_is_refused() {
    for lost in [
        "ATOM 2 CA ARG B 1 -11.191 -5.512 -0.198 1.00 13.68 C",
        "ATOM\t2\tCA\tARG\tB\t1\t-11.191\t-5.512\t-0.198",
        " HETATM 2 ZN ZN B 301 -11.191 -5.512 -0.198",
    ] {
        let mut lines = inhibitor();
        lines[1] = lost.to_owned();
        let error = read_text(&joined(&lines)).unwrap_err();
        assert!(
            error.message().contains("does not stand in the columns"),
            "{error}"
        );
        assert_eq!(error.line(), Some(2));
        assert!(error.remedy().unwrap().contains("31-38"));
    }
    // Free text is none, whatever it begins with.
    let head = "Atom types after Bondi, radii 1.7 and 1.5\natoms: 221\nHETNAM     ZN ZINC\n";
    let molecule = read_text(&(head.to_owned() + &joined(&inhibitor()))).unwrap();
    assert_eq!(molecule.atoms.len(), 221);
}

/// Found by a user: a chain given twice, and a mutation beside the residue that it replaced, had all atoms counted
/// twice without a warning.
#[test]
fn atoms_of_two_chains_or_names_in_one_place_are_warned_of() {
    assert!(
        read_text(&joined(&inhibitor()))
            .unwrap()
            .report
            .warnings
            .is_empty()
    );
    let mut twice = inhibitor();
    twice.extend(inhibitor().iter().map(|line| line.replace(" B ", " C ")));
    let molecule = read_text(&joined(&twice)).unwrap();
    let warned = warnings(&molecule);
    assert!(
        warned.contains("221 atoms of chain C lie on atoms of chain B, and all are counted"),
        "{warned}"
    );
    // An alanine at the place and number of arginine 5.
    let mut mutated = inhibitor();
    let backbone = ["N", "CA", "C", "O", "CB"];
    let of_five = inhibitor()
        .into_iter()
        .filter(|line| line[22..26].trim() == "5" && backbone.contains(&line[12..16].trim()));
    mutated.extend(of_five.map(|line| line.replace("ARG", "ALA")));
    let molecule = read_text(&joined(&mutated)).unwrap();
    assert_eq!(molecule.atoms.len(), 226);
    let warned = warnings(&molecule);
    assert!(
        warned.contains("1 residue number holds two residues in one place (B 5 as ARG and ALA)"),
        "{warned}"
    );
}

fn at(residue: &'static str, name: &'static str, alternate: char, occupancy: f64, x: f64) -> Line {
    Line {
        residue,
        x,
        ..Line::at(1, name, alternate, occupancy)
    }
}

/// Found by a user: where one location has no letter its atoms were kept beside those of the lettered one.
#[test]
fn a_blank_location_beside_a_lettered_one_is_an_alternative() {
    let side_chain = |blank: f64, lettered: f64| {
        let lines = [
            at("SER", " N  ", ' ', 1.0, 0.0),
            at("SER", " CA ", ' ', 1.0, 1.5),
            at("SER", " CB ", ' ', blank, 3.0),
            at("SER", " OG ", ' ', blank, 4.4),
            at("SER", " CB ", 'B', lettered, 3.2),
            at("SER", " OG ", 'B', lettered, 4.9),
        ];
        let molecule = read_text(&text(&lines)).unwrap();
        let places: Vec<f64> = molecule.atoms.iter().map(|atom| atom.position[0]).collect();
        let choice = molecule.report.altered.alternate_locations[0].clone();
        (places, choice.chosen, choice.offered)
    };
    let of_blank = (vec![0.0, 1.5, 3.0, 4.4], ' ', " B".to_owned());
    assert_eq!(side_chain(0.6, 0.4), of_blank);
    assert_eq!(side_chain(0.5, 0.5), of_blank);
    let of_letter = (vec![0.0, 1.5, 3.2, 4.9], 'B', " B".to_owned());
    assert_eq!(side_chain(0.4, 0.6), of_letter);
    // A letter that was left out: the blank atom belongs to the location that lacks it (biopython's disordered.pdb).
    let lines = [
        at("ARG", " CZ ", ' ', 0.5, 0.0),
        at("ARG", " CZ ", 'B', 0.5, 2.0),
        at("ARG", " NH1", 'A', 0.5, 1.3),
        at("ARG", " NH1", 'B', 0.5, 3.3),
    ];
    let molecule = read_text(&text(&lines)).unwrap();
    let places: Vec<f64> = molecule.atoms.iter().map(|atom| atom.position[0]).collect();
    assert_eq!(places, [0.0, 1.3]);
    // Two residues, of which the blank one has an atom that the other lacks.
    let lines = [
        at("SER", " CA ", ' ', 0.3, 1.5),
        at("SER", " OG ", ' ', 0.3, 4.4),
        at("ALA", " CA ", 'B', 0.7, 1.6),
    ];
    let molecule = read_text(&text(&lines)).unwrap();
    assert_eq!(names(&molecule), ["CA"]);
    assert_eq!(molecule.atoms[0].residue_name, "ALA");
    // The letter that the user asks for.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pdb");
    let both = [
        at("SER", " OG ", ' ', 0.9, 4.4),
        at("SER", " OG ", 'B', 0.1, 4.9),
    ];
    std::fs::write(&path, text(&both)).unwrap();
    let options = ReadOptions {
        altloc: AlternateLocation::Named('B'),
        ..ReadOptions::default()
    };
    let spec = InputSpec::whole(&path);
    let molecule = read(&spec, &options).unwrap();
    assert_eq!(molecule.atoms[0].position[0], 4.9);
    // Atoms that no letter shows elsewhere stay, as ever.
    let partly = [
        at("SER", " CA ", ' ', 1.0, 1.5),
        at("SER", " OG ", 'A', 0.5, 4.4),
        at("SER", " OG ", 'B', 0.5, 4.9),
    ];
    assert_eq!(names(&read_text(&text(&partly)).unwrap()), ["CA", "OG"]);
    // A water that has the number of a residue is no alternative to it.
    let water = Line {
        record: "HETATM",
        ..at("LIG", " CA ", 'A', 0.4, 30.0)
    };
    let separate = [ATOM, water];
    assert_eq!(read_text(&text(&separate)).unwrap().atoms.len(), 2);
}

/// Found by a user: HADDOCK merges a Fab's chains and numbers the second from where the first ends, with a gap: its
/// amino end lost its charge.
#[test]
fn the_second_of_two_merged_chains_keeps_its_amino_end() {
    let receptor = example("1ppe_receptor_unbound.pdb");
    let receptor = receptor.lines().filter(|line| line.starts_with("ATOM"));
    let shifted: Vec<String> = receptor
        .map(|line| {
            let number: i64 = line[22..26].trim().parse().unwrap();
            format!("{}{:>4}{}", &line[..22], number + 500, &line[26..])
        })
        .collect();
    // The last oxygen of the inhibitor, which the example does not have, where another atom would be bonded to its C.
    let mut ended = inhibitor();
    let oxygen = ended.iter().rfind(|line| &line[12..16] == " O  ").unwrap();
    let z: f64 = oxygen[46..54].trim().parse().unwrap();
    let second = format!(
        "{} OXT{}{:>8.3}{}",
        &oxygen[..12],
        &oxygen[16..46],
        z + 2.0,
        &oxygen[54..]
    );
    ended.push(second);
    let with = |chains: [&str; 2]| {
        let name = |lines: &[String], chain: &str| -> String {
            let renamed = lines
                .iter()
                .map(|line| format!("{}{chain}{}\n", &line[..21], &line[22..]));
            renamed.collect()
        };
        let text = name(&ended, chains[0]) + &name(&shifted, chains[1]);
        read_text(&text).unwrap().labels(7.0).report
    };
    let (merged, separate) = (with(["A", "A"]), with(["A", "B"]));
    assert_eq!(separate.termini, [2, 2]);
    assert_eq!(merged, separate);
}
