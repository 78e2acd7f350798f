#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Who may include what. lib: each tier only those above it (and itself); rve uses lib, never
# the other way; tools see public headers only; nothing below io reads case files.
# usage: tiers.sh ROOT
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
cd "$root" || exit 99
tiers="core material space model constraint solve effective io"

rank() {
    n=0
    for t in $tiers; do
        n=$((n + 1))
        [ "$t" = "$1" ] && echo "$n" && return
    done
    echo 0
}

# "file:line:header" of every include with quotes or brackets that matches a pattern
includes() { # pattern folder...
    pattern=$1
    shift
    grep -rnE --include='*.[ch]' "^ *# *include *$pattern" "$@"
}

tier_looks_up() {
    mine=$(rank "$1")
    wrong=0
    for other in $tiers; do
        [ "$(rank "$other")" -le "$mine" ] && continue
        includes "\"(\.\./)?$other/" "lib/$1" && wrong=1
    done
    return $wrong
}

none() { if includes "$@"; then return 1; else return 0; fi; }

only_known_folders() {
    for d in lib/*/; do
        d=$(basename "$d")
        [ "$d" = perihom ] && continue
        [ "$(rank "$d")" -gt 0 ] || { echo "lib/$d is no tier"; return 1; }
    done
}

check "every folder of lib is a tier" only_known_folders
for t in $tiers; do
    check "lib/$t includes only tiers above it" tier_looks_up "$t"
done
check "lib does not use rve" none '[<"].*(perihom_rve|perihom_campaign|perihom_trade|perihom_fidelity|rve/)' lib
check "lib does not use tools" none '"(\.\./)*tools/' lib rve
for t in core material space model constraint solve effective; do
    check "lib/$t knows no case files" none '[<"](perihom/(case|output)\.h|perihom\.h)' "lib/$t"
done
check "public headers include only public headers" none '"' lib/perihom lib/perihom.h rve/perihom_rve.h rve/perihom_campaign.h rve/perihom_error_bar.h rve/perihom_estimators.h rve/perihom_split.h rve/perihom_trade.h rve/perihom_fidelity.h
check "tools see public headers only" none \
    "\"(\.\./)*(lib|rve|$(echo "$tiers" | tr ' ' '|'))/" tools
tap_end
