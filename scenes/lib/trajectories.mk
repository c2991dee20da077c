# SPDX-License-Identifier: GPL-3.0-or-later
# Reduced models of a plan of trajectories, and from runs to tables and a picture. Included by the Makefile of each
# study whose load oscillates, which says what its models are (training.mk). cases.csv has the periods.

include $(dir $(lastword $(MAKEFILE_LIST)))training.mk

PERIODS := $(shell awk -f $(SHARED)case-time.awk cases.csv)
ifeq ($(PERIODS),)
  $(error cases.csv: found no trajectories, expected a line each below the header)
endif

# $(call trajectories,MODEL): all runs that its tables need, $(OUT)/full/STEPS-PERIOD.dat and $(OUT)/MODEL/STEPS-PERIOD.dat
steps_of     = $(or $($1.STEPS),adaptive fixed)
trajectories = $(foreach steps,$(call steps_of,$1),$(PERIODS:%=$(OUT)/full/$(steps)-%.dat) $(PERIODS:%=$(OUT)/$1/$(steps)-%.dat)) \
               $(PERIODS:%=$(OUT)/full/tenth-%.dat)

# ---- Targets for people

runs: $(call trajectories,$(MODEL)) ## all trajectories, full and reduced, adaptive and fixed steps

tables: $(OUT)/tables.txt ## sizes, steps and times, deviations
	@cat $<

figures: tables $(OUT)/figure4.png ## tables and pictures
	@printf '%s\n' $(patsubst %,'picture: %',$(abspath $(filter %.png,$^)))

.PHONY: runs tables figures

# ---- Runs

# A figure or table reads each run as text (trajectory.sh); beside it lies the result itself. cases.csv says what the
# part of the name behind the folder means.
case_settings = $(shell awk -f $(SHARED)case-time.awk -v want='$(notdir $*)' cases.csv)
run           = mkdir -p $(@D) && $(SHARED)trajectory.sh $(basename $@).h5 $(BIN)/$1 scene.yml $2 --set output.fields=false $(SET) > $@

FULL_NEEDS    := scene.yml $(SHARED)trajectory.sh $(BIN)/fullrun $(call options,fullrun,$(SET))
REDUCED_NEEDS := scene.yml $(SHARED)trajectory.sh $(BIN)/romrun

$(OUT)/full/%.dat: cases.csv $(SHARED)case-time.awk $(FULL_NEEDS)
	$(call quiet,fullrun   ,$@)$(call run,fullrun,$(case_settings))

$(sort $(filter-out $(OUT)/full/%,$(foreach model,$(MODELS),$(call trajectories,$(model))))): $(OUT)/%.dat: cases.csv \
        $(SHARED)case-time.awk $(REDUCED_NEEDS) $(OUT)/$$(of_model).h5
	$(call quiet,romrun    ,$@)$(call run,romrun,--model $(OUT)/$(of_model).h5 $(case_settings))

# ---- Tables and picture

# $(call report,MODEL...)
report = { \
    for model in $1; do echo "size $$model $$($(SHARED)model.sh $(OUT)/$$model.h5)"; done; \
    echo 'size published $(PUBLISHED_SIZES)'; \
    $(BIN)/snapgen --print $(OUT)/snapshots.h5 compressed_snapshots | sed -n '2s/^/snapshots /p'; \
    $(foreach model,$1,$(SHARED)trajectories.sh $(OUT) $(model) '$(call steps_of,$(model))' $(PERIODS);) \
} | awk -f $(SHARED)common.awk -f $(SHARED)tables-time.awk -v models='$1' - cases.csv > $@

TABLES_NEED := cases.csv $(addprefix $(SHARED),trajectories.sh tables-time.awk deviation.awk)

$(OUT)/tables.txt: $(TABLES_NEED) $(call trajectories,$(MODEL))
	$(call quiet,tables    ,$@)$(call report,$(MODEL))

deviation    = awk -f $(SHARED)common.awk -f $(SHARED)deviation.awk
FIGURE4_RUNS := $(PERIODS:%=adaptive-%.dat)

$(OUT)/figure4.png: $(SHARED)figure4.gp $(SHARED)deviation.awk $(FIGURE4_RUNS:%=$(OUT)/full/%) $(FIGURE4_RUNS:%=$(OUT)/$(MODEL)/%)
	$(call quiet,gnuplot   ,$@)for run in $(FIGURE4_RUNS); do \
	    $(deviation) $(OUT)/full/$$run $(OUT)/$(MODEL)/$$run > $(OUT)/deviation-$${run%.dat}.txt || exit; \
	done; \
	$(plot) -e 'out="$(OUT)"; periods="$(PERIODS)"' $<
