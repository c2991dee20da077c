# SPDX-License-Identifier: GPL-3.0-or-later
# Deviation against time of all that a user could do: sizes of the reduced model, the full model on coarser grids and
# with looser tolerances, published film formulas. Included behind another file of lib. The scenes are those of
# the plan check-plan.yml of the Makefile (PLANS in common.mk): none may be a training point.

# Regime of the scenes of check-plan.yml that are compared: stationary | transient.
TRADE_REGIME ?= stationary

# What the full model is measured with beside its best: times the step of the grid, Newton's tolerances.
TRADE_STRETCHES  ?= 2 4 8
TRADE_TOLERANCES ?= 1e-4 1e-2 1e-1
TRADE_REPEAT     ?= 3

# Of stationary scenes: the truth is extrapolated from two grids of so many times the step (the last two), and has the
# effect of a domain so many times as long and wide (the first). In time: films along their paths, not smoothed, on a grid
# of so many times the step, in fixed steps of this length.
TRADE_TRUTH ?= $(if $(filter stationary,$(TRADE_REGIME)),4 0.5 0.25,0.5 0.0025)

# In time: tolerances and fixed lengths of the steps, and stationary solutions at so many times. The reference has the
# first one, which is where the shortest steps along the path begin to count; the second is the default.
TRADE_STEPS ?= 5e-4 1.5e-3 5e-3 1.5e-2 fixed0.005 fixed0.02 still300

# Of the picture, in pixels.
TRADE_WIDTH ?= 1500

TRADE_OPTIONS := $(TRADE_REGIME) '$(TRADE_STRETCHES)' '$(TRADE_TOLERANCES)' '$(TRADE_STEPS)' '$(TRADE_TRUTH)' $(TRADE_REPEAT)

# Where the scene asks for published rows, all of this is with accurate ones: the same in a folder of its own.
ifneq ($(as_published),)

trade:
	$(in_accurate)

else

trade: $(OUT)/trade.png ## deviation against time of the model's sizes and of the alternatives on check-plan.yml
	@$(BIN)/romrun trade $(OUT)/calibrated.h5
	@$(if $(filter stationary,$(TRADE_REGIME)),cat $(OUT)/polish.txt)
	$(call tell_pictures,$<)
	$(call tell,numbers,$(OUT)/trade.csv)

endif

.PHONY: trade

$(OUT)/calibrated.h5: $(OUT)/$(MODEL).h5 $(OUT)/check-plan.yml scene.yml $(BIN)/romrun $(call options,calibrated,$(SET))
	$(call quiet,romrun    ,$@)$(BIN)/romrun calibrate $(OUT)/check-plan.yml --model $< -o $@ --force $(SET)

# Also polish.csv, polish.txt of stationary scenes. What was measured already is taken from $(OUT)/trade.
$(OUT)/trade.csv: $(OUT)/calibrated.h5 $(SHARED)trade.py $(BIN)/fullrun $(call options,trade,$(TRADE_OPTIONS))
	$(call quiet,measure   ,$@)$(python) $(SHARED)trade.py measure $(OUT) $(TRADE_OPTIONS)

$(OUT)/trade.png: $(OUT)/trade.csv $(call options,trade-picture,$(TRADE_WIDTH))
	$(call quiet,picture   ,$@)$(python) $(SHARED)trade.py draw $(OUT) $(TRADE_REGIME) $(TRADE_WIDTH)
