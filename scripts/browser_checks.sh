#!/usr/bin/env bash
# Clicks through reports and the page of `knotdock serve` in headless Chromium. Needs node and npm (20 or later) and Debian's package chromium, or
# CHROMIUM set to one; and the program as the tests build it. With --install it fetches what npm has and checks nothing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

target=$(realpath --canonicalize-missing "${CARGO_TARGET_DIR:-target}")
if [ ! -d viewer/node_modules ] || [ viewer/package-lock.json -nt viewer/node_modules/.package-lock.json ]; then
    npm ci --ignore-scripts --prefix viewer --no-audit --no-fund --silent
fi
[ "${1:-}" != --install ] || exit 0

cargo test --workspace --no-run --quiet --locked
node viewer/test/make.mjs "$target/debug/knotdock" "$target/reports"
KNOTDOCK=$target/debug/knotdock REPORTS=$target/reports npm test --prefix viewer
