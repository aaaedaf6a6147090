//! Memory of an engine's parts in bytes, from its plan: known before any of them is made.

use super::cpu::{COLUMNS, SIDE, TOGETHER, ligand_forward, slab_length};
use super::packed::{LANES, Packing};
use super::plan::Plan;
use super::receptor_spectra::LigandFunctions;
use crate::precision::Precision;
use crate::terms::effect::{ActiveTerm, Effect, Term, classes};
use crate::transform::Real;
use knotdock_structures::Knots;
use nalgebra::DMatrix;

/// Singular values of a class matrix below this share of the largest carry nothing.
const NEGLIGIBLE: f64 = 1e-9;

/// Bytes of an engine's parts. Spectra, engines and workspaces are linear in the functions or the rank.
#[derive(Clone, Debug, PartialEq)]
pub struct EngineMemory {
    /// The receptor's spectrum of one function.
    pub spectrum: u64,
    /// One component of an engine: the receptor's part, packed, and the ligand's weights.
    pub component: u64,
    /// A workspace of one image without components.
    pub workspace: u64,
    /// Each further image of a workspace.
    pub workspace_image: u64,
    /// One component of a workspace.
    pub workspace_component: u64,
    /// The choice of a rank, without engines and their workspace: places of the voxels, multiplicities of the modes.
    pub probing: u64,
    /// The receptor's transform, without its spectra, on one thread.
    pub transform: u64,
    /// Functions of each effect that is on, and the most components that they can have.
    pub effects: Vec<(Effect, EffectSize)>,
}

/// Size of an effect in the compressed functions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EffectSize {
    /// Functions of the ligand.
    pub functions: usize,
    /// Most components: the rank of the matrix that couples them with the receptor.
    pub rank: usize,
}

impl EngineMemory {
    /// The memory of a plan's engine.
    pub fn new(plan: &Plan, ligand: &Knots, precision: Precision) -> Self {
        match precision {
            Precision::Single => Self::of::<f32>(plan, ligand),
            Precision::Double => Self::of::<f64>(plan, ligand),
        }
    }

    fn of<T: Real>(plan: &Plan, ligand: &Knots) -> Self {
        let real = size_of::<T>() as u64;
        let modes = plan.modes().count as u64;
        let voxels = plan.modes().size.iter().product::<usize>() as u64;
        let packed = (LANES * Packing::new(plan.modes()).count()) as u64;
        let [one, two] = [1, 2].map(|rank| workspace_bytes::<T>(plan, ligand, rank, 1));
        let two_images = workspace_bytes::<T>(plan, ligand, 1, 2);
        Self {
            spectrum: 2 * real * modes,
            component: real * (2 * packed + ligand.len() as u64),
            workspace: one.saturating_sub(two - one),
            workspace_image: two_images - one,
            workspace_component: two - one,
            probing: size_of::<u32>() as u64 * voxels + size_of::<f64>() as u64 * modes,
            transform: 2 * real * modes + ligand_forward::<T>(plan, 1).workspace_bytes() as u64,
            effects: effect_sizes(plan, ligand),
        }
    }

    /// Functions and components of all effects but one.
    pub fn without(&self, left_out: Option<Effect>) -> EffectSize {
        let effects = self.effects.iter();
        let kept = effects.filter(|(effect, _)| Some(*effect) != left_out);
        kept.fold(EffectSize::default(), |sum, (_, size)| EffectSize {
            functions: sum.functions + size.functions,
            rank: sum.rank + size.rank,
        })
    }

    /// Functions and components of one effect.
    pub fn only(&self, effect: Effect) -> EffectSize {
        let found = self.effects.iter().find(|(other, _)| *other == effect);
        found.map(|(_, size)| *size).unwrap_or_default()
    }

    /// A workspace of one image at a rank.
    pub fn workspace_at(&self, rank: usize) -> u64 {
        self.workspace + rank as u64 * self.workspace_component
    }

    /// A workspace of a number of images, as many of them together as possible.
    pub fn workspace_of(&self, rank: usize, images: usize) -> u64 {
        let further = images.clamp(1, TOGETHER) as u64 - 1;
        self.workspace_at(rank) + further * self.workspace_image
    }

    /// The choice of a rank of at most `rank`: the whole engine, with its workspace or with an engine of half the rank.
    pub fn choice(&self, rank: usize) -> u64 {
        let half = rank.div_ceil(2);
        let probing = self.probing + self.workspace_at(rank);
        let halving = half as u64 * self.component + self.workspace_at(half);
        rank as u64 * self.component + probing.max(halving)
    }
}

/// Bytes of a workspace at a rank.
fn workspace_bytes<T: Real>(plan: &Plan, ligand: &Knots, rank: usize, images: usize) -> u64 {
    let [nx, ny, nz] = plan.modes().size;
    let forward = ligand_forward::<T>(plan, rank);
    let of_image = 2 * 2 * SIDE * nx + 2 * nx * slab_length(plan.modes());
    let of_slab = 2 * plan.modes().planes.len() * ny + ny * nz;
    let reals = 2 * (COLUMNS * forward.line_length() + 2 * LANES)
        + 2 * rank * LANES * Packing::new(plan.modes()).count()
        + 4 * (nx / 2).next_multiple_of(LANES)
        + images * of_image
        + of_slab
        + nx * ny * (nz + 1);
    let points = size_of::<[f64; 3]>() * ligand.len();
    (forward.workspace_bytes() + reals * size_of::<T>() + points) as u64
}

/// Size of each effect of a plan.
fn effect_sizes(plan: &Plan, ligand: &Knots) -> Vec<(Effect, EffectSize)> {
    let functions = LigandFunctions::of_score(plan, ligand).effects;
    let count = |wanted: Effect| functions.iter().filter(|effect| **effect == wanted).count();
    let size = |effect, rank: usize| {
        let functions = count(effect);
        let rank = rank.min(functions);
        (effect, EffectSize { functions, rank })
    };
    let shape = size(Effect::Shape, usize::MAX);
    let others = plan.effects().iter();
    let others = others.map(|ActiveTerm { term, .. }| size(term.effect, matrix_rank(term)));
    std::iter::once(shape).chain(others).collect()
}

/// Rank of a term's class matrix over the classes that there are.
fn matrix_rank(term: &Term) -> usize {
    let of = |labels| classes(labels).into_iter().collect::<Vec<usize>>();
    let (rows, columns) = (of(&term.receptor), of(&term.ligand));
    if rows.is_empty() || columns.is_empty() {
        return 0;
    }
    let value = |row: usize, column: usize| {
        let row = term.matrix.get(rows[row]);
        row.and_then(|row| row.get(columns[column]))
            .copied()
            .unwrap_or(0.0)
    };
    let singular = DMatrix::from_fn(rows.len(), columns.len(), value).singular_values();
    let least = NEGLIGIBLE * singular.max();
    singular.iter().filter(|value| **value > least).count()
}
