//! The settings of a sweep: each knob on its own around a default, and combinations.

use serde::Serialize;

use crate::mesh::MAX_PER_AXIS;
use crate::options::DockOptions;
use crate::options::Precision;
use crate::tradeoff::change::{Change, rounded_to_fours, three_digits};

/// What a setting changes of the default.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Knob {
    /// Nothing.
    Default,
    /// What agreement is measured by: the default with the most rotations of the sweep.
    Reference,
    /// Error allowed to the fast path, from which the rank of the lifted axis, the spreading width, the kernel's window and the spacing follow.
    Tolerance,
    /// Precision of the fast path.
    Precision,
    /// Spacing of the translation grid, and so the modes kept.
    Spacing,
    /// Resolution of the score, and with it the spacing: another score rather than a better or worse one.
    Resolution,
    /// Rotations.
    Rotations,
    /// A finer search about the best rotations.
    CoarseToFine,
    /// Peaks kept of each rotation.
    PerRotation,
    /// Poses refined off the grid.
    Refine,
    /// Nodes of the grid that meshes are sampled on.
    SampleGrid,
    /// Several at once.
    Combination,
}

impl Knob {
    /// The knobs that a sweep can be limited to.
    pub const SWEPT: [Self; 10] = [
        Self::Tolerance,
        Self::Precision,
        Self::Spacing,
        Self::Resolution,
        Self::Rotations,
        Self::CoarseToFine,
        Self::PerRotation,
        Self::Refine,
        Self::SampleGrid,
        Self::Combination,
    ];

    /// Name as on the command line and in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Reference => "reference",
            Self::Tolerance => "tolerance",
            Self::Precision => "precision",
            Self::Spacing => "spacing",
            Self::Resolution => "resolution",
            Self::Rotations => "rotations",
            Self::CoarseToFine => "coarse-to-fine",
            Self::PerRotation => "per-rotation",
            Self::Refine => "refine",
            Self::SampleGrid => "sample-grid",
            Self::Combination => "combination",
        }
    }
}

impl std::str::FromStr for Knob {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::SWEPT.into_iter().find(|knob| knob.name() == text);
        known.ok_or_else(|| {
            let names = Self::SWEPT.map(Self::name).join(", ");
            format!("there is no knob '{text}'; there are {names}")
        })
    }
}

/// One setting of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// What it is called.
    pub name: String,
    /// What it changes.
    pub knob: Knob,
    /// The options of `knotdock dock` that it changes, as they are typed in place of the default's; empty for the default.
    pub arguments: String,
    /// All options.
    pub options: DockOptions,
}

/// Rotations of the reference, as a multiple of the default's.
const REFERENCE_ROTATIONS: usize = 4;

/// What a default comes to where its options leave it open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planned {
    /// Grid spacing.
    pub spacing: f64,
    /// Poses refined.
    pub refined: usize,
}

/// The settings of a sweep of `knobs` around `default`, which comes first, and the reference second.
pub fn settings(default: &DockOptions, planned: Planned, knobs: &[Knob]) -> Vec<Setting> {
    let mut settings: Vec<Setting> = Vec::new();
    let mut add = |knob: Knob, name: Option<&str>, changes: &[Change]| {
        let mut options = default.clone();
        for change in changes {
            change.apply(&mut options);
        }
        let typed: Vec<String> = changes.iter().map(Change::argument).collect();
        let companions = |change: &Change| change.companions(default, &options);
        let arguments = changes
            .iter()
            .zip(&typed)
            .map(|(change, own)| own.clone() + &companions(change));
        let setting = Setting {
            name: name.map_or_else(|| typed.join(" ").replace("--", ""), str::to_owned),
            knob,
            arguments: arguments.collect::<Vec<_>>().join(" "),
            options,
        };
        let known = settings
            .iter()
            .any(|other| other.options == setting.options);
        if !known {
            settings.push(setting);
        }
    };
    let rotations =
        |factor: f64| Change::Rotations(rounded_to_fours(factor * default.rotations as f64));
    let resolution = |factor: f64| {
        let mut changes = vec![Change::Resolution(three_digits(
            factor * default.resolution,
        ))];
        if let Some(spacing) = default.spacing {
            changes.push(Change::Spacing(three_digits(factor * spacing)));
        }
        changes
    };
    let spacing = |factor: f64| Change::Spacing(three_digits(factor * planned.spacing));
    add(Knob::Default, Some("default"), &[]);
    let most = Change::Rotations(REFERENCE_ROTATIONS * default.rotations);
    add(Knob::Reference, Some("reference"), &[most]);
    for knob in Knob::SWEPT.into_iter().filter(|knob| knobs.contains(knob)) {
        match knob {
            Knob::Tolerance => {
                for tolerance in [0.1, 3e-2, 1e-2, 1e-3] {
                    add(knob, None, &[Change::Tolerance(tolerance)]);
                }
            }
            Knob::Precision => {
                for precision in Precision::ALL {
                    add(knob, None, &[Change::Precision(precision)]);
                }
            }
            Knob::Spacing => {
                for factor in [1.15, 0.85, 0.7] {
                    add(knob, None, &[spacing(factor)]);
                }
            }
            Knob::Resolution => {
                for factor in [7.0 / 9.0, 11.0 / 9.0, 4.0 / 3.0] {
                    add(knob, None, &resolution(factor));
                }
            }
            Knob::Rotations => {
                for factor in [1.0 / 6.0, 1.0 / 3.0, 2.0] {
                    add(knob, None, &[rotations(factor)]);
                }
            }
            Knob::CoarseToFine => {
                for factor in [4.0, 16.0] {
                    let finer = rounded_to_fours(factor * default.rotations as f64);
                    add(knob, None, &[Change::FineRotations(finer)]);
                }
            }
            Knob::PerRotation => {
                for peaks in [1, 10] {
                    add(knob, None, &[Change::PerRotation(peaks)]);
                }
            }
            Knob::Refine => {
                for poses in [0, 300]
                    .into_iter()
                    .filter(|&poses| poses != planned.refined)
                {
                    add(knob, None, &[Change::Refine(poses)]);
                }
            }
            Knob::SampleGrid => {
                // Molecules are balls as they come.
                for factor in default.sample_grid.map_or(&[][..], |_| &[0.75, 1.5]) {
                    let nodes = default.sample_grid.unwrap_or(1) as f64 * factor;
                    let nodes = (nodes.round() as usize).min(MAX_PER_AXIS);
                    add(knob, None, &[Change::SampleGrid(nodes)]);
                }
            }
            Knob::Combination => {
                let mut coarsest = resolution(4.0 / 3.0);
                coarsest.extend([
                    rotations(1.0 / 6.0),
                    Change::Tolerance(0.1),
                    Change::PerRotation(1),
                ]);
                add(knob, Some("coarsest"), &coarsest);
                let coarse = [rotations(1.0 / 3.0), Change::Tolerance(3e-2)];
                add(knob, Some("coarse"), &coarse);
                let fine = [rotations(2.0), Change::Tolerance(1e-3), spacing(0.85)];
                add(knob, Some("fine"), &fine);
            }
            Knob::Default | Knob::Reference => {}
        }
    }
    settings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swept(default: &DockOptions) -> Vec<Setting> {
        let planned = Planned {
            spacing: 2.25,
            refined: 0,
        };
        settings(default, planned, &Knob::SWEPT)
    }

    #[test]
    fn every_setting_is_another_and_says_how_to_have_it() {
        let settings = swept(&DockOptions::default());
        assert_eq!(settings[0].name, "default");
        assert_eq!(settings[1].name, "reference");
        for (index, setting) in settings.iter().enumerate() {
            assert_eq!(setting.arguments.is_empty(), index == 0);
            let same = |other: &Setting| other.options == setting.options;
            assert!(!settings[..index].iter().any(same), "{}", setting.name);
        }
        let named = |name: &str| settings.iter().find(|setting| setting.name == name);
        assert_eq!(named("resolution 3.5").unwrap().options.spacing, None);
        assert_eq!(named("rotations 600").unwrap().options.rotations, 600);
        assert!(named("tolerance 0.01").is_none(), "that is the default");
        assert!(settings.iter().all(|s| s.knob != Knob::SampleGrid));
    }

    /// What is typed for a setting is all that it changes.
    #[test]
    fn arguments_name_what_else_changes() {
        let settings = swept(&DockOptions {
            pass_length: Some(9.0),
            fine_rotations: Some(7200),
            ..DockOptions::default()
        });
        let typed = |name: &str| {
            let mut all = settings.iter();
            all.find(|s| s.name == name).unwrap().arguments.clone()
        };
        assert_eq!(typed("resolution 3.5"), "--resolution 3.5 --pass-length 7");
        assert_eq!(
            typed("reference"),
            "--rotations 14400 --fine-rotations 14400"
        );
        assert_eq!(typed("rotations 7200"), "--rotations 7200");
    }

    /// Precision moves to the one that the default does not have.
    #[test]
    fn precision_moves_either_way() {
        for (default, other) in [("single", "double"), ("double", "single")] {
            let settings = swept(&DockOptions {
                precision: default.parse().unwrap(),
                ..DockOptions::default()
            });
            let moved = settings.iter().filter(|s| s.knob == Knob::Precision);
            let moved: Vec<&str> = moved.map(|s| s.arguments.as_str()).collect();
            assert_eq!(moved, [format!("--precision {other}")]);
        }
    }

    #[test]
    fn given_lengths_go_along_with_the_resolution_and_meshes_have_a_grid() {
        let settings = swept(&DockOptions {
            spacing: Some(2.0),
            pass_length: Some(9.0),
            sample_grid: Some(64),
            resolution: 4.5,
            ..DockOptions::default()
        });
        let finer = settings
            .iter()
            .find(|s| s.knob == Knob::Resolution)
            .unwrap();
        assert_eq!(
            finer.arguments,
            "--resolution 3.5 --pass-length 7 --spacing 1.56"
        );
        assert_eq!(finer.options.pass_length, Some(7.0));
        let grids = settings.iter().filter(|s| s.knob == Knob::SampleGrid);
        let grids: Vec<_> = grids.map(|s| s.options.sample_grid).collect();
        assert_eq!(grids, [Some(48), Some(96)]);
    }
}
