# SPDX-License-Identifier: GPL-3.0-or-later
# C programs of a scene's own, on the sources: NAME.c becomes $(OUT)/NAME. Included behind common.mk; a program needs
# nothing of this on the installed library (library.mk).

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
