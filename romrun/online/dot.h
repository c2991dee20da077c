/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Products of short arrays, for which BLAS takes four times as many instructions. */
#ifndef EHD_DOT_H
#define EHD_DOT_H

#include <stddef.h>

/* Four numbers from anywhere in an array of them. */
typedef double vector __attribute__((vector_size(32), aligned(sizeof(double)), may_alias));

/* Sum of a[i] b[i]. */
static inline double dot(const double *a, const double *b, size_t count) {
    const size_t whole = count / 8 * 8;
    vector even = {0}, odd = {0};

    for (size_t j = 0; j < whole; j += 8) {
        even += *(const vector *)(a + j) * *(const vector *)(b + j);
        odd += *(const vector *)(a + j + 4) * *(const vector *)(b + j + 4);
    }
    even += odd;
    double sum = even[0] + even[1] + (even[2] + even[3]);
    for (size_t j = whole; j < count; j++)
        sum += a[j] * b[j];
    return sum;
}

#endif
