#!/usr/bin/env bash
# Checks the module of HADDOCK3 with HADDOCK3 from PyPI, in a virtual environment under target/. Needs python3 (3.11 or
# later) with venv, and the program in target/debug (or in KNOTDOCK). HADDOCK3's package has the program CNS, free of
# use for non-profit purposes. The workflow makes topologies and minimises models with it.
#
#     packaging/haddock3/check.sh              the checks
#     packaging/haddock3/check.sh --install    make the environment, and check nothing
set -euo pipefail
shopt -s inherit_errexit
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

folder=packaging/haddock3
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
venv=$target/python/haddock3
wanted=$(cat $folder/requirements.txt $folder/haddock3.txt)
if [ "$wanted" != "$(cat "$venv/installed.txt" 2>/dev/null)" ]; then
    rm -rf "$venv"
    python3 -m venv "$venv"
    pip=("$venv/bin/pip" --quiet --disable-pip-version-check)
    "${pip[@]}" install --no-compile --requirement $folder/requirements.txt
    # Building HADDOCK3 downloads a program from GitHub that no workflow runs, so its source is unpacked instead.
    "${pip[@]}" download --no-deps --no-build-isolation --dest "$venv/source" --requirement $folder/haddock3.txt
    packages=$("$venv/bin/python" -c 'import sysconfig; print(sysconfig.get_paths()["purelib"])')
    archive=$(ls "$venv"/source/haddock3-*.tar.gz)
    tar -xzf "$archive" --strip-components 2 -C "$packages" "$(basename "$archive" .tar.gz)/src"
    rm -rf "$venv/source"
    echo "$wanted" >"$venv/installed.txt"
fi
[ "${1:-}" != --install ] || exit 0

"$venv/bin/python" $folder/install.py
# The module looks on the PATH.
ln -sf "$(realpath "${KNOTDOCK:-$target/debug/knotdock}")" "$venv/bin/knotdock"
PATH=$venv/bin:$PATH "$venv/bin/python" $folder/check.py structures/examples/1ppe_receptor_unbound.pdb \
    structures/examples/1ppe_ligand_unbound.pdb
