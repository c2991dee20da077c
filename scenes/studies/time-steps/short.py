# SPDX-License-Identifier: GPL-3.0-or-later
"""Minimum film of examples/line-in-time in equal steps shorter than the grid's, against the full model in the same steps:
by romrun, and by the library, where steps begin at states half a grid step apart. short.py SCENE.yml MODEL OUT PARTS..."""
import math
import sys

import ehdrom
import numpy as np

import results

GRID_STEP, PERIOD, AMPLITUDE = 0.01, 1.4, 0.1  # of the scene


def solved(file, program, scene, step, *options):
    found = results.trajectory(file, program, scene, *options,
                               *results.sets({"transient.fixed_step": step, "transient.end_time": PERIOD}))
    if found.code not in (results.SOLVED, results.NOT_TRUSTED):
        results.stop(f"{file}: {found.message}", found.code)
    return found


def by_library(contact, times):
    """Minimum films behind the start."""
    films = []
    contact.start(load=1.0, speed=1.0)
    for before, time in zip(times[:-1], times[1:]):
        load = 1 + AMPLITUDE * math.sin(2 * math.pi * time / PERIOD)
        films.append(contact.step(time - before, load=load, speed=1.0).minimum_film_thickness)
        contact.accept()
    return np.array(films)


scene, model, out, *parts = sys.argv[1:]
contact = ehdrom.Contact(ehdrom.Model(model), scene, dimensionless=True)
rows = [["step / grid step", "steps", "romrun", "library"], None]
for part in parts:
    step = float(part) * GRID_STEP
    full = solved(f"{out}/short-full.h5", "fullrun", scene, step, "--grid-of", model)
    reduced = solved(f"{out}/short-reduced.h5", "romrun", scene, step, "--model", model, "--allow-untrusted")
    off = (films / full.H_min[1:] - 1 for films in (reduced.H_min[1:], by_library(contact, full.time)))
    rows.append([part, full.steps, *(f"{np.max(abs(values)):.1e}" for values in off)])
results.table(rows, left=0)
