/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes derivatives of solutions and of steps with respect to the conditions
 * (romrun/library/README.md), from central differences of the residuals (reduced_tangent.h). Called
 * by the library and FMUs through online.h. */
#include "romrun/online/online_objects.h"

#include <math.h>
#include <string.h>

/* A solution and its conditions. */
typedef struct solved_frame {
    const ehd_contact *reference;
    reduced_state state;
    online_conditions at; // conditions of the solution; their load scales the frame
    bool by_approach;     // true: the approach was given, not the load
    bool exit_at_node;
    void (*set_frame)(contact_frame *frame, const void *context,
                      const online_conditions *conditions);
    const void *context; // argument of set_frame
    frame_equations equations;
    reduced_tangent *tangent;
    bool *linearised; // true: the tangent is linearised at this solution, for all directions
} solved_frame;

/* Relative distance between the two sets of conditions of a central difference (distance_of).
 * Differences are taken only of the residuals of the rows, at fixed coordinates. The derivatives of
 * central and minimum film with respect to load and speed were computed for the line contact of
 * scenes/examples. Distances of 2e-3 to 2e-5 change these derivatives by less than 1e-6. A distance
 * of 2e-2 changes them by 6e-4, and a distance of 2e-7 by 6e-5 (test_derivatives.c,
 * derivatives_of_lines_are_those_of_differences). */
static const double DISTANCE = 2e-4;

/* Returns the distance between the two sets of conditions of a central difference, as a multiple of
 * `direction`. Returns 0 if the direction is zero. */
static double distance_of(const solved_frame *of, const online_direction *direction) {
    const online_conditions *at = &of->at;
    const double rates[] = {
        of->by_approach ? direction->approach : direction->load / at->load,
        direction->speed / (at->speed > 0 ? at->speed : 1),
        direction->radius / at->radius,
        direction->modulus / at->modulus,
    };
    double fastest = 0;

    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++)
        fastest = fmax(fastest, fabs(rates[i]));
    return fastest > 0 ? DISTANCE / fastest : 0;
}

/* Sets the frame for the solution's conditions plus `distance` times a direction. */
static void set_frame_at_distance(contact_frame *frame, const solved_frame *of,
                                  const online_direction *direction, double distance) {
    online_conditions at = of->at;

    if (of->by_approach)
        at.approach += distance * direction->approach;
    else
        at.load += distance * direction->load;
    at.speed += distance * direction->speed;
    at.radius += distance * direction->radius;
    at.modulus += distance * direction->modulus;
    of->set_frame(frame, of->context, &at);
}

static ehd_status check_direction(const online_direction *direction, const ehd_contact *reference,
                                  ehd_error *error) {
    const bool by_load = isnan(direction->approach);
    const double sum = (by_load ? direction->load : direction->approach) + direction->speed +
                       direction->radius + direction->modulus;

    if (!isfinite(sum) || (!by_load && !isnan(direction->load)))
        return ehd_fail(error, EHD_DATA,
                        "direction: found load %g, approach %g, speed %g, radius %g, modulus %g, "
                        "expected finite numbers, and nan for load or approach",
                        direction->load, direction->approach, direction->speed, direction->radius,
                        direction->modulus);
    return by_load ? EHD_OK : contact_check_approach(reference, error);
}

static ehd_status linearise(const solved_frame *of, ehd_error *error) {
    contact_frame at;

    if (*of->linearised) return EHD_OK;
    of->set_frame(&at, of->context, &of->at);
    const ehd_status status =
        frame_linearise(of->tangent, &of->state, &at, &of->equations, of->exit_at_node, error);
    *of->linearised = !status;
    return status;
}

/* The frames at -distance/2 and +distance/2 along a direction. */
typedef struct frame_pair {
    contact_frame side[2];
    double distance; // 0: the direction is zero
} frame_pair;

static frame_pair frames_around(const solved_frame *of, const online_direction *direction) {
    frame_pair found = {.distance = distance_of(of, direction)};

    for (int i = 0; i < 2; i++)
        set_frame_at_distance(&found.side[i], of, direction, (i - 0.5) * found.distance);
    return found;
}

/* Computes derivatives along a direction. The direction must prescribe the quantity (load or
 * approach) that was given for the solution. */
static ehd_status derivatives_along(frame_quantities *found, const solved_frame *of,
                                    const online_direction *direction, ehd_error *error) {
    const frame_pair frames = frames_around(of, direction);
    reduced_change change;

    *found = (frame_quantities){.half_width = 0};
    if (frames.distance == 0) return EHD_OK;
    return frame_tangent(found, &change, of->tangent, frames.side, frames.distance, of->reference,
                         &of->equations, error);
}

/* Returns the direction in which the given quantity (load or approach) changes by 1. The other
 * conditions stay constant. */
static online_direction direction_of_given(const solved_frame *of) {
    return of->by_approach ? (online_direction){.load = NAN, .approach = 1}
                           : (online_direction){.load = 1, .approach = NAN};
}

/* Corrects `found` if the direction prescribes the quantity (load or approach) that was an outcome
 * of the solution. Adds a multiple of `by_given`, the derivatives with respect to the given
 * quantity, so that the outcome changes as the direction prescribes. It would be wrong to prescribe
 * the outcome in the solution's own frame instead. If the frame does not follow the load, the
 * change needs pressures that the modes lack. The stiffness would then be 13 % off for the point
 * contact of scenes/examples, and 0.4 % for the line contact. */
static void correct_outcome(frame_quantities *found, const frame_quantities *by_given,
                            const solved_frame *of, const online_direction *direction) {
    const double *add = (const double *)by_given;
    double *target = (double *)found;
    const double part = of->by_approach
                            ? (direction->load - found->scalars.load) / by_given->scalars.load
                            : (direction->approach - found->scalars.rigid_approach) /
                                  by_given->scalars.rigid_approach;

    for (size_t k = 0; k < sizeof *found / sizeof *target; k++)
        target[k] += part * add[k];
}

static ehd_status differentiate(online_derivatives *derivatives, const solved_frame *of,
                                const online_direction *direction, ehd_error *error) {
    const bool of_outcome = of->by_approach == isnan(direction->approach);
    const online_direction given = direction_of_given(of);
    online_direction own = *direction;
    frame_quantities found, by_given;
    ehd_status status = check_direction(direction, of->reference, error);

    if (of_outcome) {
        own.load = of->by_approach ? NAN : 0;
        own.approach = of->by_approach ? 0 : NAN;
    }
    if (!status) status = linearise(of, error);
    if (!status) status = derivatives_along(&found, of, &own, error);
    if (!status && of_outcome) status = derivatives_along(&by_given, of, &given, error);
    if (status) return status;
    if (of_outcome) correct_outcome(&found, &by_given, of, direction);
    *derivatives = (online_derivatives){found.scalars, found.peak_pressure, found.half_width};
    return EHD_OK;
}

/* Computes stiffness and damping from a small variation exp(sT) of the load that scales the frame.
 * Per unit of this variation, the load F changes by 1 + s F1 and the approach H0 by A + s H1, so
 * dF/dH0 = 1/A - s (H1 - A F1)/A^2. Because the least squares leave a residual in the load balance,
 * F1 is not 0, and the change of F at s = 0 is not exactly 1. The function divides by this
 * change. */
static ehd_status respond(online_response *response, const solved_frame *of, ehd_error *error) {
    const online_direction by_load = {.load = 1, .approach = NAN};
    const frame_pair frames = frames_around(of, &by_load);
    frame_quantities found;
    reduced_change change;
    contact_frame at;
    contact_scalars slow;
    double bound = 0;
    ehd_status status = contact_check_approach(of->reference, error);

    of->set_frame(&at, of->context, &of->at);
    if (!status) status = linearise(of, error);
    if (!status)
        status = frame_tangent(&found, &change, of->tangent, frames.side, frames.distance,
                               of->reference, &of->equations, error);
    if (!status)
        status = frame_tangent_slow(&slow, &bound, of->tangent, &change, &at, frames.side,
                                    frames.distance, of->reference, &of->equations, error);
    if (status) return status;
    const double load = found.scalars.load, compliance = found.scalars.rigid_approach / load;
    const double by_s = (slow.rigid_approach - compliance * slow.load) / load;
    const double square = compliance * compliance;
    *response = (online_response){-1 / compliance, by_s / square, bound / load / square};
    return EHD_OK;
}

/* Sets the frame of a stationary contact. */
static void set_stationary_frame(contact_frame *frame, const void *context,
                                 const online_conditions *conditions) {
    const ehd_contact *reference = context;
    const double values[NUM_VARY] = {[VARY_LOAD] = conditions->load,
                                     [VARY_SPEED] = conditions->speed,
                                     [VARY_RADIUS] = conditions->radius,
                                     [VARY_MODULUS] = conditions->modulus};

    *frame = frame_at(reference->kind, 0, values, conditions->approach);
}

/* Returns the equations of the scene under a frame's conditions. The speed is made a factor of
 * lambda, so that the weights of the rows stay the same. */
static reduced_equations stationary_equations(void *context, const contact_frame *frame,
                                              ehd_contact *contact, int side) {
    const ehd_contact *reference = context;

    (void)side;
    frame_contact(contact, frame, reference);
    contact->lambda *= contact->entrainment;
    contact->entrainment = contact->far_speed = 1;
    return (reduced_equations){contact, NULL};
}

static ehd_status find_solved(solved_frame *solved, online_solver *solver, ehd_contact *reference,
                              ehd_error *error) {
    const online_conditions own = {
        .load = 1, .approach = NAN, .speed = 1, .radius = 1, .modulus = 1};

    part_solver *used = solver->used;

    if (!used->solved)
        return ehd_fail(error, EHD_INTERNAL, "derivatives: found no solution, expected one before");
    *solved = (solved_frame){.reference = reference,
                             .state = used->state,
                             .at = own,
                             .set_frame = set_stationary_frame,
                             .context = reference,
                             .equations = {reference, stationary_equations}};
    const ehd_status status =
        used->tangent ? EHD_OK
                      : reduced_tangent_create(&used->tangent, &used->model->reduced, error);
    solved->tangent = used->tangent;
    solved->linearised = &used->linearised;
    return status;
}

ehd_status online_differentiate(online_derivatives *derivatives, online_solver *solver,
                                const ehd_contact *contact, const online_direction *direction,
                                ehd_error *error) {
    ehd_contact reference = *contact;
    solved_frame solved;
    const ehd_status status = find_solved(&solved, solver, &reference, error);

    contact_take_grid(&reference, online_solved_grid(solver));
    return status ? status : differentiate(derivatives, &solved, direction, error);
}

ehd_status online_respond(online_response *response, online_solver *solver,
                          const ehd_contact *contact, ehd_error *error) {
    ehd_contact reference = *contact;
    solved_frame solved;
    const ehd_status status = find_solved(&solved, solver, &reference, error);

    contact_take_grid(&reference, online_solved_grid(solver));
    return status ? status : respond(response, &solved, error);
}

static void set_transient_frame(contact_frame *frame, const void *context,
                                const online_conditions *conditions) {
    const online_transient *self = context;

    *frame = transient_frame_of(self, conditions, self->solved ? self->last.step : 0);
}

/* Finds the solution of the step that is not accepted yet, or of the start. */
static ehd_status find_attempt(solved_frame *solved, online_transient *self, ehd_error *error) {
    const march_step *last = &self->last;
    const size_t part = online_transient_part(self);
    reduced_march *of = transient_march_of_attempt(self);

    if ((!self->solved && !(self->at_start && self->conditions.speed > 0)) ||
        transient_is_apart(self) || self->last.begins)
        return ehd_fail(error, EHD_INTERNAL,
                        "derivatives: found no solution, expected a step that is not accepted yet, "
                        "or a start that is not at rest");
    *solved =
        (solved_frame){.reference = &self->reference,
                       .state = reduced_march_state_before(of, transient_steps_before(self), NULL),
                       .at = self->conditions,
                       .by_approach = self->solved && !isnan(self->conditions.approach),
                       .exit_at_node = true,
                       .set_frame = set_transient_frame,
                       .context = self,
                       .equations = reduced_march_equations(of)};
    solved->at.load = last->frame.load;
    // the frame of a start follows the load, even if the approach was given
    if (!self->solved) solved->at.approach = NAN;
    if (part != self->of) self->tangent = reduced_tangent_free(self->tangent);
    self->of = part;
    const ehd_status status =
        self->tangent
            ? EHD_OK
            : reduced_tangent_create(&self->tangent, &self->model->parts[part].reduced, error);
    solved->tangent = self->tangent;
    solved->linearised = &self->linearised;
    return status;
}

ehd_status online_transient_differentiate(online_derivatives *derivatives, online_transient *self,
                                          const online_direction *direction, ehd_error *error) {
    solved_frame solved;
    const ehd_status status = find_attempt(&solved, self, error);

    return status ? status : differentiate(derivatives, &solved, direction, error);
}

ehd_status online_transient_respond(online_response *response, online_transient *self,
                                    ehd_error *error) {
    solved_frame solved;
    ehd_status status = find_attempt(&solved, self, error);

    if (!status && self->solved)
        status = ehd_fail(error, EHD_INTERNAL,
                          "stationary response: found a step in time, expected a stationary start");
    return status ? status : respond(response, &solved, error);
}
