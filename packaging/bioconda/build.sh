#!/bin/bash
set -euo pipefail
cargo-bundle-licenses --format yaml --output THIRDPARTY.yml
# Without `gpu`: the machines that build packages have no graphics drivers to link against, and clusters rarely do.
cargo install --no-track --locked --no-default-features --features serve --root "$PREFIX" --path cli
mkdir -p "$PREFIX/share/bash-completion/completions" "$PREFIX/share/zsh/site-functions" "$PREFIX/share/man/man1"
"$PREFIX/bin/knotdock" completions bash >"$PREFIX/share/bash-completion/completions/knotdock"
"$PREFIX/bin/knotdock" completions zsh >"$PREFIX/share/zsh/site-functions/_knotdock"
"$PREFIX/bin/knotdock" man "$PREFIX/share/man/man1"
