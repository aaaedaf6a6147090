//! Bytes that a rotation moves at the least, from the sizes that a plan fixes.
//!
//! The stages are those of both devices: spreading, three forward transforms, the product with the inverse along x,
//! the inverses along y and z. Each writes its result once, and the next one reads it once. A real number takes `real`
//! bytes and a complex one twice as many. Neither padding nor what a stage holds for itself counts.
//!
//! The count is of loads and stores, wherever they end. A processor whose caches hold some results moves fewer bytes
//! to and from its memory.

use super::cpu::{CpuEngine, TOGETHER, Transforms};
use crate::precision::{Precision, of_precision};
use crate::transform::Real;

/// Sizes of the results of all stages.
#[derive(Clone, Debug)]
pub(super) struct StageSizes {
    /// Grid of the scores, points per axis.
    pub grid: [usize; 3],
    /// Block of the fine grid that the ligand's knots are spread onto, points per axis.
    pub block: [usize; 3],
    /// Components of the lifted axis in use.
    pub components: usize,
    /// Planes kz that hold modes.
    pub depth: usize,
    /// Columns of modes.
    pub columns: usize,
    /// Modes of all columns.
    pub modes: usize,
    /// Images that one transform of the ligand serves.
    pub images: usize,
}

impl StageSizes {
    pub fn new<T: Real>(engine: &Transforms<T>) -> Self {
        let modes = engine.plan.modes();
        Self {
            grid: modes.size,
            block: engine.forward.block(),
            components: engine.rank(),
            depth: modes.planes.len(),
            columns: modes.columns.len(),
            modes: modes.count,
            images: engine.readings.len(),
        }
    }

    /// Bytes of each result that serves all images: the block, its rows along z, its columns before the transform
    /// along x, the ligand's modes.
    pub fn of_turn(&self, real: usize) -> [usize; 4] {
        let [bx, by, bz] = self.block;
        let complex = 2 * real;
        [
            real * self.components * bx * by * bz,
            complex * self.components * bx * self.depth * by,
            complex * self.components * self.columns * bx,
            complex * self.components * self.modes,
        ]
    }

    /// Bytes of each result of one image: the product's columns, its planes, the scores, the best of each row.
    pub fn of_image(&self, real: usize) -> [usize; 4] {
        let [nx, ny, nz] = self.grid;
        let complex = 2 * real;
        [
            complex * self.columns * nx,
            complex * nx * self.depth * ny,
            real * nx * ny * nz,
            real * nx * ny,
        ]
    }

    /// Bytes of the receptor's spectra, which the product reads.
    pub fn spectra(&self, real: usize) -> usize {
        2 * real * self.components * self.modes
    }

    /// Bytes that one image reads and writes at the least, its share of what serves several included: all images share
    /// the ligand's transform, and `together` of them a reading of the receptor's spectra.
    pub fn least_traffic(&self, real: usize, together: usize) -> u64 {
        let turn: usize = self.of_turn(real).iter().sum();
        let image: usize = self.of_image(real).iter().sum();
        (2 * (turn / self.images + image) + self.spectra(real) / together) as u64
    }
}

impl CpuEngine {
    /// Bytes that a rotation reads and writes at the least where as many images go through together as can: each
    /// stage's result written once and read once, and the receptor's spectra read.
    pub fn least_traffic(&self) -> u64 {
        let sizes = of_precision!(&self.0, transforms => StageSizes::new(transforms));
        let real = match self.precision() {
            Precision::Single => size_of::<f32>(),
            Precision::Double => size_of::<f64>(),
        };
        sizes.least_traffic(real, sizes.images.min(TOGETHER))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes() -> StageSizes {
        StageSizes {
            grid: [4, 6, 8],
            block: [2, 3, 5],
            components: 2,
            depth: 3,
            columns: 7,
            modes: 21,
            images: 4,
        }
    }

    /// Counted by hand: 2 x 3 x 5 points, 2 x 3 rows of 3 planes, 7 columns of 2 and 21 modes, of two components each;
    /// 7 columns of 4, 4 x 6 rows of 3 planes, 4 x 6 x 8 scores and 4 x 6 rows.
    #[test]
    fn small_results_have_the_bytes_that_are_counted_by_hand() {
        assert_eq!(sizes().of_turn(4), [240, 288, 224, 336]);
        assert_eq!(sizes().of_image(4), [224, 576, 768, 96]);
        assert_eq!(sizes().spectra(4), 336);
    }

    /// 1,088 bytes serve four images: 272 each. With the image's own 1,664 they are written and read: 3,872 bytes. The
    /// spectra's 336 bytes are read by each image, or once by four.
    #[test]
    fn an_image_moves_its_own_results_and_a_share_of_the_others() {
        assert_eq!(sizes().least_traffic(4, 1), 3872 + 336);
        assert_eq!(sizes().least_traffic(4, 4), 3872 + 84);
        let double = sizes().least_traffic(8, 4);
        assert_eq!(double, 2 * sizes().least_traffic(4, 4));
        let alone = StageSizes {
            images: 1,
            ..sizes()
        };
        assert_eq!(alone.least_traffic(4, 1), 2 * (1088 + 1664) + 336);
    }
}
