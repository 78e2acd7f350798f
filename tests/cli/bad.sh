#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Cases that are not admissible: NAME.yaml gives the lines of NAME.expect on stderr, nothing on
# stdout, exit code 3 and no folder. Those of tests/cli/bad are refused by the reader, those of
# tests/cli/bad_model by the model, the constraint or the solver.
# usage: bad.sh ROOT PERIHOM
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
perihom=$(absolute "$2")
bad=$root/tests/cli/bad
[ -d "$bad" ] || skip_all "no bad cases"
tap_folder
cp "$bad"/* "$root"/tests/cli/bad_model/* .

complains() {
    "$perihom" run "$1.yaml" >out 2>err </dev/null
    code=$?
    diff "$1.expect" err || return 1
    [ "$code" -eq 3 ] || { echo "exit code $code"; return 1; }
    [ ! -s out ] || { echo "talk on stdout"; return 1; }
    [ ! -e "$1-results" ] || { echo "left $1-results"; return 1; }
}
for f in *.yaml; do
    name=${f%.yaml}
    check "$name" complains "$name"
done
tap_end
