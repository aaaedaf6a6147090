//! Contacts and overlaps of one ligand atom with the receptor atoms near it, eight at a time in f32.

use super::energy::{DEPTH, RANGE};
use nalgebra::{Matrix3, Vector3};

/// Pairs that are computed side by side.
pub(super) const LANES: usize = 8;
type Lanes = [f32; LANES];

/// Coordinate of a place in a block that holds no atom, Å.
const NOWHERE: f32 = 1e4;
/// Overlap in Å from which a pair adds its whole stiffness to the curvature.
const FULL_STIFFNESS: f32 = 0.3;
/// Keeps the distance of atoms in one place from zero, Å².
const LEAST: f32 = 1e-6;

/// Receptor atoms near a ligand atom: positions relative to the centre of the interface, and distances of contact (Å).
#[derive(Clone, Copy)]
pub(super) struct Block {
    pub x: Lanes,
    pub y: Lanes,
    pub z: Lanes,
    pub contact: Lanes,
}

impl Block {
    /// A block of places that hold no atom.
    pub const EMPTY: Self = Self {
        x: [NOWHERE; LANES],
        y: [NOWHERE; LANES],
        z: [NOWHERE; LANES],
        contact: [1.0; LANES],
    };
}

/// What blocks add up to for one ligand atom.
pub(super) struct AtomSums {
    pub contacts: f64,
    pub overlap: f64,
    /// Derivative of the energy by the atom's position, RT/Å.
    pub gradient: Vector3<f64>,
    /// Second derivative of its overlaps, RT/Å².
    pub curvature: Matrix3<f64>,
}

/// Sums over the blocks of a ligand atom at a place, with a stiffness in RT/Å².
#[inline(always)]
pub(super) fn atom_sums(blocks: &[Block], at: &Vector3<f64>, stiffness: f64) -> AtomSums {
    let at = at.cast::<f32>();
    let (inverse, double) = (1.0 / RANGE as f32, 2.0 * stiffness as f32);
    let slope = 4.0 * DEPTH as f32 * inverse;
    let mut sums = [[0.0f32; LANES]; 11];
    for block in blocks {
        // One operation at a time on all lanes: the compiler makes each of them one vector instruction.
        let dx = each(|lane| at.x - block.x[lane]);
        let dy = each(|lane| at.y - block.y[lane]);
        let dz = each(|lane| at.z - block.z[lane]);
        let square =
            each(|lane| dx[lane] * dx[lane] + dy[lane] * dy[lane] + dz[lane] * dz[lane] + LEAST);
        let distance = each(|lane| square[lane].sqrt());
        let one = each(|lane| 1.0 / distance[lane]);
        let beyond = each(|lane| distance[lane] - block.contact[lane]);
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
        *sum = total(lanes);
    }
    let [contacts, overlap, gx, gy, gz, xx, xy, xz, yy, yz, zz] = s;
    AtomSums {
        contacts,
        overlap,
        gradient: Vector3::new(gx, gy, gz),
        curvature: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    }
}

/// A value for each lane.
#[inline(always)]
fn each(value: impl Fn(usize) -> f32) -> Lanes {
    let mut lanes = [0.0; LANES];
    for (index, lane) in lanes.iter_mut().enumerate() {
        *lane = value(index);
    }
    lanes
}

/// Sum of the lanes, by halves.
#[inline(always)]
fn total(lanes: &Lanes) -> f64 {
    let [a, b, c, d, e, f, g, h] = *lanes;
    f64::from(((a + e) + (c + g)) + ((b + f) + (d + h)))
}
