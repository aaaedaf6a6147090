# The commands that people repeat. `just` lists them.

default:
    @just --list

# Everything that must pass before a change lands
ci:
    .ci/run

# All tests
test:
    cargo test --workspace

# Layout and lints
lint:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings

# What is promised, tried many times (at most 20 minutes); writes the table of docs/method/trust.md
trust *options:
    cargo build --release
    scripts/checks/trust.py target/release/knotdock --write docs/method/trust.md {{options}}

# The Python package: its tests, types and README, and the recipes for clusters
python *options:
    scripts/python_checks.sh {{options}}

# The sampler for HADDOCK3, with HADDOCK3 from PyPI
haddock3:
    packaging/haddock3/check.sh

# Layout and lints of the scripts; needs ruff (PyPI)
lint-scripts:
    ruff format --check scripts python packaging --config scripts/ruff.toml
    ruff check scripts python packaging --config scripts/ruff.toml

# The documentation as a site, in target/book; needs mdBook (cargo install mdbook)
docs *options:
    mdbook build docs {{options}}

# Documentation of the crates
doc:
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps

# Dock the example pair into ./example
example:
    cargo run --release -- dock structures/examples/1ppe_receptor_unbound.pdb structures/examples/1ppe_ligand_unbound.pdb -o example --force

# Dock a benchmark folder; options of the script follow
benchmark dir *options:
    cargo build --release
    python3 scripts/benchmark/benchmark.py {{dir}} --knotdock target/release/knotdock {{options}}

# A graphics processor: checked against the CPU, then timed beside it
gpu: gpu-pack
    KNOTDOCK_NEEDS_GPU=1 cargo test -p knotdock-cli --test all graphics
    target/gpu-pack/run

# All but the first line of `just gpu` in a folder, for a machine without cargo: scripts/gpu/pack.sh says how
gpu-pack:
    scripts/gpu/pack.sh
