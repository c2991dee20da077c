/* SPDX-License-Identifier: GPL-3.0-or-later */
/* podbuild: builds bases from training solutions (README.md). The program reads options and files,
 * plans the memory, builds the bases and writes them.
 * Called from the command line, and by the pipelines in scenes. */
#include "common/output/output_main.h"
#include "common/program/memory_option.h"
#include "common/program/program.h"
#include "common/training/training_set.h"
#include "podbuild/bases.h"
#include "podbuild/readers.h"
#include "podbuild/test_weight.h"
#include "romrun/calibrate/accuracy.h"
#include "romrun/model/basis_file.h"

#include <gsl/gsl_sort.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct build_options {
    bases_settings bases;
    const test_weight *weight;
    const char *plan; // argument of --plan; NULL: --plan is not given
    double memory;    // limit of the arrays, bytes
} build_options;

typedef struct build_run {
    const program *caller;
    const build_options *options;
    snapshot_set files;
    bases_plan way;
    reduced_basis basis;
    pod_basis pressure, deformation;
} build_run;

static ehd_status read_deformation(void *member, const char *argument, ehd_error *error) {
    if (name_find(member, deformation_names, argument)) return EHD_OK;
    return ehd_fail(error, EHD_USAGE, "--deformation: found %.40s, expected coupled|independent",
                    argument);
}

// clang-format off
#define OWN_OPTIONS build_options

// columns: name, letter, argument, help, how the argument is read
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
     OPTION_ENTRY(weight, test_weights)},
    {"memory", 0, "SIZE", "Memory that arrays may take, as 2G or 500M; default half of the machine's. Snapshots that "
     "need more are streamed, and read several times", OPTION_READ(memory, memory_option_read)},
    {"compress", 0, NULL, "Write a part: the POD of these snapshots and their states, for bases of several parts, which leave "
     "out no less than --energy of theirs", OPTION_FLAG(bases.as_part)},
    {"plan", 0, "PLAN.yml", "The plan of the training, for weights that evaluate its contacts", OPTION_TEXT(plan)},
    {0}};
// clang-format on

static void print_weights(void) {
    puts("Weights of the Reynolds rows:");
    for (const test_weight *weight = test_weights; weight->name; weight++)
        printf("  %-10s %s\n", weight->name, weight->help);
}

static void print_states(const snapshot_set *files) {
    printf("%zu states on %zu nodes", files->num_states, files->grid.num_inner);
    if (files->num_left_out > 0)
        printf(", %zu left out that had not converged", files->num_left_out);
    putchar('\n');
}

static void report(const build_run *self, const basis_origin *origin) {
    const reduced_basis *basis = &self->basis;
    const char *at_most = self->way.at_once && self->files.num_parts == 0 ? "" : "at most ";

    print_states(&self->files);
    printf("pressure:    %zu modes, last singular value %.1e of the first, energy left out "
           "%s%.1e\n",
           basis->num_pressure,
           origin->pressure_singular_values[basis->num_pressure - 1] /
               origin->pressure_singular_values[0],
           at_most, origin->pressure_energy_discarded);
    if (basis->num_deformation > 0)
        printf("deformation: %zu modes, last singular value %.1e of the first, energy left out "
               "%s%.1e\n",
               basis->num_deformation,
               origin->deformation_singular_values[basis->num_deformation - 1] /
                   origin->deformation_singular_values[0],
               at_most, origin->deformation_energy_discarded);
    else
        printf("deformation: coupled\n");
}

/* If there are as many modes as states, prints the median and the largest distance of a state from
 * the span of the other states. One more state would improve the basis by about this distance.
 * Warns if the median exceeds the default accuracy of results. */
static void report_thinness(const build_run *self) {
    const reduced_states *states = &self->basis.states;
    const double promised = accuracy_limit(0);
    const size_t num = self->files.num_states;
    double *distance = malloc((num + 1) * sizeof *distance);

    if (distance && num > 1 && num == self->files.num_rows && self->pressure.num_modes == num) {
        pod_left_out(distance, &self->pressure, states->coordinates, states->num_unknowns, num);
        gsl_sort(distance, 1, num);
        printf("as many modes as states; distance of a state from the span of the others %.1e "
               "(median), %.1e (worst)\n",
               distance[num / 2], distance[num - 1]);
        if (distance[num / 2] > promised)
            program_warn(
                self->caller,
                "%s: found a training too thin: half of its pressures are further than "
                "%.2g from the span of the others, expected at most %g; add points between "
                "them, or have them chosen in a region (schemas/plan.md)",
                self->caller->arguments[0], distance[num / 2], promised);
    }
    free(distance);
}

/* Computes the weight that --weight names. If a plan is given, reads its contacts, which some
 * weights need. */
static ehd_status weigh(build_run *self, ehd_error *error) {
    const program *caller = self->caller;
    const build_options *options = self->options;
    reduced_basis *basis = &self->basis;
    plan given = {0};
    training_set training = {0};
    ehd_error cause = {""};
    ehd_status status = EHD_OK;

    if (options->plan) {
        status = plan_read(&given, options->plan, caller->overrides, caller->num_overrides, error);
        if (!status)
            status = training_set_init(&training, &given, options->plan, (shard){1, 1}, error);
        if (!status) training_set_take_grid(&training, &basis->grid);
        if (!status)
            status = grid_check(&training.grid, options->plan, &basis->grid, caller->arguments[0],
                                error);
    }
    if (!status) {
        status = options->weight->weigh(basis->weight, basis, training.contacts,
                                        training.num_points, &cause);
        if (status)
            ehd_fail(error, status, "%s: %s", options->plan ? options->plan : caller->arguments[0],
                     cause.text);
    }
    training_set_free(&training);
    plan_free(&given);
    return status;
}

static basis_origin origin_of(const pod_basis *pressure, const pod_basis *deformation) {
    return (basis_origin){
        .pressure_singular_values = pressure->singular_values,
        .num_pressure_values = pressure->num_singular_values,
        .pressure_energy_discarded = pod_discarded(pressure),
        .deformation_singular_values = deformation->singular_values,
        .num_deformation_values = deformation->num_singular_values,
        .deformation_energy_discarded = pod_discarded(deformation),
    };
}

static ehd_status write_basis(const build_run *self, const basis_origin *origin, ehd_error *error) {
    const bases_settings *settings = &self->options->bases;
    char text[256];

    snprintf(text, sizeof text,
             "deformation: %s\npressure-modes: %zu\ndeformation-modes: %zu\nenergy: "
             "%g\nweight: %s\n",
             deformation_names[settings->kind], settings->pressure.num_modes,
             settings->deformation.num_modes, settings->pressure.discarded_energy,
             self->options->weight->name);
    return basis_write(&self->basis, origin, self->caller, text, self->caller->arguments, error);
}

static ehd_status write_part(const build_run *self, ehd_error *error) {
    const pod_basis *modes = &self->pressure;
    const part_origin origin = {.num_snapshots = self->files.num_rows,
                                .num_left_out = self->files.num_left_out,
                                .energy = modes->energy,
                                .discarded = pod_discarded(modes),
                                .singular_values = modes->singular_values};
    char text[64];

    snprintf(text, sizeof text, "compress: true\nenergy: %g\n",
             self->options->bases.pressure.discarded_energy);
    return part_write(&self->basis, &origin, self->caller, text, self->caller->arguments, error);
}

/* Refuses part files as input of --compress and of --deformation independent. A part file holds
 * snapshots that an earlier run with --compress has compressed. */
static ehd_status check_parts(const snapshot_set *files, const build_options *options,
                              ehd_error *error) {
    const snapshot_source *source = files->sources;

    if (files->num_parts == 0) return EHD_OK;
    while (!source->is_part)
        source++;
    if (options->bases.as_part)
        return ehd_fail(error, EHD_DATA, "%s: found a part, expected snapshots with --compress",
                        source->path);
    if (options->bases.kind == DEFORMATION_INDEPENDENT)
        return ehd_fail(error, EHD_DATA,
                        "%s: found a part, expected snapshots with --deformation independent: what "
                        "parts leave out is known of pressures only",
                        source->path);
    return EHD_OK;
}

/* Plans the memory before the snapshots are read, and prints the plan. If the snapshots are
 * streamed, checks that the planned memory is free. */
static ehd_status plan_memory(build_run *self, ehd_error *error) {
    const build_options *options = self->options;
    const snapshot_set *files = &self->files;
    bases_plan *way = &self->way;
    ehd_status status = check_parts(files, options, error);

    if (!status) status = bases_plan_make(way, files, &options->bases, options->memory, error);
    if (status) return status;
    if (way->at_once) {
        program_detail(self->caller, "%zu snapshots at once, at most %.4g MB of %.4g MB",
                       files->num_rows, way->bytes * 1e-6, way->limit * 1e-6);
        return EHD_OK;
    }
    program_note(self->caller,
                 "%zu snapshots of %zu nodes one after the other, in blocks of %zu, with room for "
                 "%zu directions: at most %.4g MB of %.4g MB",
                 files->num_rows, files->grid.num_nodes, way->stream.block, way->stream.max_rank,
                 way->bytes * 1e-6, way->limit * 1e-6);
    return program_check_memory(self->caller->arguments[0], "snapshots", files->num_rows,
                                "snapshots", " with this --memory", way->bytes, error);
}

static ehd_status finish_basis(build_run *self, ehd_error *error) {
    const basis_origin origin = origin_of(&self->pressure, &self->deformation);
    ehd_status status = weigh(self, error);

    if (!status) status = write_basis(self, &origin, error);
    if (!status) report(self, &origin);
    if (!status) report_thinness(self);
    return status;
}

static ehd_status finish_part(const build_run *self, ehd_error *error) {
    const ehd_status status = write_part(self, error);

    if (status) return status;
    print_states(&self->files);
    printf("compressed:  %zu modes of %zu snapshots, energy left out at most %.1e\n",
           self->pressure.num_modes, self->files.num_rows, pod_discarded(&self->pressure));
    return EHD_OK;
}

static ehd_status build(const program *caller, const build_options *options, ehd_error *error) {
    build_run self = {.caller = caller, .options = options};
    ehd_status status =
        snapshot_set_open(&self.files, caller->arguments, caller->num_arguments, error);

    if (!status) status = plan_memory(&self, error);
    if (!status)
        status = bases_build(&self.basis, &self.pressure, &self.deformation, &self.files,
                             &options->bases, &self.way, self.way.at_once ? NULL : caller, error);
    if (!status)
        status = options->bases.as_part ? finish_part(&self, error) : finish_basis(&self, error);
    pod_free(&self.pressure);
    pod_free(&self.deformation);
    reduced_basis_free(&self.basis);
    snapshot_set_close(&self.files);
    return status;
}

/* Refuses options of bases together with --compress. */
static ehd_status check_compress(const program *self, ehd_error *error) {
    static const char *const of_bases[] = {"pressure-modes", "deformation-modes", "deformation",
                                           "weight", "plan"};

    for (size_t i = 0; i < sizeof of_bases / sizeof *of_bases; i++)
        if (program_was_given(self, of_bases[i]))
            return ehd_fail(error, EHD_USAGE,
                            "--%s: found it with --compress, expected it where the parts are put "
                            "together",
                            of_bases[i]);
    return EHD_OK;
}

/* Refuses options that exclude each other. */
static ehd_status check_usage(const program *self, const build_options *options, ehd_error *error) {
    const bases_settings *bases = &options->bases;

    if (options->weight->needs_contacts != (options->plan != NULL))
        return ehd_fail(error, EHD_USAGE, "--plan: found %s with --weight %s, expected %s",
                        options->plan ? options->plan : "none", options->weight->name,
                        options->plan ? "none" : "the plan of the training");
    if (bases->kind == DEFORMATION_COUPLED && bases->deformation.num_modes > 0)
        return ehd_fail(error, EHD_USAGE,
                        "--deformation-modes: found %zu with a coupled basis, expected "
                        "--deformation independent",
                        bases->deformation.num_modes);
    return bases->as_part ? check_compress(self, error) : EHD_OK;
}

static ehd_status run(const program *self, void *own, ehd_error *error) {
    build_options *options = own;
    bases_settings *bases = &options->bases;

    bases->deformation.discarded_energy = bases->pressure.discarded_energy;
    bases->exact = bases->pressure.num_modes > 0 && !program_was_given(self, "energy");
    ehd_status status = check_usage(self, options, error);
    if (!status) status = build(self, options, error);
    if (!status) stage_end(&self->stage);
    return status;
}

int main(int argc, char **argv) {
    build_options own = {.bases = {.pressure.discarded_energy = 1e-13, .kind = DEFORMATION_COUPLED},
                         .weight = test_weights,
                         .memory = memory_option_default()};
    const program_options options = {.options = own_options,
                                     .own = &own,
                                     .arguments_doc = "SNAPSHOTS.h5|PART.h5... -o BASIS.h5|PART.h5",
                                     .doc = "Builds trial and test bases of training solutions.",
                                     .help_tail = print_weights,
                                     .min_arguments = 1,
                                     .max_arguments = SIZE_MAX,
                                     .needs_output = true};
    return output_main(argc, argv, &options, run, training_check, NULL);
}
