# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes in time over the periods of cases.csv, with full and reduced models: what make runs, tables, a picture.

cases.csv has a line for each period: transient.load.period, transient.end_time and transient.fixed_step, and what was
published. Runs are OUT/full/STEPS-PERIOD.h5 and OUT/MODEL/STEPS-PERIOD.h5, with STEPS of a length by error control
(adaptive), of a tenth of its tolerance (tenth), or of a fixed length (fixed).
"""
import numpy as np

import pictures
import results

PERIOD, _, FIXED_STEP = KEYS = "transient.load.period", "transient.end_time", "transient.fixed_step"


def mark(run):
    """Of a run that stopped early *, of one that is not to be trusted +."""
    return {results.NOT_CONVERGED: "*", results.NOT_TRUSTED: "+"}.get(run and run.code, " ")


def for_make():
    """Prints variables of make: PERIODS, and settings.STEPS-PERIOD, the options of each run."""
    cases = results.read_cases()
    if not cases:
        results.stop("cases.csv: found no trajectories, expected a line each below the header")
    for case in cases:
        for key in KEYS:
            if key not in case.settings:
                results.stop(f"cases.csv: found no {key} of {case.name}, expected one")
    print("PERIODS :=", *(case.settings[PERIOD] for case in cases))
    for case in cases:
        own = {key: text for key, text in case.settings.items() if key != FIXED_STEP}
        for steps, settings in (("adaptive", own), ("tenth", own | {"transient.tolerance": "1e-5"}),
                                ("fixed", case.settings)):
            print(f"settings.{steps}-{own[PERIOD]} :=", *results.sets(settings))


def largest(reference, other, column):
    """The largest deviation over time in per cent, NaN where they have no time in common."""
    found = np.abs(results.deviations(reference, other, column))
    return 100 * np.max(found[~np.isnan(found)], initial=0) if not np.isnan(found).all() else np.nan


# ---- Tables


def size_table(models, snapshots, published):
    """Sizes of the models (name to path), and those published (text: nodes, modes, rows, needed nodes, steps)."""
    print(f"{'Table 6: sizes' if published else 'Sizes'} (m: steps of the training trajectories)\n")
    form = "{:<12} {:>6} {:>7} {:>9} {:>5} {:>8} {:>6} {:>13}".format
    print(form("", "n", "m", "unknowns", "n_p", "n_delta", "rows", "needed nodes"))
    print(results.rule(74))
    lines = [(name, snapshots, *list(results.model_sizes(file).values())[:5]) for name, file in models.items()]
    if published:
        *sizes, states = map(int, published.split())
        lines.append(("published", states, *sizes))
    for name, states, nodes, modes, more, rows, needed in lines:
        print(form(name, nodes, states, modes + more + 1, modes, more or "-", rows, needed))


def time_table(model, cases, runs):
    """Steps and times of the adaptive runs, full and reduced, below each what was published."""
    published = any(case.published for case in cases)
    print(f"\n{'Table 7: adaptive' if published else 'Adaptive'} steps at the default tolerance, {model}"
          + ("; the second line of a period: as published" if published else ""))
    print(f"\n{'T_exc':<18} {'steps':>7} {'':>8}  {'seconds':>10} {'':>9} {'ratio':>9} {'ms a step':>19}")
    print(f"{'':<18} {'full':>7} {'reduced':>8}  {'full':>10} {'reduced':>9} {'':>9} {'full':>9} {'reduced':>9}")
    print(results.rule(87))

    def line(label, full_steps, full_seconds, steps, seconds, mark=" "):
        print(f"{label:<18} {full_steps:7.0f} {steps:8.0f}{mark} {full_seconds:10.2f} {seconds:9.2f} "
              f"{full_seconds / seconds:9.1f} {1000 * full_seconds / full_steps:9.2f} {1000 * seconds / steps:9.3f}")

    for case in cases:
        full, reduced = (runs[kind, "adaptive", case.settings[PERIOD]] for kind in ("full", model))
        line(case.settings[PERIOD], full.steps, full.seconds, reduced.steps, reduced.seconds, mark(reduced))
        if case.published:
            line("  published", *(float(case.published[f"{name}_{kind}"]) for kind in ("full", "reduced")
                                  for name in ("steps", "seconds")))


def deviation_table(model, cases, runs):
    """The largest deviations over time, - for runs that there are none of."""
    def line(label, numbers, marks=" " * 6, last=""):
        cells = [f" {'-' if np.isnan(x) else f'{x:.5f}':>9}{sign}" for x, sign in zip(numbers, marks)]
        print(f"{label:<10}{' '.join(map(''.join, zip(cells[::2], cells[1::2])))} {last}".rstrip())

    print(f"\nLargest deviations over time in per cent, {model}\n"
          "fixed, adaptive: reduced against full model with the same kind of steps; tolerance: full model against\n"
          "itself at a tenth of the default tolerance\n")
    print(f"{'T_exc':<10} {'fixed P_c':>10} {'H_c':>10}  {'adapt. P_c':>10} {'H_c':>10}  {'toler. P_c':>10} {'H_c':>10}"
          "  fixed ms/step")
    print(results.rule(91))
    numbers = np.full((len(cases), 6), np.nan)
    for case, row in zip(cases, numbers):
        period, marks = case.settings[PERIOD], ""
        for i, (kind, steps, other) in enumerate(((model, "fixed", "fixed"), (model, "adaptive", "adaptive"),
                                                  ("full", "adaptive", "tenth"))):
            run = runs.get((kind, steps, period))
            marks += 2 * mark(run)
            if run:
                row[2 * i:2 * i + 2] = [largest(runs["full", other, period], run, column) for column in ("P_c", "H_c")]
        fixed = runs[model, "fixed", period]
        line(period, row, marks, f"{1000 * fixed.seconds / fixed.steps:12.3f}")
    print(results.rule(91))
    line("worst", np.fmax.reduce(numbers))


def tables(out, published, *models):
    """Prints sizes, steps with times and deviations of models (each NAME STEPS...) beside the published sizes."""
    cases = results.read_cases()
    kinds = {model.split()[0]: model.split()[1:] for model in models}
    wanted = [("full", "tenth"), *((kind, steps) for name in kinds for kind in ("full", name) for steps in kinds[name])]
    runs = {(kind, steps, case.settings[PERIOD]):
            results.read_trajectory(f"{out}/{kind}/{steps}-{case.settings[PERIOD]}.h5")
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


# ---- Picture


def picture(out, model, target):
    """Draws central pressure and film of the full model over time, and deviations of the reduced one (paper, Fig. 4).
    Periods far above the time a_ref/u_ref have a column of their own, over parts of the period."""
    periods = [case.settings[PERIOD] for case in results.read_cases()]
    short = [period for period in periods if float(period) <= 100]
    columns = [shown for shown in (short, [period for period in periods if period not in short]) if shown]
    figure, grid = pictures.page(1300, 1200, 4, len(columns), sharex="col", squeeze=False,
                                 gridspec_kw={"width_ratios": [2.6, 1][:len(columns)]})
    for axes, shown in zip(grid.T, columns):
        for period in shown:
            full, reduced = (results.read_trajectory(f"{out}/{kind}/adaptive-{period}.h5") for kind in ("full", model))
            style = {"color": pictures.COLOURS[periods.index(period) % 6], "label": f"$T_{{exc}}$ = {period}"}
            unit = float(period) if shown is not short else 1
            for i, column in enumerate(("P_c", "H_c")):
                axes[i].plot(full.time / unit, getattr(full, column), **style)
                axes[2 + i].plot(reduced.time / unit, 100 * results.deviations(full, reduced, column), **style)
        axes[3].margins(x=0)
        axes[3].set(xlim=(0, None), xlabel="$T/T_{exc}$" if shown is not short else "time $T = t\\,u_{ref}/a_{ref}$")
        axes[0].legend(loc="lower right", bbox_to_anchor=(1, 1), ncol=len(shown), frameon=False)
    for axes, label in zip(grid[:, 0], ("$P_c$, reference frame", "$H_c$, reference frame", "$P_c$, deviation / %",
                                        "$H_c$, deviation / %")):
        axes.set_ylabel(label)
    figure.align_ylabels()
    pictures.save(figure, target)


if __name__ == "__main__":
    results.commands(for_make, tables, picture)
