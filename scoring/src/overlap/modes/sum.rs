//! The sum over modes at one pose, block by block, with the bound of the rest.

use super::lattice::{Entry, Lattice};
use super::spectrum::{Body, Phases, Sums};
use super::{OverlapModes, both_signs};
use crate::se3::Pose;
use crate::vectorized::vectorize;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Buffers of one evaluation at a time.
#[derive(Clone, Debug)]
pub struct ModesWorkspace {
    phases: Phases,
    sums: Vec<Sums>,
    /// Sums times the arm along an axis.
    turned: Vec<Sums>,
}

impl ModesWorkspace {
    pub(super) fn new(body: &Body, lattice: &Lattice) -> Self {
        let sums = vec![[0.0; 4]; lattice.widest()];
        Self {
            phases: Phases::new(body, lattice),
            turned: sums.clone(),
            sums,
        }
    }
}

/// Overlap energy from some modes, with its bounds: the energy of all modes is within `tail + rounding` of `energy`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModesOverlap {
    /// The sum over the modes so far.
    pub energy: f64,
    /// The most that the modes left out can add or take.
    pub tail: f64,
    /// The most that rounding and the transforms' errors can have done.
    pub rounding: f64,
    /// -dE/dt of the sum so far: the force on body B.
    pub force: Vector3<f64>,
    /// Minus the slope of the sum by a turn of B about the chosen point, in A's frame; 0 without such a point.
    pub torque: Vector3<f64>,
    /// Modes summed, conjugates counted.
    pub modes: usize,
    /// Whether all modes are in the sum.
    pub complete: bool,
    /// Whether no weight is negative, without which an energy certifies nothing.
    pub not_negative: bool,
}

impl ModesOverlap {
    /// Whether the energy is certainly above 0, so that a ball of A meets one of B (with a margin: comes nearer than
    /// it). `false` says nothing.
    pub fn certifies_hit(&self) -> bool {
        self.not_negative && self.energy > self.tail + self.rounding
    }
}

/// A sum that can stop and go on.
pub struct ModesSum<'a> {
    modes: &'a OverlapModes,
    work: &'a mut ModesWorkspace,
    /// Where torque is taken about, relative to B's middle.
    about: Option<Vector3<f64>>,
    next: usize,
    energy_b: f64,
    sum: ModesOverlap,
}

impl<'a> ModesSum<'a> {
    pub(super) fn new(
        modes: &'a OverlapModes,
        pose: &Pose,
        about: Option<[f64; 3]>,
        work: &'a mut ModesWorkspace,
    ) -> Self {
        let middle = pose.rotation * modes.b.center + pose.translation;
        let place = middle - modes.a.center;
        // NaN counts as no meeting.
        let together = place.norm() < modes.reach;
        if together {
            let rotation = pose.rotation.to_rotation_matrix();
            vectorize!(
                work.phases
                    .place(&modes.b, &modes.lattice, &rotation, &place)
            );
        }
        let mut sum = Self {
            modes,
            work,
            about: about.map(|about| Vector3::from(about) - middle),
            // Bodies that do not meet have overlap 0. Their images may meet.
            next: if together {
                0
            } else {
                modes.lattice.blocks.len()
            },
            energy_b: 0.0,
            sum: ModesOverlap {
                not_negative: modes.not_negative,
                complete: !together,
                ..ModesOverlap::default()
            },
        };
        if together {
            sum.bound();
        }
        sum
    }

    /// The sum so far.
    pub fn sum(&self) -> ModesOverlap {
        self.sum
    }

    /// Adds block after block until all modes are in or `stop` returns true, which is called before each with the sum so
    /// far. Call it again to go on.
    pub fn advance(&mut self, mut stop: impl FnMut(&ModesOverlap) -> bool) -> ModesOverlap {
        while !self.sum.complete && !stop(&self.sum) {
            self.block();
        }
        self.sum
    }

    /// Adds the next block.
    fn block(&mut self) {
        let Self { modes, work, .. } = self;
        let (Some(block), Some(spectrum)) = (
            modes.lattice.blocks.get(self.next),
            modes.spectra.get(self.next),
        ) else {
            self.sum.complete = true;
            return;
        };
        let radians = 2.0 * PI / modes.lattice.length;
        let about = self.about;
        let mut total = Totals::default();
        vectorize!({
            let ModesWorkspace {
                phases,
                sums,
                turned,
            } = &mut **work;
            phases.gather(&modes.b, block, None, sums);
            total = Totals::default();
            for column in &block.columns {
                let range = column.entries.clone();
                let along = [f64::from(column.ky), column.kz as f64];
                let entries = block.entries[range.clone()].iter();
                for ((entry, sums), a) in entries.zip(&sums[range.clone()]).zip(&spectrum[range]) {
                    total.add(entry, along, sums, a);
                }
            }
            if about.is_none() {
                return;
            }
            for axis in 0..3 {
                phases.gather(&modes.b, block, Some(axis), turned);
                for column in &block.columns {
                    let range = column.entries.clone();
                    let along = [f64::from(column.ky), column.kz as f64];
                    let entries = block.entries[range.clone()].iter();
                    for ((entry, turned), a) in
                        entries.zip(&turned[range.clone()]).zip(&spectrum[range])
                    {
                        total.turn(axis, entry, along, turned, a);
                    }
                }
            }
        });
        let volume = modes.lattice.length.powi(3);
        self.energy_b += total.energy_b / volume;
        self.sum.energy += total.energy;
        let force = total.force * radians;
        self.sum.force += force;
        if let Some(about) = about {
            self.sum.torque += total.torque * radians - about.cross(&force);
        }
        self.sum.modes += block.modes;
        self.next += 1;
        self.sum.complete = self.next == modes.lattice.blocks.len();
        self.bound();
    }

    /// Bounds after the blocks so far.
    fn bound(&mut self) {
        let modes = self.modes;
        let [norm, error] = modes.norm_b;
        let tail_b = (norm - self.energy_b).max(0.0) + error + modes.rounding_b[self.next];
        self.sum.tail = (modes.tails_a[self.next] * tail_b).sqrt();
        self.sum.rounding = modes.rounding[self.next] + 1e-12 * self.sum.energy.abs();
    }
}

/// Sums over the modes of a block; frequencies by index.
#[derive(Default)]
struct Totals {
    energy: f64,
    energy_b: f64,
    force: Vector3<f64>,
    torque: Vector3<f64>,
}

impl Totals {
    /// With G = f_A^ conj(f_B^): the energy's part is Re G, the force's w Im G.
    #[inline(always)]
    fn add(&mut self, entry: &Entry, [ky, kz]: [f64; 2], sums: &Sums, a: &[[f64; 2]; 2]) {
        let b = both_signs(sums);
        let mut odd = [0.0; 2];
        for sign in 0..2 {
            let ([ar, ai], [br, bi]) = (a[sign], b[sign]);
            let count = entry.counts[sign];
            self.energy += count * (ar * br + ai * bi);
            self.energy_b += count * (br * br + bi * bi);
            odd[sign] = count * (ai * br - ar * bi);
        }
        let both = odd[0] + odd[1];
        self.force += Vector3::new(entry.k as f64 * (odd[0] - odd[1]), ky * both, kz * both);
    }

    /// With H = Im f_A^ conj(D), D the transform of the bumps times their arms: the torque's part is H x w.
    #[inline(always)]
    fn turn(
        &mut self,
        axis: usize,
        entry: &Entry,
        [ky, kz]: [f64; 2],
        turned: &Sums,
        a: &[[f64; 2]; 2],
    ) {
        let d = both_signs(turned);
        let unit = Vector3::ith(axis, 1.0);
        for sign in 0..2 {
            let ([ar, ai], [dr, di]) = (a[sign], d[sign]);
            let odd = entry.counts[sign] * (ai * dr - ar * di);
            let k = entry.k as f64;
            let w = Vector3::new(if sign == 0 { k } else { -k }, ky, kz);
            self.torque += unit.cross(&w) * odd;
        }
    }
}
