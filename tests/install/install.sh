#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs into a folder and compiles docs/examples/homogenise.c against what is there, with
# nothing but pkg-config. usage: install.sh ROOT BUILD CC
set -u
root=$1 build=$2 cc=$3
# shellcheck source=tests/tap.sh
. "$root/tests/tap.sh"
command -v pkg-config >/dev/null || skip_all "no pkg-config"
tap_folder
check "meson install" meson install -C "$build" --no-rebuild --quiet --destdir "$tap_tmp/dest"
pc=$(find dest -name perihom.pc)
check "perihom.pc is installed" test -n "$pc"
PKG_CONFIG_PATH=$(dirname "$tap_tmp/$pc")
PKG_CONFIG_SYSROOT_DIR=$tap_tmp/dest
export PKG_CONFIG_PATH PKG_CONFIG_SYSROOT_DIR
# shellcheck disable=SC2046
compile() { $cc -std=c11 -Wall -Wextra -Werror "$root/docs/examples/homogenise.c" -o example $(pkg-config --cflags --libs perihom); }
check "the example compiles with pkg-config" compile
LD_LIBRARY_PATH=$(dirname "$(find "$tap_tmp/dest" -name libperihom.so)")
export LD_LIBRARY_PATH
check "the example runs" ./example
check "the program runs" "$(find "$tap_tmp/dest" -name perihom -type f -perm -u+x | head -n 1)" version
tap_end
