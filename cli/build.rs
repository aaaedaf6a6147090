//! With the feature `viewer`, checks that the embedded files are there.

use std::path::Path;

/// Embedded by the feature `viewer`: npm's package 3dmol.
const VIEWER: &str = "../viewer/node_modules/3dmol/build/3Dmol-min.js";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var_os("CARGO_FEATURE_VIEWER").is_some() {
        println!("cargo::rerun-if-changed={VIEWER}");
        if !Path::new(VIEWER).is_file() {
            println!(
                "cargo::error=the feature `viewer` embeds 3dmol: run `npm ci --prefix viewer` first"
            );
        }
    }
}
