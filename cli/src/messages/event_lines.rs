//! Messages, progress and result of a command as lines of JSON on standard output (`--events`), for a program that runs it
//! as its child. The command ends when its standard input does, so it does not outlive that program.
//!
//! A line is an object with one of `say`, `warn`, `problem` (an error that does not end the command), `stage` (with
//! `total`), `done` (steps of the stage), `result` and, last, `error` as under `--json`.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread::Builder;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::messages::console::{Listener, write_line};
use knotdock::progress::{Interruption, Progress};

/// Writes the lines.
#[derive(Debug)]
pub struct EventLines {
    steps: Mutex<Steps>,
    is_ended: AtomicBool,
}

/// Steps of the stage that are done.
#[derive(Debug)]
struct Steps {
    done: u64,
    shown: Instant,
}

/// Time between two lines on the steps of a stage.
const PACE: Duration = Duration::from_millis(100);

impl EventLines {
    /// The lines of this process. The first call begins to wait for the end of standard input.
    pub fn of_process() -> &'static Self {
        static LINES: OnceLock<EventLines> = OnceLock::new();
        let mut is_first = false;
        let lines = LINES.get_or_init(|| {
            is_first = true;
            Self {
                steps: Mutex::new(Steps {
                    done: 0,
                    shown: Instant::now(),
                }),
                is_ended: AtomicBool::new(false),
            }
        });
        if is_first {
            let wait = || {
                let _ = io::copy(&mut io::stdin(), &mut io::sink());
                lines.is_ended.store(true, Ordering::Relaxed);
            };
            // Without a thread the command goes on to its end.
            let _ = Builder::new().name("input".to_owned()).spawn(wait);
        }
        lines
    }

    fn steps(&self) -> std::sync::MutexGuard<'_, Steps> {
        self.steps.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn line(object: &Value) {
    write_line(&mut io::stdout(), &object.to_string());
}

impl Progress for EventLines {
    fn stage(&self, name: &str, total: u64) {
        self.steps().done = 0;
        line(&json!({ "stage": name, "total": total }));
    }

    fn advance(&self, by: u64) {
        let mut steps = self.steps();
        steps.done += by;
        if steps.shown.elapsed() >= PACE {
            steps.shown = Instant::now();
            line(&json!({ "done": steps.done }));
        }
    }

    fn go_on(&self) -> Result<(), Interruption> {
        match self.is_ended.load(Ordering::Relaxed) {
            true => Err(Interruption::Interrupted),
            false => Ok(()),
        }
    }
}

impl Listener for EventLines {
    fn say(&self, text: &str) {
        line(&json!({ "say": text }));
    }

    fn warn(&self, text: &str) {
        line(&json!({ "warn": text }));
    }

    fn error(&self, text: &str) {
        line(&json!({ "problem": text }));
    }

    fn result(&self, object: &Value) {
        line(&json!({ "result": object }));
    }
}
