#!/bin/sh
# run.sh BUILD: boots Debian's kernel in QEMU with this machine's root folder, read-only, and what `make install` makes, above it; systemd
# starts the daemons there, and guest.sh looks at them. No KVM is needed. Prints TAP, or skips it all with a reason.
build=$1
cache=$PWD/$build/kernel
here=$PWD/tests/kernel
skip() {
	echo "1..0 # SKIP $*"
	exit 0
}
fail() {
	echo "Bail out! $*"
	exit 1
}
for program in qemu-system-x86_64 busybox modprobe depmod cpio udevadm dpkg-deb python3; do
	PATH=$PATH:/sbin:/usr/sbin command -v $program > /dev/null || skip "$program is not installed"
done
PATH=$PATH:/sbin:/usr/sbin
[ -x /lib/systemd/systemd ] || skip "systemd is not installed"
mkdir -p "$cache"

# The kernel that Debian has today, as it is for real machines: unpacked, not installed.
package=$(apt-cache depends linux-image-amd64 2> /dev/null | sed -n 's/.*Depends: \(linux-image-[0-9]\)/\1/p' | head -1)
[ -n "$package" ] || package=$(basename "$(ls -d "$cache"/linux-image-*/ 2> /dev/null | tail -1)")
case $package in linux-image-*) ;; *) skip "apt knows no linux-image-amd64, and none was kept in $cache" ;; esac
kernel=$cache/$package
if [ ! -e "$kernel/vmlinux" ]; then
	(cd "$cache" && apt-get download "$package" > download.log 2>&1) || skip "$package cannot be downloaded"
	rm -rf "$kernel" && dpkg-deb -x "$cache/$package"_*.deb "$kernel" || fail "$package cannot be unpacked"
	rm "$cache/$package"_*.deb
	depmod -b "$kernel" "${package#linux-image-}" || fail "depmod cannot read the modules"
	python3 "$here/unpack-kernel.py" "$kernel"/boot/vmlinuz-* "$kernel/vmlinux" || fail "the kernel cannot be unpacked"
fi

# What runs first: busybox, and the modules that the root folder needs.
first=$cache/first
rm -rf "$first" && mkdir -p "$first/bin" "$first/modules"
cp "$(command -v busybox)" "$first/bin/busybox"
cp "$here/first.sh" "$first/init" && chmod 755 "$first/init"
n=10
for file in $(for m in virtio_pci 9pnet_virtio 9p overlay; do
	modprobe -d "$kernel" -S "${package#linux-image-}" --show-depends "$m" || modprobe -d "$kernel" -S "${package#linux-image-}" --show-depends "$(echo $m | tr _ -)"
done | sed -n 's/^insmod \([^ ]*\).*/\1/p' | awk '!seen[$0]++'); do
	cp "$file" "$first/modules/$n-$(basename "$file")"
	n=$((n + 1))
done
(cd "$first" && find . | cpio --quiet -o -H newc | gzip -1) > "$cache/first.gz"

# The appliance, and on it the test.
appliance=$cache/appliance
rm -rf "$appliance"
make --no-print-directory install BUILD="$build" DESTDIR="$appliance" PREFIX=/usr > "$cache/install.log" 2>&1 || fail "make install: see $cache/install.log"
mkdir -p "$appliance/usr/lib/pleinair/test"
cp "$here/guest.sh" "$appliance/usr/lib/pleinair/test/"
cp "$here"/pleinair-test.* "$appliance/usr/lib/systemd/system/"
printf '[head]\ndevice=sim:hall?lidar=cola&beams=541&camera=none&seed=7&station=%%n\n' > "$appliance/etc/pleinair.conf"

# The simulated head would take all of the only processor, which no scanner does.
drop_in=$appliance/etc/systemd/system/pleinair-acquired.service.d
mkdir -p "$drop_in"
printf '[Service]\nCPUQuota=70%%\n' > "$drop_in/simulated.conf"

# A processor without AVX: Embree never comes back from what QEMU 7.2 makes of it.
# Lines of the test come by one serial line, all else by another. A file, since an exit status of QEMU says nothing.
said=$cache/said.tap
: > "$said"
started=$(date +%s)
timeout --kill-after=5 "${KERNEL_TEST_SECONDS:-350}" qemu-system-x86_64 -M q35 -accel tcg,tb-size=1024 -cpu Nehalem -smp 1 -m 3072 \
	-nodefaults -no-user-config -no-reboot -display none -vga none -serial "file:$cache/console.log" -serial "file:$said" \
	-kernel "$kernel/vmlinux" -initrd "$cache/first.gz" -append "console=ttyS0 quiet panic=-1 tsc=reliable no_timer_check norandmaps \
nokaslr modules=$kernel/lib/modules systemd.unit=pleinair-test.target systemd.condition-needs-update=no \
systemd.show_status=no fstab=no systemd.mask=systemd-update-utmp.service systemd.mask=systemd-binfmt.service \
systemd.mask=proc-sys-fs-binfmt_misc.automount systemd.mask=systemd-timesyncd.service $KERNEL_TEST_ARGUMENTS" \
	-fsdev local,id=h,path=/,security_model=none,readonly=on,multidevs=remap -device virtio-9p-pci,fsdev=h,mount_tag=host \
	-fsdev "local,id=a,path=$appliance,security_model=none,readonly=on,multidevs=remap" -device virtio-9p-pci,fsdev=a,mount_tag=appliance \
	< /dev/null > "$cache/qemu.log" 2>&1
tr -d '\r' < "$said"
echo "# $(($(date +%s) - started)) s; console: $build/kernel/console.log"
grep -q '^1\.\.' "$said" || fail "the test in QEMU did not come to its end: see $build/kernel/console.log"
! grep -q '^not ok' "$said"
