/* SPDX-License-Identifier: GPL-3.0-or-later */
/* --vtk RESULT.h5 -o OUT.vti, the same in every program: the fields of a result as VTK's image data,
 * which ParaView opens, in metres and pascals. It is made of a file, not in a run, so that every result
 * can be looked at, whoever wrote it and however long it took. */
#ifndef EHD_VTK_H
#define EHD_VTK_H

#include "common/artefact/artefact.h"
#include "common/program/program.h"

/* Writes pressure (Pa) and film_thickness (m), as far as the file has them, at the nodes of the whole
 * grid, places in m by the half width of that time. A name that ends with .vti: of the one time that
 * has fields. With .pvd: of all times that have, each in a file NAME_0000.vti, … beside it, and the
 * collection of these with their times in s. An image has two equal layers, and a line contact's also
 * two equal lines, a step apart, since VTK 9.1 crashes with images of one layer.
 *
 * EHD_DATA: no result, no fields, no SI units, several times for a .vti; EHD_USAGE: another ending;
 * EHD_CANTCREATE: a file exists and caller->force is not set; EHD_IO, EHD_MEMORY,
 * EHD_INTERRUPTED. */
ehd_status vtk_write(artefact *file, const program *caller, ehd_error *error);

/* The same of caller->vtk, which may be unfinished; frees the program and returns the exit code for
 * main. */
int output_vtk(program *caller);

#endif
