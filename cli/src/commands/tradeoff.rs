//! `knotdock tradeoff`: what accuracy costs in time for a pair, setting by setting.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use crate::arguments::machine::settled;
use crate::arguments::options::{GivenOptions, OfTradeoff, OptionArguments};
use crate::inputs::bodies::Bodies;
use crate::inputs::native::NativeArguments;
use crate::inputs::request::{KnownComplex, Request};
use crate::messages::console::Console;
use crate::records::joined;
use crate::records::tradeoff::{SCHEMA, settings, write_table};
use crate::report::DirectoryKind;
use crate::tables::report::text_table;
use crate::tradeoff::advice::advice;
use crate::tradeoff::plot::plot;
use crate::tradeoff::{Measured, Parameter, Tradeoff, sweep};
use knotdock::options::EngineChoice;
use knotdock::options::definition::Scope;
use knotdock::output::files::own_files::TRADEOFF;
use knotdock::output::files::seal::REPORT;
use knotdock::output::files::staging::Staging;
use knotdock::output::files::whole_file::to_json;
use knotdock::output::records::program::Program;
use knotdock::output::run_folder::machine;
use knotdock::threads;
use knotdock_structures::Error;

/// Measure what accuracy costs in time: docks a pair with each parameter moved by itself around the options given,
/// and with combinations.
///
/// Writes tradeoff.csv, tradeoff.json, tradeoff.svg and report.html into a directory, and says which setting to take.
#[derive(Args, Debug)]
pub struct TradeoffCommand {
    /// The fixed molecule or mesh, as for `knotdock dock`.
    #[arg(value_name = "RECEPTOR")]
    receptor: String,
    /// The molecule or mesh that is moved.
    #[arg(value_name = "LIGAND")]
    ligand: String,
    /// Directory to write to [default: tradeoff_RECEPTOR_LIGAND].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace the sweep in the directory, once the new one is done.
    #[arg(long)]
    force: bool,
    #[arg(long, value_name = "NAMES", value_delimiter = ',', help = parameters_help())]
    parameters: Option<Vec<Parameter>>,
    #[command(flatten)]
    options: OptionArguments<OfTradeoff>,
    #[command(flatten)]
    native: NativeArguments,
}

fn parameters_help() -> String {
    let names: Vec<&str> = Parameter::all().into_iter().map(Parameter::name).collect();
    let names = names.join(", ");
    format!(
        "Parameters to move, with commas between them, of {names} (several at once) [default: all]"
    )
}

impl TradeoffCommand {
    pub fn run(self, console: Console) -> Result<(), Error> {
        let mut given = self.options.given()?;
        given.options.machine = settled(&given.options.machine);
        if given.options.search.symmetry.is_some() {
            return Err(Error::input("`knotdock tradeoff` does not dock rings")
                .help("remove `symmetry` from the file of options"));
        }
        threads::on(given.options.machine.thread_count(), || {
            self.sweep(given, console)
        })?
    }

    fn sweep(self, given: GivenOptions, console: Console) -> Result<(), Error> {
        let native = self.native.read()?;
        let bodies = Bodies::read(&self.receptor, &self.ligand, &given.options)?;
        let mut request = Request::of(bodies, native, given);
        request.given.fixes_gap = true;
        check(&request, self.parameters.as_deref().unwrap_or_default())?;
        let parameters = self.parameters.unwrap_or_else(Parameter::all);
        let directory = self.output.unwrap_or_else(|| {
            let [receptor, ligand] = request.bodies.labels();
            PathBuf::from(format!("tradeoff_{receptor}_{ligand}"))
        });
        request.bodies.describe(request.arrangement(), console);
        let known = request.known(console)?;
        let first = request.plan(console)?;
        console.say(format!("\nThe default: {}\n", first.plan));
        let machine = machine(&first.plan);
        let inputs = request.inputs(first.sampling.as_deref())?;
        let opened = Staging::open(TRADEOFF, &directory, self.force)?;
        console.warn_leftovers(&opened.leftovers);
        let staging = opened.stage();
        let tradeoff = sweep(
            request.bodies.pair(),
            first,
            &request.options,
            &parameters,
            known.as_ref().and_then(KnownComplex::evaluator),
            console,
        )?;

        let advice = advice(&tradeoff);
        let svg = plot(&tradeoff)?;
        staging.write("tradeoff.svg", |file| file.write_all(svg.as_bytes()))?;
        staging.write("tradeoff.csv", |file| write_table(&tradeoff, file))?;
        let mut options = json!(request.options);
        // A sweep writes no run.
        if let Some(options) = options.as_object_mut() {
            options.remove("output");
        }
        let record = joined([
            json!({ "schema": SCHEMA }),
            json!(Program::this()),
            json!({
                "inputs": inputs,
                "options": options,
                "agreement_radius": tradeoff.radius,
                "settings": settings(&tradeoff),
                "refused": tradeoff.refused,
                "advice": advice,
                "files": staging.checksums()?,
                "match": known.as_ref().map(KnownComplex::entry).transpose()?,
                "machine": machine,
            }),
        ]);
        staging.write("tradeoff.json", |file| to_json(file, &record))?;
        let name = directory.display().to_string();
        let text = DirectoryKind::Tradeoff.report(&directory, staging.folder(), &name)?;
        staging.write(REPORT, |file| file.write_all(text.as_bytes()))?;
        opened.commit()?;

        console.say(format!("\n{}", table(&tradeoff)));
        if let Some(advice) = &advice {
            console.say(format!("\n{}", advice.text));
        }
        let names = ["tradeoff.csv", "tradeoff.svg"];
        let [csv, svg] = names.map(|name| directory.join(name).display().to_string());
        console.say(format!("\nThe table is in {csv}, the picture in {svg}"));
        console.result(&json!({
            "directory": directory.display().to_string(),
            "table": csv,
            "picture": svg,
            "tradeoff": record,
        }))?;
        Ok(())
    }
}

/// Refuses a search on a graphics processor, and parameters without effect on the inputs.
fn check(request: &Request, parameters: &[Parameter]) -> Result<(), Error> {
    if request.options.search.engine != EngineChoice::Cpu {
        let error = "settings are weighed by processor time, of which a search on a graphics processor takes next to none";
        return Err(Error::input(error).help("give --engine cpu"));
    }
    let other = if request.bodies.are_meshes() {
        Scope::Molecules
    } else {
        Scope::Meshes
    };
    if let Some(idle) = parameters.iter().find(|one| one.scope() == other) {
        let name = idle.name();
        let error = format!("the option {name} has no effect on such inputs");
        return Err(Error::input(error).help("name other parameters"));
    }
    Ok(())
}

/// Settings by time, with their main figures.
fn table(tradeoff: &Tradeoff) -> String {
    let header = "setting|wall s|CPU s|rank|error rms|worst|score apart|agreement|front";
    let of_native = match tradeoff.with_native {
        true => "|acceptable|near-native",
        false => "",
    };
    let mut order: Vec<&Measured> = tradeoff.measured.iter().collect();
    order.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
    let rank = |rank: Option<usize>| rank.map_or_else(|| "-".to_owned(), |rank| rank.to_string());
    let lines = order.into_iter().map(|run| {
        let front = match (run.front_error, run.front_agreement) {
            (true, true) => "both",
            (true, false) => "error",
            (false, true) => "agreement",
            (false, false) => "",
        };
        let mut line = vec![
            run.setting.name.clone(),
            format!("{:.2}", run.wall_seconds()),
            run.cpu_seconds()
                .map_or_else(|| "-".to_owned(), |seconds| format!("{seconds:.2}")),
            run.rank.to_string(),
            format!("{:.1e}", run.error.rms),
            format!("{:.1e}", run.error.worst),
            format!("{:.1e}", run.definition_rms),
            format!("{:.2}", run.agreement),
            front.to_owned(),
        ];
        if let Some(native) = run.native {
            line.extend([
                rank(native.first_acceptable),
                rank(native.first_near_native),
            ]);
        }
        line
    });
    text_table(&format!("{header}{of_native}"), lines)
}
