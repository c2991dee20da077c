/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reduced model of a point contact, whose exit is a line. */
#include "common/physics/deflection.h"
#include "romrun/model/reduced_cut.h"
#include "romrun/solve/guess.h"
#include "tests/unit/check.h"
#include "tests/unit/reduced_problem.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static trained half, whole;                   // half of 33 by 33 nodes; 33 by 33 nodes
static reduced_basis half_basis, whole_basis; // as many modes as the training spans
static reduced_basis half_independent, whole_independent;

static const struct {
    trained *training;
    reduced_basis *basis;
    deformation_kind kind;
} bases[] = {{&half, &half_basis, DEFORMATION_COUPLED},
             {&whole, &whole_basis, DEFORMATION_COUPLED},
             {&half, &half_independent, DEFORMATION_INDEPENDENT},
             {&whole, &whole_independent, DEFORMATION_INDEPENDENT}};
enum { NUM_BASES = sizeof bases / sizeof *bases };

static int set_up(void **state) {
    (void)state;
    trained_init_point(&half, true, "open");
    trained_init_point(&whole, false, "open");
    for (int b = 0; b < NUM_BASES; b++)
        trained_basis(bases[b].basis, bases[b].training, bases[b].kind, 0, 0);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    for (int b = 0; b < NUM_BASES; b++)
        reduced_basis_free(bases[b].basis);
    trained_free(&half);
    trained_free(&whole);
    return 0;
}

// ---- helpers

/* Checks that the film is the sum of the pressure's deflection, the gap and the approach. */
static void check_deflection(const double *film, const double *pressure, const reduced_basis *basis,
                             double rigid_approach) {
    const size_t num_nodes = basis->grid.num_nodes;
    ehd_deflection *deflection = deflection_create(basis->kind, &basis->grid);
    double *expected = malloc(num_nodes * sizeof *expected);

    assert_true(deflection && expected);
    deflection_apply(expected, deflection, pressure);
    for (size_t k = 0; k < num_nodes; k++)
        expected[k] += rigid_approach + grid_gap(&basis->grid, k);
    check_close_array(film, expected, num_nodes, 1e-12, 1e-13);
    deflection_free(deflection);
    free(expected);
}

/* Checks that solution, exit line and scalars equal the results of the full solver. */
static void check_is_training_state(const reduced_problem *self, const reduced_basis *basis,
                                    const trained *training, size_t s, double tolerance) {
    const reduced_states *states = training->states;
    size_t num_nodes = basis->grid.num_nodes, num_lines = grid_lines(&basis->grid);
    double *pressure = calloc(2 * num_nodes, sizeof *pressure), *film = pressure + num_nodes;
    const double least = trained_least_film(training->film + s * num_nodes, &basis->grid);

    assert_non_null(pressure);
    fields_of(pressure, film, &self->state, &self->model, basis->pressure);
    check_deflection(film, pressure, basis, self->state.coordinates[self->model.num_unknowns - 1]);
    for (size_t l = 0; l < num_lines; l++)
        assert_int_equal(self->state.exits[l], states->exit[s * num_lines + l]);
    check_close(self->info.scalars.central_film_thickness, states->central_film_thickness[s],
                tolerance, 0);
    check_close(self->info.scalars.minimum_film_thickness, least, tolerance, 0);
    check_close(self->info.scalars.load, 1, tolerance, 0);
    check_close_array(pressure, training->pressure + s * num_nodes, num_nodes, 0, tolerance);
    check_close_array(film, training->film + s * num_nodes, num_nodes, 0, tolerance);
    free(pressure);
}

/* Returns whether the full solver has found another exit line than the reduced model. On such a
 * coarse grid two neighbouring exit lines may both have the right signs of pressure and multiplier;
 * the films differ by 5e-6 or less. */
static bool has_two_exits(size_t s) {
    return s == 1 || s == 2 || s == 4 || s == 9;
}

// ---- the reduced model is the full one

static void check_full_rank(deformation_kind kind, size_t stride) {
    reduced_basis basis = identity_basis(&half.set, kind, half_basis.weight);
    reduced_problem reduced;

    reduced_problem_init(&reduced, &basis, NULL, 0, &strict_settings);
    for (size_t s = 0; s < TRAINED_STATES; s += stride) {
        if (has_two_exits(s)) continue;
        reduced_neighbour(&reduced.state, &reduced.model,
                          (contact_place){.moes_M = half.states->moes_M[s],
                                          .alpha_p_H = half.states->alpha_p_H[s]});
        reduced_problem_solve(&reduced, &half.contacts[s]);
        check_is_training_state(&reduced, &basis, &half, s, 1e-9);
    }
    reduced_problem_free(&reduced);
    reduced_basis_free(&basis);
}

static void full_rank_reproduces_the_full_model(void **state) {
    (void)state;
    check_full_rank(DEFORMATION_COUPLED, 3);
    check_full_rank(DEFORMATION_INDEPENDENT, 6); // more than a thousand unknowns
}

/* If the basis contains the solution, the solver finds this solution from a start nearby, on the
 * whole grid and on the half grid. */
static void a_basis_with_the_solution_finds_it(void **state) {
    (void)state;
    for (int b = 0; b < NUM_BASES; b++) {
        const reduced_basis *basis = bases[b].basis;
        const reduced_states *states = &basis->states;
        reduced_problem reduced;
        reduced_problem_init(&reduced, basis, NULL, 0, &strict_settings);
        for (size_t s = 0; s < TRAINED_STATES; s++) {
            size_t n = reduced.model.num_unknowns;
            if (has_two_exits(s)) continue;
            for (size_t j = 0; j < n; j++)
                reduced.state.coordinates[j] =
                    states->coordinates[s * n + j] * (1 + (j % 2 ? 1e-3 : -1e-3));
            reduced_state_set_exits(&reduced.state, &reduced.model,
                                    states->exit + s * states->num_lines);
            reduced_problem_solve(&reduced, &bases[b].training->contacts[s]);
            check_is_training_state(&reduced, basis, bases[b].training, s, 1e-9);
            assert_true(reduced.info.residual < 1e-6);
        }
        reduced_problem_free(&reduced);
    }
}

/* The full model's solutions are symmetric. The half grid gives the same solutions. */
static void half_is_half_of_the_whole(void **state) {
    (void)state;
    for (size_t s = 0; s < TRAINED_STATES; s++) {
        size_t half_lines = grid_lines(&half.set.grid), lines = grid_lines(&whole.set.grid);
        for (size_t l = 0; l < half_lines; l++)
            assert_int_equal(half.states->exit[s * half_lines + l],
                             whole.states->exit[s * lines + lines / 2 + l]);
        check_close(half.states->central_film_thickness[s], whole.states->central_film_thickness[s],
                    1e-10, 0);
    }
}

// ---- the exit line

/* Returns K V_p at one node as a direct sum over the whole plane, where the mode V_p is set to zero
 * behind an exit line. */
static double dense_deflection(const reduced_basis *basis, const size_t *exit, size_t node,
                               size_t mode) {
    const ehd_grid *grid = &basis->grid;
    double sum = 0;

    for (size_t i = 0; i < grid->num_nodes; i++) {
        size_t line = i / grid_width(grid);
        double x = grid_x(grid, node) - grid_x(grid, i), y = grid_y(grid, node) - grid_y(grid, i);
        double pressure = basis->pressure[i * basis->num_pressure + mode];
        if (i % grid_width(grid) >= exit[line]) continue;
        sum += deflection_influence(basis->kind, grid, x, y) * pressure;
        if (grid->half && line > 0)
            sum +=
                deflection_influence(basis->kind, grid, x, grid_y(grid, node) + grid_y(grid, i)) *
                pressure;
    }
    return sum;
}

/* Returns the product of a deformation mode with K V_p at all nodes, computed by FFT. */
static double projected_deflection(const reduced_basis *basis, const size_t *exit, size_t row,
                                   size_t mode) {
    const ehd_grid *grid = &basis->grid;
    ehd_deflection *deflection = deflection_create(basis->kind, grid);
    double *work = calloc(grid->num_nodes, sizeof *work), sum = 0;

    assert_true(deflection && work);
    for (size_t i = 0; i < grid->num_nodes; i++)
        if (i % grid_width(grid) < exit[i / grid_width(grid)])
            work[i] = basis->pressure[i * basis->num_pressure + mode];
    deflection_apply(work, deflection, work);
    for (size_t i = 0; i < grid->num_nodes; i++)
        sum += basis->deformation_modes[i * basis->num_deformation + row] * work[i];
    deflection_free(deflection);
    free(work);
    return sum;
}

static double dense_load(const reduced_basis *basis, const size_t *exit, size_t mode) {
    const ehd_grid *grid = &basis->grid;
    double sum = 0;

    for (size_t i = 0; i < grid->num_nodes; i++)
        if (i % grid_width(grid) < exit[i / grid_width(grid)])
            sum += (grid->half && i >= grid_width(grid) ? 2 : 1) * grid->step * grid->step *
                   basis->pressure[i * basis->num_pressure + mode];
    return sum;
}

static double dense_cut(const reduced_model *model, const reduced_basis *basis, const size_t *exit,
                        size_t row, size_t mode) {
    if (row + 1 == model->cut.num_rows) return dense_load(basis, exit, mode);
    return basis->deformation == DEFORMATION_COUPLED
               ? dense_deflection(basis, exit, model->rows.needed_node[row], mode)
               : projected_deflection(basis, exit, row, mode);
}

/* Compares deflections of the pressure modes with direct sums; films: [count, num_pressure]. */
static void check_films(const double *films, const size_t *nodes, size_t count,
                        const reduced_basis *basis, const size_t *exit) {
    for (size_t q = 0; q < count; q += 7)
        for (size_t j = 0; j < basis->num_pressure; j += 4)
            check_close(films[q * basis->num_pressure + j],
                        dense_deflection(basis, exit, nodes[q], j), 1e-11, 1e-11);
}

static void check_cut(const double *cut, const reduced_model *model, const reduced_basis *basis,
                      const size_t *exit) {
    for (size_t row = 0; row < model->cut.num_rows; row += row + 8 < model->cut.num_rows ? 7 : 1)
        for (size_t j = 0; j < basis->num_pressure; j += 4)
            check_close(cut[row * basis->num_pressure + j], dense_cut(model, basis, exit, row, j),
                        1e-11, 1e-11);
}

/* Returns rows that are spread over the grid, some of them at exits. */
static size_t *some_rows(size_t *count, const ehd_grid *grid) {
    size_t *rows = malloc(grid->num_inner * sizeof *rows);

    assert_non_null(rows);
    *count = 0;
    for (size_t r = 5; r < grid->num_inner; r += 17)
        rows[(*count)++] = grid_node_of_row(grid, r);
    return rows;
}

static void cut_tables_equal_plain_sums(void **state) {
    ehd_error error;
    (void)state;
    for (int b = 0; b < NUM_BASES; b++) {
        const reduced_basis *basis = bases[b].basis;
        size_t count, *rows = some_rows(&count, &basis->grid);
        reduced_problem reduced;
        reduced_problem_init(&reduced, basis, rows, count, &strict_settings);
        const reduced_model *model = &reduced.model;
        size_t size = model->cut.num_rows * model->num_pressure, *exit = reduced.state.exits;
        assert_true(model->checkpoints.num > 3);
        for (size_t c = 0; c < model->checkpoints.num; c += 3)
            check_cut(model->checkpoints.cut + c * size, model, basis,
                      model->checkpoints.exit + c * model->band.num_lines);

        const row_set *control = &model->control;
        assert_int_equal(reduced_model_add_control(&reduced.model, basis, rows, count / 2, &error),
                         EHD_OK);
        assert_true(control->num_needed > 7);
        bool coupled = model->deformation == DEFORMATION_COUPLED;
        for (size_t c = 0; coupled && c < model->checkpoints.num; c += 3)
            check_films(model->checkpoints.control + c * control->num_needed * model->num_pressure,
                        control->needed_node, control->num_needed, basis,
                        model->checkpoints.exit + c * model->band.num_lines);

        // update the table from a checkpoint to exits upstream and downstream of it; the exits pass
        // more nodes than one block contains
        cut_run *runs = malloc(model->band.num_lines * sizeof *runs);
        double *work =
            malloc(CUT_BLOCK * (model->cut.num_rows + model->num_pressure) * sizeof *work);
        double *cut = malloc(size * sizeof *cut);
        assert_true(runs && work && cut);
        memcpy(cut, model->checkpoints.cut, size * sizeof *cut);
        for (size_t l = 0; l < model->band.num_lines; l++)
            exit[l] = l % 2 ? model->band.lines[l].min_exit : model->band.lines[l].max_exit;
        size_t num_runs = reduced_model_runs(runs, model, model->checkpoints.exit, exit);
        assert_true(num_runs > model->band.num_lines / 2);
        reduced_model_change_cut(cut, model, runs, num_runs, work);
        check_cut(cut, model, basis, exit);
        free(runs);
        free(work);
        free(cut);
        free(rows);
        reduced_problem_free(&reduced);
    }
}

/* If a start has an exit that is wrong by one column on each grid line, the solver corrects it. The
 * model has a mode for every node, so the signs of the pressures at the exit show the error. */
static void exit_lines_are_found(void **state) {
    (void)state;
    const size_t s = 6;
    reduced_basis basis = identity_basis(&half.set, DEFORMATION_COUPLED, half_basis.weight);
    reduced_problem reduced;

    reduced_problem_init(&reduced, &basis, NULL, 0, &strict_settings);
    const reduced_states *states = &basis.states;
    for (size_t apart = 0; apart < 3; apart += 2) { // exits shifted by -1 column, then by +1
        size_t n = reduced.model.num_unknowns;
        memcpy(reduced.state.coordinates, states->coordinates + s * n, n * sizeof(double));
        reduced_state_set_exits(&reduced.state, &reduced.model,
                                states->exit + s * states->num_lines);
        for (size_t l = 0; l < basis.grid.inner_lines; l++)
            reduced.state.exits[l] += apart - 1;
        reduced_problem_solve(&reduced, &half.contacts[s]);
        check_is_training_state(&reduced, &basis, &half, s, 1e-9);
    }
    reduced_problem_free(&reduced);
    reduced_basis_free(&basis);
}

/* If exits are searched only on every second grid line and interpolated on the other lines, the
 * film hardly changes. */
static void exits_between_lines_are_interpolated(void **state) {
    (void)state;
    const size_t s = 6;
    const reduced_states *states = &half_basis.states;
    reduced_settings settings = strict_settings;
    reduced_problem reduced;

    settings.exit_spacing = 2 * half.set.grid.step;
    reduced_problem_init(&reduced, &half_basis, NULL, 0, &strict_settings);
    reduced.solver = reduced_solver_free(reduced.solver);
    assert_int_equal(reduced_solver_create(&reduced.solver, &reduced.model, &settings, NULL),
                     EHD_OK);
    memcpy(reduced.state.coordinates, states->coordinates + s * states->num_unknowns,
           states->num_unknowns * sizeof(double));
    reduced_state_set_exits(&reduced.state, &reduced.model, states->exit + s * states->num_lines);
    reduced_problem_solve(&reduced, &half.contacts[s]);
    for (size_t l = 1; l + 1 < half.set.grid.inner_lines; l += 2) {
        const band_line *band = &reduced.model.band.lines[l];
        const size_t *exit = reduced.state.exits + l;
        double middle = (double)(exit[-1] + exit[1]) / 2;
        middle = fmin(fmax(middle, (double)band->min_exit), (double)band->max_exit);
        assert_int_equal(*exit, (size_t)lround(middle));
    }
    check_close(reduced.info.scalars.central_film_thickness, half.states->central_film_thickness[s],
                1e-3, 0);
    reduced_problem_free(&reduced);
}

/* Training states with the same M lie on a straight line in the plane of M and alpha p_H. A guess
 * from neighbours on such a line must not extrapolate far, as a fit of a plane to them would. */
static void a_start_beside_a_row_of_neighbours_is_near_it(void **state) {
    (void)state;
    reduced_states *states;
    reduced_problem reduced;
    double least = INFINITY, most = -INFINITY;

    reduced_problem_init(&reduced, &half_basis, NULL, 0, &strict_settings);
    states = &reduced.model.states;
    size_t n = states->num_unknowns;
    for (size_t s = 0; s < states->num_states; s++) {
        states->moes_M[s] = s % 2 ? 20 : 40; // six states with each M; the two M are far apart
        states->alpha_p_H[s] = 8 + 0.1 * (double)(s / 2);
    }
    for (size_t s = 1; s < states->num_states; s += 2) {
        least = fmin(least, states->coordinates[s * n]);
        most = fmax(most, states->coordinates[s * n]);
    }
    const double extent = most - least;
    // tried at many places, because only at some of them round-off makes the factorisation take the
    // line for a plane
    for (double M = 20.1; M < 20.6; M += 0.1)
        for (double pressure = 8.03; pressure < 8.5; pressure += 0.01) {
            reduced_guess(&reduced.state, &reduced.model,
                          (contact_place){.moes_M = M, .alpha_p_H = pressure});
            assert_true(reduced.state.coordinates[0] > least - extent &&
                        reduced.state.coordinates[0] < most + extent);
        }
    reduced_problem_free(&reduced);
}

/* The band has no nodes on boundary lines. If the exit moves on a line next to a boundary line, the
 * solver must not read behind the table of the only checkpoint. Here the numbers behind this table
 * are NaN, and the exits must still move to their right places. */
static void exits_beside_the_boundary_need_nothing_behind_the_band(void **state) {
    (void)state;
    for (int g = 0; g < 2; g++) {
        reduced_problem reduced;
        reduced_problem_init(&reduced, bases[g].basis, NULL, 0, &strict_settings);
        reduced_model *model = &reduced.model;
        const reduced_states *states = &bases[g].basis->states;
        size_t width = grid_width(&model->grid), num_lines = model->band.num_lines, s = 3;
        size_t table = model->band.num_nodes * model->num_pressure,
               tail = width * model->num_pressure;
        size_t last = grid_first_line(&model->grid) + model->grid.inner_lines - 1;
        size_t *exits = malloc(num_lines * sizeof *exits);
        double *longer = arena_array(&model->memory, table + tail, sizeof *longer);

        assert_true(exits && longer && !has_two_exits(s));
        memcpy(longer, model->checkpoints.band, table * sizeof *longer);
        for (size_t i = 0; i < tail; i++)
            longer[table + i] = NAN;
        model->checkpoints.band = longer;
        model->checkpoints.num = 1;
        memcpy(exits, states->exit + s * num_lines, num_lines * sizeof *exits);
        exits[last] -= 2;
        memcpy(reduced.state.coordinates, states->coordinates + s * model->num_unknowns,
               model->num_unknowns * sizeof(double));
        reduced_state_set_exits(&reduced.state, model, exits);
        reduced_problem_solve(&reduced, &bases[g].training->contacts[s]);
        check_is_training_state(&reduced, bases[g].basis, bases[g].training, s, 1e-9);
        free(exits);
        reduced_problem_free(&reduced);
    }
}

/* The band of a grid line contains the line's exits. It also contains the nodes of this line that
 * rows at exits of the line and of the neighbouring lines need. */
static void the_band_has_what_rows_at_exits_need(void **state) {
    (void)state;
    for (int g = 0; g < 2; g++) {
        reduced_problem reduced;
        reduced_problem_init(&reduced, bases[g].basis, NULL, 0, &strict_settings);
        const reduced_model *model = &reduced.model;
        size_t first = grid_first_line(&model->grid), count = 0;
        for (size_t l = first; l < first + model->grid.inner_lines; l++) {
            const band_line *line = &model->band.lines[l];
            assert_int_equal(line->offset, count);
            count += line->end - line->begin;
            assert_true(line->begin + 2 <= line->min_exit && line->max_exit + 1 < line->end);
            for (size_t beside = l > first ? l - 1 : l; beside <= l + 1; beside++) {
                const band_line *other = &model->band.lines[beside];
                if (other->begin == other->end) continue;
                assert_true(line->begin <= other->min_exit && line->end > other->max_exit);
            }
        }
        assert_int_equal(count, model->band.num_nodes);
        reduced_problem_free(&reduced);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(half_is_half_of_the_whole),
        cmocka_unit_test(full_rank_reproduces_the_full_model),
        cmocka_unit_test(a_basis_with_the_solution_finds_it),
        cmocka_unit_test(cut_tables_equal_plain_sums),
        cmocka_unit_test(exit_lines_are_found),
        cmocka_unit_test(exits_between_lines_are_interpolated),
        cmocka_unit_test(a_start_beside_a_row_of_neighbours_is_near_it),
        cmocka_unit_test(exits_beside_the_boundary_need_nothing_behind_the_band),
        cmocka_unit_test(the_band_has_what_rows_at_exits_need),
    };

    return cmocka_run_group_tests(tests, set_up, tear_down);
}
