//! Solids of meshes whose triangles decide contact: closed surfaces that do not cross themselves.

use crate::mesh::contact::{Place, SurfacePairs};
use crate::mesh::solid::Solid;
use crate::mesh::triangle_mesh::{centroid, doubled_normal};
use crate::mesh::triangle_pair::{MeshContact, Triangle, contact, crosses_beside};
use crate::motion::Motion;
use crate::vector::{along, norm};

/// Why the triangles of a mesh do not decide contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Indefinite {
    /// Inside and outside are a matter of degree.
    #[error("the mesh is not closed")]
    NotClosed,
    /// Triangles may be within the solid.
    #[error("the mesh crosses itself")]
    CrossesItself,
    /// Its surface is none of the solid's.
    #[error("the mesh has a part within another that faces outward")]
    Nested,
}

/// A corner in a tree of sides: those closer to the root come first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Branch {
    /// The corner.
    pub to: u32,
    /// The corner before it and the side between, unless it is the root.
    pub from: Option<(u32, Run)>,
}

/// A way along a side of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run(u32);

impl Run {
    /// Three times the number of the triangle, and that of the side.
    pub fn side(self) -> usize {
        (self.0 / 2) as usize
    }

    /// Whether the triangle runs along its side the same way.
    pub fn is_forward(self) -> bool {
        self.0.is_multiple_of(2)
    }

    fn ends(self, corners: &[[u32; 3]]) -> [u32; 2] {
        let (triangle, side) = (corners[self.side() / 3], self.side() % 3);
        let ends = [triangle[side], triangle[(side + 1) % 3]];
        if self.is_forward() {
            ends
        } else {
            [ends[1], ends[0]]
        }
    }
}

/// Trees of sides from corner to corner, breadth first, and a triangle at the root of each.
fn forest(corners: &[[u32; 3]], count: usize) -> (Vec<Branch>, Vec<usize>) {
    let runs = (0..6 * corners.len() as u32).map(Run);
    let mut runs: Vec<(u32, Run)> = runs.map(|run| (run.ends(corners)[0], run)).collect();
    runs.sort_unstable_by_key(|(corner, run)| (*corner, run.0));
    let mut known = vec![false; count];
    let mut forest = Vec::with_capacity(count);
    let mut firsts = Vec::new();
    for (triangle, &[root, ..]) in corners.iter().enumerate() {
        if std::mem::replace(&mut known[root as usize], true) {
            continue;
        }
        firsts.push(triangle);
        let mut next = forest.len();
        forest.push(Branch {
            to: root,
            from: None,
        });
        while let Some(&Branch { to: from, .. }) = forest.get(next) {
            let first = runs.partition_point(|(corner, _)| *corner < from);
            for (_, run) in runs[first..]
                .iter()
                .take_while(|(corner, _)| *corner == from)
            {
                let [_, to] = run.ends(corners);
                if !std::mem::replace(&mut known[to as usize], true) {
                    forest.push(Branch {
                        to,
                        from: Some((from, *run)),
                    });
                }
            }
            next += 1;
        }
    }
    (forest, firsts)
}

/// Whether the solid is behind a triangle and not in front of it.
fn bounds_solid(solid: &Solid, triangle: &Triangle) -> bool {
    let doubled = doubled_normal(*triangle);
    // A step of a millionth of the triangle's size.
    let step = 1e-6 / norm(doubled).sqrt();
    let beside = |sign: f64| along(centroid(*triangle), sign * step, doubled);
    solid.is_inside(beside(-1.0)) && !solid.is_inside(beside(1.0))
}

/// A solid whose surface is closed and does not cross itself. If such surfaces cross, the solids meet. If not, they meet
/// only if a connected part of one surface is inside the other solid.
#[derive(Clone, Debug)]
pub struct ExactSolid {
    pub(super) solid: Solid,
    /// Corners of the triangles that have an area, by their number among these.
    pub(super) corners: Vec<[u32; 3]>,
    /// Trees of sides that hold all corners, one per connected part of the surface.
    pub(super) forest: Vec<Branch>,
    /// A corner of each part, in the solid's coordinates.
    pub(super) part_corners: Vec<[f64; 3]>,
    /// Area of the surface.
    pub(super) area: f64,
}

impl ExactSolid {
    /// The solid, if its triangles decide contact.
    ///
    /// # Errors
    /// [`Indefinite`] for an open mesh or one that crosses itself.
    pub fn new(solid: &Solid) -> Result<Self, Indefinite> {
        if !solid.mesh().is_closed() {
            return Err(Indefinite::NotClosed);
        }
        if !is_simple(solid) {
            return Err(Indefinite::CrossesItself);
        }
        let corners = solid.corners();
        let (forest, firsts) = forest(&corners, solid.mesh().positions().len());
        let positions = solid.mesh().positions();
        let firsts = firsts
            .iter()
            .map(|&first| corners[first].map(|at| positions[at as usize]));
        let firsts: Vec<Triangle> = firsts.collect();
        if !firsts.iter().all(|triangle| bounds_solid(solid, triangle)) {
            return Err(Indefinite::Nested);
        }
        Ok(Self {
            solid: solid.clone(),
            part_corners: firsts.iter().map(|[corner, ..]| *corner).collect(),
            corners,
            forest,
            area: solid.mesh().area(),
        })
    }
}

/// Whether no two triangles cross for certain.
fn is_simple(solid: &Solid) -> bool {
    let place = Place::new([solid, solid], &Motion::IDENTITY, 0.0);
    let mut simple = true;
    SurfacePairs::default().visit(
        [solid, solid],
        &place,
        || 0.0,
        |[a, b]| {
            if a.0 < b.0 {
                let shared = b.1.iter().filter(|corner| a.1.contains(corner)).count();
                simple = match shared {
                    0 => contact(&a.1, &b.1, 0.0, place.delta) != MeshContact::Met,
                    1 => !crosses_beside(&a.1, &b.1, place.delta),
                    // Two planes meet in the line of the shared edge alone.
                    _ => true,
                };
            }
            simple
        },
    );
    simple
}
