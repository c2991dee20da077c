/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes initial states for Newton's iteration: from the dry contact, and by continuation from an
 * easier contact to a harder one. */
#include "fullrun/continuation.h"

#include "common/physics/traction.h"
#include "common/program/program.h"

#include <math.h>
#include <string.h>

/* Central film of the start, divided by the film of the film formula. If the film is too thick,
 * Newton's iteration corrects it in a few steps. If the film is too thin, the iteration drives it
 * to zero at the edges of the contact. 24 cold starts with extreme M and L were measured. With
 * ratios of 1.5, 2, 4 and 10 all of them converge, in 760, 731, 765 and 820 Newton steps. With a
 * ratio of 1 eight cold starts fail (test_continuation.c, extremes_converge). */
static const double START_FILM = 2;

/* Smallest stride of a continuation, as a fraction of the whole way. Of 89 cold starts by
 * continuation (M 0.5 to 1000, L 0 to 50, line and point contacts of three laws) 43 converge, with
 * strides of 1/8 or more. In the other starts the film falls to zero on the grid, and the solver
 * gives up. The number of solutions until it gives up grows with the logarithm of this stride
 * (test_continuation.c, far_start_is_given_up_early). */
static const double MIN_STRIDE = 1. / 256;

/* Ends the pressurised zone of the dry contact at a node. On a point contact only this
 * node leaves the zone. */
static void end_zone(full_state *state, const ehd_grid *grid, size_t node) {
    if (grid->inner_lines > 1)
        state->ruptured[node] = true;
    else if (node < state->exit)
        state->exit = node;
}

void full_start_dry(full_state *state, full_solver *solver, const ehd_contact *contact,
                    double central_film) {
    const ehd_grid *grid = &contact->grid;

    memset(state->pressure, 0, grid->num_nodes * sizeof(double));
    full_state_fill(state, grid);
    for (size_t r = 0; r < grid->num_inner; r++) {
        size_t k = grid_node_of_row(grid, r);
        double distance = grid_square_distance(grid, k);
        if (distance < 1)
            state->pressure[k] = sqrt(1 - distance);
        else if (grid_x(grid, k) > 0)
            end_zone(state, grid, k);
    }
    state->rigid_approach = 0;
    full_film(state, solver);
    state->rigid_approach =
        central_film - full_evaluate_scalars(state, contact).central_film_thickness;
    full_film(state, solver);
}

static void start_dry(full_state *state, full_solver *solver, const ehd_contact *contact) {
    double film =
        contact->kind->central_film(&contact->grid.shape, contact->moes_M, contact->moes_L);

    full_start_dry(state, solver, contact, START_FILM * film);
}

static void add_effort(full_info *total, const full_info *part) {
    size_t newton = total->newton_iterations + part->newton_iterations;
    size_t gmres = total->gmres_iterations + part->gmres_iterations;
    solve_seconds seconds = total->seconds;

    solve_seconds_add(&seconds, &part->seconds);
    *total = *part;
    total->newton_iterations = newton;
    total->gmres_iterations = gmres;
    total->seconds = seconds;
}

/* Returns a contact between start (s = 0) and goal (s = 1). Interpolates linearly in s: L, p_H, ln
 * M, and the logarithm of the Eyring stress of a thinned flow. */
static ehd_contact contact_between(const ehd_contact *start, const ehd_contact *goal, double s) {
    ehd_contact between = *goal;

    if (s < 1) {
        double pressure = (1 - s) * start->hertz_pressure + s * goal->hertz_pressure;
        contact_set_moes(&between, start->moes_M * pow(goal->moes_M / start->moes_M, s),
                         (1 - s) * start->moes_L + s * goal->moes_L);
        between.hertz_pressure = pressure;
        between.alpha_p_H = between.lubricant.alpha * pressure;
        const double stress = start->lubricant.thinning_stress;
        if (stress > 0)
            between.lubricant.thinning_stress =
                stress * pow(goal->lubricant.thinning_stress / stress, s);
    }
    return between;
}

/* Solves contacts between a solved contact and the goal. The stride in s (contact_between) is
 * halved on failure and doubled on success. `state` is the solution of the contact `start`, and
 * becomes the last solution that was found. */
static ehd_status continue_to(full_info *info, full_state *state, full_solver *solver,
                              const ehd_contact *start, const ehd_contact *goal, ehd_error *error) {
    double done = 0, stride = 1;
    full_state last;
    ehd_status status = full_state_init(&last, &goal->grid, error);

    if (!status) full_state_copy(&last, state, &goal->grid);
    while (!status && done < 1 && stride >= MIN_STRIDE) {
        ehd_contact here = contact_between(start, goal, fmin(done + stride, 1));
        full_info part;
        status = full_solve_nodal(&part, state, solver, &here, error);
        if (status) break;
        add_effort(info, &part);
        if (part.status == EHD_OK) {
            done = fmin(done + stride, 1);
            stride *= 2;
            full_state_copy(&last, state, &goal->grid);
        } else {
            stride /= 2;
            full_state_copy(state, &last, &goal->grid);
        }
    }
    full_state_free(&last);
    return status;
}

/* Returns a contact that converges from a cold start, with the lubricant and grid of the goal. */
static ehd_contact easy_contact(const ehd_contact *goal) {
    ehd_contact easy = *goal;
    double moes_L = fmin(goal->moes_L, 2);
    double share = goal->moes_L > 0 ? moes_L / goal->moes_L : 1;

    contact_set_moes(&easy, fmin(fmax(goal->moes_M, 8), 20), moes_L);
    easy.hertz_pressure = share * goal->hertz_pressure * sqrt(easy.moes_M / goal->moes_M);
    easy.alpha_p_H = easy.lubricant.alpha * easy.hertz_pressure;
    return easy;
}

/* Solves a contact by Newton from the dry contact, with the exit at a node. If this fails,
 * continuation from an easy contact changes first M at small L, then L. */
static ehd_status solve_from_dry(full_info *info, full_state *state, full_solver *solver,
                                 const ehd_contact *contact, ehd_error *error) {
    full_info part;

    start_dry(state, solver, contact);
    ehd_status status = full_solve_nodal(info, state, solver, contact, error);
    if (status || info->status == EHD_OK) return status;
    ehd_contact easy = easy_contact(contact);
    start_dry(state, solver, &easy);
    status = full_solve_nodal(&part, state, solver, &easy, error);
    add_effort(info, &part);
    if (status || part.status != EHD_OK) return status;
    ehd_contact corner = easy;
    contact_set_moes(&corner, contact->moes_M, easy.moes_L);
    corner.hertz_pressure = easy.hertz_pressure * sqrt(contact->moes_M / easy.moes_M);
    corner.alpha_p_H = corner.lubricant.alpha * corner.hertz_pressure;
    status = continue_to(info, state, solver, &easy, &corner, error);
    if (!status && info->status == EHD_OK)
        status = continue_to(info, state, solver, &corner, contact, error);
    return status;
}

/* Solves a contact by continuation from a fluid that is hardly shear-thinned. The thinned flow
 * grows exponentially with the pressure gradient. In a dry contact this gradient is so large that
 * Newton does not converge from the dry contact. */
static ehd_status solve_by_thinning(full_info *info, full_state *state, full_solver *solver,
                                    const ehd_contact *contact, ehd_error *error) {
    ehd_contact hardly = *contact;

    hardly.lubricant.thinning_stress *= fmax(1, 10 * traction_thinning(contact).gradient);
    ehd_status status = solve_from_dry(info, state, solver, &hardly, error);
    if (!status && info->status == EHD_OK)
        status = continue_to(info, state, solver, &hardly, contact, error);
    return status;
}

ehd_grid full_coarser_grid(const ehd_grid *grid) {
    size_t sides = grid->inner_lines / 2; // for a whole grid: number of lines on each side of y = 0

    return grid_like(grid, grid->x_min, 2 * grid->step, (grid->inner_x + 1) / 2,
                     grid->half ? grid->inner_lines / 2 + 1 : 2 * ((sides + 1) / 2) + 1);
}

/* Returns the bilinear interpolation at an inner node of the finer grid. */
static double interpolated(const double *values, const ehd_grid *coarse, const ehd_grid *grid,
                           size_t node) {
    size_t width = grid_width(coarse), low = (node % grid_width(grid) + 1) / 2;
    size_t high = (node % grid_width(grid) + 2) / 2; // coarse column c is fine column 2c - 1
    double line = (grid_y(grid, node) - grid_y(coarse, 0)) / grid_step_across(coarse);
    size_t left = coarse->inner_lines > 1 ? (size_t)floor(line + 0.25) : 0;
    size_t right = coarse->inner_lines > 1 ? (size_t)floor(line + 0.75) : 0;

    return (values[left * width + low] + values[left * width + high] + values[right * width + low] +
            values[right * width + high]) /
           4;
}

/* Interpolates the pressure from a coarser grid, and sets the pressurised zone. Column k of the
 * coarser grid is column 2k - 1 of the finer grid. */
static void refine(full_state *state, const ehd_grid *grid, const full_state *from,
                   const ehd_grid *coarse) {
    size_t exit = 2 * from->exit - 1, last = grid->num_nodes - 1;
    double offset = 2 * from->exit_offset; // in steps of the finer grid, from a node that both
                                           // grids have

    memset(state->pressure, 0, grid->num_nodes * sizeof(double));
    for (size_t r = 0; r < grid->num_inner; r++) {
        size_t k = grid_node_of_row(grid, r);
        state->pressure[k] = interpolated(from->pressure, coarse, grid, k);
    }
    if (isless(offset, 1)) exit--; // the offset is NaN on a point contact
    full_state_set_zone(state, grid, exit < last ? exit : last);
    if (exit < last) state->exit_offset = isgreaterequal(offset, 1) ? offset - 1 : offset;
    state->rigid_approach = from->rigid_approach;
}

/* Solves the contact on a grid with twice the step, and interpolates pressure and exit to the finer
 * grid. With this start the number of Newton iterations on the finest grid does not grow with the
 * number of nodes. *started: whether the solution on the coarse grid has converged. */
static ehd_status start_coarse(bool *started, full_state *state, full_solver *solver,
                               const ehd_contact *contact, ehd_error *error) {
    full_settings settings = *full_solver_settings(solver);
    ehd_contact coarse = *contact;
    full_solver *coarse_solver = NULL;
    full_state from = {0};
    full_info info;

    *started = false;
    coarse.grid = full_coarser_grid(&contact->grid);
    // the discretisation error of the coarse grid is larger than this tolerance, so a tighter
    // tolerance would not help
    settings.tolerance = contact->kind->dimensions > 1 ? 1e-3 : 1e-6;
    settings.as_large |= full_is_large(&contact->grid);
    ehd_status status =
        full_solver_create(&coarse_solver, contact->kind, &coarse.grid, &settings, error);
    if (!status) status = full_state_init(&from, &coarse.grid, error);
    if (!status) status = full_solve_cold(&info, &from, coarse_solver, &coarse, error);
    if (!status && info.status == EHD_OK) {
        refine(state, &contact->grid, &from, &coarse.grid);
        *started = true;
    }
    full_state_free(&from);
    full_solver_free(coarse_solver);
    return status;
}

ehd_status full_solve_cold(full_info *info, full_state *state, full_solver *solver,
                           const ehd_contact *contact, ehd_error *error) {
    // Largest number of inner nodes along X on the coarsest grid. A still coarser grid would not
    // resolve the film. It would also save no iterations, as measured on a line contact of 1201
    // nodes and on a point contact of 128 cells.
    const size_t coarsest = contact->kind->dimensions > 1 ? 60 : 500;
    double before = program_seconds();
    ehd_status status = EHD_OK;
    bool started = false;

    memset(info, 0, sizeof *info);
    info->status = EHD_NOT_CONVERGED;
    if (contact->grid.inner_x > coarsest)
        status = start_coarse(&started, state, solver, contact, error);
    if (!status && started) status = full_solve(info, state, solver, contact, NULL, error);
    if (!status && info->status != EHD_OK) {
        full_info part;
        status = solve_from_dry(&part, state, solver, contact, error);
        add_effort(info, &part);
        if (!status && info->status != EHD_OK && traction_thins_flow(contact)) {
            status = solve_by_thinning(&part, state, solver, contact, error);
            add_effort(info, &part);
        }
        if (!status && info->status == EHD_OK && full_exit_is_within_node(solver)) {
            status = full_solve(&part, state, solver, contact, NULL, error);
            add_effort(info, &part);
        }
    }
    info->seconds.total = program_seconds() - before;
    return status;
}

ehd_status full_solve_from(full_info *info, full_state *state, full_solver *solver,
                           const ehd_contact *contact, ehd_error *error) {
    double before = program_seconds();
    full_info part;

    // continuation from the given state would take more iterations than a cold start: 2424 instead
    // of 1389 for a plan of 40 line contacts far apart
    ehd_status status = full_solve(info, state, solver, contact, NULL, error);
    if (!status && info->status != EHD_OK) {
        status = full_solve_cold(&part, state, solver, contact, error);
        add_effort(info, &part);
    }
    info->seconds.total = program_seconds() - before;
    return status;
}
