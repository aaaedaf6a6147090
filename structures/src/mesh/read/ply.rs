//! PLY, text and binary: elements `vertex` (x, y, z of any number type), `face` and `tristrips` (`vertex_indices` or
//! `vertex_index`, a list of any number type). Other elements and properties are passed over.

use crate::error::Error;
use crate::mesh::read::soup::{At, Soup, broken, vertex};
use crate::mesh::read::words::{Line, Records, by_line_or_stream, lines, real, shortened};

/// Role of an element of the file in the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Vertex,
    Face,
    /// Triangles that each share two vertices with the one before; a negative number ends a strip.
    Strip,
    Other,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Signed,
    Unsigned,
    Float,
}

/// Type of a number: its kind, and its size in bytes.
type Scalar = (Kind, usize);

fn scalar(name: &str) -> Option<Scalar> {
    Some(match name {
        "char" | "int8" => (Kind::Signed, 1),
        "uchar" | "uint8" => (Kind::Unsigned, 1),
        "short" | "int16" => (Kind::Signed, 2),
        "ushort" | "uint16" => (Kind::Unsigned, 2),
        "int" | "int32" => (Kind::Signed, 4),
        "uint" | "uint32" => (Kind::Unsigned, 4),
        "float" | "float32" => (Kind::Float, 4),
        "double" | "float64" => (Kind::Float, 8),
        _ => return None,
    })
}

/// Role of a number of the file in the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Use {
    /// Along this axis.
    Coordinate(usize),
    Length,
    Index,
    None,
}

#[derive(Debug)]
struct Property {
    name: String,
    kind: Scalar,
    /// Type of the length; none for a single number.
    length: Option<Scalar>,
    role: Use,
}

#[derive(Debug)]
struct Element {
    name: String,
    role: Role,
    count: usize,
    properties: Vec<Property>,
}

impl Element {
    /// Refuses an element that lacks a property that its role needs.
    fn check(&self) -> Result<(), Error> {
        let has = |role: Use| self.properties.iter().any(|property| property.role == role);
        match self.role {
            Role::Vertex if !(0..3).all(|axis| has(Use::Coordinate(axis))) => {
                let fault = "the vertices lack one of the properties x, y and z";
                Err(broken(None, fault))
            }
            Role::Face | Role::Strip if !has(Use::Index) => {
                Err(broken(None, "the faces lack the list vertex_indices"))
            }
            _ => Ok(()),
        }
    }

    fn property(&self, kind: Scalar, length: Option<Scalar>, name: &str) -> Property {
        let role = match (self.role, name, length) {
            (Role::Vertex, "x", None) => Use::Coordinate(0),
            (Role::Vertex, "y", None) => Use::Coordinate(1),
            (Role::Vertex, "z", None) => Use::Coordinate(2),
            (Role::Face | Role::Strip, "vertex_indices" | "vertex_index", Some(_)) => Use::Index,
            _ => Use::None,
        };
        Property {
            name: name.to_owned(),
            kind,
            length,
            role,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Whether a file begins as a PLY file does.
pub fn begins(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    start.starts_with(b"ply") && start.get(3).is_none_or(u8::is_ascii_whitespace)
}

/// Reads a file.
pub fn parse(bytes: &[u8]) -> Result<Soup, Error> {
    let header = header(bytes)?;
    let (elements, payload) = (header.elements, header.payload);
    if !elements.iter().any(|element| element.role == Role::Vertex) {
        return Err(broken(None, "the header has no element vertex"));
    }
    if header.encoding != Encoding::Text {
        return binary(&elements, payload, header.encoding == Encoding::BigEndian);
    }
    let text = String::from_utf8_lossy(payload);
    let lines = lines(&text, false).map(|line| Line {
        number: line.number + header.lines,
        ..line
    });
    by_line_or_stream(&lines, (), &[()], |words, ()| {
        read(&elements, &mut Data::Text(words))?.into_soup()
    })
}

struct Header<'a> {
    encoding: Encoding,
    elements: Vec<Element>,
    /// The bytes after it.
    payload: &'a [u8],
    /// Its lines.
    lines: usize,
}

fn header(bytes: &[u8]) -> Result<Header<'_>, Error> {
    let lead = bytes.len() - bytes.trim_ascii_start().len();
    let (blank, start) = bytes.split_at(lead);
    let mut number = blank.iter().filter(|&&byte| byte == b'\n').count();
    if !begins(bytes) {
        let first = start.split(|&byte| matches!(byte, b'\n' | b'\r')).next();
        return Err(match first {
            Some(first) if !first.is_empty() => {
                let first = String::from_utf8_lossy(first);
                let first = shortened(&first);
                let fault = format!("this is no PLY: it begins with '{first}' in place of 'ply'");
                broken(number + 1, fault)
            }
            _ => broken(None, "the file is empty"),
        });
    }
    // Old systems end lines in CR alone.
    let end = match start.get(3..5) {
        Some(&[b'\r', next]) if next != b'\n' => b'\r',
        _ => b'\n',
    };
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut rest = start;
    while let Some(length) = rest.iter().position(|&byte| byte == end) {
        let line = String::from_utf8_lossy(&rest[..length]);
        rest = &rest[length + 1..];
        number += 1;
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let fault = || {
            let line = shortened(line.trim());
            broken(number, format!("'{line}' is no line of a PLY header"))
        };
        match (words.as_slice(), elements.last_mut()) {
            (["ply"] | [] | ["comment" | "obj_info", ..], _) => {}
            (["format", name, _], _) => {
                encoding = Some(match *name {
                    "ascii" => Encoding::Text,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    _ => return Err(fault()),
                });
            }
            (["element", name, count], _) => elements.push(Element {
                name: (*name).to_owned(),
                role: match *name {
                    "vertex" => Role::Vertex,
                    "face" => Role::Face,
                    "tristrips" => Role::Strip,
                    _ => Role::Other,
                },
                count: count.parse().map_err(|_| fault())?,
                properties: Vec::new(),
            }),
            (["property", "list", length, kind, name], Some(element)) => {
                let [length, kind] = [length, kind].map(|word| scalar(word).ok_or_else(fault));
                let property = element.property(kind?, Some(length?), name);
                element.properties.push(property);
            }
            (["property", kind, name], Some(element)) => {
                let kind = scalar(kind).ok_or_else(fault)?;
                element.properties.push(element.property(kind, None, name));
            }
            (["end_header"], _) => {
                let encoding =
                    encoding.ok_or_else(|| broken(None, "the header has no line 'format'"))?;
                return Ok(Header {
                    encoding,
                    elements,
                    payload: rest,
                    lines: number,
                });
            }
            _ => return Err(fault()),
        }
    }
    let fault = "the header does not end: there is no line 'end_header'";
    Err(broken(None, fault))
}

fn binary(elements: &[Element], payload: &[u8], is_big: bool) -> Result<Soup, Error> {
    let read = |rest| {
        let mut data: Data<'_, '_, std::iter::Empty<_>> = Data::Binary { rest, is_big };
        let faces = read(elements, &mut data)?;
        let left = matches!(data, Data::Binary { rest, .. } if !rest.is_empty());
        Ok((faces, left))
    };
    let found = read(payload);
    let blanks = [&b"\r\n"[..], b"\n", b"\r"];
    let blank = blanks.into_iter().find_map(|end| payload.strip_prefix(end));
    // Some writers put a blank line before the data, which then fit the length better without it.
    if !matches!(found, Ok((_, false)))
        && let Some(data) = blank
        && let Ok((faces, false)) = read(data)
    {
        return faces.into_soup();
    }
    found.and_then(|(faces, _)| faces.into_soup())
}

/// The data after the header.
enum Data<'r, 'a, L> {
    Text(&'r mut Records<'a, L>),
    Binary { rest: &'a [u8], is_big: bool },
}

impl<'a, L: Iterator<Item = Line<'a>>> Data<'_, 'a, L> {
    /// The next number; zero for one without a use.
    fn number(
        &mut self,
        kind: Scalar,
        role: Use,
        soup: &mut Soup,
        what: impl Fn() -> String,
    ) -> Result<f64, Error> {
        let words = match self {
            Self::Text(words) => words,
            Self::Binary { rest, is_big } => {
                let (kind, size) = kind;
                let Some((own, after)) = rest.split_at_checked(size) else {
                    let fault = format!("the file ends where {} is needed", what());
                    return Err(broken(None, fault));
                };
                *rest = after;
                let bits = (0..size).fold(0, |bits, place| {
                    let byte = own[if *is_big { place } else { size - 1 - place }];
                    bits << 8 | u64::from(byte)
                });
                let unused = 64 - 8 * size;
                return Ok(match kind {
                    Kind::Unsigned => bits as f64,
                    Kind::Signed => ((bits << unused) as i64 >> unused) as f64,
                    Kind::Float if size == 4 => f64::from(f32::from_bits(bits as u32)),
                    Kind::Float => f64::from_bits(bits),
                });
            }
        };
        let Some(word) = words.next() else {
            let fault = format!("the line ends where {} is needed", what());
            return Err(words.line.fault(fault));
        };
        let (found, needed) = match role {
            Use::None => return Ok(0.0),
            Use::Coordinate(_) => {
                soup.digits.note(word);
                let is_single = kind == (Kind::Float, 4);
                let single = word.parse::<f32>().ok().filter(|_| is_single);
                (single.map(f64::from).or_else(|| real(word)), "a coordinate")
            }
            Use::Length => {
                let length = word.parse().ok().filter(|&length| whole(length) >= 0);
                (length, "the length of a list")
            }
            Use::Index => (word.parse().ok(), "the index of a vertex"),
        };
        found.ok_or_else(|| words.line.misplaced(word, needed))
    }
}

fn read<'a, L: Iterator<Item = Line<'a>>>(
    elements: &[Element],
    data: &mut Data<'_, 'a, L>,
) -> Result<FaceLists, Error> {
    let mut faces = FaceLists::default();
    for element in elements {
        element.check()?;
        let Element {
            name, role, count, ..
        } = element;
        for index in 1..=*count {
            if element.properties.is_empty() {
                break;
            }
            let at = match data {
                Data::Text(words) => {
                    words.begin(|| format!("{name} {index} of {count}"))?;
                    At::Line(words.line.number)
                }
                Data::Binary { .. } => At::Face(index),
            };
            let mut position = [0.0; 3];
            let mut indices = Vec::new();
            for property in &element.properties {
                let what = || format!("the property {} of {name} {index}", property.name);
                let soup = &mut faces.soup;
                let count = match property.length {
                    Some(length) => whole(data.number(length, Use::Length, soup, what)?),
                    None => 1,
                };
                for _ in 0..count {
                    let value = data.number(property.kind, property.role, soup, what)?;
                    match property.role {
                        Use::Coordinate(axis) => position[axis] = value,
                        Use::Index => indices.push(whole(value)),
                        Use::Length | Use::None => {}
                    }
                }
            }
            match role {
                Role::Vertex => {
                    faces.soup.push_vertex(position, at.line())?;
                }
                Role::Face | Role::Strip => faces.lists.push((*role, at, indices)),
                Role::Other => {}
            }
        }
    }
    Ok(faces)
}

/// A whole number, in whatever type it is written; any other number names no vertex.
fn whole(value: f64) -> i64 {
    if value.fract() == 0.0 {
        value as i64
    } else {
        i64::MIN
    }
}

/// Faces as a file lists them, which may be before the vertices that they name.
#[derive(Debug, Default)]
struct FaceLists {
    soup: Soup,
    /// Role, place and numbers of vertices.
    lists: Vec<(Role, At, Vec<i64>)>,
}

impl FaceLists {
    /// Faces checked and cut out of strips.
    fn into_soup(self) -> Result<Soup, Error> {
        let Self { mut soup, lists } = self;
        let vertices = soup.positions.len();
        let mut corners = Vec::new();
        for (role, at, indices) in lists {
            for run in indices.split(|&index| role == Role::Strip && index < 0) {
                corners.clear();
                for &index in run {
                    corners.push(vertex(at.line(), index, index, vertices)?);
                }
                if role != Role::Strip {
                    soup.push_face(&corners, at);
                    continue;
                }
                for (number, window) in corners.windows(3).enumerate() {
                    if let &[a, b, c] = window
                        && a != b
                        && b != c
                        && c != a
                    {
                        // Every other triangle of a strip runs the other way.
                        let is_even = number % 2 == 0;
                        soup.push_face(&if is_even { [a, b, c] } else { [b, a, c] }, at);
                    }
                }
            }
        }
        Ok(soup)
    }
}
