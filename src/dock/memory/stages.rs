//! Memory of a run by stage: one formula each, of the sizes of the stage's results, so that the plan follows the code.
//!
//! A stage begins with the memory of the process when the run was planned: the program, the inputs and all made of them.

use crate::dock::memory::process;
use crate::dock::scene::{LengthUnit, Scene};
use crate::options::{DockOptions, EngineChoice};
use crate::pose_space::PoseSpace;
use crate::pose_space::refine::RefinedPose;
use crate::pose_space::rotations::RotationGroup;
use crate::rank::candidates::Candidate;
use crate::rank::cluster::ClusterFigures;
use crate::rank::ranking::RankedPose;
use knotdock_scoring::engine::{EngineMemory, Plan};
use knotdock_scoring::peaks::Peak;
use knotdock_scoring::potential_grid::PotentialGrid;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::so3::{BYTES_RELAXED, MAX_RELAXED};
use nalgebra::UnitQuaternion;
use std::sync::OnceLock;

/// Components of the compressed lifted axis that a plan allows for: 7 to 9 in measured runs with all effects on, for
/// tolerances from 1e-2 to 1e-6.
pub(super) const EXPECTED_RANK: usize = 10;

/// Bytes that the process takes before it reads anything, if the system does not say.
const PROGRAM: u64 = 16 << 20;
/// Bytes of an atom as read, if the system does not say.
const ATOM_READ: u64 = 1 << 10;
/// Bytes of the program's code and tables that are first used after planning.
const CODE: u64 = 4 << 20;
/// Bytes of a ball in the exact score.
const BALL_SCORED: u64 = 1 << 8;
/// Bytes of an atom in the pose terms, and of their tables.
const ATOM_SCORED: u64 = 640;
const TERM_TABLES: u64 = 2 << 20;
/// Bytes of an atom in each complex that is being written, with its line.
const ATOM_WRITTEN: u64 = 1 << 8;
/// Bytes of a peak.
const PEAK: u64 = size_of::<Peak>() as u64;
/// Bytes of a pose when its table is made, which is when it takes the most. They are those of a candidate, of its
/// cluster (which one, whether it is distinct, and size, weight, centre and place of each cluster, its poses and its
/// figures), and of a row. Sorting rows takes half again.
const RANKED: u64 = (size_of::<Candidate>()
    + 13 * size_of::<usize>()
    + size_of::<ClusterFigures>()
    + (size_of::<RankedPose>() + size_of::<usize>()) * 3 / 2) as u64;
/// Bytes of a pose while it is rescored, when each candidate is there twice, and as a row with its quality.
const RESCORED: u64 = PEAK
    + (size_of::<RefinedPose>() + size_of::<Candidate>() + size_of::<OnceLock<Candidate>>()) as u64;
const WRITTEN: u64 = (size_of::<RankedPose>() + size_of::<(usize, Pose)>()) as u64 + 384;
const _: () = assert!(RANKED >= RESCORED && RANKED >= WRITTEN);
/// Bytes of a thread: its stack, and buffers that its allocator keeps.
const THREAD: u64 = 1 << 20;
/// One part of this many of a stage's memory is lost between buffers: 6% to 19% as measured on one thread.
const ALLOCATOR: u64 = 6;

/// Sizes that decide the memory of a run. All but `held` and `read` follow from the inputs and options.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sizes {
    /// What the process holds when the run is planned.
    held: u64,
    /// The most that reading and sampling took.
    read: u64,
    engine: EngineMemory,
    /// Components that the engine is expected to have.
    rank: usize,
    potential_grid: u64,
    atoms: u64,
    /// Complexes that are written at once.
    written: u64,
    /// Whether atoms are scored by pose terms.
    is_of_molecules: bool,
    /// Rotations of the set, and of the finer one.
    rotations: [u64; 2],
    /// Rotations of a group.
    images: u64,
    /// Rotations of the finer set that are searched.
    searched_finer: u64,
    per_rotation: u64,
    /// Poses that are kept.
    poses: u64,
    /// Whether poses are refined.
    is_refined: bool,
    /// Whether a graphics processor searches.
    is_on_card: bool,
}

/// Peaks that come back from a card together, and bytes of each on their way.
const PEAKS_OF_CARD: u64 = crate::search::scan::TOGETHER as u64;
const FOUND_ON_CARD: u64 = 56;

/// The stage of the most bytes.
fn largest<const N: usize>(stages: [(&'static str, u64); N]) -> (&'static str, u64) {
    let larger = |a: (&'static str, u64), b: (&'static str, u64)| if b.1 > a.1 { b } else { a };
    stages.into_iter().fold(("", 0), larger)
}

impl Sizes {
    /// The sizes of a run of `engine`, of which `refined` poses are refined.
    pub fn new(
        scene: &Scene,
        engine: &Plan,
        options: &DockOptions,
        (space, refined): (&PoseSpace, usize),
    ) -> Self {
        let ligand = &scene.ligand;
        let sizes = EngineMemory::new(engine, ligand, options.search.precision.into());
        let atoms = (scene.receptor.len() + ligand.len()) as u64;
        let held = process::held().unwrap_or(PROGRAM + ATOM_READ * atoms);
        let search = &options.search;
        let finer = search.fine_rotations.unwrap_or(0) as u64;
        let per_rotation = search.per_rotation as u64;
        let rotations = search.rotations as u64;
        Self {
            held,
            read: process::peak_of_run().unwrap_or(held).max(held),
            rank: sizes.without(None).rank.clamp(1, EXPECTED_RANK),
            potential_grid: if refined > 0 {
                PotentialGrid::bytes(engine, ligand) as u64
            } else {
                0
            },
            engine: sizes,
            atoms,
            written: options.machine.thread_count().min(options.output.write_top) as u64,
            is_of_molecules: scene.unit == LengthUnit::Angstrom,
            rotations: [rotations, finer],
            images: space.images(engine) as u64,
            searched_finer: (search.fine_share * finer as f64).ceil() as u64,
            per_rotation,
            poses: (search.poses as u64).min((rotations + finer) * per_rotation),
            is_refined: refined > 0,
            is_on_card: search.engine == EngineChoice::Gpu,
        }
    }

    /// Bytes of a rotation in flight at the expected rank: its workspace, and the peaks of its thread.
    pub fn expected_in_flight(&self) -> u64 {
        self.in_flight(self.rank)
    }

    /// Bytes of the largest stage without rotations in flight, and without those held before.
    pub fn fixed(&self) -> u64 {
        largest(self.stages(0)).1.saturating_sub(self.held)
    }

    /// Bytes of the largest stage.
    pub fn peak(&self, rotations: usize) -> u64 {
        self.largest(rotations).1
    }

    /// The run's largest stage, and its bytes.
    pub fn largest(&self, rotations: usize) -> (&'static str, u64) {
        largest([("read", self.read), largest(self.stages(rotations))])
    }

    /// Bytes of the search with this number of rotations in flight, at a known rank.
    pub fn search_peak(&self, rotations: usize, rank: usize) -> u64 {
        self.whole(self.search(rotations as u64, rank))
    }

    /// Bytes of a stage with its own and those held before it.
    fn whole(&self, own: u64) -> u64 {
        let rotations =
            size_of::<UnitQuaternion<f64>>() as u64 * self.rotations.iter().sum::<u64>();
        self.held + CODE + rotations + own + own / ALLOCATOR
    }

    /// The stages after reading.
    fn stages(&self, rotations: usize) -> [(&'static str, u64); 6] {
        let (rotations, rank) = (rotations as u64, self.rank);
        let threads = THREAD * rotations;
        let relaxed = |count: u64| BYTES_RELAXED * count.min(MAX_RELAXED as u64);
        let [coarse, finer] = self.rotations;
        let engine = &self.engine;
        let whole = engine.choice(engine.without(None).rank);
        let transforms = rotations.max(1) * engine.transform;
        // The finer search keeps all peaks, and those of the first one in cells.
        let peaks = 2 * (self.searched_finer + self.images) * self.per_rotation
            + 2 * self.scanned()
            + coarse * self.per_rotation;
        let groups = size_of::<RotationGroup>() as u64 * finer.div_ceil(self.images) + 8 * finer;
        let fine = self.kept_spectra()
            + rank as u64 * engine.component
            + self.on_cores(rotations) * (self.workspace(rank) + THREAD)
            + PEAK * peaks
            + groups;
        let refined = PEAK + size_of::<RefinedPose>() as u64 + size_of::<Pose>() as u64;
        [
            ("plan", relaxed(coarse).max(relaxed(finer))),
            (
                "prepare",
                self.spectra() + whole.max(transforms) + self.scorers() + threads,
            ),
            ("search", self.search(rotations, rank)),
            ("fine", if finer > 0 { fine + self.scorers() } else { 0 }),
            (
                "refine",
                self.kept_spectra()
                    + self.potential_grid
                    + refined * self.poses
                    + self.scorers()
                    + threads,
            ),
            (
                "rank",
                RANKED * self.poses
                    + ATOM_WRITTEN * self.atoms * self.written
                    + self.scorers()
                    + threads,
            ),
        ]
        .map(|(stage, own)| (stage, self.whole(own)))
    }

    /// Of a number of rotations, those in flight on the cores: where a graphics processor searches, one.
    fn on_cores(&self, rotations: u64) -> u64 {
        if self.is_on_card {
            rotations.min(1)
        } else {
            rotations
        }
    }

    fn search(&self, rotations: u64, rank: usize) -> u64 {
        let rotations = self.on_cores(rotations);
        let found = match self.is_on_card {
            true => {
                FOUND_ON_CARD * PEAKS_OF_CARD.min(self.images * self.groups() * self.per_rotation)
            }
            false => 0,
        };
        let groups = size_of::<RotationGroup>() as u64 * self.groups();
        let lists = 2 * rotations * self.scanned() * PEAK;
        self.kept_spectra()
            + rank as u64 * self.engine.component
            + rotations * self.in_flight(rank)
            + self.scorers()
            + lists
            + found
            + groups
    }

    fn in_flight(&self, rank: usize) -> u64 {
        let peaks = 2 * self.scanned() + self.per_rotation;
        self.workspace(rank) + PEAK * peaks + THREAD
    }

    /// Bytes of a workspace for all images of a rotation.
    fn workspace(&self, rank: usize) -> u64 {
        self.engine.workspace_of(rank, self.images as usize)
    }

    /// Peaks that the first search keeps.
    fn scanned(&self) -> u64 {
        self.poses
            .min(self.images * self.groups() * self.per_rotation)
    }

    /// Groups of the first search.
    fn groups(&self) -> u64 {
        self.rotations[0].div_ceil(self.images)
    }

    /// The exact score and the pose terms.
    fn scorers(&self) -> u64 {
        let terms = if self.is_of_molecules {
            TERM_TABLES + ATOM_SCORED * self.atoms
        } else {
            0
        };
        terms + BALL_SCORED * self.atoms
    }

    /// The receptor's spectra, while they are needed.
    fn spectra(&self) -> u64 {
        self.engine.spectrum * self.engine.without(None).functions as u64
    }

    /// Spectra that are kept for refining.
    fn kept_spectra(&self) -> u64 {
        if self.is_refined { self.spectra() } else { 0 }
    }
}
