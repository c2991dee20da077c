# SPDX-License-Identifier: GPL-3.0-or-later
# ehdrom: two commands on a fresh Debian 12 or 13 are enough, `make demo` and `make check`.
# They install missing packages; on a terminal they ask first. `make help` lists targets and settings.

# The version is set only here. `make version` copies it to the header, the Python package and the citation.
VERSION := 0.3.0

# ---- Settings (make NAME=value)

VARIANT ?= release
DEPS    ?= yes
JOBS    ?= 2
PREFIX  ?= /usr/local
DESTDIR ?=
V       ?= 0

ifeq ($(origin CC),default)
  CC := gcc
endif

# The instruction set is fixed, and -ffast-math is never used. The compiler is asked for its machine only once, at the
# first use of MARCH in a recipe, because `deps` may have to install the compiler before.
MARCH ?= $(eval MARCH := $$(if $$(filter x86_64%,$$(shell $(CC) -dumpmachine)),x86-64-v3))$(MARCH)

CFLAGS_release := -O3 -g
CFLAGS_debug   := -O0 -g3
CFLAGS_san     := -O1 -g -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover
CFLAGS_tsan    := -O1 -g -fno-omit-frame-pointer -fsanitize=thread
CFLAGS_fuzz    := -O2 -g -fno-omit-frame-pointer -fsanitize=address,undefined,float-cast-overflow,fuzzer-no-link \
                  -fno-sanitize-coverage=trace-cmp -fno-sanitize-recover=all
CFLAGS_cov     := -O1 -g --coverage -fprofile-update=atomic
CFLAGS         ?= $(CFLAGS_$(VARIANT))

ifeq ($(filter $(VARIANT),release debug san tsan fuzz cov),)
  $(error VARIANT: found "$(VARIANT)", expected release, debug, san, tsan or cov)
endif

BUILD := build/$(VARIANT)
BIN   := $(BUILD)/bin
LIB   := $(BUILD)/libprograms.a

ifeq ($(V),0)
  quiet = @echo '  $1 $2';
endif
.DELETE_ON_ERROR:
MAKEFLAGS += --no-builtin-rules --no-print-directory

# ---- Sources: a program is built if its folder has a main.c

PROGRAM_FOLDERS := fullrun snapgen podbuild deimselect romrun
MAINS           := $(wildcard $(PROGRAM_FOLDERS:%=%/main.c))
FMU_ONLY        := romrun/fmu/processor.c romrun/fmu/no_hdf5.c
HDF5_APART      := romrun/library/hdf5_calls.c romrun/library/hdf5_load.c romrun/library/hdf5_plugin.c
LIB_SOURCES     := $(sort $(filter-out $(MAINS) $(FMU_ONLY) $(HDF5_APART),$(wildcard common/*/*.c $(PROGRAM_FOLDERS:%=%/*.c) $(PROGRAM_FOLDERS:%=%/*/*.c))))
UNIT_SOURCES    := $(sort $(wildcard tests/unit/*.c))
BENCH_SOURCES   := $(sort $(wildcard tests/bench/*.c))
FUZZ_SOURCES    := $(sort $(wildcard tests/fuzz/*.c))
HEADERS         := $(sort $(wildcard */*.h */*/*.h))
FAULT_SOURCES   := $(sort $(wildcard tests/fault/*.c))
SOURCES         := $(MAINS) $(LIB_SOURCES) $(FMU_ONLY) $(HDF5_APART) $(UNIT_SOURCES) $(BENCH_SOURCES) $(FUZZ_SOURCES)

LIB_OBJECTS := $(LIB_SOURCES:%.c=$(BUILD)/%.o)

# The library for other programs: position-independent objects of the folders that the library may use.
LIBRARY_SOURCES := $(filter-out common/program/openblas.c common/program/processor_check.c,$(filter common/% romrun/model/% romrun/state/% romrun/solve/% romrun/trust/% romrun/online/% romrun/library/%,$(LIB_SOURCES)))
LIBRARY_OBJECTS := $(LIBRARY_SOURCES:%.c=$(BUILD)/pic/%.o)
# The shared library contains no HDF5. To read a model.h5 it loads a second shared library, which does
# (romrun/library/hdf5_calls.h).
WITHOUT_HDF5    := $(filter-out common/artefact/%,$(LIBRARY_SOURCES)) common/artefact/schemas.c romrun/library/hdf5_calls.c
SHARED_OBJECTS  := $(patsubst %.c,$(BUILD)/pic/%.o,$(WITHOUT_HDF5) romrun/library/hdf5_load.c)
PLUGIN_OBJECTS  := $(patsubst %.c,$(BUILD)/pic/%.o,$(filter common/program/% common/artefact/%,$(LIBRARY_SOURCES)) \
                   romrun/library/hdf5_plugin.c)
LIBRARY_EXPORTS := romrun/library/ehdrom.map
SONAME          := libehdrom.so.0
SHARED_LIBRARY  := $(BUILD)/lib/libehdrom.so.$(VERSION)
PLUGIN          := $(BUILD)/lib/libehdrom-hdf5.so.0
STATIC_LIBRARY  := $(BUILD)/lib/libehdrom.a
HEADER          := $(BUILD)/include/ehdrom.h
PC_FILE         := $(BUILD)/lib/pkgconfig/ehdrom.pc
LIBRARY_LINKS   := $(BUILD)/lib/$(SONAME) $(BUILD)/lib/libehdrom.so
# These files have the same relative paths in the build folder and below PREFIX, so scenes find them in both places.
LIBRARY         := $(HEADER) $(SHARED_LIBRARY) $(LIBRARY_LINKS) $(PLUGIN) $(STATIC_LIBRARY) $(PC_FILE)
# The shared object that romrun puts into FMUs. It has the same flags in all variants. It is built only on x86-64, since
# its folder in an FMU has the name that the FMI standard defines for x86-64.
FMU         := build/fmu
FMU_SOURCES := romrun/fmu/processor.c romrun/fmu/fmi2.c romrun/fmu/fmi3.c romrun/fmu/instance.c romrun/fmu/variables.c
# The library in an FMU contains no HDF5, since the model in an FMU is a flat file.
FMU_LIBRARY := $(WITHOUT_HDF5) romrun/fmu/no_hdf5.c
FMU_CORES   := $(FMU)/any.o $(FMU)/v3.o
USE_FMU     := $(if $(filter x86_64,$(shell uname -m)),$(FMU)/use_fmu)
FMU_FILES   := $(if $(filter x86_64,$(shell uname -m)),$(BUILD)/lib/ehdrom/fmu.so $(BUILD)/lib/ehdrom/licenses)

# Other variants make no library: a program that links it would also need the runtime of the sanitizers or counts.
ifeq ($(filter release debug,$(VARIANT)),)
  LIBRARY :=
endif
PROGRAMS    := $(MAINS:%/main.c=$(BIN)/%)

TESTS        := $(patsubst tests/unit/%.c,$(BUILD)/unit/%,$(filter tests/unit/test_%,$(UNIT_SOURCES)))
LONG_TESTS   := $(patsubst tests/unit/%.c,$(BUILD)/unit/%,$(filter tests/unit/long_%,$(UNIT_SOURCES)))
UNIT_SHARED  := $(patsubst %.c,$(BUILD)/%.o,$(filter-out tests/unit/test_% tests/unit/long_%,$(UNIT_SOURCES)))
USE_LIBRARY  := $(BUILD)/unit/use_library
ON_LIBRARY   := $(BUILD)/bench/bench_many
BENCHES      := $(patsubst tests/bench/%.c,$(BUILD)/bench/%,$(filter tests/bench/bench_%,$(BENCH_SOURCES)))
BENCH_SHARED := $(patsubst %.c,$(BUILD)/%.o,$(filter-out tests/bench/bench_%,$(BENCH_SOURCES)))
# code that all fuzzers share: the programs, each with its `main` renamed, and the functions that make files for them
FUZZ_SHARED  := $(BUILD)/tests/fuzz/target.o $(BUILD)/tests/fuzz/edit.o $(BUILD)/tests/fuzz/flat_edit.o $(MAINS:%/main.c=$(BUILD)/fuzz/%-main.o)
REPLAY       := $(BUILD)/fuzz/replay
FLIP         := $(BUILD)/fuzz/flip
USE_LIBRARY  := $(BUILD)/unit/use_library
FUZZER       := $(BUILD)/fuzz/libfuzzer
FAULT_TOOLS  := $(BUILD)/fault/inject.so $(BUILD)/fault/sweep
PIPELINES    := $(sort $(filter-out tests/pipeline/long_%,$(wildcard tests/pipeline/*.bats)) tests/fault/fault.bats)
LONG_PIPELINES := $(sort $(wildcard tests/pipeline/long_*.bats tests/fault/long_*.bats))

# With the thread sanitizer only tests with threads run: unit tests that start threads, and pipeline tests of --jobs and
# of threads in the programs and in the library. OpenBLAS's own threads are not checked: the programs use OpenBLAS with
# one thread, and only test_threads starts more.
ifeq ($(VARIANT),tsan)
  TESTS     := $(patsubst tests/unit/%.c,$(BUILD)/unit/%,$(shell grep -lE 'pthread_create|pool_run|team_create' tests/unit/test_*.c))
  FILTER    := [-]-jobs|order.of.threads|threads.share
  PIPELINES := $(shell grep -lE '@test.*($(FILTER))' $(PIPELINES))
endif

STUDIES      := $(patsubst %/Makefile,%,$(wildcard scenes/studies/*/Makefile))
EXAMPLES     := $(patsubst %/Makefile,%,$(wildcard scenes/examples/*/Makefile))

# ---- Flags

# OpenBLAS comes first, so that all other libraries use its BLAS, CBLAS and LAPACK; it also replaces gslcblas. The
# package has to be the variant with pthreads, although no threads are started (common/program/openblas.c).
MODULES := openblas lapacke gsl fftw3 hdf5-serial yaml-0.1 nettle

# pkg-config is asked only once, at the first use in a recipe, because `deps` may have to install it and the libraries
# before (like MARCH above).
PKG_CFLAGS = $(eval PKG_CFLAGS := $$(patsubst -I%,-isystem %,$$(shell pkg-config --cflags $(MODULES))))$(PKG_CFLAGS)
PKG_LIBS   = $(eval PKG_LIBS := $$(filter-out -lgslcblas,$$(shell pkg-config --libs $(MODULES))))$(PKG_LIBS)
, := ,

# The library calls neither BLAS nor LAPACK (common/algebra/product.h).
LIBRARY_MODULES := $(filter-out openblas lapacke,$(MODULES))
# A static link needs hdf5_hl before hdf5.
LIBRARY_LIBS     = $(eval LIBRARY_LIBS := -lhdf5_serial_hl \
                   $$(filter-out -lgslcblas,$$(shell pkg-config --libs $(LIBRARY_MODULES))) -lm)$(LIBRARY_LIBS)
PLUGIN_LIBS      = $(eval PLUGIN_LIBS := $$(shell pkg-config --libs hdf5-serial nettle) -lhdf5_serial_hl -lm)$(PLUGIN_LIBS)

WARNINGS     := -Wall -Wextra -Wpedantic -Wshadow -Wconversion
# The unversioned names of HDF5 mean different functions and types in each release. H5_USE_110_API selects release 1.10.
ALL_CPPFLAGS  = -I. -D_GNU_SOURCE -DH5_USE_110_API $(CPPFLAGS) $(PKG_CFLAGS) -isystem /usr/include/suitesparse
ALL_CFLAGS    = -std=c17 -pthread $(WARNINGS) $(MARCH:%=-march=%) $(CFLAGS)
ALL_LDFLAGS   = -pthread -Wl,--as-needed $(CFLAGS) $(LDFLAGS)
ALL_LIBS      = $(PKG_LIBS) -lumfpack -lhdf5_hl -lminizip -lm $(LDLIBS)
# HDF5 is linked statically. A shared HDF5 loads 30 other libraries, and a program then takes 33 ms to start instead of
# 17 (perf stat -r 20 romrun --version). The static HDF5 of Debian 13 needs curl, that of Debian 12 does not. The
# functions of HDF5 stay visible, so that tests/fault can replace them.
STATIC_HDF5   = -Wl,-Bstatic -lhdf5_hl -lhdf5 -Wl,-Bdynamic -Wl,--export-dynamic-symbol='H5*' -lsz -laec -lz -lcurl -lcrypto -ldl
PROGRAM_LIBS  = $(patsubst -lhdf5,$(STATIC_HDF5),$(filter-out -lhdf5_hl,$(ALL_LIBS)))

# The revision is shown by --version and stored in every result.
REVISION := $(or $(shell GIT_OPTIONAL_LOCKS=0 git -c safe.directory="*" describe --always --dirty 2>/dev/null | \
            tr -cd 'A-Za-z0-9._+-'),unknown)
BUILD_INFO = -DEHD_VERSION='"$(VERSION)"' -DEHD_REVISION='"$(REVISION)"' \
             -DEHD_FLAGS='"$(strip $(MARCH:%=-march=%) $(CFLAGS))"'

# A stamp file is rewritten only if its text changes. Files that depend on the stamp are then rebuilt.
$(BUILD)/flags:    TEXT = $(CC) $(ALL_CPPFLAGS) $(ALL_CFLAGS) $(ALL_LDFLAGS) $(ALL_LIBS) $(STATIC_HDF5)
$(BUILD)/objects:  TEXT = $(LIB_OBJECTS)
$(BUILD)/revision: TEXT = $(VERSION) $(REVISION)
$(BUILD)/flags $(BUILD)/objects $(BUILD)/revision: FORCE | deps
	@mkdir -p $(@D)
	@echo '$(TEXT)' | cmp -s - $@ || echo '$(TEXT)' > $@
FORCE:

# ---- Targets for people

all: $(PROGRAMS) $(LIBRARY) $(FMU_FILES) ## build all programs and the library (the default)
.DEFAULT_GOAL := all

demo: $(PROGRAMS) ## run the stationary line contact from training to comparison
	@$(MAKE) -C scenes/studies/stationary-line demo BIN=../../../$(BIN)

demo-point: $(PROGRAMS) ## the same with a stationary point contact
	@$(MAKE) -C scenes/studies/point-stationary demo BIN=../../../$(BIN)

# The pipeline tests run the programs, so `check` builds them too.
TEST_PROGRAMS := $(PROGRAMS) $(LIBRARY) $(USE_LIBRARY) $(FMU_FILES) $(USE_FMU) $(TESTS) $(FAULT_TOOLS) $(REPLAY) $(FLIP)
check: $(TEST_PROGRAMS) ## unit and pipeline tests, minutes; last line: N passed, N failed
	@$(run_tests) $(PIPELINES) $(TESTS)

check-all: export CHECK_ALL = yes
check-all: $(TEST_PROGRAMS) ## check, and the slow tests: examples, studies, kills, all cases
	@$(run_tests) $(PIPELINES) $(TESTS)

check-slow: export CHECK_ALL = slow
check-slow: $(TEST_PROGRAMS) ## what check leaves out of check-all
	@$(run_tests) $(shell grep -l 'test_tags=slow' $(PIPELINES)) \
	    $(patsubst tests/unit/%.c,$(BUILD)/unit/%,$(shell grep -l 'check_all()' $(TESTS:$(BUILD)/unit/%=tests/unit/%.c)))

check-release: export CHECK_ALL = yes
check-release: export TIMEOUT ?= 7200
check-release: $(TEST_PROGRAMS) $(LONG_TESTS) ## check-all and tests that take hours; as root also in bare Debian 12 and 13
	@$(run_tests) $(PIPELINES) $(TESTS) $(LONG_TESTS) $(LONG_PIPELINES)
	@if [ "$$(id -u)" = 0 ] && command -v debootstrap >/dev/null; then \
	    for suite in bookworm trixie; do tests/debian.sh $$suite demo check || exit; done; \
	else echo 'bare systems: not tested, which needs root and debootstrap'; fi

# check-slurm is not part of check, since it installs Slurm.
check-slurm: $(PROGRAMS) | slurm-deps ## training as jobs of a Slurm that is started for it, on this machine alone
	@tests/slurm/with-slurm.sh $(MAKE) run-slurm-tests

run-slurm-tests:
	@$(run_tests) tests/slurm/slurm.bats

run_tests = BIN="$$PWD"/$(BIN) VARIANT=$(VARIANT) JOBS=$(JOBS) V=$(V) $(FILTER:%=FILTER='%') tests/run.sh $(BUILD)/test-logs

FUZZ_TARGETS ?= $(shell sed -n 's/^ *{.name = "\([a-z-]*\)".*/\1/p' tests/fuzz/target.c)
FUZZ_SECONDS ?= 60

# The programs make the valid files from which the fuzz targets start.
fuzz: $(PROGRAMS) | fuzz-deps ## fuzz FUZZ_TARGETS (all) for FUZZ_SECONDS (60) each, with clang's libFuzzer
	@$(MAKE) VARIANT=fuzz CC=clang DEPS=no build/fuzz/fuzz/libfuzzer
	@for target in $(FUZZ_TARGETS); do \
	    BIN="$$PWD"/$(BIN) tests/fuzz/fuzz.sh build/fuzz/fuzz/libfuzzer $$target $(FUZZ_SECONDS) || failed=1; \
	done; [ -z "$$failed" ]

fuzz-coverage: $(PROGRAMS) | deps coverage-deps ## what each fuzz target reaches with corpus and findings: lines of the rooms, in per cent
	@$(MAKE) VARIANT=cov build/cov/fuzz/replay
	@for target in $(FUZZ_TARGETS); do BIN="$$PWD"/$(BIN) tests/fuzz/coverage.sh $$target || exit; done

# The counts of an earlier run are deleted first.
coverage: | deps coverage-deps ## lines and branches that `make check-all` runs, a folder; files below 90 % of lines
	@mkdir -p build/cov && find build/cov -name '*.gcda' -delete
	@$(MAKE) check-all VARIANT=cov; code=$$?; \
	gcovr --root . --object-directory build/cov $(addprefix --filter ,common/ $(PROGRAM_FOLDERS:%=%/)) \
	    --csv > build/cov/coverage.csv && \
	awk -F, -f tests/coverage.awk build/cov/coverage.csv && exit $$code

bench: $(PROGRAMS) $(BENCHES) ## measure speed
	@BIN="$$PWD"/$(BIN) BENCH="$$PWD"/$(BUILD)/bench tests/bench/run.sh

costs: $(PROGRAMS) $(ON_LIBRARY) $(USE_FMU) ## what each term of a scene, and a step through library and FMU, costs, by instructions and heap
	@BIN="$$PWD"/$(BIN) BENCH="$$PWD"/$(BUILD)/bench USE_FMU="$$PWD"/$(USE_FMU) tests/bench/costs.sh

figures: $(PROGRAMS) ## run all studies and draw their figures
	@for study in $(STUDIES); do \
	    $(MAKE) -C $$study figures BIN=../../../$(BIN) || exit; \
	done

examples: $(PROGRAMS) ## run all examples
	@for example in $(EXAMPLES); do \
	    $(MAKE) -C $$example BIN=../../../$(BIN) || exit; \
	done

trade: $(PROGRAMS) ## deviation against time of models, full solutions and film formulas, minutes
	@for scene in $(patsubst %/Makefile,%,$(shell grep -l check-plan.yml scenes/studies/*/Makefile)); do \
	    $(MAKE) -C $$scene trade BIN=../../../$(BIN) || exit; \
	done

# The modes are the words in the first column of the table `modes` in romrun/main.c.
MODE_PAGES := $(patsubst %,$(BUILD)/man/romrun-%.1,$(shell sed -n 's/^    {"\([a-z]*\)", "\1 .*/\1/p' /dev/null $(wildcard romrun/main.c)))
MAN_PAGES  := $(PROGRAMS:$(BIN)/%=$(BUILD)/man/%.1) $(MODE_PAGES)
man: $(MAN_PAGES) ## man pages from --help, one for each mode of romrun
$(BUILD)/man/romrun-%.1: $(BIN)/romrun
	$(call quiet,MAN ,$@)mkdir -p $(@D) && help2man --no-info --help-option='$* --help' \
	    --name='$* mode of the reduced model' --output=$@ $<
$(BUILD)/man/%.1: $(BIN)/%
	$(call quiet,MAN ,$@)mkdir -p $(@D) && help2man --no-info --output=$@ $<

PYTHON_PACKAGE := $(BUILD)/python/ehdrom
python: $(LIBRARY) ## the Python package, with its library: PYTHONPATH=build/release/python
	@mkdir -p $(PYTHON_PACKAGE) && cp -uL romrun/python/ehdrom/*.* $(SHARED_LIBRARY) $(PLUGIN) $(PYTHON_PACKAGE)
	@ln -sf $(notdir $(SHARED_LIBRARY)) $(PYTHON_PACKAGE)/$(SONAME)
	@echo "PYTHONPATH=$$PWD/$(BUILD)/python"

# Everything is installed below PREFIX. The shared library gets two links: libehdrom.so.0, which programs load, and
# libehdrom.so, with which they are linked.
quoted = '$(subst ','\'',$1)'
to     = $(call quoted,$(DESTDIR)$(PREFIX))
install: all man ## into DESTDIR, PREFIX: programs, man pages, library, examples
	install -d $(to)/bin $(to)/share/man/man1
	$(if $(PROGRAMS),install $(PROGRAMS) $(to)/bin)
	$(if $(MAN_PAGES),install -m 644 $(MAN_PAGES) $(to)/share/man/man1)
	@for file in $(filter-out $(LIBRARY_LINKS),$(LIBRARY:$(BUILD)/%=%)); do \
	    install -D -m 644 $(BUILD)/$$file $(to)/$$file || exit; \
	done
	cp -P $(LIBRARY_LINKS) $(to)/lib
	@$(if $(FMU_FILES),find $(BUILD)/lib/ehdrom -type f -printf 'lib/ehdrom/%P\n' | while read -r file; do \
	    install -D -m 644 $(BUILD)/$$file $(to)/$$file || exit; \
	done)
	@$(list_scenes) | while IFS= read -r file; do install -D scenes/"$$file" $(to)/share/ehdrom/"$$file" || exit; done
list_scenes = find scenes/lib scenes/examples \( -name 'out*' -o -name build -o -name __pycache__ \) -prune -o -type f -print | sed 's,^scenes/,,'

# Removes only the files that install writes, and folders of ehdrom that are empty then.
uninstall: ## remove what install has written there
	rm -f $(addprefix $(to)/,$(PROGRAMS:$(BIN)/%=bin/%) $(MAN_PAGES:$(BUILD)/man/%=share/man/man1/%) $(LIBRARY:$(BUILD)/%=%))
	rm -rf $(to)/lib/ehdrom
	@$(list_scenes) | while IFS= read -r file; do rm -f $(to)/share/ehdrom/"$$file"; done
	@[ ! -d $(to)/share/ehdrom ] || find $(to)/share/ehdrom -depth -type d -empty -delete

# Libs.private is for static linking. The pkg-config file of HDF5 does not list the libraries that HDF5 then needs, so
# they are listed here.
$(PC_FILE): $(BUILD)/flags FORCE
	@mkdir -p $(@D) && printf '%s\n' prefix=$(call quoted,$(PREFIX)) 'includedir=$${prefix}/include' 'libdir=$${prefix}/lib' '' \
	    'Name: ehdrom' 'Version: $(VERSION)' 'Description: Reduced-order elastohydrodynamic lubrication' \
	    'Cflags: -I$${includedir}' 'Libs: -L$${libdir} -lehdrom' 'Libs.private: $(LIBRARY_LIBS) -lsz -laec -lz -pthread' > $@

# ---- A release

# The major, minor and patch number of VERSION.
numbers = $(subst ., ,$(VERSION))
version: ## write the Makefile's VERSION to header, Python package and citation
	@sed -i -e 's/^\(#define EHDROM_VERSION_MAJOR \).*/\1$(word 1,$(numbers))/' \
	    -e 's/^\(#define EHDROM_VERSION_MINOR \).*/\1$(word 2,$(numbers))/' \
	    -e 's/^\(#define EHDROM_VERSION_PATCH \).*/\1$(word 3,$(numbers))/' \
	    -e 's/^\(#define EHDROM_VERSION  *\)".*/\1"$(VERSION)"/' romrun/library/ehdrom.h
	@sed -i 's/^version = .*/version = "$(VERSION)"/' romrun/python/pyproject.toml
	@sed -i 's/^version: .*/version: $(VERSION)/' CITATION.cff

# Packs HEAD, then builds and tests the archive in another folder.
ARCHIVE := build/ehdrom-$(VERSION).tar.gz
dist: version ## a source archive of HEAD, which is built and tested apart
	@git diff --quiet HEAD || { echo 'make dist: found changes that are not committed, expected none' >&2; exit 1; }
	@mkdir -p build && git archive --prefix=ehdrom-$(VERSION)/ -o $(ARCHIVE) HEAD
	@folder=$$(mktemp -d) && trap 'rm -rf "$$folder"' EXIT && tar -xzf $(ARCHIVE) -C "$$folder" && \
	    $(MAKE) -C "$$folder"/ehdrom-$(VERSION) check
	@echo $(ARCHIVE)

ALL_C := $(SOURCES) $(FAULT_SOURCES) $(sort $(wildcard scenes/*.c scenes/*/*.c scenes/*/*/*.c))

FORMATTED := $(ALL_C) $(HEADERS) $(wildcard tests/pipeline/*.c scenes/examples/*/*.h)

format: | lint-deps ## clang-format all sources in place
	clang-format -i $(FORMATTED)

format-check: | lint-deps ## fails where clang-format would change a source
	@clang-format --dry-run -Werror $(FORMATTED)

# The cheap checks come first. Each run of clang-tidy reads three sources; before unit tests it reads tests/lint.h.
lint: format-check | deps lint-deps ## formatting, cppcheck and clang-tidy on all sources
	@cppcheck -j $(JOBS) --quiet --std=c11 --enable=warning,portability --inline-suppr \
	    --error-exitcode=1 --suppress=missingIncludeSystem -I. -D_GNU_SOURCE $(ALL_C)
	@$(call tidy,$(filter-out tests/unit/%,$(ALL_C)))
	@$(call tidy,$(UNIT_SOURCES),-include tests/lint.h)
tidy = printf '%s\n' $1 | xargs -P $(JOBS) -n 3 sh -c 'clang-tidy --quiet "$$@" -- -std=c17 \
    $2 $(ALL_CPPFLAGS) -Iromrun/library 2>&1 | \
    { ! grep -vE "^[0-9]+ warnings? (generated|treated)|^Suppressed|^$$"; }' sh

constants: ## print docs/constants.md: the numbers that decide how the programs compute, with their reasons
	@/usr/bin/python3 tests/constants.py

clean: ## remove build/
	rm -rf build

help: ## this list
	@echo 'Targets:'
	@sed -n 's/^\([a-z-]*\):.* ## \(.*\)/  \1\t\2/p' Makefile | expand -t 16
	@echo 'Settings: VARIANT=release|debug|san|tsan|cov  V=1 (show commands)  DEPS=no (install nothing)'
	@echo '          CC= CFLAGS= MARCH= JOBS=2 (tests at a time)  PREFIX=/usr/local  DESTDIR='

print-%:
	@echo '$* = $($*)'

.PHONY: all deps lint-deps coverage-deps slurm-deps fuzz-deps fuzz-coverage demo demo-point check check-all check-slow check-release check-slurm \
        run-slurm-tests coverage fuzz bench costs figures examples trade man python install uninstall version dist format format-check lint constants clean help FORCE

# ---- Packages that are needed

PACKAGES := gcc g++ libc6-dev pkg-config libopenblas-pthread-dev liblapacke-dev libsuitesparse-dev libhdf5-dev \
            hdf5-tools libgsl-dev libfftw3-dev libyaml-dev nettle-dev libminizip-dev libcmocka-dev bats cmake \
            help2man netcdf-bin python3-numpy python3-matplotlib python3-xarray python3-h5py python3-netcdf4 \
            python3-h5netcdf python3-cffi python3-scipy python3-pip valgrind libxml2-utils qemu-user

LINT_PACKAGES     := cppcheck clang-tidy clang-format
COVERAGE_PACKAGES := gcovr
FUZZ_PACKAGES     := clang libclang-rt-dev
SLURM_PACKAGES    := slurmctld slurmd slurm-client slurm-wlm-basic-plugins munge

deps: ## install the Debian packages that are missing
	@$(call install_missing,$(PACKAGES))

lint-deps:
	@$(call install_missing,$(LINT_PACKAGES))

coverage-deps:
	@$(call install_missing,$(COVERAGE_PACKAGES))

fuzz-deps:
	@$(call install_missing,$(FUZZ_PACKAGES))

slurm-deps:
	@$(call install_missing,$(SLURM_PACKAGES))

ifneq ($(DEPS),no)
define install_missing
missing=$$(for package in $1; do echo $$package; done | grep -vxF \
    "$$(dpkg-query -W -f '$${db:Status-Status}/$${Package}\n' $1 2>/dev/null \
        | sed -n 's,^installed/,,p')" | tr '\n' ' '); \
[ -n "$$missing" ] || exit 0; \
if ! command -v apt-get >/dev/null; then \
    echo "deps: found no apt-get, expected it to install what is missing: $$missing(installed otherwise? DEPS=no)" >&2; \
    exit 1; \
fi; \
if [ "$$(id -u)" -ne 0 ]; then sudo=sudo; fi; \
if [ -n "$$sudo" ] && ! command -v sudo >/dev/null; then \
    echo "deps: found no sudo and no root, expected one of them to install: $$missing(installed otherwise? DEPS=no)" >&2; \
    exit 1; \
fi; \
if [ -n "$$sudo" ] && [ -t 0 ] && [ -t 2 ] && [ -z "$$CI" ]; then \
    printf 'deps: these packages are missing:\n  %s\nInstall them with sudo apt-get? [Y/n] ' "$$missing" >&2; \
    read -r answer || answer=no; \
    case $$answer in \
    '' | [yY]*) ;; \
    *) echo 'deps: nothing was installed (installed otherwise? DEPS=no)' >&2; exit 1 ;; \
    esac; \
else \
    echo "deps: installing $$missing" >&2; \
fi; \
$$sudo apt-get update -qq && \
$$sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $$missing
endef
endif

# ---- Rules

$(BUILD)/%.o: %.c $(BUILD)/flags
	$(call quiet,CC  ,$<)mkdir -p $(@D) && $(CC) $(ALL_CPPFLAGS) $(INFO) $(ALL_CFLAGS) -MMD -MP -c -o $@ $<

$(filter $(BUILD)/common/program/%,$(LIB_OBJECTS)): INFO = $(BUILD_INFO)
$(filter $(BUILD)/common/program/%,$(LIB_OBJECTS)): $(BUILD)/revision

$(LIB): $(LIB_OBJECTS) $(BUILD)/objects
	$(call quiet,AR  ,$@)rm -f $@ && $(AR) rcs $@ $(LIB_OBJECTS)

# Only the public names of the library are visible outside. In the shared library a version script hides the others. The
# static library is one object, in which objcopy makes the others local. Functions that nobody calls are left out.
$(BUILD)/pic/%.o: %.c $(BUILD)/flags
	$(call quiet,PIC ,$<)mkdir -p $(@D) && $(CC) $(ALL_CPPFLAGS) $(INFO) $(ALL_CFLAGS) $(PIC_CFLAGS) -MMD -MP -c -o $@ $<
PIC_CFLAGS := -fPIC -fvisibility=hidden -ffunction-sections -fdata-sections

$(filter $(BUILD)/pic/common/program/%,$(LIBRARY_OBJECTS)): INFO = $(BUILD_INFO)
$(filter $(BUILD)/pic/common/program/%,$(LIBRARY_OBJECTS)): $(BUILD)/revision

exported = $(shell sed -n 's/^ *\(ehdrom_[a-z_]*\);/\1/p' $(LIBRARY_EXPORTS))

link_shared = $(call quiet,LINK,$@)mkdir -p $(@D) && $(CC) -shared $(ALL_CFLAGS) $(ALL_LDFLAGS) -o $@ $(filter %.o,$^) \
              -Wl,--gc-sections -Wl,-z,defs,-z,relro

$(SHARED_LIBRARY): $(SHARED_OBJECTS) $(LIBRARY_EXPORTS) $(BUILD)/objects
	$(link_shared) -Wl,-soname,$(SONAME) -Wl,--version-script=$(LIBRARY_EXPORTS) $(LIBRARY_LIBS)

$(PLUGIN): $(PLUGIN_OBJECTS) $(BUILD)/objects
	$(link_shared) -Wl,-soname,$(@F) $(PLUGIN_LIBS)

$(HEADER): romrun/library/ehdrom.h
	@mkdir -p $(@D) && cp $< $@

$(LIBRARY_LINKS): $(SHARED_LIBRARY)
	@ln -sf $(<F) $@

$(STATIC_LIBRARY): $(LIBRARY_OBJECTS) $(LIBRARY_EXPORTS) $(BUILD)/objects
	$(call quiet,AR  ,$@)mkdir -p $(@D) && rm -f $@ && \
	    $(CC) -r -nostdlib -o $(@D)/ehdrom.o -Wl,--gc-sections $(patsubst %,-Wl$(,)-u$(,)%,$(exported)) \
	        $(LIBRARY_OBJECTS) && \
	    objcopy $(addprefix --keep-global-symbol=,$(exported)) $(@D)/ehdrom.o && $(AR) rcs $@ $(@D)/ehdrom.o
# An FMU contains the library twice, compiled for any x86-64 and for x86-64-v3. Each copy is one object with its own
# names (romrun/fmu/processor.c). The FMU also contains all libraries that these need, except libc and libm. FFTW and
# GSL are under the GPL (romrun/fmu/README.md).
FMU_CFLAGS = $(ALL_CPPFLAGS) -std=c17 -pthread $(WARNINGS) -O3 $(PIC_CFLAGS) -DEHD_VERSION='"$(VERSION)"' \
             -DEHD_REVISION='""' -DEHD_FLAGS='""'
fmu_calls  = $(shell sed -n 's/^CHOOSE(\(.*\))/\1/p' romrun/fmu/processor.c)
fmu_compile = $(call quiet,FMU ,$< $1)mkdir -p $(@D) && $(CC) $(FMU_CFLAGS) -march=$1 -MMD -MP -c -o $@ $<

$(FMU)/flags: TEXT = $(CC) $(FMU_CFLAGS) $(FMU_LIBS)
$(FMU)/objects: TEXT = $(FMU_LIBRARY) $(FMU_SOURCES)
$(FMU)/flags $(FMU)/objects: FORCE | deps
	@mkdir -p $(@D)
	@echo '$(TEXT)' | cmp -s - $@ || echo '$(TEXT)' > $@

$(FMU)/any/%.o: %.c $(FMU)/flags
	$(call fmu_compile,x86-64)
$(FMU)/v3/%.o: %.c $(FMU)/flags
	$(call fmu_compile,x86-64-v3)

$(FMU)/any.o: $(FMU_LIBRARY:%.c=$(FMU)/any/%.o)
$(FMU)/v3.o: $(FMU_LIBRARY:%.c=$(FMU)/v3/%.o)
$(FMU_CORES): romrun/fmu/processor.c $(FMU)/objects
	$(call quiet,LINK,$@)$(CC) -r -nostdlib -o $@ -Wl,--gc-sections $(patsubst %,-Wl$(,)-u$(,)%,$(fmu_calls)) \
	    $(filter %.o,$^) && \
	objcopy $(addprefix --keep-global-symbol=,$(fmu_calls)) $@ && \
	objcopy $(foreach name,$(fmu_calls),--redefine-sym $(name)=$(name)_$(basename $(@F))) $@

FMU_LIBS = -Wl,-Bstatic -lgsl -lfftw3 -lyaml -lnettle -Wl,-Bdynamic -lm
$(FMU)/fmu.so: $(FMU_SOURCES:%.c=$(FMU)/any/%.o) $(FMU_CORES) romrun/fmu/fmi.map
	$(call quiet,LINK,$@)$(CC) -shared -static-libgcc -s -o $@ $(filter %.o,$^) $(FMU_LIBS) \
	    -Wl,--version-script=romrun/fmu/fmi.map -Wl,-Bsymbolic -Wl,--gc-sections -Wl,-z,defs,-z,relro,-z,noexecstack

# The program with which the tests import FMUs (fmu.bats). It contains the same library objects as an FMU.
$(USE_FMU): tests/pipeline/use_fmu.c $(FMU)/any/romrun/fmu/processor.o $(FMU_CORES)
	$(call quiet,LINK,$@)$(CC) -std=c17 -D_GNU_SOURCE -Wall -Wextra -Werror -O1 -I. -o $@ $^ $(FMU_LIBS)

$(BUILD)/lib/ehdrom/fmu.so: $(FMU)/fmu.so
	@mkdir -p $(@D) && ln -f $< $@

# The licences of all libraries in an FMU, copied from their Debian packages.
FMU_LICENCES := libgsl-dev libfftw3-dev libyaml-dev nettle-dev
$(BUILD)/lib/ehdrom/licenses: LICENSE COPYING $(FMU)/flags
	@rm -rf $@ && mkdir -p $@ && cp LICENSE $@/ehdrom.txt && cp COPYING $@/GPL-3.txt
	@for package in $(FMU_LICENCES); do \
	    cp /usr/share/doc/$$package/copyright $@/$$package.txt || exit; \
	done
	@for text in LGPL-3 GPL-2; do cp /usr/share/common-licenses/$$text $@/$$text.txt || exit; done

link = mkdir -p $(@D) && $(CC) $(ALL_CFLAGS) $(ALL_LDFLAGS) -o $@ $(filter %.o %.a,$^)

$(PROGRAMS): $(BIN)/%: $(BUILD)/%/main.o $(LIB)
	$(call quiet,LINK,$@)$(link) $(PROGRAM_LIBS)

# tests/unit/allocation.h replaces these functions to make allocations fail.
WRAP := -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc

$(TESTS) $(LONG_TESTS): $(BUILD)/unit/%: $(BUILD)/tests/unit/%.o $(UNIT_SHARED) $(LIB)
	$(call quiet,LINK,$@)$(link) $(WRAP) -lcmocka $(ALL_LIBS)

# Built like a user's program, with the header and the shared library.
$(ON_LIBRARY): tests/bench/bench_many.c $(LIBRARY)
	$(call quiet,LINK,$@)mkdir -p $(@D) && $(CC) -I$(BUILD)/include -D_GNU_SOURCE $(ALL_CFLAGS) $(LDFLAGS) -o $@ $< \
	    -L$(BUILD)/lib -lehdrom -Xlinker -rpath -Xlinker "$$PWD"/$(BUILD)/lib -lm

$(filter-out $(ON_LIBRARY),$(BENCHES)): $(BUILD)/bench/%: $(BUILD)/tests/bench/%.o $(BUILD)/tests/unit/dense.o \
                             $(BUILD)/tests/unit/sample.o $(BENCH_SHARED) $(LIB)
	$(call quiet,LINK,$@)$(link) $(ALL_LIBS)

# The program of library.bats, linked with the objects of this variant and so with its sanitizers or counts.
$(USE_LIBRARY): tests/pipeline/use_library.c romrun/library/ehdrom.h $(LIB)
	$(call quiet,LINK,$@)mkdir -p $(@D) && $(CC) -Iromrun/library -D_GNU_SOURCE $(ALL_CFLAGS) $(ALL_LDFLAGS) -o $@ $< $(LIB) $(ALL_LIBS)

# inject.so is loaded into programs of any variant, so the fault tools do not use the flags of the variant.
FAULT_CFLAGS = $(ALL_CPPFLAGS) -std=c17 $(WARNINGS) -O2
$(BUILD)/fault/inject.so: tests/fault/inject.c $(BUILD)/flags
	$(call quiet,CC  ,$<)mkdir -p $(@D) && $(CC) $(FAULT_CFLAGS) -shared -fPIC -o $@ $< -ldl

$(BUILD)/fault/sweep: tests/fault/sweep.c $(BUILD)/flags
	$(call quiet,CC  ,$<)mkdir -p $(@D) && $(CC) $(FAULT_CFLAGS) -o $@ $< $(ALL_LDFLAGS) $(PKG_LIBS)

$(BUILD)/fuzz/%-main.o: %/main.c $(BUILD)/flags
	$(call quiet,CC  ,$<)mkdir -p $(@D) && $(CC) $(ALL_CPPFLAGS) $(ALL_CFLAGS) -Dmain=$*_main -MMD -MP -c -o $@ $<

$(FUZZER): LDFLAGS += -fsanitize=fuzzer -Wl,--wrap=strcmp
$(REPLAY) $(FLIP) $(FUZZER): $(BUILD)/fuzz/%: $(BUILD)/tests/fuzz/%.o $(FUZZ_SHARED) $(LIB)
	$(call quiet,LINK,$@)$(link) $(ALL_LIBS)

-include $(patsubst %.o,%.d,$(sort $(LIBRARY_OBJECTS) $(SHARED_OBJECTS) $(PLUGIN_OBJECTS)))
-include $(patsubst %.c,$(FMU)/any/%.d,$(FMU_LIBRARY) $(FMU_SOURCES)) $(FMU_LIBRARY:%.c=$(FMU)/v3/%.d)
-include $(FUZZ_SHARED:%.o=%.d)
-include $(patsubst %.c,$(BUILD)/%.d,$(SOURCES))
