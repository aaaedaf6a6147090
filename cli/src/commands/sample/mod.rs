//! `knotdock sample`: a mesh as balls.

mod robot;
mod sample_report;

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use robot::RobotFormat;
use sample_report::{SampleReport, weights_text};
use serde_json::json;

use crate::arguments::machine::Threads;
use crate::arguments::output_file::check_outputs;
use crate::messages::console::Console;
use crate::solid_files::balls::{EXPORTS, ExportBalls, write_table};
use crate::solid_files::sample_picture::write_picture;
use crate::solid_files::{check_picture, format_of, place_all};
use knotdock::options::SampleGrid;
use knotdock::options::values::{ABOVE_ZERO, AT_LEAST_ONE, Range, in_range};
use knotdock::threads;
use knotdock_structures::mesh::{self, Solid};
use knotdock_structures::numeric::Bump;
use knotdock_structures::sampling::decomposition::DecompositionOptions;
use knotdock_structures::sampling::hausdorff::{Fit, HausdorffMeter};
use knotdock_structures::sampling::weights::{self, FittedWeights};
use knotdock_structures::sampling::{
    Ball, BallSet, Method, Sampling, SetName, Step, knots, sample,
};
use knotdock_structures::sphere_tree::SphereTree;
use knotdock_structures::{Error, Knots};

/// Sample a mesh by balls, or the links of a robot: any closed surface as a few balls within a known distance of it.
///
/// Reads STL, OBJ, PLY and OFF, in text and binary. The method is Behandish and Ilies' Algorithm 1. A1 lies inside
/// the solid, A2 is A1 grown by epsilon and covers it, and A3 is A2 without redundant balls. Each is within epsilon
/// of the solid, which is measured. Lengths are in the file's unit.
#[derive(Args, Debug)]
pub struct Sample {
    /// The mesh: .stl, .obj, .ply or .off; with --robot a URDF file.
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
    /// Nodes of the grid, as 2^18 or 262144: a cube of the nearest whole number of nodes an axis.
    #[arg(long, value_name = "COUNT", default_value = "2^18")]
    grid: SampleGrid,
    /// How balls are chosen.
    #[arg(long, value_enum, default_value_t = MethodName::Bi)]
    method: MethodName,
    /// Protrusion factor of method bi, 0 to 1: the less, the more and the smoother the balls of A1 [default: 0.25].
    #[arg(long, value_parser = in_range::<f64>(Range::between(0.0, 1.0)))]
    mu: Option<f64>,
    /// Which set of method bi to write [default: a3].
    #[arg(long, value_enum)]
    set: Option<SetChoice>,
    /// Refuse doubtful meshes: meshes that are not closed, with triangles that face the wrong way, are there several
    /// times or bound nothing, or with inner parts that face outward. Meshes of which something was left out on
    /// reading are refused too, and closed ones that the balls do not come within epsilon of.
    #[arg(long)]
    strict: bool,
    /// Weights of the balls: one, or those whose summed bumps come closest to one inside and to zero outside.
    #[arg(long, value_enum, default_value_t = Weights::Unit)]
    weights: Weights,
    /// Exponent of the bump that weights are fitted for, with --weights fitted [default: 2].
    #[arg(long, value_parser = in_range::<f64>(ABOVE_ZERO))]
    alpha: Option<f64>,
    /// Write no more balls than this, with --robot for each link: a level of a tree of bounding balls over the set,
    /// which covers what the set covers.
    #[arg(long, value_name = "BALLS", value_parser = in_range::<usize>(AT_LEAST_ONE), conflicts_with = "weights")]
    level: Option<usize>,
    /// Sample all links of a URDF file: the spheres cover the collision geometry of each link, in its frame. Meshes,
    /// boxes and cylinders are sampled, spheres are kept.
    #[arg(long, value_enum, value_name = "FORMAT", conflicts_with_all = ["method", "set", "weights", "alpha", "picture", "export"])]
    robot: Option<RobotFormat>,
    /// The table of balls to write [default: knots.csv; with --robot spheres.yml, spheres.urdf or spheres.json].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Draw slices of depth, skeletal density and balls, and the balls from outside.
    #[arg(long, value_name = "FILE.svg")]
    picture: Option<PathBuf>,
    /// Write the balls as a mesh of spheres (.obj) or as pseudo-atoms (.pdb) too.
    #[arg(long, value_name = "FILE.obj|FILE.pdb")]
    export: Option<PathBuf>,
    /// Replace files that are there.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    threads: Threads,
}

/// Exponent of the bump that weights are fitted for, unless another is given.
const FITTED_ALPHA: f64 = 2.0;

/// [`Method`] by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// Behandish and Ilies, Algorithm 1.
    Bi,
    /// Weller and Zachmann, packing of the largest ball that fits.
    Wz,
    /// Balls about the cells of an octree.
    Octree,
    /// Largest balls inside, about points of the medial axis, grown by eps.
    Medial,
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

/// The balls to write, with their weights or level of detail.
struct Finished {
    balls: Vec<Ball>,
    fitted: Option<FittedWeights>,
    /// Fit of a level of detail.
    level: Option<Fit>,
    step: Option<Step>,
}

impl Sample {
    pub fn run(self, console: Console) -> Result<(), Error> {
        threads::on(self.threads.count(), || self.sample(console))?
    }

    fn sample(self, console: Console) -> Result<(), Error> {
        match self.robot {
            Some(format) => self.sample_robot(format, console),
            None => self.sample_mesh(console),
        }
    }

    fn sample_mesh(self, console: Console) -> Result<(), Error> {
        let output = self.output.clone();
        let output = output.unwrap_or_else(|| PathBuf::from("knots.csv"));
        let method = self.method()?;
        let export = self.check_files(&output, console)?;
        let start = Instant::now();
        let (mesh, report) = mesh::read(&self.mesh)?;
        let reading = Step::since("reading the mesh", start);
        console.say(format!("Mesh: {report}"));
        self.warn(report.warnings(), &console)?;
        let solid = Solid::new(&mesh).map_err(|error| error.at(&self.mesh))?;
        let mut sampling = sample(&solid, self.grid.per_axis, method).map_err(|error| {
            Error::input(error)
                .at(&self.mesh)
                .help("check that the mesh is closed and one solid, or sample it on a finer --grid")
        })?;
        sampling.steps.insert(0, reading);

        let start = Instant::now();
        let meter = HausdorffMeter::new(&solid, &sampling.field);
        let fits: Vec<Fit> = sampling
            .sets
            .iter()
            .map(|set| meter.measure(&set.balls))
            .collect();
        let step = Step::since("measuring the fit", start);
        sampling.steps.push(step);

        let mut warnings = report.warnings();
        if report.is_closed() {
            let reported = SampleReport::new(&sampling, &fits, &solid, &meter);
            let doubts = reported.doubts();
            self.warn(doubts.clone(), &console)?;
            warnings.extend(doubts);
        }
        if sampling.inside_nodes == 0 {
            let unseen = "no node of the grid lies inside the mesh, so volumes are not measured; a finer --grid has some".to_owned();
            console.warn(&unseen);
            warnings.push(unseen);
        }
        let set = self.chosen(&sampling)?;
        let set_name = set.name;
        let finished = self.finish(set, &sampling, &meter)?;
        sampling.steps.extend(finished.step);
        let frame = solid.frame();
        let fitted = finished.fitted.as_ref();
        let weights = fitted.map(|fitted| fitted.weights.as_slice());
        let knots = knots(frame, &finished.balls, weights)
            .map_err(|error| Error::input(error).at(&self.mesh))?;
        let written = self.write(&solid, &knots, &finished.balls, &output, export)?;

        let reported = SampleReport::new(&sampling, &fits, &solid, &meter);
        console.say(format!("\n{}", reported.text()));
        if let Some(fitted) = fitted {
            console.say(format!("\n{}", weights_text(fitted)));
        }
        if let Some(fit) = &finished.level {
            console.say(format!("\n{}", reported.level(finished.balls.len(), fit)));
        }
        console.say(format!(
            "\nWrote {} balls to {}",
            knots.len(),
            written.join(", ")
        ));
        let mut object = reported.object();
        object["knots"] = json!(output.display().to_string());
        object["files"] = json!(written);
        object["balls"] = json!(knots.len());
        object["set"] = json!(set_name);
        object["mesh"] = json!(report);
        object["warnings"] = json!(warnings);
        object["level"] = json!(finished.level.map(|fit| reported.fit(&fit)));
        object["weights"] = json!(finished.fitted);
        console.result(&object)?;
        Ok(())
    }

    /// Checks, before any work, that the files to write are not there and can be made; how balls are exported.
    fn check_files(
        &self,
        output: &PathBuf,
        console: Console,
    ) -> Result<Option<ExportBalls>, Error> {
        let further = [&self.picture, &self.export].into_iter().flatten();
        let files = std::iter::once(output).chain(further);
        check_outputs(files, &[&self.mesh], self.force, console)?;
        if let Some(path) = &self.picture {
            check_picture(path)?;
        }
        let export = self.export.as_ref();
        export
            .map(|path| format_of("export", path, &EXPORTS))
            .transpose()
    }

    fn write(
        &self,
        solid: &Solid,
        knots: &Knots,
        balls: &[Ball],
        output: &PathBuf,
        export: Option<ExportBalls>,
    ) -> Result<Vec<String>, Error> {
        let mut staged = vec![(write_table(knots, output)?, output)];
        if let (Some(path), Some(export)) = (&self.export, export) {
            staged.push((export(knots, path)?, path));
        }
        if let Some(path) = &self.picture {
            staged.push((write_picture(solid, balls, path)?, path));
        }
        place_all(staged)
    }

    /// Warns of faults of the mesh, or refuses it.
    fn warn(&self, warnings: Vec<String>, console: &Console) -> Result<(), Error> {
        for warning in warnings {
            if self.strict {
                return Err(Error::input(warning)
                    .at(&self.mesh)
                    .help("repair the mesh, or leave --strict out to sample what the winding number calls inside"));
            }
            console.warn(warning);
        }
        Ok(())
    }

    /// The balls to write: the chosen set, weighted or thinned out as requested.
    fn finish(
        &self,
        set: &BallSet,
        sampling: &Sampling,
        meter: &HausdorffMeter,
    ) -> Result<Finished, Error> {
        let start = Instant::now();
        let mut finished = Finished {
            balls: set.balls.clone(),
            fitted: None,
            level: None,
            step: None,
        };
        if self.weights == Weights::Fitted {
            if sampling.inside_nodes == 0 {
                return Err(Error::input(
                    "weights are fitted at nodes of the grid inside the mesh, and there are none",
                )
                .at(&self.mesh)
                .help("sample it on a finer --grid, or leave out --weights fitted"));
            }
            let (field, volume) = (&sampling.field, meter.volume());
            let bump = Bump::new(self.alpha.unwrap_or(FITTED_ALPHA))
                .map_err(|error| Error::input(error).help("give --alpha a number above zero"))?;
            finished.fitted = Some(weights::fit(field, &finished.balls, bump, volume));
            finished.step = Some(Step::since("fitting weights", start));
        }
        if let Some(count) = self.level {
            if let Some(tree) = SphereTree::new(&finished.balls) {
                finished.balls = tree.level(count);
            }
            finished.level = Some(meter.measure(&finished.balls));
            finished.step = Some(Step::since("sphere tree", start));
        }
        Ok(finished)
    }

    /// The method with its options; options of other methods, and of weights that are not fitted, are refused.
    fn method(&self) -> Result<Method, Error> {
        if self.method != MethodName::Bi && (self.mu.is_some() || self.set.is_some()) {
            return Err(Error::input("--mu and --set need --method bi")
                .help("leave them out, or sample with --method bi"));
        }
        if self.weights != Weights::Fitted && self.alpha.is_some() {
            return Err(Error::input("--alpha needs --weights fitted")
                .help("add --weights fitted, or leave --alpha out"));
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
            MethodName::Medial => Method::MedialAxis,
            MethodName::Voxels => Method::Voxels,
        })
    }

    fn chosen<'a>(&self, sampling: &'a Sampling) -> Result<&'a BallSet, Error> {
        let name = match (self.method, self.set) {
            (MethodName::Bi, Some(SetChoice::A1)) => SetName::A1,
            (MethodName::Bi, Some(SetChoice::A2)) => SetName::A2,
            _ => SetName::A3,
        };
        let mut sets = sampling.sets.iter();
        let set = match self.method {
            MethodName::Bi => sets.find(|set| set.name == name),
            _ => sets.next(),
        };
        set.ok_or_else(|| Error::machine("the sampler gave no such set"))
    }
}
