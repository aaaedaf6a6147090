//! Dockings in memory.

use std::path::PathBuf;

use pyo3::prelude::*;

use crate::command::work_beside;
use crate::failure::{bad_input, exception};
use crate::molecule::Molecule;
use knotdock::options::option_named;
use knotdock::{DockOptions, Docking, Run as Inner};

/// A docking of two molecules in memory.
#[pyclass(frozen, module = "knotdock._knotdock")]
pub struct Run(Inner);

/// Docks a ligand to a receptor with options by name, each as text. `listener` as of `call`.
#[pyfunction]
pub fn dock(
    py: Python<'_>,
    receptor: &Molecule,
    ligand: &Molecule,
    options: Vec<(String, String)>,
    listener: &Bound<'_, PyAny>,
) -> PyResult<Run> {
    let mut read = DockOptions::default();
    let names: Vec<String> = options.iter().map(|(name, _)| name.clone()).collect();
    for (name, text) in options {
        let Some(option) = option_named(&name) else {
            let message = format!("there is no option {name}");
            return Err(bad_input(py, message, "see `help(knotdock.dock)`"));
        };
        if option.subject() == "input" {
            let message = format!("{name} is an option of reading, and molecules are read");
            return Err(bad_input(py, message, "give it to `Molecule.read`"));
        }
        let set = option.set(&mut read, &text);
        set.map_err(|error| exception(py, &error))?;
    }
    let [receptor, ligand] = [receptor, ligand].map(|molecule| molecule.0.clone());
    let read = read.of_ligand(&ligand, |name| names.iter().any(|given| given == name));
    let (run, _) = work_beside(py, listener, move |events| {
        let docking = Docking::new(&receptor, &ligand);
        docking.options(&read).progress(events).run()
    })?;
    Ok(Run(run))
}

#[pymethods]
impl Run {
    /// The table of poses as CSV text.
    fn table(&self, py: Python<'_>) -> PyResult<String> {
        self.0.table().map_err(|error| exception(py, &error))
    }

    /// The record of the run as JSON text.
    fn record(&self, py: Python<'_>) -> PyResult<String> {
        self.0.record().map_err(|error| exception(py, &error))
    }

    /// The complex of a rank, from 1, as the text of a PDB or mmCIF file.
    fn complex(&self, py: Python<'_>, rank: usize) -> PyResult<String> {
        let complex = self.0.complex(rank);
        let complex = complex.map_err(|error| exception(py, &error))?;
        Ok(complex.text)
    }

    /// Writes the run into a directory that holds no other.
    fn write(&self, py: Python<'_>, directory: PathBuf) -> PyResult<()> {
        let written = py.detach(|| self.0.write(directory));
        written.map_err(|error| exception(py, &error))
    }
}
