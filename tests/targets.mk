# What people type: make demo, make check, and the rest that make help lists.

sources_all = $(shell git ls-files '*.c' '*.h' '*.cpp' 2>/dev/null || find $(modules) tests -name '*.[ch]')
demo_site ?= demo-site
gallery ?= gallery
# A whole build takes all cores, unless make was told how many.
side_by_side = $(if $(filter -j% --jobserver%,$(MAKEFLAGS)),,--jobs=$(shell nproc))

.PHONY: all all-but-bench help deps demo gallery real check check-house check-layers check-format check-translations check-docs pot check-tests check-sanitized check-asan check-ubsan \
	check-tsan fuzz bench format install clean tests

help:
	@sed -n 's/^#: //p' tests/targets.mk

#: make demo            set up, build, scan a simulated courtyard four times, register it, show panoramas and report
# All that it needs: the programs that measure are half as much to build again.
demo: deps
	$(MAKE) $(side_by_side) all-but-bench
	@sh tests/demo.sh $(BUILD)/bin $(demo_site)

#: make gallery         set up, build, draw what each parameter of hatching does: a contact sheet of each, on one page
gallery: deps
	$(MAKE) $(side_by_side) all
	@sh tests/gallery.sh $(BUILD)/bin $(demo_site) $(gallery)

#: make real            set up, build, import every scan in a folder, process and draw it: DATA=../shared/data, real=real
DATA ?= $(or $(PLEINAIR_SHARED),../shared)/data
real ?= real
real: deps
	$(MAKE) $(side_by_side) all
	@sh tests/real.sh $(BUILD)/bin "$(DATA)" "$(real)"

#: make check           set up, build, run all tests but the slowest, check layers, format and documents: ten minutes of two cores, once built
check: deps
	$(MAKE) $(side_by_side) all tests
	$(MAKE) check-house
	$(MAKE) check-units
	$(MAKE) run_tests='$(filter-out $(patient_tests),$(tests) $(fuzzers))' check-tests

#: make deps            install the Debian packages that building, running and testing need
deps:
	@sh tests/deps.sh $(packages)

check-house: check-layers check-format check-translations check-docs
check-layers:
	@sh tests/check-layers.sh
check-format:
	@clang-format --dry-run -Werror $(sources_all) && echo "format: as .clang-format says"

check-translations:
	@sh render/kiosk/po/texts.sh check
# Manual pages against the programs, where they are built; files that documents name.
check-docs:
	@sh tests/check-docs.sh $(BUILD)
#: make pot             take new texts of the touch screen over into render/kiosk/po/*.po, where they wait to be translated
pot:
	@sh render/kiosk/po/texts.sh update

tests: $(tests) $(fuzzers)

# Each program prints TAP; prove runs them side by side, each with a time limit, and sums up. The longest go first. What a failed one
# said comes again at the end.
long_tests := $(addprefix $(BUILD)/tests/,test-kiosk-workflow test-kiosk-hostile test-poster test-parity test-parity-styles test-calibrate test-process-kill test-scan-kill \
	test-commands-damage test-preset test-scan-faults)
run_tests ?= $(tests) $(fuzzers)
check-tests: all tests
	@rm -rf $(BUILD)/said
	prove --jobs $(shell nproc) --timer --exec 'sh tests/tap.sh $(BUILD)' $(filter $(run_tests),$(long_tests)) $(filter-out $(long_tests),$(run_tests)) || \
		{ sh tests/said.sh $(BUILD); exit 1; }

# Half a minute and more of two cores each: whole scans again and again, killed, damaged, calibrated. They are of make check-slow, which
# runs wherever main changes (.ci/run).
patient_tests := $(addprefix $(BUILD)/tests/,test-scan-kill test-scan-faults test-calibrate test-export test-align-command \
	test-commands-damage test-preset test-process-kill test-kiosk-hostile test-kiosk-workflow test-parity test-parity-styles test-scan test-poster)

# Instrumented, these take a minute and more of two cores each.
slow_tests := $(addprefix $(BUILD)/tests/,test-cloud-align test-align-command test-scan-faults test-align-scans \
	test-register-site test-commands-damage test-world test-preset test-segmentation-truth)
# Fingers wait for pictures: instrumented ones come too late for taps that are meant to be double.
screen_tests := $(BUILD)/tests/test-kiosk-plans $(BUILD)/tests/test-kiosk-keys $(BUILD)/tests/test-kiosk-sites $(BUILD)/tests/test-kiosk-bring $(BUILD)/tests/test-kiosk-workflow $(BUILD)/tests/test-kiosk-hostile $(BUILD)/tests/test-kiosk-rig $(BUILD)/tests/test-kiosk-speed $(BUILD)/tests/test-kiosk-safety
asan := BUILD=build-asan SANITIZE=address,undefined CFLAGS='-O2 -g1'
check-sanitized:
	$(MAKE) $(side_by_side) $(asan) all tests
	$(MAKE) $(asan) check-asan-quick
.PHONY: check-asan-quick check-asan-slow check-slow check-patient
check-asan-quick check-asan-slow: all tests
check-asan-quick:
	$(MAKE) run_tests='$(filter-out $(slow_tests) $(screen_tests),$(tests) $(fuzzers))' check-tests
check-asan-slow:
	$(MAKE) run_tests='$(slow_tests)' check-tests
#: make check-slow      what make check leaves out: the slowest tests, all of them under ASan and UBSan, real scans, a kernel in QEMU
check-slow: check-patient check-truth check-kernel
	$(MAKE) check-sanitized
	$(MAKE) $(asan) check-asan-slow
check-patient: all tests
	$(MAKE) run_tests='$(patient_tests)' check-tests
#: make check-truth     segments of simulated sites at the standard preset against the truth, and all real scans drawn, which check-slow does too
.PHONY: check-truth
check-truth: all $(BUILD)/tests/test-segmentation-truth $(BUILD)/tests/test-real
	PLEINAIR_SLOW=1 sh tests/tap.sh $(BUILD) $(BUILD)/tests/test-segmentation-truth
	PLEINAIR_SLOW=1 sh tests/tap.sh $(BUILD) $(BUILD)/tests/test-real
#: make check-units     what makes a machine an appliance, as systemd's and the bus's own tools see it; make check does this too
check-units: all
	@sh tests/check-units.sh $(BUILD)
#: make check-kernel    on Debian's kernel in QEMU, six to eight minutes: scans through its drivers with faults, a power cut, daemons and touch screen under systemd. check-slow does too
check-kernel: all
	@sh tests/deps.sh $(kernel_packages) || true
	$(MAKE) $(kernel_programs)
	prove --jobs 4 --timer --failures --exec sh $(addprefix tests/kernel/,scan.sh faults.sh run.sh screen.sh cuts.sh) :: $(BUILD)
.PHONY: check-units check-kernel
#: make check-asan      all tests under AddressSanitizer and UndefinedBehaviorSanitizer together
check-asan:
	$(MAKE) $(asan) check-tests
#: make check-ubsan     all tests under UndefinedBehaviorSanitizer alone
check-ubsan:
	$(MAKE) BUILD=build-ubsan SANITIZE=undefined CFLAGS='-O1 -g' check-tests
#: make check-tsan      tests of what has threads under ThreadSanitizer
# By clang, whose OpenMP runtime tells TSan (through its tool Archer) what waits for what; libraries of others do not.
check-tsan:
	$(MAKE) BUILD=build-tsan SANITIZE=thread CFLAGS='-O1 -g' CC=clang CXX=clang++ tests-tsan
.PHONY: tests-tsan
tests-tsan: $(addprefix $(BUILD)/tests/test-,record record-faults voxels single-trees features-cloud scan-features segments-anew)
	OMP_NUM_THREADS=3 TSAN_OPTIONS=ignore_noninstrumented_modules=1 prove --timer --exec 'sh tests/tap.sh $(BUILD)' $^

#: make fuzz            run every fuzz target for a minute (FUZZ_SECONDS=60)
FUZZ_SECONDS ?= 60
fuzz: $(foreach b,$(buses),$(BUILD)/$(word 1,$(subst :, ,$(b)))-bus.h)
	@sh tests/fuzz.sh $(FUZZ_SECONDS) '-I$(BUILD) -DGPIOD_API_VERSION=$(gpiod_api) $(PKG_CFLAGS)' '$(CXX_PKG_CFLAGS)' '$(link_libs)' $(sort $(wildcard tests/fuzz-*.c))

#: make bench           measure speed, memory and truth, beside programs of others: build/bench/bench.html; some 20 minutes
# Their packages are asked for here alone: 33 MB to fetch, 125 MB on the disk, nearly all of that Open3D's. Without them it measures the rest.
bench: all
	@sh tests/deps.sh python3-open3d python3-vtk9 xvfb cloudcompare || true
	$(BUILD)/bin/pleinair bench --output $(BUILD)/bench

#: make format          lay out all sources as .clang-format says
format:
	clang-format -i $(sources_all)

#: make install         programs, manual and what makes a machine an appliance: PREFIX=/usr/local, DESTDIR=
install: all
	install -d $(addprefix $(DESTDIR)$(PREFIX)/,bin share/man/man1 share/man/man5)
	install $(bins) $(DESTDIR)$(PREFIX)/bin
	install -m 644 $(wildcard */*.1 */*/*.1) $(DESTDIR)$(PREFIX)/share/man/man1
	install -m 644 $(wildcard */*.5) $(DESTDIR)$(PREFIX)/share/man/man5
	@for f in $(patsubst render/%,%,$(shared)); do install -D -m 644 render/$$f $(DESTDIR)$(PREFIX)/share/pleinair/$$f || exit 1; done
	@for l in $(languages); do install -D -m 644 $(BUILD)/share/locale/$$l/LC_MESSAGES/pleinair.mo \
		$(DESTDIR)$(PREFIX)/share/locale/$$l/LC_MESSAGES/pleinair.mo || exit 1; done
	@sh systemd/install.sh '$(DESTDIR)' '$(PREFIX)' '$(sysconfdir)' $(appliance) $(appliance_conf)

#: make clean           remove what was built
clean:
	rm -rf build build-asan build-ubsan build-tsan build-fuzz
