//! Failures as exceptions with file, line, message and remedy: classes of `knotdock.errors`.

use pyo3::prelude::*;

use knotdock_structures::Error;

/// The exception of a failure: `InputError` for bad input, `KnotdockError` for anything else.
pub fn exception(py: Python<'_>, failure: &Error) -> PyErr {
    let file = failure.file().map(|file| file.display().to_string());
    let parts = (failure.message(), file, failure.line(), failure.remedy());
    made(py, failure.exit_code() == 2, parts)
}

/// The exception for arguments that cannot be used.
pub fn bad_input(py: Python<'_>, message: impl ToString, remedy: &str) -> PyErr {
    let message = message.to_string();
    made(py, true, (&message, None, None, Some(remedy)))
}

/// The exception of a fault of the program.
pub fn fault(py: Python<'_>) -> PyErr {
    let message = "knotdock failed: this is a bug";
    let remedy = "report it with the call and its files";
    made(py, false, (message, None, None, Some(remedy)))
}

type Parts<'a> = (&'a str, Option<String>, Option<u64>, Option<&'a str>);

fn made(py: Python<'_>, is_input: bool, parts: Parts) -> PyErr {
    let name = if is_input {
        "InputError"
    } else {
        "KnotdockError"
    };
    let made = py
        .import("knotdock.errors")
        .and_then(|errors| errors.getattr(name)?.call1(parts));
    match made {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}
