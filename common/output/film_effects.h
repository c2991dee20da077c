/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the grid's error estimates for the films and the rolling resistance of a stationary
 * contact. */
#ifndef EHD_FILM_EFFECTS_H
#define EHD_FILM_EFFECTS_H

#include <stdbool.h>

enum {
    EFFECT_STEP,         // step, central film
    EFFECT_INLET,        // inlet, central film
    EFFECT_STEP_MINIMUM, // step, minimum film
    EFFECT_INLET_MINIMUM,
    EFFECT_STEP_ROLLING, // step, rolling resistance and rolling moment
    EFFECT_INLET_ROLLING,
    NUM_EFFECTS
};

/* Estimated sizes of the relative errors due to the step and the length of the inlet. NaN:
 * unknown. Infinite: the grid is too coarse, or its inlet too short, for an estimate. */
typedef struct film_effects {
    double of[NUM_EFFECTS];
} film_effects;

film_effects film_effects_unknown(void);

/* Checks whether any estimate is infinite. */
bool film_effects_are_infinite(const film_effects *effects);

/* Checks whether the inlet is too short to estimate its error, although the step is fine enough. */
bool film_effects_inlet_is_short(const film_effects *effects);

/* Returns the relative error estimate of the rolling resistance for step and inlet; NaN:
 * unknown. */
double film_effects_of_rolling(const film_effects *effects);

/* "step_effect", …: attributes of a result, and datasets of snapshots. */
extern const char *const film_effect_names[NUM_EFFECTS];
/* "state_step_effect", …: datasets of bases and models. */
extern const char *const film_effect_state_names[NUM_EFFECTS];

#endif
