/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solutions of many scenes as one table, HDF5 (schemas/cases.md) or CSV. */
#ifndef EHD_CASE_TABLE_H
#define EHD_CASE_TABLE_H

#include "common/output/result.h"
#include "common/settings/case_list.h"

enum { NO_PART = -1 };

/* One scene. Numbers are dimensionless unless said otherwise, and NaN where not known. */
typedef struct case_row {
    int64_t status; // as in a result
    int64_t newton_iterations;
    int64_t part; // of several models which one, from 0; NO_PART: of one model
    double moes_M, moes_L, alpha_p_H;
    double hertz_pressure; // Pa
    // of a scene in SI units:
    double half_width, film_unit;                 // m
    double load;                                  // N/m of a line contact, N of a point contact
    double radius;                                // m
    double speed;                                 // m/s
    double thermal_loading, inlet_heating_factor; // of a scene with the lubricant's conductivity
    double central_film_thickness, minimum_film_thickness;
    double central_pressure, peak_pressure;
    double rigid_approach;
    double exit_position;
    double indicated_deviation, indicated_deviation_minimum;
    // of a scene that slides:
    double friction_coefficient, indicated_deviation_friction;
    double friction_force, power_loss; // N/m and W/m of a line contact, N and W of a point contact
    double rolling_resistance, rolling_moment;      // N/m and N, N and N m
    double mean_shear_stress, largest_shear_stress; // Pa
    double residual_norm;
    double solve_seconds; // s
    char reason[RESULT_REASON];
} case_row;

/* What the contact says of a row, without a solution. */
case_row case_row_of(const ehd_contact *contact);

/* EHD_USAGE unless a name ends with .csv, .h5 or .hdf5; EHD_CANTCREATE as output_file_check. */
ehd_status case_table_check(const program *caller, ehd_error *error);

/* A table that is being written, some rows at a time. */
typedef struct case_table case_table;

/* Makes an empty table. case_table_expect then collects its columns, before case_table_begin. */
ehd_status case_table_new(
    // output:
    case_table **table, // give to case_table_finish or case_table_close
    // input:
    const program *caller, ehd_error *error);

/* Tells of a row to come: the table has a column for each of its values that is not NaN. */
void case_table_expect(case_table *table, const case_row *row);

/* Begins to write caller->output, or CSV to stdout where there is none. In CSV the columns of the list come
 * first, then those of schemas/cases.md, those of them that SI units can be made of again with the unit
 * behind the name, where a scene is given in these, and last the reason of a status. With `resume` it goes on with
 * what an interrupted run of the same settings and inputs left, if there is any. *num_done: rows that are already there.
 * EHD_CANTCREATE, EHD_IO, EHD_MEMORY; EHD_DATA: the rows that were left belong to another run or are damaged. */
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

/* Reads the status of the rows that were already there, one row a call. EHD_DATA, EHD_IO. */
ehd_status case_table_status(int64_t *status, case_table *table, ehd_error *error);

/* Appends rows. They are kept if the process is killed later. */
ehd_status case_table_put(case_table *table,
                          const case_row *rows,    // [count]
                          const case_texts *texts, // [count] of the list
                          size_t count, ehd_error *error);

/* Gives the table its name, and frees it. EHD_IO. */
ehd_status case_table_finish(case_table **table, ehd_error *error);

/* Frees an unfinished table. If it has rows, its partial file stays, to be resumed. Does nothing without a table. */
void case_table_close(case_table **table);

#endif
