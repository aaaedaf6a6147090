//! The part of a ball in a convex polyhedron, such as its cell of the power diagram.
//!
//! The ball is the unit ball about the origin. The polyhedron begins as a tetrahedron about it and is cut by planes. Its
//! faces are closed loops of shared vertices, so the surface stays closed however rounding turns out, also if planes
//! coincide or many meet in one point.
//!
//! The volume is a sum over faces: the ball's part of the cone from the origin to the face, negative if the face looks
//! at the origin. It has a closed form ([`cone`]). All terms are continuous in the vertices and none is larger than the
//! ball, so rounding costs some last digits of the ball's volume.

use std::f64::consts::FRAC_PI_2;

use crate::vector::{along, cross, dot, norm, subtract};

/// A half-space n x <= offset, with n of length one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub normal: [f64; 3],
    pub offset: f64,
}

/// A face: its plane, and the range of its loop of vertices, counterclockwise from outside.
#[derive(Clone, Copy, Debug)]
struct Face {
    plane: Plane,
    first: usize,
    end: usize,
    /// The ball's part of the cone to it, once computed.
    cone: Option<f64>,
}

/// A convex polyhedron, with the buffers for cutting it.
#[derive(Debug, Default)]
pub(super) struct Cell {
    /// Those that were cut off are not numbers; their places, `free`, are taken by later ones.
    vertices: Vec<[f64; 3]>,
    free: Vec<u32>,
    faces: Vec<Face>,
    /// Loops of faces, present and past.
    loops: Vec<u32>,
    /// How far each vertex is beyond the cutting plane.
    beyond: Vec<f64>,
    /// Edges that are cut, and their new vertices.
    cuts: Vec<([u32; 2], u32)>,
    /// Edges of the new face, from vertex to vertex.
    rim: Vec<[u32; 2]>,
}

impl Cell {
    /// Makes this the regular tetrahedron about the unit ball.
    pub fn reset(&mut self) {
        self.vertices.clear();
        self.free.clear();
        self.faces.clear();
        self.loops.clear();
        let unit = 1.0 / 3.0f64.sqrt();
        let normals = [
            [unit, unit, unit],
            [unit, -unit, -unit],
            [-unit, unit, -unit],
            [-unit, -unit, unit],
        ];
        // Each vertex is opposite to a face.
        let vertices = normals.map(|normal| normal.map(|part| -3.0 * part));
        self.vertices.extend(vertices);
        let loops = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
        for (normal, corners) in normals.into_iter().zip(loops) {
            let first = self.loops.len();
            self.loops.extend(corners);
            let offset = 1.0;
            self.add_face(Plane { normal, offset }, first);
        }
    }

    /// Adds the face whose loop is the last one, from `first` on.
    fn add_face(&mut self, plane: Plane, first: usize) {
        self.faces.push(Face {
            plane,
            first,
            end: self.loops.len(),
            cone: None,
        });
    }

    /// Number of edges, each counted in both of its faces.
    pub fn edges(&self) -> usize {
        self.faces.iter().map(|face| face.end - face.first).sum()
    }

    /// Length from the origin to the farthest vertex.
    pub fn reach(&self) -> f64 {
        let squares = self.vertices.iter().map(|&vertex| dot(vertex, vertex));
        // What was cut off is no number and no maximum.
        squares.fold(0.0, f64::max).sqrt()
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    /// Keeps the part in a half-space; whether that took anything away.
    pub fn cut(&mut self, plane: &Plane) -> bool {
        let Plane {
            normal: [a, b, c],
            offset,
        } = plane;
        self.beyond.clear();
        let beyond = |[x, y, z]: &[f64; 3]| a * x + b * y + c * z - offset;
        self.beyond.extend(self.vertices.iter().map(beyond));
        if !self.beyond.iter().any(|&beyond| beyond > 0.0) {
            return false;
        }
        self.cuts.clear();
        self.rim.clear();
        let mut number = 0;
        while let Some(face) = self.faces.get(number) {
            let Face { first, end, .. } = *face;
            let left = self.loops[first..end].iter();
            let left = left.filter(|&&vertex| self.keeps(vertex)).count();
            if left == 0 {
                self.faces.swap_remove(number);
                continue;
            }
            if left < end - first {
                let new = self.loops.len();
                self.cut_loop(first, end);
                let face = &mut self.faces[number];
                face.cone = None;
                (face.first, face.end) = (new, self.loops.len());
            }
            number += 1;
        }
        while let Some([start, mut at]) = self.rim.pop() {
            let first = self.loops.len();
            self.loops.push(start);
            while at != start {
                self.loops.push(at);
                let Some(place) = self.rim.iter().position(|[from, _]| *from == at) else {
                    break;
                };
                at = self.rim.swap_remove(place)[1];
            }
            self.add_face(*plane, first);
        }
        let vertices = (0..).zip(&mut self.vertices);
        for ((number, vertex), &beyond) in vertices.zip(&self.beyond) {
            if beyond > 0.0 {
                *vertex = [f64::NAN; 3];
                self.free.push(number);
            }
        }
        true
    }

    fn keeps(&self, vertex: u32) -> bool {
        self.beyond[vertex as usize] <= 0.0
    }

    /// Appends the part of a loop in the half-space. From the point where it leaves the half-space it goes on to the next
    /// point where it enters; rounding may let it leave repeatedly.
    fn cut_loop(&mut self, first: usize, end: usize) {
        let (mut left, mut entered) = (None, None);
        let mut from = self.loops[end - 1];
        let mut was_kept = self.keeps(from);
        for place in first..end {
            let to = self.loops[place];
            let is_kept = self.keeps(to);
            if was_kept != is_kept {
                let between = self.cut_edge([from.min(to), from.max(to)]);
                self.loops.push(between);
                match (was_kept, left.take()) {
                    (true, _) => left = Some(between),
                    (false, Some(left)) => self.rim.push([between, left]),
                    (false, None) => entered = Some(between),
                }
            }
            if is_kept {
                self.loops.push(to);
            }
            (from, was_kept) = (to, is_kept);
        }
        if let (Some(left), Some(entered)) = (left, entered) {
            self.rim.push([entered, left]);
        }
    }

    /// The vertex where an edge is cut: the same one for both of its faces.
    fn cut_edge(&mut self, edge: [u32; 2]) -> u32 {
        if let Some((_, vertex)) = self.cuts.iter().find(|(known, _)| *known == edge) {
            return *vertex;
        }
        let [a, b] = edge.map(|vertex| self.vertices[vertex as usize]);
        let [before, after] = edge.map(|vertex| self.beyond[vertex as usize]);
        let share = before / (before - after);
        let between = along(a, share, subtract(b, a));
        let vertex = match self.free.pop() {
            Some(free) => {
                self.vertices[free as usize] = between;
                free
            }
            None => {
                self.vertices.push(between);
                self.vertices.len() as u32 - 1
            }
        };
        self.cuts.push((edge, vertex));
        vertex
    }

    /// Volume of the part of the unit ball that is in the polyhedron.
    pub fn volume(&mut self) -> f64 {
        let (vertices, loops) = (&self.vertices, &self.loops);
        let cones = self.faces.iter_mut().map(|face| {
            let corners = loops[face.first..face.end].iter();
            let corners = corners.map(|&vertex| vertices[vertex as usize]);
            *face.cone.get_or_insert_with(|| cone(&face.plane, corners))
        });
        cones.sum()
    }
}

/// Volume of the unit ball's part of the cone from its centre to a face, negative if the face looks at the centre.
///
/// It is the sum of cones to triangles from the foot of the perpendicular to each edge. Within the disc that the ball
/// cuts out of the plane, such a cone is a pyramid over a triangle. Beyond, it is a pyramid over a sector of the disc
/// and a sector of the ball, whose solid angle is that of the cone less that of the disc's sector.
fn cone(plane: &Plane, corners: impl Iterator<Item = [f64; 3]> + Clone) -> f64 {
    let Plane { normal, offset } = *plane;
    let height = offset.abs();
    // Square of the disc's radius.
    let square = 1.0 - height * height;
    let (mut triangles, mut angle, mut less) = (0.0, AngleSum::default(), AngleSum::default());
    let Some(mut from) = corners.clone().last() else {
        return 0.0;
    };
    for to in corners {
        let edge = subtract(to, from);
        let length = norm(edge);
        if length > 0.0 {
            let direction = edge.map(|part| part / length);
            let arm = dot(normal, cross(from, direction));
            let start = dot(from, direction) - offset * dot(normal, direction);
            let end = start + length;
            let mut outside = |from: f64, to: f64| {
                let slant = |t: f64| (height * height + arm * arm + t * t).sqrt();
                let (near, far) = (slant(from), slant(to));
                angle.add(arm * arm + from * to, arm * (to - from));
                // The angle less the solid angle of the cone to the triangle.
                less.add(
                    arm * arm * near * far + height * height * from * to,
                    height * arm * (to * near - from * far),
                );
            };
            let half = square - arm * arm;
            if square <= 0.0 || half <= 0.0 {
                outside(start, end);
            } else {
                let half = half.sqrt();
                triangles += arm * (end.clamp(-half, half) - start.clamp(-half, half));
                if start < -half {
                    outside(start, end.min(-half));
                }
                if end > half {
                    outside(start.max(half), end);
                }
            }
        }
        from = to;
    }
    let sector = if square <= 0.0 {
        1.0 / 3.0
    } else {
        height * (square / 6.0 + 1.0 / 3.0)
    };
    offset.signum() * (height * triangles / 6.0 + sector * angle.sum() - less.sum() / 3.0)
}

/// A sum of angles, each from minus pi to pi, for one arc tangent.
#[derive(Default)]
struct AngleSum {
    quarters: f64,
    /// Tangent of the rest, from -1 to 1.
    tangent: f64,
}

impl AngleSum {
    /// Adds the angle of a point of the plane; nothing for the origin.
    fn add(&mut self, x: f64, y: f64) {
        let tangent = if x.abs() >= y.abs() {
            if x == 0.0 {
                return;
            }
            if x < 0.0 {
                self.quarters += 2.0f64.copysign(y);
            }
            y / x
        } else {
            self.quarters += 1.0f64.copysign(y);
            -x / y
        };
        let (x, y) = (1.0 - self.tangent * tangent, self.tangent + tangent);
        self.tangent = if x >= y.abs() {
            y / x
        } else {
            self.quarters += 1.0f64.copysign(y);
            -x / y
        };
    }

    fn sum(&self) -> f64 {
        let rest = if self.tangent == 0.0 {
            0.0
        } else {
            self.tangent.atan()
        };
        self.quarters * FRAC_PI_2 + rest
    }
}
