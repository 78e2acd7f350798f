#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# clang-tidy has nothing to say about the library, the RVEs and the tools (.clang-tidy).
# usage: tidy.sh ROOT BUILD
set -u
root=$1
build=$2
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
tidy=$(command -v clang-tidy-14 || command -v clang-tidy) || skip_all "no clang-tidy"
"$tidy" --version | grep -q 'version 14\.' || skip_all "clang-tidy is not version 14"
[ -f "$build/compile_commands.json" ] || skip_all "no compile_commands.json"
cd "$root" || exit 99

files=$(find lib rve tools -name '*.c' | sort)
# gcc's -Wdouble-promotion is quiet about NAN and INFINITY, clang's is not.
# shellcheck disable=SC2086
said=$(printf '%s\n' $files | xargs -P 2 -n 8 "$tidy" -p "$build" --quiet \
    --extra-arg=-Wno-double-promotion --extra-arg=-Wno-unknown-warning-option 2>/dev/null |
    grep -E '(error|warning): ' | sed "s#^$root/##; s#^.*/\.\./##" | sort -u)
if [ -z "$said" ]; then ok "clang-tidy"; else not_ok "clang-tidy" "$said"; fi
tap_end
