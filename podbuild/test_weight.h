/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The weight D of the test basis (Maier et al. 2015, eq. 27): how much each Reynolds row counts in
 * the least squares. */
#ifndef EHD_TEST_WEIGHT_H
#define EHD_TEST_WEIGHT_H

#include "romrun/model/reduced_model.h"

/* Writes one positive weight a node. `contacts` are those of the training, [num_contacts], where
 * they are known. EHD_DATA, EHD_MEMORY, EHD_INTERNAL. */
typedef ehd_status test_weight_function(
    // output:
    double *weight, // [num_nodes]
    // input:
    const reduced_basis *basis, const ehd_contact *contacts, size_t num_contacts, ehd_error *error);

typedef struct test_weight {
    const char *name; // "mode"
    test_weight_function *weigh;
    bool needs_contacts;
    const char *help;
} test_weight;

extern const test_weight test_weights[]; // ends with a row whose name is NULL

/* The entry of this name, or NULL. */
const test_weight *test_weight_find(const char *name);

/* The absolute first pressure mode, with a floor. */
test_weight_function test_weight_mode;

/* One for every row. */
test_weight_function test_weight_identity;

/* One over the norm of the row of the reduced Jacobian, root mean square over the stationary
 * training solutions whose contact is known; behind the first exit at most that of the last row
 * before it. EHD_DATA: no contact is known. */
test_weight_function test_weight_row_norm;

#endif
