//! `tradeoff.csv` and `tradeoff.json`: the measurements of a sweep, one row or object per setting.

use std::io;

use serde_json::{Map, Value, json};

use crate::tables::{Column, field, object};
use crate::tradeoff::{Measured, Tradeoff};
use knotdock::options::definition::name_of;

/// Number of the layout of `tradeoff.json`; it rises when an entry changes its meaning or goes.
pub const SCHEMA: u32 = 2;

/// Stages whose times are columns, in the order in which they run.
const STAGES: [&str; 11] = [
    "sample", "plan", "prepare", "search", "fine", "refine", "check", "rescore", "sharp",
    "cluster", "score",
];

/// Columns of a measured setting that are not times of stages, in order.
const COLUMNS: [Column<Measured>; 33] = [
    ("setting", |run| json!(run.setting.name)),
    ("parameter", |run| json!(run.setting.parameter.name())),
    ("options", |run| json!(run.setting.arguments)),
    ("resolution", |run| {
        json!(run.setting.options.kernel.resolution)
    }),
    ("spacing", |run| json!(run.spacing)),
    ("tolerance", |run| {
        json!(run.setting.options.kernel.tolerance)
    }),
    ("precision", |run| {
        json!(name_of(run.setting.options.search.precision))
    }),
    ("rotations", |run| {
        json!(run.setting.options.search.rotations)
    }),
    ("fine_rotations", |run| {
        json!(run.setting.options.search.fine_rotations)
    }),
    ("fine_share", |run| {
        let search = &run.setting.options.search;
        json!(search.fine_rotations.map(|_| search.fine_share))
    }),
    ("per_rotation", |run| {
        json!(run.setting.options.search.per_rotation)
    }),
    ("refined", |run| json!(run.refined)),
    ("sample_grid", |run| {
        let grid = run.setting.options.sampling.sample_grid;
        json!(grid.map(|grid| grid.per_axis))
    }),
    ("grid_x", |run| json!(run.grid[0])),
    ("grid_y", |run| json!(run.grid[1])),
    ("grid_z", |run| json!(run.grid[2])),
    ("modes", |run| json!(run.modes)),
    ("rank", |run| json!(run.rank)),
    ("spreading_width", |run| json!(run.spreading_width)),
    ("wall_seconds", |run| json!(run.wall_seconds())),
    ("cpu_seconds", |run| json!(run.cpu_seconds())),
    ("error_rms", |run| json!(run.error.rms)),
    ("error_worst", |run| json!(run.error.worst)),
    ("low_pass_share", |run| json!(run.error.low_pass_share)),
    ("definition_rms", |run| json!(run.definition_rms)),
    ("definition_correlation", |run| {
        json!(run.definition_correlation)
    }),
    ("agreement", |run| json!(run.agreement)),
    ("first_acceptable", |run| {
        json!(run.native.and_then(|native| native.first_acceptable))
    }),
    ("first_near_native", |run| {
        json!(run.native.and_then(|native| native.first_near_native))
    }),
    ("acceptable_in_100", |run| {
        json!(run.native.map(|native| native.acceptable))
    }),
    ("near_native_in_100", |run| {
        json!(run.native.map(|native| native.near_native))
    }),
    ("front_error", |run| json!(run.front_error)),
    ("front_agreement", |run| json!(run.front_agreement)),
];

/// A measured setting under the names of its columns, in order.
fn columns(run: &Measured) -> Map<String, Value> {
    let mut columns = object(&COLUMNS, run);
    for name in STAGES {
        let stage = run.timing.iter().find(|stage| stage.name == name);
        let wall = stage.map(|stage| stage.wall_seconds);
        let cpu = stage.and_then(|stage| stage.cpu_seconds);
        columns.insert(format!("{name}_wall_seconds"), json!(wall));
        columns.insert(format!("{name}_cpu_seconds"), json!(cpu));
    }
    columns
}

pub fn write_table(tradeoff: &Tradeoff, stream: &mut dyn io::Write) -> io::Result<()> {
    // No cell holds text from other sources, so none is quoted: `--rotations 96` can be copied.
    let mut writer = csv::Writer::from_writer(stream);
    for (index, run) in tradeoff.measured.iter().enumerate() {
        let columns = columns(run);
        if index == 0 {
            writer.write_record(columns.keys())?;
        }
        writer.write_record(columns.values().map(field))?;
    }
    writer.flush()
}

/// The measured settings as JSON objects.
pub fn settings(tradeoff: &Tradeoff) -> Value {
    tradeoff
        .measured
        .iter()
        .map(columns)
        .map(Value::Object)
        .collect()
}
