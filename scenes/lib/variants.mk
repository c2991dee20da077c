# SPDX-License-Identifier: GPL-3.0-or-later
# The C program of a scene once more: NAME.py on the Python package (make python), NAME_fmu.py on FMUs, by one integrator
# in Python. Included behind library.mk, by a Makefile that sets
#   VARIED      NAME
#   VARIED_RUN  the table that NAME writes, with a rule for it
#   INTEGRATOR  the module of both
#   FMU_SET     settings of the scene whose contact becomes an FMU, with the approach given

variants: $(OUT)/variants.txt ## the same on the library in Python (make python) and on FMUs, and how far they are off
	@cat $<

.PHONY: variants

# The package and its library where `make python` puts them, else where Python finds it.
$(OUT)/python.csv: $(VARIED).py $(INTEGRATOR).py scene.yml $(OUT)/$(MODEL).h5
	$(call quiet,python    ,$@)PYTHONPATH="$$(realpath -m $(BESIDE)/python):$$PYTHONPATH" $(PYTHON) -B $(filter-out $(INTEGRATOR).py,$^) $@ $(ends_well)

$(OUT)/contact.fmu: scene.yml $(OUT)/$(MODEL).h5 $(BIN)/romrun
	$(call quiet,romrun    ,$@)$(BIN)/romrun --fmu $< --model $(OUT)/$(MODEL).h5 --set closure=approach $(FMU_SET) $(SET) -o $@ --force --quiet

$(OUT)/fmu.csv: $(VARIED)_fmu.py $(OUT)/contact.fmu scene.yml $(INTEGRATOR).py $(SHARED)fmu.py
	$(call quiet,python    ,$@)$(python) $(wordlist 1,3,$^) $@ $(ends_well)

# Exit code 4: not to be trusted, as the program that they are compared with.
ends_well = || [ $$? -eq 4 ]

$(OUT)/variants.txt: $(SHARED)variants.py $(VARIED_RUN) $(OUT)/python.csv $(OUT)/fmu.csv
	$(call quiet,compare   ,$@)$(python) $^ > $@
