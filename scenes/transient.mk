# SPDX-License-Identifier: GPL-3.0-or-later
# Reduced models of a plan of trajectories, and from runs to tables and a picture. Included by the Makefile of each
# scene whose load oscillates, which says what its models are (training.mk). cases.csv has the periods.

include $(dir $(lastword $(MAKEFILE_LIST)))training.mk

PERIODS := $(shell awk -f $(SHARED)case-time.awk cases.csv)
ifeq ($(PERIODS),)
  $(error cases.csv: found no trajectories, expected a line each below the header)
endif

# $(call trajectories,MODEL): all runs that its tables need
steps_of     = $(or $($1.STEPS),adaptive fixed)
trajectories = $(foreach steps,$(call steps_of,$1),$(PERIODS:%=$(OUT)/run-$(steps)-%-full.dat) $(PERIODS:%=$(OUT)/run-$(steps)-%-$1.dat)) \
               $(PERIODS:%=$(OUT)/run-tenth-%-full.dat)

# ---- Targets for people

runs: $(call trajectories,$(MODEL)) ## all trajectories, full and reduced, adaptive and fixed steps

tables: $(OUT)/tables.txt ## sizes, steps and times, deviations
	@cat $<

figures: tables $(OUT)/figure4.png ## tables and pictures
	@printf '%s\n' $(patsubst %,'picture: %',$(abspath $(filter %.png,$^)))

.PHONY: runs tables figures

# ---- Runs

# A figure or table reads each run as text (trajectory.sh); beside it lies the result itself.
settings = $(shell awk -f $(SHARED)case-time.awk -v want='$*' cases.csv)
run      = $(SHARED)trajectory.sh $(basename $@).h5 $(BIN)/$1 scene.yml $2 --set output.fields=false $(SET) > $@

FULL_NEEDS := scene.yml $(SHARED)trajectory.sh $(BIN)/fullrun $(call options,fullrun,$(SET))

$(OUT)/run-%-full.dat: cases.csv $(SHARED)case-time.awk $(FULL_NEEDS)
	$(call quiet,fullrun   ,$@)$(call run,fullrun,$(settings))

# $(call romrun_rules,MODEL)
define romrun_rules
$(OUT)/run-%-$1.dat: cases.csv $(SHARED)case-time.awk scene.yml $(OUT)/$1.h5 $(SHARED)trajectory.sh $(BIN)/romrun
	$$(call quiet,romrun    ,$$@)$$(call run,romrun,--model $(OUT)/$1.h5 $$(settings))
endef
$(foreach model,$(MODELS),$(eval $(call romrun_rules,$(model))))

# ---- Tables and picture

# $(call report,MODEL...)
report = { \
    for model in $1; do echo "size $$model $$($(SHARED)sizes.sh $(OUT)/$$model.h5)"; done; \
    echo 'size published $(PUBLISHED_SIZES)'; \
    h5dump -A -a /compressed_snapshots $(OUT)/snapshots.h5 | awk '/\(0\):/ { print "snapshots", $$2 }'; \
    $(foreach model,$1,$(SHARED)trajectories.sh $(OUT) $(model) '$(call steps_of,$(model))' $(PERIODS);) \
} | awk -f $(SHARED)tables-time.awk -v models='$1' - cases.csv > $@

TABLES_NEED := cases.csv $(addprefix $(SHARED),trajectories.sh tables-time.awk sizes.sh deviation.awk)

$(OUT)/tables.txt: $(TABLES_NEED) $(call trajectories,$(MODEL))
	$(call quiet,tables    ,$@)$(call report,$(MODEL))

FIGURE4_RUNS := $(PERIODS:%=$(OUT)/run-adaptive-%)

$(OUT)/figure4.png: $(SHARED)figure4.gp $(SHARED)deviation.awk $(FIGURE4_RUNS:%=%-full.dat) $(FIGURE4_RUNS:%=%-$(MODEL).dat)
	$(call quiet,gnuplot   ,$@)for run in $(FIGURE4_RUNS); do \
	    awk -f $(SHARED)deviation.awk $$run-full.dat $$run-$(MODEL).dat > $$run-deviation.txt || exit; \
	done; \
	gnuplot -e 'picture="$(basename $@)"; runs="$(OUT)/run-adaptive-"; periods="$(PERIODS)"' $(SHARED)figure4.gp
