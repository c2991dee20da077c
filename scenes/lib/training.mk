# SPDX-License-Identifier: GPL-3.0-or-later
# From a plan to reduced models: training, bases, row selection. A Makefile that includes this may set before:
#   PLAN      what the models are trained on: plan.yml; a list of points, or a region in which they are chosen
#   ACCURACY  solve only as many points of the plan as it takes to be so accurate (1e-3) at all others; empty: all, and
#             of a region as many as 1e-3 takes
#   ENERGY    part of the energy of the training solutions that the modes may leave out: 1e-18, nearly all they tell
#   MODELS    names of the models to make: model. What each is made of, where not by ENERGY alone (podbuild --help,
#             deimselect --help): NAME.PRESSURE_MODES, NAME.DEFORMATION, NAME.DEFORMATION_MODES, NAME.WEIGHT; NAME.ROWS,
#             NAME.METHOD, NAME.WEIGHTS, NAME.STABILITY; NAME.CHECK = no: without a check
#   MEMORY    memory that arrays of podbuild and deimselect may take (--memory of either): half of the machine's
#   PARTS     not empty: each piece of the training is compressed where it was solved, and the modes are those of these parts
#   SLURM     not empty: train on Slurm, with an array of SHARDS tasks (4), in a region one a round, and sbatch's
#             SBATCH_OPTIONS (slurm.sh)

include $(dir $(lastword $(MAKEFILE_LIST)))common.mk

PLAN     ?= plan.yml
ACCURACY ?=
ENERGY   ?= 1e-18
MODELS   ?= model
MODEL    := $(firstword $(MODELS))

# Points of the plan that may fail.
ALLOW_FAILURES ?= 0

# $* is the name of the model, also in what a target needs ($$).
.SECONDEXPANSION:

models: $(MODELS:%=$(OUT)/%.h5) ## all models
	@printf '%s\n' $(patsubst %,'model: %',$(abspath $(MODELS:%=$(OUT)/%.h5)))
.DEFAULT_GOAL := models
.PHONY: models

# Points at a time; empty: as many as there are processors. Changes no result.
SNAPGEN_JOBS ?=

# Not empty where points are chosen, round by round: of a list that is so wanted, and in a region.
chosen := $(strip $(ACCURACY) $(shell grep -s '^[^\#]*region:' $(PLAN)))

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

# ---- On Slurm: the same rules, as jobs

slurm-status: ## state of the training on Slurm (make SLURM=1)
	@$(SHARED)slurm.sh status $(OUT)/slurm $(BIN)/snapgen

.PHONY: slurm-status

ifneq ($(SLURM),)

$(TRAINED): on-slurm ;

# Empty where one task does all.
in_rounds = $(and $(chosen),$(filter-out 1,$(SHARDS)))

# Hidden, because make -n would run a line that has it.
slurm_make = $(MAKE)
on-slurm:
	$(if $(chosen),,$(file >$(OUT)/shards,$(SHARDS)))@SBATCH_OPTIONS='$(SBATCH_OPTIONS)' SNAPGEN=$(BIN)/snapgen \
	    $(SHARED)slurm.sh $(if $(in_rounds),rounds,run) $(OUT)/slurm '$(slurm_make)' '$(firstword $(MAKEFILE_LIST))' \
	    '$(or $(in_rounds),$(SOURCES))' $(OUT) '$(MODELS)'

.PHONY: on-slurm

else

# ---- Training and models

# The stages, of each model four, by which the programs tell how long all of it takes yet (common/program/stage.h).
# $(call at_stage,NAME): in front of a program. $(call stage_of,NAME): "2/5".
stages    = training $(foreach model,$(MODELS),$(addprefix $(model)-,basis residuals rows $(if $(filter no,$($(model).CHECK)),,check)))
at_stage  = EHDROM_STAGES='$(OUT)/stages $1 $(stages)'
stage_of  = $(words x $(subst ^, ,$(firstword $(subst ^$1^,^ ,^$(subst $(space),^,$(stages))^))))/$(words $(stages))
space    := $() $()

adaptive = $(if $(ACCURACY),--adaptive)

# $(call snapgen,OUTPUT)
snapgen = $(call at_stage,training) $(BIN)/snapgen $(PLAN) -o $1 --force --allow-failures $(ALLOW_FAILURES) \
          $(ACCURACY:%=--adaptive --accuracy % --energy $(ENERGY)) $(SNAPGEN_JOBS:%=--jobs %) \
          $(SNAPGEN_OPTIONS) $(SET)

# $(call resumed,COMMAND): a training that was interrupted goes on, unless it was one of another plan (65).
resumed = code=65; [ ! -e $@.partial ] || { $1 --resume; code=$$?; }; [ $$code -ne 65 ] || { $1; code=$$?; }; exit $$code

# The files of scenes that the plan names.
scene_files := $(wildcard $(addprefix $(dir $(PLAN)),$(shell sed -n 's/^[^#]*scene: *\([^ ,}{\#]*\).*/\1/p' $(PLAN))))

$(SNAPSHOTS): $(PLAN) $(scene_files) $(filter-out cases.csv,$(wildcard *.csv)) $(BIN)/snapgen \
              $(call options,snapshots,$(SET) $(ALLOW_FAILURES) $(ACCURACY))
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
                     $(if $(filter row-norm,$($1.WEIGHT)),--plan $(PLAN) $(SET))
deimselect_options = --method $(or $($1.METHOD),joint) $($1.ROWS:%=--rows %) \
                     $($1.STABILITY:%=--stability %) $($1.WEIGHTS:%=--weights %) \
                     $(if $(filter no,$($1.CHECK)),--no-check)

$(MODELS:%=$(OUT)/%-basis.h5): $(OUT)/%-basis.h5: $(SOURCES) $(BIN)/podbuild \
                               $$(call options,$$*-basis,$$(call podbuild_options,$$*))
	$(call quiet,$(call stage_of,$*-basis) podbuild  ,$@)$(call at_stage,$*-basis) $(BIN)/podbuild $(SOURCES) -o $@ --force $(memory_option) $(strip $(call podbuild_options,$*))

$(MODELS:%=$(OUT)/%-residuals.h5): $(OUT)/%-residuals.h5: $(OUT)/%-basis.h5 $(SNAPSHOTS)
	$(call quiet,$(call stage_of,$*-residuals) snapgen   ,$@)$(call at_stage,$*-residuals) $(BIN)/snapgen $(PLAN) $(adaptive) --basis $< -o $@ --force $(SNAPGEN_JOBS:%=--jobs %) $(SET)

# A model with nothing to check it on (exit code 4) is a model all the same, and says so in each run.
$(MODELS:%=$(OUT)/%.h5): $(OUT)/%.h5: $(OUT)/%-residuals.h5 $(OUT)/%-basis.h5 $(BIN)/deimselect \
                         $$(call options,$$*,$$(call deimselect_options,$$*))
	$(call quiet,$(call stage_of,$*-rows) deimselect,$@)$(call at_stage,$*-rows) $(BIN)/deimselect $< --basis $(OUT)/$*-basis.h5 -o $@ --force \
	    $(memory_option) $(strip $(call deimselect_options,$*)) || [ $$? -eq 4 ]

endif

# ---- What is made of results

# The model of $(OUT)/MODEL/RESULT, for $* of such a target.
of_model = $(firstword $(subst /, ,$*))
