//! Molecules as arrays.

use std::ffi::OsString;

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::exception;
use knotdock_structures::molecule::{Atom, Format, Molecule as Inner, fits, write_renamed};

/// A molecule as knotdock reads it: the atoms that are docked.
#[pyclass(frozen, module = "knotdock._knotdock")]
pub struct Molecule(pub Inner);

#[pymethods]
impl Molecule {
    /// Reads `FILE` or `FILE:H,L`, with words such as `--waters=keep`.
    #[staticmethod]
    fn from_words(py: Python<'_>, file: OsString, words: Vec<OsString>) -> PyResult<Self> {
        let read = py.detach(|| knotdock_cli::read_molecule(&file, words));
        read.map(Self).map_err(|failure| exception(py, &failure))
    }

    fn __len__(&self) -> usize {
        self.0.atoms.len()
    }

    fn __repr__(&self) -> String {
        format!("<Molecule of {} atoms>", self.0.atoms.len())
    }

    /// What was read, dropped and altered, in words.
    #[getter]
    fn report(&self) -> String {
        self.0.report.to_string()
    }

    /// The text of a PDB file, or mmCIF if PDB cannot hold it.
    #[getter]
    fn text(&self) -> PyResult<String> {
        let format = match fits(Format::Pdb, &self.0) {
            Ok(()) => Format::Pdb,
            Err(_) => Format::Mmcif,
        };
        let mut text = Vec::new();
        write_renamed(&mut text, format, &self.0, &[])?;
        Ok(String::from_utf8_lossy(&text).into_owned())
    }

    /// Coordinates in Å, (n, 3).
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let positions: Vec<f64> = self.0.atoms.iter().flat_map(|atom| atom.position).collect();
        positions.into_pyarray(py).reshape([self.0.atoms.len(), 3])
    }

    /// Radii in Å, (n,).
    #[getter]
    fn radii<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.numbers(py, |atom| atom.radius)
    }

    /// The atoms' labels by name: lists of text, and arrays of numbers.
    #[getter]
    fn labels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let labels = PyDict::new(py);
        let optional = |letter: Option<char>| letter.map_or_else(String::new, String::from);
        labels.set_item("name", self.texts(|atom| atom.name.clone()))?;
        labels.set_item("element", self.texts(|atom| atom.element.clone()))?;
        labels.set_item("residue_name", self.texts(|atom| atom.residue_name.clone()))?;
        labels.set_item("chain", self.texts(|atom| atom.chain.clone()))?;
        let residues: Vec<i64> = self
            .0
            .atoms
            .iter()
            .map(|atom| atom.residue_number)
            .collect();
        labels.set_item("residue_number", residues.into_pyarray(py))?;
        labels.set_item(
            "insertion_code",
            self.texts(|atom| optional(atom.insertion_code)),
        )?;
        labels.set_item("occupancy", self.numbers(py, |atom| atom.occupancy))?;
        labels.set_item("b_factor", self.numbers(py, |atom| atom.b_factor))?;
        let hetero: Vec<bool> = self.0.atoms.iter().map(|atom| atom.hetero).collect();
        labels.set_item("hetero", hetero.into_pyarray(py))?;
        Ok(labels)
    }
}

impl Molecule {
    fn texts(&self, field: impl Fn(&Atom) -> String) -> Vec<String> {
        self.0.atoms.iter().map(field).collect()
    }

    fn numbers<'py>(
        &self,
        py: Python<'py>,
        field: impl Fn(&Atom) -> f64,
    ) -> Bound<'py, PyArray1<f64>> {
        let numbers: Vec<f64> = self.0.atoms.iter().map(field).collect();
        numbers.into_pyarray(py)
    }
}
