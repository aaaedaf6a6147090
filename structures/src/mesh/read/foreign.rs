//! Files of other kinds under a mesh's name, or under none: their kinds, and the files to give in their place.

use crate::error::Error;
use crate::mesh::read::encoding::text_of;
use crate::mesh::read::words::lines;

const CONVERT: &str = "export the surface as STL, OBJ, PLY or OFF from a program that opens it";
const UNPACK: &str = "unpack it, and give the STL, OBJ, PLY or OFF file that is in it";
const TESSELLATE: &str =
    "it has curved faces and no triangles: export a mesh (STL) from a CAD program that opens it";
const NO_MESH: &str = "give an STL, OBJ, PLY or OFF file";
const DOWNLOAD: &str = "download the file itself: a server sent a page, or an error, in its place";
const FETCH: &str = "fetch the file that it stands for with `git lfs pull`";
const MOLECULE: &str = "give molecules to `knotdock dock`; meshes are STL, OBJ, PLY or OFF files";

/// First bytes of files that are no text, their kinds, and the remedies.
const BINARY: [(&[u8], &str, &str); 29] = [
    (b"\x1f\x8b", "a gzip archive", UNPACK),
    (b"BZh", "a bzip2 archive", UNPACK),
    (b"\xfd7zXZ\0", "an xz archive", UNPACK),
    (b"\x28\xb5\x2f\xfd", "a Zstandard archive", UNPACK),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", UNPACK),
    (b"Rar!\x1a\x07", "a RAR archive", UNPACK),
    (b"%PDF", "a PDF document", NO_MESH),
    (b"\x89PNG", "a PNG picture", NO_MESH),
    (b"\xff\xd8\xff", "a JPEG picture", NO_MESH),
    (b"GIF8", "a GIF picture", NO_MESH),
    (b"II*\0", "a TIFF picture", NO_MESH),
    (b"MM\0*", "a TIFF picture", NO_MESH),
    (b"RIFF", "a RIFF file (picture, sound or film)", NO_MESH),
    (b"glTF", "a binary glTF scene (.glb)", CONVERT),
    (b"Kaydara FBX Binary", "an FBX scene", CONVERT),
    (b"BLENDER", "a Blender scene", CONVERT),
    (b"3D Geometry File Format", "a Rhino model (.3dm)", CONVERT),
    (b"PXR-USDC", "a USD scene", CONVERT),
    (b"OpenCTM", "an OpenCTM mesh", CONVERT),
    (b"DRACO", "a Draco mesh", CONVERT),
    (b"AC10", "an AutoCAD drawing (.dwg)", TESSELLATE),
    (
        b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
        "a document of a CAD or office program",
        TESSELLATE,
    ),
    (b"\x89HDF", "an HDF5 file", CONVERT),
    (b"CDF\x01", "a NetCDF file", CONVERT),
    (b"CDF\x02", "a NetCDF file", CONVERT),
    (b"SQLite format 3\0", "an SQLite database", NO_MESH),
    (b"\x7fELF", "a program", NO_MESH),
    (b"MZ", "a program", NO_MESH),
    (b"Zip\0", "an archive", UNPACK),
];

/// Beginnings of texts, in small letters.
const TEXTS: [(&str, &str, &str); 24] = [
    ("version https://git-lfs", "a Git LFS pointer", FETCH),
    ("oid sha256:", "a Git LFS pointer", FETCH),
    ("<!doctype html", "an HTML page", DOWNLOAD),
    ("<html", "an HTML page", DOWNLOAD),
    ("iso-10303-21", "a STEP file", TESSELLATE),
    ("#vrml", "a VRML scene", CONVERT),
    ("#x3d", "an X3D scene", CONVERT),
    ("#inventor", "an Open Inventor scene", CONVERT),
    ("#usda", "a USD scene", CONVERT),
    ("# vtk datafile", "a VTK file", CONVERT),
    ("; fbx", "an FBX scene", CONVERT),
    ("**abcdef", "a Parasolid model", TESSELLATE),
    ("$meshformat", "a Gmsh mesh", CONVERT),
    ("meshversionformatted", "a Medit mesh", CONVERT),
    ("*heading", "an Abaqus input", CONVERT),
    ("%!ps", "a PostScript document", NO_MESH),
    ("{\\rtf", "an RTF document", NO_MESH),
    ("header ", "a PDB file", MOLECULE),
    ("remark ", "a PDB file", MOLECULE),
    ("cryst1", "a PDB file", MOLECULE),
    ("atom  ", "a PDB file", MOLECULE),
    ("hetatm", "a PDB file", MOLECULE),
    ("data_", "an mmCIF file", MOLECULE),
    ("-----begin", "a key or a certificate", NO_MESH),
];

/// Elements that XML documents are detected from, in small letters.
const ELEMENTS: [(&str, &str, &str); 10] = [
    ("<html", "an HTML page", DOWNLOAD),
    ("<collada", "a COLLADA scene (.dae)", CONVERT),
    ("<x3d", "an X3D scene", CONVERT),
    ("<vtkfile", "a VTK file", CONVERT),
    ("<amf", "an AMF model", CONVERT),
    ("<svg", "an SVG picture", NO_MESH),
    ("<model", "the XML part of a 3MF model", CONVERT),
    ("<error", "an error message of a server", DOWNLOAD),
    (
        "<robot",
        "a URDF robot",
        "give one of the meshes that it names",
    ),
    (
        "<sdf",
        "an SDF scene",
        "give one of the meshes that it names",
    ),
];

/// Refuses what is surely a file of another kind.
pub fn refuse(bytes: &[u8]) -> Result<(), Error> {
    match kind_of(bytes) {
        Some((kind, remedy)) => {
            Err(Error::input(format!("this is {kind}, not a mesh that can be read")).help(remedy))
        }
        None => Ok(()),
    }
}

/// The kind of a file that is not a mesh, and the remedy; none if that is not sure.
fn kind_of(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
        return Some(zip(bytes));
    }
    let known = BINARY.iter().find(|(start, ..)| bytes.starts_with(start));
    // Letters alone may begin a text.
    let text = text_of(bytes);
    if let Some(&(start, kind, remedy)) = known
        && (text.is_none() || ![&b"BZh"[..], b"MZ", b"AC10", b"RIFF", b"DRACO"].contains(&start))
    {
        return Some((kind, remedy));
    }
    let Some(text) = text else {
        return binary(bytes);
    };
    let start: String = text.trim_start().chars().take(4096).collect();
    let start = start.to_ascii_lowercase();
    if let Some(&(_, kind, remedy)) = TEXTS.iter().find(|(begins, ..)| start.starts_with(begins)) {
        return Some((kind, remedy));
    }
    if start.starts_with('<') {
        let known = ELEMENTS
            .iter()
            .find(|(element, ..)| start.contains(element));
        return Some(
            known.map_or(("an XML document", CONVERT), |&(_, kind, remedy)| {
                (kind, remedy)
            }),
        );
    }
    if start.starts_with('{') || start.starts_with('[') {
        let is_gltf = start.contains("\"asset\"") || text.contains("\"meshes\"");
        return Some(if is_gltf {
            ("a glTF scene", CONVERT)
        } else {
            ("a JSON document", NO_MESH)
        });
    }
    exchange(&text)
}

/// What a ZIP archive holds, by the names of its files.
fn zip(bytes: &[u8]) -> (&'static str, &'static str) {
    let holds = |name: &[u8]| bytes.windows(name.len()).any(|part| part == name);
    if holds(b"3D/3dmodel.model") || holds(b".model") && holds(b"3D/") {
        ("a 3MF model", CONVERT)
    } else if holds(b".usdc") || holds(b".usda") {
        ("a USD scene (.usdz)", CONVERT)
    } else if holds(b"Document.xml") && holds(b".brp") {
        ("a FreeCAD document", TESSELLATE)
    } else if holds(b"word/") || holds(b"xl/") || holds(b"ppt/") {
        ("an office document", NO_MESH)
    } else {
        ("a ZIP archive", UNPACK)
    }
}

/// Binary files that are detected from more than their first bytes.
fn binary(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let length_at = |place: usize| {
        let bytes = bytes.get(place..place + 4)?.try_into().ok()?;
        usize::try_from(u32::from_le_bytes(bytes)).ok()
    };
    if bytes.get(257..262) == Some(b"ustar") {
        return Some(("a tar archive", UNPACK));
    }
    // A chunk that is as long as the file; a picture that says how long it is.
    if bytes.starts_with(b"MM") && length_at(2) == Some(bytes.len()) {
        return Some(("a 3D Studio scene (.3ds)", CONVERT));
    }
    if bytes.starts_with(b"BM") && length_at(2) == Some(bytes.len()) {
        return Some(("a BMP picture", NO_MESH));
    }
    None
}

/// Exchange formats of CAD programs that are detected from their lines.
fn exchange(text: &str) -> Option<(&'static str, &'static str)> {
    // IGES numbers its lines from the 73rd column, after the letter of a section.
    let is_iges = |line: &str| {
        line.len() >= 73
            && line.is_ascii()
            && matches!(line.as_bytes().get(72), Some(b'S' | b'G'))
            && line
                .get(73..80.min(line.len()))
                .is_some_and(|number| number.trim() == "1")
    };
    if text.lines().take(2).any(is_iges) {
        return Some(("an IGES file", TESSELLATE));
    }
    let mut lines = lines(text, false).map(|line| line.text);
    if (lines.next(), lines.next()) == (Some("0"), Some("SECTION")) {
        return Some(("a DXF drawing", CONVERT));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_detected_from_what_files_begin_with() {
        let iges = format!("{:72}S      1\n{:72}G      1\n", "", "1H,,1H;,");
        for (bytes, expected) in [
            (&b"\x1f\x8b\x08\0"[..], "gzip"),
            (b"PK\x03\x04\x14\0\0\0\x08\0....3D/3dmodel.model", "3MF"),
            (b"PK\x03\x04\x14\0\0\0\x08\0....part.stl", "ZIP"),
            (b"glTF\x02\0\0\0", "glTF"),
            (b"%PDF-1.7\n", "PDF"),
            (b"\x89PNG\r\n\x1a\n", "PNG"),
            (b"\xff\xd8\xff\xe0", "JPEG"),
            (
                b"version https://git-lfs.github.com/spec/v1\noid",
                "Git LFS",
            ),
            (b"\n <!DOCTYPE html><html>", "HTML"),
            (b"<?xml version=\"1.0\"?>\n<html>", "HTML"),
            (b"<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"\">", "COLLADA"),
            (b"<?xml version=\"1.0\"?>\n<X3D>", "X3D"),
            (b"<?xml version=\"1.0\"?>\n<a>", "XML"),
            (b"{\"asset\": {\"version\": \"2.0\"}}", "glTF"),
            (b"{\"message\": \"Not Found\"}", "JSON"),
            (b"ISO-10303-21;\nHEADER;\n", "STEP"),
            (b"#VRML V2.0 utf8\n", "VRML"),
            (b"# vtk DataFile Version 3.0\n", "VTK"),
            (b"  0\nSECTION\n  2\nHEADER\n", "DXF"),
            (b"ATOM      1  N   ALA A   1", "PDB"),
            (b"data_1ABC\n", "mmCIF"),
            (iges.as_bytes(), "IGES"),
        ] {
            let found = kind_of(bytes).map(|(kind, _)| kind);
            assert!(
                found.is_some_and(|kind| kind.contains(expected)),
                "{expected}: {found:?}"
            );
        }
        for mesh in [
            "solid a\n",
            "# a comment\nv 0 0 0\n",
            "OFF\n",
            "ply\n",
            "v 1 2 3\n",
            "mtllib a.mtl\n",
            "",
        ] {
            assert_eq!(kind_of(mesh.as_bytes()), None, "{mesh}");
        }
    }
}
