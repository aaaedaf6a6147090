//! Commands by their words. They run on their own thread while Python's waits, so that signals such as Ctrl-C are
//! received and other threads of Python run.

use std::ffi::OsString;
use std::fmt;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::thread::Builder;
use std::time::Duration;

use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::failure::{exception, fault};
use knotdock::output::files::added::add_files;
use knotdock::output::records::program::VERSION_WITH_COMMIT;
use knotdock::progress::{Interruption, Progress};
use knotdock_cli::Listener;
use knotdock_structures::Error;

/// Adds files to a run: its inputs, which are found again beside its record.
#[pyfunction]
pub fn add(py: Python<'_>, run: PathBuf, files: Vec<PathBuf>) -> PyResult<()> {
    add_files(&run, &files).map_err(|error| exception(py, &error))
}

/// Time between two looks at signals and messages.
const LOOK: Duration = Duration::from_millis(50);
/// Stack of a command's thread, in bytes: as much as a program's first thread commonly has.
const STACK: usize = 8 << 20;

/// A message of a command, until Python receives it.
enum Event {
    /// The listener's method, and the text.
    Message(&'static str, String),
    Stage(String, u64),
    /// Steps of the stage before it in the list.
    Advanced(u64),
    Result(String),
}

/// Collects the messages of a command.
#[derive(Default)]
pub struct Events {
    said: Mutex<Vec<Event>>,
    is_stopped: AtomicBool,
}

impl fmt::Debug for Events {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Events")
    }
}

impl Events {
    fn add(&self, event: Event) {
        if let Ok(mut said) = self.said.lock() {
            said.push(event);
        }
    }

    fn taken(&self) -> Vec<Event> {
        let taken = self.said.lock().map(|mut said| std::mem::take(&mut *said));
        taken.unwrap_or_default()
    }
}

impl Listener for Events {
    fn say(&self, text: &str) {
        self.add(Event::Message("say", text.to_owned()));
    }

    fn warn(&self, text: &str) {
        self.add(Event::Message("warn", text.to_owned()));
    }

    fn error(&self, text: &str) {
        self.add(Event::Message("error", text.to_owned()));
    }

    fn result(&self, object: &serde_json::Value) {
        self.add(Event::Result(object.to_string()));
    }
}

impl Progress for Events {
    fn stage(&self, name: &str, total: u64) {
        self.add(Event::Stage(name.to_owned(), total));
    }

    fn advance(&self, by: u64) {
        if let Ok(mut said) = self.said.lock() {
            match said.last_mut() {
                Some(Event::Advanced(steps)) => *steps += by,
                _ => said.push(Event::Advanced(by)),
            }
        }
    }

    fn go_on(&self) -> Result<(), Interruption> {
        match self.is_stopped.load(Ordering::Relaxed) {
            true => Err(Interruption::Interrupted),
            false => Ok(()),
        }
    }
}

/// Runs a command by its words, such as `["dock", "a.pdb", "b.pdb"]`; its JSON object as text, or None, and its exit
/// code. `listener` has methods `say(text)`, `warn(text)`, `error(text)`, `stage(name, total)` and `advance(steps)`.
///
/// A first Ctrl-C ends a docking at its next rotation, other commands when they are done; a second leaves the command to
/// itself.
#[pyfunction]
pub fn call(
    py: Python<'_>,
    words: Vec<OsString>,
    listener: &Bound<'_, PyAny>,
) -> PyResult<(Option<String>, u8)> {
    let work = |events: &Events| knotdock_cli::call(words, events);
    let (code, result) = work_beside(py, listener, work)?;
    Ok((result, code))
}

/// Does work on its own thread while Python's passes its messages on; its result, and its JSON object.
pub fn work_beside<T: Send + 'static>(
    py: Python<'_>,
    listener: &Bound<'_, PyAny>,
    work: impl FnOnce(&Events) -> Result<T, Error> + Send + 'static,
) -> PyResult<(T, Option<String>)> {
    let events = Arc::new(Events::default());
    let (sender, mut receiver) = channel();
    let heard = Arc::clone(&events);
    let work = move || {
        // Nobody waits for work that was left to itself.
        let _ = sender.send(work(heard.as_ref()));
    };
    let thread = Builder::new()
        .name("knotdock".to_owned())
        .stack_size(STACK)
        .spawn(work)?;
    let mut interrupted: Option<PyErr> = None;
    let mut result = None;
    let done: Option<Result<T, Error>> = loop {
        let (waited, back) = py.detach(move || (receiver.recv_timeout(LOOK), receiver));
        receiver = back;
        // What a listener raises ends the work as Ctrl-C does.
        let looked = tell(listener, &events, &mut result).and_then(|()| py.check_signals());
        if let Err(error) = looked {
            if interrupted.is_some() {
                return Err(error);
            }
            events.is_stopped.store(true, Ordering::Relaxed);
            interrupted = Some(error);
        }
        match waited {
            Ok(done) => break Some(done),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break None,
        }
    };
    let panicked = thread.join().is_err();
    if let Some(error) = interrupted {
        return Err(error);
    }
    match done {
        Some(Ok(done)) if !panicked => Ok((done, result)),
        Some(Err(failure)) => Err(exception(py, &failure)),
        _ => Err(fault(py)),
    }
}

/// Passes messages on.
fn tell(listener: &Bound<'_, PyAny>, events: &Events, result: &mut Option<String>) -> PyResult<()> {
    for event in events.taken() {
        match event {
            Event::Message(method, text) => drop(listener.call_method1(method, (text,))?),
            Event::Stage(name, total) => drop(listener.call_method1("stage", (name, total))?),
            Event::Advanced(steps) => drop(listener.call_method1("advance", (steps,))?),
            Event::Result(object) => *result = Some(object),
        }
    }
    Ok(())
}

/// Runs the program on a command line, of which the first word is its name; its exit code.
#[pyfunction]
pub fn main(py: Python<'_>, arguments: &Bound<'_, PyList>) -> PyResult<u8> {
    let arguments: Vec<OsString> = arguments.extract()?;
    knotdock_cli::system_limits::fail_at_file_size();
    #[cfg(feature = "serve")]
    {
        let python: OsString = py.import("sys")?.getattr("executable")?.extract()?;
        knotdock_cli::start_by(vec![python, "-m".into(), "knotdock".into()]);
    }
    Ok(py.detach(|| knotdock_cli::main(arguments)))
}

/// A page that holds a view and nothing else, or None in a build without the library of the view. `data` is the JSON text
/// that cli/src/report/page/view.js reads, `package` a folder of npm's package 3dmol.
#[pyfunction]
pub fn view_page(py: Python<'_>, data: &str, package: Option<PathBuf>) -> PyResult<Option<String>> {
    knotdock_cli::view_page(data, package).map_err(|error| exception(py, &error))
}

/// Version and commit.
#[pyfunction]
pub fn version() -> &'static str {
    VERSION_WITH_COMMIT
}
