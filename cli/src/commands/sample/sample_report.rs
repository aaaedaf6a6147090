//! Report of `knotdock sample` on a sampled solid.

use serde_json::{Value, json};

use crate::tables::report::{counted, text_table};
use knotdock_structures::mesh::{Figure, Solid};
use knotdock_structures::sampling::hausdorff::{Fit, HausdorffMeter};
use knotdock_structures::sampling::weights::FittedWeights;
use knotdock_structures::sampling::{Sampling, SetName};

pub(super) struct SampleReport<'a> {
    pub sampling: &'a Sampling,
    pub fits: &'a [Fit],
    /// Length of the sampler's unit in the file's.
    pub unit: f64,
    /// Of the solid, in the sampler's unit.
    pub volume: f64,
}

impl<'a> SampleReport<'a> {
    pub fn new(
        sampling: &'a Sampling,
        fits: &'a [Fit],
        solid: &Solid,
        meter: &HausdorffMeter,
    ) -> Self {
        Self {
            sampling,
            fits,
            unit: solid.frame().unit,
            volume: meter.volume(),
        }
    }

    /// Contradictions to the bounds of Algorithm 1, which hold for every closed mesh: one sentence each.
    pub fn doubts(&self) -> Vec<String> {
        let Some(covering) = self.sampling.covering else {
            return Vec::new();
        };
        let mut doubts = Vec::new();
        if covering.unreachable > 0 {
            doubts.push(format!(
                "the mesh is closed, yet {} samples of its surface have nothing of the solid under them: \
                 parts of it face the wrong way, cross or bound nothing, so that volume and balls may be wrong",
                covering.unreachable
            ));
        }
        let epsilon = self.epsilon();
        let inward = self.fits.iter().map(|fit| fit.hausdorff_inward * self.unit);
        let farthest = inward.fold(0.0, f64::max);
        if farthest > epsilon * (1.0 + 1e-9) {
            doubts.push(format!(
                "the mesh is closed, yet a point of the solid is {} from the balls, more than epsilon, {}: \
                 its surface contradicts itself, so that volume and balls may be wrong",
                Figure(farthest),
                Figure(epsilon)
            ));
        }
        doubts
    }

    fn epsilon(&self) -> f64 {
        self.sampling.field.grid.epsilon() * self.unit
    }

    /// Whether a node of the grid lies inside, so that volumes are counted.
    fn counts(&self) -> bool {
        self.sampling.inside_nodes > 0 && self.volume > 0.0
    }

    /// A volume in the file's unit, if the grid sees the solid at all.
    fn measured(&self, volume: f64) -> Option<f64> {
        self.counts().then(|| volume * self.unit.powi(3))
    }

    fn percent(&self, volume: f64) -> String {
        match self.counts() {
            true => format!("{:.3}", 100.0 * volume / self.volume),
            false => "-".to_owned(),
        }
    }

    /// For a person.
    pub fn text(&self) -> String {
        let grid = self.sampling.field.grid;
        let n = grid.per_axis();
        let rows = self.sampling.sets.iter().zip(self.fits).map(|(set, fit)| {
            vec![
                json!(set.name).as_str().unwrap_or_default().to_owned(),
                set.balls.len().to_string(),
                Figure(fit.hausdorff_inward * self.unit).to_string(),
                self.inward_bound(fit),
                Figure(fit.hausdorff_outward * self.unit).to_string(),
                Figure(fit.outward_bound * self.unit).to_string(),
                self.percent(fit.volume_missed),
                self.percent(fit.volume_outside),
                format!("{:.2}", set.seconds),
            ]
        });
        let header = "set|balls|inward|at most|outward|at most|missed, %|outside, %|seconds";
        let steps = self
            .sampling
            .steps
            .iter()
            .map(|step| format!("{} {:.2} s", step.name, step.seconds));
        let steps: Vec<String> = steps.collect();
        let added = match self.sampling.covering {
            Some(covering) => format!(
                "Added to cover the surface: {} balls, and {} inside{}\n",
                covering.surface_balls,
                covering.interior_balls,
                match covering.unreachable {
                    0 => String::new(),
                    count =>
                        format!("; {count} samples of the surface have nothing inside under them"),
                }
            ),
            None => String::new(),
        };
        let has = |name| self.sampling.sets.iter().any(|set| set.name == name);
        let sets = if has(SetName::A1) && has(SetName::A3) {
            "Sets: a1 lies inside the solid; a2, which is a1 grown by epsilon, covers it; a3 covers it with few balls.\n"
        } else {
            ""
        };
        format!(
            "Grid: {n} x {n} x {n} nodes, {} inside, spacing {}, epsilon {}\n\n{}\n\
             Inward: how far points of the solid are from the balls. The farthest is at least the first figure, which was \
             measured at samples, and at most the second, which is proven for closed meshes.\n\
             Outward: the same of points of the balls and the solid.\n\
             {sets}{added}Time: {}",
            self.sampling.inside_nodes,
            Figure(grid.spacing() * self.unit),
            Figure(self.epsilon()),
            text_table(header, rows),
            steps.join(", ")
        )
    }

    /// Fit of a level of detail, as text.
    pub fn level(&self, balls: usize, fit: &Fit) -> String {
        format!(
            "Level of detail: {}, {} from the solid outward (at most {}) and {} inward (at most {})",
            counted(balls, "ball"),
            Figure(fit.hausdorff_outward * self.unit),
            Figure(fit.outward_bound * self.unit),
            Figure(fit.hausdorff_inward * self.unit),
            self.inward_bound(fit)
        )
    }

    fn inward_bound(&self, fit: &Fit) -> String {
        let bound = fit.inward_bound;
        bound.map_or("-".to_owned(), |bound| {
            Figure(bound * self.unit).to_string()
        })
    }

    /// The sampling, for a program.
    pub fn object(&self) -> Value {
        json!({
            "grid": self.grid(),
            "inside_nodes": self.sampling.inside_nodes,
            "volume": self.measured(self.volume),
            "sets": self.sets(),
            "added": self.sampling.covering.map(|covering| json!({
                "surface_balls": covering.surface_balls,
                "interior_balls": covering.interior_balls,
                "unreachable_samples": covering.unreachable,
            })),
            "steps": self.sampling.steps,
        })
    }

    fn grid(&self) -> Value {
        let grid = self.sampling.field.grid;
        json!({
            "nodes": grid.nodes(),
            "per_axis": grid.per_axis(),
            "spacing": grid.spacing() * self.unit,
            "epsilon": self.epsilon(),
        })
    }

    fn sets(&self) -> Vec<Value> {
        let sets = self.sampling.sets.iter().zip(self.fits);
        sets.map(|(set, fit)| {
            let mut object = self.fit(fit);
            object["set"] = json!(set.name);
            object["balls"] = json!(set.balls.len());
            object["inside_nodes"] = json!(self.sampling.inside_nodes);
            object["epsilon"] = json!(self.epsilon());
            object["seconds"] = json!(set.seconds);
            object
        })
        .collect()
    }

    /// Fit of the balls to the solid, as JSON.
    pub fn fit(&self, fit: &Fit) -> Value {
        json!({
            "hausdorff_inward": fit.hausdorff_inward * self.unit,
            "inward_bound": fit.inward_bound.map(|bound| bound * self.unit),
            "hausdorff_outward": fit.hausdorff_outward * self.unit,
            "outward_bound": fit.outward_bound * self.unit,
            "volume_missed": self.measured(fit.volume_missed),
            "volume_outside": self.measured(fit.volume_outside),
            "nodes_missed": fit.nodes_missed,
        })
    }
}

pub(super) fn weights_text(fitted: &FittedWeights) -> String {
    format!(
        "Weights: summed bumps (alpha {}) are off one inside by {:.3} rms with weights of one and by {:.3} with those fitted; their \
         integral is {:.2} and {:.3} times the volume; {} weights are zero",
        fitted.alpha,
        fitted.rms_unit,
        fitted.rms_fitted,
        fitted.volume_unit,
        fitted.volume_fitted,
        fitted.zeros
    )
}
