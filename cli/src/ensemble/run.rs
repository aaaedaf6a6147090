//! The runs of an ensemble: planned, foreseen and docked one after another.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::Value;

use crate::arguments::options::GivenOptions;
use crate::docking::{Docking, held_by_another};
use crate::ensemble::aligned::{AlignedConformation, AlignedSides};
use crate::inputs::bodies::Bodies;
use crate::inputs::conformations::Conformation;
use crate::inputs::native::NativeFiles;
use crate::inputs::request::Request;
use crate::messages::console::Console;
use crate::messages::dock::time_text;
use crate::records::ENSEMBLE_RECORD;
use crate::tables::batch_results::RunSummary;
use crate::tables::report::counted;
use crate::tradeoff::choice::RunTarget;
use knotdock::ensemble::table::{DockedMember, joint};
use knotdock::output::files::added::Addition;
use knotdock::output::files::own_files::{ENSEMBLE, MEMBERS, is_run};
use knotdock::output::files::staging::{Stage, Staging};
use knotdock::output::run_folder::Clock;
use knotdock::output::tables::poses::PoseTable;
use knotdock::rank::cluster::RigidBody;
use knotdock_structures::Error;

/// Conformations of two molecules, each pair of which is docked.
pub struct Ensemble {
    pub(super) aligned: AlignedSides,
    pub(super) request: EnsembleRequest,
    pub(super) clock: Clock,
    pub(super) expected_seconds: f64,
}

/// How the pairs of an ensemble are docked, and into which directory.
pub struct EnsembleRequest {
    pub given: GivenOptions,
    pub native: Option<NativeFiles>,
    pub wanted: RunTarget,
    pub directory: PathBuf,
    pub force: bool,
}

/// The members of an ensemble after docking.
#[derive(Default)]
pub(super) struct DockedMembers {
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
    pub fn prepare(
        sides: &[Vec<Conformation>; 2],
        request: EnsembleRequest,
        clock: Clock,
        console: Console,
    ) -> Result<Self, Error> {
        if request.given.options.search.symmetry.is_some() {
            return Err(
                Error::input("--symmetry docks one conformation, and several are given")
                    .help("dock each conformation in its own run"),
            );
        }
        let aligned = AlignedSides::read(sides, &request.given.options)?;
        let mut ensemble = Self {
            aligned,
            request,
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
        let folder = self.request.directory.join(MEMBERS).join(self.name(member));
        self.docking(member, folder, console)
    }

    /// Plans a member's run into a folder.
    fn docking(&self, member: Member, folder: PathBuf, console: Console) -> Result<Docking, Error> {
        let EnsembleRequest {
            given,
            native,
            wanted,
            directory,
            force,
        } = &self.request;
        let specs = self.conformations(member).map(|one| one.spec.clone());
        let bodies = Bodies::of(specs, &given.options)?;
        let mut request = Request::of(bodies, native.clone(), given.clone());
        // Rows of all members are ordered together, and the ensemble's complexes are those that are looked at.
        request.options.ranking.exact = None;
        request.options.output.raw = true;
        let place = (folder, *force);
        let mut docking = Docking::prepare(request, *wanted, place, Clock::start(), console)?;
        docking.shown = directory.join(MEMBERS).join(self.name(member));
        Ok(docking)
    }

    /// Plans and describes the first member, then plans the largest; the seconds that all are expected to take.
    fn foresee(&self, console: Console) -> Result<f64, Error> {
        let first = self.planned(Member([0, 0]), console)?;
        let largest = Member(self.aligned.sides.each_ref().map(|side| largest(side)));
        let largest = self.planned(largest, console.silent())?;
        let bytes = first.memory_bytes().max(largest.memory_bytes());
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
        let record = !self.request.force && self.request.directory.join(ENSEMBLE_RECORD).exists();
        record.then_some(self.request.directory.as_path())
    }

    /// Whether the directory holds this very ensemble already.
    pub fn is_done(&self, console: Console) -> bool {
        let is_done = |member: Member| {
            let docking = self.planned(member, console.silent());
            docking.is_ok_and(|docking| docking.is_done())
        };
        let recorded = recorded_members(&self.request.directory.join(ENSEMBLE_RECORD));
        let members = self.members();
        let names: Vec<String> = members.iter().map(|&member| self.name(member)).collect();
        recorded == Some(names)
            && self.request.directory.join("poses.csv").is_file()
            && members.into_iter().all(is_done)
    }

    /// Docks the missing members, and writes the joint results; their JSON object.
    pub fn run(self, console: Console, notices: Console) -> Result<Value, Error> {
        let place = Place::open(&self.request.directory, self.request.force)?;
        notices.warn_leftovers(place.leftovers());
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
        let ranking = &self.request.given.options.ranking;
        let (radius, no_cluster) = (ranking.cluster_radius, ranking.no_cluster);
        let body = RigidBody::new(&self.aligned.points);
        let joint = joint(&docked.members, &body, radius, no_cluster)?;
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

/// Names in the directory of an unfinished ensemble.
const UNFINISHED: [&str; 6] = [
    MEMBERS,
    "poses.csv",
    "top",
    "view.pml",
    "view.cxc",
    "report.html",
];

/// The place that an ensemble is written to.
pub(super) enum Place {
    /// In its directory.
    New(PathBuf, Box<Addition>),
    /// Beside it.
    Replacing(Box<Staging>),
}

impl Place {
    /// The place of an ensemble in a directory: beside it if it holds another run and `force` is true.
    pub fn open(directory: &Path, force: bool) -> Result<Self, Error> {
        let is_unfinished = match std::fs::read_dir(directory) {
            Ok(entries) => entries.flatten().all(|entry| {
                let name = entry.file_name();
                UNFINISHED.iter().any(|part| name == *part)
            }),
            Err(_) => true,
        };
        if is_unfinished && !is_run(directory) {
            let addition = Addition::open(directory, Some(directory))?;
            return Ok(Self::New(directory.to_owned(), Box::new(addition)));
        }
        let staging = Staging::open(ENSEMBLE, directory, force)?;
        Ok(Self::Replacing(Box::new(staging)))
    }

    pub fn leftovers(&self) -> &[PathBuf] {
        match self {
            Self::New(_, addition) => &addition.leftovers,
            Self::Replacing(staging) => &staging.leftovers,
        }
    }

    pub fn member(&self, name: &str) -> PathBuf {
        let folder = match self {
            Self::New(directory, _) => directory,
            Self::Replacing(staging) => staging.stage().folder(),
        };
        folder.join(MEMBERS).join(name)
    }

    pub fn stage(&self) -> &Stage {
        match self {
            Self::New(_, addition) => addition.stage(),
            Self::Replacing(staging) => staging.stage(),
        }
    }

    /// Puts the joint files into their place.
    pub fn commit(self) -> Result<(), Error> {
        match self {
            Self::New(_, addition) => addition.place(false)?,
            Self::Replacing(staging) => staging.commit()?,
        }
        Ok(())
    }
}
