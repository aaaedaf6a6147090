//! Predicted models: how they are detected, and their residues of low confidence.

#![cfg(feature = "molecule")]

use std::fmt::Write;

use crate::pdb_text::{read_bytes, read_text};
use knotdock_structures::molecule::{
    Confidence, ConfidenceSource, DropKind, InputSpec, ReadOptions, read, read_with_fates,
};

/// PDB records of glycines of four atoms; the B value of atom a of residue r is `b(r, a)`.
fn glycines(residues: usize, b: impl Fn(usize, usize) -> f64) -> String {
    let mut text = String::new();
    for residue in 0..residues {
        for (index, name) in ["N", "CA", "C", "O"].into_iter().enumerate() {
            writeln!(
                text,
                "ATOM  {index:>5}  {name:<3} GLY A{:>4}    {:>8.3}{:>8.3}{:>8.3}  1.00{:>6.2}          {:>2}",
                residue + 1,
                3.8 * residue as f64,
                1.2 * index as f64,
                0.0,
                b(residue, index),
                &name[..1]
            )
            .unwrap();
        }
    }
    text
}

/// pLDDT of ten residues, 30 to 93 in steps of 7: three below 50, mean 61.5.
fn rising(residue: usize) -> f64 {
    30.0 + 7.0 * residue as f64
}

/// The same atoms in mmCIF, after the items of `head`.
fn mmcif(head: &str, b: impl Fn(usize, usize) -> f64) -> String {
    let mut text = format!(
        "data_x\n{head}\nloop_\n_atom_site.group_PDB\n_atom_site.type_symbol\n_atom_site.label_atom_id\n\
         _atom_site.label_comp_id\n\
         _atom_site.label_asym_id\n_atom_site.label_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n\
         _atom_site.Cartn_z\n\
         _atom_site.occupancy\n_atom_site.B_iso_or_equiv\n"
    );
    for residue in 0..10 {
        for (index, name) in ["N", "CA", "C", "O"].into_iter().enumerate() {
            writeln!(
                text,
                "ATOM {} {name} GLY A {} {} {} 0 1.0 {}",
                &name[..1],
                residue + 1,
                3.8 * residue as f64,
                1.2 * index as f64,
                b(residue, index)
            )
            .unwrap();
        }
    }
    text
}

fn confidence_of(name: &str, text: &str) -> Option<Confidence> {
    let molecule = read_bytes(name, text.as_bytes(), "").unwrap();
    molecule.report.confidence
}

const SURE_OF_TEN: Confidence = Confidence {
    source: ConfidenceSource::Values,
    mean: 61.5,
    residues: 10,
    below_50: 3,
};

#[test]
fn one_value_a_residue_shows_a_prediction() {
    let text = glycines(10, |residue, _| rising(residue));
    assert_eq!(confidence_of("x.pdb", &text), Some(SURE_OF_TEN));
    // From 0 to 1, as some programs write it.
    let shares = glycines(10, |residue, _| rising(residue) / 100.0);
    assert_eq!(confidence_of("x.pdb", &shares), Some(SURE_OF_TEN));
    let shown = read_text(&text).unwrap().report.to_string();
    assert!(
        shown.contains("mean pLDDT 61.5, 3 of 10 residues below 50"),
        "{shown}"
    );
    assert!(shown.contains("warning: 3 of 10 residues"), "{shown}");
}

/// B columns without one value per residue, or that are no share of a hundred, or low, or the same throughout, are no
/// pLDDT.
#[test]
fn other_columns_are_no_confidence() {
    type Column = fn(usize, usize) -> f64;
    let columns: [(&str, Column); 6] = [
        ("refined atom by atom", |residue, atom| {
            rising(residue) + 0.5 * atom as f64
        }),
        ("one atom aside", |residue, atom| {
            if (residue, atom) == (4, 2) {
                58.5
            } else {
                rising(residue)
            }
        }),
        ("above a hundred", |residue, _| rising(residue) + 20.0),
        ("below zero", |residue, _| {
            if residue == 0 { -1.0 } else { rising(residue) }
        }),
        ("refined residue by residue", |residue, _| {
            rising(residue) - 20.0
        }),
        ("filled", |_, _| 80.0),
    ];
    for (what, column) in columns {
        assert_eq!(
            confidence_of("x.pdb", &glycines(10, column)),
            None,
            "{what}"
        );
    }
    assert_eq!(
        confidence_of("x.pdb", &glycines(4, |residue, _| rising(residue + 6))),
        None
    );
}

#[test]
fn an_experiment_rules_a_prediction_out() {
    let of_method = |method: &str| {
        let text = format!(
            "EXPDTA    {method}\n{}",
            glycines(10, |residue, _| rising(residue))
        );
        confidence_of("x.pdb", &text)
    };
    assert_eq!(of_method("X-RAY DIFFRACTION"), None);
    assert_eq!(of_method("SOLUTION NMR"), None);
    for prediction in [
        "THEORETICAL MODEL",
        "THEORETICAL MODEL (SWISS-MODEL SERVER)",
        "",
    ] {
        assert_eq!(of_method(prediction), Some(SURE_OF_TEN), "{prediction}");
    }
    let of_head = |head: &str| confidence_of("x.cif", &mmcif(head, |residue, _| rising(residue)));
    assert_eq!(of_head("_exptl.method 'X-RAY DIFFRACTION'"), None);
    let several = "loop_\n_exptl.entry_id\n_exptl.method\nx 'THEORETICAL MODEL'\nx 'SOLUTION NMR'";
    assert_eq!(of_head(several), None);
    assert_eq!(of_head("_exptl.method ?"), Some(SURE_OF_TEN));
    assert_eq!(
        of_head("_exptl.method 'THEORETICAL MODEL'"),
        Some(SURE_OF_TEN)
    );
}

/// ModelCIF names its scores: with pLDDT among them values may differ from atom to atom (AlphaFold 3), without it the
/// column is something else, whatever it looks like.
#[test]
fn scores_that_a_model_names_go_before_its_values() {
    let metrics = |first: &str, second: &str| {
        format!(
            "loop_\n_ma_qa_metric.id\n_ma_qa_metric.mode\n_ma_qa_metric.name\n_ma_qa_metric.type\n\
             1 global {first}\n2 local {second}\n#"
        )
    };
    let named = metrics("'mean' pLDDT", "pLDDT pLDDT");
    let by_atom = |residue: usize, atom: usize| rising(residue) + 0.5 * atom as f64 - 0.75;
    let expected = Confidence {
        source: ConfidenceSource::Header,
        ..SURE_OF_TEN
    };
    assert_eq!(
        confidence_of("x.cif", &mmcif(&named, by_atom)),
        Some(expected)
    );
    let low = mmcif("_ma_qa_metric.name pLDDT", |residue, _| {
        rising(residue) - 30.0
    });
    assert_eq!(
        confidence_of("x.cif", &low),
        Some(Confidence {
            mean: 31.5,
            below_50: 8,
            ..expected
        })
    );
    let other = metrics(
        "QMEANDisCo 'normalized score'",
        "QMEANDisCo 'normalized score'",
    );
    assert_eq!(
        confidence_of("x.cif", &mmcif(&other, |residue, _| rising(residue))),
        None
    );
    // Named, but not in the B column.
    assert_eq!(confidence_of("x.cif", &mmcif(&named, |_, _| 0.0)), None);
}

#[test]
fn residues_below_the_limit_are_left_out_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pdb");
    std::fs::write(&path, glycines(10, |residue, _| rising(residue))).unwrap();
    let spec = InputSpec::whole(&path);
    let options = |least: f64| ReadOptions {
        min_plddt: Some(least),
        ..ReadOptions::default()
    };
    for (least, residues, warned) in [
        (30.0, 10, "3 of 10"),
        (30.01, 9, "2 of 10"),
        (50.0, 7, ""),
        (93.0, 1, ""),
    ] {
        let (molecule, entries) = read_with_fates(&spec, &options(least)).unwrap();
        assert_eq!(molecule.atoms.len(), 4 * residues, "{least}");
        assert!(molecule.atoms.iter().all(|atom| atom.b_factor >= least));
        assert_eq!(molecule.report.confidence, Some(SURE_OF_TEN));
        assert_eq!(entries.len(), 40);
        let dropped = entries
            .iter()
            .filter(|entry| entry.dropped == Some(DropKind::LowConfidence));
        assert_eq!(dropped.count(), 40 - 4 * residues);
        let shown = molecule.report.to_string();
        let warning = "residues have a pLDDT below 50";
        assert_eq!(shown.contains(warning), !warned.is_empty(), "{shown}");
        assert!(shown.contains(warned), "{shown}");
    }
    let shown = read(&spec, &options(50.0)).unwrap().report.to_string();
    assert!(
        shown.contains("12 atoms of 3 residues of low pLDDT (A 1, A 2, A 3)"),
        "{shown}"
    );
    let none = read(&spec, &options(93.01)).unwrap_err();
    assert!(
        none.message().contains("no atom is left") && none.message().contains("40 atoms"),
        "{none}"
    );
    assert!(none.remedy().unwrap().contains("--min-plddt"));

    // What is no prediction stays as it is.
    let refined = glycines(10, |residue, atom| rising(residue) + 0.5 * atom as f64);
    std::fs::write(&path, refined).unwrap();
    assert_eq!(read(&spec, &options(90.0)).unwrap().atoms.len(), 40);
}

/// The free inhibitor as Chai-1 and AlphaFold 3 write a prediction: a pLDDT for each atom, of residues 1 to 4 about 35
/// and of the others about 88.
fn by_atom(scale: f64) -> String {
    let path = format!(
        "{}/examples/1ppe_ligand_unbound.pdb",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).unwrap();
    let mut state: u64 = 1;
    let mut jitter = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as f64 / f64::from(1_u32 << 31) * 16.0 - 8.0
    };
    let records = text.lines().filter(|line| line.starts_with("ATOM"));
    records
        .map(|line| {
            let number: i64 = line[22..26].trim().parse().unwrap();
            let value = if number < 5 { 35.0 } else { 88.0 } + jitter();
            format!("{}{:>6.2}{}\n", &line[..60], scale * value, &line[66..])
        })
        .collect()
}

/// Found by a user: the model of a predictor that writes a value for each atom, and no header, was taken for measured.
#[test]
fn values_by_atom_tell_a_prediction_where_they_are_distributed_as_one() {
    for scale in [1.0, 0.01] {
        let confidence = confidence_of("x.pdb", &by_atom(scale)).unwrap();
        assert_eq!(confidence.source, ConfidenceSource::Values);
        assert_eq!((confidence.residues, confidence.below_50), (29, 4));
    }
    let text = format!("EXPDTA    X-RAY DIFFRACTION\n{}", by_atom(1.0));
    assert_eq!(confidence_of("x.pdb", &text), None);
    // Refined structures, as they are, and with B values moved to the level of pLDDT and below 100.
    for name in [
        "1ppe_receptor_unbound",
        "1ppe_ligand_unbound",
        "1ppe_receptor_bound",
        "1ppe_ligand_bound",
        "4e43_dimer",
    ] {
        let path = format!("{}/examples/{name}.pdb", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).unwrap();
        for (factor, shift) in [(1.0, 0.0), (1.0, 40.0), (0.5, 65.0)] {
            let moved = text.lines().map(|line| match line.get(60..66) {
                Some(value) if line.starts_with("ATOM") => {
                    let value: f64 = value.trim().parse().unwrap();
                    let value = (factor * value + shift).min(99.0);
                    format!("{}{value:>6.2}{}\n", &line[..60], &line[66..])
                }
                _ => format!("{line}\n"),
            });
            let moved: String = moved.collect();
            assert_eq!(
                confidence_of("x.pdb", &moved),
                None,
                "{name} {factor} {shift}"
            );
        }
    }
}

/// Who gives a least pLDDT is believed of B values that can be pLDDT, and of no others.
#[test]
fn the_users_word_is_taken_where_it_can_be_true() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pdb");
    let read_by = |text: &str, trust_plddt: bool| {
        std::fs::write(&path, text).unwrap();
        let options = ReadOptions {
            min_plddt: Some(50.0),
            trust_plddt,
            ..ReadOptions::default()
        };
        read(&InputSpec::whole(&path), &options).unwrap()
    };
    // A mean of 44: nothing but the user says that this is a prediction. Three of ten residues are above 50.
    let low = glycines(10, |residue, atom| {
        12.0 + 7.0 * residue as f64 + 0.1 * atom as f64
    });
    let untold = read_by(&low, false);
    assert_eq!((untold.atoms.len(), untold.report.confidence), (40, None));
    for scale in [1.0, 0.01] {
        let scaled = glycines(10, |residue, _| scale * (12.0 + 7.0 * residue as f64));
        let trusted = read_by(&scaled, true);
        let confidence = trusted.report.confidence.unwrap();
        assert_eq!(
            (confidence.source, confidence.below_50),
            (ConfidenceSource::User, 6)
        );
        assert_eq!(trusted.atoms.len(), 16);
        assert!(
            trusted
                .report
                .to_string()
                .contains("because --min-plddt is given")
        );
    }
    let measured = format!("EXPDTA    SOLUTION NMR\n{low}");
    for (text, reason) in [
        (glycines(10, |_, _| 0.0), "all B values are 0"),
        (glycines(10, |_, _| 20.0), "all B values are 20"),
        (
            glycines(10, |residue, _| 60.0 + 5.0 * residue as f64),
            "above 100",
        ),
        (glycines(10, |residue, _| residue as f64 - 1.0), "below 0"),
        (measured, "the file names an experiment"),
        (
            glycines(10, |residue, _| 10.0 + 5.0 * residue as f64),
            "2 of 10 residues reach 50",
        ),
    ] {
        let refused = read_by(&text, true);
        assert_eq!((refused.atoms.len(), refused.report.confidence), (40, None));
        let said = refused.report.no_confidence.unwrap();
        assert!(said.contains(reason), "{said}");
    }
}
