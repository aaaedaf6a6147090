//! The machine of a run: its threads, and the memory that is free.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use knotdock::dock::memory::process;
use knotdock::options::MachineOptions;
use knotdock::options::values::{AT_LEAST_ONE, in_range};
use knotdock::threads;

/// Threads of a command.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Machine")]
pub struct Threads {
    /// Threads [default: all hardware threads].
    #[arg(short = 'j', long, value_name = "COUNT", value_parser = in_range::<usize>(AT_LEAST_ONE))]
    pub threads: Option<usize>,
}

impl Threads {
    pub fn count(self) -> usize {
        threads::or_all(self.threads)
    }
}

/// The options of the machine with all that they leave open.
pub fn settled(options: &MachineOptions) -> MachineOptions {
    MachineOptions {
        threads: Some(options.thread_count()),
        memory: options.memory.or_else(default_limit),
    }
}

/// Share of the free memory that a run may take when the user names no size.
const DEFAULT_SHARE: f64 = 0.8;

/// Memory of a run by default, in bytes: 80% of the free memory, and that of the process. `None` if unknown.
pub fn default_limit() -> Option<u64> {
    let free = free_memory(Path::new("/"))?;
    Some((free as f64 * DEFAULT_SHARE) as u64 + process::held().unwrap_or(0))
}

/// Free memory in bytes, of the machine or of the control groups if that is less; `None` off Linux. `root` is `/`.
fn free_memory(root: &Path) -> Option<u64> {
    let meminfo = fs::read_to_string(root.join("proc/meminfo")).ok()?;
    let available = keyed(&meminfo, "MemAvailable:")?.saturating_mul(1024);
    let groups = control_groups(root)
        .into_iter()
        .filter_map(|group| group.free())
        .min();
    Some(groups.map_or(available, |free| free.min(available)))
}

/// A control group's folder, and the names there of its limit, its usage, and its file cache in `memory.stat`.
struct ControlGroup {
    folder: PathBuf,
    names: [&'static str; 3],
}

const VERSION_1: [&str; 3] = [
    "memory.limit_in_bytes",
    "memory.usage_in_bytes",
    "total_inactive_file",
];
const VERSION_2: [&str; 3] = ["memory.max", "memory.current", "inactive_file"];

impl ControlGroup {
    /// Bytes left under the group's limit; its file cache counts as free, since the kernel gives it up first.
    fn free(&self) -> Option<u64> {
        let read = |name| fs::read_to_string(self.folder.join(name)).ok();
        let [limit, usage, cache] = self.names;
        let limit: u64 = read(limit)?.trim().parse().ok()?; // "max" is no limit
        let usage: u64 = read(usage)?.trim().parse().ok()?;
        let cache = read("memory.stat")
            .and_then(|stat| keyed(&stat, cache))
            .unwrap_or(0);
        Some(limit.saturating_sub(usage.saturating_sub(cache)))
    }
}

/// The groups that bound this process: its own and every one above, in version 1 and 2 alike. A container may see
/// its own group as the top of the tree, so the top is always among them.
fn control_groups(root: &Path) -> Vec<ControlGroup> {
    let Ok(membership) = fs::read_to_string(root.join("proc/self/cgroup")) else {
        return Vec::new();
    };
    let mut groups = Vec::new();
    for line in membership.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else {
            continue;
        };
        let version_2 = controllers.is_empty();
        if !version_2 && !controllers.split(',').any(|name| name == "memory") {
            continue;
        }
        let mount = root.join(if version_2 {
            "sys/fs/cgroup"
        } else {
            "sys/fs/cgroup/memory"
        });
        let own = mount.join(path.trim_start_matches('/'));
        for folder in own
            .ancestors()
            .take_while(|folder| folder.starts_with(&mount))
        {
            groups.push(ControlGroup {
                folder: folder.to_owned(),
                names: if version_2 { VERSION_2 } else { VERSION_1 },
            });
        }
    }
    groups
}

/// The number that follows `key` at the start of a line.
fn keyed(text: &str, key: &str) -> Option<u64> {
    text.lines().find_map(|line| {
        let mut words = line.split_whitespace();
        (words.next() == Some(key)).then(|| words.next()?.parse().ok())?
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(root: &Path, path: &str, text: &str) {
        let path = root.join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    #[test]
    fn the_tightest_of_the_machine_and_its_groups_counts() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path();
        assert_eq!(free_memory(root), None);
        file(
            root,
            "proc/meminfo",
            "MemTotal: 9000 kB\nMemAvailable: 8000 kB\n",
        );
        assert_eq!(free_memory(root), Some(8_000 * 1024));

        // Version 2: the group itself is unlimited, the one above is not.
        file(root, "proc/self/cgroup", "0::/slice/job\n");
        file(root, "sys/fs/cgroup/slice/job/memory.max", "max\n");
        file(root, "sys/fs/cgroup/slice/job/memory.current", "1000\n");
        file(root, "sys/fs/cgroup/slice/memory.max", "5000\n");
        file(root, "sys/fs/cgroup/slice/memory.current", "4000\n");
        file(
            root,
            "sys/fs/cgroup/slice/memory.stat",
            "anon 1500\ninactive_file 2500\n",
        );
        assert_eq!(free_memory(root), Some(5000 - 4000 + 2500));

        // Version 1 inside a container: the path is the host's, the mount shows the group as its top.
        file(root, "proc/self/cgroup", "7:cpu:/\n4:memory:/docker/abc\n");
        file(root, "sys/fs/cgroup/memory/memory.limit_in_bytes", "3000\n");
        file(root, "sys/fs/cgroup/memory/memory.usage_in_bytes", "500\n");
        file(
            root,
            "sys/fs/cgroup/memory/memory.stat",
            "total_inactive_file 100\n",
        );
        assert_eq!(free_memory(root), Some(3000 - 500 + 100));
    }
}
