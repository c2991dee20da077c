/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors of a transient film. The errors enter at the inlet, and the fluid carries them through the
 * contact. */
#include "common/time/film_errors.h"
#include "tests/unit/check.h"

#include <math.h>

static const double EDGE = -0.85, PATH = 0.05; // X where errors enter; path of the fluid in a step

static film_errors errors;

static contact_frame frame_after(double path, double load) {
    static const contact_kind *const kind = &contact_line;
    contact_frame frame = frame_at(kind, path, (double[]){load, 1, 1, 1}, NAN);

    frame.path = path;
    return frame;
}

/* Makes one step of length PATH to the frame `now`. An error enters during this step. */
static void go_on(const contact_frame *then, const contact_frame *now, double entering) {
    film_errors_carry(&errors, then, now);
    film_errors_enter(&errors, then, now, EDGE, entering);
    film_errors_keep(&errors);
}

/* An error that enters while the path grows from 0 to 0.3 moves with the fluid. */
static void an_error_goes_with_the_fluid(void **state) {
    (void)state;
    const double last = 0.3, smooth = 0.06; // splines smooth the error's ends over `smooth`

    film_errors_set(&errors, NULL);
    for (int i = 1; i <= 80; i++) {
        const contact_frame then = frame_after((i - 1) * PATH, 1), now = frame_after(i * PATH, 1);
        go_on(&then, &now, i * PATH < last + 1e-9 ? 1 : 0);
        // front and end of the film with the error
        const double front = EDGE + i * PATH, end = fmax(front - last, EDGE);
        for (double x = EDGE + smooth; x <= 1; x += 0.01) {
            const double found = film_errors_at(&errors, x);
            if (x > front + smooth || x < end - smooth) check_close(found, 0, 0, 0.02);
            if (x < front - smooth && x > end + smooth) check_close(found, 1, 0, 0.02);
        }
        const bool at_centre = front > smooth && end < -smooth;
        if (at_centre) check_close(film_errors_largest(&errors, -0.02, 0.02), 1, 0, 0.02);
    }
    check_close(film_errors_largest(&errors, -1, 1), 0, 0, 1e-9); // the error has left
}

static void no_bound_is_negative(void **state) {
    (void)state;
    film_errors_set(&errors, NULL);
    for (int i = 1; i <= 30; i++) {
        const contact_frame then = frame_after((i - 1) * PATH, 1), now = frame_after(i * PATH, 1);
        go_on(&then, &now, i % 7 == 0 ? 1 : 0);
        for (double x = -1; x <= 1; x += 0.005)
            assert_true(film_errors_at(&errors, x) >= 0);
    }
}

/* Films are scaled by a^2/R, so an error is a quarter as large in a contact twice as wide. */
static void an_error_stays_where_the_frame_changes(void **state) {
    (void)state;
    const contact_frame narrow = frame_after(0, 1), wide = frame_after(0, 4);

    film_errors_set(&errors, NULL);
    film_errors_enter(&errors, NULL, NULL, INFINITY, 1);
    film_errors_keep(&errors);
    film_errors_carry(&errors, &narrow, &wide);
    check_close(wide.half_width, 2, 1e-12, 0);
    check_close(film_errors_at(&errors, 0), 0.25, 1e-9, 0);
    check_close(film_errors_at(&errors, 0.48), 0.25, 1e-9, 0);
    check_close(film_errors_at(&errors, 0.52), 0, 0, 1e-12); // outside of the narrow contact
}

static void the_largest_between_two_places(void **state) {
    (void)state;
    const double x[] = {-0.5, 0, 0.5}, added[] = {0, 1, 0};

    film_errors_set(&errors, NULL);
    film_errors_add(&errors, 2, added, x, 3);
    check_close(film_errors_largest(&errors, -1, 1), 2, 1e-12, 0);
    check_close(film_errors_largest(&errors, 0.25, 0.6), 1, 1e-9, 0);
    check_close(film_errors_largest(&errors, 0.6, 3), 0, 0, 1e-12);
    check_close(film_errors_largest(&errors, -9, -3), 0, 0, 1e-12);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_error_goes_with_the_fluid),
        cmocka_unit_test(no_bound_is_negative),
        cmocka_unit_test(an_error_stays_where_the_frame_changes),
        cmocka_unit_test(the_largest_between_two_places),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
