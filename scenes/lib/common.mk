# SPDX-License-Identifier: GPL-3.0-or-later
# What the Makefiles of all scenes share: folders, settings, quiet commands, `clean` and `help`. Settings
# of any scene can be given as SET='--set key=value ...': words, with quotes as in the shell around those with blanks.
#
# Names and settings never become text of make or of the shell: nothing in SET, PLAN and BIN is expanded, make knows cases by
# number (pipeline.mk), and scripts and programs read their names and settings. Folders whose names make cannot handle
# are reached through links in OUT. What cannot work, such as blanks in OUT, is refused before any work.

SHARED := $(dir $(lastword $(MAKEFILE_LIST)))
OUT    ?= out
SET    ?=
V      ?= 0

# ---- Data

define newline :=


endef

# $(call quoted,TEXT): one word of the shell. $(call found_in,TEXT,CHARACTERS): those of them that TEXT has.
quoted   = '$(subst ','\'',$1)'
found_in = $(strip $(foreach character,$2,$(findstring $(character),$1)) $(if $(findstring $(newline),$1),line-break))

# Characters that the shell acts on, and those that a target's name in make cannot have (nor blanks).
shell_acts_on := $$ ; ' " \ ` & | < > ( ) \#
not_in_names  := $(shell_acts_on) % : = * ? [ ] { } ! ~ ^ ,
unsafe_name    = $(call found_in,$1,$(not_in_names))$(if $(filter-out 1,$(words x$1x)),blank)$(filter -%,$1)

# What was given with the command or in the environment is taken as it is; make would expand it.
given   = $(filter command environment,$(firstword $(origin $1)))
literal = $(if $(call given,$1),$(eval override $1 := $$(value $1)))
texts  := SET PLAN BIN SNAPGEN_OPTIONS SBATCH_OPTIONS

# $(call words_of,TEXT): its words, quoted where the shell would not take one as it is. $(call one_word,TEXT): one word.
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

# $(call link,NAME,PLACE): makes the link OUT/NAME to a folder or file, or removes it if there is none.
link = $(shell mkdir -p $(OUT); there=$$(realpath -e -- $(call quoted,$2) 2>/dev/null) || rm -f $(OUT)/$1; \
    [ -z "$$there" ] || [ $(OUT)/$1 -ef "$$there" ] || ln -sfn -- "$$there" $(OUT)/$1)

# ---- Folders

# The programs: those on the PATH, else those installed or built beside this file.
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

# Scenes that reproduce the paper ask for its rows and grid. A study that borrows the plan only takes the rows that a scene
# has by default: ACCURATE in the Makefile of the scene, settings for that. What they lead to is in out-accurate.
ACCURATE ?=

# Not empty where that is so and SET does not say which rows; and the same target there.
as_published := $(and $(ACCURATE),$(if $(findstring discretization=,$(SET)),,published))
in_accurate   = @$(MAKE) $@ OUT=out-accurate SET=$(call quoted,$(strip $(ACCURATE) $(SET)))

# $(call accurate,FOLDER): those of another folder, none where the scene has accurate rows as it is; where their results
# are; and make there.
accurate      = $(if $(wildcard $1/Makefile),$(shell sed -n 's/^ACCURATE *= *//p' $1/Makefile))
accurate_out  = $1/out$(if $(call accurate,$1),-accurate)
accurate_make = $(MAKE) -C $1 OUT=$(notdir $(call accurate_out,$1)) SET='$(call accurate,$1)' BIN="$$(realpath $(BIN))"

# $(call differs,FILE,TEXT): not empty if the file has another text.
differs = $(subst |$(file <$1)|,,|$2|)

# Plans that stand in a Makefile, before it includes this: each of PLANS is a file of OUT and the name of the variable that
# has its text (define NAME.yml ... endef). `scene: scene.yml` there is the scene of the Makefile's folder.
PLANS ?=
$(if $(PLANS),$(call link,scene.yml,scene.yml))
$(foreach plan,$(PLANS),$(if $(call differs,$(OUT)/$(plan),$(value $(plan))),$(file >$(OUT)/$(plan),$(value $(plan)))))

# Scripts, with what they share.
PYTHON ?= /usr/bin/python3
python  = PYTHONPATH=$(SHARED) $(PYTHON) -B

# What each program may do at a time (--jobs); empty: as much as there are processors. SNAPGEN_JOBS is its name before.
JOBS ?= $(SNAPGEN_JOBS)
jobs  = $(JOBS:%=--jobs %)

# More options of snapgen that change no result, such as --resume after an interruption.
SNAPGEN_OPTIONS ?=

ifeq ($(V),0)
  quiet = @echo '  $1 $2';
endif
MAKEFLAGS += --no-builtin-rules --no-print-directory
.DELETE_ON_ERROR:

# $(call tell,WORD,FILE...,END): lines WORD: FILE END with whole paths. $(call tell_pictures,FILE...)
tell = @for file in $2; do printf '%s: %s%s\n' $1 "$$(realpath -s $$file)" '$3'; done
tell_pictures = $(call tell,picture,$1,$(,) .svg)
, := ,

# $(call options,NAME,TEXT): a file that changes with its text only, so that what other options made is
# made again.
options = $(OUT)/$1.options$(if $(call differs,$(OUT)/$1.options,$(strip $1 $2)),$(file >$(OUT)/$1.options,$(strip $1 $2)))

clean: ## remove what was made
	rm -rf $(OUT) $(if $(ACCURATE),out-accurate)

# Of the Makefile and of what it includes.
help: ## this list
	@sed -n -e ':join' -e '/\\$$/ { N; s/\\\n//; b join' -e '}' -e 's/^\([a-z-]*\):.* ## \(.*\)/  \1\t\2/p' $(foreach file,$(MAKEFILE_LIST),$(call quoted,$(file))) | expand -t 16

.PHONY: clean help
