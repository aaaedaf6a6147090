#!/usr/bin/env bash
# Checks of the Python package and of the book, by Python in a virtual environment of its own under target/: the
# package's tests, types and README, the notebook and the commands of the book, and the recipes for clusters. Needs
# python3 (3.11 or later) with venv; the recipes need Slurm, for which Debian's slurm-wlm and munge are started as root,
# and are left out elsewhere.
#
#     scripts/python_checks.sh              the package as the tests' profile builds it, put together in a folder
#     scripts/python_checks.sh --wheel      the wheel, built by maturin with all optimisations and installed by pip
#     scripts/python_checks.sh --install    make the environment, and check nothing
set -euo pipefail
shopt -s inherit_errexit
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. scripts/side_by_side.sh

target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
venv=$target/python/package
wanted=$(cat scripts/checks/requirements_python.txt)
if [ "$wanted" != "$(cat "$venv/installed.txt" 2>/dev/null)" ]; then
    rm -rf "$venv"
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check --no-compile \
        --requirement scripts/checks/requirements_python.txt
    echo "$wanted" >"$venv/installed.txt"
fi
if [ ! -x "$(command -v slurmctld)" ] && [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    packages=(slurm-wlm munge)
    apt-get install --yes --quiet --no-install-recommends "${packages[@]}" ||
        { apt-get update --quiet && apt-get install --yes --quiet --no-install-recommends "${packages[@]}"; } || true
fi
[ "${1:-}" != --install ] || exit 0

packages=$("$venv/bin/python" -c 'import sysconfig; print(sysconfig.get_paths()["purelib"])')
"$venv/bin/pip" uninstall --quiet --yes --disable-pip-version-check knotdock 2>/dev/null || true
rm -rf "$packages/knotdock.pth" "$venv/bin/knotdock"
if [ "${1:-}" = --wheel ]; then
    wheels=$target/python/wheels
    rm -rf "$wheels"
    (cd python && "$venv/bin/maturin" build --quiet --locked --release --out "$wheels")
    "$venv/bin/pip" install --quiet --disable-pip-version-check --no-deps "$wheels"/*.whl
    program=$venv/bin/knotdock
else
    # Built with the tests, for maturin would ask for other features and compile all again.
    cargo build --workspace --lib --tests --quiet --locked
    site=$target/python/site
    rm -rf "$site"
    mkdir -p "$site"
    cp -r python/knotdock "$site/"
    cp "$target"/debug/lib_knotdock.so "$site/knotdock/_knotdock.abi3.so"
    echo "$site" >"$packages/knotdock.pth"
    printf '#!/bin/sh\nexec "%s" -m knotdock "$@"\n' "$venv/bin/python" >"$venv/bin/knotdock"
    chmod +x "$venv/bin/knotdock"
    program=$target/debug/knotdock
fi
# Away from the package's source, so that the installed package is the tested one.
root=$PWD tests=$PWD/python/tests package=$PWD/python/knotdock
cd "$target/python"
PATH=$venv/bin:$PATH
package_tests() {
    pytest --quiet --rootdir "$tests" --config-file /dev/null -p no:cacheprovider "$tests"
    pytest --quiet --config-file /dev/null -p no:cacheprovider --doctest-modules --pyargs knotdock
    mypy --no-error-summary --ignore-missing-imports "$package"
}
notebook() { jupyter execute "$root"/docs/guides/*.ipynb; }
# The commands of the book are run, and its reference must be that of the program.
book() {
    python "$root/scripts/checks/check_book.py" "$program"
    python "$root/scripts/book/write_reference.py" "$program" --check
}
clusters() {
    if [ -x "$(command -v slurmctld)" ] && [ "$(id -u)" = 0 ]; then
        python "$tests/../../scripts/checks/check_cluster.py" "$(mktemp -d)"
    else
        echo "No Slurm can be started here: the recipes for clusters are not checked."
    fi
}
# They wait for programs that they start.
side_by_side package_tests notebook book clusters
