/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames: a contact that changes with time, in units of its current state. */
#include "common/settings/scene_contact.h"
#include "common/time/frame.h"
#include "tests/unit/check.h"
#include "tests/unit/frames.h"
#include "tests/unit/sample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static scene physical_scene(const contact_kind *kind, double load, double speed, double radius,
                            double modulus) {
    scene given = sample_scene("barus", "incompressible", 10, 5);

    snprintf(given.contact, sizeof given.contact, "%s", kind->name);
    if (kind->dimensions > 1) {
        given.grid.y_max = 2;
        given.grid.half = 1;
        given.grid.step = 0.1;
    }
    given.moes.M = given.moes.L = NAN;
    given.physical.load = (kind->dimensions > 1 ? 20 : 1e5) * load;
    given.physical.speed = 1.2 * speed;
    given.physical.radius = 0.012 * radius;
    given.physical.modulus = 2.2e11 * modulus;
    given.physical.viscosity = 0.04;
    return given;
}

static ehd_contact physical_contact(const contact_kind *kind, const double *factor) {
    scene given = physical_scene(kind, factor[0], factor[1], factor[2], factor[3]);
    ehd_contact contact;
    ehd_error error = {""};

    if (scene_contact(&contact, &given, &error)) fail_msg("%s", error.text);
    return contact;
}

static void compare_frames(const contact_kind *kind) {
    ehd_contact reference = physical_contact(kind, (double[]){1, 1, 1, 1});
    for (size_t i = 0; i < NUM_FACTORS; i++) {
        ehd_contact expected = physical_contact(kind, factors[i]), contact;
        contact_frame frame = frame_of_case(kind, i);
        frame_contact(&contact, &frame, &reference);
        check_close(contact.half_width, expected.half_width, 1e-13, 0);
        check_close(contact.radius, expected.radius, 1e-13, 0);
        check_close(contact.load, expected.load, 1e-13, 0);
        check_close(contact.hertz_pressure, expected.hertz_pressure, 1e-13, 0);
        check_close(contact.alpha_p_H, expected.alpha_p_H, 1e-13, 0);
        check_close(contact.moes_M, expected.moes_M, 1e-13, 0);
        check_close(contact.moes_L, expected.moes_L, 1e-13, 0);
        check_close(contact.lambda * contact.entrainment, expected.lambda, 1e-13, 0);
        // U = a_ref u / (a u_ref)
        check_close(contact.entrainment, reference.half_width * factors[i][1] / expected.half_width,
                    1e-13, 0);
        check_close(contact_film_scale(&contact), contact_film_scale(&expected), 1e-13, 0);
        check_close(frame.film_scale,
                    contact_film_scale(&expected) / contact_film_scale(&reference), 1e-13, 0);
    }
}

/* A frame of constant values gives the stationary contact with these values. */
static void frame_is_the_contact_of_its_values(void **state) {
    (void)state;
    compare_frames(&contact_line);
    compare_frames(&contact_point);
}

/* At rest M would be infinite, so it is limited. All values of the contact stay finite. */
static void frame_at_rest_is_finite(void **state) {
    (void)state;
    ehd_contact reference = physical_contact(&contact_line, (double[]){1, 1, 1, 1}), contact;
    contact_frame frame = frame_of(&contact_line, 1.2, 0, 1, 1, NAN);
    frame_contact(&contact, &frame, &reference);
    check_close(contact.entrainment, 0, 0, 0);
    check_close(contact.moes_M, 1e5, 0, 0);
    assert_true(isfinite(contact.moes_L) && contact.lambda > 0);
}

/* Returns the film at a place of the reference frame, by formulas that do not use frames. The half
 * width and the Hertz pressure of the reference are the units. */
static double film_by_hand(double x, const double *place, const double *pressure, size_t count,
                           double step, const double *factor, double approach) {
    double film = approach + x * x / (2 * factor[2]);

    for (size_t k = 0; k < count; k++)
        film += pressure[k] * contact_line.kernel(&shape_round, fabs(x - place[k]), 0, step) /
                factor[3];
    return film;
}

/* The frame of a state and the reference frame give equal physical values of film, pressure,
 * places, approach and load. This tests the scales and the constant of the kernel. */
static void scalars_of_a_frame_are_physical(void **state) {
    (void)state;
    enum { COUNT = 81 };
    ehd_contact reference = physical_contact(&contact_line, (double[]){1, 1, 1, 1});
    for (size_t i = 0; i < NUM_FACTORS; i++) {
        contact_frame frame = frame_of_case(&contact_line, i);
        double a = sqrt(factors[i][0] * factors[i][2] / factors[i][3]), step = 0.03;
        double hertz = sqrt(factors[i][0] * factors[i][3] / factors[i][2]);
        double place[COUNT], pressure[COUNT], own = -0.7, sum = 0;
        for (size_t k = 0; k < COUNT; k++) { // an arbitrary pressure in the frame
            place[k] = step * ((double)k - 30);
            pressure[k] = fmax(1 - 0.5 * place[k] * place[k] + 0.2 * sin(3 * place[k]), 0);
            sum += pressure[k] * step;
        }
        contact_scalars current = {.rigid_approach = own,
                                   .load = sum / M_PI_2,
                                   .central_pressure = pressure[30],
                                   .exit_position = 1.1};
        current.central_film_thickness =
            film_by_hand(0, place, pressure, COUNT, step, (double[]){1, 1, 1, 1}, own);
        current.minimum_film_thickness = 0.25 * current.central_film_thickness;
        contact_scalars scalars = frame_to_reference(&current, &frame, &reference);

        double physical_place[COUNT], physical_pressure[COUNT];
        for (size_t k = 0; k < COUNT; k++) {
            physical_place[k] = a * place[k];
            physical_pressure[k] = hertz * pressure[k];
        }
        double film = film_by_hand(0, physical_place, physical_pressure, COUNT, a * step,
                                   factors[i], scalars.rigid_approach);
        check_close(scalars.central_film_thickness, film, 1e-12, 1e-13);
        check_close(scalars.minimum_film_thickness, 0.25 * film, 1e-12, 1e-13);
        check_close(scalars.central_pressure, physical_pressure[30], 1e-13, 0);
        check_close(scalars.exit_position, 1.1 * a, 1e-13, 0);
        check_close(scalars.load, hertz * a * sum / M_PI_2, 1e-13, 0);
    }
}

/* The dry contact has H0 = -(1/4 + ln 2 / 2) in every frame. So between frames the approach changes
 * only by the scale and by the logarithm of the half width. */
static void approach_of_dry_contacts(void **state) {
    (void)state;
    ehd_contact reference = physical_contact(&contact_line, (double[]){1, 1, 1, 1});
    for (size_t i = 0; i < 2 * NUM_FACTORS; i++) {
        const double *f = factors[i % NUM_FACTORS];
        contact_frame frame = frame_of_case(&contact_line, i % NUM_FACTORS);
        double a = sqrt(f[0] * f[2] / f[3]);
        contact_scalars dry = {.rigid_approach = -(0.25 + log(2) / 2), .load = 1};
        reference.approach_length = i < NUM_FACTORS ? 1 : 12;
        check_close(frame_to_reference(&dry, &frame, &reference).rigid_approach,
                    (-(0.25 + log(2) / 2) + 0.5 * log(a / reference.approach_length)) * a * a /
                        f[2],
                    1e-13, 1e-15);
    }
}

/* If the approach is given, the closure prescribes the approach that frame_to_reference reports. */
static void approach_closure_is_the_reported_approach(void **state) {
    (void)state;
    ehd_contact reference = physical_contact(&contact_line, (double[]){1, 1, 1, 1}), contact;
    for (size_t i = 0; i < NUM_FACTORS; i++) {
        const double *f = factors[i];
        contact_frame frame = frame_of(&contact_line, f[0], f[1], f[2], f[3], -0.9);
        contact_scalars current = {.load = 1.3};
        frame_contact(&contact, &frame, &reference);
        current.rigid_approach =
            (contact.closure.value - contact.closure.by_load * current.load * M_PI_2) /
            contact.closure.by_approach;
        check_close(frame_to_reference(&current, &frame, &reference).rigid_approach, -0.9, 1e-13,
                    0);
        frame.approach = NAN;
        frame_contact(&contact, &frame, &reference);
        check_close(contact.closure.by_approach, 0, 0, 0);
        check_close(contact.closure.value / contact.closure.by_load, M_PI_2, 1e-15, 0);
    }
}

/* Forces, moment, power and stresses of a state in its frame equal, in SI units, the values of a
 * stationary contact with the same load, speed, radius and modulus. */
static void traction_of_a_frame_is_physical(void **state) {
    (void)state;
    const contact_kind *const kinds[] = {&contact_line, &contact_point};
    for (size_t c = 0; c < 2 * NUM_FACTORS; c++) {
        const contact_kind *kind = kinds[c / NUM_FACTORS];
        const size_t i = c % NUM_FACTORS;
        ehd_contact reference = physical_contact(kind, (double[]){1, 1, 1, 1}), moved;
        ehd_contact own = physical_contact(kind, factors[i]);
        const contact_frame frame = frame_of_case(kind, i);
        const size_t num_nodes = reference.grid.num_nodes;
        double *pressure = calloc(num_nodes, sizeof *pressure),
               *film = calloc(num_nodes, sizeof *film);
        assert_true(pressure && film);
        reference.lubricant.shear = own.lubricant.shear = laws_find(shear_laws, "eyring");
        reference.lubricant.shear_constants[0] = own.lubricant.shear_constants[0] = 4e6;
        reference.slide_roll = own.slide_roll = -0.2;
        for (size_t k = 0; k < num_nodes; k++) {
            const double x = grid_x(&reference.grid, k), y = grid_y(&reference.grid, k);
            pressure[k] = fmax(1 - x * x - y * y + 0.1 * x, 0);
            film[k] = 0.1 + fmax(x * x + y * y - 1, 0);
        }
        const contact_scalars scalars = {.load = 1.1, .exit_position = NAN};
        frame_contact(&moved, &frame, &reference);
        own.grid = reference.grid;
        const contact_traction in_frame = frame_traction_to_reference(
            contact_traction_of(&moved, pressure, film, &scalars), &frame);
        const contact_traction alone = contact_traction_of(&own, pressure, film, &scalars);
        const double force = own.load / reference.load;
        check_close(in_frame.coefficient, alone.coefficient, 1e-12, 0);
        check_close(in_frame.friction, alone.friction * force, 1e-12, 0);
        check_close(in_frame.rolling_resistance, alone.rolling_resistance * force, 1e-12, 0);
        check_close(in_frame.rolling_moment,
                    alone.rolling_moment * force * own.half_width / reference.half_width, 1e-12, 0);
        check_close(in_frame.power, alone.power * force * own.speed / reference.speed, 1e-12, 0);
        check_close(in_frame.mean_stress * reference.hertz_pressure,
                    alone.mean_stress * own.hertz_pressure, 1e-12, 0);
        check_close(in_frame.largest_stress * reference.hertz_pressure,
                    alone.largest_stress * own.hertz_pressure, 1e-12, 0);
        free(pressure);
        free(film);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(traction_of_a_frame_is_physical),
        cmocka_unit_test(frame_is_the_contact_of_its_values),
        cmocka_unit_test(frame_at_rest_is_finite),
        cmocka_unit_test(scalars_of_a_frame_are_physical),
        cmocka_unit_test(approach_of_dry_contacts),
        cmocka_unit_test(approach_closure_is_the_reported_approach),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
