/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/variant.h"

#include "common/artefact/artefact.h"
#include "tests/bench/measure.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Changes the row of modes of a node. */
typedef void row_change(double *row, size_t num_modes, double by);

static void round_row(double *row, size_t num_modes, double by) {
    (void)by;
    for (size_t j = 0; j < num_modes; j++)
        row[j] = (double)(float)row[j];
}

static void mix_row(double *row, size_t num_modes, double by) {
    row[num_modes - 1] = row[num_modes - 2] + by * row[num_modes - 1];
}

/* Changes all tables that have a column for each mode. */
static void change_tables(reduced_model *model, row_change *change, double by) {
    const struct {
        double *table;
        size_t num_rows;
    } tables[] = {{model->rows.pressure, model->rows.num_needed},
                  {model->rows.film, model->rows.num_needed},
                  {model->band.pressure, model->band.num_nodes},
                  {model->band.film, model->band.num_nodes},
                  {model->cut.base, model->cut.num_rows},
                  {model->checkpoints.cut, model->checkpoints.num * model->cut.num_rows},
                  {model->checkpoints.band, model->checkpoints.num * model->band.num_nodes}};

    for (size_t t = 0; t < sizeof tables / sizeof *tables; t++)
        for (size_t r = 0; r < tables[t].num_rows; r++)
            change(tables[t].table + r * model->num_pressure, model->num_pressure, by);
}

/* Transforms the coordinates of the trained states to the modes of mix_row; exact only with
 * by > 0. */
static void mix_states(reduced_model *model, double by) {
    for (size_t s = 0; s < model->states.num_states; s++) {
        double *last =
            model->states.coordinates + s * model->num_unknowns + model->num_pressure - 1;
        *last = by > 0 ? *last / by : 0;
        last[-1] -= *last;
    }
}

/* Removes D from the weights of the rows in use: D is the stored weight over its factor in the
 * whole model. */
static void take_D_away(reduced_model *model, const char *path) {
    const artefact_schema *const kinds[] = {&schema_model, NULL};
    artefact *file = NULL;
    ehd_error error;

    must(artefact_open(&file, path, kinds, &error), &error);
    size_t num_stored = artefact_length(file, "row");
    double *weight = must_allocate(num_stored * sizeof(double));
    double *factor = must_allocate(num_stored * sizeof(double));
    must(artefact_get(file, "row_weight", weight, num_stored, &error), &error);
    must(artefact_get(file, "row_factor", factor, num_stored, &error), &error);
    for (size_t r = 0; r < model->rows.num_rows; r++)
        model->rows.weight[r] *= factor[r] / weight[r];
    free(factor);
    free(weight);
    artefact_close(&file);
}

void variant_make(reduced_model *model, const char *name, const char *path) {
    if (strcmp(name, "stored") == 0) return;
    if (strcmp(name, "without-D") == 0) {
        take_D_away(model, path);
    } else if (strcmp(name, "single") == 0) {
        change_tables(model, round_row, 0);
    } else if (strncmp(name, "dependent=", 10) == 0) {
        double by = strtod(name + 10, NULL);
        change_tables(model, mix_row, by);
        mix_states(model, by);
    } else {
        fprintf(stderr,
                "bench: variant: found %s, expected stored, without-D, single "
                "or dependent=EPS\n",
                name);
        exit(64);
    }
}
