#!/bin/sh
# screen.sh BUILD: boots Debian's kernel in QEMU, as run.sh does, with a screen (virtio-gpu) and a touch panel (uinput): systemd starts the shipped unit
# of the touch screen there, weston and the kiosk show themselves by the kernel's DRM, and fingers reach them by evdev. screen-guest.sh says when it
# wants a picture; what the screen shows is taken here, from outside. Prints TAP, or skips it all with a reason.
build=$1
. tests/kernel/kernel.sh
needs weston
alone
unpack_kernel
make_first first
install_appliance appliance-screen
together
test=$appliance/usr/lib/pleinair/test
cp "$build/tests/kernel/fingers" "$here/screen-guest.sh" "$here/guest-tap.sh" "$test/"
cp "$here"/pleinair-screen.* "$appliance/usr/lib/systemd/system/"
printf '[head]\ndevice=\n' > "$appliance/etc/pleinair.conf"
out=$cache/screen
rm -rf "$out" && mkdir -p "$out"
begun=$(date +%s)
python3 "$here/screen-look.py" "$cache/screen.tap" "$cache/monitor" "$out" > "$cache/screen-look.log" 2>&1 &
looker=$!
boot screen "systemd.unit=pleinair-screen.target systemd.condition-needs-update=no systemd.show_status=no fstab=no \
systemd.mask=systemd-update-utmp.service systemd.mask=systemd-binfmt.service systemd.mask=proc-sys-fs-binfmt_misc.automount \
systemd.mask=systemd-timesyncd.service" -device virtio-gpu-pci -monitor "unix:$cache/monitor,server=on,wait=off" \
	-fsdev "local,id=o,path=$out,security_model=none,multidevs=remap" -device virtio-9p-pci,fsdev=o,mount_tag=out
kill $looker 2> /dev/null
tell screen "$begun"
