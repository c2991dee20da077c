/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a grid does to the films of a stationary contact, estimated. */
#ifndef EHD_FILM_EFFECTS_H
#define EHD_FILM_EFFECTS_H

enum {
    EFFECT_STEP,         // of the central film
    EFFECT_INLET,        // the same
    EFFECT_STEP_MINIMUM, // of the minimum film
    EFFECT_INLET_MINIMUM,
    NUM_EFFECTS
};

/* Relative changes of the films by ever smaller steps, and by an inlet of any length. NaN: not
 * known; infinite: with twice the step there is no solution. */
typedef struct film_effects {
    double of[NUM_EFFECTS];
} film_effects;

film_effects film_effects_unknown(void);

/* "step_effect", …: attributes of a result, and datasets of snapshots. */
extern const char *const film_effect_names[NUM_EFFECTS];
/* "state_step_effect", …: datasets of bases and models. */
extern const char *const film_effect_state_names[NUM_EFFECTS];

#endif
