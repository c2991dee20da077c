/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds estimates of the errors that the grid causes in the films and the rolling resistance of a
 * stationary contact. */
#ifndef EHD_FILM_EFFECTS_H
#define EHD_FILM_EFFECTS_H

#include <stdbool.h>

enum {
    EFFECT_STEP,         // error of the central film due to the grid step
    EFFECT_INLET,        // error of the central film due to the inlet length
    EFFECT_STEP_MINIMUM, // error of the minimum film due to the grid step
    EFFECT_INLET_MINIMUM,
    EFFECT_STEP_ROLLING, // error of rolling resistance and rolling moment due to the grid step
    EFFECT_INLET_ROLLING,
    NUM_EFFECTS
};

/* Estimated absolute values of the relative errors due to the grid step and the inlet length. NaN:
 * the error is not known. Infinite: the grid is too coarse, or its inlet too short, for an
 * estimate. */
typedef struct film_effects {
    double of[NUM_EFFECTS];
} film_effects;

film_effects film_effects_unknown(void);

/* Checks whether any estimate is infinite. */
bool film_effects_are_infinite(const film_effects *effects);

/* Checks whether the inlet is too short to estimate the error due to its length, although the grid
 * step is small enough. */
bool film_effects_inlet_is_short(const film_effects *effects);

/* Returns the estimated relative error of the rolling resistance, due to grid step and inlet length
 * together, or NaN if it is not known. */
double film_effects_of_rolling(const film_effects *effects);

/* Names of attributes of a result, and of datasets of snapshots: "step_effect", … */
extern const char *const film_effect_names[NUM_EFFECTS];
/* Names of datasets of bases and models: "state_step_effect", … */
extern const char *const film_effect_state_names[NUM_EFFECTS];

#endif
