//! Labels of the cells of a cluster: solid or not.
//!
//! Evidence in this order, until one gives labels without contradiction:
//!
//! 1. How triangles face. Through a triangle the winding number changes by the copies that face one way less those
//!    that face the other; a cell is solid where it is not zero. A cell of winding number zero is solid, too, if
//!    each of its walls is there both ways round: a body as programs for pictures write it.
//! 2. How often triangles are there: a cell is solid where a way out passes through an odd number.
//! 3. The same, each triangle taken once.
//! 4. Nothing: every cell but the outside is solid, and cells merge where there is one copy of a wall between them.

use std::collections::VecDeque;

use crate::mesh::repair::cells::Cells;
use crate::mesh::repair::distinct::Distinct;
use crate::mesh::repair::edges::Patches;

/// Label of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::mesh) enum Label {
    /// Not of the solid.
    Empty,
    /// A body; whether its walls face inward, and whether they are there both ways round.
    Body { inward: bool, both_ways: bool },
}

impl Label {
    /// Whether the cell is of the solid.
    pub fn is_body(&self) -> bool {
        *self != Self::Empty
    }
}

/// The labels of a cluster's cells.
pub(in crate::mesh) struct Labelled {
    /// A label for each of the cluster's cells.
    pub labels: Vec<(u32, Label)>,
    /// Cells of a winding number beyond one.
    pub nested: usize,
    /// What the divergence theorem counts of them beyond once, in the file's unit cubed.
    pub overlap: f64,
    /// Whether bodies merge where the wall between them is there once.
    pub merges: bool,
}

/// Volumes below zero by this share of the whole are rounding.
const ROUNDING: f64 = 1e-6;

/// A cluster: its cells and triangles.
pub(in crate::mesh) struct Cluster<'a> {
    pub distinct: &'a Distinct,
    pub patches: &'a Patches,
    pub cells: &'a Cells,
    pub names: &'a [u32],
    pub triangles: &'a [u32],
}

impl Cluster<'_> {
    fn beside(&self, triangle: u32) -> Option<[u32; 2]> {
        self.cells.beside[triangle as usize]
    }

    /// The outside; none where the sheets cross, so that cells are not what they seem.
    fn outside(&self) -> Option<u32> {
        let volume = |cell: u32| self.cells.cells[cell as usize].volume;
        let mut names = self.names.iter().copied();
        let outside = names
            .by_ref()
            .min_by(|&a, &b| volume(a).total_cmp(&volume(b)))?;
        let whole = volume(outside).abs();
        let mut others = self.names.iter().filter(|&&name| name != outside);
        let cross = others.any(|&name| {
            volume(name) < -ROUNDING * whole && !self.cells.cells[name as usize].is_flat()
        });
        (!cross).then_some(outside)
    }

    /// Net copies of a triangle, where most of its patch decide which way they face.
    fn facing(&self) -> impl Fn(u32) -> i64 {
        let turned = |triangle: u32| self.patches.turned[triangle as usize];
        let mut votes = std::collections::HashMap::new();
        for &triangle in self.triangles {
            let sign = if turned(triangle) { -1 } else { 1 };
            let votes: &mut i64 = votes.entry(self.patches.of[triangle as usize]).or_default();
            *votes += sign * self.distinct.net(triangle).signum();
        }
        move |triangle| {
            let inverted = votes.get(&self.patches.of[triangle as usize]) < Some(&0);
            let net = self.distinct.net(triangle).abs();
            if inverted == turned(triangle) {
                net
            } else {
                -net
            }
        }
    }

    /// Numbers of the cells, zero outside, of which that behind each triangle is that in front of it and the
    /// triangle's `step`, modulo `modulus`; none if there are no such numbers.
    fn numbers(&self, outside: u32, modulus: i64, step: impl Fn(u32) -> i64) -> Option<Vec<i64>> {
        let wrap = |number: i64| {
            if modulus > 0 {
                number.rem_euclid(modulus)
            } else {
                number
            }
        };
        let mut numbers: Vec<Option<i64>> = vec![None; self.cells.cells.len()];
        numbers[outside as usize] = Some(0);
        let mut queue = VecDeque::from([outside]);
        while let Some(cell) = queue.pop_front() {
            let own = numbers[cell as usize]?;
            for &(triangle, in_front) in &self.cells.cells[cell as usize].walls {
                let [front, behind] = self.beside(triangle)?;
                let (other, sign) = if in_front { (behind, 1) } else { (front, -1) };
                let expected = wrap(own + sign * step(triangle));
                match numbers[other as usize] {
                    None => {
                        numbers[other as usize] = Some(expected);
                        queue.push_back(other);
                    }
                    Some(number) if number != expected => return None,
                    Some(_) => {}
                }
            }
        }
        self.names
            .iter()
            .map(|&name| numbers[name as usize])
            .collect()
    }

    /// Whether the walls of a body face inward, by `facing` or, where that is as often one way as the other, by the
    /// first copies.
    fn is_inward(&self, cell: u32, facing: impl Fn(u32) -> i64) -> bool {
        let sum = |facing: &dyn Fn(u32) -> i64| -> i64 {
            let walls = self.cells.cells[cell as usize].walls.iter();
            walls
                .map(|&(triangle, in_front)| facing(triangle) * if in_front { -1 } else { 1 })
                .sum()
        };
        match sum(&|triangle| facing(triangle).signum()) {
            0 => sum(&|_| 1) < 0,
            sum => sum < 0,
        }
    }

    /// Labels the cells; none where the cluster is not closed or its sheets cross.
    pub fn label(&self) -> Option<Labelled> {
        let outside = self.outside()?;
        let facing = self.facing();
        if let Some(numbers) = self.numbers(outside, 0, &facing) {
            return self.by_winding(outside, numbers, &facing);
        }
        let numbers = self
            .numbers(outside, 2, |triangle| self.copies(triangle))
            .or_else(|| {
                // What is there both ways round and has one cell on both sides is a fin.
                let step = |triangle| match self.beside(triangle) {
                    Some([a, b]) if a == b && self.distinct.is_repeated(triangle) => 0,
                    _ => 1,
                };
                self.numbers(outside, 2, step)
            });
        let Some(numbers) = numbers else {
            return self.all_solid(|cell| self.is_region(outside, cell), &facing);
        };
        Some(self.by_parity(outside, numbers, &facing))
    }

    /// Whether `hold` is true of all walls of a cell.
    fn all_walls(&self, cell: u32, hold: impl Fn(u32) -> bool) -> bool {
        let mut walls = self.cells.cells[cell as usize].walls.iter();
        walls.all(|&(triangle, _)| hold(triangle))
    }

    /// Whether a cell has a volume and is not the outside.
    fn is_region(&self, outside: u32, cell: u32) -> bool {
        cell != outside && !self.cells.cells[cell as usize].is_flat()
    }

    /// Number of copies of a triangle.
    fn copies(&self, triangle: u32) -> i64 {
        self.distinct.copies[triangle as usize].len() as i64
    }

    /// Labels by winding numbers; none where bodies coincide.
    fn by_winding(
        &self,
        outside: u32,
        numbers: Vec<i64>,
        facing: impl Fn(u32) -> i64,
    ) -> Option<Labelled> {
        let both_ways =
            |cell| self.all_walls(cell, |triangle| self.distinct.is_both_ways(triangle));
        let mut labelled = Labelled {
            labels: Vec::new(),
            nested: 0,
            overlap: 0.0,
            merges: false,
        };
        // A body that coincides with another, or with the wall of a cavity, cut into other triangles: what it
        // is depends on what is about it.
        let is_double = |cell: u32| {
            self.all_walls(cell, |triangle| {
                let beside = self.beside(triangle).into_iter().flatten();
                let mut others = beside.filter(|&other| other != cell);
                self.distinct.is_both_ways(triangle)
                    || others.all(|other| self.cells.cells[other as usize].is_flat())
            })
        };
        let mut pairs = self.names.iter().zip(&numbers);
        if pairs.any(|(&name, number)| {
            *number == 0 && self.is_region(outside, name) && !both_ways(name) && is_double(name)
        }) {
            return None;
        }
        for (&name, number) in self.names.iter().zip(numbers) {
            let label = if !self.is_region(outside, name) {
                Label::Empty
            } else if number != 0 {
                Label::Body {
                    inward: number < 0,
                    both_ways: false,
                }
            } else if both_ways(name) {
                Label::Body {
                    inward: self.is_inward(name, &facing),
                    both_ways: true,
                }
            } else {
                Label::Empty
            };
            labelled.labels.push((name, label));
            if self.is_region(outside, name) && number.abs() > 1 {
                labelled.nested += 1;
                labelled.overlap +=
                    (number.abs() - 1) as f64 * self.cells.cells[name as usize].volume;
            }
        }
        Some(labelled)
    }

    /// Labels by whether a way out passes through an odd number of triangles.
    fn by_parity(&self, outside: u32, numbers: Vec<i64>, facing: impl Fn(u32) -> i64) -> Labelled {
        let mut labels = Vec::new();
        for (&name, number) in self.names.iter().zip(numbers) {
            let doubled = self.all_walls(name, |triangle| self.distinct.is_repeated(triangle));
            let label = if self.is_region(outside, name) && (number == 1 || doubled) {
                Label::Body {
                    inward: self.is_inward(name, &facing),
                    both_ways: false,
                }
            } else {
                Label::Empty
            };
            labels.push((name, label));
        }
        Labelled {
            labels,
            nested: 0,
            overlap: 0.0,
            merges: false,
        }
    }

    /// Every region solid, all facing as most of their outer walls do; none where a triangle that is there once has one
    /// cell on both sides.
    fn all_solid(
        &self,
        is_region: impl Fn(u32) -> bool,
        facing: impl Fn(u32) -> i64,
    ) -> Option<Labelled> {
        let mut outward = 0;
        for &triangle in self.triangles {
            let [front, behind] = self.beside(triangle)?;
            if front == behind && !self.distinct.is_repeated(triangle) {
                return None;
            }
            let sides = i64::from(is_region(behind)) - i64::from(is_region(front));
            outward += sides * facing(triangle).signum();
        }
        let label = |&name: &u32| match is_region(name) {
            true => Label::Body {
                inward: outward < 0,
                both_ways: false,
            },
            false => Label::Empty,
        };
        Some(Labelled {
            labels: self.names.iter().map(|name| (*name, label(name))).collect(),
            nested: 0,
            overlap: 0.0,
            merges: true,
        })
    }
}
