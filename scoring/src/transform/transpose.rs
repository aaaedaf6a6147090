//! Transposition of a part of a matrix into a part of another.

/// Rows that are written side by side: a cache line of single-precision complex numbers.
const TOGETHER: usize = 8;

/// Writes columns `range` of the first `count` rows of `source` as rows of `target`: value (i, range.start + j) goes to
/// (j, i). Rows lie `strides` apart, in the source and in the target.
///
/// # Panics
/// If a row of the source or the target is too short.
#[inline(always)]
pub(crate) fn transpose<C: Copy>(
    (source, target): (&[C], &mut [C]),
    count: usize,
    range: std::ops::Range<usize>,
    strides: [usize; 2],
) {
    let whole = count - count % TOGETHER;
    for first in (0..whole).step_by(TOGETHER) {
        let rows: [&[C]; TOGETHER] = std::array::from_fn(|i| {
            let start = (first + i) * strides[0] + range.start;
            &source[start..start + range.len()]
        });
        for (place, target) in target.chunks_mut(strides[1]).take(range.len()).enumerate() {
            let run = &mut target[first..first + TOGETHER];
            for (value, row) in run.iter_mut().zip(rows) {
                *value = row[place];
            }
        }
    }
    for row in whole..count {
        let start = row * strides[0] + range.start;
        let values = &source[start..start + range.len()];
        for (target, value) in target.chunks_mut(strides[1]).zip(values) {
            target[row] = *value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::transpose;

    #[test]
    fn moves_each_value_of_the_range_and_nothing_else() {
        for count in [1, 7, 8, 9, 20] {
            let source: Vec<usize> = (0..20 * 30).collect();
            let mut target = vec![usize::MAX; 11 * 25];
            transpose((&source, &mut target), count, 4..15, [30, 25]);
            for (place, value) in target.iter().enumerate() {
                let (j, i) = (place / 25, place % 25);
                let expected = if i < count {
                    i * 30 + 4 + j
                } else {
                    usize::MAX
                };
                assert_eq!(*value, expected, "{count}: {j}, {i}");
            }
        }
    }
}
