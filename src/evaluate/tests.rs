//! Identities and hand-known answers of the whole evaluation.

use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::{Atom, Molecule};
use proptest::prelude::*;

use super::test_molecules::{atom, helix, molecule, moved, random_sequence, renamed, renumbered};
use super::*;

/// Two helices side by side, 40 and 30 residues.
fn bound() -> (Vec<Atom>, Vec<Atom>) {
    (
        helix("A", &random_sequence(21, 40), [0.0; 3]),
        helix("B", &random_sequence(22, 30), [9.0, 0.0, 8.0]),
    )
}

fn evaluator(user: (&[Atom], &[Atom]), native: (&[Atom], &[Atom])) -> Result<Evaluator, Error> {
    let molecule = |atoms: &[Atom]| molecule(atoms.to_vec());
    let native = (molecule(native.0), molecule(native.1));
    Evaluator::new(
        &molecule(user.0),
        &molecule(user.1),
        Native::Pair {
            receptor: &native.0,
            ligand: &native.1,
        },
    )
}

fn translation(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, y, z])
}

#[track_caller]
fn assert_perfect(quality: PoseQuality) {
    assert!(quality.irmsd < 1e-9 && quality.lrmsd < 1e-9, "{quality:?}");
    assert_eq!(quality.fnat, 1.0);
    assert!((quality.dockq - 1.0).abs() < 1e-12, "{quality:?}");
    assert_eq!(quality.capri, Capri::High);
}

#[track_caller]
fn assert_alike(a: PoseQuality, b: PoseQuality) {
    let parts = |q: PoseQuality| [q.irmsd, q.lrmsd, q.fnat, q.dockq];
    for (x, y) in parts(a).into_iter().zip(parts(b)) {
        assert!((x - y).abs() < 1e-8, "{a:?} against {b:?}");
    }
    assert_eq!(a.capri, b.capri);
}

#[test]
fn bound_pair_is_its_own_answer() {
    let (receptor, ligand) = bound();
    let evaluator = evaluator((&receptor, &ligand), (&receptor, &ligand)).unwrap();
    assert_perfect(evaluator.evaluate(&Pose::identity()));
    let report = evaluator.report();
    assert_eq!((report.interface_share, report.permutations), (1.0, 1));
    assert_eq!(
        (report.receptor.matched, report.receptor.matched_by_number),
        (40, 40)
    );
    assert_eq!(report.receptor.chains[0].method, MatchMethod::Number);
    assert!(report.native_contacts > 5 && report.native_contacts == report.native_contacts_matched);
}

#[test]
fn translation_is_the_ligand_rmsd() {
    let (receptor, ligand) = bound();
    let evaluator = evaluator((&receptor, &ligand), (&receptor, &ligand)).unwrap();
    let quality = evaluator.evaluate(&translation(3.0, 0.0, 4.0));
    assert!((quality.lrmsd - 5.0).abs() < 1e-9, "{quality:?}");
    let far = evaluator.evaluate(&translation(1e6, 0.0, 0.0));
    assert!((far.lrmsd - 1e6).abs() < 1e-3);
    assert_eq!((far.fnat, far.capri), (0.0, Capri::Incorrect));
    // Beyond the numbers' range, still no NaN and no infinity.
    let lost = evaluator.evaluate(&translation(1e200, 0.0, 0.0));
    assert!(lost.irmsd.is_finite() && lost.lrmsd.is_finite() && lost.dockq < 1e-9);
}

/// The native in another frame comes back onto the docked receptor, and its ligand to where it belongs; a missing residue
/// cuts its line.
#[test]
fn the_known_complex_is_laid_over_the_docked_receptor() {
    let (receptor, ligand) = bound();
    let motion = Pose::from_parts([0.7, -0.3, 0.5, 0.4], [12.0, -30.0, 5.0]);
    let [mut first, second] = [&receptor, &ligand].map(|atoms| moved(atoms, &motion));
    first.retain(|atom| atom.residue_number != 11);
    let evaluator = evaluator((&receptor, &ligand), (&first, &second)).unwrap();
    let (known, places) = evaluator.known(&[Pose::identity(), translation(3.0, 0.0, 0.0)]);
    assert_eq!((known.len(), places), (1, vec![0, 0]));
    let lengths = known[0]
        .each_ref()
        .map(|trace| trace.iter().map(Vec::len).collect::<Vec<_>>());
    assert_eq!(lengths, [vec![10, 29], vec![30]]);
    let docked = receptor
        .iter()
        .chain(&ligand)
        .filter(|atom| atom.name == "CA");
    let docked = docked.filter(|atom| (&*atom.chain, atom.residue_number) != ("A", 11));
    for (atom, at) in docked.zip(known[0].iter().flatten().flatten()) {
        let off = (0..3).map(|axis| (atom.position[axis] - at[axis]).abs());
        assert!(
            off.fold(0.0, f64::max) < 1e-6,
            "{at:?} of {}",
            atom.residue_number
        );
    }
}

/// One residue of four backbone atoms at the corners of a square across the x axis.
fn square(chain: &str, x: f64) -> Vec<Atom> {
    [
        ("N", 1.0, 0.0),
        ("CA", 0.0, 1.0),
        ("C", -1.0, 0.0),
        ("O", 0.0, -1.0),
    ]
    .map(|(name, y, z)| atom(chain, 1, "GLY", name, [x, y, z]))
    .to_vec()
}

#[test]
fn two_squares_by_hand() {
    // Separated from 4 to 6 Å along the axis: superposed, every atom is 1 Å off; the ligand alone is 2 Å off; the
    // only contact is lost.
    let (receptor, ligand) = (square("A", 0.0), square("B", 4.0));
    let evaluator = evaluator((&receptor, &ligand), (&receptor, &ligand)).unwrap();
    let quality = evaluator.evaluate(&translation(2.0, 0.0, 0.0));
    assert!((quality.irmsd - 1.0).abs() < 1e-12);
    assert!((quality.lrmsd - 2.0).abs() < 1e-12);
    assert_eq!(quality.fnat, 0.0);
    let (interface, ligand) = (1.0 / (1.0 + 4.0 / 9.0), 1.0 / (1.0 + 16.0 / 289.0));
    assert!((quality.dockq - (interface + ligand) / 3.0).abs() < 1e-12);
    assert_eq!(
        quality.capri,
        Capri::Incorrect,
        "without contacts nothing is acceptable"
    );
    assert_eq!(evaluator.evaluate(&translation(0.9, 0.0, 0.0)).fnat, 1.0);
}

#[test]
fn dockq_superposes_the_larger_side() {
    // The ligand has more residues than the receptor, so DockQ moves the receptor. A quarter turn about the
    // ligand's own axis: seen from the ligand, the receptor beside it swings round by 9 root 2 Å.
    let (ligand, receptor) = bound();
    let evaluator = evaluator((&receptor, &ligand), (&receptor, &ligand)).unwrap();
    assert_eq!(evaluator.report().dockq_ligand, "receptor");
    let half = std::f64::consts::FRAC_PI_4;
    let pose = Pose::from_parts([half.cos(), 0.0, 0.0, half.sin()], [0.0; 3]);
    let backbone_shift = |atoms: &[Atom], pose: &Pose| {
        let squares: Vec<f64> = atoms
            .iter()
            .filter(|atom| atom.name != "CB")
            .map(|atom| {
                let moved = pose.apply(atom.position);
                (0..3)
                    .map(|axis| (moved[axis] - atom.position[axis]).powi(2))
                    .sum()
            })
            .collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let quality = evaluator.evaluate(&pose);
    let smaller = backbone_shift(&receptor, &pose.inverse());
    assert!((quality.lrmsd - smaller).abs() < 1e-9);
    assert!(
        smaller - backbone_shift(&ligand, &pose) > 5.0,
        "the case must distinguish the two"
    );
    let (fnat, irmsd) = (quality.fnat, quality.irmsd);
    assert!((quality.dockq - dockq(fnat, irmsd, smaller)).abs() < 1e-12);
    assert_eq!(quality.capri, Capri::of(fnat, irmsd, smaller));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// The native may be in any frame, and so may each file of the user: only the final places of atoms count.
    #[test]
    fn frames_do_not_matter(
        turns in prop::array::uniform3(prop::array::uniform4(0.1..1.0f64)),
        shifts in prop::array::uniform3(prop::array::uniform3(-1e3..1e3f64)),
        small in prop::array::uniform3(-4.0..4.0f64),
    ) {
        let [native_frame, receptor_frame, ligand_frame] =
            [0, 1, 2].map(|k| Pose::from_parts(turns[k], shifts[k]));
        let (receptor, ligand) = bound();
        let pose = Pose::from_parts([1.0, 0.05, -0.02, 0.1], small);
        let plain = evaluator((&receptor, &ligand), (&receptor, &ligand)).unwrap().evaluate(&pose);
        let elsewhere = evaluator(
            (&moved(&receptor, &receptor_frame), &moved(&ligand, &ligand_frame)),
            (&moved(&receptor, &native_frame), &moved(&ligand, &native_frame)),
        )
        .unwrap();
        let same = receptor_frame.after(&pose).after(&ligand_frame.inverse());
        assert_alike(elsewhere.evaluate(&same), plain);
    }
}

#[test]
fn renumbered_and_renamed_chains_are_the_same() {
    let (receptor, ligand) = bound();
    let native = (
        renumbered(&renamed(&receptor, "X"), 100),
        renamed(&ligand, "A"),
    );
    let evaluator = evaluator((&receptor, &ligand), (&native.0, &native.1)).unwrap();
    assert_perfect(evaluator.evaluate(&Pose::identity()));
    let report = evaluator.report();
    assert_eq!(report.receptor.chains[0].method, MatchMethod::Sequence);
    assert_eq!(
        (report.receptor.matched, report.receptor.matched_by_number),
        (40, 0)
    );
    assert_eq!(report.ligand.chains[0].native_chain, "A");
}

/// A receptor of two identical chains, of which the ligand touches the one named first.
fn dimer(touched: &str, other: &str) -> Vec<Atom> {
    let (one, _) = bound();
    let away = Pose::from_parts([0.0, 0.0, 0.0, 1.0], [-12.0, -3.0, 0.0]);
    [renamed(&one, touched), renamed(&moved(&one, &away), other)].concat()
}

#[test]
fn swapped_identical_chains_find_the_best_order() {
    let (_, ligand) = bound();
    let ligand = renamed(&ligand, "L");
    // The names say the wrong order: A is touched in the native, B in the user's file.
    let evaluator = evaluator((&dimer("B", "A"), &ligand), (&dimer("A", "B"), &ligand)).unwrap();
    assert_eq!(evaluator.report().permutations, 2);
    assert_perfect(evaluator.evaluate(&Pose::identity()));
    // A native of one chain: the ligand may be on either of the two that the user names.
    let (one, _) = bound();
    let on_one = super::tests::evaluator((&dimer("B", "A"), &ligand), (&one, &ligand)).unwrap();
    assert_perfect(on_one.evaluate(&Pose::identity()));
    let away = Pose::from_parts([0.0, 0.0, 0.0, 1.0], [-12.0, -3.0, 0.0]);
    assert_perfect(on_one.evaluate(&away));
}

#[test]
fn merged_chains_match_separate_ones() {
    // An antibody's H and L as one chain with numbers that begin again, against two chains in the native.
    let (heavy, antigen) = bound();
    let light = helix("L", &random_sequence(23, 35), [0.0, 10.0, 3.0]);
    let merged = [heavy.clone(), renamed(&light, "A")].concat();
    let separate = [light, renamed(&heavy, "H")].concat();
    let evaluator = evaluator((&merged, &antigen), (&separate, &antigen)).unwrap();
    assert_eq!(evaluator.report().receptor.matched, 75);
    assert_perfect(evaluator.evaluate(&Pose::identity()));
}

#[test]
fn missing_and_mutated_residues_are_left_out() {
    let (receptor, ligand) = bound();
    let shorter: Vec<_> = receptor
        .iter()
        .filter(|atom| atom.residue_number > 3)
        .cloned()
        .collect();
    let mut mutated = ligand.clone();
    for atom in mutated.iter_mut().filter(|atom| atom.residue_number == 10) {
        atom.residue_name = if atom.residue_name == "TRP" {
            "ALA"
        } else {
            "TRP"
        }
        .into();
    }
    let evaluator = evaluator((&shorter, &mutated), (&receptor, &ligand)).unwrap();
    let quality = evaluator.evaluate(&Pose::identity());
    assert!(quality.irmsd < 1e-9 && quality.lrmsd < 1e-9);
    let report = evaluator.report();
    assert_eq!((report.receptor.matched, report.ligand.matched), (37, 29));
    let reachable = report.native_contacts_matched as f64 / report.native_contacts as f64;
    assert!(reachable < 1.0, "the case must lose a contact");
    assert!((quality.fnat - reachable).abs() < 1e-15);
}

#[test]
fn half_an_interface_is_an_error() {
    let (receptor, ligand) = bound();
    // All of the receptor's residues that the native has at the interface but the first few.
    let end: Vec<_> = receptor
        .iter()
        .filter(|atom| atom.residue_number < 10)
        .cloned()
        .collect();
    let error = evaluator((&end, &ligand), (&receptor, &ligand)).unwrap_err();
    let of = error.message().strip_prefix("only ").unwrap();
    let (matched, rest) = of.split_once(" of the ").unwrap();
    let interface = rest.split(' ').next().unwrap();
    assert!(rest.contains("the native's receptor"), "{error}");
    assert!(2 * matched.parse::<usize>().unwrap() < interface.parse().unwrap());
    assert!(error.remedy().unwrap().contains("--native-receptor"));
}

/// Found by a review: where each side had the half of the interface that the other lacked, the interface RMSD of
/// every pose was 0.
#[test]
fn halves_of_an_interface_that_do_not_meet_are_an_error() {
    let (receptor, ligand) = both_ends();
    let first = |atoms: &[Atom], numbers: std::ops::Range<i64>| -> Vec<Atom> {
        let kept = atoms
            .iter()
            .filter(|one| numbers.contains(&one.residue_number));
        kept.cloned().collect()
    };
    let halves = (first(&receptor, 1..5), first(&ligand, 5..9));
    let error = evaluator((&halves.0, &halves.1), (&receptor, &ligand)).unwrap_err();
    assert!(
        error.message().starts_with("only 0 and 0 backbone atoms"),
        "{error}"
    );
    assert!(error.remedy().unwrap().contains("backbone"));
    evaluator((&halves.0, &ligand), (&receptor, &ligand)).unwrap();
}

/// Two chains that touch at both ends of a long way: residues 1 to 4 at one, 5 to 8 at the other.
fn both_ends() -> (Vec<Atom>, Vec<Atom>) {
    let chain = |name: &str, x: f64| -> Vec<Atom> {
        let mut atoms = helix(name, "ACDEFGHI", [x, 0.0, 0.0]);
        for one in atoms.iter_mut().filter(|one| one.residue_number > 4) {
            one.position[2] += 100.0;
        }
        atoms
    };
    (chain("A", 0.0), chain("B", 8.0))
}

#[test]
fn strangers_and_lone_sides_are_errors() {
    let (receptor, ligand) = bound();
    let error = evaluator((&ligand, &receptor), (&receptor, &ligand)).unwrap_err();
    assert!(
        error.message().contains("sequence of the receptor"),
        "{error}"
    );
    let separate = moved(&ligand, &translation(100.0, 0.0, 0.0));
    let error = evaluator((&receptor, &ligand), (&receptor, &separate)).unwrap_err();
    assert!(error.message().contains("within 5 Å"), "{error}");
    let dot = vec![atom("B", 1, "GLY", "CA", [4.0, 0.0, 0.0])];
    let error = evaluator((&square("A", 0.0), &dot), (&square("A", 0.0), &dot)).unwrap_err();
    assert!(
        error
            .message()
            .starts_with("only 1 backbone atoms of the ligand"),
        "{error}"
    );
}

fn in_complex(receptor: &[Atom], ligand: &[Atom], complex: Vec<Atom>) -> Result<Evaluator, Error> {
    let complex: Molecule = molecule(complex);
    Evaluator::new(
        &molecule(receptor.to_vec()),
        &molecule(ligand.to_vec()),
        Native::Complex(&complex),
    )
}

#[test]
fn whole_complex_is_split_by_sequence() {
    let (receptor, ligand) = bound();
    let bystander = helix("Z", &random_sequence(24, 20), [0.0, 50.0, 0.0]);
    let complex = [renamed(&ligand, "P"), bystander, renamed(&receptor, "Q")].concat();
    let evaluator = in_complex(&receptor, &ligand, complex).unwrap();
    assert_perfect(evaluator.evaluate(&Pose::identity()));
    assert_eq!(evaluator.report().unused_native_chains, ["Z"]);
    assert_eq!(evaluator.report().permutations, 1);
    let error = in_complex(&receptor, &ligand, receptor.clone()).unwrap_err();
    assert!(
        error.message().contains("sequence of the ligand"),
        "{error}"
    );
}

#[test]
fn same_chain_on_both_sides_may_be_exchanged() {
    // One protein docked to itself: which copy is called the receptor is chance, and the pair has no exact symmetry.
    let (one, _) = bound();
    let turned = Pose::from_parts([0.3, 0.1, 0.9, 0.0], [10.0, 3.0, 55.0]);
    let two = renamed(&moved(&one, &turned), "B");
    let complex = [one.clone(), two.clone()].concat();
    let direct = in_complex(&one, &two, complex.clone()).unwrap();
    assert_perfect(direct.evaluate(&Pose::identity()));
    assert_eq!(direct.report().permutations, 2);
    // The same file for both, so that the copy moves onto the first, or away from it.
    let same = in_complex(&one, &one, complex).unwrap();
    assert_perfect(same.evaluate(&turned));
    assert_perfect(same.evaluate(&turned.inverse()));
}

#[test]
fn paralogues_are_not_exchanged() {
    // Two chains 60% equal: each could pass for the other, and a pose must not be judged so.
    let (one, _) = bound();
    let turned = Pose::from_parts([0.3, 0.1, 0.9, 0.0], [10.0, 3.0, 55.0]);
    let mut two = renamed(&moved(&one, &turned), "B");
    for atom in two.iter_mut().filter(|atom| atom.residue_number % 5 < 2) {
        atom.residue_name = if atom.residue_name == "TRP" {
            "ALA"
        } else {
            "TRP"
        }
        .into();
    }
    let evaluator = in_complex(&one, &two, [one.clone(), two.clone()].concat()).unwrap();
    assert_eq!(evaluator.report().permutations, 1);
}
