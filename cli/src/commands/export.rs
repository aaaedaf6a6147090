//! `knotdock export`: further complexes from a finished run.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use clap::builder::RangedU64ValueParser;
use clap::{Args, ValueEnum};
use serde_json::json;

use crate::arguments::machine::Threads;
use crate::arguments::output_file::check_not_read;
use crate::arguments::ranks::Ranks;
use crate::ensemble::finished::{RunRows, runs};
use crate::inputs::bodies::Bodies;
use crate::messages::console::Console;
use crate::records::is_ensemble;
use crate::records::recorded_run::RecordedRun;
use knotdock::dock::pair::Pair;
use knotdock::output::files::added::Addition;
use knotdock::output::files::complexes::{PosedPair, file_names};
use knotdock::output::files::model_file::{model_file_name, write_model_file};
use knotdock::output::files::staging::{Stage, put_back};
use knotdock::output::prediction_inputs::{CONTACTS, PredictionInputs, Predictor};
use knotdock::output::tables::poses::{PoseRow, PoseTable};
use knotdock::output::top_complexes::TopComplexes;
use knotdock::pose_space::arrangement::Arrangement;
use knotdock::threads;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use knotdock_structures::molecule::{ChainMap, Format};

/// Write complexes (or assemblies of meshes) of chosen ranks of a run, receptor and placed ligand in one file.
#[derive(Args, Debug)]
pub struct Export {
    /// Directory of the run.
    #[arg(value_name = "DIR")]
    run: PathBuf,
    /// Ranks in poses.csv, such as 37,40-45.
    #[arg(long, alias = "ranks", value_name = "RANKS")]
    rank: Ranks,
    /// Of these ranks only the best of each cluster, where the table lists every pose.
    #[arg(long)]
    best_of_cluster: bool,
    /// Format: pdb or cif, one file per rank; or ensemble, one file with one model per rank (ensemble.pdb, or .cif where PDB
    /// cannot hold it) [default: pdb, or cif where an input was mmCIF or PDB cannot hold it].
    ///
    /// Or boltz, chai or protenix: an input of that predictor per rank, with the sequences of both sides and contacts of
    /// the pose as constraints.
    #[arg(
        long,
        value_name = "pdb|cif|ensemble|boltz|chai|protenix",
        hide_possible_values = true
    )]
    format: Option<ExportFormat>,
    /// Contacts of a pose that an input of a predictor has: those that most poses of its cluster share, then the nearest,
    /// spread over both sides.
    #[arg(long, value_name = "COUNT", default_value_t = CONTACTS, value_parser = RangedU64ValueParser::<usize>::new().range(1..=1000))]
    contacts: usize,
    /// Directory to write to [default: DIR/top; of inputs of a predictor DIR/predict].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Write complexes as they were searched, not refined.
    #[arg(long)]
    raw: bool,
    /// Replace complexes that are there and differ, even if someone has edited them.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    threads: Threads,
}

/// How complexes are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ExportFormat {
    Pdb,
    Cif,
    Ensemble,
    Boltz,
    Chai,
    Protenix,
}

impl ExportFormat {
    /// The predictor whose inputs are written.
    fn predictor(self) -> Option<Predictor> {
        match self {
            Self::Boltz => Some(Predictor::Boltz),
            Self::Chai => Some(Predictor::Chai),
            Self::Protenix => Some(Predictor::Protenix),
            Self::Pdb | Self::Cif | Self::Ensemble => None,
        }
    }
}

impl Export {
    pub fn run(self, console: Console) -> Result<(), Error> {
        threads::on(self.threads.count(), || self.export(console))?
    }

    fn export(self, console: Console) -> Result<(), Error> {
        put_back(&self.run)?;
        let predictor = self.format.and_then(ExportFormat::predictor);
        let own = self.run.join(if predictor.is_some() {
            "predict"
        } else {
            "top"
        });
        let folder = self.output.clone().unwrap_or(own);
        let exports = self.exports(&folder)?;
        let export = Addition::open(&folder, Some(&self.run))?;
        console.warn_leftovers(&export.leftovers);
        if let Some(predictor) = predictor {
            let names = self.predictions(predictor, &exports, export.stage(), console)?;
            export.place(self.force)?;
            let paths = names
                .iter()
                .map(|name| folder.join(name).display().to_string());
            let paths: Vec<String> = paths.collect();
            console.say(paths.join("\n"));
            return console.result(&json!({ "files": paths }));
        }
        if self.format == Some(ExportFormat::Ensemble) {
            let pairs = exports.iter().map(RunExport::pairs);
            let mut pairs: Vec<PosedPair> = pairs.collect::<Result<Vec<_>, Error>>()?.concat();
            pairs.sort_by_key(|pair| self.place(pair.row.rank));
            let name = write_model_file(&pairs, export.stage().folder())?;
            export.place(self.force)?;
            let path = folder.join(name).display().to_string();
            console.say(&path);
            let ranks: Vec<usize> = pairs.iter().map(|pair| pair.row.rank).collect();
            return console.result(&json!({ "file": path, "ranks": ranks }));
        }
        let format = self.format.map(|format| match format {
            ExportFormat::Pdb => Format::Pdb,
            _ => Format::Mmcif,
        });
        let mut written: Vec<(usize, String, Option<ChainMap>)> = Vec::new();
        for RunExport {
            rows,
            bodies,
            arrangement,
            top,
        } in &exports
        {
            let of_run = bodies.placed().write(
                (rows, top.refined()),
                *arrangement,
                (export.stage().folder(), format),
            )?;
            let names = rows.iter().zip(of_run.names);
            written.extend(names.map(|(row, name)| (row.rank, name, of_run.chains.clone())));
        }
        export.place(self.force)?;
        written.sort_by_key(|(rank, _, _)| self.place(*rank));
        let paths = written.iter().map(|(_, name, _)| folder.join(name));
        let paths: Vec<String> = paths.map(|path| path.display().to_string()).collect();
        console.say(paths.join("\n"));
        let is_one = exports.len() == 1;
        let chains = written.last().and_then(|(_, _, chains)| chains.clone());
        let files = written
            .iter()
            .zip(&paths)
            .map(|((rank, _, chains), path)| match is_one {
                true => json!({ "rank": rank, "path": path }),
                false => json!({ "rank": rank, "path": path, "chains": chains }),
            });
        console.result(&json!({
            "files": files.collect::<Vec<_>>(),
            "chains": chains.filter(|_| is_one),
        }))?;
        Ok(())
    }

    /// Writes inputs of a predictor; the names of their files.
    fn predictions(
        &self,
        predictor: Predictor,
        exports: &[RunExport],
        stage: &Stage,
        console: Console,
    ) -> Result<Vec<String>, Error> {
        let table = PoseTable::read(&self.run.join("poses.csv"))?;
        // Clusters of an ensemble are of several structures.
        let clusters = |row: &PoseRow| -> Vec<Pose> {
            let rows = table.rows();
            let cluster = |place: usize| {
                table
                    .field(place, "cluster")
                    .filter(|name| !name.is_empty())
            };
            let own = rows
                .iter()
                .position(|other| other.rank == row.rank)
                .and_then(cluster);
            let others = (0..rows.len()).filter(|&place| own.is_some() && cluster(place) == own);
            match is_ensemble(&self.run) {
                true => Vec::new(),
                false => others.map(|place| rows[place].pose).collect(),
            }
        };
        let mut names = Vec::new();
        for export in exports {
            let Pair::Molecules(molecules) = export.bodies.pair() else {
                return Err(Error::input("these are meshes, not molecules"));
            };
            if export.arrangement.is_ring() {
                return Err(Error::input(
                    "inputs of predictors are written of two partners, and this is a ring",
                )
                .at(&self.run)
                .help("export it as pdb or cif"));
            }
            let inputs = PredictionInputs::new(molecules)?;
            for warning in &inputs.warnings {
                console.warn(warning);
            }
            for row in &export.rows {
                let contacts = inputs.contacts(&row.pose, &clusters(row), self.contacts);
                if contacts.is_empty() {
                    let message = format!(
                        "no standard residues are in contact in the pose of rank {}",
                        row.rank
                    );
                    return Err(Error::input(message)
                        .at(&self.run)
                        .help("choose other ranks"));
                }
                for (name, text) in inputs.files(predictor, row.rank, &contacts) {
                    stage.write(&name, |file| file.write_all(text.as_bytes()))?;
                    names.push(name);
                }
            }
        }
        Ok(names)
    }

    /// Place of a rank in the user's list, whichever run it is of.
    fn place(&self, rank: usize) -> Option<usize> {
        self.rank.0.iter().position(|listed| *listed == rank)
    }

    /// The poses to write; for an ensemble, those of each member.
    fn exports(&self, folder: &Path) -> Result<Vec<RunExport>, Error> {
        if !is_ensemble(&self.run) {
            // The error of an unreadable record helps more than that of a missing table.
            RecordedRun::read(&self.run.join("run.json"))?;
        }
        let table_path = self.run.join("poses.csv");
        let table = PoseTable::read(&table_path)?;
        let mut places = self.rank.places(&table, &table_path)?;
        if self.best_of_cluster {
            // Rows of a cluster stand best first, and a row without one is by itself.
            let mut seen = HashSet::new();
            places.sort_unstable();
            places.retain(|&place| match table.field(place, "cluster") {
                None | Some("") => true,
                Some(cluster) => seen.insert(cluster),
            });
            places.sort_by_key(|&place| self.place(table.rows()[place].rank));
        }
        let runs = runs(&self.run, &table, &places)?.into_iter();
        let exports = runs.map(|RunRows { run: run_path, rows }| {
            let run = RecordedRun::read(&run_path)?;
            let rows: Vec<PoseRow> = rows.into_iter().map(|place| table.rows()[place]).collect();
            let arrangement = Arrangement::from(run.options.search.symmetry);
            let is_no_ring = |row: &&PoseRow| arrangement.images(&row.pose).is_none();
            if let Some(PoseRow { rank, .. }) = rows.iter().find(is_no_ring) {
                let suffix = arrangement.suffix();
                return Err(Error::input(format!(
                    "the pose of rank {rank} forms no ring{suffix}"
                ))
                .at(&table_path)
                .help("take the table as the run wrote it; `knotdock dock --rerun` makes it again"));
            }
            let bodies = Bodies::recorded(run.inputs.pair(), &run_path, &run.options)?;
            if self.format.is_some() && bodies.are_meshes() {
                let error = "--format is of molecules, and this is a run of meshes";
                return Err(Error::input(error)
                    .at(&run_path)
                    .help("leave it out: assemblies are written as .obj"));
            }
            let models = [Format::Pdb, Format::Mmcif].map(model_file_name);
            for name in rows.iter().flat_map(|row| file_names(row.rank)).chain(models) {
                let read = bodies.records().map(|record| record.path.as_path());
                check_not_read(&folder.join(name), read)?;
            }
            let wanted = run.options.changed(|options| {
                // Inputs of predictors are of the poses as they were searched.
                options.output.raw |= self.raw || self.format.is_some_and(|format| format.predictor().is_some());
            });
            let top = TopComplexes::new(bodies.placed(), &rows, &wanted)?;
            Ok(RunExport {
                rows,
                bodies,
                arrangement,
                top,
            })
        });
        exports.collect()
    }
}

impl RunExport {
    fn pairs(&self) -> Result<Vec<PosedPair<'_>>, Error> {
        let Pair::Molecules(molecules) = self.bodies.pair() else {
            return Err(Error::input("these are meshes, not molecules"));
        };
        let kind = (molecules, self.arrangement);
        Ok(PosedPair::of(kind, (&self.rows, self.top.refined())))
    }
}

/// Poses of a run, and the bodies that they place.
struct RunExport {
    rows: Vec<PoseRow>,
    bodies: Bodies,
    arrangement: Arrangement,
    top: TopComplexes,
}
