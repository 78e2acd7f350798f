#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What comments and pages point to exists: citation keys, test files, links, the program of
# the README. usage: docs.sh ROOT
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
cd "$root" || exit 99
bib=docs/references.bib

has_entry() { grep -qiE "^@[a-z]+\{ *$1," "$bib" || { echo "$1 is not in $bib; cited in"; grep -rlF "[$1" lib rve tools docs README.md; return 1; }; }

# [Backus1962], [Hill1963; Hashin1964] in headers, sources and pages; .reference of catalogues
keys() {
    grep -rhoE --include='*.[ch]' --include='*.md' '\[[A-Z][A-Za-z-]+[0-9]{4}[a-z]?([;,] *[A-Z][A-Za-z-]+[0-9]{4}[a-z]?)*\]' lib rve tools docs README.md
    grep -rhoE --include='*.c' '"[A-Z][A-Za-z-]+(1[6-9]|20)[0-9]{2}[a-z]?([;, ]+[A-Z][A-Za-z-]+(1[6-9]|20)[0-9]{2}[a-z]?)*"' lib rve
}
for key in $(keys | tr -d '[]"' | tr -s ';, ' '\n' | sort -u); do
    check "[$key] is in the references" has_entry "$key"
done

duplicates() { grep -oE '^@[a-zA-Z]+\{[^,]+' "$bib" | sed 's/.*{ *//' | sort | uniq -d | grep . && return 1; return 0; }
[ ! -f "$bib" ] || check "no key twice" duplicates

# "Tested: tests/a.c, docs/examples/b.c" and further file names in comments of headers
named() { grep -rhoE --include='*.[ch]' '(tests|docs|data)/[A-Za-z0-9_./-]+\.(c|h|sh|md|yaml|t)' lib rve tools; }
for file in $(named | sort -u); do
    check "$file exists" test -f "$file"
done

# relative links of the pages: [text](file) and ![text](file)
links() {
    for page in README.md docs/*.md docs/*/*.md; do
        [ -f "$page" ] || continue
        grep -oE '\]\([^)#: ]+\)' "$page" | sed "s|^](|$(dirname "$page")/|; s|)\$||"
    done
}
for file in $(links | sort -u); do
    case $file in
    *docs/pictures/*.png) continue ;; # made by a run, not kept before
    esac
    check "link to $file" test -e "$file"
done

# The C block of the README is the compiled example, to the letter.
readme_program() {
    # shellcheck disable=SC2016
    sed -n '/^```c$/,/^```$/p' README.md | sed '1d;$d' >"$tap_tmp/readme.c"
    grep -v SPDX docs/examples/homogenise.c | diff "$tap_tmp/readme.c" -
}
tap_tmp=$(mktemp -d)
trap 'rm -rf "$tap_tmp"' EXIT
check "the program of the README is docs/examples/homogenise.c" readme_program
tap_end
