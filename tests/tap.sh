# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the shell tests: one TAP line a check, exit code 1 if any failed.
# shellcheck shell=sh
tap_count=0
tap_failed=0

ok() {
    tap_count=$((tap_count + 1))
    echo "ok $tap_count - $1"
}

# not_ok NAME [detail, may have lines]
not_ok() {
    tap_count=$((tap_count + 1))
    tap_failed=$((tap_failed + 1))
    echo "not ok $tap_count - $1"
    [ -z "${2:-}" ] || printf '%s\n' "$2" | sed 's/^/#   /'
}

# check NAME command...: ok if the command succeeds
check() {
    tap_name=$1
    shift
    if tap_text=$("$@" 2>&1); then ok "$tap_name"; else not_ok "$tap_name" "$tap_text"; fi
}

tap_end() {
    echo "1..$tap_count"
    [ "$tap_failed" -eq 0 ] && [ "$tap_count" -gt 0 ]
}

# Meson gives paths from its build folder.
absolute() { echo "$(cd "$(dirname "$1")" && pwd)/$(basename "$1")"; }

skip_all() {
    echo "1..0 # SKIP $1"
    exit 77
}

# A folder of our own, gone at the end.
tap_folder() {
    tap_tmp=$(mktemp -d)
    trap 'rm -rf "$tap_tmp"' EXIT
    cd "$tap_tmp" || exit 99
}
