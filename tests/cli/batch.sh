#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A campaign as a Slurm job array and under GNU parallel: the files of a single run. Skipped
# where neither is there. usage: batch.sh ROOT PERIHOM
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
perihom=$(absolute "$2")
slurm=no
command -v sbatch >/dev/null && [ -n "$(sinfo -h -t idle,mixed,allocated -o %N 2>/dev/null)" ] && slurm=yes
parallel=no
command -v parallel >/dev/null && parallel --version 2>/dev/null | grep -q '^GNU' && parallel=yes
[ $slurm = yes ] || [ $parallel = yes ] || skip_all "neither Slurm nor GNU parallel is here"
tap_folder
cp "$root/tests/cli/campaigns/random.yaml" "$root/tests/cli/campaigns/sweep.yaml" .
PATH=$(dirname "$perihom"):$PATH
export OMP_NUM_THREADS=1 PATH

perihom campaign sweep.yaml -o one -q >/dev/null
sed 's/realisations:.*/realisations: 40/' sweep.yaml >fixed.yaml
perihom campaign fixed.yaml -o one-fixed -q >/dev/null
same() {
    cmp "$1/realisations.jsonl" "$2/realisations.jsonl" && cmp "$1/campaign.json" "$2/campaign.json" &&
        cmp "$1/campaign.h5" "$2/campaign.h5"
}

if [ $slurm = yes ]; then
    for name in sweep fixed; do
        CAMPAIGN=$name.yaml sbatch --wait --export=ALL -o slurm-%A-%a.out "$root/docs/examples/campaign.sbatch" >log 2>&1
        check "Slurm: the array of $name ends" test $? -eq 0
        check "Slurm: four parts" test "$(find $name-results -name 'shard-?-of-4' | wc -l)" -eq 4
        perihom campaign $name.yaml --merge -q >/dev/null
    done
    check "Slurm: four parts are the single run" same sweep-results one
    check "Slurm: ... with a fixed number too" same fixed-results one-fixed
    rm -rf sweep-results fixed-results
fi
if [ $parallel = yes ]; then
    parallel -j 2 perihom campaign sweep.yaml -j 1 -q --shard {}/3 ::: 3 1 2 >/dev/null 2>&1
    perihom campaign sweep.yaml --merge -q >/dev/null
    check "GNU parallel: three parts are the single run" same sweep-results one
fi
tap_end
