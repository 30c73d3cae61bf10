# Building and testing.
packages += gcc make pkg-config libc6-dev git perl clang clang-format libclang-rt-14-dev libomp-14-dev
# An EGL whose driver fails as told, which only test-gles loads; never instrumented.
$(BUILD)/tests/fake-egl/libEGL.so.1: tests/fake-egl.c
	@mkdir -p $(@D)
	$(call say,CC)
	$(q)$(CC) -std=gnu17 -D_GNU_SOURCE -O1 -Wall -Wextra -Werror -shared -fPIC -Wl,-soname,libEGL.so.1 -o $@ $<
$(BUILD)/tests/test-gles: | $(BUILD)/tests/fake-egl/libEGL.so.1
