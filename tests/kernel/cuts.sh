#!/bin/sh
# cuts.sh BUILD: while the real programs scan in QEMU (as in scan.sh) onto an ext4 disk, the power is cut: QEMU is killed, at a random moment of the
# scan, CUTS times (once; 20 times are what a release is tried with). What the guest had not written is lost then, as it is with a real cut. After each, the next
# boot must find every finished scan whole and go on with the partial one. Prints TAP, or skips it all with a reason. SEED makes the moments the same.
build=$1
cuts=${CUTS:-1}
seed=${SEED:-$(date +%s)}
. tests/kernel/kernel.sh
needs mke2fs
prepare_devices cuts cuts-guest.sh
cp "$build/tests/kernel/check-site" "$test/"
cp "$here/scan.conf" "$appliance/etc/pleinair.conf"
disk=$cache/cuts.disk
rm -f "$disk" && truncate -s 1G "$disk" && mke2fs -q -t ext4 "$disk" || fail "no disk can be made"
simulate cuts 'hall?lidar=cola&rate_hz=45&seed=7&camera=none&home_deg=330&latency_ms=55'

said=$cache/cuts.tap
start() { # END: boots in the background
	: > "$said"
	boot cuts "net.ifnames=0 test=/usr/lib/pleinair/test/cuts-guest.sh end=$1 $ports" -netdev user,id=n -device virtio-net-pci,netdev=n \
		-drive "file=$disk,format=raw,if=virtio,cache=writeback" -pidfile "$cache/cuts.pid" &
	boot=$!
	trap 'kill $simulators 2> /dev/null; kill -9 $(cat "$cache/cuts.pid") 2> /dev/null' EXIT
}
told() { tr -d '\r' < "$said" | sed -n "s/^$1 //p" | tail -1; }
number() { printf '%s' "$2" | sed -n "s/.*$1=\([0-9]*\).*/\1/p"; }
await() { # WORD: told by the guest, or the end of it: boot has the one limit of time, which a busy machine needs
	until grep -q "^\($1\|failed\)" "$said" 2> /dev/null || ! kill -0 $boot 2> /dev/null; do sleep 0.1; done
	! grep -q ^failed "$said" && grep -q "^$1" "$said"
}

echo "1..$((cuts + 1))"
echo "# seed $seed: the power is cut up to ${SCAN_SECONDS:=35} s after the scan begins"
finished=0
resumed=0
for n in $(seq $((cuts + 1))); do
	end=$([ "$n" -gt "$cuts" ] && echo yes)
	start "${end:-no}"
	if [ "$end" ]; then await over; else await scans; fi
	good=$?
	found=$(told found)
	# What was finished before the cut is there, and whole (the guest looked).
	[ "$(number finished "${found:-finished=0}")" -ge "$finished" ] || good=1
	tr -d '\r' < "$said" | sed -n '/^scans/{p;q}' | grep -q resume && resumed=$((resumed + 1))
	if [ -z "$end" ]; then
		moment=$(awk -v seed="$seed" -v n="$n" -v longest="$SCAN_SECONDS" 'BEGIN { srand(seed % 1000000 + 7919 * n); rand(); printf "%.2f", rand() * longest }')
		sleep "$moment"
	fi
	kill -9 "$(cat "$cache/cuts.pid")" 2> /dev/null
	wait $boot 2> /dev/null
	grep -q ^failed "$said" && good=1
	now=$(number finished "$(told finished)")
	finished=${now:-$(number finished "${found:-finished=0}")}
	words="boot $n finds what was there${found:+ ($found)}"
	[ "$end" ] && words="$words, and brings it to its end ($(told finished))" || words="$words; cut $moment s after the scan began ($(told scans))"
	[ $good = 0 ] && echo "ok $n - $words" || {
		why=$(told failed)
		echo "not ok $n - $words: ${why:-see $cache/cuts.console.log}"
	}
	[ $good = 0 ] || exit 1
done
echo "# after $resumed cuts a partial scan was gone on with; $finished scans are finished and whole"
