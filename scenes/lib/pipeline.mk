# SPDX-License-Identifier: GPL-3.0-or-later
# From a plan to reduced models (training.mk, which see for PLAN, ACCURACY and more), and from the cases of cases.csv to a
# table and pictures. A Makefile that includes this may set before:
#   PROFILES        names of the cases (`make list`) whose pressure and film are drawn: the first three
#   PROFILE_RANGES  commands of gnuplot for that picture (profiles.gp)
#   MAP_CASE        of a point contact: the case that is drawn as a map
#   REPEAT          times that a reduced solution is repeated for its median time: 21

include $(dir $(lastword $(MAKEFILE_LIST)))training.mk

REPEAT ?= 21

CASES := $(shell awk -f $(SHARED)case.awk cases.csv)
ifeq ($(CASES),)
  $(error cases.csv: found no cases, expected a line each below the header)
endif

# ---- Targets for people

demo: names $(OUT)/comparison.txt $(OUT)/profiles.png $(if $(MAP_CASE),$(OUT)/maps.png) ## train, solve all cases, compare, draw (the default)
	@cat $(OUT)/comparison.txt
	@printf '%s\n' $(patsubst %,'picture: %$(,) .svg',$(abspath $(filter %.png,$^)))
, := ,

list: ## names of the cases
	@printf '%s\n' $(CASES)

unknown := $(filter-out $(CASES),$(PROFILES) $(MAP_CASE))
names:
	@[ -z '$(unknown)' ] || { echo 'PROFILES, MAP_CASE: found $(unknown), expected names of cases.csv: $(CASES)' >&2; exit 1; }

.DEFAULT_GOAL := demo
.PHONY: demo list names

# ---- Cases: $(OUT)/full/CASE.h5, $(OUT)/MODEL/CASE.h5

# A case that did not converge (exit code 3) or lies outside of the trained range (4) has a result too,
# and the tables show it.
settings = $(SET) $$(awk -f $(SHARED)case.awk -v want='$(notdir $*)' cases.csv)
outcome  = >/dev/null || [ $$? -eq 3 -o $$? -eq 4 ]

$(CASES:%=$(OUT)/full/%.h5): $(OUT)/%.h5: scene.yml cases.csv $(BIN)/fullrun $(call options,case-fullrun,$(SET))
	$(call quiet,fullrun   ,$@)mkdir -p $(@D) && $(BIN)/fullrun scene.yml -o $@ --force --quiet $(settings) $(outcome)

$(foreach model,$(MODELS),$(CASES:%=$(OUT)/$(model)/%.h5)): $(OUT)/%.h5: scene.yml cases.csv $(BIN)/romrun \
        $(call options,case-romrun,$(SET) $(REPEAT)) $(OUT)/$$(of_model).h5
	$(call quiet,romrun    ,$@)mkdir -p $(@D) && $(BIN)/romrun scene.yml -o $@ --force --model $(OUT)/$(of_model).h5 --repeat $(REPEAT) \
	    --quiet --set output.fields=true $(settings) $(outcome)

# ---- Table and pictures

# Also $(OUT)/results.csv.
$(OUT)/comparison.txt: cases.csv $(OUT)/$(MODEL).h5 $(CASES:%=$(OUT)/full/%.h5) $(CASES:%=$(OUT)/$(MODEL)/%.h5)
	@{ echo "size $(MODEL) $$($(SHARED)model.sh $(OUT)/$(MODEL).h5)"; \
	    for case in $(CASES); do \
	        $(BIN)/fullrun --print $(OUT)/full/$$case.h5 film_unit 2>/dev/null | sed -n "2s/^/unit $$case /p"; \
	        $(BIN)/fullrun --print $(OUT)/full/$$case.h5 inlet_effect step_effect 2>/dev/null | \
	            sed -n "2 { s/,/ /; s/^/grid $$case /p; }"; \
	    done; \
	    $(SHARED)collect.sh $(OUT) full $(MODEL) -- $(CASES); \
	} | awk -f $(SHARED)common.awk -f $(SHARED)compare.awk -v cases='$(CASES)' -v csv=$(OUT)/results.csv - cases.csv > $@

DRAWN := $(or $(filter $(CASES),$(PROFILES)),$(wordlist 1,3,$(CASES)))

$(OUT)/profiles.png: $(SHARED)profiles.gp cases.csv $(DRAWN:%=$(OUT)/full/%.h5) $(DRAWN:%=$(OUT)/$(MODEL)/%.h5)
	$(call quiet,gnuplot   ,$@)for result in $(filter %.h5,$^); do $(call profile,$$result) > $${result%.h5}.dat || exit; done; \
	$(plot) -e 'out="$(OUT)"; cases="$(DRAWN)"; model="$(MODEL)"; $(PROFILE_RANGES)' $<

ifneq ($(MAP_CASE),)
$(OUT)/maps.png: $(SHARED)maps.gp $(SHARED)map.sh cases.csv $(OUT)/full/$(MAP_CASE).h5 $(OUT)/$(MODEL)/$(MAP_CASE).h5
	$(call quiet,gnuplot   ,$@)for kind in full $(MODEL); do \
	    $(SHARED)map.sh $(OUT)/$$kind/$(MAP_CASE).h5 > $(OUT)/map-$$kind.map || exit; \
	done; \
	$(plot) $(MAP_WIDTH:%=-e "width=%") -e 'case="$(OUT)/map"; model="$(MODEL)"' \
	    -e "heading=\"$$(awk -f $(SHARED)case.awk -v want='$(MAP_CASE)' -v title=1 cases.csv)\"" $<
endif
