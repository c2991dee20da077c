# SPDX-License-Identifier: GPL-3.0-or-later
# Rules that the Makefiles of all scenes share: folders, settings, quiet commands, `clean` and `help`. Settings of a
# scene can be given as SET='--set key=value ...'. A word with blanks needs quotes, as in the shell.
#
# Neither make nor the shell interprets names and settings. Nothing in SET, PLAN and BIN is expanded. make uses only the
# numbers of cases (pipeline.mk); scripts and programs read their names and settings. If make cannot handle the name of
# a folder, a link in OUT leads to this folder. Values that cannot work, such as blanks in OUT, are refused before any
# work.

SHARED := $(dir $(lastword $(MAKEFILE_LIST)))
OUT    ?= out
SET    ?=
V      ?= 0

# ---- Names and settings as data

define newline :=


endef

# $(call quoted,TEXT): TEXT as one word of the shell. $(call found_in,TEXT,CHARACTERS): the CHARACTERS that TEXT
# contains, and the word line-break if TEXT contains one.
quoted   = '$(subst ','\'',$1)'
found_in = $(strip $(foreach character,$2,$(findstring $(character),$1)) $(if $(findstring $(newline),$1),line-break))

# Characters with a meaning in the shell, and characters that the name of a target cannot have in make. Such a name
# cannot have blanks either.
shell_acts_on := $$ ; ' " \ ` & | < > ( ) \#
not_in_names  := $(shell_acts_on) % : = * ? [ ] { } ! ~ ^ ,
unsafe_name    = $(call found_in,$1,$(not_in_names))$(if $(filter-out 1,$(words x$1x)),blank)$(filter -%,$1)

# Values from the command line or the environment are taken literally; make would expand them.
given   = $(filter command environment,$(firstword $(origin $1)))
literal = $(if $(call given,$1),$(eval override $1 := $$(value $1)))
texts  := SET PLAN BIN SNAPGEN_OPTIONS SBATCH_OPTIONS

# $(call words_of,TEXT): the words of TEXT, in quotes if the shell would change one of them. $(call one_word,TEXT): TEXT
# as one word, in quotes if the shell would change it.
shell_changes := $(shell_acts_on) * ? [ ~
words_of = $(if $(call found_in,$1,$(shell_changes)),$(call quoted_words,$1),$1)
one_word = $(if $(call found_in,$1,$(shell_changes))$(filter-out 1,$(words x$1x)),$(call quoted,$1),$1)
quoted_words = $(shell words=$$(printf '%s' $(call quoted,$1) | xargs -n 1 printf '%s\n' 2>/dev/null) && \
    printf '%s\n' "$$words" | sed "s/'/'\\\\''/g; s/^/'/; s/$$/'/")$(if $(filter-out 0,$(.SHELLSTATUS)),$(error \
    found '$1', expected words whose quotes end))

$(foreach name,$(texts) OUT,$(call literal,$(name)))
$(foreach name,$(texts),$(if $(findstring $(newline),$($(name))),$(error \
    $(name): found a line break, expected none: make cannot have one in a command)))
$(foreach name,SET SNAPGEN_OPTIONS SBATCH_OPTIONS,$(eval override $(name) := $$(call words_of,$$($(name)))))
$(foreach name,$(filter-out $(texts),$(.VARIABLES)),$(if $(filter command,$(firstword $(origin $(name)))),$(if \
    $(call found_in,$(value $(name)),$(shell_acts_on)),$(error \
    $(name): found '$(value $(name))', expected none of $(shell_acts_on)))))
unsafe := $(call unsafe_name,$(OUT))$(foreach name,$(MODELS),$(call unsafe_name,$(name)))
$(if $(strip $(unsafe)),$(error OUT, MODELS: found '$(OUT)', '$(MODELS)', expected names without blanks and any of $(not_in_names)))

# $(call link,NAME,PATH): makes the link OUT/NAME to the folder or file PATH. If PATH does not exist, removes the link.
link = $(shell mkdir -p $(OUT); there=$$(realpath -e -- $(call quoted,$2) 2>/dev/null) || rm -f $(OUT)/$1; \
    [ -z "$$there" ] || [ $(OUT)/$1 -ef "$$there" ] || ln -sfn -- "$$there" $(OUT)/$1)

# ---- Folders

# The programs on the PATH are used, otherwise the programs that are installed or built beside this file.
ifeq ($(BIN),)
  BIN := $(or $(shell file=$$(command -v fullrun) && dirname -- "$$file"),\
              $(patsubst %/,%,$(dir $(wildcard $(SHARED)../../../bin/fullrun))),$(SHARED)../../build/release/bin)
endif
$(call link,.bin,$(BIN))
override BIN := $(OUT)/.bin
export BIN
$(BIN)/%:
	@echo '$@: found none, expected a program: BIN' >&2; exit 1

ifneq ($(call unsafe_name,$(SHARED)),)
  $(call link,.lib,$(SHARED))
  SHARED := $(OUT)/.lib/
endif

# Scenes that reproduce the paper have its discretisation and grid. Other studies use the plans of these scenes with the
# default discretisation: ACCURATE in the Makefile of the scene has the settings for it. The results are in
# out-accurate.
ACCURATE ?=

# as_published: not empty if the Makefile sets ACCURATE and SET names no discretisation. in_accurate: makes the same
# target with the settings ACCURATE in out-accurate.
as_published := $(and $(ACCURATE),$(if $(findstring discretization=,$(SET)),,published))
in_accurate   = @$(MAKE) $@ OUT=out-accurate SET=$(call quoted,$(strip $(ACCURATE) $(SET)))

# For the folder of another scene: $(call accurate,FOLDER) are its settings ACCURATE; they are empty if the scene has
# the default discretisation. $(call accurate_out,FOLDER) is the folder of the results, and $(call accurate_make,FOLDER)
# calls make there.
accurate      = $(if $(wildcard $1/Makefile),$(shell sed -n 's/^ACCURATE *= *//p' $1/Makefile))
accurate_out  = $1/out$(if $(call accurate,$1),-accurate)
accurate_make = $(MAKE) -C $1 OUT=$(notdir $(call accurate_out,$1)) SET='$(call accurate,$1)' BIN="$$(realpath $(BIN))"

# $(call differs,FILE,TEXT): not empty if the content of FILE is not TEXT.
differs = $(subst |$(file <$1)|,,|$2|)

# A Makefile may contain plans, before it includes this file. Each name in PLANS is the name of a variable with the text
# of a plan (define NAME.yml ... endef), and the name of the file in OUT to which the text is written. In such a plan,
# `scene: scene.yml` is the scene in the folder of the Makefile.
PLANS ?=
$(if $(PLANS),$(call link,scene.yml,scene.yml))
$(foreach plan,$(PLANS),$(if $(call differs,$(OUT)/$(plan),$(value $(plan))),$(file >$(OUT)/$(plan),$(value $(plan)))))

# Runs a script, which can import the Python modules of this folder.
PYTHON ?= /usr/bin/python3
python  = PYTHONPATH=$(SHARED) $(PYTHON) -B

# Number of jobs of each program (--jobs); empty: as many as there are processors. SNAPGEN_JOBS is the old name.
JOBS ?= $(SNAPGEN_JOBS)
jobs  = $(JOBS:%=--jobs %)

# Further options of snapgen that do not change results, such as --resume after an interruption.
SNAPGEN_OPTIONS ?=

ifeq ($(V),0)
  quiet = @echo '  $1 $2';
endif
MAKEFLAGS += --no-builtin-rules --no-print-directory
.DELETE_ON_ERROR:

# $(call tell,WORD,FILE...,END): prints a line `WORD: FILE END` for each file, with its absolute path.
# $(call tell_pictures,FILE...): prints such a line for each picture, which is a PNG and an SVG file.
tell = @for file in $2; do printf '%s: %s%s\n' $1 "$$(realpath -s $$file)" '$3'; done
tell_pictures = $(call tell,picture,$1,$(,) .svg)
, := ,

# $(call options,NAME,TEXT): a file that is rewritten only if TEXT has changed. A target that depends on it is made
# again if its options have changed.
options = $(OUT)/$1.options$(if $(call differs,$(OUT)/$1.options,$(strip $1 $2)),$(file >$(OUT)/$1.options,$(strip $1 $2)))

clean: ## remove what was made
	rm -rf $(OUT) $(if $(ACCURATE),out-accurate)

# Lists the targets of the Makefile and of the files that it includes.
help: ## this list
	@sed -n -e ':join' -e '/\\$$/ { N; s/\\\n//; b join' -e '}' -e 's/^\([a-z-]*\):.* ## \(.*\)/  \1\t\2/p' $(foreach file,$(MAKEFILE_LIST),$(call quoted,$(file))) | expand -t 16

.PHONY: clean help
