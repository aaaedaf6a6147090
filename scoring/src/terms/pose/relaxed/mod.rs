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
use self::list::{Atoms, Eight, Interface, Site, USUAL_SLACK};
use super::TermDefinition;
use super::atom_pair::{AtomPairPotential, EnergyTable, SMOOTH_REACH, energy, smooth_energy};
use crate::blocks::{Blocks, LANES};
use crate::lanes::{each, total};
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
        let reach = SMOOTH_REACH.max(widest(&receptor) + widest(&ligand));
        let blocks = Blocks::within(&positions, reach + USUAL_SLACK);
        let atoms = Atoms {
            sites: blocks.arranged(|index| receptor[index]),
            receptor: blocks,
            receptor_center,
            reach,
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
        let Some(Interface { middle, radius }) = self.atoms.interface(&start, workspace) else {
            return Relaxed {
                pose: *pose,
                energy: 0.0,
            };
        };
        self.atoms.collect(&start, &middle, &none, workspace);
        let before = self.collected_energy(workspace, &none);
        let (mut at, mut collected) = (none, none);
        for longest in MAX_STEPS {
            at = self.slope(workspace, &at).step(&at, radius, longest);
            self.atoms.renew(&mut collected, &at, &start, workspace);
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
            |ligand, eight| self.energies_of(ligand, eight),
        )
    }

    /// Sum at a move of a value of a ligand atom and of each of eight receptor atoms, which must be `#[inline(always)]`.
    fn sum(
        &self,
        workspace: &mut Workspace,
        at: &Move,
        values: impl Fn(&Site, &Eight) -> [f64; LANES],
    ) -> f64 {
        let atoms = &self.atoms;
        with_simd!(
            <'a, F: Fn(&Site, &Eight) -> [f64; LANES]>(
                atoms: &'a Atoms, workspace: &'a mut Workspace, at: &'a Move, values: F
            ) -> f64,
            |simd| {
                let mut sum = 0.0;
                atoms.visit(
                    simd,
                    workspace,
                    at,
                    #[inline(always)]
                    || [0.0; LANES],
                    #[inline(always)]
                    |sums: &mut [f64; LANES], atom, eight| {
                        let values = values(&atom.site, eight);
                        *sums = each(|lane| sums[lane] + values[lane]);
                    },
                    #[inline(always)]
                    |sums, _| sum += total(&sums),
                );
                sum
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
            |sums: &mut AtomSlope, atom, eight| {
                let soft = self.soft(&atom.site, eight);
                let [x, y, z] = &eight.between;
                let cx = each(|lane| soft.stiffness[lane] * x[lane]);
                let cy = each(|lane| soft.stiffness[lane] * y[lane]);
                let cz = each(|lane| soft.stiffness[lane] * z[lane]);
                let products = [
                    (&soft.rise, x),
                    (&soft.rise, y),
                    (&soft.rise, z),
                    (&cx, x),
                    (&cx, y),
                    (&cx, z),
                    (&cy, y),
                    (&cy, z),
                    (&cz, z),
                ];
                for (sum, (a, b)) in sums.products.iter_mut().zip(products) {
                    *sum = each(|lane| sum[lane] + a[lane] * b[lane]);
                }
                let weights = each(|lane| atoms.contact(eight.squares[lane]));
                sums.contacts = each(|lane| sums.contacts[lane] + weights[lane]);
            },
            #[inline(always)]
            |sums, arm| {
                let contacts = total(&sums.contacts);
                if contacts > 0.0 {
                    slope.contacts += contacts;
                    let mut totals = [0.0; 9];
                    for (to, lanes) in totals.iter_mut().zip(&sums.products) {
                        *to = total(lanes);
                    }
                    let [gx, gy, gz, xx, xy, xz, yy, yz, zz] = totals;
                    let gradient = Vector3::new(gx, gy, gz);
                    let curvature = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
                    // Each body makes half of a rotation about the middle between their places.
                    slope.add(&(arm + 0.5 * at.shift), &gradient, &curvature);
                }
            },
        );
        slope
    }

    /// Energies in RT of a ligand atom with eight receptor atoms.
    #[inline(always)]
    fn energies_of(&self, ligand: &Site, eight: &Eight) -> [f64; LANES] {
        let row = self.energies.row(ligand.kind);
        let distances = each(|lane| eight.squares[lane].sqrt());
        let energies = each(|lane| energy(row, eight.kinds[lane], distances[lane]));
        let lacks = each(|lane| {
            let lack = eight.radii[lane] + ligand.radius - OVERLAP - distances[lane];
            lack.max(0.0)
        });
        each(|lane| energies[lane] + STIFFNESS * lacks[lane] * lacks[lane])
    }

    /// Energies of a ligand atom with eight receptor atoms in the descent, with their derivatives.
    ///
    /// The overlap costs `k s²/4 (1 - d²/s²)²` at a sum of radii s: near contact it is k times the square of the
    /// overlap, and no direction is preferred where two atoms coincide.
    #[inline(always)]
    fn soft(&self, ligand: &Site, eight: &Eight) -> Soft {
        let row = self.energies.row(ligand.kind);
        let distances = each(|lane| eight.squares[lane].sqrt());
        let mut smooth = [[0.0; LANES]; 2];
        for lane in 0..LANES {
            [smooth[0][lane], smooth[1][lane]] =
                smooth_energy(row, eight.kinds[lane], distances[lane]).into();
        }
        let inverse = each(|lane| 1.0 / distances[lane].max(1e-6));
        let sums = each(|lane| eight.radii[lane] + ligand.radius - OVERLAP);
        let closeness = each(|lane| 1.0 / (sums[lane] * sums[lane]));
        let lacks = each(|lane| (1.0 - eight.squares[lane] * closeness[lane]).max(0.0));
        let overlaps = each(|lane| 0.5 * sums[lane] * lacks[lane]);
        Soft {
            #[cfg(test)]
            energy: each(|lane| {
                smooth[0][lane] + SOFT_CORE_STIFFNESS * overlaps[lane] * overlaps[lane]
            }),
            rise: each(|lane| smooth[1][lane] * inverse[lane] - SOFT_CORE_STIFFNESS * lacks[lane]),
            stiffness: each(|lane| {
                let part = (overlaps[lane] * (1.0 / FULL_STIFFNESS)).min(1.0);
                2.0 * SOFT_CORE_STIFFNESS * closeness[lane] * part
            }),
        }
    }
}

/// Energies of a ligand atom with eight others in the descent, with their derivatives.
struct Soft {
    /// Energies, RT.
    #[cfg(test)]
    energy: [f64; LANES],
    /// Derivatives by the distance over the distance, RT/Å²: times the vector between the atoms the gradient.
    rise: [f64; LANES],
    /// Stiffness of their overlaps over the squares of the distances, RT/Å⁴.
    stiffness: [f64; LANES],
}

/// Sums over the pairs of one ligand atom.
#[derive(Default)]
struct AtomSlope {
    /// Gradient along x, y and z, and curvature xx, xy, xz, yy, yz, zz, by lane.
    products: [[f64; LANES]; 9],
    contacts: [f64; LANES],
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
