#!/bin/sh
# Runs in QEMU as the only program, as root: loads the drivers, starts the agent (agent.h), and looks at each device with a simple tool of others. Prints
# TAP on the second serial line.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8
exec < /dev/null > /dev/ttyS1 2> /dev/console
. /usr/lib/pleinair/test/guest-tap.sh
begin
comment "drivers are loaded $(uptime_ms) ms after the kernel began"
$test/agent --sim "10.0.2.2:$(argument agent_tim)" --camera /dev/video10 --commands /run/agent \
	--usb "10.0.2.2:$(argument usb_tim)" --usb "10.0.2.2:$(argument usb_hokuyo)" --usb "10.0.2.2:$(argument usb_bridge)" > /run/ready &
is_ready() { grep -q ready /run/ready; }
wait_for 20 is_ready
result $? "the agent reaches the simulator"
all_plugged() { [ "$(cat /sys/bus/usb/devices/1-*/idVendor 2> /dev/null | sort -u | wc -l)" -eq 3 ] && [ -e /dev/ttyACM0 ] && [ -e /dev/ttyUSB0 ]; }
wait_for 20 all_plugged
udevadm settle
lsusb | grep -v 1d6b: > /run/lsusb
comment "$(cat /run/lsusb)"
comment "devices are there $(uptime_ms) ms after the kernel began"
grep -q 19a2:5001 /run/lsusb && grep -q 15d1:0000 /run/lsusb && grep -q 10c4:ea60 /run/lsusb
result $? "the kernel has a TiM, a Hokuyo and a CP2102"
[ "$(stat -c %a:%G /dev/ttyACM0 /dev/ttyUSB0 /dev/gpiochip0 /dev/video10 | tr '\n' ' ')" = "660:dialout 660:dialout 660:gpio 660:video " ] &&
	[ -e /dev/pleinair/hokuyo ] && [ -e /dev/pleinair/serial-lidar ]
result $? "the shipped rules of udev give devices to the service's groups"
comment "$(stat -c '%a:%G %n' /dev/ttyACM0 /dev/ttyUSB0 /dev/gpiochip0 /dev/video10 /dev/pleinair/* | tr '\n' ';')"
as_service() { setpriv --reuid=pleinair-acquired --regid=pleinair --groups=pleinair,plugdev,dialout,video,gpio --no-new-privs "$@"; }
said=$(as_service $test/usb-probe 5)
result $? "a program reads the TiM's telegrams by libusb, and none is missing"
comment "$said"
talk() { # TTY BAUD COMMAND
	stty -F "$1" "$2" raw -echo -hupcl
	exec 3<> "$1"
	printf '%s\n' "$3" >&3
	timeout 1 cat <&3
	exec 3>&-
}
said=$(talk /dev/ttyACM0 115200 VV)
printf '%s' "$said" | grep -q SERI
result $? "the Hokuyo answers VV on /dev/ttyACM0"
comment "$said"
said=$(talk /dev/ttyUSB0 115200 VV)
printf '%s' "$said" | grep -q SERI
result $? "and behind the bridge on /dev/ttyUSB0"
comment "$(stty -F /dev/ttyUSB0 | head -1)"

chip=$(gpiodetect | sed -n 's/^\([^ ]*\) \[pleinair\].*/\1/p')
said=$(gpioinfo "$chip")
comment "$said"
printf '%s' "$said" | grep -q '"step"' && printf '%s' "$said" | grep -q '"led_fault"'
result $? "the pins of the stage are there by name"
gpiomon --format='%o %e %s.%n' "$chip" 3 4 > /run/edges &
monitor=$!
sleep 0.5
turn() { # COUNT RATE
	begun=$(uptime_ms)
	$test/pulse "$chip" "$1" 1 "$2"
	comment "$1 pulses at $2 a second took $(($(uptime_ms) - begun)) ms"
	echo state > /run/agent
}
# Past home, an endpoint halts, and a plug is pulled amid a telegram, to be in again a second later.
$test/usb-probe 12 > /run/halted &
probe=$!
sleep 1
turn 300 100
turn 700 400
wait $probe
comment "$(cat /run/halted)"
grep -q ' [1-9][0-9]* halts, unplugged' /run/halted
result $? "the TiM's endpoint halts and goes on when that is cleared; its plug is pulled"
turn 1000 1500
sleep 0.3
kill $monitor
echo state > /run/agent
comment "$(cat /run/edges)"
grep -q '^3 1' /run/edges && grep -q '^4 1' /run/edges
result $? "pulses turn the head past its index and home slots"

has_tim() { grep -q 19a2 /sys/bus/usb/devices/1-*/idVendor; }
wait_for 10 has_tim
udevadm settle
said=$(as_service $test/usb-probe 3)
result $? "plugged in again, it talks as before"
comment "$said"

v4l2-ctl -d /dev/video10 --stream-mmap --stream-count=6 --stream-to=/run/frames --verbose > /run/v4l2 2>&1 &
camera=$!
wait_for 15 sh -c "! kill -0 $camera 2> /dev/null"
comment "$(grep -E 'Width|Pixel|cap dqbuf' /run/v4l2)"
[ "$(stat -c %s /run/frames)" -eq $((6 * 360 * 640 * 2)) ]
result $? "the camera gives frames"
echo state > /run/agent
sleep 0.3
bye
