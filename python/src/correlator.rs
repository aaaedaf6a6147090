//! The correlation of two sets of balls, for custom scores.
//!
//! Threads share a correlator: each waits for its buffers, without holding the interpreter.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use numpy::{IntoPyArray, PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::failure::bad_input;
use knotdock_cli::memory_limit;
use knotdock_scoring::engine::{EngineMemory, EngineOptions, Plan};
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::kernel::KernelOptions;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::{Correlation, Correlator as Inner, CorrelatorError, GridPose, Precision};
use knotdock_structures::knots::Knots;

/// Correlates two sets of balls over all translations, one rotation after another.
///
/// The score of a pose is that of `knotdock dock` by shape alone: -lambda^2 g(0) + 2 lambda g(r0) - g(2 r0), where g is
/// the weighted overlap of balls grown by an offset. It is equation 53 of Behandish and Ilies (2016), with the sign that
/// their text gives. Lengths are in the unit of the centres.
#[pyclass(frozen, module = "knotdock._knotdock")]
pub struct Correlator {
    inner: Mutex<Inner>,
    exact: Arc<ExactScorer>,
}

/// Numbers that a pose is made of: its score, quaternion (w, x, y, z) and translation.
type Row = (f64, [f64; 4], [f64; 3]);

#[pymethods]
impl Correlator {
    /// Prepares the balls `receptor` and `ligand`, arrays (n, 4) of centres and radii, with weights (n,) of one where
    /// none are given.
    #[new]
    #[pyo3(signature = (receptor, ligand, receptor_weights=None, ligand_weights=None, *, lambda_=9.0, offset=2.2, alpha=2.0, resolution=4.5, pass_length=None, spacing=None, tolerance=1e-2))]
    #[allow(clippy::too_many_arguments, reason = "keywords of Python")]
    fn new(
        py: Python<'_>,
        receptor: PyReadonlyArray2<'_, f64>,
        ligand: PyReadonlyArray2<'_, f64>,
        receptor_weights: Option<PyReadonlyArray1<'_, f64>>,
        ligand_weights: Option<PyReadonlyArray1<'_, f64>>,
        lambda_: f64,
        offset: f64,
        alpha: f64,
        resolution: f64,
        pass_length: Option<f64>,
        spacing: Option<f64>,
        tolerance: f64,
    ) -> PyResult<Self> {
        let receptor = knots(py, &receptor, receptor_weights.as_ref())?;
        let ligand = knots(py, &ligand, ligand_weights.as_ref())?;
        let kernel = KernelOptions {
            lambda: lambda_,
            offset,
            alpha,
            resolution,
            pass_length: pass_length.unwrap_or(2.0 * resolution),
            ..KernelOptions::default()
        };
        let options = EngineOptions {
            kernel,
            spacing,
            tolerance,
        };
        const REMEDY: &str = "check the arrays and the ranges of the options";
        let plan = py.detach(|| Plan::new(&receptor, &ligand, options));
        let plan = plan.map_err(|error| bad_input(py, error, REMEDY))?;
        let needed = bytes(&plan, &receptor, &ligand);
        // Python would end with its process where the system has no memory.
        if let Some(free) = memory_limit().filter(|&free| needed > free) {
            let [needed, free] = [needed, free].map(|bytes| bytes as f64 / 1e9);
            let message =
                format!("this takes {needed:.1} GB of memory, and {free:.1} GB may be taken");
            let remedy = "use a coarser spacing or resolution, or fewer distinct radii";
            return Err(bad_input(py, message, remedy));
        }
        let inner = py.detach(|| Inner::new(&receptor, &ligand, &options));
        let inner = inner.map_err(|error| bad_input(py, error, REMEDY))?;
        Ok(Self {
            exact: inner.exact_scorer(),
            inner: Mutex::new(inner),
        })
    }

    /// Scores of all translations at a rotation, a unit quaternion (w, x, y, z): an array (nx, ny, nz).
    fn correlate<'py>(
        &self,
        py: Python<'py>,
        quaternion: [f64; 4],
    ) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let (size, scores) = self.at(py, quaternion, |correlation| {
            let scores = correlation.scores().iter();
            let scores: Vec<f32> = scores.map(|score| score as f32).collect();
            (correlation.size(), scores)
        })?;
        scores.into_pyarray(py).reshape(size)
    }

    /// The best translations at a rotation, best first, none a neighbour of another: (score, quaternion, translation)
    /// each.
    fn peaks(&self, py: Python<'_>, quaternion: [f64; 4], count: usize) -> PyResult<Vec<Row>> {
        self.at(py, quaternion, |correlation| {
            correlation.peaks(count).iter().map(row).collect()
        })
    }

    /// The pose of a voxel (i, j, k) of [`Self::correlate`] at a rotation: (quaternion, translation).
    fn pose(
        &self,
        py: Python<'_>,
        quaternion: [f64; 4],
        voxel: [usize; 3],
    ) -> PyResult<([f64; 4], [f64; 3])> {
        let pose = self.at(py, quaternion, |correlation| {
            let [nx, ny, nz] = correlation.size();
            let [i, j, k] = voxel;
            let is_inside = i < nx && j < ny && k < nz;
            is_inside.then(|| correlation.pose((i * ny + j) * nz + k))
        })?;
        let pose = pose.ok_or_else(|| {
            bad_input(
                py,
                "the voxel is outside of the grid",
                "see the shape of the array",
            )
        })?;
        Ok((pose.quaternion(), pose.translation.into()))
    }

    /// Exact scores of poses: quaternions (n, 4) of any length but zero, and translations (n, 3).
    fn score<'py>(
        &self,
        py: Python<'py>,
        quaternions: PyReadonlyArray2<'_, f64>,
        translations: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let quaternions: Vec<[f64; 4]> = rows(py, &quaternions, "quaternions")?;
        let translations: Vec<[f64; 3]> = rows(py, &translations, "translations")?;
        if quaternions.len() != translations.len() {
            return Err(bad_input(
                py,
                "there are not as many quaternions as translations",
                "give a row of each a pose",
            ));
        }
        let poses = quaternions.into_iter().zip(translations).enumerate();
        let poses = poses.map(|(row, (turn, shift))| {
            scaled_pose(turn, shift).ok_or_else(|| {
                let message = format!("row {row}: {turn:?} and {shift:?} are no pose");
                let remedy = "give finite numbers, and a quaternion that is not zero";
                bad_input(py, message, remedy)
            })
        });
        let poses: Vec<Pose> = poses.collect::<PyResult<_>>()?;
        let exact = &self.exact;
        let scores: Vec<f64> =
            py.detach(|| poses.iter().map(|pose| exact.score_only(pose)).collect());
        Ok(scores.into_pyarray(py))
    }

    /// Voxels along x, y and z.
    #[getter]
    fn size(&self) -> [usize; 3] {
        self.inner().plan().size()
    }

    /// Length of a voxel's edge.
    #[getter]
    fn spacing(&self) -> f64 {
        self.inner().plan().spacing()
    }

    /// Components of the lifted axis, each of which costs one transform per rotation.
    #[getter]
    fn rank(&self) -> usize {
        self.inner().rank()
    }

    /// Error of that rank at the best voxels of a few rotations, relative to the best score there.
    #[getter]
    fn rank_error(&self) -> f64 {
        self.inner().rank_error()
    }

    /// Error against the exact sum at the best voxels of a few rotations and a sweep through their grids, relative to
    /// the best score there. It is at most the tolerance: others are refused.
    #[getter]
    fn error(&self) -> f64 {
        self.inner().error()
    }
}

impl Correlator {
    fn inner(&self) -> MutexGuard<'_, Inner> {
        // A panic leaves buffers that the next correlation overwrites.
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What `read` takes from the correlation at a rotation. Others of Python's threads run meanwhile.
    fn at<T: Send>(
        &self,
        py: Python<'_>,
        quaternion: [f64; 4],
        read: impl FnOnce(Correlation<'_>) -> T + Send,
    ) -> PyResult<T> {
        let rotation = unit(quaternion);
        let found = py.detach(|| self.inner().correlate(&rotation).map(read));
        found.map_err(|error: CorrelatorError| bad_input(py, error, "normalise it"))
    }
}

/// The pose of a quaternion of any length and a translation; `None` if they are none.
fn scaled_pose(quaternion: [f64; 4], translation: [f64; 3]) -> Option<Pose> {
    let largest = quaternion
        .iter()
        .fold(0.0f64, |most, part| most.max(part.abs()));
    let is_finite = quaternion
        .iter()
        .chain(&translation)
        .all(|part| part.is_finite());
    if !is_finite || largest == 0.0 {
        return None;
    }
    // Squares of the parts may overflow or vanish.
    let is_usual = (1e-100..1e100).contains(&largest);
    let quaternion = quaternion.map(|part| if is_usual { part } else { part / largest });
    Some(Pose::from_parts(quaternion, translation))
}

/// Memory of a correlator in bytes: spectra, engine and workspace, and the tables of the exact sum.
fn bytes(plan: &Plan, receptor: &Knots, ligand: &Knots) -> u64 {
    let memory = EngineMemory::new(plan, ligand, Precision::Single);
    let functions = plan.functions();
    let radii = |knots: &Knots| knots.radius_classes().0.len() as u64;
    let sums = radii(receptor) * radii(ligand);
    memory.spectrum * functions as u64
        + memory.choice(functions)
        + memory.transform
        + sums * ExactScorer::bytes_a_radius_sum(plan.kernel())
}

fn row(pose: &GridPose) -> Row {
    (
        pose.score,
        pose.pose.quaternion(),
        pose.pose.translation.into(),
    )
}

fn unit([w, x, y, z]: [f64; 4]) -> UnitQuaternion<f64> {
    // Its norm is checked where it is used.
    UnitQuaternion::new_unchecked(Quaternion::from_parts(w, Vector3::new(x, y, z)))
}

/// The rows of an array of N columns.
fn rows<const N: usize>(
    py: Python<'_>,
    array: &PyReadonlyArray2<'_, f64>,
    name: &str,
) -> PyResult<Vec<[f64; N]>> {
    let view = array.as_array();
    if view.ncols() != N {
        let message = format!("{name} have {} columns, where {N} are needed", view.ncols());
        return Err(bad_input(py, message, "give an array (n, columns)"));
    }
    Ok(view
        .rows()
        .into_iter()
        .map(|row| std::array::from_fn(|column| row[column]))
        .collect())
}

fn knots(
    py: Python<'_>,
    balls: &PyReadonlyArray2<'_, f64>,
    weights: Option<&PyReadonlyArray1<'_, f64>>,
) -> PyResult<Knots> {
    let balls: Vec<[f64; 4]> = rows(py, balls, "balls")?;
    let centers = balls.iter().map(|&[x, y, z, _]| [x, y, z]).collect();
    let radii = balls.iter().map(|ball| ball[3]).collect();
    let knots = match weights {
        None => Knots::new(centers, radii),
        Some(weights) => Knots::with_weights(centers, radii, weights.as_array().to_vec()),
    };
    knots.map_err(|error| bad_input(py, error, "check the centres, radii and weights"))
}
