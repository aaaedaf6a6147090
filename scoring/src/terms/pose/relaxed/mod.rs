//! Pose term `relaxed`: energy of atom pairs with a penalty on overlap, after a small rigid move that lowers it.
//!
//! Unbound surfaces overlap at some places of a grid pose and leave gaps at others, in native poses too. So an energy
//! that penalises overlap says little about the pose itself. It says more about one half an Ångström beside it.
//! [`Relaxation`] finds that pose by a few damped Gauss-Newton steps. Rigid-body minimisation does the same before
//! force fields rank poses (Li, Chen & Weng, Proteins 53 (2003) 693-707).
//!
//! The score is continuous in the atoms and the pose: noise changes it in proportion. Receptor and ligand may be
//! exchanged.

mod list;
#[cfg(test)]
mod tests;

pub use self::list::Workspace;
use self::list::{Atoms, Interface, Site};
use super::TermDefinition;
use super::atom_pair::{AtomPairPotential, EnergyTable, SMOOTH_REACH};
use crate::blocks::Blocks;
use crate::rigid_move::{Derivatives, Move, center, heavy_atoms};
use crate::se3::Pose;
use crate::vectorized::with_simd;
use knotdock_structures::Knots;
use nalgebra::{Matrix3, Vector3, Vector6};
use pulp::Simd;

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "relaxed",
    label: "atom pairs once relaxed",
    unit: "score per RT",
    time_share: 1.0,
    is_shown_always: true,
    reads: "atoms with kinds",
    count: |inputs| inputs.atoms_with_kinds(),
    applies: |inputs| inputs.has_atom_kinds(),
    build: |inputs, weight| {
        let [receptor, ligand] = inputs.bodies;
        let potential = inputs.atom_pair_potential.cloned().unwrap_or_default();
        let term = Relaxation::new(receptor, ligand, &potential, weight);
        Box::new(move |pose, workspace| term.score(pose, workspace))
    },
};

/// Depth in Å by which two atoms may overlap at no cost.
const OVERLAP: f64 = 0.1;
/// Stiffness of further overlap, RT per Å². It is soft, because atoms of unbound surfaces are in the way of the other
/// body's.
const STIFFNESS: f64 = 0.8;
/// Stiffness during the descent. It is softer still, so that single overlaps do not hold back the whole interface.
const SOFT_CORE_STIFFNESS: f64 = 0.2;
/// Overlap in Å from which a pair adds its whole stiffness to the curvature that a step reads.
const FULL_STIFFNESS: f64 = 0.5;
/// Two bodies prepared for relaxing poses.
///
/// The energy of a pose in RT is a sum over pairs of atoms at distance d, of radii r and kinds a and b:
///
/// `E = sum of E_ab(d) + 0.8 RT/Å² max(0, r_a + r_b - 0.1 Å - d)²`
///
/// E_ab is the atom pair potential as the term `atom_pair` reads it; atoms without a kind only repel. The pose
/// descends by less than 2 Å on a smooth energy of a quarter of that stiffness, to E(end). Its score is
/// `-weight min(E(start), E(end))`.
pub(super) struct Relaxation {
    atoms: Atoms,
    energies: EnergyTable,
    weight: f64,
}

/// A relaxed pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Relaxed {
    /// The pose after the descent, or the original one if that is no worse.
    pub pose: Pose,
    /// Its energy in RT; lower is better.
    pub energy: f64,
}

impl Relaxation {
    /// Prepares two sets of knots with atom kinds. `weight` is in score per RT.
    pub fn new(
        receptor: &Knots,
        ligand: &Knots,
        potential: &AtomPairPotential,
        weight: f64,
    ) -> Self {
        let energies = EnergyTable::new(potential);
        let (receptor_center, ligand_center) = (center(receptor), center(ligand));
        let bodies = [(receptor, receptor_center), (ligand, ligand_center)];
        let [receptor, ligand] =
            bodies.map(|(knots, middle)| sites(knots, middle, energies.unknown()));
        let widest = |body: &[(Vector3<f64>, Site)]| {
            let radii = body.iter().map(|(_, site)| site.radius);
            radii.fold(0.0, f64::max)
        };
        let positions: Vec<Vector3<f64>> = receptor.iter().map(|(position, _)| *position).collect();
        let blocks = Blocks::new(&positions);
        let atoms = Atoms {
            sites: blocks.arranged(|index| receptor[index].1),
            receptor: blocks,
            receptor_center,
            reach: SMOOTH_REACH.max(widest(&receptor) + widest(&ligand)),
            ligand,
            ligand_center,
        };
        Self {
            atoms,
            energies,
            weight,
        }
    }

    /// Minus the weight times the energy of the relaxed pose; higher is better.
    pub fn score(&self, pose: &Pose, workspace: &mut Workspace) -> f64 {
        -self.weight * self.relax(pose, workspace).energy
    }

    /// Energy of a pose without a move in RT.
    #[cfg(test)]
    pub fn energy(&self, pose: &Pose) -> f64 {
        let (start, none) = (self.atoms.start(pose), Move::default());
        let mut workspace = Workspace::default();
        self.atoms
            .collect(&start, &Vector3::zeros(), &none, &mut workspace);
        self.collected_energy(&mut workspace, &none)
    }

    /// Relaxed pose with its energy, which is never above that of `pose`.
    pub fn relax(&self, pose: &Pose, workspace: &mut Workspace) -> Relaxed {
        let (start, none) = (self.atoms.start(pose), Move::default());
        self.atoms
            .collect(&start, &Vector3::zeros(), &none, workspace);
        let Some(Interface { middle, radius }) = self.atoms.interface(workspace) else {
            return Relaxed {
                pose: *pose,
                energy: 0.0,
            };
        };
        let widest = self.atoms.widest(&start, &middle);
        let before = self.collected_energy(workspace, &none);
        let (mut at, mut collected) = (none, none);
        for longest in MAX_STEPS {
            at = self.slope(workspace, &at).step(&at, radius, longest);
            self.atoms
                .renew(&mut collected, &at, widest, &start, workspace);
        }
        let after = self.collected_energy(workspace, &at);
        if after < before {
            Relaxed {
                pose: self.atoms.moved(pose, &at, &middle),
                energy: after,
            }
        } else {
            Relaxed {
                pose: *pose,
                energy: before,
            }
        }
    }

    /// Energy of a move in RT.
    fn collected_energy(&self, workspace: &mut Workspace, at: &Move) -> f64 {
        self.sum(
            workspace,
            at,
            #[inline(always)]
            |receptor, ligand, square| self.pair(receptor, ligand, square.sqrt()),
        )
    }

    /// Sum at a move of a value of the two atoms and the square of their distance (Å²), which must be
    /// `#[inline(always)]`.
    fn sum(
        &self,
        workspace: &mut Workspace,
        at: &Move,
        value: impl Fn(&Site, &Site, f64) -> f64,
    ) -> f64 {
        let atoms = &self.atoms;
        with_simd!(
            <'a, F: Fn(&Site, &Site, f64) -> f64>(
                atoms: &'a Atoms, workspace: &'a mut Workspace, at: &'a Move, value: F
            ) -> f64,
            |simd| {
                let mut total = 0.0;
                atoms.visit(
                    simd,
                    workspace,
                    at,
                    #[inline(always)]
                    || 0.0,
                    #[inline(always)]
                    |sum, atom, pair| *sum += value(pair.receptor, &atom.site, pair.square),
                    #[inline(always)]
                    |sum, _| total += sum,
                );
                total
            }
        )
    }

    /// Slope of the energy of the descent at a move.
    fn slope(&self, workspace: &mut Workspace, at: &Move) -> Slope {
        let relaxation = self;
        with_simd!(
            <'a>(relaxation: &'a Relaxation, workspace: &'a mut Workspace, at: &'a Move) -> Slope,
            |simd| relaxation.slope_with(simd, workspace, at)
        )
    }

    #[inline(always)]
    fn slope_with<S: Simd>(&self, simd: S, workspace: &mut Workspace, at: &Move) -> Slope {
        let atoms = &self.atoms;
        let mut slope = Slope::default();
        atoms.visit(
            simd,
            workspace,
            at,
            AtomSlope::default,
            #[inline(always)]
            |sums, atom, pair| {
                let Soft {
                    rise, stiffness, ..
                } = self.soft(pair.receptor, &atom.site, pair.square);
                sums.gradient += rise * pair.between;
                if stiffness > 0.0 {
                    sums.curvature += (stiffness * pair.between) * pair.between.transpose();
                }
                sums.contacts += atoms.contact(pair.square);
            },
            #[inline(always)]
            |sums, arm| {
                if sums.contacts > 0.0 {
                    slope.contacts += sums.contacts;
                    // Each body makes half of a rotation about the middle between their places.
                    slope.add(&(arm + 0.5 * at.shift), &sums.gradient, &sums.curvature);
                }
            },
        );
        slope
    }

    /// Energy of two atoms in RT at a distance.
    #[inline(always)]
    fn pair(&self, receptor: &Site, ligand: &Site, distance: f64) -> f64 {
        let (energy, _) = self.energies.at(receptor.kind, ligand.kind, distance);
        let lack = (receptor.radius + ligand.radius - OVERLAP - distance).max(0.0);
        energy + STIFFNESS * lack * lack
    }

    /// Energy of two atoms in the descent, by the square of their distance.
    ///
    /// The overlap costs `k s²/4 (1 - d²/s²)²` at a sum of radii s: near contact it is k times the square of the
    /// overlap, and no direction is preferred where two atoms coincide.
    #[inline(always)]
    fn soft(&self, receptor: &Site, ligand: &Site, square: f64) -> Soft {
        let distance = square.sqrt();
        let (mut energy, rise) = self.energies.smooth(receptor.kind, ligand.kind, distance);
        let mut rise = rise / distance.max(1e-6);
        let sum = receptor.radius + ligand.radius - OVERLAP;
        let lack = (1.0 - square / (sum * sum)).max(0.0);
        let overlap = 0.5 * sum * lack;
        energy += SOFT_CORE_STIFFNESS * overlap * overlap;
        rise -= SOFT_CORE_STIFFNESS * lack;
        let stiffness =
            2.0 * SOFT_CORE_STIFFNESS / (sum * sum) * (overlap / FULL_STIFFNESS).min(1.0);
        Soft {
            energy,
            rise,
            stiffness,
        }
    }
}

/// Energy of two atoms in the descent with its derivatives.
struct Soft {
    /// Energy, RT.
    #[cfg_attr(
        not(test),
        expect(dead_code, reason = "its derivatives are tested against it")
    )]
    energy: f64,
    /// Derivative by the distance over the distance, RT/Å²: times the vector between the atoms the gradient.
    rise: f64,
    /// Stiffness of their overlap over the square of the distance, RT/Å⁴.
    stiffness: f64,
}

/// Sums over the pairs of one ligand atom.
#[derive(Default)]
struct AtomSlope {
    gradient: Vector3<f64>,
    curvature: Matrix3<f64>,
    contacts: f64,
}

/// The atoms of a set of knots other than hydrogens, relative to its centre. `unknown` is the kind of atoms without a
/// kind.
fn sites(knots: &Knots, middle: Vector3<f64>, unknown: usize) -> Vec<(Vector3<f64>, Site)> {
    heavy_atoms(knots, middle)
        .map(|(index, position, radius)| {
            let kind = knots.atom_kinds.get(index).copied().flatten();
            let kind = kind.map_or(unknown, |kind| usize::from(kind).min(unknown));
            (position, Site { radius, kind })
        })
        .collect()
}

/// Longest steps in Å, one after the other; their sum bounds the whole move.
///
/// The length of a step is the root of the squares of the shift and of the arc at the interface's radius.
pub(super) const MAX_STEPS: [f64; 6] = [0.7, 0.455, 0.296, 0.192, 0.125, 0.081];
/// Damping of a step in RT/Å²: a part for each contact and a constant. It replaces the curvature of the atom pair
/// potential, which has either sign.
const DAMPING: [f64; 2] = [0.05, 2.0];

/// Derivatives of the energy of a move, and its contacts.
#[derive(Default)]
pub(super) struct Slope {
    /// Derivatives; the curvature is that of the overlaps along the lines between their atoms: positive semidefinite.
    pub by_step: Derivatives,
    /// Number of contacts, by a smooth weight.
    pub contacts: f64,
}

impl Slope {
    /// Adds an atom at `arm`, with the gradient and curvature by its position.
    #[inline(always)]
    pub fn add(&mut self, arm: &Vector3<f64>, gradient: &Vector3<f64>, curvature: &Matrix3<f64>) {
        self.by_step.push(gradient, &arm.cross(gradient));
        self.by_step.curve(arm, curvature);
    }

    /// The move after a step downhill from `at`, shorter than `longest` (Å), at an interface of `radius` (Å).
    pub fn step(&self, at: &Move, radius: f64, longest: f64) -> Move {
        let arc = 1.0 / radius;
        let scale = Vector6::new(1.0, 1.0, 1.0, arc, arc, arc);
        let mut matrix = self
            .by_step
            .curvature
            .component_mul(&(scale * scale.transpose()));
        let damping = DAMPING[0] * self.contacts + DAMPING[1];
        for axis in 0..6 {
            matrix[(axis, axis)] += damping;
        }
        // Positive definite unless a number is not finite.
        let Some(factors) = matrix.cholesky() else {
            return *at;
        };
        let step = -factors.solve(&self.by_step.gradient.component_mul(&scale));
        let step = step / (1.0 + step.norm_squared() / (longest * longest)).sqrt();
        let step = step.component_mul(&scale);
        at.then_by_halves(
            step.fixed_rows::<3>(0).into(),
            step.fixed_rows::<3>(3).into(),
        )
    }
}
