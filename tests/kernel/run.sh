#!/bin/sh
# run.sh BUILD: boots Debian's kernel in QEMU with this machine's root folder, read-only, and what `make install` makes, above it; systemd
# starts the daemons there, and guest.sh looks at them. Prints TAP, or skips it all with a reason.
build=$1
. tests/kernel/kernel.sh
[ -x /lib/systemd/systemd ] || skip "systemd is not installed"
alone
unpack_kernel
make_first first
install_appliance appliance
together
cp "$here/guest.sh" "$appliance/usr/lib/pleinair/test/"
cp "$here"/pleinair-test.* "$appliance/usr/lib/systemd/system/"
printf '[head]\ndevice=sim:hall?lidar=cola&beams=541&camera=none&seed=7&station=%%n\n' > "$appliance/etc/pleinair.conf"

# The simulated head would take all of the only processor, which no scanner does.
drop_in=$appliance/etc/systemd/system/pleinair-acquired.service.d
mkdir -p "$drop_in"
printf '[Service]\nCPUQuota=70%%\n' > "$drop_in/simulated.conf"

begun=$(date +%s)
boot daemons "systemd.unit=pleinair-test.target systemd.condition-needs-update=no systemd.show_status=no fstab=no \
systemd.mask=systemd-update-utmp.service systemd.mask=systemd-binfmt.service systemd.mask=proc-sys-fs-binfmt_misc.automount \
systemd.mask=systemd-timesyncd.service"
tell daemons "$begun"
