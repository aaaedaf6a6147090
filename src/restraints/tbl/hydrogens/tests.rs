//! The widened bound against means over directions, and against a complex with ideal hydrogens.

use super::*;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::pose::DistanceRestraint;
use knotdock_structures::molecule::{Atom, InputSpec, Molecule, ReadOptions, read};
use nalgebra::Vector3;

/// Points of a spiral on the unit sphere, each of the same share of it.
fn directions(count: usize) -> impl Iterator<Item = [f64; 3]> + Clone {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..count).map(move |at| {
        let z = 1.0 - (2 * at + 1) as f64 / count as f64;
        let (sin, cos) = (golden * at as f64).sin_cos();
        let flat = (1.0 - z * z).sqrt();
        [flat * cos, flat * sin, z]
    })
}

/// The closed forms are the means over all directions of one hydrogen and of two.
#[test]
fn factors_are_means_over_directions() {
    let count = 2000;
    for distance in [CONTACT, 5.0, 12.0] {
        let relative = |offset: [f64; 3]| -> f64 {
            let [x, y, z] = offset.map(|part| BOND * part / distance);
            ((1.0 + x).powi(2) + y * y + z * z).powi(-3)
        };
        let one: f64 = directions(count).map(relative).sum::<f64>() / count as f64;
        let both: f64 = directions(count)
            .flat_map(|a| directions(count).map(move |b| [a[0] - b[0], a[1] - b[1], a[2] - b[2]]))
            .map(relative)
            .sum::<f64>()
            / (count * count) as f64;
        assert!((factor(distance, 1) / (1.0 + one) - 1.0).abs() < 1e-3);
        assert!((factor(distance, 2) / (1.0 + 2.0 * one + both) - 1.0).abs() < 1e-3);
    }
    assert_eq!(factor(CONTACT, 0), 1.0);
}

#[test]
fn bounds_are_those_of_their_own_distance() {
    for sides in 0..=2 {
        for upper in [1e-3, 2.0, 3.0, 5.0, 30.0, 1e10] {
            let bound = widened(upper, sides);
            let expected = upper * factor(bound.max(CONTACT), sides).powf(1.0 / 6.0);
            assert!((bound / expected - 1.0).abs() < 1e-9, "{upper} {sides}");
        }
        // Far away hydrogens are where their heavy atoms are: n atoms for one on each side.
        let far = widened(1e6, sides) / 1e6;
        assert!((far - f64::from(1 << sides).powf(1.0 / 6.0)).abs() < 1e-6);
    }
    assert!((widened(2.0, 2) - 2.777).abs() < 1e-3);
    assert!((widened(5.0, 2) - 6.46).abs() < 1e-2);
}

/// Hydrogens of the atoms of each side chain but the backbone's, by the last letters of their names.
const HYDROGENS: [(&str, &str); 20] = [
    ("ALA", "CB3"),
    ("ARG", "CB2 CG2 CD2 NE1 NH12 NH22"),
    ("ASN", "CB2 ND22"),
    ("ASP", "CB2"),
    ("CYS", "CB2"),
    ("GLN", "CB2 CG2 NE22"),
    ("GLU", "CB2 CG2"),
    ("GLY", ""),
    ("HIS", "CB2 CD21 CE11 NE21"),
    ("ILE", "CB1 CG12 CG23 CD13"),
    ("LEU", "CB2 CG1 CD13 CD23"),
    ("LYS", "CB2 CG2 CD2 CE2 NZ3"),
    ("MET", "CB2 CG2 CE3"),
    ("PHE", "CB2 CD11 CD21 CE11 CE21 CZ1"),
    ("PRO", "CB2 CG2 CD2"),
    ("SER", "CB2 OG1"),
    ("THR", "CB1 OG11 CG23"),
    ("TRP", "CB2 CD11 NE11 CE31 CZ21 CZ31 CH21"),
    ("TYR", "CB2 CD11 CD21 CE11 CE21 OH1"),
    ("VAL", "CB1 CG13 CG23"),
];

/// How many hydrogens a heavy atom carries.
fn carried(atom: &Atom) -> usize {
    let residue = atom.residue_name.as_str();
    match atom.name.as_str() {
        "N" => usize::from(residue != "PRO"),
        "CA" => 1 + usize::from(residue == "GLY"),
        name => {
            let known = HYDROGENS.iter().find(|(known, _)| *known == residue);
            let mut words = known.map_or("", |(_, words)| words).split(' ');
            let count = words.find_map(|word| word.strip_prefix(name)?.parse().ok());
            count.unwrap_or(0)
        }
    }
}

/// The places of the hydrogens of an atom, at the angles of a tetrahedron from its bonds and from each other; one that
/// turns about a bond stands anywhere.
fn ideal_hydrogens(atom: &Atom, molecule: &Molecule) -> Vec<Vector3<f64>> {
    let at = Vector3::from(atom.position);
    let others = molecule.atoms.iter();
    let bonds: Vec<Vector3<f64>> = others
        .map(|other| Vector3::from(other.position) - at)
        .filter(|between| (0.5..1.9).contains(&between.norm()))
        .map(|between| between.normalize())
        .collect();
    let away = -bonds.iter().sum::<Vector3<f64>>();
    let half = (1.0 / 3f64.sqrt()).acos();
    let count = carried(atom);
    let directions: Vec<Vector3<f64>> = match (bonds.as_slice(), count) {
        (_, 0) => Vec::new(),
        ([bond], _) => {
            let across = bond.cross(&Vector3::new(0.36, 0.48, 0.8)).normalize();
            let other = bond.cross(&across);
            let turned = |at: usize| {
                let (sin, cos) = (std::f64::consts::TAU * at as f64 / 3.0).sin_cos();
                -bond / 3.0 + (8f64.sqrt() / 3.0) * (cos * across + sin * other)
            };
            (0..count).map(turned).collect()
        }
        ([one, other], 2) => {
            let (along, across) = (away.normalize(), one.cross(other).normalize());
            [1.0, -1.0]
                .map(|side| half.cos() * along + side * half.sin() * across)
                .to_vec()
        }
        _ => vec![away.normalize()],
    };
    let places = directions
        .into_iter()
        .map(|direction| at + BOND * direction);
    places.collect()
}

/// Number and insertion code.
type ResidueNumber = (i64, Option<char>);

/// A molecule of the example in its complex: positions of its heavy atoms, then of their hydrogens, and the residue of
/// each.
fn with_hydrogens(name: &str) -> (Vec<[f64; 3]>, Vec<ResidueNumber>, usize) {
    let path = format!(
        "{}/structures/examples/1ppe_{name}_bound.pdb",
        env!("CARGO_MANIFEST_DIR")
    );
    let molecule = read(&InputSpec::whole(path), &ReadOptions::default()).unwrap();
    let residue = |atom: &Atom| (atom.residue_number, atom.insertion_code);
    let mut positions: Vec<[f64; 3]> = molecule.atoms.iter().map(|atom| atom.position).collect();
    let mut residues: Vec<_> = molecule.atoms.iter().map(residue).collect();
    for atom in &molecule.atoms {
        for place in ideal_hydrogens(atom, &molecule) {
            positions.push(place.into());
            residues.push(residue(atom));
        }
    }
    (positions, residues, molecule.atoms.len())
}

/// A residue of the interface and all those across, at 2 Å, as HADDOCK's ambiguous restraints are: heavy atoms with
/// the widened bound say of a native complex what all atoms say.
#[test]
fn heavy_atoms_satisfy_what_all_atoms_satisfy() {
    let sides = ["receptor", "ligand"].map(with_hydrogens);
    let [receptor, ligand] = sides.each_ref().map(|(positions, ..)| positions.as_slice());
    // As many hydrogens as heavy atoms.
    let share =
        |(positions, _, heavy): &(Vec<_>, Vec<_>, usize)| positions.len() as f64 / *heavy as f64;
    assert!(sides.iter().all(|side| (1.9..2.1).contains(&share(side))));
    let near = |a: [f64; 3], b: [f64; 3]| (Vector3::from(a) - Vector3::from(b)).norm() < 5.0;
    let interface = [0, 1].map(|side| {
        let (own, others) = (&sides[side], &sides[1 - side]);
        let touches = |at: &usize| {
            others.0[..others.2]
                .iter()
                .any(|other| near(own.0[*at], *other))
        };
        let atoms = (0..own.2).filter(touches);
        atoms
            .map(|at| own.1[at])
            .collect::<std::collections::BTreeSet<_>>()
    });
    let [mut all, mut widened_heavy, mut written_heavy] = [0; 3];
    let mut differences = Vec::new();
    for side in 0..2 {
        for residue in &interface[side] {
            let distance = |heavy: bool| {
                let atoms = |of: usize| -> Vec<usize> {
                    let (_, residues, count) = &sides[of];
                    let is_meant = |at: &usize| match of == side {
                        true => residues[*at] == *residue,
                        false => interface[of].contains(&residues[*at]),
                    };
                    let last = if heavy { *count } else { residues.len() };
                    (0..last).filter(is_meant).collect()
                };
                let restraint = DistanceRestraint {
                    pairs: vec![[atoms(0), atoms(1)]],
                    lower: 0.0,
                    upper: 2.0,
                };
                restraint.effective_distance(receptor, ligand, &Pose::identity())
            };
            let (of_all, of_heavy) = (distance(false), distance(true));
            assert!(of_all <= of_heavy);
            all += usize::from(of_all <= 2.0);
            widened_heavy += usize::from(of_heavy <= widened(2.0, 2));
            written_heavy += usize::from(of_heavy <= 2.0);
            differences.push(of_heavy - of_all);
        }
    }
    let count = differences.len();
    let mean = differences.iter().sum::<f64>() / count as f64;
    assert!(
        count > 40 && 3 * written_heavy < all,
        "{written_heavy} {all} {count}"
    );
    assert!(
        all.abs_diff(widened_heavy) * 10 <= count,
        "{widened_heavy} {all} {count}"
    );
    assert!((mean - (widened(2.0, 2) - 2.0)).abs() < 0.15, "{mean}");
}
