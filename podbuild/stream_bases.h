/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bases of more snapshots than fit in memory, which are read one by one, and once more for their
 * coordinates. */
#ifndef EHD_STREAM_BASES_H
#define EHD_STREAM_BASES_H

#include "common/program/program.h"
#include "podbuild/bases.h"
#include "podbuild/snapshot_files.h"
#include "podbuild/stream_pod.h"

/* What is taken of memory. The error of a stream's modes has three shares, see stream_pod.h: of the
 * first root 0.9 (omega), of the distance 0.05, and another 0.05 of the parts that were compressed
 * before. A part has half of its share for each of the two. */
typedef struct stream_plan {
    bool direct;   // all snapshots at once, as they fit
    double limit;  // bytes
    double bytes;  // that this way takes at most
    double energy; // part that may be left out in all
    stream_settings pressure, deformation;
    size_t batch; // states whose coordinates are taken at once
} stream_plan;

/* `exact`: the number of modes is given and no energy, so that nothing but noise is left out before.
 * `as_part`: the modes are those of a part. EHD_MEMORY: the limit is too small. */
ehd_status stream_plan_make(
    // output:
    stream_plan *way,
    // input:
    const snapshot_files *files, const bases_settings *settings, bool exact, bool as_part,
    double limit, ehd_error *error);

/* The same as bases_build, of files. The modes are in `basis` alone; `discarded` are bounds of the energy
 * left out, of pressure and deformation. EHD_DATA: parts that leave out too much; EHD_INTERRUPTED;
 * else as snapshot_files_open, bases_build and stream_pod. */
ehd_status stream_bases_build(
    // output:
    reduced_basis *basis,    // free with reduced_basis_free
    pod_basis *pressure_pod, // free with pod_free; without modes
    pod_basis *deformation_pod, double discarded[2],
    // in and out:
    snapshot_files *files,
    // input:
    const bases_settings *settings, const stream_plan *way, const program *caller,
    ehd_error *error);

/* The modes of files that are a part of a training, and the states of these in their coordinates, for
 * part_write. Errors as above. */
ehd_status stream_part_build(
    // output:
    reduced_basis *basis, // grid and states alone; free with reduced_basis_free
    pod_basis *modes,     // free with pod_free
    part_origin *origin,
    // in and out:
    snapshot_files *files,
    // input:
    const stream_plan *way, const program *caller, ehd_error *error);

#endif
