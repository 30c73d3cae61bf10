# Read by the tests that boot Debian's kernel in QEMU (run.sh, devices.sh), with $build set: unpacks the kernel, makes what runs first, installs
# the appliance, boots. No KVM is needed. What it needs and does not find skips the whole test, with a reason.
cache=$PWD/$build/kernel
here=$PWD/tests/kernel
PATH=$PATH:/sbin:/usr/sbin
skip() {
	echo "1..0 # SKIP $*"
	exit 0
}
fail() {
	echo "Bail out! $*"
	exit 1
}
needs() { # PROGRAM...
	for program; do
		command -v "$program" > /dev/null || skip "$program is not installed"
	done
}

# Tests run side by side: what they share is made by one at a time.
mkdir -p "$cache"
alone() { exec 9> "$cache/lock" && flock 9; }
together() { exec 9>&-; }

# The kernel that Debian has today, as it is for real machines: unpacked, not installed.
unpack_kernel() {
	needs qemu-system-x86_64 busybox modprobe depmod cpio udevadm dpkg-deb python3
	mkdir -p "$cache"
	package=$(apt-cache depends linux-image-amd64 2> /dev/null | sed -n 's/.*Depends: \(linux-image-[0-9]\)/\1/p' | head -1)
	[ -n "$package" ] || package=$(basename "$(ls -d "$cache"/linux-image-*/ 2> /dev/null | tail -1)")
	case $package in linux-image-*) ;; *) skip "apt knows no linux-image-amd64, and none was kept in $cache" ;; esac
	kernel=$cache/$package
	release=${package#linux-image-}
	[ -e "$kernel/vmlinux" ] && return
	(cd "$cache" && apt-get download "$package" > download.log 2>&1) || skip "$package cannot be downloaded"
	rm -rf "$kernel" && dpkg-deb -x "$cache/$package"_*.deb "$kernel" || fail "$package cannot be unpacked"
	rm "$cache/$package"_*.deb
	depmod -b "$kernel" "$release" || fail "depmod cannot read the modules"
	python3 "$here/unpack-kernel.py" "$kernel"/boot/vmlinuz-* "$kernel/vmlinux" || fail "the kernel cannot be unpacked"
}

# What runs first: busybox, and the modules that the root folder needs.
make_first() { # NAME
	first=$cache/$1
	rm -rf "$first" && mkdir -p "$first/bin" "$first/modules"
	cp "$(command -v busybox)" "$first/bin/busybox"
	cp "$here/first.sh" "$first/init" && chmod 755 "$first/init"
	n=10
	for file in $(for m in virtio_pci 9pnet_virtio 9p overlay; do
		modprobe -d "$kernel" -S "$release" --show-depends "$m" || modprobe -d "$kernel" -S "$release" --show-depends "$(echo $m | tr _ -)"
	done | sed -n 's/^insmod \([^ ]*\).*/\1/p' | awk '!seen[$0]++'); do
		cp "$file" "$first/modules/$n-$(basename "$file")"
		n=$((n + 1))
	done
	(cd "$first" && find . | cpio --quiet -o -H newc | gzip -1) > "$cache/$1.new"
	# Another test's QEMU may be reading the one that was there.
	mv "$cache/$1.new" "$cache/$1.gz"
}

install_appliance() { # NAME
	appliance=$cache/$1
	rm -rf "$appliance"
	make --no-print-directory install BUILD="$build" DESTDIR="$appliance" PREFIX=/usr > "$cache/install.log" 2>&1 || fail "make install: see $cache/install.log"
	mkdir -p "$appliance/usr/lib/pleinair/test"
}

# A processor without AVX: Embree never comes back from what QEMU 7.2 makes of it.
# Its time goes by instructions, four nanoseconds each, and while it has nothing to do by the clock: on a busy machine it takes longer, but in its
# own time nothing comes late, and nothing is lost for that. What guards real processors against spying programs costs QEMU a sixth of its time.
# Lines of the test come by one serial line, all else by another. A file, since an exit status of QEMU says nothing.
boot() { # NAME KERNEL-ARGUMENTS QEMU-ARGUMENTS...
	name=$1
	arguments=$2
	shift 2
	said=$cache/$name.tap
	: > "$said"
	timeout --kill-after=5 "${KERNEL_TEST_SECONDS:-900}" qemu-system-x86_64 -M q35 -accel tcg,tb-size=1024 -icount shift=2 -cpu Nehalem -smp 1 -m 3072 \
		-nodefaults -no-user-config -no-reboot -display none -vga none -serial "file:$cache/$name.console.log" -serial "file:$said" \
		-kernel "$kernel/vmlinux" -initrd "$cache/first.gz" -append "console=ttyS0 quiet panic=-1 tsc=reliable no_timer_check norandmaps \
nokaslr mitigations=off init_on_alloc=0 modules=$kernel/lib/modules $arguments $KERNEL_TEST_ARGUMENTS" \
		-fsdev local,id=h,path=/,security_model=none,readonly=on,multidevs=remap -device virtio-9p-pci,fsdev=h,mount_tag=host \
		-fsdev "local,id=a,path=$appliance,security_model=none,readonly=on,multidevs=remap" -device virtio-9p-pci,fsdev=a,mount_tag=appliance \
		"$@" < /dev/null > "$cache/$name.qemu.log" 2>&1
}

# Prints what the test in QEMU said, and how it ended.
tell() { # NAME BEGUN
	tr -d '\r' < "$cache/$1.tap"
	echo "# $(($(date +%s) - $2)) s; console: $build/kernel/$1.console.log"
	grep -q '^1\.\.' "$cache/$1.tap" || fail "the test in QEMU did not come to its end: see $build/kernel/$1.console.log"
	! grep -q '^not ok' "$cache/$1.tap"
}

# Simulators that run here, outside of QEMU. The guest is told the ports that each chose: usb_NAME=PORT agent_NAME=PORT.
simulators=
ports=
trap 'kill $simulators 2> /dev/null' EXIT
simulate() { # NAME DESCRIPTION OPTIONS...
	told=$cache/simulator-$1.ports
	rm -f "$told"
	log=$cache/simulator-$1.log
	name=$1
	description=$2
	shift 2
	"$build/bin/pleinair-sim" --kernel 0 "$@" "$description" > "$told" 2> "$log" &
	simulators="$simulators $!"
	for _ in $(seq 100); do
		[ -s "$told" ] && break
		sleep 0.1
	done
	[ -s "$told" ] || fail "the simulator $name does not start: $(cat "$log")"
	ports="$ports $(sed "s/usbip=/usb_$name=/; s/agent=/agent_$name=/" "$told")"
}

# All that a boot with devices of the kernel's own drivers needs: NAME-guest.sh runs there.
prepare_devices() { # NAME GUEST
	alone
	unpack_kernel
	modules=$cache/modules-$release
	why=$(sh "$here/modules.sh" "$release" "$modules" 2>&1) || skip "$why"
	make_first first
	install_appliance "appliance-$1"
	test=$appliance/usr/lib/pleinair/test
	cp "$modules"/*.ko "$build/tests/kernel/agent" "$here/$2" "$here/guest-tap.sh" "$test/"
	chmod 755 "$test/$2"
	together
}
