# SPDX-License-Identifier: GPL-3.0-or-later
# From a plan to reduced models (training.mk, which see for PLAN, ACCURACY and more), and from the cases of cases.csv,
# where there are any, to a table and pictures. It may be used as it is:
#     make -f …/pipeline.mk PLAN=region.yml ACCURACY=1e-3
# A Makefile that includes this may set before:
#   PROFILES        cases (names as in `make list`, or numbers) whose pressure and film are drawn: the first three
#   PROFILE_RANGES  options for that picture: --x FROM TO, --film LOWEST HIGHEST, --step NODES between marks
#   MAP_CASE        of a point contact: the case that is drawn as a map
#   REPEAT          times that a reduced solution is repeated for its median time: 21

include $(or $(wildcard $(dir $(lastword $(MAKEFILE_LIST)))training.mk),$(error $(lastword $(MAKEFILE_LIST)): found blanks in its path, expected none))

ifneq ($(wildcard cases.csv),)

REPEAT ?= 21

# CASES, their numbers.
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

# Those of the pictures are looked up before the training.
drawn = $(foreach case,$(PROFILES) $(MAP_CASE),$(call quoted,$(case)))
names:
	@$(cases) names $(drawn) >/dev/null

.DEFAULT_GOAL := demo
.PHONY: demo list names

# ---- Cases: $(OUT)/full/NUMBER.h5, $(OUT)/MODEL/NUMBER.h5

# A case that did not converge (exit code 3) or lies outside of the trained range (4) has a result too,
# and the tables show it. Full solutions are on the grid of the training, of a part that of its reduced solution, to be
# compared on the same.
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

# Also $(OUT)/results.csv.
$(OUT)/comparison.txt: $(SHARED)compare.py cases.csv $(call model_file,$(MODEL)) $(CASE_RESULTS)
	@$(python) $< table $(OUT) $(call model_file,$(MODEL)) > $@

$(OUT)/profiles.png: $(SHARED)pictures.py cases.csv $(CASE_RESULTS)
	$(call quiet,picture   ,$@)$(python) $< profiles $@ $(OUT) $(MODEL) $(foreach case,$(PROFILES),$(call quoted,$(case))) $(PROFILE_RANGES)

ifneq ($(MAP_CASE),)
$(OUT)/maps.png: $(SHARED)pictures.py cases.csv $(CASE_RESULTS)
	$(call quiet,picture   ,$@)$(python) $< maps $@ $(OUT) $(MODEL) --case=$(call quoted,$(MAP_CASE)) $(MAP_WIDTH:%=--width %)
endif

endif # cases.csv
