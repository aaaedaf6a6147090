#!/usr/bin/env bash
# Checks of the Python package, by Python in a virtual environment of its own under target/: the wheel is built and
# installed, and its tests and the recipes for clusters run. Needs python3 with venv; the recipes need Slurm, for which
# Debian's slurm-wlm and munge are started as root, and are left out elsewhere. With --install it makes the environment
# and checks nothing.
set -euo pipefail
shopt -s inherit_errexit
cd "$(dirname "${BASH_SOURCE[0]}")/.."

target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
venv=$target/python/package
wanted=$(cat scripts/checks/requirements_python.txt)
if [ "$wanted" != "$(cat "$venv/installed.txt" 2>/dev/null)" ]; then
    rm -rf "$venv"
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check --requirement scripts/checks/requirements_python.txt
    echo "$wanted" >"$venv/installed.txt"
fi
if [ ! -x "$(command -v slurmctld)" ] && [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    packages=(slurm-wlm munge)
    apt-get install --yes --quiet --no-install-recommends "${packages[@]}" ||
        { apt-get update --quiet && apt-get install --yes --quiet --no-install-recommends "${packages[@]}"; } || true
fi
[ "${1:-}" != --install ] || exit 0

wheels=$target/python/wheels
rm -rf "$wheels"
# The profile of the tests, so that little is compiled anew.
(cd python && "$venv/bin/maturin" build --quiet --locked --profile dev --out "$wheels")
"$venv/bin/pip" install --quiet --disable-pip-version-check --force-reinstall --no-deps "$wheels"/*.whl
# Away from the package's source, so that what is installed is what is tested.
tests=$PWD/python/tests readme=$PWD/python/README.md package=$PWD/python/knotdock
cd "$target/python"
PATH=$venv/bin:$PATH
pytest --quiet --rootdir "$tests" --config-file /dev/null -p no:cacheprovider "$tests"
pytest --quiet --config-file /dev/null -p no:cacheprovider --doctest-modules --pyargs knotdock
pytest --quiet --config-file /dev/null -p no:cacheprovider --doctest-glob='*.md' "$readme"
mypy --no-error-summary --ignore-missing-imports "$package"
if [ -x "$(command -v slurmctld)" ] && [ "$(id -u)" = 0 ]; then
    python "$tests/../../scripts/checks/check_cluster.py" "$(mktemp -d)"
else
    echo "No Slurm can be started here: the recipes for clusters are not checked."
fi
