/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/model/reduced_cut.h"

#include "common/algebra/product.h"
#include "common/algebra/vectors.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Distance between the checkpoints of a line contact, half widths. With a distance of at most 0.02
 * a solution (56 modes, 1201 nodes) takes 0.107 ms. With a distance of 0.08 the solution takes
 * 0.135 ms. With a single checkpoint it takes 0.17 ms (bench_online.c; test_reduced_cut.c,
 * cut_tables_equal_plain_sums). */
static const double CHECKPOINT_DISTANCE = 0.02;

/* Largest memory of a point contact's checkpoints, bytes. On 129 by 129 nodes a solution takes
 * 1.4 ms with one checkpoint, 0.57 ms with 20 MB of checkpoints and 0.52 ms with 200 MB. With all
 * 168 checkpoints (320 MB) the solution takes 0.51 ms, but the model takes 1.9 s to load instead of
 * 0.9 s (bench_point.c; test_reduced_cut.c, memory_bounds_the_checkpoints_of_a_point). */
static const size_t CHECKPOINT_MEMORY = 400u << 20;

// ---- from one exit line to another

size_t reduced_model_runs(cut_run *runs, const reduced_model *model, const size_t *from,
                          const size_t *to) {
    size_t count = 0;

    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        size_t first = from[l] < to[l] ? from[l] : to[l];
        if (from[l] != to[l])
            runs[count++] =
                (cut_run){line->offset + first - line->begin, index_distance(from[l], to[l]), l,
                          first, to[l] > from[l] ? 1 : -1};
    }
    return count;
}

/* Computes cut += left^T right, summed over `rank` nodes of the band. */
static void add_to_cut(double *cut, const reduced_model *model, const double *left,
                       const double *right, size_t rank) {
    const size_t n = model->num_pressure, num_cut = model->cut.num_rows;

    add_matrix_product(cut, n, 1, (strided){left, 1, num_cut}, right, n, num_cut, n, rank);
}

void reduced_model_change_cut(double *cut, const reduced_model *model, const cut_run *runs,
                              size_t num_runs, double *work) {
    size_t num_cut = model->cut.num_rows, num_pressure = model->num_pressure, rank = 0;
    double *left = work, *right = work + CUT_BLOCK * num_cut;

    if (num_runs == 1 && runs->sign > 0) {
        add_to_cut(cut, model, model->cut.left + runs->first * num_cut,
                   model->band.pressure + runs->first * num_pressure, runs->count);
        return;
    }
    for (size_t r = 0; r < num_runs; r++)
        for (size_t i = runs[r].first; i < runs[r].first + runs[r].count; i++) {
            memcpy(left + rank * num_cut, model->cut.left + i * num_cut, num_cut * sizeof(double));
            for (size_t j = 0; j < num_pressure; j++)
                right[rank * num_pressure + j] =
                    runs[r].sign * model->band.pressure[i * num_pressure + j];
            if (++rank < CUT_BLOCK) continue;
            add_to_cut(cut, model, left, right, rank);
            rank = 0;
        }
    if (rank > 0) add_to_cut(cut, model, left, right, rank);
}

/* Adds the effect of a change of the exit to the deflections of the modes, [num_at, num_pressure],
 * at `num_at` neighbouring nodes from `at` on. */
static void change_films(double *films, const reduced_model *model, const cut_run *runs,
                         size_t num_runs, grid_position at, size_t num_at) {
    size_t num_pressure = model->num_pressure;

    for (size_t a = 0; a < num_at; a++, at.column++)
        for (size_t r = 0; r < num_runs; r++)
            for (size_t i = 0; i < runs[r].count; i++) {
                const double unit = 1;
                double influence = 0;
                reduced_model_deflect(&influence, model, at, 1, runs[r].line, runs[r].column + i, 1,
                                      &unit, runs[r].sign);
                axpy(films + a * num_pressure, influence,
                     model->band.pressure + (runs[r].first + i) * num_pressure, num_pressure);
            }
}

// ---- checkpoints

static size_t exit_distance(const reduced_model *model, const size_t *a, const size_t *b) {
    size_t sum = 0;

    for (size_t l = 0; l < model->band.num_lines; l++)
        sum += index_distance(a[l], b[l]);
    return sum;
}

/* Returns, of the first `count` checkpoints, the checkpoint that is nearest to an exit line. */
static size_t nearest_checkpoint(const reduced_model *model, const size_t *exit, size_t count) {
    size_t best = 0, smallest = SIZE_MAX;

    for (size_t c = 0; c < count; c++) {
        size_t distance =
            exit_distance(model, exit, model->checkpoints.exit + c * model->band.num_lines);
        if (distance >= smallest) continue;
        smallest = distance;
        best = c;
    }
    return best;
}

size_t reduced_model_checkpoint(const reduced_model *model, const size_t *exit) {
    if (model->band.num_lines == 1)
        return (exit[0] - model->band.lines[0].min_exit) / model->checkpoints.stride;
    return nearest_checkpoint(model, exit, model->checkpoints.num);
}

/* Chooses the checkpoints of a line contact, CHECKPOINT_DISTANCE apart. */
static ehd_status space_checkpoints(reduced_model *model, ehd_error *error) {
    model->checkpoints.stride = (size_t)(CHECKPOINT_DISTANCE / model->grid.step) + 1;
    model->checkpoints.num = (model->band.lines[0].max_exit - model->band.lines[0].min_exit) /
                                 model->checkpoints.stride +
                             1;
    model->checkpoints.exit =
        arena_array(&model->memory, model->checkpoints.num, sizeof *model->checkpoints.exit);
    if (!model->checkpoints.exit) return ehd_no_memory(error, "reduced model");
    for (size_t c = 0; c < model->checkpoints.num; c++)
        model->checkpoints.exit[c] = model->band.lines[0].min_exit + c * model->checkpoints.stride;
    return EHD_OK;
}

/* Chooses the checkpoints of a point contact among the exit lines in training. Each new checkpoint
 * is the exit line that is farthest from the checkpoints chosen before (farthest-point sampling).
 * The choice ends when all these exit lines are checkpoints or CHECKPOINT_MEMORY is used. */
static ehd_status spread_checkpoints(reduced_model *model, ehd_error *error) {
    const reduced_states *states = &model->states;
    size_t table =
        (model->cut.num_rows + model->band.num_nodes) * model->num_pressure * sizeof(double);
    size_t max_num = CHECKPOINT_MEMORY / table + 1, num_lines = model->band.num_lines, next = 0;

    if (max_num > states->num_states) max_num = states->num_states;
    model->checkpoints.exit =
        arena_array(&model->memory, max_num * num_lines, sizeof *model->checkpoints.exit);
    if (!model->checkpoints.exit) return ehd_no_memory(error, "reduced model");
    for (model->checkpoints.num = 0; model->checkpoints.num < max_num;) {
        size_t farthest = 0;
        memcpy(model->checkpoints.exit + model->checkpoints.num++ * num_lines,
               states->exit + next * num_lines, num_lines * sizeof *states->exit);
        for (size_t s = 0; s < states->num_states; s++) {
            const size_t *exit = states->exit + s * num_lines;
            size_t near = nearest_checkpoint(model, exit, model->checkpoints.num);
            size_t distance =
                exit_distance(model, exit, model->checkpoints.exit + near * num_lines);
            if (distance <= farthest) continue;
            farthest = distance;
            next = s;
        }
        if (farthest == 0) break;
    }
    return EHD_OK;
}

/* A table that depends on the exit, stored for all checkpoints. */
typedef struct kept_table {
    double *kept;       // [num_checkpoints, size]
    const double *base; // [size] for an exit at the beginning of the band
    size_t size;
    void (*change)(double *table, const reduced_model *model, const cut_run *runs, size_t num_runs,
                   double *work); // updates a table to another exit
} kept_table;

/* Updates the deflections at the nodes of the band. */
static void change_band(double *band, const reduced_model *model, const cut_run *runs,
                        size_t num_runs, double *work) {
    (void)work;
    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        change_films(band + line->offset * model->num_pressure, model, runs, num_runs,
                     (grid_position){l, line->begin}, line->end - line->begin);
    }
}

/* Updates the deflections at the nodes that control rows need. */
static void change_control(double *films, const reduced_model *model, const cut_run *runs,
                           size_t num_runs, double *work) {
    const row_set *control = &model->control;

    (void)work;
    for (size_t q = 0; q < control->num_needed; q++)
        change_films(films + q * model->num_pressure, model, runs, num_runs,
                     reduced_model_position(model, control->needed_node[q]), 1);
}

/* Fills the tables of all checkpoints. The tables of the first checkpoint are computed from `base`,
 * and the tables of each other checkpoint from the nearest filled checkpoint. */
static ehd_status fill_checkpoints(const kept_table *tables, size_t num_tables,
                                   const reduced_model *model, ehd_error *error) {
    cut_run *runs = malloc(model->band.num_lines * sizeof *runs);
    size_t *begin = malloc(model->band.num_lines * sizeof *begin);
    double *work = malloc(CUT_BLOCK * (model->cut.num_rows + model->num_pressure) * sizeof *work);
    bool enough = runs && begin && work;

    for (size_t l = 0; enough && l < model->band.num_lines; l++)
        begin[l] = model->band.lines[l].begin;
    for (size_t c = 0; enough && c < model->checkpoints.num; c++) {
        const size_t *exit = model->checkpoints.exit + c * model->band.num_lines;
        size_t near = nearest_checkpoint(model, exit, c);
        const size_t *from = c > 0 ? model->checkpoints.exit + near * model->band.num_lines : begin;
        size_t num_runs = reduced_model_runs(runs, model, from, exit);
        for (const kept_table *table = tables; table < tables + num_tables; table++) {
            double *here = table->kept + c * table->size;
            const double *there = c > 0 ? table->kept + near * table->size : table->base;
            memcpy(here, there, table->size * sizeof(double));
            table->change(here, model, runs, num_runs, work);
        }
    }
    free(runs);
    free(begin);
    free(work);
    return enough ? EHD_OK : ehd_no_memory(error, "reduced model");
}

ehd_status reduced_model_place_checkpoints(reduced_model *model, ehd_error *error) {
    return model->band.num_lines > 1 ? spread_checkpoints(model, error)
                                     : space_checkpoints(model, error);
}

ehd_status reduced_model_make_checkpoints(reduced_model *model, ehd_error *error) {
    size_t num_pressure = model->num_pressure;
    bool coupled = model->deformation == DEFORMATION_COUPLED;
    ehd_status status = reduced_model_place_checkpoints(model, error);

    if (status) return status;
    model->checkpoints.cut =
        arena_array(&model->memory, model->checkpoints.num * model->cut.num_rows,
                    num_pressure * sizeof(double));
    if (coupled)
        model->checkpoints.band =
            arena_array(&model->memory, model->checkpoints.num * model->band.num_nodes,
                        num_pressure * sizeof(double));
    if (model->memory.failed) return ehd_no_memory(error, "reduced model");
    const kept_table tables[] = {{model->checkpoints.cut, model->cut.base,
                                  model->cut.num_rows * num_pressure, reduced_model_change_cut},
                                 {model->checkpoints.band, model->band.film,
                                  model->band.num_nodes * num_pressure, change_band}};
    return fill_checkpoints(tables, coupled ? 2 : 1, model, error);
}

ehd_status reduced_model_make_control_checkpoints(reduced_model *model, ehd_error *error) {
    row_set *control = &model->control;
    size_t size = control->num_needed * model->num_pressure;

    if (model->deformation != DEFORMATION_COUPLED || size == 0) return EHD_OK;
    model->checkpoints.control =
        arena_array(&model->memory, model->checkpoints.num, size * sizeof(double));
    if (!model->checkpoints.control) return ehd_no_memory(error, "reduced model");
    const kept_table films = {model->checkpoints.control, control->film, size, change_control};
    return fill_checkpoints(&films, 1, model, error);
}
