/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of the sum of the shear stresses over the model's nodes, compared with finite
 * differences of this sum. */
#include "deimselect/cubature.h"
#include "romrun/state/node_traction.h"
#include "tests/unit/check.h"
#include "tests/unit/reduced_problem.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double distance = 1e-5;

/* Returns the derivative of the sum with respect to coordinate j, by a finite difference. The shear
 * stress of this contact is zero where the pressure is zero, so no exit position is needed. */
static double difference(node_state *nodes, double *z, size_t j, const ehd_contact *contact) {
    const contact_scalars scalars = {.load = 1, .exit_position = NAN};
    double sums[2];

    for (int side = 0; side < 2; side++) {
        const double before = z[j];
        z[j] += side ? distance : -distance;
        nodes_expand_state(nodes, NULL, z);
        sums[side] = nodes_traction(nodes, z, contact, &scalars).friction * contact->kind->load;
        z[j] = before;
    }
    nodes_expand_state(nodes, NULL, z);
    return (sums[1] - sums[0]) / (2 * distance);
}

/* Checks the derivatives for training states, with their own and with shifted exits. */
static void check_model(const reduced_model *model, const reduced_basis *basis) {
    const size_t n = model->num_unknowns;
    double *gradient = calloc(n, sizeof *gradient), *z = calloc(n, sizeof *z);
    double *influence = calloc(model->band.num_nodes, sizeof *influence);
    arena memory = {0};
    node_state nodes;

    assert_true(model->cubature.nodes.num_needed > 5 && gradient && z && influence);
    nodes_init(&nodes, model, &memory);
    for (size_t s = 0; s < basis->states.num_states; s += 2) {
        ehd_contact contact = sample_contact("barus", "incompressible", 12, 4, basis->grid.step);
        contact.radius = contact.half_width = contact.slide_roll = 1;
        contact.lubricant.shear = laws_find(shear_laws, "limiting");
        contact.lubricant.shear_constants[0] = contact.lambda; // between Newtonian and limiting
        const size_t exit = basis->states.exit[s] - s % 4;
        double largest = 0;
        memcpy(z, basis->states.coordinates + s * n, n * sizeof *z);
        nodes_move_exit(&nodes, &exit);
        nodes_expand_state(&nodes, NULL, z);
        memset(gradient, 0, n * sizeof *gradient);
        nodes_add_friction(gradient, influence, &nodes, z, &contact);
        for (size_t j = 0; j < n; j++)
            largest = fmax(largest, fabs(gradient[j]));
        assert_true(largest > 0);
        for (size_t j = 0; j < n; j++)
            // contact_stress_slopes uses finite differences, accurate to 1e-5
            check_close(gradient[j], difference(&nodes, z, j, &contact), 0, 5e-6 * largest);
    }
    arena_free(&memory);
    free(gradient);
    free(z);
    free(influence);
}

static void derivatives_of_the_friction_are_those_of_differences(void **state) {
    const size_t rows[] = {150, 155, 160, 165, 170, 175, 180, 185, 190, 195, 200, 205, 210, 240};
    trained training;
    (void)state;

    trained_init(&training, 0.02);
    for (int kind = 0; kind < 2; kind++) {
        reduced_basis basis;
        reduced_model model;
        ehd_error error = {""};
        trained_basis(&basis, &training, kind ? DEFORMATION_INDEPENDENT : DEFORMATION_COUPLED, 0,
                      0);
        assert_int_equal(
            reduced_model_build(&model, &basis, rows, sizeof rows / sizeof *rows, &error), EHD_OK);
        assert_int_equal(cubature_train(&model, &basis, &error), EHD_OK);
        check_model(&model, &basis);
        reduced_model_free(&model);
        reduced_basis_free(&basis);
    }
    trained_free(&training);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivatives_of_the_friction_are_those_of_differences)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
