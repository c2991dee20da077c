/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Couples a lubricated line contact, as a force element, to the integrator in shaken_mass.h: a mass
 * on the contact is shaken near its resonance. Of ehdrom only the installed library is needed.
 *
 *     oscillator SCENE.yml MODEL REDUCED.csv */
#include "shaken_mass.h"

#include <ehdrom.h>

/* Stores a result in *now. The approach is the given position of the mass, since the least squares
 * of the reduced model meet a given approach only to 1e-9. */
static int give(reply *now, ehdrom_status status, double approach, const ehdrom_result *result,
                const ehdrom_contact *contact, failure *error) {
    const char *text = ehdrom_contact_error(contact);

    if (EHDROM_FAILED(status)) return fail(error, status, "%s", text);
    *now = (reply){.converged = status != EHDROM_NOT_CONVERGED,
                   .trusted = status == EHDROM_OK,
                   .approach = approach,
                   .force = result->load,
                   .film = result->central_film_thickness};
    snprintf(now->reason, sizeof now->reason, "%s", text);
    return 0;
}

/* Finds the stationary state under the load, and starts there with the approach given, as in all
 * later steps. */
static int reduced_start(reply *now, void *self, failure *error) {
    ehdrom_result result = EHDROM_RESULT_INIT;
    ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT;
    ehdrom_status status = ehdrom_start(self, NULL, &result);

    conditions.given = EHDROM_APPROACH;
    conditions.approach = result.approach;
    if (!EHDROM_FAILED(status) && status != EHDROM_NOT_CONVERGED)
        status = ehdrom_start(self, &conditions, &result);
    return give(now, status, conditions.approach, &result, self, error);
}

static int reduced_step(reply *now, void *self, double approach, double step, failure *error) {
    ehdrom_result result = EHDROM_RESULT_INIT;
    ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT;

    conditions.given = EHDROM_APPROACH;
    conditions.approach = approach;
    const ehdrom_status status = ehdrom_step(self, &conditions, step, &result);
    return give(now, status, approach, &result, self, error);
}

static void reduced_accept(void *self) {
    ehdrom_accept(self);
}

/* Reports the first state of a complete run that is not trusted. */
static int check_trust(const trace *self, failure *error) {
    for (size_t i = 0; i <= NUM_STEPS; i++)
        if (!self->states[i].trusted)
            return fail(error, UNTRUSTED, "T = %.4g: %s", self->time[i], self->states[i].reason);
    return 0;
}

/* Opens the contact of a scene, in dimensionless units. */
static int open_contact(ehdrom_contact **contact, const ehdrom_model *model, const char *scene,
                        failure *error) {
    int status = ehdrom_contact_create(contact, model);

    if (!status) status = ehdrom_contact_read(*contact, scene);
    if (!status) status = ehdrom_contact_set_units(*contact, EHDROM_DIMENSIONLESS);
    // only the force matters here, so films may be 10 % off
    if (!status) status = ehdrom_contact_set_accuracy(*contact, 0.1);
    return status ? fail(error, status, "%s", ehdrom_contact_error(*contact)) : 0;
}

static int oscillate(const char *scene, const char *model_path, const char *path, failure *error) {
    static trace reduced;
    ehdrom_model *model;
    ehdrom_contact *contact = NULL;
    int status = ehdrom_model_open(&model, model_path, NULL);

    if (status)
        fail(error, status, "%s", ehdrom_model_error(model));
    else
        status = open_contact(&contact, model, scene, error);
    if (!status) {
        const force_element element = {contact, reduced_start, reduced_step, reduced_accept};
        status = run(&reduced, &element, error);
    }
    if (!status) status = write_trace(&reduced, path, error);
    if (!status) print_run("reduced", &reduced);
    if (!status) status = check_trust(&reduced, error);
    ehdrom_contact_free(contact);
    ehdrom_model_close(model);
    return status;
}

int main(int argc, char **argv) {
    failure error = {0};

    if (argc != 4) {
        fputs("usage: oscillator SCENE.yml MODEL REDUCED.csv\n", stderr);
        return USAGE;
    }
    const int status = oscillate(argv[1], argv[2], argv[3], &error);
    if (status) fprintf(stderr, "oscillator: %s\n", error.text);
    return status;
}
