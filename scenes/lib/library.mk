# SPDX-License-Identifier: GPL-3.0-or-later
# C programs of a scene's own, on the library as others see it: each NAME of LIBRARY_PROGRAMS, NAME.c, becomes $(OUT)/NAME.
# Included behind common.mk.

# What was built, or installed, with the programs.
BESIDE      := $(abspath $(BIN)/..)
use_library  = $(shell PKG_CONFIG_PATH=$(BESIDE)/lib/pkgconfig pkg-config --define-prefix --cflags --libs ehdrom)

$(LIBRARY_PROGRAMS:%=$(OUT)/%): $(OUT)/%: %.c $(wildcard *.h) $(BESIDE)/lib/libehdrom.so
	$(call quiet,CC        ,$@)$(CC) -std=c11 -D_POSIX_C_SOURCE=200809L -O2 -Wall -Wextra -pthread -o $@ $< $(use_library) \
	    -Wl,-rpath,$(BESIDE)/lib -lm
