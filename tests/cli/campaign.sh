#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Campaigns that are killed, cut off, run twice, split: the files of an undisturbed run come
# out, bit for bit. usage: campaign.sh ROOT PERIHOM [KILLS]
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
perihom=$(absolute "$2")
kills=${3:-6}
tap_folder
cp "$root/tests/cli/campaigns/random.yaml" "$root/tests/cli/campaigns/sweep.yaml" .
export OMP_NUM_THREADS=1

campaign() { "$perihom" campaign sweep.yaml -q "$@" >/dev/null; }
same() { # folder of the campaign, folder of the undisturbed one
    cmp "$1/realisations.jsonl" "$2/realisations.jsonl" && cmp "$1/campaign.json" "$2/campaign.json" &&
        cmp "$1/campaign.h5" "$2/campaign.h5"
}

campaign -o one -j 1
check "the undisturbed run" test -s one/campaign.json
lines=$(wc -l <one/realisations.jsonl)

campaign -o again -j 3
check "three workers give the same" same again one
cp -r again old
campaign -o again
check "a second run computes nothing and changes nothing" same again old
check "no realisation was computed twice" test "$(wc -l <again/costs.csv)" -eq "$lines"

# Killed at a random moment, again and again, then run to its end.
rm -rf killed
seed=7
for k in $(seq "$kills"); do
    seed=$(((seed * 1103515245 + 12345) % 2147483648))
    "$perihom" campaign sweep.yaml -q -o killed -j 2 >/dev/null 2>&1 &
    pid=$!
    sleep "0.$(printf %03d $((seed / 65536 % 200)))"
    kill -9 "$pid" 2>/dev/null
    wait "$pid" 2>/dev/null
done
campaign -o killed -j 2
check "killed $kills times: the same" same killed one

# What a power cut can leave at the end of the file, and rot in its middle.
cp -r one torn
size=$(wc -c <torn/realisations.jsonl)
truncate -s $((size - 7)) torn/realisations.jsonl
campaign -o torn
check "a torn last line is computed again" same torn one
cp -r one zeros
truncate -s $((size + 4096)) zeros/realisations.jsonl
campaign -o zeros
check "zeros at the end do not count" same zeros one
cp -r one rotten
sed -i '20s/1/2/; 30d; 40s/.*/rubbish/' rotten/realisations.jsonl
"$perihom" campaign sweep.yaml -o rotten >/dev/null 2>err
check "damaged lines are computed again" same rotten one
check "... and it says so" grep -q '2 damaged lines' err

# The derived files are rebuilt from the lines.
rm again/campaign.json
campaign -o again --rebuild
check "--rebuild" same again one

# Shards, in any order, merged any number of times.
for k in 3 1 4 2; do campaign -o parts --shard $k/4 -j 1; done
campaign -o parts --merge
check "four shards, merged, are the single run" same parts one
campaign -o parts --merge parts/shard-2-of-4 parts/shard-4-of-4 parts/shard-2-of-4
check "merging twice changes nothing" same parts one
for k in 1 2; do campaign -o 'q [1]*' --shard $k/2 -j 1; done
campaign -o 'q [1]*' --merge
check "a folder with letters that a shell would expand" same 'q [1]*' one

# With cheaper models of every realisation: killed, and split by points.
sed 's/^realisations:.*/realisations: {at_most: 400, until: {quantity: C11, relative_half_width: 0.01}}/' sweep.yaml >models.yaml
echo 'variance_reduction: auto' >>models.yaml
models() { "$perihom" campaign models.yaml -q "$@" >/dev/null; }
models -o reduced -j 1
check "variance reduction: all models have lines" sh -c 'grep -q "\"level\": 3" reduced/realisations.jsonl && grep -q "\"variance_reduction\"" reduced/campaign.json'
for k in 1 2 3; do
    "$perihom" campaign models.yaml -q -o reduced2 -j 2 >/dev/null 2>&1 &
    pid=$!
    sleep "0.1$k"
    kill -9 "$pid" 2>/dev/null
    wait "$pid" 2>/dev/null
done
models -o reduced2 -j 2
check "... killed three times: the same" same reduced2 reduced
for k in 2 1; do models -o reduced3 --shard $k/2 -j 1; done
models -o reduced3 --merge
check "... two shards, merged: the same" same reduced3 reduced

# A size that is chosen: any number of workers, killed among pilots and after, split by points.
sed '/^sweep:/d; s/^realisations:.*/realisations: {at_most: 2000, at_least: 12, until: {quantity: C11, relative_half_width: 0.04}}/' sweep.yaml >size.yaml
echo 'size: [0.06, 0.75, 1, 1.5]' >>size.yaml
size() { "$perihom" campaign size.yaml -q "$@" >out 2>err; }
size -o sized -j 1
check "a size is chosen: exit code 0" test $? -eq 0
check "... the table says which and what was left out" sh -c 'grep -q "^\*" out && grep -q "left out" out && grep -q "^size: .* of the edge" out'
check "... so does campaign.json" sh -c 'grep -q "\"split\"" sized/campaign.json && grep -q "\"why\"" sized/campaign.json'
for k in 1 2 3 4; do
    "$perihom" campaign size.yaml -q -o sized2 -j 2 >/dev/null 2>&1 &
    pid=$!
    sleep "0.0$k"
    kill -9 "$pid" 2>/dev/null
    wait "$pid" 2>/dev/null
done
size -o sized2 -j 3
check "... killed four times: the same" same sized2 sized
size -o sized2 --rebuild
check "... --rebuild" same sized2 sized
for k in 2 1; do size -o sized3 --shard $k/2 -j 1; done
size -o sized3 --merge
check "... two shards, merged: the same" same sized3 sized
size -o sized4 --rebuild
check "... nothing to rebuild: exit code 5" test $? -eq 5
check "... and no folder" test ! -e sized4
sed 's/0.04}/0.0005}/' size.yaml >far.yaml
"$perihom" campaign far.yaml -o far -q --set materials.clay.E=1000 >out 2>err
check "what no size meets: exit code 4" test $? -eq 4
check "... says what comes nearest" grep -q 'no size meets 0.05 %.*nearest' err
check "... and has no result" test ! -e far/campaign.json
echo 'budget: {seconds: 1e-3}' >>size.yaml
size -o late
check "a budget that ends among the pilots: exit code 4" test $? -eq 4
check "... and it says so" grep -q 'pilots at 0.75 of the edge: budget.seconds' err
{ cat sweep.yaml && echo 'budget: {seconds: 1e-3}'; } >budget.yaml
"$perihom" campaign budget.yaml -o late2 -q >out 2>err
check "a budget that ends: exit code 4" test $? -eq 4
check "... the files are there, and it says how to go on" sh -c 'test -s late2/campaign.json && grep -q "incomplete" out && grep -q "goes on" err'
campaign -o late2
check "... it goes on, to the same" same late2 one

# Another campaign in the same folder is refused.
sed 's/0.05\]/0.06]/' sweep.yaml >other.yaml
"$perihom" campaign other.yaml -o one -q 2>err
check "a changed case: exit code 5" test $? -eq 5
check "... and it says so" grep -q 'realisations of another campaign' err
check "... and touches nothing" same one torn
# ... but not another number of realisations.
sed 's/at_most: 60/at_most: 50/; s/0.02}}/0.01}}/' sweep.yaml >tighter.yaml
"$perihom" campaign tighter.yaml -o again -q >/dev/null
"$perihom" campaign tighter.yaml -o fresh -q >/dev/null
check "a narrower interval goes on from what is there" same again fresh

# Two at once.
sed 's/at_most: 60/at_most: 100000/; s/0.02}}/0.0001}}/' sweep.yaml >long.yaml
env --default-signal=INT "$perihom" campaign long.yaml -o both -j 1 -q >/dev/null 2>first &
pid=$!
tries=0
until [ -s both/realisations.jsonl ] || [ $tries -ge 200 ]; do sleep 0.05; tries=$((tries + 1)); done
timeout 20 "$perihom" campaign long.yaml -o both -q >/dev/null 2>err
check "a second campaign in a folder: exit code 5" test $? -eq 5
check "... and it says so" grep -q 'another perihom is working in this folder' err

# Ctrl-C.
kill -INT "$pid"
wait "$pid"
check "SIGINT: exit code 130" test $? -eq 130
check "... says how to go on" grep -q 'interrupted; the same command goes on' first
check "... and leaves whole lines" sh -c 'tail -c 1 both/realisations.jsonl | grep -qx "" && test -s both/campaign.json'

# A folder that cannot be written.
"$perihom" campaign sweep.yaml -o /proc/nowhere -q 2>err
check "a read-only folder: exit code 5" test $? -eq 5
check "... and its name" grep -q '/proc/nowhere' err

# A full disk, played by a limit of the file size: what was there stays, nothing is torn.
(ulimit -f 4; "$perihom" campaign sweep.yaml -o full -j 1 -q >/dev/null 2>err)
check "a full disk: exit code 5" grep -q 'realisations.jsonl.*file size limit' err
check "... only whole lines" sh -c 'tail -c 1 full/realisations.jsonl | grep -qx ""'
campaign -o full
check "... and it goes on with room" same full one

# Failures are kept, and tried again when asked for. 12 platelets of 30 in a box of 32.
sed 's/mean: 12, std: 3, min: 3/mean: 30, std: 2, min: 3/' random.yaml >random2.yaml
sed 's/random.yaml/random2.yaml/; s/realisations:.*/realisations: 10/' sweep.yaml >failing.yaml
"$perihom" campaign failing.yaml -o failing -q >/dev/null 2>err
check "some failed: exit code 6" test $? -eq 6
failed=$(grep -c '"failed"' failing/realisations.jsonl)
check "failures are kept with their error" grep -q '"failed": "physically not admissible", "message": "' failing/realisations.jsonl
cp -r failing failing2
"$perihom" campaign failing.yaml -o failing -q >/dev/null 2>&1
check "they are not tried again" same failing failing2
"$perihom" campaign failing.yaml -o failing -q --retry-failed >/dev/null 2>&1
check "--retry-failed tries the $failed again" test "$(wc -l <failing/costs.csv)" -eq $((41 + failed))
check "... with the same end" same failing failing2

# Wrong usage.
for wrong in '--shard 5/4' '--shard 0/4' '--shard 1' '--shard 1/4x' '--memory 8X' '--memory -1' \
    '--merge --rebuild' '--shard 1/2 --merge' '-j 0' 'other.yaml'; do
    # shellcheck disable=SC2086
    "$perihom" campaign sweep.yaml -o wrong $wrong >/dev/null 2>&1
    check "$wrong: exit code 2" test $? -eq 2
done
check "... and no folder" test ! -e wrong
"$perihom" campaign sweep.yaml -o nothing --merge -q 2>err
check "nothing to merge: exit code 5" test $? -eq 5
check "... and it says so" grep -q 'there is no nothing/shard-' err

for wrong in '-j 257' '--threads 1025'; do
    # shellcheck disable=SC2086
    "$perihom" campaign sweep.yaml -o wrong $wrong >/dev/null 2>&1
    check "$wrong: exit code 2" test $? -eq 2
done

# Nothing to rebuild, nothing or something else to merge: refused, and no folder is made.
for none in '--rebuild' '--merge nothing' '--merge one nothing' '--merge foreign'; do
    mkdir -p foreign && sed '1s/campaign/champaign/' one/realisations.jsonl >foreign/realisations.jsonl
    # shellcheck disable=SC2086
    "$perihom" campaign sweep.yaml -o untouched -q $none >/dev/null 2>err
    check "$none of nothing: exit code 5" test $? -eq 5
    check "... and no folder" test ! -e untouched
done

# What can be refused before anything is computed is refused then. $1: what it says
refused() {
    "$perihom" campaign refused.yaml -o untouched -q >/dev/null 2>err
    check "$1: exit code 3" test $? -eq 3
    check "... said with file, line and key" grep -q "^refused.yaml:$1" err
    check "... once" test "$(wc -l <err)" -eq 1
    check "... and no folder" test ! -e untouched
}
printf 'x,y\n0.02,4\n' >measured.csv
fraction=microstructure.fillers.0.volume_fraction
{ cat sweep.yaml && echo "data: {file: measured.csv, columns: {$fraction: x, C11: z}}"; } >refused.yaml
refused "6: data.columns.C11: 'z' is not admissible: measured.csv has no such column"
{ cat sweep.yaml && echo "data: {file: gone.csv, columns: {$fraction: x, C11: y}}"; } >refused.yaml
refused '6: data.file: gone.csv: cannot be opened'
{ cat sweep.yaml && echo "data: {file: measured.csv, columns: {materials.clay.nu: x, C11: y}}"; } >refused.yaml
refused '6: data.columns.materials.clay.nu: must be a key that varies'
{ cat sweep.yaml && echo "data: {file: measured.csv, columns: {$fraction: x}}"; } >refused.yaml
refused '6: data.columns.C11: missing'
{ cat sweep.yaml && echo 'set: {materials.clay.E: 3}'; } >refused.yaml
refused '6: set: materials.clay.E: this key varies in the campaign'
sed 's/clay.E:/clay.F:/' sweep.yaml >refused.yaml
refused '3: point 0: random.yaml: --set materials.clay.F: unknown key'
sed 's/^outputs:.*/outputs: [C11, fraction.dirt]/' sweep.yaml >refused.yaml
refused "5: outputs.1: fraction.dirt: the case has no material 'dirt'"
sed 's/: 0.02}}/: 0.02, confidence: 0.9999999999999999}}/' sweep.yaml >refused.yaml
refused '4: realisations.until.confidence: 0.9999999999999999 is not admissible'
"$perihom" campaign sweep.yaml -o untouched -q --set materials.clay.E=3 2>err
check "--set of a key that varies: exit code 3" test $? -eq 3
check "... and it says so" grep -q 'set materials.clay.E: this key varies' err

# Quantities of a case that relaxes.
cp "$root/tests/cli/cases/relaxing.yaml" .
printf '%s\n' 'campaign: 1' 'case: relaxing.yaml' 'realisations: 1' 'outputs: ["E1(t=1)", "E1_loss(omega=10)"]' >relax.yaml
"$perihom" campaign relax.yaml -q >table 2>err
check "a quantity at a time" test $? -eq 0
check "... is in the table" grep -q 'E1(t=1)' table

# Names: two keys with one last word, a material with a slash.
sed 's/clay/"cl\/ay"/' random.yaml | sed 's/material: "cl/material: cl/; s/ay",/ay,/' >slash.yaml
printf '%s\n' 'campaign: 1' 'case: slash.yaml' 'realisations: 2' 'outputs: [fraction.cl/ay]' \
    'sweep: {materials.cl/ay.nu: [0.2, 0.3], materials.epoxy.nu: [0.3, 0.35]}' >names.yaml
"$perihom" campaign names.yaml -q >table 2>err
check "a material with a slash" test $? -eq 0
check "two keys with one last word have two names" grep -q 'cl/ay.nu *epoxy.nu' table
check "two keys with one last word have two pictures" test "$(ls names-results/plots/*-against-* | wc -l)" -eq 2

# A worker that is killed: its realisation is computed again.
sed 's/realisations:.*/realisations: 12/' sweep.yaml >slow.yaml
slow="campaign slow.yaml --set microstructure.nodes=[160,160] -j 1"
# shellcheck disable=SC2086
"$perihom" $slow -o orphan >/dev/null 2>err &
pid=$!
tries=0
worker=
until [ -n "$worker" ] || [ $tries -ge 400 ]; do
    sleep 0.01
    worker=$(cat "/proc/$pid/task/$pid/children" 2>/dev/null)
    tries=$((tries + 1))
done
# shellcheck disable=SC2086
kill -9 $worker
wait "$pid"
check "a killed worker: exit code 0" test $? -eq 0
check "... it says so" grep -q 'a realisation was lost: its worker process was ended by signal 9' err
# shellcheck disable=SC2086
"$perihom" $slow -o whole >/dev/null 2>&1
check "... and nothing is missing" same orphan whole
tap_end
