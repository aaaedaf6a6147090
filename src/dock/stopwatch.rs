//! Wall and CPU time of the stages of a run.

use std::time::{Duration, Instant};

use cpu_time::{ProcessTime, ThreadTime};

use crate::dock::outcome::StageTime;
use crate::dock::shared_process::is_shared;

/// Time of stages that follow one another.
pub(super) struct Stopwatch {
    stages: Vec<StageTime>,
    started: Started,
}

/// When a stage began.
struct Started {
    wall: Instant,
    /// CPU time; `None` where the system does not report it.
    cpu: Option<CpuTime>,
}

/// CPU time of the run: that of the process, or if other runs share it that of its one thread.
enum CpuTime {
    Process(ProcessTime),
    Thread(ThreadTime),
}

impl CpuTime {
    fn now() -> Option<Self> {
        match (is_shared(), rayon::current_num_threads()) {
            (false, _) => ProcessTime::try_now().ok().map(Self::Process),
            (true, 1) => ThreadTime::try_now().ok().map(Self::Thread),
            (true, _) => None,
        }
    }

    fn elapsed(&self) -> Option<Duration> {
        match self {
            Self::Process(time) => time.try_elapsed().ok(),
            Self::Thread(time) => time.try_elapsed().ok(),
        }
    }
}

impl Started {
    fn now() -> Self {
        Self {
            wall: Instant::now(),
            cpu: CpuTime::now(),
        }
    }

    /// The time since then, as that of a stage.
    fn stage(&self, name: &'static str) -> StageTime {
        let cpu = self.cpu.as_ref().and_then(CpuTime::elapsed);
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
        self.resume();
    }

    /// Starts the next stage now.
    pub fn resume(&mut self) {
        self.started = Started::now();
    }

    /// The stages that ended, in order.
    pub fn into_stages(self) -> Vec<StageTime> {
        self.stages
    }
}

/// The result of a call with its time.
pub fn timed<T>(name: &'static str, call: impl FnOnce() -> T) -> (T, StageTime) {
    let started = Started::now();
    let result = call();
    (result, started.stage(name))
}
