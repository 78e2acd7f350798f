#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What the shared library exports is what abi.txt lists: a symbol that goes breaks programs, one
# that comes is a promise. After a change that is meant:
#   nm -D --defined-only build/lib/libperihom.so | awk '{ print $3 }' | LC_ALL=C sort > tests/source/abi.txt
# usage: abi.sh ROOT LIBRARY
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
library=$(absolute "$2")
command -v nm >/dev/null || skip_all "no nm"
tap_folder
# A build with sanitizers or coverage exports symbols of its runtime too.
nm -D --defined-only "$library" | awk '$3 !~ /^(__asan|__ubsan|__tsan|__odr_asan|_init|_fini|__gcov|mangle_path)/ { print $3 }' |
    LC_ALL=C sort >exported
check "only symbols of ours" sh -c '! grep -v "^ph_" exported'
check "the exported symbols are those of abi.txt" diff "$root/tests/source/abi.txt" exported
declared() {
    sed -n 's/.*PH_API.*\(ph_[a-z0-9_]*\)[\[(;].*/\1/p' "$root"/lib/perihom/*.h | LC_ALL=C sort -u
}
declared >declared
check "every exported symbol is declared in a public header" sh -c '
    while read -r name; do
        grep -hq "\b$name\b" "$0"/lib/perihom/*.h || { echo "$name"; exit 1; }
    done <exported' "$root"
check "what a public header declares is exported" sh -c '! LC_ALL=C comm -23 declared exported | grep .'
tap_end
