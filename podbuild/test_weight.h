/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the weight D of the test basis (Maier et al. 2015, eq. 27): one weight in the least
 * squares for each Reynolds row. */
#ifndef EHD_TEST_WEIGHT_H
#define EHD_TEST_WEIGHT_H

#include "romrun/model/reduced_model.h"

/* Writes one positive weight for each node. `contacts`: [num_contacts] contacts of the training;
 * NULL if no plan is given, with 0 for num_contacts. Errors: EHD_DATA, EHD_MEMORY, EHD_INTERNAL. */
typedef ehd_status test_weight_function(
    // output:
    double *weight, // [num_nodes]
    // input:
    const reduced_basis *basis, const ehd_contact *contacts, size_t num_contacts, ehd_error *error);

typedef struct test_weight {
    const char *name; // argument of --weight, such as "mode"
    test_weight_function *weigh;
    bool needs_contacts;
    const char *help;
} test_weight;

extern const test_weight test_weights[]; // ends with an entry whose name is NULL

/* Weight "mode": the magnitude of the first pressure mode, with a lower limit (README.md, The
 * floor). */
test_weight_function test_weight_mode;

/* Weight "identity": 1 for every row. */
test_weight_function test_weight_identity;

/* Weight "row-norm": one over the norm of the row of the reduced Jacobian. The norm is the root
 * mean square over the stationary training solutions whose contact is given. Rows behind the exit
 * of any of these solutions get at most the weight of the last row before all exits. EHD_DATA: no
 * contact belongs to a training solution. */
test_weight_function test_weight_row_norm;

#endif
