//! Natives of several copies, chains under one name and chains in pieces, made of 1PPE (trypsin with a squash
//! inhibitor).
//!
//! DockQ 2.1.3 gives for [`POSE`] of the unbound partners against the plain native: iRMSD 1.672, LRMSD 3.834, fnat
//! 0.620, DockQ 0.632. However the native is written, these stay.

use std::path::Path;

use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::{Atom, InputSpec, Molecule, ReadOptions, read};

use crate::evaluate::test_molecules::{
    duplex, helix, molecule, moved, random_sequence, renamed, renumbered,
};
use crate::evaluate::*;

/// The first pose of docking the unbound partners (300 rotations).
const POSE: ([f64; 4], [f64; 3]) = (
    [
        0.693_449_900_423_260_7,
        -0.050_333_589_081_080_56,
        0.586_654_296_573_504_3,
        -0.415_247_516_525_974_7,
    ],
    [
        10.120_215_376_660_942,
        21.693_835_874_308_302,
        11.632_116_741_294_524,
    ],
);

/// Trypsin or inhibitor, unbound or bound.
fn example(name: &str) -> Vec<Atom> {
    let file = format!("structures/examples/1ppe_{name}.pdb");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let spec = InputSpec::parse(path.to_str().unwrap()).unwrap();
    read(&spec, &ReadOptions::default()).unwrap().atoms
}

fn receptor() -> Vec<Atom> {
    example("receptor_unbound")
}

fn ligand() -> Vec<Atom> {
    example("ligand_unbound")
}

/// The bound partners as chains of these names.
fn bound(receptor: &str, ligand: &str) -> [Vec<Atom>; 2] {
    [
        renamed(&example("receptor_bound"), receptor),
        renamed(&example("ligand_bound"), ligand),
    ]
}

fn aside(atoms: &[Atom], shift: [f64; 3]) -> Vec<Atom> {
    moved(atoms, &Pose::from_parts([0.5, 0.5, -0.5, 0.5], shift))
}

/// Chain `first` up to residue 124 and chain `second` from there on.
fn halves(atoms: &[Atom], first: &str, second: &str) -> Vec<Atom> {
    let mut atoms = atoms.to_vec();
    for atom in &mut atoms {
        atom.chain = if atom.residue_number <= 124 {
            first
        } else {
            second
        }
        .into();
    }
    atoms
}

fn without(atoms: &[Atom], numbers: std::ops::RangeInclusive<i64>) -> Vec<Atom> {
    let kept = atoms
        .iter()
        .filter(|atom| !numbers.contains(&atom.residue_number));
    kept.cloned().collect()
}

fn against(receptor: &[Atom], ligand: &[Atom], native: &[Vec<Atom>]) -> Result<Evaluator, Error> {
    let native: Molecule = molecule(native.concat());
    let [receptor, ligand] = [receptor, ligand].map(|side| molecule(side.to_vec()));
    Evaluator::new(&receptor, &ligand, Native::Complex(&native))
}

#[track_caller]
fn assert_as_dockq(evaluator: &Evaluator) {
    let quality = evaluator.evaluate(&Pose::from_parts(POSE.0, POSE.1));
    let found = [quality.irmsd, quality.lrmsd, quality.fnat, quality.dockq];
    for (found, expected) in found.iter().zip([1.672, 3.834, 0.620, 0.632]) {
        assert!((found - expected).abs() < 2e-3, "{quality:?}");
    }
    assert_eq!(quality.capri, Capri::Medium);
}

fn taken(evaluator: &Evaluator) -> String {
    let complex = &evaluator.report().complexes[0];
    format!(
        "{} {}",
        complex.receptor.join("+"),
        complex.ligand.join("+")
    )
}

#[test]
fn plain_native_gives_the_figures_of_dockq() {
    let evaluator = against(&receptor(), &ligand(), &bound("E", "I")).unwrap();
    assert_as_dockq(&evaluator);
    assert!(evaluator.report().warnings.is_empty());
}

/// Found with a crystal of two complexes: the first lacked a loop of one chain, so that the receptor was made of one
/// chain of each, 41 Å from where they belong (dockq 0.389).
#[test]
fn copies_are_not_mixed_where_each_lacks_other_residues() {
    let docked = halves(&receptor(), "A", "B");
    let [one, inhibitor] = bound("E", "C");
    let first = without(&halves(&one, "A", "B"), 110..=114);
    let second = aside(&halves(&one, "D", "E"), [90.0, 0.0, 0.0]);
    let second_inhibitor = renamed(&aside(&inhibitor, [90.0, 0.0, 0.0]), "F");
    // In whatever order the file has them.
    let native = [second_inhibitor, first, second, inhibitor];
    let evaluator = against(&docked, &ligand(), &native).unwrap();
    assert!(evaluator.report().receptor.backbone_rmsd < 1.0);
    assert_eq!(evaluator.report().complexes.len(), 2);
    let quality = evaluator.evaluate(&Pose::from_parts(POSE.0, POSE.1));
    assert!((quality.dockq - 0.632).abs() < 5e-3, "{quality:?}");
}

/// Found likewise: a lone second trypsin with two residues more than the one that the inhibitor is bound to was
/// taken, and nothing touched.
#[test]
fn a_lone_copy_with_more_residues_is_not_taken() {
    let [one, inhibitor] = bound("E", "I");
    let lone = renamed(&aside(&one, [0.0, 90.0, 0.0]), "F");
    for native in [
        [without(&one, 60..=61), lone.clone(), inhibitor.clone()],
        [lone, without(&one, 60..=61), inhibitor],
    ] {
        let evaluator = against(&receptor(), &ligand(), &native).unwrap();
        assert_eq!(taken(&evaluator), "E I");
        assert_eq!(evaluator.report().unused_native_chains, ["F"]);
        let quality = evaluator.evaluate(&Pose::from_parts(POSE.0, POSE.1));
        assert!((quality.dockq - 0.632).abs() < 5e-3, "{quality:?}");
    }
}

/// Found with a crystal whose neighbour, of the docked ligand's own chain name, touches the receptor by a few atoms.
#[test]
fn the_largest_interface_wins_over_a_crystal_contact() {
    let [trypsin, inhibitor] = bound("A", "D");
    // Moved through the receptor until it just touches on the other side.
    let center = |atoms: &[Atom]| -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            atoms.iter().map(|atom| atom.position[axis]).sum::<f64>() / atoms.len() as f64
        })
    };
    let (from, to) = (center(&inhibitor), center(&trypsin));
    let along = [0, 1, 2].map(|axis| to[axis] - from[axis]);
    let gap = |atoms: &[Atom]| {
        let squares = atoms.iter().flat_map(|a| {
            trypsin.iter().map(|b| {
                (0..3)
                    .map(|axis| (a.position[axis] - b.position[axis]).powi(2))
                    .sum::<f64>()
            })
        });
        squares.fold(f64::INFINITY, f64::min).sqrt()
    };
    let crystal = (20..200)
        .map(|step| {
            let shift = along.map(|length| length * f64::from(step) / 10.0);
            let motion = Pose::from_parts([1.0, 0.0, 0.0, 0.0], shift);
            renamed(&moved(&inhibitor, &motion), "I")
        })
        .find(|copy| (3.0..4.9).contains(&gap(copy)))
        .unwrap();
    let evaluator = against(&receptor(), &ligand(), &[crystal, trypsin, inhibitor]).unwrap();
    assert_eq!(taken(&evaluator), "A D");
    let complexes = &evaluator.report().complexes;
    assert_eq!(
        (complexes.len(), complexes[1].ligand.as_slice()),
        (2, &["I".to_owned()][..])
    );
    assert!(complexes[0].contacts > 5 * complexes[1].contacts);
    assert_as_dockq(&evaluator);
}

/// Found with both partners under one name: the inhibitor's first fifteen residues, whose numbers trypsin does not
/// have, were counted to trypsin (dockq 0.495).
#[test]
fn partners_under_one_name_are_distinguished() {
    let [trypsin, inhibitor] = bound("A", "A");
    // As they are; running on, so that a bond is missing; after a gap as of a missing loop; the inhibitor first.
    for native in [
        [trypsin.clone(), inhibitor.clone()],
        [trypsin.clone(), renumbered(&inhibitor, 245)],
        [trypsin.clone(), renumbered(&inhibitor, 290)],
        [inhibitor, trypsin],
    ] {
        let evaluator = against(&receptor(), &ligand(), &native).unwrap();
        let report = evaluator.report();
        assert_eq!((report.receptor.matched, report.ligand.matched), (223, 28));
        assert_eq!(
            (
                report.receptor.native_residues,
                report.ligand.native_residues
            ),
            (223, 29)
        );
        assert_as_dockq(&evaluator);
    }
}

/// Found with an inhibitor that was cut in two: its second chain, of fourteen residues, was left aside as another copy.
#[test]
fn short_chains_of_one_docked_chain_are_all_matched() {
    let [trypsin, mut inhibitor] = bound("A", "C");
    for atom in inhibitor.iter_mut().filter(|atom| atom.residue_number > 15) {
        atom.chain = "D".into();
    }
    let evaluator = against(
        &receptor(),
        &ligand(),
        &[trypsin.clone(), inhibitor.clone()],
    )
    .unwrap();
    assert_eq!(evaluator.report().ligand.matched, 28);
    assert!(evaluator.report().unused_native_chains.is_empty());
    assert_as_dockq(&evaluator);
    // And the reverse, a docked ligand of two chains against a native of one.
    let whole = renamed(&inhibitor, "C");
    let mut docked = ligand();
    for atom in docked.iter_mut().filter(|atom| atom.residue_number > 15) {
        atom.chain = "D".into();
    }
    assert_as_dockq(&against(&receptor(), &docked, &[trypsin, whole]).unwrap());
}

/// Found with a native of another inhibitor, the peptide APRGL: three of its residues are equal to some of the docked
/// ligand's, and poses were called high.
#[test]
fn a_peptide_does_not_pass_for_a_longer_ligand() {
    let [trypsin, inhibitor] = bound("A", "P");
    let mut peptide: Vec<Atom> = inhibitor
        .into_iter()
        .filter(|atom| (4..=8).contains(&atom.residue_number))
        .collect();
    for atom in &mut peptide {
        let names = [(4, "ALA"), (5, "PRO"), (6, "ARG"), (7, "GLY"), (8, "LEU")];
        let name = names
            .iter()
            .find(|(number, _)| *number == atom.residue_number);
        atom.residue_name = name.unwrap().1.into();
    }
    let error = against(&receptor(), &ligand(), &[trypsin, peptide]).unwrap_err();
    let message = error.message();
    assert!(
        message.contains("of the docked ligand's 29 residues")
            || message.contains("sequence of the ligand"),
        "{error}"
    );
}

/// A native with part of the docked molecule is measured, with a warning.
#[test]
fn half_of_a_docked_side_is_warned_of() {
    let [trypsin, inhibitor] = bound("A", "I");
    let half = without(&trypsin, 60..=130);
    let evaluator = against(&receptor(), &ligand(), &[half, inhibitor]).unwrap();
    let warnings = &evaluator.report().warnings;
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(
        warnings[0].contains("docked receptor's 223 residues"),
        "{warnings:?}"
    );
}

/// Which file is called the receptor changes no figure: CAPRI's and DockQ's ligand is the smaller partner.
#[test]
fn figures_do_not_follow_the_order_of_the_arguments() {
    let native = bound("E", "I");
    let direct = against(&receptor(), &ligand(), &native).unwrap();
    let swapped = against(&ligand(), &receptor(), &native).unwrap();
    assert_eq!(direct.report().dockq_ligand, "ligand");
    assert_eq!(swapped.report().dockq_ligand, "receptor");
    let pose = Pose::from_parts(POSE.0, POSE.1);
    // A turn of the small ligand in its place is a swing of the large receptor.
    let turned = pose.after(&Pose::from_parts([0.98, 0.0, 0.2, 0.0], [4.0, 1.0, -3.0]));
    for pose in [pose, turned] {
        let (a, b) = (direct.evaluate(&pose), swapped.evaluate(&pose.inverse()));
        for (a, b) in [
            (a.irmsd, b.irmsd),
            (a.lrmsd, b.lrmsd),
            (a.fnat, b.fnat),
            (a.dockq, b.dockq),
        ] {
            assert!((a - b).abs() < 1e-8, "{a} {b}");
        }
        assert_eq!(a.capri, b.capri);
    }
}

/// Chains of two copies are no complex: where nothing fits, there is a warning, and no pose counts as correct.
#[test]
fn an_absurd_fit_is_incorrect() {
    let docked = halves(&receptor(), "A", "B");
    let [one, inhibitor] = bound("E", "C");
    let of = |atoms: Vec<Atom>, chain: &str| -> Vec<Atom> {
        atoms
            .into_iter()
            .filter(|atom| atom.chain == chain)
            .collect()
    };
    let native = [
        of(halves(&one, "A", "B"), "B"),
        of(aside(&halves(&one, "D", "E"), [90.0, 0.0, 0.0]), "D"),
        inhibitor,
    ];
    let evaluator = against(&docked, &ligand(), &native).unwrap();
    let report = evaluator.report();
    assert_eq!(report.native_chains, "A:D,B:B,B:C");
    assert!(report.receptor.backbone_rmsd > 15.0);
    assert!(
        report.warnings[0].contains("--native FILE:A,B"),
        "{:?}",
        report.warnings
    );
    let quality = evaluator.evaluate(&Pose::from_parts(POSE.0, POSE.1));
    assert_eq!(quality.capri, Capri::Incorrect);
}

/// A docked chain of which a second copy has more than its own chain is not elsewhere.
#[test]
fn chains_cut_at_other_places_are_no_copies() {
    let docked = halves(&receptor(), "A", "B");
    let [one, inhibitor] = bound("E", "C");
    let first = without(&one, 128..=300);
    let copy = renamed(&aside(&one, [90.0, 0.0, 0.0]), "F");
    let evaluator = against(&docked, &ligand(), &[first, copy, inhibitor]).unwrap();
    assert_eq!(taken(&evaluator), "E C");
    assert_eq!(evaluator.report().warnings.len(), 1);
}

/// An antibody's two chains with an antigen, in three copies under interleaved names, each with another gap.
#[test]
fn copies_under_interleaved_names_are_kept_together() {
    let parts = [
        helix("H", &random_sequence(31, 50), [0.0; 3]),
        helix("L", &random_sequence(32, 45), [11.0, 0.0, 2.0]),
        helix("X", &random_sequence(33, 40), [5.0, 10.0, 4.0]),
    ];
    let antibody = [parts[0].clone(), parts[1].clone()].concat();
    let names = [["A", "D", "G"], ["B", "E", "H"], ["C", "F", "I"]];
    let mut native = Vec::new();
    for (part, names) in parts.iter().zip(names) {
        for (copy, name) in names.into_iter().enumerate() {
            let copied = match copy {
                0 => part.clone(),
                _ => aside(part, [60.0 * copy as f64, 0.0, 0.0]),
            };
            let gap = 8 * ((copy as i64 + part.len() as i64) % 3);
            native.push(without(&renamed(&copied, name), 4 + gap..=7 + gap));
        }
    }
    let evaluator = against(&antibody, &parts[2], &native).unwrap();
    let report = evaluator.report();
    assert!(["A+B C", "D+E F", "G+H I"].contains(&taken(&evaluator).as_str()));
    assert_eq!(report.complexes.len(), 3, "{:?}", report.complexes);
    assert!(report.receptor.backbone_rmsd < 1e-6);
    let quality = evaluator.evaluate(&Pose::identity());
    assert!(quality.irmsd < 1e-6 && quality.lrmsd < 1e-6, "{quality:?}");
}

/// Of equal complexes the one is taken whose names are those of the docked chains.
#[test]
fn names_decide_between_equal_complexes() {
    let [one, inhibitor] = bound("E", "I");
    let copy = [
        ("C", [90.0, 0.0, 0.0]),
        ("E", [0.0, 90.0, 0.0]),
        ("G", [0.0, 0.0, 90.0]),
    ];
    let mut native = Vec::new();
    for (name, shift) in copy {
        native.push(renamed(&aside(&one, shift), name));
        let inhibitors = if name == "E" { "I" } else { "X" };
        let name = format!("{inhibitors}{name}");
        let name = if name == "IE" { "I".to_owned() } else { name };
        native.push(renamed(&aside(&inhibitor, shift), &name));
    }
    let evaluator = against(
        &renamed(&receptor(), "E"),
        &renamed(&ligand(), "I"),
        &native,
    )
    .unwrap();
    assert_eq!(taken(&evaluator), "E I");
    assert_eq!(evaluator.report().complexes.len(), 3);
    assert_as_dockq(&evaluator);
}

/// One copy in the native is no complex of two.
#[test]
fn a_single_copy_is_no_native_of_a_homodimer() {
    let [one, _] = bound("A", "I");
    let error = against(&receptor(), &receptor(), &[one]).unwrap_err();
    assert!(error.message().contains("only one copy"), "{error}");
}

/// Found with DNA docked as one chain, as HADDOCK has it, against a native of two strands: the second, of eleven
/// nucleotides, was left aside as another copy.
#[test]
fn both_strands_of_a_duplex_docked_as_one_chain_are_matched() {
    let protein = helix("A", &random_sequence(41, 40), [14.0, 0.0, -5.0]);
    let native = duplex(["C", "D"]);
    // Numbers that run on, that leap and that begin again.
    for shift in [0, 89, -11] {
        let [one, other] = duplex(["B", "B"]);
        let docked = [one, renumbered(&other, shift)].concat();
        let complex = [protein.clone(), native.concat()];
        let evaluator = against(&protein, &docked, &complex).unwrap();
        assert_eq!(evaluator.report().ligand.matched, 22, "{shift}");
        assert!(evaluator.report().unused_native_chains.is_empty());
        let quality = evaluator.evaluate(&Pose::identity());
        assert!(quality.irmsd < 1e-9 && quality.lrmsd < 1e-9, "{quality:?}");
        assert_eq!(quality.fnat, 1.0);
        // Separate strands in both, with the native's in the other order and under other names.
        let swapped = [renamed(&native[1], "A"), renamed(&native[0], "B")].concat();
        let complex = [swapped, renamed(&protein, "P")];
        let evaluator = against(&protein, &native.concat(), &complex).unwrap();
        assert_eq!(evaluator.report().ligand.matched, 22);
        assert!(evaluator.evaluate(&Pose::identity()).irmsd < 1e-9);
    }
}
