# SPDX-License-Identifier: GPL-3.0-or-later
# Trains a reduced model on a plan of trajectories (training.mk), solves a transient scene with the full and the reduced
# model, compares both results and draws them. A Makefile may set this variable before it includes this file:
#   PICTURE  script that gets the picture's name and both results, and draws them; default: pictures.py in-time

SHARED_IN_TIME := $(dir $(lastword $(MAKEFILE_LIST)))

# More shards are faster on Slurm, but the result then agrees with that of one shard only to round-off.
SHARDS ?= $(or $(file <$(OUT)/shards),1)

include $(or $(wildcard $(SHARED_IN_TIME)training.mk),$(error $(SHARED_IN_TIME): found blanks in a path, expected none))

PICTURE ?= $(SHARED)pictures.py in-time

compare: $(OUT)/comparison.txt $(OUT)/picture.png ## train, run the scene full and reduced, compare, draw (the default)
	@cat $<
	$(call tell_pictures,$(OUT)/picture.png)

.DEFAULT_GOAL := compare
.PHONY: compare

# Tables that the scene uses.
TABLES ?=
$(SNAPSHOTS): $(TABLES)

run_in_time = $(BIN)/$1 scene.yml -o $2 --force --quiet --set output.fields=false $(SET)

# The full model uses the grid of the training, so that both results are on the same grid.
$(OUT)/full.h5: scene.yml $(TABLES) $(firstword $(SNAPSHOTS)) $(BIN)/fullrun $(call options,fullrun,$(SET))
	$(call quiet,fullrun   ,$@)$(call run_in_time,fullrun,$@) --grid-of $(firstword $(SNAPSHOTS)) $(jobs) >$(OUT)/full.txt

# A result that is not trusted (exit code 4) is compared too. It contains this status.
$(OUT)/comparison.txt: scene.yml $(TABLES) $(OUT)/$(MODEL).h5 $(OUT)/full.h5 $(BIN)/romrun
	$(call quiet,romrun    ,$(OUT)/reduced.h5)$(call run_in_time,romrun,$(OUT)/reduced.h5) --model $(OUT)/$(MODEL).h5 \
	    --against $(OUT)/full.h5 >$@ || [ $$? -eq 4 ]

$(OUT)/reduced.h5: $(OUT)/comparison.txt

# The picture needs a scene in SI units.
$(OUT)/picture.png: $(firstword $(PICTURE)) $(SHARED)pictures.py $(OUT)/full.h5 $(OUT)/reduced.h5
	$(call quiet,picture   ,$@)$(python) $(PICTURE) $@ $(OUT)/full.h5 $(OUT)/reduced.h5
