#!/bin/sh
# scan.sh BUILD: boots Debian's kernel in QEMU with the simulated head behind the kernel's own drivers, as devices.sh does, and lets the real programs
# scan there as the service's user under the rules that are shipped: every driver, and the faults that devices have. A scan without a fault is
# compared, cell by cell, with one that never saw a kernel. Prints TAP, or skips it all with a reason.
#
# ONLY="NAME..." takes these; ONLY=all takes those too that a release is tried with, which last a quarter of an hour. faults.sh takes some beside it.
build=$1
self=${self:-scan}
: "${ONLY:=camera exact ld}"
. tests/kernel/kernel.sh
[ "$ONLY" != all ] || ONLY="camera exact tim acm ld hokuyo rplidar rates-tim rates-hokuyo"
prepare_devices "$self" scan-guest.sh
cp "$here/scan.conf" "$appliance/etc/pleinair.conf"
cp "$build/tests/kernel/camera-faults" "$test/"
out=$cache/out-$self
rm -rf "$out" && mkdir -p "$out"

# The lidars turn fast, so that a draft takes seconds. Ranges have no noise, for the comparison.
scene='seed=7&home_deg=330&latency_ms=55'
exact="hall?lidar=cola&rate_hz=45&noise_mm=0&dropouts=0&camera=none&$scene"
camera='camera=120x214&fps=5'
"$build/bin/pleinair-sim" --certificate "hall?$camera&$scene" > "$test/certificate.json" || fail "the simulator has no certificate"
wanted() { case " $ONLY " in *" $1 "*) ;; *) false ;; esac; }
offer() { # NAME DESCRIPTION OPTIONS...
	wanted "$1" && simulate "$@"
}
offer exact "$exact"
offer tim "hall?lidar=cola&rate_hz=45&$camera&$scene&fault=unplug@150:1.5,epstall@300,drop@450x3,badframe@500x2,stall@600:2,split@700:512,garble@800x2,slip@900:40,merge@1000x2"
offer acm "hall?lidar=scip&ares=1440&camera=none&$scene&fault=drop@300x3,unplug@600:1.5,stall@900:2"
offer ld "hall?lidar=stl27l&rate_hz=30&camera=none&$scene" --plug cp2102
offer hokuyo "hall?lidar=scip&ares=1440&camera=none&$scene&fault=unplug@300:1.5,drop@500x3,epstall@700,stall@900:2,garble@1100x2"
offer rplidar "hall?lidar=rplidar-s2&camera=none&$scene&fault=unplug@600:1.5,stall@900:2" --plug cp2102
offer stream "hall?lidar=scip&ares=1440&camera=none&$scene"
offer rates-tim "hall?lidar=cola&camera=none&$scene"
offer rates-hokuyo "hall?lidar=scip&ares=1440&camera=none&$scene"
begun=$(date +%s)
boot "$self" "net.ifnames=0 test=/usr/lib/pleinair/test/scan-guest.sh only=$(echo "$ONLY" | tr ' ' ,) $ports" -netdev user,id=n -device virtio-net-pci,netdev=n \
	-fsdev "local,id=o,path=$out,security_model=none,multidevs=remap" -device virtio-9p-pci,fsdev=o,mount_tag=out

# The same scan in one process, and how far the two are the same. Steps and the mirror never meet twice in the same way, so the bar is how far another
# scan in one process, that finds home from elsewhere, is the same.
in_process() { # NAME DESCRIPTION
	rm -rf "${out:?}/$1"
	"$build/bin/pleinair-scan" "$out/$1" --preset draft --device "sim:$2" > "$cache/$1.log" 2>&1 || fail "$1: $(cat "$cache/$1.log")"
}
compare() { "$build/tests/kernel/compare-scans" "$out/$1" "$out/in-process"; }
is_as_equal() {
	in_process in-process "$exact"
	in_process in-process-again "$exact&home_deg=200"
	there=$(compare exact) && again=$(compare in-process-again) || return 1
	echo "# through the kernel and in one process: $there"
	echo "# in one process twice: $again"
	echo "${there%% *} ${again%% *}" | awk '{ exit !($1 >= $2 - 0.5) }'
}
if wanted exact && grep -q '^1\.\.' "$said"; then
	is_as_equal && good=ok || good='not ok'
	tests=$(($(tr -d '\r' < "$said" | sed -n 's/^1\.\.//p') + 1))
	sed -i '/^1\.\./d' "$said"
	printf '%s %s - exact: the scan equals one that saw no kernel\n1..%s\n' "$good" "$tests" "$tests" >> "$said"
fi
tell "$self" "$begun"
