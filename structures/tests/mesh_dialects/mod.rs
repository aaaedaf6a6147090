//! What other programs write: dialects that are read, files of other kinds that are named, and parts that are left out
//! with a warning.

#![cfg(feature = "mesh")]

mod ply;

use std::fs;

use crate::solids::{Surface, cuboid};
use knotdock_structures::Error;
use knotdock_structures::mesh::{Mesh, MeshFormat, MeshReport, parse, read};

fn cube() -> Surface {
    cuboid([0.0; 3], [10.0; 3])
}

fn named(name: &str, bytes: &[u8]) -> Result<(Mesh, MeshReport), Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    read(&path)
}

/// Reads what must be the cube, without a word.
fn is_cube(name: &str, bytes: &[u8]) {
    let (mesh, report) = named(name, bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(report.is_sound(), "{name}: {:?}", report.warnings());
    assert_eq!((report.vertices, report.triangles), (8, 12), "{name}");
    assert!((mesh.volume() - 1000.0).abs() < 1e-9, "{name}: {report}");
}

/// Reads what must be the cube, with one warning that has each of `words`.
fn is_cube_with_warning(name: &str, bytes: &[u8], words: &[&str]) {
    let (mesh, report) = named(name, bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!((mesh.volume() - 1000.0).abs() < 1e-9, "{name}: {report}");
    assert!(report.is_closed() && !report.is_sound(), "{name}");
    let warnings = report.warnings();
    assert_eq!(warnings.len(), 1, "{name}: {warnings:?}");
    for word in words {
        assert!(warnings[0].contains(word), "{name}: {warnings:?}");
    }
}

/// OFF is a stream of words by its definition, and ModelNet's files have the counts glued to the keyword; all of these
/// were refused.
#[test]
fn off_in_other_lines() {
    // Without the colours of faces, which are detected from the ends of lines alone.
    let off = cube().off().replace(" 255 0 0", "").replace("# test\n", "");
    is_cube("plain.off", off.as_bytes());
    let body = off.strip_prefix("OFF\n").unwrap();
    for (name, text) in [
        ("glued.off", format!("OFF{body}")),
        ("lower.off", format!("off\n{body}")),
        ("mixed.off", format!("Off {body}")),
        ("same.off", format!("OFF {body}")),
        (
            "comments.off",
            format!("# a\n\nOFF # b\n# c\n{}", body.replace('\n', " # d\n\n")),
        ),
        ("crlf.off", off.replace('\n', "\r\n")),
        ("bare.off", body.to_owned()),
        ("line.off", off.replace('\n', " ")),
        ("word.off", off.replace(' ', "\n")),
        (
            "two.off",
            format!("OFF 8 12 0\n{}", body[7..].replace('\n', " ")),
        ),
        ("no_edges.off", off.replacen("8 12 0", "8 12", 1)),
        (
            "no_edges_line.off",
            off.replacen("8 12 0", "8 12", 1).replace('\n', " "),
        ),
        ("under_another_name.stl", off.clone()),
        ("glued.obj", format!("OFF{body}")),
    ] {
        is_cube(name, text.as_bytes());
    }
    // Colours, normals and places in a picture, a line a vertex or not.
    for (keyword, more) in [
        ("COFF", " 0 0 0 0"),
        ("COFF", " 255 0 0"),
        ("NOFF", " 0 0 1"),
        ("STOFF", " 0.5 0.5"),
        ("CNOFF", " 0 0 1 1 0 0 1"),
        ("STCNOFF", " 0 0 1 1 0 0 1 0.5 0.5"),
        ("noff", " 0 0 1"),
    ] {
        let lines = body.lines().enumerate().map(|(index, line)| {
            let is_vertex = (1..=8).contains(&index);
            format!("{line}{}\n", if is_vertex { more } else { "" })
        });
        let text = format!("{keyword}\n{}", lines.collect::<String>());
        is_cube(&format!("lines_{keyword}.off"), text.as_bytes());
        is_cube(
            &format!("words_{keyword}.off"),
            text.replace(' ', "\n").as_bytes(),
        );
        is_cube(
            &format!("line_{keyword}.off"),
            text.replace('\n', " ").as_bytes(),
        );
    }
    // What does not fit is refused at its line, as before.
    let cut = parse(&off.as_bytes()[..off.len() - 8], MeshFormat::Off).unwrap_err();
    assert!(cut.to_string().contains("face 12 of 12"), "{cut}");
    for unread in ["4OFF\n", "nOFF\n3\n", "4nOFF\n"] {
        assert!(parse(format!("{unread}{body}").as_bytes(), MeshFormat::Off).is_err());
    }
}

/// Text STL files of other kinds: with a zero at the end, in UTF-16, without the first line, after a comment, in one
/// line. At first such a file was read as a binary one of 1,684,234,849 triangles, or had none.
#[test]
fn text_stl_of_many_kinds() {
    let stl = cube().stl_text();
    let (first, rest) = stl.split_once('\n').unwrap();
    let utf16 = |mark: &[u8], unit: fn(u16) -> [u8; 2]| {
        let units = stl.encode_utf16().flat_map(unit);
        mark.iter().copied().chain(units).collect::<Vec<u8>>()
    };
    is_cube("plain.stl", stl.as_bytes());
    is_cube("nul.stl", format!("{stl}\0").as_bytes());
    is_cube("block.stl", format!("{stl}{}", "\0".repeat(700)).as_bytes());
    is_cube(
        "dos.stl",
        format!("{}\x1a", stl.replace('\n', "\r\n")).as_bytes(),
    );
    is_cube("marred.stl", stl.replacen('\n', "\0\n", 1).as_bytes());
    is_cube("little.stl", &utf16(&[0xff, 0xfe], u16::to_le_bytes));
    is_cube("big.stl", &utf16(&[0xfe, 0xff], u16::to_be_bytes));
    is_cube("no_mark.stl", &utf16(&[], u16::to_le_bytes));
    is_cube("no_first_line.stl", rest.as_bytes());
    for comment in ["# exported by a program", "// a", "; a"] {
        is_cube("comment.stl", format!("{comment}\n\n{stl}").as_bytes());
    }
    is_cube(
        "between.stl",
        stl.replace("endfacet", "endfacet\n# next").as_bytes(),
    );
    is_cube("line.stl", stl.replace('\n', " ").as_bytes());
    is_cube("cr.stl", stl.replace('\n', "\r").as_bytes());
    is_cube("upper.stl", stl.to_uppercase().as_bytes());
    is_cube("under_another_name.obj", stl.as_bytes());
    is_cube("none", stl.as_bytes());
    let banner = format!("Exported by a program\nin mm\n{stl}");
    is_cube_with_warning("banner.stl", banner.as_bytes(), &["2 lines before"]);
    // Names may be anything.
    for name in [
        "solid facet",
        "solid outer vertex",
        "solid",
        "solid solid of a facet",
    ] {
        is_cube("name.stl", format!("{name}\n{rest}").as_bytes());
    }
    let name = first.strip_prefix("solid ").unwrap();
    is_cube(
        "name_line.stl",
        stl.replace(name, "facet vertex")
            .replace('\n', " ")
            .as_bytes(),
    );
    is_cube(
        "nan_normals.stl",
        stl.replace("normal 0 0 0", "normal nan -nan(ind) 0")
            .as_bytes(),
    );
    // Bodies of OBJ and PLY under the name.
    is_cube("obj.stl", cube().obj().as_bytes());
    is_cube("ply.stl", cube().ply_text().as_bytes());
}

/// Files of other kinds are named, in place of a count of triangles that their first bytes make.
#[test]
fn other_kinds_are_named() {
    let step = "ISO-10303-21;\nHEADER;\nENDSEC;\n".repeat(10);
    let html = "<!DOCTYPE html><html><body>404 not found</body></html>".repeat(10);
    let pointer = format!(
        "version https://git-lfs.github.com/spec/v1\noid sha256:{}\nsize 1234567\n",
        "0123456789abcdef".repeat(4)
    );
    for (bytes, kind, remedy) in [
        (step.as_bytes(), "STEP", "CAD"),
        (html.as_bytes(), "HTML", "download"),
        (pointer.as_bytes(), "Git LFS", "git lfs pull"),
        (b"\x1f\x8b\x08\0\0\0\0\0\0\x03abc", "gzip", "unpack"),
        (
            b"PK\x03\x04\x14\0\0\0\x08\x003D/3dmodel.model",
            "3MF",
            "export",
        ),
        (b"<?xml version=\"1.0\"?>\n<COLLADA>", "COLLADA", "export"),
        (b"{\"asset\":{\"version\":\"2.0\"}}", "glTF", "export"),
        (b"%PDF-1.4\n", "PDF", "give"),
    ] {
        for name in ["a.stl", "a.obj", "a.ply", "a.off", "a.3mf", "a"] {
            let error = named(name, bytes).unwrap_err();
            assert!(error.message().contains(kind), "{name}: {error}");
            assert!(
                error.message().contains("not a mesh that can be read"),
                "{name}: {error}"
            );
            assert!(error.remedy().unwrap().contains(remedy), "{error:?}");
        }
    }
    // Text of no known kind shows how it begins.
    for name in ["letter.stl", "letter.ply", "letter.obj"] {
        let error = named(name, b"Dear all,\nthe mesh is late.\n").unwrap_err();
        assert!(
            error.to_string().contains("Dear all") && error.line() == Some(1),
            "{error}"
        );
    }
    // Binary data where text is needed.
    let random: Vec<u8> = (0..500u32).map(|i| (i * i % 251) as u8).collect();
    for name in ["a.obj", "a.off"] {
        assert!(
            named(name, &random)
                .unwrap_err()
                .to_string()
                .contains("binary")
        );
    }
}

/// A header that promised 12 triangles hid the other 12; one of none, as OpenSCAD writes to a pipe, hid all.
#[test]
fn binary_stl_whose_count_is_wrong() {
    let two = cube().and(&cuboid([20.0; 3], [30.0; 3]));
    let with_count = |surface: &Surface, count: u32| {
        let mut bytes = surface.stl_binary();
        bytes[80..84].copy_from_slice(&count.to_le_bytes());
        bytes
    };
    for (count, words) in [
        (12, "promises 12 triangles, but more records follow; 24"),
        (1, "promises 1 triangles"),
        (0, "promises 0 triangles"),
        (25, "promises 25 triangles, but the file holds 24"),
        (u32::MAX, "the file holds 24"),
    ] {
        let (mesh, report) = parse(&with_count(&two, count), MeshFormat::Stl).unwrap();
        assert!((mesh.volume() - 2000.0).abs() < 1e-9, "{count}: {report}");
        assert!(
            report.warnings()[0].contains(words),
            "{:?}",
            report.warnings()
        );
        assert!(!report.is_sound() && report.is_closed());
    }
    // A second file behind the first.
    let joined = [
        cube().stl_binary(),
        cuboid([20.0; 3], [30.0; 3]).stl_binary(),
    ]
    .concat();
    let (mesh, report) = parse(&joined, MeshFormat::Stl).unwrap();
    assert!(
        (mesh.volume() - 2000.0).abs() < 1e-9 && report.warnings().len() == 1,
        "{report}"
    );
    // What fills up a block, or is no triangle, is none.
    let cube_bytes = cube().stl_binary();
    for tail in [vec![0; 600], b"written by a program ".repeat(20)] {
        let bytes = [&cube_bytes[..], &tail].concat();
        is_cube_with_warning("tail.stl", &bytes, &["not read"]);
    }
    is_cube("short_tail.stl", &[&cube_bytes[..], b"\n"].concat());
    // A file cut short inside a record is refused.
    for end in [cube_bytes.len() - 1, cube_bytes.len() - 20, 100, 84] {
        assert!(parse(&cube_bytes[..end], MeshFormat::Stl).is_err(), "{end}");
    }
}

/// One face of two vertices, a vertex without a place that no face uses, a facet with NaN: the whole file was refused.
#[test]
fn what_bounds_nothing_is_left_out() {
    let cube = cube();
    let obj = cube.obj();
    let after = obj.lines().count();
    let line = |more: usize| format!("line {}", after + more);
    is_cube_with_warning(
        "two.obj",
        format!("{obj}f 1 2\n").as_bytes(),
        &["face", &line(1)],
    );
    is_cube_with_warning(
        "more.obj",
        format!("{obj}f 1\nf\nf 2/1 3/1\n").as_bytes(),
        &["3 faces", &line(1)],
    );
    for words in ["nan nan nan", "inf 0 0", "0 -nan(ind) 0", "1e300 0 0"] {
        let text = format!("{obj}v {words}\n");
        is_cube_with_warning("unused.obj", text.as_bytes(), &["a vertex", &line(1)]);
    }
    let off = cube.off().replace("8 12 0", "9 14 0").replacen(
        "3 0 4 6",
        "nan 0 0\n2 0 1\n1 5\n3 0 4 6",
        1,
    );
    let (mesh, report) = named("a.off", off.as_bytes()).unwrap();
    assert!(
        (mesh.volume() - 1000.0).abs() < 1e-9 && report.warnings().len() == 2,
        "{report}"
    );
    let ply = cube
        .ply_text()
        .replace("vertex 8", "vertex 9")
        .replace("face 12", "face 13")
        .replacen("3 0 4 6", "nan 0 0\n2 0 1\n3 0 4 6", 1);
    let (mesh, report) = named("a.ply", ply.as_bytes()).unwrap();
    assert!(
        (mesh.volume() - 1000.0).abs() < 1e-9 && report.warnings().len() == 2,
        "{report}"
    );
    // A vertex that a face uses is refused at its line.
    let used = obj.replacen("v 10.0 10.0 0.0", "v 10.0 nan 0.0", 1);
    let error = parse(used.as_bytes(), MeshFormat::Obj).unwrap_err();
    assert_eq!(error.line(), Some(6), "{error}");
    assert!(error.message().contains("coordinate NaN"), "{error}");
    // Facets of STL.
    let stl = cube.stl_text();
    for (facet, words) in [
        (
            "vertex nan nan nan\nvertex 0 0 0\nvertex 1 0 0\n",
            "not finite",
        ),
        ("vertex 0 0 0\nvertex 1 0 0\nvertex 0 inf 0\n", "not finite"),
        ("vertex 0 0 0\nvertex 1 0 0\n", "fewer than three"),
    ] {
        let facet = format!("facet normal 0 0 0\nouter loop\n{facet}endloop\nendfacet\n");
        let text = stl.replacen("endfacet\n", &format!("endfacet\n{facet}"), 1);
        is_cube_with_warning("facet.stl", text.as_bytes(), &[words, "on line "]);
    }
    let mut bytes = cube
        .and(&Surface {
            positions: vec![[0.0, f64::NAN, 0.0]; 3],
            triangles: vec![[0, 1, 2]],
        })
        .stl_binary();
    is_cube_with_warning("nan.stl", &bytes, &["in record 13"]);
    // The first of two.
    bytes[84 + 12..84 + 16].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let (_, report) = named("nan.stl", &bytes).unwrap();
    assert!(
        !report.is_closed() && report.warnings()[0].contains("the first in record 1"),
        "{:?}",
        report.warnings()
    );
}
