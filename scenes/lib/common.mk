# SPDX-License-Identifier: GPL-3.0-or-later
# What the Makefiles of all scenes share: folders, settings, quiet commands, `clean` and `help`. Settings
# of any scene can be given as SET='--set key=value ...'.

SHARED := $(dir $(lastword $(MAKEFILE_LIST)))
OUT    ?= out
SET    ?=
V      ?= 0

# Scenes that reproduce the paper ask for its rows and grid. A study that borrows the plan only takes the rows that a scene
# has by default: ACCURATE in the Makefile of the scene, settings for that. What they lead to is in out-accurate.
ACCURATE ?=

# Not empty where that is so and SET does not say which rows; and the same target there.
as_published := $(and $(ACCURATE),$(if $(findstring discretization=,$(SET)),,published))
in_accurate   = @$(MAKE) $@ OUT=out-accurate SET='$(strip $(ACCURATE) $(SET))'

# $(call accurate,FOLDER): those of another folder, none where the scene has accurate rows as it is; where their results
# are; and make there.
accurate      = $(if $(wildcard $1/Makefile),$(shell sed -n 's/^ACCURATE *= *//p' $1/Makefile))
accurate_out  = $1/out$(if $(call accurate,$1),-accurate)
accurate_make = $(MAKE) -C $1 OUT=$(notdir $(call accurate_out,$1)) SET='$(call accurate,$1)' BIN=$(abspath $(BIN))

# The programs: those on the PATH, else those installed or built beside this file.
ifeq ($(BIN),)
  BIN := $(or $(patsubst %/,%,$(dir $(shell command -v fullrun))),\
              $(patsubst %/,%,$(dir $(wildcard $(SHARED)../../../bin/fullrun))),$(SHARED)../../build/release/bin)
endif
export BIN

# Scripts, with what they share.
PYTHON ?= /usr/bin/python3
python  = PYTHONPATH=$(SHARED) $(PYTHON) -B

# More options of snapgen that change no result, such as --resume after an interruption.
SNAPGEN_OPTIONS ?=

ifeq ($(V),0)
  quiet = @echo '  $1 $2';
endif
MAKEFLAGS += --no-builtin-rules --no-print-directory
.DELETE_ON_ERROR:

$(shell mkdir -p $(OUT))

# $(call options,NAME,TEXT): a file that changes with its text only, so that what other options made is
# made again.
options = $(OUT)/$1.options$(if $(call differs,$(OUT)/$1.options,$(strip $1 $2)),$(file >$(OUT)/$1.options,$(strip $1 $2)))
differs = $(subst |$(file <$1)|,,|$2|)

clean: ## remove what was made
	rm -rf $(OUT) $(if $(ACCURATE),out-accurate)

# Of the Makefile and of what it includes.
help: ## this list
	@sed -n -e ':join' -e '/\\$$/ { N; s/\\\n//; b join' -e '}' -e 's/^\([a-z-]*\):.* ## \(.*\)/  \1\t\2/p' $(MAKEFILE_LIST) | expand -t 16

.PHONY: clean help
