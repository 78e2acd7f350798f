#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# From a fresh Debian 12 to a result, or to a tested build. Quick when nothing is missing.
set -eu

usage() {
    cat <<'TEXT'
usage: tools/setup.sh run [CASE]   install what is missing, build, run CASE
       tools/setup.sh test         install what is missing, build, run the tests
       tools/setup.sh build        install what is missing, build

CASE is a case file (default: the one in data/cases). The build is in build/, the program
is build/tools/perihom. Packages come from apt-get, as root or with sudo.
TEXT
}

here=$(cd "$(dirname "$0")/.." && pwd)
build=$here/build
perihom=$build/tools/perihom
packages="build-essential meson ninja-build pkg-config git libsuitesparse-dev libgsl-dev
libfftw3-dev libhdf5-dev libopenblas-dev libyaml-dev libjansson-dev libpng-dev libcmocka-dev
python3 python3-cffi python3-dev python3-numpy gfortran"
# Programs that the tests let read what perihom writes.
test_packages="calculix-ccx"
# The same, but large (145 packages, 160 MB to fetch): its tests are skipped without it.
optional_packages="python3-sfepy"

say() { printf 'setup: %s\n' "$*" >&2; }
die() {
    say "$*"
    exit 1
}

missing_packages() { # of a list
    for p in $1; do
        dpkg-query -W -f '${Status}' "$p" 2>/dev/null | grep -q 'ok installed' || printf ' %s' "$p"
    done
}

as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        env DEBIAN_FRONTEND=noninteractive "$@"
    elif command -v sudo >/dev/null; then
        sudo env DEBIAN_FRONTEND=noninteractive "$@"
    else
        die "not root and no sudo; as root: apt-get install$missing"
    fi
}

install_missing() {
    command -v dpkg-query >/dev/null || {
        say "no dpkg here; assuming that the libraries are installed"
        return 0
    }
    missing=$(missing_packages "$packages")
    [ -z "$missing" ] && return 0
    say "installing$missing"
    as_root apt-get -qq update >&2 || {
        sleep 5
        as_root apt-get -qq update >&2 ||
            say "apt-get update failed twice (offline?); trying with the lists at hand"
    }
    # shellcheck disable=SC2086  # a list of packages
    as_root apt-get -qq install -y --no-install-recommends $missing >&2 ||
        die "could not install$missing
setup: the packages are not at hand and the archive is not reachable; connect this machine, or
setup: install them from a mirror, and start again"
}

# Fetching gets four minutes; what is fetched is installed to the end.
install_optional() {
    command -v dpkg-query >/dev/null || return 0
    missing=$(missing_packages "$optional_packages")
    [ -z "$missing" ] && return 0
    free=$(df -Pk /usr | awk 'NR == 2 { print $4 }')
    if [ "${free:-0}" -lt 4000000 ]; then
        say "without$missing: less than 4 GB are free; its tests will be skipped"
        return 0
    fi
    say "installing$missing for some of the tests"
    # shellcheck disable=SC2086  # a list of packages
    (as_root timeout 240 apt-get -qq install -y --no-install-recommends --download-only $missing >&2 &&
        as_root apt-get -qq install -y --no-install-recommends $missing >&2) ||
        say "without$missing: its tests will be skipped"
}

build_all() {
    if [ ! -f "$build/build.ninja" ]; then
        talk=$(meson setup "$build" "$here" --buildtype=release 2>&1) || {
            printf '%s\n' "$talk" | tail -n 20 >&2
            die "meson setup failed; its log is $build/meson-logs/meson-log.txt"
        }
    fi
    ninja -C "$build" >"$build/ninja.log" 2>&1 || {
        tail -n 60 "$build/ninja.log" >&2
        die "the build failed; all of it is in $build/ninja.log"
    }
    say "built $perihom"
}

default_case() {
    for name in epoxy-clay boron-aluminium; do
        if [ -f "$here/data/cases/$name.yaml" ]; then
            printf '%s\n' "$here/data/cases/$name.yaml"
            return 0
        fi
    done
    die "no default case in $here/data/cases; name one: tools/setup.sh run CASE"
}

run_case() {
    case=${1:-}
    [ -n "$case" ] || case=$(default_case)
    say "perihom run $case"
    "$perihom" run "$case"
    name=$(basename "$case")
    name=${name%.yaml}
    say "the results are in $(pwd)/${name%.yml}-results"
}

# Passed and failed test functions in meson's log. A test that prints TAP counts its lines;
# one that ends badly without a failed line, or prints no TAP, counts as one.
count_tests() {
    awk '
        function close_test() {
            if (name == "" || skipped) return
            if (ok + bad == 0) { if (good) passed++; else failed++ }
            else { passed += ok; failed += bad; if (!good && bad == 0) failed++ }
        }
        /^test: / { close_test(); name = $2; ok = bad = good = skipped = 0 }
        /^result: / { good = /exit status 0/ || /exit status 77/; skipped = /exit status 77/ }
        /^ok [0-9]+/ { if (!/# *[Ss][Kk][Ii][Pp]/) ok++ }
        /^not ok [0-9]+/ { if (!/# *[Ss][Kk][Ii][Pp]/) bad++ }
        END { close_test(); printf "%d passed, %d failed\n", passed, failed; exit failed > 0 }
    ' "$1"
}

run_tests() {
    log=$build/meson-logs/testlog.txt
    rm -f "$log" "$build"/meson-logs/testlog-*.txt
    code=0
    CMOCKA_MESSAGE_OUTPUT=TAP meson test -C "$build" --no-rebuild --setup quick \
        --print-errorlogs || code=$?
    [ -f "$log" ] || log=$build/meson-logs/testlog-quick.txt
    [ -f "$log" ] || die "meson test left no log"
    count_tests "$log" || code=1
    return "$code"
}

verb=${1:-}
[ $# -gt 0 ] && shift
case $verb in
run)
    [ $# -le 1 ] || { usage >&2; exit 2; }
    install_missing
    build_all
    run_case "$@"
    ;;
test)
    packages="$packages $test_packages"
    install_missing
    install_optional
    build_all
    run_tests
    ;;
build)
    install_missing
    build_all
    ;;
help | -h | --help) usage ;;
*)
    usage >&2
    exit 2
    ;;
esac
