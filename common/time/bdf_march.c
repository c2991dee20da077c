/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/bdf_march.h"

#include "common/time/saved_ring.h"

#include <math.h>
#include <string.h>

void bdf_march_init(bdf_march *self, size_t num_rows, arena *memory) {
    bdf_masses *masses = &self->masses;

    self->ring = bdf_ring_empty();
    masses->num_rows = num_rows;
    masses->solved = arena_array(memory, num_rows, sizeof(double));
    for (size_t i = 0; i < BDF_PREVIOUS; i++)
        masses->previous[i] = arena_array(memory, num_rows, sizeof(double));
    masses->counts = arena_array(memory, num_rows, sizeof *masses->counts);
}

bool bdf_march_along_path(const bdf_march *self) {
    return self->reference->transport == TRANSPORT_PATH;
}

size_t bdf_march_place(const bdf_march *self, size_t steps) {
    return self->ring.place[steps];
}

size_t bdf_march_accepted(const bdf_march *self, size_t steps) {
    return bdf_ring_accepted(&self->ring, steps);
}

void bdf_march_contact(ehd_contact *contact, double *entrainment, const contact_frame *frame,
                       const bdf_march *self) {
    frame_contact(contact, frame, self->reference);
    *entrainment = contact->entrainment;
    if (bdf_march_along_path(self)) contact->entrainment = 0;
}

static void prepare(bdf_march *self, size_t place, double share) {
    self->share[place] = share;
    self->model->prepare(self, place, share);
}

// ---- local error

double bdf_march_missed(const bdf_march *self, size_t r) {
    double mass = self->masses.solved[r];

    for (size_t i = 0; i < self->ring.num_previous; i++)
        mass -= self->formula.predictor[i] * self->masses.previous[i][r];
    return mass;
}

/* Checks, along the path, whether the iteration has found another solution: the film before the
 * centre misses its prediction by more than march_most_missed. Local errors of the inlet do not
 * count along the path, so they do not reveal it. Such a solution is ruptured in the inlet, where a
 * narrow peak of pressure travels. After a load step by a half it misses 0.2 of the central film
 * and more. In the paper's transient case no step misses more than 0.014. With a load of +-50 %
 * one step in a hundred misses 0.1 and is repeated with a quarter of its length, which only costs
 * steps. At rest there is no inlet. */
static bool is_another_solution(const bdf_march *self, double central_film) {
    const double most = march_most_missed * central_film;
    const double direction = self->model->reverses ? self->entrainment : 1;
    const bdf_masses *masses = &self->masses;

    for (size_t r = 0; r < masses->num_rows && self->formula.degree > 0; r++)
        if (grid_x(&self->reference->grid, masses->node[r]) * direction < 0 &&
            self->formula.error * fabs(bdf_march_missed(self, r)) > most)
            return true;
    return false;
}

static double largest_error(const bdf_march *self) {
    double largest = 0;

    for (size_t r = 0; r < self->masses.num_rows; r++)
        if (self->masses.counts[r]) largest = fmax(largest, fabs(bdf_march_missed(self, r)));
    return largest;
}

/* Returns the local error relative to the central film, as step control uses it (march.h). */
static double local_error(bdf_march *self, double central_film) {
    const bool on_the_way =
        bdf_march_along_path(self) && self->step * fabs(self->entrainment) <= march_short_path;

    if (!(self->formula.error > 0)) return 0;
    self->model->mark(self);
    return self->formula.error *
           (on_the_way ? self->model->error_on_the_way(self) : largest_error(self)) / central_film;
}

// ---- steps

/* Undoes the promotion of the last attempt. */
static void forget_attempt(bdf_march *self) {
    if (self->promoted) self->ring = self->accepted;
    self->promoted = false;
}

/* Applies this step's share of the filter to the accepted states. */
static void filter_previous(bdf_march *self) {
    if (!bdf_march_along_path(self)) return;
    const contact_frame *last = self->frame[bdf_march_place(self, 1)];
    const double share = frame_step_share(last, self->step, &self->reference->grid);

    for (size_t i = 1; i <= self->ring.num_previous; i++)
        if (self->share[bdf_march_place(self, i)] != share)
            prepare(self, bdf_march_place(self, i), share);
}

static ehd_status attempt_from(march_step *outcome, bdf_march *self, const contact_frame *frame,
                               double from_last, ehd_error *error) {
    const bdf_ring *ring = &self->ring;
    ehd_contact contact;

    // after a passing state the formula's step begins at the state before it
    self->step = ring->passing ? frame->time - ring->time[bdf_march_place(self, 1)] : from_last;
    self->formula = bdf_ring_formula(ring, self->step);
    *self->frame[bdf_march_place(self, 0)] = *frame;
    bdf_march_contact(&contact, &self->entrainment, frame, self);
    filter_previous(self);
    *outcome = (march_step){.effect = NAN,
                            .effect_minimum = NAN,
                            .indicated = NAN,
                            .indicated_minimum = NAN,
                            .formula = self->formula,
                            .frame = *frame};
    const ehd_status status = self->model->solve(outcome, self, &contact, error);
    if (status || outcome->status == EHD_NOT_CONVERGED) return status;

    const double central_film = outcome->scalars.central_film_thickness;
    if (bdf_march_along_path(self) && is_another_solution(self, central_film)) {
        outcome->status = EHD_NOT_CONVERGED;
        outcome->reason = "a film far from its prediction";
        return EHD_OK;
    }
    outcome->local_error = from_last / self->step * local_error(self, central_film);
    self->model->assess(outcome, self, &contact);
    return EHD_OK;
}

/* Attempts a step. If a step from the state before a passing one does not converge, repeats it from
 * the passing one. The errors that films have taken up until then, along at most one step of the
 * grid, are not counted. */
static ehd_status attempt(march_step *outcome, void *solver, const contact_frame *frame,
                          double step, ehd_error *error) {
    bdf_march *self = solver;

    forget_attempt(self);
    const ehd_status status = attempt_from(outcome, self, frame, step, error);
    if (status || outcome->status != EHD_NOT_CONVERGED || !self->ring.passing) return status;
    self->accepted = self->ring;
    self->promoted = true;
    bdf_ring_promote(&self->ring);
    return attempt_from(outcome, self, frame, step, error);
}

/* Returns the least time between the states that steps begin at (README.md, Steps of another
 * integrator). */
static double least_interval(const bdf_march *self, const contact_frame *frame) {
    const double least = 0.5; // steps of the grid

    return self->allows_short && bdf_march_along_path(self)
               ? least * frame_grid_step(frame, &self->reference->grid)
               : 0;
}

static void accept(void *solver) {
    bdf_march *self = solver;
    const size_t place = bdf_march_place(self, 0);
    const contact_frame *frame = self->frame[place];

    self->model->accept(self);
    prepare(self, place, 1);
    self->promoted = false;
    bdf_ring_accept(&self->ring, frame->time, least_interval(self, frame));
    if (!self->ring.passing) self->model->keep_errors(self);
}

static void restart(void *solver) {
    bdf_march *self = solver;

    forget_attempt(self);
    bdf_ring_restart(&self->ring);
    if (self->model->restart) self->model->restart(self);
}

static ehd_status start(march_step *outcome, void *solver, const contact_frame *frame,
                        ehd_error *error) {
    bdf_march *self = solver;
    const size_t first = bdf_march_place(self, 0);

    self->promoted = false;
    bdf_ring_keep(&self->ring, 0);
    self->formula.rate = 0;
    ehd_status status = self->model->start(outcome, self, frame, error);
    if (!status && bdf_march_along_path(self)) {
        *self->frame[BDF_BASE] = *self->frame[first];
        self->model->copy(self, BDF_BASE, first);
        status = self->model->use_base(self, error);
    }
    if (!status) accept(self);
    return status;
}

// ---- from one model to another

static void allocate(handed_state *self, const ehd_grid *grid, arena *memory) {
    self->pressure = arena_array(memory, grid->num_nodes, sizeof(double));
    self->film = arena_array(memory, grid->num_nodes, sizeof(double));
    self->exits = arena_array(memory, grid_lines(grid), sizeof *self->exits);
}

ehd_status hand_over_init(hand_over *self, const ehd_grid *grid, ehd_error *error) {
    *self = (hand_over){.change = {0}};
    allocate(&self->given, grid, &self->memory);
    allocate(&self->taken, grid, &self->memory);
    if (!self->memory.failed) return EHD_OK;
    hand_over_free(self);
    return ehd_no_memory(error, "states on the grid");
}

void hand_over_free(hand_over *self) {
    arena_free(&self->memory);
}

void bdf_march_give(handed_state *given, const bdf_march *self, size_t place) {
    given->frame = *self->frame[place];
    self->model->give(given, self, place);
}

static ehd_status take(bdf_march *self, size_t place, const handed_state *given, ehd_error *error) {
    *self->frame[place] = given->frame;
    return self->model->take(self, place, given, error);
}

static ehd_status take_base(bdf_march *self, const bdf_march *from, handed_state *given,
                            ehd_error *error) {
    bdf_march_give(given, from, BDF_BASE);
    const ehd_status status = take(self, BDF_BASE, given, error);
    return status ? status : self->model->use_base(self, error);
}

/* Finds the change of the last accepted film, which this model may represent less exactly. */
static void find_change(bdf_march *self, const bdf_march *from, hand_over *work) {
    const ehd_grid *grid = &self->reference->grid;
    const size_t line = grid_central_line(grid) / grid_width(grid);

    bdf_march_give(&work->given, from, bdf_march_accepted(from, 1));
    bdf_march_give(&work->taken, self, bdf_march_accepted(self, 1));
    film_errors_between(work->change, work->taken.film, work->given.film, grid,
                        work->given.exits[line]);
}

ehd_status bdf_march_take_over(bdf_march *self, const bdf_march *from, bool has_base,
                               hand_over *work, ehd_error *error) {
    const bool path = bdf_march_along_path(self);
    double errors[NUM_ERROR_PLACES] = {0};
    ehd_status status = path && !has_base ? take_base(self, from, &work->given, error) : EHD_OK;

    self->promoted = false;
    for (size_t i = 1; i <= from->ring.num_previous && !status; i++) {
        const size_t place = bdf_march_place(self, i);
        bdf_march_give(&work->given, from, bdf_march_accepted(from, i));
        status = take(self, place, &work->given, error);
        if (status) return status;
        prepare(self, place, 1);
        self->ring.time[place] = work->given.frame.time;
        bdf_ring_keep(&self->ring, i);
    }
    if (status) return status;
    const contact_frame load_frame = from->model->load_frame(from, bdf_march_accepted(from, 1));
    if (path) from->model->give_errors(errors, from);
    self->model->take_errors(self, errors, &load_frame);
    find_change(self, from, work);
    return EHD_OK;
}

// ---- saving: along the path the base, then the numbers in front, the ring, and those behind it

static void save_state(double *target, contact_frame *frame, const void *solver, size_t place) {
    const bdf_march *self = solver;

    *frame = *self->frame[place];
    self->model->save(target, self, place);
}

static ehd_status restore_state(void *solver, size_t place, const contact_frame *frame,
                                const double *source, ehd_error *error) {
    bdf_march *self = solver;
    const ehd_status status = self->model->restore(self, place, source, error);

    if (status) return status;
    *self->frame[place] = *frame;
    prepare(self, place, 1);
    return EHD_OK;
}

static saved_states saved_states_of(const bdf_march *self) {
    return (saved_states){.num_states = self->model->passes ? BDF_STATES - 1 : BDF_PREVIOUS,
                          .size = self->state_size,
                          .save = save_state,
                          .restore = restore_state};
}

static size_t saved_base_size(const bdf_march *self) {
    return bdf_march_along_path(self) ? NUM_FRAME + self->state_size : 0;
}

static size_t saved_size(const void *solver) {
    const bdf_march *self = solver;
    const saved_states states = saved_states_of(self);

    return saved_base_size(self) + self->front_size + ring_saved_size(&states) + self->behind_size;
}

static void save(double *saved, const void *solver) {
    const bdf_march *self = solver;
    const saved_states states = saved_states_of(self);
    double *front = saved + saved_base_size(self), *ring = front + self->front_size;
    contact_frame frame;

    memset(saved, 0, saved_size(self) * sizeof *saved);
    if (front > saved) {
        save_state(saved + NUM_FRAME, &frame, self, BDF_BASE);
        memcpy(saved, &frame, sizeof frame);
    }
    ring_save(ring, self->promoted ? &self->accepted : &self->ring, &states, self);
    self->model->save_rest(front, ring + ring_saved_size(&states), self);
}

static ehd_status restore_base(bdf_march *self, const double *saved, ehd_error *error) {
    contact_frame frame;

    if (!bdf_march_along_path(self)) return EHD_OK;
    ehd_status status = saved_frame(&frame, saved, self->state_size, error);
    if (!status) status = self->model->restore(self, BDF_BASE, saved + NUM_FRAME, error);
    if (status) return status;
    *self->frame[BDF_BASE] = frame;
    return self->model->use_base(self, error);
}

static ehd_status check_front(const double *front, size_t size, ehd_error *error) {
    for (size_t i = 0; i < size; i++)
        if (!isfinite(front[i]))
            return ehd_fail(error, EHD_DATA, "saved state: found %g, expected finite values",
                            front[i]);
    return EHD_OK;
}

static ehd_status restore(void *solver, const double *saved, ehd_error *error) {
    bdf_march *self = solver;
    const saved_states states = saved_states_of(self);
    const double *front = saved + saved_base_size(self), *ring = front + self->front_size;
    ehd_status status = restore_base(self, saved, error);

    forget_attempt(self);
    if (!status) status = check_front(front, self->front_size, error);
    if (!status)
        status = self->model->restore_rest(self, front, ring + ring_saved_size(&states), error);
    return status ? status : ring_restore(&self->ring, self, ring, &states, error);
}

// ---- as a solver

static ehd_status fields(double *pressure, double *film, void *solver, ehd_error *error) {
    const bdf_march *self = solver;
    handed_state given = {.pressure = pressure, .film = film};
    (void)error;

    self->model->give(&given, self, bdf_march_accepted(self, 1));
    return EHD_OK;
}

march_solver bdf_march_solver(bdf_march *self) {
    const bdf_model *model = self->model;

    return (march_solver){.self = self,
                          .attempt = attempt,
                          .accept = accept,
                          .restart = restart,
                          .start = start,
                          .touching = model->touching,
                          .saved_size = saved_size,
                          .save = save,
                          .restore = restore,
                          .fields = fields,
                          .exits = model->exits,
                          .traction = model->traction};
}
