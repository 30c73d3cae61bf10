# Protocols, clocks, panoramas, sites; the commands that make and show scans.
programs += acquire/pleinair acquire/pleinair-scan acquire/pleinair-panoramas
packages += libglib2.0-dev libjson-glib-dev libpng-dev libtiff-dev
pkgs += json-glib-1.0 libpng libtiff-4
