#!/bin/sh
# Runs in QEMU, as root, under systemd (screen.sh). Prints TAP.
export LC_ALL=C.UTF-8
. /usr/lib/pleinair/test/guest-tap.sh
comment "$(uname -r); the test begins $(uptime_ms) ms after the kernel"
mkdir -p /run/out
mount -t 9p -o trans=virtio,version=9p2000.L,cache=none out /run/out
modprobe uinput
pictures=0
bright=
look() { # Asks for a picture: how bright is the screen?
	pictures=$((pictures + 1))
	echo "# picture $pictures"
	seen() { [ -s "/run/out/$pictures.mean" ]; }
	wait_for 30 seen || return 1
	read -r bright size < "/run/out/$pictures.mean"
}
is_bright() { look && [ "$bright" -gt 200 ]; }
is_dark() { look && [ "$bright" -lt 100 ]; }
until_it() { # SECONDS is_bright|is_dark
	until="$(($(uptime_ms) + $1 * 1000))"
	until $2; do
		[ "$(uptime_ms)" -lt $until ] || return 1
		sleep 2
	done
}
main_of() { systemctl show --value -p MainPID pleinair-kiosk.service; }

until_it 120 is_bright
result $? "weston and the kiosk show themselves on the kernel's own screen, $size"
comment "brightness $bright in picture $pictures, $(uptime_ms) ms after the kernel began"
comment "$(ls -l /dev/dri /dev/input 2> /dev/null | tr -s ' ' | tr '\n' ';')"
pid=$(main_of)
[ "$(systemctl is-active pleinair-kiosk.service)" = active ] && [ "$(stat -c %U:%G "/proc/$pid")" = pleinair-kiosk:pleinair ]
result $? "as the unit's own user, not root: $(tr '\0' ' ' < "/proc/$pid/cmdline")"

plug_in() {
	rm -f /run/fingers.in /run/fingers.out
	mkfifo /run/fingers.in
	/usr/lib/pleinair/test/fingers < /run/fingers.in > /run/fingers.out &
	exec 4> /run/fingers.in
	ready() { grep -q ready /run/fingers.out; }
	wait_for 10 ready
	udevadm settle
	sleep 2
}
# Where the colours are chosen, at the upper right (KIOSK: 1220 of 1280, 32 of 800).
tap_colours() { echo "tap 0.953 0.04" >&4; }
plug_in
result $? "a touch panel is plugged in"
comment "$(udevadm info --query=property --name="$(ls -t /dev/input/event* | head -1)" | grep -E 'ID_INPUT|NAME' | tr '\n' ' ')"
tap_colours
until_it 40 is_dark
result $? "a finger on it darkens the colours"
comment "brightness $bright in picture $pictures"
echo quit >&4
exec 4>&-
sleep 2
plug_in
tap_colours
until_it 40 is_bright
result $? "unplugged and plugged in again, it is followed as before"
comment "brightness $bright in picture $pictures"

killed=$(uptime_ms)
kill -KILL "$(grep -lx pleinair-kiosk /proc/[0-9]*/comm | cut -d/ -f3)"
gone() { ! kill -0 "$pid"; }
wait_for 20 gone
until_it 120 is_bright && [ "$(main_of)" != "$pid" ]
result $? "killed, the kiosk is on the screen again after $(($(uptime_ms) - killed)) ms"
comment "$(journalctl -b -u pleinair-kiosk.service --no-pager -o short-monotonic | grep -iE 'error|fail|warn|systemd|segfault' | tail -20)"
bye
