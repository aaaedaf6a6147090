//! The options of `knotdock dock`, read off their one definition.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use knotdock::options::definition::{Definition, Form};
use knotdock::options::definitions;

/// The options of `knotdock dock`, in their order: `name`, `kind`, `values` of a choice, `default` as text or None,
/// `subject`, `help`, and whether it is one `of_files`, which no word of a command line gives. A kind is `flag`, `list`,
/// `file`, `number`, `choice` or `text`.
#[pyfunction]
pub fn options(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    definitions()
        .iter()
        .map(|option| entry(py, option))
        .collect()
}

fn entry<'py>(py: Python<'py>, option: &Definition) -> PyResult<Bound<'py, PyDict>> {
    let default = option.default_text();
    let is_number = |text: &String| text.parse::<f64>().is_ok();
    let kind = match option.form() {
        Form::Flag => "flag",
        Form::List => "list",
        Form::File => "file",
        Form::Choice => "choice",
        Form::Value | Form::Signed if default.as_ref().is_some_and(is_number) => "number",
        Form::Value | Form::Signed => "text",
    };
    let values: Vec<&str> = match option.form() {
        Form::Choice => option.value_name().split('|').collect(),
        _ => Vec::new(),
    };
    let entry = PyDict::new(py);
    entry.set_item("name", option.name())?;
    entry.set_item("kind", kind)?;
    entry.set_item("values", values)?;
    entry.set_item("default", default)?;
    entry.set_item("subject", option.subject())?;
    entry.set_item("help", option.help())?;
    entry.set_item("of_files", option.is_of_files())?;
    Ok(entry)
}
