//! Vectors of three, as arrays.

use std::cmp::Ordering;

/// a + b.
#[inline]
pub(crate) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a - b.
#[inline]
pub(crate) fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// s a.
#[inline]
pub(crate) fn scale(a: [f64; 3], s: f64) -> [f64; 3] {
    [s * a[0], s * a[1], s * a[2]]
}

/// a + s b.
#[inline]
pub(crate) fn along(a: [f64; 3], s: f64, b: [f64; 3]) -> [f64; 3] {
    add(a, scale(b, s))
}

#[inline]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline]
pub(crate) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[inline]
pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm(subtract(a, b))
}

#[inline]
pub(crate) fn squared_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let away = subtract(a, b);
    dot(away, away)
}

/// Squared distance from a point to a box, zero within it; axes of the box beyond the third do not count.
///
/// Written out: closures over arrays are not inlined, and searches of trees spend most of their time here.
#[inline]
pub(crate) fn squared_distance_to_box<const N: usize>(
    low: &[f64; N],
    high: &[f64; N],
    point: [f64; 3],
) -> f64 {
    let x = (low[0] - point[0]).max(point[0] - high[0]).max(0.0);
    let y = (low[1] - point[1]).max(point[1] - high[1]).max(0.0);
    let z = (low[2] - point[2]).max(point[2] - high[2]).max(0.0);
    x * x + y * y + z * z
}

/// Order of points by x, then y, then z.
pub(crate) fn compare(a: [f64; 3], b: [f64; 3]) -> Ordering {
    let pairs = a.iter().zip(&b);
    pairs.fold(Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(b)))
}

/// The smallest and the largest coordinate of points on each axis.
pub(crate) fn bounds<const N: usize>(
    points: impl IntoIterator<Item = [f64; N]>,
) -> ([f64; N], [f64; N]) {
    let (mut low, mut high) = ([f64::INFINITY; N], [f64::NEG_INFINITY; N]);
    for point in points {
        for axis in 0..N {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    (low, high)
}

/// The longest edge of a box from its lowest to its highest corner.
pub(crate) fn extent((low, high): ([f64; 3], [f64; 3])) -> f64 {
    subtract(high, low).into_iter().fold(0.0, f64::max)
}
