/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the *shown lubricants*: the lubricants of the scenes on which a model's error estimates
 * were calibrated (romrun/trust/README.md, Lubricants).
 * Called by romrun/calibrate/validation.c, and by trade_file.c and model_read.c. */
#ifndef EHD_SHOWN_H
#define EHD_SHOWN_H

#include "common/artefact/artefact.h"
#include "common/physics/contact.h"
#include "common/program/arena.h"
#include <stdint.h>

/* The lubricant of a scene or trajectory of the calibration. */
typedef struct shown_lubricant {
    double alpha_p_H;
    lubricant_rises rises; // rises of viscosity and density up to the Hertz pressure
    int64_t in_time;       // 1: lubricant of a trajectory, 0: lubricant of a stationary scene
} shown_lubricant;

typedef struct shown_lubricants {
    size_t count;
    shown_lubricant *of; // [count]
} shown_lubricants;

shown_lubricant shown_of(const ehd_contact *contact, bool in_time);

/* Writes the shown lubricants to a model file that does not contain any yet. Errors: EHD_MEMORY,
 * EHD_IO. */
ehd_status shown_put(artefact *file, const shown_lubricants *shown, ehd_error *error);

/* Reads the shown lubricants of a model file into an array of the arena `memory`. If the file has
 * none, `count` is 0. Errors: EHD_DATA, EHD_MEMORY. */
ehd_status shown_get(shown_lubricants *shown, arena *memory, artefact *file, ehd_error *error);

#endif
