//! The options of `knotdock dock`, read off their one definition.

use knotdock::options::definition::Definition;
use knotdock::options::definitions;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The options of `knotdock dock`, in their order: `name`, `kind` (`flag`, `list`, `file`, `number`, `choice` or
/// `text`), `values` of a choice, `default` as text or None, `subject`, `help`, and whether it
/// is one `of_files`, which no word of a command line gives.
#[pyfunction]
pub fn options(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    definitions()
        .iter()
        .map(|option| entry(py, option))
        .collect()
}

fn entry<'py>(py: Python<'py>, option: &Definition) -> PyResult<Bound<'py, PyDict>> {
    let argument = option.argument();
    let values: Vec<String> = argument
        .get_possible_values()
        .iter()
        .map(|value| value.get_name().to_owned())
        .collect();
    let defaults = argument.get_default_values();
    let default = defaults
        .first()
        .map(|value| value.to_string_lossy().into_owned());
    let kind = if option.is_flag() {
        "flag"
    } else if option.takes_several() {
        "list"
    } else if option.names_file() {
        "file"
    } else if !values.is_empty() {
        "choice"
    } else if default
        .as_ref()
        .is_some_and(|text| text.parse::<f64>().is_ok())
    {
        "number"
    } else {
        "text"
    };
    let entry = PyDict::new(py);
    entry.set_item("name", option.name())?;
    entry.set_item("kind", kind)?;
    entry.set_item("values", if option.is_flag() { Vec::new() } else { values })?;
    entry.set_item("default", default.filter(|_| !option.is_flag()))?;
    entry.set_item("subject", option.subject())?;
    entry.set_item("help", option.help())?;
    entry.set_item("of_files", option.is_of_files())?;
    Ok(entry)
}
