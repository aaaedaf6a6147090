//! The complex FFT of a few lines at once in a workgroup's memory, written out as WGSL for one length.
//!
//! Stockham's self-sorting form with radices 4, 2, 3, 5 and 7: every stage reads one array and writes the other, so
//! that no pass reorders. Source: Govindaraju et al., *High performance discrete Fourier transforms on graphics
//! processors*, SC 2008, section 3.

use std::f64::consts::TAU;
use std::fmt::Write;

/// Invocations of a workgroup, of every stage.
pub(crate) const WIDTH: usize = 128;

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

/// The radices of a length, in the order of their stages; `None` where a prime beyond 7 divides it.
pub(crate) fn radices(length: usize) -> Option<Vec<usize>> {
    let mut rest = length;
    let mut radices = Vec::new();
    for radix in [4, 2, 3, 5, 7] {
        while rest.is_multiple_of(radix) {
            radices.push(radix);
            rest /= radix;
        }
    }
    (rest == 1).then_some(radices)
}

/// exp(+-2 pi i k / length) for k = 0..length, as (re, im).
pub(crate) fn twiddles(length: usize, direction: Direction) -> Vec<[f32; 2]> {
    (0..length)
        .map(|k| {
            let angle = direction.sign() * TAU * k as f64 / length as f64;
            [angle.cos() as f32, angle.sin() as f32]
        })
        .collect()
}

/// WGSL of `transform(lane)` over `lines` lines of `length` (radices as given) and of `result(index)`, which reads what
/// it left; callers fill `ping` and pass a barrier before. Nothing is scaled. `twiddle` is the table of [`twiddles`].
pub(crate) fn source(
    length: usize,
    radices: &[usize],
    lines: usize,
    direction: Direction,
) -> String {
    let total = lines * length;
    let mut code = format!(
        "var<workgroup> ping: array<vec2<f32>, {total}>;\n\
         var<workgroup> pong: array<vec2<f32>, {total}>;\n\
         fn multiply(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {{\n\
         return vec2<f32>(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);\n}}\n\
         fn transform(lane: u32) {{\n"
    );
    let (mut from, mut to) = ("ping", "pong");
    let mut span = 1;
    for &radix in radices {
        let part = length / radix;
        let items = lines * part;
        let _ = write!(
            code,
            "for (var item = lane; item < {items}u; item += {WIDTH}u) {{\n\
             let line = (item / {part}u) * {length}u;\n\
             let i = item % {part}u;\n\
             let k = i % {span}u;\n\
             let v0 = {from}[line + i];\n"
        );
        let step = length / (span * radix);
        for s in 1..radix {
            let value = format!("{from}[line + i + {}u]", s * part);
            let _ = if span == 1 {
                writeln!(code, "let v{s} = {value};")
            } else {
                let turn = s * step;
                writeln!(code, "let v{s} = multiply({value}, twiddle[k * {turn}u]);")
            };
        }
        let next = span * radix;
        let _ = writeln!(code, "let to = line + (i / {span}u) * {next}u + k;");
        let values = butterfly(&mut code, radix, direction);
        for (t, value) in values.into_iter().enumerate() {
            let _ = writeln!(code, "{to}[to + {}u] = {value};", t * span);
        }
        code.push_str("}\nworkgroupBarrier();\n");
        span *= radix;
        std::mem::swap(&mut from, &mut to);
    }
    let _ = write!(
        code,
        "}}\nfn result(index: u32) -> vec2<f32> {{ return {from}[index]; }}\n"
    );
    code
}

/// The transform of v0 to v(radix - 1): intermediate values go into `code`, the results are returned as expressions.
fn butterfly(code: &mut String, radix: usize, direction: Direction) -> Vec<String> {
    // Times +-i.
    let turned = |value: &str| match direction {
        Direction::Forward => format!("vec2<f32>({value}.y, -{value}.x)"),
        Direction::Inverse => format!("vec2<f32>(-{value}.y, {value}.x)"),
    };
    match radix {
        2 => vec!["v0 + v1".into(), "v0 - v1".into()],
        4 => {
            code.push_str(
                "let a = v0 + v2;\nlet b = v0 - v2;\nlet c = v1 + v3;\nlet e = v1 - v3;\n",
            );
            let _ = writeln!(code, "let d = {};", turned("e"));
            ["a + c", "b + d", "a - c", "b - d"]
                .map(String::from)
                .into()
        }
        _ => {
            // An odd length: outputs t and radix - t share their sums.
            let half = radix / 2;
            for s in 1..=half {
                let other = radix - s;
                let _ = writeln!(
                    code,
                    "let p{s} = v{s} + v{other};\nlet m{s} = v{s} - v{other};"
                );
            }
            let mut results = vec![String::new(); radix];
            let all: Vec<String> = (1..=half).map(|s| format!("p{s}")).collect();
            results[0] = format!("v0 + {}", all.join(" + "));
            for t in 1..=half {
                let angle = |s: usize| TAU * (s * t % radix) as f64 / radix as f64;
                let sum = |name: char, part: fn(f64) -> f64| {
                    (1..=half)
                        .map(|s| format!("{name}{s} * f32({:.9e})", part(angle(s))))
                        .collect::<Vec<_>>()
                        .join(" + ")
                };
                let _ = writeln!(code, "let e{t} = v0 + {};", sum('p', f64::cos));
                let _ = writeln!(code, "let o{t} = {};", sum('m', f64::sin));
                let _ = writeln!(code, "let w{t} = {};", turned(&format!("o{t}")));
                results[t] = format!("e{t} + w{t}");
                results[radix - t] = format!("e{t} - w{t}");
            }
            results
        }
    }
}
