//! `knotdock export`: further complexes from a finished run.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

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
use knotdock::output::files::staging::put_back;
use knotdock::output::tables::poses::{PoseRow, PoseTable};
use knotdock::output::top_complexes::TopComplexes;
use knotdock::pose_space::arrangement::Arrangement;
use knotdock::threads;
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
    #[arg(long, value_name = "pdb|cif|ensemble", hide_possible_values = true)]
    format: Option<ExportFormat>,
    /// Directory to write to [default: DIR/top].
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
}

impl Export {
    pub fn run(self, console: Console) -> Result<(), Error> {
        threads::on(self.threads.count(), || self.export(console))?
    }

    fn export(self, console: Console) -> Result<(), Error> {
        put_back(&self.run)?;
        let own = self.run.join("top");
        let folder = self.output.clone().unwrap_or(own);
        let exports = self.exports(&folder)?;
        let export = Addition::open(&folder, Some(&self.run))?;
        console.warn_leftovers(&export.leftovers);
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
                options.output.raw |= self.raw;
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
