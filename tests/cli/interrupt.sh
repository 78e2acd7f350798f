#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A signal in the middle of a long run: the process ends by it, says so, and leaves nothing,
# or the old result as it was. usage: interrupt.sh ROOT PERIHOM
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
perihom=$(absolute "$2")
env --default-signal=INT true 2>/dev/null || skip_all "env has no --default-signal"
tap_folder
cp "$root/tests/cli/cases/long.yaml" "$root/tests/cli/cases/small.yaml" .

# Start a run, wait until it iterates, send the signal $1. The shell ignores SIGINT in what it
# starts in the background; env gives it back.
run_and_stop() { # signal, arguments of perihom run
    signal=$1
    shift
    env --default-signal=INT "$perihom" run "$@" -v >out 2>err &
    pid=$!
    tries=0
    until grep -q 'iteration [1-9]' err || [ "$tries" -ge 600 ]; do
        kill -0 "$pid" 2>/dev/null || break
        sleep 0.05
        tries=$((tries + 1))
    done
    kill "-$signal" "$pid"
    wait "$pid"
    code=$?
}
said_so() {
    tail -n 2 err
    [ ! -s out ] && tail -n 1 err | grep -qx 'perihom: interrupted; no result is written'
}

run_and_stop INT long.yaml
check "SIGINT: exit code 130, not $code" test "$code" -eq 130
check "SIGINT: says so, nothing on stdout" said_so
check "SIGINT: no folder" test ! -e long-results
run_and_stop TERM long.yaml
check "SIGTERM: exit code 143, not $code" test "$code" -eq 143
check "SIGTERM: no folder" test ! -e long-results

"$perihom" run small.yaml -q -o kept >/dev/null
cp kept/result.json before.json
run_and_stop INT long.yaml -o kept --force
check "SIGINT: the old result stays" cmp kept/result.json before.json
check "SIGINT: nothing half written" test "$(find kept -type f | sort | tr '\n' ' ')" = "kept/phases.png kept/result.json "
tap_end
