#!/bin/sh
# scan.sh BUILD: boots Debian's kernel in QEMU with the simulated head behind the kernel's own drivers, as devices.sh does, and lets the real programs
# scan there as the service's user under the rules that are shipped: every driver, and the faults that devices have. A scan without a fault is
# compared, cell by cell, with one that never saw a kernel. Prints TAP, or skips it all with a reason.
build=$1
. tests/kernel/kernel.sh
prepare_devices scan
cp "$here/scan.conf" "$appliance/etc/pleinair.conf"
out=$cache/out
rm -rf "$out" && mkdir -p "$out"

# The lidars turn fast, so that a draft takes seconds. Ranges have no noise, for the comparison.
scene='seed=7&camera=none&home_deg=330'
late='latency_ms=55'
exact="hall?lidar=cola&rate_hz=45&noise_mm=0&dropouts=0&$scene&$late"
simulate exact "$exact"
simulate tim "hall?lidar=cola&rate_hz=45&$scene&$late&fault=unplug@150:1.5,epstall@300,drop@450x3,stall@600:2,split@700:512,garble@800x2,slip@900:40,merge@1000x2"
simulate hokuyo "hall?lidar=scip&ares=1440&$scene&$late&fault=unplug@300:1.5,drop@500x3,epstall@700,stall@900:2,garble@1100x2"
simulate acm "hall?lidar=scip&ares=1440&$scene&$late&fault=drop@300x3,unplug@600:1.5,stall@900:2"
begun=$(date +%s)
boot scan "net.ifnames=0 test=/usr/lib/pleinair/test/scan-guest.sh $ports" -netdev user,id=n -device virtio-net-pci,netdev=n \
	-fsdev "local,id=o,path=$out,security_model=none,multidevs=remap" -device virtio-9p-pci,fsdev=o,mount_tag=out
# The same scan in one process, and how far the two are the same.
rm -rf "$out/in-process"
"$build/bin/pleinair-scan" "$out/in-process" --preset draft --device "sim:$exact" > "$cache/in-process.log" 2>&1
"$build/tests/kernel/compare-scans" "$out/exact" "$out/in-process" | sed 's/^/# the scan through the kernel, and the one in a process: /'
tell scan "$begun"
