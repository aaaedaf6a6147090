use super::*;
use crate::molecule::model::Format;
use crate::molecule::{InputSpec, ReadOptions, read};
use std::f64::consts::TAU;
use std::path::Path;

fn example(name: &str) -> Molecule {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let spec = InputSpec::whole(folder.join(name));
    read(&spec, &ReadOptions::default()).unwrap()
}

fn positions(molecule: &Molecule) -> Vec<[f64; 3]> {
    molecule.atoms.iter().map(|atom| atom.position).collect()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    squared_distance(a, b).sqrt()
}

/// Chi angles read back what was set, and distances over one and two bonds stay: bond lengths and bond angles.
#[test]
fn a_side_chain_turns_to_what_is_set_and_keeps_its_bonds() {
    let molecule = example("1ppe_receptor_bound.pdb");
    let before = positions(&molecule);
    let mut turned = 0;
    for side_chain in molecule.side_chains() {
        if side_chain.held.is_some() {
            continue;
        }
        let present = side_chain.chi(&before);
        let mut after = before.clone();
        side_chain.set_chi(&mut after, &present);
        assert_eq!(after, before, "the present angles move nothing");
        let target: Vec<f64> = (0..present.len()).map(|k| 0.7 - 1.9 * k as f64).collect();
        side_chain.set_chi(&mut after, &target);
        for (set, target) in side_chain.chi(&after).iter().zip(&target) {
            let off = set - target;
            assert!((off - TAU * (off / TAU).round()).abs() < 1e-9);
        }
        let bonded = |a: usize, b: usize| distance(before[a], before[b]) < 1.95;
        let own = &side_chain.near_bonds;
        for &a in own {
            for &b in own {
                let over_two = own.iter().any(|&c| bonded(a, c) && bonded(c, b));
                if bonded(a, b) || over_two {
                    let change = distance(after[a], after[b]) - distance(before[a], before[b]);
                    assert!(change.abs() < 1e-9, "{side_chain:?} {a} {b}");
                }
            }
        }
        let fixed = (0..before.len()).filter(|atom| !side_chain.atoms.contains(atom));
        assert!(fixed.into_iter().all(|atom| before[atom] == after[atom]));
        side_chain.set_chi(&mut after, &present);
        assert!(
            before
                .iter()
                .zip(&after)
                .all(|(a, b)| distance(*a, *b) < 1e-9)
        );
        turned += 1;
    }
    assert!(turned > 120, "{turned}");
}

/// Trypsin has six disulphides; the example's chain is complete but for a few ends of long side chains.
#[test]
fn disulphides_are_held() {
    let side_chains = example("1ppe_receptor_bound.pdb").side_chains();
    let count = |reason| {
        side_chains
            .iter()
            .filter(|one| one.held == Some(reason))
            .count()
    };
    assert_eq!(count(HeldSideChain::Disulphide), 12);
    assert_eq!(count(HeldSideChain::Mirrored), 0);
    assert_eq!(count(HeldSideChain::Bonded), 0);
}

/// One serine of the example, changed in one way each.
#[test]
fn what_is_unlike_the_table_or_bonded_is_held() {
    let molecule = example("1ppe_receptor_bound.pdb");
    let serine = |change: &dyn Fn(&mut Vec<Atom>)| {
        let of = molecule.side_chains().into_iter();
        let free = of.filter(|one| one.name == "SER" && one.held.is_none());
        let first = free.into_iter().next().unwrap();
        let own = first
            .near_bonds
            .iter()
            .map(|&index| molecule.atoms[index].clone());
        let mut atoms: Vec<Atom> = own.filter(|atom| atom.residue_name == "SER").collect();
        change(&mut atoms);
        let changed = Molecule::new(atoms, Format::Pdb);
        changed.side_chains().first().unwrap().held
    };
    let place =
        |atoms: &[Atom], name: &str| atoms.iter().position(|atom| atom.name == name).unwrap();
    // An atom of another residue so far beyond OG, away from CB.
    let beside = |atoms: &mut Vec<Atom>, element: &str, away: f64| {
        let mut other = atoms[place(atoms, "OG")].clone();
        let from = atoms[place(atoms, "CB")].position;
        let bond = distance(from, other.position);
        let beyond = |k: usize| other.position[k] + (other.position[k] - from[k]) * away / bond;
        other.position = std::array::from_fn(beyond);
        other.residue_name = "LIG".to_owned();
        other.residue_number += 1000;
        (other.name, other.element) = (element.to_uppercase(), element.to_owned());
        atoms.push(other);
    };
    use HeldSideChain::{AlternateLocations, Bonded, Incomplete, Metal, Mirrored, OtherAtoms};
    assert_eq!(serine(&|_| {}), None);
    let without = |atoms: &mut Vec<Atom>| atoms.retain(|atom| atom.name != "OG");
    assert_eq!(serine(&without), Some(Incomplete));
    assert_eq!(
        serine(&|atoms| atoms.push(atoms[place(atoms, "OG")].clone())),
        Some(OtherAtoms)
    );
    let alternate = |atoms: &mut Vec<Atom>| {
        let og = place(atoms, "OG");
        atoms[og].alternate_location = Some('A');
    };
    assert_eq!(serine(&alternate), Some(AlternateLocations));
    let mirrored = |atoms: &mut Vec<Atom>| atoms.iter_mut().for_each(|a| a.position[0] *= -1.0);
    assert_eq!(serine(&mirrored), Some(Mirrored));
    assert_eq!(serine(&|atoms| beside(atoms, "Zn", 2.1)), Some(Metal));
    assert_eq!(serine(&|atoms| beside(atoms, "Zn", 3.1)), None);
    assert_eq!(serine(&|atoms| beside(atoms, "C", 1.5)), Some(Bonded));
    assert_eq!(serine(&|atoms| beside(atoms, "C", 2.1)), None);
    assert_eq!(serine(&|atoms| beside(atoms, "P", 1.8)), Some(Bonded));
}

/// Hydrogens turn with the atom that carries them, those of CB too; CA's stays.
#[test]
fn hydrogens_go_with_their_atoms() {
    let molecule = example("1ppe_receptor_bound.pdb");
    let of = molecule.side_chains().into_iter();
    let mut serines = of.filter(|one| one.name == "SER" && one.held.is_none());
    let serine = serines.next().unwrap();
    let own = serine
        .near_bonds
        .iter()
        .map(|&index| molecule.atoms[index].clone());
    let mut atoms: Vec<Atom> = own.filter(|atom| atom.residue_name == "SER").collect();
    let place =
        |atoms: &[Atom], name: &str| atoms.iter().position(|atom| atom.name == name).unwrap();
    // Each 1 Å from its carrier, opposite to another neighbour of it.
    let carried = [("HA", "CA", "C"), ("HB2", "CB", "OG"), ("HG", "OG", "CB")];
    for (name, carrier, neighbour) in carried {
        let [at, from] = [carrier, neighbour].map(|name| atoms[place(&atoms, name)].position);
        let bond = distance(at, from);
        let mut hydrogen = atoms[place(&atoms, carrier)].clone();
        hydrogen.position = std::array::from_fn(|k| at[k] + (at[k] - from[k]) / bond);
        (hydrogen.name, hydrogen.element) = (name.to_owned(), "H".to_owned());
        atoms.push(hydrogen);
    }
    let changed = Molecule::new(atoms, Format::Pdb);
    let serine = changed.side_chains().remove(0);
    assert_eq!(serine.held, None);
    let before = positions(&changed);
    let mut after = before.clone();
    serine.set_chi(&mut after, &[serine.chi(&before)[0] + 2.0]);
    for (name, carrier, _) in carried {
        let [hydrogen, carrier] = [name, carrier].map(|name| place(&changed.atoms, name));
        assert!((distance(after[hydrogen], after[carrier]) - 1.0).abs() < 1e-9);
        assert_eq!(after[hydrogen] == before[hydrogen], name == "HA");
    }
}

#[test]
fn a_turn_adds_to_the_dihedral_angle() {
    let [a, b, c] = [[1.0, 0.3, -0.2], [0.0; 3], [0.1, -0.2, 1.5]];
    let d = [1.0, 0.1, 2.0];
    let before = dihedral([a, b, c, d]);
    for angle in [0.0, 0.4, -1.3, 2.0] {
        let after = turned(d, b, c, angle);
        let difference = dihedral([a, b, c, after]) - before - angle;
        let turns = (difference / std::f64::consts::TAU).round();
        assert!((difference - turns * std::f64::consts::TAU).abs() < 1e-12);
    }
}

/// Looking down +z from b to c, a at +x and d at +y is a quarter turn clockwise.
#[test]
fn clockwise_is_positive() {
    let places = [[1.0, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    assert!((dihedral(places) - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
}
