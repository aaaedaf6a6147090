//! `knotdock sample --robot`: the links of a robot as spheres that cover them, for planners.
//!
//! # What is certain
//!
//! A closed mesh has A3 of Algorithm 1, and a proven bound of how far any of its points is from these balls. Grown by it,
//! they cover the mesh. A level of a tree of bounding balls covers what they cover. A ball of radius r about a point of
//! depth d is nowhere farther than r - d from the solid, of which several shapes of a link give the least.
//! The first bound is a measured one for meshes that are not closed, which the files say.

use std::fmt::Write;
use std::path::PathBuf;

use clap::ValueEnum;
use serde_json::{Value, json};

use super::Sample;
use crate::arguments::output_file::check_outputs;
use crate::inputs::robot::{Collision, Link, Robot, Shape};
use crate::messages::console::Console;
use crate::solid_files::{place_all, write_text};
use crate::tables::report::{counted, text_table};
use knotdock::geometry::bracket::{shifted, turned};
use knotdock_structures::mesh::{Figure, Solid};
use knotdock_structures::sampling::decomposition::DecompositionOptions;
use knotdock_structures::sampling::hausdorff::HausdorffMeter;
use knotdock_structures::sampling::{Method, SetName, sample};
use knotdock_structures::sphere_tree::SphereTree;
use knotdock_structures::{Ball, Error};

/// Files of spheres of robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum RobotFormat {
    /// collision_spheres of cuRobo (YAML).
    Curobo,
    /// The URDF file with spheres as its collision geometry.
    Urdf,
    /// Spheres by link, as foam writes those of a mesh (JSON).
    Foam,
}

impl RobotFormat {
    /// The file that is written if none is named.
    fn file(self) -> &'static str {
        match self {
            Self::Curobo => "spheres.yml",
            Self::Urdf => "spheres.urdf",
            Self::Foam => "spheres.json",
        }
    }
}

/// Spheres that cover a link, in its frame.
struct Spheres<'a> {
    link: &'a Link,
    balls: Vec<Ball>,
    /// No point of a sphere is farther from the link than this.
    reach: f64,
    /// Whether it is proven that no point of the link is outside of the spheres; else it was measured.
    is_proven: bool,
}

/// A shape in the frame of its link, for depths.
struct PlacedShape<'a> {
    collision: &'a Collision,
    /// The solid that is sampled, and how far it is beyond the shape; none of a sphere.
    solid: Option<(Solid, f64)>,
}

impl PlacedShape<'_> {
    /// A lower bound of the depth at a point of the link's frame.
    fn depth(&self, point: [f64; 3]) -> f64 {
        let place = self.collision.origin.inverse().apply(point);
        match (&self.solid, &self.collision.shape) {
            (Some((solid, beyond)), _) => {
                let frame = solid.frame();
                frame.unit * solid.depth(frame.inward(place)) - beyond
            }
            (None, Shape::Sphere(radius)) => radius - nalgebra::Vector3::from(place).norm(),
            (None, _) => f64::NEG_INFINITY,
        }
    }
}

impl Sample {
    pub(super) fn sample_robot(self, format: RobotFormat, console: Console) -> Result<(), Error> {
        let robot = Robot::read(&self.mesh)?;
        let output = self
            .output
            .clone()
            .unwrap_or_else(|| PathBuf::from(format.file()));
        let mut read = robot.files();
        read.push(&self.mesh);
        check_outputs([&output], &read, self.force, console)?;
        let mut warnings = Vec::new();
        let links = robot.links.iter().map(|link| {
            self.spheres(link, &mut warnings, &console)
                .map_err(|error| error.at(&self.mesh).within(format!("link '{}'", link.name)))
        });
        let links: Vec<Spheres<'_>> = links.collect::<Result<_, Error>>()?;
        let text = match format {
            RobotFormat::Curobo => curobo(&links),
            RobotFormat::Urdf => urdf(&robot, &links),
            RobotFormat::Foam => foam(&links)?,
        };
        let files = place_all(vec![(write_text(&output, &text)?, &output)])?;
        let rows = links.iter().map(|spheres| {
            let covered = if spheres.is_proven {
                "proven"
            } else {
                "measured"
            };
            vec![
                spheres.link.name.clone(),
                spheres.balls.len().to_string(),
                Figure(spheres.reach).to_string(),
                covered.to_owned(),
            ]
        });
        let total: usize = links.iter().map(|spheres| spheres.balls.len()).sum();
        console.say(format!(
            "{}\nReach: no point of a sphere is farther from its link than this.\nCovered: no point of the link is \
             outside of the spheres, which is proven for closed meshes and measured for others.\n\nWrote {} of {} to {}",
            text_table("link|spheres|reach|covered", rows),
            counted(total, "sphere"),
            counted(links.len(), "link"),
            files.join(", ")
        ));
        console.result(&json!({
            "files": files,
            "links": links.iter().map(Spheres::object).collect::<Vec<_>>(),
            "warnings": warnings,
        }))
    }

    /// Spheres that cover a link.
    fn spheres<'a>(
        &self,
        link: &'a Link,
        warnings: &mut Vec<String>,
        console: &Console,
    ) -> Result<Spheres<'a>, Error> {
        let (mut shapes, mut balls, mut is_proven) = (Vec::new(), Vec::new(), true);
        for collision in &link.collisions {
            let mut solid = None;
            let own = match (&collision.shape, collision.shape.mesh()?) {
                (Shape::Sphere(radius), _) => vec![Ball {
                    center: [0.0; 3],
                    radius: *radius,
                }],
                (_, Some((mesh, report, beyond))) => {
                    let of_link = |warning| format!("link '{}': {warning}", link.name);
                    let found: Vec<String> = report.warnings().into_iter().map(of_link).collect();
                    self.warn(found.clone(), console)?;
                    warnings.extend(found);
                    is_proven &= mesh.is_closed();
                    let placed = Solid::new(&mesh)?;
                    let balls = self.covering(&placed)?;
                    solid = Some((placed, beyond));
                    balls
                }
                (_, None) => Vec::new(),
            };
            let translation = collision.origin.translation.into();
            let placed = own.iter().map(|ball| turned(ball, &collision.origin));
            balls.extend(placed.map(|ball| shifted(&ball, translation)));
            shapes.push(PlacedShape { collision, solid });
        }
        if let (Some(count), Some(tree)) = (self.level, SphereTree::new(&balls)) {
            balls = tree.level(count);
        }
        let reach = |ball: &Ball| {
            let depths = shapes.iter().map(|shape| shape.depth(ball.center));
            ball.radius - depths.fold(f64::NEG_INFINITY, f64::max)
        };
        Ok(Spheres {
            reach: balls.iter().map(reach).fold(0.0, f64::max),
            link,
            balls,
            is_proven,
        })
    }

    /// Balls that cover a solid, in the unit of its file.
    fn covering(&self, solid: &Solid) -> Result<Vec<Ball>, Error> {
        let default = DecompositionOptions::default();
        let method = Method::BehandishIlies(DecompositionOptions {
            mu: self.mu.unwrap_or(default.mu),
            ..default
        });
        let sampling = sample(solid, self.grid.per_axis, method).map_err(|error| {
            Error::input(error)
                .help("check that the mesh is closed and one solid, or sample it on a finer --grid")
        })?;
        let meter = HausdorffMeter::new(solid, &sampling.field);
        let mut sets = sampling.sets.iter();
        let Some(a3) = sets.find(|set| set.name == SetName::A3) else {
            return Err(Error::lasting("the sampler gave no balls"));
        };
        let fit = meter.measure(&a3.balls);
        // The last digits are for rounding.
        let margin = fit.inward_bound.unwrap_or(fit.hausdorff_inward) + 1e-9;
        let frame = solid.frame();
        let balls = a3.balls.iter().map(|ball| Ball {
            center: frame.outward(ball.center),
            radius: frame.unit * (ball.radius + margin),
        });
        Ok(balls.collect())
    }
}

impl Spheres<'_> {
    /// What is certain of the spheres, in words.
    fn sentence(&self) -> String {
        let covered = match self.is_proven {
            true => "Proven: no point of the link is outside of the spheres",
            false => {
                "Measured, since a mesh is not closed: no point of the link is outside of the spheres"
            }
        };
        format!(
            "{covered}, and no point of a sphere is farther than {} from the link.",
            decimal(self.reach)
        )
    }

    fn object(&self) -> Value {
        json!({
            "link": self.link.name,
            "spheres": self.balls.len(),
            "reach": self.reach,
            "covered": if self.is_proven { "proven" } else { "measured" },
        })
    }
}

/// A number with a point and without an exponent, which every reader of YAML takes for a number.
fn decimal(number: f64) -> String {
    let text = number.to_string();
    match text.contains('.') {
        true => text,
        false => text + ".0",
    }
}

/// `collision_spheres` of cuRobo. Names are JSON strings, which YAML reads as such.
fn curobo(links: &[Spheres<'_>]) -> String {
    let mut text =
        "# Spheres of the links of a robot, by knotdock sample\ncollision_spheres:\n".to_owned();
    for spheres in links {
        let _ = writeln!(text, "  # {}", spheres.sentence());
        let _ = writeln!(text, "  {}:", json!(spheres.link.name));
        for ball in &spheres.balls {
            let [x, y, z] = ball.center.map(decimal);
            let radius = decimal(ball.radius);
            let _ = writeln!(
                text,
                "    - center: [{x}, {y}, {z}]\n      radius: {radius}"
            );
        }
    }
    text
}

/// Lists of spheres by link, with the bounds beside.
fn foam(links: &[Spheres<'_>]) -> Result<String, Error> {
    let entries = links.iter().map(|spheres| {
        let list = spheres.balls.iter();
        let list = list.map(|ball| json!({ "origin": ball.center, "radius": ball.radius }));
        let object = json!({
            "note": spheres.sentence(),
            "covered": spheres.object()["covered"],
            "reach": spheres.reach,
            "spheres": list.collect::<Vec<_>>(),
        });
        (spheres.link.name.clone(), object)
    });
    let object: serde_json::Map<String, Value> = entries.collect();
    let text = serde_json::to_string_pretty(&object).map_err(Error::lasting)?;
    Ok(text + "\n")
}

/// The robot's file with spheres in place of the first collision element of each link, and without the others.
fn urdf(robot: &Robot, links: &[Spheres<'_>]) -> String {
    let mut text = String::new();
    let mut written = 0;
    for spheres in links {
        for (index, collision) in spheres.link.collisions.iter().enumerate() {
            text += &robot.text[written..collision.element.start];
            written = collision.element.end;
            if index > 0 {
                continue;
            }
            let _ = write!(text, "<!-- {} -->", spheres.sentence());
            for ball in &spheres.balls {
                let [x, y, z] = ball.center.map(decimal);
                let radius = decimal(ball.radius);
                let _ = write!(
                    text,
                    "\n    <collision><origin xyz=\"{x} {y} {z}\" rpy=\"0 0 0\"/><geometry><sphere radius=\"{radius}\"/>\
                     </geometry></collision>"
                );
            }
        }
    }
    text + &robot.text[written..]
}
