//! Files of a solid that was computed: balls, surface, volume grid, picture.

use std::path::{Path, PathBuf};

use crate::report::{SolidsReport, Viewer};
use crate::solid_files::balls::write_table;
use crate::solid_files::sample_picture::write_ball_picture;
use crate::solid_files::surfaces::{SurfaceFormat, write_surface};
use crate::solid_files::volume_grids::{VolumeFormat, VolumeGrid, write_volume};
use clap::{Args, ValueEnum};
use csv::StringRecord;
use knotdock::geometry::Bracket;
use knotdock::geometry::ball_field::{BYTES_A_NODE, BallField, FieldGrid};
use knotdock::geometry::bracket::{shifted, volume};
use knotdock::geometry::surface::{Surface, surface};
use knotdock::options::values::{AT_LEAST_ONE, in_range};
use knotdock::output::files::whole_file::{StagedFile, is_stream};
use knotdock::output::tables::fields::number;
use knotdock_scoring::se3::Pose;
use knotdock_structures::mesh::Figure;
use knotdock_structures::sampling::ball_tree::BallTree;
use knotdock_structures::{Ball, Knots};
use serde_json::{Value, json};

use crate::arguments::output_file::{check_output, is_same};
use crate::arguments::viewer::ViewerArguments;
use crate::messages::console::Console;
use knotdock_structures::Error;

/// What to write of a solid.
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
    /// Which balls are written: outer balls hold the solid, inner balls lie in it.
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

/// Most cells along an edge.
const MAX_CELLS: usize = 512;

/// Why a file is not one that is written.
fn unknown(option: &str, path: &Path, endings: &str) -> Error {
    Error::input(format!("--{option} cannot write a file with this ending"))
        .at(path)
        .help(format!("end the name with {endings}"))
}

impl SolidOutput {
    /// Checks, before any work, that the files to write are none of those `read`, and can be made.
    pub fn check(
        &self,
        read: &[&Path],
        allowed: Option<u64>,
        console: Console,
    ) -> Result<(), Error> {
        let files: Vec<&PathBuf> = [
            &self.output,
            &self.surface,
            &self.volume_grid,
            &self.picture,
            &self.report,
        ]
        .into_iter()
        .flatten()
        .collect();
        for (index, file) in files.iter().enumerate() {
            if files[..index].iter().any(|other| is_same(other, file)) {
                return Err(Error::input("the same file is named twice")
                    .at(file)
                    .help("give each output file its own name"));
            }
            check_output(file, read.iter().copied(), self.force, console)?;
        }
        if let Some(path) = &self.surface
            && SurfaceFormat::of(path).is_none()
        {
            return Err(unknown("surface", path, ".obj, .stl or .ply"));
        }
        if let Some(path) = &self.volume_grid
            && VolumeFormat::of(path).is_none()
        {
            return Err(unknown(
                "volume-grid",
                path,
                ".mrc, .map, .ccp4, .nrrd or .vtk",
            ));
        }
        if let Some(path) = &self.picture
            && !path
                .extension()
                .is_some_and(|ending| ending.eq_ignore_ascii_case("svg"))
            && !is_stream(path)
        {
            return Err(unknown("picture", path, ".svg"));
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

    /// The balls that are written.
    pub fn chosen<'a>(&self, solid: &'a Bracket) -> &'a [Ball] {
        match self.set {
            Side::Inner => &solid.inner,
            Side::Outer => &solid.outer,
        }
    }

    /// Writes all that was requested of a result of a name and returns the names of the files; the table holds `table` if
    /// that is given.
    pub fn write(
        &self,
        (name, volumes): (&str, &Volumes),
        solid: &Bracket,
        table: Option<Knots>,
    ) -> Result<Vec<String>, Error> {
        let viewer = self.viewer.read()?;
        let balls = self.chosen(solid);
        let mut staged: Vec<(StagedFile, &PathBuf)> = Vec::new();
        let wants_any =
            self.output.is_some() || self.surface.is_some() || self.volume_grid.is_some();
        if balls.is_empty() && wants_any {
            return Err(Error::machine("the result has no balls")
                .help("sample on a finer --grid and --complement-grid, or write the other --set"));
        }
        if let Some(path) = &self.output {
            let knots = match table {
                Some(knots) => knots,
                None => knots(balls, solid.origin)?,
            };
            staged.push((write_table(&knots, path)?, path));
        }
        if self.surface.is_some() || self.volume_grid.is_some() {
            let field = field(balls, self.cells)?;
            if let (Some(path), Some(format)) = (&self.surface, self.surface_format()) {
                let surface = surface(&field, solid.origin);
                let written = write_surface(&surface.positions, &surface.triangles, format, path)?;
                staged.push((written, path));
            }
            if let (Some(path), Some(format)) = (&self.volume_grid, self.volume_format()) {
                let grid = VolumeGrid {
                    origin: [0, 1, 2].map(|axis| solid.origin[axis] + field.grid.first[axis]),
                    spacing: field.grid.spacing,
                    shape: field.grid.shape,
                    values: &field.depth,
                    title: "knotdock: depth of a union of balls, above zero inside",
                };
                staged.push((write_volume(&grid, format, path)?, path));
            }
        }
        if let Some(path) = &self.picture {
            staged.push((write_ball_picture(&solid.inner, &solid.outer, path)?, path));
        }
        if let Some(path) = &self.report {
            let text = page((name, volumes), solid, viewer.as_ref())?;
            let written = StagedFile::write(path, |file| file.write_all(text.as_bytes()))?;
            staged.push((written, path));
        }
        // None takes its place before all of them are on the device.
        let mut names = Vec::new();
        for (file, path) in staged {
            file.place()?;
            names.push(path.display().to_string());
        }
        Ok(names)
    }

    fn surface_format(&self) -> Option<SurfaceFormat> {
        self.surface.as_deref().and_then(SurfaceFormat::of)
    }

    fn volume_format(&self) -> Option<VolumeFormat> {
        self.volume_grid.as_deref().and_then(VolumeFormat::of)
    }
}

/// The report of a result.
fn page(
    (name, volumes): (&str, &Volumes),
    solid: &Bracket,
    viewer: Option<&Viewer>,
) -> Result<String, Error> {
    let sets = [
        ("outer balls", &solid.outer, volumes.outer),
        ("inner balls", &solid.inner, volumes.inner),
    ];
    let surfaces = sets.map(|(_, balls, _)| shown_surface(balls, solid.origin));
    let [outer, inner] = surfaces;
    let (outer, inner) = (outer?, inner?);
    let record = |(set, balls, (volume, error)): (&str, &Vec<Ball>, (f64, f64))| {
        let fields = [
            set.to_owned(),
            balls.len().to_string(),
            number(volume),
            number(error),
        ];
        StringRecord::from(fields.to_vec())
    };
    let columns = ["set", "balls", "volume", "error of the volume"];
    let report = SolidsReport {
        title: name.to_owned(),
        sentences: vec![
            "The result lies between its inner balls, which are in it, and its outer balls, which hold it.".to_owned(),
            match solid.epsilon.is_finite() {
                true => format!("Either set is within {} of it.", Figure(solid.epsilon)),
                false => "How far either set is from it is not known.".to_owned(),
            },
        ],
        names: ["outer balls", "inner balls"],
        surfaces: [(&outer).into(), (&inner).into()],
        caption: "Both sets of balls",
        header: columns.into_iter().collect(),
        records: sets.map(record).to_vec(),
        main: &columns,
        poses: &[Pose::identity(); 2],
    };
    Ok(report.text(viewer))
}

/// Cells along the longest edge of a surface that is looked at.
const SHOWN_CELLS: usize = 64;

/// The surface of balls, to look at; without balls it is empty.
pub fn shown_surface(balls: &[Ball], origin: [f64; 3]) -> Result<Surface, Error> {
    match balls.is_empty() {
        true => Ok(Surface {
            positions: Vec::new(),
            triangles: Vec::new(),
        }),
        false => Ok(surface(&field(balls, SHOWN_CELLS)?, origin)),
    }
}

/// The depth of balls on a grid.
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

/// Volumes of a result, and bounds of their errors: of the inner balls, of the outer ones.
#[derive(Clone, Copy, Debug)]
pub struct Volumes {
    /// Of the inner balls.
    pub inner: (f64, f64),
    /// Of the outer balls.
    pub outer: (f64, f64),
}

impl Volumes {
    /// Measures both.
    pub fn of(solid: &Bracket) -> Self {
        let inner = volume(&solid.inner);
        let outer = match solid.is_exact() {
            true => inner,
            false => volume(&solid.outer),
        };
        Self { inner, outer }
    }

    /// Reports them under the name of the result.
    pub fn describe(&self, name: &str, solid: &Bracket, console: Console) {
        let set = |balls: &[Ball], (value, _): (f64, f64)| {
            format!("{} balls, volume {}", balls.len(), Figure(value))
        };
        console.say(format!(
            "\n{name}:\n  inner: {}\n  outer: {}",
            set(&solid.inner, self.inner),
            set(&solid.outer, self.outer)
        ));
        console.say(if solid.epsilon.is_finite() {
            format!(
                "  The true result lies between, within {} of either (Hausdorff)",
                Figure(solid.epsilon)
            )
        } else {
            "  No point is known to be inside; a finer --grid and --complement-grid may find one"
                .to_owned()
        });
    }

    /// The result for JSON.
    pub fn object(&self, solid: &Bracket) -> Value {
        let set = |balls: &[Ball], (value, error): (f64, f64)| json!({ "balls": balls.len(), "volume": value, "volume_error": error });
        json!({
            "inner": set(&solid.inner, self.inner),
            "outer": set(&solid.outer, self.outer),
            "epsilon": solid.epsilon.is_finite().then_some(solid.epsilon),
        })
    }
}
