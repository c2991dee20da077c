/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/deflection.h"
#include "romrun/solve/guess.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/reduced_problem.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static trained training;      // 301 nodes; sums of the cut are stored at every second one
static reduced_basis coupled; // as many modes as the training spans
static reduced_basis independent;

static const struct {
    const char *name;
    const reduced_basis *basis;
} kinds[] = {{"coupled", &coupled}, {"independent", &independent}};

static int set_up(void **state) {
    (void)state;
    trained_init(&training, 0.02);
    trained_basis(&coupled, &training, DEFORMATION_COUPLED, 0, 0);
    trained_basis(&independent, &training, DEFORMATION_INDEPENDENT, 0, 0);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    reduced_basis_free(&coupled);
    reduced_basis_free(&independent);
    trained_free(&training);
    return 0;
}

// ---- helpers

static void solve_from_neighbour(reduced_problem *self, size_t s) {
    reduced_neighbour(&self->state, &self->model,
                      (contact_place){.moes_M = training.states->moes_M[s],
                                      .alpha_p_H = training.states->alpha_p_H[s]});
    reduced_problem_solve(self, &training.contacts[s]);
}

/* Computes pressure and film on the whole grid by definition. The pressure is zero behind the exit,
 * and with a coupled basis the film contains the deflection K P. */
static void full_fields(double *pressure, double *film, const reduced_problem *self,
                        const reduced_basis *basis) {
    const ehd_grid *grid = &basis->grid;
    const double *z = self->state.coordinates;
    size_t n = self->model.num_unknowns;
    ehd_deflection *deflection = deflection_create(basis->kind, grid);

    assert_non_null(deflection);
    for (size_t k = 0; k < grid->num_nodes; k++) {
        pressure[k] = 0;
        for (size_t j = 0; j < basis->num_pressure && k < self->state.exit; j++)
            pressure[k] += basis->pressure[k * basis->num_pressure + j] * z[j];
    }
    deflection_apply(film, deflection, pressure);
    for (size_t k = 0; k < grid->num_nodes; k++) {
        if (basis->deformation == DEFORMATION_INDEPENDENT) {
            film[k] = 0;
            for (size_t j = 0; j < basis->num_deformation; j++)
                film[k] += basis->deformation_modes[k * basis->num_deformation + j] *
                           z[basis->num_pressure + j];
        }
        film[k] += z[n - 1] + grid_gap(grid, k);
    }
    deflection_free(deflection);
}

/* Checks that fields_of computes the same fields as full_fields, for a coupled basis and any
 * exit. */
static void check_fields(const reduced_problem *self, const reduced_basis *basis) {
    const size_t num_nodes = basis->grid.num_nodes;
    double *both = calloc(4 * num_nodes, sizeof *both);

    assert_non_null(both);
    full_fields(both, both + num_nodes, self, basis);
    fields_of(both + 2 * num_nodes, both + 3 * num_nodes, &self->state, &self->model,
              basis->pressure);
    check_close_array(both + 2 * num_nodes, both, 2 * num_nodes, 1e-12, 1e-13);
    free(both);
}

static double *fields(void) {
    double *memory = calloc(2 * training.set.grid.num_nodes, sizeof *memory);

    assert_non_null(memory);
    return memory;
}

/* Checks that the solution equals the solution of the full solver at all nodes. */
static void check_is_training_state(const reduced_problem *self, const reduced_basis *basis,
                                    size_t s, double tolerance) {
    size_t num_nodes = basis->grid.num_nodes;
    double *pressure = fields(), *film = pressure + num_nodes;

    if (basis->deformation == DEFORMATION_COUPLED) check_fields(self, basis);
    full_fields(pressure, film, self, basis);
    assert_int_equal(self->state.exit, training.states->exit[s]);
    check_close(self->info.scalars.central_film_thickness,
                training.states->central_film_thickness[s], tolerance, 0);
    check_close_array(pressure, training.pressure + s * num_nodes, num_nodes, 0, tolerance);
    check_close_array(film, training.film + s * num_nodes, num_nodes, 0, tolerance);
    free(pressure);
}

/* Returns the numbers 1 … count in an irregular order, which is the same in each run. */
static size_t *shuffled_nodes(size_t count) {
    size_t *nodes = malloc(count * sizeof *nodes);
    unsigned long long random = 12345;

    assert_non_null(nodes);
    for (size_t i = 0; i < count; i++)
        nodes[i] = i + 1;
    for (size_t i = count; i-- > 1;) {
        random = random * 6364136223846793005ULL + 1442695040888963407ULL;
        size_t other = (size_t)(random >> 33) % (i + 1), kept = nodes[i];
        nodes[i] = nodes[other];
        nodes[other] = kept;
    }
    return nodes;
}

// ---- the reduced model is the full one

static void full_rank_reproduces_the_full_model(void **state) {
    (void)state;
    reduced_basis basis = identity_basis(&training.set, DEFORMATION_COUPLED, coupled.weight);
    reduced_problem reduced;

    reduced_problem_init(&reduced, &basis, NULL, 0, &strict_settings);
    for (size_t s = 0; s < TRAINED_STATES; s++) {
        solve_from_neighbour(&reduced, s);
        check_is_training_state(&reduced, &basis, s, 1e-10);
    }
    reduced_problem_free(&reduced);
    reduced_basis_free(&basis);
}

/* If the basis contains the solution, the solver finds it from a start near the solution with the
 * right exit. From an exit farther downstream, the solver might stop some nodes behind the right
 * exit. With this basis no pressure there has a sign that shows the error
 * (moving_the_exit_equals_rebuilding). */
static void a_basis_with_the_solution_finds_it(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        reduced_problem reduced;
        reduced_problem_init(&reduced, kinds[kind].basis, NULL, 0, &strict_settings);
        for (size_t s = 0; s < TRAINED_STATES; s++) {
            size_t n = reduced.model.num_unknowns;
            const double *target = kinds[kind].basis->states.coordinates + s * n;
            for (size_t j = 0; j < n; j++)
                reduced.state.coordinates[j] = target[j] * (1 + (j % 2 ? 1e-3 : -1e-3));
            reduced.state.exit = training.states->exit[s];
            reduced_problem_solve(&reduced, &training.contacts[s]);
            check_is_training_state(&reduced, kinds[kind].basis, s, 1e-10);
            assert_true(reduced.info.residual < 1e-6);
        }
        reduced_problem_free(&reduced);
    }
}

static void all_rows_in_any_order_are_level_i(void **state) {
    (void)state;
    size_t num_inner = training.set.grid.num_inner, *nodes = shuffled_nodes(num_inner);

    for (int kind = 0; kind < 2; kind++) {
        reduced_basis small;
        reduced_problem level_i, level_n;
        trained_basis(&small, &training, kinds[kind].basis->deformation, 9, kind ? 7 : 0);
        reduced_problem_init(&level_i, &small, NULL, 0, &strict_settings);
        reduced_problem_init(&level_n, &small, nodes, num_inner, &strict_settings);
        for (size_t s = 0; s < TRAINED_STATES; s += 2) {
            solve_from_neighbour(&level_i, s);
            solve_from_neighbour(&level_n, s);
            assert_int_equal(level_n.state.exit, level_i.state.exit);
            // Both solutions need about 22 iterations. The numbers may differ, because the last
            // change is as small as the round-off that depends on the order of the rows.
            assert_in_range(level_n.info.iterations + 1, level_i.info.iterations,
                            level_i.info.iterations + 2);
            check_close(level_n.info.scalars.central_film_thickness,
                        level_i.info.scalars.central_film_thickness, 1e-12, 0);
            check_close(level_n.info.scalars.minimum_film_thickness,
                        level_i.info.scalars.minimum_film_thickness, 1e-12, 0);
            check_close(level_n.info.residual, level_i.info.residual, 1e-9, 1e-15);
        }
        reduced_problem_free(&level_i);
        reduced_problem_free(&level_n);
        reduced_basis_free(&small);
    }
    free(nodes);
}

/* Solves least squares by LAPACK; call number fails_at fails. */
typedef struct other_solver {
    size_t calls, fails_at;
} other_solver;

static ehd_status solve_otherwise(double *step, void *context, const double *matrix,
                                  const double *right, size_t num_rows, size_t num_unknowns) {
    other_solver *self = context;
    double *copy, *x;

    if (++self->calls == self->fails_at) return EHD_NOT_CONVERGED;
    copy = malloc(num_rows * num_unknowns * sizeof *copy);
    x = malloc(num_rows * sizeof *x);
    assert_non_null(copy);
    assert_non_null(x);
    memcpy(copy, matrix, num_rows * num_unknowns * sizeof *copy);
    for (size_t r = 0; r < num_rows; r++)
        x[r] = -right[r];
    assert_int_equal(LAPACKE_dgels(LAPACK_ROW_MAJOR, 'N', (int)num_rows, (int)num_unknowns, 1, copy,
                                   (int)num_unknowns, x, 1),
                     0);
    memcpy(step, x, num_unknowns * sizeof *step);
    free(x);
    free(copy);
    return EHD_OK;
}

/* One problem with two linear solvers: the model's own solver and another solver. */
typedef struct two_ways {
    other_solver other;
    reduced_basis small;
    reduced_problem own, with_other;
} two_ways;

static void two_ways_init(two_ways *self, reduced_linear_solver *solve) {
    reduced_settings settings = strict_settings;

    settings.solve_linear = solve;
    settings.linear_context = &self->other;
    trained_basis(&self->small, &training, DEFORMATION_COUPLED, 9, 0);
    reduced_problem_init(&self->own, &self->small, NULL, 0, &strict_settings);
    reduced_problem_init(&self->with_other, &self->small, NULL, 0, &settings);
}

static void two_ways_free(two_ways *self) {
    reduced_problem_free(&self->own);
    reduced_problem_free(&self->with_other);
    reduced_basis_free(&self->small);
}

static void another_linear_solver_may_be_put_in(void **state) {
    (void)state;
    two_ways ways;
    reduced_problem *own = &ways.own, *with_other = &ways.with_other;

    two_ways_init(&ways, solve_otherwise);
    for (size_t s = 0; s < TRAINED_STATES; s += 3) {
        ways.other = (other_solver){0};
        solve_from_neighbour(own, s);
        solve_from_neighbour(with_other, s);
        assert_int_equal(with_other->info.iterations, own->info.iterations);
        assert_int_equal(ways.other.calls, own->info.iterations);
        check_close(with_other->info.scalars.central_film_thickness,
                    own->info.scalars.central_film_thickness, 1e-11, 0);
    }
    // if a linear system cannot be solved, the solver ends without convergence
    ways.other = (other_solver){.fails_at = 2};
    reduced_neighbour(&with_other->state, &with_other->model,
                      (contact_place){.moes_M = training.states->moes_M[0],
                                      .alpha_p_H = training.states->alpha_p_H[0]});
    assert_int_equal(reduced_solve(&with_other->info, &with_other->state, with_other->solver,
                                   &training.contacts[0], NULL, NULL),
                     EHD_OK);
    assert_int_equal(with_other->info.status, EHD_NOT_CONVERGED);
    assert_int_equal(with_other->info.iterations, 1);
    two_ways_free(&ways);
}

/* Makes the first step far too long, so that the solver damps this step, and makes the second step
 * far too short. */
static ehd_status overshoot(double *step, void *context, const double *matrix, const double *right,
                            size_t num_rows, size_t num_unknowns) {
    other_solver *self = context;
    ehd_status status = solve_otherwise(step, context, matrix, right, num_rows, num_unknowns);

    for (size_t j = 0; j < num_unknowns && self->calls <= 2; j++)
        step[j] *= self->calls == 1 ? 1e4 : 1e-4;
    return status;
}

/* The rate of convergence must not be computed from the undamped length of a damped step. */
static void a_damped_step_shows_no_rate(void **state) {
    (void)state;
    two_ways ways;
    const contact_scalars *own = &ways.own.info.scalars, *other = &ways.with_other.info.scalars;

    two_ways_init(&ways, overshoot);
    for (size_t s = 0; s < TRAINED_STATES; s += 3) {
        ways.other = (other_solver){0};
        solve_from_neighbour(&ways.own, s);
        solve_from_neighbour(&ways.with_other, s);
        check_close(other->central_film_thickness, own->central_film_thickness, 1e-11, 0);
        check_close(other->minimum_film_thickness, own->minimum_film_thickness, 1e-8, 0);
    }
    two_ways_free(&ways);
}

/* Truncated bases reproduce their training states up to the truncation error, which decreases with
 * the number of modes. */
static void truncated_bases_stay_near(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        double before = INFINITY;
        for (size_t num_pressure = 6; num_pressure <= 10; num_pressure += 2) {
            double worst = 0;
            reduced_basis small;
            reduced_problem reduced;
            trained_basis(&small, &training, kinds[kind].basis->deformation, num_pressure,
                          kind ? num_pressure : 0);
            reduced_problem_init(&reduced, &small, NULL, 0, &strict_settings);
            for (size_t s = 0; s < TRAINED_STATES; s++) {
                double expected = training.states->central_film_thickness[s];
                reduced_guess(&reduced.state, &reduced.model,
                              (contact_place){.moes_M = training.states->moes_M[s],
                                              .alpha_p_H = training.states->alpha_p_H[s]});
                reduced_problem_solve(&reduced, &training.contacts[s]);
                worst =
                    fmax(worst, fabs(reduced.info.scalars.central_film_thickness / expected - 1));
            }
            assert_true(worst < before);
            before = worst;
            reduced_problem_free(&reduced);
            reduced_basis_free(&small);
        }
        assert_true(before < 1e-2);
    }
}

/* Solves each training point, starting from the solution of each training point, in the published
 * discretisation. Because of damping and a limit of the exit's strides all these solutions
 * converge, in 850 iterations altogether. In the accurate discretisation 8 of 144 solutions end in
 * another minimum of the residual. All 8 have the lightest load and the most viscous lubricant. */
static void any_trained_solution_leads_to_any_other(void **state) {
    (void)state;
    const reduced_settings settings = reduced_defaults;
    reduced_problem reduced;
    reduced_basis basis;
    trained published;
    size_t num_iterations = 0;

    trained_init_published(&published, 0.02);
    trained_basis(&basis, &published, DEFORMATION_INDEPENDENT, 0, 0);
    reduced_problem_init(&reduced, &basis, NULL, 0, &settings);
    const size_t n = reduced.model.num_unknowns;
    for (size_t i = 0; i < TRAINED_STATES * TRAINED_STATES; i++) {
        const size_t from = i / TRAINED_STATES, to = i % TRAINED_STATES;
        memcpy(reduced.state.coordinates, basis.states.coordinates + from * n, n * sizeof(double));
        reduced.state.exit = published.states->exit[from];
        reduced_problem_solve(&reduced, &published.contacts[to]);
        check_close(reduced.info.scalars.central_film_thickness,
                    published.states->central_film_thickness[to], 1e-4, 0);
        num_iterations += reduced.info.iterations;
    }
    assert_true(num_iterations < 880);
    reduced_problem_free(&reduced);
    reduced_basis_free(&basis);
    trained_free(&published);
}

// ---- an exit between two nodes, with the accurate discretisation

static const deformation_kind both_kinds[] = {DEFORMATION_COUPLED, DEFORMATION_INDEPENDENT};

static void check_full_rank(void (*init)(trained *, double)) {
    trained accurate;
    reduced_basis small;
    init(&accurate, 0.04);
    trained_basis(&small, &accurate, DEFORMATION_COUPLED, 0, 0);
    for (int kind = 0; kind < 2; kind++) {
        reduced_basis basis = identity_basis(&accurate.set, both_kinds[kind], small.weight);
        const size_t num_nodes = basis.grid.num_nodes;
        reduced_problem reduced;
        reduced_problem_init(&reduced, &basis, NULL, 0, &strict_settings);
        for (size_t s = 0; s < TRAINED_STATES; s++) {
            const size_t exit = accurate.states->exit[s];
            const double *pressure = accurate.pressure + s * num_nodes;
            reduced_neighbour(&reduced.state, &reduced.model,
                              (contact_place){.moes_M = accurate.states->moes_M[s],
                                              .alpha_p_H = accurate.states->alpha_p_H[s],
                                              .thinning = accurate.states->thinning[s]});
            reduced_problem_solve(&reduced, &accurate.contacts[s]);
            assert_int_equal(reduced.state.exit, exit);
            check_close_array(reduced.state.coordinates, pressure + 1, exit - 1, 0, 1e-9);
            check_close(reduced.info.scalars.central_film_thickness,
                        accurate.states->central_film_thickness[s], 1e-10, 0);
            check_close(reduced.info.scalars.exit_position, accurate.exit_position[s], 0, 1e-8);
        }
        reduced_problem_free(&reduced);
        reduced_basis_free(&basis);
    }
    reduced_basis_free(&small);
    trained_free(&accurate);
}

static void accurate_full_rank_reproduces_the_full_model(void **state) {
    (void)state;
    check_full_rank(trained_init_accurate);
}

static void thinned_full_rank_reproduces_the_full_model(void **state) {
    trained thinned, newtonian;
    (void)state;

    check_full_rank(trained_init_thinned);
    // thinning changes the flow: it reduces the thickest film by more than a tenth
    trained_init_thinned(&thinned, 0.04);
    trained_init_accurate(&newtonian, 0.04);
    assert_true(thinned.states->central_film_thickness[2] <
                0.9 * newtonian.states->central_film_thickness[2]);
    trained_free(&thinned);
    trained_free(&newtonian);
}

/* A large Eyring stress gives the Newtonian film, a small stress does not. This fluid is
 * incompressible, so its mobility is exponential in the pressure. The Newtonian flow between two
 * nodes is then exact without a mobility between the nodes. */
static void thinned_solutions_have_the_newtonian_limit(void **state) {
    (void)state;
    trained thinned;
    reduced_basis basis;
    reduced_problem reduced;
    trained_init_thinned(&thinned, 0.05);
    trained_basis(&basis, &thinned, DEFORMATION_COUPLED, 0, 0);
    reduced_problem_init(&reduced, &basis, NULL, 0, &strict_settings);
    const double stresses[] = {0, 1e9, 1e-2};
    contact_scalars found[3];
    for (int i = 0; i < 3; i++) {
        ehd_contact contact = thinned.contacts[4];
        contact.lubricant.thinning_stress = stresses[i] * contact.hertz_pressure;
        contact.lubricant.density = NULL;
        reduced_guess(&reduced.state, &reduced.model, contact_place_of(&contact));
        reduced_problem_solve(&reduced, &contact);
        found[i] = reduced.info.scalars;
    }
    check_close(found[1].central_film_thickness, found[0].central_film_thickness, 1e-9, 0);
    check_close(found[1].minimum_film_thickness, found[0].minimum_film_thickness, 1e-9, 0);
    assert_true(fabs(found[2].central_film_thickness / found[0].central_film_thickness - 1) > 1e-6);
    reduced_problem_free(&reduced);
    reduced_basis_free(&basis);
    trained_free(&thinned);
}

/* The last row of a least-squares problem, which belongs to the exit cell. */
typedef struct last_row {
    double matrix[TRAINED_STATES * 4], right;
} last_row;

static ehd_status keep_last_row(double *step, void *context, const double *matrix,
                                const double *right, size_t num_rows, size_t num_unknowns) {
    last_row *self = context;
    (void)step;

    assert_true(num_unknowns <= TRAINED_STATES * 4);
    memcpy(self->matrix, matrix + (num_rows - 1) * num_unknowns, num_unknowns * sizeof(double));
    self->right = right[num_rows - 1];
    return EHD_NOT_CONVERGED;
}

/* Compares the derivatives of the row of the exit cell with finite differences. The place of the
 * exit in its cell is computed from the flux each time, so the residual of this row depends only on
 * the coordinates. One exit is at a checkpoint, the other behind one. */
static void the_cell_s_row_equals_finite_differences(void **state) {
    (void)state;
    trained accurate;
    last_row row = {0};
    const reduced_settings once = {.max_iterations = 1,
                                   .tolerance = 1e-8,
                                   .solve_linear = keep_last_row,
                                   .linear_context = &row};
    trained_init_accurate(&accurate, 0.01);
    for (int i = 0; i < 4; i++) {
        const size_t s = i < 2 ? 4 : 6;
        reduced_basis basis;
        reduced_problem reduced;
        double there[TRAINED_STATES * 4], side[2];
        trained_basis(&basis, &accurate, both_kinds[i % 2], 0, 0);
        reduced_problem_init(&reduced, &basis, NULL, 0, &once);
        const size_t n = reduced.model.num_unknowns;
        for (size_t j = 0; j < n; j++) {
            const double h = j + 1 < n ? 1e-4 : 1e-7;
            for (int sign = 0; sign < 3; sign++) { // the last evaluation is at the state itself
                memcpy(reduced.state.coordinates, basis.states.coordinates + s * n,
                       n * sizeof(double));
                reduced.state.coordinates[j] += sign == 0 ? -h : sign == 1 ? h : 0;
                reduced_state_set_exits(&reduced.state, &reduced.model, &accurate.states->exit[s]);
                assert_int_equal(reduced_solve(&reduced.info, &reduced.state, reduced.solver,
                                               &accurate.contacts[s], NULL, NULL),
                                 EHD_OK);
                if (sign < 2) side[sign] = row.right;
            }
            there[j] = (side[1] - side[0]) / (2 * h);
        }
        double largest = 0;
        for (size_t j = 0; j < n; j++)
            largest = fmax(largest, fabs(row.matrix[j]));
        check_close_array(row.matrix, there, n, 1e-4, 1e-5 * largest);
        reduced_problem_free(&reduced);
        reduced_basis_free(&basis);
    }
    trained_free(&accurate);
}

/* A complete least-squares problem. */
enum { MOST_UNKNOWNS = TRAINED_STATES * 4, MOST_ROWS = 200 };
typedef struct whole_problem {
    double matrix[MOST_ROWS * MOST_UNKNOWNS], right[MOST_ROWS];
    size_t num_rows;
} whole_problem;

static ehd_status keep_problem(double *step, void *context, const double *matrix,
                               const double *right, size_t num_rows, size_t num_unknowns) {
    whole_problem *self = context;
    (void)step;

    assert_true(num_rows <= MOST_ROWS && num_unknowns <= MOST_UNKNOWNS);
    memcpy(self->matrix, matrix, num_rows * num_unknowns * sizeof(double));
    memcpy(self->right, right, num_rows * sizeof(double));
    self->num_rows = num_rows;
    return EHD_NOT_CONVERGED;
}

/* Compares the derivatives of all rows, including the row of the exit cell, with finite
 * differences, for flows that are thinned by sliding. */
static void thinned_rows_equal_finite_differences(void **state) {
    (void)state;
    trained thinned;
    static whole_problem here, side[2];
    trained_init_thinned(&thinned, 0.05);
    for (int i = 0; i < 2; i++) {
        const size_t s = 6;
        reduced_basis basis;
        trained_basis(&basis, &thinned, both_kinds[i], 0, 0);
        for (size_t j = 0; j < reduced_num_unknowns(basis.num_pressure, basis.num_deformation);
             j++) {
            const size_t n = reduced_num_unknowns(basis.num_pressure, basis.num_deformation);
            const double h = j + 1 < n ? 1e-4 : 1e-7;
            for (int sign = 0; sign < 3; sign++) {
                whole_problem *kept = sign < 2 ? &side[sign] : &here;
                const reduced_settings once = {.max_iterations = 1,
                                               .tolerance = 1e-8,
                                               .solve_linear = keep_problem,
                                               .linear_context = kept};
                reduced_problem reduced;
                reduced_problem_init(&reduced, &basis, NULL, 0, &once);
                memcpy(reduced.state.coordinates, basis.states.coordinates + s * n,
                       n * sizeof(double));
                reduced.state.coordinates[j] += sign == 0 ? -h : sign == 1 ? h : 0;
                reduced_state_set_exits(&reduced.state, &reduced.model, &thinned.states->exit[s]);
                assert_int_equal(reduced_solve(&reduced.info, &reduced.state, reduced.solver,
                                               &thinned.contacts[s], NULL, NULL),
                                 EHD_OK);
                reduced_problem_free(&reduced);
            }
            double largest = 0;
            for (size_t r = 0; r < here.num_rows; r++)
                largest = fmax(largest, fabs(here.matrix[r * n + j]));
            for (size_t r = 0; r < here.num_rows; r++)
                check_close(here.matrix[r * n + j], (side[1].right[r] - side[0].right[r]) / (2 * h),
                            1e-4, 1e-5 * largest);
        }
        reduced_basis_free(&basis);
    }
    trained_free(&thinned);
}

// ---- moving the exit

/* Newton's iteration moves a wrong exit by one or several nodes at a time, each time with a rank-k
 * update of the tables. The results come from the updated tables. They must equal the results that
 * the final state has by definition, and must not depend on the exit of the start. */
static void moving_the_exit_equals_rebuilding(void **state) {
    (void)state;
    enum { STATE = 4 };
    size_t num_nodes = training.set.grid.num_nodes, centre = 201;
    double *pressure = fields(), *film = pressure + num_nodes;

    check_close(grid_x(&training.set.grid, centre), 0, 0, 1e-12);
    for (int kind = 0; kind < 2; kind++) {
        const reduced_basis *basis = kinds[kind].basis;
        reduced_problem reduced;
        reduced_problem_init(&reduced, basis, NULL, 0, &strict_settings);
        size_t least = reduced.model.band.lines[0].min_exit,
               most = reduced.model.band.lines[0].max_exit, found = 0;
        for (size_t exit = least; exit <= most; exit++) {
            double load = 0;
            reduced_neighbour(&reduced.state, &reduced.model,
                              (contact_place){.moes_M = training.states->moes_M[STATE],
                                              .alpha_p_H = training.states->alpha_p_H[STATE]});
            reduced.state.exit = exit;
            reduced_problem_solve(&reduced, &training.contacts[STATE]);
            if (reduced.state.exit == training.states->exit[STATE])
                check_is_training_state(&reduced, basis, STATE, 1e-10);
            found += reduced.state.exit == training.states->exit[STATE];
            check_close(reduced.info.scalars.central_film_thickness,
                        training.states->central_film_thickness[STATE], 1e-5, 0);
            full_fields(pressure, film, &reduced, basis);
            for (size_t k = 1; k < num_nodes; k++)
                load += basis->grid.step * pressure[k] / basis->kind->load;
            check_close(reduced.info.scalars.load, load, 1e-12, 0);
            check_close(reduced.info.scalars.load, 1, 1e-7, 0);
            check_close(reduced.info.scalars.central_film_thickness, film[centre], 1e-11, 0);
            check_close(reduced.info.scalars.central_pressure, pressure[centre], 1e-11, 0);
        }
        assert_true(found > (most - least) / 3);
        reduced_problem_free(&reduced);
    }
    free(pressure);
}

/* The right exits of these contacts lie outside of the exit band. The solver must keep its exit
 * inside the band, because its tables end with the band. */
static void the_exit_stays_inside_the_tables(void **state) {
    (void)state;
    const double moes_M[] = {2, 4, 5, 6, 7, 300};

    for (int kind = 0; kind < 2; kind++) {
        reduced_problem reduced;
        reduced_problem_init(&reduced, kinds[kind].basis, NULL, 0, &strict_settings);
        const size_t ends[] = {reduced.model.band.lines[0].min_exit,
                               reduced.model.band.lines[0].max_exit};
        for (size_t i = 0; i < 12; i++) {
            ehd_contact contact = training.contacts[0];
            contact_set_moes(&contact, moes_M[i / 2], 3);
            reduced_guess(&reduced.state, &reduced.model, contact_place_of(&contact));
            reduced.state.exit = ends[i % 2];
            assert_int_equal(
                reduced_solve(&reduced.info, &reduced.state, reduced.solver, &contact, NULL, NULL),
                EHD_OK);
            assert_true(reduced.state.exit >= reduced.model.band.lines[0].min_exit);
            assert_true(reduced.state.exit <= reduced.model.band.lines[0].max_exit);
            assert_true(reduced.info.iterations <= strict_settings.max_iterations);
        }
        reduced_problem_free(&reduced);
    }
}

// ---- reported results

static void minimum_film_is_that_of_the_fields(void **state) {
    (void)state;
    size_t num_nodes = training.set.grid.num_nodes;
    double *pressure = fields(), *film = pressure + num_nodes;

    for (int kind = 0; kind < 2; kind++) {
        const reduced_basis *basis = kinds[kind].basis;
        reduced_problem reduced;
        reduced_problem_init(&reduced, basis, NULL, 0, &strict_settings);
        for (size_t s = 0; s < TRAINED_STATES; s++) {
            solve_from_neighbour(&reduced, s);
            full_fields(pressure, film, &reduced, basis);
            check_close(reduced.info.scalars.minimum_film_thickness,
                        trained_least_film(film, &basis->grid), 1e-11, 0);
            // All nodes of this model are needed nodes. If other coordinates than those of the
            // solution are given, as below, only the pressures in the band are computed from the
            // given coordinates.
            reduced_pressures range = reduced_pressure_range(reduced.solver, &reduced.state);
            double least = 0, largest = 0;
            for (size_t k = 0; k < num_nodes; k++) {
                least = fmin(least, pressure[k]);
                largest = fmax(largest, pressure[k]);
            }
            check_close(range.least, least, 0, 1e-12);
            check_close(range.largest, largest, 1e-12, 0);
            for (size_t j = 0; j < basis->num_pressure; j++)
                reduced.state.coordinates[j] *= -1;
            range = reduced_pressure_range(reduced.solver, &reduced.state);
            assert_true(range.least < -0.01);
            check_close(range.largest, largest, 1e-12, 0);
            const double offset = reduced.state.exit_offset;
            assert_true(offset >= 0 && offset <= 1);
            check_close(reduced.info.scalars.exit_position,
                        grid_x(&basis->grid, reduced.state.exit - 1) + offset * basis->grid.step, 0,
                        1e-12);
        }
        reduced_problem_free(&reduced);
    }
    free(pressure);
}

// ---- the Jacobian

typedef struct observation {
    size_t num_rows, count;
    double *residual, *step; // [num_rows] each, of the first iteration
} observation;

static ehd_status observe_first(void *context, const double *residual, const double *step,
                                ehd_error *error) {
    observation *seen = context;
    (void)error;
    if (seen->count++ == 0) {
        memcpy(seen->residual, residual, seen->num_rows * sizeof(double));
        memcpy(seen->step, step, seen->num_rows * sizeof(double));
    }
    return EHD_OK;
}

/* Makes one iteration from z with a given exit; stores the observed system and the new state. */
static void iterate_once(observation *seen, reduced_problem *self, const double *z, size_t exit,
                         const ehd_contact *contact) {
    seen->count = 0;
    memcpy(self->state.coordinates, z, self->model.num_unknowns * sizeof(double));
    self->state.exit = exit;
    assert_int_equal(reduced_solve(&self->info, &self->state, self->solver, contact, NULL, NULL),
                     EHD_OK);
    assert_int_equal(seen->count, 1);
}

static ehd_status observe_end(void *context, const reduced_info *info, ehd_error *error) {
    ehd_status *outcome = context;
    (void)error;
    *outcome = info->status;
    return EHD_OK;
}

static ehd_status ignore_iteration(void *context, const double *residual, const double *step,
                                   ehd_error *error) {
    (void)context, (void)residual, (void)step, (void)error;
    return EHD_OK;
}

static void the_observer_is_told_what_became_of_a_solution(void **state) {
    (void)state;
    const reduced_settings settings[] = {{.tolerance = 1e-12, .max_iterations = 1},
                                         reduced_defaults};
    for (int i = 0; i < 2; i++) {
        reduced_problem reduced;
        ehd_status outcome = EHD_INTERNAL;
        reduced_problem_init(&reduced, kinds[0].basis, NULL, 0, &settings[i]);
        reduced_neighbour(&reduced.state, &reduced.model, contact_place_of(&training.contacts[7]));
        reduced_solver_observe(reduced.solver, ignore_iteration, observe_end, &outcome);
        assert_int_equal(reduced_solve(&reduced.info, &reduced.state, reduced.solver,
                                       &training.contacts[7], NULL, NULL),
                         EHD_OK);
        assert_int_equal(outcome, i == 0 ? EHD_NOT_CONVERGED : EHD_OK);
        reduced_problem_free(&reduced);
    }
}

/* Compares central differences of the weighted residuals, (D f(z + t dz) - D f(z - t dz)) / 2t,
 * with the recorded D J dz, at states that are no solutions. */
static void jacobian_equals_finite_differences(void **state) {
    (void)state;
    const reduced_settings once = {.tolerance = 1e-12, .max_iterations = 1};
    const double t = 0.5;
    enum { STATE = 7 };

    for (int kind = 0; kind < 2; kind++) {
        const reduced_basis *basis = kinds[kind].basis;
        reduced_problem reduced;
        reduced_problem_init(&reduced, basis, NULL, 0, &once);
        size_t n = reduced.model.num_unknowns, num_rows = reduced.model.rows.num_rows;
        double *memory = calloc(6 * num_rows + 3 * n, sizeof *memory);
        assert_non_null(memory);
        double *z = memory + 6 * num_rows, *dz = z + n, *moved = dz + n;
        observation here = {num_rows, 0, memory, memory + num_rows};
        observation ahead = {num_rows, 0, memory + 2 * num_rows, memory + 3 * num_rows};
        observation behind = {num_rows, 0, memory + 4 * num_rows, memory + 5 * num_rows};
        size_t exit = training.states->exit[STATE];
        for (size_t mode = 0; mode < n; mode++) {
            double largest = 0;
            const double *trained_z = basis->states.coordinates + STATE * n;
            memcpy(z, trained_z, n * sizeof(double));
            z[mode] += 1e-4;
            reduced_solver_observe(reduced.solver, observe_first, NULL, &here);
            iterate_once(&here, &reduced, z, exit, &training.contacts[STATE]);
            for (size_t j = 0; j < n; j++)
                dz[j] = reduced.state.coordinates[j] - z[j];
            for (size_t j = 0; j < n; j++)
                moved[j] = z[j] + t * dz[j];
            reduced_solver_observe(reduced.solver, observe_first, NULL, &ahead);
            iterate_once(&ahead, &reduced, moved, exit, &training.contacts[STATE]);
            for (size_t j = 0; j < n; j++)
                moved[j] = z[j] - t * dz[j];
            reduced_solver_observe(reduced.solver, observe_first, NULL, &behind);
            iterate_once(&behind, &reduced, moved, exit, &training.contacts[STATE]);
            for (size_t r = 0; r < num_rows; r++)
                largest = fmax(largest, fabs(here.step[r]));
            assert_true(largest > 1e-8);
            for (size_t r = 0; r < num_rows; r++) {
                double difference = (ahead.residual[r] - behind.residual[r]) / (2 * t);
                check_close(here.step[r], difference, 1e-4, 1e-6 * largest);
                if (r + 1 >= exit) check_close(here.step[r], 0, 0, 0);
            }
        }
        free(memory);
        reduced_problem_free(&reduced);
    }
}

// ---- faults

static void bad_rows_are_refused(void **state) {
    (void)state;
    const size_t few[] = {100, 101, 102}, zero[] = {0}, behind[] = {302};
    size_t *nodes = shuffled_nodes(training.set.grid.num_inner);
    const struct {
        const size_t *rows;
        size_t num_rows;
        const char *words;
    } cases[] = {{few, 3, "rows: found 3 rows, expected at least 12"},
                 {zero, 1, "rows: found node 0, expected an inner node"},
                 {behind, 1, "rows: found node 302, expected an inner node"}};

    for (size_t i = 0; i < 3; i++) {
        ehd_error error = {""};
        reduced_model model;
        size_t kept = nodes[0];
        if (i > 0) nodes[0] = cases[i].rows[0];
        assert_int_equal(reduced_model_build(&model, &coupled, i ? nodes : few, i ? 20 : 3, &error),
                         EHD_DATA);
        assert_string_equal(strstr(error.text, cases[i].words) ? "" : error.text, "");
        nodes[0] = kept;
    }
    free(nodes);
}

static void survives_failing_allocations(void **state) {
    (void)state;
    const size_t rows[] = {100, 110, 120, 130, 140, 150, 160, 170, 180, 190, 200, 210, 220, 240};

    for (int kind = 0; kind < 2; kind++) {
        reduced_model model;
        reduced_solver *solver;
        size_t call = 0;
        for (;; call++) {
            allocation_fail_at(call);
            ehd_status status = reduced_model_build(&model, kinds[kind].basis, rows, 14, NULL);
            if (!allocation_failed()) break;
            assert_int_equal(status, EHD_MEMORY);
        }
        assert_true(call > 20);
        for (call = 0;; call++) {
            allocation_fail_at(call);
            ehd_status status = reduced_solver_create(&solver, &model, &strict_settings, NULL);
            if (!allocation_failed()) break;
            assert_int_equal(status, EHD_MEMORY);
            assert_null(solver);
        }
        assert_true(call > 10);
        reduced_solver_free(solver);
        reduced_model_free(&model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(full_rank_reproduces_the_full_model),
        cmocka_unit_test(a_basis_with_the_solution_finds_it),
        cmocka_unit_test(all_rows_in_any_order_are_level_i),
        cmocka_unit_test(another_linear_solver_may_be_put_in),
        cmocka_unit_test(a_damped_step_shows_no_rate),
        cmocka_unit_test(truncated_bases_stay_near),
        cmocka_unit_test(any_trained_solution_leads_to_any_other),
        cmocka_unit_test(accurate_full_rank_reproduces_the_full_model),
        cmocka_unit_test(thinned_full_rank_reproduces_the_full_model),
        cmocka_unit_test(thinned_solutions_have_the_newtonian_limit),
        cmocka_unit_test(the_cell_s_row_equals_finite_differences),
        cmocka_unit_test(thinned_rows_equal_finite_differences),
        cmocka_unit_test(moving_the_exit_equals_rebuilding),
        cmocka_unit_test(the_exit_stays_inside_the_tables),
        cmocka_unit_test(minimum_film_is_that_of_the_fields),
        cmocka_unit_test(the_observer_is_told_what_became_of_a_solution),
        cmocka_unit_test(jacobian_equals_finite_differences),
        cmocka_unit_test(bad_rows_are_refused),
        cmocka_unit_test(survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
