#!/bin/sh
# Runs in QEMU as the only program, as root: loads the drivers, starts udev with the rules that are shipped and the agent (agent.h), and scans as the
# service's user. Prints TAP on the second serial line.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8
exec < /dev/null > /dev/ttyS1 2> /dev/console
. /usr/lib/pleinair/test/guest-tap.sh
begin
mkdir -m 777 /run/sites /run/out
mount -t 9p -o trans=virtio,version=9p2000.L out /run/out
as_service() { prlimit --rtprio=90 --memlock=unlimited setpriv --reuid=pleinair-acquired --regid=pleinair --groups=pleinair,plugdev,dialout,video,gpio "$@"; }

plug_in() { # SIMULATOR VENDOR
	rm -f /run/ready /run/agent
	$test/agent --sim "10.0.2.2:$(argument "agent_$1")" --commands /run/agent --usb "10.0.2.2:$(argument "usb_$1")" > /run/ready &
	agent=$!
	is_ready() { grep -q ready /run/ready && grep -q "$vendor" /sys/bus/usb/devices/1-*/idVendor 2> /dev/null; }
	vendor=$2
	wait_for 20 is_ready
	result $? "$1: the agent reaches the simulator, and the kernel has the device"
	udevadm settle --timeout=20
}
pull_out() {
	echo state > /run/agent
	sleep 0.3
	echo quit > /run/agent
	wait $agent
}

# What was said while it waited, each sentence once.
sentences() { sed -n 's/^[0-9.]* waiting: //p' /run/progress | sort | uniq -c | sed 's/^ *\([0-9]*\) /\1 x: /'; }
scan() { # SITE ARGUMENTS...
	site=$1
	shift
	begun=$(uptime_ms)
	jiffies=$(sed -n 's/^cpu  //p' /proc/stat)
	as_service env PLEINAIR_PROGRESS_FD=3 pleinair scan "/run/sites/$site" --json "$@" > /run/said 2> /run/complaint 3> /run/progress
	status=$?
	took=$(($(uptime_ms) - begun))
	return $status
}
number() { sed -n "s/.*\"$1\" : \([-0-9.]*\).*/\1/p" /run/said; }
tell_scan() {
	comment "$(tr -d '\n' < /run/said | tr -s ' ')"
	comment "$(cat /run/complaint)"
	comment "$(sentences)"
	comment "it took $took ms; of them $(sed -n 's/^cpu  //p' /proc/stat | awk -v before="$jiffies" '{ split(before, b)
		printf "%d ms idle, %d ms in programs, %d ms in the kernel", ($4 - b[4]) * 10, ($1 + $2 - b[1] - b[2]) * 10, ($3 + $6 + $7 - b[3] - b[6] - b[7]) * 10 }')"
}
# Each sentence that is expected, in a file a line each.
says_all() { # WORDS...
	for words; do
		grep -q "waiting: .*$words" /run/progress || { comment "nobody said: $words"; return 1; }
	done
}

# For trying one alone: only=NAME among the kernel's arguments.
wanted() { [ -z "$(argument only)" ] || [ "$(argument only)" = "$1" ]; }

# ---- without a fault, to be compared
exact() {
plug_in exact 19a2
comment "$(ls -l /dev/bus/usb/001 /dev/gpiochip* | grep -v total)"
comment "$(as_service pleinair doctor /run/sites 2>&1)"
scan exact --preset draft
result $? "exact: a draft scan through libusb and libgpiod, as the service's user"
[ "$(number missing_columns)" = 0 ] && [ "$(number lost_revolutions)" = 0 ] && [ "$(number sessions)" = 1 ]
result $? "exact: nothing is missing, nothing was lost"
tell_scan
cp -r /run/sites/exact /run/out/

pull_out
}
wanted exact && exact

faulty() { # NAME VENDOR WORDS... -- ARGUMENTS...
	name=$1
	wanted "$name" || return 0
	plug_in "$1" "$2"
	shift 2
	expected=
	while [ "$1" != -- ]; do
		expected="$expected|$1"
		shift
	done
	shift
	scan "$name" --preset draft "$@"
	result $? "$name: a draft scan with faults comes to its end"
	[ "$(number missing_columns)" = 0 ] && [ "$(number sessions)" = 1 ]
	result $? "$name: nothing is missing"
	IFS='|'
	set -- ${expected#|}
	unset IFS
	says_all "$@"
	result $? "$name: each fault has its sentence"
	tell_scan
	pull_out
}
faulty tim 19a2 unplugged silent -- --device tim:
faulty hokuyo 15d1 unplugged silent -- --device scip:
faulty acm 15d1 unplugged silent -- --device scip:/dev/ttyACM0
bye
