//! Options on the search: its density, and the hardware that it runs on.

use knotdock_scoring::symmetry::Symmetry;
use serde::{Deserialize, Serialize};

use super::definition::{Choice, Optional, Parsed, options};
use super::values::{NOT_NEGATIVE, Range, Rotations, SHARE};

options! {
    /// Density of the search, and its engine.
    SearchOptions as search, "Search", Both {
        /// Rotations of the ligand, spread evenly over all: their number, or the angle between them, such as 15deg.
        ///
        /// An angle stands for a number, 3600 (15/D)^3, so that 6deg gives 56,250. By default a small ligand has fewer
        /// than 3600: 3600 (R/14)^3 if its radius of gyration R is below 14 Å, 1000 at the least. With --symmetry the option counts axes,
        /// by default 900 over half a sphere or 90 across a ring's own.
        rotations: usize = 3600, "COUNT|ANGLE", Rotations(ROTATIONS);
        /// Search again, among this many rotations, about the best: a number or an angle.
        ///
        /// Their peaks take the place of the best rotations' own. Meshes have 30,000, of which a share of 0.2 is searched,
        /// unless this option, --rotations, --fine-share or --budget is given.
        fine_rotations: Option<usize> = None, "COUNT|ANGLE", Optional(Rotations(ROTATIONS));
        /// Share of the finer rotations that are searched.
        fine_share: f64 = 0.05, "SHARE", SHARE;
        /// Floating-point type of the search: single or double.
        ///
        /// single allows tolerances down to 1e-4, double down to 1e-6. What is reported is in double precision either way.
        precision: Precision = Precision::Single, "single|double", Choice;
        /// What computes the correlations: cpu; gpu, a graphics processor; or auto, which takes one if it can.
        ///
        /// auto takes the CPU if there is no graphics processor, if it fails (with a warning), or if other options need the
        /// CPU; --budget, --accuracy and tradeoff refuse it. A graphics processor works through Vulkan, Metal or Direct3D 12,
        /// in single precision. If there are several, the
        /// environment variable WGPU_ADAPTER_NAME names one.
        engine: EngineChoice = EngineChoice::Cpu, "cpu|gpu|auto", Choice;
        /// Peaks kept of each rotation.
        per_rotation: usize = 3, "COUNT", Range::between(1.0, 1e4);
        /// Poses kept of all rotations.
        poses: usize = 2000, "COUNT", Range::between(1.0, 1e7);
        /// Best poses to refine off the grid [default: 600 with shape alone, else none].
        ///
        /// Beside other effects tighter fits make no better a ranking.
        refine: Option<usize> = None, "COUNT", Optional(NOT_NEGATIVE);
        /// Dock copies of RECEPTOR into a ring: C2, C3 ..., or two rings: D2, D3 ...
        ///
        /// LIGAND is left out. C2, C3 and so on put 2, 3 and more copies about an axis. If RECEPTOR is itself a ring of 2,
        /// 3 or more copies, D2, D3 and so on dock two such rings face to face. The option --rotations then counts axes,
        /// and each pose is where the second copy or ring goes. Residues that --block-receptor and --active-receptor name
        /// are those of every copy, or of both rings.
        symmetry: Option<Symmetry> = None, "Cn|Dn", Optional(Parsed);
    }
}

/// Numbers of rotations of a set.
const ROTATIONS: Range = Range::between(1.0, 1e7);

/// Poses refined by default when shape is all there is: as many as it takes for ranks to depend little on the
/// ligand's random start orientation (docs/research/defaults.md). Beside other effects refining cost ranks.
pub const REFINED_BY_SHAPE: usize = 600;

/// Axes of rings by default: 4 degrees to the nearest at most, and up to twice that for the copies about it.
pub const AXES: usize = 900;

/// Axes of two rings by default: of D2 at steps of one degree, of Dn of 2 / n degrees.
pub const AXES_ACROSS: usize = 90;

/// Floating-point type of the fast path: spectra, grids and the search. Reports are always in double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// 32 bits: tolerances down to 1e-4.
    #[default]
    Single,
    /// 64 bits: tolerances down to 1e-6.
    Double,
}

impl From<Precision> for knotdock_scoring::Precision {
    fn from(precision: Precision) -> Self {
        match precision {
            Precision::Single => Self::Single,
            Precision::Double => Self::Double,
        }
    }
}

impl Precision {
    /// Finest tolerance that it can reach.
    pub fn finest_tolerance(self) -> f64 {
        match self {
            Self::Single => 1e-4,
            Self::Double => 1e-6,
        }
    }
}

/// Device of the correlations. All else, such as exact sums and refinement, is computed on the CPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EngineChoice {
    /// The CPU's cores.
    #[default]
    Cpu,
    /// A graphics processor, in single precision.
    Gpu,
    /// A graphics processor if there is one that can, else the CPU's cores.
    Auto,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::definitions;

    /// The help writes out defaults that depend on more than the option itself.
    #[test]
    fn the_help_states_the_defaults_that_are_computed() {
        let help = |name: &str| {
            let all = definitions();
            let found = all.iter().find(|definition| definition.name() == name);
            found.unwrap().help()
        };
        assert!(help("refine").contains(&format!("default: {REFINED_BY_SHAPE} ")));
        let axes = format!("{AXES} over half a sphere or {AXES_ACROSS} across");
        assert!(help("rotations").contains(&axes));
        let ratio = format!("default: {} times", crate::options::PASS_RATIO);
        assert!(help("pass_length").contains(&ratio));
    }
}
