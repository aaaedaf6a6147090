//! The runs of an ensemble: planned, foreseen and docked one after another.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::records::ensemble_record::RECORD;
use crate::tables::batch_results::RunSummary;
use crate::tables::report::counted;
use crate::tradeoff::choice::Wanted;
use knotdock::ensemble::table::{DockedMember, joint};
use knotdock::output::files::own_files::MEMBERS;
use knotdock::output::tables::poses::PoseTable;
use knotdock::rank::cluster::RigidBody;
use serde_json::Value;

use crate::arguments::options::GivenOptions;
use crate::docking::{Docking, held_by_another};
use crate::ensemble::aligned::{AlignedConformation, AlignedSides};
use crate::ensemble::place::Place;
use crate::inputs::bodies::Bodies;
use crate::inputs::conformations::Conformation;
use crate::inputs::native::NativeFiles;
use crate::inputs::request::Request;
use crate::messages::brief::time_text;
use crate::messages::console::Console;
use crate::messages::leftovers::warn_leftovers;
use knotdock::output::run_folder::Clock;
use knotdock_structures::Error;

/// Conformations of two molecules, each pair of which is docked.
pub struct Ensemble {
    pub(super) aligned: AlignedSides,
    pub(super) given: GivenOptions,
    native: Option<NativeFiles>,
    wanted: Wanted,
    pub(super) directory: PathBuf,
    force: bool,
    pub(super) clock: Clock,
    pub(super) expected_seconds: f64,
}

/// The members of an ensemble after docking.
#[derive(Default)]
pub(super) struct DockedMembers {
    /// Their tables.
    pub members: Vec<DockedMember>,
    /// Poses that they kept.
    pub poses: u64,
    /// Members whose runs were there already.
    pub kept: usize,
}

/// A member: which conformation of each side.
#[derive(Clone, Copy)]
pub(super) struct Member([usize; 2]);

impl Ensemble {
    /// Reads all conformations, plans the largest pair and reports the expected cost.
    ///
    /// # Errors
    /// [`Error`] if a conformation cannot be used, or if memory does not suffice for the largest pair.
    pub fn prepare(
        sides: &[Vec<Conformation>; 2],
        (given, native, wanted): (GivenOptions, Option<NativeFiles>, Wanted),
        (directory, force): (PathBuf, bool),
        clock: Clock,
        console: Console,
    ) -> Result<Self, Error> {
        if given.options.search.symmetry.is_some() {
            return Err(
                Error::input("--symmetry docks one conformation, and several are given")
                    .help("dock each conformation in a run of its own"),
            );
        }
        let aligned = AlignedSides::read(sides, &given.options)?;
        let mut ensemble = Self {
            aligned,
            given,
            native,
            wanted,
            directory,
            force,
            clock,
            expected_seconds: 0.0,
        };
        for (side, laid) in ["Receptor", "Ligand"].iter().zip(&ensemble.aligned.sides) {
            let lines: Vec<String> = laid.iter().map(AlignedConformation::line).collect();
            console.say(format!(
                "{side}, {}:\n{}",
                counted(laid.len(), "conformation"),
                lines.join("\n")
            ));
        }
        ensemble.expected_seconds = ensemble.foresee(console)?;
        Ok(ensemble)
    }

    /// The members in the order of docking: of each conformation of the receptor all of the ligand.
    pub(super) fn members(&self) -> Vec<Member> {
        let [receptors, ligands] = self.aligned.sides.each_ref().map(Vec::len);
        let of_receptor = |receptor| (0..ligands).map(move |ligand| Member([receptor, ligand]));
        (0..receptors).flat_map(of_receptor).collect()
    }

    pub(super) fn conformations(&self, Member(places): Member) -> [&AlignedConformation; 2] {
        let [receptors, ligands] = &self.aligned.sides;
        [&receptors[places[0]], &ligands[places[1]]]
    }

    /// Its name, and that of the folder of its run.
    fn name(&self, member: Member) -> String {
        let [receptor, ligand] = self.conformations(member);
        format!("r{}_l{}", receptor.name, ligand.name)
    }

    /// Plans a member's run, for the folder that it will have in the end.
    fn planned(&self, member: Member, console: Console) -> Result<Docking, Error> {
        let folder = self.directory.join(MEMBERS).join(self.name(member));
        self.docking(member, folder, console)
    }

    /// Plans a member's run into a folder.
    fn docking(&self, member: Member, folder: PathBuf, console: Console) -> Result<Docking, Error> {
        let specs = self.conformations(member).map(|laid| laid.spec.clone());
        let bodies = Bodies::of(specs, &self.given.options)?;
        let request = Request::of(bodies, self.native.clone(), self.given.clone());
        let place = (folder, self.force);
        let mut docking = Docking::prepare(request, self.wanted, place, Clock::start(), console)?;
        docking.shown = self.directory.join(MEMBERS).join(self.name(member));
        Ok(docking)
    }

    /// Plans and describes the first member, then plans the largest; the seconds that all are expected to take.
    fn foresee(&self, console: Console) -> Result<f64, Error> {
        let first = self.planned(Member([0, 0]), console)?;
        let largest = Member(self.aligned.sides.each_ref().map(|side| largest(side)));
        let bytes = match largest.0 {
            [0, 0] => first.memory_bytes(),
            _ => first
                .memory_bytes()
                .max(self.planned(largest, console.silent())?.memory_bytes()),
        };
        let count = self.members().len();
        let each = first.expected_seconds();
        let seconds = each * count as f64;
        let [receptors, ligands] = self.aligned.sides.each_ref().map(Vec::len);
        console.say(format!(
            "\n{}: {} of the receptor with {ligands} of the ligand, one after another; about {} of search in all, {} \
             each, and at most {:.0} MB",
            counted(count, "run"),
            counted(receptors, "conformation"),
            time_text(seconds),
            time_text(each),
            bytes as f64 / 1e6,
        ));
        Ok(seconds)
    }

    /// The directory, or that of a member, if it holds results of something else that are not to be replaced.
    pub fn in_the_way(&self) -> Option<&Path> {
        let record = !self.force && self.directory.join(RECORD).exists();
        record.then_some(self.directory.as_path())
    }

    /// Whether the directory holds this very ensemble already.
    pub fn is_done(&self, console: Console) -> bool {
        let is_done = |member: Member| {
            let docking = self.planned(member, console.silent());
            docking.is_ok_and(|docking| docking.is_done())
        };
        let recorded = recorded_members(&self.directory.join(RECORD));
        let names: Vec<String> = self
            .members()
            .into_iter()
            .map(|one| self.name(one))
            .collect();
        recorded == Some(names)
            && self.directory.join("poses.csv").is_file()
            && self.members().into_iter().all(is_done)
    }

    /// Docks the missing members, and writes the joint results; their JSON object.
    pub fn run(self, console: Console, notices: Console) -> Result<Value, Error> {
        let place = Place::open(&self.directory, self.force)?;
        warn_leftovers(place.leftovers(), notices);
        let members = self.members();
        let mut docked = DockedMembers::default();
        for (&member, number) in members.iter().zip(1..) {
            let clock = Instant::now();
            let folder = place.member(&self.name(member));
            let anew = self.dock(member, &folder, (console.silent(), notices))?;
            docked.kept += usize::from(!anew);
            let summary = RunSummary::of(&folder)?;
            docked.poses += summary.counts[0].unwrap_or(0);
            console.say(format!(
                "[{number}/{}] {}: {}",
                members.len(),
                self.name(member),
                summary.line(anew.then(|| clock.elapsed().as_secs_f64()))
            ));
            let path = folder.join("poses.csv");
            docked.members.push(DockedMember {
                name: self.name(member),
                conformations: self.conformations(member).map(|laid| laid.name.clone()),
                to_first: self.conformations(member).map(|laid| laid.place.motion),
                table: PoseTable::read(&path)?,
                path,
            });
        }
        let ranking = &self.given.options.ranking;
        let body = RigidBody::new(&self.aligned.points);
        let joint = joint(
            &docked.members,
            &body,
            ranking.cluster_radius,
            ranking.no_cluster,
        )?;
        self.write(&joint, &docked, place, console)
    }

    /// Docks a member, unless its run is there; whether it had to be done.
    fn dock(
        &self,
        member: Member,
        folder: &Path,
        (silent, notices): (Console, Console),
    ) -> Result<bool, Error> {
        let docking = self.docking(member, folder.to_owned(), silent)?;
        if docking.is_done() {
            return Ok(false);
        }
        if let Some(directory) = docking.in_the_way() {
            return Err(held_by_another(directory, "--force"));
        }
        docking.run(silent, notices)?;
        Ok(true)
    }
}

/// Names of the members that a record lists.
fn recorded_members(path: &Path) -> Option<Vec<String>> {
    let record: Value = serde_json::from_slice(&std::fs::read(path).ok()?).ok()?;
    let members = record["members"].as_array()?.iter();
    members
        .map(|member| Some(member["name"].as_str()?.to_owned()))
        .collect()
}

/// The conformation that reaches furthest.
fn largest(side: &[AlignedConformation]) -> usize {
    let places = 0..side.len();
    let by_radius =
        |&a: &usize, &b: &usize| side[a].radius.total_cmp(&side[b].radius).then(b.cmp(&a));
    places.max_by(by_radius).unwrap_or(0)
}
