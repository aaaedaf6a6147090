//! `knotdock evaluate`: how near the poses of a table, or the complexes of files, are to a known complex.

mod complexes;

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use crate::arguments::machine::Threads;
use crate::arguments::options::{OfReading, OptionArguments};
use crate::arguments::output_file::check_outputs;
use crate::ensemble::finished::{RunRows, runs};
use crate::inputs::molecules::Input;
use crate::inputs::native::{NativeArguments, NativeFiles, announce, measure};
use crate::messages::console::Console;
use crate::records::is_ensemble;
use crate::records::recorded_run::RecordedRun;
use crate::tables::report;
use knotdock::evaluate::{Capri, ChainChoice, Evaluator, PoseQuality};
use knotdock::options::{InputOptions, definitions};
use knotdock::output::files::added::write_named;
use knotdock::output::files::staging::put_back;
use knotdock::output::tables::fields::Column;
use knotdock::output::tables::poses::{PoseRow, PoseTable};
use knotdock::output::tables::quality;
use knotdock::threads;
use knotdock_structures::Error;

/// Measure the poses of a run, or complexes of any program, against a known complex.
///
/// Gives interface and ligand RMSD (Å), the fraction of native contacts, DockQ and the CAPRI class of each. Without
/// --native the known complex of the run is taken.
#[derive(Args, Debug)]
pub struct Evaluate {
    /// The directory of a run, a table of poses, or complex files and optionally the chains of both sides.
    ///
    /// A table has the columns rank, qw, qx, qy, qz, tx, ty and tz. Complex files are .pdb, .ent or .cif, each also
    /// .gz; every model of a file is measured. Chains come last, such as H,L A.
    #[arg(value_name = "INPUT", required = true)]
    words: Vec<String>,
    /// The receptor that was docked; FILE:H,L picks chains [default: that of the run, read as the run read it].
    #[arg(long, value_name = "FILE")]
    receptor: Option<String>,
    /// The ligand that was docked [default: that of the run].
    #[arg(long, value_name = "FILE")]
    ligand: Option<String>,
    #[command(flatten)]
    input: OptionArguments<OfReading>,
    #[command(flatten)]
    native: NativeArguments,
    /// Chains with those of the known complex that they are measured against, as DOCKED:NATIVE, such as A:E,B:F.
    ///
    /// By default every assignment that the sequences allow is tried, and the one with the best DockQ is taken.
    #[arg(long, value_name = "CHAINS", value_delimiter = ',', value_parser = chain_pair, help_heading = "Known complex")]
    map: Vec<(String, String)>,
    /// Write the table with the columns irmsd, lrmsd, fnat, dockq and capri to this file.
    #[arg(short, long, value_name = "FILE", help_heading = OUTPUT)]
    output: Option<PathBuf>,
    /// Replace the file of `--output` if it exists, even if it is the input table.
    #[arg(long, requires = "output", help_heading = OUTPUT)]
    force: bool,
    #[command(flatten)]
    threads: Threads,
}

const OUTPUT: &str = "Output";

impl Evaluate {
    /// Evaluates; the exit code: 2 where some complexes could not be.
    pub fn run(self, console: Console) -> Result<u8, Error> {
        threads::on(self.threads.count(), || {
            if self.words.iter().any(|word| is_complex(word)) {
                return self.complexes(console);
            }
            match self.words.as_slice() {
                [poses] => self.evaluate(Path::new(poses), console).map(|()| 0),
                _ => Err(
                    Error::input("several runs are given, and one is evaluated at a time").help(
                        "name one directory or table; of complexes, files that end in .pdb or .cif",
                    ),
                ),
            }
        })?
    }

    /// The chains that the user chooses, by --map or, if `named`, by the names of those to measure.
    fn chain_choice(&self, named: bool) -> ChainChoice {
        ChainChoice {
            map: self.map.clone(),
            named: named || !self.map.is_empty(),
        }
    }

    /// Evaluates the poses of a run or a table.
    fn evaluate(&self, poses: &Path, console: Console) -> Result<(), Error> {
        let table_path = match poses.is_dir() {
            true => poses.join("poses.csv"),
            false => poses.to_owned(),
        };
        let run_path = table_path.with_file_name("run.json");
        if let Some(directory) = run_path.parent() {
            put_back(directory)?;
        }
        let mut table = PoseTable::read(&table_path)?;
        let places: Vec<usize> = (0..table.rows().len()).collect();
        let directory = run_path.parent().unwrap_or(Path::new(""));
        if is_ensemble(directory) && (self.receptor.is_some() || self.ligand.is_some()) {
            return Err(Error::input(
                "--receptor and --ligand name one conformation, and the poses of an ensemble have several",
            )
            .at(directory)
            .help("leave them out, or name the run of a member: a folder in members/"));
        }
        let mut qualities: Vec<Option<(PoseQuality, String)>> = vec![None; places.len()];
        let mut matches = Vec::new();
        for RunRows { run, rows } in runs(directory, &table, &places)? {
            let evaluator = self.evaluator(&run, console)?;
            announce(&evaluator, console);
            let poses: Vec<PoseRow> = rows.iter().map(|&row| table.rows()[row]).collect();
            for (row, (quality, report)) in rows.into_iter().zip(measure(&evaluator, &poses)) {
                qualities[row] = Some((quality, report.native_chains.clone()));
            }
            matches.push(serde_json::to_value(evaluator.report()).map_err(Error::machine)?);
        }
        // Each row is of one run.
        let (qualities, native_chains): (Vec<PoseQuality>, Vec<String>) =
            qualities.into_iter().flatten().unzip();
        assert_eq!(qualities.len(), places.len(), "rows that belong to no run");
        if let Some(path) = &self.output {
            let measured: Vec<_> = qualities.iter().copied().map(Some).collect();
            let native_chains = Column {
                name: "native_chains".to_owned(),
                fields: native_chains.clone(),
            };
            for column in quality::columns(&measured)
                .into_iter()
                .chain([native_chains])
            {
                table.set_column(&column);
            }
            console.warn_leftovers(&write_named(path, |file| table.write_to(file))?);
            console.say(format!("\n{}", summary(table.rows(), &qualities)));
            console.say(format!(
                "{} in {}",
                report::counted(qualities.len(), "row"),
                path.display()
            ));
        } else if !console.json {
            let shown = qualities.len().min(report::BEST);
            console.say(format!("\n{}", listing(&table.rows()[..shown], &qualities)));
            console.say(format!("\n{}", summary(table.rows(), &qualities)));
            if shown < qualities.len() {
                console.say(format!(
                    "The first {shown} of {} are shown; -o FILE writes all",
                    report::counted(qualities.len(), "row")
                ));
            }
        }
        let measured = qualities.iter().zip(&native_chains);
        let poses = table
            .rows()
            .iter()
            .zip(measured)
            .map(|(row, (quality, chains))| {
                let mut object = Map::from_iter([("rank".to_owned(), json!(row.rank))]);
                object.extend(quality::object(quality));
                object.insert("native_chains".to_owned(), json!(chains));
                Value::Object(object)
            });
        let matched = match matches.len() {
            1 => matches.remove(0),
            _ => matches.into(),
        };
        console.result(&json!({ "poses": poses.collect::<Vec<_>>(), "match": matched }))?;
        Ok(())
    }

    /// The known complex matched with the molecules of a run.
    fn evaluator(&self, run_path: &Path, console: Console) -> Result<Evaluator, Error> {
        let (receptor, ligand, native) = self.inputs(run_path)?;
        let structures = [&receptor, &ligand].into_iter().chain(native.inputs());
        let read = structures.map(|input| input.record.path.as_path());
        let read: Vec<&Path> = read.chain([run_path]).collect();
        check_outputs(&self.output, &read, self.force, console)?;
        let choice = self.chain_choice(false);
        native.evaluator([&receptor.molecule, &ligand.molecule], &choice)
    }

    /// The molecules docked and the known complex: those named, or else those of the run.
    fn inputs(&self, run_path: &Path) -> Result<(Input, Input, NativeFiles), Error> {
        let input = self.input.given()?.options.input;
        if self.receptor.is_none() && self.ligand.is_none() && input != InputOptions::default() {
            let options = definitions().iter().filter(|one| one.subject() == "input");
            let names: Vec<String> = options.map(|one| format!("--{}", one.long())).collect();
            let names = names.join(", ");
            return Err(Error::input(format!(
                "{names} need --receptor and --ligand: the molecules of a run are read as the run read them"
            ))
            .help("leave them out, or name the molecules"));
        }
        let reading = input.reading();
        let native = match (&self.receptor, &self.ligand, self.native.read()?) {
            (Some(receptor), Some(ligand), Some(native)) => {
                let [receptor, ligand] = Input::read_all([receptor, ligand], &reading)?;
                return Ok((receptor, ligand, native));
            }
            (_, _, native) => native,
        };
        let needed = "name the molecules that were docked with --receptor and --ligand, and the known complex with \
                      --native or with --native-receptor and --native-ligand";
        let run = RecordedRun::read(run_path).map_err(|error| error.help(needed))?;
        let native = match (native, &run.inputs.native) {
            (Some(native), _) => native,
            (None, Some(record)) => NativeFiles::recorded(record, run_path)?,
            (None, None) => return Err(no_native()),
        };
        // Whether B values were taken for pLDDT depends on both molecules.
        let records = run.inputs.pair();
        let recorded = || Input::recorded(records, run_path, &run.options.input.reading());
        let named = |file: &String| Input::read_all([file], &reading);
        Ok(match (&self.receptor, &self.ligand) {
            (Some(file), _) => {
                let ([receptor], [_, ligand]) = (named(file)?, recorded()?);
                (receptor, ligand, native)
            }
            (None, Some(file)) => {
                let ([receptor, _], [ligand]) = (recorded()?, named(file)?);
                (receptor, ligand, native)
            }
            (None, None) => {
                let [receptor, ligand] = recorded()?;
                (receptor, ligand, native)
            }
        })
    }
}

fn no_native() -> Error {
    Error::input("no known complex is given")
        .help("name it with --native FILE, or with --native-receptor FILE and --native-ligand FILE")
}

fn listing(rows: &[PoseRow], qualities: &[PoseQuality]) -> String {
    let lines = rows.iter().zip(qualities).map(|(row, quality)| {
        let rank = std::iter::once(row.rank.to_string());
        rank.chain(quality_fields(quality)).collect()
    });
    report::text_table("rank|irmsd|lrmsd|fnat|dockq|capri", lines)
}

/// Interface and ligand RMSD, fraction of native contacts, DockQ and CAPRI class.
fn quality_fields(quality: &PoseQuality) -> [String; 5] {
    [
        format!("{:.2}", quality.irmsd),
        format!("{:.2}", quality.lrmsd),
        format!("{:.3}", quality.fnat),
        format!("{:.3}", quality.dockq),
        quality.capri.name().to_owned(),
    ]
}

/// A docked chain with a native one, as `A:E`; `_` is the chain without a name.
fn chain_pair(text: &str) -> Result<(String, String), String> {
    let named = |name: &str| if name == "_" { "" } else { name }.to_owned();
    match text.split(':').collect::<Vec<_>>().as_slice() {
        [docked, native] if !docked.is_empty() && !native.is_empty() => {
            Ok((named(docked), named(native)))
        }
        _ => Err("a docked chain and a native one are needed, such as A:E".to_owned()),
    }
}

fn is_complex(word: &str) -> bool {
    let name = word.to_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    [".pdb", ".ent", ".cif"]
        .iter()
        .any(|ending| name.ends_with(ending))
}

/// How many of the first poses are acceptable, and the first rank of each CAPRI class or better.
fn summary(rows: &[PoseRow], qualities: &[PoseQuality]) -> String {
    let is_good = |quality: &&PoseQuality| quality.capri >= Capri::Acceptable;
    let good = |most: usize| qualities.iter().take(most).filter(is_good).count();
    let all = qualities.len();
    let parts: Vec<String> = [1, 10, 100]
        .into_iter()
        .filter(|&most| most < all)
        .map(|most| format!("{} of the first {most}", good(most)))
        .chain([format!("{} of all {all}", good(all))])
        .collect();
    let firsts = [Capri::Acceptable, Capri::Medium, Capri::High].map(|class| {
        let mut rows = rows.iter().zip(qualities);
        match rows.find(|(_, quality)| quality.capri >= class) {
            Some((row, _)) => format!("{} at rank {}", class.name(), row.rank),
            None => format!("{} nowhere", class.name()),
        }
    });
    format!(
        "Acceptable or better: {}\nFirst pose of each CAPRI class or better: {}",
        parts.join(", "),
        firsts.join(", ")
    )
}
