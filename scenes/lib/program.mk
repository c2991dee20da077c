# SPDX-License-Identifier: GPL-3.0-or-later
# C programs of a scene's own, on the library: NAME.c becomes $(OUT)/NAME. Included behind common.mk.

# The library that was built with the programs, and the compiler and flags that it was built with.
ROOT    := $(abspath $(BIN)/../../..)
VARIANT := $(notdir $(abspath $(BIN)/..))
LIB     := $(abspath $(BIN)/../libprograms.a)
ask      = $(shell $(MAKE) -s -C $(ROOT) VARIANT=$(VARIANT) print-$1 | sed 's/^[^=]*= //')

# Includes start from the root.
$(OUT)/%: %.c $(LIB)
	$(call quiet,CC        ,$@)cd $(ROOT) && $(call ask,CC) $(call ask,ALL_CPPFLAGS) $(call ask,ALL_CFLAGS) \
	    $(call ask,ALL_LDFLAGS) -o $(abspath $@) $(abspath $<) $(LIB) $(call ask,ALL_LIBS)
