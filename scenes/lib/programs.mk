# SPDX-License-Identifier: GPL-3.0-or-later
# Programs of a scene's own in C and Python. Included behind common.mk (in studies) or training.mk. A Makefile may set before:
#   LIBRARY_PROGRAMS  names: each NAME.c becomes $(OUT)/NAME on the library as others see it
#   VARIED            one of these: NAME.py does the same on the Python package (make python), and on FMUs
#   VARIED_RUN        the table that VARIED writes, with a rule for it
#   FMU_SET           settings of the scene whose contact becomes an FMU, with the approach given
# Every other NAME.c may become $(OUT)/NAME on the sources, with the library that was built with the programs.

# ---- On the library

# What was built, or installed, with the programs.
BESIDE      := $(BIN)/..
use_library  = $(shell PKG_CONFIG_PATH=$(BESIDE)/lib/pkgconfig pkg-config --define-prefix --cflags --libs ehdrom)
own_headers := $(foreach name,$(wildcard *.h),$(if $(call unsafe_name,$(name)),,$(name)))

ifneq ($(LIBRARY_PROGRAMS),)
$(LIBRARY_PROGRAMS:%=$(OUT)/%): $(OUT)/%: %.c $(own_headers) $(BESIDE)/lib/libehdrom.so
	$(call quiet,CC        ,$@)$(CC) -std=c11 -D_POSIX_C_SOURCE=200809L -O2 -Wall -Wextra -pthread -o $@ $< $(use_library) \
	    -Xlinker -rpath -Xlinker "$$(realpath $(BESIDE)/lib)" -lm
endif

# ---- The same in Python

ifneq ($(VARIED),)

variants: $(OUT)/variants.txt ## the same on the library in Python (make python) and on FMUs, and how far they are off
	@cat $<

.PHONY: variants

# The package and its library where `make python` puts them, else where Python finds it.
$(OUT)/python.csv: $(VARIED).py scene.yml $(OUT)/$(MODEL).h5
	$(call quiet,python    ,$@)PYTHONPATH="$$(realpath -m $(BESIDE)/python):$$PYTHONPATH" $(PYTHON) -B $^ $@ $(ends_well)

$(OUT)/contact.fmu: scene.yml $(OUT)/$(MODEL).h5 $(BIN)/romrun
	$(call quiet,romrun    ,$@)$(BIN)/romrun fmu $< --model $(OUT)/$(MODEL).h5 --set closure=approach $(FMU_SET) $(SET) -o $@ --force --quiet

$(OUT)/fmu.csv: $(VARIED).py scene.yml $(OUT)/contact.fmu $(SHARED)fmu.py
	$(call quiet,python    ,$@)$(python) $(wordlist 1,3,$^) $@ $(ends_well)

# Exit code 4: not to be trusted, as the program that they are compared with.
ends_well = || [ $$? -eq 4 ]

$(OUT)/variants.txt: $(SHARED)compare.py $(VARIED_RUN) $(OUT)/python.csv $(OUT)/fmu.csv
	$(call quiet,compare   ,$@)$(python) $< runs $(filter %.csv,$^) > $@

endif

# ---- On the sources

# The library that was built with the programs, and the compiler and flags that it was built with.
ROOT    := $(BIN)/../../..
VARIANT := $(shell basename "$$(realpath $(BIN)/..)")
LIB     := $(BIN)/../libprograms.a
ask      = $(shell $(MAKE) -s -C $(ROOT) VARIANT=$(call quoted,$(VARIANT)) print-$1 | sed 's/^[^=]*= //')

# Includes start from the root.
$(OUT)/%: %.c $(LIB)
	$(call quiet,CC        ,$@)made=$$(realpath $@) && source=$$(realpath $<) && library=$$(realpath $(LIB)) && cd -P $(ROOT) && \
	    $(call ask,CC) $(call ask,ALL_CPPFLAGS) $(call ask,ALL_CFLAGS) $(call ask,ALL_LDFLAGS) -o "$$made" "$$source" \
	    "$$library" $(call ask,ALL_LIBS)
