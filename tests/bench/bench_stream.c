/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures the POD of more snapshots than fit in memory. The reference is the least work that any
 * method needs: to read the snapshots once, and to multiply the snapshots with as many vectors as
 * their rank, for one Gram matrix. Makes a file of snapshots and removes it.
 *
 *     bench_stream FILE [num_snapshots num_nodes gigabytes] */
#include "common/program/program.h"
#include "podbuild/bases.h"
#include "tests/bench/measure.h"

#include <cblas.h>
#include <hdf5.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

typedef struct task {
    const char *path;
    size_t num_snapshots, num_nodes;
    double limit;
    size_t rank; // rank of the Gram matrix
} task;

typedef struct outcome {
    double passed, processor; // s
    size_t rank, num_modes;
    double bound, bytes;
} outcome;

static double processor_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// ---- the file, as another program would write it

static void put(hid_t file, const char *name, hid_t type, size_t count, const void *values) {
    const hsize_t length = count;
    const hid_t space = H5Screate_simple(1, &length, NULL);
    const hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) abort();
    H5Dclose(set);
    H5Sclose(space);
}

static void put_text(hid_t file, const char *name, const char *text) {
    const hid_t space = H5Screate(H5S_SCALAR), type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, strlen(text));
    const hid_t attribute = H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (H5Awrite(attribute, type, text) < 0) abort();
    H5Aclose(attribute);
    H5Tclose(type);
    H5Sclose(space);
}

static void put_number(hid_t file, const char *name, double value) {
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute =
        H5Acreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT);
    if (H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value) < 0) abort();
    H5Aclose(attribute);
    H5Sclose(space);
}

/* Fills a pressure whose width, centre and spike vary, each with its own period. */
static void fill(double *pressure, size_t s, size_t num_nodes, double step) {
    const double t = (double)s, width = 1 + 0.15 * sin(0.7 * t), centre = 0.1 * sin(1.3 * t + 1);
    const double spike = 0.6 + 0.3 * sin(2.1 * t + 2), height = 0.2 * (1 + sin(0.37 * t));
    for (size_t k = 0; k < num_nodes; k++) {
        const double x = -4 + step * (double)k;
        const double body = (x - centre) / width, top = (x - spike) / 0.012;
        // values below round-off are left out
        pressure[k] = fabs(body) < 2.5 ? exp(-body * body * body * body) : 0;
        if (fabs(top) < 6.2) pressure[k] += height * exp(-top * top);
    }
}

static void make_file(const task *work) {
    const size_t m = work->num_snapshots, n = work->num_nodes;
    const hsize_t lengths[2] = {m, n}, one[2] = {1, n};
    const hid_t file = H5Fcreate(work->path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t space = H5Screate_simple(2, lengths, NULL), row = H5Screate_simple(2, one, NULL);
    if (file < 0) {
        fprintf(stderr, "bench_stream: %s: cannot be made\n", work->path);
        exit(1);
    }
    const hid_t set = H5Dcreate2(file, "pressure", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT,
                                 H5P_DEFAULT, H5P_DEFAULT);
    double *pressure = must_allocate(n * sizeof *pressure), *ones = must_allocate(m * sizeof *ones);
    int64_t *integers = must_allocate(m * sizeof *integers);
    const double step = 6 / ((double)n - 1);
    for (size_t s = 0; s < m; s++) {
        const hsize_t start[2] = {s, 0};
        fill(pressure, s, n, step);
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, one, NULL);
        if (H5Dwrite(set, H5T_NATIVE_DOUBLE, row, space, H5P_DEFAULT, pressure) < 0) abort();
        ones[s] = 1;
    }
    put_text(file, "schema_name", "ehdrom-snapshots");
    put_text(file, "schema_version", "1.0");
    put_text(file, "contact", "line");
    put_number(file, "x_min", -4);
    put_number(file, "step", step);
    put(file, "status", H5T_NATIVE_INT64, m, integers);
    for (size_t s = 0; s < m; s++)
        integers[s] = (int64_t)n;
    put(file, "exit_node", H5T_NATIVE_INT64, m, integers);
    const char *const columns[] = {"rigid_approach", "moes_M", "alpha_p_H"};
    for (size_t i = 0; i < 3; i++)
        put(file, columns[i], H5T_NATIVE_DOUBLE, m, ones);
    free(pressure);
    free(ones);
    free(integers);
    H5Dclose(set);
    H5Sclose(space);
    H5Sclose(row);
    if (H5Fclose(file) < 0) abort();
}

// ---- measurements, each in its own process

static void open_files(snapshot_set *files, const task *work) {
    ehd_error error = {""};
    openblas_set_num_threads(1);
    must(snapshot_set_open(files, &work->path, 1, &error), &error);
}

static void begin(outcome *result) {
    *result = (outcome){.passed = -program_seconds(), .processor = -processor_seconds()};
}

static void end(outcome *result) {
    result->passed += program_seconds();
    result->processor += processor_seconds();
}

static void read_once(void *result, const void *context) {
    const task *work = context;
    snapshot_set files;
    ehd_error error = {""};
    begin(result);
    open_files(&files, work);
    double *field = must_allocate(files.grid.num_nodes * sizeof *field);
    for (size_t s = 0; s < work->num_snapshots; s++)
        must(snapshot_set_state(field, &files, 0, s, &error), &error);
    free(field);
    snapshot_set_close(&files);
    end(result);
}

/* Multiplies blocks of snapshots with work->rank vectors, as the streaming POD does. */
static void multiply(void *result, const void *context) {
    enum { BLOCK = 128 };
    const task *work = context;
    const size_t n = work->num_nodes;
    double *block = must_allocate(BLOCK * n * sizeof *block);
    double *vectors = must_allocate(work->rank * n * sizeof *vectors);
    double *product = must_allocate(BLOCK * work->rank * sizeof *product);
    openblas_set_num_threads(1);
    for (size_t i = 0; i < BLOCK * n; i++)
        block[i] = 1e-3 * (double)(i % 1009);
    for (size_t i = 0; i < work->rank * n; i++)
        vectors[i] = 1e-3 * (double)(i % 997);
    begin(result);
    for (size_t first = 0; first < work->num_snapshots; first += BLOCK)
        cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, BLOCK, (int)work->rank, (int)n, 1,
                    block, (int)n, vectors, (int)n, 0, product, (int)work->rank);
    end(result);
    free(block);
    free(vectors);
    free(product);
}

static const bases_settings settings = {.pressure.discarded_energy = 1e-13,
                                        .kind = DEFORMATION_COUPLED};

static bases_plan plan_of(const snapshot_set *files, const task *work) {
    bases_plan found;
    ehd_error error = {""};
    must(bases_plan_make(&found, files, &settings, work->limit, &error), &error);
    if (found.at_once) {
        fprintf(stderr, "bench_stream: the snapshots fit into the memory given\n");
        exit(1);
    }
    return found;
}

/* Computes the modes without the coordinates of the snapshots; reads the file once. */
static void find_modes(void *result, const void *context) {
    const task *work = context;
    outcome *own = result;
    snapshot_set files;
    pod_stream *stream;
    pod_basis modes;
    ehd_error error = {""};
    begin(own);
    open_files(&files, work);
    const bases_plan plan = plan_of(&files, work);
    double *field = must_allocate(files.grid.num_nodes * sizeof *field);
    must(pod_stream_create(&stream, files.grid.num_nodes, &plan.stream, &error), &error);
    for (size_t s = 0; s < work->num_snapshots; s++) {
        must(snapshot_set_state(field, &files, 0, s, &error), &error);
        must(pod_stream_add(stream, field, 1, &error), &error);
    }
    must(pod_stream_finish(&modes, stream, &(pod_settings){.discarded_energy = 1e-13}, &error),
         &error);
    end(own);
    own->rank = modes.num_singular_values;
    own->num_modes = modes.num_modes;
    own->bytes = plan.bytes;
    pod_free(&modes);
    pod_stream_free(stream);
    free(field);
    snapshot_set_close(&files);
}

/* Computes the modes and the coordinates of the snapshots; reads the file twice. */
static void build_bases(void *result, const void *context) {
    const task *work = context;
    const program silent = {.name = "bench_stream", .quiet = true};
    outcome *own = result;
    snapshot_set files;
    reduced_basis basis;
    pod_basis pressure, deformation;
    ehd_error error = {""};
    begin(own);
    open_files(&files, work);
    const bases_plan plan = plan_of(&files, work);
    must(bases_build(&basis, &pressure, &deformation, &files, &settings, &plan, &silent, &error),
         &error);
    end(own);
    own->bound = pod_discarded(&pressure);
    pod_free(&pressure);
    pod_free(&deformation);
    reduced_basis_free(&basis);
    snapshot_set_close(&files);
}

int main(int argc, char **argv) {
    task work = {.path = argc > 1 ? argv[1] : "bench_stream.h5",
                 .num_snapshots = argc > 4 ? strtoul(argv[2], NULL, 10) : 2000,
                 .num_nodes = argc > 4 ? strtoul(argv[3], NULL, 10) : 20000,
                 .limit = 1e9 * (argc > 4 ? strtod(argv[4], NULL) : 0.2)};
    outcome reading, modes, bases, product;
    double memory[4];

    make_file(&work);
    run_apart(&reading, sizeof reading, &memory[0], read_once, &work);
    run_apart(&modes, sizeof modes, &memory[1], find_modes, &work);
    run_apart(&bases, sizeof bases, &memory[2], build_bases, &work);
    work.rank = modes.rank;
    run_apart(&product, sizeof product, &memory[3], multiply, &work);
    unlink(work.path);

    const double least = reading.passed + product.passed;
    const double least_work = reading.processor + product.processor;
    printf(
        "%zu snapshots of %zu nodes (%.3g GB), %zu directions, %zu modes, energy left out at most "
        "%.1e\n",
        work.num_snapshots, work.num_nodes,
        8e-9 * (double)work.num_snapshots * (double)work.num_nodes, modes.rank, modes.num_modes,
        bases.bound);
    printf("read once %.1f s (processor %.1f), Gram matrix %.1f (%.1f)\n", reading.passed,
           reading.processor, product.passed, product.processor);
    printf("modes %.1f s (%.1f), %.2f times these (%.2f; limit 2.5), %.0f MB; %.0f stated, limit "
           "%.0f\n",
           modes.passed, modes.processor, modes.passed / least, modes.processor / least_work,
           memory[1], modes.bytes * 1e-6, work.limit * 1e-6);
    printf("modes and coordinates %.1f s (%.1f), %.2f times (%.2f), %.0f MB\n", bases.passed,
           bases.processor, bases.passed / least, bases.processor / least_work, memory[2]);
    // compares processor time, because it depends less on other programs; libraries and the caches
    // of HDF5 take less than 60 MB
    return modes.processor <= 2.5 * least_work &&
                   fmax(memory[1], memory[2]) <= work.limit * 1e-6 + 60
               ? 0
               : 1;
}
