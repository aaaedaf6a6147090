//! Contacts and overlaps of one ligand atom with the receptor atoms near it, eight at a time in f32.

use super::Site;
use super::energy::{BOND_LENGTH, DEPTH, RANGE, TOLERANCE};
use crate::blocks::Blocks;
pub(super) use crate::blocks::LANES;
use crate::lanes::{each, total};
use knotdock_structures::PolarAtom;
use nalgebra::{Matrix3, Vector3};

/// A number for each of the atoms of a block.
type Lanes = [f32; LANES];

/// Coordinate of a place in a block that holds no atom, Å.
const NOWHERE: f32 = 1e4;
/// Overlap in Å from which a pair adds its whole stiffness to the curvature.
const FULL_STIFFNESS: f32 = 0.3;
/// Keeps the distance of atoms in one place from zero, Å².
const MIN_SQUARE: f32 = 1e-6;

/// Positions of the receptor atoms of a block relative to the centre of the interface, Å.
#[derive(Clone, Copy)]
pub(super) struct PositionLanes([Lanes; 3]);

impl PositionLanes {
    /// Those of all blocks.
    pub fn of_all(blocks: &Blocks, middle: &Vector3<f64>, all: &mut Vec<Self>) {
        all.clear();
        all.extend((0..blocks.len()).map(|index| {
            let positions = blocks.positions(index);
            Self(std::array::from_fn(|axis| {
                positions[axis].map(|x| {
                    if x.is_finite() {
                        (x - middle[axis]) as f32
                    } else {
                        NOWHERE
                    }
                })
            }))
        }));
    }
}

/// Data of the receptor atoms of a block for distances of contact.
pub(super) struct ContactLanes {
    /// Radii, Å.
    radii: Lanes,
    /// Largest distance of contact before the tolerance by the ligand atom's [`PolarKind`], Å.
    most: [Lanes; 4],
}

/// Whether a ligand atom donates (1), accepts (2) or does both (3).
#[derive(Clone, Copy)]
pub(super) struct PolarKind(u8);

impl PolarKind {
    pub fn of(polar: &PolarAtom) -> Self {
        Self(u8::from(polar.donates) | u8::from(polar.accepts) << 1)
    }

    fn bonds(self, receptor: &PolarAtom) -> bool {
        (self.0 & 1 != 0 && receptor.accepts) || (self.0 & 2 != 0 && receptor.donates)
    }
}

impl ContactLanes {
    /// Those of at most eight atoms.
    pub fn new(sites: &[Site]) -> Self {
        let most = |kind: PolarKind, site: &Site| {
            if kind.bonds(&site.polar) {
                BOND_LENGTH as f32
            } else {
                NOWHERE
            }
        };
        let lanes =
            |of: &dyn Fn(&Site) -> f32| std::array::from_fn(|lane| sites.get(lane).map_or(0.0, of));
        Self {
            radii: lanes(&|site| site.radius as f32),
            most: [0, 1, 2, 3].map(|kind| lanes(&|site| most(PolarKind(kind), site))),
        }
    }
}

/// Data of a ligand atom for sums.
#[derive(Clone, Copy)]
pub(super) struct LigandAtom {
    /// Radius, Å.
    radius: f32,
    kind: PolarKind,
}

impl LigandAtom {
    pub fn new(site: &Site) -> Self {
        Self {
            radius: site.radius as f32,
            kind: PolarKind::of(&site.polar),
        }
    }
}

/// Sums over blocks for one ligand atom.
pub(super) struct AtomSums {
    pub contacts: f64,
    pub overlap: f64,
    /// Derivative of the energy by the atom's position, RT/Å.
    pub gradient: Vector3<f64>,
    /// Second derivative of its overlaps, RT/Å².
    pub curvature: Matrix3<f64>,
}

/// Sums over some blocks about a ligand atom at a place, with a stiffness in RT/Å².
#[inline(always)]
pub(super) fn atom_sums(
    (numbers, positions, contacts): (&[u32], &[PositionLanes], &[ContactLanes]),
    atom: LigandAtom,
    at: &Vector3<f64>,
    stiffness: f64,
) -> AtomSums {
    let at = at.cast::<f32>();
    let (inverse, double) = (1.0 / RANGE as f32, 2.0 * stiffness as f32);
    let slope = 4.0 * DEPTH as f32 * inverse;
    let mut sums = [[0.0f32; LANES]; 11];
    let kind = usize::from(atom.kind.0 & 3);
    for &index in numbers {
        let (Some(PositionLanes([x, y, z])), Some(contact)) =
            (positions.get(index as usize), contacts.get(index as usize))
        else {
            debug_assert!(false, "there is no block of this number");
            continue;
        };
        let (radii, most) = (&contact.radii, &contact.most[kind]);
        // One operation at a time on all lanes: the compiler makes each of them one vector instruction.
        let dx = each(|lane| at.x - x[lane]);
        let dy = each(|lane| at.y - y[lane]);
        let dz = each(|lane| at.z - z[lane]);
        let square = each(|lane| {
            dx[lane] * dx[lane] + dy[lane] * dy[lane] + dz[lane] * dz[lane] + MIN_SQUARE
        });
        let distance = each(|lane| square[lane].sqrt());
        let one = each(|lane| 1.0 / distance[lane]);
        let sum = each(|lane| radii[lane] + atom.radius);
        let touching = each(|lane| {
            if sum[lane] < most[lane] {
                sum[lane]
            } else {
                most[lane]
            }
        });
        let beyond = each(|lane| distance[lane] - touching[lane] + TOLERANCE as f32);
        // Comparisons, not `max`, which would look for NaN.
        let lack = each(|lane| {
            if beyond[lane] < 0.0 {
                -beyond[lane]
            } else {
                0.0
            }
        });
        let t = each(|lane| {
            if beyond[lane] > 0.0 {
                beyond[lane] * inverse
            } else {
                0.0
            }
        });
        let t = each(|lane| if t[lane] < 1.0 { t[lane] } else { 1.0 });
        let rest = each(|lane| 1.0 - t[lane] * t[lane]);
        let rise = each(|lane| (slope * rest[lane] * t[lane] - double * lack[lane]) * one[lane]);
        let part = each(|lane| lack[lane] * (1.0 / FULL_STIFFNESS));
        let part = each(|lane| if part[lane] < 1.0 { part[lane] } else { 1.0 });
        let curved = each(|lane| double * part[lane] * one[lane] * one[lane]);
        let cx = each(|lane| curved[lane] * dx[lane]);
        let cy = each(|lane| curved[lane] * dy[lane]);
        let cz = each(|lane| curved[lane] * dz[lane]);
        let pairs: [(&Lanes, &Lanes); 11] = [
            (&rest, &rest),
            (&lack, &lack),
            (&rise, &dx),
            (&rise, &dy),
            (&rise, &dz),
            (&cx, &dx),
            (&cx, &dy),
            (&cx, &dz),
            (&cy, &dy),
            (&cy, &dz),
            (&cz, &dz),
        ];
        for (sum, (a, b)) in sums.iter_mut().zip(pairs) {
            *sum = each(|lane| sum[lane] + a[lane] * b[lane]);
        }
    }
    let mut s = [0.0; 11];
    for (sum, lanes) in s.iter_mut().zip(&sums) {
        *sum = f64::from(total(lanes));
    }
    let [contacts, overlap, gx, gy, gz, xx, xy, xz, yy, yz, zz] = s;
    AtomSums {
        contacts,
        overlap,
        gradient: Vector3::new(gx, gy, gz),
        curvature: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    }
}
