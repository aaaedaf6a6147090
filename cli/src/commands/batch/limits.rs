//! What a pair of a batch may take: time and attempts.

use std::time::{Duration, Instant};

use clap::Args;
use serde_json::Value;

use crate::messages::console::Console;
use crate::messages::listener::Listener;
use knotdock::options::values::duration;
use knotdock::progress::Ended;

/// How long and how often a pair is docked.
#[derive(Args, Clone, Copy, Debug)]
pub struct Limits {
    /// Time for each pair, such as 10min: one that takes longer fails. `-- --memory 4G` limits its memory.
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub time_limit: Option<f64>,
    /// How often a pair is docked again that failed by no fault of its input, such as by a disk that did not answer.
    #[arg(long, value_name = "COUNT", default_value_t = 2)]
    pub retries: usize,
}

/// The time of one pair, and whoever else may end it.
#[derive(Debug)]
pub struct PairTime<'a> {
    limit: Option<(Instant, f64)>,
    outer: Option<&'a dyn Listener>,
}

impl<'a> PairTime<'a> {
    /// The time of a pair that begins now.
    pub fn new(limits: Limits, console: Console<'a>) -> Self {
        let limit = limits.time_limit.and_then(|seconds| {
            let limit = Duration::try_from_secs_f64(seconds).ok()?;
            Some((Instant::now().checked_add(limit)?, seconds))
        });
        Self {
            limit,
            outer: console.listener,
        }
    }
}

impl Listener for PairTime<'_> {
    fn say(&self, _: &str) {}

    fn warn(&self, _: &str) {}

    fn error(&self, _: &str) {}

    fn result(&self, _: &Value) {}

    fn stage(&self, _: &str, _: u64) {}

    fn advance(&self, _: u64) {}

    fn go_on(&self) -> Result<(), Ended> {
        if let Some(outer) = self.outer {
            outer.go_on()?;
        }
        match self.limit {
            Some((end, seconds)) if Instant::now() >= end => Err(Ended::TimeLimit(seconds)),
            _ => Ok(()),
        }
    }
}
