#!/bin/sh
# Runs in QEMU as the only program, as root, on a disk that outlives its power cuts: looks at what the last one left, then scans as the service's user,
# without end or, with end=yes, until the partial scan is finished. Says what happens on the second serial line.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8
exec < /dev/null > /dev/ttyS1 2> /dev/console
. /usr/lib/pleinair/test/guest-tap.sh
die() {
	echo "failed $*"
	busybox poweroff -f
	sleep 100
}
begin
modprobe -a virtio_blk ext4
mkdir -p /run/disk
mount -t ext4 /dev/vda /run/disk || die "the disk cannot be mounted"
dmesg | grep -i 'EXT4-fs' | sed 's/^/# /'
[ -d /run/disk/oak ] || install -d -o pleinair-acquired -g pleinair /run/disk/oak
look() { [ -e /run/disk/oak/site.json ] || return 0; $test/check-site /run/disk/oak 2> /run/wrong || die "$(cat /run/wrong)"; }
echo "found $(look)"
$test/agent --sim "10.0.2.2:$(argument agent_cuts)" --commands /run/agent --usb "10.0.2.2:$(argument usb_cuts)" > /run/ready &
is_ready() { grep -q ready /run/ready && grep -q 19a2 /sys/bus/usb/devices/1-*/idVendor 2> /dev/null; }
wait_for 20 is_ready || die "the devices do not come"
udevadm settle --timeout=20
scan() {
	resume=$(ls -d /run/disk/oak/scans/.*.partial > /dev/null 2>&1 && echo --resume)
	echo "scans ${resume:-anew}"
	prlimit --rtprio=90 --memlock=unlimited setpriv --reuid=pleinair-acquired --regid=pleinair --groups=pleinair,plugdev,dialout,video,gpio \
		pleinair scan /run/disk/oak --preset draft $resume > /run/said 2> /run/complaint || die "the scan: $(cat /run/complaint)"
	echo "finished $(look)"
}
scan
while [ "$(argument end)" != yes ]; do scan; done
umount /run/disk
echo over
bye
