# SPDX-License-Identifier: GPL-3.0-or-later
# Trains reduced models on a plan of trajectories, runs the cases of cases.csv (one for each period of the load), and
# makes tables and a picture (trajectories.py). The Makefile of each study with an oscillating load includes this file
# and sets the options of its models (training.mk).

PLAN  = $(OUT)/plan.yml
PLANS = plan.yml check-plan.yml

# Training: trajectories that start at the stationary contact, with loads of these periods. Each is solved with error
# control and with fixed steps. Long steps smooth details that short steps resolve. A model that has to agree with the
# full model in each step therefore needs both kinds of steps in its training.
TRAINED_PERIODS ?= 0.5, 1, 2
define plan.yml
groups:
  - scene: scene.yml
    vary:
      transient.load.period: [$(TRAINED_PERIODS)]
  - scene: scene.yml
    vary:
      transient.load.period: [$(TRAINED_PERIODS)]
      transient.fixed_step: [$(FIXED_STEP)]
endef
plan.yml := $(plan.yml)

# Trajectories on which `make trade` measures the models: their periods lie between the trained periods.
CHECK_PERIODS ?= 0.75, 1.5
define check-plan.yml
groups:
  - scene: scene.yml
    vary:
      transient.load.period: [$(CHECK_PERIODS)]
      transient.fixed_step: [$(FIXED_STEP)]
endef
check-plan.yml := $(check-plan.yml)

# More shards are faster on Slurm, but the result then agrees with that of one shard only to round-off.
SHARDS ?= $(or $(file <$(OUT)/shards),1)

include $(or $(wildcard $(dir $(lastword $(MAKEFILE_LIST)))training.mk),$(error $(lastword $(MAKEFILE_LIST)): found blanks in its path, expected none))

# A tenth of the default tolerance of transient runs: 1.5e-4 with the accurate, 1e-5 with the published discretisation.
TENTH := $(if $(or $(findstring discretization=accurate,$(SET)),$(shell grep -L 'discretization: published' scene.yml)),1.5e-4,1e-5)

# Number of the case that `confirm` runs.
CONFIRM_CASE ?= 1

# cases.mk sets CASES to the numbers of all cases, and SHORT_CASES to the numbers of the cases whose periods are not far
# above the time a_ref/u_ref.
$(OUT)/cases.mk: cases.csv $(SHARED)trajectories.py $(SHARED)cases.py
	@numbers=$$($(trajectories) numbers) && echo "$$numbers" | sed -e '1s/^/CASES := /' -e '2s/^/SHORT_CASES := /' > $@
include $(OUT)/cases.mk

trajectories = $(python) $(SHARED)trajectories.py

# $(call runs_of,MODEL): all runs that the tables of a model need: $(OUT)/full/STEPS-NUMBER.h5 and
# $(OUT)/MODEL/STEPS-NUMBER.h5.
steps_of = $(or $($1.STEPS),adaptive fixed)
runs_of  = $(foreach kind,full $1,$(foreach steps,$(call steps_of,$1),$(CASES:%=$(OUT)/$(kind)/$(steps)-%.h5))) \
           $(CASES:%=$(OUT)/full/tenth-%.h5)

# ---- Targets for people

runs: $(call runs_of,$(MODEL)) ## all trajectories, full and reduced, adaptive and fixed steps

tables: $(OUT)/tables.txt ## sizes, steps and times, deviations
	@cat $<

figures: tables $(OUT)/figure4.png ## tables and pictures
	$(call tell_pictures,$(filter %.png,$^))

# distances and confirm use the accurate discretisation and transport along the path.
ifneq ($(as_published),)
distances confirm:
	$(in_accurate)
else
distances: $(OUT)/distances.txt ## steps, times, and distances from the truth
	@cat $<

confirm: $(OUT)/confirm.txt ## the truth from the other method: published rows, extrapolated (CONFIRM_CASE; minutes)
	@cat $<
endif

.PHONY: runs tables figures distances confirm

# ---- Runs

# A run that stops early (exit code 3) or is not trusted (4) has a result too, which contains this status.
# $(call run,PROGRAM,OPTIONS,CASE): CASE is a command in front of the program, which adds the settings of a run.
run = mkdir -p $(@D); $3 $(BIN)/$1 scene.yml -o $@ --force --quiet $2 --set output.fields=false $(SET) >/dev/null; \
      code=$$?; case $$code in 0 | 4) ;; 3) mv $@.partial $@ ;; *) exit $$code ;; esac

# $(call of_case,FIXED): the command CASE for the run that $* names. Runs on finer grids take parts of the grid step of
# the result FIXED.
of_case = $(trajectories) run $(notdir $*) $(TENTH) $(or $1,-)

# Runs with finer grids and shorter steps in time: both are parts of the steps of the run `fixed`, whatever SET is.
FINER := truth published-half published-quarter
$(foreach steps,$(FINER),$(CASES:%=$(OUT)/full/$(steps)-%.h5)): $(OUT)/full/%.h5: $(OUT)/full/fixed-$$(lastword $$(subst -, ,$$*)).h5
	$(call quiet,fullrun   ,$@)$(call of_case,$<) $(BIN)/fullrun scene.yml -o $@ --force --quiet $(SET) \
	    --set output.fields=false >/dev/null

FULL_NEEDS    := scene.yml $(BIN)/fullrun $(call options,fullrun,$(SET))
REDUCED_NEEDS := scene.yml $(BIN)/romrun

$(OUT)/full/%.h5: cases.csv $(FULL_NEEDS)
	$(call quiet,fullrun   ,$@)$(call run,fullrun,,$(call of_case))

$(sort $(filter-out $(OUT)/full/%,$(foreach model,$(MODELS),$(call runs_of,$(model))))): $(OUT)/%.h5: cases.csv \
        $(REDUCED_NEEDS) $(OUT)/$$(of_model).h5
	$(call quiet,romrun    ,$@)$(call run,romrun,--model $(OUT)/$(of_model).h5,$(call of_case))

# ---- Tables and picture

# $(call report,MODEL...)
report = $(trajectories) tables $(OUT) '$(PUBLISHED_SIZES)' \
         $(foreach model,$1,'$(model) $(call steps_of,$(model))') > $@

$(OUT)/tables.txt: $(SHARED)trajectories.py cases.csv $(call runs_of,$(MODEL))
	$(call quiet,tables    ,$@)$(call report,$(MODEL))

$(OUT)/distances.txt: $(SHARED)trajectories.py cases.csv $(SHORT_CASES:%=$(OUT)/full/truth-%.h5) \
                      $(foreach kind,full $(MODEL),$(foreach steps,adaptive fixed,$(SHORT_CASES:%=$(OUT)/$(kind)/$(steps)-%.h5)))
	$(call quiet,table     ,$@)$(trajectories) distances $(OUT) $(MODEL) > $@

$(OUT)/confirm.txt: $(SHARED)trajectories.py cases.csv \
                    $(foreach steps,adaptive truth published-half published-quarter,$(OUT)/full/$(steps)-$(CONFIRM_CASE).h5)
	$(call quiet,table     ,$@)$(trajectories) confirm $(OUT) $(CONFIRM_CASE) > $@

FIGURE4_RUNS := $(foreach kind,full $(MODEL),$(CASES:%=$(OUT)/$(kind)/adaptive-%.h5))

$(OUT)/figure4.png: $(SHARED)trajectories.py cases.csv $(FIGURE4_RUNS)
	$(call quiet,picture   ,$@)$(trajectories) picture $(OUT) $(MODEL) $@
