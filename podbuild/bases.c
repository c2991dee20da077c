/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds trial and test bases: the POD of the pressures and, if independent, of the deflections
 * (eqs. 24 and 26), the weight D (eq. 27), and the coordinates of the states, Vᵀ p.
 * Called by main.c, and by snapgen/trial.c for models during adaptive training. */
#include "podbuild/bases.h"

#include "common/algebra/rounding.h"
#include "common/physics/deflection.h"
#include "common/program/arena.h"
#include "podbuild/test_weight.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- readings

/* Data for reading all sources several times. The rows are read for the modes, the states for the
 * coordinates. */
typedef struct reading {
    snapshot_set *from;
    const bases_plan *plan;
    const program *caller; // NULL: no progress, no interruption
    progress shown;
    size_t done;                // number of fields that have been read
    const char *what;           // what is computed, for progress and messages
    double *fields;             // [1 or batch, num_nodes] pressures
    double *deflected;          // [1 or batch, num_nodes] deflections; NULL if coupled
    ehd_deflection *deflection; // NULL if coupled
} reading;

/* Returns the total number of fields that are read, for the progress display. */
static size_t count_readings(const snapshot_set *from, bool independent) {
    size_t count = from->num_rows * (independent ? 2 : 1);

    for (size_t i = 0; i < from->num_sources; i++)
        count += from->sources[i].is_part ? from->sources[i].num_rows : from->sources[i].num_states;
    return count;
}

static ehd_status make_room(double **fields, const reading *self, size_t num_fields,
                            ehd_error *error) {
    double *longer = array_resize(*fields, num_fields, self->from->grid.num_nodes, sizeof *longer);

    if (!longer) return ehd_no_memory(error, "fields");
    *fields = longer;
    return EHD_OK;
}

static ehd_status reading_start(reading *self, snapshot_set *from, const bases_plan *plan,
                                bool independent, const program *caller, ehd_error *error) {
    *self = (reading){.from = from, .plan = plan, .caller = caller};
    if (caller) progress_start(&self->shown, caller, count_readings(from, independent));
    ehd_status status = make_room(&self->fields, self, 1, error);
    if (status || !independent) return status;
    self->deflection = deflection_create(from->kind, &from->grid);
    return self->deflection ? make_room(&self->deflected, self, 1, error)
                            : ehd_no_memory(error, "deflections");
}

static void reading_end(reading *self) {
    if (self->caller) progress_finish(&self->shown);
    free(self->fields);
    free(self->deflected);
    deflection_free(self->deflection);
}

static ehd_status go_on(reading *self, ehd_error *error) {
    if (!self->caller) return EHD_OK;
    progress_show(&self->shown, ++self->done, self->what);
    return program_interrupted() ? ehd_fail(error, EHD_INTERRUPTED, "%s: interrupted", self->what)
                                 : EHD_OK;
}

/* Puts the path of a source in front of a message about its snapshots. */
static ehd_status name_source(ehd_error *error, ehd_status status, const snapshot_source *source,
                              const ehd_error *cause) {
    if (!status) return EHD_OK;
    return source->path ? ehd_fail(error, status, "%s: %s", source->path, cause->text)
                        : ehd_fail(error, status, "%s", cause->text);
}

// ---- modes

static ehd_status stream_rows(pod_stream *stream, reading *self, size_t index, bool deflected,
                              ehd_error *error) {
    ehd_status status = snapshot_set_use(self->from, index, error);
    const snapshot_source *source = &self->from->sources[index];
    ehd_error cause = {""};

    for (size_t row = 0; row < source->num_rows && !status; row++) {
        status = snapshot_set_row(self->fields, self->from, index, row, error);
        if (status) break;
        if (deflected) deflection_apply(self->deflected, self->deflection, self->fields);
        status = pod_stream_add(stream, deflected ? self->deflected : self->fields, 1, &cause);
        status = status ? name_source(error, status, source, &cause) : go_on(self, error);
    }
    pod_stream_inherit(stream, source->origin.energy * source->origin.discarded);
    snapshot_set_leave(self->from, index);
    return status;
}

/* Computes the POD of all rows, or of their deflections if `deflected`. Deflection is linear in the
 * pressure. Deflections of compressed snapshots can therefore replace the deflections of the
 * original snapshots. Boundary nodes are included, because they have a film. */
static ehd_status find_modes(pod_basis *pod, reading *self, const pod_settings *wanted,
                             bool deflected, ehd_error *error) {
    pod_stream *stream = NULL;
    ehd_status status =
        pod_stream_create(&stream, self->from->grid.num_nodes, &self->plan->stream, error);
    ehd_error cause = {""};

    self->what = deflected ? "deflections" : "pressures";
    for (size_t i = 0; i < self->from->num_sources && !status; i++)
        status = stream_rows(stream, self, i, deflected, error);
    if (!status)
        status = name_source(error, pod_stream_finish(pod, stream, wanted, &cause),
                             self->from->sources, &cause);
    pod_stream_free(stream);
    return status;
}

/* Returns the settings for the POD of the rows, with the energy that the modes may omit. This
 * energy is smaller if some rows come from part files, which have already omitted energy, or if the
 * modes are written as a part file. */
static pod_settings share_of(const pod_settings *wanted, const snapshot_set *from,
                             const bases_settings *settings) {
    const double share = settings->as_part     ? SMALL_SHARE
                         : from->num_parts > 0 ? bases_modes_share()
                                               : 1;
    pod_settings root = *wanted;

    root.discarded_energy *= share * share;
    return root;
}

/* Checks that part files have not omitted too much energy. The limit is a fraction of the allowed
 * energy. If a given number of modes omits more than the allowed energy, the limit is a fraction of
 * the energy that these modes omit. */
static ehd_status check_distance(const pod_basis *pod, const snapshot_set *from,
                                 const bases_settings *settings, const bases_plan *plan,
                                 ehd_error *error) {
    const double share = 2 * SMALL_SHARE;
    const double asked = sqrt(plan->energy * pod->energy);
    const double left_out =
        settings->pressure.num_modes > 0 ? sqrt(pod->tail) / bases_modes_share() : 0;
    const double most = fmax(asked, left_out);

    if (from->num_parts == 0 || pod->distance <= (1 + ROUNDING) * share * most) return EHD_OK;
    return ehd_fail(
        error, EHD_DATA,
        "%s: found parts that leave out %.1e of the energy, expected at most %.1e; compress "
        "them with --energy %.1e or less",
        from->sources[0].path, pod->distance * pod->distance / pod->energy,
        share * share * most * most / pod->energy, most * most / pod->energy);
}

// ---- coordinates

/* Computes the coordinates of fields in the modes, [num_fields, num_modes]. Row i begins at
 * coordinates[i * stride]. */
static void project(double *coordinates, size_t stride, const double *fields, size_t num_fields,
                    const pod_basis *pod) {
    const int modes = (int)pod->num_modes, nodes = (int)pod->num_nodes;

    if (num_fields == 1) // faster than a product with a matrix of one row
        cblas_dgemv(CblasRowMajor, CblasNoTrans, modes, nodes, 1, pod->modes, nodes, fields, 1, 0,
                    coordinates, 1);
    else if (num_fields > 0)
        cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, (int)num_fields, modes, nodes, 1,
                    fields, nodes, pod->modes, nodes, 0, coordinates, (int)stride);
}

/* Copies all states of `from` to `to`, beginning with state `first` of `to`. Of the coordinates,
 * copies only the last one, the rigid approach. */
static void put_states(reduced_states *to, size_t first, const reduced_states *from) {
    for (size_t s = 0; s < from->num_states; s++)
        to->coordinates[(first + s + 1) * to->num_unknowns - 1] =
            from->coordinates[(s + 1) * from->num_unknowns - 1];
    reduced_states_put(to, first, from);
}

/* Reads `count` states of a source, beginning with state `s`. Writes their coordinates and exits
 * to `states`, beginning with state `first`. */
static ehd_status project_batch(reduced_states *states, size_t first, reading *self, size_t index,
                                size_t s, size_t count, const pod_basis pods[2], ehd_error *error) {
    const ehd_grid *grid = &self->from->grid;
    double *to = states->coordinates + first * states->num_unknowns;
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < count && !status; i++) {
        double *field = self->fields + i * grid->num_nodes;
        status = snapshot_set_state(field, self->from, index, s + i, error);
        if (status) break;
        if (self->deflection)
            deflection_apply(self->deflected + i * grid->num_nodes, self->deflection, field);
        grid_exit_columns(states->exit + (first + i) * states->num_lines, field, grid);
        status = go_on(self, error);
    }
    if (status) return status;
    project(to, states->num_unknowns, self->fields, count, &pods[0]);
    if (self->deflection)
        project(to + pods[0].num_modes, states->num_unknowns, self->deflected, count, &pods[1]);
    return EHD_OK;
}

static ehd_status project_states(reduced_states *states, size_t first, reading *self, size_t index,
                                 const pod_basis pods[2], ehd_error *error) {
    const snapshot_source *source = &self->from->sources[index];
    const size_t batch = self->plan->batch;
    ehd_status status = EHD_OK;

    put_states(states, first, &source->states);
    for (size_t s = 0; s < source->num_states && !status; s += batch) {
        const size_t left = source->num_states - s;
        status = project_batch(states, first + s, self, index, s, left < batch ? left : batch, pods,
                               error);
    }
    return status;
}

/* Projects the modes of a part onto the new modes. `turned`: [num_rows, num_modes] projections. */
static ehd_status project_modes(double *turned, reading *self, size_t index, const pod_basis *pod,
                                ehd_error *error) {
    const size_t num_rows = self->from->sources[index].num_rows, batch = self->plan->batch;
    ehd_status status = EHD_OK;

    for (size_t first = 0; first < num_rows && !status; first += batch) {
        const size_t left = num_rows - first, count = left < batch ? left : batch;
        for (size_t i = 0; i < count && !status; i++) {
            status = snapshot_set_mode(self->fields + i * pod->num_nodes, self->from, index,
                                       first + i, error);
            if (!status) status = go_on(self, error);
        }
        project(turned + first * pod->num_modes, pod->num_modes, self->fields, count, pod);
    }
    return status;
}

/* Adds the states of a part. Multiplies their coordinates in the modes of the part by the
 * projections of these modes onto the new modes. */
static ehd_status project_part(reduced_states *states, size_t first, reading *self, size_t index,
                               const pod_basis *pod, ehd_error *error) {
    const snapshot_source *source = &self->from->sources[index];
    const size_t num = pod->num_modes;
    double *turned = array_new(source->num_rows, num, sizeof *turned);
    double *to = states->coordinates + first * states->num_unknowns;
    reduced_states own = {0};
    ehd_status status = turned ? project_modes(turned, self, index, pod, error)
                               : ehd_no_memory(error, "coordinates");

    if (!status) status = part_read_states(&own, source->file, &self->from->grid, error);
    if (!status) {
        cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)own.num_states, (int)num,
                    (int)source->num_rows, 1, own.coordinates, (int)own.num_unknowns, turned,
                    (int)num, 0, to, (int)states->num_unknowns);
        put_states(states, first, &own);
    }
    reduced_states_free(&own);
    free(turned);
    return status;
}

static ehd_status find_coordinates(reduced_states *states, reading *self, const pod_basis pods[2],
                                   ehd_error *error) {
    snapshot_set *from = self->from;
    size_t first = 0;
    ehd_status status =
        reduced_states_init(states, from->num_states, grid_lines(&from->grid),
                            reduced_num_unknowns(pods[0].num_modes, pods[1].num_modes), error);

    self->what = "coordinates";
    if (!status) status = make_room(&self->fields, self, self->plan->batch, error);
    if (!status && self->deflection)
        status = make_room(&self->deflected, self, self->plan->batch, error);
    for (size_t i = 0; i < from->num_sources && !status; i++) {
        status = snapshot_set_use(from, i, error);
        if (!status)
            status = from->sources[i].is_part
                         ? project_part(states, first, self, i, &pods[0], error)
                         : project_states(states, first, self, i, pods, error);
        first += from->sources[i].num_states;
        snapshot_set_leave(from, i);
    }
    return status;
}

// ---- bases

/* Moves the modes of a POD to an array [num_nodes, num_modes], and frees them in the POD. */
static ehd_status take_modes(double **modes, size_t *num_modes, pod_basis *pod, ehd_error *error) {
    const size_t num = *num_modes = pod->num_modes;

    if (num == 0) return EHD_OK;
    *modes = array_new(pod->num_nodes, num, sizeof **modes);
    if (!*modes) return ehd_no_memory(error, "bases");
    for (size_t j = 0; j < num; j++)
        for (size_t k = 0; k < pod->num_nodes; k++)
            (*modes)[k * num + j] = pod->modes[j * pod->num_nodes + k];
    free(pod->modes);
    pod->modes = NULL;
    return EHD_OK;
}

static ehd_status take_all(reduced_basis *basis, pod_basis pods[2], ehd_error *error) {
    ehd_status status = take_modes(&basis->pressure, &basis->num_pressure, &pods[0], error);

    if (!status)
        status = take_modes(&basis->deformation_modes, &basis->num_deformation, &pods[1], error);
    if (status) return status;
    basis->weight = array_new(basis->grid.num_nodes, 1, sizeof(double));
    return basis->weight ? test_weight_mode(basis->weight, basis, NULL, 0, error)
                         : ehd_no_memory(error, "bases");
}

static ehd_status build(reduced_basis *basis, pod_basis pods[2], reading *self,
                        const bases_settings *settings, ehd_error *error) {
    const snapshot_set *from = self->from;
    const pod_settings pressure = share_of(&settings->pressure, from, settings);
    const pod_settings deformation = share_of(&settings->deformation, from, settings);
    ehd_status status = find_modes(&pods[0], self, &pressure, false, error);

    if (!status && settings->kind == DEFORMATION_INDEPENDENT)
        status = find_modes(&pods[1], self, &deformation, true, error);
    if (!status) status = check_distance(&pods[0], from, settings, self->plan, error);
    if (!status) status = find_coordinates(&basis->states, self, pods, error);
    return status ? status : take_all(basis, pods, error);
}

ehd_status bases_build(reduced_basis *basis, pod_basis *pressure_pod, pod_basis *deformation_pod,
                       snapshot_set *from, const bases_settings *settings, const bases_plan *plan,
                       const program *caller, ehd_error *error) {
    const bases_plan whole = bases_plan_at_once(from, settings);
    const bool independent = settings->kind == DEFORMATION_INDEPENDENT;
    pod_basis pods[2] = {{0}};
    reading self;

    *basis = (reduced_basis){.kind = from->kind,
                             .grid = from->grid,
                             .carriage = from->carriage,
                             .deformation = settings->kind};
    ehd_status status =
        reading_start(&self, from, plan ? plan : &whole, independent, caller, error);
    if (!status) status = build(basis, pods, &self, settings, error);
    reading_end(&self);
    if (status) {
        reduced_basis_free(basis);
        pod_free(&pods[0]);
        pod_free(&pods[1]);
    }
    *pressure_pod = pods[0];
    *deformation_pod = pods[1];
    return status;
}
