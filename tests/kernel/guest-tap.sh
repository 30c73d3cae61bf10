# Read by what runs in QEMU without systemd, as the only program.
test=/usr/lib/pleinair/test
n=0
result() { # STATUS WORDS: 0 is good
	n=$((n + 1))
	if [ "$1" -eq 0 ]; then echo "ok $n - $2"; else echo "not ok $n - $2"; fi
}
comment() { printf '%s\n' "$*" | sed 's/^/# /'; }
argument() { sed -n "s|.*[ ]$1=\([^ ]*\).*|\1|p" /proc/cmdline; }
uptime_ms() { awk '{ printf "%d", $1 * 1000 }' /proc/uptime; }
wait_for() { # SECONDS COMMAND...
	left=$(($1 * 5))
	shift
	until "$@"; do
		[ "$left" -gt 0 ] || return 1
		left=$((left - 1))
		sleep 0.2
	done
}
bye() {
	comment "the test ends $(uptime_ms) ms after the kernel began"
	echo "1..$n"
	dmesg > /dev/console
	busybox poweroff -f
	sleep 100
}
begin() { # The drivers, udev with the rules that are shipped, and the way to the simulators.
	comment "$(uname -r); the test begins $(uptime_ms) ms after the kernel"
	/lib/systemd/systemd-udevd --daemon
	modprobe -a configfs virtio_net vhci_hcd cdc_acm cp210x videodev
	insmod $test/gpio-sim.ko
	insmod $test/v4l2loopback.ko exclusive_caps=1 video_nr=10 card_label=head
	ip link set lo up
	ip link set eth0 up
	ip address add 10.0.2.15/24 dev eth0
}
