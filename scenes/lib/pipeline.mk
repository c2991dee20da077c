# SPDX-License-Identifier: GPL-3.0-or-later
# From a plan to reduced models (training.mk, which see for PLAN, ACCURACY and more), and from the cases of cases.csv,
# where there are any, to a table and pictures. It may be used as it is:
#     make -f …/pipeline.mk PLAN=region.yml ACCURACY=1e-3
# A Makefile that includes this may set before:
#   PROFILES        names of the cases (`make list`) whose pressure and film are drawn: the first three
#   PROFILE_RANGES  options for that picture: --x FROM TO, --film LOWEST HIGHEST, --step NODES between marks
#   MAP_CASE        of a point contact: the case that is drawn as a map
#   REPEAT          times that a reduced solution is repeated for its median time: 21

include $(dir $(lastword $(MAKEFILE_LIST)))training.mk

ifneq ($(wildcard cases.csv),)

REPEAT ?= 21

# CASES, their names, and the options of each.
$(OUT)/cases.mk: cases.csv $(SHARED)compare.py
	@$(python) $(SHARED)compare.py cases > $@
include $(OUT)/cases.mk

# ---- Targets for people

demo: names $(OUT)/comparison.txt $(OUT)/profiles.png \
      $(if $(MAP_CASE),$(OUT)/maps.png) ## train, solve all cases, compare, draw (the default)
	@cat $(OUT)/comparison.txt
	@printf '%s\n' $(patsubst %,'picture: %$(,) .svg',$(abspath $(filter %.png,$^)))
, := ,

list: ## names of the cases
	@printf '%s\n' $(CASES)

unknown := $(filter-out $(CASES),$(PROFILES) $(MAP_CASE))
names:
	@[ -z '$(unknown)' ] || \
	    { echo 'PROFILES, MAP_CASE: found $(unknown), expected names of cases.csv: $(CASES)' >&2; exit 1; }

.DEFAULT_GOAL := demo
.PHONY: demo list names

# ---- Cases: $(OUT)/full/CASE.h5, $(OUT)/MODEL/CASE.h5

# A case that did not converge (exit code 3) or lies outside of the trained range (4) has a result too,
# and the tables show it. Full solutions are on the grid of the training, to be compared on the same.
settings = $(SET) $(settings.$(notdir $*))
outcome  = >/dev/null || [ $$? -eq 3 -o $$? -eq 4 ]

$(CASES:%=$(OUT)/full/%.h5): $(OUT)/%.h5: scene.yml cases.csv $(firstword $(SNAPSHOTS)) $(BIN)/fullrun \
                            $(call options,case-fullrun,$(SET))
	$(call quiet,fullrun   ,$@)mkdir -p $(@D) && $(BIN)/fullrun scene.yml -o $@ --force --quiet \
	    --grid-of $(firstword $(SNAPSHOTS)) $(settings) $(outcome)

$(foreach model,$(MODELS),$(CASES:%=$(OUT)/$(model)/%.h5)): $(OUT)/%.h5: scene.yml cases.csv $(BIN)/romrun \
        $(call options,case-romrun,$(SET) $(REPEAT)) $(OUT)/$$(of_model).h5
	$(call quiet,romrun    ,$@)mkdir -p $(@D) && $(BIN)/romrun scene.yml -o $@ --force \
	    --model $(OUT)/$(of_model).h5 --repeat $(REPEAT) --quiet --set output.fields=true $(settings) $(outcome)

# ---- Table and pictures

# Also $(OUT)/results.csv.
$(OUT)/comparison.txt: $(SHARED)compare.py cases.csv $(OUT)/$(MODEL).h5 \
                       $(foreach kind,full $(MODEL),$(CASES:%=$(OUT)/$(kind)/%.h5))
	@$(python) $< table $(OUT) $(MODEL) > $@

DRAWN := $(or $(filter $(CASES),$(PROFILES)),$(wordlist 1,3,$(CASES)))

$(OUT)/profiles.png: $(SHARED)pictures.py cases.csv $(DRAWN:%=$(OUT)/full/%.h5) $(DRAWN:%=$(OUT)/$(MODEL)/%.h5)
	$(call quiet,picture   ,$@)$(python) $< profiles $@ $(OUT) $(MODEL) $(DRAWN) $(PROFILE_RANGES)

ifneq ($(MAP_CASE),)
$(OUT)/maps.png: $(SHARED)pictures.py cases.csv $(OUT)/full/$(MAP_CASE).h5 $(OUT)/$(MODEL)/$(MAP_CASE).h5
	$(call quiet,picture   ,$@)$(python) $< maps $@ $(filter %.h5,$^) --case $(MAP_CASE) $(MAP_WIDTH:%=--width %)
endif

endif # cases.csv
