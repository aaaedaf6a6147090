# Sourced by other scripts.

# Runs functions beside each other; the output of each comes in one piece. Fails if one of them fails.
side_by_side() {
    local output part failed=0
    output=$(mktemp -d)
    local -A running=()
    for part in "$@"; do
        (set -e; "$part") >"$output/$part" 2>&1 &
        running[$part]=$!
    done
    for part in "$@"; do
        wait "${running[$part]}" || failed=1
        printf '\n== %s\n' "$part"
        cat "$output/$part"
    done
    rm -rf "$output"
    return "$failed"
}
