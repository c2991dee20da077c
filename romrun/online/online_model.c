/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens models and lists of models, and prepares them for fields and for transient scenes. Called
 * by romrun, the library and FMUs through online.h. */
#include "romrun/model/model_file.h"
#include "romrun/online/online_objects.h"
#include "romrun/solve/guess.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool same_size(size_t wanted, size_t own) {
    return wanted == 0 || wanted == own;
}

/* Opens all parts of a flat file. The parts follow one another in the file. */
static ehd_status open_flat(online_model *self, size_t index, const model_sizes *sizes,
                            ehd_error *error) {
    const char *path = self->list.paths[index];
    const size_t first = self->num_parts;
    flat *file = &self->files[index];
    ehd_status status = flat_read(file, path, error);

    do {
        model_part *part = &self->parts[self->num_parts];
        if (status) return status;
        if (self->num_parts == MAX_PARTS)
            return ehd_fail(error, EHD_DATA, "%s: found more than %d models, expected fewer", path,
                            MAX_PARTS);
        self->num_parts++;
        part->path = path;
        part->flat = true;
        part_walk(file, part);
        status = flat_good(file) ? part_finish(part, error) : file->status;
    } while (file->at < file->size);
    if (status || !sizes) return status;
    const reduced_model *model = &self->parts[first].reduced;
    if (self->num_parts == first + 1 && same_size(sizes->pressure_modes, model->num_pressure) &&
        same_size(sizes->deformation_modes, model->num_deformation) &&
        same_size(sizes->rows, model->rows.num_rows))
        return EHD_OK;
    if (self->num_parts > first + 1 &&
        !(sizes->pressure_modes || sizes->deformation_modes || sizes->rows))
        return EHD_OK;
    flat_refuse(file,
                "found a flat model of %zu pressure modes, %zu deformation modes and %zu rows, "
                "expected no others to be asked for",
                model->num_pressure, model->num_deformation, model->rows.num_rows);
    return file->status;
}

static ehd_status open_file(online_model *self, size_t index, const model_sizes *sizes,
                            ehd_error *error) {
    const char *path = self->list.paths[index];
    bool is_flat = false;
    ehd_status status = flat_is(&is_flat, path, error);

    if (status) return status;
    if (is_flat) return open_flat(self, index, sizes, error);
    if (self->num_parts == MAX_PARTS)
        return ehd_fail(error, EHD_DATA, "%s: found more than %d models, expected fewer",
                        self->path, MAX_PARTS);
    return part_open(&self->parts[self->num_parts++], path, sizes, error);
}

/* Checks whether two parts can be in one list. They need the same kind of contact, discretisation
 * and boundary. Point contacts and ellipses also need the same grid. */
static bool alike(const reduced_model *a, const reduced_model *b) {
    return a->kind == b->kind && a->grid.discretization == b->grid.discretization &&
           a->grid.boundary == b->grid.boundary &&
           (a->kind->dimensions == 1 || grid_same(&a->grid, &b->grid));
}

/* Checks whether all parts can be in one list, with the same transport and smoothing of films. */
static ehd_status check_alike(const online_model *self, ehd_error *error) {
    const reduced_model *first = &self->parts[0].reduced;

    for (size_t p = 1; p < self->num_parts; p++) {
        const reduced_model *other = &self->parts[p].reduced;
        if (!alike(other, first))
            return ehd_fail(
                error, EHD_DATA,
                "%s: found a %s contact with %zu nodes from %g in steps of %g (%s, %s), "
                "expected one as of %s: a %s contact with %zu from %g in steps of %g (%s, %s)",
                self->parts[p].path, other->kind->name, other->grid.num_inner, other->grid.x_min,
                other->grid.step, discretization_names[other->grid.discretization],
                boundary_names[other->grid.boundary], self->parts[0].path, first->kind->name,
                first->grid.num_inner, first->grid.x_min, first->grid.step,
                discretization_names[first->grid.discretization],
                boundary_names[first->grid.boundary]);
        const ehd_status status = carriage_check(&other->carriage, self->parts[p].path,
                                                 &first->carriage, self->parts[0].path, error);
        if (status) return status;
    }
    return EHD_OK;
}

/* Returns the first part whose grid differs from the grid of part 0, or 0 if there is none. */
static size_t part_of_other_grid(const online_model *self) {
    for (size_t p = 1; p < self->num_parts; p++)
        if (!grid_same(&self->parts[p].reduced.grid, &self->parts[0].reduced.grid)) return p;
    return 0;
}

ehd_status online_open(online_model **model, const char *path, const part_sizes *sizes,
                       ehd_error *error) {
    online_model *self = calloc(1, sizeof *self);

    *model = NULL;
    if (self) self->path = strdup(path);
    if (!self || !self->path) {
        free(self);
        return ehd_no_memory(error, path);
    }
    ehd_status status = part_list_read(&self->list, path, error);
    if (!status) {
        self->files = calloc(self->list.num, sizeof *self->files);
        if (!self->files) status = ehd_no_memory(error, path);
    }
    for (size_t i = 0; i < self->list.num && !status; i++)
        status = open_file(self, i, sizes ? &sizes->of[i] : NULL, error);
    if (!status) status = check_alike(self, error);
    if (status)
        online_close(self);
    else
        *model = self;
    return status;
}

void online_release_file(online_model *self) {
    for (size_t p = 0; p < self->num_parts; p++)
        artefact_close(&self->parts[p].source);
}

online_model *online_close(online_model *self) {
    if (!self) return NULL;
    for (size_t p = 0; p < self->num_parts; p++)
        part_close(&self->parts[p]);
    for (size_t i = 0; i < self->list.num && self->files; i++)
        if (self->files[i].reading) flat_free(&self->files[i]);
    part_list_free(&self->list);
    free(self->files);
    free(self->path);
    free(self);
    return NULL;
}

ehd_status online_is_flat(bool *is, const char *path, ehd_error *error) {
    *is = false;
    return part_list_is(path) ? EHD_OK : flat_is(is, path, error);
}

ehd_status online_export(online_model *self, const char *path, bool force, ehd_error *error) {
    flat file;
    bool in_time = true;
    ehd_status status = EHD_OK;

    for (size_t p = 0; p < self->num_parts; p++) {
        const model_part *part = &self->parts[p];
        in_time = in_time && (part->transient ||
                              (part->source && model_has_modes(part->source, &part->reduced)));
    }
    in_time = in_time && !part_of_other_grid(self);
    status = in_time ? online_prepare_transient(self, error) : online_prepare_fields(self, error);
    if (status) return status;
    flat_begin(&file, path, error);
    for (size_t p = 0; p < self->num_parts; p++)
        part_walk(&file, &self->parts[p]);
    status = flat_write(&file, force);
    flat_free(&file);
    return status;
}

online_properties online_describe(const online_model *self) {
    const reduced_model *largest = &self->parts[0].reduced;
    const ehd_grid *grid = online_grid(self);
    bool checked = true, checked_in_time = true;
    size_t num_states = 0;

    for (size_t p = 0; p < self->num_parts; p++) {
        const model_part *part = &self->parts[p];
        checked = checked && part->indicator_factor > 0;
        checked_in_time = checked_in_time && part->checked_in_time;
        num_states += part->reduced.states.num_states;
        if (part->reduced.num_unknowns > largest->num_unknowns) largest = &part->reduced;
    }
    return (online_properties){.num_nodes = grid->num_nodes,
                               .discretization = discretization_names[grid->discretization],
                               .boundary = boundary_names[grid->boundary],
                               .transport = transport_names[largest->carriage.transport],
                               .pressure_modes = largest->num_pressure,
                               .deformation_modes = largest->num_deformation,
                               .unknowns = largest->num_unknowns,
                               .rows = largest->rows.num_rows,
                               .states = num_states,
                               .parts = self->num_parts,
                               .checked = checked,
                               .checked_in_time = checked_in_time};
}

const char *online_unchecked(const online_properties *model, bool in_time) {
    if (in_time)
        return model->checked_in_time
                   ? NULL
                   : "a model without a successful check in time at these sizes, which romrun "
                     "calibrate does with a transient plan, and deimselect of a transient "
                     "training without --no-check";
    return model->checked ? NULL
                          : "a model never checked at these sizes, which romrun calibrate does, "
                            "and deimselect without --no-check";
}

const contact_kind *online_kind(const online_model *model) {
    return model->parts[0].reduced.kind;
}

const char *online_path(const online_model *model) {
    return model->path;
}

const char *online_part_path(const online_model *model, size_t part) {
    return model->parts[part].path;
}

const ehd_grid *online_grid(const online_model *model) {
    const ehd_grid *largest = &model->parts[0].reduced.grid;

    for (size_t p = 1; p < model->num_parts; p++)
        if (model->parts[p].reduced.grid.num_nodes > largest->num_nodes)
            largest = &model->parts[p].reduced.grid;
    return largest;
}

ehd_status online_check_in_time(const online_model *model, ehd_error *error) {
    const size_t other = part_of_other_grid(model);
    const ehd_grid *first = &model->parts[0].reduced.grid, *of = &model->parts[other].reduced.grid;

    if (other)
        return ehd_fail(error, EHD_DATA,
                        "%s: found %zu nodes from %g in steps of %g, expected for contacts in time "
                        "the grid of %s, %zu from %g in steps of %g: parts hand films to each "
                        "other node by node",
                        model->parts[other].path, of->num_inner, of->x_min, of->step,
                        model->parts[0].path, first->num_inner, first->x_min, first->step);
    return discretization_check_in_time(first->discretization, error);
}

ehd_status online_prepare_fields(online_model *self, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t p = 0; p < self->num_parts && !status; p++)
        status = part_prepare_fields(&self->parts[p], error);
    return status;
}

ehd_status online_prepare_transient(online_model *self, ehd_error *error) {
    ehd_status status = online_check_in_time(self, error);

    for (size_t p = 0; p < self->num_parts && !status; p++)
        status = part_prepare_transient(&self->parts[p], error);
    return status;
}

size_t online_part_for(const online_model *self, const part_solver *solvers,
                       const ehd_contact *contact) {
    const contact_place place = contact_place_of(contact);
    bool fits[MAX_PARTS], any = false;
    double least = INFINITY;
    size_t found = 0;

    if (self->num_parts == 1) return 0;
    for (size_t p = 0; p < self->num_parts; p++) {
        fits[p] = !part_check_contact(&self->parts[p], contact, NULL);
        any = any || fits[p];
    }
    for (size_t p = 0; p < self->num_parts; p++) {
        range_memory *memory = solvers ? solvers[p].range_memory : NULL;
        if (any && !fits[p]) continue;
        const double here = trained_range_outside(self->parts[p].range, memory, place);
        if (!(here < least)) continue;
        least = here;
        found = p;
    }
    return found;
}

ehd_status online_show(online_model *model, const shown_lubricants *shown, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (size_t p = 0; p < model->num_parts && !status; p++)
        status = part_show(&model->parts[p], shown, error);
    return status;
}

const ehd_grid *online_grid_for(const online_model *model, const ehd_contact *contact) {
    return &model->parts[online_part_for(model, NULL, contact)].reduced.grid;
}

film_effects online_effects(const online_model *model, const ehd_contact *contact) {
    const model_part *part = &model->parts[online_part_for(model, NULL, contact)];

    return reduced_effects(&part->reduced, contact_place_of(contact));
}

bool online_has_traction(const online_model *model) {
    bool all = true;

    for (size_t p = 0; p < model->num_parts; p++)
        all = all && part_has_traction(&model->parts[p]);
    return all;
}
