# SPDX-License-Identifier: GPL-3.0-or-later
# Trains reduced models on a plan (training.mk describes PLAN, ACCURACY and other variables). If the folder contains
# cases.csv, it also solves the cases of this table, and makes a table and pictures. This file can be used directly:
#     make -f …/pipeline.mk PLAN=region.yml ACCURACY=1e-3
# A Makefile may set these variables before it includes this file:
#   PROFILES        cases whose pressure and film are drawn: names (`make list`) or numbers; default: the first three
#   PROFILE_RANGES  options of this picture: --x FROM TO, --film LOWEST HIGHEST, --step NODES between marks
#   MAP_CASE        for a point contact: the case that is drawn as a map
#   REPEAT          number of repetitions of a reduced solution, of which the median time is taken; default: 21

include $(or $(wildcard $(dir $(lastword $(MAKEFILE_LIST)))training.mk),$(error $(lastword $(MAKEFILE_LIST)): found blanks in its path, expected none))

ifneq ($(wildcard cases.csv),)

REPEAT ?= 21

# cases.mk sets CASES to the numbers of the cases.
$(OUT)/cases.mk: cases.csv $(SHARED)cases.py
	@numbers=$$($(cases) numbers) && echo "CASES := $$numbers" > $@
include $(OUT)/cases.mk
cases = $(python) $(SHARED)cases.py

# ---- Targets for people

demo: names $(OUT)/comparison.txt $(OUT)/profiles.png \
      $(if $(MAP_CASE),$(OUT)/maps.png) ## train, solve all cases, compare, draw (the default)
	@cat $(OUT)/comparison.txt
	$(call tell_pictures,$(filter %.png,$^))

list: ## names of the cases
	@$(cases) names

# The cases of the pictures are looked up before the training, so that a wrong name is reported at once.
drawn = $(foreach case,$(PROFILES) $(MAP_CASE),$(call quoted,$(case)))
names:
	@$(cases) names $(drawn) >/dev/null

.DEFAULT_GOAL := demo
.PHONY: demo list names

# ---- Cases: $(OUT)/full/NUMBER.h5, $(OUT)/MODEL/NUMBER.h5

# A case that did not converge (exit code 3) or lies outside of the trained range (4) has a result too, and the tables
# show it. The full model uses the grid of the reduced model, so that both solutions can be compared: the grid of the
# training or, if the region has parts, the grid of the reduced solution.
grid_file = $(if $(REGION_PARTS),$(OUT)/$(MODEL)/$(notdir $*).h5,$(firstword $(SNAPSHOTS)))
with_case = $(cases) run $(notdir $*) $(BIN)/$1
outcome   = >/dev/null || [ $$? -eq 3 -o $$? -eq 4 ]

$(CASES:%=$(OUT)/full/%.h5): $(OUT)/%.h5: scene.yml cases.csv $$(grid_file) $(BIN)/fullrun \
                            $(call options,case-fullrun,$(SET))
	$(call quiet,fullrun   ,$@)mkdir -p $(@D) && $(call with_case,fullrun) scene.yml -o $@ --force --quiet \
	    --grid-of $(grid_file) $(jobs) $(SET) $(outcome)

$(foreach model,$(MODELS),$(CASES:%=$(OUT)/$(model)/%.h5)): $(OUT)/%.h5: scene.yml cases.csv $(BIN)/romrun \
        $(call options,case-romrun,$(SET) $(REPEAT)) $$(call model_file,$$(of_model))
	$(call quiet,romrun    ,$@)mkdir -p $(@D) && $(call with_case,romrun) scene.yml -o $@ --force \
	    --model $(call model_file,$(of_model)) --repeat $(REPEAT) --quiet --set output.fields=true $(SET) $(outcome)

# ---- Table and pictures

CASE_RESULTS := $(foreach kind,full $(MODEL),$(CASES:%=$(OUT)/$(kind)/%.h5))

# This rule also writes $(OUT)/results.csv.
$(OUT)/comparison.txt: $(SHARED)compare.py cases.csv $(call model_file,$(MODEL)) $(CASE_RESULTS)
	@$(python) $< table $(OUT) $(call model_file,$(MODEL)) > $@

$(OUT)/profiles.png: $(SHARED)pictures.py cases.csv $(CASE_RESULTS)
	$(call quiet,picture   ,$@)$(python) $< profiles $@ $(OUT) $(MODEL) $(foreach case,$(PROFILES),$(call quoted,$(case))) $(PROFILE_RANGES)

ifneq ($(MAP_CASE),)
$(OUT)/maps.png: $(SHARED)pictures.py cases.csv $(CASE_RESULTS)
	$(call quiet,picture   ,$@)$(python) $< maps $@ $(OUT) $(MODEL) --case=$(call quoted,$(MAP_CASE)) $(MAP_WIDTH:%=--width %)
endif

endif # cases.csv
