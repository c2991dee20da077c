/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes products and sums of short arrays, for which BLAS takes four times as many
 * instructions.
 * Called by other sources of this folder, and by inner loops in romrun. */
#ifndef EHD_VECTORS_H
#define EHD_VECTORS_H

#include <math.h>
#include <stddef.h>

/* Four consecutive numbers, anywhere in an array. */
typedef double vector __attribute__((vector_size(32), aligned(sizeof(double)), may_alias));

/* Returns the sum of a[i] b[i]. */
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

/* Returns the sum of a[count - 1 - i] b[i], four terms at a time. */
static inline double dot_reversed(const double *a, const double *b, size_t count) {
    const size_t whole = count / 4 * 4;
    vector sums = {0};

    for (size_t j = 0; j < whole; j += 4)
        sums += __builtin_shufflevector(*(const vector *)(a + count - 4 - j),
                                        *(const vector *)(a + count - 4 - j), 3, 2, 1, 0) *
                *(const vector *)(b + j);
    double sum = sums[0] + sums[1] + (sums[2] + sums[3]);
    for (size_t j = whole; j < count; j++)
        sum += a[count - 1 - j] * b[j];
    return sum;
}

/* Adds factor x to y; the arrays must not overlap. */
static inline void axpy(double *restrict y, double factor, const double *restrict x, size_t count) {
    for (size_t j = 0; j < count; j++)
        y[j] += factor * x[j];
}

/* Multiplies x by a factor. */
static inline void vector_scale(double *x, double factor, size_t count) {
    for (size_t j = 0; j < count; j++)
        x[j] *= factor;
}

/* Returns the Euclidean norm, also where squares overflow or underflow. */
static inline double vector_norm(const double *x, size_t count) {
    const double least = 0x1p-900, most = 0x1p1000; // Source: range of a double
    const double square = dot(x, x, count);
    double largest = 0, sum = 0;

    if (square > least && square < most) return sqrt(square);
    for (size_t j = 0; j < count; j++) {
        if (isnan(x[j])) return NAN;
        largest = fmax(largest, fabs(x[j]));
    }
    if (largest == 0 || isinf(largest)) return largest;
    for (size_t j = 0; j < count; j++)
        sum += x[j] / largest * (x[j] / largest);
    return largest * sqrt(sum);
}

#endif
