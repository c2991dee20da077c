/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the solutions of many scenes as one table, HDF5 (schemas/cases.md) or CSV. */
#ifndef EHD_CASE_TABLE_H
#define EHD_CASE_TABLE_H

#include "common/output/result.h"
#include "common/settings/case_list.h"

enum { NO_PART = -1 };

/* Row of one scene. Numbers are dimensionless unless a unit is given. NaN: the value is not
 * known. */
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
    double thermal_loading, inlet_heating_factor; // only if the lubricant's conductivity is given
    double central_film_thickness, minimum_film_thickness;
    double central_pressure, peak_pressure;
    double rigid_approach;
    double exit_position;
    double indicated_deviation, indicated_deviation_minimum;
    // only for a scene with sliding:
    double friction_coefficient, indicated_deviation_friction;
    double friction_force, power_loss; // N/m and W/m of a line contact, N and W of a point contact
    double rolling_resistance, rolling_moment;      // line contact: N/m, N; point contact: N, N m
    double mean_shear_stress, largest_shear_stress; // Pa
    double residual_norm;
    double solve_seconds; // s
    char reason[RESULT_REASON];
} case_row;

/* Returns the row of a contact that has no solution yet. */
case_row case_row_of(const ehd_contact *contact);

/* Checks the name caller->output. Returns EHD_USAGE if the name does not end with .csv, .h5 or
 * .hdf5. Returns EHD_CANTCREATE in the same cases as output_file_check. */
ehd_status case_table_check(const program *caller, ehd_error *error);

/* A table that is being written, some rows at a time. */
typedef struct case_table case_table;

/* Makes an empty table. After this call, case_table_expect announces the rows, so that the columns
 * are known. Then case_table_begin starts to write. */
ehd_status case_table_new(
    // output:
    case_table **table, // give to case_table_finish or case_table_close
    // input:
    const program *caller, ehd_error *error);

/* Announces a row. The table gets a column for each value of the row that is not NaN. */
void case_table_expect(case_table *table, const case_row *row);

/* Starts to write caller->output, or CSV to stdout if caller->output is NULL. A CSV table has, in
 * this order,
 * - the columns of `list`,
 * - the columns of schemas/cases.md,
 * - if scenes are given in SI units: the columns that have a factor to SI units once more, in SI
 *   units and with the unit after the name,
 * - the reason of the status.
 *
 * With `resume`, continues the table of an interrupted run of the same settings and inputs, if
 * there is such a table. *num_done is the number of rows that are already in the table. Returns
 * EHD_DATA if the rows belong to another run or are damaged. Other errors: EHD_CANTCREATE, EHD_IO,
 * EHD_MEMORY. */
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

/* Reads the status of one row that an interrupted run wrote; each call reads the next row. Errors:
 * EHD_DATA, EHD_IO. */
ehd_status case_table_status(int64_t *status, case_table *table, ehd_error *error);

/* Appends rows. The rows are kept if the process is killed later. */
ehd_status case_table_put(case_table *table,
                          const case_row *rows,    // [count]
                          const case_texts *texts, // [count] rows of `list`
                          size_t count, ehd_error *error);

/* Gives the table's file its final name, and frees the table. Error: EHD_IO. */
ehd_status case_table_finish(case_table **table, ehd_error *error);

/* Frees an unfinished table. If the table has rows, its partial file stays, so that the run can be
 * resumed. Does nothing if *table is NULL. */
void case_table_close(case_table **table);

#endif
