/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A trial model, which is a reduced model in memory, and its verdicts on contacts between its
 * training points. A verdict consists of the films and the error bounds. */
#include "snapgen/trial.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"
#include "tests/unit/trained.h"

#include <math.h>
#include <string.h>

static trained training;
static reduced_model model;
static ehd_error error;

#define check_ok(call) assert_string_equal(((call) == EHD_OK) ? "" : error.text, "")

static ehd_status build(reduced_model *result, size_t num_workers, size_t num_points) {
    const snapshot_set *set = &training.set;
    const reduced_states *of = training.states;
    const program caller = {.name = "test"};
    const training_set points = {.grid = set->grid,
                                 .kind = set->kind,
                                 .num_points = num_points,
                                 .contacts = training.contacts};
    solved_state states[TRAINED_STATES];

    for (size_t s = 0; s < TRAINED_STATES; s++)
        states[s] = (solved_state){training.pressure + s * set->grid.num_nodes,
                                   of->coordinates[s],
                                   of->moes_M[s],
                                   of->alpha_p_H[s],
                                   of->thinning[s],
                                   of->central_film_thickness[s],
                                   of->rises[s]};
    trial_costs costs;
    return trial_build(result, &costs, &caller, &points, states, 0, num_workers, &error);
}

static int set_up(void **state) {
    (void)state;
    trained_init(&training, 0.02);
    return build(&model, 1, TRAINED_STATES);
}

static int tear_down(void **state) {
    (void)state;
    reduced_model_free(&model);
    trained_free(&training);
    return 0;
}

/* If the basis spans all training solutions, the model reproduces each of these solutions. */
static void training_points_are_reproduced(void **state) {
    trial_verdict verdicts[TRAINED_STATES];
    bool wanted[TRAINED_STATES];
    (void)state;

    memset(wanted, true, sizeof wanted);
    assert_int_equal(model.num_pressure, TRAINED_STATES);
    assert_true(model.control.num_rows > 0);
    check_ok(trial_judge(verdicts, &model, training.contacts, wanted, TRAINED_STATES, 1, &error));
    for (size_t s = 0; s < TRAINED_STATES; s++) {
        check_close(verdicts[s].film[FILM_CENTRAL], training.states->central_film_thickness[s],
                    1e-6, 0);
        assert_true(verdicts[s].film[FILM_MINIMUM] > 0 &&
                    verdicts[s].film[FILM_MINIMUM] < verdicts[s].film[FILM_CENTRAL]);
        for (int f = 0; f < NUM_FILMS; f++)
            check_close(verdicts[s].bound[f], 0, 0, 1e-4);
    }
}

/* Verdicts do not depend on the number of threads, and unwanted contacts are left out. */
static void verdicts_have_the_same_bits_on_more_threads(void **state) {
    enum { COUNT = 5 };
    ehd_contact contacts[COUNT];
    const bool wanted[COUNT] = {true, true, false, true, true};
    trial_verdict one[COUNT], two[COUNT];
    reduced_model again = {0};
    (void)state;

    for (size_t i = 0; i < COUNT; i++)
        contacts[i] = sample_contact("barus", "dowson-higginson", 9 + 2 * (double)i,
                                     3 + 0.3 * (double)i, 0.02);
    memset(one, 0x55, sizeof one);
    memset(two, 0x55, sizeof two);
    check_ok(trial_judge(one, &model, contacts, wanted, COUNT, 1, &error));
    check_ok(build(&again, 3, TRAINED_STATES));
    check_ok(trial_judge(two, &again, contacts, wanted, COUNT, 3, &error));
    reduced_model_free(&again);
    assert_memory_equal(one, two, sizeof one);
    memset(two, 0x55, sizeof two);
    assert_memory_equal(&one[2], &two[2], sizeof *two);
    for (size_t i = 0; i < COUNT; i++)
        if (wanted[i])
            assert_true(one[i].bound[FILM_CENTRAL] > 0 && one[i].bound[FILM_MINIMUM] > 0);
}

/* If the model finds no solution for a contact, the error bounds are infinite. */
static void what_is_not_solved_is_the_worst(void **state) {
    const ehd_contact far = sample_contact("barus", "dowson-higginson", 400, 20, 0.02);
    const bool wanted = true;
    trial_verdict verdict;
    (void)state;

    check_ok(trial_judge(&verdict, &model, &far, &wanted, 1, 1, &error));
    for (int f = 0; f < NUM_FILMS; f++) {
        assert_true(isinf(verdict.bound[f]) && verdict.bound[f] > 0);
        assert_true(isnan(verdict.film[f]));
    }
}

static void no_solutions_are_refused(void **state) {
    reduced_model none = {0};
    (void)state;

    assert_int_equal(build(&none, 1, 0), EHD_DATA);
    reduced_model_free(&none);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(training_points_are_reproduced),
        cmocka_unit_test(verdicts_have_the_same_bits_on_more_threads),
        cmocka_unit_test(what_is_not_solved_is_the_worst),
        cmocka_unit_test(no_solutions_are_refused)};

    return cmocka_run_group_tests(tests, set_up, tear_down);
}
