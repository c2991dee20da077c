/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists the quantities of a stationary result, besides the films, that have an error estimate
 * ("indicated deviation" from the full model). */
#ifndef EHD_INDICATED_H
#define EHD_INDICATED_H

typedef enum indicated_quantity {
    INDICATED_CENTRAL_PRESSURE, // relative
    INDICATED_EXIT_POSITION,    // half widths; unknown if only the node of the exit is known
    INDICATED_LOAD,             // relative to the reference load
    INDICATED_PRESSURE,         // largest error at a node, in Hertz pressures
    INDICATED_FILM,             // largest error at a node with pressure, over the central film
    // relative error of the friction force; it stands last, because older files lack it
    INDICATED_FRICTION,
    NUM_INDICATED
} indicated_quantity;

/* Names of one quantity. */
typedef struct indicated_entry {
    const char *name;  // in results and for --accuracy-of: "central_pressure"
    const char *field; // "indicated_deviation_central_pressure"
    const char *text;  // "central pressure"
    const char *unit;  // "half widths", or "" for a ratio
} indicated_entry;

extern const indicated_entry indicated_entries[NUM_INDICATED];

#endif
