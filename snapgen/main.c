/* SPDX-License-Identifier: GPL-3.0-or-later */
/* snapgen: runs a training plan (README.md). It reads options and the plan, runs the training that
 * they define, and writes snapshots or residuals.
 * Called from the command line, and by the pipelines in scenes. */
#include "common/output/grid_file.h"
#include "common/output/output_main.h"
#include "common/program/output_file.h"
#include "common/program/program.h"
#include "common/settings/part_list.h"
#include "common/settings/scene.h"
#include "common/settings/scene_contact.h"
#include "common/training/pool.h"
#include "fullrun/training.h"
#include "podbuild/readers.h"
#include "snapgen/adaptive.h"
#include "snapgen/region_parts.h"
#include "snapgen/residuals.h"
#include "snapgen/snapshots.h"
#include "snapgen/trajectory.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef struct snapgen_options {
    size_t num_jobs;
    shard piece;
    bool resume;
    size_t allowed_failures;
    bool cold;
    const char *basis; // NULL: full model
    bool adaptive;
    adaptive_settings how;
    bool only_choose;
    const char *chosen_in;
    const char *parts;
    size_t num_parts;
} snapgen_options;

static ehd_status read_shard(void *member, const char *text, ehd_error *error) {
    shard *piece = member;
    const char *slash = strchr(text, '/');
    char number[SHOWN_TEXT];

    if (!slash || (size_t)(slash - text) >= sizeof number) {
        text_show(number, text);
        return ehd_fail(error, EHD_USAGE, "--shard: found %s, expected k/N such as 1/4", number);
    }
    memcpy(number, text, (size_t)(slash - text));
    number[slash - text] = '\0';
    ehd_status status =
        parse_count(&piece->total, slash + 1, 1, 1000000, "--shard", EHD_USAGE, error);
    if (status) return status;
    return parse_count(&piece->number, number, 1, piece->total, "--shard", EHD_USAGE, error);
}

// clang-format off
#define OWN_OPTIONS snapgen_options

// columns: name, letter, argument, help, how it is read
static const program_option own_options[] = {
    {"jobs", 'j', "N", "Points at a time; as many as there are processors by default. Changes no result",
     OPTION_COUNT(num_jobs, 1, 4096)},
    {"shard", 0, "k/N", "Only the k-th of N pieces of the plan, or of --chosen-in, each with an output of its own",
     OPTION_READ(piece, read_shard)},
    {"resume", 0, NULL, "Continue an interrupted run of the same plan, where there is one; trajectories start "
     "anew", OPTION_FLAG(resume)},
    {"allow-failures", 0, "N", "Points that may fail before the exit code is 3, but never all; default 0, and "
     "with --basis any number", OPTION_COUNT(allowed_failures, 0, 1e15)},
    {"cold", 0, NULL, "Start every stationary point cold, not from its neighbour: slower, and what `fullrun` "
     "does with each", OPTION_FLAG(cold)},
    {"basis", 0, "BASIS.h5", "Repeat the plan with the projected system and write the snapshots of its "
     "residuals, for deimselect; points that do not converge count as long as they have iterations",
     OPTION_TEXT(basis)},
    {"adaptive", 0, NULL, "Train on as many points of the plan as are needed, where they are needed, until a "
     "reduced model is accurate at all others, and at some that are solved as a check; with --basis: only on the "
     "points that the basis was made of. A plan with a region is trained so anyway, one of histories alone on "
     "all of them",
     OPTION_FLAG(adaptive)},
    {"accuracy", 0, "X", "Adaptive: wanted relative deviation of central and minimum film; default 1e-3",
     OPTION_REAL(how.accuracy, 1e-12, 1)},
    {"start", 0, "N", "Adaptive: points of the first round, corners of the region and more between them; "
     "default 20", OPTION_COUNT(how.start, 3, 1000000)},
    {"batch", 0, "N", "Adaptive: points of each further round; default a fifth of those before",
     OPTION_COUNT(how.batch, 1, 1000000)},
    {"max-points", 0, "N", "Adaptive: points in all; default those of the plan",
     OPTION_COUNT(how.max_points, 3, 1000000)},
    {"most", .type = AS_ALIAS}, // earlier name of max-points
    {"energy", 0, "TOL", "Adaptive: as podbuild --energy, of the models on the way; default 1e-18",
     OPTION_REAL(how.discarded_energy, 0, 0.999)},
    {"choose", 0, NULL, "Adaptive: solve nothing; take over what PIECEs have solved of the last round and, when it is whole, "
     "choose the points of the next one, for --chosen-in, or end", OPTION_FLAG(only_choose)},
    {"chosen-in", 0, "FILE", "Adaptive: solve what --choose has left in FILE, a SNAPSHOTS.h5.partial, or the --shard k/N "
     "of it, as a PIECE", OPTION_TEXT(chosen_in)},
    {"parts", 0, "LIST", "Adaptive: where the region is too wide for one model, leave its training, and write plans for two "
     "parts of it, and their list, in place of the output", OPTION_TEXT(parts)},
    {"num-parts", 0, "N", "Solve nothing: write plans for N parts of the region, and their list as the output",
     OPTION_COUNT(num_parts, 2, MAX_PARTS)},
    {0}};
// clang-format on

static void print_settings(void) {
    puts("A plan is a list of groups, each a scene and what varies in it (schemas/plan.md).");
    scene_print_help(stdout);
}

// ---- the training

/* Warns of the first point with an implausible quantity, and names the quantity. */
static void warn_implausible(const program *self, const training_set *set, const plan *given) {
    char text[PLAUSIBLE_TEXT], name[POINT_NAME];
    size_t p = 0;

    while (p < set->num_points &&
           scene_judge(text, &set->contacts[p], &given->points[set->numbers[p]].scene) == PLAUSIBLE)
        p++;
    if (p == set->num_points) return;
    training_point_name(name, &set->contacts[p]);
    program_warn(self, "%s: point %s: %s", self->arguments[0], name, text);
}

/* Reads the plan and makes its points. Also sets `adaptive` if the plan has a region. */
static ehd_status load_set(training_set *set, bool *adaptive, const program *self, shard piece,
                           ehd_error *error) {
    const char *path = self->arguments[0];
    plan given;
    ehd_status status = plan_read(&given, path, self->overrides, self->num_overrides, error);
    if (status) return status;

    *adaptive = *adaptive || given.has_region;
    status = training_set_init(set, &given, path, piece, error);
    if (!status && set->num_dropped > 0)
        program_note(self, "%s: %zu of %zu points lie outside of the bounds and are left out", path,
                     set->num_dropped, given.num_points);
    if (!status) warn_implausible(self, set, &given);
    plan_free(&given);
    return status;
}

static ehd_status open_output(artefact **file, training *points, const program *self, bool resume,
                              ehd_error *error) {
    if (resume) {
        ehd_status status = snapshots_resume(file, points, self, error);
        if (status != EHD_NOINPUT) {
            if (!status)
                program_note(self, "%s.partial: %zu of %zu points are done", self->output,
                             points->num_done, points->set->num_points);
            return status;
        }
    }
    return snapshots_create(file, self, points->set, self->arguments[0], error);
}

static ehd_status stopped(const program *self, const training *points, ehd_error *error) {
    return ehd_fail(error, EHD_INTERRUPTED,
                    "%s.partial: found an interruption after %zu of %zu points, expected --resume "
                    "to continue",
                    self->output, points->num_done, points->set->num_points);
}

static ehd_status check_failures(const program *self, size_t num_failed, size_t num_points,
                                 size_t allowed, ehd_error *error) {
    if (num_failed <= allowed) return EHD_OK;
    return ehd_fail(error, EHD_NOT_CONVERGED,
                    "%s: found %zu of %zu points not converged, expected at most %zu "
                    "(--allow-failures)",
                    self->arguments[0], num_failed, num_points, allowed);
}

/* Returns any contact of a set. */
static const ehd_contact *set_contact(const training_set *set) {
    return set->num_points > 0 ? set->contacts : &set->trajectories->contact;
}

/* Prints a summary of the result. EHD_NOT_CONVERGED: more points failed than allowed. */
static ehd_status report(const program *self, const training *points, const trajectories *trained,
                         size_t allowed, double seconds, ehd_error *error) {
    size_t num_points = points->set->num_points + trained->num_trajectories;
    size_t num_failed = points->num_failed + trained->num_failed;

    printf("%zu points, %zu converged, %.1f s\n", num_points, num_points - num_failed, seconds);
    grid_print(set_contact(points->set), "all points");
    if (trained->num_trajectories > 0)
        printf("%zu of them trajectories with %zu steps, compressed to %zu snapshots\n",
               trained->num_trajectories, trained->num_steps, trained->first.num_modes);
    return check_failures(self, num_failed, num_points, allowed, error);
}

static ehd_status train_all(const program *self, const training_set *set,
                            const snapgen_options *options, ehd_error *error) {
    const double before = program_seconds();
    training points = {0};
    trajectories trained = {0};
    artefact *file = NULL;
    ehd_status status = training_init(&points, self, set, error);

    if (!status) status = open_output(&file, &points, self, options->resume, error);
    if (!status) {
        points.store = snapshots_store;
        points.sink = file;
        points.with_effects = true;
        points.rest = set->num_trajectories > 0 ? NAN : 0;
        status = training_run(&points, options->num_jobs, error);
        if (!status && set->num_trajectories > 0)
            status = trajectories_train(&trained, self, set, options->num_jobs, error);
        if (status == EHD_INTERRUPTED) stopped(self, &points, error);
    }
    if (!status)
        status = training_check_outcome(set, points.num_failed + trained.num_failed,
                                        self->arguments[0], error);
    if (!status && set->num_trajectories > 0)
        status = snapshots_put_trajectories(file, set, &trained, error);
    if (!status) status = artefact_finish(&file, error);
    if (!status)
        status = report(self, &points, &trained, options->allowed_failures,
                        program_seconds() - before, error);
    artefact_close(&file);
    trajectories_free(&trained);
    training_free(&points);
    return status;
}

/* Returns an option that was given and needs --adaptive, or NULL. */
static const char *option_of_adaptive(const program *self) {
    static const char *const names[] = {"accuracy", "start",  "batch",     "max-points",
                                        "energy",   "choose", "chosen-in", "parts"};

    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (program_was_given(self, names[i])) return names[i];
    return NULL;
}

/* Checks the options of a training in pieces. EHD_USAGE. */
static ehd_status check_parts(const program *self, const snapgen_options *options,
                              ehd_error *error) {
    if (options->only_choose && options->chosen_in)
        return ehd_fail(
            error, EHD_USAGE,
            "--choose: found with --chosen-in, expected one of them: points are chosen, "
            "then solved");
    if (self->num_arguments > 1 && !options->only_choose)
        return ehd_fail(error, EHD_USAGE,
                        "command line: found %zu files, expected pieces with --choose only",
                        self->num_arguments);
    return EHD_OK;
}

/* Checks whether the options fit the kind of training. EHD_USAGE. */
static ehd_status check_training(const program *self, const snapgen_options *options, bool adaptive,
                                 ehd_error *error) {
    const char *of_adaptive = option_of_adaptive(self);

    if (adaptive && options->piece.total > 1 && !options->chosen_in)
        return ehd_fail(error, EHD_USAGE,
                        "--shard: found with %s, expected one of them: which points are needed "
                        "depends on all others (--choose and --chosen-in)",
                        options->adaptive ? "--adaptive" : "a region");
    if (of_adaptive && !adaptive)
        return ehd_fail(error, EHD_USAGE,
                        "--%s: found without --adaptive and for a plan without a region, "
                        "expected one of the two",
                        of_adaptive);
    return EHD_OK;
}

static ehd_status train_adaptively(const program *self, training_set *set,
                                   const snapgen_options *options, ehd_error *error) {
    adaptive_settings how = options->how;
    const adaptive_task task = {.set = set,
                                .plan_path = self->arguments[0],
                                .settings = &how,
                                .resume = options->resume,
                                .allowed_failures = options->allowed_failures,
                                .num_workers = options->num_jobs,
                                .only_choose = options->only_choose,
                                .pieces = self->arguments + 1,
                                .num_pieces = self->num_arguments - 1,
                                .parts = options->parts,
                                .chosen_in = options->chosen_in,
                                .piece = options->piece};

    how.cold = options->cold;
    if (options->parts) {
        const ehd_status status = output_file_check(options->parts, self->force, error);
        if (status) return status;
    }
    return options->chosen_in ? adaptive_solve(self, &task, error)
                              : adaptive_train(self, &task, error);
}

/* Writes plans for parts with equally many candidates. */
static ehd_status write_parts(const program *self, const training_set *set, size_t num_parts,
                              ehd_error *error) {
    const parts_request request = {.plan_path = self->arguments[0],
                                   .set = set,
                                   .num_points = set->num_points,
                                   .num_parts = num_parts,
                                   .force = self->force};

    return parts_write(&request, self->output, error);
}

/* Runs the first mode: the full model solves all points, or as many as adaptive training needs. */
static ehd_status train(const program *self, const snapgen_options *options, ehd_error *error) {
    const char *plan_path = self->arguments[0];
    const shard whole = {1, 1};
    training_set set = {0};
    bool adaptive = options->adaptive;
    const bool any_piece = adaptive || options->chosen_in;
    ehd_status status = check_parts(self, options, error);

    if (!status)
        status = load_set(&set, &adaptive, self, any_piece ? whole : options->piece, error);
    if (!status) status = check_training(self, options, adaptive, error);
    if (!status && options->num_parts > 0) {
        status = write_parts(self, &set, options->num_parts, error);
        training_set_free(&set);
        return status;
    }
    if (!status && adaptive && set.num_points == 0 && !options->only_choose &&
        !options->chosen_in) {
        program_note(self, "%s: all %zu histories are solved; points are chosen of stationary ones",
                     plan_path, set.num_trajectories);
        adaptive = false;
    }
    if (!status && options->cold) status = training_set_make_cold(&set, plan_path, error);
    if (!status) status = training_check_memory(&set, self, plan_path, options->num_jobs, error);
    if (!status)
        status = adaptive ? train_adaptively(self, &set, options, error)
                          : train_all(self, &set, options, error);
    training_set_free(&set);
    return status;
}

/* Checks the options of the second mode. EHD_USAGE. */
static ehd_status check_repetition(const program *self, const snapgen_options *options,
                                   ehd_error *error) {
    const char *of_adaptive = option_of_adaptive(self);
    const struct {
        bool given;
        const char *option, *other, *reason;
    } excluded[] = {
        {options->num_parts > 0, "num-parts", "basis", "it solves nothing"},
        {options->piece.total > 1, "basis", "shard", "the whole plan is one file"},
        {options->resume, "resume", "basis", "the projected system is done in seconds"},
        {of_adaptive, of_adaptive, "basis", "the points are chosen before the basis is made"},
        {options->cold, "cold", "basis", "the projected system starts from the snapshots"}};

    if (self->num_arguments > 1 && check_parts(self, options, error)) return EHD_USAGE;
    for (size_t i = 0; i < sizeof excluded / sizeof *excluded; i++)
        if (excluded[i].given)
            return ehd_fail(error, EHD_USAGE, "--%s: found with --%s, expected one of them: %s",
                            excluded[i].option, excluded[i].other, excluded[i].reason);
    return EHD_OK;
}

/* Runs the second mode: solves the points of the plan with the projected system. */
static ehd_status repeat(const program *self, const snapgen_options *options, ehd_error *error) {
    const double before = program_seconds();
    size_t num_failed = 0;
    training_set set = {0};
    bool adaptive = options->adaptive;
    ehd_status status = check_repetition(self, options, error);

    if (!status) status = load_set(&set, &adaptive, self, options->piece, error);
    if (!status)
        status = residuals_run(&num_failed, self, &set, self->arguments[0], options->basis,
                               adaptive && set.num_points > 0, options->num_jobs, error);
    const size_t num_points = set.num_points + set.num_trajectories;
    if (!status)
        printf("%zu points with the projected system, %zu converged, %.1f s\n", num_points,
               num_points - num_failed, program_seconds() - before);
    if (!status && program_was_given(self, "allow-failures"))
        status = check_failures(self, num_failed, num_points, options->allowed_failures, error);
    training_set_free(&set);
    return status;
}

static ehd_status run(const program *self, void *own, ehd_error *error) {
    const snapgen_options *options = own;
    ehd_status status = options->basis ? repeat(self, options, error) : train(self, options, error);

    if (!status) stage_end(&self->stage);
    return status;
}

int main(int argc, char **argv) {
    snapgen_options own = {
        .num_jobs = pool_default_workers(), .piece = {1, 1}, .how = adaptive_default_settings()};
    const program_options options = {.options = own_options,
                                     .own = &own,
                                     .arguments_doc =
                                         "PLAN.yml -o SNAPSHOTS.h5\nPLAN.yml --adaptive -o "
                                         "SNAPSHOTS.h5\nPLAN.yml --choose [PIECE.h5...] -o "
                                         "SNAPSHOTS.h5\nPLAN.yml --chosen-in S.h5.partial -o "
                                         "PIECE.h5\nPLAN.yml --basis BASIS.h5 -o RESIDUALS.h5",
                                     .doc = "Solves all points of a training plan.",
                                     .help_tail = print_settings,
                                     .min_arguments = 1,
                                     .max_arguments = SIZE_MAX,
                                     .needs_output = true};
    return output_main(argc, argv, &options, run, training_check, NULL);
}
