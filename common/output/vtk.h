/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implements --vtk RESULT.h5 -o OUT.vti for every program: writes the fields of a result as VTK
 * image data, which ParaView opens, in metres and pascals. The data come from a file and not from a
 * run, so that any result can be viewed, also the result of another program or of a long run. */
#ifndef EHD_VTK_H
#define EHD_VTK_H

#include "common/artefact/artefact.h"
#include "common/program/program.h"

/* Writes pressure (Pa) and film_thickness (m), if the file has them, at the nodes of the whole
 * grid. Coordinates are in m, by the half width of that time. NAME.vti: the file must have fields
 * at one time. NAME.pvd: each time with fields gets a file NAME_0000.vti, … in the same folder;
 * NAME.pvd lists these files with their times in s. An image has two equal layers, and for a line
 * contact also two equal lines, a step apart, because VTK 9.1 crashes with images of one layer.
 *
 * EHD_DATA: no result, no fields, no SI units, several times for a .vti; EHD_USAGE: another
 * ending; EHD_CANTCREATE: a file exists and caller->force is not set; EHD_IO, EHD_MEMORY,
 * EHD_INTERRUPTED. */
ehd_status vtk_write(artefact *file, const program *caller, ehd_error *error);

/* Writes the file caller->vtk, which may be unfinished, with vtk_write. Frees the program and
 * returns the exit code for main. */
int output_vtk(program *caller);

#endif
