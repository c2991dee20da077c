/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests the initial states (guesses) that are computed from trained solutions. The trained
 * solutions of these tests are points in the plane of two coordinates, ln M and ln(1 + alpha p_H) /
 * 2, and their unknowns are given functions of the coordinates.
 * - Between the points the guess is exact if the unknowns are quadratic functions.
 * - Near the points the guess is exact for affine functions, if the points do not all lie on one
 *   line.
 * - If all points lie on one line, or are far away, the guess is the nearest trained solution. */
#include "common/settings/scene.h"
#include "romrun/solve/guess.h"
#include "romrun/solve/reduced_solver.h"
#include "romrun/trust/trained_range.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/reduced_problem.h"

#include <math.h>
#include <string.h>

enum { MOST = 7, UNKNOWNS = 2 };

// distances between neighbouring trained solutions in ln M and in ln(1 + alpha p_H) / 2
static const double SPACING[2] = {0.14, 0.06};

typedef struct places {
    reduced_model model;
    band_line line;
    reduced_state state;
} places;

static double field(double x, double y, size_t unknown, bool quadratic) {
    double affine = (double)unknown + 0.7 * x - 1.3 * y;

    return quadratic ? affine + 2 * x * x - 3 * x * y + 0.5 * y * y : affine;
}

/* Makes trained solutions at `columns` by `rows` points, with the values of `field` as unknowns. */
static void places_init(places *self, size_t columns, size_t rows, bool quadratic) {
    reduced_states *states = &self->model.states;
    ehd_error error;

    memset(self, 0, sizeof *self);
    self->line = (band_line){.min_exit = 40, .max_exit = 60};
    self->model.grid = grid_of(-4, 0.05, 98, 1, false, DISCRETIZATION_PUBLISHED);
    self->model.band.num_lines = 1;
    self->model.band.lines = &self->line;
    self->model.num_unknowns = UNKNOWNS;
    assert_int_equal(reduced_states_init(states, columns * rows, 1, UNKNOWNS, &error), EHD_OK);
    assert_int_equal(reduced_state_init(&self->state, &self->model, &error), EHD_OK);
    for (size_t s = 0; s < columns * rows; s++) {
        double x = SPACING[0] * (double)(s % columns), y = SPACING[1] * (double)(s / columns);
        states->moes_M[s] = exp(x);
        states->alpha_p_H[s] = expm1(2 * y);
        states->stationary[s] = true;
        states->exit[s] = 45 + 2 * (s % columns);
        for (size_t j = 0; j < UNKNOWNS; j++)
            states->coordinates[s * UNKNOWNS + j] = field(x, y, j, quadratic);
    }
}

static void places_free(places *self) {
    reduced_states_free(&self->model.states);
    reduced_state_free(&self->state);
}

/* Compares the guess at the point `at` with `field` at `as`, both in units of SPACING. */
static void check_guess(places *self, const double at[2], const double as[2], bool quadratic) {
    reduced_guess(&self->state, &self->model,
                  (contact_place){.moes_M = exp(SPACING[0] * at[0]),
                                  .alpha_p_H = expm1(2 * SPACING[1] * at[1])});
    for (size_t j = 0; j < UNKNOWNS; j++)
        check_close(self->state.coordinates[j],
                    field(SPACING[0] * as[0], SPACING[1] * as[1], j, quadratic), 1e-8, 1e-8);
}

static void quadratic_amid_training(void **state) {
    (void)state;
    places self;

    places_init(&self, MOST, MOST, true);
    for (double x = 2; x <= 4; x += 0.25)
        for (double y = 2; y <= 4; y += 0.25) {
            const double at[2] = {x, y};
            check_guess(&self, at, at, true);
            assert_true(fabs((double)self.state.exit - (45 + 2 * x)) <= 0.5 + 1e-6);
        }
    places_free(&self);
}

/* The guess of an affine function is exact also outside of the trained points, and if there are
 * only two rows of points, which do not determine a second derivative. */
static void affine_where_training_spans_a_plane(void **state) {
    (void)state;
    places self;

    places_init(&self, 4, 2, false);
    for (double x = -0.25; x <= 3.25; x += 0.25)
        for (double y = 0; y <= 1; y += 0.25) {
            const double at[2] = {x, y};
            check_guess(&self, at, at, false);
        }
    places_free(&self);
}

static void nearest_on_a_line_and_far_away(void **state) {
    (void)state;
    places self;

    places_init(&self, MOST, 1, true);
    for (double x = 0.25; x < MOST - 1; x++) {
        const double at[2] = {x, 0.1}, as[2] = {x - 0.25, 0};
        check_guess(&self, at, as, true);
    }
    places_free(&self);
    places_init(&self, MOST, MOST, true);
    const double at[2] = {40, 40}, as[2] = {MOST - 1, MOST - 1};
    check_guess(&self, at, as, true);
    places_free(&self);
}

// ---- lubricants

static const double ALPHA = 2e-8;

static ehd_lubricant barus(bool compressible) {
    ehd_lubricant found;
    scene given;

    scene_defaults(&given);
    assert_int_equal(scene_set(&given, "lubricant.viscosity.law", "barus", "test", NULL), EHD_OK);
    assert_int_equal(scene_set(&given, "lubricant.viscosity.alpha", "2e-8", "test", NULL), EHD_OK);
    assert_int_equal(scene_set(&given, "lubricant.density.law",
                               compressible ? "dowson-higginson" : "incompressible", "test", NULL),
                     EHD_OK);
    scene_complete(&given);
    assert_int_equal(lubricant_init(&found, &given.lubricant, NULL), EHD_OK);
    return found;
}

/* Makes states of two lubricants at the same places. The coordinates of a state are the values of
 * the fields plus five times the rise of the density. */
static void places_of_two(places *self, const ehd_lubricant of[2], size_t columns, size_t rows,
                          bool quadratic) {
    const size_t each = columns * rows;

    places_init(self, columns, 2 * rows, quadratic);
    reduced_states *states = &self->model.states;
    for (size_t s = 0; s < 2 * each; s++) {
        const size_t place = s % each;
        const double x = SPACING[0] * (double)(place % columns);
        const double y = SPACING[1] * (double)(place / columns);
        states->moes_M[s] = exp(x);
        states->alpha_p_H[s] = expm1(2 * y);
        states->rises[s] = lubricant_rises_at(&of[s / each], expm1(2 * y) / ALPHA);
        for (size_t j = 0; j < UNKNOWNS; j++)
            states->coordinates[s * UNKNOWNS + j] =
                field(x, y, j, quadratic) + 5 * states->rises[s].of[RISE_DENSITY];
    }
}

/* The states of two lubricants differ by five times the rise of the density (places_of_two). The
 * guess for the incompressible lubricant is its own field. If the contact gives no lubricant, the
 * guess lies between both fields. If only one lubricant has states, these states are used unchanged
 * for another lubricant. */
static void lubricants_are_told_apart(void **state) {
    enum { ALL = 2 * MOST * MOST };
    const ehd_lubricant of[2] = {barus(false), barus(true)};
    const double at[2] = {3.3, 2.6};
    (void)state;
    places self;

    places_of_two(&self, of, MOST, MOST, true);
    reduced_states *states = &self.model.states;
    const double M = exp(SPACING[0] * at[0]), pressure = expm1(2 * SPACING[1] * at[1]);
    for (size_t j = 0; j < UNKNOWNS; j++) {
        const double own = field(SPACING[0] * at[0], SPACING[1] * at[1], j, true);
        reduced_guess(&self.state, &self.model,
                      (contact_place){.moes_M = M, .alpha_p_H = pressure, .lubricant = &of[0]});
        check_close(self.state.coordinates[j], own, 1e-7, 1e-7);
        reduced_guess(&self.state, &self.model,
                      (contact_place){.moes_M = M, .alpha_p_H = pressure, .lubricant = &of[1]});
        check_close(self.state.coordinates[j],
                    own + 5 * lubricant_rises_at(&of[1], pressure / ALPHA).of[RISE_DENSITY], 0,
                    1e-3);
        reduced_guess(&self.state, &self.model,
                      (contact_place){.moes_M = M, .alpha_p_H = pressure});
        assert_true(self.state.coordinates[j] > own + 0.01);
    }
    // with the states of the incompressible lubricant only
    states->num_states = ALL / 2;
    for (size_t j = 0; j < UNKNOWNS; j++) {
        reduced_guess(&self.state, &self.model,
                      (contact_place){.moes_M = M, .alpha_p_H = pressure, .lubricant = &of[1]});
        check_close(self.state.coordinates[j],
                    field(SPACING[0] * at[0], SPACING[1] * at[1], j, true), 1e-2, 1e-2);
    }
    // a contact is a trained point only with the same lubricant
    ehd_contact contact = {.moes_M = states->moes_M[5],
                           .alpha_p_H = states->alpha_p_H[5],
                           .hertz_pressure = states->alpha_p_H[5] / ALPHA,
                           .lubricant = of[0]};
    assert_true(reduced_states_have(states, &contact));
    contact.alpha_p_H = states->alpha_p_H[MOST + 5];
    contact.hertz_pressure = contact.alpha_p_H / ALPHA;
    contact.moes_M = states->moes_M[MOST + 5];
    assert_true(reduced_states_have(states, &contact));
    contact.lubricant = of[1];
    assert_false(reduced_states_have(states, &contact));
    places_free(&self);
}

/* If the contact's lubricant has too few states for a quadratic fit, the fit also uses states of
 * other lubricants. The guess of an affine field of two lubricants is then exact. */
static void few_states_of_two_lubricants(void **state) {
    enum { COLUMNS = 4, ROWS = 2 };
    const ehd_lubricant of[2] = {barus(false), barus(true)};
    (void)state;
    places self;

    places_of_two(&self, of, COLUMNS, ROWS, false);
    for (double x = 0.25; x < COLUMNS - 1; x += 0.5) {
        const double M = exp(SPACING[0] * x), pressure = expm1(2 * SPACING[1] * 0.6);
        reduced_guess(&self.state, &self.model,
                      (contact_place){.moes_M = M, .alpha_p_H = pressure, .lubricant = &of[0]});
        for (size_t j = 0; j < UNKNOWNS; j++)
            check_close(self.state.coordinates[j],
                        field(SPACING[0] * x, SPACING[1] * 0.6, j, false), 1e-6, 1e-6);
    }
    places_free(&self);
}

// ---- effects of the grid

/* Effects of the grid on the films are interpolated exactly if they are products of powers of M and
 * of 1 + alpha p_H. Older models have effects with a sign, which is ignored. */
static void effects_are_powers(void **state) {
    (void)state;
    places self;

    places_init(&self, MOST, MOST, false);
    const reduced_states *states = &self.model.states;
    for (size_t s = 0; s < states->num_states; s++)
        for (int e = 0; e < NUM_EFFECTS; e++)
            states->effects[s].of[e] = (e == EFFECT_STEP ? -1e-3 : 1e-3) *
                                       pow(states->moes_M[s], e + 0.5) *
                                       pow(1 + states->alpha_p_H[s], 0.3 * e);
    for (double x = 2; x <= 4; x += 0.25) {
        const double M = exp(SPACING[0] * x), pressure = expm1(2 * SPACING[1] * (6 - x));
        const film_effects found =
            reduced_effects(&self.model, (contact_place){.moes_M = M, .alpha_p_H = pressure});
        for (int e = 0; e < NUM_EFFECTS; e++)
            check_close(found.of[e], 1e-3 * pow(M, e + 0.5) * pow(1 + pressure, 0.3 * e), 1e-8, 0);
    }
    places_free(&self);
}

static void effects_that_are_not_known(void **state) {
    (void)state;
    places self;

    places_init(&self, MOST, MOST, false);
    const reduced_states *states = &self.model.states;
    const double M = exp(SPACING[0] * 3.1), pressure = expm1(2 * SPACING[1] * 3.1);
    const size_t nearest = 3 * MOST + 3;
    film_effects found =
        reduced_effects(&self.model, (contact_place){.moes_M = M, .alpha_p_H = pressure});
    for (int e = 0; e < NUM_EFFECTS; e++)
        assert_true(isnan(found.of[e]));
    // states without an effect, or with an infinite one, are left out
    for (size_t s = 0; s < states->num_states; s++)
        for (int e = 0; e < NUM_EFFECTS; e++)
            states->effects[s].of[e] = 0.02;
    states->effects[nearest].of[EFFECT_STEP] = NAN;
    states->effects[nearest + 1].of[EFFECT_STEP] = INFINITY;
    states->stationary[nearest + MOST] = false;
    states->effects[nearest + MOST].of[EFFECT_STEP] = 5;
    found = reduced_effects(&self.model, (contact_place){.moes_M = M, .alpha_p_H = pressure});
    check_close(found.of[EFFECT_STEP], 0.02, 1e-9, 0);
    // if the effect at the nearest state is infinite, the result is infinite
    states->effects[nearest].of[EFFECT_STEP] = INFINITY;
    found = reduced_effects(&self.model, (contact_place){.moes_M = M, .alpha_p_H = pressure});
    assert_true(isinf(found.of[EFFECT_STEP]));
    check_close(found.of[EFFECT_INLET], 0.02, 1e-9, 0);
    places_free(&self);
}

// ---- starts and the trained range

static void guess_at_a_training_point_is_that_state(void **state) {
    (void)state;
    trained training;
    reduced_basis coupled;
    reduced_problem reduced;

    trained_init(&training, 0.02);
    trained_basis(&coupled, &training, DEFORMATION_COUPLED, 0, 0);
    reduced_problem_init(&reduced, &coupled, NULL, 0, &strict_settings);
    size_t n = reduced.model.num_unknowns;
    for (size_t s = 0; s < TRAINED_STATES; s++) {
        const double *expected = coupled.states.coordinates + s * n;
        double M = training.states->moes_M[s], pressure = training.states->alpha_p_H[s], away = 0;
        reduced_guess(&reduced.state, &reduced.model,
                      (contact_place){.moes_M = M, .alpha_p_H = pressure});
        assert_int_equal(reduced.state.exit, coupled.states.exit[s]);
        check_close_array(reduced.state.coordinates, expected, n, 1e-4, 1e-4);
        reduced_neighbour(&reduced.state, &reduced.model,
                          (contact_place){.moes_M = M, .alpha_p_H = pressure});
        for (size_t j = 0; j < n; j++)
            away = fmax(away, fabs(reduced.state.coordinates[j] - expected[j]));
        assert_true(away > 1e-3);
        assert_true(reduced.state.exit >= reduced.model.band.lines[0].min_exit);
        assert_true(reduced.state.exit <= reduced.model.band.lines[0].max_exit);
    }
    // far outside of the training, the guess is a trained solution, with an exit within the band
    reduced_guess(&reduced.state, &reduced.model, (contact_place){.moes_M = 1e4, .alpha_p_H = 1e3});
    size_t same = 0;
    for (size_t s = 0; s < TRAINED_STATES; s++)
        same += reduced.state.coordinates[0] == coupled.states.coordinates[s * n];
    assert_int_equal(same, 1);
    assert_true(reduced.state.exit >= reduced.model.band.lines[0].min_exit);
    assert_true(reduced.state.exit <= reduced.model.band.lines[0].max_exit);
    reduced_problem_free(&reduced);
    reduced_basis_free(&coupled);
    trained_free(&training);
}

/* Makes the nearest states of a contact's own lubricant useless as starts. */
static void spoil_nearest(reduced_states *states, const ehd_contact *contact, size_t count) {
    double distance[TRAINED_STATES];

    for (size_t s = 0; s < TRAINED_STATES; s++)
        distance[s] = hypot(log(states->moes_M[s] / contact->moes_M),
                            0.5 * log1p(states->alpha_p_H[s]) - 0.5 * log1p(contact->alpha_p_H));
    for (size_t i = 0; i < count; i++) {
        size_t nearest = 0;
        for (size_t s = 1; s < TRAINED_STATES; s++)
            if (distance[s] < distance[nearest]) nearest = s;
        distance[nearest] = INFINITY;
        for (size_t j = 0; j < states->num_unknowns; j++)
            states->coordinates[nearest * states->num_unknowns + j] *= -50;
    }
}

/* If a start fails, the next trained solutions are tried, here up to the eleventh. */
static void goes_on_to_other_starts(void **state) {
    (void)state;
    trained training;
    reduced_basis coupled;
    reduced_problem reduced;

    trained_init(&training, 0.02);
    trained_basis(&coupled, &training, DEFORMATION_COUPLED, 0, 0);
    reduced_problem_init(&reduced, &coupled, NULL, 0, &strict_settings);
    const ehd_contact *contact = &training.contacts[3];
    spoil_nearest(&reduced.model.states, contact, 10);
    reduced_guess(&reduced.state, &reduced.model, contact_place_of(contact));
    assert_int_equal(
        reduced_solve(&reduced.info, &reduced.state, reduced.solver, contact, NULL, NULL), EHD_OK);
    const size_t alone = reduced.info.iterations;
    assert_int_equal(reduced.info.status, EHD_NOT_CONVERGED);
    assert_int_equal(reduced_solve_from_training(&reduced.info, &reduced.state, reduced.solver,
                                                 &reduced.model, contact, NULL),
                     EHD_OK);
    assert_int_equal(reduced.info.status, EHD_OK);
    assert_true(reduced.info.iterations > alone);
    check_close(reduced.info.scalars.central_film_thickness,
                training.states->central_film_thickness[3], 1e-6, 0);
    reduced_problem_free(&reduced);
    reduced_basis_free(&coupled);
    trained_free(&training);
}

/* used in models whose contacts have no lubricant */
static lubricant_rises no_rises[7];

static bool is_trained_at(const reduced_model *model, double M, double alpha_p_H,
                          frame_rates rates) {
    trained_range *range = trained_range_create(model);
    assert_non_null(range);
    const char *reason = trained_range_check(
        range, NULL, (contact_place){.moes_M = M, .alpha_p_H = alpha_p_H}, &rates);
    trained_range_free(range);
    return reason == NULL;
}

static bool is_trained(const reduced_model *model, double M, double alpha_p_H, double rate) {
    return is_trained_at(model, M, alpha_p_H, (frame_rates){.all = rate});
}

static void trained_range_is_the_hull(void **state) {
    (void)state;
    bool stationary[] = {true, true, true, true, true, true};
    flow_thinning thinning[6] = {{0}};
    double rate[6] = {0}, load_rate[6] = {0}, moes_M[] = {10, 20, 20, 10, 15, 15},
           alpha_p_H[] = {1, 2, 6, 5, 3, 1.5};
    reduced_model model = {.states = {.num_states = 6,
                                      .moes_M = moes_M,
                                      .alpha_p_H = alpha_p_H,
                                      .thinning = thinning,
                                      .stationary = stationary,
                                      .rate = rate,
                                      .load_rate = load_rate,
                                      .rises = no_rises}};
    const struct {
        double M, alpha_p_H;
        int inside;
    } points[] = {{15, 3, 1},    {10, 1, 1},    {20, 6, 1},    {15, 5.56, 1},  {15, 1.5, 1},
                  {10, 3, 1},    {20, 4, 1},    {15, 5.57, 0}, {15, 1.499, 0}, {9.99, 3, 0},
                  {20.01, 4, 0}, {10, 0.99, 0}, {20, 6.01, 0}, {1e6, 3, 0},    {15, 0, 0},
                  {12, 1.3, 1},  {12, 5.1, 1},  {12, 5.3, 0},  {12, 1.1, 0}};

    for (size_t i = 0; i < sizeof points / sizeof *points; i++)
        if (is_trained(&model, points[i].M, points[i].alpha_p_H, 0) != points[i].inside)
            fail_msg("M = %g, alpha p_H = %g: found %d", points[i].M, points[i].alpha_p_H,
                     !points[i].inside);
    // the contact changes faster than in training; a stationary training allows almost no change
    assert_true(is_trained(&model, 15, 3, 9e-4));
    assert_false(is_trained(&model, 15, 3, 0.1));
    rate[3] = 0.1;
    assert_true(is_trained(&model, 15, 3, 0.1));
    assert_false(is_trained(&model, 15, 3, 0.11));
    // in training the load changed more slowly than the contact, because the speed also changed
    load_rate[2] = 0.04;
    assert_true(is_trained_at(&model, 15, 3, (frame_rates){.all = 0.1, .load = 0.04}));
    assert_false(is_trained_at(&model, 15, 3, (frame_rates){.all = 0.1, .load = 0.045}));
    // only the load varies, so the training points lie on a curve, M ~ (alpha p_H)^2
    double line[] = {1, 2, 3, 4, 5, 6}, squares[] = {1, 4, 9, 16, 25, 36};
    model.states.alpha_p_H = line;
    model.states.moes_M = squares;
    assert_true(is_trained(&model, 2.5 * 2.5, 2.5, 0));
    assert_false(is_trained(&model, 2.5 * 2.5, 2.5001, 0));
    assert_false(is_trained(&model, 6.001 * 6.001, 6.001, 0));
    assert_false(is_trained(&model, 0.999 * 0.999, 0.999, 0));
    // round-off may move points off the curve
    double loads[6], off[6];
    for (int i = 0; i < 6; i++) {
        loads[i] = 12 * (0.9 + 0.04 * i);
        off[i] = 5.53 * sqrt(0.9 + 0.04 * i) * (1 + (i % 2) * 3e-16);
    }
    model.states.moes_M = loads;
    model.states.alpha_p_H = off;
    assert_true(is_trained(&model, 12, 5.53, 0));
    assert_false(is_trained(&model, 12 * 1.2, 5.53 * sqrt(1.2), 0));
    assert_false(is_trained(&model, 12 * 0.8, 5.53 * sqrt(0.8), 0));
    model.states.alpha_p_H = line;
    // the stored states of a trajectory are a few points of a curve
    model.states.moes_M = line;
    stationary[4] = false;
    assert_true(is_trained(&model, 2.5, 2.5, 0));
    assert_true(is_trained(&model, 6.005, 6.005, 0));
    assert_false(is_trained(&model, 6.1, 6.1, 0));
    assert_false(is_trained(&model, 2.5, 2.6, 0));
    assert_false(is_trained(&model, 2.6, 2.5, 0));
    // the trained range of a single point, or of no points, is empty
    model.states.num_states = 1;
    assert_false(is_trained(&model, 1, 1, 0));
    model.states.num_states = 0;
    assert_false(is_trained(&model, 1, 1, 0));
}

/* Checks how far contacts are outside of two trained ranges, M from 1 to 20 and from 20 to 30. */
static void outside_the_nearest_range(void **state) {
    (void)state;
    bool stationary[] = {true, true, true, true};
    flow_thinning thinning[4] = {
        {.sliding = 0.1}, {.sliding = 0.1}, {.sliding = 0.2}, {.sliding = 0.2}};
    flow_thinning newtonian[4] = {{0}};
    double rate[4] = {0}, of_large[] = {1, 20, 1, 20}, of_small[] = {20, 30, 20, 30},
           alpha_p_H[] = {1, 1, 4, 4};
    double *const moes_M[] = {of_large, of_small};
    flow_thinning *const thinnings[] = {newtonian, thinning};

    for (int kind = 0; kind < 2; kind++) {
        double found[2][4];
        const contact_place at[] = {{.moes_M = 5, .alpha_p_H = 2},
                                    {.moes_M = 40, .alpha_p_H = 2},
                                    {.moes_M = 25, .alpha_p_H = 4.5},
                                    {.moes_M = 25, .alpha_p_H = 2}};
        for (int r = 0; r < 2; r++) {
            const reduced_model model = {.states = {.num_states = 4,
                                                    .moes_M = moes_M[r],
                                                    .alpha_p_H = alpha_p_H,
                                                    .thinning = thinnings[kind],
                                                    .stationary = stationary,
                                                    .rate = rate,
                                                    .load_rate = rate,
                                                    .rises = no_rises}};
            trained_range *range = trained_range_create(&model);
            assert_non_null(range);
            for (int i = 0; i < 4; i++) {
                contact_place place = at[i];
                // the last place is between M = 20 and 30, but its thinning is too large for both
                // ranges
                place.thinning.sliding = kind == 0 ? 0 : i == 3 ? 0.3 : 0.15;
                found[r][i] = trained_range_outside(range, NULL, place);
            }
            trained_range_free(range);
        }
        if (kind == 0) {
            assert_true(found[0][0] < 0 && found[1][3] < 0);
            check_close(found[1][1], log(40. / 30), 1e-12, 1e-12);
            check_close(found[0][1], log(40. / 20), 1e-12, 1e-12);
            check_close(found[1][2], log(4.5 / 4), 1e-12, 1e-12);
        }
        assert_true(found[1][0] > 0 && found[0][3] > 0);
        assert_true(found[1][1] < found[0][1] && found[1][2] < found[0][2]);
        assert_true(found[1][3] <= found[0][3] && isfinite(found[0][3]));
    }
}

static const char *judge_place(const reduced_model *model, contact_place place) {
    trained_range *range = trained_range_create(model);
    assert_non_null(range);
    range_memory *memory = range_memory_create(range);
    assert_non_null(memory);
    const char *reason = trained_range_check(range, NULL, place, NULL);
    allocation_fail_at(0);
    assert_ptr_equal(trained_range_check(range, memory, place, NULL), reason);
    assert_false(allocation_failed()); // no allocation is needed
    range_memory_free(memory);
    trained_range_free(range);
    return reason ? reason : "";
}

static const char *judge(const reduced_model *model, double M, double alpha_p_H, double sliding) {
    const contact_place place = {
        .moes_M = M, .alpha_p_H = alpha_p_H, .thinning = {.sliding = sliding, .gradient = 0.5}};

    return judge_place(model, place);
}

/* Tests a trained range with the shape of a wedge: at larger M the flow is thinned more. Also tests
 * a model that was trained without thinned flow. */
static void trained_range_knows_thinning(void **state) {
    (void)state;
    static const char less[] = "a flow that is thinned less than any in training";
    static const char more[] = "a flow that is thinned more than any in training";
    static const char beside[] = "outside of the trained range of M, alpha p_H and thinning";
    static const char plane[] = "outside of the trained range of M and alpha p_H";
    bool stationary[] = {true, true, true, true, true, true, true};
    double rate[7] = {0}, moes_M[] = {10, 10, 10, 10, 40, 40, 20},
           alpha_p_H[] = {5, 20, 5, 20, 5, 20, 10},
           sliding[] = {0.01, 0.01, 0.04, 0.04, 0.04, 0.04, 0.03};
    flow_thinning thinning[7];
    reduced_model model = {.states = {.num_states = 7,
                                      .moes_M = moes_M,
                                      .alpha_p_H = alpha_p_H,
                                      .thinning = thinning,
                                      .stationary = stationary,
                                      .rate = rate,
                                      .load_rate = rate,
                                      .rises = no_rises}};

    for (size_t s = 0; s < 7; s++)
        thinning[s] = (flow_thinning){sliding[s], 0.5};
    for (size_t s = 0; s < 7; s++)
        assert_string_equal(judge(&model, moes_M[s], alpha_p_H[s], sliding[s]), "");
    // places on the slope of the wedge, where ln(thinning/0.01) = ln(M/10)
    assert_string_equal(judge(&model, 20, 10, 0.02), "");
    assert_string_equal(judge(&model, 20, 10, 0.02 * (1 + 1e-6)), "");
    assert_string_equal(judge(&model, 20, 10, 0.02 * (1 - 1e-6)), beside);
    assert_string_equal(judge(&model, 30, 12, 0.0299), beside);
    assert_string_equal(judge(&model, 20, 10, 0.041), more);
    assert_string_equal(judge(&model, 10, 10, 0.0099), less);
    assert_string_equal(judge(&model, 10, 10, 0), less);
    assert_string_equal(judge(&model, 9.9, 10, 0.02), plane);
    // Newtonian flow: no thinning, or too little to change a film
    for (size_t s = 0; s < 7; s++)
        thinning[s].sliding = 0;
    assert_string_equal(judge(&model, 20, 10, 0), "");
    assert_string_equal(judge(&model, 20, 10, 1e-7), "");
    assert_string_equal(judge(&model, 20, 10, 1.1e-6), more);
    // the training has both Newtonian and thinned flow
    thinning[0].sliding = 0.01;
    assert_string_equal(judge(&model, 10, 5, 0.005), "");
    assert_string_equal(judge(&model, 20, 10, 0.005), beside);
}

/* Like trained_range_knows_thinning, with thinning by the pressure gradient. */
static void trained_range_knows_gradients(void **state) {
    (void)state;
    static const char less[] = "a flow that the pressure gradient thins less than any in training";
    static const char more[] = "a flow that the pressure gradient thins more than any in training";
    static const char beside[] = "outside of the trained range of M, alpha p_H and thinning";
    bool stationary[] = {true, true, true, true, true, true};
    double rate[6] = {0}, moes_M[] = {10, 10, 10, 10, 40, 40}, alpha_p_H[] = {5, 20, 5, 20, 5, 20};
    flow_thinning thinning[] = {{0, 1}, {0, 1}, {0, 4}, {0, 4}, {0, 4}, {0, 4}};
    const struct {
        double M, gradient;
        const char *reason;
    } cases[] = {{20, 2 * (1 + 1e-6), ""},
                 {20, 2 * (1 - 1e-6), beside},
                 {20, 4.1, more},
                 {10, 0.99, less},
                 {10, 1.01, ""}};
    const reduced_model model = {.states = {.num_states = 6,
                                            .moes_M = moes_M,
                                            .alpha_p_H = alpha_p_H,
                                            .thinning = thinning,
                                            .stationary = stationary,
                                            .rate = rate,
                                            .load_rate = rate,
                                            .rises = no_rises}};

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const contact_place place = {
            .moes_M = cases[i].M, .alpha_p_H = 10, .thinning = {0, cases[i].gradient}};
        assert_string_equal(judge_place(&model, place), cases[i].reason);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quadratic_amid_training),
        cmocka_unit_test(effects_are_powers),
        cmocka_unit_test(effects_that_are_not_known),
        cmocka_unit_test(affine_where_training_spans_a_plane),
        cmocka_unit_test(nearest_on_a_line_and_far_away),
        cmocka_unit_test(lubricants_are_told_apart),
        cmocka_unit_test(few_states_of_two_lubricants),
        cmocka_unit_test(goes_on_to_other_starts),
        cmocka_unit_test(guess_at_a_training_point_is_that_state),
        cmocka_unit_test(trained_range_is_the_hull),
        cmocka_unit_test(outside_the_nearest_range),
        cmocka_unit_test(trained_range_knows_thinning),
        cmocka_unit_test(trained_range_knows_gradients),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
