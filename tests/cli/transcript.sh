#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a transcript in a folder of its own, which holds copies of tests/cli/cases.
#   $ command      for the shell; perihom and json_get are on the path
#   > line         standard output, a shell glob (escape [ ] * ? \ where meant); none: empty
#   ! line         standard error, likewise
#   ? code         exit code; 0 where not said
# usage: transcript.sh ROOT PERIHOM JSON_GET FILE
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
perihom=$(absolute "$2") json_get=$(absolute "$3") file=$(absolute "$4")
tap_folder
mkdir bin work io
ln -s "$perihom" bin/perihom
ln -s "$json_get" bin/json_get
cp "$root"/tests/cli/cases/*.yaml work
PATH=$tap_tmp/bin:$PATH
TERM=dumb
export PATH TERM
unset NO_COLOR
cd work || exit 99

command='' want_out='' want_err='' want_code=0 nl='
'
differs() { # what, want: the file io/$1 is not as the glob says
    got=$(cat "../io/$1")
    # shellcheck disable=SC2254  # a glob
    case $got in
    $2) return 1 ;;
    esac
    printf '%s was:\n%s\nwanted:\n%s\n' "$1" "$got" "$2"
}

finish() {
    [ -n "$command" ] || return 0
    (eval "$command") >../io/stdout 2>../io/stderr </dev/null
    code=$?
    why=
    [ "$code" -eq "$want_code" ] || why="exit code $code, wanted $want_code$nl$(cat ../io/stderr)$nl"
    why=$why$(differs stdout "$want_out")$(differs stderr "$want_err")
    if [ -z "$why" ]; then ok "$command"; else not_ok "$command" "$why"; fi
    command='' want_out='' want_err='' want_code=0
}

while IFS= read -r line || [ -n "$line" ]; do
    rest=${line#? }
    [ "$rest" = "$line" ] && rest=
    case $line in
    '$ '*)
        finish
        command=$rest
        ;;
    '>'*) want_out=$want_out${want_out:+$nl}$rest ;;
    '!'*) want_err=$want_err${want_err:+$nl}$rest ;;
    '? '*) want_code=$rest ;;
    '' | '#'*) ;;
    *)
        not_ok "line of the transcript: $line"
        ;;
    esac
done <"$file"
finish
tap_end
