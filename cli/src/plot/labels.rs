//! Places of labels beside points, so that they cover neither points nor lines nor each other.

/// Width in pixels that a character takes at the size of labels.
pub(super) const CHARACTER: f64 = 8.0;
/// Height in pixels of a line of labels.
pub(super) const LINE: f64 = 16.0;
const DISTANCE: f64 = 9.0;
/// Half edge in pixels of the square that a point takes.
const POINT: f64 = 6.0;

/// Half edge in pixels of the squares that a line takes.
const LINE_HALF: f64 = 2.0;

/// Which part of a text is at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

pub(super) fn text_width(text: &str) -> f64 {
    CHARACTER * text.chars().count() as f64
}

/// A place for each label beside its point, in order; `None` where there is no room for it.
///
/// `points` are those of the labels, `others` further ones and `lines` straight ones from end to end, in pixels; labels
/// stay within the `frame` (left, upper, right, lower).
pub(super) fn place(
    points: &[([f64; 2], &str)],
    (others, lines): (&[[f64; 2]], &[[[f64; 2]; 2]]),
    frame: [f64; 4],
) -> Vec<Option<([f64; 2], Anchor)>> {
    let square = |[x, y]: [f64; 2], half: f64| [x - half, y - half, x + half, y + half];
    let all = points.iter().map(|(at, _)| at).chain(others);
    let mut taken: Vec<[f64; 4]> = all.map(|&at| square(at, POINT)).collect();
    for [from, to] in lines {
        let along = [to[0] - from[0], to[1] - from[1]];
        // Squares that overlap, from end to end.
        let steps = (along[0].hypot(along[1]) / LINE_HALF).ceil().max(1.0);
        taken.extend((0..=steps as usize).map(|step| {
            let part = step as f64 / steps;
            let at = [from[0] + part * along[0], from[1] + part * along[1]];
            square(at, LINE_HALF)
        }));
    }
    let mut place_one = |&([x, y], label): &([f64; 2], &str)| {
        let (near, far) = (0.7 * DISTANCE, 0.8 * LINE);
        let candidates = [
            ([x + DISTANCE, y], Anchor::Start),
            ([x - DISTANCE, y], Anchor::End),
            ([x, y - LINE], Anchor::Middle),
            ([x, y + LINE], Anchor::Middle),
            ([x + near, y - far], Anchor::Start),
            ([x + near, y + far], Anchor::Start),
            ([x - near, y - far], Anchor::End),
            ([x - near, y + far], Anchor::End),
        ];
        let free = candidates.into_iter().find_map(|(at, anchor)| {
            let area = area(at, anchor, text_width(label));
            let inside = area[0] > frame[0] + 2.0
                && area[1] > frame[1] + 2.0
                && area[2] < frame[2] - 2.0
                && area[3] < frame[3] - 2.0;
            let covers = |other: &[f64; 4]| {
                area[0] < other[2] && other[0] < area[2] && area[1] < other[3] && other[1] < area[3]
            };
            (inside && !taken.iter().any(covers)).then_some((at, anchor, area))
        });
        free.map(|(at, anchor, area)| {
            taken.push(area);
            (at, anchor)
        })
    };
    points.iter().map(&mut place_one).collect()
}

/// The pixels that a text takes: left, upper, right, lower.
fn area([x, y]: [f64; 2], anchor: Anchor, width: f64) -> [f64; 4] {
    let left = match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - width / 2.0,
        Anchor::End => x - width,
    };
    [left, y - LINE / 2.0, left + width, y + LINE / 2.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_cover_neither_points_nor_each_other() {
        let frame = [0.0, 0.0, 300.0, 120.0];
        // The second lies where the first label would go by its first choice; the last has no room at all.
        let points = [([120.0, 60.0], "first"), ([140.0, 60.0], "second")];
        let places = place(&points, (&[], &[]), frame);
        let (at, anchor) = places[0].unwrap();
        assert!(at[0] < 120.0, "{at:?}");
        let first = area(at, anchor, text_width("first"));
        let (at, anchor) = places[1].unwrap();
        let second = area(at, anchor, text_width("second"));
        assert!(
            first[2] <= second[0]
                || second[2] <= first[0]
                || first[3] <= second[1]
                || second[3] <= first[1]
        );
        let wide = "a label wider than its frame";
        assert_eq!(place(&[([100.0, 50.0], wide)], (&[], &[]), frame), [None]);
        // A line through the first choice: the label goes to the other side. Dashes struck through labels once.
        let line = [[135.0, 0.0], [135.0, 120.0]];
        let places = place(&points[..1], (&[], &[line]), frame);
        let (at, anchor) = places[0].unwrap();
        assert!(area(at, anchor, text_width("first"))[2] < 133.0);
    }
}
