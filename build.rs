//! Sets the git commit of the build; "unknown" outside this project's checkout or without git.

use std::path::Path;
use std::process::Command;

fn git(arguments: &[&str]) -> Option<String> {
    let directory = std::env::var_os("CARGO_MANIFEST_DIR")?;
    let output = Command::new("git")
        .arg("-C")
        .arg(directory)
        .args(arguments)
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

/// The commit, if this package's folder is itself the top of a checkout: a copy vendored into another project's
/// repository must not claim that project's commit.
fn commit() -> Option<String> {
    let package = std::env::var_os("CARGO_MANIFEST_DIR")?;
    let top = git(&["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != Path::new(&package).canonicalize().ok()? {
        return None;
    }
    git(&["rev-parse", "--short=12", "HEAD"])
}

fn main() {
    let commit = commit();
    println!("cargo::rerun-if-changed=build.rs");
    if commit.is_some() {
        // The reflog of HEAD changes with every commit and checkout, in a linked worktree too.
        for file in ["HEAD", "logs/HEAD"] {
            if let Some(path) = git(&["rev-parse", "--path-format=absolute", "--git-path", file])
                && Path::new(&path).exists()
            {
                println!("cargo::rerun-if-changed={path}");
            }
        }
    }
    println!(
        "cargo::rustc-env=KNOTDOCK_COMMIT={}",
        commit.as_deref().unwrap_or("unknown")
    );
}
