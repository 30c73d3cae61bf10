# Styles, passes, pictures, kiosk; and the commands that need every folder.
programs += render/pleinair-bench render/pleinair-render render/pleinair-styles
# What programs find in ../share/pleinair.
shared += render/style.schema.json $(wildcard render/styles/*.json)
# Headers only: libEGL, libGLESv2 and libgbm are loaded where they are, when a program runs (gles-functions.h). The rest is an
# OpenGL ES in software, for the tests.
packages += libegl-dev libgles-dev libgbm-dev libegl1 libgles2 libgl1-mesa-dri
# Vectors as arguments of functions that are all inlined; and the same bytes with and without AVX2.
$(BUILD)/render/%.o: house_cflags += -Wno-psabi -ffp-contract=off
# Shaders are texts in the library.
shader_files := $(sort $(wildcard render/shaders/*.glsl))
$(BUILD)/render/shader-texts.c: render/shader-texts.awk $(shader_files)
	@mkdir -p $(@D)
	$(call say,AWK)
	$(q)awk -f $< $(shader_files) > $@
$(BUILD)/render/shader-texts.o: $(BUILD)/render/shader-texts.c
	$(call say,CC)
	$(q)$(CC) $(house_cflags) $(CFLAGS) $(sanitize_flags) -c -o $@ $<
$(BUILD)/librender.a: $(BUILD)/render/shader-texts.o
