//! The quality of a pose: its DockQ score, its CAPRI class, and the one meaning of "acceptable" and of "near-native".

use serde::Serialize;

/// Quality of a pose against the native. All numbers are finite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PoseQuality {
    /// Interface RMSD, in Å.
    pub irmsd: f64,
    /// RMSD of the smaller side with the larger superposed, in Å.
    pub lrmsd: f64,
    /// Share of native contacts kept, 0 to 1.
    pub fnat: f64,
    /// DockQ, 0 to 1.
    pub dockq: f64,
    /// CAPRI class.
    pub capri: Capri,
}

/// DockQ, from 0 to 1, by the share of native contacts and the interface and ligand RMSD in Å.
///
/// It is (fnat + 1 / (1 + (irmsd / 1.5)^2) + 1 / (1 + (lrmsd / 8.5)^2)) / 3.
///
/// Source: Basu & Wallner, PLoS ONE 11 (2016) e0161879; Mirabello & Wallner, Bioinformatics 40 (2024) btae586.
pub fn dockq(fnat: f64, irmsd: f64, lrmsd: f64) -> f64 {
    let scaled = |rmsd: f64, scale: f64| 1.0 / (1.0 + (rmsd / scale).powi(2));
    (fnat + scaled(irmsd, 1.5) + scaled(lrmsd, 8.5)) / 3.0
}

/// The class of a prediction by the CAPRI rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Capri {
    /// None of the other classes.
    Incorrect,
    /// fnat >= 0.1 and (lrmsd <= 10 Å or irmsd <= 4 Å).
    Acceptable,
    /// fnat >= 0.3 and (lrmsd <= 5 Å or irmsd <= 2 Å).
    Medium,
    /// fnat >= 0.5 and (lrmsd <= 1 Å or irmsd <= 1 Å).
    High,
}

impl Capri {
    /// The best class whose conditions hold (Lensink, Méndez & Wodak, Proteins 69 (2007) 704-718, table 1).
    pub fn of(fnat: f64, irmsd: f64, lrmsd: f64) -> Self {
        let within = |share: f64, ligand: f64, interface: f64| {
            fnat >= share && (lrmsd <= ligand || irmsd <= interface)
        };
        if within(0.5, 1.0, 1.0) {
            Self::High
        } else if within(0.3, 5.0, 2.0) {
            Self::Medium
        } else if within(0.1, 10.0, 4.0) {
            Self::Acceptable
        } else {
            Self::Incorrect
        }
    }

    /// The class's name as written in tables: `incorrect`, `acceptable`, `medium` or `high`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Incorrect => "incorrect",
            Self::Acceptable => "acceptable",
            Self::Medium => "medium",
            Self::High => "high",
        }
    }
}

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

    #[test]
    fn dockq_by_hand() {
        assert_eq!(dockq(1.0, 0.0, 0.0), 1.0);
        // Each RMSD at its scale halves its term: (0.5 + 0.5 + 0.5) / 3.
        assert!((dockq(0.5, 1.5, 8.5) - 0.5).abs() < 1e-15);
        // (0.2 + 1/(1+4) + 1/(1+9)) / 3 = 0.5 / 3.
        assert!((dockq(0.2, 3.0, 25.5) - 0.5 / 3.0).abs() < 1e-15);
        assert!(dockq(0.0, f64::MAX, f64::MAX).abs() < 1e-300);
    }

    #[test]
    fn capri_classes_by_the_table() {
        for (fnat, irmsd, lrmsd, class) in [
            (0.5, 1.0, 99.0, Capri::High),
            (0.5, 9.0, 1.0, Capri::High),
            (0.49, 0.5, 0.5, Capri::Medium),
            (0.9, 1.01, 1.01, Capri::Medium),
            (0.3, 2.0, 99.0, Capri::Medium),
            (0.29, 0.5, 0.5, Capri::Acceptable),
            (0.9, 2.01, 5.01, Capri::Acceptable),
            (0.1, 4.0, 99.0, Capri::Acceptable),
            (0.1, 99.0, 10.0, Capri::Acceptable),
            (0.09, 0.0, 0.0, Capri::Incorrect),
            (1.0, 4.01, 10.01, Capri::Incorrect),
        ] {
            assert_eq!(
                Capri::of(fnat, irmsd, lrmsd),
                class,
                "{fnat} {irmsd} {lrmsd}"
            );
        }
    }

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
