# The simulated scanner: worlds, devices, faults. Knows the wire formats and nothing of the folders it feeds.
programs += sim/pleinair-sim
packages += libembree-dev
pkgs += glib-2.0 gio-2.0 gio-unix-2.0
