#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A program that selects rows: select_rows.py RESIDUALS.h5 BASIS.h5 ROWS.csv (schemas/residuals.md).

The rows are the first pivots of a QR decomposition with column pivoting (Drmac and Gugercin, SIAM J. Sci. Comput. 38,
2016). The matrix has the leading modes of the residuals and of the products of Jacobian and Newton step. There are two
rows for each pressure mode.
"""
import sys

import h5py
import numpy


def pivots(matrix, count):
    """Returns columns. Each one has the largest part outside of the span of the columns before."""
    left, chosen = matrix.copy(), []
    for _ in range(count):
        column = numpy.argmax((left**2).sum(axis=0))
        direction = left[:, column] / numpy.linalg.norm(left[:, column])
        left -= numpy.outer(direction, direction @ left)
        chosen.append(column)
    return chosen


with h5py.File(sys.argv[1]) as residuals, h5py.File(sys.argv[2]) as basis:
    num_modes = len(basis["pressure_basis"])
    modes = [
        numpy.linalg.svd(residuals[name][...], full_matrices=False)[2][:num_modes]
        for name in ("weighted_residual", "weighted_jacobian_step")
    ]

rows = pivots(numpy.vstack(modes), 2 * num_modes)
numpy.savetxt(sys.argv[3], rows, "%d", header="row", comments="")
print(f"{len(rows)} rows of {modes[0].shape[1]}")
