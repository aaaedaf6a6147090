//! The options of a run, to `run.json` and back.

use serde_json::{Map, Value};

use crate::options::DockOptions;
use knotdock_structures::molecule::ReadOptions;

/// Options that change how a run is carried out and never what comes of it; they are recorded under `machine`.
const MACHINE_OPTIONS: [&str; 2] = ["threads", "memory"];

/// What a run was asked to do: how to read, the search's options and those of the output.
#[derive(Clone, Debug, PartialEq)]
pub struct RunOptions {
    /// How the molecules are read.
    pub reading: ReadOptions,
    /// Options of the search.
    pub dock: DockOptions,
    /// Number of complexes written to `top/`.
    pub write_top: usize,
}

impl RunOptions {
    /// The options with those of the machine at their defaults, as a record gives them back.
    pub(super) fn less_machine(&self) -> Self {
        let default = DockOptions::default();
        Self {
            dock: DockOptions {
                threads: default.threads,
                memory: default.memory,
                ..self.dock.clone()
            },
            ..self.clone()
        }
    }

    /// The options as recorded, less those of the machine.
    pub(super) fn record(&self) -> serde_json::Result<Map<String, Value>> {
        let mut options = object(serde_json::to_value(&self.dock)?);
        for name in MACHINE_OPTIONS {
            options.remove(name);
        }
        options.extend(object(serde_json::to_value(&self.reading)?));
        options.insert("write_top".to_owned(), self.write_top.into());
        Ok(options)
    }

    /// Options from a record. Those of the machine take their defaults; what an older record does not name is as it was before there was a choice.
    pub(super) fn from_record(record: &Map<String, Value>) -> Result<Self, String> {
        let mut dock = object(
            serde_json::to_value(DockOptions::of_first_version())
                .map_err(|error| error.to_string())?,
        );
        let mut reading = object(
            serde_json::to_value(ReadOptions::default()).map_err(|error| error.to_string())?,
        );
        let mut write_top = 0;
        for (name, value) in record {
            match name.as_str() {
                "write_top" => {
                    write_top = value
                        .as_u64()
                        .and_then(|count| usize::try_from(count).ok())
                        .ok_or_else(|| format!("option `{name}` cannot be {value}"))?;
                }
                known if dock.contains_key(known) && !MACHINE_OPTIONS.contains(&known) => {
                    dock.insert(name.clone(), value.clone());
                }
                known if reading.contains_key(known) => {
                    reading.insert(name.clone(), value.clone());
                }
                _ => return Err(format!("option `{name}` is not known to this version")),
            }
        }
        Ok(Self {
            reading: serde_json::from_value(Value::Object(reading))
                .map_err(|error| error.to_string())?,
            dock: serde_json::from_value(Value::Object(dock)).map_err(|error| error.to_string())?,
            write_top,
        })
    }
}

fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(object) => object,
        _ => Map::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::priors::restraints::AntibodySurface;
    use knotdock_structures::molecule::{AlternateLocation, Hetatm, ModelChoice};

    #[test]
    fn options_survive_the_record_and_those_of_the_machine_do_not() {
        let options = RunOptions {
            reading: ReadOptions {
                hetatm: Hetatm::Drop,
                altloc: AlternateLocation::Named('B'),
                model: ModelChoice::Number(3),
                ..ReadOptions::default()
            },
            dock: DockOptions {
                rotations: 17,
                lambda: 0.1 + 0.2,
                spacing: Some(1.0 / 3.0),
                every_pose: true,
                threads: 7,
                memory: Some(99),
                ..DockOptions::default()
            },
            write_top: 3,
        };
        let text = serde_json::to_string(&options.record().unwrap()).unwrap();
        let record: Map<String, Value> = serde_json::from_str(&text).unwrap();
        let expected = RunOptions {
            dock: DockOptions {
                threads: DockOptions::default().threads,
                memory: DockOptions::default().memory,
                ..options.dock.clone()
            },
            ..options
        };
        assert_eq!(RunOptions::from_record(&record), Ok(expected));
        for name in MACHINE_OPTIONS {
            assert!(!record.contains_key(name));
        }
    }

    /// The record of a run with all options at their defaults.
    fn default_record() -> Map<String, Value> {
        let options = RunOptions {
            reading: ReadOptions::default(),
            dock: DockOptions::default(),
            write_top: 10,
        };
        options.record().unwrap()
    }

    /// A run from before poses were rescored and relaxed, antibodies told, residues blocked and engines chosen is repeated without all that, on the CPU.
    #[test]
    fn what_an_older_record_does_not_name_is_as_it_was() {
        let mut record = default_record();
        for name in [
            "engine",
            "fine_contact_weight",
            "fine_contact_potential",
            "atom_pair_weight",
            "atom_pair_potential",
            "relaxed_weight",
            "restraint_weight",
            "antibody",
            "block_receptor",
            "block_ligand",
        ] {
            record.remove(name).unwrap();
        }
        let dock = RunOptions::from_record(&record).unwrap().dock;
        let expected = DockOptions {
            fine_contact_weight: 0.0,
            atom_pair_weight: 0.0,
            relaxed_weight: 0.0,
            antibody: AntibodySurface::Whole,
            ..DockOptions::default()
        };
        assert_eq!(dock, expected);
    }

    #[test]
    fn an_option_of_a_later_version_is_refused_not_ignored() {
        let mut record = default_record();
        record.insert("charges".to_owned(), true.into());
        assert!(
            RunOptions::from_record(&record)
                .unwrap_err()
                .contains("charges")
        );
    }
}
