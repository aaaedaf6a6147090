#!/usr/bin/env bash
# Checks against other programs, by Python in a virtual environment of its own under target/. Needs python3 with venv.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

venv=target/python
if ! cmp --silent scripts/requirements.txt "$venv/installed.txt"; then
    rm -rf "$venv"
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check --requirement scripts/requirements.txt
    cp scripts/requirements.txt "$venv/installed.txt"
fi
for check in scripts/check_*.py; do
    echo "-- $check"
    "$venv/bin/python" "$check"
done
