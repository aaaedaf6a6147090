//! Robots: the links of a URDF file with their collision geometry.
//!
//! Lengths are in the file's unit, metres by its definition. A point x of a shape is at R x + t in the frame of its
//! link, R = Rz(yaw) Ry(pitch) Rx(roll) and t being those of `origin`.

use std::ops::Range;
use std::path::{Path, PathBuf};

use roxmltree::{Document, Node};

use crate::inputs::solids::is_mesh;
use knotdock::bounded_read::{MAX_TABLE, read_bounded};
use knotdock_scoring::se3::Pose;
use knotdock_structures::mesh::{self, Mesh, MeshReport};
use knotdock_structures::{Error, LARGEST_LENGTH, SMALLEST_RADIUS};

/// A robot as its file describes it.
pub struct Robot {
    /// The file.
    pub text: String,
    /// Links with collision geometry, in the order of the file.
    pub links: Vec<Link>,
}

/// A link, with at least one shape.
pub struct Link {
    pub name: String,
    pub collisions: Vec<Collision>,
}

/// A part of a link's collision geometry.
pub struct Collision {
    /// Bytes of its element in the file.
    pub element: Range<usize>,
    /// From its own frame to that of the link.
    pub origin: Pose,
    pub shape: Shape,
}

/// The shape of a collision element, about its own origin.
pub enum Shape {
    /// A sphere by its radius.
    Sphere(f64),
    /// A box by its edges.
    Box([f64; 3]),
    /// A cylinder about the z axis.
    Cylinder { radius: f64, length: f64 },
    /// A mesh, its coordinates multiplied by the scale of each axis.
    Mesh { path: PathBuf, scale: [f64; 3] },
}

/// Sides of the prism around a cylinder.
const SIDES: u32 = 64;

impl Robot {
    /// Reads a URDF file.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let bytes = read_bounded(path, MAX_TABLE).map_err(|error| {
            Error::input(format!("cannot read the robot: {error}"))
                .at(path)
                .help("check the name, the permissions and the size of the file")
        })?;
        Self::parse(&bytes, path).map_err(|error| error.at(path))
    }

    fn parse(bytes: &[u8], path: &Path) -> Result<Self, Error> {
        let text = String::from_utf8(bytes.to_vec()).map_err(|_| {
            Error::input("the file is not text in UTF-8").help("save it as UTF-8 text")
        })?;
        let document = Document::parse(&text).map_err(|error| {
            Error::input(format!("the file is not XML: {error}"))
                .on_line(u64::from(error.pos().row))
                .help("give a URDF file; make one of a xacro file by 'xacro robot.xacro > robot.urdf'")
        })?;
        let root = document.root_element();
        if !root.has_tag_name("robot") {
            return Err(fault(&root, "the file describes no robot")
                .help("give a URDF file, whose outermost element is <robot>"));
        }
        let mut links: Vec<Link> = Vec::new();
        for link in children(&root, "link") {
            let name = attribute(&link, "name")?.to_owned();
            if links.iter().any(|other| other.name == name) {
                return Err(fault(&link, format!("there are two links '{name}'"))
                    .help("give each link its own name"));
            }
            let collisions = children(&link, "collision").map(|element| {
                Ok(Collision {
                    element: element.range(),
                    origin: origin(&element)?,
                    shape: shape(&element, path)?,
                })
            });
            let collisions: Vec<Collision> = collisions.collect::<Result<_, Error>>()?;
            if !collisions.is_empty() {
                links.push(Link { name, collisions });
            }
        }
        if links.is_empty() {
            return Err(Error::input("no link of the robot has collision geometry")
                .help("add <collision> elements, for instance with the meshes of <visual>"));
        }
        drop(document);
        Ok(Self { text, links })
    }

    /// Files of the meshes, once each.
    pub fn files(&self) -> Vec<&Path> {
        let mut files: Vec<&Path> = Vec::new();
        for collision in self.links.iter().flat_map(|link| &link.collisions) {
            if let Shape::Mesh { path, .. } = &collision.shape
                && !files.contains(&path.as_path())
            {
                files.push(path);
            }
        }
        files
    }
}

impl Shape {
    /// The shape as a mesh and how far this is beyond it; `None` for spheres.
    ///
    /// A cylinder becomes the prism around it.
    pub fn mesh(&self) -> Result<Option<(Mesh, MeshReport, f64)>, Error> {
        let (mesh, beyond) = match self {
            Self::Sphere(_) => return Ok(None),
            Self::Box(edges) => {
                let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
                let corners = corners.map(|[x, y]| [x * edges[0], y * edges[1]]);
                (prism(&corners, edges[2])?, 0.0)
            }
            Self::Cylinder { radius, length } => {
                let half = std::f64::consts::PI / f64::from(SIDES);
                let around = radius / half.cos() * (1.0 + 1e-12);
                let corners = (0..SIDES).map(|side| {
                    let angle = 2.0 * half * f64::from(side);
                    [around * angle.cos(), around * angle.sin()]
                });
                let corners: Vec<[f64; 2]> = corners.collect();
                (prism(&corners, *length)?, around - radius)
            }
            Self::Mesh { path, scale } => {
                (scaled(path, *scale).map_err(|error| error.at(path))?, 0.0)
            }
        };
        Ok(Some((mesh.0, mesh.1, beyond)))
    }
}

fn scaled(path: &Path, scale: [f64; 3]) -> Result<(Mesh, MeshReport), Error> {
    let (mesh, report) = mesh::read(path)?;
    if scale == [1.0; 3] {
        return Ok((mesh, report));
    }
    let placed = mesh.positions().iter();
    let placed = placed.map(|point| [0, 1, 2].map(|axis| scale[axis] * point[axis]));
    // A reflection turns each triangle's outside in.
    let is_mirrored = scale.iter().product::<f64>() < 0.0;
    let triangles = mesh.triangles().iter().map(|&[a, b, c]| match is_mirrored {
        true => [a, c, b],
        false => [a, b, c],
    });
    mesh::from_triangles(&placed.collect::<Vec<_>>(), &triangles.collect::<Vec<_>>())
}

/// The prism over a convex polygon, its corners anticlockwise, from half the height below to half above.
fn prism(corners: &[[f64; 2]], height: f64) -> Result<(Mesh, MeshReport), Error> {
    let sides = corners.len() as u32;
    let at = |z: f64| corners.iter().map(move |&[x, y]| [x, y, z]);
    let positions: Vec<[f64; 3]> = at(-0.5 * height).chain(at(0.5 * height)).collect();
    let mut triangles = Vec::new();
    for a in 0..sides {
        let b = (a + 1) % sides;
        triangles.extend([[a, b, sides + b], [a, sides + b, sides + a]]);
        if (2..sides).contains(&b) {
            triangles.extend([[0, b, a], [sides, sides + a, sides + b]]);
        }
    }
    mesh::from_triangles(&positions, &triangles)
}

fn shape(collision: &Node<'_, '_>, robot: &Path) -> Result<Shape, Error> {
    let geometry = children(collision, "geometry").next();
    let element = geometry.and_then(|geometry| geometry.children().find(Node::is_element));
    let Some(element) = element else {
        return Err(fault(collision, "the collision element has no geometry")
            .help("add <geometry> with a mesh, box, cylinder or sphere"));
    };
    match element.tag_name().name() {
        "sphere" => Ok(Shape::Sphere(size(&element, "radius")?)),
        "box" => {
            let edges = numbers(&element, "size")?;
            match edges.iter().all(|&edge| edge >= SMALLEST_RADIUS) {
                true => Ok(Shape::Box(edges)),
                false => Err(fault(&element, "an edge of the box is not above zero")
                    .help("give three sizes above zero")),
            }
        }
        "cylinder" => Ok(Shape::Cylinder {
            radius: size(&element, "radius")?,
            length: size(&element, "length")?,
        }),
        "mesh" => {
            let name = attribute(&element, "filename")?;
            let path = found(name, robot).ok_or_else(|| {
                fault(&element, format!("there is no mesh '{name}'")).help(
                    "keep the URDF in a folder of the package that its meshes are in, or give paths relative to it",
                )
            })?;
            if !is_mesh(&path) {
                return Err(fault(&element, format!("'{name}' is no mesh that is read"))
                    .help("convert it to .stl, .obj, .ply or .off, and name that file"));
            }
            let scale = match element.has_attribute("scale") {
                true => numbers(&element, "scale")?,
                false => [1.0; 3],
            };
            match scale.contains(&0.0) {
                true => Err(fault(&element, "the scale of the mesh is zero")
                    .help("give three factors other than zero")),
                false => Ok(Shape::Mesh { path, scale }),
            }
        }
        other => Err(
            fault(&element, format!("the geometry '{other}' is not known"))
                .help("make it of meshes, boxes, cylinders and spheres"),
        ),
    }
}

/// The file of a mesh: `package://NAME/PATH` in a folder NAME above or beside the robot's file, or in any folder above
/// it; other names relative to the robot's folder.
fn found(name: &str, robot: &Path) -> Option<PathBuf> {
    let folder = std::path::absolute(robot).ok()?.parent()?.to_owned();
    let name = name.strip_prefix("file://").unwrap_or(name);
    let tried: Vec<PathBuf> = match name.strip_prefix("package://") {
        None => vec![folder.join(name)],
        Some(name) => {
            let within = name.split_once('/').map_or(name, |(_, path)| path);
            let above = |name: &str| -> Vec<PathBuf> {
                folder.ancestors().map(|folder| folder.join(name)).collect()
            };
            [above(name), above(within)].concat()
        }
    };
    tried.into_iter().find(|path| path.is_file())
}

fn origin(collision: &Node<'_, '_>) -> Result<Pose, Error> {
    let Some(element) = children(collision, "origin").next() else {
        return Ok(Pose::identity());
    };
    let of = |name: &str| match element.has_attribute(name) {
        true => numbers(&element, name),
        false => Ok([0.0; 3]),
    };
    let [roll, pitch, yaw] = of("rpy")?;
    Ok(Pose {
        rotation: nalgebra::UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        translation: of("xyz")?.into(),
    })
}

fn children<'a, 'input>(
    node: &Node<'a, 'input>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children()
        .filter(move |child| child.tag_name().name() == name)
}

fn attribute<'a>(element: &Node<'a, '_>, name: &str) -> Result<&'a str, Error> {
    element.attribute(name).ok_or_else(|| {
        let tag = element.tag_name().name();
        fault(element, format!("<{tag}> has no '{name}'")).help(format!("add {name}=\"...\""))
    })
}

/// Three numbers of an attribute.
fn numbers(element: &Node<'_, '_>, name: &str) -> Result<[f64; 3], Error> {
    let text = attribute(element, name)?;
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(number).collect();
    let numbers: Option<[f64; 3]> = numbers.and_then(|numbers| numbers.try_into().ok());
    numbers.ok_or_else(|| {
        fault(element, format!("'{name}' is not three numbers"))
            .help(format!("write {name}=\"1 1 1\""))
    })
}

/// A length above zero.
fn size(element: &Node<'_, '_>, name: &str) -> Result<f64, Error> {
    let length = number(attribute(element, name)?.trim());
    length
        .filter(|&length| length >= SMALLEST_RADIUS)
        .ok_or_else(|| {
            fault(element, format!("'{name}' is no length above zero")).help("correct the number")
        })
}

fn number(text: &str) -> Option<f64> {
    let number = text.parse::<f64>().ok();
    number.filter(|number| number.abs() <= LARGEST_LENGTH)
}

fn fault(node: &Node<'_, '_>, what: impl std::fmt::Display) -> Error {
    let place = node.document().text_pos_at(node.range().start);
    Error::input(what).on_line(u64::from(place.row))
}
