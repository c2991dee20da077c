# SPDX-License-Identifier: GPL-3.0-or-later
# From a plan to reduced models: training, bases, row selection. Included by the Makefile of each scene,
# or by pipeline.mk for it; the Makefile says what its models are. Settings of any scene can be given as
# SET='--set key=value ...'.

include $(dir $(lastword $(MAKEFILE_LIST)))common.mk

# Points of the plan that may fail.
ALLOW_FAILURES ?= 0

MODELS ?= model
MODEL  := $(firstword $(MODELS))

# ---- Targets for people

models: $(MODELS:%=$(OUT)/%.h5) ## all models (the default)
.DEFAULT_GOAL := models

.PHONY: models

# ---- Training and models

$(OUT)/snapshots.h5: plan.yml scene.yml $(filter-out cases.csv,$(wildcard *.csv)) $(BIN)/snapgen \
                     $(call options,snapshots,$(SET) $(ALLOW_FAILURES))
	$(call quiet,snapgen   ,$@)$(BIN)/snapgen plan.yml -o $@ --force --allow-failures $(ALLOW_FAILURES) $(SNAPGEN_OPTIONS) $(SET)

podbuild_options   = --deformation $(or $($1.DEFORMATION),coupled) \
                     $($1.PRESSURE_MODES:%=--pressure-modes %) \
                     $($1.DEFORMATION_MODES:%=--deformation-modes %) \
                     $($1.ENERGY:%=--energy %) $($1.WEIGHT:%=--weight %) \
                     $(if $(filter row-norm,$($1.WEIGHT)),--plan plan.yml $(SET))
deimselect_options = --method $(or $($1.METHOD),joint) $($1.ROWS:%=--rows %) $($1.STABILITY:%=--stability %) $($1.WEIGHTS:%=--weights %)

# $(call model_rules,model-NAME,-NAME)
define model_rules
$(OUT)/basis$2.h5: $(OUT)/snapshots.h5 $(BIN)/podbuild $(call options,basis$2,$(call podbuild_options,$1))
	$$(call quiet,podbuild  ,$$@)$(BIN)/podbuild $$< -o $$@ --force $(strip $(call podbuild_options,$1))

$(OUT)/residuals$2.h5: $(OUT)/basis$2.h5 $(OUT)/snapshots.h5
	$$(call quiet,snapgen   ,$$@)$(BIN)/snapgen plan.yml --basis $$< -o $$@ --force $(SET)

$(OUT)/$1.h5: $(OUT)/residuals$2.h5 $(OUT)/basis$2.h5 $(BIN)/deimselect $(call options,$1,$(call deimselect_options,$1))
	$$(call quiet,deimselect,$$@)$(BIN)/deimselect $$< --basis $(OUT)/basis$2.h5 -o $$@ --force $(strip $(call deimselect_options,$1))
endef

$(foreach model,$(MODELS),$(eval $(call model_rules,$(model),$(model:model%=%))))

ifneq ($(wildcard check-plan.yml),)
  include $(SHARED)trade.mk
endif
