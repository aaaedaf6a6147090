//! The receptor's components that the ligand's knots read, and which knot reads which.
//!
//! With few radii a component belongs to a radius, and every knot reads one. With many, knots would read all of the
//! lifted modes; the factorisation of the lifted axis then replaces them.

use crate::engine::Plan;
use crate::engine::{Factors, ReceptorSpectra};
use num_complex::Complex64;
use std::f64::consts::PI;

/// Singular values below this share of the tolerance, relative to the largest, are left out where components are
/// factored: the error of the score is some ten times that of the singular values.
const SINGULAR_SHARE: f64 = 1e-2;

/// One component: a combination of the receptor's spectra.
pub(super) struct Component {
    /// (basis function, coefficient).
    terms: Vec<(usize, f64)>,
    /// (ligand knot, weight).
    pub knots: Vec<(usize, f64)>,
}

impl Component {
    /// H of the component at a mode.
    pub fn mode(&self, spectra: &ReceptorSpectra, place: usize) -> Complex64 {
        self.terms
            .iter()
            .map(|&(function, coefficient)| spectra.value(function, place) * coefficient)
            .sum()
    }
}

/// The components of a correlation.
pub(super) fn of(plan: &Plan, spectra: &ReceptorSpectra, knots: usize) -> Vec<Component> {
    let functions = spectra.full_rank();
    let direct: Vec<Component> = (0..functions)
        .map(|function| Component {
            terms: vec![(function, 1.0)],
            knots: nonzero(knots, |knot| spectra.ligand_weight(knot, function)),
        })
        .filter(|component| !component.knots.is_empty())
        .collect();
    let reads: usize = direct.iter().map(|component| component.knots.len()).sum();
    if reads <= 2 * knots {
        return direct;
    }
    let Factors {
        combination,
        coefficients,
        singular,
    } = spectra.factor(plan.modes());
    let largest = singular.first().copied().unwrap_or(0.0);
    let least = SINGULAR_SHARE * plan.options().tolerance * largest;
    let rank = singular.iter().filter(|&&value| value > least).count();
    if rank * knots >= reads {
        return direct;
    }
    (0..rank)
        .map(|q| Component {
            terms: (0..functions).map(|b| (b, combination[(b, q)])).collect(),
            knots: nonzero(knots, |knot| coefficients[(knot, q)]),
        })
        .collect()
}

fn nonzero(knots: usize, weight: impl Fn(usize) -> f64) -> Vec<(usize, f64)> {
    (0..knots)
        .map(|knot| (knot, weight(knot)))
        .filter(|&(_, weight)| weight != 0.0)
        .collect()
}

/// exp(+2 pi i w.c) by place of the mode, c the middle of the receptor in the box.
pub(super) fn centering(plan: &Plan, spectra: &ReceptorSpectra) -> impl Fn(usize) -> Complex64 {
    let center = spectra.center();
    let mut turns = Vec::with_capacity(plan.modes().count);
    plan.modes().for_each(|_, w, _| {
        turns.push(w[0] * center[0] + w[1] * center[1] + w[2] * center[2]);
    });
    move |place| Complex64::cis(2.0 * PI * turns[place])
}
