/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds bases of more snapshots than fit in memory. All files are read once for the modes, and
 * once more for the coordinates. */
#ifndef EHD_STREAM_BASES_H
#define EHD_STREAM_BASES_H

#include "common/program/program.h"
#include "podbuild/bases.h"
#include "podbuild/pod_stream.h"
#include "podbuild/snapshot_files.h"

/* Memory plan and error budget of a basis. The root of the allowed energy has three shares, see
 * pod_stream.h: 0.9 for truncation at the end (w), 0.05 for the distance of the snapshots from the
 * directions, and 0.05 for the energy that parts omitted before. A part uses half of its 0.05 for
 * each of the first two. */
typedef struct stream_plan {
    bool direct;   // all snapshots fit in memory and are read at once
    double limit;  // memory limit, bytes
    double bytes;  // upper bound of the memory of this plan, bytes
    double energy; // part of the energy that may be omitted in all
    pod_stream_settings pressure, deformation;
    size_t batch; // number of states that are projected at once
} stream_plan;

/* Plans the memory. `exact`: the number of modes is given and no energy, so the stream omits only
 * noise before the final truncation. `as_part`: the modes are those of a part. EHD_MEMORY: the
 * limit is too small. */
ehd_status stream_plan_make(
    // output:
    stream_plan *way,
    // input:
    const snapshot_files *files, const bases_settings *settings, bool exact, bool as_part,
    double limit, ehd_error *error);

/* Builds the bases like bases_build, but from files that are streamed. Only `basis` holds the
 * modes. `discarded`: upper bounds of the omitted energy of pressure and deformation, relative.
 * Errors: EHD_DATA (parts omit too much), EHD_INTERRUPTED; else as snapshot_files_open, bases_build
 * and pod_stream_add. */
ehd_status stream_bases_build(
    // output:
    reduced_basis *basis,    // free with reduced_basis_free
    pod_basis *pressure_pod, // free with pod_free; modes is NULL
    pod_basis *deformation_pod, double discarded[2],
    // in and out:
    snapshot_files *files,
    // input:
    const bases_settings *settings, const stream_plan *way, const program *caller,
    ehd_error *error);

/* Computes the modes of some files, and the coordinates of their states in these modes, for
 * part_write. Errors as stream_bases_build. */
ehd_status stream_part_build(
    // output:
    reduced_basis *basis, // only grid and states; free with reduced_basis_free
    pod_basis *modes,     // free with pod_free
    part_origin *origin,
    // in and out:
    snapshot_files *files,
    // input:
    const stream_plan *way, const program *caller, ehd_error *error);

#endif
