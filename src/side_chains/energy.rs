//! Energy of two atoms that are not bonded; the formulas are at the top of the module above.

use knotdock_structures::molecule::HydrogenBonding;

/// Distance in Å past which atoms do not act on each other.
pub(super) const REACH: f64 = 6.0;

/// Depth of the contact of two atoms.
const DEPTH: f64 = 0.1;
/// Most that two atoms cost each other.
const MAX_REPULSION: f64 = 10.0;

/// Best distance in Å of a hydrogen bond's heavy atoms.
const BOND_DISTANCE: f64 = 2.9;
/// Depth of a hydrogen bond.
const BOND_DEPTH: f64 = 1.5;
/// Cosine and sine of the angle between a hydrogen bond and the direction away from an atom's one bonded neighbour, 60
/// degrees.
const BESIDE: [f64; 2] = [0.5, 0.866_025_403_784_438_6];

/// An atom in its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Particle {
    pub position: [f64; 3],
    pub radius: f64,
    pub bonding: Option<Bonding>,
}

/// Role of an atom in hydrogen bonds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bonding {
    pub role: HydrogenBonding,
    /// Unit vector away from the bonded neighbours, and whether there is only one; `None` for an atom by itself.
    pub direction: Option<([f64; 3], bool)>,
}

impl Bonding {
    /// Fit of a partner in the direction of this unit vector, 0 to 1.
    fn fit(&self, towards: [f64; 3]) -> f64 {
        let Some((direction, is_end)) = self.direction else {
            return 1.0;
        };
        let cos: f64 = (0..3).map(|axis| direction[axis] * towards[axis]).sum();
        let off = if is_end {
            // cos(a - 60 degrees), a the angle between the two.
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            cos * BESIDE[0] + sin * BESIDE[1]
        } else {
            cos
        };
        off.max(0.0).powi(2)
    }
}

/// Energy of two atoms, the same in either order.
pub(super) fn pair_energy(a: &Particle, b: &Particle) -> f64 {
    let between: [f64; 3] = std::array::from_fn(|axis| b.position[axis] - a.position[axis]);
    let square: f64 = between.iter().map(|x| x * x).sum();
    if square >= REACH * REACH {
        return 0.0;
    }
    let sum = a.radius + b.radius;
    let x6 = (sum * sum / square).powi(3);
    // Atoms at one place have an infinite or undefined value here.
    let contact = if x6.is_finite() {
        (DEPTH * x6 * (x6 - 2.0)).min(MAX_REPULSION)
    } else {
        MAX_REPULSION
    };
    contact + hydrogen_bond(a, b, between, square)
}

/// Energy of the hydrogen bond that two atoms may form, at most 0.
fn hydrogen_bond(a: &Particle, b: &Particle, between: [f64; 3], square: f64) -> f64 {
    let (Some(of_a), Some(of_b)) = (&a.bonding, &b.bonding) else {
        return 0.0;
    };
    let bonds = |giver: HydrogenBonding, taker: HydrogenBonding| giver.donor && taker.acceptor;
    if !(bonds(of_a.role, of_b.role) || bonds(of_b.role, of_a.role)) {
        return 0.0;
    }
    let y2 = BOND_DISTANCE * BOND_DISTANCE / square;
    let y10 = y2.powi(5);
    let radial = BOND_DEPTH * y10 * (5.0 * y2 - 6.0);
    // Too near a bond, and atoms at one place.
    if radial.is_nan() || radial >= 0.0 {
        return 0.0;
    }
    let distance = square.sqrt();
    let towards = between.map(|x| x / distance);
    radial * of_a.fit(towards) * of_b.fit(towards.map(|x| -x))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn atom(x: f64, bonding: Option<Bonding>) -> Particle {
        Particle {
            position: [x, 0.0, 0.0],
            radius: 1.5,
            bonding,
        }
    }

    #[test]
    fn contacts_are_best_where_radii_touch_and_bounded() {
        let of = |d: f64| pair_energy(&atom(0.0, None), &atom(d, None));
        assert!((of(3.0) + DEPTH).abs() < 1e-12);
        assert!(of(2.9) > of(3.0) && of(3.1) > of(3.0));
        for d in [0.0, 1e-200, 1e-3, 1.0] {
            assert_eq!(of(d), MAX_REPULSION);
        }
        assert_eq!(of(6.0), 0.0);
    }

    /// A donor and an acceptor at the best distance and angles gain the whole depth; two donors gain nothing.
    #[test]
    fn hydrogen_bonds_go_by_distance_and_direction() {
        let bonding = |donor: bool, direction: Option<([f64; 3], bool)>| {
            Some(Bonding {
                role: HydrogenBonding {
                    donor,
                    acceptor: !donor,
                },
                direction,
            })
        };
        let straight = Some(([1.0, 0.0, 0.0], false));
        let beside = Some(([-BESIDE[0], BESIDE[1], 0.0], true));
        let back = Some(([1.0, 0.0, 0.0], false));
        let of = |first: Option<Bonding>, second: Option<Bonding>| {
            let (a, b) = (atom(0.0, first), atom(BOND_DISTANCE, second));
            let energy = pair_energy(&a, &b);
            assert_eq!(energy, pair_energy(&b, &a));
            energy - pair_energy(&atom(0.0, None), &atom(BOND_DISTANCE, None))
        };
        assert!((of(bonding(true, straight), bonding(false, beside)) + BOND_DEPTH).abs() < 1e-9);
        assert!((of(bonding(true, None), bonding(false, None)) + BOND_DEPTH).abs() < 1e-9);
        assert!(of(bonding(true, straight), bonding(false, back)).abs() < 1e-12);
        assert_eq!(of(bonding(true, straight), bonding(true, beside)), 0.0);
    }
}
