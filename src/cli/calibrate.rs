//! `knotdock calibrate`: how fast this machine is, for `knotdock dock --budget` and `--accuracy`.

use std::path::PathBuf;

use crate::options::Threads;
use crate::output::records::cost_model_file::{default_path, is_ours, read, write};
use crate::output::tables::report::align;
use crate::threads::on;
use crate::tradeoff::calibrate::calibrate;
use crate::tradeoff::cost_model::CostModel;
use clap::Args;
use serde_json::json;

use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;

/// Measure how fast this machine docks, in some seconds, for `knotdock dock --budget`: run it while nothing else does.
///
/// The cost model is kept in knotdock/cost_model.json in the user's cache folder ($XDG_CACHE_HOME, or else ~/.cache).
#[derive(Args, Debug)]
pub struct Calibrate {
    /// File to write instead.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    threads: Threads,
}

impl Calibrate {
    /// Calibrates.
    pub fn run(self, console: Console) -> Result<(), Failure> {
        let named = self.output.is_some();
        let path = self.output.or_else(default_path).ok_or_else(|| {
            Failure::input("there is no cache folder: neither XDG_CACHE_HOME nor HOME names one")
                .remedy("name a file with -o")
        })?;
        if named && path.is_file() && !is_ours(&path) {
            return Err(Failure::input("this file exists and is not a cost model")
                .at(&path)
                .remedy("choose another name"));
        }
        let threads = self.threads.count();
        let progress = console.progress();
        let model = on(threads, || calibrate(threads, &progress))?
            .map_err(|error| Failure::other(&error).remedy(error.remedy()))?;
        drop(progress);
        if !model.is_sound() {
            return Err(Failure::other("no cost model fits the measured times")
                .remedy("try again while the machine has nothing else to do"));
        }
        write(&path, &model, threads)?;
        let built_in = CostModel::BUILT_IN;
        let mut lines = vec![
            ["seconds", "this machine", "built-in"]
                .map(str::to_owned)
                .to_vec(),
        ];
        for (name, here, there) in [
            ("rotation, each N log2 N", model.inverse, built_in.inverse),
            ("and each of its fields", model.field, built_in.field),
            (
                "preparing, each mode and effect",
                model.prepare,
                built_in.prepare,
            ),
            ("exact sum, each pair", model.pair, built_in.pair),
            (
                "rescoring, each pose and knot",
                model.rescore,
                built_in.rescore,
            ),
            (
                "refining, each pose and knot",
                model.refine,
                built_in.refine,
            ),
            (
                "rotation set, each rotation",
                model.rotation,
                built_in.rotation,
            ),
            ("its covering radius", model.covering, built_in.covering),
        ] {
            lines.push(vec![
                name.to_owned(),
                format!("{here:.2e}"),
                format!("{there:.2e}"),
            ]);
        }
        console.say(align(&lines));
        console.say(format!("\nThe cost model is in {}", path.display()));
        console.result(&json!({
            "file": path.display().to_string(),
            "threads": threads,
            "cost_model": serde_json::to_value(model).map_err(Failure::other)?,
        }))?;
        Ok(())
    }
}

/// The cost model in force, and where it is from: the file of `knotdock calibrate`, or the built-in one.
pub fn cost_model(console: Console) -> (CostModel, String) {
    let built_in = || (CostModel::BUILT_IN, "built-in".to_owned());
    let Some(path) = default_path() else {
        return built_in();
    };
    match read(&path) {
        Ok(Some(model)) => (model, path.display().to_string()),
        Ok(None) => built_in(),
        Err(error) => {
            console.warn(format!(
                "{error}; the built-in cost model is used until `knotdock calibrate` writes another"
            ));
            built_in()
        }
    }
}
