# SPDX-License-Identifier: GPL-3.0-or-later
# From a plan to reduced models: training, bases, row selection. A Makefile that includes this may set before:
#   PLAN      what the models are trained on: plan.yml
#   ACCURACY  solve only as many points of the plan as it takes to be so accurate (1e-3) at all others; empty: all
#   ENERGY    part of the energy of the training solutions that the modes may leave out: 1e-18, nearly all they tell
#   MODELS    names of the models to make: model. What each is made of, where not by ENERGY alone (podbuild --help,
#             deimselect --help): NAME.PRESSURE_MODES, NAME.DEFORMATION, NAME.DEFORMATION_MODES, NAME.WEIGHT; NAME.ROWS,
#             NAME.METHOD, NAME.WEIGHTS, NAME.STABILITY

include $(dir $(lastword $(MAKEFILE_LIST)))common.mk

PLAN     ?= plan.yml
ACCURACY ?=
ENERGY   ?= 1e-18
MODELS   ?= model
MODEL    := $(firstword $(MODELS))

# Points of the plan that may fail.
ALLOW_FAILURES ?= 0

models: $(MODELS:%=$(OUT)/%.h5) ## all models
.DEFAULT_GOAL := models
.PHONY: models

# ---- Training and models

adaptive = $(if $(ACCURACY),--adaptive)

# An interrupted training goes on, unless it was one of another plan (65).
snapgen = $(BIN)/snapgen $(PLAN) -o $@ --force --allow-failures $(ALLOW_FAILURES) \
          $(ACCURACY:%=--adaptive --accuracy % --energy $(ENERGY)) $(SNAPGEN_OPTIONS) $(SET)
snapgen_or_resume = code=65; [ ! -e $@.partial ] || { $(snapgen) --resume; code=$$?; }; \
                    [ $$code -ne 65 ] || { $(snapgen); code=$$?; }; exit $$code

$(OUT)/snapshots.h5: $(PLAN) scene.yml $(filter-out cases.csv,$(wildcard *.csv)) $(BIN)/snapgen \
                     $(call options,snapshots,$(SET) $(ALLOW_FAILURES) $(ACCURACY))
	$(call quiet,snapgen   ,$@)$(snapgen_or_resume)

podbuild_options   = --deformation $(or $($1.DEFORMATION),coupled) \
                     $(or $($1.PRESSURE_MODES:%=--pressure-modes %),--energy $(ENERGY)) \
                     $($1.DEFORMATION_MODES:%=--deformation-modes %) $($1.WEIGHT:%=--weight %) \
                     $(if $(filter row-norm,$($1.WEIGHT)),--plan $(PLAN) $(SET))
deimselect_options = --method $(or $($1.METHOD),joint) $($1.ROWS:%=--rows %) \
                     $($1.STABILITY:%=--stability %) $($1.WEIGHTS:%=--weights %)

# $* is the name of the model, also in what a target needs ($$).
.SECONDEXPANSION:

$(MODELS:%=$(OUT)/%-basis.h5): $(OUT)/%-basis.h5: $(OUT)/snapshots.h5 $(BIN)/podbuild \
                               $$(call options,$$*-basis,$$(call podbuild_options,$$*))
	$(call quiet,podbuild  ,$@)$(BIN)/podbuild $< -o $@ --force $(strip $(call podbuild_options,$*))

$(MODELS:%=$(OUT)/%-residuals.h5): $(OUT)/%-residuals.h5: $(OUT)/%-basis.h5 $(OUT)/snapshots.h5
	$(call quiet,snapgen   ,$@)$(BIN)/snapgen $(PLAN) $(adaptive) --basis $< -o $@ --force --allow-failures $(ALLOW_FAILURES) $(SET)

$(MODELS:%=$(OUT)/%.h5): $(OUT)/%.h5: $(OUT)/%-residuals.h5 $(OUT)/%-basis.h5 $(BIN)/deimselect \
                         $$(call options,$$*,$$(call deimselect_options,$$*))
	$(call quiet,deimselect,$@)$(BIN)/deimselect $< --basis $(OUT)/$*-basis.h5 -o $@ --force \
	    $(strip $(call deimselect_options,$*))

# ---- What is made of results

# The model of $(OUT)/MODEL/RESULT, for $* of such a target.
of_model = $(firstword $(subst /, ,$*))
