//! Minkowski sums by pairs (Behandish & Ilieş, CAD 70, 2016, section 5.1): centres are added, radii too.
//!
//! A solid is a set of balls, or the nodes of a uniform grid inside it. The sum of n1 and n2 of them has n1 n2. It is
//! written to memory, or streamed: each is computed, used and forgotten. The use here is the gap at a place, the distance
//! to an obstacle.

/// Centre and radius of a ball: x, y, z, r.
pub type Knot = [f64; 4];
/// A grid's node: x, y, z.
pub type Node = [f64; 3];

/// Writes the sums of all pairs, those of one of `first` together.
pub fn write<const N: usize>(first: &[[f64; N]], second: &[[f64; N]], sum: &mut Vec<[f64; N]>) {
    sum.clear();
    for a in first {
        sum.extend(second.iter().map(|b| std::array::from_fn(|i| a[i] + b[i])));
    }
}

/// Signed distance from a place to the sum of two sets of balls: above zero outside; inside, the depth in the ball that
/// the place is deepest in.
pub fn gap_of_balls(first: &[Knot], second: &[Knot], place: Node) -> f64 {
    let mut gap = f64::INFINITY;
    for a in first {
        let from = [place[0] - a[0], place[1] - a[1], place[2] - a[2]];
        for b in second {
            let across = [from[0] - b[0], from[1] - b[1], from[2] - b[2]];
            gap = gap.min(square(across).sqrt() - (a[3] + b[3]));
        }
    }
    gap
}

/// Distance from a place to the nearest sum of two nodes.
pub fn gap_of_nodes(first: &[Node], second: &[Node], place: Node) -> f64 {
    let mut least = f64::INFINITY;
    for a in first {
        let from = [place[0] - a[0], place[1] - a[1], place[2] - a[2]];
        for b in second {
            least = least.min(square([from[0] - b[0], from[1] - b[1], from[2] - b[2]]));
        }
    }
    least.sqrt()
}

fn square([x, y, z]: Node) -> f64 {
    x * x + y * y + z * z
}
