/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Transient error estimates of the films. They are computed from residuals of rows and from the
 * motion of the exit. */
#include "romrun/trust/time_indicator.h"
#include "tests/unit/marching.h"

#include <math.h>
#include <stdlib.h>

enum { STATE = 6 }; // training state of the contact

static trained training; // 121 nodes
static reduced_basis basis;
static marching at_rest; // after its start, with all rows
static time_indicator indicator;
static ehd_error error;

static contact_frame frame_after(double path) {
    contact_frame frame = frame_at(&contact_line, path, (double[]){1, 1, 1, 1}, NAN);

    frame.path = path;
    return frame;
}

static int set_up(void **state) {
    const contact_frame frame = frame_after(0);
    (void)state;
    trained_init_accurate(&training, 0.05);
    trained_basis(&basis, &training, DEFORMATION_COUPLED, 0, 0);
    marching_start(&at_rest, &training.contacts[STATE], &basis, &frame);
    return time_indicator_init(&indicator, &at_rest.model, &error);
}

static int tear_down(void **state) {
    (void)state;
    time_indicator_free(&indicator);
    marching_free(&at_rest);
    reduced_basis_free(&basis);
    trained_free(&training);
    return 0;
}

static double local_of(reduced_film film) {
    return time_indicator_local(&indicator, film, 0.1);
}

/* While the fluid moves from the minimum of the film to the exit, the local error of an earlier
 * step decreases to 1/e. The error of a new step is added. A repeated step starts from the accepted
 * state again. */
static void what_rows_do_leaves_through_the_exit(void **state) {
    const contact_scalars scalars = {.central_film_thickness = 0.1,
                                     .minimum_film_thickness = 0.08,
                                     .minimum_position = 0.9,
                                     .exit_position = 1.1};
    const double some[NUM_REDUCED_FILMS] = {1e-4, 1e-3}, none[NUM_REDUCED_FILMS] = {0, 0};
    const double unknown[NUM_REDUCED_FILMS] = {NAN, NAN};
    const contact_frame first = frame_after(1), second = frame_after(1.2);
    (void)state;

    time_indicator_clear(&indicator);
    time_indicator_add_local(&indicator, some, &scalars, NULL, &first);
    time_indicator_keep(&indicator);
    time_indicator_add_local(&indicator, unknown, &scalars, &first, &second);
    check_close(local_of(REDUCED_CENTRAL_FILM), 0.1, 0, 0); // an unknown error counts as 100 %
    for (int i = 0; i < 2; i++) {
        time_indicator_add_local(&indicator, some, &scalars, &first, &second);
        check_close(local_of(REDUCED_CENTRAL_FILM), 1e-4 * (1 + exp(-1)), 1e-12, 0);
        check_close(local_of(REDUCED_MINIMUM_FILM), 1e-3 * (1 + exp(-1)), 1e-12, 0);
    }
    time_indicator_add_local(&indicator, none, &scalars, &first, &second);
    check_close(local_of(REDUCED_MINIMUM_FILM), 1e-3 * exp(-1), 1e-12, 0);
    time_indicator_clear(&indicator);
    time_indicator_add_local(&indicator, none, &scalars, &first, &second);
    check_close(local_of(REDUCED_MINIMUM_FILM), 0, 0, 0);
}

/* Errors decay along the path from where they arose to the exit. Errors from the constriction and
 * from a dip far upstream decay independently, wherever the later minimum lies. */
static void what_rows_do_leaves_from_where_it_arose(void **state) {
    const contact_scalars outlet = {.central_film_thickness = 0.1,
                                    .minimum_film_thickness = 0.08,
                                    .minimum_position = 0.9,
                                    .exit_position = 1.1};
    const double some[NUM_REDUCED_FILMS] = {1e-4, 1e-3}, none[NUM_REDUCED_FILMS] = {0, 0};
    contact_scalars dip = outlet;
    (void)state;

    dip.minimum_position = -0.5;
    time_indicator_clear(&indicator);
    for (int i = 0; i < 5; i++) {
        const contact_frame then = frame_after(i * 0.1), now = frame_after((i + 1) * 0.1);
        time_indicator_add_local(&indicator, i < 2 ? some : none, i == 0 || i > 3 ? &outlet : &dip,
                                 i > 0 ? &then : NULL, &now);
        time_indicator_keep(&indicator);
        const double of_outlet = exp(-i * 0.1 / 0.2),
                     of_dip = i > 0 ? exp(-(i - 1) * 0.1 / 1.6) : 0;
        check_close(local_of(REDUCED_MINIMUM_FILM), 1e-3 * (of_outlet + of_dip), 1e-12, 0);
    }
}

static size_t row_at(size_t node) {
    const row_set *rows = &at_rest.model.rows;
    size_t row = 0;

    while (rows->node[row] != node)
        row++;
    return row;
}

/* time_indicator_at_exit counts only residuals of rows that are not in the last least-squares
 * problem, for example because the exit has passed them. Such a row has the influence and the
 * weight of the nearest row in this problem. */
static void rows_that_an_exit_has_passed_count(void **state) {
    const row_set *rows = &at_rest.model.rows;
    const reduced_state at = reduced_march_state(at_rest.march, NULL);
    double *influence = calloc(rows->num_rows, sizeof *influence);
    (void)state;

    assert_non_null(influence);
    time_indicator_place(&indicator, &at);
    assert_int_equal(indicator.num_at_exit, 2); // on this grid a moved exit needs a new Jacobian
    const size_t before = indicator.node[indicator.num_nodes];
    assert_int_equal(before, at.exit - 1);
    indicator.residual[indicator.num_nodes] = 0.5;
    indicator.residual[indicator.num_nodes + 1] = 0;
    for (size_t r = 0; r < rows->num_rows; r++)
        influence[r] = rows->node[r] < at.exit ? 3 : 0;
    check_close(time_indicator_at_exit(&indicator, influence), 0, 0, 0);
    influence[row_at(before)] = 0;
    check_close(time_indicator_at_exit(&indicator, influence),
                0.5 * 3 * rows->weight[row_at(before - 1)], 1e-12, 0);
    time_indicator_place(&indicator, NULL);
    check_close(time_indicator_at_exit(&indicator, influence), 0, 0, 0);
    free(influence);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_rows_do_leaves_through_the_exit),
        cmocka_unit_test(what_rows_do_leaves_from_where_it_arose),
        cmocka_unit_test(rows_that_an_exit_has_passed_count),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
