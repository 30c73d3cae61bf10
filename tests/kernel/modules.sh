#!/bin/sh
# modules.sh RELEASE FOLDER: modules for devices that are not there, which Debian's kernel has the sources of and leaves out: gpio-sim.ko (lines by
# name, moved through configfs and sysfs) and v4l2loopback.ko (a camera that a program feeds). They are built from Debian's packages for the
# kernel RELEASE and kept in FOLDER. Says on stderr what is missing, and fails.
release=$1
folder=$2
headers=/lib/modules/$release/build
source=linux-source-$(echo "$release" | sed 's/^\([0-9]*\.[0-9]*\).*/\1/')
[ -e "$folder/gpio-sim.ko" ] && [ -e "$folder/v4l2loopback.ko" ] && exit 0
fail() {
	echo "$*" >&2
	exit 1
}
[ -e "$headers/Makefile" ] || headers=/usr/src/linux-headers-$release
[ -e "$headers/Makefile" ] || sh tests/deps.sh "linux-headers-$release" > /dev/null 2>&1 || fail "linux-headers-$release is not to be had"
mkdir -p "$folder"
work=$(mktemp -d "$folder/work.XXXXXX") || fail "no room in $folder"
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
apt-get download "$source" v4l2loopback-dkms > download.log 2>&1 || fail "$source and v4l2loopback-dkms cannot be downloaded"

# Out of the whole kernel's source, three files. Its simulated interrupts are not in Debian's kernel either: they go into the same module.
dpkg-deb --fsys-tarfile "$source"_*.deb | tar -xO "./usr/src/$source.tar.xz" |
	tar -xJ --strip-components=1 "$source/drivers/gpio/gpio-sim.c" "$source/drivers/gpio/gpiolib.h" "$source/kernel/irq/irq_sim.c" ||
	fail "$source does not hold gpio-sim"
mkdir gpio-sim
mv drivers/gpio/gpio-sim.c gpio-sim/chip.c
mv drivers/gpio/gpiolib.h gpio-sim/
# What that file calls is not exported; the same is had by a way that is.
sed 's/irq_to_desc(\([^()]*\))/irq_data_to_desc(irq_get_irq_data(\1))/' kernel/irq/irq_sim.c > gpio-sim/irq_sim.c
printf 'obj-m := gpio-sim.o\ngpio-sim-y := chip.o irq_sim.o\n' > gpio-sim/Kbuild
dpkg-deb -x v4l2loopback-dkms_*.deb .
mv usr/src/v4l2loopback-* v4l2loopback
# A camera counts its exposures, also those that were lost, and says which frames are damaged. This one knows no numbers of its own.
sed -i 's/^\(\t*\)b->buffer.bytesused = buf->bytesused;/&\n\1b->buffer.sequence = buf->sequence;\n\1b->buffer.flags = (b->buffer.flags \& ~V4L2_BUF_FLAG_ERROR) | (buf->flags \& V4L2_BUF_FLAG_ERROR);/' \
	v4l2loopback/v4l2loopback.c
grep -q 'b->buffer.sequence = buf->sequence' v4l2loopback/v4l2loopback.c || fail "v4l2loopback is not as it was: modules.sh has to be put right"
for module in gpio-sim v4l2loopback; do
	make -C "$headers" M="$work/$module" modules > "$module.log" 2>&1 || fail "$module cannot be built: $(tail -3 "$module.log")"
	mv "$work/$module/$module.ko" "$folder/"
done
