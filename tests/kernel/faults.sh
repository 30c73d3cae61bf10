#!/bin/sh
# faults.sh BUILD: as scan.sh, scans with the faults that devices have; beside it, since together they take long.
self=faults
: "${ONLY:=stream tim}"
. tests/kernel/scan.sh
