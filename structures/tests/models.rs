//! Models of a file: alternatives, of which one is read, and parts of one thing.

#![cfg(feature = "molecule")]

use std::fmt::Write;

use knotdock_structures::Error;
use knotdock_structures::molecule::{
    InputSpec, ModelChoice, Molecule, ReadOptions, read, read_bytes,
};

fn example(name: &str) -> String {
    let path = format!("{}/examples/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap()
}

/// The atom records of a chain, under another chain's name.
fn chain(text: &str, from: char, to: char) -> String {
    let records = text.lines().filter(|line| line.starts_with("ATOM"));
    records
        .filter(|line| line.chars().nth(21) == Some(from))
        .map(|line| format!("{}{to}{}\n", &line[..21], &line[22..]))
        .collect()
}

/// The dimer of 4E43 as the archive's files of assemblies have it: a model for each half, both called A.
fn halves() -> [String; 2] {
    let dimer = example("4e43_dimer.pdb");
    ['A', 'B'].map(|name| chain(&dimer, name, 'A'))
}

fn models(parts: &[String]) -> String {
    let mut text = String::from("HEADER    X\n");
    for (number, part) in (1..).zip(parts) {
        write!(text, "MODEL     {number:>4}\n{part}ENDMDL\n").unwrap();
    }
    text + "END\n"
}

/// The records of models as a table of mmCIF.
fn mmcif(parts: &[String]) -> String {
    let mut text = String::from(
        "data_x\nloop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.type_symbol\n_atom_site.label_atom_id\n\
         _atom_site.label_comp_id\n_atom_site.auth_asym_id\n_atom_site.label_asym_id\n_atom_site.auth_seq_id\n\
         _atom_site.Cartn_x\n\
         _atom_site.Cartn_y\n_atom_site.Cartn_z\n_atom_site.pdbx_PDB_model_num\n",
    );
    for (number, part) in (1..).zip(parts) {
        for line in part.lines() {
            let columns = |from: usize, to: usize| line[from..to].trim();
            writeln!(
                text,
                "ATOM {} {} {} {} {chain} {chain} {} {} {} {} {number}",
                columns(6, 11),
                columns(76, 78),
                columns(12, 16),
                columns(17, 20),
                columns(22, 26),
                columns(30, 38),
                columns(38, 46),
                columns(46, 54),
                chain = columns(21, 22),
            )
            .unwrap();
        }
    }
    text
}

fn read_by(name: &str, text: &str, options: &ReadOptions) -> Result<Molecule, Error> {
    read_bytes(&InputSpec::whole(name), text.as_bytes().to_vec(), options)
}

fn of_model(model: ModelChoice) -> ReadOptions {
    ReadOptions {
        model,
        ..ReadOptions::default()
    }
}

fn warned(molecule: &Molecule) -> bool {
    let warnings = molecule.report.warnings.join("\n");
    warnings.contains("--model all reads them as one")
}

/// Found by a user: of an assembly as the archive has it (`.pdb1`) half was read, and the report said no more than that
/// a model was ignored.
#[test]
fn models_beside_one_another_are_parts() {
    let dimer = read(
        &InputSpec::whole(format!(
            "{}/examples/4e43_dimer.pdb",
            env!("CARGO_MANIFEST_DIR")
        )),
        &ReadOptions::default(),
    )
    .unwrap();
    let positions = |molecule: &Molecule| -> Vec<[f64; 3]> {
        molecule.atoms.iter().map(|atom| atom.position).collect()
    };
    let of_dimer: Vec<[f64; 3]> = positions(&dimer);
    for (name, text) in [
        ("dimer.pdb1", models(&halves())),
        ("dimer.cif", mmcif(&halves())),
        ("dimer.pdb", models(&halves()).replace('\n', "\r\n")),
        ("frames.pdb", halves().map(|half| half + "END\n").concat()),
    ] {
        let first = read_by(name, &text, &ReadOptions::default()).unwrap();
        assert_eq!(first.atoms.len(), 760, "{name}");
        assert_eq!(first.report.altered.models_ignored, 1);
        assert!(warned(&first), "{name}: {}", first.report);
        assert!(warned(
            &read_by(name, &text, &of_model(ModelChoice::Number(2))).unwrap()
        ));

        let whole = read_by(name, &text, &of_model(ModelChoice::All)).unwrap();
        assert_eq!(whole.atoms.len(), 1520);
        assert_eq!(positions(&whole), of_dimer);
        let chains = &whole.report.chains;
        let names: Vec<&str> = chains.iter().map(|chain| chain.name.as_str()).collect();
        assert_eq!(names, ["A", "A-2"]);
        assert_eq!(whole.report.altered.models_ignored, 0);
        assert!(whole.report.warnings.is_empty(), "{}", whole.report);
        assert_eq!(whole.report.joined_models.as_ref().unwrap().models, 2);
        assert!(
            whole
                .report
                .to_string()
                .contains("2 models read as one molecule")
        );
        assert_eq!(whole.labels(7.0).report, dimer.labels(7.0).report);
    }
}

/// A chain keeps its name where no earlier model has it, and a name that is taken is not given again.
#[test]
fn chains_of_later_models_have_names_of_their_own() {
    let [first, second] = halves();
    let named = |text: &str, name: char| chain(text, 'A', name);
    let parts = [first, named(&second, 'B')];
    let whole = read_by("x.pdb", &models(&parts), &of_model(ModelChoice::All)).unwrap();
    let names = |molecule: &Molecule| -> Vec<String> {
        let chains = molecule.report.chains.iter();
        chains.map(|chain| chain.name.clone()).collect()
    };
    assert_eq!(names(&whole), ["A", "B"]);
    // Long names, one of which is that of a copy.
    let moved = |text: &str, name: &str, z: f64| -> String {
        let table = mmcif(&[text.to_owned()]);
        let rows = table.lines().filter(|line| line.starts_with("ATOM"));
        let row = |line: &str| {
            let mut words: Vec<String> = line.split(' ').map(str::to_owned).collect();
            for place in [5, 6] {
                words[place] = name.to_owned();
            }
            words[10] = format!("{:.3}", words[10].parse::<f64>().unwrap() + z);
            words
        };
        rows.map(|line| row(line)[..11].join(" ") + " ")
            .collect::<Vec<_>>()
            .join("\n")
    };
    let head = mmcif(&[]);
    let with = |rows: String, model: usize| -> String {
        rows.lines().map(|row| format!("{row}{model}\n")).collect()
    };
    let text = head
        + &with(moved(&parts[0], "AB", 0.0), 1)
        + &with(moved(&parts[0], "AB-2", 100.0), 1)
        + &with(moved(&parts[0], "AB", 200.0), 2);
    let whole = read_by("x.cif", &text, &of_model(ModelChoice::All)).unwrap();
    assert_eq!(names(&whole), ["AB", "AB-2", "AB-2+"]);
    let spec = InputSpec {
        chains: Some(vec!["AB-2+".to_owned()]),
        ..InputSpec::whole("x.cif")
    };
    let picked = read_bytes(&spec, text.into_bytes(), &of_model(ModelChoice::All)).unwrap();
    assert_eq!(picked.atoms.len(), 760);
}

/// An ensemble's models overlap: no warning is due, unless all are read as one.
#[test]
fn models_on_one_another_are_alternatives() {
    let [first, _] = halves();
    // Each atom up to so many Å beside its place, along each axis.
    let shaken = |most: f64, seed: u64| -> String {
        let mut state = seed;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            most * ((state >> 33) as f64 / f64::from(1_u32 << 31) * 2.0 - 1.0)
        };
        let moved = |line: &str| {
            let coordinates = [30, 38, 46].map(|from| {
                let value: f64 = line[from..from + 8].trim().parse().unwrap();
                format!("{:>8.3}", value + next())
            });
            format!("{}{}{}\n", &line[..30], coordinates.concat(), &line[54..])
        };
        first.lines().map(moved).collect()
    };
    for most in [0.0, 0.3, 1.0, 3.0] {
        let ensemble = [first.clone(), shaken(most, 7), shaken(most, 8)];
        for (name, text) in [("x.pdb", models(&ensemble)), ("x.cif", mmcif(&ensemble))] {
            let molecule = read_by(name, &text, &ReadOptions::default()).unwrap();
            assert!(!warned(&molecule), "{most}: {}", molecule.report);
            let all = read_by(name, &text, &of_model(ModelChoice::All)).unwrap();
            assert_eq!(all.atoms.len(), 2280);
            assert!(all.report.to_string().contains("as alternatives do"));
        }
    }
}

/// An ion on an axis of symmetry is in both models, and is read as one.
#[test]
fn atoms_on_an_axis_are_kept_once() {
    let ion = "HETATM 9999 ZN    ZN A 301      10.000  20.000  90.000  1.00 20.00          ZN  \n";
    let parts = halves().map(|half| half + ion);
    let whole = read_by("x.pdb", &models(&parts), &of_model(ModelChoice::All)).unwrap();
    assert_eq!(whole.atoms.len(), 1521);
    assert_eq!(whole.report.joined_models.unwrap().on_axes, 1);
}

#[test]
fn a_choice_of_models_is_read_as_it_is_written() {
    for text in ["1", "12", "all"] {
        assert_eq!(text.parse::<ModelChoice>().unwrap().to_string(), text);
    }
    for text in ["0", "-1", "", "All", "1.5"] {
        assert!(text.parse::<ModelChoice>().is_err(), "{text}");
    }
    // A file of one model is read as it is.
    let [first, _] = halves();
    let one = read_by("x.pdb", &first, &of_model(ModelChoice::All)).unwrap();
    assert_eq!((one.atoms.len(), one.report.joined_models), (760, None));
    // An assembly of models is requested twice.
    let remark = "REMARK 350 BIOMOLECULE: 1\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n\
        REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n\
        REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n\
        REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n";
    let both = ReadOptions {
        assembly: Some("1".to_owned()),
        ..of_model(ModelChoice::All)
    };
    let text = remark.to_owned() + &models(&halves());
    let error = read_by("x.pdb", &text, &both).unwrap_err();
    assert!(
        error.message().contains("--assembly") && error.message().contains("--model all"),
        "{error}"
    );
}
