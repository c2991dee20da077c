/* SPDX-License-Identifier: GPL-3.0-or-later */
/* deimselect: selects the rows of the online model and writes it (README.md). It reads options and
 * files, plans the memory, selects rows, and checks the model.
 * Called from the command line, and by the pipelines in scenes. */
#include "common/artefact/artefact.h"
#include "common/output/output_main.h"
#include "common/program/memory_option.h"
#include "common/program/program.h"
#include "common/training/pool.h"
#include "deimselect/checked_model.h"
#include "deimselect/cubature.h"
#include "deimselect/row_plan.h"
#include "podbuild/readers.h"
#include "romrun/model/basis_file.h"
#include "romrun/model/model_file.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct select_options {
    const char *basis;
    const char *rows_from; // NULL: a method selects the rows
    row_settings rows;     // method and weights are NULL if not given
    bool no_check;
    size_t num_jobs;
    double memory; // limit of the arrays, bytes
} select_options;

// clang-format off
#define OWN_OPTIONS select_options

// columns: name, letter, argument, help, destination and type of the value
static const program_option own_options[] = {
    {"basis", 0, "BASIS.h5", "The basis of the residuals", OPTION_TEXT(basis)},
    {"rows", 0, "N", "Number of rows; default 2 a mode, or what the snapshots tell apart",
     OPTION_COUNT(rows.num_rows, 1, 10000000)},
    {"rows-from", 0, "FILE", "Rows that somebody else selected, in place of a method: column `row` of a CSV "
     "file, or dataset `rows` of an HDF5 file, counted as selected_row in schemas/model.md; with "
     "`weight` or `weights` also their factors", OPTION_TEXT(rows_from)},
    {"stability", 0, "S", "As few rows as leave 1/sigma_min at most S at every exit of training, where all "
     "rows have 1; in place of --rows", OPTION_REAL(rows.stability, 1, 1e12)},
    {"method", 0, "NAME", "joint (default), qr, sopt, exits; see below", OPTION_ENTRY(rows.method, selection_methods)},
    {"weights", 0, "NAME", "quadrature (default), plain; see below", OPTION_ENTRY(rows.weights, weightings)},
    {"control", 0, "N", "Number of control rows, which take no part in the solution and indicate its "
     "deviation; default a tenth of the rows, at least 8; 0: none", OPTION_COUNT(rows.num_control, 0, 10000000)},
    {"no-check", 0, NULL, "Leave out the check of the model, by full solutions between the points of its training; "
     "romrun then trusts none of its results", OPTION_FLAG(no_check)},
    {"memory", 0, "SIZE", "Memory that arrays may take, as 2G or 500M; default half of the machine's. Residuals that "
     "need more are streamed, and read twice", OPTION_READ(memory, memory_option_read)},
    {"jobs", 'j', "N", "Full solutions at a time; as many as there are processors by default",
     OPTION_COUNT(num_jobs, 1, 4096)},
    {0}};
// clang-format on

static void print_methods(void) {
    puts("Methods of row selection:");
    for (const selection_method *method = selection_methods; method->name; method++)
        printf("  %-12s%s\n", method->name, method->help);
    puts("Weights of the rows:");
    for (const weighting *weights = weightings; weights->name; weights++)
        printf("  %-12s%s\n", weights->name, weights->help);
}

// ---- the residuals

typedef struct select_run {
    const program *caller;
    const select_options *options;
    reduced_basis basis;
    char identity[65]; // of the file with the basis
    given_rows given;
    residual_reader reader; // the reader's file is closed if all snapshots are in memory
    residual_snapshots snapshots;
    char *plan_text; // text of the training plan (`settings` of the file); NULL: no plan
    row_choice choice;
} select_run;

/* Checks that the residuals were made on the grid of this basis and with this basis. */
static ehd_status check_fit(const select_run *self, artefact *file, ehd_error *error) {
    const char *basis_path = self->options->basis;
    const contact_kind *kind;
    ehd_grid grid;
    char *made_with = NULL;
    ehd_status status = grid_read(&grid, &kind, file, error);

    if (!status)
        status = grid_check(&grid, artefact_path(file), &self->basis.grid, basis_path, error);
    if (!status && artefact_has(file, "basis_sha256")) {
        status = artefact_get_text(file, "basis_sha256", &made_with, error);
        if (!status && strcmp(made_with, self->identity))
            status = ehd_fail(error, EHD_DATA,
                              "%s: basis_sha256: found %.12s..., expected %.12s... of %s: they "
                              "were made with another basis",
                              artefact_path(file), made_with, self->identity, basis_path);
    }
    free(made_with);
    return status;
}

/* Opens the file and reads everything except the snapshots. */
static ehd_status open_residuals(select_run *self, ehd_error *error) {
    const artefact_schema *const kinds[] = {&schema_residuals, NULL};
    residual_snapshots *snapshots = &self->snapshots;
    artefact **file = &self->reader.file;
    ehd_status status = artefact_open(file, self->caller->arguments[0], kinds, error);

    if (!status) status = check_fit(self, *file, error);
    if (!status)
        status = residual_snapshots_init(snapshots, artefact_length(*file, "iteration"),
                                         &self->reader, error);
    for (size_t i = 0; i < snapshots->count && !status; i++)
        snapshots->state[i] = -1;
    if (!status && artefact_has(*file, "iteration_state"))
        status = artefact_get_integers(*file, "iteration_state", snapshots->state, snapshots->count,
                                       error);
    if (!status && artefact_has(*file, "settings"))
        status = artefact_get_text(*file, "settings", &self->plan_text, error);
    return status;
}

/* Plans the memory before the snapshots are read, and prints the plan. If the snapshots do not fit
 * at once, also checks that the planned memory is free. */
static ehd_status plan_memory(row_plan *way, const select_run *self, ehd_error *error) {
    const residual_snapshots *snapshots = &self->snapshots;
    const ehd_status status = row_plan_make(way, snapshots, &self->basis, &self->options->rows,
                                            self->options->memory, error);

    if (status) return status;
    if (way->direct) {
        program_detail(self->caller, "%zu iterations at once, at most %.4g MB of %.4g MB",
                       snapshots->count, way->bytes * 1e-6, way->limit * 1e-6);
        return EHD_OK;
    }
    program_note(self->caller,
                 "%zu iterations of %zu nodes one after the other, in blocks of %zu, with room for "
                 "%zu directions: at most %.4g MB of %.4g MB",
                 snapshots->count, self->basis.grid.num_inner, way->block, way->max_rank,
                 way->bytes * 1e-6, way->limit * 1e-6);
    return program_check_memory(self->caller->arguments[0], "iterations", snapshots->count,
                                "iterations", " with this --memory", way->bytes, error);
}

/* Reads all snapshots, or prepares the reader to stream them. */
static ehd_status read_residuals(select_run *self, ehd_error *error) {
    const size_t num_inner = self->basis.grid.num_inner;
    const size_t size = self->snapshots.count * num_inner;
    artefact *file = self->reader.file;
    row_plan way;
    ehd_status status = plan_memory(&way, self, error);
    if (status) return status;

    if (!way.direct) {
        self->reader.caller = self->caller;
        self->reader.block = way.block;
        self->reader.max_rank = way.max_rank;
        return EHD_OK;
    }
    status = residual_snapshots_hold(&self->snapshots, num_inner, error);
    if (!status)
        status = artefact_get(file, "weighted_residual", self->snapshots.residuals, size, error);
    if (!status)
        status = artefact_get(file, "weighted_jacobian_step", self->snapshots.steps, size, error);
    artefact_close(&self->reader.file);
    return status;
}

// ---- the model

static ehd_status write_model(const select_run *self, ehd_error *error) {
    const program *caller = self->caller;
    const select_options *options = self->options;
    const reduced_basis *basis = &self->basis;
    const row_choice *choice = &self->choice;
    const row_settings *rows = &options->rows;
    const bool given_factors = rows->given && rows->given->factors;
    const char *const inputs[] = {caller->arguments[0], options->basis, options->rows_from, NULL};
    const char *method = rows->given ? "given" : rows->method->name;
    const char *weights = given_factors ? NULL : rows->weights->name;
    const model_origin origin = {.method = method,
                                 .basis_identity = self->identity,
                                 .sigma_min_residual = choice->sigma_min_residual,
                                 .sigma_min_jacobian = choice->sigma_min_jacobian,
                                 .sigma_min_over_exits = choice->sigma_min_over_exits,
                                 .sigma_min_by_exit = choice->sigma_min_by_exit,
                                 .stability = choice->stability,
                                 .weights = weights,
                                 .factors = choice->factors,
                                 .num_jacobian_modes = choice->num_jacobian_modes,
                                 .jacobian_modes = choice->jacobian_modes};
    reduced_model model = {0};
    char text[128], worth[CHECK_REPORT] = "";
    ehd_status status = row_choice_model(&model, choice, basis, error);

    if (!status) status = cubature_train(&model, basis, error);
    snprintf(text, sizeof text, "method: %s\nrows: %zu\nweights: %s\ncontrol: %zu\n", method,
             choice->num_rows, weights ? weights : "given", choice->num_control);
    if (!status && options->no_check)
        status = model_write(&model, basis, &origin, caller, text, inputs, error);
    if (!status && options->no_check) stage_end(&caller->stage);
    if (!status && !options->no_check) {
        const check_task task = {self->plan_text, caller->arguments[0], text, inputs,
                                 options->num_jobs};
        status = checked_model_write(worth, &model, basis, &origin, caller, &task, error);
    }
    if (!status || status == EHD_UNTRUSTED)
        printf("%zu rows of %zu %s %s, %zu unknowns, state needed at %zu nodes, %zu control rows\n"
               "1/sigma_min: residuals %.3g, Jacobian products %.3g, worst exit of training %.3g\n"
               "stability: %.3g at the worst exit of training, where all rows have 1\n%s",
               model.rows.num_rows, model.grid.num_inner, rows->given ? "from" : "by method",
               rows->given ? options->rows_from : method, model.num_unknowns, model.rows.num_needed,
               model.control.num_rows, 1 / choice->sigma_min_residual,
               1 / choice->sigma_min_jacobian, 1 / choice->sigma_min_over_exits, choice->stability,
               worth);
    reduced_model_free(&model);
    return status;
}

/* Reads the rows of --rows-from. Refuses --weights if the file has weights. */
static ehd_status read_given(select_run *self, ehd_error *error) {
    const select_options *options = self->options;
    ehd_status status = given_rows_read(&self->given, options->rows_from, &self->basis, error);

    if (!status && self->given.factors && options->rows.weights)
        return ehd_fail(error, EHD_USAGE,
                        "--weights: found %s, expected none: %s has weights of its own",
                        options->rows.weights->name, options->rows_from);
    return status;
}

/* Refuses options that exclude each other, and a command line without a basis. */
static ehd_status check_usage(const program *self, const select_options *options,
                              ehd_error *error) {
    const row_settings *rows = &options->rows;
    const char *excluded = rows->method          ? "--method"
                           : rows->num_rows > 0  ? "--rows"
                           : rows->stability > 0 ? "--stability"
                                                 : NULL;

    if (options->rows_from && excluded)
        return ehd_fail(error, EHD_USAGE,
                        "--rows-from: found with %s, expected one of them: the file says which "
                        "rows and how many",
                        excluded);
    if (rows->num_rows > 0 && rows->stability > 0)
        return ehd_fail(error, EHD_USAGE,
                        "--stability: found --rows %zu too, expected one of the two",
                        rows->num_rows);
    if (!options->basis)
        return ehd_fail(error, EHD_USAGE, "--basis: found none, expected the basis of %s",
                        self->arguments[0]);
    return EHD_OK;
}

static ehd_status run(const program *caller, void *own, ehd_error *error) {
    select_options *options = own;
    select_run self = {.caller = caller, .options = options};
    ehd_error cause = {""};
    ehd_status status = check_usage(caller, options, error);

    if (!status) status = basis_read(&self.basis, self.identity, options->basis, error);
    if (!status && options->rows_from) status = read_given(&self, error);
    if (options->rows_from) options->rows.given = &self.given;
    if (!options->rows.method) options->rows.method = selection_methods;
    if (!options->rows.weights) options->rows.weights = weightings;
    if (!status) status = open_residuals(&self, error);
    if (!status) status = read_residuals(&self, error);
    if (!status) {
        status =
            row_choice_make(&self.choice, &self.snapshots, &self.basis, &options->rows, &cause);
        if (status) ehd_fail(error, status, "%s: %s", caller->arguments[0], cause.text);
    }
    artefact_close(&self.reader.file);
    residual_snapshots_free(&self.snapshots); // frees memory for the full solutions of the check
    if (!status) status = write_model(&self, error);
    free(self.plan_text);
    row_choice_free(&self.choice);
    options->rows.given = NULL;
    given_rows_free(&self.given);
    reduced_basis_free(&self.basis);
    return status;
}

int main(int argc, char **argv) {
    select_options own = {.rows = {.num_control = CONTROL_BY_ITSELF},
                          .num_jobs = pool_default_workers(),
                          .memory = memory_option_default()};
    const program_options options = {
        .options = own_options,
        .own = &own,
        .arguments_doc = "RESIDUALS.h5 --basis BASIS.h5 -o MODEL.h5",
        .doc = "Selects the Reynolds rows of the online model and writes it.",
        .help_tail = print_methods,
        .min_arguments = 1,
        .max_arguments = 1,
        .needs_output = true};
    return output_main(argc, argv, &options, run, training_check, NULL);
}
