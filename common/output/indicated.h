/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists the quantities of a stationary result, besides the films, that have an error estimate
 * ("indicated deviation" from the full model). */
#ifndef EHD_INDICATED_H
#define EHD_INDICATED_H

typedef enum indicated_quantity {
    INDICATED_CENTRAL_PRESSURE, // relative
    INDICATED_EXIT_POSITION,    // half widths; unknown if exits are nodes
    INDICATED_LOAD,             // over the reference load
    INDICATED_PRESSURE,         // largest of all nodes, Hertz pressures
    INDICATED_FILM,             // largest of all nodes with pressure, over the central film
    INDICATED_FRICTION,         // relative, of the friction force; last, since older files lack it
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
