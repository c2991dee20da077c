/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of bases and models. */
#include "romrun/model/basis_file.h"
#include "romrun/model/model_file.h"
#include "romrun/model/weighting.h"
#include "romrun/solve/guess.h"
#include "romrun/solve/reduced_solver.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"
#include "tests/unit/trained.h"

#include <hdf5.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_ROWS = FEW_ROWS, NUM_JACOBIAN_MODES = 10 };

static trained training;
static reduced_basis bases[2];
static size_t rows[NUM_ROWS];
static double factors[NUM_ROWS], jacobian_modes[NUM_ROWS][NUM_JACOBIAN_MODES];
static char path[128];
static ehd_error error;
static char *words[] = {"podbuild", NULL};
static const model_sizes everything = {0};

#define check_ok(call) assert_string_equal(((call) == EHD_OK) ? "" : error.text, "")

static program writer(void) {
    program self = {.name = "podbuild", .argc = 1, .argv = words, .force = true, .output = path};
    return self;
}

static int set_up(void **state) {
    if (make_folder(state)) return -1;
    snprintf(path, sizeof path, "%s/file.h5", folder);
    trained_few_init(&training, bases, rows);
    for (size_t r = 0; r < NUM_ROWS; r++)
        for (size_t j = 0; j < NUM_JACOBIAN_MODES; j++)
            jacobian_modes[r][j] = 0.2 * sin((double)(rows[r] * (j + 1)));
    return weighting_quadrature(factors, &jacobian_modes[0][0], NUM_ROWS, NUM_JACOBIAN_MODES, NULL);
}

static int tear_down(void **state) {
    trained_few_free(&training, bases);
    return remove_folder(state);
}

// ---- helpers

static void write_basis(const reduced_basis *basis) {
    const double values[] = {3, 2, 1};
    const basis_origin origin = {values, 3, 1e-9, basis->num_deformation ? values : NULL, 3, 1e-8};
    const program self = writer();

    check_ok(basis_write(basis, &origin, &self, "energy: 1\n", NULL, &error));
}

/* Writes a model. `weights` is the name of the weighting; NULL: the file has none. */
static void write_weighted(const reduced_model *model, const reduced_basis *basis,
                           const char *weights) {
    double sigmas[TRAINED_STATES];
    const program self = writer();

    for (size_t s = 0; s < TRAINED_STATES; s++)
        sigmas[s] = 0.25;
    const model_origin origin = {.method = "joint",
                                 .basis_identity = "0123",
                                 .sigma_min_residual = 0.5,
                                 .sigma_min_jacobian = 0.5,
                                 .sigma_min_over_exits = 0.25,
                                 .sigma_min_by_exit = sigmas,
                                 .weights = weights,
                                 .factors = factors,
                                 .num_jacobian_modes = NUM_JACOBIAN_MODES,
                                 .jacobian_modes = &jacobian_modes[0][0]};
    check_ok(model_write(model, basis, &origin, &self, "rows: 40\n", NULL, &error));
}

static void write_model(const reduced_model *model, const reduced_basis *basis) {
    write_weighted(model, basis, NULL);
}

static void build_model(reduced_model *model, const reduced_basis *basis, size_t num_rows) {
    check_ok(reduced_model_build(model, basis, rows, num_rows, &error));
}

static int compare_nodes(const void *a, const void *b) {
    const size_t p = *(const size_t *)a, q = *(const size_t *)b;

    return p < q ? -1 : p > q;
}

/* Builds the model that build_model builds, but with its rows sorted by node, like the rows of a
 * model from a file. */
static void build_in_order(reduced_model *model, const reduced_basis *basis, size_t num_rows) {
    size_t ordered[NUM_ROWS];

    memcpy(ordered, rows, num_rows * sizeof *ordered);
    qsort(ordered, num_rows, sizeof *ordered, compare_nodes);
    check_ok(reduced_model_build(model, basis, ordered, num_rows, &error));
}

static void check_states(const reduced_states *found, const reduced_states *expected) {
    size_t count = expected->num_states;

    assert_int_equal(found->num_states, count);
    assert_int_equal(found->num_unknowns, expected->num_unknowns);
    check_close_array(found->coordinates, expected->coordinates, count * expected->num_unknowns, 0,
                      0);
    check_close_array(found->moes_M, expected->moes_M, count, 0, 0);
    check_close_array(found->alpha_p_H, expected->alpha_p_H, count, 0, 0);
    check_close_array(found->central_film_thickness, expected->central_film_thickness, count, 0, 0);
    for (size_t s = 0; s < count; s++)
        assert_int_equal(found->exit[s], expected->exit[s]);
}

/* Opens the file at `path` for direct writing, and removes its digest. */
static hid_t open_raw(void) {
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    assert_true(file >= 0);
    if (H5Aexists(file, "content_sha256") > 0) assert_true(H5Adelete(file, "content_sha256") >= 0);
    return file;
}

static void patch_real(const char *name, size_t entry, double value) {
    hid_t file = open_raw(), set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
    hssize_t count = H5Sget_simple_extent_npoints(space);
    double *data = malloc((size_t)count * sizeof *data);

    assert_true(data && count > (hssize_t)entry);
    assert_true(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
    data[entry] = value;
    assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
    free(data);
    H5Sclose(space);
    H5Dclose(set);
    H5Fclose(file);
}

static void patch_integer_attribute(const char *name, long long value) {
    hid_t file = open_raw(), attribute = H5Aopen(file, name, H5P_DEFAULT);

    assert_true(H5Awrite(attribute, H5T_NATIVE_LLONG, &value) >= 0);
    H5Aclose(attribute);
    H5Fclose(file);
}

static void check_refused(ehd_status found, const char *words_of_it) {
    if (found != EHD_DATA || !strstr(error.text, words_of_it) || !strstr(error.text, path))
        fail_msg("found %d \"%s\", expected %d with \"%s\"", (int)found, error.text, (int)EHD_DATA,
                 words_of_it);
}

static void basis_is_refused(const char *words_of_it) {
    reduced_basis found;
    char identity[65];

    check_refused(basis_read(&found, identity, path, &error), words_of_it);
}

static void model_is_refused(const model_sizes *sizes, const char *words_of_it) {
    reduced_model found;

    check_refused(model_read(&found, path, sizes, &error), words_of_it);
}

/* Solves a contact between the training points. */
static reduced_info solve(const reduced_model *model, double *coordinates) {
    const reduced_settings settings = reduced_defaults;
    ehd_contact contact = training.contacts[4];
    reduced_state state = {.coordinates = coordinates};
    reduced_solver *solver;
    reduced_info info;

    contact_set_moes(&contact, 12, 3);
    check_ok(reduced_solver_create(&solver, model, &settings, &error));
    reduced_guess(&state, model, contact_place_of(&contact));
    check_ok(reduced_solve(&info, &state, solver, &contact, NULL, &error));
    reduced_solver_free(solver);
    return info;
}

static void check_same_solution(const reduced_model *a, const reduced_model *b, double tolerance) {
    double *z = calloc(a->num_unknowns + b->num_unknowns, sizeof *z);

    assert_non_null(z);
    assert_int_equal(a->num_unknowns, b->num_unknowns);
    assert_int_equal(a->rows.num_needed, b->rows.num_needed);
    reduced_info first = solve(a, z), second = solve(b, z + a->num_unknowns);
    assert_int_equal(first.status, EHD_OK);
    assert_int_equal(second.iterations, first.iterations);
    check_close_array(z, z + a->num_unknowns, a->num_unknowns, tolerance, tolerance);
    check_close(first.scalars.minimum_film_thickness, second.scalars.minimum_film_thickness,
                tolerance, 0);
    check_close(first.scalars.central_film_thickness, second.scalars.central_film_thickness,
                tolerance, 0);
    free(z);
}

// ---- round trips

static void a_basis_comes_back(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        const reduced_basis *basis = &bases[kind];
        size_t num_nodes = basis->grid.num_nodes;
        reduced_basis found;
        char identity[65], again[65];
        write_basis(basis);
        check_ok(artefact_check(path, &error));
        check_ok(basis_read(&found, identity, path, &error));
        assert_int_equal(strlen(identity), 64);
        assert_ptr_equal(found.kind, basis->kind);
        assert_int_equal(found.grid.num_nodes, num_nodes);
        check_close(found.grid.x_min, basis->grid.x_min, 0, 0);
        check_close(found.grid.step, basis->grid.step, 0, 0);
        assert_int_equal(found.deformation, basis->deformation);
        assert_int_equal(found.num_pressure, basis->num_pressure);
        assert_int_equal(found.num_deformation, basis->num_deformation);
        // the file contains only the inner nodes; at the boundary the pressure is zero and there
        // are no rows
        size_t first = basis->num_pressure, count = (num_nodes - 2) * first;
        check_close_array(found.pressure + first, basis->pressure + first, count, 0, 0);
        check_close_array(found.pressure, (double[9]){0}, first, 0, 0);
        check_close_array(found.weight + 1, basis->weight + 1, num_nodes - 2, 0, 0);
        if (basis->num_deformation)
            check_close_array(found.deformation_modes, basis->deformation_modes,
                              num_nodes * basis->num_deformation, 0, 0);
        check_states(&found.states, &basis->states);
        reduced_basis_free(&found);
        check_ok(basis_read(&found, again, path, &error));
        assert_string_equal(again, identity);
        reduced_basis_free(&found);
    }
}

static void a_model_comes_back(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        reduced_model written, model, found;
        build_model(&written, &bases[kind], NUM_ROWS);
        write_model(&written, &bases[kind]);
        reduced_model_free(&written);
        build_in_order(&model, &bases[kind], NUM_ROWS);
        check_ok(artefact_check(path, &error));
        check_ok(model_read(&found, path, &everything, &error));
        size_t num_pressure = model.num_pressure;
        assert_int_equal(found.deformation, model.deformation);
        assert_int_equal(found.rows.num_rows, NUM_ROWS);
        for (size_t r = 0; r < NUM_ROWS; r++)
            assert_int_equal(found.rows.node[r], model.rows.node[r]);
        check_close_array(found.rows.weight, model.rows.weight, NUM_ROWS, 0, 0);
        assert_int_equal(found.rows.num_needed, model.rows.num_needed);
        assert_int_equal(found.band.lines[0].begin, model.band.lines[0].begin);
        assert_int_equal(found.band.lines[0].min_exit, model.band.lines[0].min_exit);
        assert_int_equal(found.band.lines[0].max_exit, model.band.lines[0].max_exit);
        assert_int_equal(found.cut.num_rows, model.cut.num_rows);
        check_close_array(found.cut.left, model.cut.left, model.band.num_nodes * model.cut.num_rows,
                          0, 0);
        check_close_array(found.checkpoints.cut, model.checkpoints.cut,
                          model.checkpoints.num * model.cut.num_rows * num_pressure, 0, 0);
        if (model.checkpoints.band)
            check_close_array(found.checkpoints.band, model.checkpoints.band,
                              model.checkpoints.num * model.band.num_nodes * num_pressure, 0, 0);
        check_states(&found.states, &model.states);
        check_same_solution(&found, &model, 0);
        artefact *file;
        double *basis;
        check_ok(model_open(&file, path, &error));
        check_ok(model_get_modes(&basis, NULL, file, &found, &error));
        artefact_close(&file);
        check_close_array(basis + num_pressure, bases[kind].pressure + num_pressure,
                          (model.grid.num_nodes - 2) * num_pressure, 0, 0);
        free(basis);
        reduced_model_free(&found);
        reduced_model_free(&model);
    }
}

/* A model has all its control rows, also if it is opened with fewer modes and rows. */
static void control_rows_come_back(void **state) {
    const size_t nodes[] = {90, 2, 60};
    (void)state;

    for (int kind = 0; kind < 2; kind++) {
        const reduced_basis *basis = &bases[kind];
        reduced_model model, found;
        build_model(&model, basis, 40);
        check_ok(reduced_model_add_control(&model, basis, nodes, 3, &error));
        write_model(&model, basis);
        check_ok(artefact_check(path, &error));
        for (size_t fewer = 0; fewer < 3; fewer += 2) {
            size_t deformation = basis->num_deformation ? basis->num_deformation - fewer : 0;
            const model_sizes sizes = {basis->num_pressure - fewer, deformation, 40 - fewer};
            const row_set *expected = &model.control, *control = &found.control;
            check_ok(model_read(&found, path, &sizes, &error));
            assert_int_equal(control->num_rows, 3);
            assert_memory_equal(control->node, nodes, sizeof nodes);
            assert_int_equal(control->num_needed, expected->num_needed);
            assert_memory_equal(control->needed_node, expected->needed_node,
                                expected->num_needed * sizeof *nodes);
            assert_memory_equal(control->stencils, expected->stencils,
                                3 * sizeof *control->stencils);
            check_close_array(control->weight, expected->weight, 3, 0, 0);
            size_t width = kind == DEFORMATION_COUPLED ? basis->num_pressure : deformation + fewer;
            for (size_t q = 0; q < control->num_needed; q++) {
                check_close_array(control->pressure + q * found.num_pressure,
                                  expected->pressure + q * basis->num_pressure, found.num_pressure,
                                  0, 0);
                check_close_array(control->film + q * (width - fewer), expected->film + q * width,
                                  width - fewer, 0, 0);
            }
            reduced_model_free(&found);
        }
        patch_real("control_node_index", 0, 5);
        model_is_refused(NULL, "control_node_index: found 1 behind");
        reduced_model_free(&model);
    }
}

static void a_prefix_of_the_rows_is_the_model_of_those_rows(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        const model_sizes sizes = {.rows = 30};
        reduced_model whole, part, found;
        build_model(&whole, &bases[kind], NUM_ROWS);
        build_in_order(&part, &bases[kind], 30);
        write_model(&whole, &bases[kind]);
        check_ok(model_read(&found, path, &sizes, &error));
        assert_int_equal(found.rows.num_rows, 30);
        check_same_solution(&found, &part, 0);
        reduced_model_free(&found);
        reduced_model_free(&part);
        reduced_model_free(&whole);
    }
}

/* A model opened with fewer modes equals a model trained with fewer modes. Only the first node of
 * the exit band may differ, which changes the last digits. */
static void a_prefix_of_the_modes_is_the_model_of_those_modes(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        const model_sizes sizes = {7, kind ? 0 : 6, 0};
        reduced_basis small;
        reduced_model whole, part, found;
        trained_basis(&small, &training, bases[kind].deformation, 7, kind ? 0 : 6);
        build_model(&whole, &bases[kind], NUM_ROWS);
        build_model(&part, &small, NUM_ROWS);
        write_model(&whole, &bases[kind]);
        check_ok(model_read(&found, path, &sizes, &error));
        assert_int_equal(found.num_pressure, 7);
        assert_int_equal(found.num_deformation, kind ? 0 : 6);
        check_same_solution(&found, &part, 1e-8);
        reduced_model_free(&found);
        reduced_model_free(&part);
        reduced_model_free(&whole);
        reduced_basis_free(&small);
    }
}

/* Computes the weights of the first num_rows rows from the first num_modes Jacobian modes. A model
 * uses as many of these modes as it has unknowns. */
static void expected_weights(double *weights, const reduced_basis *basis, size_t num_rows,
                             size_t num_modes) {
    double sampled[NUM_ROWS * NUM_JACOBIAN_MODES];

    for (size_t i = 0; i < num_rows * num_modes; i++)
        sampled[i] = jacobian_modes[i / num_modes][i % num_modes];
    assert_int_equal(weighting_quadrature(weights, sampled, num_rows, num_modes, NULL), EHD_OK);
    for (size_t r = 0; r < num_rows; r++)
        weights[r] *= basis->weight[rows[r]];
}

static size_t place_of(const reduced_model *model, size_t node) {
    size_t r = 0;

    while (model->rows.node[r] != node)
        r++;
    return r;
}

/* If a model is opened with fewer modes or rows, its weights are computed anew. The whole model has
 * the stored weights. */
static void a_part_is_weighed_by_itself(void **state) {
    const struct {
        model_sizes sizes;
        size_t num_rows, num_modes;
    } cases[] = {{{0, 0, 0}, NUM_ROWS, 10},
                 {{0, 0, 30}, 30, 10},
                 {{7, 0, 0}, NUM_ROWS, 8},
                 {{6, 0, 20}, 20, 7}};
    reduced_model model;
    double weights[NUM_ROWS];
    (void)state;

    build_model(&model, &bases[1], NUM_ROWS);
    for (size_t r = 0; r < NUM_ROWS; r++)
        model.rows.weight[r] *= factors[r];
    write_weighted(&model, &bases[1], "quadrature");
    check_ok(artefact_check(path, &error));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        reduced_model found;
        check_ok(model_read(&found, path, &cases[i].sizes, &error));
        expected_weights(weights, &bases[1], cases[i].num_rows, cases[i].num_modes);
        for (size_t r = 0; r < cases[i].num_rows; r++)
            check_close(found.rows.weight[place_of(&found, rows[r])], weights[r], 1e-14, 0);
        reduced_model_free(&found);
    }
    reduced_model_free(&model);
}

static void a_part_of_unknown_weights_is_refused(void **state) {
    const model_sizes part = {.rows = 30};
    reduced_model model, found;
    (void)state;

    build_model(&model, &bases[1], NUM_ROWS);
    write_weighted(&model, &bases[1], "other");
    model_is_refused(&part, "weights: found other, expected");
    check_ok(model_read(&found, path, &everything, &error));
    reduced_model_free(&found);
    write_weighted(&model, &bases[1], "quadrature");
    patch_real("row_factor", 1, 0);
    model_is_refused(&part, "row_factor: found 0, expected above 0");
    write_weighted(&model, &bases[1], "quadrature");
    patch_real("row_jacobian_modes", 1, NAN);
    model_is_refused(&part, "row_jacobian_modes: found ");
    reduced_model_free(&model);
}

// ---- refused files

static void bad_bases_are_refused(void **state) {
    (void)state;
    const struct {
        const char *field;
        double value;
        const char *words;
    } cases[] = {{"pressure_basis", NAN, "pressure_basis: found "},
                 {"deformation_basis", INFINITY, "deformation_basis: found "},
                 {"weight", NAN, "weight: found "},
                 {"state_pressure", NAN, "state_pressure: found "},
                 {"state_deformation", NAN, "state_deformation: found "},
                 {"state_rigid_approach", -INFINITY, "state_rigid_approach: found "},
                 {"state_moes_M", NAN, "state_moes_M: found "},
                 {"state_alpha_p_H", NAN, "state_alpha_p_H: found "},
                 {"state_exit_node", 0, "state_exit_node: found 0, expected"},
                 {"state_exit_node", -1, "state_exit_node: found -1, expected"},
                 {"state_exit_node", 10, "state_exit_node: found 10, expected"},
                 {"state_exit_node", 122, "state_exit_node: found 122, expected"}};

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_basis(&bases[0]);
        patch_real(cases[i].field, 1, cases[i].value);
        basis_is_refused(cases[i].words);
    }
}

static void bad_models_are_refused(void **state) {
    (void)state;
    const struct {
        const char *field;
        size_t entry;
        double value;
        const char *words;
    } cases[] = {{"selected_row", 1, -1, "selected_row: found -1, expected 0 to 120"},
                 {"selected_row", 1, 121, "selected_row: found 121, expected 0 to 120"},
                 {"selected_row", 1, 3, "needed_node_index: found no node"},
                 {"needed_node_index", 2, 1, "needed_node_index: found 1 behind"},
                 {"needed_node_index", 2, 500, "needed_node_index: found 500, expected 0 to 122"},
                 {"row_weight", 1, NAN, "row_weight: found "},
                 {"needed_pressure_basis", 1, NAN, "needed_pressure_basis: found "},
                 {"band_pressure_basis", 1, NAN, "band_pressure_basis: found "},
                 {"load_jacobian", 1, NAN, "load_jacobian: found "},
                 {"state_pressure", 1, NAN, "state_pressure: found "},
                 {"state_moes_M", 1, NAN, "state_moes_M: found "},
                 {"state_exit_node", 1, 1000, "state_exit_node: found 1000"}};
    const struct {
        const char *name;
        long long value;
    } places[] = {{"band_begin", -1},  {"band_begin", 2},  {"band_begin", 1000}, {"least_exit", 1},
                  {"least_exit", 122}, {"most_exit", 121}, {"most_exit", 4},     {"band_begin", 0}};
    reduced_model model;

    build_model(&model, &bases[1], NUM_ROWS);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_model(&model, &bases[1]);
        patch_real(cases[i].field, cases[i].entry, cases[i].value);
        model_is_refused(&everything, cases[i].words);
    }
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        write_model(&model, &bases[1]);
        patch_integer_attribute(places[i].name, places[i].value);
        model_is_refused(&everything, "found");
    }
    // the band must contain two nodes before each exit
    write_model(&model, &bases[1]);
    patch_integer_attribute("least_exit", (long long)model.band.lines[0].begin);
    model_is_refused(&everything, "inside the band");
    reduced_model_free(&model);
}

static void sizes_beyond_the_model_are_refused(void **state) {
    (void)state;
    const struct {
        model_sizes sizes;
        const char *words;
    } cases[] = {{{10, 0, 0}, "--pressure-modes: found 10, expected at most the 9"},
                 {{0, 8, 0}, "--deformation-modes: found 8, expected at most the 7"},
                 {{0, 0, 41}, "--rows: found 41, expected at most the 40"}};
    reduced_model model;

    build_model(&model, &bases[0], NUM_ROWS);
    write_model(&model, &bases[0]);
    for (size_t i = 0; i < 3; i++)
        model_is_refused(&cases[i].sizes, cases[i].words);
    const model_sizes few = {0, 0, 8};
    reduced_model found;
    assert_int_equal(model_read(&found, path, &few, &error), EHD_DATA);
    assert_non_null(
        strstr(error.text, "--rows: found 8 rows, expected at least 9: the model has "));
    reduced_model_free(&model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_basis_comes_back),
        cmocka_unit_test(a_model_comes_back),
        cmocka_unit_test(control_rows_come_back),
        cmocka_unit_test(a_prefix_of_the_rows_is_the_model_of_those_rows),
        cmocka_unit_test(a_prefix_of_the_modes_is_the_model_of_those_modes),
        cmocka_unit_test(a_part_is_weighed_by_itself),
        cmocka_unit_test(a_part_of_unknown_weights_is_refused),
        cmocka_unit_test(bad_bases_are_refused),
        cmocka_unit_test(bad_models_are_refused),
        cmocka_unit_test(sizes_beyond_the_model_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
