#!/bin/sh
# What the test programs said that failed, as tap.sh kept it: said.sh BUILD.
for tap in "$1"/said/*.tap; do
	[ -e "$tap" ] || continue
	name=$(basename "$tap" .tap)
	echo "==== $name failed; it said last:"
	grep '^ *not ok\|^ *Bail out' "$tap"
	tail -n 60 "${tap%.tap}.err"
done
