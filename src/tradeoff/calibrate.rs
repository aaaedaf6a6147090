//! Fits the cost model on this machine: dockings of a made-up pair of the size of a small complex, whose stages are
//! timed.

use knotdock_scoring::terms::effect::{Effect, contact, electrostatics};
use knotdock_scoring::terms::pose;
use knotdock_structures::Knots;
use knotdock_structures::knots::KnotsError;

use crate::dock::effect_decisions::Decision;
use crate::dock::outcome::StageTime;
use crate::dock::plan::{DockPlan, plan_scene};
use crate::dock::run::dock;
use crate::dock::scene::{LengthUnit, Scene};
use crate::error::SearchError;
use crate::options::DockOptions;
use crate::progress::Progress;
use crate::tradeoff::cost_model::{CostModel, Workload};
use knotdock_structures::molecule::LabelReport;

/// Spacing in Å of the lattice that the bodies' knots lie on: the density of atoms in proteins.
const LATTICE: f64 = 2.6;
/// Radii of the two bodies, Å.
const BODIES: [f64; 2] = [19.0, 9.7];
/// How many times more knots touch in a pose of two proteins than in one of two balls: the example pair's exact sums
/// against the made-up one's, on one machine.
const FLATTER: f64 = 1.4;
/// Dockings of each setting, of which the fastest counts stage by stage: whatever else runs on a machine only ever
/// slows one down. A build with debug assertions, which measures no machine, takes one.
const ROUNDS: usize = if cfg!(debug_assertions) { 1 } else { 3 };
/// Radii of knots, Å, in turn.
const RADII: [f64; 7] = [1.4, 1.5, 1.6, 1.65, 1.7, 1.8, 1.9];

/// Fits the cost model for so many threads, all of which should have nothing else to do.
///
/// # Errors
/// [`SearchError`], which would be a fault of this program.
pub fn calibrate(threads: usize, progress: &dyn Progress) -> Result<CostModel, SearchError> {
    let base = DockOptions::default().changed(|options| {
        options.search.rotations = 480;
        options.search.poses = 400;
        options.machine.threads = threads.into();
    });
    let settings = [
        base.changed(|options| options.search.refine = Some(100)),
        base.changed(|options| options.kernel.tolerance = 0.1),
        base.changed(|options| {
            options.kernel.spacing = Some(1.6);
            options.search.rotations = 240;
        }),
    ];
    // Memory is touched and the processor awake after one run.
    run(&settings[1], progress)?;
    let mut runs: Vec<Timed> = settings
        .iter()
        .map(|options| run(options, progress))
        .collect::<Result<_, _>>()?;
    // In turn, so that a slow spell of the machine falls on one round of each.
    for _ in (0..ROUNDS).skip(1) {
        for (options, timed) in settings.iter().zip(&mut runs) {
            timed.take_faster(run(options, progress)?);
        }
    }
    Ok(fit(&runs))
}

/// Dockings of a setting that were timed.
struct Timed {
    /// Each as fast as it ever was.
    stages: Vec<StageTime>,
    work: Workload,
    /// Exact sums of the stage `check`.
    checked: f64,
    rotations: f64,
    in_flight: f64,
    rotation_set_seconds: f64,
}

impl Timed {
    /// Processor seconds of a stage; where the system does not tell, those on the clock times the threads.
    fn stage(&self, name: &str) -> f64 {
        self.sum(name, |stage| {
            stage
                .cpu_seconds
                .unwrap_or(self.in_flight * stage.wall_seconds)
        })
    }

    /// Seconds on the clock of a stage that threads share in part.
    fn clock(&self, name: &str) -> f64 {
        self.sum(name, |stage| stage.wall_seconds)
    }

    fn sum(&self, name: &str, seconds: impl Fn(&StageTime) -> f64) -> f64 {
        let stages = self.stages.iter();
        stages.filter(|s| s.name == name).map(seconds).sum()
    }

    /// Takes over what was faster in another docking of the same setting.
    fn take_faster(&mut self, other: Self) {
        for (stage, again) in self.stages.iter_mut().zip(other.stages) {
            stage.wall_seconds = stage.wall_seconds.min(again.wall_seconds);
            stage.cpu_seconds = match (stage.cpu_seconds, again.cpu_seconds) {
                (Some(first), Some(second)) => Some(first.min(second)),
                _ => None,
            };
        }
        self.rotation_set_seconds = self.rotation_set_seconds.min(other.rotation_set_seconds);
    }
}

fn run(options: &DockOptions, progress: &dyn Progress) -> Result<Timed, SearchError> {
    let scene = scene(options)?;
    let points = scene.ligand.centers.clone();
    let start = std::time::Instant::now();
    let plan: DockPlan = plan_scene(scene, options)?;
    let rotation_set_seconds = start.elapsed().as_secs_f64();
    let outcome = dock(&plan, &points, progress)?;
    Ok(Timed {
        work: Workload {
            rank: outcome.rank as f64,
            ..Workload::of(&plan)
        },
        rotations: plan.rotations as f64,
        in_flight: plan.in_flight() as f64,
        rotation_set_seconds,
        checked: outcome.error.poses as f64,
        stages: outcome.timing,
    })
}

/// Two balls of labelled knots, with every effect on that a pair of proteins calls for.
fn scene(options: &DockOptions) -> Result<Scene, KnotsError> {
    let [receptor, ligand] = BODIES.map(body);
    let (receptor, ligand) = (receptor?, ligand?);
    let terms = vec![
        electrostatics::term(
            &receptor,
            &ligand,
            options.terms.weights.get("electrostatics"),
        ),
        contact::term(
            &receptor,
            &ligand,
            options.terms.weights.get("contact"),
            &contact::Potential::default(),
        ),
    ];
    let decisions = Effect::ALL.map(|effect| Decision {
        effect,
        on: effect != Effect::Restraint,
        reason: "calibration".to_owned(),
    });
    Ok(Scene {
        polar: None,
        unit: LengthUnit::Angstrom,
        angstrom: 1.0,
        skin: None,
        receptor,
        ligand,
        terms,
        decisions: decisions.to_vec(),
        labels: [LabelReport::default(), LabelReport::default()],
        active: Default::default(),
        restraints: Default::default(),
        regions: Default::default(),
        ring_axis: None,
    })
}

/// A ball of knots on a lattice.
fn body(radius: f64) -> Result<Knots, KnotsError> {
    let steps = (radius / LATTICE) as i32;
    let mut centers = Vec::new();
    for x in -steps..=steps {
        for y in -steps..=steps {
            for z in -steps..=steps {
                let center = [x, y, z].map(|step| LATTICE * f64::from(step));
                if center.iter().map(|x| x * x).sum::<f64>() <= radius * radius {
                    centers.push(center);
                }
            }
        }
    }
    let count = centers.len();
    let radii = (0..count).map(|index| RADII[index % RADII.len()]);
    let charges = (0..count).map(|index| if index % 2 == 0 { 0.3 } else { -0.3 });
    let types = (0..count).map(|index| Some((index % contact::TYPES.len()) as u8));
    let kinds = (0..count).map(|index| Some((index % pose::atom_kinds().len()) as u8));
    Knots::new(centers, radii.collect())?
        .with_labels(charges.collect(), types.collect())?
        .with_atom_kinds(kinds.collect())
}

/// Coefficients from timed runs; what a run does not tell comes from the built-in model, sped up or slowed down as
/// the rest is.
fn fit(runs: &[Timed]) -> CostModel {
    let built_in = CostModel::BUILT_IN;
    // Least squares of relative errors: seconds of a rotation over N log2 N against the rank.
    let points: Vec<(f64, f64)> = runs
        .iter()
        .map(|run| {
            let each = run.stage("search") / run.rotations / run.work.grid;
            (run.work.rank, each)
        })
        .collect();
    let (inverse, field) = line(&points).unwrap_or_else(|| {
        let ratios = points
            .iter()
            .map(|(rank, each)| each / (built_in.inverse + built_in.field * rank));
        let ratio = ratios.sum::<f64>() / points.len().max(1) as f64;
        (built_in.inverse * ratio, built_in.field * ratio)
    });
    let mean = |of: &dyn Fn(&Timed) -> f64, fallback: f64| {
        let values: Vec<f64> = runs
            .iter()
            .map(of)
            .filter(|value| value.is_finite() && *value > 0.0)
            .collect();
        if values.is_empty() {
            fallback
        } else {
            values.iter().sum::<f64>() / values.len() as f64
        }
    };
    let checked = |run: &Timed| run.stage("check") / run.checked;
    let pair = FLATTER
        * mean(
            &|run| checked(run) / run.work.pairs,
            built_in.pair / FLATTER,
        );
    let rotation_set = |run: &Timed| {
        run.rotation_set_seconds / (built_in.covering + built_in.rotation * run.rotations)
    };
    let sets = mean(&rotation_set, 1.0);
    CostModel {
        inverse,
        field,
        prepare: mean(
            &|run| run.clock("prepare") / (run.work.modes * run.work.effects),
            built_in.prepare,
        ),
        pair,
        rescore: mean(
            &|run| run.stage("rescore") / (run.work.rescored * run.work.ligand),
            built_in.rescore,
        ),
        refine: mean(
            &|run| run.stage("refine") / (run.work.refined * run.work.ligand),
            built_in.refine * pair / built_in.pair,
        ),
        rotation: built_in.rotation * sets,
        covering: built_in.covering * sets,
    }
}

/// The line a + b x through (x, y) points, by least squares of relative errors; `None` unless a and b are above zero.
fn line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let (mut aa, mut ab, mut bb, mut ya, mut yb) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for &(x, y) in points {
        let weight = 1.0 / (y * y);
        aa += weight;
        ab += weight * x;
        bb += weight * x * x;
        ya += weight * y;
        yb += weight * x * y;
    }
    let determinant = aa * bb - ab * ab;
    let (a, b) = (
        (bb * ya - ab * yb) / determinant,
        (aa * yb - ab * ya) / determinant,
    );
    (a.is_finite() && b.is_finite() && a > 0.0 && b > 0.0).then_some((a, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::cost_model::LADDER;

    #[test]
    fn the_line_is_that_of_the_points() {
        let (a, b) = line(&[(1.0, 5.0), (4.0, 11.0), (7.0, 17.0)]).unwrap();
        assert!((a - 3.0).abs() < 1e-9 && (b - 2.0).abs() < 1e-9);
        assert_eq!(line(&[(2.0, 5.0), (2.0, 6.0)]), None);
        assert_eq!(line(&[(1.0, 5.0), (2.0, 1.0)]), None, "falling");
    }

    #[test]
    fn no_rung_costs_more_than_a_finer_one() {
        let seconds = LADDER.map(|rung| {
            let mut options =
                DockOptions::default().changed(|options| options.search.rotations = 4);
            rung.apply(&mut options);
            let plan = plan_scene(scene(&options).unwrap(), &options).unwrap();
            CostModel::BUILT_IN.seconds(&Workload::of(&plan), 3600, 1)
        });
        // Two whose grids come out alike cost the same but for rounding.
        assert!(seconds.is_sorted_by(|a, b| *a <= 1.01 * b), "{seconds:?}");
    }

    #[test]
    fn bodies_are_of_a_protein_s_size() {
        let sizes = BODIES.map(|radius| body(radius).unwrap().len());
        assert!((1400..1900).contains(&sizes[0]) && (180..260).contains(&sizes[1]));
    }
}
