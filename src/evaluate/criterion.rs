//! Success criteria of a pose: the one meaning of "acceptable" and of "near-native" in this project.

use serde::Serialize;

use super::PoseQuality;
use super::dockq::Capri;

/// Interface RMSD in Å up to which a pose is near-native.
const NEAR_NATIVE_INTERFACE_RMSD: f64 = 2.5;

/// Criterion for a pose that counts as found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// CAPRI's class acceptable, medium or high ([`Capri::of`]).
    Acceptable,
    /// An interface RMSD of at most 2.5 Å.
    NearNative,
}

impl Criterion {
    /// Every criterion.
    pub const ALL: [Self; 2] = [Self::Acceptable, Self::NearNative];

    /// The criterion's name in tables and JSON: `acceptable` or `near_native`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Acceptable => "acceptable",
            Self::NearNative => "near_native",
        }
    }

    /// Whether a pose of this quality meets the criterion.
    pub fn is_met(self, quality: &PoseQuality) -> bool {
        match self {
            Self::Acceptable => quality.capri >= Capri::Acceptable,
            Self::NearNative => quality.irmsd <= NEAR_NATIVE_INTERFACE_RMSD,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quality(fnat: f64, irmsd: f64, lrmsd: f64) -> PoseQuality {
        PoseQuality {
            irmsd,
            lrmsd,
            fnat,
            dockq: 0.0,
            capri: Capri::of(fnat, irmsd, lrmsd),
        }
    }

    #[test]
    fn criteria_by_their_limits() {
        let met = |quality| Criterion::ALL.map(|criterion| criterion.is_met(&quality));
        assert_eq!(met(quality(0.1, 4.0, 99.0)), [true, false]);
        assert_eq!(met(quality(0.1, 2.5, 99.0)), [true, true]);
        assert_eq!(met(quality(0.1, 4.01, 10.01)), [false, false]);
        // A pose without the native's contacts is not acceptable, however near it lies.
        assert_eq!(met(quality(0.09, 2.5, 5.0)), [false, true]);
    }
}
