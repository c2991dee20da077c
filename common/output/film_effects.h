/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Error estimates of a grid on the films and the rolling resistance of a stationary contact. */
#ifndef EHD_FILM_EFFECTS_H
#define EHD_FILM_EFFECTS_H

#include <stdbool.h>

enum {
    EFFECT_STEP,         // of the central film
    EFFECT_INLET,        // the same
    EFFECT_STEP_MINIMUM, // of the minimum film
    EFFECT_INLET_MINIMUM,
    EFFECT_STEP_ROLLING, // of the rolling resistance, and the same of its moment
    EFFECT_INLET_ROLLING,
    NUM_EFFECTS
};

/* Estimated sizes of the relative errors by the step, and by the length of the inlet. NaN:
 * not known; infinite: the grid is too coarse, or its inlet too short, to tell. */
typedef struct film_effects {
    double of[NUM_EFFECTS];
} film_effects;

film_effects film_effects_unknown(void);

/* Whether any of them is infinite. */
bool film_effects_are_infinite(const film_effects *effects);

/* Whether the inlet is too short to estimate what it changes, while the step is fine enough. */
bool film_effects_inlet_is_short(const film_effects *effects);

/* Error estimate of the rolling resistance by the grid, relative; NaN: not known. */
double film_effects_of_rolling(const film_effects *effects);

/* "step_effect", …: attributes of a result, and datasets of snapshots. */
extern const char *const film_effect_names[NUM_EFFECTS];
/* "state_step_effect", …: datasets of bases and models. */
extern const char *const film_effect_state_names[NUM_EFFECTS];

#endif
