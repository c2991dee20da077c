/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A user's program for the installed library, for library.bats; it compiles as C11 and as C++17.
 *
 *     use_library solve MODEL SCENE [KEY VALUE]...   solution and fields, dimensionless
 *     use_library set MODEL LOCALE                   one contact by settings, in SI and dimensionless
 *     use_library units MODEL SCENE                  a solution and a step in SI, compared with dimensionless ones; scales
 *     use_library march MODEL SCENE STEP NUM         steps under a sine of the load, each tried twice
 *     use_library derivatives MODEL SCENE            derivatives against differences; stiffness and damping; a step
 *     use_library tolerances MODEL SCENE             tolerances of solutions, and of steps along the path
 *     use_library restart MODEL SCENE                the step after a jump has first order
 *     use_library wrong MODEL SCENE                  wrong inputs and their messages
 *     use_library sizes MODEL SCENE                  callers whose structs are longer or shorter than the library's
 *     use_library loaded MODEL SCENE                 a solution and a step, and whether HDF5 is in the process
 *     use_library memory MODEL SCENE STEP NUM        VmRSS after 1000 steps and after NUM
 *     use_library threads MODEL SCENE                four threads, each with a solved contact and two transient ones */
#include <ehdrom.h>

#include <errno.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "use_library.c:%d: expected %s\n", __LINE__, #condition);              \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

/* Returns the status; on an error it prints the text and ends the program. */
static ehdrom_status taken(ehdrom_status status, const ehdrom_contact *contact) {
    if (EHDROM_FAILED(status)) {
        fprintf(stderr, "%s\n", ehdrom_contact_error(contact));
        exit(status);
    }
    return status;
}

static ehdrom_model *open_model(const char *path) {
    ehdrom_model *model;
    ehdrom_status status = ehdrom_model_open(&model, path, NULL);

    if (status) {
        fprintf(stderr, "%s\n", ehdrom_model_error(model));
        exit(status);
    }
    return model;
}

/* Creates a contact that accepts any accuracy, because the models of the tests were not checked. */
static ehdrom_contact *new_contact(const ehdrom_model *model, const char *scene) {
    ehdrom_contact *contact;

    CHECK(!ehdrom_contact_create(&contact, model));
    CHECK(!ehdrom_contact_set_accuracy(contact, HUGE_VAL));
    if (scene) taken(ehdrom_contact_read(contact, scene), contact);
    return contact;
}

static void show(const char *name, double value) {
    printf("%s %.17g\n", name, value);
}

static void show_result(const ehdrom_result *result) {
    show("status", result->status);
    show("time", result->time);
    show("load", result->load);
    show("rigid_approach", result->approach);
    show("central_film_thickness", result->central_film_thickness);
    show("minimum_film_thickness", result->minimum_film_thickness);
    show("central_pressure", result->central_pressure);
    show("peak_pressure", result->peak_pressure);
    show("exit_position", result->exit_position);
    show("half_width", result->half_width);
    show("newton_iterations", (double)result->iterations);
}

/* Returns the largest pressure of the fields. */
static double largest(ehdrom_contact *contact, const ehdrom_model *model, double *first_x) {
    ehdrom_model_info info = EHDROM_MODEL_INFO_INIT;
    size_t num_x, num_y;

    CHECK(!ehdrom_model_describe(model, &info));
    const size_t count = info.num_x * info.num_y;
    double *pressure = (double *)malloc(count * sizeof(double));
    double *film = (double *)malloc(count * sizeof(double));
    double *x = (double *)malloc(info.num_x * sizeof(double));
    double most = 0;
    CHECK(pressure && film && x);
    CHECK(!ehdrom_fields(contact, pressure, film));
    CHECK(!ehdrom_fields(contact, pressure, NULL));
    CHECK(!ehdrom_axes(contact, x, NULL));
    CHECK(!ehdrom_nodes(contact, &num_x, &num_y) && num_y == info.num_y);
    // the solution may be of a model in a list, on a grid with fewer nodes; the rest is NaN
    for (size_t k = 0; k < count; k++) {
        CHECK(isnan(pressure[k]) == (k >= num_x * num_y) && isnan(film[k]) == isnan(pressure[k]));
        if (pressure[k] > most) most = pressure[k];
    }
    for (size_t i = 0; i < info.num_x; i++)
        CHECK(isnan(x[i]) == (i >= num_x));
    *first_x = x[0];
    free(pressure);
    free(film);
    free(x);
    return most;
}

static void solve(int argc, char **argv) {
    ehdrom_model *model = open_model(argv[2]);
    ehdrom_contact *contact = new_contact(model, argv[3]);
    ehdrom_result result = EHDROM_RESULT_INIT;
    double first_x;
    size_t num_x;

    CHECK(!ehdrom_contact_set_units(contact, EHDROM_DIMENSIONLESS));
    for (int i = 4; i + 1 < argc; i += 2)
        CHECK(!ehdrom_contact_set(contact, argv[i], argv[i + 1]));
    ehdrom_status status = ehdrom_solve(contact, &result);
    taken(status, contact);
    show_result(&result);
    show("largest", largest(contact, model, &first_x));
    show("first_x", first_x);
    CHECK(!ehdrom_nodes(contact, &num_x, NULL));
    show("nodes", (double)num_x);
    ehdrom_contact_free(contact);
    ehdrom_model_close(model);
    exit(status);
}

static int near(double found, double expected) {
    return fabs(found / expected - 1) < 1e-12;
}

/* Checks that a result in SI is the dimensionless result times the scales, to the last bit. */
static int same_by(const ehdrom_scales *scales, const ehdrom_result *si,
                   const ehdrom_result *pure) {
    return si->central_film_thickness == pure->central_film_thickness * scales->film &&
           si->minimum_film_thickness == pure->minimum_film_thickness * scales->film &&
           si->approach == pure->approach * scales->film &&
           si->central_pressure == pure->central_pressure * scales->hertz_pressure &&
           si->peak_pressure == pure->peak_pressure * scales->hertz_pressure &&
           si->exit_position == pure->exit_position * scales->half_width &&
           si->half_width == pure->half_width * scales->half_width &&
           si->load == pure->load * scales->load && si->time == pure->time * scales->time;
}

static void units(char **argv) {
    ehdrom_model *model = open_model(argv[2]);
    ehdrom_contact *si = new_contact(model, argv[3]), *pure = new_contact(model, argv[3]);
    ehdrom_result found = EHDROM_RESULT_INIT, expected = EHDROM_RESULT_INIT;
    ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT, relative = EHDROM_CONDITIONS_INIT;
    ehdrom_scales scales = EHDROM_SCALES_INIT;
    ehdrom_response response = EHDROM_RESPONSE_INIT;

    CHECK(!ehdrom_contact_set_units(pure, EHDROM_DIMENSIONLESS));
    CHECK(!ehdrom_contact_scales(si, &scales));
    CHECK(taken(ehdrom_solve(si, &found), si) == EHDROM_OK);
    CHECK(taken(ehdrom_solve(pure, &expected), pure) == EHDROM_OK);
    CHECK(same_by(&scales, &found, &expected));
    show_result(&found);
    show("load_scale", scales.load);
    show("film_scale", scales.film);
    show("pressure_scale", scales.hertz_pressure);
    show("length_scale", scales.half_width);
    CHECK(!ehdrom_respond(si, &response));
    show("stiffness", response.stiffness);
    // a step with load and speed in SI
    const double step = scales.time / 64;
    CHECK(taken(ehdrom_start(si, NULL, &found), si) == EHDROM_OK);
    CHECK(taken(ehdrom_start(pure, NULL, &expected), pure) == EHDROM_OK);
    conditions.given = relative.given = EHDROM_LOAD | EHDROM_SPEED;
    conditions.load = 1.03125 * scales.load;
    conditions.speed = 0.96875 * scales.speed;
    relative.load = conditions.load / scales.load;
    relative.speed = conditions.speed / scales.speed;
    CHECK(taken(ehdrom_step(si, &conditions, step, &found), si) != EHDROM_NOT_CONVERGED);
    CHECK(taken(ehdrom_step(pure, &relative, step / scales.time, &expected), pure) == found.status);
    CHECK(same_by(&scales, &found, &expected));
    // 1e-3: error of the few selected equations of a small model
    CHECK(found.time == step && fabs(found.load / conditions.load - 1) < 1e-3);
    // a step with the approach, in m
    conditions.given = relative.given = EHDROM_APPROACH;
    conditions.approach = found.approach;
    relative.approach = conditions.approach / scales.film;
    CHECK(taken(ehdrom_step(si, &conditions, step, &found), si) != EHDROM_NOT_CONVERGED);
    CHECK(taken(ehdrom_step(pure, &relative, step / scales.time, &expected), pure) == found.status);
    CHECK(same_by(&scales, &found, &expected));
    CHECK(fabs(found.approach / conditions.approach - 1) < 1e-3);
    ehdrom_contact_free(si);
    ehdrom_contact_free(pure);
    ehdrom_model_close(model);
}

static void set(char **argv) {
    ehdrom_model *model = open_model(argv[2]);
    ehdrom_contact *contact = new_contact(model, NULL);
    ehdrom_result si = EHDROM_RESULT_INIT, pure = EHDROM_RESULT_INIT;
    ehdrom_scales scales = EHDROM_SCALES_INIT;
    double x_si, x_pure;

    // a locale with a decimal comma
    CHECK(setlocale(LC_ALL, argv[3]));
    CHECK(!ehdrom_contact_set(contact, "lubricant.viscosity.law", "barus"));
    CHECK(!ehdrom_contact_set(contact, "lubricant.viscosity.alpha", "2.0e-8"));
    CHECK(!ehdrom_contact_set(contact, "lubricant.density.law", "dowson-higginson"));
    CHECK(!ehdrom_contact_set_number(contact, "physical.load", 20e3));
    CHECK(!ehdrom_contact_set_number(contact, "physical.radius", 0.01));
    CHECK(!ehdrom_contact_set_number(contact, "physical.speed", 0.0376));
    CHECK(!ehdrom_contact_set_number(contact, "physical.modulus", 220e9));
    CHECK(!ehdrom_contact_set_number(contact, "physical.viscosity", 0.02));
    CHECK(!ehdrom_solve(contact, &si));
    const double largest_si = largest(contact, model, &x_si);
    CHECK(strcmp(setlocale(LC_ALL, NULL), argv[3]) == 0);
    CHECK(!ehdrom_contact_scales(contact, &scales));
    CHECK(!ehdrom_contact_set_units(contact, EHDROM_DIMENSIONLESS));
    CHECK(!ehdrom_solve(contact, &pure));
    const double largest_pure = largest(contact, model, &x_pure);
    CHECK(same_by(&scales, &si, &pure) && near(scales.load, 20e3));
    CHECK(near(largest_si, largest_pure * scales.hertz_pressure));
    CHECK(near(x_si, x_pure * scales.half_width));
    // Hertz: a = sqrt(8 w R/(pi E')), p_H = 2 w/(pi a)
    CHECK(near(scales.half_width, sqrt(8 * 20e3 * 0.01 / (3.14159265358979323846 * 220e9))));
    CHECK(near(scales.hertz_pressure, 2 * 20e3 / (3.14159265358979323846 * scales.half_width)));
    CHECK(near(scales.time, scales.half_width / 0.0376));
    show_result(&pure);
    ehdrom_contact_free(contact);
    ehdrom_model_close(model);
}

static void march(char **argv) {
    ehdrom_model *model = open_model(argv[2]);
    ehdrom_contact *contact = new_contact(model, argv[3]), *other = new_contact(model, argv[3]);
    ehdrom_result result = EHDROM_RESULT_INIT, again = EHDROM_RESULT_INIT;
    ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT;
    const double step = atof(argv[4]);
    const int num = atoi(argv[5]);
    size_t count = 0;
    double *saved;

    CHECK(ehdrom_step(contact, NULL, step, &result) == EHDROM_INTERNAL);
    CHECK(!ehdrom_contact_set_units(contact, EHDROM_DIMENSIONLESS));
    CHECK(!ehdrom_contact_set_units(other, EHDROM_DIMENSIONLESS));
    CHECK(taken(ehdrom_start(contact, NULL, &result), contact) != EHDROM_NOT_CONVERGED);
    CHECK(ehdrom_accept(contact) == EHDROM_INTERNAL);
    CHECK(!ehdrom_state_size(contact, &count));
    saved = (double *)malloc(count * sizeof(double));
    CHECK(saved);
    for (int i = 1; i <= num; i++) {
        const double trial = step / 2;
        conditions.given = EHDROM_LOAD;
        conditions.load = 1 + 0.1 * sin(2 * 3.14159265358979323846 * (result.time + trial));
        CHECK(taken(ehdrom_step(contact, &conditions, trial, &again), contact) !=
              EHDROM_NOT_CONVERGED);
        conditions.load = 1 + 0.1 * sin(2 * 3.14159265358979323846 * i * step);
        CHECK(taken(ehdrom_step(contact, &conditions, step, &result), contact) !=
              EHDROM_NOT_CONVERGED);
        if (i == num) CHECK(!ehdrom_state_save(contact, saved, count));
        CHECK(!ehdrom_accept(contact));
    }
    // another contact continues from the state before the last step; its results are equal to the
    // last bit
    CHECK(ehdrom_state_restore(other, saved, count - 1) == EHDROM_DATA);
    CHECK(!ehdrom_state_restore(other, saved, count));
    CHECK(taken(ehdrom_step(other, &conditions, step, &again), other) != EHDROM_NOT_CONVERGED);
    CHECK(again.central_film_thickness == result.central_film_thickness);
    CHECK(again.approach == result.approach && again.peak_pressure == result.peak_pressure);
    CHECK(!ehdrom_accept(other));
    double first_x;
    const double most = largest(contact, model, &first_x);
    // one call makes a step of both contacts
    ehdrom_contact *const both[2] = {contact, other};
    const ehdrom_conditions same[2] = {conditions, conditions};
    ehdrom_result results[2] = {result, result};
    CHECK(!EHDROM_FAILED(ehdrom_step_many(both, same, step, results, 2)));
    CHECK(results[0].time > result.time && results[0].time == results[1].time);
    CHECK(results[0].minimum_film_thickness == results[1].minimum_film_thickness);
    // if a contact fails, its result has the status, and the other values do not change
    const ehdrom_conditions one_is_wrong[2] = {{sizeof conditions, 1024, 0, 0, 0, 0, 0},
                                               conditions};
    const double before = results[0].load;
    results[1].load = 0;
    CHECK(ehdrom_step_many(both, one_is_wrong, step, results, 2) == EHDROM_DATA);
    CHECK(results[0].status == EHDROM_DATA && results[0].load == before && results[1].load > 0);
    CHECK(!EHDROM_FAILED(results[1].status) && *ehdrom_contact_error(contact));
    results[1].size = 0;
    CHECK(ehdrom_step_many(both, NULL, step, results, 2) == EHDROM_DATA);
    // a shorter struct of an older caller: the caller cannot give the members that it lacks
    ehdrom_conditions shorter = {offsetof(ehdrom_conditions, speed), EHDROM_LOAD, 0, 0, 1, 1, 1};
    shorter.load = conditions.load;
    CHECK(!EHDROM_FAILED(ehdrom_step(contact, &shorter, step, &again)));
    shorter.given |= EHDROM_SPEED;
    CHECK(ehdrom_step(contact, &shorter, step, &again) == EHDROM_DATA);
    CHECK(strstr(ehdrom_contact_error(contact), "speed: found a struct that ends before it"));
    CHECK(most == largest(other, model, &first_x));
    show_result(&result);
    show("largest", most);
    // a restored state does not depend on steps made meanwhile, nor on settings that were changed
    // and changed back
    for (int i = 0; i < 3; i++) {
        if (i == 1) CHECK(!ehdrom_contact_set_number(contact, "moes.M", 12));
        if (i == 2) {
            CHECK(!ehdrom_contact_set_number(contact, "moes.M", 12.5));
            CHECK(ehdrom_state_restore(contact, saved, count) == EHDROM_DATA);
            CHECK(!ehdrom_contact_set_number(contact, "moes.M", 12));
        }
        CHECK(!ehdrom_state_restore(contact, saved, count));
        CHECK(!EHDROM_FAILED(ehdrom_step(contact, &conditions, step, &again)));
        CHECK(again.central_film_thickness == result.central_film_thickness);
        CHECK(again.approach == result.approach && again.peak_pressure == result.peak_pressure);
        CHECK(again.local_error == result.local_error && again.iterations == result.iterations);
    }
    saved[2] += 1;
    CHECK(ehdrom_state_restore(other, saved, count) == EHDROM_DATA);
    CHECK(ehdrom_step(other, &conditions, step, &again) == EHDROM_INTERNAL);
    free(saved);
    ehdrom_contact_free(contact);
    ehdrom_contact_free(other);
    ehdrom_model_close(model);
}

/* Checks a derivative against a central difference, to 2e-3. */
static int as_difference(double found, double before, double behind, double change) {
    return fabs(found - (behind - before) / change) < 2e-3 * fabs(found);
}

/* Checks derivatives of the solution with respect to its load, in SI units. */
static void differentiate_solution(ehdrom_contact *contact, double load) {
    ehdrom_derivatives by_load = EHDROM_DERIVATIVES_INIT, by_approach = EHDROM_DERIVATIVES_INIT;
    ehdrom_conditions direction = EHDROM_CONDITIONS_INIT;
    ehdrom_response response = EHDROM_RESPONSE_INIT;
    ehdrom_result result = EHDROM_RESULT_INIT, sides[2] = {result, result};

    taken(ehdrom_solve(contact, &result), contact);
    direction.given = EHDROM_LOAD;
    direction.load = 1;
    taken(ehdrom_differentiate(contact, &direction, &by_load), contact);
    direction.given = EHDROM_APPROACH;
    direction.approach = 1;
    taken(ehdrom_differentiate(contact, &direction, &by_approach), contact);
    taken(ehdrom_respond(contact, &response), contact);
    CHECK(fabs(by_load.load - 1) < 1e-2);
    CHECK(fabs(by_load.half_width / (result.half_width / load / 2) - 1) < 1e-6);
    CHECK(fabs(by_approach.load * by_load.approach / by_load.load - 1) < 1e-9);
    CHECK(fabs(response.stiffness / -by_approach.load - 1) < 1e-9);
    CHECK(response.damping_bound > 0);
    for (int i = 0; i < 2; i++) {
        taken(ehdrom_contact_set_number(contact, "physical.load", load * (i ? 1.001 : 0.999)),
              contact);
        taken(ehdrom_solve(contact, &sides[i]), contact);
    }
    CHECK(as_difference(by_load.central_pressure, sides[0].central_pressure,
                        sides[1].central_pressure, 2e-3 * load));
    CHECK(as_difference(by_load.peak_pressure, sides[0].peak_pressure, sides[1].peak_pressure,
                        2e-3 * load));
    show("stiffness", response.stiffness);
    show("damping", response.damping);
    show("central_film_by_load", by_load.central_film_thickness);
    show("approach_by_load", by_load.approach);
}

/* Checks derivatives of a step, and that the step can still be accepted afterwards. */
static void differentiate_step(ehdrom_contact *contact, double load) {
    ehdrom_derivatives found = EHDROM_DERIVATIVES_INIT;
    ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT, direction = EHDROM_CONDITIONS_INIT;
    ehdrom_response response = EHDROM_RESPONSE_INIT;
    ehdrom_result result = EHDROM_RESULT_INIT, sides[2] = {result, result};
    ehdrom_scales scales = EHDROM_SCALES_INIT;

    taken(ehdrom_contact_set_number(contact, "physical.load", load), contact);
    taken(ehdrom_contact_scales(contact, &scales), contact);
    taken(ehdrom_start(contact, NULL, &result), contact);
    taken(ehdrom_differentiate(contact, &direction, &found), contact); // a direction of zero
    CHECK(found.central_film_thickness == 0 && found.load == 0);
    direction.given = conditions.given = EHDROM_LOAD;
    direction.load = 1;
    for (int i = 0; i < 2; i++) {
        conditions.load = load * (i ? 1.011 : 1.009);
        taken(ehdrom_step(contact, &conditions, 0.02 * scales.time, &sides[i]), contact);
    }
    conditions.load = load * 1.01;
    taken(ehdrom_step(contact, &conditions, 0.02 * scales.time, &result), contact);
    taken(ehdrom_differentiate(contact, &direction, &found), contact);
    CHECK(as_difference(found.approach, sides[0].approach, sides[1].approach, 2e-3 * load));
    CHECK(as_difference(found.central_pressure, sides[0].central_pressure,
                        sides[1].central_pressure, 2e-3 * load));
    CHECK(ehdrom_respond(contact, &response) == EHDROM_INTERNAL); // not available after a step
    direction.given |= EHDROM_APPROACH;
    CHECK(ehdrom_differentiate(contact, &direction, &found) == EHDROM_DATA);
    CHECK(!ehdrom_accept(contact));
    direction.given = EHDROM_LOAD;
    CHECK(ehdrom_differentiate(contact, &direction, &found) == EHDROM_INTERNAL);
}

static void derivatives(char **argv) {
    ehdrom_model *model = open_model(argv[2]);
    ehdrom_contact *contact = new_contact(model, argv[3]);
    ehdrom_derivatives found = EHDROM_DERIVATIVES_INIT;
    const double load = 20e3;

    CHECK(ehdrom_differentiate(contact, NULL, &found) == EHDROM_INTERNAL);
    differentiate_solution(contact, load);
    differentiate_step(contact, load);
    ehdrom_contact_free(contact);
    ehdrom_model_close(model);
}

/* Returns the central film after 20 steps under a rising load, and the number of iterations. */
static double rise(ehdrom_contact *contact, double load, double step, size_t *iterations) {
    ehdrom_result result = EHDROM_RESULT_INIT;
    ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT;

    *iterations = 0;
    conditions.given = EHDROM_LOAD;
    CHECK(taken(ehdrom_start(contact, NULL, &result), contact) != EHDROM_NOT_CONVERGED);
    for (int i = 1; i <= 20; i++) {
        conditions.load = load * (1 + 0.002 * i);
        CHECK(taken(ehdrom_step(contact, &conditions, step, &result), contact) !=
              EHDROM_NOT_CONVERGED);
        CHECK(!ehdrom_accept(contact));
        *iterations += result.iterations;
    }
    return result.central_film_thickness;
}

static void tolerances(char **argv) {
    const double wrong[] = {0, -1e-3, 1, NAN};
    ehdrom_model *model = open_model(argv[2]);
    ehdrom_contact *tight = new_contact(model, argv[3]), *loose = new_contact(model, argv[3]);
    ehdrom_result found = EHDROM_RESULT_INIT, expected = EHDROM_RESULT_INIT;
    size_t of_tight, of_loose;

    for (int i = 0; i < 4; i++) {
        CHECK(ehdrom_contact_set_tolerance(loose, wrong[i]) == EHDROM_DATA);
        CHECK(strstr(ehdrom_contact_error(loose), "tolerance: found "));
        CHECK(ehdrom_contact_set_step_tolerance(loose, wrong[i]) == EHDROM_DATA);
        CHECK(strstr(ehdrom_contact_error(loose), "step tolerance: found "));
    }
    CHECK(!ehdrom_contact_set_units(tight, EHDROM_DIMENSIONLESS));
    CHECK(!ehdrom_contact_set_units(loose, EHDROM_DIMENSIONLESS));
    const double all = rise(tight, 1, 0.01, &of_tight);
    // refused tolerances have no effect
    CHECK(rise(loose, 1, 0.01, &of_loose) == all && of_loose == of_tight);
    CHECK(!ehdrom_contact_set_step_tolerance(loose, 5e-2));
    CHECK(fabs(rise(loose, 1, 0.01, &of_loose) / all - 1) < 5e-2 && of_loose < of_tight);

    CHECK(!ehdrom_contact_set_tolerance(loose, 1e-2));
    CHECK(taken(ehdrom_solve(tight, &expected), tight) == EHDROM_OK);
    CHECK(taken(ehdrom_solve(loose, &found), loose) == EHDROM_OK);
    CHECK(found.iterations < expected.iterations);
    CHECK(found.central_film_thickness != expected.central_film_thickness);
    CHECK(fabs(found.central_film_thickness / expected.central_film_thickness - 1) < 1e-2);
    ehdrom_contact_free(tight);
    ehdrom_contact_free(loose);
    ehdrom_model_close(model);
}

/* Returns the central film after a step to a higher load than at the start. */
static double jump(ehdrom_contact *contact, double step) {
    ehdrom_result result = EHDROM_RESULT_INIT;
    ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT;

    conditions.given = EHDROM_LOAD;
    conditions.load = 1.05;
    CHECK(taken(ehdrom_step(contact, &conditions, step, &result), contact) != EHDROM_NOT_CONVERGED);
    return result.central_film_thickness;
}

/* If the conditions of a contact are constant, its history only determines the order of the next
 * step. Checks that a step after ehdrom_restart therefore equals the first step after a start. */
static void restart(char **argv) {
    ehdrom_model *model = open_model(argv[2]);
    ehdrom_contact *contact = new_contact(model, argv[3]);
    ehdrom_result result = EHDROM_RESULT_INIT;
    const double step = 0.02;

    CHECK(!ehdrom_contact_set_units(contact, EHDROM_DIMENSIONLESS));
    CHECK(ehdrom_restart(contact) == EHDROM_INTERNAL);
    CHECK(strstr(ehdrom_contact_error(contact), "restart: found a contact at no time"));
    taken(ehdrom_start(contact, NULL, &result), contact);
    const double first = jump(contact, step);
    taken(ehdrom_start(contact, NULL, &result), contact);
    taken(ehdrom_step(contact, NULL, step, &result), contact);
    CHECK(!ehdrom_accept(contact));
    const double second_order = jump(contact, step);
    CHECK(!ehdrom_restart(contact));
    const double again = jump(contact, step);
    show("first", first);
    show("second_order", second_order);
    show("again", again);
    // the film after a step under constant conditions differs from the film at the start by 2e-5,
    // an error of the selected equations of a small model
    CHECK(fabs(again - first) < 0.05 * fabs(second_order - first));
    ehdrom_contact_free(contact);
    ehdrom_model_close(model);
}

static void wrong(char **argv) {
    ehdrom_model *none, *model = open_model(argv[2]);
    ehdrom_contact *contact, *orphan;
    ehdrom_result result = EHDROM_RESULT_INIT;
    ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT;
    ehdrom_model_options options = EHDROM_MODEL_OPTIONS_INIT;

    CHECK(ehdrom_model_open(&none, "missing.h5", NULL) == EHDROM_NOINPUT);
    printf("%s\n", ehdrom_model_error(none));
    CHECK(ehdrom_contact_create(&orphan, none) == EHDROM_INTERNAL);
    CHECK(ehdrom_solve(orphan, &result) == EHDROM_INTERNAL);
    ehdrom_contact_free(orphan);
    ehdrom_model_close(none);
    CHECK(ehdrom_model_open(&none, argv[3], NULL) == EHDROM_DATA);
    printf("%s\n", ehdrom_model_error(none));
    ehdrom_model_close(none);
    options.rows = 100000;
    CHECK(ehdrom_model_open(&none, argv[2], &options) == EHDROM_DATA);
    ehdrom_model_close(none);
    options.rows = 0;
    options.stationary = 1;
    CHECK(!ehdrom_model_open(&none, argv[2], &options));
    contact = new_contact(none, argv[3]);
    CHECK(ehdrom_start(contact, NULL, &result) == EHDROM_INTERNAL);
    ehdrom_contact_free(contact);
    ehdrom_model_close(none);

    contact = new_contact(model, argv[3]);
    char text[8] = "before";
    CHECK(!ehdrom_contact_get(contact, "contact", text, sizeof text) && strcmp(text, "line") == 0);
    CHECK(!ehdrom_contact_get(contact, "physical.load", text, sizeof text) && !*text);
    CHECK(ehdrom_contact_get(contact, "lubricant.density.law", text, sizeof text) == EHDROM_DATA);
    CHECK(strstr(ehdrom_contact_error(contact), "found room for 8 characters, expected 17"));
    CHECK(ehdrom_contact_set(contact, NULL, "1") == EHDROM_DATA);
    CHECK(ehdrom_contact_set(contact, NULL, NULL) == EHDROM_DATA);
    CHECK(ehdrom_contact_set_number(contact, NULL, 1) == EHDROM_DATA);
    CHECK(ehdrom_contact_get(contact, NULL, text, sizeof text) == EHDROM_DATA);
    CHECK(ehdrom_contact_read(contact, NULL) == EHDROM_DATA);
    CHECK(ehdrom_contact_set(contact, "physical.lod", "1") == EHDROM_DATA);
    printf("%s\n", ehdrom_contact_error(contact));
    CHECK(ehdrom_contact_set_number(contact, "physical.load", NAN) == EHDROM_DATA);
    printf("%s\n", ehdrom_contact_error(contact));
    // SI units need physical settings; this scene has M and L
    CHECK(ehdrom_solve(contact, &result) == EHDROM_DATA);
    printf("%s\n", ehdrom_contact_error(contact));
    CHECK(!ehdrom_contact_set_units(contact, EHDROM_DIMENSIONLESS));
    CHECK(!ehdrom_solve(contact, &result) && !ehdrom_contact_error(contact)[0]);
    CHECK(ehdrom_fields(contact, NULL, NULL) == EHDROM_OK);
    result.size = 0;
    CHECK(ehdrom_solve(contact, &result) == EHDROM_DATA);
    result.size = offsetof(ehdrom_result, approach); // a shorter struct of an older caller
    result.approach = 17;
    CHECK(!ehdrom_solve(contact, &result) && result.approach == 17 && result.load > 0.9);
    result.size = sizeof result;
    CHECK(!ehdrom_contact_set(contact, "grid.step", "0.07"));
    CHECK(ehdrom_solve(contact, &result) == EHDROM_DATA);
    CHECK(!ehdrom_contact_set(contact, "grid.step", NULL));
    CHECK(ehdrom_fields(contact, NULL, NULL) == EHDROM_INTERNAL);
    conditions.given = EHDROM_LOAD | EHDROM_APPROACH;
    CHECK(ehdrom_start(contact, &conditions, &result) == EHDROM_DATA);
    conditions.given = EHDROM_LOAD;
    conditions.load = NAN;
    CHECK(ehdrom_start(contact, &conditions, &result) == EHDROM_DATA);
    conditions.given = 1U << 20;
    CHECK(ehdrom_start(contact, &conditions, &result) == EHDROM_DATA);
    // the model was never checked
    CHECK(!ehdrom_contact_set_accuracy(contact, 0.01));
    CHECK(ehdrom_solve(contact, &result) == EHDROM_UNTRUSTED && !result.trusted);
    printf("%s\n", ehdrom_contact_error(contact));
    // a wrong kind of contact is reported before a grid with millions of nodes is made
    CHECK(!ehdrom_contact_set(contact, "contact", "point"));
    CHECK(!ehdrom_contact_set(contact, "grid.step", "0.001"));
    CHECK(ehdrom_solve(contact, &result) == EHDROM_DATA);
    printf("%s\n", ehdrom_contact_error(contact));
    ehdrom_contact_free(contact);
    ehdrom_contact_free(NULL);
    ehdrom_model_close(model);
    ehdrom_model_close(NULL);
}

// ---- callers of another version

/* A struct of a later header, with more members at the end. */
typedef struct newer_result {
    ehdrom_result known;
    double beyond[2];
} newer_result;
typedef struct newer_conditions {
    ehdrom_conditions known;
    double beyond[2];
} newer_conditions;
typedef struct newer_scales {
    ehdrom_scales known;
    double beyond[2];
} newer_scales;

/* Checks that a longer struct has the values of `expected`, and that its additional members are
 * unchanged. */
static int same_as(const newer_result *found, const ehdrom_result *expected) {
    ehdrom_result known = found->known;

    known.size = expected->size;
    return memcmp(&known, expected, sizeof known) == 0 && found->known.size == sizeof *found &&
           found->beyond[0] == 17 && found->beyond[1] == -17;
}

static void sizes(char **argv) {
    const newer_result fresh = {EHDROM_RESULT_INIT, {17, -17}};
    const newer_conditions none = {EHDROM_CONDITIONS_INIT, {NAN, NAN}};
    ehdrom_model *model = open_model(argv[2]);
    ehdrom_contact *contacts[2] = {new_contact(model, argv[3]), new_contact(model, argv[3])};
    ehdrom_result result = EHDROM_RESULT_INIT;
    ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT;
    ehdrom_scales scales = EHDROM_SCALES_INIT;
    newer_result newer[2] = {fresh, fresh};
    newer_conditions of_newer[2] = {none, none};
    newer_scales newer_scale = {EHDROM_SCALES_INIT, {17, -17}};

    newer_scale.known.size = sizeof newer_scale;
    for (int i = 0; i < 2; i++) {
        newer[i].known.size = sizeof newer[i];
        of_newer[i].known.size = sizeof of_newer[i];
        CHECK(!ehdrom_contact_set_units(contacts[i], EHDROM_DIMENSIONLESS));
    }
    CHECK(!ehdrom_solve(contacts[0], &result) && !ehdrom_solve(contacts[1], &newer[0].known));
    CHECK(same_as(&newer[0], &result));
    CHECK(!ehdrom_contact_scales(contacts[0], &scales));
    CHECK(!ehdrom_contact_scales(contacts[1], &newer_scale.known));
    CHECK(newer_scale.known.moes_M == scales.moes_M && scales.moes_M == 12);
    CHECK(newer_scale.beyond[0] == 17 && newer_scale.beyond[1] == -17);

    conditions.given = EHDROM_LOAD;
    conditions.load = 1.01;
    for (int i = 0; i < 2; i++) {
        of_newer[i].known.given = EHDROM_LOAD;
        of_newer[i].known.load = 1.01;
    }
    CHECK(!ehdrom_start(contacts[0], &conditions, &result));
    CHECK(!ehdrom_start(contacts[1], &of_newer[0].known, &newer[0].known));
    CHECK(same_as(&newer[0], &result));
    // in an array the distance of entries is the size of the caller's struct
    CHECK(!ehdrom_start(contacts[0], NULL, &result) && !ehdrom_start(contacts[1], NULL, &result));
    of_newer[1].known.load = conditions.load = 1.02;
    // the model was trained on stationary states, so no step is trusted
    CHECK(ehdrom_step_many(contacts, &of_newer[0].known, 0.01, &newer[0].known, 2) ==
          EHDROM_UNTRUSTED);
    CHECK(newer[0].known.load < newer[1].known.load && newer[1].known.time == 0.01);
    CHECK(ehdrom_step(contacts[0], &conditions, 0.01, &result) == EHDROM_UNTRUSTED);
    CHECK(same_as(&newer[1], &result));
    // a shorter struct without the modulus; the memory behind it is not read
    conditions.size = offsetof(ehdrom_conditions, modulus);
    conditions.modulus = NAN;
    CHECK(ehdrom_step(contacts[1], &conditions, 0.01, &newer[0].known) == EHDROM_UNTRUSTED);
    CHECK(same_as(&newer[0], &result));
    for (int i = 0; i < 2; i++)
        ehdrom_contact_free(contacts[i]);
    ehdrom_model_close(model);
}

// ---- threads and memory

/* Returns the number behind `name`, such as "Threads:", in /proc/self/status. */
static int own_number(const char *name) {
    char line[256];
    int count = 0;
    FILE *file = fopen("/proc/self/status", "r");

    CHECK(file);
    while (fgets(line, sizeof line, file))
        if (strncmp(line, name, strlen(name)) == 0) count = atoi(line + strlen(name));
    fclose(file);
    return count;
}

/* Counts the lines of /proc/self/maps that contain the name of the library. */
static int count_maps(const char *library) {
    FILE *maps = fopen("/proc/self/maps", "r");
    char line[4096];
    int count = 0;

    CHECK(maps);
    while (fgets(line, sizeof line, maps))
        count += strstr(line, library) != NULL;
    fclose(maps);
    return count;
}

static void loaded(char **argv) {
    ehdrom_model *model = open_model(argv[2]);
    ehdrom_contact *contact = new_contact(model, argv[3]);
    ehdrom_result result = EHDROM_RESULT_INIT;

    CHECK(!ehdrom_contact_set_units(contact, EHDROM_DIMENSIONLESS));
    taken(ehdrom_solve(contact, &result), contact);
    show("central_film_thickness", result.central_film_thickness);
    taken(ehdrom_start(contact, NULL, &result), contact);
    taken(ehdrom_step(contact, NULL, 0.01, &result), contact);
    show("step", result.central_film_thickness);
    show("hdf5", count_maps("libhdf5"));
    ehdrom_contact_free(contact);
    ehdrom_model_close(model);
    exit(0);
}

static void memory(char **argv) {
    ehdrom_model *model = open_model(argv[2]);
    ehdrom_contact *contact = new_contact(model, argv[3]);
    ehdrom_result result = EHDROM_RESULT_INIT;
    ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT;
    const double step = atof(argv[4]);
    const int num = atoi(argv[5]);

    CHECK(!ehdrom_contact_set_units(contact, EHDROM_DIMENSIONLESS));
    CHECK(!ehdrom_start(contact, NULL, &result));
    conditions.given = EHDROM_LOAD;
    for (int i = 1; i <= num; i++) {
        conditions.load = 1 + 0.02 * sin(2 * 3.14159265358979323846 * i * step);
        CHECK(taken(ehdrom_step(contact, &conditions, step, &result), contact) !=
              EHDROM_NOT_CONVERGED);
        CHECK(!ehdrom_accept(contact));
        if (i == 1000) show("first_kB", own_number("VmRSS:"));
    }
    show("last_kB", own_number("VmRSS:"));
    CHECK(fabs(result.time / (step * num) - 1) < 1e-9);
    ehdrom_contact_free(contact);
    ehdrom_model_close(model);
}

typedef struct worker {
    const char *path, *scene;
    const ehdrom_model *model;
    ehdrom_result results[20];
    ehdrom_result steps[10][2];
} worker;

/* Makes steps of two contacts in one call, while other threads do the same with their contacts. */
static void step_together(worker *self) {
    ehdrom_contact *contacts[2] = {new_contact(self->model, self->scene),
                                   new_contact(self->model, self->scene)};
    const ehdrom_conditions fresh = EHDROM_CONDITIONS_INIT;
    ehdrom_conditions conditions[2] = {fresh, fresh};
    ehdrom_result result = EHDROM_RESULT_INIT;

    for (int c = 0; c < 2; c++) {
        CHECK(!ehdrom_contact_set_units(contacts[c], EHDROM_DIMENSIONLESS));
        CHECK(!ehdrom_start(contacts[c], NULL, &result));
        conditions[c].given = EHDROM_LOAD;
    }
    for (int i = 0; i < 10; i++) {
        for (int c = 0; c < 2; c++) {
            conditions[c].load = 1 + (c ? 0.002 : -0.002) * (i + 1);
            self->steps[i][c].size = sizeof result;
        }
        CHECK(ehdrom_step_many(contacts, conditions, 0.01, self->steps[i], 2) !=
              EHDROM_NOT_CONVERGED);
        for (int c = 0; c < 2; c++) {
            CHECK(!EHDROM_FAILED(self->steps[i][c].status));
            CHECK(!ehdrom_accept(contacts[c]));
        }
    }
    ehdrom_contact_free(contacts[0]);
    ehdrom_contact_free(contacts[1]);
}

static void *work(void *argument) {
    worker *self = (worker *)argument;
    ehdrom_model *own = open_model(self->path); // several threads open the model at once
    ehdrom_contact *contact = new_contact(self->model, self->scene);

    CHECK(!ehdrom_contact_set_units(contact, EHDROM_DIMENSIONLESS));
    for (int i = 0; i < 20; i++) {
        ehdrom_result *result = &self->results[i];
        result->size = sizeof *result;
        CHECK(!ehdrom_contact_set_number(contact, "moes.M", 9 + 0.2 * i));
        CHECK(!ehdrom_solve(contact, result));
    }
    ehdrom_contact_free(contact);
    step_together(self);
    ehdrom_model_close(own);
    return NULL;
}

/* The action of each signal, and the blocked signals. */
enum { NUM_SIGNALS = 65 }; // signals of Linux are numbered from 1
struct signals {
    struct sigaction action[NUM_SIGNALS];
    int known[NUM_SIGNALS];
    sigset_t held;
};

static void take_signals(struct signals *self) {
    int num_known = 0;

    memset(self, 0, sizeof *self);
    for (int i = 1; i < NUM_SIGNALS; i++) {
        self->known[i] = !sigaction(i, NULL, &self->action[i]);
        num_known += self->known[i];
    }
    CHECK(num_known > 60); // glibc reserves two of them
    CHECK(!pthread_sigmask(SIG_SETMASK, NULL, &self->held));
}

static int same_signals(const struct signals *self, const struct signals *other) {
    for (int i = 1; i < NUM_SIGNALS; i++) {
        const struct sigaction *one = &self->action[i], *two = &other->action[i];
        if (self->known[i] != other->known[i] || one->sa_handler != two->sa_handler ||
            one->sa_flags != two->sa_flags ||
            sigismember(&self->held, i) != sigismember(&other->held, i))
            return 0;
        for (int k = 1; k < NUM_SIGNALS; k++)
            if (sigismember(&one->sa_mask, k) != sigismember(&two->sa_mask, k)) return 0;
    }
    return 1;
}

static void threads(char **argv) {
    static worker workers[5];
    pthread_t ids[5];
    struct signals before, after;

    take_signals(&before);
    ehdrom_model *model = open_model(argv[2]);
    for (int i = 0; i < 5; i++) {
        workers[i].path = argv[2];
        workers[i].scene = argv[3];
        workers[i].model = model;
    }
    work(&workers[4]);
    CHECK(own_number("Threads:") == 1); // the library starts no threads
    for (int i = 0; i < 4; i++)
        CHECK(!pthread_create(&ids[i], NULL, work, &workers[i]));
    for (int i = 0; i < 4; i++)
        CHECK(!pthread_join(ids[i], NULL));
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 20; k++)
            CHECK(workers[i].results[k].central_film_thickness ==
                  workers[4].results[k].central_film_thickness);
    for (int i = 0; i < 4; i++)
        CHECK(memcmp(workers[i].steps, workers[4].steps, sizeof workers[i].steps) == 0);
    ehdrom_model_close(model);
    take_signals(&after);
    CHECK(same_signals(&before, &after));
}

int main(int argc, char **argv) {
    if (argc < 4) return 64;
    CHECK(strcmp(ehdrom_version(), EHDROM_VERSION) == 0);
    if (strcmp(argv[1], "solve") == 0) solve(argc, argv);
    if (strcmp(argv[1], "set") == 0) set(argv);
    if (strcmp(argv[1], "march") == 0 && argc == 6) march(argv);
    if (strcmp(argv[1], "units") == 0) units(argv);
    if (strcmp(argv[1], "derivatives") == 0) derivatives(argv);
    if (strcmp(argv[1], "tolerances") == 0) tolerances(argv);
    if (strcmp(argv[1], "restart") == 0) restart(argv);
    if (strcmp(argv[1], "wrong") == 0) wrong(argv);
    if (strcmp(argv[1], "sizes") == 0) sizes(argv);
    if (strcmp(argv[1], "loaded") == 0) loaded(argv);
    if (strcmp(argv[1], "memory") == 0 && argc == 6) memory(argv);
    if (strcmp(argv[1], "threads") == 0) threads(argv);
    return 0;
}
