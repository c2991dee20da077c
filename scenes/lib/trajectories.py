# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs transient scenes for the periods of cases.csv with full and reduced models, and makes tables and a picture.

cases.csv has a line for each period: transient.load.period, transient.end_time, transient.fixed_step, and published
values. Runs are OUT/full/STEPS-NUMBER.h5 and OUT/MODEL/STEPS-NUMBER.h5 with the number of the line. STEPS is

    adaptive             error control
    tenth                error control with a tenth of the default tolerance
    fixed                fixed steps
    truth                half of the fixed step and half of the grid step, accurate discretisation, transport along the
                         path, no smoothing
    published-half       published discretisation with half of the fixed step and half of the grid step
    published-quarter    published discretisation with a quarter of both
"""
from types import SimpleNamespace

import numpy as np

import pictures
import results

PERIOD, _, FIXED_STEP = KEYS = "transient.load.period", "transient.end_time", "transient.fixed_step"


def mark(run):
    """Returns the mark of a run in tables: * if it stopped early, + if it is not trusted."""
    return {results.NOT_CONVERGED: "*", results.NOT_TRUSTED: "+"}.get(run and run.code, " ")


def short(case):
    """Returns whether the period is not far above the time a_ref/u_ref, so that the transport of the film matters."""
    return float(case.settings[PERIOD]) <= 100


def numbers():
    """Checks the table, and prints the numbers of all cases and, in a second line, of the cases with short periods."""
    cases = results.read_cases()
    if not cases:
        results.stop("cases.csv: found no trajectories, expected a line each below the header")
    for case in cases:
        for key in KEYS:
            if key not in case.settings:
                results.stop(f"cases.csv: found no {key} of {case.name}, expected one")
            try:
                float(case.settings[key])
            except ValueError:
                results.stop(f"cases.csv: found {key} = '{case.settings[key]}', expected a number")
    print(*(case.number for case in cases))
    print(*(case.number for case in cases if short(case)))


def run(name, tenth, fixed, *command):
    """Replaces this process by the command, with the settings of the run `name` (STEPS-NUMBER) as further options.
    `tenth` is a tenth of the default tolerance. Finer grids have parts of the grid step of the result `fixed`."""
    steps, _, number = name.rpartition("-")
    case = results.read_cases()[int(number) - 1].settings
    own = {key: text for key, text in case.items() if key != FIXED_STEP}
    part = {"truth": 0.5, "published-half": 0.5, "published-quarter": 0.25}.get(steps)
    if part:
        own |= {FIXED_STEP: f"{float(case[FIXED_STEP]) * part:.12g}",
                "grid.step": f"{results.value(fixed, 'step') * part:.12g}"}
    more = {"adaptive": {}, "tenth": {"transient.tolerance": tenth}, "fixed": {FIXED_STEP: case[FIXED_STEP]},
            "truth": {"discretization": "accurate", "transport": "path", "transient.smoothing": "0"}}
    results.execute(command, own | more.get(steps, {"discretization": "published", "transport": "upwind"}))


def largest(reference, other, column):
    """Returns the largest deviation over time in per cent, or NaN if the runs have no time in common."""
    found = np.abs(results.deviations(reference, other, column))
    return 100 * np.max(found[~np.isnan(found)], initial=0) if not np.isnan(found).all() else np.nan


# ---- Tables


def size_table(models, snapshots, published):
    """Prints sizes of the models (name to path) and published sizes (text: nodes, modes, rows, needed nodes, steps)."""
    print(f"{'Table 6: sizes' if published else 'Sizes'} (m: steps of the training trajectories)\n")
    lines = {name: [*list(results.model_sizes(file).values())[:5], snapshots] for name, file in models.items()}
    if published:
        lines["published"] = map(int, published.split())
    rows = [["", "n", "m", "unknowns", "n_p", "n_delta", "rows", "needed nodes"], None]
    for name, (nodes, modes, more, selected, needed, states) in lines.items():
        rows.append([name, nodes, states, modes + more + 1, modes, more or "-", selected, needed])
    results.table(rows)


def time_table(model, cases, runs):
    """Prints steps and times of the adaptive runs, full and reduced, and below each case the published values."""
    published = any(case.published for case in cases)
    print(f"\n{'Table 7: adaptive' if published else 'Adaptive'} steps at the default tolerance, {model}"
          + ("; the second line of a period: as published" if published else "") + "\n")
    rows = [["T_exc", "steps", "", "seconds", "", "ratio", "ms a step", ""],
            ["", "full", "reduced ", "full", "reduced", "", "full", "reduced"], None]

    def add(label, full_steps, full_seconds, steps, seconds, note=" "):
        rows.append([label, f"{full_steps:.0f}", f"{steps:.0f}{note}", f"{full_seconds:.2f}", f"{seconds:.2f}",
                     f"{full_seconds / seconds:.1f}", f"{1000 * full_seconds / full_steps:.2f}",
                     f"{1000 * seconds / steps:.3f}"])

    for case in cases:
        full, reduced = (runs[kind, "adaptive", case.number] for kind in ("full", model))
        add(case.settings[PERIOD], full.steps, full.seconds, reduced.steps, reduced.seconds, mark(reduced))
        if case.published:
            add("  published", *(float(case.published[f"{name}_{kind}"]) for kind in ("full", "reduced")
                                 for name in ("steps", "seconds")))
    results.table(rows)


def deviation_table(model, cases, runs):
    """Prints the largest deviations over time; - stands for runs that do not exist."""
    print(f"\nLargest deviations over time in per cent, {model}\n"
          "fixed, adaptive: reduced against full model with the same kind of steps; tolerance: full model against\n"
          "itself at a tenth of the default tolerance\n")
    rows = [["T_exc", "fixed P_c ", "H_c ", "adapt. P_c ", "H_c ", "toler. P_c ", "H_c ", "fixed ms/step"], None]
    numbers = []
    for case in cases:
        number, row, marks = case.number, [], []
        for kind, steps, other in ((model, "fixed", "fixed"), (model, "adaptive", "adaptive"),
                                   ("full", "adaptive", "tenth")):
            run = runs.get((kind, steps, number))
            row += [largest(runs["full", other, number], run, column) if run else np.nan for column in ("P_c", "H_c")]
            marks += 2 * [mark(run)]
        fixed = runs[model, "fixed", number]
        numbers.append(row)
        rows.append([case.settings[PERIOD], *map(per_cent, row, marks), f"{1000 * fixed.seconds / fixed.steps:.3f}"])
    results.table([*rows, None, ["worst", *map(per_cent, np.fmax.reduce(numbers)), ""]])


def per_cent(number, note=" "):
    return f"{'-' if np.isnan(number) else f'{number:.5f}'}{note}"


def tables(out, published, *models):
    """Prints sizes, steps, times and deviations of models (each `NAME STEPS...`), beside the published sizes."""
    cases = results.read_cases()
    kinds = {model.split()[0]: model.split()[1:] for model in models}
    wanted = [("full", "tenth"), *((kind, steps) for name in kinds for kind in ("full", name) for steps in kinds[name])]
    runs = {(kind, steps, case.number): results.read_trajectory(f"{out}/{kind}/{steps}-{case.number}.h5")
            for kind, steps in dict.fromkeys(wanted) for case in cases}
    snapshots = int(results.value(f"{out}/snapshots.h5", "compressed_snapshots", 0))
    size_table({name: f"{out}/{name}.h5" for name in kinds}, snapshots, published)
    for name in kinds:
        if "adaptive" in kinds[name]:
            time_table(name, cases, runs)
    for name in kinds:
        deviation_table(name, cases, runs)
    if any(run.code for run in runs.values()):
        print("\n* stopped early, + not to be trusted")


def distances(out, model):
    """Prints for each period the steps and times of both models, with error control and with fixed steps. Also prints
    the largest deviations over time of central and minimum film: from the converged solution, and of the reduced model
    from the full model."""
    print(f"Largest deviations over time in per cent (rms in brackets): from the truth, and of {model} from the full\n"
          "model with the same kind of steps\n")
    rows = [["T_exc", "model", "steps", "number ", "ms a step", "seconds", "truth: H_c", "H_min", "full: H_c", "H_min"],
            None]
    for case in filter(short, results.read_cases()):
        period = case.settings[PERIOD]
        runs = {(kind, steps): results.read_trajectory(f"{out}/{kind}/{steps}-{case.number}.h5")
                for kind, steps in (("full", "truth"), *((kind, steps) for steps in ("adaptive", "fixed")
                                                         for kind in ("full", model)))}
        for (kind, steps), run in runs.items():
            row = [period, kind, steps, f"{run.steps}{mark(run)}", f"{1000 * run.seconds / run.steps:.3f}",
                   f"{run.seconds:.3f}"]
            for column in ("H_c", "H_min"):
                row.append(off_by(runs["full", "truth"], run, column) if steps != "truth" else "")
            row += [f"{largest(runs['full', steps], run, column):.4f}" if kind == model else ""
                    for column in ("H_c", "H_min")]
            rows.append(row)
        rows.append(None)
    results.table(rows, left=3)
    if any(row and row[3][-1] in "*+" for row in rows):
        print("\n* stopped early, + not to be trusted")


def off_by(reference, other, column):
    """Returns the largest deviation over time in per cent, and in brackets the rms deviation."""
    off = results.deviations(reference, other, column)
    return f"{largest(reference, other, column):.3f} ({100 * np.sqrt(np.mean(off[~np.isnan(off)]**2)):.3f})"


def confirm(out, number):
    """Prints the deviations of the films with transport along the path from the films of the published discretisation.
    The latter are extrapolated with second order from two grids and two time steps."""
    period = results.read_cases()[int(number) - 1].settings[PERIOD]
    runs = {name: results.read_trajectory(f"{out}/full/{name}-{number}.h5")
            for name in ("truth", "adaptive", "published-half", "published-quarter")}
    coarse, fine = runs["published-half"], runs["published-quarter"]
    exact = SimpleNamespace(time=coarse.time, **{
        column: (4 * results.at_times(fine.time, getattr(fine, column), coarse.time) - getattr(coarse, column)) / 3
        for column in ("H_c", "H_min")})
    print(f"Largest deviations over time in per cent (rms in brackets), T_exc = {period}: from the published rows with half\n"
          "and a quarter of the steps of grid and time, extrapolated\n")
    results.table([["full model", "steps", "H_c", "H_min"], None,
                   *([name, run.steps, *(off_by(exact, run, column) for column in ("H_c", "H_min"))]
                     for name, run in runs.items())])


# ---- Picture


def picture(out, model, target):
    """Draws central pressure and film of the full model over time, and deviations of the reduced model (paper, Fig. 4).
    Periods far above the time a_ref/u_ref have a separate column, with the time divided by the period."""
    cases = results.read_cases()
    columns = [shown for shown in ([*filter(short, cases)], [case for case in cases if not short(case)]) if shown]
    figure, grid = pictures.page(1300, 1200, 4, len(columns), sharex="col", squeeze=False,
                                 gridspec_kw={"width_ratios": [2.6, 1][:len(columns)]})
    for axes, shown in zip(grid.T, columns):
        for case in shown:
            full, reduced = (results.read_trajectory(f"{out}/{kind}/adaptive-{case.number}.h5") for kind in ("full", model))
            period = case.settings[PERIOD]
            style = {"color": pictures.COLOURS[(case.number - 1) % 6], "label": f"$T_{{exc}}$ = {period}"}
            unit = 1 if short(case) else float(period)
            for i, column in enumerate(("P_c", "H_c")):
                axes[i].plot(full.time / unit, getattr(full, column), **style)
                axes[2 + i].plot(reduced.time / unit, 100 * results.deviations(full, reduced, column), **style)
        axes[3].margins(x=0)
        axes[3].set(xlim=(0, None), xlabel="$T/T_{exc}$" if not short(shown[0]) else "time $T = t\\,u_{ref}/a_{ref}$")
        axes[0].legend(loc="lower right", bbox_to_anchor=(1, 1), ncol=len(shown), frameon=False)
    for axes, label in zip(grid[:, 0], ("$P_c$, reference frame", "$H_c$, reference frame", "$P_c$, deviation / %",
                                        "$H_c$, deviation / %")):
        axes.set_ylabel(label)
    figure.align_ylabels()
    pictures.save(figure, target)


if __name__ == "__main__":
    results.commands(numbers, run, tables, distances, confirm, picture)
