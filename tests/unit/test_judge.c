/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests which solutions of a line and a point contact are usable. */
#include "fullrun/judge.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <math.h>

static char reason[JUDGE_REASON];

/* Makes a state with the dry pressure of Hertz, which ends inside the domain. */
static void make_state(full_state *state, const ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid;

    assert_int_equal(full_state_init(state, grid, NULL), EHD_OK);
    full_state_fill(state, grid);
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        const double gap = 2 * grid_gap(grid, k);
        state->pressure[k] = gap < 1 ? sqrt(1 - gap) : 0;
        if (gap >= 1 && grid_x(grid, k) > 0) state->ruptured[k] = true;
    }
}

static void check_reason(ehd_status found, const char *expected) {
    assert_int_equal(found, *expected ? EHD_NOT_CONVERGED : EHD_OK);
    assert_string_equal(reason, expected);
}

/* Checks the reasons for which full_judge rejects solutions of a contact with a WLF oil. The law of
 * this oil is valid up to 11.5 GPa. */
static void check_contact(const ehd_contact *contact) {
    const size_t centre = grid_central_line(&contact->grid) +
                          (size_t)lround(-contact->grid.x_min / contact->grid.step);
    const full_info good = {.status = EHD_OK};
    const full_info bad = {.status = EHD_NOT_CONVERGED,
                           .reason = "too many iterations",
                           .newton_iterations = 60,
                           .residual = 0.00123};
    full_state state;

    make_state(&state, contact);
    check_reason(full_judge(reason, &good, &state, contact), "");
    assert_false(full_beyond_law(&state, contact));
    check_reason(full_judge(reason, &bad, &state, contact),
                 "found too many iterations after 60 Newton iterations, residual 1.2e-03");

    state.pressure[centre] = 13e9 / contact->hertz_pressure;
    assert_true(full_beyond_law(&state, contact));
    const char high[] = "found a pressure of 13 GPa, expected at most 11.5 GPa, the limit of the "
                        "wlf law";
    check_reason(full_judge(reason, &good, &state, contact), high);
    check_reason(full_judge(reason, &bad, &state, contact),
                 "found too many iterations after 60 Newton iterations, residual 1.2e-03; found a "
                 "pressure of 13 GPa, expected at most 11.5 GPa, the limit of the wlf law");
    state.pressure[centre] = 1;

    full_state_fill(&state, &contact->grid); // pressure up to the end of the domain
    check_reason(full_judge(reason, &good, &state, contact),
                 contact->kind->dimensions > 1
                     ? "found the exit boundary outside the domain, expected it before X = 1.375 "
                       "(grid.x_max)"
                     : "found the exit boundary outside the domain, expected it before X = 2 "
                       "(grid.x_max)");
    full_state_free(&state);
}

static void tells_why_a_line_may_not_be_used(void **state) {
    const ehd_contact contact = sample_contact("no1", "incompressible", 20, 5, 0.05);
    (void)state;

    check_contact(&contact);
}

static void tells_why_a_point_may_not_be_used(void **state) {
    const ehd_contact contact = sample_point("no1", "incompressible", 20, 5, 48, true);
    (void)state;

    check_contact(&contact);
}

/* Barus' law has no pressure limit. */
static void a_law_without_limit_is_never_left(void **state) {
    const ehd_contact contact = sample_contact("barus", "incompressible", 20, 5, 0.05);
    full_state solution;
    (void)state;

    make_state(&solution, &contact);
    solution.pressure[contact.grid.num_nodes / 2] = 1e6;
    assert_false(full_beyond_law(&solution, &contact));
    full_state_free(&solution);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tells_why_a_line_may_not_be_used),
        cmocka_unit_test(tells_why_a_point_may_not_be_used),
        cmocka_unit_test(a_law_without_limit_is_never_left),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
