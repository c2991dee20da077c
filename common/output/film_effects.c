/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/film_effects.h"

#include <math.h>

#define NAMES(prefix)                                                                              \
    {                                                                                              \
        [EFFECT_STEP] = prefix "step_effect", [EFFECT_INLET] = prefix "inlet_effect",              \
        [EFFECT_STEP_MINIMUM] = prefix "step_effect_minimum",                                      \
        [EFFECT_INLET_MINIMUM] = prefix "inlet_effect_minimum"                                     \
    }

const char *const film_effect_names[NUM_EFFECTS] = NAMES("");
const char *const film_effect_state_names[NUM_EFFECTS] = NAMES("state_");

film_effects film_effects_unknown(void) {
    film_effects effects;

    for (int e = 0; e < NUM_EFFECTS; e++)
        effects.of[e] = NAN;
    return effects;
}
