//! Vertices in one place are one: bridges of polygons with holes, seams within the rounding of numbers, and what must
//! not be joined.

#![cfg(feature = "mesh")]

use std::f64::consts::PI;
use std::fmt::Write;

use crate::solids::{Surface, cuboid, sphere};
use knotdock_structures::mesh::{Mesh, MeshFormat, MeshReport, parse};

fn read(bytes: &[u8], format: MeshFormat) -> (Mesh, MeshReport) {
    parse(bytes, format).unwrap_or_else(|error| panic!("{error}"))
}

/// An OBJ file of polygons; `shared` has a vertex a place, else each corner has its own.
fn obj(faces: &[Vec<[f64; 3]>], shared: bool) -> String {
    let mut places: Vec<[f64; 3]> = Vec::new();
    let mut lists = String::new();
    for face in faces {
        lists += "f";
        for corner in face {
            let known = places.iter().position(|place| place == corner);
            let index = known.filter(|_| shared).unwrap_or_else(|| {
                places.push(*corner);
                places.len() - 1
            });
            write!(lists, " {}", index + 1).unwrap();
        }
        lists += "\n";
    }
    let vertices = places
        .iter()
        .map(|[x, y, z]| format!("v {x:?} {y:?} {z:?}\n"));
    vertices.collect::<String>() + &lists
}

/// A plate 2 thick from its outline, in which bridges lead to the holes, and the walls along all of it but for bridges.
fn plate(outline: &[[f64; 2]], turned: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<Vec<[f64; 3]>> {
    let at = |[x, y]: [f64; 2], z: f64| turned([x, y, z]);
    let top = outline.iter().map(|&p| at(p, 2.0)).collect();
    let bottom = outline.iter().rev().map(|&p| at(p, 0.0)).collect();
    let mut faces = vec![top, bottom];
    let sides: Vec<[[f64; 2]; 2]> = (0..outline.len())
        .map(|i| [outline[i], outline[(i + 1) % outline.len()]])
        .collect();
    for &[a, b] in &sides {
        if !sides.contains(&[b, a]) {
            faces.push(vec![at(a, 0.0), at(b, 0.0), at(b, 2.0), at(a, 2.0)]);
        }
    }
    faces
}

/// A hole as a polygon, clockwise from its first corner and back to it.
fn hole(middle: [f64; 2], radius: f64, corners: usize, first: f64) -> Vec<[f64; 2]> {
    (0..=corners)
        .map(|i| first - 2.0 * PI * (i % corners) as f64 / corners as f64)
        .map(|angle| {
            [
                middle[0] + radius * angle.cos(),
                middle[1] + radius * angle.sin(),
            ]
        })
        .collect()
}

/// A cap with a hole is one polygon, whose bridge is run through both ways. If the corners of the bridge were other
/// vertices in the same places, as exporters without shared vertices write, the hole was filled: a plate of 168 had a
/// volume of 200.
#[test]
fn polygons_with_bridges_to_holes() {
    let rim = [[0., 0.], [10., 0.], [10., 10.], [0., 10.]];
    let square = [[3., 3.], [3., 7.], [7., 7.], [7., 3.], [3., 3.]];
    let one: Vec<[f64; 2]> = [&rim[..], &rim[..1], &square[..]].concat();
    // Two round holes from one corner, and a third one by way of the second.
    let area = |radius: f64, corners: usize| {
        0.5 * corners as f64 * radius * radius * (2.0 * PI / corners as f64).sin()
    };
    let mut three: Vec<[f64; 2]> = vec![rim[0]];
    three.extend(hole([2., 7.], 1.5, 20, 1.5 * PI));
    three.push(rim[0]);
    let second = hole([4., 3.], 1.0, 24, PI);
    three.extend(&second[..13]);
    three.extend(hole([8., 3.], 1.5, 30, PI));
    three.extend(&second[12..]);
    three.extend(rim);
    let holes = area(1.5, 20) + area(1.0, 24) + area(1.5, 30);
    let tilt = |[x, y, z]: [f64; 3]| {
        let (c, s) = (0.6, 0.8);
        let (x, y) = (c * x - s * y, s * x + c * y);
        [x, c * y - s * z, s * y + c * z]
    };
    for (outline, area) in [(&one, 84.0), (&three, 100.0 - holes)] {
        for shared in [true, false] {
            for (faces, name) in [
                (plate(outline, |p| p), "flat"),
                (plate(outline, tilt), "tilted"),
            ] {
                let (mesh, report) = read(obj(&faces, shared).as_bytes(), MeshFormat::Obj);
                assert!(report.is_sound(), "{name}, shared {shared}: {report}");
                assert!(
                    (mesh.volume() - 2.0 * area).abs() < 1e-9,
                    "{name}: {report}"
                );
                // Both caps are covered once: no triangle lies outside them.
                let walls = report.area - 2.0 * area;
                let around: f64 = faces[2..]
                    .iter()
                    .map(|wall| distance(wall[0], wall[1]))
                    .sum();
                assert!(
                    (walls - 2.0 * around).abs() < 1e-9,
                    "{name}: {walls} {around}"
                );
            }
        }
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3)
        .map(|axis| (a[axis] - b[axis]).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// Triangles without shared corners: each corner is moved along each axis by `step` of the coordinate and a whole
/// number that looks random from `low` to `high`; every other triangle turned over if `turned`.
fn meshed_separately(
    surface: &Surface,
    low: i64,
    high: i64,
    turned: bool,
    step: impl Fn(f64, i64) -> f64,
) -> Surface {
    let mut separate = Surface::default();
    let mut state: u64 = 1;
    let mut random = |count: i64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as i64 % count
    };
    for triangle in &surface.triangles {
        let start = separate.positions.len() as u32;
        for &corner in triangle {
            let position = surface.positions[corner as usize];
            separate
                .positions
                .push(position.map(|x| step(x, low + random(high - low + 1))));
        }
        let mut corners = [start, start + 1, start + 2];
        if turned && random(2) == 1 {
            corners.swap(0, 1);
        }
        separate.triangles.push(corners);
    }
    separate
}

/// A neighbour among the `float`s.
fn ulps(x: f64, steps: i64) -> f64 {
    f64::from(f32::from_bits(((x as f32).to_bits() as i64 + steps) as u32))
}

/// A ball at an offset of 100, its faces meshed separately: corners differ by a last bit of `float`, and triangles face
/// either way. It was open throughout, had a volume of 9.2 in place of 4100, and took minutes.
#[test]
fn seams_within_the_rounding_of_a_float_are_closed() {
    let ball = sphere([100.0; 3], 10.0, 16).mapped(|p| p.map(|x| f64::from(x as f32)));
    let whole = ball.mesh().0.volume();
    for (low, high) in [(0, 1), (-1, 1)] {
        for turned in [false, true] {
            let separate = meshed_separately(&ball, low, high, turned, ulps);
            let (mesh, report) = read(&separate.stl_binary(), MeshFormat::Stl);
            assert!(report.is_closed() && report.parts == 1, "{report}");
            assert_eq!(report.vertices, ball.positions.len());
            assert!(report.seam_vertices > 500 && report.weld_reach < 2e-5);
            assert!((mesh.volume() / whole - 1.0).abs() < 1e-5, "{report}");
            // Doubles that hold floats, as text and not.
            for (bytes, format) in [
                (separate.ply_binary(false), MeshFormat::Ply),
                (separate.ply_text().into_bytes(), MeshFormat::Ply),
                (separate.obj().into_bytes(), MeshFormat::Obj),
            ] {
                assert!(read(&bytes, format).1.is_closed(), "{format:?}");
            }
        }
    }
}

/// The same where coordinates are written with few digits: the last one of two copies differs.
#[test]
fn seams_within_the_digits_written_are_closed() {
    let ball = sphere([100.0; 3], 10.0, 12);
    let whole = ball.mesh().0.volume();
    // Four decimals, and six digits with zeros dropped as `%g` does.
    type Write = fn(f64) -> String;
    let written: [(f64, Write); 2] = [
        (1e-4, |x| format!("{x:.4}")),
        (1e-3, |x| {
            let decimals = 5 - x.abs().log10().floor() as usize;
            let text = format!("{x:.decimals$}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }),
    ];
    for (unit, write) in written {
        let separate = meshed_separately(&ball, 0, 1, true, |x, steps| x + unit * steps as f64);
        let mut obj = String::new();
        let mut stl = String::from("solid\n");
        for t in &separate.triangles {
            let corners = t.map(|corner| separate.positions[corner as usize]);
            stl += "facet normal 0 0 0\nouter loop\n";
            for position in corners {
                let [x, y, z] = position.map(write);
                writeln!(obj, "v {x} {y} {z}").unwrap();
                writeln!(stl, "vertex {x} {y} {z}").unwrap();
            }
            obj += "f -3 -2 -1\n";
            stl += "endloop\nendfacet\n";
        }
        for (text, format) in [(obj, MeshFormat::Obj), (stl, MeshFormat::Stl)] {
            let (mesh, report) = read(text.as_bytes(), format);
            assert!(
                report.is_closed() && report.parts == 1,
                "{unit} {format:?}: {report}"
            );
            assert!((mesh.volume() / whole - 1.0).abs() < 1e-3);
        }
    }
}

/// Numbers with all digits of a double are welded within its last ones only.
#[test]
fn seams_of_doubles() {
    let ball = sphere([100.0; 3], 10.0, 10);
    let next = |x: f64, steps: i64| f64::from_bits((x.to_bits() as i64 + steps) as u64);
    let separate = meshed_separately(&ball, 0, 1, false, next);
    assert!(
        read(separate.ply_text().as_bytes(), MeshFormat::Ply)
            .1
            .is_closed()
    );
    // A millionth of a float's last bit is no rounding of a double.
    let farther = meshed_separately(&ball, 0, 1, false, |x, steps| x + 1e-9 * steps as f64);
    let (_, report) = read(farther.ply_text().as_bytes(), MeshFormat::Ply);
    assert!(!report.is_closed() && report.seam_vertices == 0);
}

/// What is thin stays as it is: closed meshes are not welded beyond equal digits, however thin they are.
#[test]
fn thin_features_are_no_seams() {
    // Two last bits of a float thick, and a unit of the last digit.
    let bit = 2f64.powi(-17);
    for thickness in [bit, 2.0 * bit] {
        let plate = cuboid([100.0; 3], [110.0, 110.0, 100.0 + thickness]);
        let (mesh, report) = read(&plate.stl_binary(), MeshFormat::Stl);
        assert!(report.is_sound() && report.triangles == 12, "{report}");
        assert!((mesh.volume() / (100.0 * thickness) - 1.0).abs() < 1e-6);
    }
    let text = "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 0 0 0.001\nv 10 0 0.001\nv 10 10 0.001\nv 0 10 0.001\n\
                f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    let (mesh, report) = read(text.as_bytes(), MeshFormat::Obj);
    assert!(report.is_sound() && (mesh.volume() - 0.1).abs() < 1e-12);
    // A sliver as thin as a bit between two faces.
    let mut needles = cuboid([0.0; 3], [1.0, 1.0, 1.0]);
    needles.positions.push([0.5, 1.0 + 2f64.powi(-23), 1.0]);
    needles.triangles.retain(|t| *t != [4, 7, 6]);
    needles.triangles.extend([[7, 6, 8], [4, 7, 8], [4, 8, 6]]);
    let (mesh, report) = read(&needles.stl_binary(), MeshFormat::Stl);
    assert!(
        report.is_closed() && report.triangles == needles.triangles.len(),
        "{report}"
    );
    assert!((mesh.volume() - 1.0).abs() < 1e-6);
}

/// Whole numbers are no rounding: a tray of 10 by 10 by 2 stays open at the top, and a slit as wide as a unit stays a
/// slit.
#[test]
fn few_digits_do_not_close_what_is_open() {
    let mut tray = cuboid([0.0; 3], [10.0, 10.0, 2.0]);
    tray.triangles.truncate(10);
    let text = tray.obj().replace(".0", "");
    let (_, report) = read(text.as_bytes(), MeshFormat::Obj);
    assert!(
        report.open_edges == 4 && report.seam_vertices == 0,
        "{report}"
    );
    let mut slit = cuboid([0.0; 3], [100.0, 100.0, 0.1]);
    slit.triangles.drain(0..2);
    let (_, report) = read(slit.obj().as_bytes(), MeshFormat::Obj);
    assert!(
        report.open_edges == 4 && report.seam_vertices == 0,
        "{report}"
    );
}

/// Open meshes finer than their numbers' rounding are left unchanged but for vertices within it, and no chain of
/// vertices collapses: a sheet of many small triangles keeps its extent.
#[test]
fn a_dense_sheet_does_not_collapse() {
    // Triangles a unit of rounding wide, each by itself, and a far one that makes the unit.
    let bit = 2f64.powi(-17);
    let mut cloud = Surface {
        positions: vec![[100.0; 3], [101.0, 100.0, 100.0], [100.0, 101.0, 102.0]],
        triangles: vec![[0, 1, 2]],
    };
    for i in 0..40 {
        for j in 0..40 {
            let [x, y] = [i, j].map(|k| 100.0 + f64::from(k) * bit);
            let start = cloud.positions.len() as u32;
            cloud
                .positions
                .extend([[x, y, 100.0], [x + bit, y, 100.0], [x, y + bit, 100.0]]);
            cloud.triangles.push([start, start + 1, start + 2]);
        }
    }
    let (mesh, report) = read(&cloud.stl_binary(), MeshFormat::Stl);
    // Equal vertices are one; others may be joined with those next to them, and no farther.
    assert!(report.triangles > 400, "{report}");
    let far = mesh
        .positions()
        .iter()
        .filter(|p| p[0] > 100.0 + 30.0 * bit && p[0] < 100.1);
    assert!(far.count() > 20);
    // The same bytes give the same mesh.
    assert_eq!(read(&cloud.stl_binary(), MeshFormat::Stl).0, mesh);
}
