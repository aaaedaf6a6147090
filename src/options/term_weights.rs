//! Weights of the pose terms: one option for each term of the registry.

use std::fmt;
use std::sync::LazyLock;

use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use knotdock_scoring::terms::pose::POSE_TERMS;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::values::number;

/// Largest weight of a term.
const MAX_WEIGHT: f64 = 1e6;

/// Names of the options' fields, and their defaults as text, in the order of the registry.
static FIELDS: LazyLock<Vec<(String, String)>> = LazyLock::new(|| {
    let field = |option: &str| option.replace('-', "_");
    POSE_TERMS
        .iter()
        .map(|term| (field(term.weight_option), term.default_weight.to_string()))
        .collect()
});

/// Names of the options' fields.
static NAMES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| FIELDS.iter().map(|(name, _)| name.as_str()).collect());

/// Weights of the pose terms, in the order of the registry.
///
/// The command line, records and files name each by its option, as `fine_contact_weight`.
#[derive(Clone, Debug, PartialEq)]
pub struct TermWeights([f64; POSE_TERMS.len()]);

impl Default for TermWeights {
    fn default() -> Self {
        Self(std::array::from_fn(|index| {
            POSE_TERMS[index].default_weight
        }))
    }
}

impl TermWeights {
    /// All weights, in the order of the registry.
    pub fn all(&self) -> &[f64; POSE_TERMS.len()] {
        &self.0
    }

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

    /// The same weights with another for the term with an id.
    ///
    /// # Panics
    /// If no term has this id.
    #[must_use]
    pub fn with(mut self, id: &str, weight: f64) -> Self {
        self.set(id, weight);
        self
    }
}

/// Place of the term with an id in the registry.
fn index(id: &str) -> usize {
    let index = POSE_TERMS.iter().position(|term| term.id == id);
    index.unwrap_or_else(|| unreachable!("no pose term '{id}'"))
}

impl Args for TermWeights {
    fn augment_args(command: Command) -> Command {
        let options = POSE_TERMS.iter().zip(FIELDS.iter());
        command.args(options.map(|(term, (name, default))| {
            Arg::new(name.as_str())
                .long(term.weight_option)
                .value_name("X")
                .value_parser(number(0.0..=MAX_WEIGHT))
                .default_value(default.as_str())
                .help(format!(
                    "{}: {}; 0 leaves the term out",
                    term.weight_help, term.unit
                ))
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
        to.write_str("the weights of the pose terms")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<TermWeights, A::Error> {
        let mut found = [None; POSE_TERMS.len()];
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
        let expected: Vec<&str> = POSE_TERMS.iter().map(|term| term.weight_option).collect();
        assert_eq!(options, expected);

        let record = serde_json::to_value(DockOptions::default()).unwrap();
        for (term, name) in POSE_TERMS.iter().zip(NAMES.iter()) {
            assert_eq!(record["terms"][name], term.default_weight, "{name}");
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
        let typed = ["--relaxed-weight=0.25", "--active-weight=7"];
        let matches = command.clone().try_get_matches_from(typed).unwrap();
        let weights = TermWeights::from_arg_matches(&matches).unwrap();
        let expected = TermWeights::default()
            .with("relaxed", 0.25)
            .with("active_residues", 7.0);
        assert_eq!(weights, expected);
        assert_eq!(weights.get("relaxed"), 0.25);
        for wrong in ["--relaxed-weight=-1", "--relaxed-weight=1e7"] {
            assert!(command.clone().try_get_matches_from([wrong]).is_err());
        }
    }
}
