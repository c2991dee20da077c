# SPDX-License-Identifier: GPL-3.0-or-later
# Deviation against time of all that a user could do: sizes of the reduced model, the full model on coarser grids and
# with looser tolerances, published film formulas. Included by studies that have a check-plan.yml, behind a file of lib.

# Regime of the scenes of check-plan.yml that are compared: stationary | transient.
TRADE_REGIME ?= stationary

# What the full model is measured with beside its best: times the step of the grid, Newton's tolerances.
TRADE_STRETCHES  ?= 2 4 8 16
TRADE_TOLERANCES ?= 1e-4 1e-2 1e-1
TRADE_REPEAT     ?= 3

# In time: tolerances and fixed lengths of the steps, and stationary solutions at so many times. The reference has the
# first one.
TRADE_STEPS ?= 1e-5 1e-4 1e-3 1e-2 fixed0.005 fixed0.02 still300

# Of the picture, in pixels.
TRADE_WIDTH ?= 1000

TRADE  := $(OUT)/trade
TRADES := $(dir $(lastword $(MAKEFILE_LIST)))

# ---- Targets for people

trade: $(OUT)/trade.png $(if $(filter stationary,$(TRADE_REGIME)),$(OUT)/polish.txt) ## deviation against time of the model's sizes and of the alternatives on check-plan.yml
	@$(BIN)/romrun --trade --model $(OUT)/calibrated.h5
	@cat $(filter %.txt,$^)
	@echo 'picture: $(abspath $<), .svg; numbers: $(abspath $(OUT)/trade.csv)'

.PHONY: trade

# ---- Calibration, and its scenes

$(OUT)/calibrated.h5: $(OUT)/$(MODEL).h5 check-plan.yml scene.yml $(BIN)/romrun $(call options,calibrated,$(SET))
	$(call quiet,romrun    ,$@)$(BIN)/romrun --calibrate check-plan.yml --model $< -o $@ --force $(SET)

# The alternatives choose the steps in time. The calibration leaves out scenes outside of the trained range.
KEPT := $(if $(filter stationary,$(TRADE_REGIME)),calibration_scenes,calibration_trajectories)

$(TRADE)/scenes.txt: $(OUT)/calibrated.h5 $(TRADES)scenes.awk
	@rm -rf $(TRADE) && mkdir $(TRADE)
	@kept=$$($(BIN)/romrun --print $< $(KEPT) | sed -n 2p) && $(BIN)/romrun --print $< settings | \
	    awk -f $(TRADES)scenes.awk -v folder=$(TRADE) -v regime=$(TRADE_REGIME) -v without=transient.fixed_step -v kept=$$kept && \
	    ls $(TRADE) | grep yml > $@

$(TRADE)/ladder.txt: $(TRADE)/scenes.txt $(TRADES)ladder.sh
	@$(TRADES)ladder.sh $(OUT)/calibrated.h5 > $@

# ---- Stationary alternatives

ifeq ($(TRADE_REGIME),stationary)

TRADE_WAYS := $(foreach start,cold neighbour,$(start)-1-1e-10 $(TRADE_STRETCHES:%=$(start)-%-1e-10) \
                  $(TRADE_TOLERANCES:%=$(start)-1-%)) \
              $(wordlist 1,2,$(TRADE_STRETCHES:%=neighbour-%-1e-2)) reduced-1-1e-10

$(TRADE)/%.txt: $(TRADE)/scenes.txt $(TRADES)stationary.sh $(SHARED)collect.sh $(BIN)/fullrun
	$(call quiet,fullrun   ,$*)REPEAT=$(TRADE_REPEAT) MODEL=$(OUT)/calibrated.h5 \
	    $(TRADES)stationary.sh $(TRADE) $* > $@

$(OUT)/trade.csv: $(TRADES)stationary.awk $(TRADE)/ladder.txt $(TRADE_WAYS:%=$(TRADE)/%.txt)
	@awk -f $(SHARED)common.awk $(addprefix -f ,$(filter %.awk,$^)) $(filter %.txt,$^) > $@

$(OUT)/polish.txt: $(TRADES)polish.awk $(TRADE)/cold-1-1e-10.txt $(TRADE)/reduced-1-1e-10.txt
	@awk -f $(SHARED)common.awk -f $< -v csv=$(OUT)/polish.csv $(filter %.txt,$^) > $@

else

# ---- Alternatives in time

TRADE_REFERENCE := full-1-$(firstword $(TRADE_STEPS))
TRADE_COARSE    := full-2-$(firstword $(TRADE_STEPS))
TRADE_WAYS      := $(TRADE_STEPS:%=full-1-%) $(TRADE_COARSE) \
                   $(foreach stretch,$(TRADE_STRETCHES),$(wordlist 2,3,$(TRADE_STEPS:%=full-$(stretch)-%)))

trade_time = MODEL=$(OUT)/calibrated.h5 $(TRADES)in-time.sh $(TRADE)

$(filter-out $(TRADE)/$(TRADE_REFERENCE).txt,$(TRADE_WAYS:%=$(TRADE)/%.txt)) $(TRADE)/reduced.txt: $(TRADE)/$(TRADE_REFERENCE).txt

$(TRADE)/full-%.txt: $(TRADE)/scenes.txt $(TRADES)in-time.sh $(SHARED)trajectory.sh $(SHARED)deviation.awk $(BIN)/fullrun
	$(call quiet,fullrun   ,full-$*)$(trade_time) full-$* $(TRADE_REFERENCE) > $@

# Every size with the default steps, the whole model with all.
$(TRADE)/reduced.txt: $(TRADE)/ladder.txt $(TRADES)in-time.sh $(SHARED)trajectory.sh $(SHARED)deviation.awk $(BIN)/romrun
	$(call quiet,romrun    ,reduced)while read -r ladder size more rows rest; do \
	    $(trade_time) reduced-$$size-$$more-$$rows-$(word 2,$(TRADE_STEPS)) $(TRADE_REFERENCE) || exit; \
	done < $< > $@; \
	for steps in $(filter-out $(word 2,$(TRADE_STEPS)),$(TRADE_STEPS)); do \
	    $(trade_time) reduced-$$(tail -n 1 $< | awk '{ print $$2 "-" $$3 "-" $$4 }')-$$steps $(TRADE_REFERENCE) || exit; \
	done >> $@

$(OUT)/trade.csv: $(TRADES)in-time.awk $(TRADE)/reduced.txt $(TRADE_WAYS:%=$(TRADE)/%.txt)
	@awk -f $(SHARED)common.awk -f $< -v coarse=$(TRADE_COARSE) $(filter %.txt,$^) > $@

endif

# ---- The picture

$(OUT)/trade.png: $(OUT)/trade.csv $(TRADES)trade.gp $(call options,trade-picture,$(TRADE_WIDTH))
	$(call quiet,gnuplot   ,$@)$(plot) -e 'data="$<"; regime="$(TRADE_REGIME)"; width=$(TRADE_WIDTH)' \
	    $(TRADES)trade.gp
