# Styles, passes, pictures, kiosk; and the commands that need every folder.
programs += render/pleinair-bench render/pleinair-render render/pleinair-styles
# What programs find in ../share/pleinair.
shared += render/style.schema.json $(wildcard render/styles/*.json)
# Headers only: libEGL, libGLESv2 and libgbm are loaded where they are, when a program runs (gles-functions.h). The rest is an
# OpenGL ES in software, for the tests.
packages += libegl-dev libgles-dev libgbm-dev libegl1 libgles2 libgl1-mesa-dri
# Pages as vectors; films, which ffmpeg is run for.
packages += libcairo2-dev zlib1g-dev ffmpeg
pkgs += cairo cairo-pdf zlib
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
lane_flags_avx2 := -mavx2
lane_flags_avx512 := -march=x86-64-v4 -mavx512vbmi -mprefer-vector-width=256
define lane_path
$$(BUILD)/render/%-lanes.$(1).o: render/%-lanes.c
	@mkdir -p $$(@D)
	$$(call say,CC)
	$$(q)$$(CC) $$(house_cflags) -DLANES_BUILT_FOR=$(1) $$(lane_flags_$(1)) $$(CFLAGS) $$(sanitize_flags) -c -o $$@ $$<
$$(BUILD)/librender.a: $$(lane_sources:%.c=$$(BUILD)/%.$(1).o)
endef
$(foreach path,avx2 avx512,$(eval $(call lane_path,$(path))))
endif
