# SPDX-License-Identifier: GPL-3.0-or-later
# Measures error and time of all alternatives: sizes of the reduced model, the full model on coarser grids and with
# looser tolerances, and published film formulas. Include this file after another file of lib. The scenes are the points
# of check-plan.yml, a plan in the Makefile (PLANS in common.mk). None of them may be a training point.

# Regime of the scenes of check-plan.yml that are compared: stationary | transient.
TRADE_REGIME ?= stationary

# Less accurate settings of the full model that are measured too: factors on the grid step, and Newton tolerances.
# TRADE_REPEAT is the number of repetitions for the times.
TRADE_STRETCHES  ?= 2 4 8
TRADE_TOLERANCES ?= 1e-4 1e-2 1e-1
TRADE_REPEAT     ?= 3

# The converged solution. For stationary scenes it is extrapolated from two grids (second and third number: factors on
# the grid step) and includes the effect of a larger domain (first number: factor on its length and width). For
# transient scenes it is a run with transport along the path and without smoothing (numbers: factor on the grid step;
# fixed time step).
TRADE_TRUTH ?= $(if $(filter stationary,$(TRADE_REGIME)),4 0.5 0.25,0.5 0.0025)

# Time steps of transient scenes: a tolerance, a fixed length, or `still` and a number of times at which stationary
# solutions are computed. The first entry is that of the reference. Its tolerance is so small that the lower limit of
# the steps along the path begins to matter. The second entry is the default tolerance.
TRADE_STEPS ?= 5e-4 1.5e-3 5e-3 1.5e-2 fixed0.005 fixed0.02 still300

# Width of the picture in pixels.
TRADE_WIDTH ?= 1500

TRADE_OPTIONS := $(TRADE_REGIME) '$(TRADE_STRETCHES)' '$(TRADE_TOLERANCES)' '$(TRADE_STEPS)' '$(TRADE_TRUTH)' $(TRADE_REPEAT)

# If the scene has the published discretisation, `trade` uses the accurate one instead, in the folder out-accurate.
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

# For stationary scenes this rule also writes polish.csv and polish.txt. It reuses earlier measurements in $(OUT)/trade.
$(OUT)/trade.csv: $(OUT)/calibrated.h5 $(SHARED)trade.py $(BIN)/fullrun $(call options,trade,$(TRADE_OPTIONS))
	$(call quiet,measure   ,$@)$(python) $(SHARED)trade.py measure $(OUT) $(TRADE_OPTIONS)

$(OUT)/trade.png: $(OUT)/trade.csv $(call options,trade-picture,$(TRADE_WIDTH))
	$(call quiet,picture   ,$@)$(python) $(SHARED)trade.py draw $(OUT) $(TRADE_REGIME) $(TRADE_WIDTH)
