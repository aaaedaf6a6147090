//! Contact, distance and shared region of two meshes at a pose, beside sums over all pairs of triangles and points.
#![cfg(feature = "mesh")]

use crate::solids::{Surface, cuboid, scattered, sphere};
use knotdock_structures::ball_solid::Motion;
use knotdock_structures::mesh::{
    ExactSolid, Indefinite, MeshContact, SharedRegion, SharedRegions, Solid, SurfacePairs,
};

/// A rotation of no special direction, and a shift.
fn motion(angle: f64, shift: [f64; 3]) -> Motion {
    let (s, c) = angle.sin_cos();
    let [x, y, z] = [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0];
    let t = 1.0 - c;
    Motion {
        rows: [
            [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
            [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
            [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
        ],
        shift,
    }
}

fn inverse(motion: &Motion) -> Motion {
    let rows = [0, 1, 2].map(|column| motion.rows.map(|row| row[column]));
    let back = Motion {
        rows,
        shift: [0.0; 3],
    };
    Motion {
        rows,
        shift: back.apply(motion.shift).map(|part| -part),
    }
}

/// A peanut, not convex, and of another unit than the box that it meets.
fn peanut() -> Solid {
    let waist = |[x, y, z]: [f64; 3]| {
        let share = 0.4 + 0.6 * x * x;
        [3.0 * x, 1.2 * share * y, 1.2 * share * z]
    };
    sphere([0.0; 3], 1.0, 16).mapped(waist).solid()
}

fn exact(solid: &Solid) -> ExactSolid {
    ExactSolid::new(solid).unwrap()
}

/// Shared volume by points, and its standard error.
fn by_points([a, b]: [&Solid; 2], motion: &Motion) -> [f64; 2] {
    let back = inverse(motion);
    let half = a.half_sides();
    let frames = [a.frame().unit, b.frame().unit];
    let count = 40_000;
    let inside = scattered(count, 1.0)
        .map(|point| [0, 1, 2].map(|axis| point[axis] * half[axis]))
        .filter(|&point| a.is_inside(point))
        .map(|point| back.apply(point.map(|x| x * frames[0])))
        .filter(|point| b.is_inside(point.map(|x| x / frames[1])))
        .count();
    let share = inside as f64 / count as f64;
    let whole = half
        .iter()
        .map(|side| 2.0 * side * frames[0])
        .product::<f64>();
    let error = (share * (1.0 - share) / count as f64).sqrt();
    [share * whole, error * whole]
}

#[test]
fn the_shared_region_and_its_slopes() {
    let (first, second) = (
        peanut(),
        cuboid([-0.5, -0.7, -0.6], [0.5, 0.7, 0.6]).solid(),
    );
    let solids = [&exact(&first), &exact(&second)];
    let mut regions = SharedRegions::default();
    let mut at = |motion: &Motion| -> SharedRegion { regions.at(solids, motion, 0.0).unwrap() };
    let mut met = 0;
    for step in 0..24 {
        let part = |by: f64| 2.0 * (f64::from(step) * by).fract() - 1.0;
        let place = [3.0 * part(0.8191), 1.2 * part(0.671), 1.3 * part(0.5497)];
        let motion = motion(f64::from(step), place);
        let found = at(&motion);
        let [volume, error] = by_points([&first, &second], &motion);
        assert!(
            (found.volume - volume).abs() <= 5.0 * error + 1e-3,
            "{step} {found:?} {volume}"
        );
        assert!(found.bound < 1e-10);
        // The other way round it is the same, with the opposite slope.
        let [a, b] = solids;
        let back = regions_of([b, a], &inverse(&motion));
        assert!((back.volume - found.volume).abs() < 1e-12);
        let force = Motion {
            shift: [0.0; 3],
            ..motion
        }
        .apply(back.by_shift);
        let off = (0..3).map(|axis| (force[axis] + found.by_shift[axis]).abs());
        assert!(off.fold(0.0, f64::max) < 1e-12, "{step}");
        let h = 1e-5;
        for axis in 0..3 {
            let mut by = [0.0; 3];
            by[axis] = h;
            let ahead = at(&motion.shifted(by));
            let behind = at(&motion.shifted(by.map(|part| -part)));
            let slope = (ahead.volume - behind.volume) / (2.0 * h);
            assert!((slope - found.by_shift[axis]).abs() < 1e-7, "{step} {axis}");
        }
        met += usize::from(found.volume > 0.0);
    }
    assert!((12..24).contains(&met), "{met}");
}

fn regions_of(solids: [&ExactSolid; 2], motion: &Motion) -> SharedRegion {
    SharedRegions::default().at(solids, motion, 0.0).unwrap()
}

#[test]
fn contact_and_distance_of_balls_of_triangles() {
    let ball = |radius: f64| sphere([0.0; 3], radius, 24).solid();
    let (first, second) = (ball(1.0), ball(0.5));
    let solids = [&exact(&first), &exact(&second)];
    let mut pairs = SurfacePairs::default();
    for step in 0..60 {
        let gap = 0.02 * f64::from(step - 30);
        let motion = motion(
            f64::from(step),
            [0.6, 0.0, 0.8].map(|part| part * (1.5 + gap)),
        );
        let found = pairs.contact(solids, &motion, [0.0; 2], || false);
        // Facets are within 1% of the radius of their sphere.
        if gap.abs() > 0.015 {
            assert_eq!(found == MeshContact::Met, gap < 0.0, "{gap}");
        }
        if found == MeshContact::Apart {
            let closest = pairs.closest(solids, &motion, [9.0, 0.0]).unwrap();
            assert!(closest.low <= closest.high && closest.high - closest.low < 1e-7);
            assert!(
                (gap..gap + 0.02).contains(&closest.high),
                "{gap} {closest:?}"
            );
            for (margin, expected) in [(0.99, MeshContact::Apart), (1.01, MeshContact::Met)] {
                let lengths = [margin * closest.high, 0.0];
                assert_eq!(pairs.contact(solids, &motion, lengths, || false), expected);
            }
        }
    }
    // One within the other, far inside its surface.
    let inside = pairs.contact(solids, &motion(1.0, [0.1, 0.1, 0.2]), [0.0; 2], || false);
    assert_eq!(inside, MeshContact::Met);
}

#[test]
fn open_and_crossing_meshes_are_refused() {
    let block = cuboid([-1.0; 3], [1.0; 3]);
    let mut open = block.clone();
    open.triangles.pop();
    let crossing = block.clone().and(
        &block
            .clone()
            .mapped(|[x, y, z]| [x + 1.0, y + 0.3, z + 0.2]),
    );
    let smaller = block.clone().mapped(|at| at.map(|x| 0.5 * x));
    let nested = block.clone().and(&smaller);
    let hollow = block.clone().and(&smaller.inverted());
    let apart = block
        .clone()
        .and(&block.mapped(|[x, y, z]| [x + 3.0, y, z]));
    for (surface, expected) in [
        (open, Some(Indefinite::NotClosed)),
        (crossing, Some(Indefinite::CrossesItself)),
        (nested, Some(Indefinite::Nested)),
        (hollow, None),
        (apart, None),
    ] {
        let surface: Surface = surface;
        assert_eq!(ExactSolid::new(&surface.solid()).err(), expected);
    }
}
