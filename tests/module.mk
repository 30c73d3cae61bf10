# Building and testing.
packages += gcc lld make pkg-config libc6-dev git perl clang clang-format libclang-rt-14-dev libomp-14-dev
# An EGL whose driver fails as told, which only test-gles loads; never instrumented.
$(BUILD)/tests/fake-egl/libEGL.so.1: tests/fake-egl.c
	@mkdir -p $(@D)
	$(call say,CC)
	$(q)$(CC) -std=gnu17 -D_GNU_SOURCE -O1 -Wall -Wextra -Werror -shared -fPIC -Wl,-soname,libEGL.so.1 -o $@ $<
$(BUILD)/tests/test-gles: | $(BUILD)/tests/fake-egl/libEGL.so.1
# Programs of others that read what is exported; tests skip without.
packages += pcl-tools cloudcompare
# The kiosk is tested under weston without a screen, which also is what shows it on one.
packages += weston libweston-10-dev libwayland-dev
$(BUILD)/tests/test-kiosk-%.o $(BUILD)/tests/rig-app.o: house_cflags += $(gtk_cflags)
# A touch screen for weston; never instrumented, since weston is not.
ifneq ($(shell pkg-config --exists libweston-10 weston && echo found),)
touch_module := $(BUILD)/tests/weston-touch.so
$(touch_module): tests/weston-touch.c
	@mkdir -p $(@D)
	$(call say,CC)
	$(q)$(CC) -std=gnu17 -D_GNU_SOURCE -O1 -g -Wall -Wextra -Werror -shared -fPIC \
		$(shell pkg-config --cflags libweston-10 weston libpng | sed 's/-I/-isystem /g') -o $@ $< $(shell pkg-config --libs libpng)
endif
# What stands in the guest of make check-kernel where wires would be, and simple programs that ask devices there.
kernel_programs := $(addprefix $(BUILD)/tests/kernel/,agent usb-probe pulse compare-scans check-site camera-faults fingers)
$(BUILD)/tests/kernel/agent: $(patsubst %.c,$(BUILD)/%.o,$(wildcard tests/kernel/agent*.c)) $(BUILD)/libsim.a
	$(call say,LD)
	$(q)$(CC) $(CFLAGS) $(sanitize_flags) -fopenmp -o $@ $^ -Wl,--as-needed $(link_libs)
$(BUILD)/tests/kernel/usb-probe: $(BUILD)/tests/kernel/usb-probe.o
	$(call say,LD)
	$(q)$(CC) $(CFLAGS) $(sanitize_flags) -o $@ $^ -lusb-1.0 $(shell pkg-config --libs glib-2.0)
$(BUILD)/tests/kernel/fingers: $(BUILD)/tests/kernel/fingers.o
	$(call say,LD)
	$(q)$(CC) $(CFLAGS) $(sanitize_flags) -o $@ $^ -lm
$(BUILD)/tests/kernel/pulse: $(BUILD)/tests/kernel/pulse.o
	$(call say,LD)
	$(q)$(CC) $(CFLAGS) $(sanitize_flags) -o $@ $^ -lgpiod
$(addprefix $(BUILD)/tests/kernel/,compare-scans check-site camera-faults): $(BUILD)/tests/kernel/%: $(BUILD)/tests/kernel/%.o $(BUILD)/libacquire.a $(BUILD)/libfirmware-io.a
	$(call say,LD)
	$(q)$(CC) $(CFLAGS) $(sanitize_flags) -fopenmp -o $@ $^ -Wl,--as-needed $(link_libs)
# The lines by libgpiod's second API are compiled also where only the first is installed.
tests: $(BUILD)/tests/gpio-lines-2.o
$(BUILD)/tests/gpio-lines-2.o: firmware-io/gpio-lines-2.c firmware-io/gpio-lines.h tests/gpiod-2/gpiod.h
	@mkdir -p $(@D)
	$(call say,CC)
	$(q)$(CC) -std=gnu17 -D_GNU_SOURCE -O1 -Wall -Wextra -Werror -DGPIOD_API_VERSION=2 -Itests/gpiod-2 -I. \
		$(shell pkg-config --cflags glib-2.0 | sed 's/-I/-isystem /g') -c -o $@ $<
