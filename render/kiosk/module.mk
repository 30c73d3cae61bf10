# The touch screen: all that names GTK.
programs += render/kiosk/pleinair-kiosk
shared += render/kiosk/kiosk.css render/kiosk/light.css render/kiosk/dark.css
# dbus-daemon: for desks without a session bus, and for tests.
packages += libgtk-4-dev fonts-inter fonts-cantarell adwaita-icon-theme gettext
link_libs_of_render/kiosk := $(shell pkg-config --libs gtk4 2>/dev/null)
gtk_cflags := $(shell pkg-config --cflags gtk4 2>/dev/null | sed 's/-I/-isystem /g')
$(BUILD)/render/kiosk/%.o $(BUILD)/tests/test-kiosk-%.o $(BUILD)/tests/kiosk-%.o: house_cflags += $(gtk_cflags)

# Translations: `make pot` takes the texts of the sources over into po/*.po, msgfmt makes the catalogues that the kiosk reads in
# ../share/locale. Titles of styles are texts too.
languages := $(patsubst render/kiosk/po/%.po,%,$(wildcard render/kiosk/po/*.po))
catalogues := $(languages:%=$(BUILD)/share/locale/%/LC_MESSAGES/pleinair.mo)
$(BUILD)/share/locale/%/LC_MESSAGES/pleinair.mo: render/kiosk/po/%.po
	@mkdir -p $(@D)
	$(call say,MSGFMT)
	$(q)msgfmt --check -o $@ $<
$(BUILD)/render/kiosk/box.o: house_cflags += -DPLEINAIR_VERSION='"$(shell git describe --always --tags --dirty 2>/dev/null || echo unknown)"'
