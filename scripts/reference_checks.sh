#!/usr/bin/env bash
# Checks against other programs and by hand, by Python in virtual environments of their own under target/. Needs python3 with venv.
set -euo pipefail
shopt -s inherit_errexit
cd "$(dirname "${BASH_SOURCE[0]}")/.."

target=${CARGO_TARGET_DIR:-target}
# Prints the Python that has what scripts/checks/requirements_NAME.txt names, each file of it by its hash.
python() {
    local venv=$target/python/$1 requirements=scripts/checks/requirements_$1.txt
    if ! cmp --silent "$requirements" "$venv/installed.txt"; then
        rm -rf "$venv"
        python3 -m venv "$venv"
        "$venv/bin/pip" install --quiet --disable-pip-version-check --requirement "$requirements"
        cp "$requirements" "$venv/installed.txt"
    fi
    echo "$venv/bin/python"
}
# The tests build the program; building it alone would compile some of its dependencies again with fewer features.
cargo test --workspace --no-run --quiet --locked
example=structures/examples/1ppe
# Either may be called the receptor.
for sides in "receptor ligand" "ligand receptor"; do
    read -r first second <<<"$sides"
    "$(python dockq)" scripts/checks/check_dockq.py "$target/debug/knotdock" \
        "${example}_${first}_unbound.pdb" "${example}_${second}_unbound.pdb" \
        "${example}_${first}_bound.pdb" "${example}_${second}_bound.pdb"
done
"$(python dockq)" scripts/checks/check_atom_pairs.py
"$(python dockq)" scripts/reference/pair_sum.py "$target/debug/knotdock"
"$(python rdkit)" scripts/checks/check_rdkit.py "$target/debug/knotdock" structures/examples
# The full set of files, five times as many, goes without --few.
"$(python gemmi)" scripts/checks/check_gemmi.py "$target/debug/knotdock" "$target/stress" --few
"$(python gemmi)" scripts/checks/check_assemblies.py "$target/debug/knotdock" "$target/stress" --few
# The full set, 1,000 poses of each pair of solids, goes without --poses.
"$(python solids)" scripts/checks/check_solids.py "$target/debug/knotdock" structures/examples/bunny.obj --poses 100
