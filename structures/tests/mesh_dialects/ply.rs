//! PLY files of other programs, as text and binary.

use super::{cube, is_cube};

/// Numbers that are none in properties that no mesh needs, blank lines, strips of triangles, indices of other types:
/// all were refused.
#[test]
fn ply_dialects() {
    let ply = cube().ply_text();
    let (head, body) = ply.split_once("end_header\n").unwrap();
    is_cube("plain.ply", ply.as_bytes());
    let (vertices, faces) = body.split_at(body.match_indices('\n').nth(7).unwrap().0 + 1);
    // Properties between the coordinates, and numbers that are none.
    let with_normals = head.replace(
        "property double z\n",
        "property float nx\nproperty double z\nproperty uchar red\n",
    );
    for word in [
        "nan", "-nan", "NaN", "inf", "-inf", "1.#QNAN", "-1.#IND", "nan(ind)", "1.", ".5",
    ] {
        let lines = vertices.lines().map(|line| {
            let (start, z) = line.rsplit_once(' ').unwrap();
            format!("{start} {word} {z} 255\n")
        });
        let text = format!(
            "{with_normals}end_header\n{}{faces}",
            lines.collect::<String>()
        );
        is_cube("normals.ply", text.as_bytes());
    }
    for (name, text) in [
        (
            "blank.ply",
            format!("{head}end_header\n\n{vertices}\n\n{faces}\n\n"),
        ),
        (
            "blank_head.ply",
            ply.replace(
                "comment test\n",
                "comment\n\n\ncomment\tx\nobj_info\nobj_info a b\n",
            ),
        ),
        ("crlf.ply", ply.replace('\n', "\r\n")),
        ("cr.ply", ply.replace('\n', "\r")),
        (
            "crlf_head.ply",
            format!("{}end_header\r\n{body}", head.replace('\n', "\r\n")),
        ),
        (
            "spaces.ply",
            ply.replace('\n', "  \n").replace("element ", "element  "),
        ),
        (
            "line.ply",
            format!("{head}end_header\n{}", body.replace('\n', " ")),
        ),
        (
            "word.ply",
            format!("{head}end_header\n{}", body.replace(' ', "\n")),
        ),
        (
            "short.ply",
            ply.replace("double", "float64")
                .replace("uchar int", "uint8 int32"),
        ),
        ("index.ply", ply.replace("vertex_indices", "vertex_index")),
        ("float.ply", ply.replace("uchar int", "uchar float")),
        ("real.ply", ply.replace("uchar int", "int double")),
        (
            "real_words.ply",
            format!(
                "{head}end_header\n{vertices}{}",
                faces.replace("3 ", "3.0 ")
            )
            .replace("uchar int", "float double"),
        ),
        (
            "list.ply",
            format!(
                "{}property list uchar float texcoord\nend_header\n{vertices}{}",
                head,
                faces.replace('\n', " 2 0.5 nan\n")
            ),
        ),
        (
            "edges.ply",
            format!(
                "{head}element edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n\
                 {body}0 1\n1 2\n"
            ),
        ),
        (
            "first.ply",
            format!(
                "{}end_header\n1 2.5 nan\n{body}",
                head.replace(
                    "element vertex",
                    "element camera 1\nproperty int a\nproperty float b\nproperty float c\n\
                     element vertex"
                )
            ),
        ),
        ("faces_first.ply", {
            let (vertex, face) = head.split_at(head.find("element face").unwrap());
            let start = vertex.find("element vertex").unwrap();
            format!(
                "{}{face}{}end_header\n{faces}{vertices}",
                &vertex[..start],
                &vertex[start..]
            )
        }),
    ] {
        is_cube(name, text.as_bytes());
    }
    let latin = ply.replace("comment test", "comment Gr\u{1}e").into_bytes();
    let latin: Vec<u8> = latin
        .iter()
        .map(|&b| if b == 1 { 0xdf } else { b })
        .collect();
    is_cube("latin.ply", &latin);
    // Strips: each triangle by itself, and two to a strip, of which the second runs the other way in the file.
    let strips = |lists: &[Vec<i32>]| {
        let head = head.replace(
            "element face 12",
            &format!("element tristrips {}", lists.len()),
        );
        let lists = lists.iter().map(|list| {
            let words: Vec<String> = list.iter().map(i32::to_string).collect();
            format!("{} {}\n", list.len(), words.join(" "))
        });
        format!(
            "{}end_header\n{vertices}{}",
            head.replace("uchar int", "int int"),
            lists.collect::<String>()
        )
    };
    let triangles: Vec<[i32; 3]> = cube()
        .triangles
        .iter()
        .map(|t| t.map(|corner| corner as i32))
        .collect();
    let each: Vec<i32> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [a, b, c, -1])
        .collect();
    is_cube("strip.ply", strips(&[each]).as_bytes());
    let quads = triangles.chunks(2).map(|pair| {
        let ([a, b, c], [_, _, d]) = (pair[0], pair[1]);
        vec![b, c, a, d]
    });
    is_cube("strips.ply", strips(&quads.collect::<Vec<_>>()).as_bytes());
}

/// The same in binary: lists of every type, both orders of bytes, a header of other lines.
#[test]
fn binary_ply_dialects() {
    type Bytes = fn(f64) -> Vec<u8>;
    let types: [(&str, usize, Bytes); 8] = [
        ("char", 1, |x| (x as i8).to_be_bytes().to_vec()),
        ("uint8", 1, |x| (x as u8).to_be_bytes().to_vec()),
        ("int16", 2, |x| (x as i16).to_be_bytes().to_vec()),
        ("ushort", 2, |x| (x as u16).to_be_bytes().to_vec()),
        ("int", 4, |x| (x as i32).to_be_bytes().to_vec()),
        ("uint32", 4, |x| (x as u32).to_be_bytes().to_vec()),
        ("float", 4, |x| (x as f32).to_be_bytes().to_vec()),
        ("float64", 8, |x| x.to_be_bytes().to_vec()),
    ];
    for (name, size, bytes_of) in types {
        for big in [true, false] {
            for end in ["\n", "\r\n", "\n\n"] {
                let put = |x: f64| {
                    let mut bytes = bytes_of(x);
                    assert_eq!(bytes.len(), size);
                    if !big {
                        bytes.reverse();
                    }
                    bytes
                };
                let order = if big { "big" } else { "little" };
                let head = format!(
                    "ply\nformat binary_{order}_endian 1.0\ncomment\nelement vertex 8\nproperty {name} x\n\
                     property {name} y\n\
                     property {name} z\nelement face 12\nproperty list uchar {name} vertex_indices\nend_header"
                );
                let line_end = end.trim_end_matches('\n').to_owned() + "\n";
                let mut bytes = (head.replace('\n', &line_end) + end).into_bytes();
                let cube = cube();
                bytes.extend(cube.positions.iter().flatten().flat_map(|&x| put(x)));
                for triangle in &cube.triangles {
                    bytes.push(3);
                    bytes.extend(triangle.iter().flat_map(|&corner| put(f64::from(corner))));
                }
                is_cube(&format!("{name}_{order}.ply"), &bytes);
            }
        }
    }
}
