//! Truncation at run time: the modes of a correlation that are kept, and the error without the rest.
//!
//! # Conventions
//!
//! - `modes` counts three-dimensional frequencies, both of a conjugate pair; the lifted axis is summed over already.
//! - Modes come and go in groups of up to four, (±kx, ky, kz) and their conjugates: they cost together what one costs,
//!   and keep the correlation real. So a selection of at most m modes keeps m - 3 to m of them while there are any
//!   left.
//! - A magnitude is |G^(w)| / volume of a stored mode: what that frequency and its conjugate each add to a value at
//!   most.

use super::modes::{Column, ModeSet};

/// Which modes come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModeOrder {
    /// From frequency zero outward.
    LowFrequency,
    /// By falling magnitude.
    Magnitude,
}

/// The modes that are kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection {
    /// For every mode of the set whether it is kept.
    kept: Vec<bool>,
    modes: usize,
}

/// Modes that are kept or left out together.
struct Group {
    /// Places of the stored ones, the first `stored` of them.
    places: [usize; 4],
    stored: usize,
    /// Modes in the group, conjugates counted.
    modes: usize,
    /// Squared frequency.
    square: f64,
}

impl Group {
    fn places(&self) -> &[usize] {
        &self.places[..self.stored]
    }
}

impl Selection {
    /// Every mode.
    pub fn all(modes: &ModeSet) -> Self {
        Self {
            kept: vec![true; modes.count],
            modes: total(modes),
        }
    }

    /// At most `most` modes, from frequency zero outward; ties go by place in the set.
    pub fn low_frequency(modes: &ModeSet, most: usize) -> Self {
        Self::first(modes, &by_frequency(modes), most)
    }

    /// At most `most` modes by falling magnitude, groups by their mean square; ties go by place in the set.
    ///
    /// # Panics
    /// Unless there is one magnitude per mode of the set.
    pub fn by_magnitude(modes: &ModeSet, magnitudes: &[f64], most: usize) -> Self {
        assert_eq!(magnitudes.len(), modes.count, "one magnitude a mode");
        let mut keyed: Vec<(f64, Group)> = groups(modes)
            .into_iter()
            .map(|group| {
                let squares = group
                    .places()
                    .iter()
                    .map(|&place| magnitudes[place] * magnitudes[place]);
                (squares.sum::<f64>() / group.stored as f64, group)
            })
            .collect();
        keyed.sort_by(|a, b| b.0.total_cmp(&a.0));
        let groups: Vec<Group> = keyed.into_iter().map(|(_, group)| group).collect();
        Self::first(modes, &groups, most)
    }

    fn first(modes: &ModeSet, groups: &[Group], most: usize) -> Self {
        let mut selection = Self {
            kept: vec![false; modes.count],
            modes: 0,
        };
        for group in groups {
            if selection.modes + group.modes > most {
                break;
            }
            for &place in group.places() {
                selection.kept[place] = true;
            }
            selection.modes += group.modes;
        }
        selection
    }

    /// Number of modes kept, conjugates counted.
    pub fn modes(&self) -> usize {
        self.modes
    }

    /// Whether a mode is kept, by its place in the set.
    pub fn keeps(&self, place: usize) -> bool {
        self.kept[place]
    }
}

/// Root mean square, over all translations of the box, of the part of a correlation outside of a selection of modes: by
/// Parseval the root of the sum of their squared magnitudes.
///
/// # Panics
/// If magnitudes or selection belong to another set.
pub fn rms_left_out(modes: &ModeSet, selection: &Selection, magnitudes: &[f64]) -> f64 {
    assert_eq!(magnitudes.len(), modes.count, "one magnitude a mode");
    assert_eq!(
        selection.kept.len(),
        modes.count,
        "the selection of these modes"
    );
    let mut squares = 0.0;
    modes.for_each(|place, _, multiplicity| {
        if !selection.keeps(place) {
            squares += multiplicity * magnitudes[place] * magnitudes[place];
        }
    });
    squares.sqrt()
}

/// Number of modes in a set, conjugates counted.
pub fn total(modes: &ModeSet) -> usize {
    let plane = modes.columns.iter().filter(|column| column.kz == 0);
    let plane: usize = plane.map(Column::count).sum();
    2 * modes.count - plane
}

/// The modes of the largest ball of frequencies that has at most `most`: what a correlation is cut to when it shall
/// also cost less. Its shells are whole, so it may hold fewer than [`Selection::low_frequency`] keeps; it always holds
/// frequency zero.
pub fn ball(modes: &ModeSet, most: usize) -> ModeSet {
    let groups = by_frequency(modes);
    let mut held = 0;
    let Some(beyond) = groups.iter().position(|group| {
        held += group.modes;
        held > most
    }) else {
        return modes.clone();
    };
    let stop = groups[beyond].square;
    // Frequencies of a shell agree to rounding only.
    let last = groups[..beyond]
        .iter()
        .map(|group| group.square)
        .rfind(|&square| square < stop * (1.0 - 1e-9))
        .unwrap_or(0.0);
    let next = groups
        .iter()
        .map(|group| group.square)
        .find(|&square| square > last * (1.0 + 1e-9))
        .unwrap_or(stop);
    ModeSet::new(modes.size, modes.lengths, 0.5 * (last.sqrt() + next.sqrt()))
}

/// All groups of a set from frequency zero outward; ties go by place.
fn by_frequency(modes: &ModeSet) -> Vec<Group> {
    let mut groups = groups(modes);
    groups.sort_by(|a, b| a.square.total_cmp(&b.square));
    groups
}

/// All groups of a set, by rising place.
fn groups(modes: &ModeSet) -> Vec<Group> {
    let mut groups = Vec::with_capacity(modes.count / 2 + 1);
    let mirrors = modes.mirrors();
    for (column, mirror) in modes.columns.iter().zip(mirrors) {
        // Of the plane kz = 0 the set stores both signs of ky; the mirror image joins the group.
        let mirror = match (column.kz, column.ky) {
            (0, ky) if ky < 0 => continue,
            (0, ky) if ky > 0 => modes.columns.get(mirror as usize),
            _ => None,
        };
        let wy = f64::from(column.ky) / modes.lengths[1];
        let wz = f64::from(column.kz) / modes.lengths[2];
        for k in 0..=column.kx_max {
            let wx = f64::from(k) / modes.lengths[0];
            let mut group = Group {
                places: [0; 4],
                stored: 0,
                modes: 0,
                square: wx * wx + wy * wy + wz * wz,
            };
            let signs: &[i32] = if k == 0 { &[1] } else { &[1, -1] };
            for column in std::iter::once(column).chain(mirror) {
                for sign in signs {
                    group.places[group.stored] = column.start + (column.kx_max + sign * k) as usize;
                    group.stored += 1;
                }
            }
            group.modes = if column.kz == 0 {
                group.stored
            } else {
                2 * group.stored
            };
            groups.push(group);
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set() -> ModeSet {
        ModeSet::new([16, 18, 12], [30.0, 33.0, 25.0], 0.22)
    }

    #[test]
    fn groups_hold_every_mode_once() {
        let modes = set();
        let mut seen = vec![0; modes.count];
        let mut count = 0;
        for group in groups(&modes) {
            count += group.modes;
            for &place in group.places() {
                seen[place] += 1;
            }
        }
        assert!(seen.iter().all(|&times| times == 1));
        assert_eq!(count, total(&modes));
        let mut by_multiplicity = 0.0;
        modes.for_each(|_, _, multiplicity| by_multiplicity += multiplicity);
        assert_eq!(by_multiplicity, total(&modes) as f64);
    }

    #[test]
    fn low_frequencies_come_first_and_the_count_is_the_requested_one() {
        let modes = set();
        for most in [1, 2, 50, 333, total(&modes) - 1, total(&modes), 1 << 30] {
            let selection = Selection::low_frequency(&modes, most);
            let kept = selection.modes();
            assert!(kept <= most && kept + 3 >= most.min(total(&modes)));
            let (mut inside, mut outside, mut counted) = (0.0f64, f64::INFINITY, 0.0);
            modes.for_each(|place, w, multiplicity| {
                let length = w.iter().map(|x| x * x).sum::<f64>();
                if selection.keeps(place) {
                    inside = inside.max(length);
                    counted += multiplicity;
                } else {
                    outside = outside.min(length);
                }
            });
            assert!(inside <= outside && counted == kept as f64);
        }
    }

    #[test]
    fn a_ball_has_whole_shells_and_no_more_than_requested() {
        let modes = set();
        for most in [1, 7, 100, 500, 1 << 30] {
            let ball = ball(&modes, most);
            assert!(total(&ball) <= most.max(1));
            // The shell that comes next would not have fitted.
            let wider = ModeSet::new(modes.size, modes.lengths, modes.cut);
            let next = Selection::low_frequency(&wider, most + 24);
            assert!(total(&ball) + 48 > most.min(total(&modes)) || next.modes() > most);
        }
        assert_eq!(total(&super::ball(&modes, 1)), 1);
    }

    /// A cube has large shells of exactly equal frequencies, which rounding must not tear.
    #[test]
    fn a_cube_is_cut_between_its_shells() {
        let modes = ModeSet::new([12; 3], [20.0; 3], 0.2);
        // 1 + 6 (100) + 12 (110) + 8 (111) + 6 (200) = 33.
        for (most, expected) in [
            (6, 1),
            (7, 7),
            (18, 7),
            (19, 19),
            (27, 27),
            (32, 27),
            (33, 33),
        ] {
            assert_eq!(total(&ball(&modes, most)), expected, "{most}");
        }
    }
}
