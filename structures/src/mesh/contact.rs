//! Contact of the surfaces of two solids at a pose: whether they cross, and their distance.
//!
//! Two trees of boxes are searched together. Near triangles are compared in three steps, the cheap ones first:
//!
//! 1. A plane separates them: one triangle is on one side of the other's plane.
//! 2. They cross: the ends of an edge are on either side of the other's plane, and the edge passes within its sides.
//! 3. Their closest points give an axis along which they are apart.
//!
//! # Rounding
//!
//! Let delta bound the error of a coordinate at the pose. A sign counts if the number is farther from zero than delta
//! and the arithmetic can make it. So triangles are apart or cross for certain, or the answer is open: faces that are
//! flush, or an edge that grazes another.

use crate::mesh::solid::{Solid, nearest_on};
use crate::mesh::triangle_mesh::{centroid, doubled_normal};
use crate::motion::Motion;
use crate::vector::{add, along, bounds, cross, dot, norm, scale, squared_distance, subtract};

/// How two solids, or two of their triangles, are to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshContact {
    /// They share points, or come closer than the margin.
    Met,
    /// They are farther from each other than the margin.
    Apart,
    /// Rounding leaves it open.
    Open,
}

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
    part_corners: Vec<[f64; 3]>,
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

/// The closest points of two surfaces that do not cross.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoints {
    /// Points of the first and of the second solid, in the coordinates of the first one's file.
    pub points: [[f64; 3]; 2],
    /// The distance is not below this.
    pub low: f64,
    /// The distance is not above this.
    pub high: f64,
}

/// A solid at a place in the coordinates of another.
///
/// Both are in the coordinates of their [`Frame`](super::Frame)s, whose units may differ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Rows of the rotation, times the second unit over the first.
    rows: [[f64; 3]; 3],
    shift: [f64; 3],
    /// The second unit over the first.
    pub ratio: f64,
    /// Bound of the rounding of a coordinate.
    pub delta: f64,
}

/// Lowest and highest corner of a box.
type Bounds = ([f64; 3], [f64; 3]);

/// Triangles with an area, by their corners.
pub(super) type Triangle = [[f64; 3]; 3];

/// Operations that make up an error: the products and sums of a determinant of differences stay below this many times
/// delta times the square of a length.
const OPERATIONS: f64 = 32.0;

impl Place {
    /// The second solid moved by `motion`, from coordinates about its frame's origin to those about the first one's.
    pub fn new([a, b]: [&Solid; 2], motion: &Motion, rounding: f64) -> Self {
        let (first, second) = (a.frame().unit, b.frame().unit);
        let ratio = second / first;
        let shift = scale(motion.shift, 1.0 / first);
        let size = |point: [f64; 3]| point.iter().map(|part| part.abs()).sum::<f64>();
        let reach = size(a.half_sides()) + ratio * size(b.half_sides()) + size(shift);
        Self {
            rows: motion.rows.map(|row| scale(row, ratio)),
            shift,
            ratio,
            delta: (rounding / first).max(8.0 * f64::EPSILON * reach),
        }
    }

    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        add(self.rows.map(|row| dot(row, point)), self.shift)
    }

    pub fn moved(&self, triangle: Triangle) -> Triangle {
        triangle.map(|corner| self.apply(corner))
    }

    /// A point of the first solid's coordinates in the second one's.
    pub fn back(&self, point: [f64; 3]) -> [f64; 3] {
        let way = scale(subtract(point, self.shift), self.ratio.powi(-2));
        [0, 1, 2].map(|axis| dot(self.rows.map(|row| row[axis]), way))
    }

    /// Largest gap of the boxes of two nodes along any of their axes: the nodes are no closer. Negative if they overlap.
    fn gap(&self, [a, b]: [&Bounds; 2]) -> f64 {
        let middle = |(low, high): &Bounds| [0, 1, 2].map(|i| 0.5 * (low[i] + high[i]));
        let half = |(low, high): &Bounds| [0, 1, 2].map(|i| 0.5 * (high[i] - low[i]));
        let (first, second) = (half(a), half(b));
        let way = subtract(self.apply(middle(b)), middle(a));
        let absolute = self.rows.map(|row| row.map(f64::abs));
        let (inverse, mut gap) = (1.0 / self.ratio, f64::NEG_INFINITY);
        for i in 0..3 {
            gap = gap.max(way[i].abs() - first[i] - dot(absolute[i], second));
            let along = dot(self.rows.map(|row| row[i]), way).abs();
            let reach = dot(absolute.map(|row| row[i]), first);
            gap = gap.max((along - reach) * inverse - self.ratio * second[i]);
        }
        gap - 4.0 * self.delta
    }
}

/// Searches pairs of triangles of two solids. Buffers are kept from one search to the next.
#[derive(Debug, Default)]
pub struct SurfacePairs {
    /// Pairs of nodes, with the gap of their boxes.
    open: Vec<(f64, [u32; 2])>,
}

impl SurfacePairs {
    /// Whether two solids share points or come closer than `margin`; open if `stop` returns true before that is known.
    ///
    /// `motion` takes coordinates about the second one's origin to those about the first one's, with at most
    /// `rounding` of error. Lengths are in the unit of the files.
    pub fn contact(
        &mut self,
        solids: [&ExactSolid; 2],
        motion: &Motion,
        [margin, rounding]: [f64; 2],
        stop: impl Fn() -> bool,
    ) -> MeshContact {
        let [a, b] = solids;
        let place = Place::new([&a.solid, &b.solid], motion, rounding);
        let margin = margin / a.solid.frame().unit;
        let mut found = MeshContact::Apart;
        self.visit(
            [&a.solid, &b.solid],
            &place,
            || margin,
            |[a, b]| {
                match contact(&a.1, &b.1, margin, place.delta) {
                    MeshContact::Apart => {}
                    other => found = other,
                }
                if stop() {
                    found = MeshContact::Open;
                    return false;
                }
                found != MeshContact::Met
            },
        );
        let inside = || {
            let mut second = b.part_corners.iter().map(|&corner| place.apply(corner));
            second.any(|corner| a.solid.is_inside(corner))
                || a.part_corners
                    .iter()
                    .any(|&corner| b.solid.is_inside(place.back(corner)))
        };
        match found {
            MeshContact::Apart if inside() => MeshContact::Met,
            found => found,
        }
    }

    /// The closest points of surfaces that do not cross, if they are closer than `limit`. Lengths as those of
    /// [`Self::contact`].
    pub fn closest(
        &mut self,
        [a, b]: [&ExactSolid; 2],
        motion: &Motion,
        [limit, rounding]: [f64; 2],
    ) -> Option<ClosestPoints> {
        let solids = [&a.solid, &b.solid];
        let place = Place::new(solids, motion, rounding);
        let frame = a.solid.frame();
        let best = std::cell::Cell::new((limit / frame.unit, None));
        self.visit(
            solids,
            &place,
            || best.get().0,
            |[a, b]| {
                let points = closest_points(&a.1, &b.1);
                let squared = squared_distance(points[0], points[1]);
                if squared < best.get().0.powi(2) {
                    best.set((squared.sqrt(), Some(points)));
                }
                true
            },
        );
        let (distance, points) = best.get();
        // The closest points of lines that are nearly parallel are not: that lengthens a square by rounding.
        let square = distance * distance - OPERATIONS * place.delta;
        let low = square.max(0.0).sqrt() - place.delta;
        points.map(|points| ClosestPoints {
            points: points.map(|point| frame.outward(point)),
            low: low.max(0.0) * frame.unit,
            high: (distance + 2.0 * place.delta) * frame.unit,
        })
    }

    /// Calls `found` with the triangles, numbered and the second ones moved, whose boxes are within `margin`, until it
    /// returns false. The nearest boxes come first.
    pub(super) fn visit(
        &mut self,
        solids: [&Solid; 2],
        place: &Place,
        margin: impl Fn() -> f64,
        mut found: impl FnMut([&(usize, Triangle); 2]) -> bool,
    ) {
        let [a, b] = solids.map(Solid::boxes);
        let gap = |[i, j]: [u32; 2]| place.gap([&a[i as usize].known, &b[j as usize].known]);
        self.open.clear();
        self.open.push((gap([0, 0]), [0, 0]));
        while let Some((least, nodes)) = self.open.pop() {
            if least > margin() {
                continue;
            }
            let [first, second] = [&a[nodes[0] as usize], &b[nodes[1] as usize]];
            if first.second == 0 && second.second == 0 {
                let firsts = &solids[0].triangles()[first.first..][..first.count];
                for (number, triangle) in &solids[1].triangles()[second.first..][..second.count] {
                    let moved = (*number, place.moved(*triangle));
                    let (low, high) = bounds(moved.1);
                    for triangle in firsts {
                        let reach = margin() + 4.0 * place.delta;
                        let near = |axis: usize| {
                            let [p, q, r] = triangle.1.map(|corner| corner[axis]);
                            p.min(q).min(r) - high[axis] <= reach
                                && low[axis] - p.max(q).max(r) <= reach
                        };
                        if near(0) && near(1) && near(2) && !found([triangle, &moved]) {
                            return;
                        }
                    }
                }
                continue;
            }
            let size = |(low, high): &Bounds| squared_distance(*low, *high);
            let larger = size(&second.known) * place.ratio.powi(2) > size(&first.known);
            let side = usize::from(first.second == 0 || (second.second != 0 && larger));
            let mut halves = [(0.0, nodes), (0.0, nodes)];
            halves[0].1[side] = [first, second][side].second as u32;
            halves[1].1[side] = nodes[side] + 1;
            for half in &mut halves {
                half.0 = gap(half.1);
            }
            if halves[0].0 < halves[1].0 {
                halves.swap(0, 1);
            }
            let within = |half: &(f64, _)| half.0 <= margin();
            self.open.extend(halves.into_iter().filter(within));
        }
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

/// How two triangles are to each other, with coordinates that may be off by `delta`.
fn contact(a: &Triangle, b: &Triangle, margin: f64, delta: f64) -> MeshContact {
    let sides = [[a, b], [b, a]].map(|[plane, other]| Sides::new(plane, other, margin, delta));
    if sides.iter().any(|sides| sides.apart) {
        return MeshContact::Apart;
    }
    if sides[0].crossed(a, b, delta) || sides[1].crossed(b, a, delta) {
        return MeshContact::Met;
    }
    let [p, q] = closest_points(a, b);
    let axis = subtract(q, p);
    let distance = norm(axis);
    if distance < margin - 4.0 * delta {
        return MeshContact::Met;
    }
    // The closest points may be off; the axis through them is tried, and shows what it shows.
    let along_axis = |triangle: &Triangle| triangle.map(|corner| dot(axis, subtract(corner, p)));
    let from = along_axis(a).into_iter().fold(f64::NEG_INFINITY, f64::max);
    let to = along_axis(b).into_iter().fold(f64::INFINITY, f64::min);
    if to - from > (margin + OPERATIONS * delta) * distance {
        MeshContact::Apart
    } else {
        MeshContact::Open
    }
}

/// Sum of the coordinates of the corner that is farthest by it.
fn corners_reach(triangle: &Triangle, from: [f64; 3]) -> f64 {
    let reach = |corner: &[f64; 3]| {
        let way = subtract(*corner, from);
        way.iter().map(|part| part.abs()).sum::<f64>()
    };
    triangle.iter().map(reach).fold(0.0, f64::max)
}

/// On which side of a triangle's plane the corners of another are.
struct Sides {
    /// Heights above the plane, times the length of the normal.
    heights: [f64; 3],
    /// 1 in front for certain, -1 behind for certain, else 0.
    signs: [i8; 3],
    /// All on one side, farther away than the margin.
    apart: bool,
}

impl Sides {
    fn new(plane: &Triangle, other: &Triangle, margin: f64, delta: f64) -> Self {
        let [a, b, c] = *plane;
        let normal = cross(subtract(b, a), subtract(c, a));
        let reach = corners_reach(plane, a);
        let error = OPERATIONS * delta * reach * (reach + corners_reach(other, a));
        let heights = other.map(|corner| dot(normal, subtract(corner, a)));
        let beyond = error + margin * norm(normal) * (1.0 + 1e-12);
        let signs = heights.map(|height| match height {
            _ if height > error => 1,
            _ if height < -error => -1,
            _ => 0,
        });
        Self {
            heights,
            signs,
            apart: heights.iter().all(|&height| height > beyond)
                || heights.iter().all(|&height| height < -beyond),
        }
    }

    /// Whether an edge of `other` crosses the triangle for certain.
    fn crossed(&self, triangle: &Triangle, other: &Triangle, delta: f64) -> bool {
        [[0, 1], [1, 2], [2, 0]].iter().any(|&[from, to]| {
            self.signs[from] * self.signs[to] == -1
                && passes(triangle, [other[from], other[to]], delta) == Some(true)
        })
    }
}

/// Whether the line through an edge passes within the sides of a triangle; `None` if rounding can change that.
fn passes([a, b, c]: &Triangle, [from, to]: [[f64; 3]; 2], delta: f64) -> Option<bool> {
    let way = subtract(to, from);
    let [a, b, c] = [a, b, c].map(|corner| subtract(*corner, from));
    let reach = [a, b, c, way].map(|v| v.iter().map(|part| part.abs()).sum::<f64>());
    let reach = reach.into_iter().fold(0.0, f64::max);
    let error = OPERATIONS * delta * reach * reach;
    let around = [cross(a, b), cross(b, c), cross(c, a)].map(|normal| dot(way, normal));
    let counts = [1.0, -1.0].map(|sign| around.iter().filter(|&side| sign * side > error).count());
    match counts {
        [3, _] | [_, 3] => Some(true),
        [0, _] | [_, 0] => None,
        _ => Some(false),
    }
}

/// How two triangles are to each other.
pub(super) enum Relation {
    Apart,
    /// They cross along a segment.
    Cross([End; 2]),
    /// Rounding leaves it open.
    Open,
}

/// An end of the segment along which two triangles cross: a side of one passes through the other.
#[derive(Clone, Copy)]
pub(super) struct End {
    pub point: [f64; 3],
    /// Whether it is a side of the second triangle.
    pub of_second: bool,
    /// Number of the side: it begins at the corner of this number.
    pub side: usize,
    /// Share of the side before the point.
    pub share: f64,
    /// Whether the side leaves the solid behind the other triangle there.
    pub leaves: bool,
}

/// How two triangles are to each other, by signs that rounding cannot change.
pub(super) fn relation(a: &Triangle, b: &Triangle, delta: f64) -> Relation {
    let sides = [[b, a], [a, b]].map(|[plane, other]| Sides::new(plane, other, 0.0, delta));
    if sides.iter().any(|sides| sides.apart) {
        return Relation::Apart;
    }
    let mut ends = [None; 2];
    let mut found = 0;
    let mut certain = true;
    for (second, (sides, [other, plane])) in sides.iter().zip([[a, b], [b, a]]).enumerate() {
        for side in 0..3 {
            let next = (side + 1) % 3;
            let signs = [sides.signs[side], sides.signs[next]];
            certain &= signs[0] != 0;
            if signs[0] * signs[1] != -1 {
                continue;
            }
            match passes(plane, [other[side], other[next]], delta) {
                Some(false) => {}
                None => certain = false,
                Some(true) => {
                    let [from, to] = [sides.heights[side], sides.heights[next]];
                    let way = subtract(other[next], other[side]);
                    let share = from / (from - to);
                    if let Some(end) = ends.get_mut(found) {
                        *end = Some(End {
                            point: along(other[side], share, way),
                            share,
                            of_second: second == 1,
                            side,
                            leaves: signs[1] > 0,
                        });
                    }
                    found += 1;
                }
            }
        }
    }
    match (certain, found, ends) {
        (true, 0, _) => Relation::Apart,
        (true, 2, [Some(from), Some(to)]) => Relation::Cross([from, to]),
        // A corner in the other's plane, beside the other.
        _ if contact(a, b, 0.0, delta) == MeshContact::Apart => Relation::Apart,
        _ => Relation::Open,
    }
}

/// Whether triangles that share one corner cross beside it for certain.
fn crosses_beside(a: &Triangle, b: &Triangle, delta: f64) -> bool {
    [[a, b], [b, a]].into_iter().any(|[plane, other]| {
        let sides = Sides::new(plane, other, 0.0, delta);
        sides.crossed(plane, other, delta)
    })
}

/// Closest points of two triangles that do not cross: of a corner and a triangle, or of two edges.
fn closest_points(a: &Triangle, b: &Triangle) -> [[f64; 3]; 2] {
    let mut best = (f64::INFINITY, [a[0], b[0]]);
    let mut offer = |points: [[f64; 3]; 2]| {
        let squared = squared_distance(points[0], points[1]);
        if squared < best.0 {
            best = (squared, points);
        }
    };
    for &corner in a {
        offer([corner, nearest_on(*b, corner)]);
    }
    for &corner in b {
        offer([nearest_on(*a, corner), corner]);
    }
    for (i, &from) in a.iter().enumerate() {
        for (j, &other) in b.iter().enumerate() {
            let points = between_lines([from, a[(i + 1) % 3]], [other, b[(j + 1) % 3]]);
            points.into_iter().for_each(&mut offer);
        }
    }
    best.1
}

/// Closest points of the lines through two edges, if both are on the edges.
fn between_lines([a, b]: [[f64; 3]; 2], [c, d]: [[f64; 3]; 2]) -> Option<[[f64; 3]; 2]> {
    let (first, second, way) = (subtract(b, a), subtract(d, c), subtract(c, a));
    let normal = cross(first, second);
    let square = dot(normal, normal);
    let s = dot(cross(way, second), normal) / square;
    let t = dot(cross(way, first), normal) / square;
    let on = |share: f64| (0.0..=1.0).contains(&share);
    (on(s) && on(t)).then(|| [along(a, s, first), along(c, t, second)])
}
