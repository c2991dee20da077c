# SPDX-License-Identifier: GPL-3.0-or-later
# From a plan of trajectories to a reduced model (training.mk), and a scene in time with the full and the reduced model,
# compared and drawn. A Makefile that includes this may set before:
#   PICTURE  a script that draws it, given the picture's name and both results: pictures.py in-time

SHARED_IN_TIME := $(dir $(lastword $(MAKEFILE_LIST)))

# More pieces are faster on Slurm, but have the bits of one to rounding only.
SHARDS ?= $(or $(file <$(OUT)/shards),1)

include $(or $(wildcard $(SHARED_IN_TIME)training.mk),$(error $(SHARED_IN_TIME): found blanks in a path, expected none))

PICTURE ?= $(SHARED)pictures.py in-time

compare: $(OUT)/comparison.txt $(OUT)/picture.png ## train, run the scene full and reduced, compare, draw (the default)
	@cat $<
	$(call tell_pictures,$(OUT)/picture.png)

.DEFAULT_GOAL := compare
.PHONY: compare

# Tables that the scene names.
TABLES ?=
$(SNAPSHOTS): $(TABLES)

run_in_time = $(BIN)/$1 scene.yml -o $2 --force --quiet --set output.fields=false $(SET)

# On the grid of the training, to be compared on the same.
$(OUT)/full.h5: scene.yml $(TABLES) $(firstword $(SNAPSHOTS)) $(BIN)/fullrun $(call options,fullrun,$(SET))
	$(call quiet,fullrun   ,$@)$(call run_in_time,fullrun,$@) --grid-of $(firstword $(SNAPSHOTS)) $(jobs) >$(OUT)/full.txt

# A result that is not to be trusted (exit code 4) is one all the same, and says so.
$(OUT)/comparison.txt: scene.yml $(TABLES) $(OUT)/$(MODEL).h5 $(OUT)/full.h5 $(BIN)/romrun
	$(call quiet,romrun    ,$(OUT)/reduced.h5)$(call run_in_time,romrun,$(OUT)/reduced.h5) --model $(OUT)/$(MODEL).h5 \
	    --against $(OUT)/full.h5 >$@ || [ $$? -eq 4 ]

$(OUT)/reduced.h5: $(OUT)/comparison.txt

# Of a scene in SI units.
$(OUT)/picture.png: $(firstword $(PICTURE)) $(SHARED)pictures.py $(OUT)/full.h5 $(OUT)/reduced.h5
	$(call quiet,picture   ,$@)$(python) $(PICTURE) $@ $(OUT)/full.h5 $(OUT)/reduced.h5
