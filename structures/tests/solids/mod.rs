//! Meshes of solids whose volumes and distances are known, and files of them.

use std::f64::consts::PI;
use std::fmt::Write;

use knotdock_structures::mesh::{Mesh, MeshReport, Solid, from_triangles};

/// Vertices and triangles.
#[derive(Clone, Default)]
pub struct Surface {
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

impl Surface {
    pub fn mesh(&self) -> (Mesh, MeshReport) {
        from_triangles(&self.positions, &self.triangles).unwrap()
    }

    pub fn solid(&self) -> Solid {
        Solid::new(&self.mesh().0).unwrap()
    }

    pub fn and(mut self, other: &Surface) -> Self {
        let shift = self.positions.len() as u32;
        self.positions.extend(&other.positions);
        self.triangles.extend(
            other
                .triangles
                .iter()
                .map(|t| t.map(|corner| corner + shift)),
        );
        self
    }

    pub fn inverted(mut self) -> Self {
        for triangle in &mut self.triangles {
            triangle.swap(1, 2);
        }
        self
    }

    pub fn mapped(mut self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        for position in &mut self.positions {
            *position = map(*position);
        }
        self
    }

    pub fn obj(&self) -> String {
        let mut text = String::from("# test\no part\n");
        for [x, y, z] in &self.positions {
            writeln!(text, "v {x:?} {y:?} {z:?}").unwrap();
        }
        for t in &self.triangles {
            let [a, b, c] = t.map(|corner| corner + 1);
            writeln!(text, "f {a}/1/1 {b}//2 {c}").unwrap();
        }
        text
    }

    pub fn off(&self) -> String {
        let mut text = format!(
            "OFF\n# test\n{} {} 0\n",
            self.positions.len(),
            self.triangles.len()
        );
        for [x, y, z] in &self.positions {
            writeln!(text, "{x:?} {y:?} {z:?}").unwrap();
        }
        for [a, b, c] in &self.triangles {
            writeln!(text, "3 {a} {b} {c} 255 0 0").unwrap();
        }
        text
    }

    pub fn stl_text(&self) -> String {
        let mut text = String::from("solid a name with spaces\n");
        for t in &self.triangles {
            text += "facet normal 0 0 0\n outer loop\n";
            for corner in t {
                let [x, y, z] = self.positions[*corner as usize];
                writeln!(text, "  vertex {x:?} {y:?} {z:?}").unwrap();
            }
            text += " endloop\nendfacet\n";
        }
        text + "endsolid a name with spaces\n"
    }

    pub fn stl_binary(&self) -> Vec<u8> {
        // Many writers begin the header with the word of the text format.
        let mut bytes = b"solid binary".to_vec();
        bytes.resize(80, b' ');
        bytes.extend((self.triangles.len() as u32).to_le_bytes());
        for t in &self.triangles {
            bytes.extend([0; 12]);
            for corner in t {
                for value in self.positions[*corner as usize] {
                    bytes.extend((value as f32).to_le_bytes());
                }
            }
            bytes.extend([0; 2]);
        }
        bytes
    }

    pub fn ply_text(&self) -> String {
        let mut text = format!(
            "ply\nformat ascii 1.0\ncomment test\nelement vertex {}\nproperty double x\nproperty double y\n\
             property double z\n\
             element face {}\nproperty list uchar int vertex_indices\nend_header\n",
            self.positions.len(),
            self.triangles.len()
        );
        for [x, y, z] in &self.positions {
            writeln!(text, "{x:?} {y:?} {z:?}").unwrap();
        }
        for [a, b, c] in &self.triangles {
            writeln!(text, "3 {a} {b} {c}").unwrap();
        }
        text
    }

    pub fn ply_binary(&self, big_endian: bool) -> Vec<u8> {
        let bytes_of = |mut bytes: Vec<u8>| {
            if big_endian {
                bytes.reverse();
            }
            bytes
        };
        let mut bytes = format!(
            "ply\nformat binary_{}_endian 1.0\nelement vertex {}\nproperty float confidence\nproperty double x\n\
             property double y\n\
             property double z\nelement face {}\nproperty list uchar uint vertex_index\nend_header\n",
            if big_endian { "big" } else { "little" },
            self.positions.len(),
            self.triangles.len()
        )
        .into_bytes();
        for position in &self.positions {
            bytes.extend([0; 4]);
            for value in position {
                bytes.extend(bytes_of(value.to_le_bytes().to_vec()));
            }
        }
        for t in &self.triangles {
            bytes.push(3);
            for corner in t {
                bytes.extend(bytes_of(corner.to_le_bytes().to_vec()));
            }
        }
        bytes
    }
}

/// A box from corner to corner.
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Surface {
    let positions = (0..8)
        .map(|i| {
            [0, 1, 2].map(|axis| {
                if i >> axis & 1 == 1 {
                    high[axis]
                } else {
                    low[axis]
                }
            })
        })
        .collect();
    let quads = [
        [0, 4, 6, 2], // x low
        [1, 3, 7, 5], // x high
        [0, 1, 5, 4], // y low
        [2, 6, 7, 3], // y high
        [0, 2, 3, 1], // z low
        [4, 5, 7, 6], // z high
    ];
    Surface {
        positions,
        triangles: quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect(),
    }
}

/// A sphere in rings and sectors, its vertices on the sphere: the polyhedron lies inside it.
pub fn sphere(center: [f64; 3], radius: f64, rings: u32) -> Surface {
    let sectors = 2 * rings;
    let mut surface = Surface::default();
    let mut put = |theta: f64, phi: f64| {
        let unit = [
            theta.sin() * phi.cos(),
            theta.sin() * phi.sin(),
            theta.cos(),
        ];
        surface
            .positions
            .push([0, 1, 2].map(|axis| center[axis] + radius * unit[axis]));
    };
    put(0.0, 0.0);
    for ring in 1..rings {
        for sector in 0..sectors {
            put(
                PI * f64::from(ring) / f64::from(rings),
                2.0 * PI * f64::from(sector) / f64::from(sectors),
            );
        }
    }
    put(PI, 0.0);
    let last = surface.positions.len() as u32 - 1;
    let at = |ring: u32, sector: u32| 1 + (ring - 1) * sectors + sector % sectors;
    for s in 0..sectors {
        surface.triangles.push([0, at(1, s), at(1, s + 1)]);
        surface
            .triangles
            .push([last, at(rings - 1, s + 1), at(rings - 1, s)]);
        for ring in 1..rings - 1 {
            surface
                .triangles
                .push([at(ring, s), at(ring + 1, s), at(ring + 1, s + 1)]);
            surface
                .triangles
                .push([at(ring, s), at(ring + 1, s + 1), at(ring, s + 1)]);
        }
    }
    surface
}

/// Points of the cube [-half, half]^3 that look random and are always the same (Weyl sequence).
pub fn scattered(count: usize, half: f64) -> impl Iterator<Item = [f64; 3]> {
    const STEPS: [f64; 3] = [
        0.819_172_513_396_164_4,
        0.671_043_606_703_789_2,
        0.549_700_477_901_970_8,
    ];
    (1..=count).map(move |i| STEPS.map(|step| half * (2.0 * (i as f64 * step).fract() - 1.0)))
}
