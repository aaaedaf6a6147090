//! Dots on the molecular surface: the inner boundary of all that a rolling probe reaches (Richards, Annu. Rev. Biophys.
//! Bioeng. 6 (1977) 151-176; Connolly, J. Appl. Cryst. 16 (1983) 548-558).
//!
//! The surface has three kinds of faces: parts of the atoms' own spheres, saddles that the probe sweeps while it touches two
//! atoms, and triangles on the probe where it touches three.

use knotdock_structures::molecule::spiral;
use knotdock_structures::neighbours::{CellList, Member};
use nalgebra::Vector3;

/// How much deeper than its radius a ball has to hold a point to cover it, in Å: what touches does not cover.
const SLACK: f64 = 1e-7;

/// A point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SurfaceDot {
    /// Position, in Å.
    pub at: Vector3<f64>,
    /// Away from the molecule, of length 1; the probe that touches here is along it.
    pub normal: Vector3<f64>,
}

/// A ball: an atom.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    pub center: Vector3<f64>,
    pub radius: f64,
    /// Whether dots are placed on the faces that it is part of.
    pub has_dots: bool,
}

/// Dots on the faces of the balls that have dots, `density` of them per Å^2, for a probe of a radius. Balls are about the
/// origin.
pub(super) fn surface_dots(spheres: &[Sphere], probe: f64, density: f64) -> Vec<SurfaceDot> {
    let surface = Surface::new(spheres, probe, density);
    let mut dots = surface.convex();
    let probes = surface.probes();
    let members = probes.iter().map(|one| Member {
        position: one.at.into(),
        item: (),
    });
    let held = CellList::new(members.collect(), probe);
    // If probes overlap, the surface is only the part that none of them reaches.
    let is_out = |dot: &SurfaceDot| {
        let mut is_out = true;
        held.visit_within(dot.at.into(), probe - SLACK, |(), _| is_out = false);
        is_out
    };
    dots.extend(surface.saddles().into_iter().filter(is_out));
    dots.extend(surface.triangles(&probes).into_iter().filter(is_out));
    dots
}

/// A probe that touches three balls.
struct Probe {
    at: Vector3<f64>,
    touched: [usize; 3],
}

/// The circle of the centres of probes that touch two balls.
struct Circle {
    center: Vector3<f64>,
    radius: f64,
    /// From the first ball to the second, then two directions across.
    axes: [Vector3<f64>; 3],
    /// From the first ball to the plane of the circle, and from there to the second.
    along: [f64; 2],
}

impl Circle {
    fn outward(&self, angle: f64) -> Vector3<f64> {
        self.axes[1] * angle.cos() + self.axes[2] * angle.sin()
    }
}

struct Surface<'a> {
    spheres: &'a [Sphere],
    /// For each ball, those that a probe can touch together with it.
    neighbours: Vec<Vec<usize>>,
    probe: f64,
    /// Distance between dots.
    step: f64,
}

impl<'a> Surface<'a> {
    fn new(spheres: &'a [Sphere], probe: f64, density: f64) -> Self {
        let radii = spheres.iter().map(|sphere| sphere.radius);
        let largest = radii.fold(0.0, f64::max) + probe;
        let members = spheres.iter().enumerate().map(|(item, sphere)| Member {
            position: sphere.center.into(),
            item,
        });
        let cells = CellList::new(members.collect(), largest.max(1.0));
        let neighbours = spheres.iter().enumerate().map(|(index, sphere)| {
            let mut found = Vec::new();
            let reach = sphere.radius + probe + largest;
            cells.visit_within(sphere.center.into(), reach, |&other, square| {
                let touch = sphere.radius + spheres[other].radius + 2.0 * probe;
                if other != index && square < touch * touch {
                    found.push(other);
                }
            });
            found.sort_unstable();
            found
        });
        Self {
            neighbours: neighbours.collect(),
            spheres,
            probe,
            step: density.sqrt().recip(),
        }
    }

    /// Distance from a ball of the centres of probes that touch it.
    fn grown(&self, index: usize) -> f64 {
        self.spheres[index].radius + self.probe
    }

    /// Whether no ball but those that it touches keeps a probe from a place.
    fn is_free(&self, at: Vector3<f64>, near: usize, touched: &[usize]) -> bool {
        let holds = |&other: &usize| {
            let grown = self.grown(other) - SLACK;
            (at - self.spheres[other].center).norm_squared() < grown * grown
        };
        let others = self.neighbours[near].iter();
        !others.filter(|other| !touched.contains(other)).any(holds)
    }

    fn has_dots(&self, indices: &[usize]) -> bool {
        indices.iter().any(|&index| self.spheres[index].has_dots)
    }

    /// Dots on the balls themselves.
    fn convex(&self) -> Vec<SurfaceDot> {
        let mut dots = Vec::new();
        let spheres = self.spheres.iter().enumerate();
        for (index, sphere) in spheres.filter(|(_, one)| one.has_dots) {
            let area = 4.0 * std::f64::consts::PI * sphere.radius * sphere.radius;
            for direction in spiral(count(area / (self.step * self.step))) {
                let normal = Vector3::from(direction);
                if self.is_free(sphere.center + normal * self.grown(index), index, &[index]) {
                    dots.push(SurfaceDot {
                        at: sphere.center + normal * sphere.radius,
                        normal,
                    });
                }
            }
        }
        dots
    }

    /// Pairs of balls that a probe can touch together, with the circle of its centres.
    fn circles(&self) -> impl Iterator<Item = ([usize; 2], Circle)> {
        let pairs = (0..self.spheres.len()).flat_map(|first| {
            let neighbours = self.neighbours[first].iter();
            let after = neighbours.filter(move |&&other| other > first);
            after.map(move |&second| [first, second])
        });
        pairs.filter_map(|pair| Some((pair, self.circle(pair)?)))
    }

    fn circle(&self, [first, second]: [usize; 2]) -> Option<Circle> {
        let [one, other] = [first, second].map(|index| self.spheres[index].center);
        let between = other - one;
        let distance = between.norm();
        let [r, s] = [first, second].map(|index| self.grown(index));
        if distance < SLACK {
            return None;
        }
        let along = (distance * distance + r * r - s * s) / (2.0 * distance);
        let square = r * r - along * along;
        if square <= 0.0 {
            return None;
        }
        let axis = between / distance;
        let across = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
        Some(Circle {
            center: one + axis * along,
            radius: square.sqrt(),
            axes: [axis, across, axis.cross(&across)],
            along: [along, distance - along],
        })
    }

    /// Dots on the saddles between two balls.
    fn saddles(&self) -> Vec<SurfaceDot> {
        let mut dots = Vec::new();
        for (pair, circle) in self.circles().filter(|(pair, _)| self.has_dots(pair)) {
            // Seen from the probe, from its contact with the one ball to that with the other.
            let from = -(circle.along[0] / self.grown(pair[0])).asin();
            let to = (circle.along[1] / self.grown(pair[1])).asin();
            let rings = count(self.probe * (to - from) / self.step);
            for ring in 0..rings {
                let angle = from + (to - from) * (ring as f64 + 0.5) / rings as f64;
                let radius = circle.radius - self.probe * angle.cos();
                // Nearer to the axis than this, another place of the probe reaches it.
                if radius <= 0.0 {
                    continue;
                }
                let around = count(std::f64::consts::TAU * radius / self.step);
                for place in 0..around {
                    let turn = std::f64::consts::TAU * (place as f64 + 0.5) / around as f64;
                    let outward = circle.outward(turn);
                    let center = circle.center + outward * circle.radius;
                    if self.is_free(center, pair[0], &pair) {
                        let normal = outward * angle.cos() - circle.axes[0] * angle.sin();
                        dots.push(SurfaceDot {
                            at: center - normal * self.probe,
                            normal,
                        });
                    }
                }
            }
        }
        dots
    }

    /// The probes that touch three balls and are free of all others.
    fn probes(&self) -> Vec<Probe> {
        let mut probes = Vec::new();
        for (pair, circle) in self.circles() {
            let third = self.neighbours[pair[1]].iter().filter(|&&third| {
                third > pair[1] && self.neighbours[pair[0]].binary_search(&third).is_ok()
            });
            for &third in third.filter(|&&third| self.has_dots(&[pair[0], pair[1], third])) {
                let touched = [pair[0], pair[1], third];
                let to = self.spheres[third].center - circle.center;
                let (a, b) = (to.dot(&circle.axes[1]), to.dot(&circle.axes[2]));
                let grown = self.grown(third);
                let along = (circle.radius.powi(2) + to.norm_squared() - grown * grown)
                    / (2.0 * circle.radius);
                let across = a.hypot(b);
                if along.abs() >= across {
                    continue;
                }
                let (middle, half) = (b.atan2(a), (along / across).acos());
                for angle in [middle - half, middle + half] {
                    let at = circle.center + circle.outward(angle) * circle.radius;
                    if self.is_free(at, pair[0], &touched) {
                        probes.push(Probe { at, touched });
                    }
                }
            }
        }
        probes
    }

    /// Dots on the probes, between the points at which each touches its three balls.
    fn triangles(&self, probes: &[Probe]) -> Vec<SurfaceDot> {
        let area = 4.0 * std::f64::consts::PI * self.probe * self.probe;
        let directions = spiral(count(area / (self.step * self.step))).into_iter();
        let directions: Vec<Vector3<f64>> = directions.map(Vector3::from).collect();
        let mut dots = Vec::new();
        for probe in probes {
            let touched = probe.touched;
            let [a, b, c] = touched.map(|index| self.spheres[index].center - probe.at);
            let sign = a.dot(&b.cross(&c)).signum();
            let sides = [b.cross(&c), c.cross(&a), a.cross(&b)].map(|side| side * sign);
            let is_inside =
                |direction: &&Vector3<f64>| sides.iter().all(|side| side.dot(direction) > 0.0);
            let inside = directions.iter().filter(is_inside);
            dots.extend(inside.map(|direction| SurfaceDot {
                at: probe.at + direction * self.probe,
                normal: -direction,
            }));
        }
        dots
    }
}

/// A number of dots, one at least.
fn count(wanted: f64) -> usize {
    (wanted.ceil() as usize).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn spheres(balls: &[([f64; 3], f64)]) -> Vec<Sphere> {
        let sphere = |&(center, radius): &([f64; 3], f64)| Sphere {
            center: Vector3::from(center),
            radius,
            has_dots: true,
        };
        balls.iter().map(sphere).collect()
    }

    /// Area by the number of dots.
    fn area(balls: &[([f64; 3], f64)], probe: f64) -> f64 {
        let density = 400.0;
        surface_dots(&spheres(balls), probe, density).len() as f64 / density
    }

    /// Two equal balls: caps of height r + z on each, and a saddle whose area is 2 pi (p t T - 2 p^2 sin(T/2)). Here t
    /// is the radius of the probe's circle and T the angle that the probe sweeps.
    #[test]
    fn areas_are_those_of_closed_forms() {
        let (r, p) = (1.7_f64, 1.5_f64);
        assert!((area(&[([0.0; 3], r)], p) / (4.0 * PI * r * r) - 1.0).abs() < 0.005);
        let half = 1.4;
        let sine = half / (r + p);
        let t = (r + p) * (1.0 - sine * sine).sqrt();
        let sweep = 2.0 * sine.asin();
        let saddle = 2.0 * PI * (p * t * sweep - 2.0 * p * p * sine);
        let caps = 2.0 * 2.0 * PI * r * (r + r * sine);
        let found = area(&[([-half, 0.0, 0.0], r), ([half, 0.0, 0.0], r)], p);
        assert!(
            (found / (saddle + caps) - 1.0).abs() < 0.01,
            "{found} {}",
            saddle + caps
        );
    }

    /// Three touching balls: every dot is a probe's radius from a free place of the probe and inside none. Each of the
    /// two probes on top of them has a triangle, whose area is that of its angles.
    #[test]
    fn dots_lie_where_the_probe_touches() {
        let (r, p) = (1.7, 1.5);
        let height = 3.0_f64.sqrt() * r;
        let balls = [
            ([0.0; 3], r),
            ([2.0 * r, 0.0, 0.0], r),
            ([r, height, 0.0], r),
        ];
        let spheres = spheres(&balls);
        let dots = surface_dots(&spheres, p, 60.0);
        for dot in &dots {
            assert!((dot.normal.norm() - 1.0).abs() < 1e-9);
            let probe = dot.at + dot.normal * p;
            for sphere in &spheres {
                let distance = (probe - sphere.center).norm();
                assert!(distance > sphere.radius + p - 1e-6, "{distance}");
                assert!((dot.at - sphere.center).norm() > sphere.radius - 1e-6);
            }
        }
        let surface = Surface::new(&spheres, p, 400.0);
        let probes = surface.probes();
        assert_eq!(probes.len(), 2);
        let corners = spheres
            .iter()
            .map(|sphere| (sphere.center - probes[0].at).normalize());
        let [a, b, c]: [Vector3<f64>; 3] = corners.collect::<Vec<_>>().try_into().unwrap();
        // Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125-126.
        let solid =
            2.0 * (a.dot(&b.cross(&c)).abs()).atan2(1.0 + a.dot(&b) + b.dot(&c) + c.dot(&a));
        let found = surface.triangles(&probes[..1]).len() as f64 / 400.0;
        assert!(
            (found / (solid * p * p) - 1.0).abs() < 0.02,
            "{found} {}",
            solid * p * p
        );
    }
}
