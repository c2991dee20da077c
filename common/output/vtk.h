/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implements --vtk RESULT.h5 -o OUT.vti for every program. Writes the fields of a result, in metres
 * and pascals, as VTK image data, which ParaView opens. The data come from a file and not from a
 * run. Therefore the result of another program, or of an unfinished run, can be viewed too. */
#ifndef EHD_VTK_H
#define EHD_VTK_H

#include "common/artefact/artefact.h"
#include "common/program/program.h"

/* Writes pressure (Pa) and film_thickness (m), if the file has them, at the nodes of the whole
 * grid. Coordinates are in m; they follow from the half width at that time. The name of the output
 * decides what is written:
 * - NAME.vti: one image. The result must have fields at exactly one time.
 * - NAME.pvd: an image NAME_0000.vti, … in the same folder for each time with fields. NAME.pvd
 *   lists these files with their times in s.
 *
 * An image has two equal layers, and for a line contact also two equal lines, a grid step apart,
 * because VTK 9.1 crashes with images of one layer.
 *
 * Returns EHD_DATA if the file is no result, has no fields, has no SI units, or has fields at
 * several times for a .vti. Returns EHD_USAGE for another ending. Returns EHD_CANTCREATE if a file
 * exists and caller->force is not set. Other errors: EHD_IO, EHD_MEMORY, EHD_INTERRUPTED. */
ehd_status vtk_write(artefact *file, const program *caller, ehd_error *error);

/* Writes the file caller->vtk, which may be unfinished, with vtk_write. */
ehd_status output_vtk(const program *caller, ehd_error *error);

#endif
