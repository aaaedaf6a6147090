//! Files of a solid that was computed: balls, surface, volume grid, picture.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use csv::StringRecord;
use serde_json::{Value, json};

use crate::arguments::output_file::check_outputs;
use crate::messages::console::Console;
use crate::report::{SolidsReport, Viewer, ViewerArguments};
use crate::solid_files::balls::write_table;
use crate::solid_files::sample_picture::write_ball_picture;
use crate::solid_files::surfaces::SURFACE_FORMATS;
use crate::solid_files::volume_grids::{VOLUME_FORMATS, VolumeGrid};
use crate::solid_files::{check_picture, format_of, place_all, write_text};
use knotdock::geometry::Bracket;
use knotdock::geometry::ball_field::{BYTES_A_NODE, BallField, FieldGrid, Surface, surface};
use knotdock::geometry::bracket::{shifted, volume};
use knotdock::geometry::morphology::exact_volume::VolumeBounds;
use knotdock::options::values::{AT_LEAST_ONE, in_range};
use knotdock::output::files::whole_file::StagedFile;
use knotdock::output::tables::fields::number;
use knotdock_scoring::se3::Pose;
use knotdock_structures::mesh::Figure;
use knotdock_structures::sampling::ball_tree::BallTree;
use knotdock_structures::{Ball, Error, Knots};

/// Files of a computed solid.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Output")]
pub struct SolidOutput {
    /// The table of balls to write, with columns x, y, z, r and weight.
    #[arg(short, long, value_name = "FILE.csv")]
    pub output: Option<PathBuf>,
    /// The surface to write, by surface nets on a grid: .obj, .stl or .ply.
    #[arg(long, value_name = "FILE")]
    pub surface: Option<PathBuf>,
    /// The volume grid to write: the depth at each node, above zero inside: .mrc, .map, .ccp4, .nrrd or .vtk.
    #[arg(long, value_name = "FILE")]
    pub volume_grid: Option<PathBuf>,
    /// The picture to write: a slice of inner and outer balls, and the outer balls from outside.
    #[arg(long, value_name = "FILE.svg")]
    pub picture: Option<PathBuf>,
    /// The report to write: the result in three dimensions and its volumes, in a page that opens in any browser.
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub viewer: ViewerArguments,
    /// Which balls are written: outer balls hold the solid, inner balls are in it.
    #[arg(long, value_enum, default_value_t = Side::Outer)]
    pub set: Side,
    /// Cells of a grid along the longest edge of the box around the solid.
    #[arg(long, value_name = "COUNT", default_value_t = 64, value_parser = in_range::<usize>(AT_LEAST_ONE))]
    pub cells: usize,
    /// Replace files that are there.
    #[arg(long)]
    pub force: bool,
}

/// One of the two sets of balls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Side {
    /// Balls inside the solid.
    Inner,
    /// Balls that hold the solid.
    Outer,
}

const MAX_CELLS: usize = 512;

impl SolidOutput {
    /// Checks, before any work, that the files to write are none of those `read`, and can be made. `allowed` is the
    /// memory that a process may take, in bytes.
    pub fn check(
        &self,
        read: &[&Path],
        allowed: Option<u64>,
        console: Console,
    ) -> Result<(), Error> {
        let files = [
            &self.output,
            &self.surface,
            &self.volume_grid,
            &self.picture,
            &self.report,
        ];
        check_outputs(files.into_iter().flatten(), read, self.force, console)?;
        if let Some(path) = &self.surface {
            format_of("surface", path, &SURFACE_FORMATS)?;
        }
        if let Some(path) = &self.volume_grid {
            format_of("volume-grid", path, &VOLUME_FORMATS)?;
        }
        if let Some(path) = &self.picture {
            check_picture(path)?;
        }
        if self.cells > MAX_CELLS {
            return Err(
                Error::input(format!("--cells {} is more than {MAX_CELLS}", self.cells))
                    .help(format!("give at most {MAX_CELLS}")),
            );
        }
        let needed = BYTES_A_NODE * (self.cells as u64 + 6).pow(3);
        match allowed {
            Some(allowed) if needed > allowed => Err(Error::input(format!(
                "a grid of {} cells needs {needed} bytes of memory, and {allowed} are allowed",
                self.cells
            ))
            .help("give fewer --cells, or allow more --memory")),
            _ => Ok(()),
        }
    }

    pub fn chosen<'a>(&self, solid: &'a Bracket) -> &'a [Ball] {
        match self.set {
            Side::Inner => &solid.inner,
            Side::Outer => &solid.outer,
        }
    }

    /// Writes the requested files of a result and returns their names; the table holds `table` if that is given.
    pub fn write(&self, result: &SolidResult, table: Option<Knots>) -> Result<Vec<String>, Error> {
        let viewer = self.viewer.read()?;
        let solid = &result.solid;
        let balls = self.chosen(solid);
        let mut staged: Vec<(StagedFile, &PathBuf)> = Vec::new();
        let wants_any =
            self.output.is_some() || self.surface.is_some() || self.volume_grid.is_some();
        if let Some(reason) = &result.empty
            && self.volume_grid.is_some()
        {
            return Err(Error::input(format!(
                "the result is empty: {reason}, so there is no box to lay a volume grid over"
            ))
            .help("leave out --volume-grid; -o and --surface write an empty result"));
        }
        if balls.is_empty() && wants_any && result.empty.is_none() {
            return Err(Error::input("no ball is known to be inside the result")
                .help("sample on a finer --grid and --complement-grid, or write --set outer"));
        }
        if let Some(path) = &self.output {
            let knots = match table {
                Some(knots) => knots,
                None if balls.is_empty() => Knots::default(),
                None => knots(balls, solid.origin)?,
            };
            staged.push((write_table(&knots, path)?, path));
        }
        if let Some(path) = &self.surface {
            let write = format_of("surface", path, &SURFACE_FORMATS)?;
            let surface = surface_of(balls, solid.origin, self.cells)?;
            staged.push((StagedFile::write(path, |file| write(&surface, file))?, path));
        }
        if let Some(path) = &self.volume_grid {
            let field = field(balls, self.cells)?;
            let write = format_of("volume-grid", path, &VOLUME_FORMATS)?;
            let grid = VolumeGrid {
                origin: [0, 1, 2].map(|axis| solid.origin[axis] + field.grid.first[axis]),
                spacing: field.grid.spacing,
                shape: field.grid.shape,
                values: &field.depth,
                title: "knotdock: depth of a union of balls, above zero inside",
            };
            staged.push((StagedFile::write(path, |file| write(&grid, file))?, path));
        }
        if let Some(path) = &self.picture {
            staged.push((write_ball_picture(&solid.inner, &solid.outer, path)?, path));
        }
        if let Some(path) = &self.report {
            let text = result.page(viewer.as_ref())?;
            staged.push((write_text(path, &text)?, path));
        }
        place_all(staged)
    }
}

/// Cells along the longest edge of a surface that is looked at.
const SHOWN_CELLS: usize = 64;

/// The surface of balls, to look at.
pub fn shown_surface(balls: &[Ball], origin: [f64; 3]) -> Result<Surface, Error> {
    surface_of(balls, origin, SHOWN_CELLS)
}

/// The surface of balls on a grid of `cells` cells; without balls it is empty.
fn surface_of(balls: &[Ball], origin: [f64; 3], cells: usize) -> Result<Surface, Error> {
    match balls.is_empty() {
        true => Ok(Surface {
            positions: Vec::new(),
            triangles: Vec::new(),
        }),
        false => Ok(surface(&field(balls, cells)?, origin)),
    }
}

fn field(balls: &[Ball], cells: usize) -> Result<BallField, Error> {
    let grid = FieldGrid::about(balls, cells).ok_or_else(|| {
        Error::machine("the balls have no extent, so no grid can be laid over them")
    })?;
    Ok(BallField::new(&BallTree::new(balls), grid))
}

/// Balls as knots in the frame of the files.
pub fn knots(balls: &[Ball], origin: [f64; 3]) -> Result<Knots, Error> {
    let placed = balls.iter().map(|ball| shifted(ball, origin));
    let (centers, radii) = placed.map(|ball| (ball.center, ball.radius)).unzip();
    Knots::new(centers, radii).map_err(Error::machine)
}

/// A solid that was computed, with the volumes of its inner and its outer balls. A volume comes with a bound of its
/// error.
pub struct SolidResult {
    pub name: &'static str,
    pub solid: Bracket,
    pub inner_volume: (f64, f64),
    pub outer_volume: (f64, f64),
    /// Bounds of the volume of the true result.
    pub volume: VolumeBounds,
    /// Why the result is empty, if that is proven.
    pub empty: Option<String>,
}

impl SolidResult {
    /// The result between two sets of balls, whose volume is within `known` as well. `reason` says what an empty one
    /// means.
    pub fn new(
        name: &'static str,
        mut solid: Bracket,
        known: VolumeBounds,
        reason: String,
    ) -> Self {
        if known[1] <= 0.0 {
            solid = Bracket {
                inner: Vec::new(),
                outer: Vec::new(),
                epsilon: 0.0,
                ..solid
            };
        }
        let inner_volume = volume(&solid.inner);
        let outer_volume = match solid.is_exact() {
            true => inner_volume,
            false => volume(&solid.outer),
        };
        let least = (inner_volume.0 - inner_volume.1).max(known[0]).max(0.0);
        let most = (outer_volume.0 + outer_volume.1).min(known[1]);
        Self {
            name,
            inner_volume,
            outer_volume,
            volume: [least, most.max(least)],
            empty: solid.outer.is_empty().then_some(reason),
            solid,
        }
    }

    pub fn describe(&self, console: Console) {
        let set = |balls: &[Ball], (value, _): (f64, f64)| {
            format!("{} balls, volume {}", balls.len(), Figure(value))
        };
        let Self { name, solid, .. } = self;
        if let Some(reason) = &self.empty {
            console.say(format!("\n{name}: the result is empty: {reason}"));
            return;
        }
        console.say(format!(
            "\n{name}: volume between {} and {}\n  inner: {}\n  outer: {}",
            Figure(self.volume[0]),
            Figure(self.volume[1]),
            set(&solid.inner, self.inner_volume),
            set(&solid.outer, self.outer_volume)
        ));
        console.say(if solid.epsilon.is_finite() {
            format!(
                "  The true result is between, within {} of either (Hausdorff)",
                Figure(solid.epsilon)
            )
        } else {
            "  No point is known to be inside; a finer --grid and --complement-grid may find one"
                .to_owned()
        });
    }

    pub fn object(&self) -> Value {
        let set = |balls: &[Ball], (value, error): (f64, f64)| json!({ "balls": balls.len(), "volume": value, "volume_error": error });
        let epsilon = self.solid.epsilon;
        json!({
            "volume": { "least": self.volume[0], "most": self.volume[1] },
            "empty": self.empty,
            "inner": set(&self.solid.inner, self.inner_volume),
            "outer": set(&self.solid.outer, self.outer_volume),
            "epsilon": epsilon.is_finite().then_some(epsilon),
        })
    }

    fn page(&self, viewer: Option<&Viewer>) -> Result<String, Error> {
        let solid = &self.solid;
        let outer = shown_surface(&solid.outer, solid.origin)?;
        let inner = shown_surface(&solid.inner, solid.origin)?;
        let record = |set: &str, balls: &[Ball], (volume, error): (f64, f64)| {
            let count = balls.len().to_string();
            StringRecord::from(vec![set.to_owned(), count, number(volume), number(error)])
        };
        let columns = ["set", "balls", "volume", "error of the volume"];
        let report = SolidsReport {
            title: self.name.to_owned(),
            sentences: vec![
                "The result is between its inner balls, which are in it, and its outer balls, which hold it.".to_owned(),
                format!(
                    "Its volume is between {} and {}.",
                    Figure(self.volume[0]),
                    Figure(self.volume[1])
                ),
                match solid.epsilon.is_finite() {
                    true => format!("Either set is within {} of it.", Figure(solid.epsilon)),
                    false => "How far either set is from it is not known.".to_owned(),
                },
            ],
            names: ["outer balls", "inner balls"],
            surfaces: [(&outer).into(), (&inner).into()],
            caption: "Both sets of balls",
            header: columns.into_iter().collect(),
            records: vec![
                record("outer balls", &solid.outer, self.outer_volume),
                record("inner balls", &solid.inner, self.inner_volume),
            ],
            main: &columns,
            poses: &[Pose::identity(); 2],
        };
        Ok(report.text(viewer))
    }
}
