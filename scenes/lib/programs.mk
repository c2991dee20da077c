# SPDX-License-Identifier: GPL-3.0-or-later
# Builds and runs a scene's own programs in C and Python. Include this file after common.mk (in studies) or training.mk.
# A Makefile may set these variables before:
#   LIBRARY_PROGRAMS  names of programs: NAME.c is compiled to $(OUT)/NAME with the public header and the shared library
#   VARIED            one of these names: NAME.py does the same with the Python package (make python), and with FMUs
#   VARIED_RUN        the table that the C program VARIED writes; the Makefile has a rule for this table
#   FMU_SET           settings of the scene from which the FMU is made; its approach is an input
# Any other NAME.c can be compiled to $(OUT)/NAME against the sources and the library that was built with the programs.

# ---- On the library

# The folder with the library that was built, or installed, together with the programs.
BESIDE      := $(BIN)/..
use_library  = $(shell PKG_CONFIG_PATH=$(BESIDE)/lib/pkgconfig pkg-config --define-prefix --cflags --libs ehdrom)
own_headers := $(foreach name,$(wildcard *.h),$(if $(call unsafe_name,$(name)),,$(name)))

ifneq ($(LIBRARY_PROGRAMS),)
$(LIBRARY_PROGRAMS:%=$(OUT)/%): $(OUT)/%: %.c $(own_headers) $(BESIDE)/lib/libehdrom.so
	$(call quiet,CC        ,$@)$(CC) -std=c11 -D_POSIX_C_SOURCE=200809L -O2 -Wall -Wextra -pthread -o $@ $< $(use_library) \
	    -Xlinker -rpath -Xlinker "$$(realpath $(BESIDE)/lib)" -lm
endif

# ---- The same program in Python

ifneq ($(VARIED),)

variants: $(OUT)/variants.txt ## the same on the library in Python (make python) and on FMUs, and how far they are off
	@cat $<

.PHONY: variants

# Python takes the package from the folder of `make python`, otherwise from its usual folders.
$(OUT)/python.csv: $(VARIED).py scene.yml $(OUT)/$(MODEL).h5
	$(call quiet,python    ,$@)PYTHONPATH="$$(realpath -m $(BESIDE)/python):$$PYTHONPATH" $(PYTHON) -B $^ $@ $(ends_well)

$(OUT)/contact.fmu: scene.yml $(OUT)/$(MODEL).h5 $(BIN)/romrun
	$(call quiet,romrun    ,$@)$(BIN)/romrun fmu $< --model $(OUT)/$(MODEL).h5 --set closure=approach $(FMU_SET) $(SET) -o $@ --force --quiet

$(OUT)/fmu.csv: $(VARIED).py scene.yml $(OUT)/contact.fmu $(SHARED)fmu.py
	$(call quiet,python    ,$@)$(python) $(wordlist 1,3,$^) $@ $(ends_well)

# Exit code 4 (results that are not trusted) is accepted, since the C program may end with it too.
ends_well = || [ $$? -eq 4 ]

$(OUT)/variants.txt: $(SHARED)compare.py $(VARIED_RUN) $(OUT)/python.csv $(OUT)/fmu.csv
	$(call quiet,compare   ,$@)$(python) $< runs $(filter %.csv,$^) > $@

endif

# ---- On the sources

# The library that was built with the programs. `ask` gets the compiler and the flags of this build.
ROOT    := $(BIN)/../../..
VARIANT := $(shell basename "$$(realpath $(BIN)/..)")
LIB     := $(BIN)/../libprograms.a
ask      = $(shell $(MAKE) -s -C $(ROOT) VARIANT=$(call quoted,$(VARIANT)) print-$1 | sed 's/^[^=]*= //')

# The compiler runs in the root of the sources, where the paths of #include start.
$(OUT)/%: %.c $(LIB)
	$(call quiet,CC        ,$@)made=$$(realpath $@) && source=$$(realpath $<) && library=$$(realpath $(LIB)) && cd -P $(ROOT) && \
	    $(call ask,CC) $(call ask,ALL_CPPFLAGS) $(call ask,ALL_CFLAGS) $(call ask,ALL_LDFLAGS) -o "$$made" "$$source" \
	    "$$library" $(call ask,ALL_LIBS)
