#!/usr/bin/env bash
# Checks knotdock on this machine's graphics processor, then times it: pack.sh makes this folder.
# Tables go to the terminal and to results.md, and what they hold to results.json, in the folder of the first argument
# (default: this one).
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
out=${1:-$here}
mkdir -p "$out"
export KNOTDOCK_NEEDS_GPU=1
"$here/checks" gpu:: processor:: --quiet
files=()
for receptor in "$here"/pairs/*_receptor.pdb; do
    files+=("$receptor" "${receptor%_receptor.pdb}_ligand.pdb")
done
"$here/times" --json "$out/results.json" "${files[@]}" | tee "$out/results.md"
pair=("$here/pairs/1PPE_receptor.pdb" "$here/pairs/1PPE_ligand.pdb")
"$here/knotdock" dock "${pair[@]}" --engine gpu --raw --force -o "$out/docked" -v 2>&1 | tee -a "$out/results.md"
