# Protocols, clocks, panoramas, sites; the commands that make and show scans.
programs += acquire/pleinair-acquired acquire/pleinair-doctor acquire/pleinair acquire/pleinair-scan acquire/pleinair-panoramas
packages += libglib2.0-dev libglib2.0-dev-bin dbus-daemon libjson-glib-dev libpng-dev libtiff-dev libturbojpeg0-dev zlib1g-dev
pkgs += json-glib-1.0 libpng libtiff-4 libturbojpeg gio-unix-2.0 zlib
buses += acquire/acquisition:org.pleinair.Acquisition1
