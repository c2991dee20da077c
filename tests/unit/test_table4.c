/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The acceptance test of the full model: Table 4 of Maier, Hager, Hetzler and Seemann (2015),
 * column "Full". Cold starts must give every printed digit. */
#include "fullrun/full_solver.h"
#include "tests/unit/check.h"
#include "tests/unit/sample.h"

#include <string.h>

static const struct {
    const char *lubricant;
    double moes_M, moes_L;
    double hertz_pressure; // GPa, as printed
    double central_film;
} table[] = {
    {"no1", 12, 12, 0.70, 0.17966418},  {"no1", 17, 15, 1.04, 0.13701194},
    {"no1", 45, 5, 0.57, 0.02515764},   {"no1", 100, 10, 1.69, 0.01437200},
    {"no1", 600, 8, 3.31, 0.00157085},  {"no2", 13, 8, 0.92, 0.13029989},
    {"no2", 40, 9, 1.82, 0.03837291},   {"no2", 45, 5, 1.07, 0.02455470},
    {"no2", 120, 10, 3.50, 0.01163337}, {"no2", 500, 6, 4.28, 0.00164452},
    {"no3", 12, 8, 0.61, 0.14277281},   {"no3", 18, 15, 1.41, 0.12720192},
    {"no3", 40, 12, 1.68, 0.04513897},  {"no3", 200, 12, 3.75, 0.00718491},
    {"no3", 600, 6, 3.25, 0.00130920},
};

/* Returns the step of the paper's grids: n = 1201 for low loads, n = 3001 for high ones. */
static double step_of(double moes_M) {
    return moes_M < 50 ? 0.005 : 0.002;
}

static void every_printed_digit(void **state) {
    (void)state;
    full_settings settings = full_default_settings();
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        scene given =
            sample_scene(table[i].lubricant, "dowson-higginson", table[i].moes_M, table[i].moes_L);
        ehd_contact contact;
        full_solver *solver;
        full_state fields;
        full_info info;

        given.hertz_pressure = 1e9 * table[i].hertz_pressure;
        strcpy(given.discretization, "published");
        given.grid.step = step_of(table[i].moes_M);
        assert_int_equal(scene_contact(&contact, &given, NULL), EHD_OK);
        assert_int_equal(full_solver_create(&solver, contact.kind, &contact.grid, &settings, NULL),
                         EHD_OK);
        assert_int_equal(full_state_init(&fields, &contact.grid, NULL), EHD_OK);
        assert_int_equal(full_solve_cold(&info, &fields, solver, &contact, NULL), EHD_OK);
        assert_int_equal(info.status, EHD_OK);
        check_close(full_evaluate_scalars(&fields, &contact).central_film_thickness,
                    table[i].central_film, 0, 0.5e-8);
        full_state_free(&fields);
        full_solver_free(solver);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_printed_digit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
