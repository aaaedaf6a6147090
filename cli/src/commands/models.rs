//! `knotdock models`: which predicted models of a complex to trust, by their confidence and their coordinates.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use crate::arguments::machine::Threads;
use crate::arguments::output_file::check_outputs;
use crate::messages::console::{Console, failure_text};
use crate::tables::report::{counted, text_table};
use crate::tables::{Column, object, write_table};
use knotdock::models::scores::IPSAE_CUTOFF;
use knotdock::models::{ChainPair, PredictedModel, System, model_files, systems};
use knotdock::options::DockOptions;
use knotdock::options::values::{ABOVE_ZERO, in_range};
use knotdock::output::files::whole_file::write_whole;
use knotdock::threads;
use knotdock_structures::Error;

/// Rate predicted models of complexes: ipTM, ipSAE, pDockQ and LIS of each pair of chains by the confidence of
/// AlphaFold 3, Boltz, ColabFold, Chai or Protenix, beside contacts, clashes and fit of the surfaces.
///
/// Confidence files are found by their names beside each structure. Without them the coordinates are described.
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
    /// Write a row for each pair of chains of each model to this table.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the file of `--output` if it exists.
    #[arg(long, requires = "output")]
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
        let read = files.iter().chain(&self.confidence).map(PathBuf::as_path);
        check_outputs(
            &self.output,
            &read.collect::<Vec<&Path>>(),
            self.force,
            console,
        )?;
        let ph = DockOptions::default().terms.ph;
        let (mut models, mut code) = (Vec::new(), 0);
        // One after another: the confidence of one can take much of the memory.
        for file in &files {
            match PredictedModel::read(file, confidence, self.pae_cutoff, ph) {
                Ok(model) => models.push(model),
                Err(failure) if files.len() == 1 => return Err(failure),
                Err(failure) => {
                    console.error(failure_text(&failure));
                    code = code.max(failure.exit_code());
                }
            }
        }
        let systems = systems(&models);
        let rows = rows(&models, &systems);
        if let Some(path) = &self.output {
            write_whole(path, |file| write_table(file, &columns(), &rows))?;
        }
        console.say(text(&models, &systems, &rows));
        let systems: Vec<Value> = systems.iter().map(|one| entry(one, &models)).collect();
        console.result(&json!({ "models": objects(&models, &rows), "systems": systems }))?;
        Ok(code)
    }
}

/// A pair of chains of a model, with its agreement and the number and size of its cluster.
struct Row<'a> {
    model: &'a PredictedModel,
    pair: &'a ChainPair,
    agreement: Option<f64>,
    cluster: usize,
    cluster_size: usize,
}

/// The rows of all models, in their order.
fn rows<'a>(models: &'a [PredictedModel], systems: &[System]) -> Vec<Row<'a>> {
    let mut rows: Vec<([usize; 2], Row)> = Vec::new();
    for system in systems {
        for (member, &place) in system.members.iter().enumerate() {
            let cluster = system.clusters[member];
            let row = Row {
                model: &models[place[0]],
                pair: &models[place[0]].pairs[place[1]],
                agreement: system.agreement[member],
                cluster,
                cluster_size: system
                    .clusters
                    .iter()
                    .filter(|&&other| other == cluster)
                    .count(),
            };
            rows.push((place, row));
        }
    }
    rows.sort_by_key(|(place, _)| *place);
    rows.into_iter().map(|(_, row)| row).collect()
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
fn pair_columns<'a>() -> [Column<Row<'a>>; 24] {
    [
        ("chain_1", |row| json!(row.pair.chains[0])),
        ("chain_2", |row| json!(row.pair.chains[1])),
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

fn columns<'a>() -> Vec<Column<Row<'a>>> {
    model_columns().into_iter().chain(pair_columns()).collect()
}

fn larger(both: Option<[f64; 2]>) -> Option<f64> {
    both.map(|[forth, back]| forth.max(back))
}

fn mean(both: Option<[f64; 2]>) -> Option<f64> {
    both.map(|[forth, back]| 0.5 * (forth + back))
}

/// The models as JSON objects, each with its pairs of chains.
fn objects(models: &[PredictedModel], rows: &[Row]) -> Vec<Value> {
    let of_model = |model: &PredictedModel| -> Value {
        let rows = || rows.iter().filter(|row| std::ptr::eq(row.model, model));
        let pairs: Vec<Map<String, Value>> =
            rows().map(|row| object(&pair_columns(), row)).collect();
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

/// The chains of a system, by the names in its first model.
fn chains<'a>(system: &System, models: &'a [PredictedModel]) -> &'a [String; 2] {
    let [model, pair] = system.members[0];
    &models[model].pairs[pair].chains
}

/// A system as a JSON object.
fn entry(system: &System, models: &[PredictedModel]) -> Value {
    let [first, second] = chains(system, models);
    let residues = system.consensus.iter().map(|(residue, share)| {
        json!({ "chain": residue.chain, "number": residue.number, "name": residue.name, "share": share })
    });
    json!({
        "chain_1": first,
        "chain_2": second,
        "models": system.members.len(),
        "clusters": sizes(system),
        "consensus": residues.collect::<Vec<Value>>(),
    })
}

/// Sizes of the clusters.
fn sizes(system: &System) -> Vec<usize> {
    let clusters = system.clusters.iter().copied().max().unwrap_or(0);
    let size = |number| system.clusters.iter().filter(|&&one| one == number).count();
    (1..=clusters).map(size).collect()
}

/// The table of the terminal, and the agreement of models of one system.
fn text(models: &[PredictedModel], systems: &[System], rows: &[Row]) -> String {
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
        vec![
            row.model.path.display().to_string(),
            format!("{} {}", chains[0], chains[1]),
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
        ]
    });
    let mut text = text_table(
        "file|chains|ipTM|ipSAE|pDockQ2|LIS|PAE, Å|pLDDT|contacts|buried, Å²|Sc|clashes|agreement",
        lines,
    );
    for system in systems.iter().filter(|system| system.members.len() > 1) {
        let [first, second] = chains(system, models);
        let sizes: Vec<String> = sizes(system).iter().map(usize::to_string).collect();
        let touched = |side: &str| {
            let residues = system.consensus.iter();
            residues
                .filter(|(residue, _)| residue.chain == side)
                .count()
        };
        text += &format!(
            "\nChains {first} {second}: {} in {} of {}; half or more touch {} of {first} and {} of {second}",
            counted(system.members.len(), "model"),
            counted(sizes.len(), "cluster"),
            sizes.join(", "),
            counted(touched(first), "residue"),
            counted(touched(second), "residue"),
        );
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
