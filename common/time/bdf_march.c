/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/time/bdf_march.h"

#include <math.h>
#include <string.h>

const double march_exit_margin = 0.1;
const double march_error_growth = 1.5;

/* Longest path of the fluid in a step, in half widths, for which the error of a step is the error
 * that a film accumulates on its way to the centre. With such short steps a film takes many steps
 * to reach the centre, and accumulates the error of each step. In a longer step the film reaches
 * the centre within this step, so that only the local error of this step matters. After a slow
 * ramp of the load by 8 % the error is 0.14 %, at a tolerance of 0.15 %. Without the distinction
 * between short and longer steps the error was 1.7 % (test_full_march.c,
 * a_slow_ramp_along_the_path_ends_at_rest). */
static const double SHORT_PATH = 0.25;

/* Largest local error of the film anywhere upstream of the centre, relative to the central film.
 * With transport along the path a step with a larger error is repeated, because the iteration has
 * then found another solution: the film ruptures in the inlet, and a narrow peak of pressure
 * travels there. After a jump of the load by a half, such solutions have errors of 0.2 and more. In
 * the paper's transient case no error exceeds 0.014 (test_path_march.c,
 * a_film_far_from_its_prediction_is_not_taken). With a load that varies by +-50 %, one time step in
 * a hundred has an error of 0.1, and is repeated with a quarter of its length. */
static const double MOST_MISSED = 0.05;

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

/* With transport along the path, checks whether the film upstream of the centre differs from its
 * prediction by more than MOST_MISSED. The local error does not show such a difference, because
 * with this transport it leaves out the inlet. Without entrainment there is no inlet to check. */
static bool is_another_solution(const bdf_march *self, double central_film) {
    const double most = MOST_MISSED * central_film;
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

/* Returns the local error for step control (march.h), relative to the central film. */
static double local_error(bdf_march *self, double central_film) {
    const bool on_the_way =
        bdf_march_along_path(self) && self->step * fabs(self->entrainment) <= SHORT_PATH;

    if (!(self->formula.error > 0)) return 0;
    self->model->mark(self);
    return self->formula.error *
           (on_the_way ? self->model->error_on_the_way(self) : largest_error(self)) / central_film;
}

// ---- steps

/* Restores the ring of accepted states if the last attempt began at a passing state (README.md,
 * Steps of another integrator). */
static void forget_attempt(bdf_march *self) {
    if (self->promoted) self->ring = self->accepted;
    self->promoted = false;
}

/* Filters the previous states anew if this step needs another fraction of the filter's effect
 * (frame_step_share) than the fraction that was applied to them. */
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

    // A passing state (bdf_ring) is left out: the step of the formula begins at the state before
    // the passing one.
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

/* Attempts a step. If the last state is passing (bdf_ring), the step begins at the state before it.
 * If this step does not converge, repeats the attempt with a step that begins at the passing state.
 * The errors that films accumulated up to the passing state, along at most one grid step, are then
 * neglected. */
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

/* Returns the least time between two states at which steps begin (README.md, Steps of another
 * integrator). */
static double least_interval(const bdf_march *self, const contact_frame *frame) {
    // least path of the fluid between two such states, in grid steps (README.md, BDF2;
    // test_online_transient.c, steps_may_have_any_lengths)
    const double least = 0.5;

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

/* Takes the accepted state of the other march that lies `steps` steps before its attempt. */
static ehd_status take_state(bdf_march *self, const bdf_march *from, size_t steps, hand_over *work,
                             ehd_error *error) {
    const size_t place = bdf_march_place(self, steps);

    bdf_march_give(&work->given, from, bdf_march_accepted(from, steps));
    const ehd_status status = take(self, place, &work->given, error);
    if (status) return status;
    prepare(self, place, 1);
    self->ring.time[place] = work->given.frame.time;
    bdf_ring_keep(&self->ring, steps);
    return EHD_OK;
}

/* Computes the difference between the last accepted films of both marches. The model of `self` may
 * represent the film less accurately than the other model. */
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
    for (size_t i = 1; i <= from->ring.num_previous && !status; i++)
        status = take_state(self, from, i, work, error);
    if (status) return status;
    const contact_frame load_frame = from->model->load_frame(from, bdf_march_accepted(from, 1));
    if (path) from->model->give_errors(errors, from);
    self->model->take_errors(self, errors, &load_frame);
    find_change(self, from, work);
    return EHD_OK;
}

// ---- saving, in this order: base (along the path), numbers in front, states, numbers behind

enum { NUM_PREVIOUS, IS_PASSING, NUM_HEAD };

static size_t entry_size(const bdf_march *self) {
    return NUM_FRAME + self->state_size;
}

static size_t base_size(const bdf_march *self) {
    return bdf_march_along_path(self) ? entry_size(self) : 0;
}

static size_t ring_size(const bdf_march *self) {
    return NUM_HEAD + (BDF_PREVIOUS + (size_t)self->model->passes) * entry_size(self);
}

static size_t saved_size(const void *solver) {
    const bdf_march *self = solver;

    return base_size(self) + self->front_size + ring_size(self) + self->behind_size;
}

/* Returns the number of saved states: the previous states, and the passing state if there is one. A
 * ring with a passing state always has BDF_PREVIOUS previous states. */
static size_t num_saved(const bdf_ring *ring) {
    return ring->num_previous + (ring->passing ? 1 : 0);
}

static void save_state(double *saved, const bdf_march *self, size_t place) {
    memcpy(saved, self->frame[place], sizeof *self->frame[place]);
    self->model->save(saved + NUM_FRAME, self, place);
}

static void save(double *saved, const void *solver) {
    const bdf_march *self = solver;
    const bdf_ring *ring = self->promoted ? &self->accepted : &self->ring;
    double *front = saved + base_size(self), *head = front + self->front_size;

    memset(saved, 0, saved_size(self) * sizeof *saved);
    if (bdf_march_along_path(self)) save_state(saved, self, BDF_BASE);
    head[NUM_PREVIOUS] = (double)ring->num_previous;
    head[IS_PASSING] = ring->passing ? 1 : 0;
    for (size_t i = 0; i < num_saved(ring); i++)
        save_state(head + NUM_HEAD + i * entry_size(self), self, ring->place[i + 1]);
    self->model->save_rest(front, head + ring_size(self), self);
}

static ehd_status check_finite(const double *saved, size_t size, ehd_error *error) {
    for (size_t i = 0; i < size; i++)
        if (!isfinite(saved[i]))
            return ehd_fail(error, EHD_DATA, "saved state: found %g, expected finite values",
                            saved[i]);
    return EHD_OK;
}

static ehd_status restore_state(bdf_march *self, size_t place, const double *saved,
                                ehd_error *error) {
    contact_frame frame;

    memcpy(&frame, saved, sizeof frame);
    if (!frame_is_valid(&frame))
        return ehd_fail(error, EHD_DATA,
                        "saved state: found a frame of half width %g, expected a contact's",
                        frame.half_width);
    *self->frame[place] = frame;
    const ehd_status status = check_finite(saved + NUM_FRAME, self->state_size, error);
    return status ? status : self->model->restore(self, place, saved + NUM_FRAME, error);
}

static ehd_status check_head(const double *head, const bdf_march *self, ehd_error *error) {
    const double count = head[NUM_PREVIOUS], passing = head[IS_PASSING];
    const bool may_pass = self->model->passes && count == BDF_PREVIOUS;

    if (!(isgreaterequal(count, 1) && count <= BDF_PREVIOUS && count == floor(count)))
        return ehd_fail(error, EHD_DATA, "saved state: found %g previous states, expected 1 to %d",
                        count, BDF_PREVIOUS);
    if (passing != 0 && !(passing == 1 && may_pass))
        return ehd_fail(error, EHD_DATA, "saved state: found %g passing states, expected %s",
                        passing, may_pass ? "0 or 1" : "0");
    return EHD_OK;
}

static ehd_status check_times(const bdf_ring *ring, ehd_error *error) {
    for (size_t i = 1; i < num_saved(ring); i++) {
        const double later = ring->time[bdf_ring_accepted(ring, i)];
        const double time = ring->time[bdf_ring_accepted(ring, i + 1)];
        if (!(later > time))
            return ehd_fail(error, EHD_DATA,
                            "saved state: found time %g after %g, expected a later one", later,
                            time);
    }
    return EHD_OK;
}

static ehd_status restore_ring(bdf_march *self, const double *head, ehd_error *error) {
    bdf_ring *ring = &self->ring;
    ehd_status status = check_head(head, self, error);

    if (status) return status;
    ring->num_previous = (size_t)head[NUM_PREVIOUS];
    ring->passing = head[IS_PASSING] == 1;
    for (size_t i = 0; i < num_saved(ring) && !status; i++) {
        const size_t place = ring->place[i + 1];
        status = restore_state(self, place, head + NUM_HEAD + i * entry_size(self), error);
        if (!status) prepare(self, place, 1);
        ring->time[place] = self->frame[place]->time;
    }
    return status ? status : check_times(ring, error);
}

/* Restores a saved march. After a failure the march has no states. */
static ehd_status restore(void *solver, const double *saved, ehd_error *error) {
    bdf_march *self = solver;
    const double *front = saved + base_size(self), *head = front + self->front_size;
    ehd_status status = check_finite(front, self->front_size, error);

    forget_attempt(self);
    if (!status && bdf_march_along_path(self)) {
        status = restore_state(self, BDF_BASE, saved, error);
        if (!status) status = self->model->use_base(self, error);
    }
    if (!status) status = self->model->restore_rest(self, front, head + ring_size(self), error);
    if (!status) status = restore_ring(self, head, error);
    if (status) bdf_ring_keep(&self->ring, 0);
    return status;
}

// ---- as a solver

static ehd_status fields(double *pressure, double *film, void *solver, ehd_error *error) {
    const bdf_march *self = solver;
    handed_state given = {.pressure = pressure, .film = film};
    (void)error;

    self->model->give(&given, self, bdf_march_accepted(self, 1));
    return EHD_OK;
}

static solve_seconds seconds(const void *solver) {
    const bdf_march *self = solver;

    return self->seconds;
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
                          .traction = model->traction,
                          .seconds = seconds};
}
