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

#include <math.h>
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

/* Checks that the residuals were made on the grid of this basis and with this basis. */
static ehd_status check_fit(artefact *file, const reduced_basis *basis, const char *basis_path,
                            const char *identity, ehd_error *error) {
    const contact_kind *kind;
    ehd_grid grid;
    char *made_with = NULL;
    ehd_status status = grid_read(&grid, &kind, file, error);

    if (!status) status = grid_check(&grid, artefact_path(file), &basis->grid, basis_path, error);
    if (!status && artefact_has(file, "basis_sha256")) {
        status = artefact_get_text(file, "basis_sha256", &made_with, error);
        if (!status && strcmp(made_with, identity))
            status = ehd_fail(error, EHD_DATA,
                              "%s: basis_sha256: found %.12s..., expected %.12s... of %s: they "
                              "were made with another basis",
                              artefact_path(file), made_with, identity, basis_path);
    }
    free(made_with);
    return status;
}

typedef struct residual_input {
    residual_reader reader; // the reader's file is closed if all snapshots are in memory
    residual_snapshots snapshots;
    char *plan_text; // text of the training plan (`settings` of the file); NULL: no plan
} residual_input;

static void residual_input_close(residual_input *input) {
    artefact_close(&input->reader.file);
    residual_snapshots_free(&input->snapshots);
}

/* Opens the file and reads everything except the snapshots. */
static ehd_status open_residuals(residual_input *input, const char *path,
                                 const reduced_basis *basis, const char *basis_path,
                                 const char *identity, ehd_error *error) {
    const artefact_schema *const kinds[] = {&schema_residuals, NULL};
    residual_snapshots *snapshots = &input->snapshots;
    artefact **file = &input->reader.file;
    ehd_status status = artefact_open(file, path, kinds, error);

    if (!status) status = check_fit(*file, basis, basis_path, identity, error);
    if (!status)
        status = residual_snapshots_init(snapshots, artefact_length(*file, "iteration"),
                                         &input->reader, error);
    for (size_t i = 0; i < snapshots->count && !status; i++)
        snapshots->state[i] = -1;
    if (!status && artefact_has(*file, "iteration_state"))
        status = artefact_get_integers(*file, "iteration_state", snapshots->state, snapshots->count,
                                       error);
    if (!status && artefact_has(*file, "settings"))
        status = artefact_get_text(*file, "settings", &input->plan_text, error);
    return status;
}

/* Plans the memory before the snapshots are read, and prints the plan. If the snapshots do not fit
 * at once, also checks that the planned memory is free. */
static ehd_status plan_memory(row_plan *way, const residual_input *input, const program *self,
                              const reduced_basis *basis, const select_options *options,
                              ehd_error *error) {
    const residual_snapshots *snapshots = &input->snapshots;
    const ehd_status status =
        row_plan_make(way, snapshots, basis, &options->rows, options->memory, error);

    if (status) return status;
    if (way->direct) {
        program_detail(self, "%zu iterations at once, at most %.4g MB of %.4g MB", snapshots->count,
                       way->bytes * 1e-6, way->limit * 1e-6);
        return EHD_OK;
    }
    program_note(self,
                 "%zu iterations of %zu nodes one after the other, in blocks of %zu, with room for "
                 "%zu directions: at most %.4g MB of %.4g MB",
                 snapshots->count, basis->grid.num_inner, way->block, way->max_rank,
                 way->bytes * 1e-6, way->limit * 1e-6);
    return program_check_memory(self->arguments[0], "iterations", snapshots->count, "iterations",
                                " with this --memory", way->bytes, error);
}

/* Reads all snapshots, or prepares the reader to stream them. */
static ehd_status read_residuals(residual_input *input, const program *self,
                                 const reduced_basis *basis, const select_options *options,
                                 ehd_error *error) {
    artefact *file = input->reader.file;
    row_plan way;
    ehd_status status = plan_memory(&way, input, self, basis, options, error);
    if (status) return status;

    if (!way.direct) {
        input->reader.caller = self;
        input->reader.block = way.block;
        input->reader.max_rank = way.max_rank;
        return EHD_OK;
    }
    status = residual_snapshots_hold(&input->snapshots, basis->grid.num_inner, error);
    if (!status)
        status = artefact_get(file, "weighted_residual", input->snapshots.residuals,
                              input->snapshots.count * basis->grid.num_inner, error);
    if (!status)
        status = artefact_get(file, "weighted_jacobian_step", input->snapshots.steps,
                              input->snapshots.count * basis->grid.num_inner, error);
    artefact_close(&input->reader.file);
    return status;
}

// ---- the model

static ehd_status write_model(const program *self, const select_options *options,
                              const reduced_basis *basis, const row_choice *choice,
                              const char *identity, const char *plan_text, ehd_error *error) {
    const row_settings *rows = &options->rows;
    const bool given_factors = rows->given && rows->given->factors;
    const char *const inputs[] = {self->arguments[0], options->basis, options->rows_from, NULL};
    const char *method = rows->given ? "given" : rows->method->name;
    const char *weights = given_factors ? NULL : rows->weights->name;
    const model_origin origin = {.method = method,
                                 .basis_identity = identity,
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
        status = model_write(&model, basis, &origin, self, text, inputs, error);
    if (!status && options->no_check) stage_end(&self->stage);
    if (!status && !options->no_check) {
        const check_task task = {plan_text, self->arguments[0], text, inputs, options->num_jobs};
        status = checked_model_write(worth, &model, basis, &origin, self, &task, error);
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
static ehd_status read_given(given_rows *given, const select_options *options,
                             const reduced_basis *basis, ehd_error *error) {
    ehd_status status = given_rows_read(given, options->rows_from, basis, error);

    if (!status && given->factors && options->rows.weights)
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

static ehd_status run(const program *self, void *own, ehd_error *error) {
    select_options *options = own;
    residual_input input = {0};
    reduced_basis basis = {0};
    given_rows given = {0};
    row_choice choice = {0};
    ehd_error cause = {""};
    char identity[65];
    ehd_status status = check_usage(self, options, error);

    if (!status) status = basis_read(&basis, identity, options->basis, error);
    if (!status && options->rows_from) status = read_given(&given, options, &basis, error);
    if (options->rows_from) options->rows.given = &given;
    if (!options->rows.method) options->rows.method = selection_methods;
    if (!options->rows.weights) options->rows.weights = weightings;
    if (!status)
        status =
            open_residuals(&input, self->arguments[0], &basis, options->basis, identity, error);
    if (!status) status = read_residuals(&input, self, &basis, options, error);
    if (!status) {
        status = row_choice_make(&choice, &input.snapshots, &basis, &options->rows, &cause);
        if (status) ehd_fail(error, status, "%s: %s", self->arguments[0], cause.text);
    }
    residual_input_close(&input); // frees memory for the full solutions of the check
    if (!status)
        status = write_model(self, options, &basis, &choice, identity, input.plan_text, error);
    free(input.plan_text);
    row_choice_free(&choice);
    options->rows.given = NULL;
    given_rows_free(&given);
    reduced_basis_free(&basis);
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
    return output_main(argc, argv, &options, run, training_check);
}
