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
wanted() { case ",$(argument only)," in *",$1,"*) ;; *) false ;; esac; }

plug_in() { # SIMULATOR VENDOR OPTIONS-OF-THE-AGENT...
	rm -f /run/ready /run/agent
	name=$1
	vendor=$2
	shift 2
	$test/agent --sim "10.0.2.2:$(argument "agent_$name")" --commands /run/agent --usb "10.0.2.2:$(argument "usb_$name")" "$@" > /run/ready &
	agent=$!
	is_ready() { grep -q ready /run/ready && grep -q "$vendor" /sys/bus/usb/devices/1-*/idVendor 2> /dev/null; }
	wait_for 20 is_ready
	result $? "$name: the agent reaches the simulator, and the kernel has the device"
	udevadm settle --timeout=20
}
pull_out() {
	echo state > /run/agent
	sleep 0.3
	echo quit > /run/agent
	wait $agent
}
line() { echo "line $1 $2" > /run/agent; }

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
	[ ! -s /run/complaint ] || comment "$(cat /run/complaint)"
	sentences | sed 's/^/# /'
	comment "it took $took ms; of them $(sed -n 's/^cpu  //p' /proc/stat | awk -v before="$jiffies" '{ split(before, b)
		printf "%d ms idle, %d ms in programs, %d ms in the kernel", ($4 - b[4]) * 10, ($1 + $2 - b[1] - b[2]) * 10, ($3 + $6 + $7 - b[3] - b[6] - b[7]) * 10 }')"
}

exact() { # without a fault, to be compared
	plug_in exact 19a2
	comment "$(ls -l /dev/bus/usb/001/* /dev/gpiochip*)"
	comment "$(as_service pleinair doctor /run/sites 2>&1)"
	scan exact --preset draft
	result $? "exact: a draft scan through libusb and libgpiod, as the service's user"
	[ "$(number missing_columns)" = 0 ] && [ "$(number lost_revolutions)" = 0 ] && [ "$(number sessions)" = 1 ]
	result $? "exact: nothing is missing, nothing was lost"
	tell_scan
	cp -r /run/sites/exact /run/out/
	pull_out
}

# A sentence is expected while it waits for each.
faulty() { # NAME WORD,... ARGUMENTS...
	name=$1
	words=$(echo "$2" | tr , ' ')
	shift 2
	scan "$name" --preset draft "$@"
	result $? "$name: a draft scan with faults comes to its end"
	[ "$(number missing_columns)" = 0 ] && [ "$(number sessions)" = 1 ]
	result $? "$name: nothing is missing"
	unsaid=
	for word in $words; do grep -q "waiting: .*$word" /run/progress || unsaid="$unsaid $word"; done
	[ -z "$unsaid" ]
	result $? "$name: each fault has its sentence${unsaid:+, but for$unsaid}"
	tell_scan
}
tim() {
	plug_in tim 19a2 --camera /dev/video10
	faulty tim unplugged,silent --device "tim:?camera.node=/dev/video10&camera.timestamps=trust&camera.width=120&camera.height=214&head.certificate=$test/certificate.json"
	[ "$(number photos)" -ge 18 ]
	result $? "tim: a photo from each of 18 angles, through V4L2, though frames are damaged and lost"
	cp -r /run/sites/tim /run/out/
	pull_out
}
hokuyo() {
	plug_in hokuyo 15d1
	faulty hokuyo unplugged,silent --device scip:
	pull_out
}
acm() {
	plug_in acm 15d1
	faulty acm unplugged,silent --device scip:/dev/ttyACM0
	pull_out
}
rplidar() {
	plug_in rplidar 10c4
	faulty rplidar unplugged,silent --device rplidar:/dev/ttyUSB0
	pull_out
}

# Stopped for safety in the middle of a pass, by one contact after the other: each time the scan ends partial with a sentence, nothing moves until it is
# gone on with, and at last it becomes whole.
sentence_of() { case $1 in estop) echo 'emergency stop is pressed' ;; interlock) echo 'interlock is open' ;; esac; }
ld() {
	plug_in ld 10c4
	set -- --preset draft --device ld:/dev/ttyUSB0
	for contact in estop interlock; do
		(
			sleep 12
			line $contact 0
			sleep 1
			line $contact 1
		) &
		! scan ld "$@" && grep -q "$(sentence_of $contact)" /run/complaint
		result $? "ld: $contact stops the scan, and it says so"
		comment "$(cat /run/complaint)"
		wait $!
		set -- --resume
	done
	scan ld --resume
	result $? "ld: it is gone on with and comes to its end"
	[ "$(number missing_columns)" = 0 ] && [ "$(number sessions)" = 3 ]
	result $? "ld: nothing is missing"
	tell_scan
	pull_out
}

# The kernel's own test cameras, which fail as they are told: one a webcam, one a box behind an HDMI cable.
camera() {
	modprobe vivid n_devs=2 node_types=0x1,0x1 num_inputs=1,1 input_types=0x0,0x3 multiplanar=1,2 vid_cap_nr=20,21
	nodes_are_ours() { [ "$(stat -c %a:%G /dev/video20 /dev/video21 2> /dev/null | tr '\n' ' ')" = "660:video 660:video " ]; }
	wait_for 20 nodes_are_ours
	as_service $test/camera-faults /dev/video20 /dev/video21 > /run/faults 2>&1
	grep -Eo '^(not )?ok .*' /run/faults > /run/faults.ok
	while read -r line; do
		[ "${line#ok}" != "$line" ]
		result $? "camera: ${line##* }"
	done < /run/faults.ok
	[ "$(grep -c '^ok' /run/faults.ok)" = "$(sed -n 's/^1\.\.//p' /run/faults)" ]
	result $? "camera: all that the kernel's test cameras can fail in"
	comment "$(grep -E 'Bail out|^# [^*]*(a frame each|the camera |/dev/video| lost|restarts)' /run/faults | grep -v 'DEBUG\|MESSAGE\|format that' | sed 's/^# *//; s/pleinair-Message: [0-9:.]*//')"
	modprobe -r vivid
}

rate() { # NAME VENDOR DEVICE SECONDS
	plug_in "$1" "$2"
	said=$(as_service pleinair doctor --device "$3" --stream "$4" /run/sites 2>&1)
	result $? "$1: nothing is lost in $4 s at full rate"
	comment "$said"
	pull_out
}

for test_of in camera exact tim acm ld hokuyo rplidar; do
	! wanted $test_of || $test_of
done
! wanted stream || rate stream 15d1 scip: 5
! wanted rates-tim || rate rates-tim 19a2 tim: 60
! wanted rates-hokuyo || rate rates-hokuyo 15d1 scip: 60
bye
