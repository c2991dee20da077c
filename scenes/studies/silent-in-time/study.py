# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests whether a reduced model flags its wrong results in transient runs (README.md):

    study.py draw FOLDER SEED COUNT [plan]      draws random histories of load and speed: FOLDER/NUMBER.yml or, for a
                                                calibration and without tables, FOLDER/plan.yml
    study.py run FOLDER MODEL.h5 PROMISE...     solves them with the full model and, for each promise, with a calibrated
                                                model: FOLDER/runs.csv. A promise is a number (the accuracy), none (the
                                                limit is 1 %), or fallback (the limit is 1 %, and the full model solves
                                                what the reduced model does not)
    study.py table RUNS.csv SEED                prints counts; exit code 1 if a run ended with an error

The history of load or speed is a sine, a ramp, a step, a table, or constant; at least one of both varies. Two thirds of
the histories stay inside of the range of the training plan, a third may go beyond.
"""
import os
import re
import resource
import sys

import numpy as np

import results

END = 2.5
LOAD, SPEED = (0.87, 1.13), (0.75, 1.25)  # factors inside; the training has 0.85 to 1.15 and 0.7 to 1.3
BEYOND = 2  # ranges outside over ranges inside
RUN = ["number", "where", "promise", "code", "common", "central", "minimum", "load", "speed", "cost"]
REPEAT = 2  # runs of a program, of which the least processor time counts
OPTIONS = {"none": [], "fallback": ["--fallback", "full"]}  # options for promises that are no number


# ---- Histories


def history(random, bounds, kinds, table):
    """Draws a history between bounds. Returns its settings, or None if it is constant. A table is written to a file."""
    low, high = bounds
    kind = random.choice(kinds)
    first, second = random.uniform(low, high, 2)
    if kind == "none":
        return None
    if kind == "sine":
        amplitude = random.uniform(0.2, 1) * (high - low) / 2
        return {"law": kind, "mean": random.uniform(low + amplitude, high - amplitude), "amplitude": amplitude,
                "period": random.uniform(0.8, 3), "phase": random.uniform(0, 2 * np.pi)}
    if kind == "ramp":
        return {"law": kind, "from": first, "to": second, "start": random.uniform(0, 1),
                "duration": random.uniform(0.3, 1.5)}
    if kind == "step":
        return {"law": kind, "from": first, "to": second, "at": random.uniform(0.1, 1)}
    times = np.linspace(0, END, random.integers(4, 9))
    interpolation = random.choice(["linear", "spline"])
    middle, part = (low + high) / 2, 0.7 if interpolation == "spline" else 1  # splines overshoot
    factors = middle + part * (random.uniform(low, high, len(times)) - middle)
    results.write_csv(table, ["T", "factor"], zip(times, factors))
    return {"law": kind, "file": os.path.basename(table), "column": "factor", "interpolation": interpolation}


def flow(settings):
    return "{" + ", ".join(f"{key}: {value}" for key, value in settings.items()) + "}"


def draw(folder, seed, count, plan=""):
    """Draws scenes with random histories. Steps are fixed, so that both models have the same times."""
    with open("scene.yml") as source:
        scene = re.sub(r"^transient:.*(\n .*)*\n", "", source.read(), flags=re.M)
    random = np.random.default_rng(int(seed))
    kinds = ["sine", "ramp", "step", "none"] + ([] if plan else ["table"])
    os.makedirs(folder, exist_ok=True)
    text = "groups:\n"
    for i in range(int(count)):
        outside = not plan and i % 3 == 2
        varies = {}
        while not varies:
            for name, bounds in (("load", LOAD), ("speed", SPEED)):
                middle, half = sum(bounds) / 2, (bounds[1] - bounds[0]) / 2 * (BEYOND if outside else 1)
                drawn = history(random, (middle - half, middle + half), kinds, f"{folder}/{i}-{name}.csv")
                if drawn:
                    varies[name] = drawn
        lines = scene + "transient:\n" + "".join(f"  {line}\n" for line in (
            f"end_time: {END}", "fixed_step: 0.02", "smoothing: 0.014",
            *(f"{name}: {flow(settings)}" for name, settings in varies.items())))
        if plan:
            text += "  - scene:\n" + re.sub("^", " " * 6, lines, flags=re.M).rstrip() + \
                    f"\n    vary: {{transient.end_time: [{END}]}}\n"
        else:
            results.write_changed(f"{folder}/{i}.yml", f"# {'outside' if outside else 'inside'}\n{lines}")
    if plan:
        results.write_changed(f"{folder}/plan.yml", text)
    else:
        results.write_changed(f"{folder}/count", str(count))


# ---- Runs


def processor_seconds():
    """Returns the processor time of all programs that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def solved(program, scene, out, *options):
    """Runs a program. Returns its exit code, its processor time, and times with central and minimum film."""
    seconds = np.inf
    for _ in range(REPEAT):
        before = processor_seconds()
        code = results.run(program, scene, "-o", out, "--force", "--quiet", "--set", "output.fields=false", *options,
                           outcomes=range(-255, 256)).returncode
        seconds = min(seconds, processor_seconds() - before)
    if code not in (results.SOLVED, results.NOT_TRUSTED):
        return code, seconds, None
    return code, seconds, np.array(list(results.printed(out, "time", "central_film_thickness",
                                               "minimum_film_thickness").values()))


def run(folder, model, *promises):
    """Runs all scenes with all promises. The cost is the processor time over that of the full model."""
    with open(f"{folder}/count") as source:
        count = int(source.read())
    runs = []
    for i in range(count):
        scene = f"{folder}/{i}.yml"
        with open(scene) as source:
            lines = source.read()
        where = lines.split()[1]
        laws = [(re.search(rf"^  {name}: {{law: (\w+)", lines, re.M) or [0, "none"])[1] for name in ("load", "speed")]
        code, seconds, full = solved("fullrun", scene, f"{folder}/full.h5", "--grid-of", model)
        if full is None or code:
            runs.append([i, where, "", "", 0, "", "", *laws, ""])
            continue
        for promise in promises:
            asked = OPTIONS.get(promise, ["--accuracy", promise])
            code, spent, reduced = solved("romrun", scene, f"{folder}/reduced.h5", "--model", model, *asked)
            off, common, cost = ["", ""], 0, ""
            if reduced is not None:
                cost = spent / seconds
                times, of_full, of_reduced = np.intersect1d(np.round(full[0], 9), np.round(reduced[0], 9),
                                                            return_indices=True)
                common = len(times) / len(full[0])
                off = [np.abs(reduced[q][of_reduced] / full[q][of_full] - 1).max() for q in (1, 2)]
            runs.append([i, where, promise, code, common, *off, *laws, cost])
    results.write_csv(f"{folder}/runs.csv", RUN, runs)


# ---- Table


def outcome(run):
    """Returns the outcome of a run, and the larger error of its films."""
    if not run["promise"]:
        return "no reference", 0
    code = int(run["code"])
    if code == results.NOT_CONVERGED:
        return "not solved", 0
    if code not in (results.SOLVED, results.NOT_TRUSTED):
        return "error", 0
    off = max(float(run["central"]), float(run["minimum"]))
    promise = 0.01 if run["promise"] in OPTIONS else float(run["promise"])
    flagged = "flagged" if code == results.NOT_TRUSTED else "not flagged"
    return f"{'good' if off <= promise else 'bad'} {flagged}", off


def table(file, seed):
    """Prints the numbers of flagged and of other runs."""
    listed = results.read_csv(file)
    runs = [(run["promise"], run["where"], *outcome(run)) for run in listed]
    print(f"seed {seed}\n")
    layout = "{:24} {:>8} {:>8} {:>12} {:>16} {:>8} {:>10}"
    print(layout.format("", "good,", "good,", "of the good", "bad, not", "bad,", "not"))
    print(layout.format("", "quiet", "flagged", "flagged", "flagged: silent", "flagged", "solved"))
    for promise in dict.fromkeys(run[0] for run in runs if run[0]):
        print({"none": "no promise asked for", "fallback": "--fallback full"}.get(promise) or f"promise {float(promise):g}")
        for where in ("inside", "outside"):
            mine = [run[2] for run in runs if run[0] == promise and run[1] == where]
            quiet, loud, *others = (mine.count(what) for what in (
                "good not flagged", "good flagged", "bad not flagged", "bad flagged", "not solved"))
            print(layout.format(f"  {where}", quiet, loud, f"{100 * loud / max(quiet + loud, 1):.1f} %", *others))
        costs = [float(run["cost"]) for run in listed if run["promise"] == promise and run["cost"]]
        if costs:
            print(f"  processor time over the full model's: median {np.median(costs):.2f}, largest {max(costs):.2f}")
    silent = [off for *_, what, off in runs if what == "bad not flagged"]
    errors = sum(what == "error" for *_, what, _ in runs)
    print(f"\nthe full model did not end: {sum(what == 'no reference' for *_, what, _ in runs)}")
    print(f"silent failures: {len(silent)}" + (f", the worst {max(silent):.2g} off" if silent else ""))
    if errors:
        print(f"found {errors} runs that ended otherwise, expected none")
        sys.exit(1)


if __name__ == "__main__":
    results.commands(draw, run, table)
