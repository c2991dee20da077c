# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the tables and figure 3 of the paper for the stationary line contact in both regions. Include this file after
# pipeline.mk.

figures: $(OUT)/tables.txt $(OUT)/profiles.png \
         $(if $(FIGURE3_CASE),$(OUT)/figure3.png) ## tables and figures as published
	@cat $(OUT)/tables.txt
	$(call tell_pictures,$(filter %.png,$^))

.PHONY: figures

$(OUT)/tables.txt: $(SHARED)published.py cases.csv $(MODELS:%=$(OUT)/%.h5) \
                   $(foreach kind,full $(MODELS),$(CASES:%=$(OUT)/$(kind)/%.h5))
	$(call quiet,tables    ,$@)$(python) $< tables $(OUT) '$(PUBLISHED_SIZES)' $(MODELS) > $@

# ---- Figure 3: each point is a separate model

FIGURE3_POINTS := $(FIGURE3_PRESSURE_MODES:%=coupled-%-0) \
                  $(FIGURE3_PRESSURE_MODES:%=independent-%-$(lastword $(FIGURE3_FIXED))) \
                  $(FIGURE3_DEFORMATION_MODES:%=independent-$(firstword $(FIGURE3_FIXED))-%)
FIGURE3_FILES  := $(sort $(FIGURE3_POINTS:%=$(OUT)/figure3-%.txt))

$(OUT)/figure3-%.txt: $(SHARED)published.py $(OUT)/snapshots.h5 $(CASES:%=$(OUT)/full/%.h5) $(BIN)/romrun $(BIN)/deimselect
	$(call quiet,figure 3  ,$*)$(python) $< point $(OUT) $* $(FIGURE3_CASE) $(SET) > $@

$(OUT)/figure3.png: $(SHARED)published.py $(SHARED)pictures.py cases.csv $(FIGURE3_FILES)
	$(call quiet,picture   ,$@)$(python) $< figure3 $@ \
	    $(FIGURE3_CASE) $(FIGURE3_FIXED) '$(PUBLISHED_SIZES)' $(FIGURE3_FILES)
