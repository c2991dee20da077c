# SPDX-License-Identifier: GPL-3.0-or-later
# Tables and figure 3 as published, of the stationary line contact in both regions. Included behind pipeline.mk.

PUBLISHED := $(dir $(lastword $(MAKEFILE_LIST)))

figures: $(OUT)/tables.txt $(OUT)/profiles.png $(if $(FIGURE3_CASE),$(OUT)/figure3.png) ## tables and figures as published
	@cat $(OUT)/tables.txt
	@printf '%s\n' $(patsubst %,'picture: %',$(abspath $(filter %.png,$^)))

.PHONY: figures

$(OUT)/tables.txt: cases.csv $(PUBLISHED)tables.awk $(MODELS:%=$(OUT)/%.h5) $(CASES:%=$(OUT)/full/%.h5) \
                   $(foreach model,$(MODELS),$(CASES:%=$(OUT)/$(model)/%.h5))
	$(call quiet,tables    ,$@){ \
	    for model in $(MODELS); do echo "size $$model $$($(SHARED)model.sh $(OUT)/$$model.h5)"; done; \
	    echo 'size published $(PUBLISHED_SIZES)'; \
	    $(SHARED)collect.sh $(OUT) full $(MODELS) -- $(CASES); \
	} | awk -f $(SHARED)common.awk -f $(PUBLISHED)tables.awk -v models='$(MODELS)' - cases.csv > $@

# ---- Figure 3: each point is a model of its own

fixed_pressure    := $(word 1,$(FIGURE3_FIXED))
fixed_deformation := $(word 2,$(FIGURE3_FIXED))
FIGURE3_POINTS    := $(FIGURE3_PRESSURE_MODES:%=coupled-%-0) \
                     $(FIGURE3_PRESSURE_MODES:%=independent-%-$(fixed_deformation)) \
                     $(FIGURE3_DEFORMATION_MODES:%=independent-$(fixed_pressure)-%)
FIGURE3_FILES     := $(sort $(FIGURE3_POINTS:%=$(OUT)/figure3-%.txt))
figure3_settings   = $$(awk -f $(SHARED)case.awk -v want='$(FIGURE3_CASE)' cases.csv)

$(OUT)/figure3-%.txt: $(OUT)/snapshots.h5 $(OUT)/full/$(FIGURE3_CASE).h5 $(PUBLISHED)figure3.sh $(BIN)/romrun $(BIN)/deimselect
	$(call quiet,figure 3  ,$*)$(PUBLISHED)figure3.sh $(OUT) $* $(FIGURE3_CASE) "$(SET) $(figure3_settings)" '$(SET)' > $@

published_deviation = $(shell awk -F, '$$1 == "$(FIGURE3_CASE)" && $$12 != "" { print $$12 }' cases.csv)

$(OUT)/figure3.png: $(FIGURE3_FILES) $(PUBLISHED)figure3.gp cases.csv
	@cat $(FIGURE3_FILES) > $(OUT)/figure3.dat
	$(call quiet,gnuplot   ,$@)$(plot) -e 'data="$(OUT)/figure3.dat"; published_deviation=$(or $(published_deviation),NaN)' \
	    -e 'fixed_pressure=$(fixed_pressure); fixed_deformation=$(fixed_deformation)' \
	    -e "case_title=\"$$(awk -f $(SHARED)case.awk -v want='$(FIGURE3_CASE)' -v title=1 cases.csv)\"" \
	    -e 'published_pressure=$(or $(word 2,$(PUBLISHED_SIZES)),0); published_deformation=$(or $(word 3,$(PUBLISHED_SIZES)),0)' \
	    $(PUBLISHED)figure3.gp
