//! The lifted cone (B&I eq. 44): one kernel over (x, r) whose slice at height rho is the pair kernel of two balls.
//!
//! kappa(d, sigma) = psi_alpha(d / sigma) w(sigma). For balls of radii r, s and a slice at offset rho, sigma = r + s +
//! rho. The factor w is the trim along the radius axis: it makes the cone periodic in sigma, so that it has Fourier
//! modes.
//!
//! B&I's r axis runs the other way, r = -sigma. Their trim is printed as psi_alpha(1 - r / L) after eq. 44, and as
//! psi_alpha(1 - 2 r / L) in section 2.2. For r < 0 the argument is above 1, where psi_alpha is 0: as printed it
//! vanishes on its own support. The working sign, psi_alpha(1 + r / L) = psi_alpha(1 - sigma / L), is used here.

use super::smooth_step_down;
use knotdock_structures::numeric::Bump;
use serde::{Deserialize, Serialize};

/// The trim w(sigma) along the lifted axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Trim {
    /// 1 on the radii in use, C-infinity down to 0 outside: changes no pair (default).
    #[default]
    FlatTop,
    /// B&I's product trim with the working sign, psi_alpha(1 - sigma / length).
    ///
    /// It weights pairs by their radii, which changes the meaning of lambda. It is smooth, and its series short, only
    /// where alpha is even.
    BehandishIlies {
        /// Radius sum at which the trim is 1, in Å. It falls to 0 at 0 and at twice this length, which must lie beyond
        /// all radius sums in use.
        length: f64,
    },
}

/// The lifted cone on the radius sums [low, high] in use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The bump function along d / sigma.
    pub bump: Bump,
    /// The trim along sigma.
    pub trim: Trim,
    /// Smallest radius sum in use (slice 0), in Å.
    pub low: f64,
    /// Largest radius sum in use (slice 2 r0), in Å.
    pub high: f64,
}

impl Cone {
    /// Width in Å of the flat-top trim's taper on each side of [low, high]; scales with the lengths themselves.
    pub fn taper(&self) -> f64 {
        (0.6 * (self.high - self.low)).max(0.35 * self.high)
    }

    /// Radius sums in Å between which the trim is not 0, all those in use among them: one period of the lifted axis.
    pub fn ends(&self) -> [f64; 2] {
        match self.trim {
            Trim::FlatTop => [self.low - self.taper(), self.high + self.taper()],
            Trim::BehandishIlies { length } => [0.0, 2.0 * length],
        }
    }

    /// Period P of the lifted axis in Å, from one end of the trim to the other.
    ///
    /// That of the flat top covers the radius sums in use and two tapers.
    pub fn period(&self) -> f64 {
        match self.trim {
            Trim::FlatTop => self.high - self.low + 2.0 * self.taper(),
            Trim::BehandishIlies { length } => 2.0 * length,
        }
    }

    /// The trim w(sigma); sigma may be below 0, where the flat top's taper may end.
    pub fn trim_value(&self, sigma: f64) -> f64 {
        match self.trim {
            Trim::FlatTop => {
                let outside = (self.low - sigma).max(sigma - self.high);
                smooth_step_down(outside, 0.0, self.taper())
            }
            Trim::BehandishIlies { length } => self.bump.value(1.0 - sigma / length),
        }
    }

    /// kappa(d, sigma) for sigma in [low, high], d >= 0 in Å.
    pub fn value(&self, distance: f64, sigma: f64) -> f64 {
        self.bump.value(distance / sigma) * self.trim_value(sigma)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_top_changes_no_pair_in_use_and_closes_the_period() {
        let cone = Cone {
            bump: Bump::new(2.0).unwrap(),
            trim: Trim::FlatTop,
            low: 3.0,
            high: 7.8,
        };
        for sigma in [3.0, 4.4, 7.8] {
            assert_eq!(cone.trim_value(sigma), 1.0);
        }
        assert_eq!(cone.trim_value(3.0 - cone.taper()), 0.0);
        assert_eq!(cone.trim_value(7.8 + cone.taper()), 0.0);
        let paper = Cone {
            trim: Trim::BehandishIlies { length: 6.0 },
            ..cone
        };
        assert_eq!(paper.trim_value(6.0), 1.0);
        assert!(paper.trim_value(3.0) < 0.8);
        assert_eq!(paper.ends().map(|end| paper.trim_value(end)), [0.0; 2]);
    }
}
