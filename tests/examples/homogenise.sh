#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# docs/examples/homogenise.c: fibres of 46 x 46 of 64 x 64 cells, fraction 0.5166.
# usage: homogenise.sh ROOT PROGRAM
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
program=$(absolute "$2")
tap_folder

# Along the fibres: not below the rule of mixtures, 0.4834 * 68.3 + 0.5166 * 379.3 = 228.96,
# and at most 4 f (1-f) (nu1-nu2)^2 / ((1-f)/k2 + f/k1 + 1/G2) = 2.5 above it (Hill 1964;
# 1 aluminium, 2 boron, k = G/(1-2 nu)). Across: between Reuss, 118.5, and Voigt.
within() { awk -v x="$1" -v low="$2" -v high="$3" 'BEGIN { exit !(x > low && x < high) }'; }
check "the program runs" sh -c "'$program' > out"
cat out
along=$(sed -n 's/^E along \([0-9.]*\) GPa.*/\1/p' out)
across=$(sed -n 's/.*across \([0-9.]*\) GPa.*/\1/p' out)
check "E along the fibres, $along" within "${along:-0}" 228.9 231.6
check "E across, $across" within "${across:-0}" 118.5 228.9
tap_end
