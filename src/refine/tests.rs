use std::path::Path;

use nalgebra::Vector3;

use knotdock_structures::molecule::{InputSpec, ReadOptions, read};

use super::*;

const ALL: RefineOptions = RefineOptions {
    moves: true,
    max_move: 3.0,
    side_chains: true,
    ph: 7.0,
};

fn example(name: &str) -> Molecule {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("structures/examples");
    let input = InputSpec::whole(folder.join(format!("1ppe_{name}.pdb")));
    read(&input, &ReadOptions::default()).unwrap()
}

fn shifted(z: f64) -> Pose {
    Pose::from_parts([1.0, 0.0, 0.0, 0.0], [0.0, 0.0, z])
}

/// The energy of a refined pose is that of its molecules at its pose, and each stage lowers it or is undone.
#[test]
fn stages_lower_the_energy_that_is_reported() {
    let molecules = ["receptor_unbound", "ligand_unbound"].map(example);
    let [receptor, ligand] = &molecules;
    let mut list = PairList::default();
    for pose in [shifted(0.0), shifted(0.7), shifted(-1.0)] {
        let mut refine = |moves, side_chains| {
            let options = RefineOptions {
                moves,
                side_chains,
                ..ALL
            };
            let refiner = Refiner::new([receptor, ligand], options).unwrap();
            refiner.refine(&pose, &mut list).unwrap()
        };
        let [both, moved, packed] = [(true, true), (true, false), (false, true)]
            .map(|(moves, side_chains)| refine(moves, side_chains));
        assert!(both.after.total() <= moved.after.total());
        assert!(moved.after.total() <= moved.before.total());
        assert!(packed.after.total() <= packed.before.total());
        assert!(both.after.total() < both.before.total());
        assert_eq!((packed.pose, packed.rmsd_moved), (pose, 0.0));
        assert!(!moved.has_moved_atoms() && moved.packing.is_none());
        for refined in [both, moved, packed] {
            assert!(refined.rmsd_moved <= ALL.max_move);
            let both = [0, 1].map(|side| refined.molecule(side, &molecules[side]));
            let fit = sharp_fit(both.each_ref(), ALL.ph).unwrap();
            assert_eq!(fit.energy(&refined.pose), refined.after);
            let moves = refined.packing.is_some_and(|packing| packing.moved > 0);
            assert!(!moves || refined.has_moved_atoms());
        }
    }
}

/// A crystal complex that was moved by an Ångström comes nearer to its place, and its energy ends no higher than at
/// that place.
#[test]
fn a_bound_complex_returns_to_its_place() {
    let molecules = ["receptor_bound", "ligand_bound"].map(example);
    let [receptor, ligand] = &molecules;
    let refiner = Refiner::new([receptor, ligand], ALL).unwrap();
    let refined = refiner
        .refine(&shifted(1.0), &mut PairList::default())
        .unwrap();
    let left = rmsd_between(ligand, &Pose::identity(), &refined.pose);
    assert!(left < 0.8, "{left}");
    let crystal = refiner.fit.energy(&Pose::identity());
    assert!(refined.after.total() <= crystal.total());
    assert!(refined.after.clashes <= crystal.clashes);
}

#[test]
fn no_move_is_longer_than_allowed() {
    let molecules = ["receptor_bound", "ligand_bound"].map(example);
    let [receptor, ligand] = &molecules;
    for max_move in [0.0, 0.3, 2.0] {
        let options = RefineOptions { max_move, ..ALL };
        let refiner = Refiner::new([receptor, ligand], options).unwrap();
        let refined = refiner.refine(&shifted(1.0), &mut PairList::default());
        let moved = refined.unwrap().rmsd_moved;
        assert!(moved <= max_move && (moved > 0.5) == (max_move == 2.0));
    }
}

#[test]
fn molecules_out_of_reach_stay() {
    let molecules = ["receptor_unbound", "ligand_unbound"].map(example);
    let [receptor, ligand] = &molecules;
    let refiner = Refiner::new([receptor, ligand], ALL).unwrap();
    let pose = shifted(1000.0);
    let refined = refiner.refine(&pose, &mut PairList::default()).unwrap();
    assert_eq!((refined.pose, refined.rmsd_moved), (pose, 0.0));
    assert_eq!((refined.before.total(), refined.after.total()), (0.0, 0.0));
    let packing = refined.packing.unwrap();
    assert!(packing.moved == 0 && packing.exact && !refined.has_moved_atoms());
}

/// The unbound molecules clash in the place of the bound ones. Refinement leaves at most a twentieth of the clashes, and atoms
/// that move keep their bonds, their hands and flat peptide bonds.
#[test]
fn minimisation_parts_what_clashes_and_keeps_shapes() {
    let molecules = ["receptor_unbound", "ligand_unbound"].map(example);
    let refiner = Refiner::new(molecules.each_ref(), ALL).unwrap();
    for pose in [shifted(0.0), shifted(0.7)] {
        let refined = refiner.refine(&pose, &mut PairList::default()).unwrap();
        let clashes = [refined.before.clashes, refined.after.clashes];
        assert!(
            clashes[0] > 5 && 20 * clashes[1] <= clashes[0],
            "{clashes:?}"
        );
        // Packing turns side chains, so shapes are compared with those that it left.
        let repacker = Repacker::new(&molecules[0], &molecules[1], RepackOptions::default());
        let packed = repacker.repack(&refined.pose);
        for (side, packed) in [packed.receptor, packed.ligand].iter().enumerate() {
            let after = refined.molecule(side, &molecules[side]);
            shapes_agree(&molecules[side], packed, &after);
        }
    }
}

/// Checks bonds, volumes spanned by CA and its neighbours, and torsions of peptide bonds. Bonds are those of the file:
/// packing may put other atoms as near.
fn shapes_agree(file: &Molecule, before: &Molecule, after: &Molecule) {
    let place = |molecule: &Molecule, atom: usize| Vector3::from(molecule.atoms[atom].position);
    let distance = |of: &Molecule, a: usize, b: usize| (place(of, a) - place(of, b)).norm();
    let count = before.atoms.len();
    let bonded: Vec<Vec<usize>> = (0..count)
        .map(|a| {
            let others = (0..count).filter(|&b| b != a);
            others.filter(|&b| distance(file, a, b) < 1.9).collect()
        })
        .collect();
    let mut torsions = 0;
    for (a, others) in bonded.iter().enumerate() {
        for &b in others {
            let stretched = distance(after, a, b) - distance(before, a, b);
            assert!(stretched.abs() < 0.1, "bond of {a} and {b}: {stretched}");
        }
        let name = |atom: usize| before.atoms[atom].name.as_str();
        if let ("CA", [x, y, z]) = (name(a), &others[..]) {
            let volume = |of: &Molecule| {
                let [x, y, z] = [x, y, z].map(|&end| place(of, end) - place(of, a));
                x.dot(&y.cross(&z))
            };
            assert!(volume(before) * volume(after) > 0.0, "hand of {a}");
        }
        let next = others.iter().find(|&&b| name(a) == "C" && name(b) == "N");
        let alpha = |of: usize| bonded[of].iter().find(|&&end| name(end) == "CA");
        if let Some(&next) = next
            && let (Some(&first), Some(&last)) = (alpha(a), alpha(next))
        {
            let sine = |of: &Molecule| {
                let [u, v, w] = [(first, a), (a, next), (next, last)]
                    .map(|(from, to)| place(of, to) - place(of, from));
                let (m, n) = (u.cross(&v), v.cross(&w));
                v.normalize().dot(&m.cross(&n)) / (m.norm() * n.norm())
            };
            let turned = (sine(after) - sine(before)).abs();
            assert!(turned < 0.2, "peptide bond of {a}: {turned}");
            torsions += 1;
        }
    }
    assert!(torsions > 20, "{torsions}");
}
