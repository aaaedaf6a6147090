//! The receptor's side of a correlation: its transform times the lifted kernel, and the compression of the lifted axis.

use super::plan::Plan;
use crate::kernel::table::Table;
use crate::precision::{InPrecision, Precision, in_precision, of_precision};
use crate::quantity::Quantity;
use crate::terms::effect::{ActiveTerm, Effect, Label, Term};
use crate::transform::Real;
use crate::transform::modes::ModeSet;
use crate::transform::pruned_type1::{Forward, ForwardWorkspace};
use crate::transform::truncation::Selection;
use knotdock_structures::Knots;
use nalgebra::{DMatrix, SymmetricEigen, Vector3};
use num_complex::{Complex, Complex64};
use rayon::prelude::*;
use std::sync::Arc;

/// Spectra by function, shared with copies that leave an effect out.
pub(super) type SpectrumList<T> = Vec<Arc<Vec<Complex<T>>>>;

/// The spectra of the functions in their precision.
type Spectra = InPrecision<SpectrumList<f32>, SpectrumList<f64>>;

/// The receptor's side, uncompressed: `H[function][mode]`, and the values of the functions at the ligand's knots.
///
/// The first functions are those of the lifted axis; each further effect adds one for every class that the ligand has.
#[derive(Clone)]
pub struct ReceptorSpectra {
    /// Window and volume are not yet divided out on the ligand's side.
    pub(super) spectra: Spectra,
    /// d_j v_b(s_j): (knots, functions).
    ligand: DMatrix<f64>,
    pub(super) center: [f64; 3],
    /// The effect of each function.
    effects: Vec<Effect>,
}

/// The factorisation of the functions, at full rank.
pub(crate) struct Factors {
    /// The receptor's combination: (functions, q).
    pub combination: DMatrix<f64>,
    /// The ligand's coefficients: (knots, q).
    pub coefficients: DMatrix<f64>,
    /// Singular values, largest first.
    pub singular: Vec<f64>,
}

impl ReceptorSpectra {
    /// Transforms the receptor and multiplies by the lifted kernel.
    ///
    /// The plan's further terms belong to the score alone, not to slices and sensitivities.
    ///
    /// # Panics
    /// If the plan was made for other knots.
    pub fn new(
        plan: &Plan,
        receptor: &Knots,
        ligand: &Knots,
        fold: Quantity,
        precision: Precision,
    ) -> Self {
        let bodies = [receptor, ligand];
        match precision {
            Precision::Single => Self::of(plan, bodies, fold, InPrecision::Single),
            Precision::Double => Self::of(plan, bodies, fold, InPrecision::Double),
        }
    }

    /// The spectra in a floating-point type, which `wrap` makes those of its precision.
    fn of<T: Real>(
        plan: &Plan,
        [receptor, ligand]: [&Knots; 2],
        fold: Quantity,
        wrap: fn(SpectrumList<T>) -> Spectra,
    ) -> Self {
        assert!(plan.holds_ligand(ligand), "the plan is of another ligand");
        let knots = Receptor::<T>::new(plan, receptor);
        let mut spectra = knots.shape_functions(plan, receptor, fold);
        let LigandFunctions {
            mut columns,
            mut effects,
        } = LigandFunctions::of_shape(plan, ligand);
        let terms = match fold {
            Quantity::Score => plan.effects(),
            _ => &[],
        };
        for ActiveTerm { term, kernel } in terms {
            let table = kernel.spectrum_table(plan.modes().cut);
            for ClassFunction { spectrum, column } in knots.term_functions(term, &table) {
                spectra.push(spectrum);
                columns.push(column);
                effects.push(term.effect);
            }
        }
        let ligand = DMatrix::from_fn(ligand.len(), columns.len(), |j, b| columns[b][j]);
        let scale = knots.forward.cells_per_length();
        let center = knots.forward.center();
        Self {
            spectra: wrap(spectra.into_iter().map(Arc::new).collect()),
            ligand,
            center: [0, 1, 2].map(|axis| center[axis] / scale[axis]),
            effects,
        }
    }

    /// The same without the functions of one effect.
    #[must_use]
    pub fn without(&self, effect: Effect) -> Self {
        let kept: Vec<usize> = (0..self.full_rank())
            .filter(|&b| self.effects[b] != effect)
            .collect();
        Self {
            spectra: in_precision!(&self.spectra, spectra => {
                kept.iter().map(|&b| Arc::clone(&spectra[b])).collect()
            }),
            ligand: self.ligand.select_columns(&kept),
            center: self.center,
            effects: kept.iter().map(|&b| self.effects[b]).collect(),
        }
    }

    /// The effect that a function belongs to.
    pub fn effect(&self, function: usize) -> Effect {
        self.effects[function]
    }

    /// Floating-point type of the spectra.
    pub fn precision(&self) -> Precision {
        self.spectra.precision()
    }

    /// `H[function]` at a mode by its place, window and volume not yet divided out on the ligand's side.
    pub(crate) fn value(&self, function: usize, place: usize) -> Complex64 {
        of_precision!(&self.spectra, spectra => {
            let value = spectra[function][place];
            Complex64::new(value.re.wide(), value.im.wide())
        })
    }

    /// Sum over the modes of the squared magnitudes of each function.
    pub(super) fn norms(&self) -> Vec<f64> {
        of_precision!(&self.spectra, spectra => {
            let squares = spectra.par_iter().map(|spectrum| {
                spectrum.iter().map(|value| value.norm_sqr().wide()).sum()
            });
            squares.collect()
        })
    }

    /// Leaves out all modes but those of a selection, for the whole correlation.
    pub fn keep(&mut self, selection: &Selection) {
        of_precision!(&mut self.spectra, spectra => {
            for spectrum in spectra {
                for (place, value) in Arc::make_mut(spectrum).iter_mut().enumerate() {
                    if !selection.keeps(place) {
                        *value = Default::default();
                    }
                }
            }
        });
    }

    /// d_j v_b(s_j) of ligand knot j.
    pub(crate) fn ligand_weight(&self, knot: usize, function: usize) -> f64 {
        self.ligand[(knot, function)]
    }

    /// The receptor's middle in the box, Å.
    pub(crate) fn center(&self) -> [f64; 3] {
        self.center
    }

    /// Number of functions: the rank that is exact.
    pub fn full_rank(&self) -> usize {
        self.effects.len()
    }

    /// The factorisation of the functions of all effects together, into as many terms as there are functions.
    ///
    /// With D the ligand's (knots, basis) matrix and S = (D'D)^(1/2), the product H D' is (H S)(D S^-1)'. The singular
    /// vectors of H S give the best q terms in the mean over knots placed at random. H S is stacked [Re; Im], so that V
    /// stays real.
    pub(crate) fn factor(&self, modes: &ModeSet) -> Factors {
        let size = self.full_rank();
        let mut gram = DMatrix::<f64>::zeros(size, size);
        let mut multiplicities = Vec::with_capacity(modes.count);
        modes.for_each(|_, _, multiplicity| multiplicities.push(multiplicity));
        let lower: Vec<(usize, usize)> = (0..size)
            .flat_map(|a| (0..=a).map(move |b| (a, b)))
            .collect();
        let products = lower.into_par_iter().map(|(a, b)| {
            let sum = of_precision!(&self.spectra, spectra => {
                product(&spectra[a], &spectra[b], &multiplicities)
            });
            (a, b, sum)
        });
        for (a, b, sum) in products.collect::<Vec<_>>() {
            gram[(a, b)] = sum;
            gram[(b, a)] = sum;
        }
        let ligand = SymmetricEigen::new(self.ligand.transpose() * &self.ligand);
        let largest = ligand.eigenvalues.max();
        let power = |exponent: f64| {
            let scaled = ligand.eigenvalues.map(|value| {
                // Functions that agree at all ligand knots carry nothing.
                if value > 1e-13 * largest {
                    value.powf(exponent)
                } else {
                    0.0
                }
            });
            &ligand.eigenvectors * DMatrix::from_diagonal(&scaled) * ligand.eigenvectors.transpose()
        };
        let (root, inverse_root) = (power(0.5), power(-0.5));
        let eigen = SymmetricEigen::new(&root * gram * &root);
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let vectors = DMatrix::from_fn(size, size, |row, q| eigen.eigenvectors[(row, order[q])]);
        let singular = order
            .iter()
            .map(|&i| eigen.eigenvalues[i].max(0.0).sqrt())
            .collect();
        Factors {
            combination: &root * &vectors,
            coefficients: &self.ligand * inverse_root * &vectors,
            singular,
        }
    }
}

/// Sum over the modes of the products of two functions, each with its multiplicity.
fn product<T: Real>(x: &[Complex<T>], y: &[Complex<T>], multiplicities: &[f64]) -> f64 {
    let pairs = x.iter().zip(y).zip(multiplicities);
    pairs
        .map(|((x, y), m)| m * (x.re.wide() * y.re.wide() + x.im.wide() * y.im.wide()))
        .sum()
}

/// Values of the functions at the ligand's knots, and their effects: the ligand's side of a correlation, which needs no
/// transform.
pub(crate) struct LigandFunctions {
    /// [function][knot].
    pub columns: Vec<Vec<f64>>,
    /// The effect of each function.
    pub effects: Vec<Effect>,
}

impl LigandFunctions {
    /// Those of shape: d_j v_b(s_j).
    fn of_shape(plan: &Plan, ligand: &Knots) -> Self {
        let (_, size) = plan.shape_functions();
        let column = |b: usize| {
            (0..ligand.len())
                .map(|j| plan.shape_value(ligand, 1, b, j))
                .collect()
        };
        Self {
            columns: (0..size).map(column).collect(),
            effects: vec![Effect::Shape; size],
        }
    }

    /// Those of a score, as [`ReceptorSpectra::new`] makes them.
    pub(crate) fn of_score(plan: &Plan, ligand: &Knots) -> Self {
        let mut all = Self::of_shape(plan, ligand);
        for ActiveTerm { term, .. } in plan.effects() {
            for class in 0..term.matrix.first().map_or(0, Vec::len) {
                let seen = |label: &Label| seen_by(term, class, label) != 0.0;
                let column = class_column(term, class);
                if term.receptor.iter().any(seen) && column.iter().any(|value| *value != 0.0) {
                    all.columns.push(column);
                    all.effects.push(term.effect);
                }
            }
        }
        all
    }
}

/// Values of a term at the ligand's knots of one class: 0 for other classes.
fn class_column(term: &Term, class: usize) -> Vec<f64> {
    let of_class = |label: &Label| {
        if label.class == class {
            label.value
        } else {
            0.0
        }
    };
    term.ligand.iter().map(of_class).collect()
}

/// Weight of a knot of the receptor for a ligand knot of a class.
fn seen_by(term: &Term, class: usize, label: &Label) -> f64 {
    let row = term.matrix.get(label.class);
    label.value * row.and_then(|row| row.get(class)).unwrap_or(&0.0)
}

/// The part of a term for the ligand's knots of one class.
struct ClassFunction<T> {
    /// The receptor's transform as the class feels it, through the term's kernel.
    spectrum: Vec<Complex<T>>,
    /// Values at the ligand's knots: 0 for other classes.
    column: Vec<f64>,
}

/// The receptor's knots and their transform.
struct Receptor<T: Real> {
    modes: Arc<ModeSet>,
    forward: Forward<T>,
    /// Relative to the receptor's centre, along the grid's axes, Å.
    points: Vec<[f64; 3]>,
}

impl<T: Real> Receptor<T> {
    fn new(plan: &Plan, receptor: &Knots) -> Self {
        let modes = plan.modes();
        let fine = plan.fine();
        let frame = plan.frame().to_rotation_matrix();
        let extent = [0, 1, 2].map(|axis| {
            plan.receptor_extent()[axis] * fine[axis] as f64 / modes.lengths[axis] + 0.5
        });
        Self {
            forward: Forward::<T>::new(Arc::clone(modes), fine, plan.width(), extent, 1),
            points: receptor
                .centers
                .iter()
                .map(|&x| (frame * (Vector3::from(x) - plan.receptor_center())).into())
                .collect(),
            modes: Arc::clone(modes),
        }
    }

    /// The functions of the lifted axis through its kernel: `[ligand basis function][mode]`.
    fn shape_functions(
        &self,
        plan: &Plan,
        receptor: &Knots,
        fold: Quantity,
    ) -> Vec<Vec<Complex<T>>> {
        let (receptor_size, ligand_size) = plan.shape_functions();
        let modes = &self.modes;
        let mut work = self.forward.workspace();
        let zero = Complex::new(T::zero(), T::zero());
        let mut spectra = vec![vec![zero; modes.count]; ligand_size];
        let mut field = vec![zero; modes.count];
        for a in 0..receptor_size {
            let mut inside = Vec::new();
            let mut weights = Vec::new();
            for i in 0..receptor.len() {
                let value = plan.shape_value(receptor, 0, a, i);
                if value != 0.0 {
                    inside.push(self.points[i]);
                    weights.push(T::of(value));
                }
            }
            self.forward
                .transform(&inside, &weights, &mut work, &mut field);
            spectra
                .par_iter_mut()
                .enumerate()
                .for_each(|(b, spectrum)| {
                    let Some(table) = plan.coupling(fold, (a, b)) else {
                        return;
                    };
                    modes.for_each(|mode, w, _| {
                        let length = (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt();
                        let factor = T::of(table.value(length)[0]);
                        spectrum[mode] = spectrum[mode] + field[mode].scale(factor);
                    });
                });
        }
        spectra
    }

    /// The functions of a term, one for every class that both sides feel; `table` is the term's kernel by wave number.
    fn term_functions(&self, term: &Term, table: &Table<1>) -> Vec<ClassFunction<T>> {
        let classes = term.matrix.first().map_or(0, Vec::len);
        (0..classes)
            .into_par_iter()
            .map_init(
                || self.forward.workspace(),
                |work, class| self.class_function(term, table, class, work),
            )
            .flatten()
            .collect()
    }

    /// The function of one class; `table` is the term's kernel by wave number. `None` if no knot of the ligand is of the
    /// class, or none of the receptor has a weight for it.
    fn class_function(
        &self,
        term: &Term,
        table: &Table<1>,
        class: usize,
        work: &mut ForwardWorkspace<T>,
    ) -> Option<ClassFunction<T>> {
        let column = class_column(term, class);
        let (inside, weights): (Vec<[f64; 3]>, Vec<T>) = self
            .points
            .iter()
            .zip(&term.receptor)
            .map(|(point, label)| (*point, seen_by(term, class, label)))
            .filter(|(_, weight)| *weight != 0.0)
            .map(|(point, weight)| (point, T::of(weight)))
            .unzip();
        if inside.is_empty() || column.iter().all(|value| *value == 0.0) {
            return None;
        }
        let mut spectrum = vec![Complex::new(T::zero(), T::zero()); self.modes.count];
        self.forward
            .transform(&inside, &weights, work, &mut spectrum);
        self.modes.for_each(|mode, w, _| {
            let length = (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt();
            spectrum[mode] = spectrum[mode].scale(T::of(table.value(length)[0]));
        });
        Some(ClassFunction { spectrum, column })
    }
}
