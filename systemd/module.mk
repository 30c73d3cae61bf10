# The appliance: its units, who may what, and where `make install` puts them. Files here name /usr/bin; installing writes PREFIX there.
packages += systemd libxml2-utils
# What `make check-kernel` needs besides: a machine, and what its first program is made of.
kernel_packages := qemu-system-x86 busybox-static e2fsprogs kmod cpio udev dbus libpam-systemd iproute2 weston \
	usbutils usbip v4l-utils gpiod libgpiod-dev libusb-1.0-0-dev linux-headers-amd64 xz-utils
sysconfdir ?= /etc
systemdsystemunitdir ?= $(PREFIX)/lib/systemd/system
sysusersdir ?= $(PREFIX)/lib/sysusers.d
tmpfilesdir ?= $(PREFIX)/lib/tmpfiles.d
modulesloaddir ?= $(PREFIX)/lib/modules-load.d
udevrulesdir ?= $(PREFIX)/lib/udev/rules.d
dbusservicedir ?= $(PREFIX)/share/dbus-1/system-services
# The bus reads what is the machine's own in /etc, and never looks in /usr/local.
dbuspolicydir ?= $(if $(filter /usr,$(PREFIX)),$(PREFIX)/share,$(sysconfdir))/dbus-1/system.d
# FILE:FOLDER/NAME. Those of sysconfdir are the machine's own: one that is there stays.
appliance := $(foreach u,acquired jobsd kiosk,pleinair-$(u).service:$(systemdsystemunitdir)/pleinair-$(u).service) \
	$(foreach n,Acquisition1 Jobs1,org.pleinair.$(n).conf:$(dbuspolicydir)/org.pleinair.$(n).conf \
		org.pleinair.$(n).service:$(dbusservicedir)/org.pleinair.$(n).service) \
	pleinair.sysusers:$(sysusersdir)/pleinair.conf pleinair.tmpfiles:$(tmpfilesdir)/pleinair.conf \
	pleinair.modules-load:$(modulesloaddir)/pleinair.conf pleinair.udev:$(udevrulesdir)/70-pleinair.rules \
	pleinair-kiosk.desktop:$(PREFIX)/share/applications/org.pleinair.Kiosk.desktop \
	kiosk-session:$(PREFIX)/lib/pleinair/kiosk-session kiosk-screen:$(PREFIX)/lib/pleinair/kiosk-screen
appliance_conf := weston.ini:$(sysconfdir)/pleinair/weston.ini pleinair.conf:$(sysconfdir)/pleinair.conf \
	pleinair-kiosk.pam:$(sysconfdir)/pam.d/pleinair-kiosk
