/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/film_effects.h"

#include <math.h>

#define NAMES(prefix)                                                                              \
    {                                                                                              \
        [EFFECT_STEP] = prefix "step_effect", [EFFECT_INLET] = prefix "inlet_effect",              \
        [EFFECT_STEP_MINIMUM] = prefix "step_effect_minimum",                                      \
        [EFFECT_INLET_MINIMUM] = prefix "inlet_effect_minimum",                                    \
        [EFFECT_STEP_ROLLING] = prefix "step_effect_rolling",                                      \
        [EFFECT_INLET_ROLLING] = prefix "inlet_effect_rolling"                                     \
    }

const char *const film_effect_names[NUM_EFFECTS] = NAMES("");
const char *const film_effect_state_names[NUM_EFFECTS] = NAMES("state_");

film_effects film_effects_unknown(void) {
    film_effects effects;

    for (int e = 0; e < NUM_EFFECTS; e++)
        effects.of[e] = NAN;
    return effects;
}

bool film_effects_are_infinite(const film_effects *effects) {
    bool any = false;

    for (int e = 0; e < NUM_EFFECTS; e++)
        any = any || isinf(effects->of[e]);
    return any;
}

bool film_effects_inlet_is_short(const film_effects *effects) {
    return isinf(effects->of[EFFECT_INLET]) && !isinf(effects->of[EFFECT_STEP]) &&
           !isinf(effects->of[EFFECT_STEP_MINIMUM]);
}

double film_effects_of_rolling(const film_effects *effects) {
    return effects->of[EFFECT_STEP_ROLLING] + effects->of[EFFECT_INLET_ROLLING];
}
