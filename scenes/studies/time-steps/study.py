# SPDX-License-Identifier: GPL-3.0-or-later
"""What steps in time and filter do to the films: what results say of it, and what it is."""
import numpy as np

import pictures
import results

FILMS = {"central": ("H_c", "time_effect"), "minimum": ("H_min", "time_effect_minimum")}


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


if __name__ == "__main__":
    results.commands(measure, draw)
