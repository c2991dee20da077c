/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "podbuild/stream_bases.h"

#include "common/physics/deflection.h"
#include "common/program/arena.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Shares of the root of the allowed energy, see stream_bases.h. */
static const double ROOT_SHARE = 0.9, LOCAL_SHARE = 0.05, PART_SHARE = 0.05;

/* Directions that are dropped while streaming may have this part of the energy of the
 * ROOT_SHARE. */
static const double TRUNCATED_SHARE = 0.25;

/* Allowed energy whose local share is 1e-22, as for trajectories. This keeps singular
 * values above 1e-11 of the first. */
static const double EXACT_ENERGY = 4e-20;

/* Lower limit of the local energy; below it there is only round-off. */
static const double LEAST_LOCAL = 1e-28;

// ---- memory

static pod_stream_settings shares(double energy, bool as_part) {
    const double root = as_part ? PART_SHARE / 2 : ROOT_SHARE;
    const double local = as_part ? PART_SHARE / 2 : LOCAL_SHARE;

    return (pod_stream_settings){.local_energy = fmax(local * local * energy, LEAST_LOCAL),
                                 .dropped_energy = TRUNCATED_SHARE * root * root * energy};
}

static double smaller(double a, double b) {
    return a < b ? a : b;
}

/* Returns the largest number of modes that a stream may have at its end. */
static double most_modes(const pod_settings *wanted, size_t max_rank) {
    return wanted->num_modes ? smaller((double)wanted->num_modes, (double)max_rank)
                             : (double)max_rank;
}

/* Returns the memory of the states with their coordinates, which are held and copied once for
 * writing. The states of a part are held twice too while they are read. */
static double state_bytes(const snapshot_files *files, double num_modes) {
    const double columns = 20, lines = (double)grid_lines(&files->grid);
    double rank = 0, longest = 0;

    for (size_t i = 0; i < files->num_files; i++)
        if (files->files[i].is_part) {
            rank = fmax(rank, (double)files->files[i].num_rows);
            longest = fmax(longest, (double)files->files[i].num_states);
        }
    return 8 * (double)files->num_states * (2 * (num_modes + 2) + 3 * lines + columns) +
           8 * longest * (2 * (rank + 2) + 2 * lines + columns) + 8 * rank * num_modes +
           snapshot_set_bytes(files);
}

/* Returns the largest memory over all stages of a stream. */
static double bytes_of_stream(const stream_plan *way, const snapshot_files *files,
                              const bases_settings *settings) {
    const bool independent = settings->kind == DEFORMATION_INDEPENDENT;
    const double nodes = (double)files->grid.num_nodes, a_field = 8 * nodes;
    const double few =
        (independent ? 24 : 6) * a_field; // rows that are read, and work arrays of the deflection
    const double pressure = most_modes(&settings->pressure, way->pressure.max_rank);
    const double deformation =
        independent ? most_modes(&settings->deformation, way->deformation.max_rank) : 0;
    const double batches = (independent ? 2 : 1) * (double)way->batch * a_field;
    double most = pod_stream_bytes(files->grid.num_nodes, files->num_rows, &way->pressure);

    if (independent)
        most =
            fmax(most, pressure * a_field + pod_stream_bytes(files->grid.num_nodes, files->num_rows,
                                                             &way->deformation));
    most = fmax(most, (pressure + deformation) * a_field + batches);
    // modes in the basis, and a second copy while they are transposed and written
    most = fmax(most, (pressure + deformation + fmax(pressure, deformation)) * a_field);
    return most + few + state_bytes(files, pressure + deformation);
}

/* Returns the memory of bases_build: states and snapshots, the copy and the modes in pod_build, and
 * the same arrays for deflections. */
static double bytes_at_once(const snapshot_files *files, const bases_settings *settings) {
    const bool independent = settings->kind == DEFORMATION_INDEPENDENT;
    const double nodes = (double)files->grid.num_nodes, states = (double)files->num_states;
    const double rows = (double)files->num_rows, values = smaller(rows, nodes);
    const double modes = most_modes(&settings->pressure, (size_t)values);
    const double more =
        independent ? states + rows + 2 * most_modes(&settings->deformation, (size_t)values) : 0;

    return 8 * nodes * (states + 2 * rows + 2 * modes + more + 6) + 8 * 7 * values * values +
           state_bytes(files, independent ? 2 * modes : modes);
}

static void take_room(stream_plan *way, size_t block, size_t rank) {
    way->pressure.block = way->deformation.block = way->batch = block;
    way->pressure.max_rank = way->deformation.max_rank = rank;
}

/* Arguments of bytes_with. */
typedef struct plan_work {
    const snapshot_files *files;
    const bases_settings *settings;
    const stream_plan *way;
} plan_work;

static double bytes_with(const void *work, size_t block, size_t rank) {
    const plan_work *self = work;
    stream_plan way = *self->way;

    take_room(&way, block, rank);
    return bytes_of_stream(&way, self->files, self->settings);
}

ehd_status stream_plan_make(stream_plan *way, const snapshot_files *files,
                            const bases_settings *settings, bool exact, bool as_part, double limit,
                            ehd_error *error) {
    const double energy = exact ? EXACT_ENERGY : settings->pressure.discarded_energy;
    const size_t rows = files->num_rows, nodes = files->grid.num_nodes;
    const size_t most = rows < nodes ? rows : nodes;
    const size_t modes = settings->pressure.num_modes > settings->deformation.num_modes
                             ? settings->pressure.num_modes
                             : settings->deformation.num_modes;
    size_t least = modes > 16 ? modes : 16;

    *way = (stream_plan){.limit = limit, .energy = energy};
    way->pressure = way->deformation = shares(energy, as_part);
    way->bytes = bytes_at_once(files, settings);
    way->direct = !as_part && files->num_parts == 0 && way->bytes <= limit;
    if (way->direct) return EHD_OK;
    if (least > most) least = most;
    const plan_work work = {files, settings, way};
    size_t block, rank;
    const bool enough = pod_stream_room(&block, &rank, rows, least, most, limit, bytes_with, &work);
    take_room(way, block, rank);
    way->bytes = bytes_of_stream(way, files, settings);
    if (enough) return EHD_OK;
    return ehd_fail(
        error, EHD_MEMORY,
        "--memory: found %.4g MB, expected at least %.4g MB for %zu states on %zu nodes "
        "and %zu modes",
        limit * 1e-6, ceil(way->bytes * 1e-4) * 1e-2, files->num_states, nodes, least);
}

// ---- readings

/* State of one pass over all files. */
typedef struct reading {
    snapshot_files *files;
    double *field; // [num_nodes] the last field that was read
    progress shown;
    size_t done;
    const char *what;
} reading;

static ehd_status go_on(reading *self, ehd_error *error) {
    progress_show(&self->shown, ++self->done, self->what);
    return program_interrupted() ? ehd_fail(error, EHD_INTERRUPTED, "%s: interrupted", self->what)
                                 : EHD_OK;
}

static ehd_status read_one(reading *self, size_t index, size_t entry, bool row, ehd_error *error) {
    return row ? snapshot_file_row(self->field, self->files, index, entry, error)
               : snapshot_file_state(self->field, self->files, index, entry, error);
}

/* Reads a field and adds the pressure, or its deflection if `deflection` is not NULL, to the
 * stream. */
static ehd_status stream_one(pod_stream *stream, reading *self, ehd_deflection *deflection,
                             double *deflected, size_t index, size_t entry, bool row,
                             ehd_error *error) {
    ehd_status status = read_one(self, index, entry, row, error);

    if (!status && deflection) deflection_apply(deflected, deflection, self->field);
    if (!status) status = pod_stream_add(stream, deflection ? deflected : self->field, 1, error);
    return status ? status : go_on(self, error);
}

static ehd_status stream_file(pod_stream *stream, reading *self, ehd_deflection *deflection,
                              double *deflected, size_t index, ehd_error *error) {
    ehd_status status = snapshot_file_use(self->files, index, error);
    const snapshot_file *file = &self->files->files[index];
    if (status) return status;
    const size_t num_compressed = snapshot_file_compressed(self->files, index);

    for (size_t i = 0; i < file->states.count && !status; i++)
        if (file->states.outcome[i] == 0 && file->states.trajectory[i] < 0)
            status = stream_one(stream, self, deflection, deflected, index, i, false, error);
    for (size_t i = 0; i < num_compressed && !status; i++)
        status = stream_one(stream, self, deflection, deflected, index, i, true, error);
    if (file->is_part) pod_stream_inherit(stream, file->origin.energy * file->origin.discarded);
    snapshot_file_leave(self->files, index);
    return status;
}

/* Computes the POD of all rows that the basis is built from, of pressures or of their
 * deflections. */
static ehd_status stream_all(pod_basis *pod, reading *self, const pod_stream_settings *settings,
                             const pod_settings *wanted, bool deflected, ehd_error *error) {
    const ehd_grid *grid = &self->files->grid;
    ehd_deflection *deflection = deflected ? deflection_create(self->files->kind, grid) : NULL;
    double *field = deflected ? array_new(grid->num_nodes, 1, sizeof *field) : NULL;
    pod_stream *stream = NULL;
    ehd_status status = deflected && (!deflection || !field)
                            ? ehd_no_memory(error, "deflections")
                            : pod_stream_create(&stream, grid->num_nodes, settings, error);

    for (size_t i = 0; i < self->files->num_files && !status; i++)
        status = stream_file(stream, self, deflection, field, i, error);
    if (!status) status = pod_stream_finish(pod, stream, wanted, error);
    pod_stream_free(stream);
    free(field);
    deflection_free(deflection);
    return status;
}

// ---- coordinates

/* Second pass over the files, which computes the coordinates of the states. */
typedef struct projection {
    const pod_basis *pressure, *deformation; // deformation is NULL if coupled
    ehd_deflection *deflection;
    double *fields, *deflected; // [batch, num_nodes]
    size_t batch, num_waiting;
    snapshot_set *set;
    reduced_states *states;
} projection;

static void project(double *coordinates, size_t stride, const double *fields, size_t num_fields,
                    const pod_basis *pod) {
    if (num_fields == 0) return;
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, (int)num_fields, (int)pod->num_modes,
                (int)pod->num_nodes, 1, fields, (int)pod->num_nodes, pod->modes,
                (int)pod->num_nodes, 0, coordinates, (int)stride);
}

/* Projects the states that wait in the batch. */
static void project_waiting(projection *self) {
    const size_t num_unknowns = self->states->num_unknowns;
    double *to =
        self->states->coordinates + (self->set->num_states - self->num_waiting) * num_unknowns;

    project(to, num_unknowns, self->fields, self->num_waiting, self->pressure);
    if (self->deformation)
        project(to + self->pressure->num_modes, num_unknowns, self->deflected, self->num_waiting,
                self->deformation);
    self->num_waiting = 0;
}

static ehd_status project_states(projection *self, reading *from, size_t index, ehd_error *error) {
    const size_t num_nodes = from->files->grid.num_nodes;
    const file_states *states = &from->files->files[index].states;
    ehd_status status = EHD_OK;

    for (size_t i = 0; i < states->count && !status; i++) {
        if (states->outcome[i] != 0) continue;
        status = read_one(from, index, i, false, error);
        if (status) break;
        memcpy(self->fields + self->num_waiting * num_nodes, from->field,
               num_nodes * sizeof(double));
        if (self->deformation)
            deflection_apply(self->deflected + self->num_waiting * num_nodes, self->deflection,
                             from->field);
        snapshot_set_add(self->set, from->field, states, i);
        self->num_waiting++;
        if (self->num_waiting == self->batch) project_waiting(self);
        status = go_on(from, error);
    }
    project_waiting(self);
    return status;
}

/* Projects the modes of a part onto the new modes. Writes [num_rows, modes] to `turned`. */
static ehd_status project_modes(double *turned, projection *self, reading *from, size_t index,
                                ehd_error *error) {
    const size_t num_nodes = from->files->grid.num_nodes, num = self->pressure->num_modes;
    const size_t num_rows = from->files->files[index].num_rows;
    ehd_status status = EHD_OK;

    for (size_t first = 0; first < num_rows && !status; first += self->batch) {
        const size_t left = num_rows - first, count = left < self->batch ? left : self->batch;
        for (size_t i = 0; i < count && !status; i++) {
            status = snapshot_file_mode(self->fields + i * num_nodes, from->files, index, first + i,
                                        error);
            if (!status) status = go_on(from, error);
        }
        project(turned + first * num, num, self->fields, count, self->pressure);
    }
    return status;
}

/* Adds the states of a part. Their coordinates in its own modes are multiplied by the projection of
 * these modes onto the new ones. */
static ehd_status project_part(projection *self, reading *from, size_t index, ehd_error *error) {
    const snapshot_file *file = &from->files->files[index];
    const size_t num = self->pressure->num_modes, num_unknowns = self->states->num_unknowns;
    double *turned = array_new(file->num_rows, num, sizeof *turned);
    double *to = self->states->coordinates + self->set->num_states * num_unknowns;
    reduced_states states = {0};
    ehd_status status = turned ? project_modes(turned, self, from, index, error)
                               : ehd_no_memory(error, "coordinates");

    if (!status) status = part_read_states(&states, file->file, &from->files->grid, error);
    if (!status) {
        cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)states.num_states, (int)num,
                    (int)file->num_rows, 1, states.coordinates, (int)states.num_unknowns, turned,
                    (int)num, 0, to, (int)num_unknowns);
        snapshot_set_add_reduced(self->set, &states);
    }
    reduced_states_free(&states);
    free(turned);
    return status;
}

static ehd_status project_file(projection *self, reading *from, size_t index, ehd_error *error) {
    ehd_status status = snapshot_file_use(from->files, index, error);

    if (!status)
        status = from->files->files[index].is_part ? project_part(self, from, index, error)
                                                   : project_states(self, from, index, error);
    snapshot_file_leave(from->files, index);
    return status;
}

/* Computes the coordinates of all states in a second pass over the files. */
static ehd_status project_all(reduced_basis *basis, reading *from, const stream_plan *way,
                              const pod_basis *pressure, const pod_basis *deformation,
                              ehd_error *error) {
    const ehd_grid *grid = &from->files->grid;
    const bool independent = deformation->num_modes > 0;
    const size_t num_unknowns = reduced_num_unknowns(pressure->num_modes, deformation->num_modes);
    snapshot_set set = {0};
    ehd_deflection *deflection = independent ? deflection_create(basis->kind, grid) : NULL;
    projection self = {
        .pressure = pressure,
        .deformation = independent ? deformation : NULL,
        .deflection = deflection,
        .fields = array_new(way->batch, grid->num_nodes, sizeof(double)),
        .deflected = independent ? array_new(way->batch, grid->num_nodes, sizeof(double)) : NULL,
        .batch = way->batch,
        .set = &set,
        .states = &basis->states};
    ehd_status status = !self.fields || (independent && (!self.deflected || !deflection))
                            ? ehd_no_memory(error, "coordinates")
                            : reduced_states_init(&basis->states, from->files->num_states,
                                                  grid_lines(grid), num_unknowns, error);

    if (!status) status = snapshot_set_begin(&set, from->files, error);
    for (size_t i = 0; i < from->files->num_files && !status; i++)
        status = project_file(&self, from, i, error);
    if (!status) bases_fill_states(&basis->states, &set);
    snapshot_set_free(&set);
    free(self.fields);
    free(self.deflected);
    deflection_free(deflection);
    return status;
}

// ---- bases

/* Moves the modes to the basis, transposed, and frees them in the POD. */
static ehd_status take_modes(double **modes, pod_basis *pod, ehd_error *error) {
    *modes = pod->num_modes > 0 ? bases_turn_modes(pod) : NULL;
    if (pod->num_modes > 0 && !*modes) return ehd_no_memory(error, "bases");
    free(pod->modes);
    pod->modes = NULL;
    return EHD_OK;
}

/* Checks that parts have omitted no more than their share of the allowed energy, or of the energy
 * that the modes omit if their number is given. */
static ehd_status check_distance(const pod_basis *pod, const snapshot_files *files,
                                 const stream_plan *way, bool modes_given, ehd_error *error) {
    const double share = LOCAL_SHARE + PART_SHARE, rounding = 1 + 1e-6;
    const double asked = sqrt(way->energy * pod->energy);
    const double left_out = modes_given ? sqrt(pod->tail) / ROOT_SHARE : 0;
    const double most = fmax(asked, left_out);

    if (files->num_parts == 0 || pod->distance <= rounding * share * most) return EHD_OK;
    return ehd_fail(
        error, EHD_DATA,
        "found parts that leave out %.1e of the energy, expected at most %.1e; compress "
        "them with --energy %.1e or less",
        pod->distance * pod->distance / pod->energy, share * share * most * most / pod->energy,
        most * most / pod->energy);
}

/* Returns what the POD of the rows may omit. Rows of parts leave it a smaller share. */
static pod_settings first_root(const pod_settings *wanted, const snapshot_files *files) {
    pod_settings root = *wanted;

    if (files->num_parts > 0) root.discarded_energy *= ROOT_SHARE * ROOT_SHARE;
    return root;
}

/* Returns the number of fields that both passes read. */
static size_t count_readings(const snapshot_files *files, bool independent) {
    size_t count = files->num_rows * (independent ? 2 : 1);

    for (size_t i = 0; i < files->num_files; i++)
        count += files->files[i].is_part ? files->files[i].num_rows : files->files[i].num_states;
    return count;
}

ehd_status stream_bases_build(reduced_basis *basis, pod_basis *pressure_pod,
                              pod_basis *deformation_pod, double discarded[2],
                              snapshot_files *files, const bases_settings *settings,
                              const stream_plan *way, const program *caller, ehd_error *error) {
    const bool independent = settings->kind == DEFORMATION_INDEPENDENT;
    const pod_settings pressure = first_root(&settings->pressure, files);
    const pod_settings deformation = first_root(&settings->deformation, files);
    reading from = {.files = files,
                    .field = array_new(files->grid.num_nodes, 1, sizeof(double)),
                    .what = "pressures"};

    *pressure_pod = *deformation_pod = (pod_basis){0};
    bases_begin(basis, files->kind, &files->grid, &files->carriage, settings->kind);
    ehd_status status = from.field ? EHD_OK : ehd_no_memory(error, "bases");
    progress_start(&from.shown, caller, count_readings(files, independent));
    if (!status) status = stream_all(pressure_pod, &from, &way->pressure, &pressure, false, error);
    from.what = "deflections";
    if (!status && independent)
        status = stream_all(deformation_pod, &from, &way->deformation, &deformation, true, error);
    from.what = "coordinates";
    if (!status)
        status = check_distance(pressure_pod, files, way, settings->pressure.num_modes > 0, error);
    if (!status) status = project_all(basis, &from, way, pressure_pod, deformation_pod, error);
    progress_finish(&from.shown);
    if (!status) {
        discarded[0] = pod_discarded(pressure_pod);
        discarded[1] = pod_discarded(deformation_pod);
        basis->num_pressure = pressure_pod->num_modes;
        basis->num_deformation = deformation_pod->num_modes;
        status = take_modes(&basis->pressure, pressure_pod, error);
    }
    if (!status) status = take_modes(&basis->deformation_modes, deformation_pod, error);
    if (!status) status = bases_weigh(basis, error);
    free(from.field);
    if (status) {
        reduced_basis_free(basis);
        pod_free(pressure_pod);
        pod_free(deformation_pod);
    }
    return status;
}

ehd_status stream_part_build(reduced_basis *basis, pod_basis *modes, part_origin *origin,
                             snapshot_files *files, const stream_plan *way, const program *caller,
                             ehd_error *error) {
    const double root = PART_SHARE / 2;
    const pod_settings wanted = {.discarded_energy = 4 * root * root * way->energy};
    reading from = {.files = files,
                    .field = array_new(files->grid.num_nodes, 1, sizeof(double)),
                    .what = "pressures"};
    pod_basis none = {0};

    *modes = (pod_basis){0};
    bases_begin(basis, files->kind, &files->grid, &files->carriage, DEFORMATION_COUPLED);
    ehd_status status = from.field ? EHD_OK : ehd_no_memory(error, "part");
    progress_start(&from.shown, caller, count_readings(files, false));
    if (!status) status = stream_all(modes, &from, &way->pressure, &wanted, false, error);
    from.what = "coordinates";
    if (!status) status = project_all(basis, &from, way, modes, &none, error);
    progress_finish(&from.shown);
    *origin = (part_origin){.num_snapshots = files->num_rows,
                            .num_left_out = files->num_left_out,
                            .energy = modes->energy,
                            .discarded = pod_discarded(modes)};
    free(from.field);
    if (status) {
        reduced_basis_free(basis);
        pod_free(modes);
    }
    return status;
}
