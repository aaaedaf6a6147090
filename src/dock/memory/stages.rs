//! Memory of a run by stage: what is held at once in each, in named parts.
//!
//! A stage begins with what the process held when the run was planned: the program, the inputs and what was made of
//! them. Each part is computed from the sizes of what the stage makes, so that the plan follows the code.

use crate::dock::memory::process;
use crate::dock::scene::{LengthUnit, Scene};
use crate::options::DockOptions;
use crate::pose_space::PoseSpace;
use crate::pose_space::refine::RefinedPose;
use crate::pose_space::rotations::RotationGroup;
use crate::rank::candidates::Candidate;
use crate::rank::cluster::PlacedBody;
use crate::rank::ranking::RankedPose;
use knotdock_scoring::engine::{EngineMemory, Plan};
use knotdock_scoring::peaks::Peak;
use knotdock_scoring::potential_grid::PotentialGrid;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::so3::{BYTES_RELAXED, MAX_RELAXED};
use nalgebra::UnitQuaternion;
use serde::Serialize;

/// Components of the compressed lifted axis that a plan allows for: 7 to 9 in measured runs with all effects on, for
/// tolerances from 1e-2 to 1e-6.
pub(super) const EXPECTED_RANK: usize = 10;

/// Bytes that the process takes before it reads anything, where the system does not say.
const PROGRAM: u64 = 16 << 20;
/// Bytes of an atom as read, where the system does not say.
const ATOM_READ: u64 = 1 << 10;
/// Bytes of the program's code and tables that are first used after planning.
const CODE: u64 = 3 << 20;
/// Bytes of a ball in the exact score.
const BALL_SCORED: u64 = 1 << 8;
/// Bytes of an atom in the pose terms, and of their tables.
const ATOM_SCORED: u64 = 640;
const TERM_TABLES: u64 = 2 << 20;
/// Bytes of an atom in a complex that is being written, with its line.
const ATOM_WRITTEN: u64 = 1 << 8;
/// Bytes of a row's values against a known complex.
const QUALITY: u64 = 384;
/// Bytes of a thread: its stack, and buffers that its allocator keeps.
const THREAD: u64 = 1 << 20;
/// One part in so many of a stage's memory is lost between buffers: measured, 6% to 19% of what is alive on one thread.
const ALLOCATOR: u64 = 6;

/// A part of the memory of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct MemoryPart {
    /// What takes it.
    pub name: &'static str,
    /// Bytes.
    pub bytes: u64,
}

/// A stage of a run with the memory that it takes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MemoryStage {
    /// Name of the stage, as `timing` in run.json has it where it is one of these.
    pub stage: &'static str,
    /// What is held in it at once.
    pub parts: Vec<MemoryPart>,
}

impl MemoryStage {
    /// Bytes of the whole stage.
    pub fn bytes(&self) -> u64 {
        self.parts.iter().map(|part| part.bytes).sum()
    }
}

/// Sizes that decide what a run takes. All but `held` and `read` follow from the inputs and options.
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
            is_of_molecules: scene.unit == LengthUnit::Angstrom,
            rotations: [rotations, finer],
            images: space.images(engine) as u64,
            searched_finer: (search.fine_share * finer as f64).ceil() as u64,
            per_rotation,
            poses: (search.poses as u64).min((rotations + finer) * per_rotation),
            is_refined: refined > 0,
        }
    }

    /// Bytes of a rotation in flight at a rank: its workspace, and the peaks of its thread.
    pub fn in_flight(&self, rank: usize) -> u64 {
        let peaks = 2 * self.scanned() + self.per_rotation;
        self.workspace(rank) + size_of::<Peak>() as u64 * peaks + THREAD
    }

    /// Bytes of a workspace for all images of a rotation.
    fn workspace(&self, rank: usize) -> u64 {
        self.engine.workspace_of(rank, self.images as usize)
    }

    /// Bytes of a rotation in flight at the expected rank.
    pub fn expected_in_flight(&self) -> u64 {
        self.in_flight(self.rank)
    }

    /// Bytes of the largest stage without rotations in flight, and without what was held before.
    pub fn fixed(&self) -> u64 {
        let stages = self.stages(0, self.rank);
        let own = stages
            .iter()
            .map(|stage| stage.bytes().saturating_sub(self.held));
        // Reading is the first stage, and not the plan's.
        own.skip(1).max().unwrap_or(0)
    }

    /// Bytes of the run's largest stage.
    pub fn peak(&self, rotations: usize) -> u64 {
        let stages = self.stages(rotations, self.rank);
        stages.iter().map(MemoryStage::bytes).max().unwrap_or(0)
    }

    /// The run's largest stage.
    pub fn largest(&self, rotations: usize) -> Option<MemoryStage> {
        let stages = self.stages(rotations, self.rank).into_iter();
        stages.max_by_key(MemoryStage::bytes)
    }

    /// Bytes of the search with so many rotations in flight, at a rank that is known.
    pub fn search_peak(&self, rotations: usize, rank: usize) -> u64 {
        self.search(rotations, rank).bytes()
    }

    /// All stages in their order, with an engine of a rank.
    fn stages(&self, rotations: usize, rank: usize) -> Vec<MemoryStage> {
        let mut stages = vec![
            MemoryStage {
                stage: "read",
                parts: vec![MemoryPart {
                    name: "inputs",
                    bytes: self.read,
                }],
            },
            self.plan(),
            self.prepare(rotations),
            self.search(rotations, rank),
        ];
        if self.rotations[1] > 0 {
            stages.push(self.fine(rotations, rank));
        }
        stages.extend([
            self.refine(rotations),
            self.rescore(rotations),
            self.cluster(rotations),
            self.score(rotations),
            self.write(),
        ]);
        stages
    }

    /// A stage of parts beside what was held before.
    fn stage(&self, stage: &'static str, own: &[(&'static str, u64)]) -> MemoryStage {
        let bytes = own.iter().map(|(_, bytes)| bytes).sum::<u64>();
        let rotations =
            size_of::<UnitQuaternion<f64>>() as u64 * self.rotations.iter().sum::<u64>();
        let common = [
            ("held before", self.held),
            ("code", CODE),
            ("rotations", rotations),
            ("allocator", bytes / ALLOCATOR),
        ];
        let parts = common.iter().chain(own).filter(|(_, bytes)| *bytes > 0);
        MemoryStage {
            stage,
            parts: parts
                .map(|&(name, bytes)| MemoryPart { name, bytes })
                .collect(),
        }
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

    fn threads(&self, rotations: usize) -> u64 {
        THREAD * rotations as u64
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

    fn plan(&self) -> MemoryStage {
        let relaxed = |count: &u64| BYTES_RELAXED * (*count).min(MAX_RELAXED as u64);
        let relaxing = self.rotations.iter().map(relaxed).max().unwrap_or(0);
        self.stage("plan", &[("relaxing rotations", relaxing)])
    }

    /// The receptor is transformed and the rank chosen.
    fn prepare(&self, rotations: usize) -> MemoryStage {
        let engine = &self.engine;
        let whole = engine.choice(engine.without(None).rank);
        let transforms = rotations.max(1) as u64 * engine.transform;
        self.stage(
            "prepare",
            &[
                ("spectra", self.spectra()),
                ("engines", whole.max(transforms)),
                ("scorers", self.scorers()),
                ("threads", self.threads(rotations)),
            ],
        )
    }

    fn search(&self, rotations: usize, rank: usize) -> MemoryStage {
        let peak = size_of::<Peak>() as u64;
        let groups = size_of::<RotationGroup>() as u64 * self.groups();
        let lists = 2 * rotations as u64 * self.scanned() * peak;
        self.stage(
            "search",
            &[
                ("spectra", if self.is_refined { self.spectra() } else { 0 }),
                ("engines", self.engines(rank)),
                (
                    "rotations in flight",
                    rotations as u64 * self.in_flight(rank),
                ),
                ("scorers", self.scorers()),
                ("peaks", lists + groups),
            ],
        )
    }

    fn engines(&self, rank: usize) -> u64 {
        rank as u64 * self.engine.component
    }

    /// The finer search keeps all peaks.
    fn fine(&self, rotations: usize, rank: usize) -> MemoryStage {
        let peak = size_of::<Peak>() as u64;
        let [coarse, finer] = self.rotations;
        let found = (self.searched_finer + self.images) * self.per_rotation;
        let cells = coarse * self.per_rotation;
        let groups = size_of::<RotationGroup>() as u64 * finer.div_ceil(self.images);
        let in_flight = self.workspace(rank) + THREAD;
        self.stage(
            "fine",
            &[
                ("spectra", if self.is_refined { self.spectra() } else { 0 }),
                ("engines", self.engines(rank)),
                ("rotations in flight", rotations as u64 * in_flight),
                ("scorers", self.scorers()),
                (
                    "peaks",
                    peak * (2 * found + 2 * self.scanned() + cells) + groups + 8 * finer,
                ),
            ],
        )
    }

    /// Peaks and where they led to.
    fn placed(&self) -> u64 {
        (size_of::<Peak>() + size_of::<RefinedPose>()) as u64 * self.poses
    }

    fn refine(&self, rotations: usize) -> MemoryStage {
        let grid_poses = size_of::<Pose>() as u64 * self.poses;
        self.stage(
            "refine",
            &[
                ("spectra", if self.is_refined { self.spectra() } else { 0 }),
                ("potential grid", self.potential_grid),
                ("poses", self.placed() + grid_poses),
                ("scorers", self.scorers()),
                ("threads", self.threads(rotations)),
            ],
        )
    }

    /// Bytes of all candidates.
    fn candidates(&self) -> u64 {
        size_of::<Candidate>() as u64 * self.poses
    }

    fn rescore(&self, rotations: usize) -> MemoryStage {
        self.stage(
            "rescore",
            &[
                ("poses", self.placed()),
                // Sorting takes half of them again.
                ("candidates", self.candidates() * 3 / 2),
                ("scorers", self.scorers()),
                ("threads", self.threads(rotations)),
            ],
        )
    }

    fn cluster(&self, rotations: usize) -> MemoryStage {
        let body = size_of::<Pose>() + size_of::<PlacedBody>() + 2 * size_of::<usize>();
        self.stage(
            "cluster",
            &[
                ("candidates", self.candidates()),
                ("clusters", body as u64 * self.poses),
                ("scorers", self.scorers()),
                ("threads", self.threads(rotations)),
            ],
        )
    }

    fn score(&self, rotations: usize) -> MemoryStage {
        // Cluster of each pose, whether it is distinct, and of each cluster size, weight, centre and place.
        let clusters = 10 * size_of::<usize>() as u64 * self.poses;
        let row = (size_of::<RankedPose>() + size_of::<usize>()) as u64;
        self.stage(
            "score",
            &[
                ("candidates", self.candidates()),
                ("clusters", clusters),
                // Sorting takes half of them again.
                ("rows", row * self.poses * 3 / 2),
                ("scorers", self.scorers()),
                ("threads", self.threads(rotations)),
            ],
        )
    }

    fn write(&self) -> MemoryStage {
        let row = (size_of::<RankedPose>() + size_of::<(usize, Pose)>()) as u64 + QUALITY;
        self.stage(
            "write",
            &[
                ("rows", row * self.poses),
                ("complexes", ATOM_WRITTEN * self.atoms),
                // The allocator may keep what the scores took.
                ("scorers", self.scorers()),
            ],
        )
    }
}
