//! The program that wrote a record.

use serde::Serialize;

/// The program's version.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The git commit that the program was built from, or `unknown`.
pub const COMMIT: &str = env!("KNOTDOCK_COMMIT");

/// Version and commit as `--version` shows them.
pub const VERSION_WITH_COMMIT: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    " (",
    env!("KNOTDOCK_COMMIT"),
    ")"
);

/// The program, as records of runs and sweeps name it.
#[derive(Clone, Debug, Serialize)]
pub struct Program {
    program: &'static str,
    version: &'static str,
    commit: &'static str,
    cpu_features: String,
}

impl Program {
    /// This one.
    pub fn this() -> Self {
        Self {
            program: "knotdock",
            version: VERSION,
            commit: COMMIT,
            cpu_features: cpu_features(),
        }
    }
}

/// The instruction sets that select the transforms' code paths, which the last bits of a score can depend on.
pub fn cpu_features() -> String {
    #[cfg(target_arch = "x86_64")]
    let found = [
        ("sse4.1", std::arch::is_x86_feature_detected!("sse4.1")),
        ("avx", std::arch::is_x86_feature_detected!("avx")),
        ("fma", std::arch::is_x86_feature_detected!("fma")),
        ("avx2", std::arch::is_x86_feature_detected!("avx2")),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    let found: [(&str, bool); 0] = [];
    let mut names = vec![std::env::consts::ARCH];
    names.extend(found.iter().filter(|(_, on)| *on).map(|(name, _)| *name));
    names.join(" ")
}
