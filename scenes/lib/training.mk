# SPDX-License-Identifier: GPL-3.0-or-later
# Makes reduced models from a plan: training, bases, row selection. A Makefile may set these variables before it
# includes this file:
#   PLAN      training points: a list, or a region in which points are chosen; default: plan.yml
#   ACCURACY  wanted accuracy, such as 1e-3: only as many points are solved as the model needs to have it at all other
#             points. If it is empty, all points are solved, in a region as many as 1e-3 needs. Histories are all
#             solved.
#   ENERGY    part of the energy of the training solutions that the modes may leave out; default: 1e-18, nearly nothing
#   MODELS    names of the models; default: model. Options of the model NAME (podbuild --help, deimselect --help), if
#             ENERGY alone does not determine it: NAME.PRESSURE_MODES, NAME.DEFORMATION, NAME.DEFORMATION_MODES,
#             NAME.WEIGHT; NAME.ROWS, NAME.METHOD, NAME.WEIGHTS, NAME.STABILITY. NAME.CHECK = no omits the check.
#             NAME.CALIBRATION is a plan for romrun calibrate, which then replaces the check (for oils that are not
#             trained).
#   JOBS      points that are solved at a time, and threads of the other programs; empty: one for each processor. JOBS
#             does not change results.
#   MEMORY    memory for the arrays of podbuild and deimselect (--memory); default: half of the machine's memory
#   PARTS     not empty: each piece of the training is compressed where it was solved, and the modes are computed from
#             the compressed pieces
#   SPLIT     number of parts of a region, each with its own model; OUT/NAME.yml lists the models (schemas/models.md).
#             Empty: one, but if the region is too wide for one model, the training finds the number (parts.sh).
#   ONE_GRID  not empty: all parts have the grid that the whole region needs, as contacts in time and FMUs require.
#             Parts of point contacts and ellipses always have this grid.
#   SLURM     not empty: the training runs on Slurm, as an array of SHARDS tasks (default: 4; in a region one array a
#             round) with the sbatch options SBATCH_OPTIONS (slurm.sh)

PLAN     ?= plan.yml

include $(or $(wildcard $(dir $(lastword $(MAKEFILE_LIST)))common.mk),$(error $(lastword $(MAKEFILE_LIST)): found blanks in its path, expected none))

ACCURACY ?=
ENERGY   ?= 1e-18
MODELS   ?= model
MODEL    := $(firstword $(MODELS))

# The main makefile, for calls of make in rules, and the plan, each as one word of the shell.
this_makefile := $(call one_word,$(firstword $(MAKEFILE_LIST)))
plan          := $(call one_word,$(PLAN))

# For each part of a region make is called again, in the folder of the part: PART is the name of the part, PARTS_OF are
# the names of all parts.
PART ?=
PARTS_OF ?=
ifneq ($(PART),)
override SET += $(call words_of,$(file <$(dir $(OUT))parts-grid.txt))
endif

# Number of points of the plan that may fail.
ALLOW_FAILURES ?= 0

# With second expansion ($$), prerequisites can use $*, which is the name of the model.
.SECONDEXPANSION:

models: $$(foreach model,$$(MODELS),$$(call model_file,$$(model))) ## all models
	$(call tell,model,$(foreach model,$(MODELS),$(call model_file,$(model))))
.DEFAULT_GOAL := models
.PHONY: models

# Which of the words `region` and `histories` apply to the plan (plan.sh). plan.stamp has the time of the newest file
# that the training reads.
planned := $(shell $(SHARED)plan.sh $(plan) $(OUT)/plan.stamp)

# region: not empty if the plan has a region. chosen: not empty if the training chooses points round by round: in a
# region, and with ACCURACY in a list of points. Trajectories of histories are all solved.
region := $(if $(PART),yes,$(filter region,$(planned)))
chosen := $(if $(filter histories,$(planned)),,$(strip $(ACCURACY) $(region)))

# Only a region has parts, and they are not trained on Slurm.
ifneq ($(filter-out 1,$(SPLIT)),)
ifneq ($(if $(region),$(SLURM),no),)
$(error SPLIT: found $(SPLIT) $(if $(region),on Slurm,for a plan without a region), expected 1)
endif
endif

# The training can be solved in SHARDS pieces, each of which is a file. Together they agree with a training in one piece
# to the last bit. A training on Slurm stays in pieces. If points are chosen, the pieces are those of a round, and one
# file collects the solutions of all rounds.
SLURM  ?=
SHARDS ?= $(or $(if $(chosen),,$(file <$(OUT)/shards)),$(if $(SLURM),4,1))
SBATCH_OPTIONS ?=

SNAPSHOTS := $(if $(or $(chosen),$(filter 1,$(SHARDS))),$(OUT)/snapshots.h5,$(patsubst %,$(OUT)/snapshots-%-of-$(SHARDS).h5,$(shell seq $(SHARDS))))
shard      = $(if $(or $(chosen),$(filter 1,$(SHARDS))),,--shard $(word 2,$(subst -, ,$(notdir $@)))/$(SHARDS))

# The files from which the modes are computed.
MEMORY ?=
PARTS  ?=
SOURCES := $(if $(PARTS),$(SNAPSHOTS:$(OUT)/snapshots%=$(OUT)/part%),$(SNAPSHOTS))

TRAINED := $(sort $(SNAPSHOTS) $(SOURCES)) $(foreach model,$(MODELS),$(model:%=$(OUT)/%-basis.h5) $(model:%=$(OUT)/%-residuals.h5) $(model:%=$(OUT)/%.h5))

# make -n runs each line that contains $(MAKE). It does not run lines that contain $(hidden_make).
hidden_make = $(MAKE)

# ---- On Slurm: the same rules run as jobs

slurm-status: ## state of the training on Slurm (make SLURM=1)
	@$(SHARED)slurm.sh status $(OUT)/slurm $(BIN)/snapgen

.PHONY: slurm-status

ifneq ($(SLURM),)

$(TRAINED): on-slurm ;

# Not empty if points are chosen and more than one task solves them.
in_rounds = $(and $(chosen),$(filter-out 1,$(SHARDS)))

on-slurm:
	$(if $(chosen),,$(file >$(OUT)/shards,$(SHARDS)))@SNAPGEN=$(BIN)/snapgen \
	    $(SHARED)slurm.sh $(if $(in_rounds),rounds,run) $(OUT)/slurm '$(hidden_make)' $(this_makefile) \
	    '$(or $(in_rounds),$(SOURCES))' $(OUT) '$(MODELS)' $(SBATCH_OPTIONS)

.PHONY: on-slurm

else

# ---- Training and models

# Stages: the training, and four for each model (three if it is not checked). The programs use the list of stages to
# estimate the remaining time of the whole pipeline (common/program/stage.h). $(call at_stage,NAME) stands in front of a
# program; $(call stage_of,NAME) is a text such as "2/5". If a region has parts, the trainings of all parts come first.
of_models = $(foreach model,$(MODELS),$(addprefix $(model)-,basis residuals rows $(if $(call unchecked,$(model)),,check)))
stages    = $(if $(PARTS_OF),$(PARTS_OF:%=%-training) $(foreach part,$(PARTS_OF),$(addprefix $(part)-,$(of_models))),training $(of_models))
# $(call unchecked,MODEL): not empty if deimselect does not check the model.
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

# $(call resumed,COMMAND): continues an interrupted training. If it was of another plan (exit code 65), starts again.
resumed = code=65; [ ! -e $@.partial ] || { $1 --resume; code=$$?; }; [ $$code -ne 65 ] || { $1; code=$$?; }; exit $$code

trained_on := $(if $(wildcard $(OUT)/plan.stamp),$(OUT)/plan.stamp,plan) $(BIN)/snapgen \
              $(call options,snapshots,$(SET) $(ALLOW_FAILURES) $(ACCURACY))
plan:
	@echo PLAN: found no $(call quoted,$(PLAN)), expected a plan >&2; exit 1
.PHONY: plan

# REGION_PARTS are the names of the parts of a region; it is empty if there is one model. The names are known only after
# the training, so make trains first and then reads the names from parts.mk. It does not train if it only prints what it
# would do (-n, -q, -t), or if its goals do not need the names.
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

# The models of the parts, and the list of these models.
$(foreach part,$(REGION_PARTS),$(MODELS:%=$(OUT)/$(part)/%.h5)): FORCE
	@$(MAKE) $(if $(filter 0,$(V)),-s) -f $(this_makefile) PLAN=$(@D).yml OUT=$(@D) SPLIT=1 PART=$(notdir $(@D)) PARTS_OF='$(REGION_PARTS)' $@
FORCE:

$(MODELS:%=$(OUT)/%.yml): $(OUT)/%.yml: $$(addprefix $(OUT)/,$$(addsuffix /$$*.h5,$(REGION_PARTS)))
	@echo 'models: [$(subst $(space),$(,) ,$(patsubst $(OUT)/%,%,$^))]' > $@

else

$(SNAPSHOTS): $(trained_on)
	$(call quiet,$(call stage_of,training) snapgen   ,$@)$(call resumed,$(call snapgen,$@) $(shard))

# Rules for a round of the training on Slurm (slurm.sh). Each piece of the round solves some of the chosen points.
# next-round collects the pieces, and then chooses the points of the next round or ends the training. It leaves out
# pieces that do not belong to the training (exit code 65). If the training is of another plan, it starts again. If too
# many points fail (exit code 3), it leaves no file.
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

# If there are no points to check the model on (exit code 4), the model is kept. romrun then trusts none of its results.
$(MODELS:%=$(OUT)/%.h5): $(OUT)/%.h5: $(OUT)/%-residuals.h5 $(OUT)/%-basis.h5 $(BIN)/deimselect \
                         $$(call options,$$*,$$(call deimselect_options,$$*))
	$(call quiet,$(call stage_of,$*-rows) deimselect,$@)$(call at_stage,$*-rows) $(BIN)/deimselect $< --basis $(OUT)/$*-basis.h5 -o $@ --force \
	    $(jobs) $(memory_option) $(strip $(call deimselect_options,$*)) || [ $$? -eq 4 ]
	$(if $($*.CALIBRATION),$(call quiet,romrun    ,$@)mv $@ $@.unchecked && \
	    $(BIN)/romrun calibrate $($*.CALIBRATION) --model $@.unchecked -o $@ --quiet $(jobs) $(SET) >/dev/null && rm $@.unchecked)

endif
endif

# ---- Names of models in rules

# $(call model_file,NAME): the file of a model or, if the region has parts, of the list of their models.
model_file = $(OUT)/$1.$(if $(REGION_PARTS),yml,h5)

# The name MODEL in the $* of a target $(OUT)/MODEL/RESULT.
of_model = $(firstword $(subst /, ,$*))
