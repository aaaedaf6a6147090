#!/usr/bin/env bash
# Checks against other programs and by hand, by Python in virtual environments of their own under target/. Needs python3
# with venv. With --install it makes the environments and checks nothing.
set -euo pipefail
shopt -s inherit_errexit
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. scripts/side_by_side.sh

target=${CARGO_TARGET_DIR:-target}
knotdock=$target/debug/knotdock
# Makes an environment: NAME, then those of scripts/checks/requirements_*.txt that it has, each file of it by its hash.
install() {
    local venv=$target/python/$1 files=()
    for name in "${@:2}"; do files+=(--requirement "scripts/checks/requirements_$name.txt"); done
    local wanted
    wanted=$(for name in "${@:2}"; do cat "scripts/checks/requirements_$name.txt"; done)
    if [ "$wanted" != "$(cat "$venv/installed.txt" 2>/dev/null)" ]; then
        rm -rf "$venv"
        python3 -m venv "$venv"
        "$venv/bin/pip" install --quiet --disable-pip-version-check --no-compile "${files[@]}"
        echo "$wanted" >"$venv/installed.txt"
    fi
}
# DockQ wants an older numpy than the rest.
install dockq dockq
install others rdkit gemmi solids biotite
install deny deny
[ "${1:-}" != --install ] || exit 0
old_numpy() { "$target/python/dockq/bin/python" "$@"; }
python() { "$target/python/others/bin/python" "$@"; }

# The tests build the program; building it alone would compile some of its dependencies again with fewer features.
cargo test --workspace --no-run --quiet --locked
example=structures/examples/1ppe
poses() {
    # Either may be called the receptor.
    for sides in "receptor ligand" "ligand receptor"; do
        read -r first second <<<"$sides"
        old_numpy scripts/checks/check_dockq.py "$knotdock" \
            "${example}_${first}_unbound.pdb" "${example}_${second}_unbound.pdb" \
            "${example}_${first}_bound.pdb" "${example}_${second}_bound.pdb"
    done
    old_numpy scripts/checks/check_atom_pairs.py
    old_numpy scripts/reference/pair_sum.py "$knotdock"
}
shapes() {
    python scripts/checks/check_rdkit.py "$knotdock" structures/examples
    python scripts/checks/check_interface.py "$knotdock" structures/examples
}
# The full set of files, five times as many, goes without --few.
files() {
    python scripts/checks/check_gemmi.py "$knotdock" "$target/stress" --few
    python scripts/checks/check_assemblies.py "$knotdock" "$target/stress" --few
}
# The full set, 1,000 poses of each pair of solids, goes without --poses.
solids() { python scripts/checks/check_solids.py "$knotdock" structures/examples/bunny.obj --poses 100; }

# They wait for files and for the network.
side_by_side poses shapes files solids
