# The simulated scanner: worlds, devices, faults. Knows the wire formats and nothing of the folders it feeds.
programs += sim/pleinair-sim
packages += libembree-dev
# Frames as cameras with MJPEG give them.
packages += libturbojpeg0-dev
pkgs += libturbojpeg
pkgs += glib-2.0 gio-2.0 gio-unix-2.0
