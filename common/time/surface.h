/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A waviness, a dent or a table of heights on one of the surfaces, which moves with it (README.md, A
 * surface that is not smooth). The gap of a contact grows by its height. */
#ifndef EHD_SURFACE_H
#define EHD_SURFACE_H

#include "common/physics/contact.h"
#include "common/program/status.h"
#include "common/settings/scene.h"
#include "common/time/frame.h"

/* Read-only once it is made. */
typedef struct ehd_surface ehd_surface;

/* That of a valid scene; NULL: both surfaces are smooth. EHD_DATA or EHD_NOINPUT: a table as of a
 * history, or of another height than 0 where it ends; units si without physical; EHD_MEMORY. Reads
 * HDF5, so only one at a time (artefact.h). */
ehd_status surface_init(
    // output:
    ehd_surface **self, // free with surface_free; NULL after a failure
    // input:
    const scene *given, const ehd_contact *reference, ehd_error *error);

ehd_surface *surface_free(ehd_surface *self); // accepts and returns NULL

/* Whether it has a speed of 0. Then it is part of the start. NULL: not. */
bool surface_rests(const ehd_surface *self);

/* EHD_DATA where in the frame of a start some of one that moves is on the grid already: the start is
 * smooth. */
ehd_status surface_check_start(const ehd_surface *self, const contact_frame *frame,
                               const ehd_grid *grid, ehd_error *error);

/* EHD_DATA where the nodes of the reference's grid do not see the surface: one that rests outside of
 * the grid, or one that is finer than the steps. */
ehd_status surface_check_grid(const ehd_surface *self, const ehd_grid *grid, ehd_error *error);

/* Height at a place of a frame, in its scales. */
double surface_height(const ehd_surface *self, const contact_frame *frame, double x, double y);

/* The same at the nodes of a grid. */
void surface_heights(
    // output:
    double *heights, // [num_nodes]
    // input:
    const ehd_surface *self, const contact_frame *frame, const ehd_grid *grid);

/* Where it is when the fluid has come so far: the end of a waviness, the middle of a dent, x = 0 of a
 * table; reference half widths, as the path. */
double surface_position(const ehd_surface *self, double path);

/* How far the fluid may come in a step, reference half widths, so that the step resolves how the
 * surface passes the grid; INFINITY: any. */
double surface_longest_path(const ehd_surface *self, const contact_frame *frame,
                            const ehd_grid *grid, bool backwards); // the fluid

#endif
