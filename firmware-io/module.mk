# Wires, stage, camera, and the record of what they said.
packages += libusb-1.0-0-dev libgpiod-dev libgudev-1.0-dev
pkgs += libusb-1.0 libgpiod gudev-1.0
# libgpiod has two APIs: 1 on Debian 12, 2 from 13 on.
gpiod_api := $(firstword $(subst ., ,$(shell pkg-config --modversion libgpiod 2>/dev/null)))
$(BUILD)/firmware-io/gpio-lines-%.o: house_cflags += -DGPIOD_API_VERSION=$(gpiod_api)
