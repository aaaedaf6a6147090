//! The radii of two bodies, and how they meet in the kernel.

use super::pair_kernel::PairKernel;
use crate::kernel::RankingKernel;
use crate::lifted_axis::{LiftedAxis, RadiusBasis};
use knotdock_structures::Knots;

/// The distinct radii of both bodies, Å, each from the smallest to the largest.
pub(super) struct Radii {
    receptor: Vec<f64>,
    ligand: Vec<f64>,
}

impl Radii {
    pub fn of(receptor: &Knots, ligand: &Knots) -> Self {
        Self {
            receptor: receptor.radius_classes().0,
            ligand: ligand.radius_classes().0,
        }
    }

    /// The smallest radius of the receptor and of the ligand, then the largest; zeros where there is none.
    pub fn ends(&self) -> [f64; 4] {
        let end = |radius: Option<&f64>| radius.copied().unwrap_or_default();
        [
            end(self.receptor.first()),
            end(self.ligand.first()),
            end(self.receptor.last()),
            end(self.ligand.last()),
        ]
    }

    /// The smallest and the largest sum of a receptor's and a ligand's radius.
    pub fn sums(&self) -> (f64, f64) {
        let [r_low, s_low, r_high, s_high] = self.ends();
        (r_low + s_low, r_high + s_high)
    }

    /// The lifted axis, how radii meet it, and the largest relative error of that, `tolerance` at most. A product
    /// kernel, whose frequencies end at `cut` per Å, has no use for the axis: that is the mean alone then.
    pub fn meet(
        self,
        kernel: &RankingKernel,
        pair: &PairKernel,
        cut: f64,
        tolerance: f64,
    ) -> (LiftedAxis, RadiusBasis, f64) {
        match pair {
            PairKernel::Lifted => {
                let (axis, error) = LiftedAxis::for_tolerance(kernel, tolerance);
                let basis = RadiusBasis::choose(&axis, self.receptor, self.ligand);
                (axis, basis, error)
            }
            PairKernel::Product(product) => {
                let (basis, error) =
                    RadiusBasis::for_product(product, self.receptor, self.ligand, cut, tolerance);
                (LiftedAxis::new(kernel, 0), basis, error)
            }
        }
    }
}
