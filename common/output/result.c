/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/result.h"

#include "common/output/columns.h"
#include "common/output/grid_file.h"
#include "common/output/traction_output.h"
#include "common/physics/inlet_heating.h"
#include "common/program/arena.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- writing

ehd_status result_put_contact(artefact *file, const ehd_contact *contact, ehd_error *error) {
    const bool ellipse = contact->kind == &contact_ellipse, thins = traction_thins_flow(contact);
    const flow_thinning thinning = traction_thinning(contact);
    const named_number numbers[] = {{"hertz_pressure", contact->hertz_pressure},
                                    {"moes_M", contact->moes_M},
                                    {"moes_L", contact->moes_L},
                                    {"alpha_p_H", contact->alpha_p_H},
                                    {0}};
    const named_number known[] = {
        // NaN if the scene is not in SI units, or sliding thins no flow
        {"half_width", contact->half_width},
        {"half_width_across", ellipse ? contact_half_width_across(contact) : NAN},
        {"film_unit", contact_film_scale(contact)},
        {"time_unit", contact_time_scale(contact)},
        {contact->kind->dimensions > 1 ? "point_load" : "line_load", contact->load},
        {"thinning", thins ? thinning.sliding : NAN},
        {"gradient_thinning", thins ? thinning.gradient : NAN},
        {0}};
    ehd_status status = grid_write_attributes(file, contact->kind, &contact->grid, error);

    if (!status) status = numbers_put(file, 0, numbers, error);
    if (!status) status = numbers_put_known(file, 0, known, error);
    if (!status && contact_has_traction(contact)) status = traction_put_units(file, contact, error);
    return status;
}

ehd_status result_create(artefact **file, const program *caller, const ehd_contact *contact,
                         const char *settings_text, const char *const *inputs, ehd_error *error) {
    const double stationary = 0;
    ehd_status status =
        artefact_create(file, caller->output, &schema_result, caller, settings_text, inputs, error);
    const ehd_grid whole = grid_whole(&contact->grid);

    if (!status) status = artefact_put_axis(*file, "time", 1, &stationary, error);
    if (!status && whole.inner_lines > 1) status = grid_write_axes(*file, &whole, error);
    if (!status) status = result_put_contact(*file, contact, error);
    if (status) artefact_close(file);
    return status;
}

int64_t result_stored_status(ehd_status status) {
    return status == EHD_NOT_CONVERGED ? 1 : (int64_t)status;
}

ehd_status result_put_seconds(artefact *file, const solve_seconds *seconds, ehd_error *error) {
    const double parts[] = {seconds->rows, seconds->linear, seconds->exit};
    double rest = seconds->total;

    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (!isnan(parts[i])) rest -= parts[i];
    const named_number numbers[] = {{"solve_seconds", seconds->total},
                                    {"solve_seconds_rows", seconds->rows},
                                    {"solve_seconds_linear", seconds->linear},
                                    {"solve_seconds_exit", seconds->exit},
                                    {"solve_seconds_other", rest},
                                    {0}};
    return numbers_put_known(file, 0, numbers, error);
}

static ehd_status put_fields(artefact *file, const run_result *result, const ehd_grid *grid,
                             ehd_error *error) {
    bool on_line = grid->inner_lines == 1, any = result->pressure || result->film;
    ehd_status status = on_line && any ? grid_write_axes(file, grid, error) : EHD_OK;

    if (!status && result->pressure)
        status = grid_put_field(file, "pressure", 0, result->pressure, grid, true, error);
    if (!status && result->film)
        status = grid_put_field(file, "film_thickness", 0, result->film, grid, true, error);
    return status;
}

static ehd_status put_scalars(artefact *file, const run_result *result, ehd_error *error) {
    const named_number numbers[] = {
        {"central_film_thickness", result->scalars.central_film_thickness},
        {"minimum_film_thickness", result->scalars.minimum_film_thickness},
        {"central_pressure", result->scalars.central_pressure},
        {"rigid_approach", result->scalars.rigid_approach},
        {"load", result->scalars.load},
        // a stationary result is in the reference frame
        {"contact_half_width", 1},
        {"frame_hertz_pressure", 1},
        {"frame_film_unit", 1},
        {"residual_norm", result->residual},
        {"newton_iterations", (double)result->newton_iterations},
        {"status", (double)result_stored_status(result->status)},
        {0}};
    const bool one_model = result->solved_by == SOLVED_BY_ANY;
    const named_number known[] = {
        {"indicated_deviation", result->indicated_deviation},
        {"indicated_deviation_minimum", result->indicated_deviation_minimum},
        {"by_full_model", one_model ? NAN : result->solved_by == SOLVED_BY_FULL},
        {0}};
    const double *exits = result->exits ? result->exits : &result->scalars.exit_position;
    ehd_status status = numbers_put(file, 0, numbers, error);

    if (!status) status = artefact_put(file, "exit_position", exits, error);
    if (!status) status = numbers_put_known(file, 0, known, error);
    for (int q = 0; q < NUM_INDICATED && result->indicated && !status; q++)
        if (!isnan(result->indicated[q]))
            status = artefact_put(file, indicated_entries[q].field, &result->indicated[q], error);
    return status;
}

void result_judge(run_result *result, const ehd_grid *grid) {
    const bool coarse = result->effects && film_effects_are_infinite(result->effects);

    if (result->status) return;
    if (coarse) {
        result->status = EHD_UNTRUSTED;
        snprintf(result->reason, RESULT_REASON,
                 "a grid from X = %g on by %g, too %s to estimate its error", grid->x_min,
                 grid->step, film_effects_inlet_is_short(result->effects) ? "short" : "coarse");
    } else if (result->traction && isgreater(fabs(result->traction->friction), possible_friction)) {
        result->status = EHD_UNTRUSTED;
        snprintf(result->reason, RESULT_REASON, "%s", impossible_friction);
    }
}

/* Writes the error estimates that are known. */
static ehd_status put_effects(artefact *file, const film_effects *effects, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (int e = 0; e < NUM_EFFECTS && effects && !status; e++)
        if (isfinite(effects->of[e]))
            status = artefact_put_real(file, film_effect_names[e], effects->of[e], error);
    return status;
}

/* Writes the effect of shear heating in the inlet. The factor is missing outside the range of its
 * formula. */
static ehd_status put_heating(artefact *file, const ehd_contact *contact, ehd_error *error) {
    const inlet_heating heating = inlet_heating_of(contact);
    ehd_status status = EHD_OK;

    if (isfinite(heating.loading))
        status = artefact_put_real(file, "thermal_loading", heating.loading, error);
    if (!status && isfinite(heating.factor))
        status = artefact_put_real(file, "inlet_heating_factor", heating.factor, error);
    return status;
}

ehd_status result_write(artefact **file, const run_result *result, const ehd_contact *contact,
                        ehd_error *error) {
    ehd_status status = put_fields(*file, result, &contact->grid, error);

    if (!status) status = put_scalars(*file, result, error);
    if (!status && result->traction) status = traction_put(*file, result->traction, error);
    if (!status && result->traction && result->pressure && result->film)
        status = traction_put_stresses(*file, 0, contact, result->pressure, result->film,
                                       result->scalars.rigid_approach, error);
    if (!status) status = put_effects(*file, result->effects, error);
    if (!status) status = put_heating(*file, contact, error);
    if (!status) status = result_put_seconds(*file, &result->seconds, error);
    if (!status) return artefact_finish(file, error);
    artefact_close(file);
    return status;
}

// ---- printing

static void print_value(const char *name, double value, double scale, const char *unit) {
    if (isfinite(value * scale))
        printf("%-24s%-14.8g%.6g %s\n", name, value, value * scale, unit);
    else
        printf("%-24s%.8g\n", name, value);
}

/* Adds one source of error to the line. Prints nothing if `part` is NaN. If `part` is infinite,
 * prints `lack`, the reason why there is no estimate. */
static void print_part(const char **separator, const char *name, double part, const char *lack) {
    if (isnan(part)) return;
    printf("%s%s ", *separator, name);
    if (isinf(part))
        printf("too %s to tell", lack);
    else
        printf("%.2g %%", 100 * fabs(part));
    *separator = ", ";
}

/* Prints estimates of the errors due to the reduced model, the grid step and the inlet length.
 * Prints nothing if neither error due to the grid is known. */
static void print_parts(const char *head, double model, double step, double inlet) {
    const char *separator = "";

    if (isnan(step) && isnan(inlet)) return;
    printf("%-24s", head);
    print_part(&separator, "model", model, "coarse");
    print_part(&separator, "grid", step, "coarse");
    print_part(&separator, "inlet", inlet, isinf(step) ? "coarse" : "short");
    putchar('\n');
}

/* Prints a line with the error estimates of other quantities. `with_friction`: the result has
 * friction. */
static void print_indicated(const double *indicated, bool with_friction) {
    const char *separator = "";
    bool any = false;

    for (int q = 0; q < NUM_INDICATED; q++)
        any = any || !isnan(indicated[q]);
    if (!any) return;
    printf("%-24s", "  of others");
    for (int q = 0; q < NUM_INDICATED; q++) {
        if (isnan(indicated[q])) continue;
        printf("%s%s %.2g%s", separator, indicated_entries[q].text, indicated[q],
               indicated_entries[q].unit);
        separator = ", ";
    }
    if (with_friction && isnan(indicated[INDICATED_FRICTION])) printf(", friction not known");
    putchar('\n');
}

static void print_heating(const ehd_contact *contact) {
    const inlet_heating heating = inlet_heating_of(contact);

    if (!isfinite(heating.loading)) return;
    printf("%-24s", "inlet shear heating");
    if (isfinite(heating.factor))
        printf("%.4f of the films above, which are isothermal", heating.factor);
    else
        printf("not known, outside of the range of its formula");
    printf(" (thermal loading %.3g)\n", heating.loading);
}

void result_print(const run_result *result, const ehd_contact *contact) {
    const char *const errors = "  estimated error";
    const double film = contact_film_scale(contact) * 1e6; // µm
    const double width = contact->half_width * 1e6;
    const double pressure = isnan(contact->load) ? NAN : contact->hertz_pressure * 1e-9;
    const film_effects effects = result->effects ? *result->effects : film_effects_unknown();

    printf("%-24sM = %.6g, L = %.6g, alpha p_H = %.6g, p_H = %.6g GPa\n", "contact",
           contact->moes_M, contact->moes_L, contact->alpha_p_H, contact->hertz_pressure * 1e-9);
    grid_print_equations(contact);
    grid_print(contact, "this M and L");
    print_value("central film thickness", result->scalars.central_film_thickness, film, "µm");
    print_parts(errors, result->indicated_deviation, effects.of[EFFECT_STEP],
                effects.of[EFFECT_INLET]);
    print_value("minimum film thickness", result->scalars.minimum_film_thickness, film, "µm");
    print_parts(errors, result->indicated_deviation_minimum, effects.of[EFFECT_STEP_MINIMUM],
                effects.of[EFFECT_INLET_MINIMUM]);
    print_heating(contact);
    print_value("central pressure", result->scalars.central_pressure, pressure, "GPa");
    print_value("rigid approach", result->scalars.rigid_approach, film, "µm");
    print_value("exit position", result->scalars.exit_position, width, "µm");
    print_value("load", result->scalars.load, contact->load,
                contact->kind->dimensions > 1 ? "N" : "N/m");
    if (result->traction) {
        traction_print(result->traction, contact, &effects);
        print_parts("  error of rolling", NAN, effects.of[EFFECT_STEP_ROLLING],
                    effects.of[EFFECT_INLET_ROLLING]);
    }
    printf("%-24s%zu, residual %.1e\n", "Newton iterations", result->newton_iterations,
           result->residual);
    if (!isnan(result->indicated_deviation))
        printf("%-24s%.2g of the central film thickness\n", "indicated deviation",
               result->indicated_deviation);
    if (result->indicated) print_indicated(result->indicated, result->traction);
    printf("%-24s%.3g ms\n", "solution", result->seconds.total * 1e3);
}

// ---- reading

ehd_status result_get_contact(stored_result *stored, artefact *file, const contact_kind *kind,
                              ehd_error *error) {
    char *contact = NULL;
    ehd_status status = artefact_get_text(file, "contact", &contact, error);

    if (!status && strcmp(contact, kind->name) != 0)
        status = ehd_fail(error, EHD_DATA, "%s: contact: found %.32s, expected %s",
                          artefact_path(file), contact, kind->name);
    free(contact);
    stored->num_lines = 1;
    if (!status) status = grid_count_lines(&stored->num_lines, file, kind, error);
    if (!status && kind->dimensions > 1 && stored->num_lines % 2 == 0)
        status = ehd_fail(error, EHD_DATA, "%s: y: found %zu lines, expected an odd number",
                          artefact_path(file), stored->num_lines);
    stored->num_inner = artefact_length(file, "x") * stored->num_lines;
    stored->moes_L = NAN;
    if (!status) status = artefact_get_real(file, "x_min", &stored->x_min, error);
    if (!status) status = artefact_get_real(file, "step", &stored->step, error);
    if (!status) status = grid_read_discretization(&stored->discretization, file, error);
    stored->boundary = BOUNDARY_ZERO;
    if (!status && kind->dimensions > 1)
        status = grid_read_boundary(&stored->boundary, file, error);
    if (!status) status = grid_read_shape(&stored->shape, file, kind, error);
    if (!status) status = artefact_get_real(file, "hertz_pressure", &stored->hertz_pressure, error);
    if (!status) status = artefact_get_real(file, "moes_M", &stored->moes_M, error);
    if (!status) status = artefact_get_real(file, "alpha_p_H", &stored->alpha_p_H, error);
    if (!status && artefact_has(file, "moes_L"))
        status = artefact_get_real(file, "moes_L", &stored->moes_L, error);
    if (!status && artefact_has(file, "thinning"))
        status = artefact_get_real(file, "thinning", &stored->thinning.sliding, error);
    if (!status && artefact_has(file, "gradient_thinning"))
        status = artefact_get_real(file, "gradient_thinning", &stored->thinning.gradient, error);
    return status;
}

/* Reads the exit farthest downstream at Y = 0. A point contact has an exit on each line of nodes. A
 * line of nodes has several exits if the entrainment reverses. */
static ehd_status get_exit(stored_result *stored, artefact *file, ehd_error *error) {
    const size_t several = artefact_length(file, "exit"), each = several > 0 ? several : 1;
    if (!artefact_has(file, "exit_position")) return EHD_OK;
    double *exits = array_new(stored->num_lines, each, sizeof *exits);
    if (!exits) return ehd_no_memory(error, artefact_path(file));

    ehd_status status = artefact_get(file, "exit_position", exits, stored->num_lines * each, error);
    if (!status) stored->exit_position = exits[stored->num_lines / 2 * each];
    free(exits);
    return status;
}

static ehd_status get_scalars(stored_result *stored, artefact *file, ehd_error *error) {
    const struct {
        const char *name;
        double *value;
    } reals[] = {{"central_film_thickness", &stored->central_film_thickness},
                 {"minimum_film_thickness", &stored->minimum_film_thickness},
                 {"rigid_approach", &stored->rigid_approach},
                 {"central_pressure", &stored->central_pressure}};
    ehd_status status = EHD_OK;

    // fields with NEED_ALWAYS exist; otherwise the file could not have been opened
    for (size_t i = 0; i < sizeof reals / sizeof *reals && !status; i++)
        if (artefact_has(file, reals[i].name))
            status = artefact_get(file, reals[i].name, reals[i].value, 1, error);
    if (!status) status = get_exit(stored, file, error);
    if (!status && artefact_has(file, "status"))
        status = artefact_get_integers(file, "status", &stored->status, 1, error);
    return status;
}

static ehd_status get_field(double **field, size_t num_inner, artefact *file, const char *name,
                            ehd_error *error) {
    if (!artefact_has(file, name)) return EHD_OK;
    *field = array_new(num_inner, 1, sizeof **field);
    if (!*field) return ehd_no_memory(error, artefact_path(file));
    return artefact_get(file, name, *field, num_inner, error);
}

static ehd_status check_finite(const stored_result *stored, const char *path, ehd_error *error) {
    bool finite = isfinite(stored->central_film_thickness) &&
                  isfinite(stored->minimum_film_thickness) && isfinite(stored->rigid_approach);

    for (size_t i = 0; i < stored->num_inner && finite; i++)
        finite = (!stored->pressure || isfinite(stored->pressure[i])) &&
                 (!stored->film || isfinite(stored->film[i]));
    if (finite || stored->status == 1) return EHD_OK;
    return ehd_fail(error, EHD_DATA,
                    "%s: found numbers that are not finite, expected those of a solution", path);
}

static ehd_status get_result(stored_result *stored, artefact *file, const contact_kind *kind,
                             bool want_fields, ehd_error *error) {
    const char *path = artefact_path(file);
    size_t num_times = artefact_length(file, "time");

    if (num_times != 1)
        return ehd_fail(error, EHD_DATA,
                        "%s: time: found %zu entries, expected 1, of a stationary result", path,
                        num_times);
    ehd_status status = result_get_contact(stored, file, kind, error);
    if (!status) status = get_scalars(stored, file, error);
    if (!status && want_fields)
        status = get_field(&stored->pressure, stored->num_inner, file, "pressure", error);
    if (!status && want_fields)
        status = get_field(&stored->film, stored->num_inner, file, "film_thickness", error);
    return status ? status : check_finite(stored, path, error);
}

ehd_status result_read(stored_result *stored, const char *path, const contact_kind *kind,
                       bool want_fields, ehd_error *error) {
    static const artefact_schema *const schemas[] = {&schema_result, NULL};
    artefact *file = NULL;

    memset(stored, 0, sizeof *stored);
    stored->central_pressure = stored->exit_position = NAN;
    ehd_status status = artefact_open(&file, path, schemas, error);
    if (!status) status = get_result(stored, file, kind, want_fields, error);
    artefact_close(&file);
    return status;
}

void result_free(stored_result *stored) {
    free(stored->pressure);
    free(stored->film);
    stored->pressure = stored->film = NULL;
}

ehd_grid result_grid(const stored_result *stored) {
    const ehd_grid like = {.discretization = stored->discretization,
                           .boundary = stored->boundary,
                           .shape = stored->shape};

    return grid_like(&like, stored->x_min, stored->step, stored->num_inner / stored->num_lines,
                     stored->num_lines);
}

ehd_status result_check_grid(const stored_result *stored, const char *path, const ehd_grid *grid,
                             ehd_error *error) {
    const ehd_grid whole = grid_whole(grid);
    const ehd_grid own = result_grid(stored);

    return grid_check(&own, path, &whole, "the scene", error);
}
