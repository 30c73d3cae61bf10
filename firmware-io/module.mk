# Wires, stage, camera, and the record of what they said.
packages += libusb-1.0-0-dev libgpiod-dev libgudev-1.0-dev
pkgs += libusb-1.0 libgpiod gudev-1.0
