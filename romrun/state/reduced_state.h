/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the unknowns of a reduced solution and its exit line (Maier et al. (2015), eqs. 24 and 39),
 * and computes quantities at few nodes from the unknowns. Called by the folders solve, trust and
 * online of romrun, by podbuild/test_weight.c and by snapgen. */
#ifndef EHD_REDUCED_STATE_H
#define EHD_REDUCED_STATE_H

#include "romrun/model/reduced_model.h"
#include <stdbool.h>

/* A reduced state: z = (a, d, H0) and the exit line (eq. 39). */
typedef struct reduced_state {
    double *coordinates; // [num_unknowns]
    size_t exit;         // column of the exit on the line Y = 0; for a line contact a grid node
    size_t *exits;       // [num_lines] columns of the exit on all grid lines; NULL: line contact
    // for an exit between two nodes: distance of the exit from the node before `exit`, in grid
    // steps, 0 to 1; for a transient contact the result of exit_place. NaN: the exit is a node, or
    // the distance is not known yet.
    double exit_offset;
} reduced_state;

/* Allocates a state of a model, with all coordinates zero. Errors: EHD_MEMORY. */
ehd_status reduced_state_init(reduced_state *state, const reduced_model *model, ehd_error *error);
void reduced_state_free(reduced_state *state);

/* Copies a state of the same model. */
void reduced_state_copy(reduced_state *target, const reduced_state *source,
                        const reduced_model *model);

/* Return and set the exit line as columns, [num_lines]. An exit outside of the range from min_exit
 * to max_exit (band_line) is moved to the nearest end of this range. This happens to training
 * solutions without an exit. */
const size_t *reduced_state_exits(const reduced_state *state);
void reduced_state_set_exits(reduced_state *state, const reduced_model *model, const size_t *exits);

/* The first function checks whether the exit of a state lies between the nodes `exit` - 1 and
 * `exit`. The second returns the X at which the pressure ends, at Y = 0. */
bool reduced_exit_divides(const reduced_state *state, const reduced_model *model);
double reduced_exit_position(const reduced_state *state, const reduced_model *model);

/* Values of a state at the needed nodes (row_set), which are all nodes of the rows' stencils. For a
 * given checkpoint, the values are linear in the coordinates. */
typedef struct reduced_values {
    size_t checkpoint; // checkpoint of the exit (reduced_model_checkpoint)
    double *pressure;  // [num_needed] P, not set to zero behind the exit
    double *cut;       // [rows of the cut table] the checkpoint's cut table times z
} reduced_values;

/* Allocates the arrays. No checkpoint is set yet. Errors: EHD_MEMORY. */
ehd_status reduced_values_init(reduced_values *values, const reduced_model *model,
                               ehd_error *error);
void reduced_values_free(reduced_values *values);

/* Compute the values from coordinates. reduced_values_at uses a given checkpoint, reduced_values_of
 * the checkpoint of an exit line. */
void reduced_values_at(reduced_values *values, const reduced_model *model,
                       const double *coordinates, size_t checkpoint);
void reduced_values_of(reduced_values *values, const reduced_model *model,
                       const double *coordinates, const size_t *exit);

/* Computes P at `count` nodes of the band from index `first` on. P is not set to zero behind the
 * exit. */
void reduced_band_pressure(double *pressure, const reduced_model *model, const double *coordinates,
                           size_t first, size_t count);

/* Least and largest P before the exit, at the needed nodes and in the band. */
typedef struct reduced_pressures {
    double least, largest;
} reduced_pressures;

/* Largest accepted magnitude of a negative pressure, Hertz pressures. Truncation alone causes
 * negative pressures of a tenth to a third of it. Of 1000 solutions with trained lubricants, in 18
 * model sizes (14 modes or more) of three trainings, none has a pressure below -3e-4. Of the line
 * contacts with any lubricant that the whole model solves to 1 %, none has a pressure below -4e-4.
 * Solutions with pressures below -1e-3 have errors of the fields of 0.01 to 4 Hertz pressures
 * (scenes/studies/silent-failures; test_online.c, the_library_says_what_it_solved). */
static const double MOST_NEGATIVE = 1e-3;

/* Returns H of a state at any node. */
typedef double film_function(const void *context, size_t node);

/* Extends a range so that it includes a pressure. If the pressure is NaN, both limits become NaN
 * and stay NaN. */
void reduced_pressures_include(reduced_pressures *range, double pressure);

#endif
