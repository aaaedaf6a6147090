//! Schedule of the rotations: those that are searched, in their order.
//!
//! A search within a time stops between two rotations. It has then searched the first part of an order in which every
//! first part covers all orientations about evenly. The number of these rotations is recorded: searched again, they give
//! the same bytes.

use crate::pose_space::rotations::RotationGroup;
use crate::search::plan::SearchPlan;

/// The groups of rotations to search: all in the order of the set, or evenly spread if a search may stop, or has stopped,
/// before the last.
pub(crate) fn schedule(plan: &SearchPlan, may_stop: bool) -> Vec<RotationGroup> {
    let all = plan.rotations.groups();
    if !may_stop && plan.stop_after.is_none() {
        return all;
    }
    let mut spread: Vec<RotationGroup> = evenly_spread(all.len()).map(|index| all[index]).collect();
    if let Some(limit) = plan.stop_after {
        let mut searched = 0;
        spread.retain(|group| {
            let wanted = searched < limit;
            searched += group.count();
            wanted
        });
    }
    spread
}

/// Indices below `count` in steps of a golden section of it, so that a first part of them leaves no large gap. Sets of
/// rotations are spirals, whose indices run through all orientations.
fn evenly_spread(count: usize) -> impl Iterator<Item = usize> {
    let golden = (count as f64 * 0.618_033_988_749_894_9).round() as usize;
    let coprime = |step: &usize| greatest_common_divisor(*step, count) == 1;
    let step = (golden.max(1)..).find(coprime).unwrap_or(1);
    (0..count).map(move |place| place * step % count)
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    match b {
        0 => a,
        _ => greatest_common_divisor(b, a % b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_scoring::grid_turn::GridTurn;
    use knotdock_scoring::so3::{covering_radius, rotation_set};

    #[test]
    fn the_order_has_every_index_once() {
        for count in [0, 1, 2, 3, 4, 5, 900, 901, 14_063] {
            let mut indices: Vec<usize> = evenly_spread(count).collect();
            indices.sort_unstable();
            assert!(indices.iter().copied().eq(0..count), "{count}");
        }
    }

    /// A first part covers as a set of that size does, or nearly; the set's own order leaves half of the orientations
    /// out.
    #[test]
    fn a_first_part_covers_all_orientations() {
        let set = rotation_set(3600);
        let images = GridTurn::ALL.len();
        let of_groups = |groups: Vec<usize>| -> Vec<_> {
            let all = |group: usize| (images * group..images * (group + 1)).map(|index| set[index]);
            groups.into_iter().flat_map(all).collect()
        };
        for part in [45, 112, 225, 350] {
            let own = covering_radius(&rotation_set(images * part));
            let first = covering_radius(&of_groups(evenly_spread(450).take(part).collect()));
            assert!(first < 1.6 * own, "{part}: {first} {own}");
            let in_order = covering_radius(&of_groups((0..part).collect()));
            assert!(first < in_order, "{part}: {first} {in_order}");
        }
    }
}
