//! `tradeoff.csv` and `tradeoff.json`: what a sweep of settings measured, a row or object a setting.

use std::collections::BTreeMap;
use std::io;

use serde::Serialize;
use serde_json::{Map, Number, Value};

use crate::tables::field;
use crate::tradeoff::advice::Advice;
use crate::tradeoff::{Measured, Refused, Tradeoff};
use knotdock::options::DockOptions;
use knotdock::options::definition::name_of;
use knotdock::output::files::whole_file::to_json;
use knotdock::output::records::manifest::{Inputs, Machine};
use knotdock::output::records::program::Program;

/// Number of the layout of `tradeoff.json`; it rises when an entry changes its meaning or goes.
pub const SCHEMA: u32 = 2;

/// Stages whose times are columns, in the order in which they run.
const STAGES: [&str; 11] = [
    "sample", "plan", "prepare", "search", "fine", "refine", "check", "rescore", "sharp",
    "cluster", "score",
];

/// A measured setting under the names of its columns, in order.
pub fn columns(run: &Measured) -> Vec<(String, Value)> {
    let options = &run.setting.options;
    let optional = |value: Option<f64>| value.map_or(Value::Null, real);
    let rank = |value: Option<Option<usize>>| value.flatten().map_or(Value::Null, Value::from);
    let native = run.native;
    let [nx, ny, nz] = run.grid;
    let finer = options.search.fine_rotations;
    let mut columns: Vec<(String, Value)> = [
        ("setting", Value::from(run.setting.name.as_str())),
        ("parameter", run.setting.parameter.name().into()),
        ("options", run.setting.arguments.as_str().into()),
        ("resolution", real(options.kernel.resolution)),
        ("spacing", real(run.spacing)),
        ("tolerance", real(options.kernel.tolerance)),
        ("precision", name_of(options.search.precision).into()),
        ("rotations", options.search.rotations.into()),
        ("fine_rotations", finer.map_or(Value::Null, Value::from)),
        (
            "fine_share",
            optional(finer.map(|_| options.search.fine_share)),
        ),
        ("per_rotation", options.search.per_rotation.into()),
        ("refined", run.refined.into()),
        (
            "sample_grid",
            options
                .sampling
                .sample_grid
                .map_or(Value::Null, |grid| grid.per_axis.into()),
        ),
        ("grid_x", nx.into()),
        ("grid_y", ny.into()),
        ("grid_z", nz.into()),
        ("modes", run.modes.into()),
        ("rank", run.rank.into()),
        ("spreading_width", run.spreading_width.into()),
        ("wall_seconds", real(run.wall_seconds())),
        ("cpu_seconds", optional(run.cpu_seconds())),
        ("error_rms", real(run.error.rms)),
        ("error_worst", real(run.error.worst)),
        ("low_pass_share", real(run.error.low_pass_share)),
        ("definition_rms", real(run.definition_rms)),
        (
            "definition_correlation",
            optional(run.definition_correlation),
        ),
        ("agreement", real(run.agreement)),
        (
            "first_acceptable",
            rank(native.map(|native| native.first_acceptable)),
        ),
        (
            "first_near_native",
            rank(native.map(|native| native.first_near_native)),
        ),
        (
            "acceptable_in_100",
            rank(native.map(|native| Some(native.acceptable))),
        ),
        (
            "near_native_in_100",
            rank(native.map(|native| Some(native.near_native))),
        ),
        ("front_error", run.front_error.into()),
        ("front_agreement", run.front_agreement.into()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .to_vec();
    columns.extend(stage_times(run));
    columns
}

/// A number; null where it is not finite.
fn real(value: f64) -> Value {
    Number::from_f64(value).map_or(Value::Null, Value::Number)
}

/// Columns with the times of the stages.
fn stage_times(run: &Measured) -> impl Iterator<Item = (String, Value)> {
    let optional = |value: Option<f64>| value.map_or(Value::Null, real);
    STAGES.into_iter().flat_map(move |name| {
        let stage = run.timing.iter().find(|stage| stage.name == name);
        let wall = stage.map(|stage| stage.wall_seconds);
        let cpu = stage.and_then(|stage| stage.cpu_seconds);
        [
            (format!("{name}_wall_seconds"), optional(wall)),
            (format!("{name}_cpu_seconds"), optional(cpu)),
        ]
    })
}

/// Writes the table to a stream.
///
/// # Errors
/// Those of the stream.
pub fn write_table(tradeoff: &Tradeoff, stream: &mut dyn io::Write) -> io::Result<()> {
    // Its cells are this program's own words: `--rotations 96` is to be typed as it stands.
    let mut writer = csv::Writer::from_writer(stream);
    for (index, run) in tradeoff.measured.iter().enumerate() {
        let columns = columns(run);
        if index == 0 {
            writer.write_record(columns.iter().map(|(name, _)| name))?;
        }
        writer.write_record(columns.iter().map(|(_, value)| field(value)))?;
    }
    writer.flush()
}

/// `tradeoff.json`.
#[derive(Debug, Serialize)]
pub struct TradeoffRecord<'a> {
    schema: u32,
    #[serde(flatten)]
    program: Program,
    inputs: &'a Inputs,
    options: Value,
    agreement_radius: f64,
    settings: Vec<Map<String, Value>>,
    refused: &'a [Refused],
    advice: Option<&'a Advice>,
    files: BTreeMap<String, String>,
    #[serde(rename = "match")]
    matching: Option<Value>,
    machine: Machine,
}

/// Parts of a [`TradeoffRecord`].
pub struct TradeoffParts<'a> {
    /// The input files.
    pub inputs: &'a Inputs,
    /// The default's options.
    pub options: &'a DockOptions,
    /// What was measured.
    pub tradeoff: &'a Tradeoff,
    /// What to take.
    pub advice: Option<&'a Advice>,
    /// Report on the native's matching, or why it does not match, if there is one.
    pub matching: Option<Value>,
    /// SHA-256 of each other file, by its name.
    pub files: BTreeMap<String, String>,
    /// Where it ran.
    pub machine: Machine,
}

impl<'a> TradeoffRecord<'a> {
    /// The record of a finished sweep.
    ///
    /// # Errors
    /// When a part cannot be put into JSON, which would be a fault of this program.
    pub fn new(parts: TradeoffParts<'a>) -> serde_json::Result<Self> {
        let mut options = serde_json::to_value(parts.options)?;
        // A sweep writes no run.
        if let Some(options) = options.as_object_mut() {
            options.remove("output");
        }
        Ok(Self {
            schema: SCHEMA,
            program: Program::this(),
            inputs: parts.inputs,
            options,
            agreement_radius: parts.tradeoff.radius,
            settings: parts
                .tradeoff
                .measured
                .iter()
                .map(|run| columns(run).into_iter().collect())
                .collect(),
            refused: &parts.tradeoff.refused,
            advice: parts.advice,
            files: parts.files,
            matching: parts.matching,
            machine: parts.machine,
        })
    }

    /// Writes the record to a stream.
    ///
    /// # Errors
    /// Those of the stream.
    pub fn write_to(&self, stream: &mut dyn io::Write) -> io::Result<()> {
        to_json(stream, self)
    }
}
