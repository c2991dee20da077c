/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of transient results: they are written, read during the run, resumed after the run was
 * killed, and read. */
#include "common/output/time_result.h"

#include "common/output/result.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"
#include "tests/unit/sample.h"

#include <fcntl.h>
#include <hdf5.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

enum { NUM_NODES = 123, NUM_INNER = 121, RESTART_SIZE = 700, FIELDS_EVERY = 3 };

static size_t restart_size;
static const char *model; // model file of the run; NULL: the run has no model
static scene given;       // scene of the run; only its tables are used

static ehd_contact contact; // 121 inner nodes
static char path[128], partial[160], saved[160];
static ehd_error error;
static char *words[] = {"fullrun", NULL};

#define check_ok(call) assert_string_equal(((call) == EHD_OK) ? "" : error.text, "")

static program writer(void) {
    program self = {.name = "fullrun", .argc = 1, .argv = words, .output = path};
    return self;
}

static int set_up(void **state) {
    if (make_folder(state)) return -1;
    snprintf(path, sizeof path, "%s/result.h5", folder);
    snprintf(partial, sizeof partial, "%s.partial", path);
    snprintf(saved, sizeof saved, "%s.saved", path);
    restart_size = RESTART_SIZE;
    model = NULL;
    given = (scene){0};
    contact = sample_contact("barus", "incompressible", 20, 5, 0.05);
    return contact.grid.num_nodes == NUM_NODES ? 0 : -1;
}

// ---- killing between writes

/* These functions replace the functions with which HDF5 writes. If `writes_left` is not negative,
 * the process is killed after so many writes, in the middle of the next write. Of this write only
 * the part on the first page is written, as if the kernel stopped between two pages. */
static long writes_left = -1; // negative: no limit

int ftruncate(int descriptor, off_t size) {
    if (writes_left == 0) kill(getpid(), SIGKILL);
    if (writes_left > 0) writes_left--;
    return (int)syscall(SYS_ftruncate, descriptor, size);
}

ssize_t pwrite(int descriptor, const void *bytes, size_t size, off_t offset) {
    const size_t page = 4096;

    if (writes_left == 0) {
        size_t first = page - (size_t)offset % page;
        if (first < size) syscall(SYS_pwrite64, descriptor, bytes, first, offset);
        kill(getpid(), SIGKILL);
    }
    if (writes_left > 0) writes_left--;
    return syscall(SYS_pwrite64, descriptor, bytes, size, offset);
}

// ---- a run with known values

static double field_at(size_t index, size_t node) {
    return (double)index + 1e-3 * (double)node;
}

static double restart_at(size_t num_entries, size_t index) {
    return 1e3 * (double)num_entries + (double)index + 0.25;
}

static bool has_fields(size_t index) {
    return index % FIELDS_EVERY == 0;
}

static double time_at(size_t index) {
    return 0.25 * (double)index;
}

static const double *exits_at(size_t index) {
    static double exits[GRID_EXITS];

    for (size_t e = 0; e < GRID_EXITS; e++)
        exits[e] = e <= index % 3 ? (double)index + 0.6 - (double)e : NAN;
    return exits;
}

static time_entry entry_at(size_t index) {
    const double i = (double)index;
    time_entry entry = {.time = time_at(index),
                        .scalars = {.central_film_thickness = i + 0.1,
                                    .minimum_film_thickness = i + 0.2,
                                    .central_pressure = i + 0.3,
                                    .rigid_approach = -i,
                                    .load = i + 0.4},
                        .contact_half_width = i + 0.5,
                        .frame_hertz_pressure = i + 0.55,
                        .frame_film_unit = i + 0.65,
                        .exits = exits_at(index),
                        .newton_iterations = index % 7,
                        .residual = i + 0.7,
                        .status = index % 5 == 4 ? EHD_NOT_CONVERGED : EHD_OK,
                        .step = index > 0 ? 0.25 : 0,
                        .effect = i + 0.8,
                        .effect_minimum = i + 0.9,
                        .indicated = i + 0.11,
                        .indicated_minimum = i + 0.12};
    return entry;
}

/* Removes the file of an unfinished run and the copy that artefact_save makes on a slow machine. */
static void remove_unfinished(void) {
    unlink(partial);
    unlink(saved);
}

static ehd_status append(artefact *file, size_t index, bool with_fields) {
    double pressure[NUM_NODES], film[NUM_NODES];
    time_entry entry = entry_at(index);

    for (size_t k = 0; k < NUM_NODES; k++) {
        pressure[k] = field_at(index, k);
        film[k] = -field_at(index, k);
    }
    if (with_fields && has_fields(index)) {
        entry.pressure = pressure;
        entry.film = film;
    }
    return time_result_append(file, &contact.grid, &entry, 1, index, &error);
}

static ehd_status checkpoint(artefact *file, size_t num_entries) {
    double restart[RESTART_SIZE];

    for (size_t i = 0; i < RESTART_SIZE; i++)
        restart[i] = restart_at(num_entries, i);
    return time_result_checkpoint(file, restart, num_entries, &error);
}

static artefact *start(bool with_fields) {
    const program self = writer();
    artefact *file = NULL;

    check_ok(time_result_create(&file, &self, &contact, "scene", NULL, with_fields,
                                contact.transport == TRANSPORT_PATH, false, restart_size, &error));
    return file;
}

static ehd_status try_resume(artefact **file, size_t *num_entries, const char *settings) {
    const program self = writer();
    double restart[RESTART_SIZE] = {0};
    ehd_status status =
        time_result_resume(file, restart, num_entries, &self, &contact, settings,
                           (const char *const[]){model, NULL}, &given, restart_size, &error);

    for (size_t i = 0; i < restart_size && !status; i++)
        check_close(restart[i], *num_entries > 0 ? restart_at(*num_entries, i) : 0, 0, 0);
    return status;
}

static void finish(artefact **file, size_t num_entries) {
    const time_summary summary = {.seconds = {.total = 8, .rows = 4, .linear = 3, .exit = NAN},
                                  .num_steps = num_entries - 1,
                                  .num_rejected = 2,
                                  .newton_iterations = 99};
    check_ok(time_result_finish(file, &summary, &error));
    assert_null(*file);
}

static void check_series(const time_series *series, size_t num_times) {
    assert_int_equal(series->num_times, num_times);
    for (size_t i = 0; i < num_times; i++) {
        const time_entry entry = entry_at(i);
        check_close(series->time[i], entry.time, 0, 0);
        check_close(series->central_film_thickness[i], entry.scalars.central_film_thickness, 0, 0);
        check_close(series->minimum_film_thickness[i], entry.scalars.minimum_film_thickness, 0, 0);
        check_close(series->central_pressure[i], entry.scalars.central_pressure, 0, 0);
        check_close(series->load[i], entry.scalars.load, 0, 0);
    }
}

/* Checks that the file contains the scalars of the entries that time_series_read does not read. */
static void check_scalars(artefact *file, size_t num_times) {
    static const struct {
        const char *name;
        size_t offset; // of a double in time_entry
    } reals[] = {{"rigid_approach", offsetof(time_entry, scalars.rigid_approach)},
                 {"contact_half_width", offsetof(time_entry, contact_half_width)},
                 {"residual_norm", offsetof(time_entry, residual)},
                 {"time_step", offsetof(time_entry, step)},
                 {"time_effect", offsetof(time_entry, effect)},
                 {"time_effect_minimum", offsetof(time_entry, effect_minimum)},
                 {"indicated_deviation", offsetof(time_entry, indicated)},
                 {"indicated_deviation_minimum", offsetof(time_entry, indicated_minimum)}};

    const size_t num_exits = artefact_length(file, "exit") > 0 ? GRID_EXITS : 1;

    for (size_t i = 0; i < num_times; i++) {
        const time_entry entry = entry_at(i);
        int64_t integer;
        double found, exits[GRID_EXITS];
        for (size_t r = 0; r < sizeof reals / sizeof *reals; r++) {
            double expected;
            memcpy(&expected, (const char *)&entry + reals[r].offset, sizeof expected);
            check_ok(artefact_get_part(file, reals[r].name, i, 1, &found, 1, &error));
            check_close(found, expected, 0, 0);
        }
        check_ok(artefact_get_part(file, "exit_position", i, 1, exits, num_exits, &error));
        check_close(exits[0], entry.exits[0], 0, 0);
        check_ok(artefact_get_integers_part(file, "newton_iterations", i, 1, &integer, 1, &error));
        assert_int_equal(integer, entry.newton_iterations);
        check_ok(artefact_get_integers_part(file, "status", i, 1, &integer, 1, &error));
        assert_int_equal(integer, entry.status == EHD_NOT_CONVERGED);
    }
}

static void check_field(artefact *file, const char *name, size_t num_times, double sign) {
    double values[NUM_INNER];

    for (size_t i = 0; i < num_times; i++) {
        check_ok(artefact_get_part(file, name, i, 1, values, NUM_INNER, &error));
        for (size_t k = 0; k < NUM_INNER; k++) {
            if (has_fields(i))
                check_close(values[k], sign * field_at(i, k + 1), 0, 0);
            else
                assert_true(isnan(values[k]));
        }
    }
}

/* Checks that the finished file contains all appended entries. */
static void check_result(size_t num_times, bool with_fields) {
    static const artefact_schema *const schemas[] = {&schema_result, NULL};
    time_series series;
    artefact *file = NULL;

    check_ok(artefact_check(path, &error));
    check_ok(time_series_read(&series, path, &contact_line, &error));
    check_series(&series, num_times);
    assert_int_equal(series.grid.num_inner, with_fields ? NUM_INNER : 0);
    check_close(series.moes_M, 20, 0, 0);
    check_close(series.moes_L, 5, 0, 0);
    check_close(series.grid.x_min, contact.grid.x_min, 0, 0);
    check_close(series.grid.step, contact.grid.step, 0, 0);
    check_close(series.alpha_p_H, contact.alpha_p_H, 0, 0);
    check_close(series.hertz_pressure, contact.hertz_pressure, 0, 0);
    time_series_free(&series);
    check_ok(artefact_open(&file, path, schemas, &error));
    check_scalars(file, num_times);
    if (with_fields) check_field(file, "pressure", num_times, 1);
    if (with_fields) check_field(file, "film_thickness", num_times, -1);
    artefact_close(&file);
}

static void check_refused(ehd_status found, ehd_status expected, const char *words_of_it) {
    if (found != expected || !strstr(error.text, words_of_it))
        fail_msg("found %d \"%s\", expected %d with \"%s\"", (int)found, error.text, (int)expected,
                 words_of_it);
}

// ---- writing and reading

static void grows_and_reads_back(void **state) {
    (void)state;
    const size_t num_times = 1300; // more than two chunks
    artefact *file = start(true);

    for (size_t i = 0; i < num_times; i++)
        check_ok(append(file, i, true));
    finish(&file, num_times);
    check_result(num_times, true);
}

/* With transport along the path, several exits are stored, from downstream to upstream. */
static void all_exits_are_stored(void **state) {
    (void)state;
    static const artefact_schema *const schemas[] = {&schema_result, NULL};
    const size_t num_times = 7;
    double exits[7 * GRID_EXITS];

    contact.transport = TRANSPORT_PATH;
    artefact *file = start(false);
    for (size_t i = 0; i < num_times; i++)
        check_ok(append(file, i, false));
    finish(&file, num_times);
    check_result(num_times, false);
    check_ok(artefact_open(&file, path, schemas, &error));
    assert_int_equal(artefact_length(file, "exit"), GRID_EXITS);
    check_ok(artefact_get(file, "exit_position", exits, num_times * GRID_EXITS, &error));
    artefact_close(&file);
    for (size_t i = 0; i < num_times; i++)
        for (size_t e = 0; e < GRID_EXITS; e++) {
            if (e <= i % 3)
                check_close(exits[i * GRID_EXITS + e], exits_at(i)[e], 0, 0);
            else
                assert_true(isnan(exits[i * GRID_EXITS + e]));
        }
}

static void summary_is_stored(void **state) {
    (void)state;
    static const artefact_schema *const schemas[] = {&schema_result, NULL};
    const struct {
        const char *name;
        double expected;
    } attributes[] = {{"solve_seconds", 8},
                      {"solve_seconds_rows", 4},
                      {"solve_seconds_linear", 3},
                      {"solve_seconds_other", 1},
                      {"steps", 1},
                      {"rejected_steps", 2},
                      {"total_newton_iterations", 99}};
    artefact *file = start(false);

    check_ok(append(file, 0, false));
    check_ok(append(file, 1, false));
    finish(&file, 2);
    check_ok(artefact_open(&file, path, schemas, &error));
    for (size_t i = 0; i < sizeof attributes / sizeof *attributes; i++) {
        double found = NAN;
        check_ok(artefact_get_real(file, attributes[i].name, &found, &error));
        check_close(found, attributes[i].expected, 0, 0);
    }
    assert_false(artefact_has(file, "solve_seconds_exit"));
    artefact_close(&file);
}

/* Returns the number of fields that have one number for each time, including `time`. */
static size_t num_scalars(void) {
    size_t count = 1;
    for (const artefact_field *field = schema_result.fields; field->name; field++)
        if (strcmp(field->axes[0], "time") == 0 && !field->axes[1]) count++;
    return count;
}

static void unwritten_fields_take_no_space(void **state) {
    (void)state;
    const size_t num_times = 2000;
    const size_t field_bytes = NUM_INNER * sizeof(double);
    struct stat found;
    artefact *file = start(true);

    for (size_t i = 0; i < num_times; i++)
        check_ok(append(file, i, i == 0 || i + 1 == num_times - 1));
    finish(&file, num_times);
    assert_int_equal(stat(path, &found), 0);
    size_t scalars = num_scalars() * (num_times + 512) * sizeof(double);
    assert_true((size_t)found.st_size < scalars + 4 * field_bytes + 32768);
}

static void stationary_is_one_time(void **state) {
    (void)state;
    const program self = writer();
    const run_result result = {
        .indicated_deviation = NAN,
        .indicated_deviation_minimum = NAN,
        .scalars = {.central_film_thickness = 0.25, .minimum_film_thickness = 0.125, .load = 1},
        .newton_iterations = 5,
        .seconds = {.rows = NAN, .linear = NAN, .exit = NAN}};
    time_series series;
    artefact *file = NULL;

    check_ok(result_create(&file, &self, &contact, "scene", NULL, &error));
    check_ok(result_write(&file, &result, &contact, &error));
    check_ok(time_series_read(&series, path, &contact_line, &error));
    assert_int_equal(series.num_times, 1);
    check_close(series.time[0], 0, 0, 0);
    check_close(series.central_film_thickness[0], 0.25, 0, 0);
    check_close(series.load[0], 1, 0, 0);
    assert_true(isnan(series.friction_coefficient[0]));
    time_series_free(&series);
    time_series_free(&series);
}

/* Changes one time in a finished file, by HDF5 alone. */
static void patch_time(size_t index, double value) {
    const hsize_t first[1] = {index}, count[1] = {1};
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    hid_t set = H5Dopen2(file, "time", H5P_DEFAULT), space = H5Dget_space(set);
    hid_t memory = H5Screate_simple(1, count, NULL);

    if (H5Aexists(file, "content_sha256") > 0) H5Adelete(file, "content_sha256");
    H5Sselect_hyperslab(space, H5S_SELECT_SET, first, NULL, count, NULL);
    assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, &value) >= 0);
    H5Sclose(memory);
    H5Sclose(space);
    H5Dclose(set);
    H5Fclose(file);
}

static void times_increase(void **state) {
    (void)state;
    const double wrong[] = {time_at(1), -1, NAN, INFINITY};
    time_series series;
    artefact *file = start(false);

    for (size_t i = 0; i < 4; i++)
        check_ok(append(file, i, false));
    finish(&file, 4);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        patch_time(2, wrong[i]);
        check_refused(time_series_read(&series, path, &contact_line, &error), EHD_DATA,
                      "time: found");
        time_series_free(&series);
    }
    patch_time(2, time_at(2));
    check_result(4, false);
}

static void misuse_is_internal(void **state) {
    (void)state;
    const program self = writer();
    const double restart[1] = {0};
    artefact *file = NULL;

    check_ok(time_result_create(&file, &self, &contact, "", NULL, false, false, false, 0, &error));
    check_refused(append(file, 0, true), EHD_INTERNAL, "pressure");
    check_refused(time_result_checkpoint(file, restart, 1, &error), EHD_INTERNAL, "restart");
    check_refused(artefact_finish(&file, &error), EHD_INTERNAL, "found no entry");
    assert_true(access(partial, F_OK) == 0 && access(path, F_OK) != 0);
}

static void memory_failures(void **state) {
    (void)state;
    const program self = writer();
    time_series series;
    artefact *file = NULL;
    ehd_status status = EHD_OK;
    size_t call = 0;

    for (allocation_fail_at(call);; allocation_fail_at(++call)) {
        status = time_result_create(&file, &self, &contact, "scene", NULL, true, false, false,
                                    RESTART_SIZE, &error);
        if (!allocation_failed()) break;
        assert_int_not_equal(status, EHD_OK);
        assert_null(file);
    }
    check_ok(status);
    check_ok(append(file, 0, true));
    check_ok(append(file, 1, true));
    check_ok(checkpoint(file, 2));
    artefact_close(&file);

    size_t num_entries = 0;
    for (allocation_fail_at(call = 0);; allocation_fail_at(++call)) {
        status = try_resume(&file, &num_entries, "scene");
        if (!allocation_failed()) break;
        assert_int_not_equal(status, EHD_OK);
        assert_null(file);
    }
    check_ok(status);
    assert_true(call > 5);
    finish(&file, 2);
    for (allocation_fail_at(call = 0);; allocation_fail_at(++call)) {
        status = time_series_read(&series, path, &contact_line, &error);
        if (!allocation_failed()) break;
        // if the name of a field cannot be read, the field is treated as one that was written
        if (!status) check_series(&series, 2);
        time_series_free(&series);
    }
    check_ok(status);
    assert_true(call > 10);
    check_series(&series, 2);
    time_series_free(&series);
}

// ---- reading during the run

/* Reads a file that is being written, as a program that follows the run does. Returns the length of
 * the time axis, and checks that every field has at least as many entries. */
static size_t follow(hid_t file) {
    static const char *const names[] = {"central_film_thickness", "status", "time_step",
                                        "pressure"};
    hid_t time = H5Dopen2(file, "time", H5P_DEFAULT), space;
    hsize_t dims[2], length[1];

    assert_true(H5Drefresh(time) >= 0);
    space = H5Dget_space(time);
    H5Sget_simple_extent_dims(space, length, NULL);
    H5Sclose(space);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        hid_t set = H5Dopen2(file, names[i], H5P_DEFAULT);
        assert_true(H5Drefresh(set) >= 0);
        space = H5Dget_space(set);
        H5Sget_simple_extent_dims(space, dims, NULL);
        assert_true(dims[0] >= length[0]);
        H5Sclose(space);
        H5Dclose(set);
    }
    double *values = calloc(length[0] + 1, sizeof *values);
    hid_t film = H5Dopen2(file, "central_film_thickness", H5P_DEFAULT);
    H5Drefresh(film);
    hid_t memory = H5Screate_simple(1, length, NULL), all = H5Dget_space(film);
    const hsize_t first[1] = {0};
    H5Sselect_hyperslab(all, H5S_SELECT_SET, first, NULL, length, NULL);
    int attempts = 0;
    // reading fails if the chunk is rewritten at the same time
    while (H5Dread(film, H5T_NATIVE_DOUBLE, memory, all, H5P_DEFAULT, values) < 0)
        assert_true(attempts++ < 1000);
    for (size_t i = 0; i < length[0]; i++)
        check_close(values[i], entry_at(i).scalars.central_film_thickness, 0, 0);
    H5Sclose(memory);
    H5Sclose(all);
    H5Dclose(film);
    H5Dclose(time);
    free(values);
    return (size_t)length[0];
}

static hid_t open_to_follow(void) {
    hid_t access = H5Pcreate(H5P_FILE_ACCESS), file;

    H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    H5Pset_file_locking(access, false, true);
    file = H5Fopen(partial, H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access);
    H5Pclose(access);
    assert_true(file >= 0);
    return file;
}

/* Returns the place in the file of a field's only chunk, bytes. */
static off_t chunk_of(const char *name) {
    const hsize_t first[1] = {0};
    haddr_t place = HADDR_UNDEF;
    hid_t file = open_to_follow(), set = H5Dopen2(file, name, H5P_DEFAULT);

    assert_true(H5Dget_chunk_info_by_coord(set, first, NULL, &place, NULL) >= 0);
    H5Dclose(set);
    H5Fclose(file);
    return (off_t)place;
}

static void change_byte(off_t place) {
    unsigned char byte;
    const int descriptor = open(partial, O_RDWR);

    assert_int_equal(pread(descriptor, &byte, 1, place), 1);
    byte ^= 1;
    assert_int_equal(pwrite(descriptor, &byte, 1, place), 1);
    close(descriptor);
}

static off_t changed_until_wait; // place of a byte that is wrong until the program waits; 0: none

/* Replaces nanosleep. */
int nanosleep(const struct timespec *wanted, struct timespec *left) {
    if (changed_until_wait) change_byte(changed_until_wait);
    changed_until_wait = 0;
    return (int)syscall(SYS_nanosleep, wanted, left);
}

/* One byte of the chunk is wrong until the reader first waits, as in a chunk that a writer has
 * written in part. The writer is killed, so that the file still has the mark of its writer. */
static void a_chunk_that_is_rewritten_is_read_again(void **state) {
    (void)state;
    static const artefact_schema *const schemas[] = {&schema_result, NULL};
    static const char name[] = "central_film_thickness";
    double films[2];
    artefact *file;

    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        file = start(false);
        if (append(file, 0, false) || append(file, 1, false)) _exit(1);
        raise(SIGKILL);
    }
    waitpid(child, NULL, 0);
    const off_t place = chunk_of(name);
    check_ok(artefact_open_unfinished(&file, partial, schemas, &error));
    change_byte(place);
    changed_until_wait = place;
    check_ok(artefact_get_part(file, name, 0, 2, films, 2, &error));
    check_close(films[1], entry_at(1).scalars.central_film_thickness, 0, 0);
    change_byte(place);
    check_refused(artefact_get_part(file, name, 0, 2, films, 2, &error), EHD_DATA,
                  "central_film_thickness: found damaged data");
    artefact_close(&file);
}

static void followed_while_it_grows(void **state) {
    (void)state;
    const size_t num_times = 3000;
    size_t seen = 0, prefixes = 0;
    char byte = 0;
    int ends[2];

    assert_int_equal(pipe(ends), 0);
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        alarm(60);
        artefact *file = start(true);
        for (size_t i = 0; i < num_times; i++) {
            if (append(file, i, true)) _exit(1);
            if (i == 0 && write(ends[1], &byte, 1) != 1) _exit(1);
        }
        pause();
    }
    assert_int_equal(read(ends[0], &byte, 1), 1);
    alarm(60); // ends the test if the child fails
    hid_t file = open_to_follow();
    while (seen < num_times) {
        size_t length = follow(file);
        assert_true(length >= seen && length >= 1);
        if (length > seen) prefixes++;
        seen = length;
    }
    alarm(0);
    H5Fclose(file);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    close(ends[0]);
    close(ends[1]);
    assert_int_equal(seen, num_times);
    assert_true(prefixes > 1);
}

// ---- killing and resuming

/* Appends the entries first, first + 1, …, num_times - 1. After every second entry it writes two
 * checkpoints, so that both slots for checkpoints may have the same number of entries. */
static void run(artefact *file, size_t first, size_t num_times) {
    for (size_t i = first; i < num_times; i++) {
        check_ok(append(file, i, true));
        for (int again = 0; again < 2 && i % 2 == 1; again++)
            check_ok(checkpoint(file, i + 1));
    }
}

/* Starts a run in a child process, and kills it in write number `kill_at` (counted from 0) after
 * entry `first`. Returns false if the run ended before. */
static bool killed_run(size_t first, size_t num_times, long kill_at) {
    int outcome = 0;

    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        artefact *file = start(true);
        run(file, 0, first);
        writes_left = kill_at;
        run(file, first, num_times);
        _exit(0);
    }
    waitpid(child, &outcome, 0);
    if (WIFSIGNALED(outcome)) return true;
    assert_int_equal(outcome, 0);
    return false;
}

/* Kills one run after another, each `stride` writes later than the run before. After each kill all
 * entries up to a checkpoint must be in the file, at most the last checkpoint may be lost, and the
 * other entries can be added. Returns the number of kills. */
static size_t kill_and_resume(size_t first, size_t num_times, long stride) {
    size_t num_entries = 0, least = first, kills = 0;
    artefact *file = NULL;

    for (; killed_run(first, num_times, (long)kills * stride); kills++) {
        check_ok(try_resume(&file, &num_entries, "scene"));
        assert_true(num_entries % 2 == 0 && num_entries >= least && num_entries <= num_times);
        assert_int_equal(artefact_length(file, "time"), num_entries);
        least = num_entries;
        run(file, num_entries, num_times);
        finish(&file, num_times);
        check_result(num_times, true);
        unlink(path);
    }
    remove_unfinished(); // file of the last run, which was not killed
    assert_true(least + 2 >= num_times);
    return kills;
}

static void kill_at_every_write(void **state) {
    (void)state;
    const size_t sizes[] = {RESTART_SIZE, 400}; // these numbers take more and less than a page
    const long stride = check_all() ? 1 : 29;
    for (size_t i = 0; i < 2; i++) {
        restart_size = sizes[i];
        assert_true(kill_and_resume(0, 6, stride) > 100 / (size_t)stride);
    }
}

static void kill_at_a_new_chunk(void **state) {
    (void)state;
    const long stride = check_all() ? 7 : 50;
    assert_true(kill_and_resume(252, 258, stride) > 105 / (size_t)stride); // a chunk: 255 scalars
}

/* Writes two entries, a checkpoint and a third entry, and closes the file as usual. */
static void interrupted_run(void) {
    artefact *file = start(true);

    run(file, 0, 3);
    artefact_close(&file);
    assert_true(access(partial, F_OK) == 0 && access(path, F_OK) != 0);
}

static void resume_drops_what_came_after(void **state) {
    (void)state;
    artefact *file = start(true);
    size_t num_entries = 0;

    run(file, 0, 9);
    artefact_close(&file);
    for (int again = 0; again < 2; again++) {
        check_ok(try_resume(&file, &num_entries, "scene"));
        assert_int_equal(num_entries, 8);
        if (again == 0) artefact_close(&file);
    }
    finish(&file, 8);
    check_result(8, true);
}

static void resume_before_the_first_checkpoint(void **state) {
    (void)state;
    artefact *file = start(true);
    size_t num_entries = 9;

    check_ok(append(file, 0, true));
    artefact_close(&file);
    check_ok(try_resume(&file, &num_entries, "scene"));
    assert_int_equal(num_entries, 0);
    run(file, 0, 2);
    finish(&file, 2);
    check_result(2, true);
}

static void resume_refuses_another_run(void **state) {
    (void)state;
    size_t num_entries = 0;
    artefact *file = NULL;

    check_refused(try_resume(&file, &num_entries, "scene"), EHD_NOINPUT, "partial");
    interrupted_run();
    check_refused(try_resume(&file, &num_entries, "other"), EHD_DATA, "other settings");
    restart_size = 699;
    check_refused(try_resume(&file, &num_entries, "scene"), EHD_DATA,
                  "restart_entry: found length 700, expected 699");
    restart_size = 0;
    check_refused(try_resume(&file, &num_entries, "scene"), EHD_DATA, "restart_entry");
    restart_size = RESTART_SIZE;
    const ehd_grid own = contact.grid;
    // as many nodes, but at other places
    contact.grid =
        grid_of(own.x_min - own.step, own.step, own.inner_x, 1, false, own.discretization);
    check_refused(try_resume(&file, &num_entries, "scene"), EHD_DATA,
                  "x: found 121 nodes from -4 by 0.05, expected 121 from -4.05 by 0.05");
    contact.grid = grid_of(own.x_min, own.step, own.inner_x - 1, 1, false, own.discretization);
    check_refused(try_resume(&file, &num_entries, "scene"), EHD_DATA,
                  "x: found 121 nodes from -4 by 0.05, expected 120");
    contact.grid = own;
    assert_null(file);
    check_ok(try_resume(&file, &num_entries, "scene"));
    artefact_close(&file);
}

static void spill(const char *name, const char *text) {
    FILE *stream = fopen(name, "w");

    assert_true(stream && fputs(text, stream) >= 0 && fclose(stream) == 0);
}

static void resume_refuses_other_inputs(void **state) {
    (void)state;
    char scene_path[128], first[128], second[128], table[128];
    const program self = writer();
    size_t num_entries = 0;
    artefact *file = NULL;

    snprintf(scene_path, sizeof scene_path, "%s/scene.yml", folder);
    snprintf(first, sizeof first, "%s/first.h5", folder);
    snprintf(second, sizeof second, "%s/second.h5", folder);
    snprintf(table, sizeof table, "%s/table.csv", folder);
    spill(scene_path, "a scene");
    spill(first, "one");
    spill(second, "two");
    spill(table, "three");
    const char *const inputs[] = {scene_path, first, table, NULL};
    check_ok(time_result_create(&file, &self, &contact, "scene", inputs, true, false, false,
                                restart_size, &error));
    run(file, 0, 3);
    artefact_close(&file);

    model = second;
    snprintf(given.transient.vary[VARY_LOAD].file, sizeof given.transient.vary[VARY_LOAD].file,
             "%s", table);
    given.transient.vary[VARY_SPEED] = given.transient.vary[VARY_LOAD];
    check_refused(try_resume(&file, &num_entries, "scene"), EHD_DATA,
                  "result.h5.partial: found a run with another model than /tmp/");
    check_refused(EHD_DATA, EHD_DATA, "second.h5 is now");
    assert_null(file);
    // the error is the same if the other model has restart data of another size
    restart_size = 699;
    check_refused(try_resume(&file, &num_entries, "scene"), EHD_DATA, "another model");
    restart_size = RESTART_SIZE;
    spill(table, "four");
    model = first;
    check_refused(try_resume(&file, &num_entries, "scene"), EHD_DATA, "another table than");
    check_refused(EHD_DATA, EHD_DATA, "table.csv is now");
    spill(table, "three");
    // another name of a file with the same content is no error
    spill(second, "one");
    model = second;
    check_ok(try_resume(&file, &num_entries, "scene"));
    assert_int_equal(num_entries, 2);
    artefact_close(&file);
}

/* Finds the first number with this value in the unfinished file, and flips a bit of it. */
static void damage(double value) {
    int descriptor = open(partial, O_RDWR);
    off_t size = lseek(descriptor, 0, SEEK_END);
    char *bytes = malloc((size_t)size);

    assert_true(bytes && pread(descriptor, bytes, (size_t)size, 0) == size);
    char *found = memmem(bytes, (size_t)size, &value, sizeof value);
    assert_non_null(found);
    found[1] ^= 4;
    assert_int_equal(pwrite(descriptor, found, sizeof value, found - bytes), sizeof value);
    free(bytes);
    close(descriptor);
}

static void resume_and_damage(void **state) {
    (void)state;
    size_t num_entries = 0;
    artefact *file = NULL;

    // damage behind the last checkpoint does not matter, because these fields are written again
    file = start(true);
    run(file, 0, 7);
    artefact_close(&file);
    damage(field_at(6, 77));
    check_ok(try_resume(&file, &num_entries, "scene"));
    assert_int_equal(num_entries, 6);
    run(file, 6, 8);
    finish(&file, 8);
    check_result(8, true);
    unlink(path);

    interrupted_run();
    damage(field_at(0, 77));
    check_refused(try_resume(&file, &num_entries, "scene"), EHD_DATA, "pressure: found damaged");
    remove_unfinished();
    interrupted_run();
    damage(restart_at(2, RESTART_SIZE - 1));
    check_refused(try_resume(&file, &num_entries, "scene"), EHD_DATA, "restart: found damaged");
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, remove_folder)
    const struct CMUnitTest tests[] = {
        TEST(grows_and_reads_back),
        TEST(all_exits_are_stored),
        TEST(summary_is_stored),
        TEST(unwritten_fields_take_no_space),
        TEST(stationary_is_one_time),
        TEST(times_increase),
        TEST(misuse_is_internal),
        TEST(memory_failures),
        TEST(a_chunk_that_is_rewritten_is_read_again),
        TEST(followed_while_it_grows),
        TEST(kill_at_every_write),
        TEST(kill_at_a_new_chunk),
        TEST(resume_drops_what_came_after),
        TEST(resume_before_the_first_checkpoint),
        TEST(resume_refuses_another_run),
        TEST(resume_refuses_other_inputs),
        TEST(resume_and_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
