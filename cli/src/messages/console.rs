//! Where words go: the report on standard output, progress on standard error; under `--json` one object on standard
//! output and every word on standard error; under `--quiet` no words but errors.
//!
//! Control characters of files and names are escaped: [`shown`].
//!
//! A reader that closes the pipe early (`knotdock ... | head`) never stops a run: what it does not want is not
//! written. A disk that is full does not stop one either, but the command fails in the end.

use crate::messages::failure;
use std::borrow::Cow;
use std::io::{self, IsTerminal, Write};
use std::sync::OnceLock;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{Builder, JoinHandle};
use std::time::Duration;

use anstream::{AutoStream, ColorChoice};
use anstyle::{AnsiColor, Style};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use knotdock::progress::{Ended, Progress};

use crate::messages::listener::Listener;
use crate::messages::shown::{shown, shown_json};
use knotdock_structures::Error;

/// Why a part of the report could not be written, the first time that happened.
static LOST: OnceLock<io::Error> = OnceLock::new();

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

    /// Writes a paragraph of the report.
    pub fn say(&self, text: impl ToString) {
        if self.quiet {
            return;
        }
        if let Some(listener) = self.listener {
            return listener.say(&text.to_string());
        }
        if self.json {
            write_line(&mut io::stderr(), &shown(&text.to_string()));
        } else {
            let mut stream = io::stdout();
            let text = text.to_string();
            let written = writeln!(stream, "{}", shown(&text)).and_then(|()| stream.flush());
            if let Err(error) = written {
                // Only the first failure is reported.
                let _ = LOST.set(error);
            }
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

    /// Writes a warning on standard error.
    pub fn warn(&self, text: impl ToString) {
        if self.quiet {
            return;
        }
        if let Some(listener) = self.listener {
            listener.warn(&text.to_string());
        } else {
            let text = format!("warning: {}", text.to_string());
            write_line(&mut io::stderr(), &painted(&shown(&text)));
        }
    }

    /// Writes on standard error what went wrong and does not end the command.
    pub fn error(&self, text: impl ToString) {
        if let Some(listener) = self.listener {
            return listener.error(&text.to_string());
        }
        write_line(&mut io::stderr(), &shown(&text.to_string()));
    }

    /// Writes the command's JSON object, if it was requested: what cannot be written is a failure then, for the
    /// object is all there is, unless its reader has gone.
    pub fn result(&self, object: &serde_json::Value) -> Result<(), Error> {
        if let Some(listener) = self.listener {
            listener.result(object);
            return Ok(());
        }
        if !self.json {
            return Ok(());
        }
        let mut stream = io::stdout();
        let object = object.to_string();
        match writeln!(stream, "{}", shown_json(&object)).and_then(|()| stream.flush()) {
            Err(error) => unwritten(&error),
            Ok(()) => Ok(()),
        }
    }

    /// Writes a failure: for a person on standard error, for a program on standard output as well.
    pub fn fail(&self, failure: &Error) {
        if self.json {
            let object = failure::json(failure).to_string();
            write_line(&mut io::stdout(), &shown_json(&object));
        }
        write_line(&mut io::stderr(), &painted(&shown(&failure::text(failure))));
    }

    /// Reports to the listener that a stage of `total` steps begins; the terminal shows these steps in other ways.
    pub fn begins(&self, stage: &str, total: usize) {
        if let (Some(listener), false) = (self.listener, self.quiet || total == 0) {
            listener.stage(stage, total as u64);
        }
    }

    /// Reports to the listener that a step of the stage is done.
    pub fn advances(&self) {
        if let (Some(listener), false) = (self.listener, self.quiet) {
            listener.advance(1);
        }
    }

    /// Fails if the listener ends the command.
    pub fn go_on(&self) -> Result<(), Error> {
        let ended = self.listener.map_or(Ok(()), Listener::go_on);
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
        let shown = !self.quiet && self.listener.is_none() && io::stderr().is_terminal();
        ProgressLine {
            ticker: shown.then(|| Ticker::start(&bar)).flatten(),
            bar,
            shown,
            is_heard: !self.quiet && self.listener.is_some(),
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

/// Writes a line. Failures, such as a closed pipe, are not reported.
fn write_line(stream: &mut dyn Write, text: &str) {
    let _ = writeln!(stream, "{text}").and_then(|()| stream.flush());
}

/// The progress of a search on one line of the terminal, cleared when the search ends.
pub struct ProgressLine<'a> {
    bar: ProgressBar,
    shown: bool,
    ticker: Option<Ticker>,
    /// Whether the listener receives the steps; it always decides whether the work goes on.
    is_heard: bool,
    listener: Option<&'a dyn Listener>,
}

/// Time between two drawings of a line without progress.
const TICK: Duration = Duration::from_millis(200);

/// A thread that redraws the line, so that its clock goes on.
///
/// indicatif has one, too, and panics where the thread cannot be started.
struct Ticker {
    /// Ends the thread when it is dropped.
    running: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Ticker {
    /// Starts it; `None` where the system has no thread for it: the line then moves with the work alone.
    fn start(bar: &ProgressBar) -> Option<Self> {
        let (running, is_running) = channel::<()>();
        let bar = bar.clone();
        let ticks = move || {
            while is_running.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
                if !bar.is_finished() {
                    bar.tick();
                }
            }
        };
        let thread = Builder::new()
            .name("progress".to_owned())
            .spawn(ticks)
            .ok()?;
        Some(Self {
            running: Some(running),
            thread: Some(thread),
        })
    }
}

impl Drop for Ticker {
    fn drop(&mut self) {
        self.running.take();
        if let Some(thread) = self.thread.take() {
            // It has nothing to report, and its end is all that is waited for.
            let _ = thread.join();
        }
    }
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
        if self.is_heard {
            if let Some(listener) = self.listener {
                listener.stage(name, total);
            }
            return;
        }
        self.bar.finish_and_clear();
        // Each of these would draw a line of its own that is half the old stage's and half the new one's.
        self.bar.set_draw_target(ProgressDrawTarget::hidden());
        self.bar.reset();
        self.bar.set_length(total);
        self.bar.set_message(name.to_owned());
        if self.shown {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }

    fn advance(&self, by: u64) {
        match self.listener {
            Some(listener) if self.is_heard => listener.advance(by),
            _ => self.bar.inc(by),
        }
    }

    fn go_on(&self) -> Result<(), Ended> {
        self.listener.map_or(Ok(()), Listener::go_on)
    }
}

impl Drop for ProgressLine<'_> {
    fn drop(&mut self) {
        self.ticker.take();
        self.bar.finish_and_clear();
    }
}

/// First words of messages, with their colours: those of clap's own errors.
const PAINTED: [(&str, AnsiColor); 2] =
    [("error:", AnsiColor::Red), ("warning:", AnsiColor::Yellow)];

/// A message for standard error, its first word in colour if the terminal has colours: not in a pipe, with NO_COLOR or
/// with TERM=dumb.
fn painted(text: &str) -> Cow<'_, str> {
    if AutoStream::choice(&io::stderr()) == ColorChoice::Never {
        return Cow::Borrowed(text);
    }
    in_colour(text)
}

fn in_colour(text: &str) -> Cow<'_, str> {
    for (word, colour) in PAINTED {
        if let Some(rest) = text.strip_prefix(word) {
            let style = Style::new().fg_color(Some(colour.into())).bold();
            return Cow::Owned(format!("{style}{word}{style:#}{rest}"));
        }
    }
    Cow::Borrowed(text)
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
