# SPDX-License-Identifier: GPL-3.0-or-later
# From a plan to reduced models: training, bases, row selection. A Makefile that includes this may set before:
#   PLAN      what the models are trained on: plan.yml; a list of points, or a region in which they are chosen
#   ACCURACY  solve only as many points of the plan as it takes to be so accurate (1e-3) at all others; empty: all, and
#             of a region as many as 1e-3 takes; of histories always all
#   ENERGY    part of the energy of the training solutions that the modes may leave out: 1e-18, nearly all they tell
#   MODELS    names of the models to make: model. What each is made of, where not by ENERGY alone (podbuild --help,
#             deimselect --help): NAME.PRESSURE_MODES, NAME.DEFORMATION, NAME.DEFORMATION_MODES, NAME.WEIGHT; NAME.ROWS,
#             NAME.METHOD, NAME.WEIGHTS, NAME.STABILITY; NAME.CHECK = no: without a check;
#             NAME.CALIBRATION: a plan that romrun calibrate takes in place of the check, for oils that are not trained
#   JOBS      points at a time, and threads of each other program; empty: as many as there are processors. Changes no result
#   MEMORY    memory that arrays of podbuild and deimselect may take (--memory of either): half of the machine's
#   PARTS     not empty: each piece of the training is compressed where it was solved, and the modes are those of these parts
#   SPLIT     parts of a region, each with a model of its own, which OUT/NAME.yml lists (schemas/models.md): 1, or a number;
#             empty: 1, or where the region is too wide for one model as many as the training finds (parts.sh)
#   ONE_GRID  not empty: all parts on the grid that the region needs, for contacts in time and FMUs; points and ellipses always
#   SLURM     not empty: train on Slurm, with an array of SHARDS tasks (4), in a region one a round, and sbatch's
#             SBATCH_OPTIONS (slurm.sh)

PLAN     ?= plan.yml

include $(or $(wildcard $(dir $(lastword $(MAKEFILE_LIST)))common.mk),$(error $(lastword $(MAKEFILE_LIST)): found blanks in its path, expected none))

ACCURACY ?=
ENERGY   ?= 1e-18
MODELS   ?= model
MODEL    := $(firstword $(MODELS))

# The same makefile again, and the plan, as words of the shell.
this_makefile := $(call one_word,$(firstword $(MAKEFILE_LIST)))
plan          := $(call one_word,$(PLAN))

# What the Makefile of a region says of one of its parts, in a folder of that.
PART ?=
PARTS_OF ?=
ifneq ($(PART),)
override SET += $(call words_of,$(file <$(dir $(OUT))parts-grid.txt))
endif

# Points of the plan that may fail.
ALLOW_FAILURES ?= 0

# $* is the name of the model, also in what a target needs ($$).
.SECONDEXPANSION:

models: $$(foreach model,$$(MODELS),$$(call model_file,$$(model))) ## all models
	$(call tell,model,$(foreach model,$(MODELS),$(call model_file,$(model))))
.DEFAULT_GOAL := models
.PHONY: models

# What the plan, or that which it is a part of, is of; plan.stamp is as old as the newest of what it is read from.
planned := $(shell $(SHARED)plan.sh $(plan) $(OUT)/plan.stamp)

# Not empty where points are chosen, round by round: of a list that is so wanted, and in a region. Histories are all needed.
region := $(if $(PART),yes,$(filter region,$(planned)))
chosen := $(if $(filter histories,$(planned)),,$(strip $(ACCURACY) $(region)))

# Parts are of a region, and trained here.
ifneq ($(filter-out 1,$(SPLIT)),)
ifneq ($(if $(region),$(SLURM),no),)
$(error SPLIT: found $(SPLIT) $(if $(region),on Slurm,for a plan without a region), expected 1)
endif
endif

# Pieces of the training, which together have the bits of one: each is a file. What Slurm has trained stays in pieces.
# Where points are chosen the pieces are those of a round, and join the one file.
SLURM  ?=
SHARDS ?= $(or $(if $(chosen),,$(file <$(OUT)/shards)),$(if $(SLURM),4,1))
SBATCH_OPTIONS ?=

SNAPSHOTS := $(if $(or $(chosen),$(filter 1,$(SHARDS))),$(OUT)/snapshots.h5,$(patsubst %,$(OUT)/snapshots-%-of-$(SHARDS).h5,$(shell seq $(SHARDS))))
shard      = $(if $(or $(chosen),$(filter 1,$(SHARDS))),,--shard $(word 2,$(subst -, ,$(notdir $@)))/$(SHARDS))

# What the modes are made of.
MEMORY ?=
PARTS  ?=
SOURCES := $(if $(PARTS),$(SNAPSHOTS:$(OUT)/snapshots%=$(OUT)/part%),$(SNAPSHOTS))

TRAINED := $(sort $(SNAPSHOTS) $(SOURCES)) $(foreach model,$(MODELS),$(model:%=$(OUT)/%-basis.h5) $(model:%=$(OUT)/%-residuals.h5) $(model:%=$(OUT)/%.h5))

# Hidden, because make -n would run a line that has it.
hidden_make = $(MAKE)

# ---- On Slurm: the same rules, as jobs

slurm-status: ## state of the training on Slurm (make SLURM=1)
	@$(SHARED)slurm.sh status $(OUT)/slurm $(BIN)/snapgen

.PHONY: slurm-status

ifneq ($(SLURM),)

$(TRAINED): on-slurm ;

# Empty where one task does all.
in_rounds = $(and $(chosen),$(filter-out 1,$(SHARDS)))

on-slurm:
	$(if $(chosen),,$(file >$(OUT)/shards,$(SHARDS)))@SNAPGEN=$(BIN)/snapgen \
	    $(SHARED)slurm.sh $(if $(in_rounds),rounds,run) $(OUT)/slurm '$(hidden_make)' $(this_makefile) \
	    '$(or $(in_rounds),$(SOURCES))' $(OUT) '$(MODELS)' $(SBATCH_OPTIONS)

.PHONY: on-slurm

else

# ---- Training and models

# The stages, of each model four, by which the programs tell how long all of it takes yet (common/program/stage.h).
# $(call at_stage,NAME): in front of a program. $(call stage_of,NAME): "2/5".
# Of parts of a region the trainings come first.
of_models = $(foreach model,$(MODELS),$(addprefix $(model)-,basis residuals rows $(if $(call unchecked,$(model)),,check)))
stages    = $(if $(PARTS_OF),$(PARTS_OF:%=%-training) $(foreach part,$(PARTS_OF),$(addprefix $(part)-,$(of_models))),training $(of_models))
# $(call unchecked,MODEL): not empty where deimselect does not check it.
unchecked = $(or $(filter no,$($1.CHECK)),$($1.CALIBRATION))
at_stage  = EHDROM_STAGES='$(patsubst %/$(PART),%,$(OUT))/stages $(stage) $(stages)'
stage     = $(PART:%=%-)$1
stage_of  = $(words x $(subst ^, ,$(firstword $(subst ^$(stage)^,^ ,^$(subst $(space),^,$(stages))^))))/$(words $(stages))
space    := $() $()

adaptive = $(if $(ACCURACY),--adaptive)

# $(call snapgen,OUTPUT)
snapgen = $(call at_stage,training) $(BIN)/snapgen $(plan) -o $1 --force --allow-failures $(ALLOW_FAILURES) \
          $(ACCURACY:%=--adaptive --accuracy % --energy $(ENERGY)) $(jobs) \
          $(PARTS_LIST:%=--parts %) $(SNAPGEN_OPTIONS) $(SET)

# $(call resumed,COMMAND): a training that was interrupted goes on, unless it was one of another plan (65).
resumed = code=65; [ ! -e $@.partial ] || { $1 --resume; code=$$?; }; [ $$code -ne 65 ] || { $1; code=$$?; }; exit $$code

trained_on := $(if $(wildcard $(OUT)/plan.stamp),$(OUT)/plan.stamp,plan) $(BIN)/snapgen \
              $(call options,snapshots,$(SET) $(ALLOW_FAILURES) $(ACCURACY))
plan:
	@echo PLAN: found no $(call quoted,$(PLAN)), expected a plan >&2; exit 1
.PHONY: plan

# A region in parts: REGION_PARTS, their names, none for one model. Which there are is known when it has been trained. make
# does that first, unless it only says what it would do or need not know.
asks   := $(if $(MAKECMDGOALS),$(filter-out clean help list names slurm-status,$(MAKECMDGOALS)),yes)
flags  := $(foreach word,$(firstword $(MAKEFLAGS)),$(if $(findstring =,$(word)),,$(filter-out -%,$(word))))
idle   := $(foreach flag,n q t,$(findstring $(flag),$(flags)))
parts  := $(and $(region),$(filter-out 1,$(or $(SPLIT),any)))
ifneq ($(parts),)
ifneq ($(and $(asks),$(if $(strip $(idle)),,yes)),)
include $(OUT)/parts.mk
else
$(eval $(file <$(OUT)/parts.mk))
endif
$(OUT)/parts.mk: $(trained_on) $(call options,split,$(SPLIT) $(ONE_GRID))
	@$(if $(strip $(idle)),echo) $(SHARED)parts.sh '$(MAKE)' $(this_makefile) $(plan) $(OUT) $(BIN)/snapgen '$(SPLIT)' '$(ONE_GRID)' '$^' $(SET)
endif

ifneq ($(REGION_PARTS),)

# Models of the parts, and their list.
$(foreach part,$(REGION_PARTS),$(MODELS:%=$(OUT)/$(part)/%.h5)): FORCE
	@$(MAKE) $(if $(filter 0,$(V)),-s) -f $(this_makefile) PLAN=$(@D).yml OUT=$(@D) SPLIT=1 PART=$(notdir $(@D)) PARTS_OF='$(REGION_PARTS)' $@
FORCE:

$(MODELS:%=$(OUT)/%.yml): $(OUT)/%.yml: $$(addprefix $(OUT)/,$$(addsuffix /$$*.h5,$(REGION_PARTS)))
	@echo 'models: [$(subst $(space),$(,) ,$(patsubst $(OUT)/%,%,$^))]' > $@

else

$(SNAPSHOTS): $(trained_on)
	$(call quiet,$(call stage_of,training) snapgen   ,$@)$(call resumed,$(call snapgen,$@) $(shard))

# A round in parts (slurm.sh): pieces of it; and what takes them over, and chooses the next round or ends the training.
# Where pieces do not fit (65) they are left out, and where the training is of another plan it begins anew. Of one with too
# many failures (3) nothing stays.
pieces      = ls $(OUT)/piece-*.h5 $(OUT)/piece-*.h5.partial 2>/dev/null
drop_pieces = rm -f $(OUT)/piece-*.h5 $(OUT)/piece-*.h5.partial
choose      = $(call snapgen,$(OUT)/snapshots.h5) --choose

$(OUT)/piece-%.h5:
	$(call resumed,$(call snapgen,$@) --chosen-in $(OUT)/snapshots.h5.partial --shard $(subst -of-,/,$*))

next-round:
	pieces=$$($(pieces)); code=65; partial=$(OUT)/snapshots.h5.partial; \
	[ ! -e $$partial ] || { $(choose) $$pieces --resume; code=$$?; }; \
	[ $$code -ne 65 -o -z "$$pieces" -o ! -e $$partial ] || { $(choose) --resume; code=$$?; }; \
	[ $$code -ne 65 ] || { $(choose); code=$$?; }; \
	[ $$code -ne 0 ] || $(drop_pieces); [ $$code -ne 3 ] || rm -f $(OUT)/snapshots.h5; exit $$code

.PHONY: next-round

memory_option = $(MEMORY:%=--memory %)

ifneq ($(PARTS),)
$(SOURCES): $(OUT)/part%: $(OUT)/snapshots% $(BIN)/podbuild $(call options,parts,$(ENERGY))
	$(call quiet,$(call stage_of,training) podbuild  ,$@)$(BIN)/podbuild --compress $< -o $@ --force --energy $(ENERGY) $(memory_option)
endif

podbuild_options   = --deformation $(or $($1.DEFORMATION),coupled) \
                     $(or $($1.PRESSURE_MODES:%=--pressure-modes %),--energy $(ENERGY)) \
                     $($1.DEFORMATION_MODES:%=--deformation-modes %) $($1.WEIGHT:%=--weight %) \
                     $(if $(filter row-norm,$($1.WEIGHT)),--plan $(plan) $(SET))
deimselect_options = --method $(or $($1.METHOD),joint) $($1.ROWS:%=--rows %) \
                     $($1.STABILITY:%=--stability %) $($1.WEIGHTS:%=--weights %) \
                     $(if $(call unchecked,$1),--no-check)

$(MODELS:%=$(OUT)/%-basis.h5): $(OUT)/%-basis.h5: $(SOURCES) $(BIN)/podbuild \
                               $$(call options,$$*-basis,$$(call podbuild_options,$$*))
	$(call quiet,$(call stage_of,$*-basis) podbuild  ,$@)$(call at_stage,$*-basis) $(BIN)/podbuild $(SOURCES) -o $@ --force $(memory_option) $(strip $(call podbuild_options,$*))

$(MODELS:%=$(OUT)/%-residuals.h5): $(OUT)/%-residuals.h5: $(OUT)/%-basis.h5 $(SNAPSHOTS)
	$(call quiet,$(call stage_of,$*-residuals) snapgen   ,$@)$(call at_stage,$*-residuals) $(BIN)/snapgen $(plan) $(adaptive) --basis $< -o $@ --force $(jobs) $(SET)

# A model with nothing to check it on (exit code 4) is a model all the same, and says so in each run.
$(MODELS:%=$(OUT)/%.h5): $(OUT)/%.h5: $(OUT)/%-residuals.h5 $(OUT)/%-basis.h5 $(BIN)/deimselect \
                         $$(call options,$$*,$$(call deimselect_options,$$*))
	$(call quiet,$(call stage_of,$*-rows) deimselect,$@)$(call at_stage,$*-rows) $(BIN)/deimselect $< --basis $(OUT)/$*-basis.h5 -o $@ --force \
	    $(jobs) $(memory_option) $(strip $(call deimselect_options,$*)) || [ $$? -eq 4 ]
	$(if $($*.CALIBRATION),$(call quiet,romrun    ,$@)mv $@ $@.unchecked && \
	    $(BIN)/romrun calibrate $($*.CALIBRATION) --model $@.unchecked -o $@ --quiet $(jobs) $(SET) >/dev/null && rm $@.unchecked)

endif
endif

# ---- What is made of results

# $(call model_file,NAME): a model, or a list of those of parts.
model_file = $(OUT)/$1.$(if $(REGION_PARTS),yml,h5)

# The model of $(OUT)/MODEL/RESULT, for $* of such a target.
of_model = $(firstword $(subst /, ,$*))
