use std::path::Path;

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
