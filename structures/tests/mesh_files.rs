//! Reading meshes: every format gives the same mesh, faults are named with their line, and nothing panics.

#![cfg(feature = "mesh")]

use std::fs;

use crate::solids::{Surface, cuboid, scattered, sphere};
use knotdock_structures::mesh::{MeshFormat, Solid, parse, read};

fn unit_cube() -> Surface {
    cuboid([0.0; 3], [1.0; 3])
}

fn all_formats(surface: &Surface) -> Vec<(&'static str, MeshFormat, Vec<u8>)> {
    vec![
        ("a.obj", MeshFormat::Obj, surface.obj().into_bytes()),
        ("a.off", MeshFormat::Off, surface.off().into_bytes()),
        ("text.stl", MeshFormat::Stl, surface.stl_text().into_bytes()),
        ("binary.stl", MeshFormat::Stl, surface.stl_binary()),
        ("text.ply", MeshFormat::Ply, surface.ply_text().into_bytes()),
        ("little.ply", MeshFormat::Ply, surface.ply_binary(false)),
        ("big.ply", MeshFormat::Ply, surface.ply_binary(true)),
    ]
}

/// A byte order mark before the first vertex, or a comment that ends with a backslash before another, takes neither
/// away; lines that go on go on.
#[test]
fn marks_and_comments_take_no_vertex_away() {
    let cube = unit_cube();
    let (expected, _) = parse(cube.obj().as_bytes(), MeshFormat::Obj).unwrap();
    let obj = cube.obj();
    let after_comment = obj.replacen("v ", "# from C:\\models\\\nv ", 1);
    let continued = obj.replacen("\nf ", "\nf \\\n", 3);
    assert!(after_comment != obj && continued != obj);
    for (text, format) in [
        (format!("\u{feff}{obj}"), MeshFormat::Obj),
        (after_comment, MeshFormat::Obj),
        (continued, MeshFormat::Obj),
        (format!("\u{feff}{}", cube.off()), MeshFormat::Off),
    ] {
        let (mesh, report) = parse(text.as_bytes(), format).unwrap();
        assert_eq!((report.vertices, report.triangles), (8, 12));
        assert_eq!(mesh.volume(), expected.volume());
    }
}

#[test]
fn every_format_gives_the_same_mesh() {
    let folder = tempfile::tempdir().unwrap();
    // A quarter and a half survive the 24 bits of binary STL.
    let surface = cuboid([-0.25, 0.5, 1.0], [0.75, 2.5, 4.0]).and(
        &sphere([9.0, 0.0, 0.0], 1.0, 4).mapped(|p| p.map(|value| (value * 64.0).round() / 64.0)),
    );
    let mut volumes = Vec::new();
    for (name, format, bytes) in all_formats(&surface) {
        let path = folder.path().join(name);
        fs::write(&path, &bytes).unwrap();
        let (mesh, report) = read(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(report.format, Some(format), "{name}");
        assert_eq!(report.triangles, surface.triangles.len(), "{name}");
        assert_eq!(report.vertices, surface.positions.len(), "{name}: welded");
        assert!(report.is_sound() && report.parts == 2, "{name}: {report}");
        volumes.push(mesh.volume());
    }
    assert!(
        volumes
            .iter()
            .all(|volume| (volume - volumes[0]).abs() < 1e-12),
        "{volumes:?}"
    );
    let (_, report) = surface.mesh();
    assert!((report.volume - volumes[0]).abs() < 1e-12);
}

#[test]
fn a_text_format_keeps_every_digit() {
    let surface = unit_cube().mapped(|p| p.map(|value| 1e6 + value / 3.0));
    for (name, format, bytes) in all_formats(&surface) {
        if name == "binary.stl" {
            continue;
        }
        let (mesh, _) = parse(&bytes, format).unwrap();
        let mut found = mesh.positions().to_vec();
        let mut expected = surface.positions.clone();
        found.sort_by(|a, b| a.partial_cmp(b).unwrap());
        expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(found, expected, "{name}");
    }
}

#[test]
fn dialects() {
    // Quads, counting back, continued lines, groups, no final newline; CRLF.
    let obj = "g x\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nv 0 0 1\r\nv 1 0 1\r\nv 1 1 1\r\nv 0 1 1\r\n\
        vn 0 0 1\r\n\
               f 1 4 3 2\r\nf 5 6 \\\r\n7 8\r\nusemtl y\r\nf 1 2 6 5\r\nf 2 3 7 6\r\nf 3 4 8 7\r\nf -8 -4 -1 -5";
    let (mesh, report) = parse(obj.as_bytes(), MeshFormat::Obj).unwrap();
    assert_eq!(report.triangles, 12);
    assert!((mesh.volume() - 1.0).abs() < 1e-15 && report.is_sound());
    // Counts on the line of the keyword, and a colour a vertex.
    let off = "COFF 4 4 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n\n0 1 0 1 1 1 1\n0 0 1 1 1 1 1 # last\n3 0 2 1\n3 0 1 3\n\
        3 1 2 3\n3 2 0 3\n";
    let (mesh, report) = parse(off.as_bytes(), MeshFormat::Off).unwrap();
    assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-15 && report.is_sound());
    // Two solids in one file, and upper case.
    let stl = unit_cube().stl_text() + &cuboid([2.0; 3], [3.0; 3]).stl_text().to_uppercase();
    let (mesh, report) = parse(stl.as_bytes(), MeshFormat::Stl).unwrap();
    assert_eq!(report.parts, 2);
    assert!((mesh.volume() - 2.0).abs() < 1e-12);
}

fn line_of(text: &str, format: MeshFormat) -> Option<u64> {
    parse(text.as_bytes(), format).unwrap_err().line()
}

#[test]
fn faults_name_their_line() {
    let cube = unit_cube();
    for (text, format, word, line) in [
        (cube.obj(), MeshFormat::Obj, "v 1.0 1.0 0.0", 6),
        (cube.off(), MeshFormat::Off, "1.0 1.0 0.0", 7),
        (cube.stl_text(), MeshFormat::Stl, "vertex 0.0 0.0 1.0", 5),
        (cube.ply_text(), MeshFormat::Ply, "1.0 1.0 0.0", 14),
    ] {
        assert!(text.contains(word));
        // A facet of STL with one of the first two is left out, as it stands for itself: see mesh_dialects.rs.
        let values = ["nan", "inf", "1e300", "x"];
        let first = if format == MeshFormat::Stl { 2 } else { 0 };
        for value in &values[first..] {
            let broken = word.replace("0.0", value);
            let damaged = text.replacen(word, &broken, 1);
            assert_eq!(line_of(&damaged, format), Some(line), "{format:?} {broken}");
        }
    }
    for (text, format, word, broken, line) in [
        (
            cube.obj(),
            MeshFormat::Obj,
            "f 2/1/1 4//2 8",
            "f 2/1/1 4//2 9",
            13,
        ),
        (cube.obj(), MeshFormat::Obj, "f 2/1/1 4//2 8", "f 0 4 8", 13),
        (cube.off(), MeshFormat::Off, "3 1 3 7", "3 1 3 8", 14),
        (cube.off(), MeshFormat::Off, "3 1 3 7", "3 1 3 -1", 14),
        (cube.off(), MeshFormat::Off, "8 12 0", "eight 12 0", 3),
        (cube.ply_text(), MeshFormat::Ply, "3 1 3 7", "3 1 3 8", 21),
        (
            cube.stl_text(),
            MeshFormat::Stl,
            " endloop\n",
            " vortex\n",
            7,
        ),
    ] {
        assert!(text.contains(word), "{word}");
        assert_eq!(
            line_of(&text.replacen(word, broken, 1), format),
            Some(line),
            "{format:?} {broken}"
        );
    }
}

#[test]
fn what_bounds_no_solid_is_refused() {
    let refused = |text: &str, format, message: &str| {
        let error = parse(text.as_bytes(), format).unwrap_err();
        assert!(error.message().contains(message), "{error}");
        assert!(error.remedy().is_some(), "{error}");
    };
    let obj = MeshFormat::Obj;
    refused("v 0 0 0\nv 1 0 0\nv 0 1 0\n", obj, "no triangles");
    refused("OFF\n0 0 0\n", MeshFormat::Off, "no triangles");
    for text in [
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
        "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n",
    ] {
        refused(text, obj, "all 1 triangles are degenerate");
    }
    // A square in a tilted plane.
    let square = "v 0 0 0\nv 1 0 1\nv 1 1 2\nv 0 1 1\nf 1 2 3 4\n";
    refused(square, obj, "flat");
    let tiny = unit_cube().mapped(|p| p.map(|value| 1e-120 * value));
    refused(&tiny.obj(), obj, "below 1e-60");
}

#[test]
fn files_that_are_no_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, bytes: &[u8], message: &str| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let error = read(&path).unwrap_err();
        assert_eq!(error.file(), Some(path.as_path()));
        assert!(error.message().contains(message), "{error}");
        assert!(error.remedy().is_some(), "{error}");
    };
    refused("letter.txt", b"Dear all", "the format is not known");
    refused("letter.stl", b"Dear all", "begins with 'Dear all'");
    refused("letter.ply", b"Dear all", "begins with 'Dear all'");
    refused("empty.stl", b"", "the file is empty");
    refused("empty.obj", b"", "no triangles");
    let binary = unit_cube().stl_binary();
    refused("cut.stl", &binary[..binary.len() - 7], "12 triangles");
    // The first bytes decide before the name.
    let path = folder.path().join("odd.obj");
    fs::write(&path, unit_cube().ply_text()).unwrap();
    assert_eq!(read(&path).unwrap().1.format, Some(MeshFormat::Ply));
    let of = |path: &std::path::Path| read(path).unwrap_err().message().to_owned();
    assert!(of(folder.path()).contains("a directory"));
    assert!(of(&folder.path().join("none.stl")).contains("no such file"));
}

/// Every file cut at every byte, and every byte changed: an answer or an error, never a panic, an endless loop or a
/// huge allocation.
#[test]
fn damaged_files_never_panic() {
    let tetrahedron = Surface {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    };
    for (_, format, bytes) in all_formats(&tetrahedron) {
        for end in 0..bytes.len() {
            let _ = parse(&bytes[..end], format);
        }
        for place in 0..bytes.len() {
            for value in [
                0,
                b' ',
                b'\n',
                b'-',
                b'9',
                b'e',
                0x7f,
                0xff,
                bytes[place] ^ 1,
            ] {
                let mut damaged = bytes.clone();
                damaged[place] = value;
                if let Ok((mesh, _)) = parse(&damaged, format) {
                    let solid = Solid::new(&mesh).unwrap();
                    assert!(solid.depth([0.1, 0.05, -0.1]).is_finite());
                }
            }
        }
    }
    // Counts that no file could hold must not be allocated up front.
    for text in [
        "OFF\n99999999999999 1 0\n0 0 0\n",
        "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n",
    ] {
        let format = if text.starts_with("OFF") {
            MeshFormat::Off
        } else {
            MeshFormat::Ply
        };
        let error = parse(text.as_bytes(), format).unwrap_err();
        assert!(error.message().contains("file ends"), "{error}");
    }
}

#[test]
fn doubling_every_length_keeps_the_bits() {
    let surface = sphere([0.3, -0.2, 0.1], 0.7, 9);
    let once = surface.solid();
    let doubled = surface.mapped(|p| p.map(|value| 2.0 * value)).solid();
    assert_eq!(doubled.frame().unit, 2.0 * once.frame().unit);
    for point in scattered(200, 0.5) {
        assert_eq!(once.depth(point).to_bits(), doubled.depth(point).to_bits());
    }
}
