//! The complex FFT of a few lines at once in a workgroup's memory, written out as WGSL for one length.
//!
//! Stockham's self-sorting form: every pass reads one array and writes the other, so that none reorders. A pass takes
//! a radix up to 16, in registers, so that most lengths to 256 take two passes. The stride between lines is odd, and a
//! place is left free after every sixteen points: so the strides of passes meet different banks of the memory. Source: Govindaraju et al., *High performance discrete Fourier
//! transforms on graphics processors*, SC 2008, section 3.

use std::f64::consts::TAU;
use std::fmt::Write;

/// Invocations of a workgroup, of every stage.
pub(crate) const WIDTH: usize = 128;

/// Most lines that a workgroup transforms together: beyond, a row of them is longer than a memory transaction.
pub(crate) const MAX_LINES: usize = 16;

/// Largest radix of a pass: its values are in registers.
const MAX_RADIX: usize = 16;
/// Points after which a place of a workgroup's memory is free: banks of 8 bytes.
const BANKS: usize = 16;

/// Direction of a transform: the sign of its exponent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    Forward,
    Inverse,
}

impl Direction {
    fn sign(self) -> f64 {
        match self {
            Self::Forward => -1.0,
            Self::Inverse => 1.0,
        }
    }
}

/// Transforms of one length and direction, a number of lines at a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LineFft {
    pub length: usize,
    pub lines: usize,
    pub direction: Direction,
}

impl LineFft {
    /// Places in the workgroup's memory from one line to the next.
    fn stride(self) -> usize {
        (self.length + self.length / BANKS) | 1
    }

    /// Places of both of the arrays that [`Self::source`] needs.
    pub fn places(self) -> usize {
        self.lines * self.stride()
    }

    /// Bytes of both arrays for each line of a length.
    pub fn bytes_of_line(length: usize) -> usize {
        let one = Self {
            length,
            lines: 1,
            direction: Direction::Forward,
        };
        2 * size_of::<[f32; 2]>() * one.places()
    }

    /// Floating-point operations of a line, by the usual count of 5 n log2 n.
    pub fn flops_of_line(length: usize) -> f64 {
        let length = length as f64;
        5.0 * length * length.log2()
    }

    /// exp(+-2 pi i k / length) for k = 0..length, as (re, im).
    pub fn twiddles(self) -> Vec<[f32; 2]> {
        (0..self.length)
            .map(|k| {
                let angle = self.direction.sign() * TAU * k as f64 / self.length as f64;
                [angle.cos() as f32, angle.sin() as f32]
            })
            .collect()
    }

    /// The arrays `ping` and `pong` for the largest of some transforms.
    pub fn arrays(transforms: &[Self]) -> String {
        let places = transforms.iter().map(|one| one.places()).max();
        let places = places.unwrap_or(1);
        format!(
            "var<workgroup> ping: array<vec2<f32>, {places}>;\n\
             var<workgroup> pong: array<vec2<f32>, {places}>;\n\
             fn multiply(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {{\n\
             return vec2<f32>(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);\n}}\n"
        )
    }

    /// WGSL of `transform(lane)`, of `at(line, k)`, the place of a point in `ping`, which callers fill and pass a barrier
    /// before, and of `result(line, k)`, which reads what the transform left. Nothing is scaled. `twiddle` is the table
    /// of [`Self::twiddles`]. All four names carry the suffix.
    ///
    /// `None` if a prime beyond 7 divides the length.
    pub fn source(self, suffix: &str) -> Option<String> {
        let Self { length, lines, .. } = self;
        let stride = self.stride();
        let mut code = format!(
            "fn at{suffix}(line: u32, k: u32) -> u32 {{ return line * {stride}u + k + k / {BANKS}u; }}\n\
             fn transform{suffix}(lane: u32) {{\n\
             _ = &twiddle{suffix}; // A single pass reads no table, which is bound all the same.\n"
        );
        let (mut from, mut to) = ("ping", "pong");
        let mut span = 1;
        for radix in radices(length)? {
            let part = length / radix;
            let items = lines * part;
            let _ = write!(
                code,
                "for (var item = lane; item < {items}u; item += {WIDTH}u) {{\n\
                 let line = item / {part}u;\n\
                 let i = item % {part}u;\n\
                 let k = i % {span}u;\n"
            );
            for s in 0..radix {
                let _ = writeln!(
                    code,
                    "var v{s} = {from}[at{suffix}(line, i + {}u)];",
                    s * part
                );
            }
            if span > 1 {
                // One read of the table; the other powers are products of lower ones, in registers.
                let step = length / (span * radix);
                let _ = writeln!(code, "let w1 = twiddle{suffix}[k * {step}u];");
                for s in 1..radix {
                    if s > 1 {
                        let _ = writeln!(code, "let w{s} = multiply(w{}, w{});", s / 2, s - s / 2);
                    }
                    let _ = writeln!(code, "v{s} = multiply(v{s}, w{s});");
                }
            }
            let values = (0..radix).map(|s| format!("v{s}")).collect();
            let mut registers = Registers {
                code: &mut code,
                count: 0,
                direction: self.direction,
            };
            let values = registers.transform(values);
            let _ = writeln!(code, "let to = (i / {span}u) * {}u + k;", span * radix);
            for (t, value) in values.into_iter().enumerate() {
                let _ = writeln!(
                    code,
                    "{to}[at{suffix}(line, to + {}u)] = {value};",
                    t * span
                );
            }
            code.push_str("}\nworkgroupBarrier();\n");
            span *= radix;
            std::mem::swap(&mut from, &mut to);
        }
        let _ = write!(
            code,
            "}}\nfn result{suffix}(line: u32, k: u32) -> vec2<f32> {{ return {from}[at{suffix}(line, k)]; }}\n"
        );
        Some(code)
    }
}

/// The radices of a length, in the order of their passes: the fewest, then those of the smallest sum. `None` if a prime
/// beyond 7 divides it.
fn radices(length: usize) -> Option<Vec<usize>> {
    if length == 1 {
        return Some(Vec::new());
    }
    let smooth = |radix: &usize| [2, 3, 5, 7].iter().fold(*radix, |r, p| divided(r, *p)) == 1;
    (2..=MAX_RADIX.min(length))
        .filter(|radix| length.is_multiple_of(*radix))
        .filter(smooth)
        .filter_map(|radix| {
            let mut rest = radices(length / radix)?;
            rest.push(radix);
            Some(rest)
        })
        .min_by_key(|passes| (passes.len(), passes.iter().sum::<usize>()))
}

/// A number without a factor.
fn divided(mut number: usize, by: usize) -> usize {
    while number.is_multiple_of(by) {
        number /= by;
    }
    number
}

/// Code of a transform in registers.
struct Registers<'a> {
    code: &'a mut String,
    /// Names given.
    count: usize,
    direction: Direction,
}

impl Registers<'_> {
    /// A name for a value.
    fn named(&mut self, value: &str) -> String {
        self.count += 1;
        let name = format!("r{}", self.count);
        let _ = writeln!(self.code, "let {name} = {value};");
        name
    }

    /// Times i, or -i forward.
    fn turned(&mut self, value: &str) -> String {
        let turned = match self.direction {
            Direction::Forward => format!("vec2<f32>({value}.y, -{value}.x)"),
            Direction::Inverse => format!("vec2<f32>(-{value}.y, {value}.x)"),
        };
        self.named(&turned)
    }

    /// The transform of some values, by name.
    fn transform(&mut self, v: Vec<String>) -> Vec<String> {
        let radix = v.len();
        match [4, 2, 3, 5, 7].iter().find(|p| radix.is_multiple_of(**p)) {
            Some(&inner) if inner != radix => self.composite(v, inner),
            _ => match radix {
                1 => v,
                2 => self.pair(&v[0], &v[1]).into(),
                4 => self.four(&v),
                _ => self.odd(&v),
            },
        }
    }

    fn pair(&mut self, a: &str, b: &str) -> [String; 2] {
        [
            self.named(&format!("{a} + {b}")),
            self.named(&format!("{a} - {b}")),
        ]
    }

    fn four(&mut self, v: &[String]) -> Vec<String> {
        let [a, b] = self.pair(&v[0], &v[2]);
        let [c, e] = self.pair(&v[1], &v[3]);
        let d = self.turned(&e);
        let [zero, two] = self.pair(&a, &c);
        let [one, three] = self.pair(&b, &d);
        vec![zero, one, two, three]
    }

    /// Cooley and Tukey's division into transforms of `inner`, constant turns, and the rest.
    fn composite(&mut self, v: Vec<String>, inner: usize) -> Vec<String> {
        let radix = v.len();
        let outer = radix / inner;
        let mut columns = Vec::new();
        for n in 0..outer {
            let line = (0..inner).map(|i| v[outer * i + n].clone()).collect();
            let values = self.transform(line);
            let turned = values.into_iter().enumerate();
            let turned: Vec<String> = turned
                .map(|(k, value)| self.turned_by(value, n * k, radix))
                .collect();
            columns.push(turned);
        }
        let mut results = vec![String::new(); radix];
        for k in 0..inner {
            let line = columns.iter().map(|column| column[k].clone()).collect();
            for (m, value) in self.transform(line).into_iter().enumerate() {
                results[k + inner * m] = value;
            }
        }
        results
    }

    /// Times exp(+-2 pi i turn / of).
    fn turned_by(&mut self, value: String, turn: usize, of: usize) -> String {
        match 4 * (turn % of) {
            0 => value,
            quarter if quarter == of => self.turned(&value),
            _ => {
                let angle = self.direction.sign() * TAU * turn as f64 / of as f64;
                let factor = format!("vec2<f32>({:.9e}, {:.9e})", angle.cos(), angle.sin());
                self.named(&format!("multiply({value}, {factor})"))
            }
        }
    }

    /// An odd length: outputs t and radix - t share their sums.
    fn odd(&mut self, v: &[String]) -> Vec<String> {
        let radix = v.len();
        let half = radix / 2;
        let pairs: Vec<[String; 2]> = (1..=half)
            .map(|s| self.pair(&v[s], &v[radix - s]))
            .collect();
        let mut results = vec![String::new(); radix];
        let sums: Vec<&str> = pairs.iter().map(|[sum, _]| sum.as_str()).collect();
        results[0] = self.named(&format!("{} + {}", v[0], sums.join(" + ")));
        for t in 1..=half {
            let sum = |which: usize, part: fn(f64) -> f64| {
                let of = |s: usize| part(TAU * ((s + 1) * t % radix) as f64 / radix as f64);
                let terms = pairs.iter().enumerate();
                let terms = terms.map(|(s, pair)| format!("{} * f32({:.9e})", pair[which], of(s)));
                terms.collect::<Vec<_>>().join(" + ")
            };
            let even = self.named(&format!("{} + {}", v[0], sum(0, f64::cos)));
            let odd = self.named(&sum(1, f64::sin));
            let odd = self.turned(&odd);
            [results[t], results[radix - t]] = self.pair(&even, &odd);
        }
        results
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two passes up to 256 where two factors to 16 make the length, else three.
    #[test]
    fn lengths_take_the_fewest_passes() {
        for length in 17..=256 {
            let smooth = [2, 3, 5, 7].into_iter().fold(length, divided) == 1;
            let passes = radices(length);
            assert_eq!(passes.is_some(), smooth, "{length}");
            let Some(passes) = passes else { continue };
            assert_eq!(passes.iter().product::<usize>(), length);
            let twos = (2..=MAX_RADIX).any(|a| length.is_multiple_of(a) && length / a <= MAX_RADIX);
            assert_eq!(
                passes.len(),
                if twos { 2 } else { 3 },
                "{length}: {passes:?}"
            );
        }
        assert_eq!(radices(48), Some(vec![8, 6]));
        assert_eq!(radices(11), None);
    }
}
