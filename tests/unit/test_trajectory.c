/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results of training on trajectories: the snapshots of all steps in a compressed form, and a few
 * states that are kept unchanged. */
#include "fullrun/full_march.h"
#include "podbuild/pod.h"
#include "snapgen/trajectory.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"

#include <cblas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// ---- plans of trajectories, of which one cannot reach its end

static const char usual_scene[] =
    "contact: line\nregime: transient\ntransport: upwind\nmoes: {M: 20, L: 6}\n"
    "lubricant: {viscosity: {law: barus, alpha: 2e-8}, density: {law: dowson-higginson}}\n"
    "grid: {x_min: -4, x_max: 2, step: 0.05}\n"
    "transient: {end_time: 1, fixed_step: 0.01, load: {law: sine, amplitude: 0.2, period: 1}}\n";

/* Makes a training set of the scene. `vary` gives several values for one key. */
static void make_set(training_set *set, const char *vary) {
    FILE *file = fopen("scene.yml", "w");
    plan given;
    ehd_error error = {""};

    assert_non_null(file);
    assert_true(fputs(usual_scene, file) >= 0);
    assert_int_equal(fclose(file), 0);
    file = fopen("plan.yml", "w");
    assert_non_null(file);
    fprintf(file, "groups:\n  - scene: scene.yml\n    vary: {%s}\n", vary);
    assert_int_equal(fclose(file), 0);
    if (plan_read(&given, "plan.yml", NULL, 0, &error) ||
        training_set_init(set, &given, "plan.yml", (shard){1, 1}, &error))
        fail_msg("%s", error.text);
    plan_free(&given);
}

static void train(trajectories *trained, const training_set *set, size_t num_workers) {
    const program caller = {.name = "test", .quiet = true};
    ehd_error error = {""};

    if (trajectories_train(trained, &caller, set, num_workers, &error)) fail_msg("%s", error.text);
}

// ---- all steps of the trajectories

typedef struct all_steps {
    full_march *full;
    size_t num_nodes, count, capacity;
    double *pressure; // [count, num_nodes]
    size_t least_exit, most_exit;
} all_steps;

static ehd_status keep_step(void *sink, const march_step *step, size_t index, ehd_error *error) {
    all_steps *self = sink;
    const full_state *state = full_march_state(self->full, NULL);
    (void)step, (void)index, (void)error;

    if (self->count == self->capacity) {
        self->capacity = 2 * self->capacity + 64;
        self->pressure = realloc(self->pressure, self->capacity * self->num_nodes * sizeof(double));
        assert_non_null(self->pressure);
    }
    memcpy(self->pressure + self->count++ * self->num_nodes, state->pressure,
           self->num_nodes * sizeof(double));
    if (state->exit < self->least_exit) self->least_exit = state->exit;
    if (state->exit > self->most_exit) self->most_exit = state->exit;
    return EHD_OK;
}

static void add_trajectory(all_steps *steps, const trajectory_scene *of) {
    full_settings settings = full_default_settings();
    ehd_histories *histories;
    march_step first;
    ehd_status outcome;
    ehd_error error = {""};

    settings.tolerance = 1e-12;
    assert_int_equal(histories_init(&histories, &of->scene, &error), EHD_OK);
    assert_int_equal(full_march_create(&steps->full, &of->contact, &settings, NAN, &error), EHD_OK);
    march run = {.settings = march_settings_of(&of->scene, histories, NAN),
                 .histories = histories,
                 .reference = &of->contact,
                 .solver = full_march_solver(steps->full),
                 .store = keep_step,
                 .sink = steps};
    assert_int_equal(march_begin(&first, &run, &error), EHD_OK);
    assert_int_equal(keep_step(steps, &first, 0, &error), EHD_OK);
    assert_int_equal(march_run(&outcome, &run, &error), EHD_OK);
    assert_int_equal(outcome, EHD_OK);
    full_march_free(steps->full);
    histories_free(histories);
}

/* Returns the part of the snapshots' energy outside of the span of the first `rank` modes. */
static double energy_outside(const all_steps *steps, const pod_basis *set, size_t rank) {
    double outside = 0, energy = 0;
    double *rest = calloc(steps->num_nodes, sizeof *rest);

    assert_non_null(rest);
    for (size_t s = 0; s < steps->count; s++) {
        const double *snapshot = steps->pressure + s * steps->num_nodes;
        memcpy(rest, snapshot, steps->num_nodes * sizeof *rest);
        for (size_t i = 0; i < rank; i++) {
            const double *mode = set->modes + i * set->num_nodes;
            double part = cblas_ddot((int)steps->num_nodes, mode, 1, rest, 1);
            cblas_daxpy((int)steps->num_nodes, -part, mode, 1, rest, 1);
        }
        outside += cblas_ddot((int)steps->num_nodes, rest, 1, rest, 1);
        energy += cblas_ddot((int)steps->num_nodes, snapshot, 1, snapshot, 1);
    }
    free(rest);
    return outside / energy;
}

static void compression_is_the_svd_of_all_steps(void **state) {
    (void)state;
    training_set set;
    trajectories trained;
    make_set(&set, "transient.load.period: [0.5, 1]");
    assert_int_equal(set.num_trajectories, 2);
    assert_int_equal(set.num_points, 0);
    train(&trained, &set, 1);
    all_steps steps = {.num_nodes = set.grid.num_nodes, .least_exit = set.grid.num_nodes};
    for (size_t t = 0; t < 2; t++)
        add_trajectory(&steps, &set.trajectories[t]);

    const pod_basis *compressed = &trained.first;
    pod_basis whole;
    const pod_settings all = {.num_modes = 0, .discarded_energy = 0};
    ehd_error error = {""};
    if (pod_build(&whole, steps.pressure, steps.count, steps.num_nodes, &all, &error))
        fail_msg("%s", error.text);
    assert_int_equal(steps.count, 202);
    assert_int_equal(compressed->num_snapshots, steps.count);
    assert_int_equal(trained.num_steps, steps.count);
    assert_int_equal(trained.num_failed, 0);
    assert_int_equal(trained.second.num_modes, 0);
    // the compressed form has fewer rows than there are snapshots, and no energy is lost
    assert_true(compressed->num_modes < steps.count && compressed->num_modes > 20);
    double energy = compressed->energy, first = whole.singular_values[0];
    assert_true(pod_discarded(compressed) <= 4e-22);
    check_close(energy_outside(&steps, compressed, compressed->num_modes), 0, 0, 1e-20);
    for (size_t i = 0; i < compressed->num_modes; i++)
        check_close(compressed->singular_values[i], whole.singular_values[i], 1e-4, 1e-11 * first);
    check_close(compressed->singular_values[0], first, 1e-13, 0);
    // the energy outside of the span of the first modes follows from the singular values
    for (size_t rank = 1; rank < 25; rank += 4) {
        double outside = 0;
        for (size_t i = rank; i < whole.num_singular_values; i++)
            outside += whole.singular_values[i] * whole.singular_values[i];
        check_close(energy_outside(&steps, compressed, rank), outside / energy, 1e-6, 1e-20);
    }
    pod_free(&whole);
    free(steps.pressure);
    trajectories_free(&trained);
    training_set_free(&set);
}

/* The results have the same bits, whatever the number of threads and the order of their work. */
static void workers_change_no_bit(void **state) {
    (void)state;
    training_set set;
    trajectories one, two;
    // the first trajectory takes longest, so the results of the others wait for it
    make_set(&set, "transient.end_time: [1, 0.1, 0.2]");
    train(&one, &set, 1);
    train(&two, &set, 3);
    assert_int_equal(one.num_trajectories, 3);
    assert_int_equal(one.first.num_modes, two.first.num_modes);
    assert_int_equal(one.num_steps, two.num_steps);
    assert_memory_equal(one.first.modes, two.first.modes,
                        one.first.num_modes * one.first.num_nodes * sizeof(double));
    for (size_t t = 0; t < 3; t++)
        for (size_t i = 0; i < NUM_KEPT; i++) {
            const kept_state *a = &one.kept[t].states[i], *b = &two.kept[t].states[i];
            check_close(a->time, b->time, 0, 0);
            check_close(a->moes_M, b->moes_M, 0, 0);
            assert_memory_equal(a->pressure, b->pressure, set.grid.num_nodes * sizeof(double));
        }
    trajectories_free(&one);
    trajectories_free(&two);
    training_set_free(&set);
}

/* With M = 5000 the grid is too coarse, so this trajectory fails. The results are then those of the
 * other trajectory alone. */
static void failed_trajectory_leaves_nothing(void **state) {
    (void)state;
    training_set set, alone;
    trajectories both, good;
    make_set(&set, "moes.M: [5000, 20]");
    make_set(&alone, "moes.M: [20]");
    train(&both, &set, 1);
    train(&good, &alone, 1);
    assert_int_equal(both.num_failed, 1);
    assert_true(both.failed[0] && !both.failed[1]);
    assert_int_equal(good.num_failed, 0);
    assert_int_equal(both.first.num_modes, good.first.num_modes);
    assert_memory_equal(both.first.modes, good.first.modes,
                        good.first.num_modes * good.first.num_nodes * sizeof(double));
    trajectories_free(&both);
    trajectories_free(&good);
    training_set_free(&set);
    training_set_free(&alone);
}

// ---- kept states

enum { NODES = 3 };

static ehd_contact reference_contact(void) {
    training_set set;
    make_set(&set, "moes.M: [20]");
    ehd_contact contact = set.trajectories[0].contact;
    training_set_free(&set);
    return contact;
}

/* Passes all steps of a march to kept_states_consider. The march has given loads and exits, and
 * equal steps to T = 1. Its frames are scaled by approximate loads, as with a given approach. */
static void consider_all(kept_states *kept, const ehd_contact *reference, size_t count,
                         const double *load, const size_t *exit) {
    for (size_t k = 0; k < count; k++) {
        const double part = k % 2 ? 1.1 : 0.9;
        const double values[NUM_VARY] = {
            [VARY_LOAD] = load[k] / part, [VARY_SPEED] = 1, [VARY_RADIUS] = 1, [VARY_MODULUS] = 1};
        double time = count > 1 ? (double)k / (double)(count - 1) : 0;
        const march_step step = {.frame = frame_at(reference->kind, time, values, NAN),
                                 .step = k > 0 ? 1 / (double)(count - 1) : 0,
                                 .scalars = {.load = part, .exit_position = (double)exit[k]},
                                 .iterations = k};
        const double pressure[NODES] = {(double)k, 1, 2}, film[NODES] = {3, (double)k, 4};
        kept_states_consider(kept, &step, reference, pressure, film, &exit[k]);
    }
    kept_states_complete(kept);
}

static void extremes_are_kept(void **state) {
    (void)state;
    enum { COUNT = 401 };
    ehd_contact reference = reference_contact();
    double load[COUNT];
    size_t exit[COUNT];
    kept_states kept;
    for (size_t k = 0; k < COUNT; k++) {
        load[k] = 1 + 0.3 * sin(2 * M_PI * (double)k / (COUNT - 1));
        exit[k] = 50;
    }
    exit[33] = 40;
    exit[34] = 40; // of equal extremes the first is kept
    exit[77] = 61;
    load[222] = 1; // a sudden change
    assert_int_equal(kept_states_init(&kept, NODES, 1, 1, NULL), EHD_OK);
    consider_all(&kept, &reference, COUNT, load, exit);
    assert_int_equal(kept.num_times, KEPT_TIMES);
    for (size_t i = 0; i < KEPT_TIMES; i++) { // the first step at or after a regular time
        double wanted = (double)i / (KEPT_TIMES - 1);
        assert_true(kept.states[i].time >= wanted - 1e-12 &&
                    kept.states[i].time < wanted + 1. / (COUNT - 1));
        check_close(kept.states[i].pressure[0], (double)kept.states[i].iterations, 0, 0);
        check_close(kept.states[i].film[1], (double)kept.states[i].iterations, 0, 0);
    }
    check_close(kept.states[0].rate, 0, 0, 0);
    const kept_state *extreme = kept.states + KEPT_TIMES;
    const size_t step[KEPT_EXTREMES] = {300, 100, 300, 100, 33, 77, 223};
    for (size_t i = 0; i < KEPT_EXTREMES; i++) {
        assert_int_equal(extreme[i].iterations, step[i]);
        check_close(extreme[i].moes_M, 20 * load[step[i]], 1e-13, 0);
        check_close(extreme[i].alpha_p_H, reference.alpha_p_H * sqrt(load[step[i]]), 1e-13, 0);
        assert_int_equal(extreme[i].exits[0], exit[step[i]]);
    }
    const double sudden = 0.5 * fabs(log(load[223] / load[222])) * (COUNT - 1);
    check_close(extreme[6].rate, sudden, 1e-9, 0);
    check_close(kept.states[KEPT_TIMES - 1].load_rate, sudden, 1e-9, 0);
    check_close(extreme[4].load_rate, 0.5 * log(load[1] / load[0]) * (COUNT - 1), 1e-9, 0);
    kept_states_free(&kept);
}

/* If a march has fewer steps than states are to be kept, the remaining kept states are copies of
 * the last state. */
static void few_steps_fill_all_places(void **state) {
    (void)state;
    ehd_contact reference = reference_contact();
    const double load[] = {1, 1.1, 0.9};
    const size_t exit[] = {5, 6, 7};
    for (size_t count = 1; count <= 3; count++) {
        kept_states kept;
        assert_int_equal(kept_states_init(&kept, NODES, 1, 1, NULL), EHD_OK);
        consider_all(&kept, &reference, count, load, exit);
        assert_int_equal(kept.num_times, KEPT_TIMES);
        assert_int_equal(kept.states[KEPT_TIMES - 1].iterations, count - 1);
        check_close(kept.states[KEPT_TIMES - 1].pressure[0], (double)count - 1, 0, 0);
        check_close(kept.states[0].pressure[0], 0, 0, 0);
        kept_states_free(&kept);
    }
}

static void states_without_fields(void **state) {
    (void)state;
    ehd_contact reference = reference_contact();
    const double load[] = {1, 1.1, 0.9};
    const size_t exit[] = {5, 6, 7};
    kept_states kept;
    assert_int_equal(kept_states_init(&kept, 0, 1, 1, NULL), EHD_OK);
    consider_all(&kept, &reference, 3, load, exit);
    assert_null(kept.states[0].pressure);
    assert_int_equal(kept.states[KEPT_TIMES + 5].exits[0], 7);
    kept_states_free(&kept);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(compression_is_the_svd_of_all_steps),
        cmocka_unit_test(workers_change_no_bit),
        cmocka_unit_test(failed_trajectory_leaves_nothing),
        cmocka_unit_test(extremes_are_kept),
        cmocka_unit_test(few_steps_fill_all_places),
        cmocka_unit_test(states_without_fields),
    };
    return cmocka_run_group_tests_name("trajectory", tests, enter_folder, leave_folder);
}
