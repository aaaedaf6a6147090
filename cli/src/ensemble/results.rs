//! Joint results of an ensemble: the table, complexes, the record, and the report.

use std::path::Path;

use serde_json::{Value, json};

use crate::ensemble::aligned::AlignedConformation;
use crate::ensemble::run::{DockedMembers, Ensemble, Place};
use crate::inputs::bodies::Bodies;
use crate::messages::console::Console;
use crate::records::{ENSEMBLE_RECORD, ENSEMBLE_SCHEMA, joined};
use crate::report::DirectoryKind;
use crate::tables::report::{BEST, best_rows, counted};
use knotdock::ensemble::table::JointTable;
use knotdock::output::files::own_files::MEMBERS;
use knotdock::output::files::seal::REPORT;
use knotdock::output::files::staging::Stage;
use knotdock::output::files::viewers::ViewedComplex;
use knotdock::output::files::whole_file::to_json;
use knotdock::output::records::program::Program;
use knotdock::output::run_folder::write_scripts;
use knotdock::output::tables::poses::PoseRow;
use knotdock::output::top_complexes::TopComplexes;
use knotdock::pose_space::arrangement::Arrangement;
use knotdock_structures::Error;

impl Ensemble {
    /// Writes the joint table, complexes and the record, and reports them; the JSON object.
    pub(super) fn write(
        &self,
        joint: &JointTable,
        docked: &DockedMembers,
        place: Place,
        console: Console,
    ) -> Result<Value, Error> {
        let staging = place.stage();
        staging.write("poses.csv", |file| joint.table.write_to(file))?;
        let viewed = self.write_top(joint, &staging.folder().join("top"))?;
        write_scripts(staging, &viewed)?;
        let record = self.record(joint, docked, staging)?;
        staging.write(ENSEMBLE_RECORD, |file| to_json(file, &record))?;
        if !self.request.given.options.output.no_report {
            let name = self.request.directory.display().to_string();
            let text =
                DirectoryKind::Ensemble.report(&self.request.directory, staging.folder(), &name)?;
            staging.write(REPORT, |file| file.write_all(text.as_bytes()))?;
        }
        place.commit()?;
        self.report(joint, console);
        let top = self.request.directory.join("top");
        let complexes = viewed
            .iter()
            .map(|complex| top.join(&complex.file).display().to_string());
        Ok(json!({
            "directory": self.request.directory.display().to_string(),
            "poses": self.request.directory.join("poses.csv").display().to_string(),
            "complexes": complexes.collect::<Vec<_>>(),
            "best": joint.table.objects(joint.firsts().into_iter().take(BEST)),
            "ensemble": record,
        }))
    }

    /// Writes the complexes of the first ranks, each of its member's conformations, in the order of the ranks.
    fn write_top(&self, joint: &JointTable, folder: &Path) -> Result<Vec<ViewedComplex>, Error> {
        let rows = joint.table.rows();
        let count = self.request.given.options.output.write_top.min(rows.len());
        let mut viewed = Vec::new();
        for (index, member) in self.members().into_iter().enumerate() {
            let own = (0..count).filter(|&row| joint.members[row] == index);
            let own: Vec<PoseRow> = own.map(|row| rows[row]).collect();
            if own.is_empty() {
                continue;
            }
            let specs = self.conformations(member).map(|laid| laid.spec.clone());
            let bodies = Bodies::of(specs, &self.request.given.options)?;
            let options = &self.request.given.options;
            let top = TopComplexes::new(bodies.placed(), &own, options)?;
            let complexes = (&own[..], top.refined());
            let placed = bodies.placed();
            let written = placed.write(complexes, Arrangement::Pair, (folder, None))?;
            let chains = written.chains.unwrap_or_default();
            let names = own.iter().zip(&written.names);
            viewed.extend(names.map(|(row, name)| ViewedComplex::new(row.rank, name, &chains)));
        }
        viewed.sort_by_key(|complex| complex.rank);
        Ok(viewed)
    }

    /// ensemble.json. All but `timing` and `command` is the same for the same input, options and CPU feature level.
    fn record(
        &self,
        joint: &JointTable,
        docked: &DockedMembers,
        staging: &Stage,
    ) -> Result<Value, Error> {
        let members = docked.members.iter().map(|member| {
            let [receptor, ligand] = &member.conformations;
            let best = member.table.objects([0]);
            let best = best.first().and_then(|row| row["pose_score"].as_f64());
            json!({
                "name": member.name,
                "receptor_model": receptor,
                "ligand_model": ligand,
                "rows": member.table.rows().len(),
                "best_pose_score": best,
            })
        });
        let [receptor, ligand] = self.aligned.sides.each_ref();
        let conformations = |side: &[AlignedConformation]| {
            side.iter()
                .map(AlignedConformation::record)
                .collect::<Vec<_>>()
        };
        let command = std::env::args_os().map(|word| word.to_string_lossy().into_owned());
        Ok(joined([
            json!({ "schema": ENSEMBLE_SCHEMA }),
            json!(Program::this()),
            json!({
                "receptor": conformations(receptor),
                "ligand": conformations(ligand),
                "options": self.request.given.options,
                "members": members.collect::<Vec<_>>(),
                "results": {
                    "rows": joint.table.rows().len(),
                    "clusters": joint.clusters,
                    "poses": docked.poses,
                },
                "files": staging.checksums()?,
                "timing": {
                    "wall_seconds": self.clock.seconds(),
                    "expected_seconds": self.expected_seconds,
                    "members_kept": docked.kept,
                },
                "command": command.collect::<Vec<_>>(),
            }),
        ]))
    }

    fn report(&self, joint: &JointTable, console: Console) {
        console.say(format!(
            "\n{}\n\nAll {} together: {} in {:.1} s",
            best_rows(&joint.table, joint.firsts()),
            counted(self.members().len(), "run"),
            counted(joint.clusters, "cluster"),
            self.clock.seconds(),
        ));
        let directory = self.request.directory.display();
        console.say(format!(
            "Effects, errors and times of each are in {directory}/{MEMBERS}/*/run.json"
        ));
        console.say(format!(
            "{} in {directory}/poses.csv",
            counted(joint.table.rows().len(), "row"),
        ));
        if !self.request.given.options.output.no_report {
            console.say(format!(
                "  open {directory}/{REPORT}  look at them in a browser"
            ));
        }
    }
}
