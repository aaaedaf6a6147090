//! `knotdock sample`: a mesh as balls.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use knotdock::output::balls::{PseudoAtomError, write_mesh, write_pseudo_atoms, write_table};
use knotdock::output::report;
use knotdock::output::sample_picture::write_picture;
use knotdock_structures::mesh::{self, MeshError, Solid};
use knotdock_structures::sampler::decomposition::DecompositionOptions;
use knotdock_structures::sampler::hausdorff::{Fit, Referee};
use knotdock_structures::sampler::weights::{self, FittedWeights};
use knotdock_structures::sampler::{BallSet, Method, Sampling, SetName, Step, knots, sample};
use knotdock_structures::sphere_tree::SphereTree;
use serde_json::{Value, json};

use super::arguments::{above_zero, at_least_one, grid, protrusion};
use super::console::Console;
use super::failure::Failure;

/// Sample a mesh by balls: any closed surface as a few balls that come within a known distance of it.
///
/// Reads STL, OBJ, PLY and OFF, in text and binary. The method is Behandish and Ilies' Algorithm 1: A1 lies inside the solid, A2 is
/// A1 grown by epsilon and covers it, A3 is A2 without what is redundant; each is within epsilon of the solid, which is
/// measured. Lengths are in the file's unit.
#[derive(Args, Debug)]
pub struct Sample {
    /// The mesh: .stl, .obj, .ply or .off.
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
    /// Nodes of the grid, as 2^18 or 262144: a cube of the nearest whole number of nodes an axis.
    #[arg(long, value_name = "M", default_value = "2^18", value_parser = grid)]
    grid: usize,
    /// How balls are chosen.
    #[arg(long, value_enum, default_value_t = MethodName::Bi)]
    method: MethodName,
    /// Protrusion factor of method bi, 0 to 1: the less, the more and the smoother the balls of A1 [default: 0.25].
    #[arg(long, value_parser = protrusion)]
    mu: Option<f64>,
    /// Which set of method bi to write [default: a3].
    #[arg(long, value_enum)]
    set: Option<SetChoice>,
    /// Refuse meshes that are not closed or have triangles that face the wrong way.
    #[arg(long)]
    strict: bool,
    /// Weights of the balls: one, or those whose summed bumps come closest to one inside and to zero outside.
    #[arg(long, value_enum, default_value_t = Weights::Unit)]
    weights: Weights,
    /// Exponent of the bump that weights are fitted for.
    #[arg(long, default_value_t = 2.0, value_parser = above_zero)]
    alpha: f64,
    /// Write no more balls than this: a level of a tree of bounding balls over the set, which covers what the set covers.
    #[arg(long, value_name = "BALLS", value_parser = at_least_one, conflicts_with = "weights")]
    level: Option<usize>,
    /// The table of balls to write.
    #[arg(short, long, value_name = "FILE", default_value = "knots.csv")]
    output: PathBuf,
    /// Draw slices of depth, skeletal density and balls, and the balls from outside.
    #[arg(long, value_name = "FILE.svg")]
    picture: Option<PathBuf>,
    /// Write the balls as a mesh of spheres (.obj) or as pseudo-atoms (.pdb) too.
    #[arg(long, value_name = "FILE.obj|FILE.pdb")]
    export: Option<PathBuf>,
    /// Replace files that are there.
    #[arg(long)]
    force: bool,
}

/// [`Method`] by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// Behandish and Ilies, Algorithm 1.
    Bi,
    /// Weller and Zachmann, packing of the largest ball that fits.
    Wz,
    /// Balls about the cells of an octree.
    Octree,
    /// A ball about every voxel.
    Voxels,
}

/// [`SetName`] of method bi.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SetChoice {
    /// Inside the solid.
    A1,
    /// Covering the solid.
    A2,
    /// The fewest balls.
    A3,
}

/// What weights balls get.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Weights {
    /// One.
    Unit,
    /// Fitted by nonnegative least squares.
    Fitted,
}

/// Form in which balls are exported.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Export {
    Mesh,
    PseudoAtoms,
}

impl Sample {
    /// Samples.
    pub fn run(self, console: Console) -> Result<(), Failure> {
        let method = self.method()?;
        let export = self.check_files()?;
        let start = Instant::now();
        let (mesh, report) = mesh::read(&self.mesh)?;
        let seconds = start.elapsed().as_secs_f64();
        console.say(format!("Mesh: {report}"));
        for warning in report.warnings() {
            if self.strict {
                return Err(Failure::input(warning)
                    .at(&self.mesh)
                    .remedy("mend the mesh, or leave --strict out to sample what the winding number calls inside"));
            }
            console.warn(warning);
        }
        let solid = Solid::new(&mesh).map_err(|error| Failure::input(error).at(&self.mesh))?;
        let mut sampling = sample(&solid, self.grid, method).map_err(|error| {
            Failure::input(error).at(&self.mesh).remedy(
                "check that the mesh is closed and one solid, or sample it on a finer --grid",
            )
        })?;
        sampling.steps.insert(
            0,
            Step {
                name: "reading the mesh",
                seconds,
            },
        );

        let start = Instant::now();
        let referee = Referee::new(&solid, &sampling.field);
        let fits: Vec<Fit> = sampling
            .sets
            .iter()
            .map(|set| referee.judge(&set.balls))
            .collect();
        let volume = referee.volume();
        let seconds = start.elapsed().as_secs_f64();
        sampling.steps.push(Step {
            name: "measuring the fit",
            seconds,
        });

        let chosen = self.chosen(&sampling)?;
        let mut balls = chosen.balls.clone();
        let start = Instant::now();
        let fitted = match self.weights {
            Weights::Unit => None,
            Weights::Fitted => Some(weights::fit(&sampling.field, &balls, self.alpha, volume)),
        };
        let mut level = None;
        if let Some(count) = self.level {
            if let Some(tree) = SphereTree::new(&balls) {
                balls = tree.level(count);
            }
            level = Some(referee.judge(&balls));
        }
        if fitted.is_some() || level.is_some() {
            let name = if fitted.is_some() {
                "fitting weights"
            } else {
                "sphere tree"
            };
            let seconds = start.elapsed().as_secs_f64();
            sampling.steps.push(Step { name, seconds });
        }
        let frame = solid.frame();
        let knots = knots(
            frame,
            &balls,
            fitted.as_ref().map(|fitted| fitted.weights.as_slice()),
        )
        .map_err(|error| Failure::input(error).at(&self.mesh))?;
        write_table(&knots, &self.output)?;
        let mut files = vec![&self.output];
        if let (Some(path), Some(export)) = (&self.export, export) {
            match export {
                Export::Mesh => write_mesh(&knots, path)?,
                Export::PseudoAtoms => write_pseudo_atoms(&knots, path)?,
            }
            files.push(path);
        }
        if let Some(path) = &self.picture {
            write_picture(&solid, &balls, path)?;
            files.push(path);
        }

        let told = Told {
            sampling: &sampling,
            fits: &fits,
            unit: frame.unit,
            volume,
        };
        console.say(format!("\n{}", told.text()));
        if let Some(fitted) = &fitted {
            console.say(format!("\n{}", weights_text(fitted)));
        }
        if let Some(fit) = &level {
            console.say(format!(
                "\nLevel of detail: {} balls, {:.6} from the solid outward and {:.6} inward",
                balls.len(),
                fit.hausdorff_outward * frame.unit,
                fit.hausdorff_inward * frame.unit
            ));
        }
        let written: Vec<String> = files
            .iter()
            .map(|file| file.display().to_string())
            .collect();
        console.say(format!(
            "\nWrote {} balls to {}",
            knots.len(),
            written.join(", ")
        ));
        console.result(&json!({
            "knots": self.output.display().to_string(),
            "files": written,
            "balls": knots.len(),
            "set": chosen_name(&self, &sampling),
            "mesh": report,
            "warnings": report.warnings(),
            "grid": told.grid(),
            "inside_nodes": sampling.inside_nodes,
            "volume": volume * frame.unit.powi(3),
            "sets": told.sets(),
            "added": sampling.covering.map(|covering| json!({
                "surface_balls": covering.surface_balls,
                "interior_balls": covering.interior_balls,
                "unreachable_samples": covering.unreachable,
            })),
            "level": level.map(|fit| told.fit(&fit)),
            "weights": fitted,
            "steps": sampling.steps,
        }));
        Ok(())
    }

    /// The method with its options; options of other methods are refused.
    fn method(&self) -> Result<Method, Failure> {
        if self.method != MethodName::Bi && (self.mu.is_some() || self.set.is_some()) {
            return Err(Failure::input("--mu and --set belong to method bi")
                .remedy("leave them out, or sample with --method bi"));
        }
        Ok(match self.method {
            MethodName::Bi => {
                let default = DecompositionOptions::default();
                Method::BehandishIlies(DecompositionOptions {
                    mu: self.mu.unwrap_or(default.mu),
                    ..default
                })
            }
            MethodName::Wz => Method::WellerZachmann,
            MethodName::Octree => Method::Octree,
            MethodName::Voxels => Method::Voxels,
        })
    }

    /// Checks, before any work, that the files to write are not there and can be made.
    fn check_files(&self) -> Result<Option<Export>, Failure> {
        let files: Vec<&PathBuf> = [
            Some(&self.output),
            self.picture.as_ref(),
            self.export.as_ref(),
        ]
        .into_iter()
        .flatten()
        .collect();
        for (index, file) in files.iter().enumerate() {
            if files[..index].contains(file) || **file == self.mesh {
                return Err(Failure::input("the same file is named twice")
                    .at(file)
                    .remedy("give each file to write a name of its own"));
            }
            // A device or a pipe is there and is meant to be written to.
            if !self.force && file.is_file() {
                return Err(Failure::input("the file is already there")
                    .at(file)
                    .remedy("choose another name, or pass --force to replace it"));
            }
            let folder = file
                .parent()
                .filter(|folder| !folder.as_os_str().is_empty());
            if file.is_dir() || !folder.unwrap_or(Path::new(".")).is_dir() {
                return Err(Failure::input(
                    "cannot write there: the folder does not exist or the name is a folder's",
                )
                .at(file)
                .remedy("name a file in a folder that exists"));
            }
        }
        let Some(path) = &self.export else {
            return Ok(None);
        };
        let ending = path
            .extension()
            .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("obj") => Ok(Some(Export::Mesh)),
            Some("pdb") => Ok(Some(Export::PseudoAtoms)),
            _ => Err(Failure::input("--export writes .obj and .pdb files")
                .at(path)
                .remedy(
                    "end the name with .obj for a mesh of spheres or with .pdb for pseudo-atoms",
                )),
        }
    }

    /// The set to write.
    fn chosen<'a>(&self, sampling: &'a Sampling) -> Result<&'a BallSet, Failure> {
        let name = chosen_name(self, sampling);
        let found = sampling.sets.iter().find(|set| Some(set.name) == name);
        found.ok_or_else(|| Failure::other("the sampler gave no such set"))
    }
}

/// The name of the set to write.
fn chosen_name(sample: &Sample, sampling: &Sampling) -> Option<SetName> {
    match (sample.method, sample.set) {
        (MethodName::Bi, Some(SetChoice::A1)) => Some(SetName::A1),
        (MethodName::Bi, Some(SetChoice::A2)) => Some(SetName::A2),
        (MethodName::Bi, _) => Some(SetName::A3),
        _ => sampling.sets.first().map(|set| set.name),
    }
}

/// What is told of a sampled solid, in the file's unit.
struct Told<'a> {
    sampling: &'a Sampling,
    fits: &'a [Fit],
    unit: f64,
    volume: f64,
}

impl Told<'_> {
    fn epsilon(&self) -> f64 {
        self.sampling.field.grid.epsilon() * self.unit
    }

    fn text(&self) -> String {
        let grid = self.sampling.field.grid;
        let n = grid.per_axis();
        let mut lines = vec![
            [
                "set",
                "balls",
                "inward",
                "outward",
                "missed, %",
                "outside, %",
                "seconds",
            ]
            .map(str::to_owned)
            .to_vec(),
        ];
        for (set, fit) in self.sampling.sets.iter().zip(self.fits) {
            lines.push(vec![
                set_name(set.name).to_owned(),
                set.balls.len().to_string(),
                format!("{:.6}", fit.hausdorff_inward * self.unit),
                format!("{:.6}", fit.hausdorff_outward * self.unit),
                format!("{:.3}", 100.0 * fit.volume_missed / self.volume),
                format!("{:.3}", 100.0 * fit.volume_outside / self.volume),
                format!("{:.2}", set.seconds),
            ]);
        }
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
        format!(
            "Grid: {n} x {n} x {n} nodes, {} inside, spacing {:.6}, epsilon {:.6}\n\n{}\n\
             Inward: the farthest that a point of the solid is from the balls; outward: that a point of the balls is from the solid.\n\
             {added}Time: {}",
            self.sampling.inside_nodes,
            grid.spacing() * self.unit,
            self.epsilon(),
            report::align(&lines),
            steps.join(", ")
        )
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

    fn fit(&self, fit: &Fit) -> Value {
        let cubed = self.unit.powi(3);
        json!({
            "hausdorff_inward": fit.hausdorff_inward * self.unit,
            "hausdorff_outward": fit.hausdorff_outward * self.unit,
            "outward_bound": fit.outward_bound * self.unit,
            "volume_missed": fit.volume_missed * cubed,
            "volume_outside": fit.volume_outside * cubed,
            "nodes_missed": fit.nodes_missed,
        })
    }
}

/// A set's name, as `--set` and `--method` have it.
fn set_name(name: SetName) -> &'static str {
    match name {
        SetName::A1 => "a1",
        SetName::A2 => "a2",
        SetName::A3 => "a3",
        SetName::Wz => "wz",
        SetName::Octree => "octree",
        SetName::Voxels => "voxels",
    }
}

fn weights_text(fitted: &FittedWeights) -> String {
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

impl From<MeshError> for Failure {
    fn from(error: MeshError) -> Self {
        let failure = Self::input(&error)
            .on_line(error.line().and_then(|line| u64::try_from(line).ok()))
            .remedy(error.remedy());
        match error.file() {
            Some(file) => failure.at(file),
            None => failure,
        }
    }
}

impl From<PseudoAtomError> for Failure {
    fn from(error: PseudoAtomError) -> Self {
        match error {
            PseudoAtomError::Coordinate { .. } => {
                Self::input(&error).remedy("move or scale the mesh, or export the balls as .obj")
            }
            PseudoAtomError::File(error) => error.into(),
        }
    }
}
