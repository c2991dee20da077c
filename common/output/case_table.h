/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the solutions of many scenes as one table, HDF5 (schemas/cases.md) or CSV. */
#ifndef EHD_CASE_TABLE_H
#define EHD_CASE_TABLE_H

#include "common/output/result.h"
#include "common/settings/case_list.h"

enum { NO_PART = -1 };

/* Row of one scene. Numbers are dimensionless unless a unit is given. NaN: unknown. */
typedef struct case_row {
    int64_t status; // as in a result
    int64_t newton_iterations;
    int64_t part; // number of the model that solved the scene, from 0; NO_PART: only one model
    double moes_M, moes_L, alpha_p_H;
    double hertz_pressure; // Pa
    // only for a scene in SI units:
    double half_width, film_unit;                 // m
    double load;                                  // N/m of a line contact, N of a point contact
    double radius;                                // m
    double speed;                                 // m/s
    double thermal_loading, inlet_heating_factor; // only with the lubricant's conductivity
    double central_film_thickness, minimum_film_thickness;
    double central_pressure, peak_pressure;
    double rigid_approach;
    double exit_position;
    double indicated_deviation, indicated_deviation_minimum;
    // only for a scene with sliding:
    double friction_coefficient, indicated_deviation_friction;
    double friction_force, power_loss; // N/m and W/m of a line contact, N and W of a point contact
    double rolling_resistance, rolling_moment;      // N/m and N of a line contact, N and N m of a
                                                    // point contact
    double mean_shear_stress, largest_shear_stress; // Pa
    double residual_norm;
    double solve_seconds; // s
    char reason[RESULT_REASON];
} case_row;

/* Returns the row of a contact that has no solution yet. */
case_row case_row_of(const ehd_contact *contact);

/* Checks the name caller->output. EHD_USAGE: it does not end with .csv, .h5 or .hdf5.
 * EHD_CANTCREATE as output_file_check. */
ehd_status case_table_check(const program *caller, ehd_error *error);

/* A table that is being written, some rows at a time. */
typedef struct case_table case_table;

/* Makes an empty table. case_table_expect then collects its columns, before case_table_begin. */
ehd_status case_table_new(
    // output:
    case_table **table, // give to case_table_finish or case_table_close
    // input:
    const program *caller, ehd_error *error);

/* Announces a row: the table has a column for each of the row's values that is not NaN. */
void case_table_expect(case_table *table, const case_row *row);

/* Starts to write caller->output, or CSV to stdout if caller->output is NULL. A CSV has first the
 * columns of the list, then the columns of schemas/cases.md. If scenes are given in SI units,
 * columns that have a factor to SI units follow once more in SI units, each with its unit after the
 * name. The last column is the reason of a status.
 *
 * With `resume`, the table of an interrupted run of the same settings and inputs is continued, if
 * there is one. *num_done: rows that are already in the table. EHD_CANTCREATE, EHD_IO, EHD_MEMORY;
 * EHD_DATA: the rows belong to another run or are damaged. */
ehd_status case_table_begin(
    // in and out:
    case_table *table,
    // output:
    size_t *num_done,
    // input:
    const case_list *list, const contact_kind *kind, const ehd_grid *grid,
    const char *settings_text,
    const char *const *inputs, // paths, NULL at the end
    bool resume, ehd_error *error);

/* Reads the status of the rows that were already there, one row per call. EHD_DATA, EHD_IO. */
ehd_status case_table_status(int64_t *status, case_table *table, ehd_error *error);

/* Appends rows. They are kept if the process is killed later. */
ehd_status case_table_put(case_table *table,
                          const case_row *rows,    // [count]
                          const case_texts *texts, // [count] of the list
                          size_t count, ehd_error *error);

/* Gives the table its final name, and frees it. EHD_IO. */
ehd_status case_table_finish(case_table **table, ehd_error *error);

/* Frees an unfinished table. If it has rows, its partial file stays, to be resumed. Does nothing
 * without a table. */
void case_table_close(case_table **table);

#endif
