/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deimselect/given_rows.h"
#include "tests/unit/check.h"
#include "tests/unit/folder.h"

#include <stdio.h>
#include <string.h>

enum { NUM_INNER = 10, NUM_PRESSURE = 3 };

/* A basis of which only the sizes are used. */
static const reduced_basis basis = {.grid = {.num_inner = NUM_INNER}, .num_pressure = NUM_PRESSURE};

static ehd_status read_text(given_rows *given, const char *text, ehd_error *error) {
    FILE *file = fopen("rows.csv", "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    return given_rows_read(given, "rows.csv", &basis, error);
}

static void refuses(const char *text, const char *expected) {
    given_rows given;
    ehd_error error = {""};
    assert_int_equal(read_text(&given, text, &error), EHD_DATA);
    if (strcmp(error.text, expected) != 0)
        fail_msg("found \"%s\", expected \"%s\"", error.text, expected);
    assert_null(given.rows);
    assert_null(given.factors);
}

static void rows_and_weights_are_read(void **state) {
    (void)state;
    given_rows given;
    assert_int_equal(read_text(&given, "row\n9\n0\n4\n", NULL), EHD_OK);
    assert_int_equal(given.count, 3);
    assert_memory_equal(given.rows, ((size_t[]){9, 0, 4}), 3 * sizeof *given.rows);
    assert_null(given.factors);
    given_rows_free(&given);

    // columns may have any order and the names used in model.h5; other columns are ignored
    assert_int_equal(read_text(&given,
                               "# of mine\nx , row_factor, selected_row\n-1,0.5,2\n"
                               "who,2,7\n\n0,1e-3,3.0\n,1,0\n",
                               NULL),
                     EHD_OK);
    assert_int_equal(given.count, 4);
    assert_memory_equal(given.rows, ((size_t[]){2, 7, 3, 0}), 4 * sizeof *given.rows);
    check_close_array(given.factors, ((double[]){0.5, 2, 1e-3, 1}), 4, 0, 0);
    given_rows_free(&given);
}

static void bad_rows_are_refused(void **state) {
    (void)state;
    refuses("", "rows.csv: found an empty file, expected a header");
    refuses("4\n5\n6\n",
            "rows.csv:1: found the columns 4, expected a column selected_row|row|rows");
    refuses("weight\n1\n1\n1\n",
            "rows.csv:1: found the columns weight, expected a column selected_row|row|rows");
    refuses("row\n", "rows.csv: found 0 rows, expected at least 3: the model has 4 unknowns, of "
                     "which the load balance determines 1");
    refuses("row\n1\n2\n", "rows.csv: found 2 rows, expected at least 3: the model has 4 unknowns, "
                           "of which the load balance determines 1");
    refuses("row\n1\n2\n10\n",
            "rows.csv: row: found 10 as entry 3, expected a whole number from 0 to 9");
    refuses("row\n1\n-1\n3\n",
            "rows.csv: row: found -1 as entry 2, expected a whole number from 0 to 9");
    refuses("row\n1\n2\n2.5\n",
            "rows.csv: row: found 2.5 as entry 3, expected a whole number from 0 to 9");
    refuses("row\n1\n2\n1e300\n",
            "rows.csv: row: found 1e+300 as entry 3, expected a whole number from 0 to 9");
    refuses("row\n1\n2\n3\n2\n", "rows.csv: row: found 2 again as entry 4, expected each row once");
    refuses("row\n1\nx\n3\n", "rows.csv:3: row: found x, expected a number");
    refuses("row\n1\nnan\n3\n", "rows.csv:3: row: found nan, expected a number");
    refuses("row,weight\n1,1\n2\n3,1\n", "rows.csv:3: found 1 column, expected 2 as in the header");
}

/* If a file has several columns with known names, the column is used whose name comes first in the
 * list of known names. This matters because files of ehdrom also have the axis `row`. */
static void the_first_known_name_counts(void **state) {
    (void)state;
    given_rows given;
    assert_int_equal(read_text(&given, "row,selected_row,rows\n0,9,x\n1,5,x\n2,4,x\n", NULL),
                     EHD_OK);
    assert_memory_equal(given.rows, ((size_t[]){9, 5, 4}), 3 * sizeof *given.rows);
    given_rows_free(&given);
}

static void bad_weights_are_refused(void **state) {
    (void)state;
    refuses("row,weight\n1,1\n2,0\n3,1\n",
            "rows.csv: weight: found 0 as entry 2, expected a positive finite number");
    refuses("row,weight\n1,1\n2,1\n3,-1\n",
            "rows.csv: weight: found -1 as entry 3, expected a positive finite number");
    refuses("row,weight\n1,1\n2,inf\n3,1\n", "rows.csv:3: weight: found inf, expected a number");
    refuses("row,weight\n1,1\n2,\n3,1\n", "rows.csv:3: weight: found nothing, expected a number");
}

static void a_missing_file_is_no_input(void **state) {
    (void)state;
    given_rows given;
    assert_int_equal(given_rows_read(&given, "none.csv", &basis, NULL), EHD_NOINPUT);
    assert_int_equal(given_rows_read(&given, "none.h5", &basis, NULL), EHD_NOINPUT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_and_weights_are_read),  cmocka_unit_test(the_first_known_name_counts),
        cmocka_unit_test(bad_rows_are_refused),       cmocka_unit_test(bad_weights_are_refused),
        cmocka_unit_test(a_missing_file_is_no_input),
    };
    return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
