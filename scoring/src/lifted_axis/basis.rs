//! The basis in which knots meet the fourth axis: radius classes, lifted modes, or nodes over the radii.

use super::LiftedAxis;
use crate::kernel::product::{Body, layer_factor};
use crate::kernel::table::Table;
use crate::kernel::{ProductKernel, RankingKernel};
use crate::quantity::Quantity;
use knotdock_structures::numeric::chebyshev;
use num_complex::Complex64;
use std::f64::consts::PI;

/// The functions of a radius in which receptor and ligand meet the lifted axis. Radii are in Å, those of the receptor
/// first.
#[derive(Clone, Debug, PartialEq)]
pub enum RadiusBasis {
    /// One indicator for each distinct radius: exact, and the shortest when radii are few.
    Classes([Vec<f64>; 2]),
    /// 1, cos and sin of 2 pi eta_k r for k = 1..=K: the lifted modes themselves, for any number of radii.
    Modes,
    /// Lagrange polynomials on Chebyshev nodes: any number of radii for the product kernel, whose factors are smooth in
    /// the radius and have no lifted modes.
    Nodes([Vec<f64>; 2]),
}

impl RadiusBasis {
    /// The shorter of classes and modes for these radii.
    pub fn choose(axis: &LiftedAxis, radii: [Vec<f64>; 2]) -> Self {
        if longest(&radii) <= 2 * axis.modes() + 1 {
            Self::Classes(radii)
        } else {
            Self::Modes
        }
    }

    /// The basis for a product kernel on |w| <= `w_max`, and its largest error of interpolating over radii, relative to
    /// the largest ball's transform. The error is 0 where each radius has its own class, else as near to `tolerance` as
    /// `MAX_NODES` nodes bring it.
    pub fn for_product(
        kernel: &ProductKernel,
        radii: [Vec<f64>; 2],
        w_max: f64,
        tolerance: f64,
    ) -> (Self, f64) {
        if longest(&radii) <= MAX_NODES {
            return (Self::Classes(radii), 0.0);
        }
        let [(receptor, a), (ligand, b)] =
            radii.map(|radii| nodes_for(kernel, &radii, w_max, tolerance));
        (Self::Nodes([receptor, ligand]), a.max(b))
    }

    /// Number of functions on the receptor's (0) or the ligand's side (1).
    pub fn size(&self, axis: &LiftedAxis, side: usize) -> usize {
        match self {
            Self::Classes(radii) | Self::Nodes(radii) => radii[side].len(),
            Self::Modes => 2 * axis.modes() + 1,
        }
    }

    /// Value of function `index` of a side at a radius.
    pub fn value(&self, axis: &LiftedAxis, side: usize, index: usize, radius: f64) -> f64 {
        match self {
            Self::Classes(radii) => f64::from(u8::from(radii[side][index] == radius)),
            Self::Nodes(nodes) => node_value(&nodes[side], index, radius),
            Self::Modes => mode_value(axis, index, radius),
        }
    }

    /// Radial spectrum that couples receptor function a with ligand function b in a quantity, on 0 <= |w| <= `w_max`;
    /// `None` where it is zero.
    pub fn coupling(
        &self,
        kernel: &RankingKernel,
        axis: &LiftedAxis,
        fold: Quantity,
        (a, b): (usize, usize),
        w_max: f64,
    ) -> Option<Table<1>> {
        let profile = match self {
            Self::Classes([receptor, ligand]) | Self::Nodes([receptor, ligand]) => {
                let sigma = receptor[a] + ligand[b];
                axis.profile(|axis, k| {
                    let turn = Complex64::cis(-2.0 * PI * axis.eta(k) * sigma)
                        * axis.fold_factor(kernel, fold, k);
                    if k == 0 { turn } else { 2.0 * turn }
                })
            }
            Self::Modes => {
                // sum_k Z_k exp(-i theta (r + s)) = Z_0 + 2 sum [Re Z cos theta(r + s) + Im Z sin theta(r + s)].
                let (ka, kb) = (a.div_ceil(2), b.div_ceil(2));
                if ka != kb {
                    return None;
                }
                let mix = match (a % 2 == 1, b % 2 == 1) {
                    _ if a == 0 => Complex64::new(1.0, 0.0),
                    (true, true) => Complex64::new(2.0, 0.0),
                    (false, false) => Complex64::new(-2.0, 0.0),
                    // Im Z = Re(-i Z).
                    _ => Complex64::new(0.0, -2.0),
                };
                axis.profile(|axis, k| {
                    if k == ka as i64 {
                        mix * axis.fold_factor(kernel, fold, k)
                    } else {
                        Complex64::new(0.0, 0.0)
                    }
                })
            }
        };
        let panel = 0.125 / kernel.reach();
        Some(Table::fit(w_max, panel.max(w_max / 2000.0), |w| {
            [kernel.spectrum_of(&profile, w)]
        }))
    }

    /// As [`Self::coupling`] for a product kernel: the product of the two bodies' transforms at the radii of the
    /// functions. Of `layers` if grown balls have separate weights, else of the double skins. `None` for
    /// [`Self::Modes`], whose functions have no radius, and if it is zero.
    pub fn product_coupling(
        &self,
        kernel: &ProductKernel,
        fold: Quantity,
        (a, b): (usize, usize),
        layers: Option<(Body, Body)>,
        w_max: f64,
    ) -> Option<Table<1>> {
        let (Self::Classes([receptor, ligand]) | Self::Nodes([receptor, ligand])) = self else {
            return None;
        };
        let (r, s) = (receptor[a], ligand[b]);
        let options = kernel.options();
        if layers.is_some_and(|layers| layer_factor(fold, layers, options.lambda) == 0.0) {
            return None;
        }
        let support = r + s + 2.0 * options.offset;
        let fall = 1.0 / options.resolution - 1.0 / options.pass_length;
        let panel = (0.25 / support).min(0.1 * fall);
        Some(Table::fit(w_max, panel.max(w_max / 2000.0), |w| {
            [match layers {
                Some(layers) => kernel.layer_coupling(fold, layers, (r, s), w),
                None => kernel.coupling(fold, r, s, w),
            }]
        }))
    }
}

/// Number of radii of the side that has more.
fn longest(radii: &[Vec<f64>; 2]) -> usize {
    radii[0].len().max(radii[1].len())
}

fn mode_value(axis: &LiftedAxis, index: usize, radius: f64) -> f64 {
    let angle = 2.0 * PI * axis.eta(index.div_ceil(2) as i64) * radius;
    if index % 2 == 1 || index == 0 {
        angle.cos()
    } else {
        angle.sin()
    }
}

/// Most nodes of [`RadiusBasis::Nodes`], and most distinct radii of a product kernel that each have a class.
const MAX_NODES: usize = 32;

/// Value at `radius` of the Lagrange polynomial that is 1 at node `index`.
fn node_value(nodes: &[f64], index: usize, radius: f64) -> f64 {
    let own = nodes[index];
    nodes
        .iter()
        .enumerate()
        .filter(|&(other, _)| other != index)
        .map(|(_, node)| (radius - node) / (own - node))
        .product()
}

/// The fewest Chebyshev nodes over a range of radii that carry both bodies' transforms to `tolerance`, and the error
/// reached.
fn nodes_for(kernel: &ProductKernel, radii: &[f64], w_max: f64, tolerance: f64) -> (Vec<f64>, f64) {
    let (Some(&low), Some(&high)) = (radii.first(), radii.last()) else {
        return (Vec::new(), 0.0);
    };
    if low == high {
        return (vec![low], 0.0);
    }
    let bodies = [Body::Solid, Body::Grown];
    let between = |i: usize, n: usize| low + (high - low) * i as f64 / n as f64;
    let mut reached = (Vec::new(), f64::INFINITY);
    for count in 2..=MAX_NODES {
        let nodes: Vec<f64> = chebyshev::nodes(count)
            .map(|x| 0.5 * (low + high) + 0.5 * (high - low) * x)
            .collect();
        let mut error = 0.0f64;
        for i in 0..=48 {
            let radius = between(i, 48);
            let values: Vec<f64> = (0..count).map(|m| node_value(&nodes, m, radius)).collect();
            for j in 0..=16 {
                let w = w_max * f64::from(j) / 16.0;
                for body in bodies {
                    let sum: f64 = nodes
                        .iter()
                        .zip(&values)
                        .map(|(&node, value)| value * kernel.spectrum(body, node, w))
                        .sum();
                    let scale = kernel.spectrum(body, high, 0.0);
                    error = error.max((sum - kernel.spectrum(body, radius, w)).abs() / scale);
                }
            }
        }
        reached = (nodes, error);
        if error <= tolerance {
            break;
        }
    }
    reached
}
