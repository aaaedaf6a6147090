//! Terms beside shape in the pair sum: their values at a pose, and their part of the gradient.
//!
//! A term has blocks of its own, which hold only the knots that take part in it: half of a protein's atoms carry no charge.

use super::blocks::{Block, Blocks, LANES};
use super::gradient::value_and_slope;
use super::tables::{Line, PairTables, Places};
use super::{ExactScorer, PoseGradient};
use crate::effect::{ActiveTerm, Effect};
use crate::se3::Pose;
use nalgebra::Vector3;

/// One term, prepared.
pub(super) struct PairTerm {
    effect: Effect,
    /// Receptor knots that take part: values as weights, classes as classes.
    receptor: Blocks,
    /// Ligand knots that take part: index, value, class.
    ligand: Vec<(usize, f64, usize)>,
    /// M by [ligand class][receptor class].
    rows: Vec<Vec<f64>>,
    /// The filtered radial function by panel, as the shape tables' panels lie.
    lines: Vec<Line>,
}

impl PairTerm {
    /// Prepares a term; `points` are the receptor's knots relative to its centre, in Å.
    pub fn new(active: &ActiveTerm, tables: &PairTables, points: &[Vector3<f64>]) -> Self {
        let term = &active.term;
        let classes = term.matrix.first().map_or(0, Vec::len);
        let members: Vec<usize> = (0..points.len())
            .filter(|&i| term.receptor.get(i).is_some_and(|label| label.value != 0.0))
            .collect();
        let pick = |of: &dyn Fn(usize) -> f64| members.iter().map(|&i| of(i)).collect::<Vec<f64>>();
        let inside: Vec<Vector3<f64>> = members.iter().map(|&i| points[i]).collect();
        let kinds: Vec<usize> = members.iter().map(|&i| term.receptor[i].class).collect();
        Self {
            effect: term.effect,
            receptor: Blocks::new(&inside, &pick(&|i| term.receptor[i].value), &kinds),
            ligand: term
                .ligand
                .iter()
                .enumerate()
                .filter(|(_, label)| label.value != 0.0 && label.class < classes)
                .map(|(j, label)| (j, label.value, label.class))
                .collect(),
            rows: (0..classes)
                .map(|b| term.matrix.iter().map(|row| row[b]).collect())
                .collect(),
            lines: tables.lines_of(|distance| active.kernel.value(distance)),
        }
    }
}

impl ExactScorer {
    /// Values of the terms beside shape at a pose, by effect; shape's own place stays 0.
    #[inline(always)]
    pub(super) fn effect_sums(&self, pose: &Pose) -> [f64; Effect::ALL.len()] {
        let mut totals = [0.0; Effect::ALL.len()];
        if self.effects.is_empty() {
            return totals;
        }
        let (rotation, center) = self.placed(pose);
        let reach = self.kernel.reach();
        for term in &self.effects {
            let mut total = 0.0;
            for &(knot, value, class) in &term.ligand {
                let x = (rotation * self.ligand[knot].position + center).into();
                let row = &term.rows[class];
                let mut sums = [[0.0; 4]; 2];
                term.receptor.near(
                    &x,
                    reach,
                    #[inline(always)]
                    |block| {
                        let places = self.tables.place(&block.squares(&x));
                        add_block(block, &places, row, &term.lines, &mut sums);
                    },
                );
                let four: [f64; 4] = std::array::from_fn(|k| sums[0][k] + sums[1][k]);
                total += value * ((four[0] + four[2]) + (four[1] + four[3]));
            }
            totals[term.effect as usize] += total;
        }
        totals
    }

    /// Sum of the terms beside shape at a pose and its gradient, which is added to `gradient`.
    #[inline(always)]
    pub(super) fn effect_gradient(&self, pose: &Pose, gradient: &mut PoseGradient) -> f64 {
        let (rotation, center) = self.placed(pose);
        let mut score = 0.0;
        for term in &self.effects {
            for &(knot, charge, class) in &term.ligand {
                let arm = rotation * self.ligand[knot].position;
                let x: [f64; 3] = (arm + center).into();
                let row = &term.rows[class];
                let mut value = 0.0;
                let mut force = [0.0; 3];
                term.receptor.near(
                    &x,
                    self.kernel.reach(),
                    #[inline(always)]
                    |block| {
                        let squares = block.squares(&x);
                        let places = self.tables.place(&squares);
                        for lane in 0..LANES {
                            let Some(line) = term.lines.get(places.panels[lane] as usize) else {
                                continue;
                            };
                            let weight = block.weights[lane] * entry(row, block.classes[lane]);
                            let (kernel, slope) = value_and_slope(line, places.offsets[lane]);
                            value += weight * kernel;
                            let distance = squares[lane].sqrt();
                            // Coincident knots: the kernel is even and smooth there, so its force is zero.
                            if distance > 0.0 {
                                let pull = weight * slope / distance;
                                for axis in 0..3 {
                                    force[axis] += (x[axis] - block.positions[axis][lane]) * pull;
                                }
                            }
                        }
                    },
                );
                score += charge * value;
                let force = Vector3::from(force) * (charge * self.tables.panels_per_unit());
                gradient.force += force;
                gradient.torque += arm.cross(&force);
            }
        }
        score
    }
}

#[inline(always)]
fn entry(row: &[f64], class: u32) -> f64 {
    row.get(class as usize).copied().unwrap_or(0.0)
}

/// Adds the kernel of eight receptor knots, each times its value and its entry of the class matrix.
#[inline(always)]
fn add_block(
    block: &Block,
    places: &Places,
    row: &[f64],
    lines: &[Line],
    sums: &mut [[f64; 4]; 2],
) {
    for lane in 0..LANES {
        let Some(Line(line)) = lines.get(places.panels[lane] as usize) else {
            continue;
        };
        let weight = block.weights[lane] * entry(row, block.classes[lane]);
        let u = places.offsets[lane];
        let square = u * u;
        let first = weight * u;
        let powers = [weight, first, weight * square, first * square];
        let fourth = square * square;
        let sum = &mut sums[lane % 2];
        for k in 0..4 {
            sum[k] += powers[k] * (line[k] + fourth * line[k + 4]);
        }
    }
}
