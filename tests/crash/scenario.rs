//! A command that is ended, or fails, at each of its changes to the disk.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::atomic::{AtomicUsize, Ordering};

use assert_cmd::cargo::cargo_bin_cmd;

use super::folder::{Snapshot, copy};

/// The files that must be whole together after a crash.
#[derive(Clone, Copy, PartialEq)]
enum Stands {
    /// The old or the new state of all files; the old one may be aside.
    Whole,
    /// That of each file by itself.
    EachFile,
    /// The old files, and any of the new ones.
    Added,
    /// That of each of these directories.
    EachDirectory(&'static [&'static str]),
}

/// A command in a folder.
pub struct Scenario {
    template: tempfile::TempDir,
    command: String,
    variable: Option<(&'static str, &'static str)>,
    stands: Stands,
    /// Whether the new files hold times, so that they differ from call to call.
    measured: bool,
}

/// Runs the program in a folder; it must succeed.
pub fn run(folder: &Path, command: &str) -> Output {
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args(command.split_whitespace())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command}: {text}");
    output
}

impl Scenario {
    pub fn new(prepare: impl Fn(&Path), command: &str) -> Self {
        let template = tempfile::tempdir().unwrap();
        prepare(template.path());
        Self {
            template,
            command: command.to_owned(),
            variable: None,
            stands: Stands::Whole,
            measured: false,
        }
    }

    pub fn with_variable(mut self, name: &'static str, value: &'static str) -> Self {
        self.variable = Some((name, value));
        self
    }

    pub fn by_file(mut self) -> Self {
        self.stands = Stands::EachFile;
        self
    }

    pub fn additive(mut self) -> Self {
        self.stands = Stands::Added;
        self
    }

    pub fn by_directory(mut self, directories: &'static [&'static str]) -> Self {
        self.stands = Stands::EachDirectory(directories);
        self
    }

    pub fn measured(mut self) -> Self {
        self.measured = true;
        self
    }

    /// A fresh copy of the folder. Its path is the same for all, so that what the program writes is.
    pub fn fresh(&self, root: &Path) -> PathBuf {
        let folder = root.join("here");
        if folder.exists() {
            fs::remove_dir_all(&folder).unwrap();
        }
        copy(self.template.path(), &folder);
        folder
    }

    /// The exit code and the messages.
    pub fn call(&self, folder: &Path, variables: &[(&str, &str)]) -> (Option<i32>, String) {
        let mut command = cargo_bin_cmd!("knotdock");
        command
            .current_dir(folder)
            .args(self.command.split_whitespace());
        command.args(if self.command.starts_with("batch") {
            [""; 0].as_slice()
        } else {
            &["--json"]
        });
        for (name, value) in variables.iter().copied().chain(self.variable) {
            command.env(name, value);
        }
        let output = command.output().unwrap();
        let said =
            String::from_utf8_lossy(&output.stderr) + String::from_utf8_lossy(&output.stdout);
        (output.status.code(), said.into_owned())
    }

    /// The changes of an uninterrupted call, a line each.
    pub fn changes(&self) -> Vec<String> {
        let root = tempfile::tempdir().unwrap();
        let folder = self.fresh(root.path());
        let log = root.path().join("log");
        let (code, said) = self.call(&folder, &[("KNOTDOCK_FAULT_LOG", &log.to_string_lossy())]);
        assert_eq!(code, Some(0), "{said}");
        let text = fs::read_to_string(log).unwrap();
        text.lines().map(str::to_owned).collect()
    }

    /// Ends the command at each change, and has each change fail.
    pub fn check(&self) {
        let changes = self.changes();
        assert!(changes.len() > 5, "{changes:#?}");
        let root = tempfile::tempdir().unwrap();
        let folder = self.fresh(root.path());
        let old = Snapshot::of(&folder);
        let (code, said) = self.call(&folder, &[]);
        assert_eq!(code, Some(0), "{said}");
        let new = Snapshot::of(&folder);
        assert!(!new.has_litter(), "{:?}", new.0.keys());
        assert_ne!(old.difference(&new), "");
        let next = AtomicUsize::new(1);
        // Processes wait for the device more than they compute.
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    let root = tempfile::tempdir().unwrap();
                    loop {
                        let change = next.fetch_add(1, Ordering::Relaxed);
                        let Some(line) = changes.get(change - 1) else {
                            break;
                        };
                        let what = format!("change {change}, {line}, of {}", self.command);
                        self.check_kill(root.path(), change, (&old, &new), &what);
                        let is_sync = line.starts_with("sync");
                        self.check_failure(root.path(), (change, is_sync), (&old, &new), &what);
                    }
                });
            }
        });
    }

    fn check_kill(
        &self,
        root: &Path,
        change: usize,
        (old, new): (&Snapshot, &Snapshot),
        what: &str,
    ) {
        let folder = self.fresh(root);
        let (code, said) = self.call(&folder, &[("KNOTDOCK_FAULT", &format!("kill {change}"))]);
        assert_eq!(code, Some(137), "kill at {what}: {said}");
        let killed = Snapshot::of(&folder).put_back();
        self.check_stands(&killed.clone().without_litter(), (old, new), what);
        let (code, said) = self.call(&folder, &[]);
        // Where the killed call had come to its end, the second finds its run in the way.
        let is_done = said.contains("already holds a run");
        assert!(
            code == Some(0) || is_done,
            "second call after a kill at {what}: {said}"
        );
        let found = Snapshot::of(&folder);
        let words = (!is_done).then_some(said.as_str());
        check_leftovers(&killed, &found, words, what);
        // That of a pair of a batch whose run is there already is not needed again.
        let is_needed = !matches!(self.stands, Stands::EachDirectory(_));
        let is_lock = |path: &&String| path.ends_with(".knotdock-lock");
        let mut locks = found.0.keys().filter(is_lock);
        assert!(
            locks.all(|lock| !is_needed && killed.0.contains_key(lock)),
            "{what}: {:?}",
            found.0.keys()
        );
        self.check_new(&found.without_litter(), new, what);
    }

    fn check_failure(
        &self,
        root: &Path,
        (change, is_sync): (usize, bool),
        (old, new): (&Snapshot, &Snapshot),
        what: &str,
    ) {
        let folder = self.fresh(root);
        let (code, said) = self.call(&folder, &[("KNOTDOCK_FAULT", &format!("fail {change}"))]);
        assert!(!said.contains("panicked"), "failure of {what}: {said}");
        let found = Snapshot::of(&folder);
        // One that only tidies up after the end fails nothing, and may leave what the next call reports.
        if code == Some(0) {
            self.check_new(&found.without_litter(), new, what);
            return;
        }
        assert!(
            matches!(code, Some(1 | 2)),
            "failure of {what}: {code:?} {said}"
        );
        assert!(
            !found.has_litter(),
            "failure of {what}: {:?}",
            found.0.keys()
        );
        match self.stands {
            // All is in its place before the folder above it is on the device.
            Stands::Whole if is_sync && found.difference(new).is_empty() => {}
            // What a failure undoes it undoes at once.
            Stands::Whole => {
                assert_eq!(found.difference(old), "", "failure of {what}: {said}");
            }
            _ => self.check_stands(&found, (old, new), what),
        }
    }

    fn check_new(&self, found: &Snapshot, new: &Snapshot, what: &str) {
        if self.measured {
            assert!(
                found.0.keys().eq(new.0.keys()),
                "{what}: {:?}",
                found.0.keys()
            );
        } else {
            assert_eq!(found.difference(new), "", "{what}");
        }
    }

    fn check_stands(&self, found: &Snapshot, (old, new): (&Snapshot, &Snapshot), what: &str) {
        let is_one = |found: &Snapshot, old: &Snapshot, new: &Snapshot| {
            let keys_alike = self.measured && found.0.keys().eq(new.0.keys());
            found == old || found == new || keys_alike
        };
        match self.stands {
            // Folders above the run's may be there already.
            Stands::Whole => {
                let files = |snapshot: &Snapshot| {
                    let mut snapshot = snapshot.clone();
                    snapshot.0.retain(|_, text| text != "folder");
                    snapshot
                };
                let [found, old, new] = [found, old, new].map(files);
                let stands = is_one(&found, &old, &new);
                let differences = [found.difference(&old), found.difference(&new)];
                assert!(stands, "{what}: {differences:?}");
            }
            Stands::EachFile => {
                for (path, text) in &found.0 {
                    let stands = [old, new].iter().any(|one| one.0.get(path) == Some(text));
                    assert!(stands, "{path} after {what}");
                }
                assert!(
                    old.0.keys().all(|path| found.0.contains_key(path)),
                    "{what}"
                );
            }
            Stands::Added => {
                for (path, text) in &found.0 {
                    assert_eq!(Some(text), new.0.get(path), "{path} after {what}");
                }
                assert!(
                    old.0.keys().all(|path| found.0.contains_key(path)),
                    "{what}"
                );
            }
            Stands::EachDirectory(directories) => {
                for directory in directories {
                    let [found, old, new] = [found, old, new].map(|one| one.below(directory));
                    assert!(
                        is_one(&found, &old, &new),
                        "{directory} after {what}: {}",
                        found.difference(&new)
                    );
                }
            }
        }
    }
}

/// What a killed call left stays as it is, and the next one names it.
fn check_leftovers(killed: &Snapshot, found: &Snapshot, said: Option<&str>, what: &str) {
    let (before, after) = (killed.leftovers(), found.leftovers());
    assert!(after.is_subset(&before), "{what}: {after:?}");
    for left in before {
        // Of an older run that is aside, and whose place is taken, the rest may go.
        if left.ends_with("-old") && !after.contains(left) {
            continue;
        }
        let difference = found.below(left).difference(&killed.below(left));
        assert_eq!(difference, "", "{left} after {what}");
        let name = left.rsplit('/').next().unwrap_or(left);
        let is_named = said.is_none_or(|said| said.contains(name));
        assert!(is_named, "{left} is not named after {what}: {said:?}");
    }
}
