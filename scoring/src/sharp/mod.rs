//! The sharp fit: the energy of two rigid bodies at atomic resolution, and its optima near a pose.
//!
//! The score that a search ranks by is soft: it forgives errors of unbound surfaces. If the two files fit as they are (a
//! known complex that is docked again), an exact fit is strong evidence, and it shows at atomic resolution alone.
//!
//! # Energy
//!
//! In RT, over pairs of heavy atoms at distance d, with united-atom radii r and s:
//!
//! `E = sum of -0.25 W((d - c) / 2 Å) + 6 RT/Å² max(0, c - d)² - 1.5 sum over donors and acceptors of h`
//!
//! - c is the distance of contact: r + s - 0.1 Å, and at most 2.7 Å between a donor and an acceptor.
//! - W falls from 1 at contact to 0: (1 - t²)² for 0 < t < 1. The depth of a contact is about that of a pair of united
//!   atoms in a molecular force field (Jorgensen & Tirado-Rives, J. Am. Chem. Soc. 110 (1988) 1657-1666).
//! - h is a hydrogen bond by its heavy atoms: W((d - 2.8 Å) / 0.9 Å) times a weight of the angle at either atom. The
//!   weight is 1 where each points at the other to within 60 degrees, and 0 beyond 90. It counts twice between opposite
//!   charges. Baker & Hubbard (Prog. Biophys. Mol. Biol. 44 (1984) 97-179) describe distances and angles.
//!
//! # Descents
//!
//! [`SharpFit::descend`] is a Levenberg-Marquardt descent over the six rigid degrees of freedom, whose stiffness against
//! overlap grows over three rounds. Quasi-Newton steps then lead to the minimum. [`SharpFit::best_near`] starts from a
//! pose and from twelve places about it.
//!
//! Positions are relative to the bodies' centres. Lengths are in Å, energies in RT. Lower is better.

mod contacts;
mod descent;
mod energy;
mod pair_list;
#[cfg(test)]
mod tests;

pub use descent::Optimum;
pub use energy::{CLASH, Energy, contact_distance};
pub use pair_list::PairList;

use crate::blocks::{Blocks, NearPoints};
use crate::rigid_move::{center, heavy_atoms};
use crate::se3::Pose;
use contacts::{ContactLanes, LANES};
use knotdock_structures::{Knots, PolarAtom};
use nalgebra::{Matrix3, Vector3};

/// A heavy atom of a body.
#[derive(Clone, Copy, Debug)]
struct Site {
    /// Position relative to the body's centre, Å.
    position: Vector3<f64>,
    radius: f64,
    polar: PolarAtom,
    /// Charge, e.
    charge: f64,
}

/// Two rigid bodies prepared for sharp fits.
pub struct SharpFit {
    receptor: Blocks,
    /// The receptor's atoms, in the order of the blocks.
    sites: Vec<Site>,
    /// Distances of contact by block.
    contacts: Vec<ContactLanes>,
    /// The receptor's atoms that may be in hydrogen bonds.
    polar: Blocks,
    /// Their places among all, in the order of their blocks.
    polar_sites: Vec<usize>,
    receptor_center: Vector3<f64>,
    ligand: Vec<Site>,
    ligand_center: Vector3<f64>,
    /// Largest radius of a receptor atom, Å.
    widest: f64,
}

impl SharpFit {
    /// Prepares receptor and ligand with the roles of their atoms in hydrogen bonds: one label per knot, or none.
    pub fn new([receptor, ligand]: [&Knots; 2], polar: [&[PolarAtom]; 2]) -> Self {
        let (receptor_center, ligand_center) = (center(receptor), center(ligand));
        let sites_of = sites(receptor, polar[0], receptor_center);
        let ligand = sites(ligand, polar[1], ligand_center);
        let widest = |sites: &[Site]| {
            sites
                .iter()
                .fold(0.0, |most: f64, site| most.max(site.radius))
        };
        let positions = |sites: &[Site]| sites.iter().map(|site| site.position).collect::<Vec<_>>();
        let reach = pair_reach(widest(&sites_of) + widest(&ligand)) + PairList::USUAL_SLACK;
        let blocks = Blocks::within(&positions(&sites_of), reach);
        let sites_of = blocks.arranged(|index| sites_of[index]);
        let bonds = |site: &Site| site.polar.donates || site.polar.accepts;
        let polar: Vec<usize> = (0..sites_of.len())
            .filter(|&index| bonds(&sites_of[index]))
            .collect();
        let polar_blocks = Blocks::new(&positions(
            &polar
                .iter()
                .map(|&index| sites_of[index])
                .collect::<Vec<_>>(),
        ));
        Self {
            widest: widest(&sites_of),
            contacts: sites_of.chunks(LANES).map(ContactLanes::new).collect(),
            polar_sites: polar_blocks.arranged(|index| polar[index]),
            polar: polar_blocks,
            receptor: blocks,
            receptor_center,
            sites: sites_of,
            ligand,
            ligand_center,
        }
    }

    /// The energy of a pose: the plain double sum over pairs of atoms in f64.
    pub fn energy(&self, pose: &Pose) -> Energy {
        let (matrix, place) = self.placed(pose);
        let mut energy = Energy::default();
        let mut near = NearPoints::default();
        for site in &self.ligand {
            let at = matrix * site.position + place;
            let reach = self.reach(site);
            let direction = matrix * Vector3::from(site.polar.direction);
            self.receptor
                .list_near(&at.into(), reach, &mut near, |near| {
                    for (_, atom) in near.pairs() {
                        let Some(other) = self.sites.get(atom as usize) else {
                            debug_assert!(false, "an atom that is not there is near");
                            continue;
                        };
                        energy.add(other, site, &(at - other.position), &direction);
                    }
                });
        }
        energy
    }

    /// Distance in Å from which a ligand atom has no energy.
    fn reach(&self, ligand: &Site) -> f64 {
        pair_reach(self.widest + ligand.radius)
    }

    /// Rotation of the ligand, and the place of its centre relative to the receptor's.
    fn placed(&self, pose: &Pose) -> (Matrix3<f64>, Vector3<f64>) {
        let place = pose.rotation * self.ligand_center + pose.translation - self.receptor_center;
        (*pose.rotation.to_rotation_matrix().matrix(), place)
    }
}

/// Distance in Å from which two atoms have no energy, by the sum of their radii.
fn pair_reach(radii: f64) -> f64 {
    (radii + energy::RANGE).max(energy::BOND_REACH)
}

/// The heavy atoms of a body relative to `middle`.
fn sites(knots: &Knots, polar: &[PolarAtom], middle: Vector3<f64>) -> Vec<Site> {
    heavy_atoms(knots, middle)
        .map(|(index, position, radius)| Site {
            position,
            radius,
            polar: polar.get(index).copied().unwrap_or_default(),
            charge: knots.charges.get(index).copied().unwrap_or(0.0),
        })
        .collect()
}
