/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/full_march.h"

#include "common/program/arena.h"
#include "common/time/bdf_march.h"
#include "common/time/surface.h"
#include "common/time/time_grid.h"
#include "fullrun/continuation.h"
#include "fullrun/judge.h"
#include "fullrun/previous.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Largest pressure gradient at the end of the grid with which a result is trusted, in Hertz
 * pressures per half width. With a gradient of 0.3 the error of the central film is 0.15 %. This
 * error was measured under loads that vary by half of the load, on grids that end at X = 1.15 … 2,
 * against a grid that ends at X = 4 (README.md, In time). After a sudden change of the load by
 * half, the gradient is up to 0.15 for a short time. */
static const double MAX_END_GRADIENT = 0.3;

struct full_march {
    bdf_march bdf;
    ehd_contact reference;
    double start_film;
    full_solver *solver;
    previous_state states[NUM_BDF_PLACES]; // at the places of `bdf` (bdf.h); the place PASSING is
                                           // not used
    previous_carrier carrier;
    double *entrained; // [num_inner] d/dX of rho H of the base, discretised as in the rows
    bool *noisy;       // [num_nodes] nodes left out of the local error
    double *previous;  // [num_inner] sum of rho H of the previous states, weighted by the BDF
                       // formula
    double *taken_up;  // [num_nodes] errors of rho H that the last attempt's film has accumulated
    double *kept;      // [num_nodes] errors of rho H that the last accepted film has accumulated
    double *film;      // [num_nodes] scratch for carried errors or for a film without its errors
    double *surface;   // [num_nodes] surface heights in the last attempt's frame; NULL: smooth
    bool mirrored;     // X of the surface is mirrored (find_mirrored_start)
    double *exits;     // [lines of the whole grid, GRID_EXITS] X of the last attempt's exits
    char reason[JUDGE_REASON];
    arena memory;
};

full_march *full_march_free(full_march *self) {
    if (!self) return NULL;
    full_solver_free(self->solver);
    for (size_t i = 0; i < NUM_BDF_PLACES; i++)
        previous_free(&self->states[i]);
    previous_carrier_free(&self->carrier);
    arena_free(&self->memory);
    free(self);
    return NULL;
}

double full_march_bytes(const ehd_contact *reference) {
    const double own = (BDF_PREVIOUS + 8) * sizeof(double) + 2 * sizeof(bool);

    return full_solver_bytes(&reference->grid) + previous_bytes(reference, BDF_PREVIOUS + 2) +
           own * (double)reference->grid.num_nodes;
}

/* Returns the central film of the film formula at a hundredth of the reference speed, with the
 * alpha p_H of the reference. */
static double dry_start_film(const ehd_contact *reference) {
    const contact_kind *kind = reference->kind;
    const contact_shape *shape = &reference->grid.shape;
    // ratio of the reference speed to the speed in the film formula (README.md, In time;
    // test_full_march.c, start_at_rest)
    const double slowness = 100;
    double moes_M = kind->moes_M(shape, reference->lambda / slowness);
    double moes_L = reference->alpha_p_H / kind->alpha_p_H(shape, moes_M, 1);

    return kind->central_film(shape, moes_M, moes_L);
}

enum { NUM_STATE_SCALARS = 2, PASSING = BDF_STATES - 1 };

static size_t state_size(const full_march *self) {
    return NUM_STATE_SCALARS + 2 * self->reference.grid.num_nodes;
}

static const bdf_model model;

/* Connects the states to the bdf_march. Saved data have this order:
 * 1. With transport along the path: the time until which the base is used.
 * 2. The errors in `kept`.
 * 3. The states. */
static void set_bdf_march(full_march *self) {
    const ehd_grid *grid = &self->reference.grid;
    bdf_march *bdf = &self->bdf;
    size_t *node = arena_array(&self->memory, grid->num_inner, sizeof *node);

    for (size_t r = 0; node && r < grid->num_inner; r++)
        node[r] = grid_node_of_row(grid, r);
    bdf_march_init(bdf, grid->num_inner, &self->memory);
    bdf->model = &model;
    bdf->reference = &self->reference;
    bdf->seconds.exit = NAN; // not measured
    bdf->masses.node = node;
    for (size_t i = 0; i < NUM_BDF_PLACES; i++)
        bdf->frame[i] = &self->states[i].frame;
    bdf->state_size = state_size(self);
    bdf->front_size = grid->num_nodes + (bdf_march_along_path(bdf) ? 1 : 0);
}

ehd_status full_march_create(full_march **created, const ehd_contact *reference,
                             const full_settings *settings, double start_film, ehd_error *error) {
    size_t num_nodes = reference->grid.num_nodes;
    full_settings in_time = *settings;

    *created = NULL;
    ehd_status status = discretization_check_in_time(reference->grid.discretization, error);
    if (status) return status;
    full_march *self = calloc(1, sizeof *self);
    in_time.exit_at_node = true; // an exit within a cell at the start would cause a wave
    if (!self) return ehd_no_memory(error, "full model");
    arena *memory = &self->memory;
    self->reference = *reference;
    self->start_film = isnan(start_film) ? dry_start_film(reference) : start_film;
    set_bdf_march(self);
    self->previous = arena_array(memory, reference->grid.num_inner, sizeof(double));
    self->noisy = arena_array(memory, num_nodes, sizeof *self->noisy);
    self->entrained = arena_array(memory, num_nodes, sizeof(double));
    self->taken_up = arena_array(memory, num_nodes, sizeof(double));
    self->kept = arena_array(memory, num_nodes, sizeof(double));
    self->film = arena_array(memory, num_nodes, sizeof(double));
    if (reference->surface) self->surface = arena_array(memory, num_nodes, sizeof(double));
    self->exits =
        arena_array(memory, grid_whole(&reference->grid).inner_lines * GRID_EXITS, sizeof(double));
    bool whole = !memory->failed;
    status = whole ? full_solver_create(&self->solver, reference->kind, &reference->grid, &in_time,
                                        error)
                   : ehd_no_memory(error, "full model");
    if (!status) status = previous_carrier_init(&self->carrier, reference, error);
    for (size_t i = 0; i < NUM_BDF_PLACES && !status; i++)
        if (i != PASSING) status = previous_init(&self->states[i], reference, error);
    if (status)
        full_march_free(self);
    else
        *created = self;
    return status;
}

static previous_state *state_before(full_march *self, size_t steps) {
    return &self->states[bdf_march_place(&self->bdf, steps)];
}

// ---- the start

/* Finds the stationary solution for a given load. At zero speed, sets the state to the dry
 * contact. */
static ehd_status start_with_load(full_info *info, full_march *self, const contact_frame *frame,
                                  ehd_error *error) {
    full_state *state = &state_before(self, 0)->state;
    ehd_contact contact;

    frame_contact(&contact, frame, &self->reference);
    contact.closure = contact_load_closure(contact.kind);
    if (frame->speed > 0) {
        contact.lambda *= contact.entrainment;
        contact.entrainment = contact.far_speed = 1;
        return full_solve_cold(info, state, self->solver, &contact, error);
    }
    full_start_dry(state, self->solver, &contact, self->start_film);
    memset(info, 0, sizeof *info);
    info->reason = "";
    return EHD_OK;
}

static double reference_approach(const full_march *self, const full_state *state,
                                 const contact_frame *frame) {
    contact_scalars scalars = full_evaluate_scalars(state, &self->reference);

    return frame_to_reference(&scalars, frame, &self->reference).rigid_approach;
}

/* MIN_STRIDE: smallest stride on the way to an approach or to a surface, as a fraction of the whole
 * way. SETTLED_LOAD: relative tolerance of the load. Of 120 approaches (line and point contacts, M
 * 5 to 100, L 0 to 10, H0 from -6 to 2) 73 are reached, with strides of 1/128 or more. At most of
 * the other approaches the bodies separate. The search for an approach is given up after about 30
 * solutions (test_full_march.c, start_from_an_approach_far_away; test_surface.c,
 * one_at_rest_is_part_of_the_start). */
static const double MIN_STRIDE = 1. / 1024, SETTLED_LOAD = 1e-8;

/* Continues from the solution of a given load to the solution of a given approach. Adapts the frame
 * to the resulting load. */
static ehd_status continue_to_approach(full_info *info, full_march *self, contact_frame *frame,
                                       ehd_error *error) {
    const double wanted = frame->approach;
    full_state *state = &state_before(self, 0)->state, *last = &state_before(self, 1)->state;
    double done = 0, stride = 0.25, load = 1;
    double start = reference_approach(self, state, frame);
    ehd_status status = EHD_OK;

    full_state_copy(last, state, &self->reference.grid);
    while (!status && stride >= MIN_STRIDE && (done < 1 || fabs(load - 1) > SETTLED_LOAD)) {
        ehd_contact contact;
        double next = fmin(done + stride, 1);
        contact_frame here = *frame;
        here.approach = start + next * (wanted - start);
        frame_contact(&contact, &here, &self->reference);
        status = full_solve(info, state, self->solver, &contact, NULL, error);
        if (status) break;
        load = full_evaluate_scalars(state, &contact).load;
        if (info->status == EHD_OK && load > 0.5 && load < 2) {
            if (fabs(load - 1) > SETTLED_LOAD)
                *frame = frame_of_load(self->reference.kind, frame, load);
            done = next;
            stride *= 2;
            full_state_copy(last, state, &self->reference.grid);
        } else {
            stride /= 2;
            load = 1;
            full_state_copy(state, last, &self->reference.grid);
        }
    }
    if (!status && done < 1) {
        info->status = EHD_NOT_CONVERGED;
        info->reason = "approach out of reach";
    }
    return status;
}

/* Estimates the error of the central film that a short inlet causes, unless the load is negligible.
 * If the inlet is too short, the outcome is not to be trusted. */
static void judge_inlet(march_step *outcome, const ehd_contact *contact, bool backwards) {
    if (outcome->status == EHD_NOT_CONVERGED || outcome->frame.load <= default_accuracy) return;
    const bool is_short = time_grid_is_short(&outcome->inlet_effect, contact, backwards);
    if (!outcome->status && is_short)
        march_distrust(outcome,
                       backwards ? "an inlet too short for the contact at this time (grid.x_max)"
                                 : "an inlet too short for the contact at this time (grid.x_min)");
}

/* Judges a stationary start by the criteria of a stationary result (judge.h). An untrusted start is
 * reported even if all later steps are trusted. */
static void judge_start(full_info *info, full_march *self, const previous_state *first) {
    ehd_contact contact;

    frame_contact(&contact, &first->frame, &self->reference);
    if (info->status || first->frame.speed == 0) return; // the dry contact
    info->status = full_judge(self->reason, info, &first->state, &contact);
    if (info->status) info->reason = self->reason;
}

/* Computes d/dX of rho H at the inner nodes: the residual of the Reynolds rows at unit entrainment
 * without pressure flow. For entrainment towards smaller X, reverses the stencils. EHD_MEMORY. */
static ehd_status entrain(double *entrained, const previous_state *state,
                          const ehd_contact *reference, ehd_error *error) {
    const ehd_grid *grid = &reference->grid;
    const bool backwards = state->frame.speed < 0;
    double *memory = calloc(grid->num_nodes, NUM_FLUID_ARRAYS * sizeof *memory);
    reynolds_fluid fluid;

    if (!memory) return ehd_no_memory(error, "full model");
    fluid = reynolds_fluid_in(memory, grid->num_nodes, reference);
    for (size_t k = 0; k < grid->num_nodes && fluid.density; k++)
        fluid.density[k] = lubricant_density(&reference->lubricant,
                                             state->state.pressure[k] * reference->hertz_pressure *
                                                 state->frame.hertz_pressure);
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        const reynolds_stencil stencil =
            backwards ? reynolds_stencil_reversed(grid, k) : reynolds_stencil_at(grid, k);
        reynolds_row row;
        reynolds_rows(&row, grid, 1, NULL, &stencil, 1, &fluid, state->state.pressure,
                      state->state.film);
        entrained[r] = backwards ? row.residual : -row.residual;
    }
    free(memory);
    return EHD_OK;
}

/* Prepares the base: the initial state, at the place BDF_BASE. Until the entrainment reverses, only
 * the difference of previous states from the base is carried along the path. EHD_MEMORY. */
static ehd_status use_base(void *solver, ehd_error *error) {
    full_march *self = solver;
    previous_state *base = &self->states[BDF_BASE];

    previous_set_base(&self->carrier, base);
    return entrain(self->entrained, base, &self->reference, error);
}

/* Adds the fraction `part` of the heights of a surface at rest to the initial gap. A moving
 * surface has not entered the contact yet (surface_check_start). */
static void place_start_surface(full_march *self, const contact_frame *frame, double part) {
    const ehd_surface *surface = self->reference.surface;
    const ehd_grid *grid = &self->reference.grid;
    const bool rests = surface_rests(surface) && part > 0;

    for (size_t k = 0; rests && k < grid->num_nodes; k++) {
        const double x = grid_x(grid, k);
        self->surface[k] =
            part * surface_height(surface, frame, self->mirrored ? -x : x, grid_y(grid, k));
    }
    full_solver_set_surface(self->solver, rests ? self->surface : NULL);
}

/* Continues from the initial state of smooth surfaces to the initial state with a surface at rest,
 * whose heights grow gradually. If the approach is given, the frame is adapted to the load. */
static ehd_status add_surface(full_info *info, full_march *self, contact_frame *frame,
                              ehd_error *error) {
    full_state *state = &state_before(self, 0)->state, *last = &state_before(self, 1)->state;
    double done = 0, stride = 1, load = 1;
    ehd_status status = EHD_OK;
    ehd_contact contact;

    if (frame->speed == 0) { // the dry contact
        place_start_surface(self, frame, 1);
        full_film(state, self->solver);
        for (size_t k = 0; k < self->reference.grid.num_nodes; k++)
            if (!(state->film[k] > 0)) info->status = EHD_NOT_CONVERGED;
        if (info->status) info->reason = "a surface thicker than transient.start_film";
        return EHD_OK;
    }
    full_state_copy(last, state, &self->reference.grid);
    while (stride >= MIN_STRIDE && (done < 1 || fabs(load - 1) > SETTLED_LOAD)) {
        const double next = fmin(done + stride, 1);
        place_start_surface(self, frame, next);
        frame_contact(&contact, frame, &self->reference);
        status = full_solve(info, state, self->solver, &contact, NULL, error);
        if (status) return status;
        if (info->status) {
            stride /= 2;
            full_state_copy(state, last, &self->reference.grid);
            continue;
        }
        done = next;
        stride *= 2;
        full_state_copy(last, state, &self->reference.grid);
        if (isnan(frame->approach)) continue;
        load = full_evaluate_scalars(state, &contact).load;
        *frame = frame_of_load(self->reference.kind, frame, load);
    }
    return EHD_OK;
}

/* Finds the initial state, state_before(self, 0), at a speed that is zero or positive. */
static ehd_status find_start(full_info *info, full_march *self, const contact_frame *frame,
                             ehd_error *error) {
    previous_state *first = state_before(self, 0);
    place_start_surface(self, frame, 0);
    ehd_status status = start_with_load(info, self, frame, error);

    first->frame = *frame;
    if (!status && info->status == EHD_OK && frame->speed > 0 && !isnan(frame->approach))
        status = continue_to_approach(info, self, &first->frame, error);
    if (!status && info->status == EHD_OK && surface_rests(self->reference.surface))
        status = add_surface(info, self, &first->frame, error);
    if (!status) solve_seconds_add(&self->bdf.seconds, &info->seconds);
    return status;
}

static void mirror_state(full_state *target, const full_state *source, const ehd_grid *grid) {
    const size_t width = grid_width(grid);

    target->rigid_approach = source->rigid_approach;
    target->exit = 1;
    target->exit_offset = NAN;
    for (size_t k = 0; k < grid->num_nodes; k++) {
        const size_t mirrored = k / width * width + width - 1 - k % width;
        target->pressure[k] = source->pressure[mirrored];
        target->film[k] = source->film[mirrored];
        target->ruptured[k] = !full_has_pressure(source, mirrored);
        if (!target->ruptured[k]) target->exit = k + 1;
    }
    if (grid->inner_lines > 1) target->exit = grid->num_nodes - 1;
}

/* Finds the initial state at a negative speed. It is the mirror image of the initial state at the
 * opposite speed on the mirrored grid. *exit: X at which the pressure ends. */
static ehd_status find_mirrored_start(full_info *info, double *exit, full_march *self,
                                      const contact_frame *frame, ehd_error *error) {
    const ehd_grid *grid = &self->reference.grid;
    previous_state *first = state_before(self, 0);
    ehd_contact reference = self->reference;
    contact_frame forward = *frame;
    full_march *mirror;

    reference.transport = TRANSPORT_UPWIND; // of no effect, since the mirrored march takes no step
    if (!surface_rests(reference.surface)) reference.surface = NULL;
    reference.grid.x_min = -grid_x(grid, grid->inner_x);
    forward.speed = -frame->speed;
    ehd_status status = full_march_create(&mirror, &reference, full_solver_settings(self->solver),
                                          self->start_film, error);
    if (!status) mirror->mirrored = true;
    if (!status) status = find_start(info, mirror, &forward, error);
    if (!status) {
        const previous_state *found = state_before(mirror, 0);
        *exit = -full_evaluate_scalars(&found->state, &reference).exit_position;
        solve_seconds_add(&self->bdf.seconds, &info->seconds);
        first->frame = found->frame;
        first->frame.speed = frame->speed;
        mirror_state(&first->state, &found->state, grid);
    }
    full_march_free(mirror);
    return status;
}

static ehd_status start(march_step *outcome, void *solver, const contact_frame *frame,
                        ehd_error *error) {
    full_march *self = solver;
    previous_state *first = state_before(self, 0);
    const bool backwards = frame->speed < 0;
    double exit = NAN;
    ehd_contact contact;
    full_info info;

    ehd_status status = backwards ? find_mirrored_start(&info, &exit, self, frame, error)
                                  : find_start(&info, self, frame, error);
    if (status) return status;
    judge_start(&info, self, first);
    if (!info.status && frame->time > 0 && self->reference.surface) {
        info.status = EHD_UNTRUSTED;
        info.reason = "a contact that is found again, with a surface that its start leaves out";
    }
    frame_contact(&contact, &first->frame, &self->reference);
    *outcome = (march_step){.status = info.status,
                            .reason = info.reason,
                            .frame = first->frame,
                            .indicated = NAN,
                            .indicated_minimum = NAN,
                            .scalars = full_evaluate_scalars(&first->state, &contact),
                            .iterations = info.newton_iterations,
                            .residual = info.residual};
    judge_inlet(outcome, &contact, backwards);
    if (backwards) outcome->scalars.exit_position = exit;
    full_list_exits(self->exits, &first->state, &self->reference.grid, backwards);
    memset(self->taken_up, 0, self->reference.grid.num_nodes * sizeof(double));
    return EHD_OK;
}

// ---- a time step

/* Predicts pressure and approach of the attempted time step by extrapolation from the previous
 * states, each in its own frame. The prediction has the pressurised zone of the last state. */
static void predict(full_march *self) {
    const bdf_formula *formula = &self->bdf.formula;
    full_state *state = &state_before(self, 0)->state;

    full_state_copy(state, &state_before(self, 1)->state, &self->reference.grid);
    for (size_t k = 1; k < state->exit; k++) {
        double pressure = 0;
        if (state->ruptured[k]) continue;
        for (size_t i = 0; i < self->bdf.ring.num_previous; i++)
            pressure += formula->predictor[i] * state_before(self, i + 1)->state.pressure[k];
        state->pressure[k] = fmax(pressure, 0);
    }
    state->rigid_approach = 0;
    for (size_t i = 0; i < self->bdf.ring.num_previous; i++)
        state->rigid_approach +=
            formula->predictor[i] * state_before(self, i + 1)->state.rigid_approach;
}

/* Transforms rho H of the previous states to the attempt's frame, and adds up these values for the
 * rows, weighted by the BDF formula. With transport along the path, the only entrainment in the
 * rows is the entrainment of the base, which is added here. */
static void carry_over(full_march *self, const contact_frame *frame) {
    const size_t num_inner = self->reference.grid.num_inner;
    const bdf_march *bdf = &self->bdf;

    memset(self->previous, 0, num_inner * sizeof(double));
    for (size_t i = 0; i < bdf->ring.num_previous; i++) {
        double *mass = bdf->masses.previous[i];
        previous_mass(mass, state_before(self, i + 1), frame, &self->carrier);
        for (size_t r = 0; r < num_inner; r++)
            self->previous[r] += bdf->formula.weight[i] * mass[r];
    }
    if (bdf_march_along_path(bdf) && previous_base(&self->carrier, frame))
        cblas_daxpy((int)num_inner, bdf->entrainment, self->entrained, 1, self->previous, 1);
}

/* Extends the marks on a line of nodes to `margin` nodes before each marked node, and to margin - 1
 * nodes behind it. In the array the nodes of the line are `stride` apart. */
static void dilate(bool *noisy, size_t count, size_t stride, size_t margin) {
    size_t since = margin, left = 0;

    // forwards from each mark, then backwards
    for (size_t k = 0; k < count; k++) {
        since = noisy[k * stride] ? 0 : since + 1;
        noisy[k * stride] = since < margin;
    }
    for (size_t k = count; k-- > 0;) {
        bool start = noisy[k * stride] && (k == 0 || !noisy[(k - 1) * stride]);
        if (!noisy[k * stride] && left > 0) {
            noisy[k * stride] = true;
            left--;
        }
        if (start) left = margin;
    }
}

/* Marks the nodes at or near which the attempt or one of its previous states has no pressure. Near
 * such nodes the film is not smooth in time on the scale of the grid. */
static void mark_noisy(void *solver) {
    full_march *self = solver;
    const full_state *state = &state_before(self, 0)->state;
    const bdf_masses *masses = &self->bdf.masses;
    const ehd_grid *grid = &self->reference.grid;
    size_t width = grid_width(grid), first = grid_first_line(grid) * width;
    size_t margin = (size_t)ceil(march_exit_margin / grid->step);

    for (size_t r = 0; r < grid->num_inner; r++) {
        size_t k = grid_node_of_row(grid, r);
        self->noisy[k] = !full_has_pressure(state, k);
        for (size_t i = 1; i <= self->bdf.ring.num_previous; i++)
            self->noisy[k] = self->noisy[k] || !full_has_pressure(&state_before(self, i)->state, k);
    }
    for (size_t l = 0; l < grid->inner_lines; l++)
        dilate(self->noisy + first + l * width + 1, grid->inner_x, 1, margin);
    for (size_t i = 1; grid->inner_lines > 1 && i <= grid->inner_x; i++)
        dilate(self->noisy + first + i, grid->inner_lines, width, margin);
    for (size_t r = 0; r < masses->num_rows; r++)
        masses->counts[r] = !self->noisy[masses->node[r]];
}

/* Returns rho H of a state at a node. */
static double mass_at(const full_state *state, const ehd_contact *contact, size_t k) {
    return state->film[k] *
           lubricant_density(&contact->lubricant, state->pressure[k] * contact->hertz_pressure);
}

/* Returns the local error at the node of row r, without the factor of the BDF formula. The error is
 * 0 near ruptured film. */
static double missed_mass(const full_march *self, size_t r) {
    return self->bdf.masses.counts[r] ? bdf_march_missed(&self->bdf, r) : 0;
}

/* Adds up the local errors that a film accumulates in the dry contact on its way from any place to
 * the centre. Returns the largest of these sums. The factor of the BDF formula (`error`) is left
 * out. If all time steps are like this one, the sum is the error of rho H at the centre.
 * - Errors are added along the grid lines, from the side of the inlet. Errors of opposite sign
 *   cancel. Thus errors that pass a node without staying in the film cancel too.
 * - Upstream of the dry contact the pressure determines the film. There, even fifty times larger
 *   errors do no harm.
 * - The film accumulates errors while it moves. For each half width of its path it takes
 *   1/|entrainment| units of T, of which at most one unit is counted.
 * - The sum is divided by the length of the time step. If the step is shorter than
 *   frame_shortest_step, the sum is divided by frame_shortest_step, because noise does not become
 *   smaller in shorter steps. */
static double error_on_the_way(void *solver) {
    full_march *self = solver;
    const ehd_grid *grid = &self->reference.grid;
    const double entrainment = self->bdf.entrainment;
    double largest = 0, sum = 0, lowest = 0, highest = 0, last = 0;
    bool inside = false;

    for (size_t i = 0; i < grid->num_inner; i++) {
        const size_t r = entrainment < 0 ? grid->num_inner - 1 - i : i;
        const size_t k = grid_node_of_row(grid, r);
        const bool before = inside && i % grid->inner_x > 0;
        inside = grid_is_dry(grid, k);
        if (!inside) continue;
        const double missed = missed_mass(self, r);
        if (!before) sum = lowest = highest = 0;
        if (before) sum += grid->step * (last + missed) / 2;
        last = missed;
        lowest = fmin(lowest, sum);
        highest = fmax(highest, sum);
        if (fabs(grid_x(grid, k)) <= grid->step)
            largest = fmax(largest, fmax(sum - lowest, highest - sum));
    }
    const contact_frame *frame = &state_before(self, 0)->frame;
    return largest / fmax(self->bdf.step, frame_shortest_step(frame, grid)) /
           fmax(fabs(entrainment), 1);
}

// ---- effects of the time steps on the films

/* Sets `errors` to the errors of the last accepted film, plus the change of this film that the
 * filter causes in this time step. */
static void add_filter_errors(double *errors, full_march *self) {
    const previous_state *last = state_before(self, 1);
    const size_t num_nodes = self->reference.grid.num_nodes;
    ehd_contact contact;

    frame_contact(&contact, &last->frame, &self->reference);
    memcpy(errors, self->kept, num_nodes * sizeof *errors);
    for (size_t k = 0; k < num_nodes; k++)
        if (last->filtered[k] != 0 && grid_is_dry(&contact.grid, k))
            errors[k] += march_error_growth * last->filtered[k] / last->state.film[k] *
                         mass_at(&last->state, &contact, k);
}

/* Computes the errors that the attempt's film has accumulated. They are the errors of the last
 * accepted film, carried along with the fluid, plus the local errors of this step. A film keeps the
 * errors that arise in the dry contact upstream of the centre. Upstream of the dry contact, and
 * around spike and constriction, the pressure determines the film anew. If errors from these places
 * were added, the estimated effect on the minimum film of M = 20, L = 5 would be 18 % instead of
 * 1.9 %. The local errors are multiplied by the rate of the BDF formula times the step. With equal
 * time steps this factor is 3/2, by which BDF2 enlarges errors that each step adds. */
static void take_up_errors(full_march *self, const contact_frame *frame) {
    const ehd_grid *grid = &self->reference.grid;
    const bdf_formula *formula = &self->bdf.formula;
    double *carried = self->film;

    add_filter_errors(self->taken_up, self);
    previous_errors(carried, self->taken_up, &state_before(self, 1)->frame, frame, &self->carrier);
    memset(self->taken_up, 0, grid->num_nodes * sizeof(double));
    for (size_t r = 0; r < grid->num_inner; r++) {
        const size_t k = grid_node_of_row(grid, r);
        if (!grid_is_dry(grid, k)) continue;
        self->taken_up[k] = carried[r];
        if (formula->error > 0 && grid_x(grid, k) * frame->speed <= 0)
            self->taken_up[k] +=
                formula->rate * self->bdf.step * formula->error * missed_mass(self, r);
    }
}

/* Returns the largest accumulated error upstream of the centre, relative to rho H at its node. */
static double largest_taken_up(const full_march *self, const full_state *state,
                               const ehd_contact *contact, double entrainment) {
    double largest = 0;

    for (size_t k = 0; k < contact->grid.num_nodes; k++)
        if (self->taken_up[k] != 0 && grid_x(&contact->grid, k) * entrainment <= 0)
            largest = fmax(largest, fabs(self->taken_up[k] / mass_at(state, contact, k)));
    return largest;
}

/* Estimates the relative changes of the films in the limit of small time steps. For this, subtracts
 * the accumulated errors from the film. */
static void set_effects(march_step *outcome, const full_march *self, const full_state *state,
                        const ehd_contact *contact) {
    const size_t num_nodes = contact->grid.num_nodes;
    full_state better = *state;

    better.film = self->film;
    for (size_t k = 0; k < num_nodes; k++)
        better.film[k] = state->film[k] * (1 - self->taken_up[k] / mass_at(state, contact, k));
    const contact_scalars scalars = full_evaluate_scalars(&better, contact);
    outcome->effect = scalars.central_film_thickness / outcome->scalars.central_film_thickness - 1;
    outcome->effect_minimum =
        scalars.minimum_film_thickness / outcome->scalars.minimum_film_thickness - 1;
}

/* Checks whether the downstream end of the grid cuts off a pressure with a gradient above
 * MAX_END_GRADIENT. The pressure of a squeezed film may reach the end, but is small there. */
static bool is_cut(const full_state *state, const ehd_grid *grid, bool backwards) {
    for (size_t r = backwards ? 0 : grid->inner_x - 1; r < grid->num_inner; r += grid->inner_x)
        if (state->pressure[grid_node_of_row(grid, r)] > MAX_END_GRADIENT * grid->step) return true;
    return false;
}

/* Returns the fraction of the load that the domain's end cuts off from a second pressure zone. */
static double cut_load(full_march *self, bool backwards) {
    const ehd_grid *grid = &self->reference.grid;
    const double end = backwards ? -grid->x_min : grid_x(grid, grid->inner_x);

    // in the first step after the start or a jump, the rates between the frames include the jump
    if (self->bdf.ring.num_previous < 2) return 0;
    return frame_closing_gap(&state_before(self, 0)->frame, &state_before(self, 1)->frame,
                             &self->reference, end)
        .beyond;
}

/* Lists the exits of the state just solved. With transport along the path, the exit farthest
 * downstream at Y = 0 becomes the exit position of the scalars. */
static void list_exits(march_step *outcome, full_march *self, const ehd_contact *contact,
                       bool backwards) {
    const reynolds_squeeze squeeze = {self->bdf.formula.rate, self->previous};
    const full_state *state = &state_before(self, 0)->state;
    const ehd_grid *grid = &contact->grid;

    if (grid->inner_lines > 1)
        full_list_exits(self->exits, state, grid, backwards);
    else
        full_place_exits(self->exits, state, self->solver, contact, &squeeze, backwards);
    const double farthest = self->exits[grid_whole(grid).inner_lines / 2 * GRID_EXITS];
    if (bdf_march_along_path(&self->bdf) && !isnan(farthest))
        outcome->scalars.exit_position = farthest;
}

static void place_surface(full_march *self, const contact_frame *frame) {
    if (!self->surface) return;
    surface_heights(self->surface, self->reference.surface, frame, &self->reference.grid);
    full_solver_set_surface(self->solver, self->surface);
}

/* Returns why a solution cannot be trusted, or NULL if it can be trusted. */
static const char *why_not_to_trust(full_march *self, const full_state *state,
                                    const ehd_contact *contact, bool backwards) {
    const ehd_grid *grid = &contact->grid;

    if (is_cut(state, grid, backwards))
        return backwards ? "the exit boundary outside the domain (grid.x_min)"
                         : "the exit boundary outside the domain (grid.x_max)";
    if (cut_load(self, backwards) > default_accuracy)
        return backwards ? "a second zone of pressure behind the exit that the domain cuts off "
                           "(grid.x_min)"
                         : "a second zone of pressure behind the exit that the domain cuts off "
                           "(grid.x_max)";
    if (full_film_closes(state, grid)) return "a film that closes between nodes (grid.step)";
    return full_flow_doubt(state, contact) > default_accuracy ? flow_doubt_reason : NULL;
}

static ehd_status solve(march_step *outcome, void *solver, const ehd_contact *contact,
                        ehd_error *error) {
    full_march *self = solver;
    previous_state *next = state_before(self, 0);
    const full_state *state = &next->state;
    const bdf_masses *masses = &self->bdf.masses;
    const reynolds_squeeze squeeze = {self->bdf.formula.rate, self->previous};
    full_info info;

    carry_over(self, &next->frame);
    place_surface(self, &next->frame);
    predict(self);
    ehd_status status = full_solve(&info, &next->state, self->solver, contact, &squeeze, error);
    if (status) return status;
    solve_seconds_add(&self->bdf.seconds, &info.seconds);
    outcome->status = info.status;
    outcome->reason = info.reason;
    outcome->scalars = full_evaluate_scalars(state, contact);
    outcome->iterations = info.newton_iterations;
    outcome->residual = info.residual;
    if (info.status) return EHD_OK;
    if (full_beyond_law(state, contact)) {
        outcome->status = EHD_NOT_CONVERGED;
        outcome->reason = "a pressure beyond the viscosity law's limit";
    }
    for (size_t r = 0; r < masses->num_rows; r++)
        masses->solved[r] = mass_at(state, contact, masses->node[r]);
    return EHD_OK;
}

static void assess(march_step *outcome, void *solver, const ehd_contact *contact) {
    full_march *self = solver;
    const previous_state *next = state_before(self, 0);
    const bool backwards = self->bdf.entrainment < 0;

    list_exits(outcome, self, contact, backwards);
    take_up_errors(self, &next->frame);
    outcome->taken_up = largest_taken_up(self, &next->state, contact, self->bdf.entrainment);
    set_effects(outcome, self, &next->state, contact);
    march_distrust(outcome, why_not_to_trust(self, &next->state, contact, backwards));
    judge_inlet(outcome, contact, backwards);
}

static void accept(void *solver) {
    full_march *self = solver;

    previous_watch_base(&self->carrier, &state_before(self, 0)->frame);
}

static void keep_errors(void *solver) {
    full_march *self = solver;

    memcpy(self->kept, self->taken_up, self->reference.grid.num_nodes * sizeof *self->kept);
}

static void copy(void *solver, size_t target, size_t source) {
    full_march *self = solver;

    full_state_copy(&self->states[target].state, &self->states[source].state,
                    &self->reference.grid);
}

static void prepare(void *solver, size_t place, double share) {
    full_march *self = solver;

    previous_prepare(&self->states[place], share, &self->carrier);
}

/* Finds approach and load at which the bodies touch (march.h). Halves the load as long as the
 * stationary solution can be trusted and M is at least MIN_MOES_M, and returns the last load with a
 * trusted solution. If even the first solution is not trusted, returns the first load, provided
 * that it has a solution. */
static ehd_status touching(double *approach, double *load, void *solver, const contact_frame *frame,
                           ehd_error *error) {
    full_march *self = solver;
    previous_state *scratch = state_before(self, 0);
    contact_frame light = *frame;
    char reason[JUDGE_REASON]; // not self->reason, to which the reason of an outcome may point
    full_info info;

    *approach = *load = NAN;
    light.speed = fabs(frame->speed);
    place_start_surface(self, frame, 0);
    while (true) {
        ehd_contact contact;
        frame_contact(&contact, &light, &self->reference);
        if (contact.moes_M < MIN_MOES_M && !isnan(*load)) return EHD_OK;
        const ehd_status status = start_with_load(&info, self, &light, error);
        if (status) return status;
        solve_seconds_add(&self->bdf.seconds, &info.seconds);
        const bool trusted = !info.status && !full_judge(reason, &info, &scratch->state, &contact);
        if (info.status || (!trusted && !isnan(*load))) return EHD_OK;
        *approach = reference_approach(self, &scratch->state, &light);
        *load = light.load;
        if (!trusted) return EHD_OK;
        light = frame_of_load(self->reference.kind, &light, 0.5);
    }
}

const full_state *full_march_state(const full_march *self, const contact_frame **frame) {
    const previous_state *last = &self->states[bdf_march_accepted(&self->bdf, 1)];

    if (frame) *frame = &last->frame;
    return &last->state;
}

// ---- states from and to another model

/* Copies a state, without its frame, to `given`. `given->exits` may be NULL. */
static void give(handed_state *given, const void *solver, size_t place) {
    const full_march *self = solver;
    const full_state *state = &self->states[place].state;
    const ehd_grid *grid = &self->reference.grid;

    memcpy(given->pressure, state->pressure, grid->num_nodes * sizeof(double));
    memcpy(given->film, state->film, grid->num_nodes * sizeof(double));
    given->rigid_approach = state->rigid_approach;
    if (!given->exits) return;
    if (grid->inner_lines > 1)
        grid_exit_columns(given->exits, state->pressure, grid);
    else
        given->exits[0] = state->exit;
}

static ehd_status take(void *solver, size_t place, const handed_state *given, ehd_error *error) {
    full_march *self = solver;
    full_state *state = &self->states[place].state;
    const ehd_grid *grid = &self->reference.grid;
    (void)error;

    memcpy(state->pressure, given->pressure, grid->num_nodes * sizeof(double));
    memcpy(state->film, given->film, grid->num_nodes * sizeof(double));
    state->rigid_approach = given->rigid_approach;
    full_state_set_zone(state, grid, given->exits[grid_central_line(grid) / grid_width(grid)]);
    return EHD_OK;
}

/* Interpolates the accumulated errors from the nodes to places on the central line. */
static void give_errors(double errors[NUM_ERROR_PLACES], const void *solver) {
    const full_march *self = solver;
    const ehd_grid *grid = &self->reference.grid;
    const double *line = self->kept + grid_central_line(grid);

    for (size_t i = 0; i < NUM_ERROR_PLACES; i++) {
        const double x = film_errors_place(i);
        const double column =
            fmin(fmax((x - grid_x(grid, 0)) / grid->step, 0), (double)grid_width(grid) - 1.5);
        const size_t c = (size_t)column;
        errors[i] = line[c] + (column - (double)c) * (line[c + 1] - line[c]);
    }
}

/* Interpolates errors from places on the central line to the nodes of the dry contact. */
static void take_errors(void *solver, const double errors[NUM_ERROR_PLACES],
                        const contact_frame *load_frame) {
    full_march *self = solver;
    const ehd_grid *grid = &self->reference.grid;
    film_errors taken = {.kept = {0}};
    (void)load_frame;

    memcpy(taken.next, errors, sizeof taken.next);
    for (size_t k = 0; k < grid->num_nodes; k++)
        self->kept[k] = grid_is_dry(grid, k) ? film_errors_at(&taken, grid_x(grid, k)) : 0;
}

static contact_frame load_frame(const void *solver, size_t place) {
    const full_march *self = solver;
    const previous_state *of = &self->states[place];
    ehd_contact contact;

    if (isnan(of->frame.approach)) return of->frame;
    frame_contact(&contact, &of->frame, &self->reference);
    return frame_of_load(self->reference.kind, &of->frame,
                         full_evaluate_scalars(&of->state, &contact).load);
}

bdf_march *full_march_steps(full_march *self) {
    return &self->bdf;
}

// ---- saving

static const double RUPTURED = -1; // is saved as the pressure of a ruptured node; no pressure is
                                   // that low
static const double NEVER = -1;    // is saved in place of base_until = INFINITY

/* Saves rigid approach, exit, pressure and film, in this order. */
static void save(double *target, const void *solver, size_t place) {
    const full_march *self = solver;
    const full_state *state = &self->states[place].state;
    const size_t num_nodes = self->reference.grid.num_nodes;

    target[0] = state->rigid_approach;
    target[1] = (double)state->exit;
    target += NUM_STATE_SCALARS;
    for (size_t k = 0; k < num_nodes; k++)
        target[k] = state->ruptured[k] ? RUPTURED : state->pressure[k];
    memcpy(target + num_nodes, state->film, num_nodes * sizeof(double));
}

static ehd_status restore(void *solver, size_t place, const double *source, ehd_error *error) {
    full_march *self = solver;
    full_state *state = &self->states[place].state;
    const size_t num_nodes = self->reference.grid.num_nodes;

    if (!(source[1] > 1 && source[1] < (double)num_nodes))
        return ehd_fail(error, EHD_DATA,
                        "saved state: found the exit at node %g, expected it on the grid",
                        source[1]);
    state->rigid_approach = source[0];
    state->exit = (size_t)source[1];
    source += NUM_STATE_SCALARS;
    for (size_t k = 0; k < num_nodes; k++) {
        state->ruptured[k] = source[k] == RUPTURED;
        state->pressure[k] = state->ruptured[k] ? 0 : source[k];
    }
    memcpy(state->film, source + num_nodes, num_nodes * sizeof(double));
    return EHD_OK;
}

/* Saves the accumulated errors. With transport along the path, the time up to which the base is
 * used comes first. */
static void save_rest(double *front, double *behind, const void *solver) {
    const full_march *self = solver;
    const double until = self->carrier.base_until;
    (void)behind;

    if (bdf_march_along_path(&self->bdf)) *front++ = isinf(until) ? NEVER : until;
    memcpy(front, self->kept, self->reference.grid.num_nodes * sizeof *front);
}

static ehd_status restore_rest(void *solver, const double *front, const double *behind,
                               ehd_error *error) {
    full_march *self = solver;
    (void)behind, (void)error;

    if (bdf_march_along_path(&self->bdf)) {
        self->carrier.base_until = *front == NEVER ? INFINITY : *front;
        front++;
    }
    memcpy(self->kept, front, self->reference.grid.num_nodes * sizeof *front);
    return EHD_OK;
}

static void exits(double *positions, const void *solver) {
    const full_march *self = solver;

    memcpy(positions, self->exits,
           grid_whole(&self->reference.grid).inner_lines * GRID_EXITS * sizeof *positions);
}

static const bdf_model model = {.reverses = true,
                                .start = start,
                                .solve = solve,
                                .mark = mark_noisy,
                                .error_on_the_way = error_on_the_way,
                                .assess = assess,
                                .accept = accept,
                                .keep_errors = keep_errors,
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
                                .exits = exits};

march_solver full_march_solver(full_march *self) {
    return bdf_march_solver(&self->bdf);
}
