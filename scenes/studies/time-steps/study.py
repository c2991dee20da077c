# SPDX-License-Identifier: GPL-3.0-or-later
"""What steps in time and filter do to the films: what results say of it, and what it is (README.md).

    study.py measure OUT TOLERANCES TRUTH_STEP OPTIONS...
    study.py draw OUT PICTURE.png
    study.py short SCENE.yml MODEL OUT PARTS...    minimum film of examples/line-in-time in equal steps shorter than the
                                                   grid's, against the full model in the same steps: by romrun, and by the
                                                   library, where steps begin at states half a grid step apart
"""
import math

import numpy as np

import pictures
import results

FILMS = {"central": ("H_c", "time_effect"), "minimum": ("H_min", "time_effect_minimum")}
GRID_STEP, PERIOD, AMPLITUDE = 0.01, 1.4, 0.1  # of the scene of short


def solved(file, case, *options):
    """A trajectory with the effects that its result tells."""
    found = results.trajectory(file, "fullrun", "scene.yml", *case.options, *options)
    if found.code != results.SOLVED:
        results.stop(f"{file}: {found.message}", found.code)
    found.effects = results.printed(file, "time_effect", "time_effect_minimum")
    return found


def mean(found, values):
    """Root of the mean square over time."""
    step = np.diff(found.time, prepend=0)
    return np.sqrt(np.sum(step * values**2) / found.time[-1])


def measure(out, tolerances, truth_step, *options):
    """Prints for each history and tolerance: steps, root mean square and largest of the true and the told effect."""
    rows = [["history", "tolerance", "steps", "film", "true rms", "told", "true most", "told", "rms / tolerance"], None]
    off = []
    for case in results.read_cases():
        truth = solved(f"{out}/{case.number}-truth.h5", case, *options, *results.sets(
            {"grid.step": truth_step, "transient.fixed_step": truth_step, "transient.smoothing": 0}))
        for tolerance in tolerances.split():
            found = solved(f"{out}/{case.number}-{tolerance}.h5", case, *options,
                           *results.sets({"transient.tolerance": tolerance}))
            for film, (column, name) in FILMS.items():
                true = results.at_times(truth.time, getattr(truth, column), found.time) / getattr(found, column) - 1
                told = found.effects[name]
                rows.append([case.title if film == "central" else "", tolerance if film == "central" else "",
                             found.steps if film == "central" else "", film,
                             *(f"{100 * value:.3f} %" for value in (mean(found, true), mean(found, told),
                                                                    np.max(abs(true)), np.max(abs(told)))),
                             f"{mean(found, true) / float(tolerance):.2f}" if film == "central" else ""])
                off.append((film, np.max(abs(told)) / np.max(abs(true)), mean(found, told) / mean(found, true)))
        rows.append(None)
    print("Effects of the steps in time and of the filter on the films, true and told by the result\n")
    results.table(rows, left=1)
    for film in FILMS:
        most, means = (sorted(row[i] for row in off if row[0] == film) for i in (1, 2))
        print(f"{film} film, told / true: largest {most[0]:.2f} to {most[-1]:.2f}, "
              f"root mean square {means[0]:.2f} to {means[-1]:.2f}")


def draw(out, target):
    """Draws true and told effects on the central film over time, at the default tolerance."""
    cases = results.read_cases()
    figure, panels = pictures.page(1800, 760, 2, 4, sharex=True)
    for axes, case in zip(panels.flat, cases):
        truth = results.read_trajectory(f"{out}/{case.number}-truth.h5")
        file = f"{out}/{case.number}-1.5e-3.h5"
        found = results.read_trajectory(file)
        told = results.printed(file, "time_effect")["time_effect"]
        true = results.at_times(truth.time, truth.H_c, found.time) / found.H_c - 1
        axes.plot(found.time, 100 * true, color=pictures.BLUE, label="true")
        axes.plot(found.time, 100 * told, color=pictures.RED, linestyle="--", label="told by the result")
        axes.set_title(f"{case.label}: {found.steps} steps", fontsize="medium")
    for axes in panels[:, 0]:
        axes.set_ylabel("effect on $H_c$ in %")
    for axes in panels[1]:
        axes.set_xlabel("time $T$")
    panels[0, 0].legend(frameon=False)
    pictures.save(figure, target)


# ---- Short steps


def in_equal_steps(file, program, scene, step, *options):
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


def short(scene, model, out, *parts):
    """Prints the largest errors, for steps of so many parts of the grid's."""
    import ehdrom  # the package of make python

    contact = ehdrom.Contact(ehdrom.Model(model), scene, dimensionless=True)
    rows = [["step / grid step", "steps", "romrun", "library"], None]
    for part in parts:
        step = float(part) * GRID_STEP
        full = in_equal_steps(f"{out}/short-full.h5", "fullrun", scene, step, "--grid-of", model)
        reduced = in_equal_steps(f"{out}/short-reduced.h5", "romrun", scene, step, "--model", model, "--allow-untrusted")
        off = (films / full.H_min[1:] - 1 for films in (reduced.H_min[1:], by_library(contact, full.time)))
        rows.append([part, full.steps, *(f"{np.max(abs(values)):.1e}" for values in off)])
    results.table(rows, left=0)


if __name__ == "__main__":
    results.commands(measure, draw, short)
