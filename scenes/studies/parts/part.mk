# SPDX-License-Identifier: GPL-3.0-or-later
# The training of one part, or of the whole region: PLAN and OUT (Makefile).
ACCURACY = 1e-4

# Spikes of some of the highest pressures are beyond the limits of a viscosity law.
ALLOW_FAILURES = 100

# The parts are those of the Makefile.
SPLIT = 1

include ../../lib/training.mk
