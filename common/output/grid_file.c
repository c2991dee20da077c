/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/grid_file.h"

#include "common/settings/scene_contact.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double COARSEST_STEP = 0.25; // Bounds of the grid step, half widths, as for scenes

/* Writes an axis. `along` is the difference between the row numbers (grid_node_of_row) of
 * neighbouring nodes of the axis. */
static ehd_status write_axis(artefact *file, const char *name, size_t length, size_t along,
                             const ehd_grid *grid, double place(const ehd_grid *, size_t),
                             ehd_error *error) {
    double *values = malloc(length * sizeof *values);
    if (!values) return ehd_no_memory(error, artefact_path(file));

    for (size_t i = 0; i < length; i++)
        values[i] = place(grid, grid_node_of_row(grid, i * along));
    ehd_status status = artefact_put_axis(file, name, length, values, error);
    free(values);
    return status;
}

ehd_status grid_write_axes(artefact *file, const ehd_grid *grid, ehd_error *error) {
    ehd_status status = write_axis(file, "x", grid->inner_x, 1, grid, grid_x, error);

    if (status || grid->inner_lines == 1) return status;
    return write_axis(file, "y", grid->inner_lines, grid->inner_x, grid, grid_y, error);
}

/* Return the number of values that a file has for a field at the inner nodes, and the grid node of
 * each value. */
static size_t count_inner(const ehd_grid *grid, bool mirrored) {
    return mirrored ? grid_whole(grid).num_inner : grid->num_inner;
}

static size_t node_of_inner(const ehd_grid *grid, size_t row, bool mirrored) {
    return grid_node_of_row(grid, mirrored ? grid_row_of_whole(grid, row) : row);
}

void grid_take_inner(double *inner, const double *nodes, const ehd_grid *grid, bool mirrored) {
    size_t count = count_inner(grid, mirrored);

    for (size_t r = 0; r < count; r++)
        inner[r] = nodes[node_of_inner(grid, r, mirrored)];
}

void grid_put_inner(double *nodes, const double *inner, const ehd_grid *grid, bool mirrored) {
    size_t count = count_inner(grid, mirrored);

    for (size_t r = 0; r < count; r++)
        nodes[node_of_inner(grid, r, mirrored)] = inner[r];
}

ehd_status grid_put_field(artefact *file, const char *name, size_t index, const double *nodes,
                          const ehd_grid *grid, bool mirrored, ehd_error *error) {
    size_t count = count_inner(grid, mirrored);
    double *inner = malloc(count * sizeof *inner);
    if (!inner) return ehd_no_memory(error, artefact_path(file));

    grid_take_inner(inner, nodes, grid, mirrored);
    ehd_status status = artefact_put_part(file, name, index, 1, inner, error);
    free(inner);
    return status;
}

ehd_status grid_write_attributes(artefact *file, const contact_kind *kind, const ehd_grid *grid,
                                 ehd_error *error) {
    ehd_status status = artefact_put_text(file, "contact", kind->name, error);

    if (!status) status = artefact_put_real(file, "x_min", grid->x_min, error);
    if (!status) status = artefact_put_real(file, "step", grid->step, error);
    if (!status)
        status = artefact_put_text(file, "discretization",
                                   discretization_names[grid->discretization], error);
    if (!status && kind->dimensions > 1)
        status = artefact_put_text(file, "boundary", boundary_names[grid->boundary], error);
    if (!status && kind == &contact_ellipse)
        status = artefact_put_real(file, "ellipticity", grid->shape.ellipticity, error);
    return status;
}

ehd_status grid_write(artefact *file, const contact_kind *kind, const ehd_grid *grid,
                      ehd_error *error) {
    ehd_status status = grid_write_axes(file, grid, error);

    if (!status) status = grid_write_attributes(file, kind, grid, error);
    if (!status && grid->half) status = artefact_put_integer(file, "half", 1, error);
    return status;
}

ehd_status grid_count_lines(size_t *num_lines, artefact *file, const contact_kind *kind,
                            ehd_error *error) {
    size_t found = artefact_length(file, "y");
    bool across = kind->dimensions > 1;

    *num_lines = across ? found : 1;
    if (across ? found >= 2 : found == 0) return EHD_OK;
    return ehd_fail(error, EHD_DATA, "%s: y: found %zu lines, expected %s, of a %s contact",
                    artefact_path(file), found, across ? "several" : "none", kind->name);
}

ehd_status name_read(unsigned *index, artefact *file, const char *attribute,
                     const char *const *names, const char *expected, ehd_error *error) {
    char *name = NULL;

    *index = 0;
    if (!artefact_has(file, attribute)) return EHD_OK;
    ehd_status status = artefact_get_text(file, attribute, &name, error);
    if (!status && !name_find(index, names, name))
        status = ehd_fail(error, EHD_DATA, "%s: %s: found %.32s, expected %s", artefact_path(file),
                          attribute, name, expected);
    free(name);
    return status;
}

ehd_status grid_read_discretization(ehd_discretization *discretization, artefact *file,
                                    ehd_error *error) {
    return name_read(discretization, file, "discretization", discretization_names,
                     "accurate|cross-flux|published", error);
}

ehd_status grid_read_boundary(ehd_boundary *boundary, artefact *file, ehd_error *error) {
    return name_read(boundary, file, "boundary", boundary_names, "open|zero", error);
}

ehd_status grid_read_shape(contact_shape *shape, artefact *file, const contact_kind *kind,
                           ehd_error *error) {
    double found = NAN;

    *shape = shape_round;
    if (kind != &contact_ellipse) return EHD_OK;
    const ehd_status status = artefact_has(file, "ellipticity")
                                  ? artefact_get_real(file, "ellipticity", &found, error)
                                  : EHD_OK;
    if (status) return status;
    if (!(found >= MIN_ELLIPTICITY && found <= MAX_ELLIPTICITY))
        return ehd_fail(error, EHD_DATA, "%s: ellipticity: found %g, expected %g to %g",
                        artefact_path(file), found, MIN_ELLIPTICITY, MAX_ELLIPTICITY);
    *shape = shape_of(found);
    return EHD_OK;
}

ehd_status contact_kind_read(const contact_kind **kind, artefact *file, ehd_error *error) {
    char *name = NULL;
    ehd_status status = artefact_get_text(file, "contact", &name, error);

    *kind = status ? &contact_line : contact_kind_find(name);
    if (!*kind)
        status = ehd_fail(error, EHD_DATA, "%s: contact: found %.32s, expected %s|%s|%s",
                          artefact_path(file), name, contact_line.name, contact_point.name,
                          contact_ellipse.name);
    free(name);
    return status;
}

ehd_status grid_read(ehd_grid *grid, const contact_kind **kind, artefact *file, ehd_error *error) {
    ehd_status status = contact_kind_read(kind, file, error);

    if (!status) status = artefact_get_real(file, "x_min", &grid->x_min, error);
    if (!status) status = artefact_get_real(file, "step", &grid->step, error);
    size_t num_lines = 1;
    int64_t half = 0;
    if (!status) status = grid_count_lines(&num_lines, file, *kind, error);
    if (!status && artefact_has(file, "half"))
        status = artefact_get_integer(file, "half", &half, error);
    ehd_grid like = {.half = num_lines > 1 && half != 0};
    if (!status) status = grid_read_discretization(&like.discretization, file, error);
    if (!status && num_lines > 1) status = grid_read_boundary(&like.boundary, file, error);
    if (!status) status = grid_read_shape(&like.shape, file, *kind, error);
    if (status) return status;
    *grid = grid_like(&like, grid->x_min, grid->step, artefact_length(file, "x"), num_lines);
    return grid_check_extent(grid, artefact_path(file), error);
}

ehd_status grid_check_extent(const ehd_grid *grid, const char *path, ehd_error *error) {
    double x_max = grid->x_min + ((double)grid->inner_x - 1) * grid->step;
    if (!(grid->step > 0 && grid->step <= COARSEST_STEP && grid->x_min < -1 && x_max > 1))
        return ehd_fail(error, EHD_DATA,
                        "%s: x: found %g to %g in steps of %g, expected the dry contact inside and "
                        "steps of at most %g",
                        path, grid->x_min, x_max, grid->step, COARSEST_STEP);
    return EHD_OK;
}

ehd_status carriage_write(artefact *file, const ehd_carriage *carriage, ehd_error *error) {
    ehd_status status =
        artefact_put_text(file, "transport", transport_names[carriage->transport], error);

    if (!status && carriage->transport == TRANSPORT_PATH && !isnan(carriage->smoothing))
        status = artefact_put_real(file, "smoothing", carriage->smoothing, error);
    return status;
}

ehd_status carriage_read(ehd_carriage *carriage, artefact *file, ehd_error *error) {
    *carriage = (ehd_carriage){TRANSPORT_UPWIND, NAN};
    if (!artefact_has(file, "transport")) return EHD_OK;
    ehd_status status =
        name_read(&carriage->transport, file, "transport", transport_names, "path|upwind", error);

    if (!status && artefact_has(file, "smoothing"))
        status = artefact_get_real(file, "smoothing", &carriage->smoothing, error);
    if (!status && !isnan(carriage->smoothing) &&
        !(carriage->smoothing >= 0 && carriage->smoothing <= 1))
        status = ehd_fail(error, EHD_DATA, "%s: smoothing: found %g, expected 0 to 1",
                          artefact_path(file), carriage->smoothing);
    return status;
}

ehd_status grid_of_file(ehd_grid *grid, const contact_kind **kind, const char *path,
                        ehd_error *error) {
    static const artefact_schema *const schemas[] = {&schema_snapshots, &schema_basis,
                                                     &schema_model, &schema_result, NULL};
    artefact *file = NULL;
    ehd_status status = artefact_open(&file, path, schemas, error);

    if (!status && artefact_length(file, "x") == 0)
        status = ehd_fail(error, EHD_DATA, "%s: x: found none, expected a file with fields", path);
    if (!status) status = grid_read(grid, kind, file, error);
    // a result has both halves of a point contact, but programs solve a half grid
    if (!status && grid->inner_lines > 1 && artefact_kind(file) == &schema_result) {
        ehd_grid half = *grid;
        half.half = true;
        *grid = grid_like(&half, grid->x_min, grid->step, grid->inner_x, grid->inner_lines / 2 + 1);
    }
    artefact_close(&file);
    return status;
}

ehd_status grid_check_shape(const ehd_grid *grid, const char *path, const ehd_grid *expected,
                            const char *expected_path, ehd_error *error) {
    if (shape_same(&grid->shape, &expected->shape)) return EHD_OK;
    return ehd_fail(error, EHD_DATA, "%s: ellipticity: found %.9g, expected %.9g, as in %s", path,
                    grid->shape.ellipticity, expected->shape.ellipticity, expected_path);
}

ehd_status grid_check(const ehd_grid *grid, const char *path, const ehd_grid *expected,
                      const char *expected_path, ehd_error *error) {
    if (grid_same(grid, expected)) return EHD_OK;
    if (grid->discretization != expected->discretization)
        return ehd_fail(error, EHD_DATA, "%s: discretization: found %s, expected %s, as in %s",
                        path, discretization_names[grid->discretization],
                        discretization_names[expected->discretization], expected_path);
    if (grid->inner_lines > 1 && expected->inner_lines > 1 && grid->boundary != expected->boundary)
        return ehd_fail(error, EHD_DATA, "%s: boundary: found %s, expected %s, as in %s", path,
                        boundary_names[grid->boundary], boundary_names[expected->boundary],
                        expected_path);
    const ehd_status status = grid_check_shape(grid, path, expected, expected_path, error);
    if (status) return status;
    return ehd_fail(error, EHD_DATA,
                    "%s: x: found %zu nodes from %g by %g, expected %zu from %g by %g, as in %s",
                    path, grid->num_inner, grid->x_min, grid->step, expected->num_inner,
                    expected->x_min, expected->step, expected_path);
}

ehd_status grid_check_memory(const program *caller, const char *object, const ehd_contact *contact,
                             double bytes, size_t num_jobs, ehd_error *error) {
    const double megabytes = bytes / 1e6;
    size_t num_nodes = contact->grid.num_inner;
    char jobs[48] = "";

    if (contact->kind->dimensions == 1) return EHD_OK;
    if (num_jobs > 1) snprintf(jobs, sizeof jobs, " with --jobs %zu", num_jobs);
    const ehd_status status =
        program_check_memory(object, "grid", num_nodes, "nodes", jobs, bytes, error);
    if (status) return status;
    (megabytes > 1000 ? program_note : program_detail)(caller, "%zu nodes take about %.0f MB%s",
                                                       num_nodes, megabytes, jobs);
    return EHD_OK;
}

void grid_print_nodes(const ehd_grid *grid) {
    const ehd_grid whole = grid_whole(grid);

    printf("%zu", whole.inner_x);
    if (whole.inner_lines > 1) printf(" by %zu", whole.inner_lines);
    printf(" nodes from %g to %g by %g", whole.x_min, grid_extent_of(&whole).x_max, whole.step);
}

void grid_print_equations(const ehd_contact *contact) {
    const ehd_grid *grid = &contact->grid;

    if (contact->kind == &contact_ellipse) {
        const double half_width = contact->half_width * 1e6;
        printf("%-24sb/a = %.8g", "ellipse", grid->shape.ellipticity);
        if (isfinite(half_width))
            printf(", a = %.6g µm, b = %.6g µm", half_width,
                   contact_half_width_across(contact) * 1e6);
        putchar('\n');
    }
    printf("%-24s%s\n", "discretization", discretization_names[grid->discretization]);
    if (contact->kind->dimensions > 1)
        printf("%-24s%s\n", "boundary",
               grid->boundary == BOUNDARY_OPEN ? "open, with the far field around the grid"
                                               : "zero pressure");
}

void grid_print(const ehd_contact *contact, const char *needed_by) {
    const bool chosen = contact_has_chosen_grid(contact);

    printf("%-24s", "grid");
    grid_print_nodes(&contact->grid);
    printf("%s%s\n", chosen ? ", as wide and fine as needed by " : "", chosen ? needed_by : "");
}

ehd_status scene_load(scene *given, char **text, const program *caller, ehd_error *error) {
    const char *path = caller->arguments[0];
    ehd_status status = scene_read(given, path, caller->overrides, caller->num_overrides, error);
    if (status) return status;

    *text = scene_text(given);
    return *text ? EHD_OK : ehd_no_memory(error, path);
}

ehd_status contact_load(ehd_contact *contact, const scene *given, const program *caller,
                        const contact_kind *kind, const char *model, ehd_error *error) {
    ehd_error cause = {""};
    ehd_status status = kind ? scene_check_kind(given, kind, model, &cause) : EHD_OK;

    if (!status) status = scene_contact(contact, given, &cause);
    if (status) return ehd_fail(error, status, "%s: %s", caller->arguments[0], cause.text);
    char text[PLAUSIBLE_TEXT];
    if (scene_judge(text, contact, given) != PLAUSIBLE)
        program_warn(caller, "%s: %s", caller->arguments[0], text);
    return EHD_OK;
}
