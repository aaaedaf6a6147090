#!/usr/bin/env bash
# Checks against other programs, by Python in a virtual environment of its own under target/. Needs python3 with venv.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

target=${CARGO_TARGET_DIR:-target}
venv=$target/python
if ! cmp --silent scripts/requirements.txt "$venv/installed.txt"; then
    rm -rf "$venv"
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check --requirement scripts/requirements.txt
    cp scripts/requirements.txt "$venv/installed.txt"
fi
# The tests build the program; building it alone would compile some of its dependencies again with fewer features.
cargo test --workspace --no-run --quiet --locked
example=structures/examples/1ppe
"$venv/bin/python" scripts/check_dockq.py "$target/debug/knotdock" \
    "${example}_receptor_unbound.pdb" "${example}_ligand_unbound.pdb" \
    "${example}_receptor_bound.pdb" "${example}_ligand_bound.pdb"
