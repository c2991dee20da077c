/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/online/reduced_march.h"

#include "common/algebra/product.h"
#include "common/algebra/vectors.h"
#include "common/program/program.h"
#include "common/time/bdf_march.h"
#include "common/time/film_errors.h"
#include "romrun/solve/guess.h"
#include "romrun/state/fields.h"
#include "romrun/trust/time_indicator.h"
#include "romrun/trust/trained_range.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Weighted sums of rho H of the accepted states, in the frame of the attempt. */
typedef struct previous_sums {
    size_t *ascending; // [num_rows] rows in the order of their nodes
    double *sum;       // [num_rows] sum with the weights of the BDF formula
    // `attempt`: number of the present attempt; `band_attempt`, [nodes of the band]: number of the
    // attempt that set band_sum
    size_t attempt, *band_attempt;
    double *band_sum; // [nodes of the band] the sum, evaluated on demand
} previous_sums;

/* Data for the local error of an attempt. */
typedef struct error_estimate {
    double *pressure; // [num_rows] P at the rows' nodes
    size_t *end;      // [num_lines] columns of exits, set by find_error_end
    // the way: places on the central grid line from the upstream edge of the dry contact to the
    // centre, used with transport along the path
    size_t num_way;
    size_t *way;     // [num_way] nodes
    size_t *way_row; // [num_way] row at the node, or NO_NODE
    double *x;       // [num_way] X of the place
    double *missed;  // [num_way] solution minus prediction of rho H (bdf_march_missed)
    // `changed`, [num_way]: change of the last accepted rho H that the filter causes; `changed_x`,
    // [num_way]: X to which the fluid has carried this change
    double *changed, *changed_x;
    double *way_mass; // [num_way] rho H at the place; infinite where no error is estimated
} error_estimate;

/* Equations for conditions that differ a little from the conditions of the attempt. */
typedef struct march_beside {
    reduced_march *march;
    contact_frame frame;
    double entrainment;
    double *sum; // [num_rows]
    reduced_squeeze squeeze;
} march_beside;

/* Arguments of reduced_keep_factors for the solver's kept factors. A restored march makes the same
 * factors from these arguments. */
typedef struct factors_origin {
    bool valid;
    contact_frame frame;
    double rate;
    reduced_state state;
} factors_origin;

struct reduced_march {
    bdf_march bdf;
    const reduced_model *model;
    ehd_contact reference;
    film_carrier carrier;
    trained_range *range;
    range_memory *range_memory;
    reduced_solver *solver;
    double start_tolerance;               // tolerance of the iterations of the start
    double tolerance;                     // error that steps may cause in the film; NaN: not set
    previous_film states[NUM_BDF_PLACES]; // states in the ring of `bdf`, and the base (BDF_BASE)
    previous_sums previous;
    // only for transport along the path: d/dX of rho H of the base, as the rows evaluate this
    // derivative
    double *entrained, *band_entrained; // [num_rows], [nodes of the band]
    error_estimate estimate;
    film_errors taken_up; // errors that films have accumulated with transport along the path
    time_indicator indicator;
    film_factors of_films; // factors of the indicator; NaN: no estimates
    film_bounds bounds;    // bounds of the attempt
    functionals *functionals;
    double *influence; // [num_rows] influence of rows on a film
    // value of contact_frame.path until which the contact contains film that formed in an untrusted
    // step; `doubtful`: for the attempt, `last_doubtful`: for the last accepted state
    double doubtful, last_doubtful;
    factors_origin factors;
    // frames scaled by the computed loads. `load_frame`: for the attempt; `last_load_frame`: for
    // the last accepted state; `rate_frame`: for the state from which rates of change are measured.
    // If the approach is given, these frames differ from the frames in which the states were
    // solved.
    contact_frame load_frame, last_load_frame, rate_frame;
    reduced_info info; // outcome of the attempt
    march_beside beside[2];
    arena memory; // memory of all arrays
};

reduced_march *reduced_march_free(reduced_march *self) {
    if (!self) return NULL;
    reduced_solver_free(self->solver);
    trained_range_free(self->range);
    range_memory_free(self->range_memory);
    for (size_t i = 0; i < NUM_BDF_PLACES; i++)
        previous_film_free(&self->states[i]);
    film_carrier_free(&self->carrier);
    time_indicator_free(&self->indicator);
    functionals_free(self->functionals);
    reduced_state_free(&self->factors.state);
    arena_free(&self->memory);
    free(self);
    return NULL;
}

static int compare_nodes(const void *a, const void *b, void *context) {
    const size_t *node = context, p = node[*(const size_t *)a], q = node[*(const size_t *)b];

    return p < q ? -1 : p > q;
}

/* Sorts the rows by node, so that the splines of neighbouring rows use the same memory. */
static void sort_rows(reduced_march *self) {
    for (size_t r = 0; r < self->model->rows.num_rows; r++)
        self->previous.ascending[r] = r;
    qsort_r(self->previous.ascending, self->model->rows.num_rows, sizeof *self->previous.ascending,
            compare_nodes, self->model->rows.node);
}

static void allocate_arrays(reduced_march *self) {
    size_t num_rows = self->model->rows.num_rows, num_band = self->model->band.num_nodes;
    size_t num_lines = self->model->band.num_lines, width = grid_width(&self->model->grid);
    error_estimate *estimate = &self->estimate;
    arena *memory = &self->memory;

    self->previous.ascending = arena_array(memory, num_rows, sizeof *self->previous.ascending);
    self->previous.sum = arena_array(memory, num_rows, sizeof(double));
    self->previous.band_attempt =
        arena_array(memory, num_band, sizeof *self->previous.band_attempt);
    self->previous.band_sum = arena_array(memory, num_band, sizeof(double));
    self->entrained = arena_array(memory, num_rows, sizeof(double));
    self->influence = arena_array(memory, num_rows, sizeof(double));
    self->band_entrained = arena_array(memory, num_band, sizeof(double));
    for (int i = 0; i < 2; i++)
        self->beside[i].sum = arena_array(memory, num_rows, sizeof(double));
    estimate->pressure = arena_array(memory, num_rows, sizeof(double));
    estimate->end = arena_array(memory, num_lines, sizeof *estimate->end);
    estimate->way = arena_array(memory, width, sizeof *estimate->way);
    estimate->way_row = arena_array(memory, width, sizeof *estimate->way_row);
    estimate->x = arena_array(memory, width, sizeof(double));
    estimate->missed = arena_array(memory, width, sizeof(double));
    estimate->changed = arena_array(memory, width, sizeof(double));
    estimate->changed_x = arena_array(memory, width, sizeof(double));
    estimate->way_mass = arena_array(memory, width, sizeof(double));
}

static bool is_along_path(const reduced_march *self) {
    return bdf_march_along_path(&self->bdf);
}

/* Checks whether the errors that time steps cause in the minimum film are estimated. They are
 * estimated only with transport along the path. For a point contact they are not estimated, because
 * its minimum film lies beside the central grid line. */
static bool estimates_minimum(const reduced_march *self) {
    return is_along_path(self) && self->model->band.num_lines == 1;
}

/* Finds the places of the way to the centre (error_estimate). The places are the nodes of rows on
 * the central grid line. If two such nodes are farther apart than `widest`, nodes between them are
 * added. */
static void find_way(reduced_march *self) {
    // Largest distance between two places, half widths (common/time/README.md, Along the path).
    const double widest = 0.05;
    const ehd_grid *grid = &self->model->grid;
    const size_t begin = grid_central_line(grid), end = begin + grid_width(grid) - 1;
    error_estimate *estimate = &self->estimate;
    size_t last = begin; // last place found

    for (size_t k = begin + 1; k < end && grid_x(grid, k) <= grid->step; k++) {
        const size_t row = reduced_model_row(self->model, k);
        if (grid_x(grid, k) < -1) continue;
        if (row == NO_NODE && estimate->num_way > 0 &&
            grid_x(grid, k + 1) - grid_x(grid, last) <= widest)
            continue;
        estimate->way[estimate->num_way] = last = k;
        estimate->x[estimate->num_way] = grid_x(grid, k);
        estimate->way_row[estimate->num_way++] = row;
    }
}

static bool is_of_stationary_scenes(const reduced_states *states) {
    size_t i = 0;

    while (i < states->num_states && states->stationary[i])
        i++;
    return i == states->num_states;
}

/* Checks that transport and smoothing of films are those of the training. */
static ehd_status check_carriage(const reduced_model *model, const ehd_contact *reference,
                                 ehd_error *error) {
    // a smoothing that the scene does not give (NaN) is taken from the training
    const ehd_carriage carriage = {reference->transport, reference->smoothing};
    const ehd_status status =
        carriage_check(&carriage, NULL, &model->carriage, "the model's training", error);

    if (status && is_of_stationary_scenes(&model->states))
        return ehd_fail(error, status,
                        "regime: found transient, expected stationary: this model was trained on "
                        "stationary contacts; train with `histories` in the plan");
    return status;
}

/* Data that is saved behind the accepted states. `load_frame`, `rate_frame` and `doubtful`: as in
 * reduced_march, for the last accepted state. `local`: errors that rows cause in the films.
 * `valid`: 1 if there are kept factors. `rate` and `frame` belong to these factors. In the saved
 * data, the state of the factors and the errors of the indicator follow this struct. */
typedef struct saved_rest {
    contact_frame load_frame, rate_frame;
    double doubtful;
    double valid, rate;
    contact_frame frame;
    local_errors local;
} saved_rest;

enum { NUM_REST = sizeof(saved_rest) / sizeof(double) };
_Static_assert(sizeof(saved_rest) == NUM_REST * sizeof(double), "these are doubles alone");

static const bdf_model model_in_time;

/* Connects the states to the march of BDF2 steps. With transport along the path, saved data begin
 * with the errors that films have accumulated. */
static void set_bdf_march(reduced_march *self) {
    const reduced_model *model = self->model;
    bdf_march *bdf = &self->bdf;

    bdf_march_init(bdf, model->rows.num_rows, &self->memory);
    bdf->model = &model_in_time;
    bdf->reference = &self->reference;
    bdf->masses.node = model->rows.node;
    for (size_t i = 0; i < NUM_BDF_PLACES; i++)
        bdf->frame[i] = &self->states[i].frame;
    bdf->state_size = model->band.num_lines + model->num_unknowns;
    bdf->front_size = is_along_path(self) ? NUM_ERROR_PLACES : 0;
    bdf->behind_size = NUM_REST + bdf->state_size + NUM_ERROR_PLACES;
}

ehd_status reduced_march_create(reduced_march **created, const reduced_model *model,
                                const film_splines *splines, const ehd_contact *reference,
                                const reduced_settings *settings, ehd_error *error) {
    reduced_settings in_time = *settings;

    in_time.exit_at_node = true; // the exit of the start is a node too, as in the full model
    *created = NULL;
    ehd_status status = check_carriage(model, reference, error);
    if (!status) status = discretization_check_in_time(model->grid.discretization, error);
    if (status) return status;
    reduced_march *self = calloc(1, sizeof *self);
    if (!self) return ehd_no_memory(error, "online solver");
    self->model = model;
    self->reference = *reference;
    if (isnan(reference->smoothing)) self->reference.smoothing = model->carriage.smoothing;
    self->of_films = (film_factors){NAN, NAN, NAN, NAN};
    self->start_tolerance = settings->tolerance;
    self->tolerance = NAN;
    self->range = trained_range_create(model);
    self->range_memory = self->range ? range_memory_create(self->range) : NULL;
    allocate_arrays(self);
    set_bdf_march(self);
    self->functionals = functionals_create(model);
    bool whole = self->range_memory && self->functionals && !self->memory.failed;
    if (whole) sort_rows(self);
    if (whole && is_along_path(self)) find_way(self);
    status = whole ? reduced_solver_create(&self->solver, model, &in_time, error)
                   : ehd_no_memory(error, "online solver");
    if (!status) status = reduced_state_init(&self->factors.state, model, error);
    if (!status)
        status = film_carrier_init(&self->carrier, model, splines, &self->reference, error);
    for (size_t i = 0; i < NUM_BDF_PLACES && !status; i++)
        status = previous_film_init(&self->states[i], &self->carrier, error);
    if (!status) status = time_indicator_init(&self->indicator, model, error);
    if (status)
        reduced_march_free(self);
    else
        *created = self;
    return status;
}

void reduced_march_indicate(reduced_march *self, film_factors factors) {
    self->of_films = factors;
}

film_bounds reduced_march_bounds(const reduced_march *self) {
    return self->bounds;
}

void reduced_march_set_tolerance(reduced_march *self, double tolerance) {
    self->tolerance = tolerance;
}

void reduced_march_allow_short_steps(reduced_march *self) {
    self->bdf.allows_short = true;
}

reduced_solver *reduced_march_inner(reduced_march *self) {
    return self->solver;
}

static previous_film *state_before(reduced_march *self, size_t steps) {
    return &self->states[bdf_march_place(&self->bdf, steps)];
}

// ---- trust

/* Checks whether an exit lies at the edge of its trained range. An exit at the downstream end of
 * the grid is accepted: right after a sudden rise of the load the whole outlet is full, and in the
 * training the exit of the full model lies at this end for a moment. */
static bool is_at_edge(const reduced_model *model, const reduced_state *state) {
    const size_t *exit = reduced_state_exits(state), end = grid_width(&model->grid) - 2;

    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        const bool ends = line->max_exit == end;
        if (reduced_model_has_band(model, l) &&
            (exit[l] <= line->min_exit || (exit[l] >= line->max_exit && !ends)))
            return true;
    }
    return false;
}

/* Marks steps as untrusted while the contact contains a film that formed in an untrusted step. Such
 * a film leaves the contact after it has travelled from X = -1 to the exit. */
static void judge_films(march_step *outcome, reduced_march *self, const contact_frame *frame) {
    const double exit = outcome->scalars.exit_position;

    self->doubtful = self->last_doubtful;
    if (outcome->status == EHD_UNTRUSTED) {
        self->doubtful = frame->path + frame->half_width * (1 + exit);
    } else if (frame->path < self->doubtful) {
        march_distrust(outcome, "a film that formed in a step that was not to be trusted");
    }
}

/* Checks whether the gap behind the exit closes so fast that a second zone of pressure carries a
 * part of the load. A reduced model has only one zone on each grid line. */
static bool lacks_zone(const reduced_march *self) {
    if (self->bdf.ring.num_previous < 2) return false; // the first step after a jump has no rates
    return frame_closing_gap(&self->load_frame, &self->last_load_frame, &self->reference, 1).load >
           default_accuracy;
}

/* Returns the rates of change in the attempt. If the approach is given, the load is an outcome and
 * has noise. In short steps, the change of the load is therefore measured from an earlier state.
 * Until there is such a state, the change is multiplied by frame_step_share. */
static frame_rates rates_of_step(const reduced_march *self) {
    const contact_frame *now = &self->load_frame, *last = &self->rate_frame;
    frame_rates rates = frame_rates_between(now, &self->last_load_frame);

    if (isnan(now->approach)) return rates;
    const double share = frame_step_share(last, now->time - last->time, &self->model->grid);
    const double load = share * frame_rates_between(now, last).load;
    rates.all += load - rates.load;
    rates.load = load;
    return rates;
}

/* Sets rate_frame, from which rates of change are measured, to the frame of the accepted state.
 * Does this only if the state is far enough from the present rate_frame, or if the state is the
 * first one after a jump. */
static void move_rate_frame(reduced_march *self) {
    const contact_frame *now = &self->load_frame, *last = &self->rate_frame;

    if (self->bdf.ring.num_previous < 2 ||
        frame_step_share(last, now->time - last->time, &self->model->grid) == 1)
        self->rate_frame = *now;
}

/* Returns why the model does not cover a state. Returns NULL if the model covers the state. */
static const char *why_not_to_trust(reduced_march *self, const reduced_state *state) {
    const reduced_model *model = self->model;
    ehd_contact contact;

    frame_contact(&contact, &self->load_frame, &self->reference);
    // the first step after a jump may have any length, so its rates are not checked
    frame_rates rates = {0};
    if (self->bdf.ring.num_previous > 1) rates = rates_of_step(self);
    if (reduced_doubts_flow(self->solver, state, &contact)) return flow_doubt_reason;
    for (size_t r = 0; r < model->rows.num_rows; r++)
        if (self->estimate.pressure[r] < -MOST_NEGATIVE &&
            grid_x(&model->grid, model->rows.node[r]) < 0)
            return "a negative pressure before the contact";
    if (lacks_zone(self))
        return "a second zone of pressure behind the exit, which the model does not have";
    if (is_at_edge(model, state)) return "an exit boundary at the edge of the trained range";
    return trained_range_check(self->range, self->range_memory, contact_place_of(&contact), &rates);
}

static void judge(march_step *outcome, reduced_march *self, const reduced_state *state,
                  const contact_frame *frame) {
    self->load_frame = isnan(frame->approach)
                           ? *frame // the load is given, and the solution has nearly this load
                           : frame_of_load(self->reference.kind, frame, outcome->scalars.load);
    if (outcome->status == EHD_NOT_CONVERGED) return;
    if (outcome->status == EHD_OK) march_distrust(outcome, why_not_to_trust(self, state));
    judge_films(outcome, self, frame);
}

// ---- the start

/* Solves a contact. The iteration starts from the state at state_before(self, 0). */
static ehd_status solve(reduced_info *info, reduced_march *self, const ehd_contact *contact,
                        const reduced_squeeze *squeeze, ehd_error *error) {
    previous_film *next = state_before(self, 0);
    ehd_status status = reduced_solve(info, &next->state, self->solver, contact, squeeze, error);

    solve_seconds_add(&self->bdf.seconds, &info->seconds);
    return status;
}

/* Solves the stationary contact under the load that scales a frame. The iteration starts from the
 * trained states around the contact. */
static ehd_status solve_under_load(reduced_info *info, reduced_march *self,
                                   const contact_frame *frame, ehd_error *error) {
    ehd_contact contact;

    frame_contact(&contact, frame, &self->reference);
    contact.closure = contact_load_closure(contact.kind);
    reduced_guess(&state_before(self, 0)->state, self->model, contact_place_of(&contact));
    return solve(info, self, &contact, NULL, error);
}

/* Largest number of loads that a search for the load at a given approach tries
 * (test_online_transient.c, the_approach_gives_the_load_back,
 * a_start_from_an_approach_finds_its_load). */
enum { MAX_LOADS = 30 };

/* Finds the load at the given approach by fixed-point iteration: the load of each stationary
 * solution rescales the frame of the next one. The iteration may end in a cycle, because solutions
 * have a tolerance and exits are nodes. A frame of the cycle is accepted if its load error is below
 * the tolerance of the start and no longer falls, or is small after all rescalings. Example: for
 * the line contact of scenes/examples/oscillator under 0.952 of its load, the relative error of the
 * load alternates between 64e-9 and -64e-9. */
static ehd_status find_load(reduced_info *info, reduced_march *self, contact_frame *frame,
                            ehd_error *error) {
    // largest relative error of the load in a cycle (test_online_transient.c,
    // the_approach_gives_the_load_back)
    const double most_in_cycle = 1e-6;
    double off = INFINITY, before;
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < MAX_LOADS; i++) {
        ehd_contact contact;
        frame_contact(&contact, frame, &self->reference);
        status = solve(info, self, &contact, NULL, error);
        if (status || info->status == EHD_NOT_CONVERGED) return status;
        before = off;
        off = fabs(info->scalars.load - 1);
        if (off < 1e-10 || (off < self->start_tolerance && off >= before) ||
            (i + 1 == MAX_LOADS && off < most_in_cycle))
            return EHD_OK;
        *frame =
            frame_of_load(self->reference.kind, frame, fmin(fmax(info->scalars.load, 0.8), 1.25));
    }
    info->status = EHD_NOT_CONVERGED;
    info->reason = "approach out of reach";
    return EHD_OK;
}

/* Finds the load for an approach at which find_load does not converge. The secant method changes
 * the load until the error of the approach is small compared with the film. Each solution of the
 * secant method starts from trained states. Then find_load completes the search. */
static ehd_status walk_to_approach(reduced_info *info, reduced_march *self, contact_frame *frame,
                                   ehd_error *error) {
    // `near`: error of the approach from which on find_load takes over, in central films.
    // `first_stride`, `longest_stride`: first and largest change of ln(load) from one load to the
    // next (test_online_transient.c, a_start_from_an_approach_finds_its_load).
    const double near = 0.1, first_stride = 0.05, longest_stride = 0.2;
    double stride = 0, before = 0;

    for (size_t i = 0; i < MAX_LOADS; i++) {
        const ehd_status status = solve_under_load(info, self, frame, error);
        if (status || info->status == EHD_NOT_CONVERGED) return status;
        const contact_scalars found = frame_to_reference(&info->scalars, frame, &self->reference);
        const double off = found.rigid_approach - frame->approach; // decreases as the load rises
        if (fabs(off) <= near * found.central_film_thickness)
            return find_load(info, self, frame, error);
        stride = i == 0 ? copysign(first_stride, off) : stride * off / (before - off);
        stride = fmin(fmax(stride, -longest_stride), longest_stride);
        before = off;
        *frame = frame_of_load(self->reference.kind, frame, exp(stride));
    }
    info->status = EHD_NOT_CONVERGED;
    info->reason = "approach out of reach";
    return EHD_OK;
}

double reduced_march_least_M(const reduced_march *self) {
    const reduced_states *states = &self->model->states;
    double least = INFINITY;

    for (size_t s = 0; s < states->num_states; s++)
        least = fmin(least, states->moes_M[s]);
    return least;
}

/* Returns the approach and the load of the stationary contact with the smallest M of the training
 * (`touching` of march_solver). */
static ehd_status touching(double *approach, double *load, void *solver, const contact_frame *frame,
                           ehd_error *error) {
    reduced_march *self = solver;
    ehd_contact contact;
    reduced_info info;

    frame_contact(&contact, frame, &self->reference);
    const contact_frame light =
        frame_of_load(self->reference.kind, frame, reduced_march_least_M(self) / contact.moes_M);
    const ehd_status status = solve_under_load(&info, self, &light, error);

    *approach = *load = NAN;
    if (status || info.status == EHD_NOT_CONVERGED) return status;
    *approach = frame_to_reference(&info.scalars, &light, &self->reference).rigid_approach;
    *load = light.load;
    return EHD_OK;
}

/* Returns d/dX of the base's rho H at a node, as the row of the node evaluates it: the value of
 * this row at an entrainment of 1 without pressure flow. */
static double entrain(const reduced_march *self, size_t node) {
    const reduced_model *model = self->model;
    reynolds_stencil stencil = reynolds_stencil_at(&model->grid, node);
    double memory[NUM_FLUID_ARRAYS * NUM_STENCIL] = {0};
    double film[NUM_STENCIL] = {0}, pressure[NUM_STENCIL] = {0};
    reynolds_fluid fluid = reynolds_fluid_in(memory, NUM_STENCIL, &self->reference);
    reynolds_row row;

    for (size_t a = 0; a < NUM_STENCIL; a++) {
        double density;
        if (stencil.node[a] == NO_NODE) continue;
        film_carrier_base_at(&film[a], &density, &self->carrier, stencil.node[a]);
        if (fluid.density) fluid.density[a] = density;
        stencil.node[a] = a;
    }
    reynolds_rows(&row, &model->grid, 1, NULL, &stencil, 1, &fluid, pressure, film);
    return -row.residual;
}

/* Prepares the base (common/time/README.md, Along the path) after its state is set. Previous states
 * are then stored as differences from the base. */
static ehd_status use_base(void *solver, ehd_error *error) {
    reduced_march *self = solver;
    const reduced_model *model = self->model;
    const ehd_grid *grid = &model->grid;
    (void)error;

    film_carrier_set_base(&self->carrier, &self->states[BDF_BASE]);
    for (size_t r = 0; r < model->rows.num_rows; r++)
        self->entrained[r] = entrain(self, model->rows.node[r]);
    for (size_t i = 0; i < self->indicator.num_nodes; i++)
        self->indicator.entrained[i] = entrain(self, self->indicator.node[i]);
    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        if (!grid_is_inner_line(grid, l)) continue;
        for (size_t c = line->begin; c < line->end; c++)
            if (c > 0 && c + 1 < grid_width(grid))
                self->band_entrained[line->offset + c - line->begin] =
                    entrain(self, l * grid_width(grid) + c);
    }
    return EHD_OK;
}

// ---- error estimates of the films

static bool indicates(const reduced_march *self) {
    return !isnan(self->of_films.central);
}

/* Adds the errors that rows cause in the films of the attempt to the indicator's local errors.
 * `then`: frame of the last state; NULL: the attempt is the start. */
static void add_local(reduced_march *self, const contact_scalars *scalars,
                      const contact_frame *then, const contact_frame *now) {
    double errors[NUM_REDUCED_FILMS];

    for (int q = 0; q < NUM_REDUCED_FILMS; q++) {
        const double own = functionals_film_error(self->influence, self->functionals, self->solver,
                                                  (reduced_film)q);
        errors[q] = hypot(own, time_indicator_at_exit(&self->indicator, self->influence));
    }
    time_indicator_add_local(&self->indicator, errors, scalars, then, now);
}

/* Sets the error estimates of the outcome from the errors that the indicator has computed for the
 * attempt. */
static void set_indicated(march_step *outcome, reduced_march *self, const ehd_contact *contact) {
    const time_indicator *indicator = &self->indicator;
    const film_factors *factors = &self->of_films;
    const contact_scalars *scalars = &outcome->scalars;
    const double central = scalars->central_film_thickness;
    const double minimum = scalars->minimum_film_thickness;
    const double at = self->model->band.num_lines > 1 ? 0 : scalars->minimum_position;
    const double density =
        lubricant_density(&contact->lubricant, scalars->central_pressure * contact->hertz_pressure);

    self->bounds = (film_bounds){
        .central = (time_indicator_central(indicator) / density +
                    time_indicator_local(indicator, REDUCED_CENTRAL_FILM, central)) /
                   central,
        .arriving = time_indicator_arriving(indicator, at) / density / minimum,
        .arising = time_indicator_local(indicator, REDUCED_MINIMUM_FILM, minimum) / minimum};
    outcome->indicated = factors->central * self->bounds.central + factors->central_floor;
    outcome->indicated_minimum = factors->central * self->bounds.arriving +
                                 factors->minimum * self->bounds.arising + factors->minimum_floor;
    // an estimate is NaN if an iterate exceeded the limit of the viscosity law
    if (isnan(outcome->indicated)) outcome->indicated = INFINITY;
    if (isnan(outcome->indicated_minimum)) outcome->indicated_minimum = INFINITY;
}

/* Estimates the errors of the start. `contact` is the solved contact, or the dry contact if the
 * surfaces are at rest. */
static void indicate_start(march_step *outcome, reduced_march *self, const ehd_contact *contact) {
    previous_film *first = state_before(self, 0);

    if (!indicates(self)) return;
    previous_film_prepare(first);
    time_indicator_clear(&self->indicator);
    time_indicator_place(&self->indicator, NULL);
    time_indicator_evaluate(&self->indicator, first, self->solver, contact, 0);
    time_indicator_start(&self->indicator, contact->entrainment);
    if (contact->entrainment > 0) add_local(self, &outcome->scalars, NULL, &first->frame);
    set_indicated(outcome, self, contact);
}

static void drop_factors(reduced_march *self);

static ehd_status start(march_step *outcome, void *solver, const contact_frame *frame,
                        ehd_error *error) {
    reduced_march *self = solver;
    previous_film *first = state_before(self, 0);
    reduced_info info = {.status = EHD_OK, .reason = ""};
    ehd_contact contact;
    ehd_status status = EHD_OK;

    reduced_solver_set_tolerance(self->solver, self->start_tolerance);
    first->frame = *frame;
    if (frame->speed > 0) {
        status = solve_under_load(&info, self, frame, error);
    } else {
        frame_contact(&contact, frame, &self->reference);
        contact.closure = contact_load_closure(contact.kind);
        reduced_guess(&first->state, self->model, contact_place_of(&contact));
        info.scalars = reduced_scalars(self->solver, &first->state, &contact);
    }
    if (!status && info.status != EHD_NOT_CONVERGED && frame->speed > 0 &&
        !isnan(frame->approach)) {
        status = find_load(&info, self, &first->frame, error);
        if (!status && info.status == EHD_NOT_CONVERGED) {
            first->frame = *frame;
            status = walk_to_approach(&info, self, &first->frame, error);
        }
    }
    if (status) return status;
    *outcome = (march_step){.status = info.status,
                            .reason = info.reason,
                            .frame = first->frame,
                            .scalars = info.scalars,
                            .effect = is_along_path(self) ? 0 : NAN,
                            .effect_minimum = estimates_minimum(self) ? 0 : NAN,
                            .indicated = NAN,
                            .indicated_minimum = NAN,
                            .iterations = info.iterations,
                            .residual = info.residual};
    if (info.status != EHD_NOT_CONVERGED) {
        frame_contact(&contact, &first->frame, &self->reference);
        reduced_row_values(self->estimate.pressure, NULL, self->solver, &contact);
        self->last_doubtful = -INFINITY;
        judge(outcome, self, &first->state, &first->frame);
        indicate_start(outcome, self, &contact);
    }
    drop_factors(self);
    if (is_along_path(self)) film_errors_set(&self->taken_up, NULL);
    return EHD_OK;
}

// ---- a step

/* Extrapolates the coordinates and the values at the needed nodes from the accepted states. Keeps
 * the exits of the last state. */
static void predict(reduced_march *self) {
    const reduced_model *model = self->model;
    previous_film *next = state_before(self, 0);
    reduced_values *values = &next->values;

    reduced_state_set_exits(&next->state, model,
                            reduced_state_exits(&state_before(self, 1)->state));
    values->checkpoint = state_before(self, 1)->values.checkpoint;
    memset(next->state.coordinates, 0, model->num_unknowns * sizeof(double));
    memset(values->pressure, 0, model->rows.num_needed * sizeof(double));
    memset(values->cut, 0, model->cut.num_rows * sizeof(double));
    for (size_t i = 0; i < self->bdf.ring.num_previous; i++) {
        const previous_film *previous = state_before(self, i + 1);
        double factor = self->bdf.formula.predictor[i];
        axpy(next->state.coordinates, factor, previous->state.coordinates, model->num_unknowns);
        axpy(values->pressure, factor, previous->values.pressure, model->rows.num_needed);
        axpy(values->cut, factor, previous->values.cut, model->cut.num_rows);
        if (previous->values.checkpoint != values->checkpoint && factor != 0)
            values->checkpoint = model->checkpoints.num; // this value means: no checkpoint
    }
}

/* Returns the weighted sum over the previous states of rho H, carried to a node of a frame.
 * `masses`, [num]: rho H of each state. */
static double sum_masses(double masses[BDF_PREVIOUS], const reduced_march *self,
                         const double *weights, size_t num, size_t node,
                         const contact_frame *frame) {
    double sum = 0;

    for (size_t i = 0; i < num; i++) {
        const previous_film *film = &self->states[bdf_march_place(&self->bdf, i + 1)];
        masses[i] = previous_film_mass(film, node, frame);
        sum += weights[i] * masses[i];
    }
    return sum;
}

/* Computes the part of the squeeze term that the previous states contribute at the rows' nodes.
 * `sum`, [num_rows]: this part; with transport along the path it includes the entrainment term of
 * the base. `masses`, [BDF_PREVIOUS, num_rows]: rho H of each state; NULL: the caller does not need
 * rho H. */
static void sum_at_rows(double *sum, double *const *masses, const reduced_march *self,
                        const contact_frame *frame, double entrainment) {
    const row_set *rows = &self->model->rows;
    const size_t num = self->bdf.ring.num_previous;
    double mass[BDF_PREVIOUS];

    for (size_t i = 0; i < rows->num_rows; i++) {
        const size_t r = self->previous.ascending[i];
        sum[r] = sum_masses(mass, self, self->bdf.formula.weight, num, rows->node[r], frame) +
                 entrainment * self->entrained[r];
        for (size_t k = 0; masses && k < num; k++)
            masses[k][r] = mass[k];
    }
}

/* Prepares an accepted state as a previous state of the next steps. With transport along the path
 * the function applies the fraction `share` of the filter. */
static void prepare(void *solver, size_t place, double share) {
    reduced_march *self = solver;
    previous_film *film = &self->states[place];

    if (is_along_path(self))
        previous_film_prepare_path(film, share);
    else
        previous_film_prepare(film);
}

static void carry_over(reduced_march *self, const contact_frame *frame) {
    const double start = program_seconds();

    sum_at_rows(self->previous.sum, self->bdf.masses.previous, self, frame, self->bdf.entrainment);
    self->bdf.seconds.rows += program_seconds() - start;
}

/* Returns the weighted sum of previous rho H at a node of a frame. */
static double sum_in_frame(const reduced_march *self, size_t node, const contact_frame *now) {
    const bdf_formula *formula = &self->bdf.formula;
    double mass[BDF_PREVIOUS];

    return sum_masses(mass, self, formula->weight, formula->num_weighted, node, now);
}

/* Returns the weighted sum of previous rho H at a node of the attempt's frame. */
static double sum_at(const reduced_march *self, size_t node) {
    return sum_in_frame(self, node, &self->states[bdf_march_place(&self->bdf, 0)].frame);
}

/* Returns sum_at plus the entrainment term of the base at a node of the band. Evaluates each node
 * at most once per attempt. */
static double previous_at(void *solver, size_t node) {
    reduced_march *self = solver;
    size_t index = reduced_model_band_index(self->model, node);

    if (self->previous.band_attempt[index] != self->previous.attempt) {
        self->previous.band_sum[index] =
            sum_at(self, node) + self->bdf.entrainment * self->band_entrained[index];
        self->previous.band_attempt[index] = self->previous.attempt;
    }
    return self->previous.band_sum[index];
}

/* Sets estimate.end of each grid line to the column of the farthest upstream exit in the attempt,
 * on the grid lines at a distance of at most march_exit_margin. For a point contact, the exits of
 * the previous states are included. The local error is estimated only at nodes that lie more than
 * march_exit_margin upstream of this exit (is_before_exit). */
static void find_error_end(reduced_march *self) {
    const reduced_model *model = self->model;
    size_t margin = (size_t)ceil(march_exit_margin / model->grid.step);
    size_t num_states = model->band.num_lines > 1 ? self->bdf.ring.num_previous : 0;

    for (size_t l = 0; l < model->band.num_lines; l++)
        self->estimate.end[l] = SIZE_MAX;
    for (size_t i = 0; i <= num_states; i++) {
        const size_t *exit = reduced_state_exits(&state_before(self, i)->state);
        for (size_t l = 0; l < model->band.num_lines; l++) {
            size_t last =
                l + margin < model->band.num_lines ? l + margin : model->band.num_lines - 1;
            if (!reduced_model_has_band(model, l)) continue;
            for (size_t near = l > margin ? l - margin : 0; near <= last; near++)
                if (exit[l] < self->estimate.end[near]) self->estimate.end[near] = exit[l];
        }
    }
}

static bool is_before_exit(const reduced_march *self, size_t node) {
    const ehd_grid *grid = &self->model->grid;
    double end = grid_x(grid, self->estimate.end[reduced_model_line(self->model, node)]);

    return grid_x(grid, node) < end - march_exit_margin;
}

/* Returns bdf_march_missed (solution minus prediction of rho H) at any node. The state of the
 * attempt must be prepared. *mass: rho H at the node. */
static double missed_at(double *mass, const reduced_march *self, size_t node) {
    const previous_film *next = &self->states[bdf_march_place(&self->bdf, 0)];
    double before[BDF_PREVIOUS];

    *mass = previous_film_mass(next, node, &next->frame);
    return *mass - sum_masses(before, self, self->bdf.formula.predictor,
                              self->bdf.ring.num_previous, node, &next->frame);
}

/* Returns the density at the pressure that the dry contact has at X. */
static double hertz_density(const ehd_contact *contact, double x) {
    return lubricant_density(&contact->lubricant,
                             contact->hertz_pressure * sqrt(fmax(1 - x * x, 0)));
}

/* Computes the difference between solution and prediction of rho H (bdf_march_missed) at the places
 * of the way to the centre. The state of the attempt must be prepared. */
static void miss_on_the_way(reduced_march *self) {
    error_estimate *estimate = &self->estimate;

    for (size_t i = 0; i < estimate->num_way; i++) {
        const size_t node = estimate->way[i], r = estimate->way_row[i];
        estimate->missed[i] = 0;
        estimate->way_mass[i] = INFINITY;
        if (!is_before_exit(self, node)) continue;
        if (r == NO_NODE) {
            estimate->missed[i] = missed_at(&estimate->way_mass[i], self, node);
        } else {
            estimate->missed[i] = bdf_march_missed(&self->bdf, r);
            estimate->way_mass[i] = self->bdf.masses.solved[r];
        }
    }
}

/* Returns the largest error of rho H that a film accumulates in the attempt on its way to the
 * centre, divided by the path of the fluid in the step, as in full_march.c. If the step is shorter
 * than frame_shortest_step, the error is divided by the path in this shortest step, since noise
 * does not shrink further. */
static double error_on_the_way(void *solver) {
    const reduced_march *self = solver;
    const error_estimate *estimate = &self->estimate;
    const double *x = estimate->x, *missed = estimate->missed;
    double sum = 0, lowest = 0, highest = 0;

    for (size_t i = 1; i < estimate->num_way; i++) {
        sum += (x[i] - x[i - 1]) * (missed[i] + missed[i - 1]) / 2;
        lowest = fmin(lowest, sum);
        highest = fmax(highest, sum);
    }
    const contact_frame *frame = &self->states[bdf_march_place(&self->bdf, 0)].frame;
    return fmax(sum - lowest, highest - sum) /
           (fmax(self->bdf.step, frame_shortest_step(frame, &self->model->grid)) *
            fmax(self->bdf.entrainment, 1));
}

/* Marks the rows at which the local error is estimated (is_before_exit). With transport along the
 * path, the function also computes the local errors on the way to the centre. */
static void mark(void *solver) {
    reduced_march *self = solver;
    const bdf_masses *masses = &self->bdf.masses;

    find_error_end(self);
    for (size_t r = 0; r < masses->num_rows; r++)
        masses->counts[r] = is_before_exit(self, masses->node[r]);
    if (is_along_path(self)) miss_on_the_way(self);
}

/* Returns the largest accumulated error of rho H before the centre, relative to rho H at the same
 * place. */
static double largest_taken_up(const reduced_march *self) {
    const error_estimate *estimate = &self->estimate;
    double largest = 0;

    for (size_t i = 0; i < estimate->num_way; i++) {
        const double error = fabs(film_errors_at(&self->taken_up, estimate->x[i]));
        if (isgreater(error, 0)) largest = fmax(largest, error / estimate->way_mass[i]);
    }
    return largest;
}

/* The filter changes the last accepted film. Adds this change to the accumulated errors, at the
 * places to which the fluid has carried this film. */
static void add_filter_errors(reduced_march *self, const contact_frame *now) {
    const previous_film *last = state_before(self, 1);
    const double shift = frame_shift(now, &last->frame), stretch = frame_stretch(now, &last->frame);
    error_estimate *estimate = &self->estimate;
    ehd_contact contact;

    frame_contact(&contact, &last->frame, &self->reference);
    for (size_t i = 0; i < estimate->num_way; i++) {
        estimate->changed_x[i] = (estimate->x[i] + shift) / stretch;
        estimate->changed[i] = hertz_density(&contact, estimate->x[i]) *
                               previous_film_filter_change(last, estimate->way[i]);
    }
    film_errors_add(&self->taken_up, march_error_growth * frame_film_ratio(now, &last->frame),
                    estimate->changed, estimate->changed_x, estimate->num_way);
}

/* Carries the accumulated errors of the films along with the fluid, and adds the errors of the
 * attempt. Then sets `effect` and `effect_minimum`, as the full model does. They are the relative
 * differences between the films that infinitely small time steps would give and these films. With
 * upwind transport these differences are not known. */
static void set_effects(march_step *outcome, reduced_march *self, const ehd_contact *contact) {
    const contact_scalars *scalars = &outcome->scalars;
    const previous_film *next = state_before(self, 0);

    if (!is_along_path(self)) return;
    film_errors_carry(&self->taken_up, &state_before(self, 1)->frame, &next->frame);
    add_filter_errors(self, &next->frame);
    if (self->bdf.formula.error > 0)
        film_errors_add(&self->taken_up,
                        self->bdf.formula.rate * self->bdf.step * self->bdf.formula.error,
                        self->estimate.missed, self->estimate.x, self->estimate.num_way);
    outcome->taken_up = largest_taken_up(self);
    outcome->effect = -film_errors_at(&self->taken_up, 0) /
                      (scalars->central_film_thickness * hertz_density(contact, 0));
    if (!estimates_minimum(self)) return;
    outcome->effect_minimum =
        -film_errors_at(&self->taken_up, scalars->minimum_position) /
        (scalars->minimum_film_thickness * hertz_density(contact, scalars->minimum_position));
}

/* Estimates the errors of an attempt. The state of the attempt must be prepared. `contact` comes
 * from bdf_march_contact. */
static void indicate(march_step *outcome, reduced_march *self, const ehd_contact *contact) {
    time_indicator *indicator = &self->indicator;
    const previous_film *next = state_before(self, 0);
    const contact_frame *then = &state_before(self, 1)->frame;

    time_indicator_place(indicator, &next->state);
    for (size_t i = 0; i < indicator->num_nodes; i++)
        indicator->previous[i] = indicator->row[i] != NO_NODE
                                     ? self->previous.sum[indicator->row[i]]
                                     : sum_at(self, indicator->node[i]) +
                                           self->bdf.entrainment * indicator->entrained[i];
    for (size_t i = indicator->num_nodes; i < indicator->num_nodes + indicator->num_at_exit; i++)
        indicator->previous[i] = previous_at(self, indicator->node[i]);
    time_indicator_evaluate(indicator, next, self->solver, contact, self->bdf.formula.rate);
    time_indicator_carry(indicator, then, &next->frame, self->bdf.entrainment, self->bdf.step);
    add_local(self, &outcome->scalars, then, &next->frame);
    set_indicated(outcome, self, contact);
}

/* Returns whether a step whose exit did not settle is repeated with a shorter step. */
static bool shorter_may_settle(const reduced_march *self) {
    // Ratio of the length of this step to the length of the previous step. Above this limit the
    // step is repeated. In scenes/examples/line-in-time all exits settle, so no step reaches this
    // limit.
    const double much_shorter = 0.05;
    const size_t *index = self->bdf.ring.place;

    return self->bdf.ring.num_previous > 1 &&
           self->bdf.step >
               much_shorter * (self->bdf.ring.time[index[1]] - self->bdf.ring.time[index[2]]);
}

static reduced_squeeze squeeze_of(reduced_march *self) {
    return (reduced_squeeze){.rate = self->bdf.formula.rate,
                             .previous = self->previous.sum,
                             .previous_at = previous_at,
                             .context = self};
}

static double film_of_attempt(const void *context, size_t node) {
    const reduced_march *self = context;

    return previous_film_thickness(&self->states[bdf_march_place(&self->bdf, 0)], node);
}

/* Returns the tolerance of the iterations: a tenth of the error that a step of this length may
 * cause in the film. The line contact of scenes/studies/transient-load, period 1/2 (120 modes, 140
 * rows, error control), then takes 1897 iterations instead of 2118. With a tolerance of three times
 * KEPT_TOLERANCE for the pressures, the errors of short steps would be noise. The minimum film
 * would then differ from the full model by 1.0 % instead of 0.4 %. */
static double iteration_tolerance(const reduced_march *self) {
    // `part`: tolerance divided by the allowed error of the step. `most`: largest tolerance. A
    // model of scenes/examples/line-in-time takes 255 iterations. With a tenth of `most` the model
    // takes 270, and the largest film changes by 4e-4. Without `most` a long march with slow
    // changes takes 8 % more steps, and its films change by up to twice the tolerance of the steps
    // (test_path_march.c,
    // a_tolerance_of_the_steps_saves_iterations).
    const double part = 0.1, most = 1.5e-6;
    const double path = self->bdf.step * fmax(self->bdf.entrainment, 1);

    if (isnan(self->tolerance) || !is_along_path(self)) return self->start_tolerance;
    return fmax(self->start_tolerance, fmin(part * self->tolerance * path, most));
}

static ehd_status solve_step(march_step *outcome, void *solver, const ehd_contact *contact,
                             ehd_error *error) {
    reduced_march *self = solver;
    previous_film *next = state_before(self, 0);
    reduced_info info;

    self->previous.attempt++;
    reduced_solver_set_tolerance(self->solver, iteration_tolerance(self));
    carry_over(self, &next->frame);
    predict(self);
    reduced_squeeze squeeze = squeeze_of(self);
    squeeze.start = &next->values;
    squeeze.last = state_before(self, 1)->values.pressure;
    ehd_status status = solve(&info, self, contact, &squeeze, error);
    if (status) return status;
    if (info.status == EHD_UNTRUSTED && shorter_may_settle(self)) info.status = EHD_NOT_CONVERGED;
    self->info = info;
    outcome->status = info.status;
    outcome->reason = info.reason;
    outcome->scalars = info.scalars;
    outcome->iterations = info.iterations;
    outcome->residual = info.residual;
    if (info.status == EHD_NOT_CONVERGED) return EHD_OK;
    reduced_row_values(self->estimate.pressure, self->bdf.masses.solved, self->solver, contact);
    if (indicates(self) || (is_along_path(self) && self->bdf.formula.error > 0)) {
        previous_film_prepare(next);
        reduced_find_dip(&outcome->scalars, self->solver, film_of_attempt, self);
    }
    return EHD_OK;
}

static void assess(march_step *outcome, void *solver, const ehd_contact *contact) {
    reduced_march *self = solver;
    const previous_film *next = state_before(self, 0);

    set_effects(outcome, self, contact);
    judge(outcome, self, &next->state, &next->frame);
    if (indicates(self)) indicate(outcome, self, contact);
}

// ---- derivatives

static double beside_previous_at(void *context, size_t node) {
    const march_beside *beside = context;
    const reduced_march *self = beside->march;

    return sum_in_frame(self, node, &beside->frame) +
           beside->entrainment * self->band_entrained[reduced_model_band_index(self->model, node)];
}

/* Checks whether films are carried into both frames with the same result. */
static bool carries_alike(const contact_frame *a, const contact_frame *b) {
    return a->half_width == b->half_width && a->film_scale == b->film_scale &&
           a->hertz_pressure == b->hertz_pressure && a->path == b->path && a->speed == b->speed;
}

static reduced_equations equations_beside(void *context, const contact_frame *frame,
                                          ehd_contact *contact, int side) {
    reduced_march *self = context;
    march_beside *beside = &self->beside[side];

    frame_contact(contact, frame, &self->reference);
    if (!(self->bdf.formula.rate > 0)) return (reduced_equations){contact, NULL};
    beside->march = self;
    beside->frame = *frame;
    bdf_march_contact(contact, &beside->entrainment, frame, &self->bdf);
    beside->squeeze = squeeze_of(self);
    if (!carries_alike(frame, &state_before(self, 0)->frame)) {
        sum_at_rows(beside->sum, NULL, self, frame, beside->entrainment);
        beside->squeeze.previous = beside->sum;
        beside->squeeze.previous_at = beside_previous_at;
        beside->squeeze.context = beside;
    }
    return (reduced_equations){contact, &beside->squeeze};
}

frame_equations reduced_march_equations(reduced_march *self) {
    return (frame_equations){self, equations_beside};
}

// ---- kept factors

/* Makes the kept factors from the arguments in self->factors. */
static void keep_factors(reduced_march *self) {
    ehd_contact contact;
    double entrainment;

    bdf_march_contact(&contact, &entrainment, &self->factors.frame, &self->bdf);
    reduced_keep_factors(self->solver, &self->factors.state, &contact, self->factors.rate);
}

static bool same_exits(const reduced_state *a, const reduced_state *b, const reduced_model *model) {
    return memcmp(reduced_state_exits(a), reduced_state_exits(b),
                  model->band.num_lines * sizeof(size_t)) == 0;
}

/* Returns whether to keep the factors for the next step, judged by the convergence of this step.
 * Keeping the factors longer does not save time. */
static bool factors_are_current(const reduced_march *self, const reduced_state *solved) {
    // Largest number of iterations of a step after which the factors are kept. A model of
    // scenes/examples/line-in-time takes 255 iterations in all if this number is 3. The model takes
    // 234 iterations if this number is 1, and 279 if this number is 10.
    const size_t max_iterations = 3;

    return self->factors.valid && !self->info.own_jacobian &&
           self->info.iterations <= max_iterations &&
           same_exits(solved, &self->factors.state, self->model);
}

static void renew_factors(reduced_march *self, const previous_film *solved) {
    if (factors_are_current(self, &solved->state)) return;
    self->factors.valid = true;
    self->factors.frame = solved->frame;
    self->factors.rate = self->bdf.formula.rate;
    const bool near = self->info.near_factors;
    reduced_state_copy(&self->factors.state,
                       near ? reduced_take_factors(self->solver) : &solved->state, self->model);
    if (!near) keep_factors(self);
}

static void drop_factors(reduced_march *self) {
    self->factors.valid = false;
    reduced_drop_factors(self->solver);
}

static void keep_errors(void *solver) {
    reduced_march *self = solver;

    if (is_along_path(self)) film_errors_keep(&self->taken_up);
    if (indicates(self)) time_indicator_keep(&self->indicator);
}

static void accept(void *solver) {
    reduced_march *self = solver;
    previous_film *solved = state_before(self, 0);

    reduced_last_values(&solved->values, self->solver);
    if (self->bdf.formula.rate > 0) renew_factors(self, solved);
    move_rate_frame(self);
    self->last_load_frame = self->load_frame;
    self->last_doubtful = self->doubtful;
}

static void restart(void *solver) {
    drop_factors(solver);
}

static void copy(void *solver, size_t target, size_t source) {
    reduced_march *self = solver;

    reduced_state_copy(&self->states[target].state, &self->states[source].state, self->model);
}

reduced_state reduced_march_state(const reduced_march *self, contact_frame *frame) {
    return reduced_march_state_before(self, 1, frame);
}

// ---- from and to another solver

bdf_march *reduced_march_steps(reduced_march *self) {
    return &self->bdf;
}

reduced_state reduced_march_state_before(const reduced_march *self, size_t steps,
                                         contact_frame *frame) {
    const previous_film *found = &self->states[bdf_ring_accepted(&self->bdf.ring, steps)];

    if (frame) *frame = found->frame;
    return found->state;
}

/* Fills `given`, from which another model can take a state, with pressure, film, approach and exits
 * of the state. Does not set the frame of `given`. `given->exits` may be NULL. */
static void give(handed_state *given, const void *solver, size_t place) {
    const reduced_march *self = solver;
    const reduced_state *state = &self->states[place].state;

    given->rigid_approach = state->coordinates[self->model->num_unknowns - 1];
    reduced_fields(given->pressure, given->film, state, self->model,
                   &self->carrier.splines->fields);
    if (given->exits)
        memcpy(given->exits, reduced_state_exits(state),
               self->model->band.num_lines * sizeof *given->exits);
}

const char *reduced_march_check_range(const reduced_march *self, const contact_frame *now,
                                      const contact_frame *before) {
    const frame_rates rates = frame_rates_between(now, before);
    ehd_contact contact;

    frame_contact(&contact, now, &self->reference);
    return trained_range_check(self->range, self->range_memory, contact_place_of(&contact), &rates);
}

double reduced_march_outside(const reduced_march *self, const contact_frame *frame) {
    ehd_contact contact;

    frame_contact(&contact, frame, &self->reference);
    return trained_range_outside(self->range, self->range_memory, contact_place_of(&contact));
}

/* Computes the mean difference, weighted by the pressure, between two films: the film of a state
 * from another model, and the film of the projection of this state. */
static ehd_status mean_lift(double *lift, const reduced_march *self, const handed_state *state,
                            const reduced_state *projected, ehd_error *error) {
    const size_t num_nodes = self->model->grid.num_nodes;
    double *pressure = malloc(2 * num_nodes * sizeof *pressure);
    double weight = 0, sum = 0;

    if (!pressure) return ehd_no_memory(error, "reduced march");
    double *film = pressure + num_nodes;
    reduced_fields(pressure, film, projected, self->model, &self->carrier.splines->fields);
    for (size_t k = 0; k < num_nodes; k++) {
        if (!(state->pressure[k] > 0)) continue;
        weight += state->pressure[k];
        sum += state->pressure[k] * (state->film[k] - film[k]);
    }
    free(pressure);
    *lift = weight > 0 ? sum / weight : 0;
    return EHD_OK;
}

/* Projects a state from another model on the modes. Computes the coordinates of the pressure in the
 * orthonormal modes and, for an independent basis, the coordinates of the deflection. Sets the
 * exits to the nearest exits that this model has. Sets the approach so that the mean film stays the
 * same. Otherwise the pressure that the modes do not represent would lift or lower the whole film.
 * Errors: EHD_MEMORY. */
static ehd_status project(reduced_state *target, const reduced_march *self,
                          const handed_state *state, ehd_error *error) {
    const reduced_model *model = self->model;
    const film_splines *splines = self->carrier.splines;
    const ehd_grid *grid = &model->grid;
    const size_t width = grid_width(grid), num = model->num_pressure;
    double *z = target->coordinates;

    reduced_state_set_exits(target, model, state->exits);
    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        size_t exit = state->exits[l];
        if (exit < line->min_exit) exit = line->min_exit;
        if (exit > line->max_exit) exit = line->max_exit;
        if (target->exits) target->exits[l] = exit;
        if (!target->exits || l == grid_central_line(grid) / width) target->exit = exit;
    }
    memset(z, 0, (num + model->num_deformation) * sizeof *z);
    add_transposed_product(z, 1, splines->fields.pressure, grid->num_nodes, num, state->pressure);
    for (size_t k = 0; k < grid->num_nodes && model->num_deformation > 0; k++) {
        const double *modes = splines->film + (k / width + splines->side) * splines->layout.line +
                              (k % width + splines->margin) * splines->layout.column;
        axpy(z + num, state->film[k] - grid_gap(grid, k) - state->rigid_approach, modes,
             model->num_deformation);
    }
    z[model->num_unknowns - 1] = state->rigid_approach;
    double lift = 0;
    const ehd_status status = mean_lift(&lift, self, state, target, error);
    z[model->num_unknowns - 1] += lift;
    return status;
}

static ehd_status take(void *solver, size_t place, const handed_state *given, ehd_error *error) {
    reduced_march *self = solver;
    previous_film *taken = &self->states[place];
    const ehd_status status = project(&taken->state, self, given, error);

    if (!status)
        reduced_values_of(&taken->values, self->model, taken->state.coordinates,
                          reduced_state_exits(&taken->state));
    return status;
}

static void give_errors(double errors[NUM_ERROR_PLACES], const void *solver) {
    const reduced_march *self = solver;

    memcpy(errors, self->taken_up.kept, sizeof self->taken_up.kept);
}

static void take_errors(void *solver, const double errors[NUM_ERROR_PLACES],
                        const contact_frame *frame) {
    reduced_march *self = solver;

    if (is_along_path(self)) film_errors_set(&self->taken_up, errors);
    self->last_load_frame = self->rate_frame = *frame;
    self->last_doubtful = -INFINITY;
    time_indicator_clear(&self->indicator);
    drop_factors(self);
}

static contact_frame load_frame(const void *solver, size_t place) {
    const reduced_march *self = solver;
    (void)place; // `place` is always the last accepted state

    return self->last_load_frame;
}

/* The stored errors are not yet multiplied by the factor of their model. They are converted by the
 * ratio of both models' factors, so that error times factor stays the same. If one factor is not
 * known, nothing is estimated, and no result of such a model is trusted. */
void reduced_march_take_indicated(reduced_march *self, const reduced_march *from,
                                  const double *change) {
    const film_factors *own = &self->of_films, *other = from ? &from->of_films : own;
    const double factors[NUM_REDUCED_FILMS] = {
        [REDUCED_CENTRAL_FILM] = other->central / own->central,
        [REDUCED_MINIMUM_FILM] = other->minimum / own->minimum};
    double errors[NUM_ERROR_PLACES];
    ehd_contact contact;

    if (from) self->last_doubtful = from->last_doubtful;
    if (isnan(own->central) || isnan(other->central)) return;
    frame_contact(&contact, &self->states[self->bdf.ring.place[1]].frame, &self->reference);
    for (size_t i = 0; i < NUM_ERROR_PLACES; i++) {
        const double x = film_errors_place(i);
        errors[i] = hertz_density(&contact, x) * change[i] / own->central;
        if (from) errors[i] += factors[REDUCED_CENTRAL_FILM] * from->indicator.errors.kept[i];
    }
    film_errors_set(&self->indicator.errors, errors);
    if (!from) return;
    self->indicator.kept_local = from->indicator.kept_local;
    for (int q = 0; q < NUM_REDUCED_FILMS; q++)
        for (size_t l = 0; l < NUM_LENGTHS; l++)
            self->indicator.kept_local.of_film[q][l] *= factors[q];
}

// ---- saving

static void save_state(double *target, const reduced_state *state, const reduced_model *model) {
    const size_t *exit = reduced_state_exits(state);

    for (size_t l = 0; l < model->band.num_lines; l++)
        target[l] = (double)exit[l];
    memcpy(target + model->band.num_lines, state->coordinates,
           model->num_unknowns * sizeof(double));
}

static ehd_status restore_state(reduced_state *state, const double *exit,
                                const reduced_model *model, ehd_error *error) {
    for (size_t l = 0; l < model->band.num_lines; l++) {
        const band_line *line = &model->band.lines[l];
        if (!(exit[l] >= (double)line->min_exit && exit[l] <= (double)line->max_exit))
            return ehd_fail(error, EHD_DATA,
                            "saved state: found the exit at node %g, expected %zu to %zu", exit[l],
                            line->min_exit, line->max_exit);
    }
    state->exit = (size_t)exit[grid_central_line(&model->grid) / grid_width(&model->grid)];
    for (size_t l = 0; l < model->band.num_lines && state->exits; l++)
        state->exits[l] = (size_t)exit[l];
    memcpy(state->coordinates, exit + model->band.num_lines, model->num_unknowns * sizeof(double));
    return EHD_OK;
}

static void save(double *target, const void *solver, size_t place) {
    const reduced_march *self = solver;

    save_state(target, &self->states[place].state, self->model);
}

static ehd_status restore(void *solver, size_t place, const double *source, ehd_error *error) {
    reduced_march *self = solver;
    previous_film *previous = &self->states[place];
    const ehd_status status = restore_state(&previous->state, source, self->model, error);

    if (!status)
        reduced_values_of(&previous->values, self->model, previous->state.coordinates,
                          reduced_state_exits(&previous->state));
    return status;
}

static void save_rest(double *front, double *behind, const void *solver) {
    const reduced_march *self = solver;
    saved_rest rest = {.load_frame = self->last_load_frame,
                       .rate_frame = self->rate_frame,
                       .doubtful = self->last_doubtful,
                       .valid = self->factors.valid ? 1 : 0,
                       .rate = self->factors.rate,
                       .local = self->indicator.kept_local};

    if (is_along_path(self)) memcpy(front, self->taken_up.kept, sizeof self->taken_up.kept);
    if (self->factors.valid) {
        rest.frame = self->factors.frame;
        save_state(behind + NUM_REST, &self->factors.state, self->model);
    }
    memcpy(behind, &rest, sizeof rest);
    memcpy(behind + NUM_REST + self->bdf.state_size, self->indicator.errors.kept,
           sizeof self->indicator.errors.kept);
}

static ehd_status restore_rest(void *solver, const double *front, const double *behind,
                               ehd_error *error) {
    reduced_march *self = solver;
    saved_rest rest;

    memcpy(&rest, behind, sizeof rest);
    if (!frame_is_valid(&rest.load_frame) || !frame_is_valid(&rest.rate_frame))
        return ehd_fail(error, EHD_DATA, "saved state: found no frame of the load, expected one");
    if (is_along_path(self)) film_errors_set(&self->taken_up, front);
    film_errors_set(&self->indicator.errors, behind + NUM_REST + self->bdf.state_size);
    self->indicator.kept_local = rest.local;
    self->last_load_frame = rest.load_frame;
    self->rate_frame = rest.rate_frame;
    self->last_doubtful = rest.doubtful;
    drop_factors(self);
    if (rest.valid != 1) return EHD_OK;
    const ehd_status status =
        restore_state(&self->factors.state, behind + NUM_REST, self->model, error);
    if (status) return status;
    self->factors.frame = rest.frame;
    self->factors.rate = rest.rate;
    self->factors.valid = true;
    keep_factors(self);
    return EHD_OK;
}

static contact_traction traction(void *solver, const ehd_contact *contact,
                                 const contact_scalars *scalars) {
    reduced_march *self = solver;
    const reduced_state state = reduced_march_state(self, NULL);

    return reduced_traction(self->solver, &state, contact, scalars);
}

/* Writes GRID_EXITS entries for each grid line: its exit, then NaN. */
static void exits(double *positions, const void *solver) {
    const reduced_march *self = solver;
    const reduced_state state = reduced_march_state(self, NULL);
    const ehd_grid *grid = &self->model->grid;

    grid_exits(positions, reduced_state_exits(&state), grid);
    for (size_t l = grid_whole(grid).inner_lines; l-- > 0;) {
        positions[l * GRID_EXITS] = positions[l];
        for (size_t i = 1; i < GRID_EXITS; i++)
            positions[l * GRID_EXITS + i] = NAN;
    }
}

static const bdf_model model_in_time = {.passes = true,
                                        .start = start,
                                        .solve = solve_step,
                                        .mark = mark,
                                        .error_on_the_way = error_on_the_way,
                                        .assess = assess,
                                        .accept = accept,
                                        .keep_errors = keep_errors,
                                        .restart = restart,
                                        .copy = copy,
                                        .prepare = prepare,
                                        .use_base = use_base,
                                        .save = save,
                                        .restore = restore,
                                        .save_rest = save_rest,
                                        .restore_rest = restore_rest,
                                        .give = give,
                                        .take = take,
                                        .give_errors = give_errors,
                                        .take_errors = take_errors,
                                        .load_frame = load_frame,
                                        .touching = touching,
                                        .exits = exits,
                                        .traction = traction};

march_solver reduced_march_solver(reduced_march *self) {
    march_solver solver = bdf_march_solver(&self->bdf);

    if (self->model->cubature.nodes.num_needed == 0) solver.traction = NULL;
    return solver;
}
