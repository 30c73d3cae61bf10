#!/bin/sh
# Runs one test program so that prove can read it: tap.sh BUILD PROGRAM. Half-open settings of the desk must not leak in.
build=$1
program=$2
name=$(basename "$program")
export PLEINAIR_BIN="$PWD/$build/bin" PLEINAIR_SOURCE="$PWD"
export G_DEBUG=fatal-warnings GSETTINGS_BACKEND=memory LC_ALL=C.UTF-8 MALLOC_PERTURB_=165
export ASAN_OPTIONS=detect_leaks=1:abort_on_error=1:malloc_context_size=20 UBSAN_OPTIONS=print_stacktrace=1
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
# What the touch screen looked like on its way through the tests.
export PLEINAIR_SHOTS="${PLEINAIR_SHOTS:-$PWD/$build/shots}"
# Programs run side by side: threads that wait leave the core to the other program; spinning cost instrumented tests of pictures a third.
export OMP_WAIT_POLICY=passive
# As pleinair sets it for commands, which tests start by themselves; the touch screen and daemons run without.
case $name in
test-kiosk-*) ;;
*) export GLIBC_TUNABLES="$(grep -o '"glibc[^"]*"' acquire/large-pages.h | tr -d '"\n')" ;;
esac
# What it said is kept where it failed: prove counts, and in a long log what went wrong is far from the end (said.sh).
said=$build/said/$name
mkdir -p "$build/said"
case $name in
fuzz-*) timeout --kill-after=5 240 "$program" >"$said.tap" 2>"$said.err" ;;
*) timeout --kill-after=5 900 "$program" --tap >"$said.tap" 2>"$said.err" ;;
esac
status=$?
cat "$said.tap"
cat "$said.err" >&2
[ $status -ne 0 ] || rm "$said.tap" "$said.err"
exit $status
