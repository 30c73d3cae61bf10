# pleinair: one non-recursive Makefile. The facts of each folder (libraries, programs) stand in its module.mk; this file is
# the machinery. `make demo` and `make check` do everything by themselves, `make help` lists the rest.
MAKEFLAGS += --no-builtin-rules
.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
BUILD ?= build
# Also as other projects spell it.
prefix ?= /usr/local
PREFIX ?= $(prefix)
CFLAGS ?= -O3 -g1
CXXFLAGS ?= $(CFLAGS)
SANITIZE ?=
# V=1 shows the commands.
q := $(if $(V),,@)
say = $(if $(V),,@echo '  $(1)  $@')
modules := sim firmware-io acquire process render render/kiosk

# Packages are needed before pkg-config can say anything, so `make deps` must work without them.
packages :=
buses :=
pkgs :=
cxx_pkgs :=
cxx_libs :=
cxx_flags :=
programs :=
pages :=
shared :=
include $(addsuffix /module.mk,$(modules)) systemd/module.mk tests/module.mk
PKG_CFLAGS := $(shell pkg-config --cflags $(pkgs) 2>/dev/null)
PKG_LIBS := $(shell pkg-config --libs $(pkgs) 2>/dev/null)
# The C++ libraries are named by the bridges alone (*_pcl.cpp, *_cv.cpp); their headers are not held to our warnings.
CXX_PKG_CFLAGS = $(shell pkg-config --cflags $(cxx_pkgs) 2>/dev/null | sed 's/-I/-isystem /g') $(cxx_flags)
CXX_PKG_LIBS := $(shell pkg-config --libs $(cxx_pkgs) 2>/dev/null)

house_cflags := -std=gnu17 -I. -I$(BUILD) -D_GNU_SOURCE -DG_LOG_DOMAIN='"pleinair"' -Wall -Wextra -Werror -Wno-missing-field-initializers \
	-Wshadow -Wstrict-prototypes -Wmissing-prototypes -fno-math-errno -fno-trapping-math -fopenmp -MMD -MP $(PKG_CFLAGS)
house_cxxflags = -std=c++17 -I. -D_GNU_SOURCE -DG_LOG_DOMAIN='"pleinair"' -Wall -Wextra -Werror -fopenmp -MMD -MP $(PKG_CFLAGS) \
	$(CXX_PKG_CFLAGS)
sanitize_flags := $(if $(SANITIZE),-fsanitize=$(SANITIZE) -fno-omit-frame-pointer -fno-sanitize-recover=all)
# Two hundred programs are linked, by lld in half the time; other linkers do too.
linker := $(if $(shell command -v ld.lld),-fuse-ld=lld)
link_libs := $(linker) $(PKG_LIBS) $(CXX_PKG_LIBS) $(cxx_libs) -lembree3 -lm -pthread -lstdc++

# Every .c and .cpp of a folder is in its library but for the programs' mains, which are listed in module.mk, and what measures
# (bench-*), which has one of its own: only pleinair-bench and tests need it.
sources = $(sort $(wildcard $(1)/*.c $(1)/*.cpp))
mains := $(foreach p,$(programs),$(p).c)
object_of = $(patsubst %,$(BUILD)/%.o,$(basename $(1)))
bench_sources := $(wildcard $(foreach m,$(modules),$(m)/bench-*.c $(m)/bench-*.cpp))
objects = $(call object_of,$(filter-out $(mains) $(bench_sources),$(call sources,$(1))))
lib_of = $(if $(call objects,$(1)),$(BUILD)/lib$(subst /,-,$(1)).a)
# A program links its own folder and what stands left of it; the simulator stands alone.
libs_of_sim := $(call lib_of,sim)
libs_of_firmware-io := $(call lib_of,firmware-io)
libs_of_acquire := $(call lib_of,acquire) $(libs_of_firmware-io)
libs_of_process := $(call lib_of,process) $(libs_of_acquire)
libs_of_render := $(call lib_of,render) $(libs_of_process)
libs_of_render/kiosk := $(call lib_of,render/kiosk) $(libs_of_render)
folder_of = $(patsubst %/,%,$(dir $(1)))
lib_of_bench := $(BUILD)/libbench.a
libs := $(lib_of_bench) $(libs_of_render) $(libs_of_sim)
bins := $(foreach p,$(programs),$(BUILD)/bin/$(notdir $(p)))
tests := $(patsubst tests/%.c,$(BUILD)/tests/%,$(sort $(wildcard tests/test-*.c)))
fuzzers := $(patsubst tests/%.c,$(BUILD)/tests/%,$(sort $(wildcard tests/fuzz-*.c)))
# Files that programs read: beside the programs here as where they are installed.
shared_files := $(patsubst render/%,$(BUILD)/share/pleinair/%,$(shared)) $(catalogues)

all: all-but-bench $(BUILD)/bin/pleinair-bench
all-but-bench: $(filter-out $(BUILD)/bin/pleinair-bench,$(bins)) $(shared_files)

$(BUILD)/share/pleinair/%: render/%
	$(call say,COPY)
	$(q)install -D -m 644 $< $@

$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	$(call say,CC)
	$(q)$(CC) $(house_cflags) $(CFLAGS) $(sanitize_flags) -c -o $@ $<

$(BUILD)/%.o: %.cpp
	@mkdir -p $(@D)
	$(call say,CXX)
	$(q)$(CXX) $(house_cxxflags) $(CXXFLAGS) $(sanitize_flags) -c -o $@ $<

# What is said on a bus stands in one XML a service; the code of both ends is generated: FOLDER/NAME-bus.h.
define bus
$(BUILD)/$(1)-bus.c: $(dir $(1))$(2).xml
	@mkdir -p $$(@D)
	$$(call say,BUS)
	$$(q)gdbus-codegen --interface-prefix org.pleinair. --c-namespace Bus --c-generate-autocleanup all \
		--output-directory $$(@D) --generate-c-code $(notdir $(1))-bus $$<
$(BUILD)/$(1)-bus.h: $(BUILD)/$(1)-bus.c
$(BUILD)/$(1)-bus.o: $(BUILD)/$(1)-bus.c
	$$(call say,CC)
	$$(q)$$(CC) $$(house_cflags) -Wno-unused-parameter $$(CFLAGS) $$(sanitize_flags) -c -o $$@ $$<
$(BUILD)/lib$(firstword $(subst /, ,$(1))).a: $(BUILD)/$(1)-bus.o
endef
$(foreach b,$(buses),$(eval $(call bus,$(word 1,$(subst :, ,$(b))),$(word 2,$(subst :, ,$(b))))))
# Headers that are made must be there before anything includes them.
$(patsubst %.c,$(BUILD)/%.o,$(wildcard acquire/*.c process/*.c render/*.c render/kiosk/*.c tests/*.c)): | \
	$(foreach b,$(buses),$(BUILD)/$(word 1,$(subst :, ,$(b)))-bus.h)

define library
$(call lib_of,$(1)): $(call objects,$(1))
	@rm -f $$@; $(AR) rcs $$@ $$^
endef
$(foreach m,$(modules),$(eval $(call library,$(m))))
$(lib_of_bench): $(call object_of,$(bench_sources))
	@rm -f $@; $(AR) rcs $@ $^

# What measures and what it measures by ask for each other.
in_any_order = -Wl,--start-group $(1) -Wl,--end-group -Wl,--as-needed
define program
$(BUILD)/bin/$(notdir $(1)): $(BUILD)/$(1).o $(libs_of_$(call folder_of,$(1)))
	@mkdir -p $$(@D)
	$$(call say,LD)
	$$(q)$$(CC) $$(CFLAGS) $$(sanitize_flags) -fopenmp -o $$@ $(call in_any_order,$$^) $$(link_libs) $(link_libs_of_$(call folder_of,$(1)))
endef
$(foreach p,$(programs),$(eval $(call program,$(p))))
$(BUILD)/bin/pleinair-bench: $(lib_of_bench)

$(BUILD)/tests/%: $(BUILD)/tests/%.o $(BUILD)/tests/support.o $(BUILD)/tests/simulated.o $(libs) | $(shared_files)
	$(call say,LD)
	$(q)$(CC) $(CFLAGS) $(sanitize_flags) -fopenmp -o $@ $(call in_any_order,$^) $(link_libs)
# What tests of the kiosk have besides: its widgets, a compositor with a touch screen, and fingers (kiosk-rig.h).
rig_objects := $(patsubst %.c,$(BUILD)/%.o,$(wildcard tests/kiosk-rig*.c))
$(BUILD)/tests/test-kiosk-%: $(BUILD)/tests/test-kiosk-%.o $(rig_objects) $(BUILD)/tests/support.o $(BUILD)/tests/simulated.o \
	$(libs_of_render/kiosk) $(libs_of_sim) | $(shared_files) $(touch_module) $(BUILD)/tests/rig-app
	$(call say,LD)
	$(q)$(CC) $(CFLAGS) $(sanitize_flags) -fopenmp -o $@ $(call in_any_order,$^) $(link_libs) $(link_libs_of_render/kiosk)
$(BUILD)/tests/rig-app: $(BUILD)/tests/rig-app.o $(libs_of_render/kiosk)
	$(call say,LD)
	$(q)$(CC) $(CFLAGS) $(sanitize_flags) -fopenmp -o $@ $(call in_any_order,$^) $(link_libs) $(link_libs_of_render/kiosk)
# A fuzz target is plain C with LLVMFuzzerTestOneInput; here it is linked to a driver that replays its corpus.
$(BUILD)/tests/fuzz-%: $(BUILD)/tests/fuzz-%.o $(BUILD)/tests/replay-corpus.o $(libs)
	$(call say,LD)
	$(q)$(CC) $(CFLAGS) $(sanitize_flags) -fopenmp -o $@ $(call in_any_order,$^) $(link_libs)
.SECONDARY:
-include $(shell find $(BUILD) -name '*.d' -type f 2>/dev/null)

include tests/targets.mk
