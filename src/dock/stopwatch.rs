//! Wall and CPU time of the stages of a run.

use std::time::Instant;

use cpu_time::ProcessTime;

use crate::dock::outcome::StageTime;

/// Time of stages that follow one another.
pub(super) struct Stopwatch {
    stages: Vec<StageTime>,
    started: Started,
}

/// When a stage began.
struct Started {
    wall: Instant,
    /// CPU time of the whole process; `None` where the system does not report it.
    cpu: Option<ProcessTime>,
}

impl Started {
    fn now() -> Self {
        Self {
            wall: Instant::now(),
            cpu: ProcessTime::try_now().ok(),
        }
    }

    /// The time since then, as that of a stage.
    fn stage(&self, name: &'static str) -> StageTime {
        let cpu = self.cpu.and_then(|cpu| cpu.try_elapsed().ok());
        StageTime {
            name,
            wall_seconds: self.wall.elapsed().as_secs_f64(),
            cpu_seconds: cpu.map(|cpu| cpu.as_secs_f64()),
        }
    }
}

impl Stopwatch {
    /// Starts the first stage.
    pub fn start() -> Self {
        Self {
            stages: Vec::new(),
            started: Started::now(),
        }
    }

    /// Ends a stage and starts the next.
    pub fn lap(&mut self, name: &'static str) {
        self.stages.push(self.started.stage(name));
        self.started = Started::now();
    }

    /// The stages that ended, in order.
    pub fn into_stages(self) -> Vec<StageTime> {
        self.stages
    }
}

/// The result of a call with its time.
pub(super) fn timed<T>(name: &'static str, call: impl FnOnce() -> T) -> (T, StageTime) {
    let started = Started::now();
    let result = call();
    (result, started.stage(name))
}
