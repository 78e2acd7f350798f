#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# tests/api/program.c under valgrind: no error, nothing lost. A build for a processor that valgrind
# does not know (AVX-512) is skipped: configure with -Dnative=false.
# usage: valgrind.sh ROOT PROGRAM
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
program=$(absolute "$2")
tap_folder
check "the program is content" "$program"
if ! command -v valgrind >/dev/null; then
    echo "# no valgrind: only the program was run"
    tap_end
    exit
fi
OMP_NUM_THREADS=1 valgrind --leak-check=full --errors-for-leak-kinds=definite --error-exitcode=99 --log-file=log \
    "$program" >out 2>&1
code=$?
if grep -q "Illegal opcode\|unrecognised instruction\|unhandled instruction" log; then
    echo "# valgrind does not know all instructions of this build: configure with -Dnative=false"
    tap_end
    exit
fi
grep "definitely lost\|ERROR SUMMARY" log | sed 's/^/# /'
check "valgrind sees no error and nothing lost" sh -c "[ $code = 0 ] || { cat log; exit 1; }"
tap_end
