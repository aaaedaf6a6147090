//! `knotdock score`: one pose, exactly and from ever more modes.

use clap::{Args, ValueEnum};
use serde_json::{Value, json};

use crate::arguments::machine::default_limit;
use crate::arguments::options::{GivenOptions, OfScore, OptionArguments};
use crate::inputs::bodies::{Bodies, sampled, spec_of};
use crate::inputs::checks::refuse_traces;
use crate::inputs::molecules::Input;
use crate::inputs::poses::pose;
use crate::inputs::request::GivenMeshOptions;
use crate::inputs::solids::is_shape;
use crate::messages::console::Console;
use crate::messages::dock::{known_text, regions_text, site_text};
use crate::records::joined;
use crate::tables::report;
use knotdock::dock::scene::Scene;
use knotdock::options::DockOptions;
use knotdock::options::values::{AT_LEAST_ONE, in_range};
use knotdock::pose_geometry::PoseGeometry;
use knotdock::pose_space::arrangement::Arrangement;
use knotdock::score::{self, LADDER_ERROR, PoseScore, ScoreOptions};
use knotdock::threads;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::pose::{TermValues, Workspace};
use knotdock_scoring::transform::truncation::ModeOrder;
use knotdock_structures::Error;

/// Score one pose: the exact sum, and what m of its Fourier modes give, with the error and the time of each.
///
/// The number of modes m counts three-dimensional frequencies with their conjugates, and doubles until the error is
/// below 1e-3 of the exact value or of the scale, the best score at this rotation.
#[derive(Args, Debug)]
pub struct Score {
    /// The molecule that stays: .pdb, .ent or .cif, each also .gz; FILE:H,L picks chains by the author's names,
    /// FILE:H:1-120,L residues too. Or a mesh: .stl, .obj, .ply or .off.
    #[arg(value_name = "RECEPTOR")]
    receptor: String,
    /// The molecule that is moved.
    #[arg(value_name = "LIGAND")]
    ligand: String,
    /// The pose, as poses.csv has it: a unit quaternion and a translation in Å. A ligand atom at x goes to R x + t.
    #[arg(long, value_name = "QW,QX,QY,QZ,TX,TY,TZ", allow_hyphen_values = true)]
    pose: String,
    /// A number of modes that the table is to contain.
    #[arg(long, value_name = "COUNT", value_parser = in_range::<usize>(AT_LEAST_ONE))]
    modes: Option<usize>,
    /// Which modes come first.
    #[arg(long, value_enum, default_value_t = Order::LowFrequency)]
    order: Order,
    #[command(flatten)]
    options: OptionArguments<OfScore>,
}

/// [`ModeOrder`] by its name.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Order {
    /// From frequency zero outward.
    LowFrequency,
    /// By falling magnitude at the pose's rotation.
    Magnitude,
}

impl Score {
    pub fn run(self, console: Console) -> Result<(), Error> {
        let pose = pose(&self.pose)?;
        let given = self.options.given()?;
        let mut are_meshes = false;
        for text in [&self.receptor, &self.ligand] {
            are_meshes |= is_shape(&spec_of(text)?.path);
        }
        threads::on(given.options.machine.thread_count(), || {
            if are_meshes {
                self.score_meshes(&pose, given, console)
            } else {
                self.score(&pose, &given.options, console)
            }
        })?
    }

    fn ladder(&self, dock: &DockOptions) -> ScoreOptions {
        ScoreOptions {
            engine: dock.kernel.engine(),
            modes: self.modes,
            order: match self.order {
                Order::LowFrequency => ModeOrder::LowFrequency,
                Order::Magnitude => ModeOrder::Magnitude,
            },
            memory: default_limit(),
        }
    }

    /// Scores two meshes, sampled as `dock` samples them.
    fn score_meshes(
        &self,
        pose: &Pose,
        given: GivenOptions,
        console: Console,
    ) -> Result<(), Error> {
        let given_defaults = GivenMeshOptions {
            fixes_gap: true,
            ..(&given).into()
        };
        let mut dock = given.options;
        let bodies = Bodies::read(&self.receptor, &self.ligand, &dock)?;
        bodies.describe(Arrangement::Pair, console);
        let Bodies::Meshes(inputs) = &bodies else {
            return Err(Error::input("two meshes are needed"));
        };
        let (sampling, _) = sampled(inputs, &mut dock, given_defaults, console)?;
        let scene = Scene::of_meshes(&sampling.pair, &dock)?;
        let scored = score::score(&scene, pose, &self.ladder(&dock))?;
        console.say(format!("\n{}", ladder_text(&scored, "unit")));
        let further = json!({
            "pose": pose_numbers(pose),
            "sampling": sampling.pair.parts,
            "pose_score": scored.exact,
        });
        console.result(&joined([json!(scored), further]))
    }

    fn score(&self, pose: &Pose, dock: &DockOptions, console: Console) -> Result<(), Error> {
        let options = self.ladder(dock);
        let reading = dock.input.reading();
        let inputs = Input::read_all([&self.receptor, &self.ligand], &reading)?;
        refuse_traces(["receptor", "ligand"].into_iter().zip(&inputs))?;
        let [receptor, ligand] = inputs.map(|input| input.molecule);
        console.say(format!("Receptor: {}", receptor.report));
        console.say(format!("Ligand: {}", ligand.report));
        let scene = Scene::new(&receptor, &ligand, dock)?;
        let scored = score::score(&scene, pose, &options)?;
        let geometry = PoseGeometry::of(&receptor, &ligand, pose).map_err(Error::input)?;
        let pose_terms = scene
            .rescorer(dock)
            .map_or_else(TermValues::default, |rescorer| {
                rescorer.score(pose, &mut Workspace::default())
            });
        let pose_score = scored.exact + pose_terms.sum();
        console.say(format!("\n{}", ladder_text(&scored, "Å")));
        for text in known_text(&["receptor", "ligand"], &scene.restraints) {
            console.say(format!("Known: {text}"));
        }
        for text in regions_text(&["receptor", "ligand"], &scene.regions) {
            console.say(text);
        }
        if let Some(site) = scene.active_site() {
            console.say(site_text(site));
        }
        if let Some(terms) = pose_terms_text(&pose_terms) {
            console.say(format!(
                "{terms}: `dock` ranks this pose of a pair by {pose_score:.3}"
            ));
        }
        console.say(geometry_text(&geometry));
        if !scored.reached {
            console.warn(
                "all modes are in and the error is above its mark: the grid is too coarse for the kernel; leave --spacing out",
            );
        }
        let terms = pose_terms.iter();
        let terms = terms.map(|(term, value)| (term.id.to_owned(), json!(value)));
        console.result(&joined([
            json!(scored),
            json!({ "geometry": geometry, "active_site": scene.active_site() }),
            json!(scene.regions),
            json!({ "pose": pose_numbers(pose) }),
            Value::Object(terms.collect()),
            json!({ "pose_score": pose_score }),
        ]))
    }
}

/// Values of the pose terms that act; `None` if no term acts.
fn pose_terms_text(values: &TermValues) -> Option<String> {
    let acting = values
        .iter()
        .filter_map(|(term, value)| Some(format!("{} {:.3}", term.label, value?)));
    let terms = acting.collect::<Vec<_>>().join(", ");
    (!terms.is_empty()).then(|| format!("Pose terms: {terms}"))
}

fn pose_numbers(pose: &Pose) -> Value {
    let [qw, qx, qy, qz] = pose.quaternion();
    let [tx, ty, tz]: [f64; 3] = pose.translation.into();
    json!([qw, qx, qy, qz, tx, ty, tz])
}

fn geometry_text(geometry: &PoseGeometry) -> String {
    format!(
        "Buried surface {:.0} Å² ({:.0} of the receptor, {:.0} of the ligand); shared volume {:.1} Å³ of {:.0} and {:.0}: \
         Tanimoto similarity {:.4}, {:.2}% of the smaller protrudes",
        geometry.buried_area,
        geometry.buried_area_receptor,
        geometry.buried_area_ligand,
        geometry.volume_shared,
        geometry.volume_receptor,
        geometry.volume_ligand,
        geometry.shape_tanimoto,
        100.0 * geometry.protrusion,
    )
}

/// The exact score with its derivatives, and the table of modes.
fn ladder_text(scored: &PoseScore, unit: &str) -> String {
    let lines = scored.rows.iter().map(|row| {
        vec![
            row.modes.to_string(),
            format!("{:.3}", row.value),
            format!("{:.2e}", row.error),
            format!("{:.2e}", row.rms),
            format!("{:.1}", 1e6 * row.seconds),
            format!("{:.1}", 1e6 * row.seconds_new_rotation),
        ]
    });
    let vector = |v: [f64; 3]| format!("({:.2}, {:.2}, {:.2})", v[0], v[1], v[2]);
    let sensitivity = match &scored.offset_sensitivity {
        Some(sensitivity) => format!(
            "Sensitivity to the offset, per {unit}: {:.2} of the score, {} of the slices; by differences of the exact sum {:.2}, {}\n",
            sensitivity.score,
            vector(sensitivity.slices),
            sensitivity.exact_score,
            vector(sensitivity.exact_slices),
        ),
        None => String::new(),
    };
    format!(
        "Exact score {:.3} (without the low-pass {:.3}); best score at this rotation {:.3}\n\
         Gradient: {} per {unit}, {} per radian about the ligand's centre\n\
         {sensitivity}\
         \n{}\n\
         Modes: of {}, conjugates counted. Error: at this pose; rms: what the modes left out add over all translations.\n{}",
        scored.exact,
        scored.unfiltered,
        scored.scale,
        vector(scored.gradient.force),
        vector(scored.gradient.torque),
        report::text_table(
            "modes|value|error|rms|translation, µs|new rotation, µs",
            lines
        ),
        scored.modes_total,
        if scored.reached {
            format!(
                "The last error is below {LADDER_ERROR} of the exact value or of the best score."
            )
        } else {
            "The last error is what the grid leaves.".to_owned()
        }
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_scoring::terms::pose::POSE_TERMS;

    /// Every acting term is in the line of terms once, by its label.
    #[test]
    fn the_line_of_pose_terms_is_that_of_the_registry() {
        assert_eq!(pose_terms_text(&TermValues::default()), None);
        let values = POSE_TERMS
            .iter()
            .fold(TermValues::default(), |values, term| {
                values.with(term.id, 1.5)
            });
        let text = pose_terms_text(&values).unwrap();
        let expected = POSE_TERMS
            .iter()
            .map(|term| format!("{} 1.500", term.label));
        let found = text.strip_prefix("Pose terms: ").unwrap().split(", ");
        assert!(found.eq(expected), "{text}");
    }
}
