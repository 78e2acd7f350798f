#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Each public header compiles alone, as C11 and as C++, without a warning.
# usage: headers.sh ROOT CC [CXX]
set -u
root=$1 cc=$2 cxx=${3:-}
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
flags="-fsyntax-only -Wall -Wextra -pedantic-errors -Werror -I$root/lib -I$root/rve"

compile() { # compiler language header
    # shellcheck disable=SC2086
    printf '#include <%s>\n#include <%s>\n' "$3" "$3" | $1 $flags -x $2 -
}

cd "$root/lib" || exit 99
for header in perihom.h perihom/*.h perihom_rve.h perihom_calibrate.h perihom_campaign.h perihom_error_bar.h perihom_estimators.h perihom_split.h perihom_trade.h perihom_fidelity.h; do
    check "$header as C11" compile "$cc -std=c11" c "$header"
    [ -z "$cxx" ] || check "$header as C++" compile "$cxx -std=c++17" c++ "$header"
done
tap_end
