//! Where words go: the report on standard output, progress on standard error; under `--json` one object on standard
//! output and every word on standard error; under `--quiet` no words but errors.
//!
//! Control characters of files and names are escaped: [`shown`].
//!
//! A reader that closes the pipe early (`knotdock ... | head`) never stops a run: what it does not want is not
//! written. A disk that is full does not stop one either, but the command fails in the end.

use std::borrow::Cow;
use std::fmt::Debug;
use std::io::{self, IsTerminal, Write};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};
use std::thread::{Builder, sleep};
use std::time::Duration;

use anstyle::{AnsiColor, Style};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};

use crate::messages::shown::{shown, shown_json, shown_name};
use crate::system_limits::object_is_written;
use knotdock::progress::{Interruption, Progress};
use knotdock_structures::Error;

/// The first error on writing the report.
static LOST: OnceLock<io::Error> = OnceLock::new();

/// Receives what a command would write to the terminal, from any of its threads. What is not implemented is dropped.
pub trait Listener: Progress + Debug {
    /// A paragraph of the report.
    fn say(&self, _text: &str) {}
    /// A warning.
    fn warn(&self, _text: &str) {}
    /// An error that does not end the command.
    fn error(&self, _text: &str) {}
    /// The JSON object of the command.
    fn result(&self, _object: &Value) {}
}

/// The terminal as a command sees it, or the program that listens in its place.
#[derive(Clone, Copy, Debug, Default)]
pub struct Console<'a> {
    /// Results as one JSON object.
    pub json: bool,
    /// No words but errors.
    pub quiet: bool,
    /// More words.
    pub verbose: bool,
    /// Hears everything in the terminal's place.
    pub listener: Option<&'a dyn Listener>,
}

impl<'a> Console<'a> {
    /// A console that passes on errors alone, for work within a command.
    pub fn silent(self) -> Self {
        Self {
            quiet: true,
            json: false,
            verbose: false,
            ..self
        }
    }

    pub fn say(&self, text: impl ToString) {
        if self.quiet {
            return;
        }
        if let Some(listener) = self.listener {
            return listener.say(&text.to_string());
        }
        let text = text.to_string();
        if self.json {
            write_line(&mut io::stderr(), &shown(&text));
        } else if let Err(error) = written(&mut io::stdout(), &shown(&text)) {
            // Only the first failure is reported.
            let _ = LOST.set(error);
        }
    }

    /// Writes a paragraph that only `--verbose` wants.
    pub fn detail(&self, text: impl ToString) {
        if self.verbose {
            self.say(text);
        }
    }

    /// Whether all of the report could be written, if anyone was there to read it.
    pub fn all_said() -> Result<(), Error> {
        LOST.get().map_or(Ok(()), unwritten)
    }

    pub fn warn(&self, text: impl ToString) {
        if self.quiet {
            return;
        }
        if let Some(listener) = self.listener {
            listener.warn(&text.to_string());
        } else {
            let text = format!("warning: {}", text.to_string());
            write_line(&mut anstream::stderr(), &in_colour(&shown(&text)));
        }
    }

    /// Warns of leftovers of ended commands. They stay: only the user knows whether a command still runs.
    pub fn warn_leftovers(&self, paths: &[PathBuf]) {
        for path in paths {
            self.warn(format!(
                "{} was left by a command that was ended, or that still runs: remove it if none does",
                path.display()
            ));
        }
    }

    /// Writes on standard error what went wrong and does not end the command.
    pub fn error(&self, text: impl ToString) {
        if let Some(listener) = self.listener {
            return listener.error(&text.to_string());
        }
        write_line(&mut io::stderr(), &shown(&text.to_string()));
    }

    /// Writes the command's JSON object, if requested; a failure to write it is an error unless its reader is gone.
    pub fn result(&self, object: &Value) -> Result<(), Error> {
        if let Some(listener) = self.listener {
            listener.result(object);
            return Ok(());
        }
        if !self.json {
            return Ok(());
        }
        let written = written(&mut io::stdout(), &shown_json(&object.to_string()));
        written.or_else(|error| unwritten(&error))
    }

    /// Writes a failure: for a person on standard error, for a program on standard output as well.
    pub fn fail(&self, failure: &Error) {
        if self.json {
            let object = failure_json(failure).to_string();
            write_line(&mut io::stdout(), &shown_json(&object));
            object_is_written();
        }
        write_line(
            &mut anstream::stderr(),
            &in_colour(&shown(&failure_text(failure))),
        );
    }

    /// Reports to the listener that a stage of `total` steps begins; the terminal shows these steps in other ways.
    pub fn begins(&self, stage: &str, total: usize) {
        if let (Some(listener), false) = (self.listener, self.quiet || total == 0) {
            listener.stage(stage, total as u64);
        }
    }

    pub fn advances(&self) {
        if let (Some(listener), false) = (self.listener, self.quiet) {
            listener.advance(1);
        }
    }

    /// Fails if the listener ends the command.
    pub fn go_on(&self) -> Result<(), Error> {
        let ended = self.listener.map_or(Ok(()), |listener| listener.go_on());
        ended.map_err(|why| Error::lasting(why).help("start it again"))
    }

    /// A progress bar on standard error; none when that is not a terminal or words are not wanted.
    pub fn progress(&self) -> ProgressLine<'a> {
        let bar = ProgressBar::hidden();
        // The templates are constant; should one not parse, indicatif's own style serves.
        if let Ok(style) = ProgressStyle::with_template(
            "{msg:>12} [{wide_bar}] {human_pos}/{human_len}, {elapsed} gone, {eta} left",
        ) {
            bar.set_style(style.progress_chars("=> "));
        }
        let is_shown = !self.quiet && self.listener.is_none() && io::stderr().is_terminal();
        let shown = is_shown.then(|| Arc::new(()));
        if let Some(shown) = &shown {
            keep_ticking(&bar, shown);
        }
        ProgressLine {
            bar,
            shown,
            receiver: self.listener.filter(|_| !self.quiet),
            listener: self.listener,
        }
    }
}

/// A failure to write to standard output, unless its reader has gone.
fn unwritten(error: &io::Error) -> Result<(), Error> {
    if error.kind() == io::ErrorKind::BrokenPipe {
        return Ok(());
    }
    Err(
        Error::machine(format!("cannot write to standard output: {error}"))
            .help("check the free space there"),
    )
}

fn written(stream: &mut dyn Write, text: &str) -> io::Result<()> {
    writeln!(stream, "{text}").and_then(|()| stream.flush())
}

/// Writes a line. Failures, such as a closed pipe, are not reported.
pub(super) fn write_line(stream: &mut dyn Write, text: &str) {
    let _ = written(stream, text);
}

/// The progress of a search on one line of the terminal, cleared when the search ends.
pub struct ProgressLine<'a> {
    bar: ProgressBar,
    /// Present if it is shown; the thread that redraws it ends without.
    shown: Option<Arc<()>>,
    /// Receives the steps.
    receiver: Option<&'a dyn Listener>,
    /// Decides whether the work goes on.
    listener: Option<&'a dyn Listener>,
}

/// Time between two drawings of a line without progress.
const TICK: Duration = Duration::from_millis(200);

/// Redraws a line while it is shown, so that its clock goes on. Without a thread for that, the line moves with the work
/// alone; indicatif's own ticker panics then.
fn keep_ticking(bar: &ProgressBar, shown: &Arc<()>) {
    let (bar, shown) = (bar.clone(), Arc::downgrade(shown));
    let ticks = move || {
        while shown.strong_count() > 0 {
            sleep(TICK);
            if !bar.is_finished() {
                bar.tick();
            }
        }
    };
    let _ = Builder::new().name("progress".to_owned()).spawn(ticks);
}

impl ProgressLine<'_> {
    /// Clears the line, so that a sentence can be written in its place.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for ProgressLine<'_> {
    fn stage(&self, name: &str, total: u64) {
        // A stage without steps would show as 0 of 0.
        if total == 0 {
            return;
        }
        if let Some(receiver) = self.receiver {
            return receiver.stage(name, total);
        }
        self.bar.finish_and_clear();
        // Each of these would draw a separate line that is half the old stage's and half the new one's.
        self.bar.set_draw_target(ProgressDrawTarget::hidden());
        self.bar.reset();
        self.bar.set_length(total);
        self.bar.set_message(name.to_owned());
        if self.shown.is_some() {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }

    fn advance(&self, by: u64) {
        match self.receiver {
            Some(receiver) => receiver.advance(by),
            None => self.bar.inc(by),
        }
    }

    fn go_on(&self) -> Result<(), Interruption> {
        self.listener.map_or(Ok(()), |listener| listener.go_on())
    }
}

impl Drop for ProgressLine<'_> {
    fn drop(&mut self) {
        self.shown.take();
        self.bar.finish_and_clear();
    }
}

/// First words of messages, with their colours: those of clap's own errors.
const PAINTED: [(&str, AnsiColor); 2] =
    [("error:", AnsiColor::Red), ("warning:", AnsiColor::Yellow)];

/// A message with its first word in colour; anstream drops the colour in a pipe, with NO_COLOR or with TERM=dumb.
fn in_colour(text: &str) -> Cow<'_, str> {
    for (word, colour) in PAINTED {
        if let Some(rest) = text.strip_prefix(word) {
            let style = Style::new().fg_color(Some(colour.into())).bold();
            return Cow::Owned(format!("{style}{word}{style:#}{rest}"));
        }
    }
    Cow::Borrowed(text)
}

/// The lines for a person.
pub fn failure_text(error: &Error) -> String {
    let mut text = format!("error: {}", error.message());
    if let Some(file) = error.file() {
        text += &format!("\n  in {}", shown_name(&file.display().to_string()));
        if let Some(line) = error.line() {
            text += &format!(", line {line}");
        }
    }
    if let Some(remedy) = error.remedy() {
        text += &format!("\n  help: {remedy}");
    }
    text
}

/// The object for a program: `{"error": {"file", "line", "message", "remedy"}}`.
pub fn failure_json(error: &Error) -> Value {
    json!({ "error": {
        "file": error.file().map(|file| file.display().to_string()),
        "line": error.line(),
        "message": error.message(),
        "remedy": error.remedy(),
    }})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_word_alone_has_a_colour() {
        let painted = in_colour("error: no warning: at all");
        assert_eq!(
            painted,
            "\u{1b}[1m\u{1b}[31merror:\u{1b}[0m no warning: at all"
        );
        assert_eq!(in_colour("no error: here"), "no error: here");
    }
}
