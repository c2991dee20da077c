/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of deflections for a pressure that is zero behind the exit, compared with direct sums.
 * Only the exits at checkpoints are tested here. Changes of the tables to other exits are tested in
 * test_reduced_solver.c and, for point contacts, in test_reduced_point.c. */
#include "common/physics/deflection.h"
#include "romrun/model/reduced_cut.h"
#include "tests/unit/check.h"
#include "tests/unit/trained.h"

/* Returns K V_p at one node as a direct sum, where the mode V_p is set to zero behind the exit. */
static double dense_deflection(const reduced_basis *basis, size_t exit, size_t node, size_t mode) {
    double sum = 0;

    for (size_t i = 1; i < exit; i++) {
        double distance = (node > i ? (double)(node - i) : (double)(i - node)) * basis->grid.step;
        sum += deflection_influence(basis->kind, &basis->grid, distance, 0) *
               basis->pressure[i * basis->num_pressure + mode];
    }
    return sum;
}

static double dense_load(const reduced_basis *basis, size_t exit, size_t mode) {
    double sum = 0;

    for (size_t i = 1; i < exit; i++)
        sum += basis->grid.step * basis->pressure[i * basis->num_pressure + mode];
    return sum;
}

/* Computes an entry of the table model->cut by its definition. */
static double dense_cut(const reduced_model *model, const reduced_basis *basis, size_t exit,
                        size_t row, size_t mode) {
    double sum = 0;

    if (row == model->cut.num_rows - 1) return dense_load(basis, exit, mode);
    if (basis->deformation == DEFORMATION_COUPLED)
        return dense_deflection(basis, exit, model->rows.needed_node[row], mode);
    for (size_t k = 0; k < basis->grid.num_nodes; k++)
        sum += basis->deformation_modes[k * basis->num_deformation + row] *
               dense_deflection(basis, exit, k, mode);
    return sum;
}

static void cut_tables_equal_plain_sums(void **state) {
    (void)state;
    trained training; // 301 nodes, a checkpoint every second node
    const size_t rows[] = {150, 155, 160, 165, 170, 175, 180, 185, 190, 195, 200, 205, 210, 240};

    trained_init(&training, 0.02);
    for (int kind = 0; kind < 2; kind++) {
        reduced_basis own, *const basis = &own;
        trained_basis(&own, &training, kind ? DEFORMATION_INDEPENDENT : DEFORMATION_COUPLED, 0, 0);
        size_t num_pressure = basis->num_pressure;
        reduced_model model;
        assert_int_equal(reduced_model_build(&model, basis, rows, sizeof rows / sizeof *rows, NULL),
                         EHD_OK);
        assert_true(model.checkpoints.num > 3 && model.checkpoints.stride > 1);
        for (size_t c = 0; c < model.checkpoints.num; c++) {
            size_t exit = model.band.lines[0].min_exit + c * model.checkpoints.stride;
            assert_int_equal(reduced_model_checkpoint(&model, &exit), c);
            const size_t last = exit + model.checkpoints.stride - 1;
            assert_int_equal(reduced_model_checkpoint(&model, &last), c);
            if (c % 4 && c + 1 < model.checkpoints.num) continue; // direct sums are slow
            const double *cut = model.checkpoints.cut + c * model.cut.num_rows * num_pressure;
            for (size_t row = 0; row < model.cut.num_rows;
                 row += row + 4 < model.cut.num_rows ? 3 : 1)
                for (size_t j = 0; j < num_pressure; j += 3)
                    check_close(cut[row * num_pressure + j], dense_cut(&model, basis, exit, row, j),
                                1e-12, 1e-12);
            for (size_t i = 0; i < model.band.num_nodes && model.checkpoints.band; i++)
                check_close(
                    model.checkpoints.band[(c * model.band.num_nodes + i) * num_pressure + 1],
                    dense_deflection(basis, exit, model.band.lines[0].begin + i, 1), 1e-12, 1e-12);
        }
        reduced_model_free(&model);
        reduced_basis_free(&own);
    }
    trained_free(&training);
}

/* The checkpoints of a point contact exceed 400 MB by at most one checkpoint. The band of an
 * independent basis has no film table, so this test fills much less memory than is counted here. */
static void memory_bounds_the_checkpoints_of_a_point(void **state) {
    enum { LINES = 2, COLUMNS = 20, STATES = 12 };
    (void)state;
    for (size_t megabytes = 1; megabytes <= 200; megabytes += 199) {
        size_t exits[STATES][LINES];
        band_line lines[LINES];
        double left[LINES * COLUMNS] = {0}, pressure[LINES * COLUMNS] = {0}, base = 0;
        for (size_t s = 0; s < STATES; s++)
            exits[s][0] = s, exits[s][1] = 2;
        for (size_t l = 0; l < LINES; l++)
            lines[l] = (band_line){.end = COLUMNS, .offset = l * COLUMNS, .max_exit = COLUMNS};
        reduced_model model = {
            .deformation = DEFORMATION_INDEPENDENT,
            .num_pressure = 1,
            .band = {.num_lines = LINES, .lines = lines, .pressure = pressure},
            .cut = {.num_rows = 1, .left = left, .base = &base},
            .states = {.num_states = STATES, .num_lines = LINES, .exit = exits[0]}};
        model.band.num_nodes = (megabytes << 20) / sizeof(double);
        assert_int_equal(reduced_model_make_checkpoints(&model, NULL), EHD_OK);
        if (megabytes == 1)
            assert_int_equal(model.checkpoints.num, STATES);
        else
            assert_in_range(model.checkpoints.num, 2, 5);
        arena_free(&model.memory);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cut_tables_equal_plain_sums),
        cmocka_unit_test(memory_bounds_the_checkpoints_of_a_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
