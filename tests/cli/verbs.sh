#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The help of every verb: on stdout, exit code 0, the same from both ways, with one line that
# says what it does, a usage line, three examples, and a text for every option.
# usage: verbs.sh ROOT PERIHOM
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
perihom=$(absolute "$2")
tap_folder
verbs=$("$perihom" help | sed -n 's/^  \([a-z]*\) .*/\1/p')

both_ways() {
    "$perihom" help "$1" >a 2>a.err && "$perihom" "$1" --help >b 2>b.err &&
        "$perihom" "$1" -h >c 2>c.err && cmp a b && cmp a c && ! cat a.err b.err c.err | grep .
}
teaches() {
    "$perihom" help "$1" >a
    cat a
    grep -q "^perihom $1: ..*" a && grep -q "^usage: perihom $1" a &&
        [ "$(sed -n '/^examples:/,/^options:/p' a | grep -c '^  perihom')" -eq 3 ]
}
explained() {
    "$perihom" help "$1" | sed -n '/^options:/,/^$/p' | grep '^  ' >a
    cat a
    grep -q -- '--help' a && ! grep -vE '^  (-[A-Za-z],|   ) --[a-z-]+( [A-Z=]+)?  +[^ ]' a
}
rejects() {
    "$perihom" "$1" --no-such-option >out 2>err
    code=$?
    cat err
    [ "$code" -eq 2 ] && [ ! -s out ] && grep -q -- '--no-such-option' err && grep -q '^usage: ' err
}
for v in $verbs; do
    check "help $v = $v --help = $v -h" both_ways "$v"
    check "$v: title, usage, three examples" teaches "$v"
    check "$v: every option has a text" explained "$v"
    check "$v: unknown option" rejects "$v"
done
tap_end
