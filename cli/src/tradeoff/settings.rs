//! The settings of a sweep: each parameter on its own around a default, and combinations.

use serde::Serialize;

use knotdock::options::definition::{Definition, Scope, name_of};
use knotdock::options::{DockOptions, MAX_PER_AXIS, Precision, SampleGrid, option_named};
use knotdock_structures::Error;

/// Change of the default that a setting makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    Default,
    /// What agreement is measured by: the default with the most rotations of the sweep.
    Reference,
    /// The default at a few rotations more or fewer, which differs from it by noise alone.
    Repeat,
    Option(&'static str),
    /// Several at once.
    Combination,
}

struct Swept {
    option: &'static str,
    /// Its values around a default, each with further changes.
    values: fn(&DockOptions, Planned) -> Vec<Vec<Change>>,
}

/// The options that a sweep moves, in its order.
const SWEPT: [Swept; 9] = [
    // From it follow the rank of the lifted axis, the spreading width, the kernel's window and the spacing.
    Swept {
        option: "tolerance",
        values: |_, _| each("tolerance", [0.1, 3e-2, 1e-2, 1e-3]),
    },
    Swept {
        option: "precision",
        values: |_, _| {
            let precisions = [Precision::Single, Precision::Double];
            each("precision", precisions.map(name_of))
        },
    },
    // And so the modes kept.
    Swept {
        option: "spacing",
        values: |_, planned| {
            let spacings = [1.15, 0.85, 0.7].map(|factor| spacing(planned, factor));
            each("spacing", spacings)
        },
    },
    // And with it the spacing: another score rather than a better or worse one.
    Swept {
        option: "resolution",
        values: |default, _| {
            let factors = [7.0 / 9.0, 11.0 / 9.0, 4.0 / 3.0];
            factors.map(|factor| resolution(default, factor)).into()
        },
    },
    Swept {
        option: "rotations",
        values: |default, _| {
            let factors = [1.0 / 6.0, 1.0 / 3.0, 2.0];
            each(
                "rotations",
                factors.map(|factor| rotations(default, factor)),
            )
        },
    },
    Swept {
        option: "fine_rotations",
        values: |default, _| {
            let factors = [4.0, 16.0];
            each(
                "fine_rotations",
                factors.map(|factor| rotations(default, factor)),
            )
        },
    },
    Swept {
        option: "per_rotation",
        values: |_, _| each("per_rotation", [1, 10]),
    },
    Swept {
        option: "refine",
        values: |_, planned| {
            let poses = [0, 300].into_iter();
            each("refine", poses.filter(|&poses| poses != planned.refined))
        },
    },
    // Molecules are balls as they come.
    Swept {
        option: "sample_grid",
        values: |default, _| {
            let finer = |grid: SampleGrid, factor: f64| {
                let nodes = (grid.per_axis as f64 * factor).round() as usize;
                let per_axis = nodes.min(MAX_PER_AXIS);
                SampleGrid { per_axis }
            };
            default.sampling.sample_grid.map_or_else(Vec::new, |grid| {
                each("sample_grid", [0.75, 1.5].map(|factor| finer(grid, factor)))
            })
        },
    },
];

fn each(option: &'static str, values: impl IntoIterator<Item = impl ToString>) -> Vec<Vec<Change>> {
    let values = values.into_iter();
    values
        .map(|value| vec![Change::new(option, value)])
        .collect()
}

/// `factor` times the default's rotations.
fn rotations(default: &DockOptions, factor: f64) -> usize {
    rounded_to_fours(factor * default.search.rotations as f64)
}

/// `factor` times the planned spacing.
fn spacing(planned: Planned, factor: f64) -> f64 {
    three_digits(factor * planned.spacing)
}

/// `factor` times the default's resolution; a spacing that was given goes along.
fn resolution(default: &DockOptions, factor: f64) -> Vec<Change> {
    let kernel = &default.kernel;
    let resolution = three_digits(factor * kernel.resolution);
    let mut changes = vec![Change::new("resolution", resolution)];
    if let Some(spacing) = kernel.spacing {
        changes.push(Change::new("spacing", three_digits(factor * spacing)));
    }
    changes
}

/// Several changes at once, each with the setting's name.
fn combinations(default: &DockOptions, planned: Planned) -> [(&'static str, Vec<Change>); 3] {
    let tolerance = |value: f64| Change::new("tolerance", value);
    let rotations = |factor| Change::new("rotations", rotations(default, factor));
    let mut coarsest = resolution(default, 4.0 / 3.0);
    let once = Change::new("per_rotation", 1);
    coarsest.extend([rotations(1.0 / 6.0), tolerance(0.1), once]);
    let coarse = vec![rotations(1.0 / 3.0), tolerance(3e-2)];
    let spacing = Change::new("spacing", spacing(planned, 0.85));
    let fine = vec![rotations(2.0), tolerance(1e-3), spacing];
    [("coarsest", coarsest), ("coarse", coarse), ("fine", fine)]
}

impl Parameter {
    pub fn all() -> Vec<Self> {
        let options = SWEPT.iter().map(|swept| Self::Option(swept.option));
        options.chain([Self::Combination]).collect()
    }

    /// Whether settings of it are for taking: the reference and repeats only measure others.
    pub fn is_choice(self) -> bool {
        !matches!(self, Self::Reference | Self::Repeat)
    }

    /// Name as on the command line and in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Reference => "reference",
            Self::Repeat => "repeat",
            Self::Option(name) => option_named(name).map_or(name, Definition::long),
            Self::Combination => "combination",
        }
    }

    pub fn scope(self) -> Scope {
        match self {
            Self::Option(name) => option_named(name).map_or(Scope::Both, Definition::scope),
            _ => Scope::Both,
        }
    }
}

impl std::str::FromStr for Parameter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::all().into_iter().find(|known| known.name() == text);
        known.ok_or_else(|| {
            let names: Vec<&str> = Self::all().into_iter().map(Self::name).collect();
            let names = names.join(", ");
            format!("there is no parameter '{text}'; there are {names}")
        })
    }
}

/// One setting of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    pub name: String,
    /// What it changes.
    pub parameter: Parameter,
    /// Options of `knotdock dock` that it changes, as typed; empty for the default.
    pub arguments: String,
    pub options: DockOptions,
}

/// A setting that could not be run.
#[derive(Clone, Debug, Serialize)]
pub struct Refused {
    pub setting: String,
    pub reason: String,
}

impl Refused {
    /// A setting that ended in an error.
    pub(crate) fn new(setting: &str, error: impl std::fmt::Display) -> Self {
        Self {
            setting: setting.to_owned(),
            reason: error.to_string(),
        }
    }
}

/// What changes are typed as, without dashes.
fn typed(changes: &[Change]) -> String {
    let typed: Vec<String> = changes.iter().map(Change::argument).collect();
    typed.join(" ").replace("--", "")
}

impl Setting {
    /// Whether a sweep means nothing without it.
    pub(crate) fn is_needed(&self) -> bool {
        matches!(self.parameter, Parameter::Default | Parameter::Reference)
    }

    /// Its name, and its options where the name is not all of them.
    pub(crate) fn description(&self) -> String {
        match self.parameter {
            Parameter::Default => self.name.clone(),
            Parameter::Reference | Parameter::Repeat | Parameter::Combination => {
                format!("{}: {}", self.name, self.arguments)
            }
            Parameter::Option(_) => self.arguments.clone(),
        }
    }

    /// The default with some changes.
    fn new(
        parameter: Parameter,
        name: &str,
        changes: &[Change],
        default: &DockOptions,
    ) -> Result<Self, Error> {
        let mut options = default.clone();
        for change in changes {
            options = change.apply(&options)?;
        }
        let arguments = changes
            .iter()
            .map(|change| change.argument() + &change.companions(default, &options));
        Ok(Self {
            name: name.to_owned(),
            parameter,
            arguments: arguments.collect::<Vec<_>>().join(" "),
            options,
        })
    }
}

/// Rotations of the reference, as a multiple of the default's.
const REFERENCE_ROTATIONS: usize = 4;

/// What a default comes to where its options leave it open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planned {
    pub spacing: f64,
    pub refined: usize,
}

/// The settings of a sweep of `parameters` around `default`, which comes first, and the reference second; and
/// settings out of range. Of the two repeats one is the third and one the last, so that they show a drift of the
/// machine's speed, too.
pub fn settings(
    default: &DockOptions,
    planned: Planned,
    parameters: &[Parameter],
) -> Result<(Vec<Setting>, Vec<Refused>), Error> {
    let count = default.search.rotations;
    let with = |parameter, name, rotations| {
        let change = Change::new("rotations", rotations);
        Setting::new(parameter, name, &[change], default)
    };
    let fewer = count.checked_sub(4).filter(|&fewer| fewer > 0);
    let last = with(Parameter::Repeat, "repeat 2", fewer.unwrap_or(count + 8))?;
    let mut settings = vec![
        Setting::new(Parameter::Default, "default", &[], default)?,
        with(
            Parameter::Reference,
            "reference",
            REFERENCE_ROTATIONS * count,
        )?,
        with(Parameter::Repeat, "repeat 1", count + 4)?,
    ];
    let mut refused = Vec::new();
    let mut add = |parameter, name: &str, changes: &[Change]| {
        if !parameters.contains(&parameter) {
            return;
        }
        match Setting::new(parameter, name, changes, default) {
            Ok(new) if settings.iter().any(|known| known.options == new.options) => {}
            Ok(new) => settings.push(new),
            Err(error) => refused.push(Refused::new(name, error)),
        }
    };
    for swept in &SWEPT {
        for changes in (swept.values)(default, planned) {
            add(Parameter::Option(swept.option), &typed(&changes), &changes);
        }
    }
    for (name, changes) in combinations(default, planned) {
        add(Parameter::Combination, name, &changes);
    }
    if settings.iter().all(|known| known.options != last.options) {
        settings.push(last);
    }
    Ok((settings, refused))
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Change {
    option: &'static str,
    /// Its value as it is typed.
    value: String,
}

impl Change {
    fn new(option: &'static str, value: impl ToString) -> Self {
        Self {
            option,
            value: value.to_string(),
        }
    }

    fn apply(&self, options: &DockOptions) -> Result<DockOptions, Error> {
        let mut changed = options.with(self.option, &self.value)?;
        match self.option {
            // A pass length that was given goes along with the resolution, as the default one does.
            "resolution" => {
                let scale = changed.kernel.resolution / options.kernel.resolution;
                let length = &mut changed.kernel.pass_length;
                *length = length.map(|length| length * scale);
            }
            // A finer set is no coarser.
            "rotations" => {
                let rotations = changed.search.rotations;
                let finer = &mut changed.search.fine_rotations;
                *finer = finer.map(|finer| finer.max(rotations));
            }
            _ => {}
        }
        Ok(changed)
    }

    /// Further arguments that a run with `default` options needs: given lengths, and a finer set of rotations. Meshes
    /// have one by default, but not beside given rotations.
    fn companions(&self, default: &DockOptions, changed: &DockOptions) -> String {
        let (pass_length, finer) = (changed.kernel.pass_length, changed.search.fine_rotations);
        let are_meshes = changed.sampling.sample_grid.is_some();
        let share = changed.search.fine_share;
        match (self.option, pass_length, finer) {
            ("resolution", Some(length), _) => format!(" --pass-length {length}"),
            ("rotations", _, Some(finer)) if are_meshes => {
                format!(" --fine-rotations {finer} --fine-share {share}")
            }
            ("fine_rotations", ..) if are_meshes => format!(" --fine-share {share}"),
            ("rotations", _, Some(finer)) if default.search.fine_rotations != Some(finer) => {
                format!(" --fine-rotations {finer}")
            }
            ("sample_grid", ..) => format!(" --offset {}", changed.kernel.offset),
            _ => String::new(),
        }
    }

    fn argument(&self) -> String {
        let long = option_named(self.option).map_or(self.option, Definition::long);
        format!("--{long} {}", self.value)
    }
}

/// The nearest multiple of four, for rotations share their work in fours; at least four.
fn rounded_to_fours(count: f64) -> usize {
    4 * ((count / 4.0).round() as usize).max(1)
}

/// A length above zero to three significant digits, so that it can be typed.
fn three_digits(length: f64) -> f64 {
    let digits = 2 - length.log10().floor() as i32;
    // Through text, which gives the double nearest to the decimal.
    if digits >= 0 {
        let text = format!("{length:.0$}", digits as usize);
        text.parse().unwrap_or(length)
    } else {
        let unit = 10f64.powi(-digits);
        (length / unit).round() * unit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swept(default: &DockOptions) -> Vec<Setting> {
        let planned = Planned {
            spacing: 2.25,
            refined: 0,
        };
        settings(default, planned, &Parameter::all()).unwrap().0
    }

    #[test]
    fn every_setting_is_another_and_says_how_to_have_it() {
        let settings = swept(&DockOptions::default());
        assert_eq!(settings[0].name, "default");
        assert_eq!(settings[1].name, "reference");
        let repeats = settings.iter().enumerate();
        let repeats = repeats.filter(|(_, setting)| setting.parameter == Parameter::Repeat);
        let rotations: Vec<_> = repeats
            .map(|(index, setting)| (index, setting.options.search.rotations))
            .collect();
        assert_eq!(rotations, [(2, 3604), (settings.len() - 1, 3596)]);
        for (index, setting) in settings.iter().enumerate() {
            assert_eq!(setting.arguments.is_empty(), index == 0);
            let same = |other: &Setting| other.options == setting.options;
            assert!(!settings[..index].iter().any(same), "{}", setting.name);
        }
        let named = |name: &str| settings.iter().find(|setting| setting.name == name);
        assert_eq!(
            named("resolution 3.5").unwrap().options.kernel.spacing,
            None
        );
        assert_eq!(
            named("rotations 600").unwrap().options.search.rotations,
            600
        );
        assert!(named("tolerance 0.01").is_none(), "that is the default");
        assert!(
            settings
                .iter()
                .all(|s| s.parameter != Parameter::Option("sample_grid"))
        );
    }

    /// Each name of a parameter is one of an option's.
    #[test]
    fn what_is_swept_is_an_option() {
        for parameter in Parameter::all() {
            if let Parameter::Option(name) = parameter {
                assert!(option_named(name).is_some(), "{name}");
            }
            assert_eq!(parameter.name().parse(), Ok(parameter));
        }
        assert!("skill".parse::<Parameter>().is_err());
    }

    /// A value that no option can have is left out, and a reference that there cannot be is an error.
    #[test]
    fn settings_out_of_range_are_refused() {
        let planned = Planned {
            spacing: 2.25,
            refined: 0,
        };
        let of = |rotations| {
            let default =
                DockOptions::default().changed(|options| options.search.rotations = rotations);
            settings(&default, planned, &Parameter::all())
        };
        let (_, refused) = of(2_000_000).unwrap();
        assert_eq!(refused[0].setting, "fine-rotations 32000000");
        assert!(of(9_000_000).is_err());
    }

    /// What is typed for a setting is all that it changes.
    #[test]
    fn arguments_name_what_else_changes() {
        let settings = swept(&DockOptions::default().changed(|options| {
            options.kernel.pass_length = Some(9.0);
            options.search.fine_rotations = Some(7200);
        }));
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
            let settings = swept(&DockOptions::default().with("precision", default).unwrap());
            let moved = settings
                .iter()
                .filter(|s| s.parameter == Parameter::Option("precision"));
            let moved: Vec<&str> = moved.map(|s| s.arguments.as_str()).collect();
            assert_eq!(moved, [format!("--precision {other}")]);
        }
    }

    #[test]
    fn given_lengths_go_along_with_the_resolution_and_meshes_have_a_grid() {
        let settings = swept(&DockOptions::default().changed(|options| {
            options.kernel.spacing = Some(2.0);
            options.kernel.pass_length = Some(9.0);
            options.sampling.sample_grid = Some(SampleGrid { per_axis: 64 });
            options.kernel.resolution = 4.5;
            options.search.fine_rotations = Some(30_000);
            options.search.fine_share = 0.2;
        }));
        let finer = settings
            .iter()
            .find(|s| s.parameter == Parameter::Option("resolution"))
            .unwrap();
        assert_eq!(
            finer.arguments,
            "--resolution 3.5 --pass-length 7 --spacing 1.56"
        );
        assert_eq!(finer.options.kernel.pass_length, Some(7.0));
        let fewer = settings.iter().find(|s| s.name == "rotations 600");
        assert_eq!(
            fewer.unwrap().arguments,
            "--rotations 600 --fine-rotations 30000 --fine-share 0.2"
        );
        let grids = settings
            .iter()
            .filter(|s| s.parameter == Parameter::Option("sample_grid"));
        let grids: Vec<_> = grids.map(|s| s.options.sampling.sample_grid).collect();
        assert_eq!(
            grids,
            [48, 96].map(|per_axis| Some(SampleGrid { per_axis }))
        );
    }

    #[test]
    fn lengths_have_three_digits_in_any_unit() {
        for (length, rounded) in [
            (3.500_000_1, 3.5),
            (0.004_567_8, 0.004_57),
            (98_765.0, 98_800.0),
        ] {
            assert_eq!(three_digits(length), rounded);
        }
        assert_eq!(rounded_to_fours(1.0), 4);
        assert_eq!(rounded_to_fours(601.0), 600);
    }
}
