# SPDX-License-Identifier: GPL-3.0-or-later
"""Studies loads beyond the published range, pressure and film at one time (paper, Fig. 5), and errors due to time steps
(README.md):

    study.py extremes OUT MODEL AMPLITUDE-PERIOD...
    study.py figure5 FULL.h5 REDUCED.h5 PICTURE.png PERIOD TIME
    study.py effects OUT HISTORIES TOLERANCES TRUTH_STEP OPTIONS...    estimated and true errors due to steps and filter
    study.py draw OUT HISTORIES PICTURE.png                            draws these errors of the central film over time
    study.py short SCENE.yml MODEL OUT PARTS...    minimum film of examples/line-in-time with equal time steps, in which
                                                   the fluid moves by less than a grid step: romrun, and the library,
                                                   whose steps begin at states half a grid step apart, compared with the
                                                   full model with the same steps
"""
import math

import numpy as np

import pictures
import results
import trajectories


def extremes(out, model, *runs):
    """Prints full and reduced model beside each other for runs AMPLITUDE-PERIOD."""
    def outcome(run):
        return {results.SOLVED: "done", results.NOT_TRUSTED: "not trusted"}.get(
            run.code, f"stopped at T = {run.time[-1]:.3f}" if run.steps else "stopped at its start")

    rows = [["amplitude", "T_exc", "full model", "steps", "reduced model", "steps", "P_c", "H_c"], None]
    print("Loads beyond the published range: largest deviations of the reduced from the full model over time in %\n")
    incomplete = silent = 0
    for run in runs:
        amplitude, period = run.split("-")
        full, reduced = (results.read_trajectory(f"{out}/{kind}/extreme-{run}.h5") for kind in ("full", model))
        pressure, film = (trajectories.largest(full, reduced, column) for column in ("P_c", "H_c"))
        rows.append([f"{100 * float(amplitude):.0f} %", period, outcome(full), full.steps, outcome(reduced),
                     reduced.steps, f"{pressure:.4f}", f"{film:.4f}"])
        incomplete += full.code != results.SOLVED
        silent += reduced.code == results.SOLVED and (pressure > 1 or film > 1)
    results.table([*rows, None], left=0)
    print(f"full runs that did not complete: {incomplete}; reduced runs more than 1 % off that say nothing: {silent}")


def figure5(full, reduced, target, period, time):
    """Draws pressure and film at the last time and a zoom of the outlet; lines: full model, marks: reduced one."""
    figure, panels = pictures.page(1200, 620, 1, 2, gridspec_kw={"width_ratios": [1.5, 1]})
    (x, P, H), (reduced_x, reduced_P, reduced_H) = map(results.profile, (full, reduced))
    for axes, (left, right), most_P, most_H, every in zip(panels, ((-1.5, 1.5), (0.85, 1.05)), (1.2, 0.6), (0.06, 0.03),
                                                          (12, 1)):
        film = axes.twinx()
        pictures.pair(axes, (x, P), (reduced_x, reduced_P), every, label="$P$, ")
        pictures.pair(film, (x, H), (reduced_x, reduced_H), every, pictures.RED, "s", "$H$, ")
        axes.set(xlim=(left, right), ylim=(0, most_P), xlabel="position $X$, current frame")
        film.set(ylim=(0, most_H))
        film.grid(False)
    panels[0].set_ylabel("pressure $P$", color=pictures.BLUE)
    film.set_ylabel("film thickness $H$", color=pictures.RED)
    panels[1].set_title("outlet")
    handles = [handle for axes in (panels[1], film) for handle in axes.get_legend_handles_labels()[0]]
    panels[0].legend(handles=handles, title=f"$T_{{exc}}$ = {period},  $T$ = {time}", loc="lower center",
                     bbox_to_anchor=(0.5, 1), ncol=2, frameon=False)
    pictures.save(figure, target)


# ---- What the steps in time do

# Titles and settings of histories. Only the first one was used for tuning.
HISTORIES = {
    "load": ("load ± 10 %, period 1/2", {"load.law": "sine", "load.amplitude": 0.1, "load.period": 0.5}),
    "strong": ("load ± 40 %, period 3/2", {"load.law": "sine", "load.amplitude": 0.4, "load.period": 1.5}),
    "soft": ("load ± 30 %, period 1; M = 20, L = 5",
             {"moes.M": 20, "moes.L": 5, "load.law": "sine", "load.amplitude": 0.3, "load.period": 1}),
    "ramp": ("load to 1.5 within 1; M = 60",
             {"moes.M": 60, "load.law": "ramp", "load.to": 1.5, "load.start": 0.2, "load.duration": 1}),
    "speed": ("speed ± 30 %, period 1", {"speed.law": "sine", "speed.amplitude": 0.3, "speed.period": 1}),
    "radius": ("radius ± 10 %, period 3/4", {"radius.law": "sine", "radius.amplitude": 0.1, "radius.period": 0.75}),
    "jump": ("load jumps to 1.3; M = 20, L = 5",
             {"moes.M": 20, "moes.L": 5, "load.law": "step", "load.to": 1.3, "load.at": 0.2}),
    "faster": ("speed jumps to 1.3", {"speed.law": "step", "speed.to": 1.3, "speed.at": 0.2})}

FILMS = {"central": ("H_c", "time_effect"), "minimum": ("H_min", "time_effect_minimum")}
GRID_STEP, PERIOD, AMPLITUDE = 0.01, 1.4, 0.1  # of the scene that `short` uses


def options_of(history):
    """Returns options that replace the load history of scene.yml, and set the accurate discretisation."""
    settings = {"discretization": "accurate", **dict.fromkeys(("load.law", "load.amplitude", "load.period"), ""),
                **HISTORIES[history][1]}
    return results.sets({key if key.startswith(("moes", "disc")) else f"transient.{key}": value
                         for key, value in settings.items()})


def solved(file, history, *options):
    """Runs a trajectory. Returns it with the error estimates in its result."""
    found = results.trajectory(file, "fullrun", "scene.yml", *options_of(history), *options)
    if found.code != results.SOLVED:
        results.stop(f"{file}: {found.message}", found.code)
    found.effects = results.printed(file, "time_effect", "time_effect_minimum")
    return found


def mean(found, values):
    """Returns the root mean square over time."""
    step = np.diff(found.time, prepend=0)
    return np.sqrt(np.sum(step * values**2) / found.time[-1])


def effects(out, histories, tolerances, truth_step, *options):
    """Prints for each history and tolerance the steps, and the rms and largest values of true and estimated errors."""
    rows = [["history", "tolerance", "steps", "film", "true rms", "told", "true most", "told", "rms / tolerance"], None]
    off = []
    for history in histories.split():
        truth = solved(f"{out}/{history}-truth.h5", history, *options, *results.sets(
            {"grid.step": truth_step, "transient.fixed_step": truth_step, "transient.smoothing": 0}))
        for tolerance in tolerances.split():
            found = solved(f"{out}/{history}-{tolerance}.h5", history, *options,
                           *results.sets({"transient.tolerance": tolerance}))
            for film, (column, name) in FILMS.items():
                true = results.at_times(truth.time, getattr(truth, column), found.time) / getattr(found, column) - 1
                told = found.effects[name]
                rows.append([HISTORIES[history][0] if film == "central" else "", tolerance if film == "central" else "",
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


def draw(out, histories, target):
    """Draws true and estimated errors of the central film over time, at the default tolerance."""
    figure, panels = pictures.page(1800, 760, 2, 4, sharex=True)
    for axes, history in zip(panels.flat, histories.split()):
        truth = results.read_trajectory(f"{out}/{history}-truth.h5")
        file = f"{out}/{history}-1.5e-3.h5"
        found = results.read_trajectory(file)
        told = results.printed(file, "time_effect")["time_effect"]
        true = results.at_times(truth.time, truth.H_c, found.time) / found.H_c - 1
        axes.plot(found.time, 100 * true, color=pictures.BLUE, label="true")
        axes.plot(found.time, 100 * told, color=pictures.RED, linestyle="--", label="told by the result")
        axes.set_title(f"{HISTORIES[history][0]}: {found.steps} steps", fontsize="medium")
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
    """Returns the minimum films after the start."""
    films = []
    contact.start(load=1.0, speed=1.0)
    for before, time in zip(times[:-1], times[1:]):
        load = 1 + AMPLITUDE * math.sin(2 * math.pi * time / PERIOD)
        films.append(contact.step(time - before, load=load, speed=1.0).minimum_film_thickness)
        contact.accept()
    return np.array(films)


def short(scene, model, out, *parts):
    """Prints the largest errors for time steps that are parts of the grid step."""
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
    results.commands(extremes, figure5, effects, draw, short)
