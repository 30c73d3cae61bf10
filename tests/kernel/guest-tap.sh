# Read by what runs in QEMU without systemd.
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
