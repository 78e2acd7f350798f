#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A calibration that is killed goes on where it was: nothing lost, nothing solved twice, and
# the same result. Signals, a folder in use, a line cut off, a disk that is full.
# usage: calibrate_resume.sh ROOT PERIHOM
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
perihom=$(absolute "$2")
tap_folder
cp "$root"/tests/cli/calibrate/*.yaml .
printf 'percent,E,sd\n1,3.6,0.05\n2.5,3.8,0.05\n5,4.1,0.06\n' >clay.csv

# Everything of a result but when and where it was made.
result() { sed '/"provenance"/,$d' "$1/calibration.json"; }
lines() { if [ -f "$1/evaluations.jsonl" ]; then wc -l <"$1/evaluations.jsonl"; else echo 0; fi; }
nothing_twice() { # every line is there once, in whatever order threads wrote them
    [ "$(sed 's/"values".*//' "$1/evaluations.jsonl" | sort | uniq -d | wc -l)" -eq 0 ]
}

"$perihom" calibrate kappa.yaml -q -o whole >/dev/null
total=$(lines whole)

# Kill it whenever a share of the work is done.
for share in 1 3 5 7; do
    "$perihom" calibrate kappa.yaml -q -o killed >/dev/null 2>&1 &
    pid=$!
    while kill -0 "$pid" 2>/dev/null && [ "$(lines killed)" -lt $((total * share / 8)) ]; do :; done
    kill -KILL "$pid" 2>/dev/null
    wait "$pid" 2>/dev/null
done
left=$(lines killed)
check "killed four times: some work is left" test "$left" -lt "$total"
"$perihom" calibrate kappa.yaml -o killed >/dev/null 2>err
result whole >a
result killed >b
check "killed four times: the same result" cmp a b
check "killed four times: as many lines" test "$(lines killed)" -eq "$total"
check "killed four times: nothing twice" nothing_twice killed

# One and two threads.
"$perihom" calibrate kappa.yaml -q -j 2 -o two >/dev/null
result two >b
check "two threads: the same result" cmp a b

# A line that was cut off is solved again.
cp -r whole cut
size=$(wc -c <cut/evaluations.jsonl)
dd if=/dev/null of=cut/evaluations.jsonl bs=1 seek=$((size - 9)) 2>/dev/null
"$perihom" calibrate kappa.yaml -o cut >/dev/null 2>err
result cut >b
check "last line cut off: one more solve" grep -q '^perihom: 1 realisations solved' err
check "last line cut off: the same result" cmp a b

# A line that makes no sense is not passed over.
cp -r whole broken
sed '3s/.*/{"at": 1}/' whole/evaluations.jsonl >broken/evaluations.jsonl
"$perihom" calibrate kappa.yaml -o broken >/dev/null 2>err
code=$?
check "broken line: exit code 5, not $code" test "$code" -eq 5
check "broken line: says which" grep -q 'evaluations.jsonl:3: not a line' err

# Two on one folder, and signals.
env --default-signal=INT true 2>/dev/null || { tap_end; exit; }
slow='--set microstructure.nodes=[120,120] --set microstructure.size=[1200,1200]'
# shellcheck disable=SC2086  # words
env --default-signal=INT "$perihom" calibrate kappa.yaml $slow -o busy >out 2>err &
pid=$!
while kill -0 "$pid" 2>/dev/null && [ "$(lines busy)" -lt 5 ]; do sleep 0.02; done
# shellcheck disable=SC2086
"$perihom" calibrate kappa.yaml $slow -o busy >/dev/null 2>err2
code=$?
check "folder in use: exit code 5, not $code" test "$code" -eq 5
check "folder in use: says so" grep -q 'another calibration is writing' err2
kill -INT "$pid"
wait "$pid"
code=$?
check "SIGINT: exit code 130, not $code" test "$code" -eq 130
check "SIGINT: says that the work is kept" grep -q 'interrupted; what was solved is kept' err
check "SIGINT: nothing on stdout, no result" test ! -s out -a ! -e busy/calibration.json
check "SIGINT: every line is whole" sh -c 'tail -c 1 busy/evaluations.jsonl | od -c | grep -q "\\\\n"'

# A file that may not grow: the size limit stands for the full disk.
(
    ulimit -f 8
    trap '' XFSZ
    "$perihom" calibrate kappa.yaml -o full >/dev/null 2>err
)
code=$?
check "disk full: exit code 5, not $code" test "$code" -eq 5
check "disk full: says so" grep -q 'evaluations.jsonl: cannot be written' err
"$perihom" calibrate kappa.yaml -q -o full >/dev/null
result full >b
check "disk full: goes on when there is room" cmp a b
tap_end
