#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A model by somebody else's program, from schemas/model.md alone: write_model.py BASIS.h5 ROWS.csv MODEL.h5"""
import sys

import h5py
import numpy

basis = h5py.File(sys.argv[1])
rows = numpy.loadtxt(sys.argv[2], int, skiprows=1)
model = h5py.File(sys.argv[3], "w")

# ---- the nodes of the film

pressure_modes = basis["pressure_basis"][...]
point, half = basis.attrs["contact"] in ("point", b"point"), basis.attrs.get("half", 0) == 1
x_min, step = basis.attrs["x_min"], basis.attrs["step"]
num_modes, num_x = pressure_modes.shape[0], pressure_modes.shape[-1]
num_y = pressure_modes.shape[1] if point else 1
width = num_x + 2
first_line = 1 if point and not half else 0
num_lines = first_line + num_y + (1 if point else 0)
x = x_min + step * (numpy.arange(width) - 1)
y = step * (numpy.arange(num_lines) - (0 if half or not point else (num_y + 1) / 2))
# nodes that a row reaches upstream (back), and downstream and across (ahead)
accurate = basis.attrs.get("discretization", "published") in ("accurate", b"accurate")
back, ahead = (3, 2) if accurate else (2, 1)
gap = (x[None, :] ** 2 + y[:, None] ** 2) / 2

V = numpy.zeros((num_lines, width, num_modes))
V[first_line : first_line + num_y, 1:-1] = numpy.moveaxis(pressure_modes.reshape(-1, num_y, num_x), 0, -1)

# ---- the deflection kernel


def line_part(a):
    return 0 if a == 0 else a * (numpy.log(abs(a)) - 1)


def point_part(a, b):
    return 0 if a == 0 or b == 0 else a * numpy.arcsinh(b / abs(a)) + b * numpy.arcsinh(a / abs(b))


def kernel(dx, dy):
    left, right, low, high = dx - step / 2, dx + step / 2, dy - step / 2, dy + step / 2
    if not point:
        return (line_part(left) - line_part(right)) / numpy.pi
    return 2 / numpy.pi**2 * (point_part(right, high) - point_part(left, high)
                              - point_part(right, low) + point_part(left, low))


def influence(dx, dy):
    here = kernel(dx, dy)
    if not accurate:
        return here
    along = kernel(dx - step, dy) - 2 * here + kernel(dx + step, dy)
    across = kernel(dx, dy - step) - 2 * here + kernel(dx, dy + step) if point else 0
    return here - (along + across) / 24


distances = numpy.array([[influence(i * step, l * step) for i in range(width)] for l in range(2 * num_lines)])
columns, lines = numpy.arange(width), numpy.arange(num_lines)
apart = abs(columns[:, None] - columns[None, :])
K = distances[abs(lines[:, None] - lines[None, :])][:, :, apart]  # [line, source line, column, source column]
if half:
    mirrored = distances[lines[:, None] + lines[None, :]][:, :, apart]
    mirrored[:, 0] = 0
    K = K + mirrored
K = K.transpose(0, 2, 1, 3).reshape(num_lines * width, num_lines * width)

# ---- the band

exits = numpy.ones((len(basis["state_exit_node"]), num_lines), int)
exits[:, first_line : first_line + num_y] = basis["state_exit_node"][...].reshape(-1, num_y) + 1
inner = range(first_line, first_line + num_y)
centre = int(-x_min / step) + 1
near = int(numpy.ceil(0.05 / step))
begin, minimum_lines = numpy.full(num_lines, width - 1), []
for a, exit in zip(basis["state_pressure"][...], exits):
    pressure = V @ a
    pressure[columns[None, :] >= exit[:, None]] = 0
    film = (K @ pressure.ravel()).reshape(num_lines, width) + gap
    film[(columns[None, :] < centre) | (columns[None, :] > exit[:, None])] = numpy.inf
    line, column = numpy.unravel_index(film.argmin(), film.shape)
    for l in inner:
        if abs(l - line) <= near:
            begin[l] = min(begin[l], column)
            minimum_lines.append(l)
margin = int(numpy.ceil((0.3 if point else 0.1) / step))
foremost = 2 if point else centre + 1
earliest, latest = exits.min(axis=0), exits.max(axis=0)
earliest = numpy.where(earliest > foremost + margin + back, earliest - margin, foremost + back)
latest = numpy.minimum(latest + margin, width - 2)
end = numpy.zeros(num_lines, int)
for l in list(inner):
    beside = [k for k in range(l - ahead, l + ahead + 1) if k in inner]
    first = min([begin[l]] + [earliest[k] for k in beside])
    begin[l] = max(first - near - back, 1 if point else foremost)
    end[l] = min(max(latest[k] for k in beside) + 1 + ahead, width)
begin[[l for l in lines if l not in inner]] = end[[l for l in lines if l not in inner]] = 1
band = numpy.concatenate([l * width + numpy.arange(begin[l], end[l]) for l in lines])

# ---- the nodes that rows need


def nodes_of(row):
    node = (row // num_x + first_line) * width + row % num_x + 1
    column, line = node % width, node // width
    found = [line * width + c for c in range(max(column - back, 0), min(column + ahead, width - 1) + 1)]
    if point:
        beside = [abs(k) if half else k for k in range(line - ahead, line + ahead + 1)]
        found += [k * width + column for k in beside if 0 <= k < num_lines]
    return found


place = -x_min / step + 1
k = int(numpy.floor(place + 1e-6))
around = [k] if abs(place - k) < 1e-6 else [k - 1, k, k + 1, k + 2]
central_line = (0 if half or not point else first_line + num_y // 2) * width
needed = numpy.unique([node for row in rows for node in nodes_of(row)] + [central_line + c for c in around])

# ---- the tables

V = V.reshape(-1, num_modes)
before_band = (columns[None, :] < begin[:, None]).ravel()
cut = V * before_band[:, None]
deflections = K @ cut

model["selected_row"] = rows
model["row_weight"] = basis["weight"][...].ravel()[rows]
model["needed_node_index"] = needed
model["needed_pressure_basis"] = V[needed]
model["band_pressure_basis"] = V[band]
if basis.attrs["deformation"] in ("coupled", b"coupled"):
    model["needed_coupled_basis"] = deflections[needed]
    model["band_coupled_basis"] = deflections[band]
else:
    U = basis["deformation_basis"][...].reshape(len(basis["deformation_basis"]), -1).T
    model["needed_deformation_basis"], model["band_deformation_basis"] = U[needed], U[band]
    model["elasticity_jacobian"] = U.T @ deflections
    model["band_projected_kernel"] = (U.T @ K[:, band]).T
    model["deformation_basis"] = basis["deformation_basis"][...]
twice = numpy.where(half & (y > 0), 2, 1).repeat(width)
model["load_jacobian"] = (step ** (2 if point else 1) * twice) @ cut
model["pressure_basis"] = pressure_modes
for name in basis:
    if name.startswith("state_"):
        model[name] = basis[name][...]
for name in "contact", "x_min", "step", "discretization", "boundary", "half", "deformation":
    if name in basis.attrs:
        model.attrs[name] = basis.attrs[name]
model.attrs["schema_name"], model.attrs["schema_version"] = "ehdrom-model", "2.0"
model.attrs["band_begin"], model.attrs["least_exit"], model.attrs["most_exit"] = begin[0], earliest[0], latest[0]
if point:
    inner = slice(first_line, first_line + num_y)
    model["band_line_begin"], model["band_line_end"] = begin[inner], end[inner]
    model["band_line_least_exit"], model["band_line_most_exit"] = earliest[inner], latest[inner]
    model.attrs["first_minimum_line"], model.attrs["last_minimum_line"] = min(minimum_lines), max(minimum_lines)
