# SPDX-License-Identifier: GPL-3.0-or-later
# Reduced models of a plan, and from cases to tables and pictures. Included by the Makefile of each
# stationary scene, which says what its models are (training.mk).

include $(dir $(lastword $(MAKEFILE_LIST)))training.mk

# Times an online solution is repeated for its median time.
REPEAT ?= 21

CASES := $(shell awk -f $(SHARED)case.awk cases.csv)
ifeq ($(CASES),)
  $(error cases.csv: found no cases, expected a line each below the header)
endif

# ---- Targets for people

demo: $(OUT)/$(MODEL).h5 $(CASES:%=$(OUT)/case-%-full.h5) $(CASES:%=$(OUT)/case-%-$(MODEL).h5) \
      $(OUT)/profiles.png ## train, solve all cases, compare, draw
	@$(SHARED)collect.sh $(OUT) full $(MODEL) -- $(CASES) | \
	    awk -f $(SHARED)demo.awk -v model="$$($(SHARED)sizes.sh $(OUT)/$(MODEL).h5)" - cases.csv
	@echo 'picture: $(abspath $(OUT)/profiles.png), .svg'

figures: $(OUT)/tables.txt $(OUT)/profiles.png $(if $(FIGURE3_CASE),$(OUT)/figure3.png) ## tables and figures as published
	@cat $(OUT)/tables.txt
	@printf '%s\n' $(patsubst %,'picture: %',$(abspath $(filter %.png,$^)))

list: ## names of the cases
	@printf '%s\n' $(CASES)

.PHONY: demo figures list

# ---- Cases

# A case that did not converge (exit code 3) or lies outside of the trained range (4) has a result too,
# and the tables show it.
case_run = $1 scene.yml -o $@ --force $2 $(SET) $$(awk -f $(SHARED)case.awk -v want='$*' cases.csv) >/dev/null || \
           [ $$? -eq 3 -o $$? -eq 4 ]

# $(call case_rule,model-NAME)
define case_rule
$(OUT)/case-%-$1.h5: scene.yml $(OUT)/$1.h5 $(BIN)/romrun $(call options,case-romrun,$(SET) $(REPEAT))
	$$(call quiet,romrun    ,$$@)$$(call case_run,$(BIN)/romrun,--model $(OUT)/$1.h5 --repeat $(REPEAT) --set output.fields=true)
endef
$(foreach model,$(MODELS),$(eval $(call case_rule,$(model))))

$(OUT)/case-%-full.h5: scene.yml $(BIN)/fullrun $(call options,case-fullrun,$(SET))
	$(call quiet,fullrun   ,$@)$(call case_run,$(BIN)/fullrun,)

# ---- Tables and pictures

$(OUT)/tables.txt: cases.csv $(SHARED)tables.awk $(MODELS:%=$(OUT)/%.h5) $(CASES:%=$(OUT)/case-%-full.h5) \
                   $(foreach model,$(MODELS),$(CASES:%=$(OUT)/case-%-$(model).h5))
	$(call quiet,tables    ,$@){ \
	    for model in $(MODELS); do echo "size $$model $$($(SHARED)sizes.sh $(OUT)/$$model.h5)"; done; \
	    echo 'size published $(PUBLISHED_SIZES)'; \
	    $(SHARED)collect.sh $(OUT) full $(MODELS) -- $(CASES); \
	} | awk -f $(SHARED)tables.awk -v models='$(MODELS)' - cases.csv > $@

PROFILES := $(foreach case,$(or $(PROFILE_CASES),$(firstword $(CASES))),$(OUT)/case-$(case))

$(OUT)/profiles.png: plot.gp $(SHARED)profiles.gp $(PROFILES:%=%-full.h5) $(PROFILES:%=%-$(MODEL).h5)
	$(call quiet,gnuplot   ,$@)for result in $(filter %.h5,$^); do \
	    $(SHARED)profile.sh $$result > $${result%.h5}.dat || exit; \
	done; \
	gnuplot -e 'shared="$(SHARED)"; picture="$(basename $@)"; cases="$(PROFILES)"; model="$(MODEL)"' plot.gp

# ---- Figure 3: each point is a model of its own

fixed_pressure    := $(word 1,$(FIGURE3_FIXED))
fixed_deformation := $(word 2,$(FIGURE3_FIXED))
FIGURE3_POINTS    := $(FIGURE3_PRESSURE_MODES:%=coupled-%-0) \
                     $(FIGURE3_PRESSURE_MODES:%=independent-%-$(fixed_deformation)) \
                     $(FIGURE3_DEFORMATION_MODES:%=independent-$(fixed_pressure)-%)
FIGURE3_FILES     := $(sort $(FIGURE3_POINTS:%=$(OUT)/figure3-%.txt))

$(OUT)/figure3-%.txt: $(OUT)/snapshots.h5 $(OUT)/case-$(FIGURE3_CASE)-full.h5 $(SHARED)figure3.sh $(BIN)/romrun $(BIN)/deimselect
	$(call quiet,figure 3  ,$*)BIN=$(BIN) $(SHARED)figure3.sh $(OUT) $* $(FIGURE3_CASE) \
	    "$(SET) $$(awk -f $(SHARED)case.awk -v want='$(FIGURE3_CASE)' cases.csv)" '$(SET)' > $@

$(OUT)/figure3.png: $(FIGURE3_FILES) $(SHARED)figure3.gp cases.csv
	@cat $(FIGURE3_FILES) > $(OUT)/figure3.dat
	$(call quiet,gnuplot   ,$@)gnuplot -e 'data="$(OUT)/figure3.dat"; picture="$(basename $@)"' \
	    -e 'fixed_pressure=$(fixed_pressure); fixed_deformation=$(fixed_deformation)' \
	    -e "$$(awk -f $(SHARED)case.awk -v want='$(FIGURE3_CASE)' -v plot=1 cases.csv)" \
	    -e 'published_pressure=$(or $(word 5,$(PUBLISHED_SIZES)),0); published_deformation=$(or $(word 6,$(PUBLISHED_SIZES)),0)' \
	    $(SHARED)figure3.gp
