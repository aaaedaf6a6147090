//! Contact of the surfaces of two solids at a pose: whether they cross, and their distance.
//!
//! Two trees of boxes are searched together, the nearest boxes first. Near triangles are compared by signs that rounding
//! cannot change ([`triangle_pair`](super::triangle_pair)). So the answer may be open: faces that are flush, or an edge
//! that grazes another.

use crate::mesh::exact_solid::ExactSolid;
use crate::mesh::solid::Solid;
use crate::mesh::triangle_pair::{MeshContact, OPERATIONS, Triangle, closest_points, contact};
use crate::motion::Motion;
use crate::vector::{add, bounds, dot, scale, squared_distance, subtract};

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

    /// A lower bound of the distance of what two boxes hold: that of either box and the one along its axes about the other.
    /// Below zero by how much they overlap; any bound above `margin` will do.
    fn gap(&self, [a, b]: [&Bounds; 2], margin: f64) -> f64 {
        let middle = |(low, high): &Bounds| [0, 1, 2].map(|i| 0.5 * (low[i] + high[i]));
        let half = |(low, high): &Bounds| [0, 1, 2].map(|i| 0.5 * (high[i] - low[i]));
        let (first, second) = (half(a), half(b));
        let way = subtract(self.apply(middle(b)), middle(a));
        let absolute = self.rows.map(|row| row.map(f64::abs));
        let along_first = [0, 1, 2].map(|i| way[i].abs() - first[i] - dot(absolute[i], second));
        let bound = between_boxes(along_first) - 8.0 * self.delta;
        if bound > margin {
            return bound;
        }
        let inverse = 1.0 / self.ratio;
        let along_second = [0, 1, 2].map(|i| {
            let along = dot(self.rows.map(|row| row[i]), way).abs();
            let reach = dot(absolute.map(|row| row[i]), first);
            (along - reach) * inverse - self.ratio * second[i]
        });
        bound.max(between_boxes(along_second) - 8.0 * self.delta)
    }
}

/// Distance of two boxes along common axes from their gaps along each; the largest of these if none is above zero.
fn between_boxes(gaps: [f64; 3]) -> f64 {
    let beyond = gaps.map(|gap| gap.max(0.0));
    match dot(beyond, beyond) {
        0.0 => gaps[0].max(gaps[1]).max(gaps[2]),
        square => square.sqrt(),
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
        let gap = |[i, j]: [u32; 2]| {
            let nodes = [&a[i as usize].known, &b[j as usize].known];
            place.gap(nodes, margin())
        };
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
                        let reach = margin() + 8.0 * place.delta;
                        let mut square = 0.0;
                        let near = (0..3).all(|axis| {
                            let [p, q, r] = triangle.1.map(|corner| corner[axis]);
                            let before = p.min(q).min(r) - high[axis];
                            let gap = before.max(low[axis] - p.max(q).max(r));
                            square += gap.max(0.0).powi(2);
                            gap <= reach && square <= reach * reach
                        });
                        if near && !found([triangle, &moved]) {
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
