//! Binary trees of boxes over things at places in N dimensions, halved at the median of the longest side.

use crate::vector::bounds;

/// Things in a leaf at most by default.
pub(crate) const LEAF: usize = 8;

/// Some of the things: the box of their places, and a value computed from all of them.
#[derive(Clone, Debug)]
pub(crate) struct BoxNode<K, const N: usize = 3> {
    pub low: [f64; N],
    pub high: [f64; N],
    /// Where they begin in the list of all.
    pub first: usize,
    pub count: usize,
    /// The second half; the first follows this node. Zero in a leaf.
    pub second: usize,
    pub known: K,
}

/// Sorts things into a tree of leaves of at most `leaf` things; its nodes come in depth-first order. None of nothing.
///
/// `place` is where a thing is and its number, which decides between things in one place. `known` is computed of the
/// things of each node.
pub(crate) fn box_tree<T, K, const N: usize>(
    things: &mut [T],
    leaf: usize,
    place: impl Fn(&T) -> ([f64; N], usize),
    known: impl Fn(&[T]) -> K,
) -> Vec<BoxNode<K, N>> {
    let mut nodes = Vec::new();
    if !things.is_empty() {
        build(things, 0, leaf, &place, &known, &mut nodes);
    }
    nodes
}

/// Appends the node of things that begin at `first` of the whole list, and the nodes below it.
fn build<T, K, const N: usize>(
    things: &mut [T],
    first: usize,
    leaf: usize,
    place: &impl Fn(&T) -> ([f64; N], usize),
    known: &impl Fn(&[T]) -> K,
    nodes: &mut Vec<BoxNode<K, N>>,
) {
    let (low, high) = bounds(things.iter().map(|thing| place(thing).0));
    let at = nodes.len();
    nodes.push(BoxNode {
        low,
        high,
        first,
        count: things.len(),
        second: 0,
        known: known(things),
    });
    if things.len() <= leaf {
        return;
    }
    let side = |axis: usize| high[axis] - low[axis];
    let longer = |best, axis| if side(axis) > side(best) { axis } else { best };
    let axis = (1..N).fold(0, longer);
    let middle = things.len() / 2;
    things.select_nth_unstable_by(middle, |a, b| {
        let ((a, one), (b, other)) = (place(a), place(b));
        a[axis].total_cmp(&b[axis]).then(one.cmp(&other))
    });
    let (before, after) = things.split_at_mut(middle);
    build(before, first, leaf, place, known, nodes);
    nodes[at].second = nodes.len();
    build(after, first + middle, leaf, place, known, nodes);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every node holds its things in its box, and its halves hold each of them once; also where all are in one place.
    #[test]
    fn halves_share_the_things_and_boxes_hold_them() {
        for spread in [5.0, 0.0] {
            let position = |i: usize| [0.7, 1.9, 3.1].map(|step| spread * (step * i as f64).sin());
            for count in [0, 1, 8, 9, 300] {
                let mut things: Vec<usize> = (0..count).collect();
                let nodes = box_tree(
                    &mut things,
                    LEAF,
                    |&i| (position(i), i),
                    |things| things.len(),
                );
                let mut sorted = things.clone();
                sorted.sort_unstable();
                assert!(sorted.into_iter().eq(0..count));
                assert_eq!(nodes.is_empty(), count == 0);
                for (at, node) in nodes.iter().enumerate() {
                    assert_eq!(node.known, node.count);
                    for &thing in &things[node.first..node.first + node.count] {
                        let held = |axis: usize| {
                            let x = position(thing)[axis];
                            node.low[axis] <= x && x <= node.high[axis]
                        };
                        assert!((0..3).all(held));
                    }
                    if node.second == 0 {
                        assert!(node.count <= LEAF);
                        continue;
                    }
                    let (one, other) = (&nodes[at + 1], &nodes[node.second]);
                    assert_eq!(node.count, one.count + other.count);
                    assert_eq!(
                        (one.first, other.first),
                        (node.first, one.first + one.count)
                    );
                }
            }
        }
    }
}
