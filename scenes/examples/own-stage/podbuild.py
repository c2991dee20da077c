#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A program in place of podbuild: podbuild.py SNAPSHOTS.h5 BASIS.h5 (schemas/snapshots.md, schemas/basis.md)."""
import sys

import h5py
import numpy

DISCARDED_ENERGY = 1e-13  # part of the squared singular values that is left out

with h5py.File(sys.argv[1]) as snapshots, h5py.File(sys.argv[2], "w") as basis:
    solved = snapshots["status"][...] == 0
    pressure = snapshots["pressure"][...][solved]  # [state, x], zero behind the exit

    # the modes are the right singular vectors; each one is as long as the grid and of norm 1
    _, values, modes = numpy.linalg.svd(pressure, full_matrices=False)
    left_out = numpy.cumsum(values[::-1] ** 2)[::-1] / numpy.sum(values**2)
    modes = modes[left_out > DISCARDED_ENERGY]

    for name in "contact", "x_min", "step", "discretization":
        basis.attrs[name] = snapshots.attrs[name]
    basis.attrs["schema_name"] = "ehdrom-basis"
    basis.attrs["schema_version"] = "2.0"
    basis.attrs["deformation"] = "coupled"  # deflections of the pressure modes; there are no deformation modes
    basis["pressure_basis"] = modes
    basis["state_pressure"] = pressure @ modes.T
    for name in "rigid_approach", "exit_node", "moes_M", "alpha_p_H":
        basis["state_" + name] = snapshots[name][...][solved]

    # the weight D of the rows: the first mode, with a floor for rows beyond the exits of the training
    first = abs(modes[0])
    basis["weight"] = numpy.maximum(first, 1e-4 * first.max())

print(f"{len(modes)} modes of {len(pressure)} solutions")
