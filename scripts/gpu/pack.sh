#!/usr/bin/env bash
# What checks and times knotdock on a graphics processor, in one folder for a machine without cargo and network:
#
#     scripts/gpu/pack.sh [FOLDER] [NAME=RECEPTOR,LIGAND]...
#
# FOLDER is target/gpu-pack by default. `FOLDER/run` needs a driver for Vulkan with its loader (libvulkan.so.1), and a
# glibc no older than this machine's. It docks the example pair, and times it and the pairs named here.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
folder=$root/target/gpu-pack
case "${1:-}" in *=* | "") ;; *) folder=$(realpath -m "$1") && shift ;; esac
if [ -e "$folder" ] && [ ! -e "$folder/checks" ]; then
    echo "$folder exists and is no such folder: remove it, or name another" >&2
    exit 2
fi
rm -rf "$folder"
mkdir -p "$folder/pairs"
for pair; do
    files=${pair#*=}
    cp "${files%,*}" "$folder/pairs/${pair%%=*}_receptor.pdb"
    cp "${files#*,}" "$folder/pairs/${pair%%=*}_ligand.pdb"
done

cd "$root"
export CARGO_PROFILE_RELEASE_STRIP=symbols
# Builds, and copies the executable of a name to a place.
built() {
    local name=$1 to=$2 executable
    shift 2
    executable=$(cargo "$@" --locked --message-format=json-render-diagnostics | python3 -c '
import json, sys
for line in map(json.loads, sys.stdin):
    if line.get("executable") and line["target"]["name"] == sys.argv[1]:
        print(line["executable"])' "$name")
    cp "$executable" "$folder/$to"
}
built all checks test --release --no-run --package knotdock-scoring --features gpu --test all
built graphics times bench --no-run --package knotdock-cli --bench graphics
built knotdock knotdock build --release --package knotdock-cli

cp scripts/gpu/run.sh "$folder/run"
cp structures/examples/1ppe_receptor_unbound.pdb "$folder/pairs/1PPE_receptor.pdb"
cp structures/examples/1ppe_ligand_unbound.pdb "$folder/pairs/1PPE_ligand.pdb"
du -sh "$folder"
