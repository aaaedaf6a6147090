//! Which way bodies face, alone, nested, touching and there several times. In each test the volume is known by
//! hand, and must be both that of the report and the share of points that are inside.

#![cfg(feature = "mesh")]

use crate::solids::{Surface, cuboid, scattered, sphere};
use knotdock_structures::mesh::{MeshReport, Solid};

/// The report of a surface, after a check that its volume is the one expected, by both ways to measure it.
fn with_volume(surface: &Surface, expected: f64) -> MeshReport {
    let (mesh, report) = surface.mesh();
    assert!(
        (report.volume - expected).abs() < 1e-9 * expected.max(1.0),
        "reported {} for {expected}: {report:?}",
        report.volume
    );
    let solid = Solid::new(&mesh).unwrap();
    let half = solid.half_sides();
    let points = 6000;
    let inside = scattered(points, 1.0)
        .map(|point| [0, 1, 2].map(|axis| point[axis] * half[axis]))
        .filter(|point| solid.is_inside(*point))
        .count();
    let whole = half.iter().map(|half| 2.0 * half).product::<f64>() * solid.frame().unit.powi(3);
    let found = inside as f64 / points as f64 * whole;
    assert!(
        (found - expected).abs() < 0.02 * whole,
        "counted {found} for {expected}: {report:?}"
    );
    report
}

/// A cube of edge `edge` with its lowest corner at `low`.
fn cube(low: [f64; 3], edge: f64) -> Surface {
    cuboid(low, low.map(|x| x + edge))
}

fn mirrored(surface: &Surface) -> Surface {
    surface.clone().mapped(|[x, y, z]| [-x, y, z])
}

/// Every triangle of a surface as chance turns it.
fn jumbled(mut surface: Surface, seed: u32) -> Surface {
    let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(12345);
    for triangle in &mut surface.triangles {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        if state >> 31 == 1 {
            triangle.swap(0, 1);
        }
    }
    surface
}

/// The cube with the other diagonal on each face.
fn recut(low: [f64; 3], edge: f64) -> Surface {
    let mut surface = cube(low, edge);
    for pair in surface.triangles.chunks_mut(2) {
        let [a, b, c] = pair[0];
        let d = pair[1][2];
        pair.copy_from_slice(&[[a, b, d], [b, c, d]]);
    }
    surface
}

/// A half and its mirror image, made by a program that mirrors places but not the order of corners: the image faces
/// inward. The two were one surface by their shared edges, of volume 0, and only half of the solid was sampled,
/// without a warning.
#[test]
fn a_mirror_image_that_touches_its_original_is_turned() {
    let half = cube([-10.0, 0.0, 0.0], 10.0);
    let report = with_volume(&half.clone().and(&mirrored(&half)), 2000.0);
    assert!(report.is_closed() && !report.is_sound());
    assert_eq!((report.parts, report.inverted_parts), (2, 1));
    assert_eq!(report.triangles, 24);
    // Of another size, and with other diagonals on the wall.
    with_volume(
        &half
            .clone()
            .and(&cuboid([0.0; 3], [7.0, 10.0, 10.0]).inverted()),
        1700.0,
    );
    for (a, b) in [(true, false), (false, true), (true, true), (false, false)] {
        let mut original = recut([-10.0, 0.0, 0.0], 10.0);
        let mut image = cube([0.0; 3], 10.0);
        if a {
            original = original.inverted();
        }
        if b {
            image = image.inverted();
        }
        let report = with_volume(&original.and(&image), 2000.0);
        assert_eq!(report.inverted_parts, usize::from(a) + usize::from(b));
    }
    // Every triangle as chance has it.
    for seed in 0..8 {
        let report = with_volume(&jumbled(half.clone().and(&mirrored(&half)), seed), 2000.0);
        assert!(report.is_closed() && !report.is_sound());
    }
}

/// Bodies that touch and face outward are sound, and stay unchanged.
#[test]
fn bodies_that_touch_stay_as_they_are() {
    let at = |x: f64, y: f64, z: f64| cube([x, y, z], 1.0);
    for (surface, volume) in [
        (at(0.0, 0.0, 0.0).and(&at(1.0, 0.0, 0.0)), 2.0),
        (at(0.0, 0.0, 0.0).and(&at(1.0, 1.0, 0.0)), 2.0),
        (at(0.0, 0.0, 0.0).and(&at(1.0, 1.0, 1.0)), 2.0),
        (
            at(0.0, 0.0, 0.0)
                .and(&at(1.0, 1.0, 0.0))
                .and(&at(1.0, 0.0, 0.0)),
            3.0,
        ),
        (
            at(0.0, 0.0, 0.0)
                .and(&at(1.0, 0.0, 0.0))
                .and(&at(0.0, 1.0, 0.0))
                .and(&at(1.0, 1.0, 0.0)),
            4.0,
        ),
        (at(0.0, 0.0, 0.0).and(&recut([1.0, 0.0, 0.0], 1.0)), 2.0),
        // A core that fills the cavity of its coat.
        (
            cube([-1.0; 3], 3.0)
                .and(&at(0.0, 0.0, 0.0).inverted())
                .and(&at(0.0, 0.0, 0.0)),
            27.0,
        ),
        (
            cube([-1.0; 3], 3.0)
                .and(&at(0.0, 0.0, 0.0))
                .and(&at(0.0, 0.0, 0.0).inverted()),
            27.0,
        ),
        (
            cube([-1.0; 3], 3.0)
                .and(&at(0.0, 0.0, 0.0).inverted())
                .and(&recut([0.0; 3], 1.0)),
            27.0,
        ),
        (
            cube([-1.0; 3], 3.0)
                .and(&recut([0.0; 3], 1.0))
                .and(&at(0.0, 0.0, 0.0).inverted()),
            27.0,
        ),
    ] {
        let (mesh, _) = surface.mesh();
        let report = with_volume(&surface, volume);
        assert!(report.is_sound(), "{:?}", report.warnings());
        let corners = |triangles: &[[u32; 3]], positions: &[[f64; 3]]| -> Vec<[[f64; 3]; 3]> {
            triangles
                .iter()
                .map(|t| t.map(|corner| positions[corner as usize]))
                .collect()
        };
        assert_eq!(
            corners(mesh.triangles(), mesh.positions()),
            corners(&surface.triangles, &surface.positions)
        );
    }
}

/// Each of three cubes about one edge, and of four, facing as it likes.
#[test]
fn cubes_about_an_edge_are_turned_one_by_one() {
    let places = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    for count in [3, 4] {
        for facing in 0..1 << count {
            let mut surface = Surface::default();
            for (index, [x, y]) in places.into_iter().take(count).enumerate() {
                let own = cube([x, y, 0.0], 1.0);
                surface = surface.and(&if facing >> index & 1 == 1 {
                    own.inverted()
                } else {
                    own
                });
            }
            let report = with_volume(&surface, count as f64);
            assert_eq!(report.inverted_parts, (facing as u32).count_ones() as usize);
        }
    }
    // Along an edge only, and at a corner only.
    for shift in [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0]] {
        let pair = cube([0.0; 3], 1.0).and(&cube(shift, 1.0).inverted());
        assert_eq!(with_volume(&pair, 2.0).inverted_parts, 1);
    }
}

/// A cube once, beside one with every triangle both ways round: that one was read as nothing, without a warning.
#[test]
fn a_body_both_ways_round_is_taken_once() {
    let twice = |surface: Surface| surface.clone().and(&surface.inverted());
    let one = cube([0.0; 3], 10.0);
    for spacing in [20.0, 10.0] {
        let other = cube([spacing, 0.0, 0.0], 10.0);
        for other in [twice(other.clone()), twice(other.clone().inverted())] {
            for surface in [one.clone().and(&other), other.clone().and(&one)] {
                let report = with_volume(&surface, 2000.0);
                assert!(report.is_closed() && !report.is_sound());
                assert_eq!((report.repeated_triangles, report.triangles), (12, 24));
                assert_eq!((report.parts, report.inverted_parts), (2, 0));
            }
        }
    }
    // The same way round twice; and both of two that touch, all both ways round.
    let report = with_volume(
        &one.clone().and(&one).and(&cube([20.0, 0.0, 0.0], 10.0)),
        2000.0,
    );
    assert_eq!(report.repeated_triangles, 12);
    with_volume(
        &twice(one.clone().and(&cube([10.0, 0.0, 0.0], 10.0))),
        2000.0,
    );
    // Some faces of a body only, and one.
    for some in [1, 3, 4, 11] {
        let mut surface = one.clone();
        let faces = one.clone().inverted().triangles;
        surface.triangles.extend(&faces[..some]);
        let report = with_volume(&surface, 1000.0);
        assert!(report.is_closed() && !report.is_sound(), "{some}");
        assert_eq!(report.triangles, 12);
    }
    // Some faces of bodies that touch, where facing contradicts itself; and a wall between two that is there once.
    for some in [2, 5, 9] {
        let mut surface = one.clone().and(&cube([10.0, 0.0, 0.0], 10.0));
        let faces = surface.clone().inverted().triangles;
        surface.triangles.extend(&faces[some..some + 7]);
        with_volume(&surface, 2000.0);
    }
    let mut baffle = one.clone().and(&cube([10.0, 0.0, 0.0], 10.0));
    baffle.triangles.drain(2..4);
    let report = with_volume(&baffle, 2000.0);
    assert!(report.is_closed() && !report.is_sound());
    assert_eq!((report.idle_triangles, report.parts), (2, 1));
    // A hollow body whose walls are there both ways round.
    let hollow = one.clone().and(&cube([3.0; 3], 4.0).inverted());
    with_volume(
        &twice(hollow.clone()).and(&cube([20.0, 0.0, 0.0], 10.0)),
        1936.0,
    );
}

/// A sheet without thickness bounds nothing: it was counted as a part of the solid that the balls miss by many
/// times epsilon.
#[test]
fn a_fin_is_left_out() {
    let body = cube([0.0; 3], 10.0);
    let sheet = |low: [f64; 3], high: [f64; 3]| {
        let mut sheet = cuboid(low, high);
        sheet.triangles.truncate(2);
        sheet.clone().and(&sheet.inverted())
    };
    // Off the middle of a face, along an edge, alone.
    for (low, high) in [
        ([5.0, 10.0, 0.0], [5.0, 20.0, 10.0]),
        ([10.0, 10.0, 0.0], [10.0, 20.0, 10.0]),
        ([15.0, 15.0, 0.0], [15.0, 25.0, 10.0]),
    ] {
        let report = with_volume(&body.clone().and(&sheet(low, high)), 1000.0);
        assert_eq!((report.idle_triangles, report.triangles), (4, 12));
        assert_eq!(report.high, [10.0; 3], "the box is that of the solid");
        assert!(report.warnings()[0].contains("bound nothing"));
    }
    // Front and back cut along different diagonals.
    let mut sheet = cuboid([15.0, 0.0, 0.0], [15.0, 10.0, 10.0]);
    sheet.triangles.truncate(2);
    let [a, b, c] = sheet.triangles[0];
    let d = sheet.triangles[1][2];
    sheet.triangles.extend([[b, a, d], [c, b, d]]);
    let report = with_volume(&body.clone().and(&sheet), 1000.0);
    assert_eq!((report.idle_triangles, report.triangles), (4, 12));
}

/// A cube in a cube in a cube, each facing as it likes: from the outside in, walls that change from empty to solid
/// and back.
#[test]
fn nested_bodies_are_read_from_the_outside_in() {
    let (outer, middle, inner) = (1000.0, 216.0, 8.0);
    for (facing, volume, nested) in [
        ("+++", outer, 2),
        ("++-", outer, 2),
        ("+-+", outer - middle + inner, 0),
        // The island in the cavity faces inward. It was taken for a cavity's wall in a cavity, and lost.
        ("+--", outer - middle + inner, 0),
        ("-++", outer - middle + inner, 0),
        ("-+-", outer - middle + inner, 0),
        ("--+", outer, 2),
        ("---", outer, 2),
    ] {
        let mut surface = Surface::default();
        for ((low, edge), sign) in [(0.0, 10.0), (2.0, 6.0), (4.0, 2.0)]
            .into_iter()
            .zip(facing.chars())
        {
            let own = cube([low; 3], edge);
            surface = surface.and(&if sign == '-' { own.inverted() } else { own });
        }
        let report = with_volume(&surface, volume);
        assert_eq!(report.nested_parts, nested, "{facing}");
        assert_eq!(report.is_sound(), facing == "+-+");
    }
    // As programs write cavities that turn all to face outward: the union, as documented, and a warning.
    let report = with_volume(&cube([0.0; 3], 10.0).and(&cube([3.0; 3], 4.0)), 1000.0);
    let warnings = report.warnings();
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].contains("a part lies within another and faces outward; is it a cavity?"));
    assert_eq!(report.inverted_parts, 0);
}

/// A cavity that touches the wall about it, at a face, an edge and a corner, with and without vertices in common,
/// is one.
#[test]
fn cavities_may_touch_the_walls_about_them() {
    let body = cube([0.0; 3], 10.0);
    for low in [
        [0.0, 3.0, 3.0],
        [0.0, 0.0, 3.0],
        [0.0; 3],
        [6.0; 3],
        [6.0, 3.0, 3.0],
    ] {
        for inverted in [false, true] {
            let mut surface = body.clone().and(&cube(low, 4.0).inverted());
            if inverted {
                surface = surface.inverted();
            }
            let report = with_volume(&surface, 936.0);
            assert_eq!(report.inverted_parts, if inverted { 2 } else { 0 });
        }
    }
    // A wall in common, of two triangles: both ways round, with the outside on one side and the cavity on the other.
    let coat = cuboid([0.0; 3], [10.0, 10.0, 10.0]);
    let through = cuboid([0.0, 0.0, 0.0], [4.0, 10.0, 10.0]).inverted();
    let report = with_volume(&coat.and(&through), 600.0);
    assert!(report.is_closed());
}

/// A strip and a bottle with one side only.
#[test]
fn surfaces_of_one_side_are_warned_of() {
    let turns = 24;
    let strip = |around: i32| {
        let closed = around > 0;
        let mut surface = Surface::default();
        let width = if closed { around } else { 2 };
        for i in 0..turns {
            let t = 2.0 * std::f64::consts::PI * f64::from(i) / f64::from(turns);
            for j in 0..width {
                // A figure of eight, or a line, turned by half while it goes round: the flat Klein bottle, or the
                // Möbius strip.
                let v = 2.0 * std::f64::consts::PI * f64::from(j) / f64::from(around);
                let (p, q) = if closed {
                    (v.sin(), (2.0 * v).sin())
                } else {
                    (f64::from(j) - 0.5, 0.0)
                };
                let (s, c) = (0.5 * t).sin_cos();
                let r = 3.0 + c * p - s * q;
                surface
                    .positions
                    .push([r * t.cos(), r * t.sin(), s * p + c * q]);
            }
        }
        let at = |i: i32, j: i32| {
            // After one turn p and q have changed sign.
            let j = if i < turns {
                j
            } else if closed {
                around - j
            } else {
                1 - j
            };
            ((i % turns) * width + j.rem_euclid(width)) as u32
        };
        let last = if closed { around } else { 1 };
        for i in 0..turns {
            for j in 0..last {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                surface.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        surface
    };
    for (surface, open) in [(strip(0), true), (strip(13), false)] {
        let (_, report) = surface.mesh();
        assert_eq!(report.open_edges > 0, open);
        assert!(!report.is_closed() && !report.is_sound());
        assert_eq!(report.one_sided_parts, 1);
        assert!(
            report
                .warnings()
                .iter()
                .any(|warning| warning.contains("one side only"))
        );
    }
    // With vertices where the bottle's tube meets itself, space falls into cells: two tubes side by side.
    let (_, report) = strip(12).mesh();
    assert!(report.is_closed() && !report.is_sound());
    assert!(report.volume > 10.0, "{report:?}");
}

/// Many pores in a fine block: each was compared with every triangle of the block.
#[test]
fn pores_stay_pores() {
    let mut surface = sphere([0.0; 3], 10.0, 24);
    let (_, block) = surface.mesh();
    let pore = sphere([0.0; 3], 0.4, 4).inverted();
    let (_, hole) = pore.clone().inverted().mesh();
    let mut count = 0;
    for i in 0..216 {
        let at = [i % 6, i / 6 % 6, i / 36].map(|n| 1.8 * (f64::from(n) - 2.5));
        surface = surface.and(
            &pore
                .clone()
                .mapped(|p| [0, 1, 2].map(|axis| p[axis] + at[axis])),
        );
        count += 1;
    }
    let report = with_volume(&surface, block.volume - f64::from(count) * hole.volume);
    assert!(report.is_sound() && report.parts == 217);
}
