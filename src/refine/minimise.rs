//! Restrained minimisation of an interface: atoms that overlap move apart, and all keep the shape of their surroundings.
//!
//! Residues with an atom within 6 Å of the other molecule are loose; all else stays. The energy is, in RT,
//!
//! `E = sum k (d - d0)² over pairs one to three bonds apart + 20 sum (v - v0)² over corners + 20 sum max(0, c - d)²
//! + 0.1 sum |x - x0|²`
//!
//! - d0 is the distance at the start. The stiffness k is 200 RT/Å² for bonds and angles, which stay as they are, and 2 for
//!   atoms three bonds apart, so that torsions give.
//! - A corner is an atom with three that it is bonded to, or a torsion about a bond shorter than 1.42 Å, and v is the
//!   signed volume that these four atoms span. So hands stay hands, and peptide bonds and rings stay flat.
//! - Across the interface c is the distance of contact of the sharp fit ([`contact_distance`]) less an overlap that is no
//!   clash. Within a molecule it is at most d0: nothing that is near already is pushed away.
//! - Metals and atoms that bind them stay.
//!
//! FIRE finds the minimum (Bitzek et al., Phys. Rev. Lett. 97 (2006) 170201).

use knotdock_scoring::se3::Pose;
use knotdock_scoring::sharp::{CLASH, contact_distance};
use knotdock_structures::PolarAtom;
use knotdock_structures::molecule::{Atom, Molecule};
use knotdock_structures::neighbours::{CellList, Member};
use nalgebra::Vector3;

/// Distance in Å from the other molecule within which residues are loose.
const REACH: f64 = 6.0;
/// Distance in Å over which contacts are listed: two atoms in contact, either of which has moved.
const LISTED: f64 = 6.0;
/// Share of the sum of radii within which two atoms of a molecule are bonded: carbons at 2.3 Å.
const BONDED: f64 = 0.6;
/// Longest distance of a metal from an atom that binds it, Å.
const METAL: f64 = 2.8;
/// Stiffness of bonds and angles, RT/Å².
const STIFF: f64 = 200.0;
/// Stiffness between atoms three bonds apart, RT/Å².
const SOFT: f64 = 2.0;
/// Stiffness of corners, RT/Å^6.
const CORNER: f64 = 20.0;
/// Longest bond that does not turn, Å: peptide bonds have 1.33, rings 1.40, single bonds 1.43 and more.
const FLAT: f64 = 1.42;
/// Stiffness of overlaps, RT/Å².
const APART: f64 = 20.0;
/// Stiffness of the restraint to the place at the start, RT/Å².
const PLACE: f64 = 0.1;
/// Overlap across the interface that has no energy, Å; springs that hold atoms back leave more.
const LEFT: f64 = 0.15;

/// Largest force of a minimum, RT/Å: atoms in contact are then nearer by 0.01 Å.
const AT_REST: f64 = 0.4;
/// Steps at the most.
const STEPS: usize = 500;

/// Two atoms, at least one of them loose, and a distance in Å.
struct PairOf {
    atoms: [usize; 2],
    distance: f64,
    stiffness: f64,
}

/// Four atoms of a molecule, at least one of them loose, and the volume of the box on the edges from the first to the
/// others, Å³.
struct Corner {
    atoms: [usize; 4],
    volume: f64,
}

impl Corner {
    fn new(atoms: [usize; 4], places: &[Vector3<f64>]) -> Self {
        let [a, b, c] = edges(atoms, places);
        let volume = a.dot(&b.cross(&c));
        Self { atoms, volume }
    }
}

/// The edges from the first of four atoms to the others.
fn edges(atoms: [usize; 4], places: &[Vector3<f64>]) -> [Vector3<f64>; 3] {
    [1, 2, 3].map(|end| places[atoms[end]] - places[atoms[0]])
}

/// Terms of the energy: springs and corners keep shapes, contacts push.
#[derive(Default)]
struct Terms {
    springs: Vec<PairOf>,
    corners: Vec<Corner>,
    contacts: Vec<PairOf>,
}

/// The atoms that each atom of a molecule is bonded to, by its file. Packing keeps bonds, and may bring other atoms as near.
pub(super) fn bonds(molecule: &Molecule) -> Vec<Vec<usize>> {
    let atoms = &molecule.atoms;
    // An offset of the whole costs no cells.
    let origin = Vector3::from(atoms.first().map_or([0.0; 3], |atom| atom.position));
    let place = |atom: &Atom| -> [f64; 3] { (Vector3::from(atom.position) - origin).into() };
    let widest = atoms.iter().map(|atom| atom.radius).fold(0.1, f64::max);
    let members = atoms.iter().enumerate().map(|(item, atom)| Member {
        position: place(atom),
        item,
    });
    let cells = CellList::new(members.collect(), 2.0 * BONDED * widest);
    let of_atom = |(index, atom): (usize, &Atom)| {
        let mut bonded = Vec::new();
        cells.visit_within(
            place(atom),
            BONDED * (atom.radius + widest),
            |&other, square| {
                let reach = BONDED * (atom.radius + atoms[other].radius);
                if other != index && square < reach * reach {
                    bonded.push(other);
                }
            },
        );
        bonded
    };
    atoms.iter().enumerate().map(of_atom).collect()
}

/// Receptor and ligand, each in its own frame, with the overlaps of a pose relieved; `None` if nothing overlaps. `polar`
/// are their atoms' roles in hydrogen bonds, and `bonds` are those of [`bonds`].
pub(super) fn minimised(
    molecules: [&Molecule; 2],
    polar: [&[PolarAtom]; 2],
    bonds: [&[Vec<usize>]; 2],
    pose: &Pose,
) -> Option<[Molecule; 2]> {
    let atoms: Vec<&Atom> = molecules.iter().flat_map(|one| &one.atoms).collect();
    let polar: Vec<&PolarAtom> = polar.into_iter().flatten().collect();
    let first_of_ligand = molecules[0].atoms.len();
    // Relative to the ligand, so that cells span little.
    let origin = Vector3::from(pose.apply(molecules[1].atoms.first()?.position));
    let mut places: Vec<Vector3<f64>> = Vec::with_capacity(atoms.len());
    places.extend((molecules[0].atoms.iter()).map(|atom| Vector3::from(atom.position) - origin));
    let placed = molecules[1].atoms.iter();
    places.extend(placed.map(|atom| Vector3::from(pose.apply(atom.position)) - origin));
    let members = places.iter().enumerate().map(|(item, place)| Member {
        position: (*place).into(),
        item,
    });
    let cells = CellList::new(members.collect(), LISTED / 2.0);
    let across = |a: usize, b: usize| (a < first_of_ligand) != (b < first_of_ligand);
    let contact = |a: usize, b: usize| {
        let radii = atoms[a].radius + atoms[b].radius;
        contact_distance(radii, polar[a].may_bond(polar[b]))
    };
    let near = |atom: usize, reach: f64| {
        let mut found: Vec<(usize, f64)> = Vec::new();
        cells.visit_within(places[atom].into(), reach, |&other, square| {
            if other != atom {
                found.push((other, square.sqrt()));
            }
        });
        found
    };

    let mut is_near = vec![false; atoms.len()];
    let mut overlaps = false;
    for atom in (first_of_ligand..atoms.len()).filter(|&atom| !atoms[atom].is_hydrogen()) {
        for (other, distance) in near(atom, REACH) {
            if across(atom, other) && !atoms[other].is_hydrogen() {
                (is_near[atom], is_near[other]) = (true, true);
                overlaps |= distance < contact(atom, other) - CLASH;
            }
        }
    }
    if !overlaps {
        return None;
    }
    let loose = loose_atoms(molecules, &is_near, |atom| {
        let binds = || {
            near(atom, METAL)
                .iter()
                .any(|&(other, _)| atoms[other].is_metal())
        };
        atoms[atom].is_metal() || binds()
    });

    let [of_receptor, of_ligand] = bonds;
    let of_ligand = of_ligand.iter().map(|bonded| {
        let shifted = bonded.iter().map(|other| first_of_ligand + other);
        shifted.collect()
    });
    let bonded: Vec<Vec<usize>> = of_receptor.iter().cloned().chain(of_ligand).collect();
    let mut terms = Terms {
        corners: corners(&bonded, &loose, &places),
        ..Terms::default()
    };
    for atom in (0..atoms.len()).filter(|&atom| loose[atom]) {
        // A pair of loose atoms is listed once.
        let is_new = |other: usize| atom < other || !loose[other];
        let by_bonds = within_three_bonds(&bonded, atom);
        for &(other, bonds) in by_bonds.iter().filter(|(other, _)| is_new(*other)) {
            terms.springs.push(PairOf {
                atoms: [atom, other],
                distance: (places[atom] - places[other]).norm(),
                stiffness: if bonds < 3 { STIFF } else { SOFT },
            });
        }
        if atoms[atom].is_hydrogen() {
            continue;
        }
        for (other, distance) in near(atom, LISTED) {
            let is_bonded = by_bonds.iter().any(|(bonded, _)| *bonded == other);
            if is_bonded || atoms[other].is_hydrogen() || !is_new(other) {
                continue;
            }
            terms.contacts.push(PairOf {
                atoms: [atom, other],
                distance: match across(atom, other) {
                    true => contact(atom, other) - LEFT,
                    false => contact(atom, other).min(distance),
                },
                stiffness: APART,
            });
        }
    }
    let after = at_minimum(&places, &loose, &terms);
    let back = pose.inverse();
    let moved = |molecule: &Molecule, first: usize, frame: &dyn Fn([f64; 3]) -> [f64; 3]| {
        let mut moved = molecule.clone();
        for (place, atom) in moved.atoms.iter_mut().enumerate() {
            if loose[first + place] {
                atom.position = frame((after[first + place] + origin).into());
            }
        }
        moved
    };
    Some([
        moved(molecules[0], 0, &|x| x),
        moved(molecules[1], first_of_ligand, &|x| back.apply(x)),
    ])
}

/// Whether each atom of both molecules is loose: those of residues with an atom near the other molecule, unless
/// they are held.
fn loose_atoms(
    molecules: [&Molecule; 2],
    is_near: &[bool],
    is_held: impl Fn(usize) -> bool,
) -> Vec<bool> {
    let mut loose = vec![false; is_near.len()];
    let mut first = 0;
    for molecule in molecules {
        let all = vec![true; molecule.atoms.len()];
        for residue in molecule.atoms_by_residue(&all) {
            if residue.iter().any(|atom| is_near[first + atom]) {
                for atom in residue {
                    loose[first + atom] = !is_held(first + atom);
                }
            }
        }
        first += molecule.atoms.len();
    }
    loose
}

/// The atoms one to three bonds from one, each with the number of bonds, nearest first.
fn within_three_bonds(bonded: &[Vec<usize>], atom: usize) -> Vec<(usize, usize)> {
    let mut found = vec![(atom, 0)];
    let mut next = 0;
    while let Some(&(from, bonds)) = found.get(next).filter(|(_, bonds)| *bonds < 3) {
        for &other in &bonded[from] {
            if !found.iter().any(|(known, _)| *known == other) {
                found.push((other, bonds + 1));
            }
        }
        next += 1;
    }
    found.swap_remove(0);
    found
}

/// The corners with a loose atom: of atoms with three or more bonds, and of torsions that stay flat.
fn corners(bonded: &[Vec<usize>], loose: &[bool], places: &[Vector3<f64>]) -> Vec<Corner> {
    let mut corners = Vec::new();
    for (atom, others) in bonded.iter().enumerate() {
        if let [a, b, c, ..] = others[..] {
            corners.push([atom, a, b, c]);
        }
        let flat = |&&other: &&usize| atom < other && (places[atom] - places[other]).norm() < FLAT;
        for &other in others.iter().filter(flat) {
            for &first in others.iter().filter(|&&first| first != other) {
                let lasts = bonded[other].iter();
                for &last in lasts.filter(|&&last| last != atom && last != first) {
                    corners.push([atom, first, other, last]);
                }
            }
        }
    }
    corners.retain(|corner| corner.iter().any(|&atom| loose[atom]));
    corners
        .into_iter()
        .map(|atoms| Corner::new(atoms, places))
        .collect()
}

/// Places of all atoms at the minimum of the energy: springs, corners, and contacts that only push.
fn at_minimum(start: &[Vector3<f64>], loose: &[bool], terms: &Terms) -> Vec<Vector3<f64>> {
    // Steps are stable below twice the inverse of the highest frequency.
    const LONGEST: f64 = 0.025;
    let mut places = start.to_vec();
    let mut speeds = vec![Vector3::zeros(); start.len()];
    let mut forces = vec![Vector3::zeros(); start.len()];
    let moving: Vec<usize> = (0..start.len()).filter(|&atom| loose[atom]).collect();
    let (mut step, mut mixing, mut downhill) = (0.3 * LONGEST, 0.1, 0);
    for _ in 0..STEPS {
        for &atom in &moving {
            forces[atom] = 2.0 * PLACE * (start[atom] - places[atom]);
        }
        for corner in &terms.corners {
            let [a, b, c] = edges(corner.atoms, &places);
            let slopes = [b.cross(&c), c.cross(&a), a.cross(&b)];
            let push = 2.0 * CORNER * (corner.volume - a.dot(&slopes[0]));
            for (slope, &atom) in slopes.iter().zip(&corner.atoms[1..]) {
                forces[atom] += push * slope;
                forces[corner.atoms[0]] -= push * slope;
            }
        }
        let springs = terms.springs.iter().map(|pair| (pair, false));
        let contacts = terms.contacts.iter().map(|pair| (pair, true));
        for (pair, only_pushes) in springs.chain(contacts) {
            let [a, b] = pair.atoms;
            let between = places[b] - places[a];
            let square = between.norm_squared();
            // Atoms at one place have no direction to part in; others push them.
            if (only_pushes && square >= pair.distance * pair.distance) || square == 0.0 {
                continue;
            }
            let distance = square.sqrt();
            let push = 2.0 * pair.stiffness * (pair.distance - distance) / distance * between;
            forces[a] -= push;
            forces[b] += push;
        }
        let largest = moving.iter().map(|&atom| forces[atom].norm_squared());
        if largest.fold(0.0, f64::max) < AT_REST * AT_REST {
            break;
        }
        let sums = moving.iter().map(|&atom| {
            let (force, speed): (&Vector3<f64>, &Vector3<f64>) = (&forces[atom], &speeds[atom]);
            [force.dot(speed), force.norm_squared(), speed.norm_squared()]
        });
        let [power, force, speed] = sums.fold([0.0; 3], |sum, one| {
            std::array::from_fn(|part| sum[part] + one[part])
        });
        if power > 0.0 {
            downhill += 1;
            let along = mixing * (speed / force).sqrt();
            for &atom in &moving {
                speeds[atom] = (1.0 - mixing) * speeds[atom] + along * forces[atom];
            }
            if downhill > 5 {
                step = (1.1 * step).min(LONGEST);
                mixing *= 0.99;
            }
        } else {
            (downhill, mixing) = (0, 0.1);
            step *= 0.5;
            for &atom in &moving {
                speeds[atom] = Vector3::zeros();
            }
        }
        for &atom in &moving {
            speeds[atom] += step * forces[atom];
            places[atom] += step * speeds[atom];
        }
    }
    places
}
