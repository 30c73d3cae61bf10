#!/bin/sh
# devices.sh BUILD: boots Debian's kernel in QEMU, as run.sh does but without systemd, with the simulated head behind the kernel's own drivers: lidars
# plugged in by USB/IP, a stage on pins of gpio-sim, a camera of v4l2loopback. The simulators run here, since casting rays there is thirty times
# slower; devices-guest.sh looks at what the kernel makes of them. Prints TAP, or skips it all with a reason.
build=$1
. tests/kernel/kernel.sh
prepare_devices devices devices-guest.sh
cp "$build/tests/kernel/usb-probe" "$build/tests/kernel/pulse" "$test/"

simulate tim 'hall?lidar=cola&seed=7&latency_ms=55&camera=360x640&fps=2&home_deg=350&fault=epstall@20,unplug@120:1'
simulate hokuyo 'hall?lidar=scip&ares=1440&seed=7&latency_ms=55&camera=none'
simulate bridge 'hall?lidar=scip&ares=1440&seed=7&latency_ms=55&camera=none' --plug cp2102

begun=$(date +%s)
boot devices "net.ifnames=0 test=/usr/lib/pleinair/test/devices-guest.sh $ports" -netdev user,id=n -device virtio-net-pci,netdev=n
tell devices "$begun"
