#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Every C file is as clang-format leaves it. One version of it, since they differ.
# usage: format.sh ROOT
set -u
root=$1
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
cd "$root" || exit 99
pinned=14
clang_format=$(command -v clang-format-$pinned || command -v clang-format) ||
    skip_all "no clang-format"
"$clang_format" --version | grep -q "version $pinned\." || skip_all "clang-format is not version $pinned"

files=$(find lib rve tools tests docs/examples -name '*.[ch]' | sort)
# shellcheck disable=SC2086
wrong=$("$clang_format" --dry-run -Werror $files 2>&1 | sed -n 's/^\([^:]*\):[0-9]*:.*clang-format.*/\1/p' | sort -u | tr '\n' ' ')
if [ -z "$wrong" ]; then
    ok "clang-format leaves every file as it is"
else
    not_ok "clang-format leaves every file as it is" "clang-format -i $wrong"
fi

without=$(for f in $files; do head -n 1 "$f" | grep -q 'SPDX-License-Identifier: GPL-3.0-or-later' || echo "$f"; done)
if [ -z "$without" ]; then ok "SPDX line on top"; else not_ok "SPDX line on top" "$without"; fi
tap_end
