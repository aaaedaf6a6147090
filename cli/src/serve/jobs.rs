//! The queue: one run at a time, each a process of this program. Its state is a file, so it survives the server.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::process::Stdio;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::process::Command;
use tokio::sync::{Notify, watch};
use tokio::time::timeout;

use super::Server;
use super::folder::{Folder, is_name, read_small};
use super::request::RunRequest;
use knotdock::output::files::whole_file::write_whole;
use knotdock_structures::Error;

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum JobState {
    Waiting,
    Running,
    Done,
    Failed,
    Cancelled,
    /// The server ended while it ran.
    Interrupted,
}

impl JobState {
    /// Whether it ended without a run.
    pub fn is_over(self) -> bool {
        matches!(self, Self::Failed | Self::Cancelled | Self::Interrupted)
    }
}

/// A run that the page requested, as its file has it.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Job {
    pub state: JobState,
    /// Time of the request, seconds since 1970.
    pub requested: u64,
    pub request: RunRequest,
    #[serde(default)]
    pub warnings: Vec<String>,
    /// The failure, as the program reports it.
    #[serde(default)]
    pub error: Option<Value>,
}

impl Job {
    pub fn read(folder: &Folder, run: &str) -> Option<Self> {
        let file = is_name(run).then(|| folder.job_file(run))?;
        serde_json::from_slice(&read_small(&file)?).ok()
    }

    fn write(&self, folder: &Folder, run: &str) -> Result<(), Error> {
        write_whole(&folder.job_file(run), |file| {
            serde_json::to_writer_pretty(&mut *file, self)?;
            file.write_all(b"\n")
        })
    }
}

/// The run that is going on.
struct Running {
    run: String,
    began: Instant,
    stage: String,
    total: u64,
    done: u64,
    stage_began: Instant,
}

impl Running {
    fn begin(&mut self, stage: &str, total: u64) {
        stage.clone_into(&mut self.stage);
        self.stage_began = Instant::now();
        (self.total, self.done) = (total, 0);
    }

    fn shown(&self) -> Value {
        let passed = self.stage_began.elapsed().as_secs_f64();
        let left = self.total.saturating_sub(self.done) as f64;
        let seconds_left = (self.done > 0).then(|| passed * left / self.done as f64);
        json!({
            "run": self.run,
            "stage": self.stage,
            "done": self.done,
            "total": self.total,
            "seconds": self.began.elapsed().as_secs_f64(),
            "stage_seconds_left": seconds_left,
        })
    }
}

#[derive(Default)]
struct Queue {
    waiting: VecDeque<String>,
    running: Option<Running>,
    /// Grows with every change of the list of runs.
    changes: u64,
}

pub struct Jobs {
    queue: Mutex<Queue>,
    wake: Notify,
    /// Ends the run that is going on.
    cancel: Notify,
    shown: watch::Sender<Value>,
}

impl Jobs {
    /// The queue as an earlier server left it.
    pub fn recovered(folder: &Folder) -> Result<Self, Error> {
        let mut waiting: Vec<(u64, String)> = Vec::new();
        for run in folder.job_names()? {
            let Some(mut job) = Job::read(folder, &run) else {
                continue;
            };
            match job.state {
                JobState::Waiting => waiting.push((job.requested, run)),
                JobState::Running => {
                    let is_done = folder.run(&run).is_some();
                    job.state = if is_done {
                        JobState::Done
                    } else {
                        JobState::Interrupted
                    };
                    job.write(folder, &run)?;
                }
                _ => {}
            }
        }
        waiting.sort();
        let jobs = Self {
            queue: Mutex::new(Queue {
                waiting: waiting.into_iter().map(|(_, run)| run).collect(),
                ..Queue::default()
            }),
            wake: Notify::new(),
            cancel: Notify::new(),
            shown: watch::Sender::new(Value::Null),
        };
        jobs.wake.notify_one();
        jobs.show(&jobs.queue());
        Ok(jobs)
    }

    fn queue(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The state of the queue, and its changes from then on.
    pub fn watch(&self) -> watch::Receiver<Value> {
        self.shown.subscribe()
    }

    fn show(&self, queue: &Queue) {
        self.shown.send_replace(json!({
            "running": queue.running.as_ref().map(Running::shown),
            "waiting": queue.waiting,
            "changes": queue.changes,
        }));
    }

    /// Changes the queue, and shows it.
    fn change<T>(&self, change: impl FnOnce(&mut Queue) -> T) -> T {
        let mut queue = self.queue();
        let changed = change(&mut queue);
        queue.changes += 1;
        self.show(&queue);
        changed
    }

    /// Puts a new run in the queue; its name.
    pub fn add(&self, folder: &Folder, request: RunRequest) -> Result<String, Error> {
        let label = request.label();
        let is_taken = |run: &str| folder.run(run).is_some() || folder.job_file(run).exists();
        let names = (1_u64..).map(|number| match number {
            1 => label.clone(),
            number => format!("{label}_{number}"),
        });
        let run = names
            .into_iter()
            .find(|run| !is_taken(run))
            .unwrap_or_default();
        // Refuses what makes no command line before anything is written.
        request.words(folder, &run)?;
        let requested = SystemTime::now().duration_since(UNIX_EPOCH);
        let job = Job {
            state: JobState::Waiting,
            requested: requested.map_or(0, |time| time.as_secs()),
            request,
            warnings: Vec::new(),
            error: None,
        };
        self.wait(folder, &run, job)?;
        Ok(run)
    }

    /// Puts a run that ended without a result in the queue again; whether it was one.
    pub fn again(&self, folder: &Folder, run: &str) -> Result<bool, Error> {
        match Job::read(folder, run).filter(|job| job.state.is_over()) {
            Some(job) => self.wait(folder, run, job).map(|()| true),
            None => Ok(false),
        }
    }

    fn wait(&self, folder: &Folder, run: &str, job: Job) -> Result<(), Error> {
        let job = Job {
            state: JobState::Waiting,
            warnings: Vec::new(),
            error: None,
            ..job
        };
        job.write(folder, run)?;
        self.change(|queue| queue.waiting.push_back(run.to_owned()));
        self.wake.notify_one();
        Ok(())
    }

    /// Ends a run, or takes it out of the queue; whether it was there.
    pub fn cancel(&self, folder: &Folder, run: &str) -> Result<bool, Error> {
        let is_running =
            |queue: &Queue| (queue.running.as_ref()).is_some_and(|running| running.run == run);
        if is_running(&self.queue()) {
            // Not kept for later: a run that has just ended must not hand it to the next.
            self.cancel.notify_waiters();
            return Ok(true);
        }
        let was_waiting = self.change(|queue| {
            let place = queue.waiting.iter().position(|waiting| waiting == run);
            place.map(|place| queue.waiting.remove(place)).is_some()
        });
        if was_waiting && let Some(job) = Job::read(folder, run) {
            let state = JobState::Cancelled;
            Job { state, ..job }.write(folder, run)?;
            self.change(|_| ());
        }
        Ok(was_waiting)
    }

    /// Forgets a run that ended without a result; whether it was one.
    pub fn forget(&self, folder: &Folder, run: &str) -> bool {
        let is_over = Job::read(folder, run).is_some_and(|job| job.state.is_over());
        let is_gone = is_over && std::fs::remove_file(folder.job_file(run)).is_ok();
        self.change(|_| is_gone)
    }

    async fn next(&self) -> String {
        loop {
            let next = self.queue().waiting.pop_front();
            match next {
                Some(run) => return run,
                None => self.wake.notified().await,
            }
        }
    }
}

/// Makes the runs of the queue, one after another.
pub async fn run_all(server: Arc<Server>) -> Infallible {
    loop {
        let run = server.jobs.next().await;
        let Some(mut job) = Job::read(&server.folder, &run) else {
            continue;
        };
        job.state = JobState::Running;
        // A job whose state cannot be written is shown as it was.
        let _ = job.write(&server.folder, &run);
        let now = Instant::now();
        server.jobs.change(|queue| {
            queue.running = Some(Running {
                run: run.clone(),
                began: now,
                stage: String::new(),
                total: 0,
                done: 0,
                stage_began: now,
            });
        });
        let words = job.request.words(&server.folder, &run);
        let made = match words {
            Ok(words) => make(&server, &words, &mut job.warnings).await,
            Err(error) => Err(Some(
                crate::messages::console::failure_json(&error)["error"].take(),
            )),
        };
        (job.state, job.error) = match made {
            Ok(()) => (JobState::Done, None),
            Err(Some(error)) => (JobState::Failed, Some(error)),
            Err(None) => (JobState::Cancelled, None),
        };
        let _ = job.write(&server.folder, &run);
        server.jobs.change(|queue| queue.running = None);
    }
}

/// Time that a cancelled run has to end by itself, which it does between rotations.
const GRACE: Duration = Duration::from_secs(3);

/// Runs a command, and shows its progress. `Err(None)` if it was cancelled, else with the failure.
async fn make(
    server: &Server,
    words: &[String],
    warnings: &mut Vec<String>,
) -> Result<(), Option<Value>> {
    let fault = |message: &dyn std::fmt::Display| {
        Some(json!({ "message": format!("the run could not be made: {message}") }))
    };
    let mut child = command(server, words)
        .spawn()
        .map_err(|error| fault(&error))?;
    let input = child.stdin.take();
    let output = child
        .stdout
        .take()
        .ok_or_else(|| fault(&"it has no output"))?;
    let mut lines = BufReader::new(output).lines();
    let mut error = None;
    loop {
        let line = tokio::select! {
            line = lines.next_line() => line,
            () = server.jobs.cancel.notified() => {
                // It ends, and removes what it has written, when its input does.
                drop(input);
                if timeout(GRACE, child.wait()).await.is_err() {
                    let _ = child.kill().await;
                }
                return Err(None);
            }
        };
        let Ok(Some(line)) = line else { break };
        let Ok(mut event) = serde_json::from_str::<Value>(&line) else {
            continue;
        };
        let text = |name: &str| event[name].as_str().map(str::to_owned);
        warnings.extend(text("warn").or_else(|| text("problem")));
        let (stage, done) = (text("stage"), event["done"].as_u64());
        let total = event["total"].as_u64().unwrap_or(0);
        if !event["error"].is_null() {
            error = Some(event["error"].take());
        }
        let mut queue = server.jobs.queue();
        if let Some(running) = &mut queue.running {
            match (stage, done) {
                (Some(stage), _) => running.begin(&stage, total),
                (_, Some(done)) => running.done = done,
                _ => continue,
            }
            server.jobs.show(&queue);
        }
    }
    // It reads its input to the end, so it is open until here.
    let status = child.wait().await.map_err(|error| fault(&error))?;
    drop(input);
    match (status.success(), error) {
        (true, _) => Ok(()),
        (false, Some(error)) => Err(Some(error)),
        (false, None) => Err(fault(&format!("it ended with {status}"))),
    }
}

/// A command of this program in the folder that is served. It ends with the server, and Ctrl-C in the server's terminal
/// does not reach it before.
pub fn command(server: &Server, words: &[String]) -> Command {
    let mut command = Command::new(&server.program[0]);
    command
        .args(&server.program[1..])
        .args(words)
        .arg("--events")
        .current_dir(server.folder.root())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .kill_on_drop(true);
    #[cfg(unix)]
    command.process_group(0);
    command
}
