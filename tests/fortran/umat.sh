#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The Fortran module and the UMAT, in a folder with the result that they read.
# usage: umat.sh PROGRAM
set -eu
program=$(readlink -f "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
iso() { # bulk and shear modulus -> 6 rows
    awk -v K="$1" -v G="$2" 'BEGIN {
        printf "["
        for (i = 0; i < 6; i++) {
            printf "%s[", i ? ", " : ""
            for (j = 0; j < 6; j++)
                printf "%s%.17g", j ? ", " : "", i < 3 && j < 3 ? K - 2 * G / 3 + (i == j) * 2 * G : (i == j) * G
            printf "]"
        }
        printf "]"
    }'
}
cat >resin.json <<TEXT
{"schema": "perihom.result/1", "grid": {"kinematics": "space"},
 "effective": {"stiffness": $(iso 4 1.5), "viscoelastic": {"stiffness_infinity": $(iso 2 0.5),
  "terms": [{"time": 2, "stiffness": $(iso 1 0.4)}, {"time": 30, "stiffness": $(iso 1 0.6)}]}}}
TEXT
cat >brittle.json <<TEXT
{"schema": "perihom.result/1", "grid": {"kinematics": "space"},
 "effective": {"stiffness": $(iso 1 0.5), "damage": {"law": {"strain": [0, 0, 1, 0, 0, 0], "damage": [0, 0.5, 0.75],
  "begin": [0.001, 0.003], "end": [0.002, 0.004], "stiffness": [$(iso 4 2), $(iso 2 1), $(iso 1 0.5)], "correction": 0}}}}
TEXT
"$program"
