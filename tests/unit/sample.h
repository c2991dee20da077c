/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes for tests of the contact and its solvers. */
#ifndef EHD_SAMPLE_H
#define EHD_SAMPLE_H

#include "common/physics/contact.h"
#include "common/settings/scene_contact.h"

enum { NUM_SAMPLE_LUBRICANTS = 5 };
// at least one lubricant of each viscosity law
extern const char *const sample_lubricants[NUM_SAMPLE_LUBRICANTS];

/* Returns a default scene with a lubricant: "barus" (20 1/GPa), "roelands" (0.04 Pa s, 20 1/GPa),
 * or a WLF preset, "no1" … "no3". The density law is "incompressible" or "dowson-higginson". */
scene sample_scene(const char *lubricant, const char *density, double moes_M, double moes_L);

/* Returns the contact of sample_scene with the given grid step, on a grid from X = -4 to 2. Calls
 * abort() if the scene is refused. */
ehd_contact sample_contact(const char *lubricant, const char *density, double moes_M, double moes_L,
                           double step);

/* Returns the point contact of sample_scene on the domain of Venner and Lubrecht: X in -4.5 … 1.5,
 * Y in -3 … 3, with nodes on the boundary. `cells`: even number of cells in each direction. */
ehd_contact sample_point(const char *lubricant, const char *density, double moes_M, double moes_L,
                         size_t cells, bool half);

/* Returns the contact with the published discretisation. A point contact gets zero pressure around
 * its grid. */
ehd_contact sample_published(ehd_contact contact);

/* Line contacts under light and heavy loads, with all viscosity and density laws, on grids as
 * coarse as possible. */
enum { NUM_SAMPLE_CASES = 10 };
ehd_contact sample_case(int i);

#endif
