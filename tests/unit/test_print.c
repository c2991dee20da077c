/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/print.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { NUM_TIMES = 2, NUM_LINES = 2, NUM_NODES = 3 };

static char *words[] = {"fullrun", "a \"quoted\", name.yml", NULL};
static const program caller = {.name = "fullrun", .argc = 2, .argv = words, .force = true};

static char path[128];
static bool in_si;
static ehd_error error;

static int set_up(void **state) {
    if (make_folder(state)) return -1;
    snprintf(path, sizeof path, "%s/file.h5", folder);
    return 0;
}

#define check_ok(call) assert_string_equal(((call) == EHD_OK) ? "" : error.text, "")

/* Writes a result of a line contact (num_lines = 1) or a point contact. Each pressure is 100 times
 * the index of its time, plus 10 times the index of its grid line, plus the index of its node. */
static void write_result(size_t num_times, size_t num_lines) {
    const double times[] = {0, 0.1}, lines[] = {0, 0.5}, nodes[] = {-1, 0, 1. / 3};
    const double scalar[] = {0.1, NAN};
    const int64_t counts[] = {3, INT64_MAX};
    double pressure[NUM_TIMES * NUM_LINES * NUM_NODES], exits[NUM_TIMES * NUM_LINES] = {0};
    artefact *file = NULL;

    for (size_t i = 0; i < num_times * num_lines * NUM_NODES; i++)
        pressure[i] = (double)(100 * (i / (num_lines * NUM_NODES)) +
                               10 * (i / NUM_NODES % num_lines) + i % NUM_NODES);
    check_ok(artefact_create(&file, path, &schema_result, &caller, "a: 1\n", NULL, &error));
    check_ok(artefact_put_axis(file, "time", num_times, times, &error));
    if (num_lines > 1) check_ok(artefact_put_axis(file, "y", num_lines, lines, &error));
    check_ok(artefact_put_axis(file, "x", NUM_NODES, nodes, &error));
    check_ok(artefact_put_text(file, "contact", "line", &error));
    for (const artefact_field *one = schema_result.attributes; one->name; one++)
        if (one->need != NEED_OPTIONAL && one->type == ARTEFACT_REAL)
            check_ok(artefact_put_real(file, one->name, 1. / 3, &error));
    check_ok(artefact_put(file, "pressure", pressure, &error));
    check_ok(artefact_put(file, "exit_position", exits, &error));
    for (const artefact_field *one = schema_result.fields; one->name; one++) {
        if (one->need == NEED_OPTIONAL || strcmp(one->name, "exit_position") == 0) continue;
        if (one->type == ARTEFACT_INTEGER)
            check_ok(artefact_put_integers(file, one->name, counts, &error));
        else
            check_ok(artefact_put(file, one->name, scalar, &error));
    }
    check_ok(artefact_finish(&file, &error));
}

/* Returns the text that is printed for a list of names, which ends with NULL. Free the text. */
static char *printed(ehd_status expected, const char *const *names) {
    artefact *file = NULL;
    char *text = NULL;
    size_t size = 0, count = 0;

    while (names[count])
        count++;
    check_ok(artefact_open_unfinished(&file, path, artefact_schemas, &error));
    FILE *stream = open_memstream(&text, &size);
    assert_int_equal(print_entries(file, names, count, in_si, stream, &error), expected);
    fclose(stream);
    artefact_close(&file);
    return text;
}

#define check_printed(expected, ...)                                                               \
    do {                                                                                           \
        char *text = printed(EHD_OK, (const char *const[]){__VA_ARGS__, NULL});                    \
        assert_string_equal(text, expected);                                                       \
        free(text);                                                                                \
    } while (0)

#define check_refused(part, ...)                                                                   \
    do {                                                                                           \
        char *text = printed(EHD_DATA, (const char *const[]){__VA_ARGS__, NULL});                  \
        assert_string_equal(text, "");                                                             \
        if (!strstr(error.text, part)) fail_msg("found %s, expected %s", error.text, part);        \
        free(text);                                                                                \
    } while (0)

static void a_line_for_each_entry(void **state) {
    (void)state;
    write_result(2, 1);
    check_printed("time,load,status\n0,0.1,3\n0.1,nan,9223372036854775807\n", "time", "load",
                  "status");
    check_printed("load\n0.1\nnan\n", "load"); // one axis alone is not printed in front
    check_printed("x\n-1\n0\n0.3333333333333333\n", "x");
}

static void attributes_are_one_line_or_the_same_in_each(void **state) {
    (void)state;
    write_result(2, 1);
    check_printed("moes_M,contact\n0.3333333333333333,line\n", "moes_M", "contact");
    check_printed("complete\n1\n", "complete");
    check_printed("time,step\n0,0.3333333333333333\n0.1,0.3333333333333333\n", "time", "step");
    check_printed("settings\n\"a: 1\n\"\n", "settings");
    char *history = printed(EHD_OK, (const char *const[]){"history", NULL});
    assert_non_null(strstr(history, "\"\"quoted\"\", name.yml"));
    free(history);
}

static void several_axes_lead_and_empty_lines_part_them(void **state) {
    (void)state;
    write_result(2, 1);
    check_printed("time,x,pressure\n0,-1,0\n0,0,1\n0,0.3333333333333333,2\n\n"
                  "0.1,-1,100\n0.1,0,101\n0.1,0.3333333333333333,102\n",
                  "pressure");
    check_printed("time,pressure,x\n0,0,-1\n0,1,0\n0,2,0.3333333333333333\n\n"
                  "0.1,100,-1\n0.1,101,0\n0.1,102,0.3333333333333333\n",
                  "pressure", "x");
    write_result(2, 2);
    check_printed("time,y,pressure,x\n0,0,0,-1\n0,0,1,0\n0,0,2,0.3333333333333333\n\n"
                  "0,0.5,10,-1\n0,0.5,11,0\n0,0.5,12,0.3333333333333333\n\n\n"
                  "0.1,0,100,-1\n0.1,0,101,0\n0.1,0,102,0.3333333333333333\n\n"
                  "0.1,0.5,110,-1\n0.1,0.5,111,0\n0.1,0.5,112,0.3333333333333333\n",
                  "pressure", "x");
}

static void an_axis_of_one_entry_neither_leads_nor_parts(void **state) {
    (void)state;
    write_result(1, 1);
    check_printed("pressure\n0\n1\n2\n", "pressure");
    check_printed("x,pressure,time\n-1,0,0\n0,1,0\n0.3333333333333333,2,0\n", "x", "pressure",
                  "time");
    write_result(1, 2);
    check_printed("y,x,pressure\n0,-1,0\n0,0,1\n0,0.3333333333333333,2\n\n"
                  "0.5,-1,10\n0.5,0,11\n0.5,0.3333333333333333,12\n",
                  "pressure");
}

static void names_that_are_not_there_and_other_axes_are_refused(void **state) {
    (void)state;
    write_result(1, 1);
    check_refused("found no pressur, expected one of: time x pressure central_film", "pressur");
    check_refused("moes_M", "load", "y"); // y exists only for a point contact
    check_refused("found no a?b,", "a\nb");
    check_refused("found no nothing", "");
    check_refused("found pressure and load of different axes", "load", "pressure");
    check_refused("found x and time of different axes", "x", "time");
    check_refused("found load and x of different axes", "load", "x");
}

/* Writes a result with the attributes for SI units: half width 2, film unit 3, time unit 4, load 5,
 * Hertz pressure 6. The units of the frames are larger at the second point in time. */
static void write_units(bool with_frames) {
    const struct {
        const char *name;
        double value;
    } units[] = {
        {"half_width", 2}, {"film_unit", 3}, {"time_unit", 4}, {"line_load", 5}, {"step", 0.5}};
    const double one[] = {1, 2}, many[] = {1, 10}, frames[] = {1, 100};
    const double times[] = {0, 0.5}, nodes[] = {-1, 1}, pressure[] = {1, 2, 3, 4};
    artefact *file = NULL;

    check_ok(artefact_create(&file, path, &schema_result, &caller, "a: 1\n", NULL, &error));
    check_ok(artefact_put_axis(file, "time", 2, times, &error));
    check_ok(artefact_put_axis(file, "x", 2, nodes, &error));
    check_ok(artefact_put_text(file, "contact", "line", &error));
    for (const artefact_field *row = schema_result.attributes; row->name; row++)
        if (row->need != NEED_OPTIONAL && row->type == ARTEFACT_REAL)
            check_ok(artefact_put_real(file, row->name, 6, &error));
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        check_ok(artefact_put_real(file, units[i].name, units[i].value, &error));
    check_ok(artefact_put(file, "pressure", pressure, &error));
    check_ok(artefact_put(file, "film_thickness", pressure, &error));
    check_ok(artefact_put(file, "contact_half_width", many, &error));
    if (with_frames) check_ok(artefact_put(file, "frame_hertz_pressure", frames, &error));
    for (const artefact_field *row = schema_result.fields; row->name; row++) {
        const int64_t counts[] = {7, 8};
        if (row->need == NEED_OPTIONAL || strcmp(row->name, "contact_half_width") == 0) continue;
        if (row->type == ARTEFACT_INTEGER)
            check_ok(artefact_put_integers(file, row->name, counts, &error));
        else
            check_ok(artefact_put(file, row->name, one, &error));
    }
    check_ok(artefact_finish(&file, &error));
}

static void units_follow_from_the_rows(void **state) {
    (void)state;

    in_si = true;
    write_units(true);
    check_printed("time [s],central_film_thickness [m],central_pressure [Pa],rigid_approach [m],"
                  "load [N m-1],contact_half_width [m],exit_position [m],residual_norm,status\n"
                  "0,3,6,3,5,2,2,1,7\n2,6,12,6,10,20,4,2,8\n",
                  "time", "central_film_thickness", "central_pressure", "rigid_approach", "load",
                  "contact_half_width", "exit_position", "residual_norm", "status");
    // fields and X are converted with the frame of their time
    check_printed("time [s],x [m],pressure [Pa]\n0,-2,6\n0,2,12\n\n2,-20,1800\n2,20,2400\n",
                  "pressure");
    check_printed("step [m],moes_M,contact\n1,6,line\n", "step", "moes_M", "contact");
    check_refused("x: found a unit that varies with time, expected a dataset along time", "x");
    check_refused("film_thickness: found no frame_film_unit", "film_thickness");
    write_units(false);
    check_refused("pressure: found no frame_hertz_pressure", "pressure");
    write_result(1, 1);
    check_refused("found no attribute film_unit, expected that of a contact in SI units", "status",
                  "central_film_thickness");
    check_printed("status,central_pressure [Pa]\n3,0.03333333333333333\n", "status",
                  "central_pressure");
    in_si = false;
}

static void tells_what_there_is(void **state) {
    (void)state;
    artefact *file = NULL;
    char *text = NULL;
    size_t size = 0;

    write_result(2, 2);
    check_ok(artefact_open(&file, path, artefact_schemas, &error));
    FILE *stream = open_memstream(&text, &size);
    check_ok(print_names(file, false, stream, &error));
    fclose(stream);
    artefact_close(&file);
    assert_non_null(strstr(text, "name,units,lengths,axes,description\n"));
    assert_non_null(strstr(text, "\npressure,1,2 2 3,time y x,\"pressure P, in"));
    assert_non_null(strstr(text, "\nhertz_pressure,Pa,,,Hertz pressure of the reference\n"));
    assert_non_null(strstr(text, "\ncreator,,,,\n"));
    assert_null(strstr(text, "film_thickness,1,2 2 3"));
    free(text);
}

/* Leaves file.h5.partial as a run does that stops early. The attribute `complete` is 0, and fields
 * may have one entry more or fewer than the time axis. */
static void leave_unfinished(size_t num_times) {
    const double nodes[] = {-1, 0, 1}, times[] = {0, 0.5, 1}, loads[] = {1, 2};
    const int64_t counts[] = {5, 6};
    artefact *file = NULL;

    check_ok(
        artefact_create_growing(&file, path, &schema_result, "time", &caller, "", NULL, &error));
    check_ok(artefact_put_axis(file, "x", NUM_NODES, nodes, &error));
    check_ok(artefact_put_text(file, "contact", "line", &error));
    for (const artefact_field *one = schema_result.attributes; one->name; one++)
        if (one->need != NEED_OPTIONAL && one->type == ARTEFACT_REAL)
            check_ok(artefact_put_real(file, one->name, 1, &error));
    for (const artefact_field *one = schema_result.fields; one->name; one++)
        if (one->need != NEED_OPTIONAL) check_ok(artefact_declare(file, one->name, &error));
    check_ok(artefact_begin_streaming(file, &error));
    for (const artefact_field *one = schema_result.fields; one->name; one++) {
        if (one->need == NEED_OPTIONAL) continue;
        if (one->type == ARTEFACT_REAL)
            check_ok(artefact_put_part(file, one->name, 0, 2, loads, &error));
        else
            check_ok(artefact_put_integers_part(file, one->name, 0, 2, counts, &error));
    }
    check_ok(artefact_put_axis_part(file, "time", 0, num_times, times, &error));
    check_ok(artefact_flush(file, &error));
    artefact_close(&file);
}

static void an_unfinished_file_is_printed_as_far_as_it_goes(void **state) {
    (void)state;
    const size_t length = strlen(path);

    leave_unfinished(1);
    strcpy(path + length, ".partial");
    check_printed("time,load,status,complete\n0,1,5,0\n", "time", "load", "status", "complete");
    path[length] = '\0';
}

static char *read_bytes(size_t *size) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    char *bytes = malloc(*size);
    assert_non_null(bytes);
    rewind(file);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

static void write_bytes(const char *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void damaged_data_are_no_silent_end(void **state) {
    (void)state;
    const double value = 101; // one of the pressures; a bit of it is flipped
    size_t size;

    write_result(2, 1);
    char *bytes = read_bytes(&size);
    char *place = memmem(bytes, size, &value, sizeof value);
    assert_non_null(place);
    *place ^= 1;
    write_bytes(bytes, size);
    free(bytes);
    char *text = printed(EHD_DATA, (const char *const[]){"pressure", NULL});
    assert_non_null(strstr(error.text, "pressure: found damaged data"));
    free(text);
}

/* Suppresses reports about HDF5 1.10, which leaks memory when it reads damaged files. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) {
    return "leak:libhdf5";
}

/* If any byte of a file is wrong, printing the file ends with EHD_OK, EHD_DATA or EHD_IO, whether
 * the file is finished or not. */
static void any_byte_may_be_wrong(void **state) {
    const char *const names[] = {"time", "load", "status", "history", "moes_M", "contact"};
    const size_t length = strlen(path);
    FILE *nowhere = fopen("/dev/null", "w");
    size_t size;
    (void)state;

    assert_non_null(nowhere);
    for (int unfinished = 0; unfinished < 2; unfinished++) {
        if (unfinished)
            leave_unfinished(2);
        else
            write_result(2, 1);
        if (unfinished) strcpy(path + length, ".partial");
        char *bytes = read_bytes(&size);
        for (size_t i = 0; i < size; i += bytes[i] ? 11 : 211) {
            artefact *file = NULL;
            bytes[i] = (char)~bytes[i];
            write_bytes(bytes, size);
            bytes[i] = (char)~bytes[i];
            ehd_status status = artefact_open_unfinished(&file, path, artefact_schemas, &error);
            if (!status) status = print_entries(file, names, 6, false, nowhere, &error);
            if (!status) status = print_names(file, false, nowhere, &error);
            artefact_close(&file);
            if (status != EHD_OK && status != EHD_DATA && status != EHD_IO)
                fail_msg("byte %zu: %s", i, error.text);
        }
        free(bytes);
        if (unfinished) unlink(path);
        path[length] = '\0';
    }
    fclose(nowhere);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_for_each_entry),
        cmocka_unit_test(attributes_are_one_line_or_the_same_in_each),
        cmocka_unit_test(several_axes_lead_and_empty_lines_part_them),
        cmocka_unit_test(an_axis_of_one_entry_neither_leads_nor_parts),
        cmocka_unit_test(names_that_are_not_there_and_other_axes_are_refused),
        cmocka_unit_test(units_follow_from_the_rows),
        cmocka_unit_test(tells_what_there_is),
        cmocka_unit_test(an_unfinished_file_is_printed_as_far_as_it_goes),
        cmocka_unit_test(damaged_data_are_no_silent_end),
        cmocka_unit_test(any_byte_may_be_wrong),
    };
    return cmocka_run_group_tests(tests, set_up, remove_folder);
}
