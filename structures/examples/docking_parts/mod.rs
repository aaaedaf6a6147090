//! Pairs of parts that fit together, with the symmetries of each and the gap between them known.
//!
//! Both parts of a pair are made in the frame in which they are together; the docking tests then turn one away. Lengths
//! are in shares of the first part's longest edge, about one. Corners run anticlockwise seen from outside.
//!
//! - **Keyed peg and blind hole.** A rod with a fin along it, and a block with a hole of that outline, grown by the
//!   clearance, that ends inside. The peg may go in by either end: half a turn about the axis of its fin. The block has
//!   no symmetry but a mirror.
//! - **Linked halves of a torus.** The cut turns once with the way around, so that the halves are two linked rings (as
//!   of a bagel, after G. Hart). Each half is its own image under half a turn about one axis, which is the same for
//!   both.
//! - **Broken block.** A block broken along four planes that meet in a point off its middle. No part has a symmetry.
//! - **Saddle block.** A block cut along a smooth saddle. No part has a symmetry.
//! - **Studded plates.** Two plates, one with two studs and a dent, the other with their counterparts. No part has a
//!   symmetry.

use std::f64::consts::PI;

/// A triangle mesh.
#[derive(Clone, Debug, Default)]
pub struct Part {
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

/// Half a turn about an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfTurnAxis {
    /// A point of the axis.
    pub point: [f64; 3],
    /// Its direction, of length one.
    pub direction: [f64; 3],
}

/// Two parts in the pose in which they fit.
#[derive(Clone, Debug)]
pub struct Pair {
    pub name: &'static str,
    /// The part that stays.
    pub receptor: Part,
    /// The part that moves.
    pub ligand: Part,
    /// Half-turns that map the receptor onto itself; with the identity they are its group of rotations.
    pub receptor_symmetry: Vec<HalfTurnAxis>,
    /// Those of the ligand.
    pub ligand_symmetry: Vec<HalfTurnAxis>,
}

/// All five, no two points of their parts nearer to one another than `clearance`.
pub fn pairs(clearance: f64) -> Vec<Pair> {
    vec![
        peg_and_hole(clearance),
        linked_torus(clearance),
        broken_block(clearance),
        saddle_block(clearance),
        studded_plates(clearance),
    ]
}

/// A rod of radius .21 with a fin out to .35, .7 long, .55 of it in the hole (at a clearance of .05).
pub fn peg_and_hole(clearance: f64) -> Pair {
    const SIDES: u32 = 96;
    let (radius, fin, half_width) = (0.26, 0.4, 0.11);
    // Distance from the axis to the outline: a disc and a rectangle from its middle outward, both shrunk.
    let outline = move |angle: f64, shrunk: f64| {
        let disc = radius - shrunk;
        let (sine, cosine) = angle.sin_cos();
        if cosine <= 1e-9 {
            return disc;
        }
        let fin = ((fin - shrunk) / cosine).min((half_width - shrunk) / sine.abs().max(1e-9));
        disc.max(fin)
    };
    let ring = |distance: &dyn Fn(f64) -> f64, z: f64| -> Vec<[f64; 3]> {
        (0..SIDES)
            .map(|i| 2.0 * PI * f64::from(i) / f64::from(SIDES))
            .map(|angle| {
                let r = distance(angle);
                [r * angle.cos(), r * angle.sin(), z]
            })
            .collect()
    };
    let hole = |angle: f64| outline(angle, 0.0);
    let peg = |angle: f64| outline(angle, clearance);
    // Rays through the corners are among the sides, which are a multiple of eight.
    let square = |angle: f64| 0.5 / angle.cos().abs().max(angle.sin().abs());
    let (bottom, floor, top) = (-0.4, -0.2, 0.4);
    let mut block = Part::default();
    let rings = [
        ring(&square, bottom),
        ring(&square, top),
        ring(&hole, top),
        ring(&hole, floor),
    ];
    block.lid([0.0, 0.0, bottom], &rings[0], false);
    for pair in rings.windows(2) {
        block.band(&pair[0], &pair[1]);
    }
    block.lid([0.0, 0.0, floor], &rings[3], true);
    let (low, high) = (floor + clearance, 0.55);
    let mut rod = Part::default();
    rod.lid([0.0, 0.0, low], &ring(&peg, low), false);
    rod.band(&ring(&peg, low), &ring(&peg, high));
    rod.lid([0.0, 0.0, high], &ring(&peg, high), true);
    Pair {
        name: "peg",
        receptor: block,
        ligand: rod,
        receptor_symmetry: Vec::new(),
        ligand_symmetry: vec![HalfTurnAxis {
            point: [0.0, 0.0, 0.5 * (low + high)],
            direction: [1.0, 0.0, 0.0],
        }],
    }
}

/// Linked halves of a torus whose tube has radius .15 about a circle of radius .35.
pub fn linked_torus(clearance: f64) -> Pair {
    const AROUND: u32 = 160;
    const ARC: u32 = 24;
    const CHORD: u32 = 8;
    let (ring, tube) = (0.35, 0.15);
    // The cut turns by one radian a radian, so that at the inner side of the tube it is as steep as this.
    let steepest: f64 = tube / (ring - tube);
    let half_gap = 0.5 * clearance * (1.0 + steepest * steepest).sqrt();
    let edge = (half_gap / tube).asin();
    let across = tube * edge.cos();
    // The outline of a half in its own frame: the arc above the chord, then the chord back.
    let outline: Vec<[f64; 2]> = (0..=ARC)
        .map(|i| edge + (PI - 2.0 * edge) * f64::from(i) / f64::from(ARC))
        .map(|angle| [tube * angle.cos(), tube * angle.sin()])
        .chain((1..CHORD).map(|i| {
            [
                across * (2.0 * f64::from(i) / f64::from(CHORD) - 1.0),
                half_gap,
            ]
        }))
        .collect();
    let half = |phase: f64| {
        let mut part = Part::default();
        let rings: Vec<Vec<[f64; 3]>> = (0..AROUND)
            .map(|i| 2.0 * PI * f64::from(i) / f64::from(AROUND))
            .map(|way| {
                let (sine, cosine) = (way + phase).sin_cos();
                outline
                    .iter()
                    .map(|&[u, v]| {
                        let outward = ring + u * cosine - v * sine;
                        let z = u * sine + v * cosine;
                        [outward * way.cos(), outward * way.sin(), z]
                    })
                    .collect()
            })
            .collect();
        for i in 0..rings.len() {
            part.band(&rings[(i + 1) % rings.len()], &rings[i]);
        }
        part
    };
    let axis = HalfTurnAxis {
        point: [0.0; 3],
        direction: [0.0, 1.0, 0.0],
    };
    Pair {
        name: "torus",
        receptor: half(0.0),
        ligand: half(PI),
        receptor_symmetry: vec![axis],
        ligand_symmetry: vec![axis],
    }
}

/// A block of one by one, broken along z = .9 |x - .1| + .45 |y + .15|.
pub fn broken_block(clearance: f64) -> Pair {
    let (steep_x, steep_y): (f64, f64) = (0.9, 0.45);
    let half_gap = 0.5 * clearance * (1.0 + steep_x * steep_x + steep_y * steep_y).sqrt();
    let xs = [-0.5, 0.1, 0.5];
    let ys = [-0.5, -0.15, 0.5];
    let height = |x: f64, y: f64| steep_x * (x - 0.1).abs() + steep_y * (y + 0.15).abs();
    // A sheet of 3 by 3 points, and a block between two of them.
    let sheet = |z: &dyn Fn(f64, f64) -> f64| -> Vec<[f64; 3]> {
        ys.iter()
            .flat_map(|&y| xs.iter().map(move |&x| (x, y)))
            .map(|(x, y)| [x, y, z(x, y)])
            .collect()
    };
    let between = |low: &[[f64; 3]], high: &[[f64; 3]]| {
        let mut part = Part::default();
        let border = [0, 1, 2, 5, 8, 7, 6, 3];
        let around = |sheet: &[[f64; 3]]| border.map(|i| sheet[i]);
        part.band(&around(low), &around(high));
        for (sheet, upward) in [(low, false), (high, true)] {
            for [a, b, c, d] in [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]] {
                part.quad([a, b, c, d].map(|i| sheet[i]), upward);
            }
        }
        part
    };
    Pair {
        name: "broken",
        receptor: between(
            &sheet(&|_, _| -0.2),
            &sheet(&|x, y| height(x, y) - half_gap),
        ),
        ligand: between(&sheet(&|x, y| height(x, y) + half_gap), &sheet(&|_, _| 1.0)),
        receptor_symmetry: Vec::new(),
        ligand_symmetry: Vec::new(),
    }
}

/// A block of one by one, cut along z = .7 x y + .12 sin(5 x + 1) + .08 cos(4 y).
pub fn saddle_block(clearance: f64) -> Pair {
    let height =
        |x: f64, y: f64| 0.7 * x * y + 0.12 * (5.0 * x + 1.0).sin() + 0.08 * (4.0 * y).cos();
    cut_along("saddle", &height, [-0.45, 0.65], clearance)
}

/// Plates of one by one, about .2 and .5 thick, between them two studs and a dent.
pub fn studded_plates(clearance: f64) -> Pair {
    let studs = [
        (-0.22, -0.12, 0.22, 0.14),
        (0.2, 0.2, 0.16, 0.11),
        (0.1, -0.3, -0.14, 0.1),
    ];
    let height = move |x: f64, y: f64| -> f64 {
        let stud = |(u, v, high, wide): (f64, f64, f64, f64)| {
            high * (-((x - u).powi(2) + (y - v).powi(2)) / (2.0 * wide * wide)).exp()
        };
        studs.into_iter().map(stud).sum()
    };
    cut_along("studs", &height, [-0.32, 0.5], clearance)
}

/// A block between two heights, cut along a sheet whose two sides are `clearance` from each other.
fn cut_along(
    name: &'static str,
    height: &dyn Fn(f64, f64) -> f64,
    [bottom, top]: [f64; 2],
    clearance: f64,
) -> Pair {
    const SIDES: usize = 40;
    let place = |i: usize| i as f64 / SIDES as f64 - 0.5;
    let steepest = (0..=SIDES)
        .flat_map(|i| (0..=SIDES).map(move |j| (place(i), place(j))))
        .map(|(x, y)| {
            let h = 1e-4;
            let slope_x = (height(x + h, y) - height(x - h, y)) / (2.0 * h);
            let slope_y = (height(x, y + h) - height(x, y - h)) / (2.0 * h);
            slope_x.hypot(slope_y)
        })
        .fold(0.0, f64::max);
    let half_gap = 0.5 * clearance * (1.0 + steepest * steepest).sqrt();
    let sheet = |z: &dyn Fn(f64, f64) -> f64| -> Vec<[f64; 3]> {
        (0..=SIDES)
            .flat_map(|j| (0..=SIDES).map(move |i| (place(i), place(j))))
            .map(|(x, y)| [x, y, z(x, y)])
            .collect()
    };
    let between = |low: &[[f64; 3]], high: &[[f64; 3]]| {
        let mut part = Part::default();
        let row = SIDES + 1;
        let around = |sheet: &[[f64; 3]]| -> Vec<[f64; 3]> {
            let south = 0..SIDES;
            let east = (0..SIDES).map(|j| j * row + SIDES);
            let north = (0..SIDES).map(|i| SIDES * row + SIDES - i);
            let west = (0..SIDES).map(|j| (SIDES - j) * row);
            let border = south.chain(east).chain(north).chain(west);
            border.map(|index| sheet[index]).collect()
        };
        part.band(&around(low), &around(high));
        for (sheet, upward) in [(low, false), (high, true)] {
            for j in 0..SIDES {
                for i in 0..SIDES {
                    let at = j * row + i;
                    let corners = [at, at + 1, at + row + 1, at + row];
                    part.quad(corners.map(|index| sheet[index]), upward);
                }
            }
        }
        part
    };
    Pair {
        name,
        receptor: between(
            &sheet(&|_, _| bottom),
            &sheet(&|x, y| height(x, y) - half_gap),
        ),
        ligand: between(&sheet(&|x, y| height(x, y) + half_gap), &sheet(&|_, _| top)),
        receptor_symmetry: Vec::new(),
        ligand_symmetry: Vec::new(),
    }
}

impl Part {
    fn vertex(&mut self, position: [f64; 3]) -> u32 {
        self.positions.push(position);
        self.positions.len() as u32 - 1
    }

    fn triangle(&mut self, corners: [[f64; 3]; 3]) {
        let triangle = corners.map(|corner| self.vertex(corner));
        self.triangles.push(triangle);
    }

    /// A planar quadrilateral, anticlockwise in the order given when `upward`.
    fn quad(&mut self, [a, b, c, d]: [[f64; 3]; 4], upward: bool) {
        if upward {
            self.triangle([a, b, c]);
            self.triangle([a, c, d]);
        } else {
            self.triangle([a, c, b]);
            self.triangle([a, d, c]);
        }
    }

    /// A band from one closed line to the next, which lies above it when the lines run anticlockwise seen from above.
    fn band(&mut self, low: &[[f64; 3]], high: &[[f64; 3]]) {
        for i in 0..low.len() {
            let j = (i + 1) % low.len();
            self.triangle([low[i], low[j], high[j]]);
            self.triangle([low[i], high[j], high[i]]);
        }
    }

    /// A disc about a middle, facing up or down, within a line that runs anticlockwise seen from above.
    fn lid(&mut self, middle: [f64; 3], line: &[[f64; 3]], upward: bool) {
        for i in 0..line.len() {
            let (a, b) = (line[i], line[(i + 1) % line.len()]);
            self.triangle(if upward {
                [middle, a, b]
            } else {
                [middle, b, a]
            });
        }
    }

    /// The part with every point moved by `map`, which must not mirror it.
    #[must_use]
    pub fn moved(&self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        Self {
            positions: self.positions.iter().map(|&point| map(point)).collect(),
            triangles: self.triangles.clone(),
        }
    }

    /// The part as an STL file in text, whose digits are those of the double.
    pub fn stl(&self) -> String {
        let mut text = String::from("solid part\n");
        for triangle in &self.triangles {
            text += "facet normal 0 0 0\nouter loop\n";
            for &corner in triangle {
                let [x, y, z] = self.positions[corner as usize];
                text += &format!("vertex {x:?} {y:?} {z:?}\n");
            }
            text += "endloop\nendfacet\n";
        }
        text + "endsolid part\n"
    }
}
