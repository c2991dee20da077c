/* SPDX-License-Identifier: GPL-3.0-or-later */
/* podbuild: bases of training solutions. */
#include "common/output/check.h"
#include "common/output/print.h"
#include "common/output/vtk.h"
#include "common/program/program.h"
#include "common/training/training_set.h"
#include "podbuild/bases.h"
#include "podbuild/readers.h"
#include "podbuild/test_weight.h"
#include "romrun/calibrate/accuracy.h"
#include "romrun/model/basis_file.h"

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct build_options {
    bases_settings bases;
    const test_weight *weight;
    const char *plan; // NULL: none
} build_options;

static ehd_status read_weight(void *member, const char *argument, ehd_error *error) {
    const test_weight **weight = member;

    *weight = test_weight_find(argument);
    if (*weight) return EHD_OK;
    return ehd_fail(error, EHD_USAGE, "--weight: found %.40s, expected one of --help", argument);
}

static ehd_status read_deformation(void *member, const char *argument, ehd_error *error) {
    deformation_kind *kind = member;

    for (int i = 0; deformation_names[i]; i++)
        if (strcmp(argument, deformation_names[i]) == 0) {
            *kind = (deformation_kind)i;
            return EHD_OK;
        }
    return ehd_fail(error, EHD_USAGE, "--deformation: found %.40s, expected coupled|independent",
                    argument);
}

// clang-format off
#define OWN_OPTIONS build_options

// columns: name, letter, argument, help, how it is read
static const program_option own_options[] = {
    {"pressure-modes", 0, "N", "Number of pressure modes; by default as --energy asks",
     OPTION_COUNT(bases.pressure.num_modes, 1, 100000)},
    {"deformation-modes", 0, "N", "Number of deformation modes (independent only); by default as --energy asks",
     OPTION_COUNT(bases.deformation.num_modes, 1, 100000)},
    {"energy", 0, "TOL", "Part of the squared singular values that may be left out; default 1e-13",
     OPTION_REAL(bases.pressure.discarded_energy, 0, 0.999)},
    {"deformation", 0, "KIND", "coupled: deflections of the pressure modes (default); independent: modes of "
     "their own, as published", OPTION_READ(bases.kind, read_deformation)},
    {"weight", 0, "NAME", "Weight of the Reynolds rows: mode (default), identity, row-norm; see below",
     OPTION_READ(weight, read_weight)},
    {"plan", 0, "PLAN.yml", "The plan of the training, for weights that evaluate its contacts", OPTION_TEXT(plan)},
    {0}};
// clang-format on

static void print_weights(void) {
    puts("Weights of the Reynolds rows:");
    for (const test_weight *weight = test_weights; weight->name; weight++)
        printf("  %-10s %s\n", weight->name, weight->help);
}

static void report(const reduced_basis *basis, const basis_origin *origin,
                   const snapshot_set *set) {
    printf("%zu states on %zu nodes", set->num_states, set->grid.num_inner);
    if (set->num_left_out > 0) printf(", %zu left out that had not converged", set->num_left_out);
    printf(
        "\npressure:    %zu modes, last singular value %.1e of the first, energy left out %.1e\n",
        basis->num_pressure,
        origin->pressure_singular_values[basis->num_pressure - 1] /
            origin->pressure_singular_values[0],
        origin->pressure_energy_discarded);
    if (basis->num_deformation > 0)
        printf("deformation: %zu modes, last singular value %.1e of the first, energy left out "
               "%.1e\n",
               basis->num_deformation,
               origin->deformation_singular_values[basis->num_deformation - 1] /
                   origin->deformation_singular_values[0],
               origin->deformation_energy_discarded);
    else
        printf("deformation: coupled\n");
}

static int compare_doubles(const void *a, const void *b) {
    double p = *(const double *)a, q = *(const double *)b;

    return (p > q) - (p < q);
}

/* With as many modes as states more states would tell more: how much, is told by how well each is
 * told by the others. A warning where that is worse than what results are promised to be. */
static void report_thinness(const program *self, const pod_basis *pressure,
                            const snapshot_set *set) {
    const double promised = accuracy_limit(0);
    const size_t num = set->num_states;
    double *distance = malloc((num + 1) * sizeof *distance);

    if (distance && num > 1 && num == set->num_snapshots && pressure->num_modes == num) {
        pod_left_out(distance, pressure, set->pressure, num);
        qsort(distance, num, sizeof *distance, compare_doubles);
        printf("as many modes as states; each state is told by the others to %.1e (median), %.1e "
               "(worst)\n",
               distance[num / 2], distance[num - 1]);
        if (distance[num / 2] > promised)
            program_warn(self,
                         "%s: found a training too thin: half of its pressures are further than "
                         "%.2g from what the others tell, expected at most %g; add points between "
                         "them, or have them chosen in a region (schemas/plan.md)",
                         self->arguments[0], distance[num / 2], promised);
    }
    free(distance);
}

/* Another weight than that of the first mode. */
static ehd_status weigh(reduced_basis *basis, const program *self, const build_options *options,
                        ehd_error *error) {
    plan given = {0};
    training_set training = {0};
    ehd_error cause = {""};
    ehd_status status = EHD_OK;

    if (options->plan) {
        status = plan_read(&given, options->plan, self->overrides, self->num_overrides, error);
        if (!status)
            status = training_set_init(&training, &given, options->plan, (shard){1, 1}, error);
        if (!status) training_set_take_grid(&training, &basis->grid);
        if (!status)
            status =
                grid_check(&training.grid, options->plan, &basis->grid, self->arguments[0], error);
    }
    if (!status) {
        status = options->weight->weigh(basis->weight, basis, training.contacts,
                                        training.num_points, &cause);
        if (status)
            ehd_fail(error, status, "%s: %s", options->plan ? options->plan : self->arguments[0],
                     cause.text);
    }
    training_set_free(&training);
    plan_free(&given);
    return status;
}

static ehd_status build(const program *self, const build_options *options, ehd_error *error) {
    const bases_settings *settings = &options->bases;
    snapshot_set set = {0};
    reduced_basis basis = {0};
    pod_basis pressure = {0}, deformation = {0};
    ehd_status status = snapshot_set_read(&set, self->arguments, self->num_arguments, error);
    const char **inputs = calloc(self->num_arguments + 1, sizeof *inputs);
    ehd_error cause = {""};
    char text[256];

    if (!status && !inputs) status = ehd_fail(error, EHD_MEMORY, "podbuild: found no memory");
    if (!status) {
        status = bases_build(&basis, &pressure, &deformation, &set, settings, &cause);
        if (status) ehd_fail(error, status, "%s: %s", self->arguments[0], cause.text);
    }
    if (!status) status = weigh(&basis, self, options, error);
    if (!status) {
        const basis_origin origin = {
            pressure.singular_values,          pressure.num_singular_values,
            bases_energy_discarded(&pressure), deformation.singular_values,
            deformation.num_singular_values,   bases_energy_discarded(&deformation)};
        memcpy(inputs, self->arguments, self->num_arguments * sizeof *inputs);
        snprintf(text, sizeof text,
                 "deformation: %s\npressure-modes: %zu\ndeformation-modes: %zu\nenergy: "
                 "%g\nweight: %s\n",
                 deformation_names[settings->kind], settings->pressure.num_modes,
                 settings->deformation.num_modes, settings->pressure.discarded_energy,
                 options->weight->name);
        status = basis_write(&basis, &origin, self, text, inputs, error);
        if (!status) report(&basis, &origin, &set);
        if (!status) report_thinness(self, &pressure, &set);
    }
    free(inputs);
    pod_free(&pressure);
    pod_free(&deformation);
    reduced_basis_free(&basis);
    snapshot_set_free(&set);
    return status;
}

int main(int argc, char **argv) {
    build_options own = {.bases = {{.discarded_energy = 1e-13}, {0}, DEFORMATION_COUPLED},
                         .weight = test_weights};
    const program_options options = {.options = own_options,
                                     .own = &own,
                                     .arguments_doc = "SNAPSHOTS.h5... -o BASIS.h5",
                                     .doc = "Builds trial and test bases of training solutions.",
                                     .help_tail = print_weights,
                                     .min_arguments = 1,
                                     .max_arguments = SIZE_MAX,
                                     .needs_output = true};
    ehd_error error = {""};
    program self;

    program_start(&self, argc, argv, &options);
    if (self.check) return output_check(&self, training_readers);
    if (self.print) return output_print(&self);
    if (self.vtk) return output_vtk(&self);
    own.bases.deformation.discarded_energy = own.bases.pressure.discarded_energy;
    if (own.weight->needs_contacts != (own.plan != NULL))
        return program_finish(&self,
                              ehd_fail(&error, EHD_USAGE,
                                       "--plan: found %s with --weight %s, expected %s",
                                       own.plan ? own.plan : "none", own.weight->name,
                                       own.plan ? "none" : "the plan of the training"),
                              &error);
    if (own.bases.kind == DEFORMATION_COUPLED && own.bases.deformation.num_modes > 0)
        return program_finish(&self,
                              ehd_fail(&error, EHD_USAGE,
                                       "--deformation-modes: found %zu with a coupled basis, "
                                       "expected --deformation independent",
                                       own.bases.deformation.num_modes),
                              &error);
    ehd_status status = build(&self, &own, &error);
    if (!status) stage_end(&self.stage);
    return program_finish(&self, status, &error);
}
