#!/bin/busybox sh
# The first program in QEMU: puts the root folder together and lets systemd begin there, or the program that the kernel's argument "test=" names.
# Lowest the machine's own root by 9p, then what `make install` made, above both what is written, in memory.
b=/bin/busybox
die() {
	$b echo "first: $*" > /dev/console
	$b poweroff -f
}
$b mkdir -p /proc /sys /dev /host /appliance /writes /new
$b mount -t proc proc /proc
$b mount -t sysfs sys /sys
$b mount -t devtmpfs dev /dev
for module in /modules/*; do $b insmod "$module"; done
argument() { $b sed -n "s|.*[ ]$1=\([^ ]*\).*|\1|p" /proc/cmdline; }
for folder in host appliance; do
	$b mount -t 9p -o ro,trans=virtio,version=9p2000.L,msize=512000,cache=loose $folder /$folder || die "no $folder"
done
$b mount -t tmpfs -o size=2g tmpfs /writes
$b mkdir /writes/upper /writes/work
$b mount -t overlay -o "lowerdir=/appliance:/host,upperdir=/writes/upper,workdir=/writes/work" overlay /new || die "no overlay"
# Whoever built it, here its folders are root's.
(cd /appliance && $b find . -type d) | while read -r folder; do $b chown 0:0 "/new/$folder"; done
$b rm -f /new/.dockerenv /new/run/.containerenv
$b rm -rf /new/var/lib/pleinair
$b mount -t tmpfs -o mode=755 tmpfs /new/run
$b mount -t tmpfs -o mode=1777 tmpfs /new/tmp
$b mkdir -p /new/usr/lib/modules
$b mount --bind "/host$(argument modules)" /new/usr/lib/modules
test=$(argument test)
for folder in proc sys dev; do $b mount --move /$folder /new/$folder; done
# As a package would do: users of ours, one that may use the appliance, and one that may not.
$b chroot /new /usr/bin/systemd-sysusers > /dev/console 2>&1
$b chroot /new /usr/bin/systemd-sysusers --inline 'u surveyor - - /' 'u passerby - - /' 'm surveyor pleinair' > /dev/console 2>&1
exec $b switch_root /new "${test:-/lib/systemd/systemd}"
