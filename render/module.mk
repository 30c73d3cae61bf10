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
# What is done for eight at a time, built for each kind of processor (lanes-path.h); none of them may join a product and a sum.
lane_sources := $(wildcard render/*-lanes.c)
$(lane_sources:%.c=$(BUILD)/%.o): house_cflags += -DLANES_BUILT_FOR=portable
ifneq ($(findstring x86_64,$(shell $(CC) -dumpmachine)),)
$(BUILD)/render/%-lanes.avx2.o: house_cflags += -DLANES_BUILT_FOR=avx2 -mavx2
$(BUILD)/render/%-lanes.avx512.o: house_cflags += -DLANES_BUILT_FOR=avx512 -march=x86-64-v4 -mprefer-vector-width=256
$(BUILD)/render/%.avx2.o $(BUILD)/render/%.avx512.o: render/%.c
	@mkdir -p $(@D)
	$(call say,CC)
	$(q)$(CC) $(house_cflags) $(CFLAGS) $(sanitize_flags) -c -o $@ $<
$(BUILD)/librender.a: $(lane_sources:%.c=$(BUILD)/%.avx2.o) $(lane_sources:%.c=$(BUILD)/%.avx512.o)
endif
