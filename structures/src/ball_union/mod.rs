//! Volumes of unions of balls, and of the intersection of two such unions.
//!
//! Each ball of a union owns the points for which its power, |x - c|^2 - r^2, is the least: its cell of the power
//! diagram, a convex polyhedron. The union is the sum of the balls' parts in their own cells (`cell`), so volumes are
//! exact but for rounding (Edelsbrunner, "The union of balls and its dual shape", Discrete Comput. Geom. 13, 1995).
//!
//! Two unions share what cells lose: V(A) + V(B) - V(A or B), ball by ball. Balls that do not meet the other union
//! take no part, a ball inside one of the other union counts in full, and two balls that meet no further one share a
//! lens ([`lens_volume`]).
//!
//! Volumes are in the cube of the balls' unit; weights play no part. A ball takes O(f n) time for f faces and n balls
//! that meet it.

mod cell;
mod lens;

use std::f64::consts::PI;

use crate::ball::{Ball, largest_first};
use crate::knots::Knots;
use crate::neighbours::box_tree::{BoxNode, LEAF, box_tree};
use crate::vector::{compare, distance, dot, norm, subtract};
use cell::{Cell, Plane};
pub use lens::lens_volume;

/// A volume and a bound of its error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Volume {
    /// The volume.
    pub value: f64,
    /// The true volume differs by no more than this.
    pub error: f64,
}

/// Volumes of two unions of balls and of their intersection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Of the first.
    pub first: f64,
    /// Of the second.
    pub second: f64,
    /// Of the intersection.
    pub shared: f64,
    /// Bound of the error of each.
    pub error: f64,
}

impl Overlap {
    /// Tanimoto similarity of the two: the shared volume over that of both together, 0 to 1.
    pub fn tanimoto(&self) -> f64 {
        self.shared / (self.first + self.second - self.shared)
    }

    /// Share of the smaller one that lies outside the other, 0 to 1.
    pub fn protrusion(&self) -> f64 {
        1.0 - self.shared / self.first.min(self.second)
    }
}

/// Volume of the union of balls.
pub fn union_volume(balls: &Knots) -> Volume {
    volume_of_union(&balls_of(balls))
}

/// As [`union_volume`], of a list.
pub fn volume_of_union(balls: &[Ball]) -> Volume {
    let balls = Arrangement::new([balls, &[]]);
    let (mut cell, mut meeting) = (Cell::default(), Meeting::default());
    let mut sum = Volume::default();
    for (number, ball) in balls.balls.iter().enumerate() {
        balls.find(number, &mut meeting);
        if meeting.own.covered {
            continue;
        }
        cell.reset();
        meeting.own.cut(&mut cell);
        sum.add(part(ball, &mut cell, &[&meeting.own]), 1.0);
    }
    sum
}

/// Volumes of two unions of balls, in one frame, and of their intersection.
pub fn overlap(first: &Knots, second: &Knots) -> Overlap {
    let [a, b] = [balls_of(first), balls_of(second)];
    let [one, other] = [&a, &b].map(|balls| volume_of_union(balls));
    let shared = shared_volume(&a, &b);
    Overlap {
        first: one.value,
        second: other.value,
        shared: shared.value.min(one.value).min(other.value),
        error: one.error.max(other.error).max(shared.error),
    }
}

/// Volume that two unions of balls share, in one frame. Exchanging the two changes no bit.
pub fn shared_volume(first: &[Ball], second: &[Ball]) -> Volume {
    let balls = Arrangement::new([first, second]);
    let (mut cell, mut meeting) = (Cell::default(), Meeting::default());
    let mut sums = [Volume::default(); 2];
    for (number, ball) in balls.balls.iter().enumerate() {
        let sum = &mut sums[usize::from(number >= balls.split)];
        balls.find(number, &mut meeting);
        let other = meeting.other.last;
        match meeting.other.count {
            0 => {}
            // The other half comes with the other ball.
            1 if balls.partners(other) == 1 => sum.add(lens(ball, &balls.balls[other]), 0.5),
            _ => add_lost(ball, &mut meeting, &mut cell, sum),
        }
    }
    let [one, other] = sums;
    let mut sum = Volume {
        value: (one.value + other.value).max(0.0),
        error: one.error + other.error,
    };
    if sum.error > CLEAR * sum.value {
        let [a, b] = [first, second].map(volume_of_union);
        let most = (a.value + a.error).min(b.value + b.error);
        let (low, high) = ((sum.value - sum.error).max(0.0), sum.value + sum.error);
        let high = high.min(most).max(low);
        sum = Volume {
            value: 0.5 * (low + high),
            error: 0.5 * (high - low),
        };
    }
    sum
}

/// Planes that are sorted at first; then twice as many each time.
const SORTED_FIRST: usize = 8;
/// Share of a volume from which its error is held against the volumes of both unions.
const CLEAR: f64 = 1e-3;
/// Rounding of one term of a cell's volume, in cubes of the ball's radius.
const ROUNDING: f64 = 1e-15;

fn balls_of(balls: &Knots) -> Vec<Ball> {
    let balls = balls.centers.iter().zip(&balls.radii);
    balls
        .map(|(&center, &radius)| Ball::new(center, radius))
        .collect()
}

fn lens(a: &Ball, b: &Ball) -> Volume {
    let distance = distance(a.center, b.center);
    let (larger, smaller) = (a.radius.max(b.radius), a.radius.min(b.radius));
    let value = lens_volume(a.radius, b.radius, distance);
    // The distance of the centres is rounded; the lens changes by at most the smaller great disc for each unit.
    let edge = 4.0 * f64::EPSILON * (distance + larger) * PI * smaller * smaller;
    let is_inside = distance <= larger - smaller;
    let error = if is_inside { 0.0 } else { edge };
    Volume {
        value,
        error: error.min(ball_volume(smaller)) + 8.0 * f64::EPSILON * value,
    }
}

fn ball_volume(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

impl Volume {
    fn add(&mut self, other: Self, factor: f64) {
        self.value += factor * other.value;
        self.error += factor.abs() * other.error + f64::EPSILON * self.value.abs();
    }
}

/// How one ball cuts the cell of another.
enum Cut {
    /// Not within that ball.
    Without,
    /// Nothing of that ball is left.
    Covered,
    /// The two are the same.
    Same,
    /// By the plane of equal power, relative to that ball's centre and radius.
    Plane(Plane),
}

/// How `other`, which meets `ball`, cuts its cell.
fn cut(ball: &Ball, other: &Ball) -> Cut {
    let arm = subtract(other.center, ball.center);
    let distance = norm(arm);
    let (r, s) = (ball.radius, other.radius);
    if distance == 0.0 {
        return match s.total_cmp(&r) {
            std::cmp::Ordering::Less => Cut::Without,
            std::cmp::Ordering::Equal => Cut::Same,
            std::cmp::Ordering::Greater => Cut::Covered,
        };
    }
    // (d^2 + r^2 - s^2) / 2 d, without a difference of squares.
    let twice = if s > r {
        (distance - s) * (1.0 + s / distance) + r * (r / distance)
    } else {
        distance + (r - s) * ((r + s) / distance)
    };
    let offset = 0.5 * twice / r;
    if offset >= 1.0 {
        Cut::Without
    } else if offset <= -1.0 {
        Cut::Covered
    } else {
        let normal = arm.map(|part| part / distance);
        Cut::Plane(Plane { normal, offset })
    }
}

/// How the balls of one union cut the cell of a ball.
#[derive(Default)]
struct Cuts {
    /// How many there are, and the last of them.
    count: usize,
    last: usize,
    planes: Vec<Plane>,
    /// Whether one holds the ball.
    covered: bool,
    /// Whether one is the ball.
    same: bool,
    /// Radius of the largest one, in radii of the ball: the rounding of a plane's place is in proportion to it.
    largest: f64,
}

impl Cuts {
    fn clear(&mut self) {
        let mut planes = std::mem::take(&mut self.planes);
        planes.clear();
        *self = Self {
            planes,
            ..Self::default()
        };
    }

    fn take(&mut self, ball: &Ball, other: &Ball, number: usize) {
        self.count += 1;
        self.last = number;
        match cut(ball, other) {
            Cut::Without => {}
            Cut::Covered => self.covered = true,
            Cut::Same => self.same = true,
            Cut::Plane(plane) => {
                self.planes.push(plane);
                self.largest = self.largest.max(other.radius / ball.radius);
            }
        }
    }

    /// Cuts a cell; whether any plane took something away. The plane that cuts deepest comes first, so the order does
    /// not depend on that of the balls, and planes beyond all vertices are never sorted.
    fn cut(&mut self, cell: &mut Cell) -> bool {
        let order = |a: &Plane, b: &Plane| {
            (a.offset.total_cmp(&b.offset)).then_with(|| compare(a.normal, b.normal))
        };
        let mut any = false;
        let (mut rest, mut sorted) = (&mut self.planes[..], SORTED_FIRST);
        while !rest.is_empty() && !cell.is_empty() {
            let reach = cell.reach();
            let count = sorted.min(rest.len());
            if count < rest.len() {
                rest.select_nth_unstable_by(count - 1, order);
            }
            let (now, later) = rest.split_at_mut(count);
            now.sort_unstable_by(order);
            for plane in now {
                if plane.offset >= reach {
                    return any;
                }
                any |= cell.cut(plane);
            }
            rest = later;
            sorted *= 2;
        }
        any
    }
}

/// Balls that meet one, of the same union and of the other.
#[derive(Default)]
struct Meeting {
    own: Cuts,
    other: Cuts,
}

/// One or two unions of balls, each sorted and without copies, and a tree over all balls.
struct Arrangement {
    balls: Vec<Ball>,
    /// Number of the first ball of the second union.
    split: usize,
    /// The balls with their numbers, in the order of the tree.
    members: Vec<(Ball, usize)>,
    /// Nodes that know the largest radius.
    nodes: Vec<BoxNode<f64>>,
}

impl Arrangement {
    fn new([first, second]: [&[Ball]; 2]) -> Self {
        let [mut balls, second] = [first, second].map(|balls| {
            // No zero has a sign, so that equal balls have equal bits.
            let mut balls: Vec<Ball> = balls.to_vec();
            for ball in &mut balls {
                ball.center = ball.center.map(|part| part + 0.0);
            }
            balls.sort_unstable_by(largest_first);
            balls.dedup();
            balls
        });
        let split = balls.len();
        balls.extend(second);
        let numbered = balls.iter().copied().zip(0..);
        let mut members: Vec<(Ball, usize)> = numbered.collect();
        let place = |(ball, number): &(Ball, usize)| (ball.center, *number);
        let largest = |members: &[(Ball, usize)]| {
            let radii = members.iter().map(|(ball, _)| ball.radius);
            radii.fold(0.0, f64::max)
        };
        let nodes = box_tree(&mut members, LEAF, place, largest);
        Self {
            balls,
            split,
            members,
            nodes,
        }
    }

    fn together(&self, one: usize, other: usize) -> bool {
        (one < self.split) == (other < self.split)
    }

    fn visit_meeting(&self, number: usize, mut visit: impl FnMut(&Ball, usize)) {
        let ball = &self.balls[number];
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            let beyond = [0, 1, 2].map(|axis| {
                let place = ball.center[axis];
                (node.low[axis] - place)
                    .max(place - node.high[axis])
                    .max(0.0)
            });
            if !within(beyond, ball.radius + node.known) {
                at = self.after(at);
                continue;
            }
            if node.second == 0 {
                for (other, name) in &self.members[node.first..node.first + node.count] {
                    let away = subtract(other.center, ball.center);
                    let meets = within(away, ball.radius + other.radius);
                    if meets && *name != number {
                        visit(other, *name);
                    }
                }
            }
            // The first half follows its node.
            at += 1;
        }
    }

    /// The node after all that are below one.
    fn after(&self, at: usize) -> usize {
        let mut last = at;
        while self.nodes[last].second > 0 {
            last = self.nodes[last].second;
        }
        last + 1
    }

    /// Finds what meets a ball.
    fn find(&self, number: usize, meeting: &mut Meeting) {
        let Meeting { own, other } = meeting;
        own.clear();
        other.clear();
        let ball = &self.balls[number];
        self.visit_meeting(number, |with, name| {
            let cuts = match self.together(number, name) {
                true => &mut *own,
                false => &mut *other,
            };
            cuts.take(ball, with, name);
        });
    }

    /// Number of balls of the other union that meet one.
    fn partners(&self, number: usize) -> usize {
        let mut count = 0;
        self.visit_meeting(number, |_, name| {
            count += usize::from(!self.together(number, name));
        });
        count
    }
}

fn within(vector: [f64; 3], reach: f64) -> bool {
    dot(vector, vector) < reach * reach
}

fn part(ball: &Ball, cell: &mut Cell, cuts: &[&Cuts]) -> Volume {
    let cube = ball.radius.powi(3);
    let blur = |cuts: &&Cuts| 4.0 * cuts.planes.len() as f64 * (1.0 + cuts.largest);
    let blur: f64 = cuts.iter().map(blur).sum();
    Volume {
        value: cube * cell.volume().clamp(0.0, ball_volume(1.0)),
        error: cube * ROUNDING * (8.0 + cell.edges() as f64 + blur),
    }
}

/// Adds the part of a ball that its cell loses to the other union. Of a ball that is in both unions each copy gets half
/// of the cell.
fn add_lost(ball: &Ball, Meeting { own, other }: &mut Meeting, cell: &mut Cell, sum: &mut Volume) {
    if own.covered {
        return;
    }
    cell.reset();
    own.cut(cell);
    if other.covered {
        return sum.add(part(ball, cell, &[own]), 1.0);
    }
    let before = part(ball, cell, &[own]);
    if other.cut(cell) || other.same {
        let left = if other.same { 0.5 } else { 1.0 };
        sum.add(before, 1.0);
        sum.add(part(ball, cell, &[own, other]), -left);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn knots(list: &[([f64; 3], f64)]) -> Knots {
        let (centers, radii) = list.iter().copied().unzip();
        Knots::new(centers, radii).unwrap()
    }

    fn balls(list: &[([f64; 3], f64)]) -> Vec<Ball> {
        let balls = list.iter();
        balls
            .map(|&(center, radius)| Ball { center, radius })
            .collect()
    }

    /// Numbers from 0 to 1, the same in every run.
    fn random() -> impl FnMut() -> f64 {
        let mut state = 1u64;
        move || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    fn holds(volume: Volume, exact: f64) -> bool {
        (volume.value - exact).abs() <= volume.error + 1e-15 * exact
    }

    #[test]
    fn one_ball_anywhere_and_of_any_size() {
        for (center, radius) in [
            ([0.0; 3], 1.0),
            ([1e6, -1e6, 3.3], 1.7),
            ([0.1; 3], 1e-9),
            ([0.0; 3], 1e30),
        ] {
            let volume = union_volume(&knots(&[(center, radius)]));
            assert!(holds(volume, ball_volume(radius)), "{volume:?}");
            assert!(volume.error < 1e-13 * volume.value);
        }
    }

    #[test]
    fn two_balls_share_a_lens() {
        for (r, s, d) in [(1.0, 1.0, 0.5), (1.8, 1.4, 2.0), (3.0, 1.0, 2.5)] {
            let at = [0.6 * d + 0.3, 0.2, 0.8 * d - 7.0];
            let (a, b) = (knots(&[([0.3, 0.2, -7.0], r)]), knots(&[(at, s)]));
            let found = overlap(&a, &b);
            let exact = lens_volume(r, s, d);
            assert!((found.shared - exact).abs() < 1e-13, "{found:?} {exact}");
            let both = ball_volume(r) + ball_volume(s) - exact;
            assert!((found.tanimoto() - exact / both).abs() < 1e-12);
            let least = ball_volume(r.min(s));
            assert!((found.protrusion() - (1.0 - exact / least)).abs() < 1e-12);
            let union = union_volume(&knots(&[([0.3, 0.2, -7.0], r), (at, s)]));
            assert!(holds(union, both), "{union:?} {both}");
        }
    }

    #[test]
    fn copies_and_balls_inside_add_nothing() {
        let outer = ([0.0; 3], 2.0);
        let many = [outer, outer, ([0.5, 0.0, 0.0], 1.0), ([1e-15; 3], 2.0)];
        assert!(holds(union_volume(&knots(&many)), ball_volume(2.0)));
        let same = overlap(&knots(&many), &knots(&many));
        assert!((same.tanimoto() - 1.0).abs() < 1e-12);
        assert!(same.protrusion().abs() < 1e-12);
        assert!(holds(
            shared_volume(&balls(&many), &balls(&[outer])),
            ball_volume(2.0)
        ));
    }

    /// Small balls in a large one and across its sphere: the error is small beside the small ones.
    #[test]
    fn balls_of_very_different_size() {
        let large = balls(&[([0.0; 3], 1000.0)]);
        for (small, exact) in [
            (vec![([999.0, 0.0, 0.0], 0.001)], ball_volume(0.001)),
            (
                vec![([999.0, 0.0, 0.0], 0.001), ([0.0, 999.0, 0.0], 0.001)],
                2.0 * ball_volume(0.001),
            ),
            (
                vec![([1000.0, 0.0, 0.0], 0.001)],
                lens_volume(1000.0, 0.001, 1000.0),
            ),
            (
                vec![([1000.0, 0.0, 0.0], 1.0), ([0.0, 0.0, 1000.0], 1.0)],
                2.0 * lens_volume(1000.0, 1.0, 1000.0),
            ),
        ] {
            let found = shared_volume(&large, &balls(&small));
            assert!(holds(found, exact), "{found:?} {exact}");
            assert!(found.error < 1e-4 * exact, "{found:?}");
        }
    }

    /// A pose at the other end of the world costs no more than one beside it.
    #[test]
    fn far_sets_share_nothing() {
        let found = overlap(
            &knots(&[([0.0; 3], 1.5)]),
            &knots(&[([1e9, 5.0, 0.0], 1.5)]),
        );
        assert_eq!(found.shared, 0.0);
        assert_eq!((found.tanimoto(), found.protrusion()), (0.0, 1.0));
        assert!((found.first - ball_volume(1.5)).abs() < found.error);
    }

    /// A ball that meets no other ball of its union shares one lens with each ball of the other union. On a lattice, at
    /// poses of high symmetry, planes coincide and meet in one point.
    #[test]
    fn unions_of_separate_balls_share_lenses() {
        let mut random = random();
        let mut shared = 0;
        for case in 0..400 {
            let on_lattice = case % 2 == 0;
            let mut list = |shift: [f64; 3], radius: f64| -> Vec<Ball> {
                let places = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]);
                let ball = |place: [i32; 3]| {
                    let noise = if on_lattice { 0.0 } else { 0.1 };
                    let center = [0, 1, 2]
                        .map(|axis| 2.4 * f64::from(place[axis]) + shift[axis] + noise * random());
                    Ball { center, radius }
                };
                places.map(ball).collect()
            };
            let quarter = |i: i32| 0.3 * f64::from(i);
            let first = list([0.0; 3], 1.1);
            let shift = [
                quarter(case % 7),
                quarter(case / 7 % 7),
                quarter(case / 49 % 7),
            ];
            let second = list(shift, [1.1, 0.5, 1.0][case as usize % 3]);
            let pairs = first.iter().flat_map(|a| {
                let lenses = second
                    .iter()
                    .map(|b| lens_volume(a.radius, b.radius, distance(a.center, b.center)));
                lenses.collect::<Vec<_>>()
            });
            let exact: f64 = pairs.sum();
            let found = shared_volume(&first, &second);
            assert!(holds(found, exact), "{case}: {found:?} {exact}");
            assert!(found.error <= 1e-9 * found.value, "{case}: {found:?}");
            shared += i32::from(exact > 0.0);
        }
        assert!(shared > 350);
    }

    /// Random unions, and symmetric ones at symmetric poses, against points thrown at random (fixed seed), to five
    /// standard errors. To exchange the unions changes no bit, and to turn both changes last digits.
    #[test]
    fn unions_against_random_points_and_turned() {
        let mut random = random();
        for case in 0..60 {
            let symmetric = case % 2 == 0;
            let mut list = |count: usize| -> Vec<Ball> {
                let ball = |_| {
                    let (center, radius) = ([0; 3].map(|_| 4.0 * random() - 2.0), 0.3 + random());
                    match symmetric {
                        true => Ball::new(center.map(f64::round), (2.0 * radius).ceil() / 2.0),
                        false => Ball { center, radius },
                    }
                };
                (0..count).map(ball).collect()
            };
            let first = list(1 + case % 50);
            let mut second = match case % 4 {
                0 => first.clone(),
                _ => list(1 + 7 * case % 50),
            };
            for ball in &mut second {
                ball.center = [ball.center[1] + 1.0, -ball.center[0], ball.center[2]];
            }
            let found = shared_volume(&first, &second);
            assert_eq!(found, shared_volume(&second, &first), "{case}");
            let inside = |list: &[Ball], x: [f64; 3]| {
                list.iter().any(|ball| {
                    let square = (0..3).map(|k| (x[k] - ball.center[k]).powi(2));
                    square.sum::<f64>() < ball.radius * ball.radius
                })
            };
            let throws = 2000;
            let hits = (0..throws)
                .map(|_| [0; 3].map(|_| 8.0 * random() - 4.0))
                .filter(|&x| inside(&first, x) && inside(&second, x));
            let share = (hits.count() as f64 / f64::from(throws)).max(1.0 / f64::from(throws));
            let sigma = 512.0 * (share * (1.0 - share) / f64::from(throws)).sqrt();
            let off = (found.value - 512.0 * share).abs() - found.error;
            assert!(
                off < 5.0 * sigma,
                "{case}: {found:?} {} {sigma}",
                512.0 * share
            );
            let turned = [&first, &second].map(|list| {
                // By an angle of no symmetry, about x and about z.
                let (s, c) = 0.7f64.sin_cos();
                let turn = |[x, y, z]: [f64; 3]| [x, c * y - s * z, s * y + c * z];
                let ball = |ball: &Ball| {
                    let [x, y, z] = turn(ball.center);
                    let [z, x, y] = turn([z, x, y]);
                    Ball::new([x, y, z], ball.radius)
                };
                list.iter().map(ball).collect::<Vec<_>>()
            });
            let again = shared_volume(&turned[0], &turned[1]);
            let off = (again.value - found.value).abs();
            assert!(
                off <= again.error + found.error,
                "{case}: {found:?} {again:?}"
            );
        }
    }

    /// A sphere with many small balls on it: faces by the hundred.
    #[test]
    fn a_ball_with_many_faces() {
        let count = 400;
        let mut list = vec![([0.0; 3], 1.0)];
        // Far enough apart to be separate.
        list.extend((0..count).map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let turn = f64::from(i) * 2.399963229728653;
            let across = (1.0 - z * z).sqrt();
            ([across * turn.cos(), across * turn.sin(), z], 0.05)
        }));
        let beyond = ball_volume(0.05) - lens_volume(1.0, 0.05, 1.0);
        let exact = ball_volume(1.0) + f64::from(count) * beyond;
        let found = union_volume(&knots(&list));
        assert!((found.value - exact).abs() < 1e-12, "{found:?} {exact}");
        assert!(holds(found, exact) && found.error < 1e-10, "{found:?}");
    }

    #[test]
    fn no_balls_have_no_volume() {
        assert_eq!(volume_of_union(&[]), Volume::default());
        assert_eq!(
            shared_volume(&[], &balls(&[([0.0; 3], 1.0)])),
            Volume::default()
        );
        assert!((ball_volume(1.0) - 4.0 / 3.0 * PI).abs() < 1e-15);
    }
}
