# SPDX-License-Identifier: GPL-3.0-or-later
# C programs of a scene's own, on the library as others see it: each NAME of LIBRARY_PROGRAMS, NAME.c, becomes $(OUT)/NAME.
# Included behind common.mk.

# What was built, or installed, with the programs.
BESIDE      := $(BIN)/..
use_library  = $(shell PKG_CONFIG_PATH=$(BESIDE)/lib/pkgconfig pkg-config --define-prefix --cflags --libs ehdrom)
own_headers := $(foreach name,$(wildcard *.h),$(if $(call unsafe_name,$(name)),,$(name)))

$(LIBRARY_PROGRAMS:%=$(OUT)/%): $(OUT)/%: %.c $(own_headers) $(BESIDE)/lib/libehdrom.so
	$(call quiet,CC        ,$@)$(CC) -std=c11 -D_POSIX_C_SOURCE=200809L -O2 -Wall -Wextra -pthread -o $@ $< $(use_library) \
	    -Xlinker -rpath -Xlinker "$$(realpath $(BESIDE)/lib)" -lm
