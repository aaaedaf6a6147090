//! `knotdock models`: which predicted models of a complex to trust, by their confidence and their coordinates.

use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};
use csv::StringRecord;
use serde_json::{Map, Value, json};

use crate::arguments::machine::Threads;
use crate::arguments::output_file::check_outputs;
use crate::inputs::native::NativeFiles;
use crate::messages::console::{Console, failure_text};
use crate::report::{ModelsReport, ShownModels, Viewer, ViewerArguments};
use crate::solid_files::{place_all, write_text};
use crate::tables::report::{counted, text_table};
use crate::tables::{Column, field, object, write_table};
use knotdock::evaluate::{ChainChoice, PoseQuality};
use knotdock::models::scores::IPSAE_CUTOFF;
use knotdock::models::trust::Assessment;
use knotdock::models::{ChainPair, PredictedModel, Prediction, System, model_files, systems};
use knotdock::options::DockOptions;
use knotdock::options::values::{ABOVE_ZERO, in_range};
use knotdock::output::files::whole_file::StagedFile;
use knotdock::threads;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;

/// Rate predicted models of complexes: ipTM, ipSAE, pDockQ and LIS of each pair of chains by the confidence of
/// AlphaFold 3, Boltz, ColabFold, Chai or Protenix, beside contacts, clashes and fit of the surfaces.
///
/// Confidence files are found by their names beside each structure. Without them the coordinates are described. Each pair
/// of chains gets a word of trust with its evidence: likely, uncertain or doubtful.
#[derive(Args, Debug)]
pub struct ModelsCommand {
    /// Predicted structures (.pdb, .ent, .cif, each also .gz), or directories: of these, and those in them, every
    /// structure with confidence files.
    #[arg(value_name = "MODEL", required = true)]
    models: Vec<PathBuf>,
    /// Confidence files of the one structure given, JSON or .npz, in place of those beside it.
    #[arg(long, value_name = "FILE", num_args = 1)]
    confidence: Vec<PathBuf>,
    /// PAE in Å below which pairs of residues count for ipSAE.
    #[arg(long, value_name = "PAE", default_value_t = IPSAE_CUTOFF, value_parser = in_range::<f64>(ABOVE_ZERO))]
    pae_cutoff: f64,
    /// Known complex, against which each pair of chains is measured as by `knotdock evaluate`; FILE:A,B picks chains.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    native: Option<String>,
    /// Write a row for each pair of chains of each model to this table.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The report to write: the table, the models in three dimensions and maps of their PAE, in a page that opens in any
    /// browser.
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    #[command(flatten)]
    viewer: ViewerArguments,
    /// Replace files that are there.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    threads: Threads,
}

impl ModelsCommand {
    /// Rates the models; the exit code: 2 if some could not be read.
    pub fn run(self, console: Console) -> Result<u8, Error> {
        threads::on(self.threads.count(), || self.rate(console))?
    }

    fn rate(&self, console: Console) -> Result<u8, Error> {
        let mut files: Vec<PathBuf> = Vec::new();
        for path in &self.models {
            files.extend(model_files(path)?);
        }
        let confidence = match (self.confidence.as_slice(), files.len()) {
            ([], _) => None,
            (given, 1) => Some(given),
            (_, count) => {
                return Err(Error::input(format!(
                    "--confidence is for one structure, and {count} are given"
                ))
                .help("give one structure, or put the confidence files beside each one"));
            }
        };
        let viewer = self.viewer.read()?;
        let native = self.native.as_deref();
        let native = native.map(NativeFiles::complex).transpose()?;
        let natives = native.iter().flat_map(NativeFiles::inputs);
        let read = files.iter().chain(&self.confidence).map(PathBuf::as_path);
        let read = read.chain(natives.map(|input| input.record.path.as_path()));
        let outputs = [&self.output, &self.report].into_iter().flatten();
        check_outputs(outputs, &read.collect::<Vec<&Path>>(), self.force, console)?;
        if let Some(native) = &native {
            native.warn(console);
        }
        let ph = DockOptions::default().terms.ph;
        let mut found = Found::default();
        // One after another: the confidence of one can take much of the memory.
        for file in &files {
            let prediction = Prediction::read(file, confidence);
            let rated = prediction.and_then(|prediction| {
                let model = prediction.rated(self.pae_cutoff, ph)?;
                Ok((prediction, model))
            });
            match rated {
                Ok((prediction, model)) => {
                    if let Some(native) = &native {
                        found.measure(&prediction, native);
                    }
                    if self.report.is_some() {
                        found.shown.add(&prediction);
                    }
                    found.models.push(model);
                }
                Err(failure) if files.len() == 1 => return Err(failure),
                Err(failure) => {
                    console.error(failure_text(&failure));
                    found.code = found.code.max(failure.exit_code());
                }
            }
        }
        found.warn(console)?;
        let shown = std::mem::take(&mut found.shown);
        let systems = systems(&found.models);
        let rows = rows(&found, &systems);
        let columns = columns(native.is_some());
        let mut staged = Vec::new();
        if let Some(path) = &self.output {
            let table = StagedFile::write(path, |file| write_table(file, &columns, &rows))?;
            staged.push((table, path));
        }
        if let Some(path) = &self.report {
            let sentences = systems.iter().map(|one| sentence(one, &rows));
            let sentences = sentences.collect();
            let page = page(sentences, &columns, &rows, shown, viewer.as_ref());
            staged.push((write_text(path, &page)?, path));
        }
        place_all(staged)?;
        // After all that may fail, so that a failure is the only result.
        console.say(text(&found.models, &systems, &rows, native.is_some()));
        let entries: Vec<Value> = systems.iter().map(|one| entry(one, &rows)).collect();
        console.result(&json!({
            "models": objects(&found.models, &rows, native.is_some()),
            "systems": entries,
        }))?;
        Ok(found.code)
    }
}

/// Nearness of a pair of chains to the known complex.
struct Measured {
    quality: PoseQuality,
    /// Its chains with those of the known complex, as `A:E,B:F`.
    native_chains: String,
    /// Share of the interface residues of the known complex that it has.
    interface_share: f64,
}

/// Models that were read, with the data gathered from each before the next one is read.
#[derive(Default)]
struct Found {
    models: Vec<PredictedModel>,
    /// Of each model its pairs of chains; empty without a known complex.
    measured: Vec<Vec<Option<Measured>>>,
    /// Warnings of the match with the known complex, each once.
    notes: Vec<String>,
    /// The first pair of chains that could not be measured.
    unmatched: Option<Error>,
    shown: ShownModels,
    code: u8,
}

impl Found {
    /// Measures the pairs of chains of a model. Those that the known complex does not have stay without figures.
    fn measure(&mut self, prediction: &Prediction, native: &NativeFiles) {
        let mut pairs = Vec::new();
        for pair in prediction.pairs() {
            let molecules = pair.map(|at| &prediction.molecules[at]);
            let names = pair.map(|at| prediction.polymers.chains[at].name.as_str());
            match native.evaluator(molecules, &ChainChoice::default()) {
                Ok(evaluator) => {
                    let (quality, report) = evaluator.best(&Pose::identity());
                    let warnings = report.warnings.iter();
                    let warnings = warnings.map(|one| format!("chains {}: {one}", names.join(" ")));
                    self.note(warnings.collect());
                    pairs.push(Some(Measured {
                        quality,
                        native_chains: report.native_chains.clone(),
                        interface_share: report.interface_share,
                    }));
                }
                Err(failure) => {
                    self.note(vec![format!(
                        "chains {} are not measured: {}",
                        names.join(" "),
                        failure.message()
                    )]);
                    self.unmatched.get_or_insert(failure);
                    pairs.push(None);
                }
            }
        }
        self.measured.push(pairs);
    }

    fn note(&mut self, notes: Vec<String>) {
        for note in notes {
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }

    /// Prints the warnings; an error if no pair of chains could be measured.
    fn warn(&mut self, console: Console) -> Result<(), Error> {
        let is_measured = self.measured.iter().flatten().any(Option::is_some);
        if let Some(failure) = self.unmatched.take().filter(|_| !is_measured) {
            return Err(failure);
        }
        for note in &self.notes {
            console.warn(note);
        }
        Ok(())
    }
}

/// A pair of chains of a model, with its agreement and the number and size of its cluster.
struct Row<'a> {
    model: &'a PredictedModel,
    pair: &'a ChainPair,
    /// Places of the model, and of the pair in it.
    place: [usize; 2],
    agreement: Option<f64>,
    cluster: usize,
    cluster_size: usize,
    assessment: Assessment,
    measured: Option<&'a Measured>,
}

/// The rows of all models, in their order.
fn rows<'a>(found: &'a Found, systems: &[System]) -> Vec<Row<'a>> {
    let mut rows: Vec<Row> = Vec::new();
    for system in systems {
        for (member, &place) in system.members.iter().enumerate() {
            let cluster = system.clusters[member];
            let model = &found.models[place[0]];
            let pair = &model.pairs[place[1]];
            let agreement = system.agreement[member];
            let measured = found.measured.get(place[0]);
            rows.push(Row {
                model,
                pair,
                place,
                agreement,
                cluster,
                cluster_size: system
                    .clusters
                    .iter()
                    .filter(|&&other| other == cluster)
                    .count(),
                assessment: Assessment::of(pair, agreement, system.members.len()),
                measured: measured.and_then(|pairs| pairs[place[1]].as_ref()),
            });
        }
    }
    rows.sort_by_key(|row| row.place);
    rows
}

/// Columns of a model.
fn model_columns<'a>() -> [Column<Row<'a>>; 6] {
    [
        ("file", |row| json!(row.model.path.display().to_string())),
        ("program", |row| json!(row.model.program)),
        ("ranking_score", |row| json!(row.model.ranking_score)),
        ("model_iptm", |row| json!(row.model.iptm)),
        ("model_ptm", |row| json!(row.model.ptm)),
        ("model_plddt", |row| json!(row.model.plddt)),
    ]
}

/// Columns of a pair of chains.
fn pair_columns<'a>() -> [Column<Row<'a>>; 26] {
    [
        ("chain_1", |row| json!(row.pair.chains[0])),
        ("chain_2", |row| json!(row.pair.chains[1])),
        ("trust", |row| json!(row.assessment.trust.name())),
        ("evidence", |row| json!(row.assessment.evidence)),
        ("iptm", |row| json!(row.pair.iptm)),
        ("ipsae", |row| json!(larger(row.pair.scores.ipsae))),
        ("ipsae_12", |row| {
            json!(row.pair.scores.ipsae.map(|both| both[0]))
        }),
        ("ipsae_21", |row| {
            json!(row.pair.scores.ipsae.map(|both| both[1]))
        }),
        ("pdockq", |row| json!(row.pair.scores.pdockq)),
        ("pdockq2", |row| json!(larger(row.pair.scores.pdockq2))),
        ("pdockq2_12", |row| {
            json!(row.pair.scores.pdockq2.map(|both| both[0]))
        }),
        ("pdockq2_21", |row| {
            json!(row.pair.scores.pdockq2.map(|both| both[1]))
        }),
        ("lis", |row| json!(mean(row.pair.scores.lis))),
        ("lis_12", |row| {
            json!(row.pair.scores.lis.map(|both| both[0]))
        }),
        ("lis_21", |row| {
            json!(row.pair.scores.lis.map(|both| both[1]))
        }),
        ("interface_pae", |row| json!(row.pair.scores.interface_pae)),
        ("interface_plddt", |row| {
            json!(row.pair.scores.interface_plddt)
        }),
        ("contacts", |row| json!(row.pair.interface.pairs.len())),
        ("hydrogen_bonds", |row| {
            json!(row.pair.interface.hydrogen_bonds)
        }),
        ("salt_bridges", |row| json!(row.pair.interface.salt_bridges)),
        ("clashes", |row| json!(row.pair.interface.clashes)),
        ("buried_area", |row| {
            json!(row.pair.interface.buried.iter().sum::<f64>())
        }),
        ("shape_complementarity", |row| {
            json!(row.pair.interface.shape_complementarity)
        }),
        ("agreement", |row| json!(row.agreement)),
        ("cluster", |row| json!(row.cluster)),
        ("cluster_size", |row| json!(row.cluster_size)),
    ]
}

/// Columns of the known complex, under the names of `knotdock evaluate`.
fn native_columns<'a>() -> [Column<Row<'a>>; 7] {
    [
        ("irmsd", |row| {
            of_native(row, |one| json!(one.quality.irmsd))
        }),
        ("lrmsd", |row| {
            of_native(row, |one| json!(one.quality.lrmsd))
        }),
        ("fnat", |row| of_native(row, |one| json!(one.quality.fnat))),
        ("dockq", |row| {
            of_native(row, |one| json!(one.quality.dockq))
        }),
        ("capri", |row| {
            of_native(row, |one| json!(one.quality.capri.name()))
        }),
        ("interface_share", |row| {
            of_native(row, |one| json!(one.interface_share))
        }),
        ("native_chains", |row| {
            of_native(row, |one| json!(one.native_chains))
        }),
    ]
}

fn of_native(row: &Row, value: fn(&Measured) -> Value) -> Value {
    row.measured.map_or(Value::Null, value)
}

/// Columns of a pair of chains, with those of the known complex if there is one.
fn all_pair_columns<'a>(has_native: bool) -> Vec<Column<Row<'a>>> {
    let native = native_columns().into_iter().filter(|_| has_native);
    pair_columns().into_iter().chain(native).collect()
}

fn columns<'a>(has_native: bool) -> Vec<Column<Row<'a>>> {
    let of_model = model_columns().into_iter();
    of_model.chain(all_pair_columns(has_native)).collect()
}

fn larger(both: Option<[f64; 2]>) -> Option<f64> {
    both.map(|[forth, back]| forth.max(back))
}

fn mean(both: Option<[f64; 2]>) -> Option<f64> {
    both.map(|[forth, back]| 0.5 * (forth + back))
}

/// The models as JSON objects, each with its pairs of chains.
fn objects(models: &[PredictedModel], rows: &[Row], has_native: bool) -> Vec<Value> {
    let columns = all_pair_columns(has_native);
    let of_model = |model: &PredictedModel| -> Value {
        let rows = || rows.iter().filter(|row| std::ptr::eq(row.model, model));
        let pairs: Vec<Map<String, Value>> = rows().map(|row| object(&columns, row)).collect();
        let mut entries = rows()
            .next()
            .map_or_else(Map::new, |row| object(&model_columns(), row));
        let files = model
            .confidence_files
            .iter()
            .map(|path| path.display().to_string());
        entries.insert(
            "confidence_files".to_owned(),
            json!(files.collect::<Vec<String>>()),
        );
        entries.insert("pairs".to_owned(), json!(pairs));
        Value::Object(entries)
    };
    models.iter().map(of_model).collect()
}

/// The row of a system's member of the highest ipTM; the first of equal ones.
fn assessed<'a, 'b>(system: &System, rows: &'b [Row<'a>]) -> Option<&'b Row<'a>> {
    let members = rows
        .iter()
        .filter(|row| system.members.contains(&row.place));
    let iptm = |row: &Row| row.pair.iptm.unwrap_or(-1.0);
    members.reduce(|best, next| if iptm(next) > iptm(best) { next } else { best })
}

/// A system as a JSON object.
fn entry(system: &System, rows: &[Row]) -> Value {
    let row = assessed(system, rows);
    let [first, second] = chains(system, rows);
    let residues = system.consensus.iter().map(|(residue, share)| {
        json!({ "chain": residue.chain, "number": residue.number, "name": residue.name, "share": share })
    });
    json!({
        "chain_1": first,
        "chain_2": second,
        "models": system.members.len(),
        "assessed": row.map(|row| row.model.path.display().to_string()),
        "trust": row.map(|row| row.assessment.trust.name()),
        "evidence": row.map(|row| row.assessment.evidence.as_str()),
        "clusters": sizes(system),
        "consensus": residues.collect::<Vec<Value>>(),
    })
}

/// The chains of a system, by the names in its first model.
fn chains<'a>(system: &System, rows: &'a [Row]) -> [&'a str; 2] {
    let first = rows.iter().find(|row| row.place == system.members[0]);
    first.map_or([""; 2], |row| {
        row.pair.chains.each_ref().map(String::as_str)
    })
}

/// The trust in a pair of chains, with its evidence and the agreement of its models.
fn sentence(system: &System, rows: &[Row]) -> String {
    let [first, second] = chains(system, rows);
    let Some(row) = assessed(system, rows) else {
        return String::new();
    };
    let Assessment { trust, evidence } = &row.assessment;
    let mut text = format!("Chains {first} {second}, {}", trust.name());
    let count = system.members.len();
    if count > 1 {
        let choice = match row.pair.iptm {
            Some(_) => "highest ipTM",
            None => "the first",
        };
        text += &format!(" by {} ({choice})", row.model.path.display());
    }
    text += &format!(": {evidence}.");
    if count > 1 {
        let sizes: Vec<String> = sizes(system).iter().map(usize::to_string).collect();
        let touched = |side: &str| {
            let residues = system.consensus.iter();
            residues
                .filter(|(residue, _)| residue.chain == side)
                .count()
        };
        text += &format!(
            " {} in {} of {}; half or more touch {} of {first} and {} of {second}.",
            counted(count, "model"),
            counted(sizes.len(), "cluster"),
            sizes.join(", "),
            counted(touched(first), "residue"),
            counted(touched(second), "residue"),
        );
    }
    text
}

/// The report, as HTML.
fn page<'a>(
    sentences: Vec<String>,
    columns: &[Column<Row<'a>>],
    rows: &[Row<'a>],
    shown: ShownModels,
    viewer: Option<&Viewer>,
) -> String {
    let main = [
        "chain_1",
        "chain_2",
        "trust",
        "iptm",
        "ipsae",
        "pdockq2",
        "agreement",
        "dockq",
        "capri",
        "file",
    ];
    // These come first, in this order.
    let place = |name: &str| main.iter().position(|one| *one == name);
    let mut columns: Vec<&Column<Row<'a>>> = columns.iter().collect();
    columns.sort_by_key(|(name, _)| place(name).unwrap_or(main.len()));
    let record = |row: &Row<'a>| -> StringRecord {
        let fields = columns.iter().map(|(_, value)| field(&value(row)));
        fields.collect()
    };
    ModelsReport {
        title: "Predicted models".to_owned(),
        sentences,
        header: columns.iter().map(|(name, _)| *name).collect(),
        records: rows.iter().map(record).collect(),
        main: &main,
        shown,
    }
    .text(viewer)
}

/// Sizes of the clusters.
fn sizes(system: &System) -> Vec<usize> {
    let clusters = system.clusters.iter().copied().max().unwrap_or(0);
    let size = |number| system.clusters.iter().filter(|&&one| one == number).count();
    (1..=clusters).map(size).collect()
}

/// The table of the terminal, and the trust in each pair of chains.
fn text(models: &[PredictedModel], systems: &[System], rows: &[Row], has_native: bool) -> String {
    let rounded = |value: Option<f64>, digits: usize| {
        value.map_or_else(String::new, |value| format!("{value:.digits$}"))
    };
    let lines = rows.iter().map(|row| {
        let ChainPair {
            chains,
            iptm,
            scores,
            interface,
            ..
        } = row.pair;
        let mut line = vec![
            row.model.path.display().to_string(),
            format!("{} {}", chains[0], chains[1]),
            row.assessment.trust.name().to_owned(),
            rounded(*iptm, 2),
            rounded(larger(scores.ipsae), 3),
            rounded(larger(scores.pdockq2), 3),
            rounded(mean(scores.lis), 3),
            rounded(scores.interface_pae, 1),
            rounded(scores.interface_plddt, 0),
            interface.pairs.len().to_string(),
            format!("{:.0}", interface.buried[0] + interface.buried[1]),
            rounded(interface.shape_complementarity, 2),
            interface.clashes.to_string(),
            rounded(row.agreement, 2),
        ];
        if has_native {
            let quality = row.measured.map(|one| one.quality);
            line.push(rounded(quality.map(|one| one.dockq), 3));
            line.push(quality.map_or_else(String::new, |one| one.capri.name().to_owned()));
        }
        line
    });
    let mut header = "file|chains|trust|ipTM|ipSAE|pDockQ2|LIS|PAE, Å|pLDDT|contacts|buried, Å²|Sc|clashes|agreement"
        .to_owned();
    if has_native {
        header += "|dockq|capri";
    }
    let mut text = text_table(&header, lines);
    for system in systems {
        text += &format!("\n{}", sentence(system, rows));
    }
    match models
        .iter()
        .filter(|model| model.confidence_files.is_empty())
        .count()
    {
        0 => text,
        bare => format!(
            "{text}\n{} without confidence files",
            counted(bare, "model")
        ),
    }
}
