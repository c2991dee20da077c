/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/artefact/artefact.h"
#include "tests/unit/allocation.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <hdf5.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { NUM_STATES = 3, NUM_NODES = 4 };

static char *words[] = {"snapgen", "it's a plan.yml", "-o", "snapshots.h5", NULL};
static const program caller = {.name = "snapgen", .argc = 4, .argv = words};
static const program forcing = {.name = "snapgen", .argc = 4, .argv = words, .force = true};
static const artefact_schema *const snapshots_only[] = {&schema_snapshots, NULL};

static char path[128]; // path of the file under test
static char partial[160];
static ehd_error error;

static int set_up(void **state) {
    if (make_folder(state)) return -1;
    snprintf(path, sizeof path, "%s/file.h5", folder);
    snprintf(partial, sizeof partial, "%s.partial", path);
    return 0;
}

// ---- helpers

#define check_ok(call) assert_string_equal(((call) == EHD_OK) ? "" : error.text, "")

static bool exists(const char *name) {
    return access(name, F_OK) == 0;
}

static void check_refused(ehd_status found, ehd_status expected, const char *part) {
    if (found != expected || !strstr(error.text, part)) {
        fail_msg("found %d \"%s\", expected %d with \"%s\"", (int)found, error.text, (int)expected,
                 part);
    }
}

static double pressure_at(size_t state, size_t node) {
    return (double)state + 0.1 * (double)node + 1.0 / 3.0;
}

static void put_x(artefact *file) {
    const double x[NUM_NODES] = {-1.0, -0.5, 0.0, 0.5};
    check_ok(artefact_put_axis(file, "x", NUM_NODES, x, &error));
    check_ok(artefact_put_text(file, "contact", "line", &error));
    check_ok(artefact_put_real(file, "x_min", -1.0, &error));
    check_ok(artefact_put_real(file, "step", 0.5, &error));
}

static void put_grid(artefact *file) {
    check_ok(artefact_put_axis(file, "state", NUM_STATES, NULL, &error));
    put_x(file);
}

static bool is_on_x(const artefact_field *field) {
    for (size_t i = 0; i < ARTEFACT_MAX_RANK && field->axes[i]; i++)
        if (strcmp(field->axes[i], "x") == 0) return true;
    return false;
}

static void put_fields(artefact *file) {
    double field[NUM_STATES][NUM_NODES];
    const double scalar[NUM_STATES] = {0.5, 1.5, 2.5};
    const int64_t integer[NUM_STATES] = {0, 1, INT64_MAX};
    for (size_t i = 0; i < NUM_STATES; i++) {
        for (size_t k = 0; k < NUM_NODES; k++)
            field[i][k] = pressure_at(i, k);
    }
    for (const artefact_field *entry = schema_snapshots.fields; entry->name; entry++) {
        if (entry->need == NEED_OPTIONAL) continue;
        if (entry->type == ARTEFACT_INTEGER) {
            check_ok(artefact_put_integers(file, entry->name, integer, &error));
        } else if (!is_on_x(entry)) {
            check_ok(artefact_put(file, entry->name, scalar, &error));
        } else {
            check_ok(artefact_put(file, entry->name, field[0], &error));
        }
    }
}

static void write_snapshots(const char *settings) {
    artefact *file = NULL;
    check_ok(artefact_create(&file, path, &schema_snapshots, &forcing, settings, NULL, &error));
    put_grid(file);
    put_fields(file);
    check_ok(artefact_finish(&file, &error));
    assert_null(file);
}

static artefact *reopen(void) {
    artefact *file = NULL;
    check_ok(artefact_open(&file, path, snapshots_only, &error));
    return file;
}

/* Returns the content of a file as text; NULL if the file is refused. */
static char *content_of(const char *name) {
    artefact *file = NULL;
    char *text = NULL;
    char *content = NULL;
    size_t size = 0;
    if (artefact_check(name, NULL) != EHD_OK) return NULL;
    if (artefact_open(&file, name, snapshots_only, NULL) != EHD_OK) return NULL;
    FILE *stream = open_memstream(&content, &size);
    const char *const texts[] = {"settings", "history",     "creator",       "title",
                                 "contact",  "Conventions", "schema_version"};
    bool good = true;
    for (size_t i = 0; i < sizeof texts / sizeof *texts && good; i++) {
        good = artefact_get_text(file, texts[i], &text, NULL) == EHD_OK;
        if (good) fprintf(stream, "%s\n", text);
        free(text);
        text = NULL;
    }
    double numbers[NUM_STATES * NUM_NODES];
    int64_t integers[NUM_STATES];
    good = good && artefact_get_real(file, "x_min", &numbers[0], NULL) == EHD_OK &&
           artefact_get_real(file, "step", &numbers[1], NULL) == EHD_OK;
    good = good && artefact_length(file, "x") == NUM_NODES &&
           artefact_length(file, "state") == NUM_STATES;
    if (good) fprintf(stream, "%a %a\n", numbers[0], numbers[1]);
    good = good && artefact_get_axis(file, "x", numbers, NUM_NODES, NULL) == EHD_OK;
    for (size_t i = 0; i < NUM_NODES && good; i++)
        fprintf(stream, "%a ", numbers[i]);
    for (const artefact_field *field = schema_snapshots.fields; field->name && good; field++) {
        size_t length = is_on_x(field) ? NUM_STATES * NUM_NODES : NUM_STATES;
        fprintf(stream, "\n%s %d:", field->name, artefact_has(file, field->name));
        if (!artefact_has(file, field->name)) continue;
        if (field->type == ARTEFACT_INTEGER) {
            good = artefact_get_integers(file, field->name, integers, length, NULL) == EHD_OK;
            for (size_t i = 0; i < length && good; i++)
                fprintf(stream, " %ld", integers[i]);
        } else {
            good = artefact_get(file, field->name, numbers, length, NULL) == EHD_OK;
            for (size_t i = 0; i < length && good; i++)
                fprintf(stream, " %a", numbers[i]);
        }
    }
    artefact_close(&file);
    fclose(stream);
    if (good) return content;
    free(content);
    return NULL;
}

static unsigned char *slurp(const char *name, size_t *size) {
    FILE *stream = fopen(name, "rb");
    assert_non_null(stream);
    fseek(stream, 0, SEEK_END);
    *size = (size_t)ftell(stream);
    rewind(stream);
    unsigned char *bytes = malloc(*size);
    assert_int_equal(fread(bytes, 1, *size, stream), *size);
    fclose(stream);
    return bytes;
}

static void spill(const char *name, const void *bytes, size_t size) {
    FILE *stream = fopen(name, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(bytes, 1, size, stream), size);
    assert_int_equal(fclose(stream), 0);
}

static ehd_status try_open(void) {
    artefact *file = NULL;
    ehd_status status = artefact_open(&file, path, snapshots_only, &error);
    artefact_close(&file);
    return status;
}

/* Returns the command of a Python that has h5py; NULL if there is none. */
static const char *python(void) {
    static const char *const candidates[] = {"python3", "/usr/bin/python3"};
    for (size_t i = 0; i < 2; i++) {
        char command[128];
        snprintf(command, sizeof command, "%s -c 'import h5py' 2>/dev/null", candidates[i]);
        if (system(command) == 0) return candidates[i];
    }
    return NULL;
}

static void need_python(void) {
    if (python()) return;
    print_message("no python3 with h5py\n");
    skip();
}

/* Runs a script with `path` as its argument. */
static void run_python(const char *script) {
    char name[128];
    char command[512];
    snprintf(name, sizeof name, "%s/script.py", folder);
    spill(name, script, strlen(script));
    snprintf(command, sizeof command, "%s %s %s", python(), name, path);
    assert_int_equal(system(command), 0);
}

static void check_text(artefact *file, const char *name, const char *expected) {
    char *text = NULL;
    check_ok(artefact_get_text(file, name, &text, &error));
    assert_string_equal(text, expected);
    free(text);
}

// ---- writing and reading

static void round_trip(void **state) {
    (void)state;
    write_snapshots("moes.M: 12\n");
    assert_false(exists(partial));

    artefact *file = reopen();
    double x[NUM_NODES];
    double pressure[NUM_STATES][NUM_NODES];
    double row[NUM_NODES];
    double step;
    int64_t exits[NUM_STATES];
    int64_t last;
    assert_ptr_equal(artefact_kind(file), &schema_snapshots);
    assert_string_equal(artefact_path(file), path);
    assert_int_equal(artefact_length(file, "x"), NUM_NODES);
    assert_int_equal(artefact_length(file, "state"), NUM_STATES);
    assert_int_equal(artefact_length(file, "row"), 0);
    assert_true(artefact_has(file, "pressure") && artefact_has(file, "step"));
    assert_false(artefact_has(file, "weight"));

    check_ok(artefact_get_axis(file, "x", x, NUM_NODES, &error));
    check_close(x[1], -0.5, 0.0, 0.0);
    check_ok(artefact_get(file, "pressure", pressure[0], NUM_STATES * NUM_NODES, &error));
    check_close(pressure[2][3], pressure_at(2, 3), 0.0, 0.0);
    check_ok(artefact_get_part(file, "pressure", 1, 1, row, NUM_NODES, &error));
    check_close(row[2], pressure_at(1, 2), 0.0, 0.0);
    check_ok(artefact_get_integers(file, "exit_node", exits, NUM_STATES, &error));
    assert_true(exits[2] == INT64_MAX);
    check_ok(artefact_get_integers_part(file, "exit_node", 1, 1, &last, 1, &error));
    assert_int_equal(last, 1);
    check_ok(artefact_get_real(file, "step", &step, &error));
    check_close(step, 0.5, 0.0, 0.0);
    check_refused(artefact_get_part(file, "pressure", 2, 2, row, 2 * NUM_NODES, &error),
                  EHD_INTERNAL, "pressure");
    check_refused(artefact_get_real(file, "nothing", &step, &error), EHD_DATA, "nothing");
    artefact_close(&file);
    assert_null(file);
    artefact_close(&file);
}

/* Copies the file under test to `name`. Returns the content of the copy, which begins with the
 * copy's own provenance. */
static char *copied_content(const char *name, const char *const *except_axes) {
    artefact *from = reopen(), *to = NULL;

    check_ok(artefact_create(&to, name, &schema_snapshots, &forcing, "copied\n", NULL, &error));
    check_ok(artefact_copy(to, from, except_axes, &error));
    check_ok(artefact_finish(&to, &error));
    artefact_close(&from);
    char *content = content_of(name);
    assert_non_null(content);
    return content;
}

static void copies_are_equal(void **state) {
    static const char first_line[] = "-0x1p+0 0x1p-1\n"; // x_min and step
    static const char *const except[] = {"compressed", NULL};
    const double values[NUM_STATES] = {3, 2, 1};
    artefact *file = NULL;
    char other[160];
    (void)state;

    snprintf(other, sizeof other, "%s/other.h5", folder);
    check_ok(artefact_create(&file, path, &schema_snapshots, &forcing, "", NULL, &error));
    put_grid(file);
    put_fields(file);
    check_ok(artefact_put_axis(file, "compressed", NUM_STATES, NULL, &error));
    check_ok(artefact_put(file, "compressed_singular_values", values, &error));
    check_ok(artefact_finish(&file, &error));
    char *whole = content_of(path), *same = copied_content(other, NULL);
    assert_non_null(whole);
    assert_non_null(strstr(whole, "compressed_singular_values 1: 0x1.8p+1"));
    assert_string_equal(strstr(same, first_line), strstr(whole, first_line));
    assert_non_null(strstr(same, "copied\n"));
    char *without = copied_content(other, except);
    assert_non_null(strstr(without, "compressed_singular_values 0:"));
    assert_non_null(strstr(without, "pressure 1: 0x1"));
    free(whole);
    free(same);
    free(without);
}

static void provenance(void **state) {
    (void)state;
    char input[96];
    char missing[96];
    snprintf(input, sizeof input, "%s/abc", folder);
    snprintf(missing, sizeof missing, "%s/none", folder);
    spill(input, "abc", 3);
    write_snapshots("first");
    char *first = strdup(path);
    snprintf(path, sizeof path, "%s/second.h5", folder);

    const char *inputs[] = {first, input, first, NULL};
    artefact *file = NULL;
    check_ok(artefact_create(&file, path, &schema_snapshots, &caller, "caf\xc3\xa9 \xff", inputs,
                             &error));
    put_grid(file);
    put_fields(file);
    check_ok(artefact_finish(&file, &error));
    file = reopen();
    check_text(file, "settings", "caf\xc3\xa9 ?");
    check_text(file, "input_2_sha256",
               "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    char *creator = NULL;
    check_ok(artefact_get_text(file, "creator", &creator, &error));
    assert_non_null(strstr(creator, program_build()));
    free(creator);

    // an input that is given twice adds one line to the history, before the line of the new file
    char *text = NULL;
    check_ok(artefact_get_text(file, "history", &text, &error));
    char *end = strchr(text, '\n');
    assert_non_null(end);
    assert_string_equal(strchr(end + 1, '\n'), "\n");
    assert_non_null(strstr(text, " snapgen "));
    assert_non_null(strstr(text, ": snapgen 'it'\\''s a plan.yml' -o snapshots.h5\n"));
    assert_int_equal(text[10], 'T');
    assert_int_equal(text[19], 'Z');
    free(text);

    char identity[65];
    char again[65];
    check_ok(artefact_identity(file, identity, &error));
    artefact_close(&file);
    file = NULL;
    const char *second[] = {path, NULL};
    char third[128];
    snprintf(third, sizeof third, "%s/third.h5", folder);
    check_ok(artefact_create(&file, third, &schema_snapshots, &caller, NULL, second, &error));
    check_text(file, "input_1_sha256", identity);
    artefact_close(&file);
    assert_false(exists(third));
    inputs[1] = missing;
    check_refused(artefact_create(&file, third, &schema_snapshots, &caller, NULL, inputs, &error),
                  EHD_NOINPUT, "none");
    assert_null(file);

    snprintf(path, sizeof path, "%s", first);
    free(first);
    file = reopen();
    check_ok(artefact_identity(file, again, &error));
    assert_string_not_equal(again, identity);
    artefact_close(&file);
}

/* A text that is too long for one attribute is split into several attributes, but never within a
 * character. */
static void long_texts(void **state) {
    (void)state;
    const size_t length = 3000000;
    char *longest = malloc(length + 1);
    for (size_t i = 0; i < length; i += 3)
        memcpy(longest + i, "\xe2\x82\xac", 3); // euro signs
    longest[length] = '\0';
    artefact *file = NULL;
    check_ok(artefact_create(&file, path, &schema_basis, &caller, longest, NULL, &error));
    char *text = NULL;
    check_ok(artefact_get_text(file, "settings", &text, &error));
    assert_string_equal(text, longest);
    free(text);

    check_ok(artefact_put_text(file, "contact", longest, &error));
    assert_true(artefact_has(file, "contact_2"));
    check_ok(artefact_put_text(file, "contact", "", &error));
    assert_false(artefact_has(file, "contact_2"));
    check_ok(artefact_get_text(file, "contact", &text, &error));
    assert_string_equal(text, "");
    free(text);
    artefact_close(&file);

    write_snapshots(longest);
    file = reopen();
    check_ok(artefact_get_text(file, "settings", &text, &error));
    assert_string_equal(text, longest);
    free(text);
    artefact_close(&file);
    free(longest);
}

static void misuse_is_internal(void **state) {
    (void)state;
    const double values[NUM_STATES] = {0};
    artefact *file = NULL;
    check_ok(artefact_create(&file, path, &schema_snapshots, &caller, "", NULL, &error));
    check_refused(artefact_put(file, "moes_M", values, &error), EHD_INTERNAL, "no axis state");
    check_refused(artefact_put_axis(file, "row", 3, NULL, &error), EHD_INTERNAL, "row");
    check_refused(artefact_put_axis(file, "x", 0, NULL, &error), EHD_INTERNAL, "x");
    put_grid(file);
    check_refused(artefact_put_axis(file, "x", 3, NULL, &error), EHD_INTERNAL, "x");
    check_refused(artefact_put(file, "weight", values, &error), EHD_INTERNAL, "weight");
    check_refused(artefact_put(file, "status", values, &error), EHD_INTERNAL, "status");
    check_refused(artefact_put_real(file, "contact", 1.0, &error), EHD_INTERNAL, "contact");
    check_refused(artefact_begin_streaming(file, &error), EHD_INTERNAL, "pressure");
    check_refused(artefact_finish(&file, &error), EHD_INTERNAL, "pressure");
    assert_null(file);
    assert_false(exists(path));
}

// ---- names

static void output_names(void **state) {
    (void)state;
    artefact *file = NULL;
    spill(path, "mine", 4);
    check_refused(artefact_create(&file, path, &schema_result, &caller, "", NULL, &error),
                  EHD_CANTCREATE, "--force");
    check_ok(artefact_create(&file, path, &schema_result, &forcing, "", NULL, &error));
    assert_true(exists(partial));
    artefact_close(&file);
    assert_false(exists(partial));
    size_t size;
    unsigned char *kept = slurp(path, &size);
    assert_int_equal(size, 4);
    free(kept);

    check_refused(artefact_create(&file, folder, &schema_result, &forcing, "", NULL, &error),
                  EHD_CANTCREATE, "found a folder");
    check_refused(artefact_create(&file, "/dev/null", &schema_result, &forcing, "", NULL, &error),
                  EHD_CANTCREATE, "regular");
    check_refused(artefact_create(&file, "/none/x.h5", &schema_result, &forcing, "", NULL, &error),
                  EHD_CANTCREATE, "No such");
    check_refused(artefact_create(&file, "/proc/x.h5", &schema_result, &forcing, "", NULL, &error),
                  EHD_CANTCREATE, "/proc/x.h5");
}

/* The provisional name must be unused, or belong to a regular file that can be written. */
static void provisional_names(void **state) {
    (void)state;
    artefact *file = NULL;
    assert_int_equal(mkdir(partial, 0777), 0);
    check_refused(artefact_create(&file, path, &schema_result, &forcing, "", NULL, &error),
                  EHD_CANTCREATE, "expected a writable file");
    assert_int_equal(rmdir(partial), 0);
    assert_int_equal(mkfifo(partial, 0666), 0);
    check_refused(artefact_create(&file, path, &schema_result, &forcing, "", NULL, &error),
                  EHD_CANTCREATE, "found no regular file, expected one or none");
    assert_int_equal(unlink(partial), 0);
    assert_null(file);
}

/* Checks that artefact_finish fails if, since artefact_create, a file or folder has taken the final
 * name, or the provisional file has disappeared. */
static void names_that_change_meanwhile(void **state) {
    (void)state;
    for (int i = 0; i < 3; i++) {
        artefact *file = NULL;
        check_ok(artefact_create(&file, path, &schema_snapshots, &caller, "", NULL, &error));
        put_grid(file);
        put_fields(file);
        if (i == 0) {
            spill(path, "other", 5);
            check_refused(artefact_finish(&file, &error), EHD_CANTCREATE, "an existing file");
            assert_int_equal(unlink(path), 0);
        } else if (i == 1) {
            assert_int_equal(mkdir(path, 0777), 0);
            check_refused(artefact_finish(&file, &error), EHD_CANTCREATE, "found a folder");
            assert_int_equal(rmdir(path), 0);
        } else {
            assert_int_equal(unlink(partial), 0);
            check_refused(artefact_finish(&file, &error), EHD_CANTCREATE, "to get this name");
        }
        assert_null(file);
        assert_false(exists(path));
        unlink(partial);
    }
}

static void survives_failing_allocations(void **state) {
    (void)state;
    artefact *file = NULL;
    size_t call = 0;
    for (;; call++) {
        allocation_fail_at(call);
        const ehd_status status =
            artefact_create(&file, path, &schema_snapshots, &caller, "a: 1\n", NULL, &error);
        if (!allocation_failed()) break;
        assert_int_equal(status, EHD_MEMORY);
        assert_null(file);
    }
    assert_true(call >= 3);
    artefact_close(&file);
}

/* Reads several texts, one of which is stored in several pieces, and then checks the whole file. */
static ehd_status read_texts(char **settings) {
    const char *const names[] = {"contact", "history", "step"};
    artefact *file = NULL;
    ehd_status status = artefact_open(&file, path, snapshots_only, &error);

    *settings = NULL;
    if (!status) status = artefact_get_text(file, "settings", settings, &error);
    for (size_t i = 0; i < sizeof names / sizeof *names && !status; i++) {
        char *shown = NULL;
        status = artefact_show_attribute(file, names[i], &shown, &error);
        free(shown);
    }
    artefact_close(&file);
    return status ? status : artefact_check(path, &error);
}

/* If an allocation fails, the reader must return EHD_MEMORY, not another error or a shortened
 * text. */
static void refused_memory_is_no_other_text(void **state) {
    (void)state;
    enum { LENGTH = 150000 };
    char *text = calloc(LENGTH + 1, 1), *found = NULL;
    size_t call = 0;
    assert_non_null(text);
    memset(text, 'x', LENGTH);
    write_snapshots(text);
    for (;; call++) {
        allocation_fail_at(call);
        const ehd_status status = read_texts(&found);
        if (!allocation_failed()) break;
        if (status != EHD_MEMORY)
            fail_msg("allocation %zu: found %d, %s, expected 71", call, (int)status, error.text);
        free(found);
    }
    assert_string_equal(found, text);
    assert_true(call > 20);
    free(found);
    free(text);
}

/* If an allocation fails, artefact_finish must not store a digest of incomplete content. */
static void refused_memory_ends_no_file(void **state) {
    (void)state;
    bool failed = true;
    for (size_t call = 0; failed; call++) {
        artefact *file = NULL;
        check_ok(artefact_create(&file, path, &schema_snapshots, &forcing, "a: 1\n", NULL, &error));
        put_grid(file);
        put_fields(file);
        allocation_fail_at(call);
        const ehd_status status = artefact_finish(&file, &error);
        failed = allocation_failed();
        if (status && status != EHD_MEMORY)
            fail_msg("allocation %zu: found %d, %s, expected 71", call, (int)status, error.text);
        if (!status) check_ok(artefact_check(path, &error));
    }
}

static int refused_looks; // number of calls of H5Lexists that fail from now on

/* Replaces H5Lexists of HDF5. */
htri_t H5Lexists(hid_t where, const char *name, hid_t access) {
    typedef htri_t look(hid_t, const char *, hid_t);
    void *symbol = dlsym(RTLD_NEXT, "H5Lexists");
    look *own;

    memcpy(&own, &symbol, sizeof own);
    if (refused_looks <= 0) return own(where, name, access);
    refused_looks--;
    errno = ENOMEM;
    return -1;
}

/* A failed look-up must not be taken for a missing optional dataset. */
static void refused_look_is_no_no(void **state) {
    (void)state;
    double pressure[NUM_STATES][NUM_NODES];
    write_snapshots("a: 1\n");
    artefact *file = reopen();
    refused_looks = 1;
    assert_true(artefact_has(file, "pressure"));
    refused_looks = 2;
    check_refused(artefact_get(file, "pressure", pressure[0], NUM_STATES * NUM_NODES, &error),
                  EHD_MEMORY, "memory");
    artefact_close(&file);
}

static void two_writers(void **state) {
    (void)state;
    artefact *first = NULL;
    artefact *second = NULL;
    check_ok(artefact_create(&first, path, &schema_snapshots, &caller, "", NULL, &error));
    check_refused(artefact_create(&second, path, &schema_snapshots, &caller, "", NULL, &error),
                  EHD_CANTCREATE, "another process");
    assert_null(second);
    put_grid(first);
    put_fields(first);
    check_ok(artefact_finish(&first, &error));
    assert_true(exists(path));
}

// ---- refused files

static void refuses_what_is_no_artefact(void **state) {
    (void)state;
    check_refused(try_open(), EHD_NOINPUT, "No such file");
    spill(path, "", 0);
    check_refused(try_open(), EHD_DATA, "empty");
    check_refused(artefact_check(path, &error), EHD_DATA, "empty");
    spill(path, "not HDF5 at all", 15);
    check_refused(try_open(), EHD_DATA, "no HDF5");
    assert_int_equal(unlink(path), 0);
    assert_int_equal(mkdir(path, 0777), 0);
    check_refused(try_open(), EHD_NOINPUT, "regular");
    assert_int_equal(rmdir(path), 0);

    write_snapshots("");
    check_ok(artefact_check(path, &error));
    artefact *file = NULL;
    const artefact_schema *const others[] = {&schema_basis, &schema_model, NULL};
    check_refused(artefact_open(&file, path, others, &error), EHD_DATA,
                  "found ehdrom-snapshots, expected ehdrom-basis or ehdrom-model");
    size_t size;
    unsigned char *bytes = slurp(path, &size);
    spill(path, bytes, size / 2);
    check_refused(try_open(), EHD_DATA, "truncated");
    free(bytes);
}

static hid_t open_for_change(void) {
    write_snapshots("");
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, access);
    H5Pclose(access);
    assert_true(file >= 0);
    assert_true(H5Adelete(file, "content_sha256") >= 0);
    return file;
}

static void replace_attribute(hid_t file, const char *name, hid_t type, const void *value) {
    H5Adelete(file, name);
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t attribute = H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, type, value) >= 0);
    H5Aclose(attribute);
    H5Sclose(space);
}

static void replace_text(hid_t file, const char *name, const char *value) {
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, strlen(value) + 1);
    replace_attribute(file, name, type, value);
    H5Tclose(type);
}

static void replace_dataset(hid_t file, const char *name, hid_t type, int rank, hsize_t d0,
                            hsize_t d1) {
    hsize_t dims[] = {d0, d1};
    H5Ldelete(file, name, H5P_DEFAULT);
    hid_t space = H5Screate_simple(rank, dims, NULL);
    hid_t dataset = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(dataset >= 0);
    H5Dclose(dataset);
    H5Sclose(space);
}

/* Changes of a file. `text` is the new value of an attribute, `length` the new length of the last
 * axis of a dataset. `found` is a part of the error text of the reader; NULL: the reader accepts
 * the change. */
static const struct {
    enum { UNFINISHED, TEXT, NO_ATTRIBUTE, NO_DATASET, REALS, GROUP } change;
    const char *name, *text;
    hsize_t length;
    const char *found;
} misfits[] = {
    {UNFINISHED, "complete", "", 0, "unfinished"},
    {TEXT, "schema_version", "3.0", 0, "found 3.0"},
    {TEXT, "schema_version", "1.0x", 0, "found 1.0x"},
    {TEXT, "schema_version", "1.7", 0, NULL},
    {NO_ATTRIBUTE, "schema_name", "", 0, "schema_name: found none"},
    {NO_ATTRIBUTE, "step", "", 0, "found no attribute step"},
    {TEXT, "step", "half", 0, "attribute step"},
    {NO_DATASET, "pressure", "", 0, "found no dataset pressure"},
    {NO_DATASET, "film_thickness", "", 0, NULL},
    {REALS, "pressure", "", 1, "found 1 axes, expected 2"},
    {REALS, "film_thickness", "", NUM_NODES + 1,
     "film_thickness: found length 5 along x, expected 4"},
    {REALS, "status", "", 1, "status: found values of another type"},
    {GROUP, "pressure", "", 0, "pressure"},
};

static void change_file(hid_t file, size_t row) {
    const char *name = misfits[row].name;
    const hsize_t length = misfits[row].length;
    const int64_t zero = 0;

    if (misfits[row].change == UNFINISHED)
        replace_attribute(file, name, H5T_NATIVE_INT64, &zero);
    else if (misfits[row].change == TEXT)
        replace_text(file, name, misfits[row].text);
    else if (misfits[row].change == NO_ATTRIBUTE)
        H5Adelete(file, name);
    else if (misfits[row].change == REALS)
        replace_dataset(file, name, H5T_IEEE_F64LE, length > 1 ? 2 : 1, NUM_STATES, length);
    else
        H5Ldelete(file, name, H5P_DEFAULT);
    if (misfits[row].change == GROUP)
        H5Gclose(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
}

static void refuses_what_does_not_fit(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof misfits / sizeof *misfits; i++) {
        hid_t file = open_for_change();
        change_file(file, i);
        H5Fclose(file);
        if (misfits[i].found)
            check_refused(try_open(), EHD_DATA, misfits[i].found);
        else
            check_ok(try_open());
    }
}

// ---- damage

static void damage_is_named(void **state) {
    (void)state;
    write_snapshots("");
    size_t size;
    unsigned char *bytes = slurp(path, &size);
    const double wanted = pressure_at(1, 2);
    unsigned char *found = memmem(bytes, size, &wanted, sizeof wanted);
    assert_non_null(found);
    found[3] ^= 0x10;
    spill(path, bytes, size);
    free(bytes);

    double pressure[NUM_STATES][NUM_NODES];
    artefact *file = reopen();
    check_refused(artefact_get(file, "pressure", pressure[0], NUM_STATES * NUM_NODES, &error),
                  EHD_DATA, "pressure: found damaged");
    artefact_close(&file);
    check_refused(artefact_check(path, &error), EHD_DATA, "pressure: found damaged");
}

/* Runs probe(i) for i = first, first + step, … below end in child processes, so that a crash is
 * reported and does not end the test. A probe returns 0 on success. */
static void probe_all(const char *what, int (*probe)(size_t), size_t first, size_t end,
                      size_t step) {
    const size_t batch = 500;
    while (first < end) {
        size_t last = first + batch * step < end ? first + batch * step : end;
        int ends[2];
        assert_int_equal(pipe(ends), 0);
        fflush(NULL);
        pid_t child = fork();
        if (child == 0) {
            alarm(120);
            for (size_t i = first; i < last; i += step) {
                if (write(ends[1], &i, sizeof i) < 0 || probe(i) != 0) _exit(1);
            }
            _exit(0);
        }
        close(ends[1]);
        size_t reached = first;
        while (read(ends[0], &reached, sizeof reached) > 0)
            continue;
        close(ends[0]);
        int outcome = 0;
        waitpid(child, &outcome, 0);
        if (outcome != 0) fail_msg("%s at %zu: outcome %d", what, reached, outcome);
        first = last;
    }
}

static unsigned char *whole;
static size_t whole_size;
static char *whole_content;

/* Returns 1 if the reader accepts the changed file and finds changed content in it, otherwise 0. */
static int read_changed_file(void) {
    char *content = content_of(path);
    int outcome = content && strcmp(content, whole_content) != 0;
    free(content);
    return outcome;
}

static int flip_byte(size_t offset) {
    unsigned char flipped = (unsigned char)(whole[offset] ^ (1U << (offset % 8)));
    int descriptor = open(path, O_WRONLY);
    if (pwrite(descriptor, &flipped, 1, (off_t)offset) != 1) return 1;
    int outcome = read_changed_file();
    if (pwrite(descriptor, &whole[offset], 1, (off_t)offset) != 1) return 1;
    close(descriptor);
    return outcome;
}

static int cut_file(size_t size) {
    spill(path, whole, size);
    return artefact_check(path, NULL) == EHD_OK;
}

/* Flips a bit in every `step`-th byte of the file at `path`: the reader must refuse the file or
 * find its original content. Then truncates the file at many places: the reader must refuse it. */
static void fuzz_file(size_t step) {
    whole = slurp(path, &whole_size);
    whole_content = content_of(path);
    assert_non_null(whole_content);
    assert_int_equal(read_changed_file(), 0);
    probe_all("flipped byte", flip_byte, 0, whole_size, step);
    probe_all("truncated file", cut_file, 0, whole_size, whole_size / 200 + 1);
    probe_all("truncated file", cut_file, whole_size - 40, whole_size, 1);
    free(whole);
    free(whole_content);
}

/* Returns the step between flipped bytes. Flipping all bytes takes a minute, so by default only
 * some bytes are flipped. */
static size_t fuzz_stride(void) {
    const char *stride = getenv("EHD_FUZZ_STRIDE");
    if (stride) return strtoul(stride, NULL, 10);
    return check_all() ? 5 : 47;
}

static void fuzz(void **state) {
    (void)state;
    write_snapshots("moes.M: 12\n");
    fuzz_file(fuzz_stride());
}

// ---- failing writes

/* Writes like write_snapshots, but returns errors. The file needs more than one block. */
static ehd_status attempt(bool streaming, ehd_error *text) {
    enum { MANY = 400 };
    static double field[NUM_STATES][MANY];
    static int64_t integer[NUM_STATES];
    artefact *file = NULL;
    for (size_t i = 0; i < NUM_STATES * MANY; i++)
        field[i / MANY][i % MANY] = 1;
    ehd_status status = artefact_create(&file, path, &schema_snapshots, &caller, "s", NULL, text);
    if (status != EHD_OK) return status;
    const ehd_status setup[] = {artefact_put_axis(file, "state", NUM_STATES, NULL, text),
                                artefact_put_axis(file, "x", MANY, NULL, text),
                                artefact_put_text(file, "contact", "line", text),
                                artefact_put_real(file, "x_min", -1.0, text),
                                artefact_put_real(file, "step", 0.5, text)};
    for (size_t i = 0; i < sizeof setup / sizeof *setup && status == EHD_OK; i++)
        status = setup[i];
    const artefact_field *fields = schema_snapshots.fields;
    for (size_t i = 0; fields[i].name && status == EHD_OK && streaming; i++) {
        if (fields[i].need != NEED_OPTIONAL) status = artefact_declare(file, fields[i].name, text);
    }
    if (streaming && status == EHD_OK) status = artefact_begin_streaming(file, text);
    for (size_t i = 0; fields[i].name && status == EHD_OK; i++) {
        if (fields[i].need == NEED_OPTIONAL) continue;
        status = fields[i].type == ARTEFACT_INTEGER
                     ? artefact_put_integers(file, fields[i].name, integer, text)
                     : artefact_put(file, fields[i].name, field[0], text);
    }
    ehd_status last = artefact_finish(&file, status == EHD_OK ? text : NULL);
    return status == EHD_OK ? last : status;
}

static bool limited_streaming;

/* Writes a file while files are limited to `size` bytes. Returns 0 in two cases: the status is
 * EHD_IO or EHD_CANTCREATE and there is no file, or the file is complete. In both cases the exit
 * handlers must print nothing. */
static int write_with_limit(size_t size) {
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        char errors[96];
        snprintf(errors, sizeof errors, "%s/stderr", folder);
        if (!freopen(errors, "w", stderr)) _exit(1);
        signal(SIGXFSZ, SIG_IGN);
        struct rlimit limit = {size, size};
        setrlimit(RLIMIT_FSIZE, &limit);
        ehd_status status = attempt(limited_streaming, &error);
        bool sound = status == EHD_OK ? artefact_check(path, NULL) == EHD_OK : !exists(path);
        bool known = status == EHD_OK || ((status == EHD_IO || status == EHD_CANTCREATE) &&
                                          strstr(error.text, "File too large"));
        if (!known) fprintf(stderr, "%d %s\n", (int)status, error.text);
        exit(sound && known ? 0 : 1); // exit runs the exit handlers of HDF5
    }
    int outcome = 0;
    waitpid(child, &outcome, 0);
    char errors[96];
    struct stat printed;
    snprintf(errors, sizeof errors, "%s/stderr", folder);
    if (outcome == 0 && (stat(errors, &printed) != 0 || printed.st_size > 0)) outcome = 1;
    if (outcome != 0) {
        size_t length = 0;
        unsigned char *text = slurp(errors, &length);
        printf("limit %zu: %.*s\n", size, (int)length, (char *)text);
        free(text);
    }
    unlink(path);
    unlink(partial);
    return outcome;
}

static void failing_writes(void **state) {
    const char *variant = getenv("VARIANT");
    (void)state;
    if (variant && strcmp(variant, "cov") == 0) skip(); // the limit would truncate coverage files
    for (int streaming = 0; streaming < 2; streaming++) {
        limited_streaming = streaming;
        check_ok(attempt(limited_streaming, &error));
        struct stat normal;
        assert_int_equal(stat(path, &normal), 0);
        size_t size = (size_t)normal.st_size;
        unlink(path);
        for (size_t limit = 0; limit < size + 4096; limit += check_all() ? 487 : 4999) {
            int outcome = write_with_limit(limit);
            if (outcome) fail_msg("limit %zu of %zu: outcome %d", limit, size, outcome);
        }
    }
}

/* Space that becomes free again does not repair an earlier failed write. */
static void failure_is_remembered(void **state) {
    (void)state;
    const double values[NUM_STATES] = {0.5, 1.5, 2.5};
    struct rlimit normal;
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &normal);
    const struct rlimit tight = {16, normal.rlim_max};
    artefact *file = NULL;
    check_ok(artefact_create(&file, path, &schema_snapshots, &caller, "", NULL, &error));
    put_grid(file);
    put_fields(file);
    check_ok(artefact_flush(file, &error));
    setrlimit(RLIMIT_FSIZE, &tight);
    ehd_status refused = artefact_put(file, "rigid_approach", values, &error);
    setrlimit(RLIMIT_FSIZE, &normal);
    check_refused(refused, EHD_IO, "rigid_approach: found a write failure (File too large)");
    check_refused(artefact_finish(&file, &error), EHD_IO, "earlier write failure");
    assert_false(exists(partial));
    assert_false(exists(path));
}

// ---- streaming

static void declare_all_and_stream(artefact *file) {
    for (const artefact_field *field = schema_snapshots.fields; field->name; field++) {
        if (field->need != NEED_OPTIONAL) check_ok(artefact_declare(file, field->name, &error));
    }
    check_ok(artefact_begin_streaming(file, &error));
}

static artefact *start_stream(const char *settings) {
    artefact *file = NULL;
    check_ok(artefact_create(&file, path, &schema_snapshots, &forcing, settings, NULL, &error));
    put_grid(file);
    declare_all_and_stream(file);
    return file;
}

static void stream_state(artefact *file, size_t number) {
    double row[NUM_NODES];
    const int64_t done = 1; // other fields of a solved state are not written
    for (size_t k = 0; k < NUM_NODES; k++)
        row[k] = pressure_at(number, k);
    check_ok(artefact_put_part(file, "pressure", number, 1, row, &error));
    check_ok(artefact_put_integers_part(file, "status", number, 1, &done, &error));
}

/* Streams two states in a child process, flushes them if `flush`, and kills the process. */
static void killed_stream(bool flush) {
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        artefact *file = start_stream("same");
        stream_state(file, 0);
        stream_state(file, 2);
        if (flush) check_ok(artefact_flush(file, &error));
        kill(getpid(), SIGKILL);
    }
    int outcome = 0;
    waitpid(child, &outcome, 0);
    assert_true(WIFSIGNALED(outcome) && WTERMSIG(outcome) == SIGKILL);
    assert_true(exists(partial));
    assert_false(exists(path));
}

static void check_streamed(artefact *file, bool second) {
    double pressure[NUM_STATES][NUM_NODES];
    int64_t status[NUM_STATES];
    check_ok(artefact_get(file, "pressure", pressure[0], NUM_STATES * NUM_NODES, &error));
    check_ok(artefact_get_integers(file, "status", status, NUM_STATES, &error));
    assert_true(status[0] == 1 && status[2] == 1);
    assert_true(status[1] == (second ? 1 : -1));
    check_close(pressure[0][1], pressure_at(0, 1), 0.0, 0.0);
    check_close(pressure[2][3], pressure_at(2, 3), 0.0, 0.0);
    if (second) check_close(pressure[1][2], pressure_at(1, 2), 0.0, 0.0);
    if (!second) assert_true(isnan(pressure[1][2]));
}

static void resume_after_kill(void **state) {
    (void)state;
    artefact *file = NULL;
    check_refused(artefact_resume(&file, path, &schema_snapshots, &caller, "same", &error),
                  EHD_NOINPUT, "No such file");
    assert_false(exists(partial));
    for (int flush = 0; flush < 2; flush++) {
        killed_stream(flush);
        check_refused(artefact_open(&file, partial, snapshots_only, &error), EHD_DATA, "killed");
        check_refused(artefact_resume(&file, path, &schema_result, &caller, "same", &error),
                      EHD_DATA, "ehdrom-snapshots");
        check_refused(artefact_resume(&file, path, &schema_snapshots, &caller, "other", &error),
                      EHD_DATA, "other settings");
        check_ok(artefact_resume(&file, path, &schema_snapshots, &caller, "same", &error));
        check_streamed(file, false);
        artefact_close(&file); // closing interrupts the run again
        assert_true(exists(partial));
        check_refused(artefact_open(&file, partial, snapshots_only, &error), EHD_DATA,
                      "unfinished");
        check_ok(artefact_resume(&file, path, &schema_snapshots, &caller, "same", &error));
        stream_state(file, 1);
        check_ok(artefact_flush(file, &error));
        check_ok(artefact_finish(&file, &error));
        assert_false(exists(partial));

        check_ok(artefact_check(path, &error));
        file = reopen();
        check_streamed(file, true);
        char *history = NULL;
        check_ok(artefact_get_text(file, "history", &history, &error));
        // two lines of history: started, resumed
        assert_string_equal(strchr(strchr(history, '\n') + 1, '\n'), "\n");
        free(history);
        artefact_close(&file);
        check_refused(artefact_resume(&file, path, &schema_snapshots, &caller, "same", &error),
                      EHD_CANTCREATE, "--force");
        unlink(path);
    }
}

/* An interrupted run with finished states is replaced only on request. A run without finished
 * states is always replaced. */
static void unfinished_runs(void **state) {
    (void)state;
    artefact *file = NULL;
    killed_stream(true);
    check_refused(artefact_create(&file, path, &schema_snapshots, &caller, "", NULL, &error),
                  EHD_CANTCREATE, "found an interrupted run with solved points, expected --resume");
    assert_null(file);
    assert_true(exists(partial));
    check_ok(artefact_create(&file, path, &schema_snapshots, &forcing, "", NULL, &error));
    artefact_close(&file);
    check_ok(artefact_create(&file, path, &schema_snapshots, &caller, "", NULL, &error));
    artefact_close(&file);
    // if a file claims more entries than can be read, and stores none of them, the check must end
    const hid_t made_up = open_for_change();
    replace_dataset(made_up, "status", H5T_NATIVE_INT64, 1, (hsize_t)1 << 40, 1);
    H5Fclose(made_up);
    assert_int_equal(rename(path, partial), 0);
    check_ok(artefact_create(&file, path, &schema_snapshots, &caller, "", NULL, &error));
    artefact_close(&file);
}

/* Flips a bit of a number in the partial file. */
static void damage_partial(double number) {
    size_t size;
    unsigned char *bytes = slurp(partial, &size);
    unsigned char *found = memmem(bytes, size, &number, sizeof number);
    assert_non_null(found);
    *found ^= 1;
    spill(partial, bytes, size);
    free(bytes);
}

/* Resuming accepts a file with a damaged entry, because a killed run may have written some entries
 * only in part. artefact_check_entry finds this damage. A damaged axis or file is refused at
 * once. */
static void resume_refuses_damage(void **state) {
    (void)state;
    artefact *file = NULL;
    killed_stream(true);
    damage_partial(pressure_at(2, 1));
    check_ok(artefact_resume(&file, path, &schema_snapshots, &caller, "same", &error));
    check_refused(artefact_check_entry(file, 2, &error), EHD_DATA, "pressure: found damaged");
    artefact_close(&file);
    damage_partial(-0.5); // a value of the axis x
    check_refused(artefact_resume(&file, path, &schema_snapshots, &caller, "same", &error),
                  EHD_DATA, "damaged");
    spill(partial, "junk", 4);
    check_refused(artefact_resume(&file, path, &schema_snapshots, &caller, "same", &error),
                  EHD_DATA, "no whole HDF5 file");
    assert_true(exists(partial));
}

static void resume_checks_inputs(void **state) {
    (void)state;
    char one[96], other[96], third[96];
    artefact *file = NULL;
    snprintf(one, sizeof one, "%s/one", folder);
    snprintf(other, sizeof other, "%s/other", folder);
    snprintf(third, sizeof third, "%s/third", folder);
    spill(one, "abc", 3);
    spill(other, "abcd", 4);
    const char *inputs[] = {one, other, NULL};
    check_ok(artefact_create(&file, path, &schema_snapshots, &forcing, "same", inputs, &error));
    put_grid(file);
    declare_all_and_stream(file);
    artefact_close(&file);

    check_ok(artefact_resume(&file, path, &schema_snapshots, &caller, "same", &error));
    check_ok(artefact_check_input(file, "table", one, &error));
    check_ok(artefact_check_input(file, "table", other, &error));
    // exchanged contents of two inputs are refused; a copy under another name is accepted
    spill(one, "abcd", 4);
    spill(other, "abc", 3);
    spill(third, "abcd", 4);
    check_refused(artefact_check_input(file, "table", one, &error), EHD_DATA,
                  "found a run with another table than");
    check_refused(artefact_check_input(file, "table", other, &error), EHD_DATA, "/other is now");
    check_ok(artefact_check_input(file, "table", third, &error));
    spill(third, "ab", 2);
    check_refused(artefact_check_input(file, "model", third, &error), EHD_DATA, "another model");
    unlink(third);
    check_refused(artefact_check_input(file, "model", third, &error), EHD_NOINPUT, "/third");
    artefact_close(&file);
}

/* A run that is killed before streaming leaves nothing to resume. */
static void kill_before_stream(void **state) {
    (void)state;
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        artefact *file = NULL;
        check_ok(artefact_create(&file, path, &schema_snapshots, &forcing, "same", NULL, &error));
        put_grid(file);
        put_fields(file);
        kill(getpid(), SIGKILL);
    }
    waitpid(child, NULL, 0);
    artefact *file = NULL;
    ehd_status status = artefact_resume(&file, path, &schema_snapshots, &caller, "same", &error);
    check_refused(status, EHD_NOINPUT, "nothing to continue");
    write_snapshots("same"); // the next run starts anew
}

static void attributes_after_streaming(void **state) {
    (void)state;
    artefact *file = start_stream("s");
    check_refused(artefact_put_real(file, "step", 0.25, &error), EHD_INTERNAL, "streaming");
    check_refused(artefact_put_axis(file, "x", 3, NULL, &error), EHD_INTERNAL, "x");
    stream_state(file, 0);
    check_ok(artefact_end_streaming(file, &error));
    check_ok(artefact_put_real(file, "step", 0.25, &error));
    check_ok(artefact_finish(&file, &error));
    double step;
    file = reopen();
    check_ok(artefact_get_real(file, "step", &step, &error));
    check_close(step, 0.25, 0.0, 0.0);
    artefact_close(&file);
}

static void readable_while_it_grows(void **state) {
    (void)state;
    need_python();
    artefact *file = start_stream("s");
    stream_state(file, 0);
    run_python("import h5py, sys\n"
               "with h5py.File(sys.argv[1] + '.partial', 'r', libver='latest', swmr=True) as f:\n"
               "    assert f.attrs['complete'] == 0\n"
               "    assert list(f['status'][:]) == [1, -1, -1], f['status'][:]\n"
               "    assert f['pressure'][0, 0] == 1 / 3\n");
    check_ok(artefact_finish(&file, &error));
}

// ---- a growing axis

static artefact *start_growing(void) {
    artefact *file = NULL;
    check_ok(artefact_create_growing(&file, path, &schema_snapshots, "state", &forcing, "same",
                                     NULL, &error));
    put_x(file);
    declare_all_and_stream(file);
    return file;
}

/* Writes the axis, and pressure and status of every second state. */
static void put_states(artefact *file, size_t first, size_t end) {
    for (size_t i = first; i < end; i++) {
        const double number = (double)i;
        if (i % 2 == 0) stream_state(file, i);
        check_ok(artefact_put_axis_part(file, "state", i, 1, &number, &error));
        assert_int_equal(artefact_length(file, "state"), i + 1);
    }
}

static void grows_evenly(void **state) {
    (void)state;
    double pressure[NUM_STATES][NUM_NODES];
    double moes_M[NUM_STATES];
    int64_t status[NUM_STATES];
    const double second = 1.0;
    artefact *file = start_growing();
    put_states(file, 0, NUM_STATES);
    // writing the same value again does not change the length
    check_ok(artefact_put_axis_part(file, "state", 1, 1, &second, &error));
    assert_int_equal(artefact_length(file, "state"), NUM_STATES);
    check_ok(artefact_finish(&file, &error));
    check_ok(artefact_check(path, &error));
    file = reopen();
    assert_int_equal(artefact_length(file, "state"), NUM_STATES);
    check_ok(artefact_get(file, "pressure", pressure[0], NUM_STATES * NUM_NODES, &error));
    check_ok(artefact_get_integers(file, "status", status, NUM_STATES, &error));
    check_ok(artefact_get(file, "moes_M", moes_M, NUM_STATES, &error));
    for (size_t k = 0; k < NUM_NODES; k++) {
        check_close(pressure[0][k], pressure_at(0, k), 0.0, 0.0);
        assert_true(isnan(pressure[1][k]));
        check_close(pressure[2][k], pressure_at(2, k), 0.0, 0.0);
    }
    assert_true(status[0] == 1 && status[1] == -1 && status[2] == 1);
    assert_true(isnan(moes_M[0]) && isnan(moes_M[2])); // never written
    artefact_close(&file);
}

static void growing_axis_is_cut(void **state) {
    (void)state;
    artefact *file = start_growing();
    put_states(file, 0, NUM_STATES);
    check_refused(artefact_cut_axis(file, "state", 1, &error), EHD_INTERNAL, "before streaming");
    artefact_close(&file);
    check_ok(artefact_resume(&file, path, &schema_snapshots, &forcing, "same", &error));
    check_refused(artefact_cut_axis(file, "x", 1, &error), EHD_DATA, "another axis that grows");
    check_refused(artefact_cut_axis(file, "state", NUM_STATES + 1, &error), EHD_DATA,
                  "found 3 entries, expected at least 4");
    artefact_close(&file);
    check_ok(artefact_resume(&file, path, &schema_snapshots, &forcing, "same", &error));
    check_ok(artefact_cut_axis(file, "state", 1, &error));
    check_ok(artefact_finish(&file, &error));
    file = reopen();
    assert_int_equal(artefact_length(file, "state"), 1);
    artefact_close(&file);
}

static void fuzz_grown(void **state) {
    (void)state;
    artefact *file = start_growing();
    put_states(file, 0, NUM_STATES);
    check_ok(artefact_finish(&file, &error));
    fuzz_file(5 * fuzz_stride()); // fewer flips, since most pages of the file are empty
}

static void misuse_of_growth_is_internal(void **state) {
    (void)state;
    const double number = 0.0;
    artefact *file = NULL;
    check_refused(
        artefact_create_growing(&file, path, &schema_snapshots, "row", &caller, "", NULL, &error),
        EHD_INTERNAL, "axis row");
    assert_null(file);
    assert_false(exists(partial));
    // the growing axis must be the first axis of a dataset
    check_ok(
        artefact_create_growing(&file, path, &schema_snapshots, "x", &caller, "", NULL, &error));
    check_ok(artefact_put_axis(file, "state", NUM_STATES, NULL, &error));
    check_refused(artefact_declare(file, "pressure", &error), EHD_INTERNAL, "no axis x");
    artefact_close(&file);
    file = start_growing();
    check_refused(artefact_put_axis_part(file, "x", NUM_NODES, 1, &number, &error), EHD_INTERNAL,
                  "axis x");
    check_refused(artefact_finish(&file, &error), EHD_INTERNAL, "state: found no entry");
    assert_true(exists(partial));
}

// ---- files and tools of other programs

/* A script that writes a minimal file as another program may write it: with other types and
 * layouts. */
static const char foreign[] =
    "import h5py, numpy, sys\n"
    "with h5py.File(sys.argv[1], 'w') as f:\n"
    "    f.attrs['schema_name'] = 'ehdrom-snapshots'\n"
    "    f.attrs['schema_version'] = numpy.bytes_('1.3')\n"
    "    f.attrs['contact'] = 'line'\n"
    "    f.attrs['x_min'] = -1\n"
    "    f.attrs['step'] = numpy.array([0.5], '>f4')\n"
    "    p = numpy.arange(12.0).reshape(3, 4)\n"
    "    f.create_dataset('pressure', data=p.astype('>f4'), chunks=(2, 3), compression='gzip')\n"
    "    f['rigid_approach'] = numpy.array([1.5, 2.5, 3.5])\n"
    "    f['exit_node'] = numpy.array([3, 4, 4], '>i2')\n"
    "    f['status'] = numpy.zeros(3, 'u1')\n"
    "    f['moes_M'] = numpy.array([5, 8, 12], 'i4')\n"
    "    f['alpha_p_H'] = numpy.array([5, 8, 12], 'f4')\n";

static void foreign_file(void **state) {
    (void)state;
    need_python();
    run_python(foreign);
    check_ok(artefact_check(path, &error));
    artefact *file = reopen();
    double pressure[NUM_STATES][NUM_NODES];
    double numbers[NUM_NODES];
    int64_t exits[NUM_STATES];
    assert_int_equal(artefact_length(file, "x"), NUM_NODES);
    assert_int_equal(artefact_length(file, "state"), NUM_STATES);
    check_ok(artefact_get(file, "pressure", pressure[0], NUM_STATES * NUM_NODES, &error));
    check_close(pressure[2][3], 11.0, 0.0, 0.0);
    check_ok(artefact_get_integers(file, "exit_node", exits, NUM_STATES, &error));
    assert_int_equal(exits[0], 3);
    check_ok(artefact_get(file, "moes_M", numbers, NUM_STATES, &error));
    check_close(numbers[2], 12.0, 0.0, 0.0);
    check_ok(artefact_get_real(file, "x_min", &numbers[0], &error));
    check_ok(artefact_get_real(file, "step", &numbers[1], &error));
    check_close(numbers[0], -1.0, 0.0, 0.0);
    check_close(numbers[1], 0.5, 0.0, 0.0);
    char *text = NULL;
    check_ok(artefact_get_text(file, "contact", &text, &error));
    assert_string_equal(text, "line");
    free(text);
    check_refused(artefact_get_axis(file, "x", numbers, NUM_NODES, &error), EHD_DATA, "axis x");
    check_refused(artefact_get(file, "film_thickness", pressure[0], NUM_STATES * NUM_NODES, &error),
                  EHD_DATA, "found no dataset film_thickness");
    check_refused(artefact_get_text(file, "history", &text, &error), EHD_DATA, "history");
    artefact_close(&file);

    // the file has no history, but is identified by its content
    const char *inputs[] = {path, NULL};
    char next[128];
    snprintf(next, sizeof next, "%s/next.h5", folder);
    check_ok(artefact_create(&file, next, &schema_basis, &caller, "", inputs, &error));
    check_ok(artefact_get_text(file, "history", &text, &error));
    assert_string_equal(strchr(text, '\n'), "\n");
    free(text);
    artefact_close(&file);
}

static void foreign_netcdf(void **state) {
    (void)state;
    need_python();
    run_python(
        "import numpy, sys, xarray\n"
        "s, x = 3, 4\n"
        "d = xarray.Dataset({'pressure': (('state', 'x'), numpy.ones((s, x))),\n"
        "  'exit_node': ('state', numpy.full(s, x)), 'status': ('state', numpy.zeros(s, int))},\n"
        "  coords={'x': numpy.linspace(-1, 0.5, x)},\n"
        "  attrs={'schema_name': 'ehdrom-snapshots', 'schema_version': '1.0',\n"
        "         'contact': 'line', 'x_min': -1.0, 'step': 0.5})\n"
        "for n in 'rigid_approach', 'moes_M', 'alpha_p_H': d[n] = ('state', numpy.ones(s))\n"
        "d.to_netcdf(sys.argv[1], engine='netcdf4')\n");
    check_ok(artefact_check(path, &error));
    artefact *file = reopen();
    double x[NUM_NODES];
    double index[NUM_STATES];
    check_ok(artefact_get_axis(file, "x", x, NUM_NODES, &error));
    check_close(x[3], 0.5, 1e-15, 0.0);
    check_refused(artefact_get_axis(file, "state", index, NUM_STATES, &error), EHD_DATA,
                  "axis state");
    artefact_close(&file);
}

static void transposed_square_field(void **state) {
    (void)state;
    need_python();
    run_python("import h5py, numpy, sys\n"
               "with h5py.File(sys.argv[1], 'w') as f:\n"
               "    f.attrs.update(schema_name='ehdrom-snapshots', schema_version='1.0')\n"
               "    f.attrs.update(contact='line', x_min=-1.0, step=0.5)\n"
               "    for n in 'rigid_approach', 'moes_M', 'alpha_p_H': f[n] = numpy.ones(3)\n"
               "    for n in 'exit_node', 'status': f[n] = numpy.zeros(3, int)\n"
               "    for n in 'x', 'state': f[n] = numpy.arange(3.0); f[n].make_scale(n)\n"
               "    f['pressure'] = numpy.ones((3, 3))\n"
               "    f['pressure'].dims[0].attach_scale(f['x'])\n"
               "    f['pressure'].dims[1].attach_scale(f['state'])\n");
    check_refused(try_open(), EHD_DATA, "pressure: found state as axis 1");
    // with a second link to the dataset the error is the same
    run_python("import h5py, sys\n"
               "with h5py.File(sys.argv[1], 'r+') as f: f['a'] = f['pressure']\n");
    check_refused(try_open(), EHD_DATA, "pressure: found state as axis 1");
}

static void check_opens_elsewhere(void) {
    char command[256];
    snprintf(command, sizeof command, "%s tests/pipeline/open_elsewhere.py %s > %s/out", python(),
             path, folder);
    int outcome = system(command);
    if (outcome != 0) {
        size_t size;
        snprintf(command, sizeof command, "%s/out", folder);
        unsigned char *out = slurp(command, &size);
        fail_msg("%.*s", (int)size, (char *)out);
    }
}

static void opens_elsewhere(void **state) {
    (void)state;
    need_python();
    write_snapshots("moes.M: 12\n");
    check_opens_elsewhere();
}

static void growing_opens_elsewhere(void **state) {
    (void)state;
    need_python();
    artefact *file = start_growing();
    put_states(file, 0, 2);
    put_states(file, 2, NUM_STATES);
    check_ok(artefact_finish(&file, &error));
    check_opens_elsewhere();
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, remove_folder)
    const struct CMUnitTest tests[] = {
        TEST(round_trip),
        TEST(copies_are_equal),
        TEST(provenance),
        TEST(long_texts),
        TEST(misuse_is_internal),
        TEST(output_names),
        TEST(provisional_names),
        TEST(names_that_change_meanwhile),
        TEST(survives_failing_allocations),
        TEST(refused_memory_is_no_other_text),
        TEST(refused_memory_ends_no_file),
        TEST(refused_look_is_no_no),
        TEST(two_writers),
        TEST(refuses_what_is_no_artefact),
        TEST(refuses_what_does_not_fit),
        TEST(damage_is_named),
        TEST(fuzz),
        TEST(failing_writes),
        TEST(failure_is_remembered),
        TEST(resume_after_kill),
        TEST(unfinished_runs),
        TEST(resume_refuses_damage),
        TEST(resume_checks_inputs),
        TEST(kill_before_stream),
        TEST(attributes_after_streaming),
        TEST(readable_while_it_grows),
        TEST(grows_evenly),
        TEST(growing_axis_is_cut),
        TEST(fuzz_grown),
        TEST(misuse_of_growth_is_internal),
        TEST(foreign_file),
        TEST(foreign_netcdf),
        TEST(transposed_square_field),
        TEST(opens_elsewhere),
        TEST(growing_opens_elsewhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
