/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/sample.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void set(scene *given, const char *key, const char *value) {
    ehd_error error;

    if (!scene_set(given, key, value, "sample", &error)) return;
    fprintf(stderr, "%s\n", error.text);
    abort();
}

const char *const sample_lubricants[NUM_SAMPLE_LUBRICANTS] = {"barus", "roelands", "no1", "no2",
                                                              "no3"};

scene sample_scene(const char *lubricant, const char *density, double moes_M, double moes_L) {
    scene given;
    int wlf = strncmp(lubricant, "no", 2) == 0;

    scene_defaults(&given);
    given.moes.M = moes_M;
    given.moes.L = moes_L;
    set(&given, "lubricant.viscosity.law", wlf ? "wlf" : lubricant);
    if (wlf)
        set(&given, "lubricant.viscosity.preset", lubricant);
    else
        set(&given, "lubricant.viscosity.alpha", "2e-8");
    if (strcmp(lubricant, "roelands") == 0) set(&given, "lubricant.viscosity.eta0", "0.04");
    set(&given, "lubricant.density.law", density);
    scene_complete(&given);
    given.grid.x_min = -4;
    given.grid.x_max = 2;
    given.grid.step = 0.005;
    return given;
}

static ehd_contact contact_of(const scene *given) {
    ehd_contact contact;
    ehd_error error;

    if (scene_contact(&contact, given, &error)) {
        fprintf(stderr, "%s\n", error.text);
        abort();
    }
    return contact;
}

ehd_contact sample_contact(const char *lubricant, const char *density, double moes_M, double moes_L,
                           double step) {
    scene given = sample_scene(lubricant, density, moes_M, moes_L);

    given.grid.step = step;
    return contact_of(&given);
}

ehd_contact sample_point(const char *lubricant, const char *density, double moes_M, double moes_L,
                         size_t cells, bool half) {
    scene given = sample_scene(lubricant, density, moes_M, moes_L);

    snprintf(given.contact, sizeof given.contact, "point");
    snprintf(given.boundary, sizeof given.boundary, "open");
    given.grid.step = 6 / (double)cells;
    given.grid.x_min = -4.5 + given.grid.step;
    given.grid.x_max = 1.5 - given.grid.step;
    given.grid.y_max = 3 - given.grid.step;
    given.grid.half = half;
    return contact_of(&given);
}

ehd_contact sample_published(ehd_contact contact) {
    contact.grid.discretization = DISCRETIZATION_PUBLISHED;
    contact.grid.boundary = BOUNDARY_ZERO;
    return contact;
}

static const struct {
    const char *lubricant, *density;
    double moes_M, moes_L, step;
} cases[NUM_SAMPLE_CASES] = {
    {"barus", "incompressible", 5, 3, 0.04},     {"barus", "dowson-higginson", 10, 10, 0.04},
    {"barus", "incompressible", 200, 5, 0.02},   {"barus", "dowson-higginson", 10, 0, 0.05},
    {"roelands", "incompressible", 50, 8, 0.02}, {"roelands", "dowson-higginson", 20, 15, 0.02},
    {"no1", "dowson-higginson", 5, 15, 0.05},    {"no1", "incompressible", 100, 5, 0.02},
    {"no2", "dowson-higginson", 40, 9, 0.02},    {"no3", "dowson-higginson", 12, 8, 0.02},
};
ehd_contact sample_case(int i) {
    return sample_contact(cases[i].lubricant, cases[i].density, cases[i].moes_M, cases[i].moes_L,
                          cases[i].step);
}
