//! Weights of the terms: one option for each that the registries hold.

use std::fmt;
use std::sync::LazyLock;

use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use knotdock_scoring::terms::Weight;
use knotdock_scoring::terms::pose::TermDefinition;
use knotdock_scoring::terms::weights;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::values::number;

/// Largest weight of a term.
const MAX_WEIGHT: f64 = 1e6;

/// An option of a weight.
struct WeightOption {
    /// Id of the term.
    id: &'static str,
    weight: &'static Weight,
    /// Name of the option's field.
    name: String,
    /// The default as text.
    default: String,
}

/// The options of all weights.
static OPTIONS: LazyLock<Vec<WeightOption>> = LazyLock::new(|| {
    let option = |(id, weight): (_, &'static Weight)| WeightOption {
        id,
        weight,
        name: weight.option.replace('-', "_"),
        default: weight.default.to_string(),
    };
    weights().map(option).collect()
});

/// Names of the options' fields.
static NAMES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| OPTIONS.iter().map(|option| option.name.as_str()).collect());

/// Weights of effects and pose terms, in the order of their registries.
///
/// The command line, records and files name each by its option, as `fine_contact_weight`.
#[derive(Clone, Debug, PartialEq)]
pub struct TermWeights(Vec<f64>);

impl Default for TermWeights {
    fn default() -> Self {
        Self(weights().map(|(_, weight)| weight.default).collect())
    }
}

impl TermWeights {
    /// Weight of the term with an id.
    ///
    /// # Panics
    /// If no term has this id.
    pub fn get(&self, id: &str) -> f64 {
        self.0[index(id)]
    }

    /// Sets the weight of the term with an id.
    ///
    /// # Panics
    /// If no term has this id.
    pub fn set(&mut self, id: &str, weight: f64) {
        self.0[index(id)] = weight;
    }
}

/// Place of the weight of the term with an id.
fn index(id: &str) -> usize {
    let index = OPTIONS.iter().position(|option| option.id == id);
    index.unwrap_or_else(|| unreachable!("no weight of a term '{id}'"))
}

impl Args for TermWeights {
    fn augment_args(command: Command) -> Command {
        command.args(OPTIONS.iter().map(|option| {
            let Weight { help, unit, .. } = option.weight;
            // Effects are left out by `--effects`.
            let zero = match TermDefinition::with_id(option.id) {
                Some(_) => "; 0 leaves the term out",
                None => "",
            };
            Arg::new(option.name.as_str())
                .long(option.weight.option)
                .value_name("NUMBER")
                .value_parser(number(0.0..=MAX_WEIGHT))
                .default_value(option.default.as_str())
                .help(format!("{help}: {unit}{zero}"))
        }))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for TermWeights {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut weights = Self::default();
        weights.update_from_arg_matches(matches)?;
        Ok(weights)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        for (weight, name) in self.0.iter_mut().zip(NAMES.iter()) {
            if let Some(typed) = matches.get_one::<f64>(name) {
                *weight = *typed;
            }
        }
        Ok(())
    }
}

impl Serialize for TermWeights {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(NAMES.iter().zip(&self.0))
    }
}

impl<'de> Deserialize<'de> for TermWeights {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        // As a struct, so that the options around it refuse what is no field of either.
        from.deserialize_struct("TermWeights", &NAMES, WeightsVisitor)
    }
}

/// Reads each weight by its name.
struct WeightsVisitor;

impl<'de> Visitor<'de> for WeightsVisitor {
    type Value = TermWeights;

    fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("the weights of the terms")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<TermWeights, A::Error> {
        let mut found = vec![None; NAMES.len()];
        while let Some(name) = map.next_key::<String>()? {
            let index = NAMES.iter().position(|field| *field == name);
            let index = index.ok_or_else(|| A::Error::unknown_field(&name, &NAMES))?;
            found[index] = Some(map.next_value()?);
        }
        let mut weights = TermWeights::default();
        for ((weight, found), name) in weights.0.iter_mut().zip(found).zip(NAMES.iter()) {
            *weight = found.ok_or_else(|| A::Error::missing_field(name))?;
        }
        Ok(weights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::DockOptions;

    /// Each term of the registry has one option on the command line and in records, with its default, and no other.
    #[test]
    fn options_of_weights_are_those_of_the_registry() {
        let command = TermWeights::augment_args(Command::new("dock"));
        let options: Vec<&str> = command.get_arguments().filter_map(Arg::get_long).collect();
        let expected: Vec<&str> = weights().map(|(_, weight)| weight.option).collect();
        assert_eq!(options, expected);

        let record = serde_json::to_value(DockOptions::default()).unwrap();
        for ((_, weight), name) in weights().zip(NAMES.iter()) {
            assert_eq!(record["terms"][name], weight.default, "{name}");
            let mut less = record.clone();
            less["terms"].as_object_mut().unwrap().remove(*name);
            assert!(serde_json::from_value::<DockOptions>(less).is_err());
        }
        let read: DockOptions = serde_json::from_value(record).unwrap();
        assert_eq!(read, DockOptions::default());
    }

    #[test]
    fn weights_are_typed_by_name_and_found_by_id() {
        let command = TermWeights::augment_args(Command::new("dock").no_binary_name(true));
        let typed = ["--relaxed-weight=0.25", "--contact-weight=7"];
        let matches = command.clone().try_get_matches_from(typed).unwrap();
        let weights = TermWeights::from_arg_matches(&matches).unwrap();
        let mut expected = TermWeights::default();
        expected.set("relaxed", 0.25);
        expected.set("contact", 7.0);
        assert_eq!(weights, expected);
        assert_eq!(weights.get("relaxed"), 0.25);
        for wrong in ["--relaxed-weight=-1", "--relaxed-weight=1e7"] {
            assert!(command.clone().try_get_matches_from([wrong]).is_err());
        }
    }
}
