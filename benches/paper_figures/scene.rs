//! The two solids as balls: the Stanford bunny and a keyed peg, sampled with one spacing by B&I's Algorithm 1.
//!
//! Lengths are in longest edges of the bunny's bounding box. The paper's second solid is not named; its share of the
//! bunny's inside nodes is 7 to 12% (Table 1). The peg is made by the docking tests
//! (`structures/examples/docking_parts`), and its size here comes near this share. It is turned once, so that none of
//! its faces lies along the grid.

use super::docking_parts::peg_and_hole;
use knotdock::geometry::gap::spectrum::Body;
use knotdock_scoring::minkowski::Node;
use knotdock_structures::mesh::{Mesh, Solid, from_triangles, read};
use knotdock_structures::sampling::decomposition::DecompositionOptions;
use knotdock_structures::sampling::{Method, SetName, knots, sample};
use nalgebra::{UnitQuaternion, Vector3};
use std::error::Error;
use std::path::Path;

/// Longest edge of the peg.
const PEG: f64 = 0.42;
/// Longest edge of a small bunny, which has the paper's share of the bunny's nodes without flat faces.
const SMALL: f64 = 0.45;

/// Both solids at one grid size.
pub struct Scene {
    /// Grid points per axis, the cube root of m.
    pub per_axis: usize,
    /// The bunny's balls about the middle of its bounding box.
    pub bunny: Body,
    /// The peg's, turned.
    pub peg: Body,
    /// The small bunny's, as it stands.
    pub small: Body,
    /// Nodes of the sampling grids inside bunny, peg and small bunny, where the balls are: what uniform sampling takes.
    pub nodes: [Vec<Node>; 3],
    /// Edge of the periodic cube in which the two are correlated: their extents together, so that nothing wraps around.
    pub edge: f64,
}

impl Scene {
    /// Samples both with the spacing of `per_axis` nodes along the bunny's longest edge.
    pub fn new(per_axis: usize) -> Result<Self, Box<dyn Error>> {
        let mesh = bunny_mesh()?;
        let mu = DecompositionOptions::default().mu;
        let (bunny, nodes) = sampled(&mesh, 1.0, per_axis, mu)?;
        let nodes_along = |edge: f64| 1 + (edge * (per_axis - 1) as f64).round() as usize;
        let (small, small_nodes) = sampled(&mesh, SMALL, nodes_along(SMALL), mu)?;
        let part = peg_and_hole(0.05).ligand;
        let (peg, _) = from_triangles(&part.positions, &part.triangles)?;
        let (mut peg, mut peg_nodes) = sampled(&peg, PEG, nodes_along(PEG), mu)?;
        let turn = UnitQuaternion::from_euler_angles(0.3, -0.4, 1.2);
        for place in peg.centers.iter_mut().chain(&mut peg_nodes) {
            *place = (turn * Vector3::from(*place)).into();
        }
        let edge = edge(&bunny, &peg);
        Ok(Self {
            per_axis,
            bunny,
            peg,
            small,
            nodes: [nodes, peg_nodes, small_nodes],
            edge,
        })
    }

    /// The bound eps of the bunny's sampling; the others' are this but for the rounding of their nodes to whole ones.
    pub fn epsilon(&self) -> f64 {
        0.5 * 3f64.sqrt() / (self.per_axis - 1) as f64
    }
}

fn bunny_mesh() -> Result<Mesh, Box<dyn Error>> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    Ok(read(&root.join("structures/examples/bunny.obj"))?.0)
}

/// The bunny's set A3 at a protrusion factor.
pub fn bunny_balls(per_axis: usize, mu: f64) -> Result<Body, Box<dyn Error>> {
    Ok(sampled(&bunny_mesh()?, 1.0, per_axis, mu)?.0)
}

/// The set A3 of a mesh scaled to a longest edge, and the nodes inside.
pub fn sampled(
    mesh: &Mesh,
    edge: f64,
    per_axis: usize,
    mu: f64,
) -> Result<(Body, Vec<Node>), Box<dyn Error>> {
    let solid = Solid::new(mesh)?;
    let method = Method::BehandishIlies(DecompositionOptions {
        mu,
        ..DecompositionOptions::default()
    });
    let sampling = sample(&solid, per_axis, method)?;
    let frame = solid.frame();
    let balls = sampling.sets.iter().find(|set| set.name == SetName::A3);
    let balls = balls.ok_or("the sampler gave no set A3")?;
    let knots = knots(frame, &balls.balls, None)?;
    let scale = edge / mesh.extent();
    let centers = knots
        .centers
        .iter()
        .map(|center| [0, 1, 2].map(|axis| scale * (center[axis] - frame.origin[axis])));
    let field = &sampling.field;
    let inside = field.inside().into_iter();
    let nodes = inside.map(|node| field.grid.node(node).map(|x| scale * frame.unit * x));
    let body = Body {
        centers: centers.collect(),
        radii: knots.radii.iter().map(|radius| scale * radius).collect(),
    };
    Ok((body, nodes.collect()))
}

/// Edge of the smallest cube in which the correlation of two bodies does not wrap around.
pub fn edge(first: &Body, second: &Body) -> f64 {
    let (first, second) = (first.extent(), second.extent());
    (0..3)
        .map(|axis| first[axis] + second[axis])
        .fold(0.0, f64::max)
}
