//! Contacts between two molecules, of which one is moved by a pose, and the residues that the best clusters touch.

use knotdock_scoring::se3::Pose;
use knotdock_structures::PolarAtom;
use knotdock_structures::molecule::{Atom, Molecule};
use knotdock_structures::neighbours::{CellList, Member};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

use super::{CLASH, CONTACT, HYDROGEN_BOND, ResidueName, SALT_BRIDGE};

/// Two residues in contact, by default given by their indices in [`ContactFinder::residues`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Contact<Residue = usize> {
    /// The residue of each side.
    pub residues: [Residue; 2],
    /// Distance of their nearest heavy atoms, in Å.
    pub distance: f64,
    /// Hydrogen bonds between them.
    pub hydrogen_bonds: usize,
    /// Distance of donor and acceptor of the shortest of these, in Å.
    pub hydrogen_bond_distance: Option<f64>,
    /// Whether they make a salt bridge.
    pub salt_bridge: bool,
}

/// Two molecules made ready to find their contacts in any number of poses.
pub struct ContactFinder<'a> {
    /// By their places relative to the middle: coordinates may be far from zero.
    fixed: CellList<Site<'a>>,
    middle: [f64; 3],
    /// Most atoms of a pose are far from the fixed ones, which this shows at once.
    near: NearCells,
    moved: Vec<Site<'a>>,
    residues: [Vec<ResidueName>; 2],
}

impl<'a> ContactFinder<'a> {
    /// A finder for two molecules, the second of which moves; charges are those at a pH.
    pub fn new([fixed, moved]: [&'a Molecule; 2], ph: f64) -> Self {
        let (fixed, first) = sites(fixed, ph);
        let (moved, second) = sites(moved, ph);
        let count = fixed.len().max(1) as f64;
        let middle = std::array::from_fn(|axis| {
            let along = fixed.iter().map(|site| site.atom.position[axis]);
            along.sum::<f64>() / count
        });
        let members = fixed.into_iter().map(|site| Member {
            position: from(middle, site.atom.position),
            item: site,
        });
        let members: Vec<Member<Site>> = members.collect();
        let positions = members.iter().map(|member| member.position);
        Self {
            near: NearCells::new(positions.collect()),
            fixed: CellList::new(members, CONTACT),
            middle,
            moved,
            residues: [first, second],
        }
    }

    /// The residues of each side that have heavy atoms, in the order of the file.
    pub fn residues(&self) -> [&[ResidueName]; 2] {
        self.residues.each_ref().map(Vec::as_slice)
    }

    /// The residues in contact if the second molecule takes several poses at once (the copies of a ring), in the order
    /// of side 0, then of side 1.
    pub fn contacts(&self, poses: &[Pose]) -> Vec<Contact> {
        let mut found: BTreeMap<[usize; 2], Contact> = BTreeMap::new();
        for pose in poses {
            for other in &self.moved {
                let at = pose.apply(other.atom.position);
                let relative = from(self.middle, at);
                if !self.near.may_hold(relative) {
                    continue;
                }
                let direction = pose.rotation * nalgebra::Vector3::from(other.polar.direction);
                self.fixed.visit_within(relative, CONTACT, |one, square| {
                    let residues = [one.residue, other.residue];
                    let contact = found.entry(residues).or_insert(Contact {
                        residues,
                        distance: f64::INFINITY,
                        hydrogen_bonds: 0,
                        hydrogen_bond_distance: None,
                        salt_bridge: false,
                    });
                    contact.distance = contact.distance.min(square.sqrt());
                    let between = from(one.atom.position, at);
                    let may_bond = (CLASH * CLASH..=HYDROGEN_BOND * HYDROGEN_BOND)
                        .contains(&square)
                        && one.polar.may_bond(&other.polar);
                    if may_bond
                        && faces(one.polar.direction, between)
                        && faces(direction.into(), between.map(|part| -part))
                    {
                        let shortest = contact.hydrogen_bond_distance.unwrap_or(f64::INFINITY);
                        contact.hydrogen_bonds += 1;
                        contact.hydrogen_bond_distance = Some(shortest.min(square.sqrt()));
                    }
                    contact.salt_bridge |=
                        square <= SALT_BRIDGE * SALT_BRIDGE && one.sign * other.sign < 0;
                });
            }
        }
        found.into_values().collect()
    }
}

/// Cells of the edge [`CONTACT`] that may hold an atom in contact with one of some points.
struct NearCells {
    low: [f64; 3],
    counts: [usize; 3],
    /// Empty if there would be too many cells: then any place may.
    marked: Vec<bool>,
}

impl NearCells {
    /// Most cells; points that are farther apart are no molecule.
    const MAX: usize = 1 << 22;

    fn new(points: Vec<[f64; 3]>) -> Self {
        let along = |axis: usize| points.iter().map(move |point| point[axis]);
        // One cell more at either end.
        let low = [0, 1, 2].map(|axis| along(axis).fold(f64::INFINITY, f64::min) - CONTACT);
        let high = [0, 1, 2].map(|axis| along(axis).fold(f64::NEG_INFINITY, f64::max));
        let counts: [usize; 3] =
            std::array::from_fn(|axis| ((high[axis] - low[axis]) / CONTACT) as usize + 2);
        let mut all = counts.iter();
        let all = all.try_fold(1_usize, |all, &count| all.checked_mul(count));
        let mut cells = Self {
            low,
            counts,
            marked: Vec::new(),
        };
        let Some(all) = all.filter(|&all| !points.is_empty() && all <= Self::MAX) else {
            return cells;
        };
        let mut marked = vec![false; all];
        for [x, y, z] in points.into_iter().filter_map(|point| cells.cell(point)) {
            let about =
                |center: usize, count: usize| center.saturating_sub(1)..(center + 2).min(count);
            for i in about(x, counts[0]) {
                for j in about(y, counts[1]) {
                    for k in about(z, counts[2]) {
                        marked[(i * counts[1] + j) * counts[2] + k] = true;
                    }
                }
            }
        }
        cells.marked = marked;
        cells
    }

    fn cell(&self, point: [f64; 3]) -> Option<[usize; 3]> {
        let places: [f64; 3] = std::array::from_fn(|axis| (point[axis] - self.low[axis]) / CONTACT);
        let is_inside =
            (0..3).all(|axis| places[axis] >= 0.0 && places[axis] < self.counts[axis] as f64);
        is_inside.then(|| places.map(|place| place as usize))
    }

    fn may_hold(&self, point: [f64; 3]) -> bool {
        let marked =
            |[x, y, z]: [usize; 3]| self.marked[(x * self.counts[1] + y) * self.counts[2] + z];
        self.marked.is_empty() || self.cell(point).is_some_and(marked)
    }
}

/// An atom with its role in hydrogen bonds and salt bridges.
struct Site<'a> {
    residue: usize,
    atom: &'a Atom,
    polar: PolarAtom,
    /// Sign of its charge in a salt bridge.
    sign: i8,
}

/// The heavy atoms of a molecule, and the names of the residues that they point to.
fn sites(molecule: &Molecule, ph: f64) -> (Vec<Site<'_>>, Vec<ResidueName>) {
    let (polar, labels) = (molecule.polar_atoms(), molecule.labels(ph));
    let (mut sites, mut names) = (Vec::new(), Vec::new());
    for (residue, atoms) in heavy_residues(molecule).into_iter().enumerate() {
        for &at in &atoms {
            let atom = &molecule.atoms[at];
            sites.push(Site {
                residue,
                atom,
                polar: polar[at],
                sign: match (atom.element.as_str(), labels.group_signs[at]) {
                    ("N", 1) => 1,
                    ("O", -1) => -1,
                    _ => 0,
                },
            });
        }
        let first = atoms.first().map(|&at| &molecule.atoms[at]);
        names.extend(first.map(ResidueName::of));
    }
    (sites, names)
}

/// Indices of the heavy atoms of each residue that has any: the residues of [`ContactFinder::residues`].
pub fn heavy_residues(molecule: &Molecule) -> Vec<Vec<usize>> {
    let atoms = molecule.atoms.iter();
    let heavy: Vec<bool> = atoms.map(|atom| !atom.is_hydrogen()).collect();
    molecule.atoms_by_residue(&heavy)
}

/// Vector from one place to another.
fn from(one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| other[axis] - one[axis])
}

/// Whether the free side in a direction is towards an atom at `between`; an atom without a direction is free on all sides.
fn faces(direction: [f64; 3], between: [f64; 3]) -> bool {
    let along: f64 = (0..3).map(|axis| direction[axis] * between[axis]).sum();
    direction == [0.0; 3] || along > 0.0
}

/// Clusters that are counted, the best ones.
pub const CONSENSUS: usize = 50;

/// A residue, with the number of best clusters that touch it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResidueShare {
    /// The residue.
    pub residue: ResidueName,
    /// Clusters whose best pose has it in contact.
    pub clusters: usize,
    /// Their share of all clusters that were counted.
    pub share: f64,
}

/// The share of some clusters that touch each residue of either side. `clusters` are the contacts of the best pose of
/// each. Residues are in the order of their files, those that no cluster touches included.
pub fn residue_shares(finder: &ContactFinder, clusters: &[&[Contact]]) -> [Vec<ResidueShare>; 2] {
    let sides = finder.residues();
    let mut counts = sides.map(|residues| vec![0_usize; residues.len()]);
    for contacts in clusters {
        for (side, counts) in counts.iter_mut().enumerate() {
            let touched = contacts.iter().map(|contact| contact.residues[side]);
            for residue in touched.collect::<BTreeSet<usize>>() {
                counts[residue] += 1;
            }
        }
    }
    std::array::from_fn(|side| {
        let residues = sides[side].iter().zip(&counts[side]);
        let share = |(residue, &count): (&ResidueName, &usize)| ResidueShare {
            residue: residue.clone(),
            clusters: count,
            share: count as f64 / clusters.len().max(1) as f64,
        };
        residues.map(share).collect()
    })
}
