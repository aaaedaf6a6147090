#!/usr/bin/env bash
# What checks and times knotdock on a graphics processor, in one folder for a machine without cargo and network:
#
#     scripts/gpu/pack.sh [FOLDER] [NAME=RECEPTOR,LIGAND]...
#
# FOLDER is target/gpu-pack by default. `FOLDER/run` needs a driver for Vulkan and nothing else. It docks the example pair,
# and times it and the pairs named here.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
folder=target/gpu-pack
case "${1:-}" in *=* | "") ;; *) folder=$1 && shift ;; esac
export CARGO_PROFILE_RELEASE_STRIP=symbols

# The executables that a build makes.
built() {
    cargo "$@" --locked --message-format=json-render-diagnostics |
        python3 -c 'import json, sys; [print(line["executable"]) for line in map(json.loads, sys.stdin) if line.get("executable")]'
}
# Assigned before they are copied, so that a build that fails ends this script.
checks=$(built test --release --no-run --package knotdock-scoring --features gpu --test all)
times=$(built bench --no-run --package knotdock-cli --bench graphics)
program=$(built build --release --package knotdock-cli)

rm -rf "$folder"
mkdir -p "$folder/pairs"
cp "$checks" "$folder/checks"
cp "$times" "$folder/times"
cp "$program" "$folder/knotdock"
cp scripts/gpu/run.sh "$folder/run"
cp structures/examples/1ppe_receptor_unbound.pdb "$folder/pairs/1PPE_receptor.pdb"
cp structures/examples/1ppe_ligand_unbound.pdb "$folder/pairs/1PPE_ligand.pdb"
for pair; do
    files=${pair#*=}
    cp "${files%,*}" "$folder/pairs/${pair%%=*}_receptor.pdb"
    cp "${files#*,}" "$folder/pairs/${pair%%=*}_ligand.pdb"
done
du -sh "$folder"
