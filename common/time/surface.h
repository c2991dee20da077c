/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes a waviness, a dent or a table of heights on one of the two surfaces of a contact. The
 * heights move with this surface and are added to the gap of the contact (README.md, A surface that
 * is not smooth).
 * Called by full_march.c and previous.c of fullrun for each step. */
#ifndef EHD_SURFACE_H
#define EHD_SURFACE_H

#include "common/physics/contact.h"
#include "common/program/status.h"
#include "common/settings/scene.h"
#include "common/time/frame.h"

/* A surface is read-only once it is made. */
typedef struct ehd_surface ehd_surface;

/* Makes the surface of a valid scene; *self is NULL if both surfaces are smooth. EHD_DATA or
 * EHD_NOINPUT: the table is missing or not valid, or the height at its edge is not 0. EHD_DATA:
 * `units: si` in a scene without `physical`, or a speed that contradicts the slide-roll ratio.
 * EHD_MEMORY. Reads HDF5, so only one call at a time (artefact.h). */
ehd_status surface_init(
    // output:
    ehd_surface **self, // free with surface_free; NULL after a failure
    // input:
    const scene *given, const ehd_contact *reference, ehd_error *error);

ehd_surface *surface_free(ehd_surface *self); // accepts and returns NULL

/* Checks whether the surface has a speed of 0. The heights of such a surface are part of the
 * initial film. Returns false for NULL. */
bool surface_rests(const ehd_surface *self);

/* Checks that a moving surface is in front of the grid at the start, because the initial film is
 * the film of smooth surfaces. `frame` is the frame of the start. EHD_DATA: a part of the surface
 * is on the grid already. */
ehd_status surface_check_start(const ehd_surface *self, const contact_frame *frame,
                               const ehd_grid *grid, ehd_error *error);

/* Checks that the nodes of the reference's grid resolve the surface. EHD_DATA: the surface rests
 * outside of the grid, or is too fine for the steps of the grid. */
ehd_status surface_check_grid(const ehd_surface *self, const ehd_grid *grid, ehd_error *error);

/* Returns the height at a place of a frame, in the scales of the frame. */
double surface_height(const ehd_surface *self, const contact_frame *frame, double x, double y);

/* Computes the heights at the nodes of a grid, in the scales of the frame. */
void surface_heights(
    // output:
    double *heights, // [num_nodes]
    // input:
    const ehd_surface *self, const contact_frame *frame, const ehd_grid *grid);

/* Returns the position of the surface for a path of the fluid, both in reference half widths. The
 * position is the place of the front end of a moving waviness, of the middle of a dent, or of x = 0
 * of a table. */
double surface_position(const ehd_surface *self, double path);

/* Returns the longest path of the fluid in a step, in reference half widths, for which the step
 * resolves the motion of the surface over the grid. INFINITY: no limit. `backwards`: the fluid
 * moves backwards. */
double surface_longest_path(const ehd_surface *self, const contact_frame *frame,
                            const ehd_grid *grid, bool backwards);

#endif
