# SPDX-License-Identifier: GPL-3.0-or-later
"""Deviation against time of all that a user could do, on the scenes that a model was calibrated on:

    trade.py measure OUT REGIME [OPTION...]    leaves OUT/trade.csv; of stationary scenes also OUT/polish.csv, .txt
    trade.py draw OUT REGIME WIDTH             draws OUT/trade.png, .svg

A way is a tuple, which also names the file of OUT/trade that its films are kept in:

    (cold | neighbour | reduced, STRETCH, TOLERANCE)      full model with STRETCH times the scene's step, started cold, from
                                                          the scene before, or from the reduced model's solution
    (full, STRETCH, STEPS)                                in time; STEPS is a tolerance, fixedLENGTH, or stillN: everything
                                                          10^4 times as slowly in N steps, so that the contact is stationary
                                                          at each time (not where a history is a table)
    (reduced, MODES, DEFORMATION_MODES, ROWS, STEPS)      in time; deformation modes 0: coupled basis

Films are kept, not deviations: any way could be the reference that the others are compared with.
"""
import argparse
import csv
import glob
import os
import re
import tempfile

import numpy as np

import pictures
import results
from pictures import BLUE, GREEN, ORANGE, PINK, RED, SKY

HEADER = "alternative,position,quantity,scenes,failures,worst,deviation_95,median,seconds".split(",")
FINEST = "1e-10"  # Newton's tolerance where no other is asked for
SLOWER = 1e4      # how much more slowly everything goes where each time is taken as stationary

# ---- Scenes


def calibrated_scenes(model, regime):
    """Scenes of a regime that a model was calibrated on, as mappings of settings, without those that ways choose. The text
    names the settings of the first scene, then what changes from one to the next (schemas/plan.md)."""
    text = results.printed(model, "settings")["settings"][0].partition("# calibrated on")[2]
    scenes, scene = [], {}
    for point in text.split("# point")[1:]:
        for line in point.splitlines()[1:]:
            if line and not line.startswith("#"):
                key, _, value = line.partition(":")
                scene = {**scene, key: value.strip()}
        scenes.append({key: value for key, value in scene.items() if value and key != "transient.fixed_step"})
    scenes = [scene for scene in scenes if scene["regime"] == regime]
    kept = int(results.value(model, "calibration_scenes" if regime == "stationary" else "calibration_trajectories", 0))
    if len(scenes) != kept or not scenes:
        results.stop(f"check-plan.yml: found {len(scenes)} {regime} scenes, expected the {kept} that the calibration kept,"
                     " inside of the trained range (TRADE_REGIME)")
    return scenes


def write_scenes(folder, scenes):
    """Files FOLDER/scene-001.yml, ... and no others of that kind; returns their names."""
    for old in glob.glob(f"{folder}/scene-*.yml"):
        os.remove(old)
    files = [f"{folder}/scene-{i + 1:03}.yml" for i in range(len(scenes))]
    for file, scene in zip(files, scenes):
        with open(file, "w") as target:
            target.writelines(f"{key}: {value}\n" for key, value in scene.items())
    return files


def model_sizes(model):
    """Sizes that a model was calibrated with: pressure modes, deformation modes, rows."""
    names = ["position_pressure_modes", "position_deformation_modes", "position_rows"]
    return [tuple(int(x) for x in size) for size in zip(*results.printed(model, *names).values())]


# ---- Measurements: a record a scene


def stationary_films(way, scenes, files, model, repeat, work):
    """Solves stationary scenes; the record of one has its film and time, formulas, and what the grid does to the film."""
    start, stretch, tolerance = way
    records, before = [], None
    for i, (scene, file) in enumerate(zip(scenes, files)):
        record, common = {}, ["--repeat", repeat, "--force", "--quiet"]
        if start == "reduced":
            before = f"{work}/reduced.h5"
            done = results.run("romrun", file, "--model", model, "-o", before, "--set", "output.fields=true", *common)
            record["start"] = solution(before)
            before = None if done.returncode == results.NOT_CONVERGED else before
        result = f"{work}/{i % 2}.h5"
        done = results.run("fullrun", file, "-o", result, "--tolerance", tolerance, "--formulas", *common,
                           *results.sets({"grid.step": f"{stretch * float(scene['grid.step']):.12g}"}),
                           *(["--start", before] if before else []))
        record.update(solution(result))
        solved = done.returncode == results.SOLVED
        if solved:
            words = [line.split() for line in done.stdout.splitlines() if line.startswith("formula ")]
            record["formulas"] = [(word[1], word[2], float(word[3]), 1e-9 * float(word[6])) for word in words]
            record["effects"] = {name: results.value(result, f"{name}_effect") for name in ("step", "inlet")}
        before = result if solved and start == "neighbour" else None
        records.append(record)
    return records


def solution(file):
    """Numbers of a stationary result."""
    numbers = results.printed(file, "status", "newton_iterations", "solve_seconds", "central_film_thickness",
                              "minimum_film_thickness")
    return dict(zip(("status", "iterations", "seconds", "central", "minimum"), (float(x[0]) for x in numbers.values())))


def transient_films(way, scenes, files, model, _repeat, work):
    """Runs trajectories; the record of one has its exit code, times and films, seconds, and the deviations of formulas."""
    kind, steps = way[0], way[-1]
    records = []
    for scene, file in zip(scenes, files):
        settings, slower = {"output.fields": "false"}, 1.0
        if steps.startswith("still"):
            slower = SLOWER
            settings.update((key, repr(slower * float(value))) for key, value in scene.items()
                            if key.startswith("transient.")
                            and key.split(".")[-1] in ("period", "start", "duration", "at", "end_time"))
            settings["transient.fixed_step"] = repr(float(settings["transient.end_time"]) / int(steps[len("still"):]))
        elif steps.startswith("fixed"):
            settings["transient.fixed_step"] = steps[len("fixed"):]
        else:
            settings["transient.tolerance"] = steps
        if kind == "full":
            settings["grid.step"] = f"{way[1] * float(scene['grid.step']):.12g}"
            program, options = "fullrun", ["--formulas"]
        else:
            program, options = "romrun", ["--model", model, "--pressure-modes", way[1], "--rows", way[3]]
            options += ["--deformation-modes", way[2]] if way[2] else []
        run = results.trajectory(f"{work}/run.h5", program, file, *options, *results.sets(settings))
        records.append({"code": run.code, "seconds": run.seconds, "time": list(run.time / slower), "central": list(run.H_c),
                        "formulas": [(word[0], word[1], *(float(word[i]) / 100 for i in (3, 7, 10)),
                                      1e-9 * float(word[12]) * len(run.time)) for word in run.formulas]})
    return records


def measured(folder, way, films, newer_than):
    """Records of a way: those that lie in the folder, where they are newer than these files, else of films(way, work)."""
    name = "-".join(f"{part:g}" if isinstance(part, float) else str(part) for part in way)

    def measure_now():
        print(f"  measure    {name}", flush=True)
        with tempfile.TemporaryDirectory(dir=folder) as work:
            return films(way, work)
    return results.kept(f"{folder}/{name}.json", measure_now, *newer_than)


# ---- Tables


def quantiles(values, weights):
    """The largest value, and what it does not exceed for 95 % and for half of the weight (nearest rank)."""
    if not len(values):
        return [np.nan] * 3
    order = np.argsort(values)
    total = np.cumsum(np.asarray(weights, dtype=float)[order])
    return [np.asarray(values)[order[np.searchsorted(total, part * total[-1])]] for part in (1, 0.95, 0.5)]


def over_scenes(values):
    return quantiles(values, np.ones(len(values)))


def line(name, count, failures, deviations, seconds=np.nan):
    """A line of trade.csv; name: alternative, position, quantity. What the grid itself does has no time."""
    return [*name, count, failures, *(f"{x:.4g}" for x in deviations), "" if np.isnan(seconds) else f"{seconds:.4g}"]


def stationary_lines(ways, reference):
    """Lines of the full model in all ways, and of formulas, compared with one of the ways. Deviations are over scenes, of
    the smallest film where a formula is for that, else of the central one; seconds are the scenes' median."""
    known = {i: record for i, record in enumerate(ways[reference]) if record["status"] != 1}
    formulas, effects = {}, {}
    for record in known.values():
        for name, quantity, film, seconds in record.get("formulas", []):
            formulas.setdefault((name, quantity), []).append((abs(film / record[quantity] - 1), seconds))
        for name, effect in record.get("effects", {}).items():
            if not np.isnan(effect):  # of the inlet it is known of a line contact
                effects.setdefault(name, []).append(abs(effect))
    for (name, quantity), pairs in formulas.items():
        off, seconds = zip(*pairs)
        yield line(("formula", name, quantity), len(off), 0, over_scenes(off), over_scenes(seconds)[2])
    for (start, stretch, tolerance), records in ways.items():
        solved = {i: record for i, record in enumerate(records) if record["status"] != 1}
        off = [abs(record["central"] / known[i]["central"] - 1) for i, record in solved.items() if i in known]
        # a start from the reduced model costs its solution too
        seconds = [record["seconds"] + record.get("start", {}).get("seconds", 0) for record in solved.values()]
        failures = len(records) - len(solved)
        yield line(("full cold" if start == "cold" else f"full from {start}", f"step {stretch:.3g} times tolerance {tolerance}",
                    "central"), len(off) + failures, failures, over_scenes(off), over_scenes(seconds)[2])
    for name, values in effects.items():
        yield line(("reference", name, "central"), len(values), 0, over_scenes(values))


def calibration_lines(model):
    """Lines of the sizes of a model, as its calibration found them against the full model on the same scenes."""
    failures, seconds = results.printed(model, "position_failures", "position_seconds").values()
    off = results.printed(model, "deviation_central_film_thickness")["deviation_central_film_thickness"].reshape(-1, 3)
    scenes = int(results.value(model, "calibration_scenes"))
    for i, (modes, more, rows) in enumerate(model_sizes(model)):
        yield line(("reduced", size_name(modes, more, rows), "central"), scenes, int(failures[i]), off[i, ::-1], seconds[i])


def size_name(modes, more, rows):
    return f"{modes} modes {f'and {more} ' if more else ''}{rows} rows"


def transient_lines(ways, reference, coarse):
    """Lines of all ways in time and of formulas, compared with one of the ways. Deviations are the largest of all
    trajectories, seconds those of a whole trajectory, their mean. What the reference's grid does itself is a third of what
    twice its step does (coarse), as of second order."""
    for kind in ("reduced", "full"):
        if kind == "full":
            yield from transient_formulas(ways[reference])
        for way, records in ways.items():
            if way[0] == kind:
                yield compared(way_name(way), records, ways[reference])
    row = compared(("reference", "step", "central"), ways[coarse], ways[reference], 1 / 3)
    yield row[:3] + [row[3] - row[4], 0] + row[5:8] + [""]


def compared(name, records, references, part=1.0):
    """The line of a way in time: its deviations from the reference, or a part of them."""
    off, seconds = [], []
    for record, reference in zip(records, references):
        if record["code"] == results.SOLVED:
            films = results.at_times(np.array(reference["time"]), np.array(reference["central"]), record["time"])
            steps = np.diff(record["time"])
            weights = (np.append(steps, 0) + np.insert(steps, 0, 0)) / 2
            known = ~np.isnan(films)
            off.append(quantiles(abs(np.array(record["central"]) / films - 1)[known], weights[known]))
            seconds.append(record["seconds"])
    return line(name, len(records), len(records) - len(off), part * np.max(off or [[np.nan] * 3], axis=0),
                np.mean(seconds) if seconds else np.nan)


def transient_formulas(records):
    formulas = {}
    for record in records:
        for name, quantity, *numbers in record["formulas"]:
            formulas.setdefault((name, quantity), []).append(numbers)
    for name, numbers in formulas.items():
        yield line(("formula", *name), len(numbers), 0, np.max(numbers, axis=0)[:3], np.mean(numbers, axis=0)[3])


def way_name(way):
    """Alternative, position, quantity of a way in time."""
    steps = way[-1]
    for start, text in (("fixed", "fixed steps {}"), ("still", "stationary at {} times"), ("", "tolerance {}")):
        if steps.startswith(start):
            steps = text.format(steps[len(start):])
            break
    position = f"step {way[1]:.3g} times" if way[0] == "full" else size_name(*way[1:4])
    return way[0], f"{position} {steps}", "central"


def polish(cold, started, out):
    """Cold starts of the full model against starts from the reduced solution: polish.csv a scene, polish.txt together."""
    kinds = {"cold": cold, "reduced": [record["start"] for record in started], "polish": started}
    all_solved = [i for i in range(len(cold)) if all(kinds[kind][i]["status"] != 1 for kind in kinds)]
    if not all_solved:
        results.stop("polish: found no scene that all three solved, expected some")
    iterations, seconds, films = ({kind: np.array([records[i][name] for i in all_solved]) for kind, records in kinds.items()}
                                  for name in ("iterations", "seconds", "central"))
    off, difference = (abs(films[kind] / films["cold"] - 1) for kind in ("reduced", "polish"))
    header = [f"{kind}_{what}" for kind in kinds for what in ("iterations", "seconds")]
    results.write_csv(f"{out}/polish.csv", ["scene", *header, "reduced_deviation", "polish_difference"], [
        [f"scene-{scene + 1:03}", *(text for kind in kinds for text in (f"{iterations[kind][i]:.0f}", f"{seconds[kind][i]:.4g}")),
         f"{off[i]:.2e}", f"{difference[i]:.2e}"] for i, scene in enumerate(all_solved)])

    lost = len(cold) - len(all_solved)
    together = seconds["reduced"] + seconds["polish"]
    labels = {"cold": "cold start", "reduced": "reduced solution", "polish": "full model from it"}
    with open(f"{out}/polish.txt", "w") as target:
        target.writelines(text + "\n" for text in [
            f"full model, {len(all_solved)} scenes{f' ({lost} more not solved by all)' if lost else ''}: "
            "cold start against start from the reduced solution",
            f"{'':28} {'iterations: mean, most':>22} {'mean time':>12}",
            *(f"{labels[kind]:28} {np.mean(iterations[kind]):15.1f} {np.max(iterations[kind]):6.0f} "
              f"{1000 * np.mean(seconds[kind]):9.2f} ms" for kind in kinds),
            f"time saved: {100 * (1 - np.sum(together) / np.sum(seconds['cold'])):.0f} %; slower than a cold start: "
            f"{np.sum(together > seconds['cold'])} scenes; H_c moves by at most {np.max(off):.1e} and ends at most "
            f"{np.max(difference):.1e} from the cold start's"])


# ---- The two commands


def measure(out, regime, stretches, tolerances, steps, repeat):
    """Measures all ways on all scenes, and writes the tables."""
    folder, model = f"{out}/trade", f"{out}/calibrated.h5"
    os.makedirs(folder, exist_ok=True)
    scenes = calibrated_scenes(model, regime)
    files = write_scenes(folder, scenes)
    stationary = regime == "stationary"
    if stationary:
        ways = [(start, *rest) for start in ("cold", "neighbour")
                for rest in [(1, FINEST), *((x, FINEST) for x in stretches), *((1, x) for x in tolerances)]]
        ways += [("neighbour", stretch, "1e-2") for stretch in stretches[:2]] + [("reduced", 1, FINEST)]
    else:
        sizes = model_sizes(model)
        ways = [("full", 1, x) for x in steps] + [("full", 2, steps[0])]
        ways += [("full", stretch, x) for stretch in stretches for x in steps[1:3]]
        # every size with the default steps, the whole model with all
        ways += [("reduced", *size, steps[1]) for size in sizes] + [("reduced", *sizes[-1], x) for x in steps if x != steps[1]]

    films = stationary_films if stationary else transient_films
    newer_than = [model, *(os.path.join(os.environ["BIN"], program) for program in ("fullrun", "romrun"))]
    found = {way: measured(folder, way, lambda way, work: films(way, scenes, files, model, repeat, work), newer_than)
             for way in ways}
    if stationary:
        lines = [*calibration_lines(model), *stationary_lines(found, ways[0])]
        polish(found[ways[0]], found[ways[-1]], out)
    else:
        lines = transient_lines(found, ways[0], ("full", 2, steps[0]))
    results.write_csv(f"{out}/trade.csv", HEADER, lines)


# Of the picture: label, mark (hollow in brackets), colour, and which lines of trade.csv: the first pattern that matches
# alternative and position, behind "failing" where some scenes have no result.
SERIES = {
    "stationary": [
        ("film formulas", "o", "black", "formula"),
        ("reduced model, sizes", "o", BLUE, "reduced"),
        ("the same, failing on some scenes", "x", SKY, "failing reduced"),
        ("full model from a neighbour, grids", "^", GREEN, f"full from neighbour .* {FINEST}"),
        ("the same, looser tolerances", "(^)", GREEN, "full from neighbour"),
        ("full model, cold start, grids", "s", RED, f"full cold .* {FINEST}"),
        ("the same, looser tolerances", "(s)", RED, "full cold"),
        ("full model, failing on some scenes", "x", ORANGE, "failing full"),
        ("full model from the reduced solution", "D", PINK, "full from reduced")],
    "transient": [
        ("film formulas at each time", "o", "black", "formula"),
        ("reduced model, sizes and tolerances", "o", BLUE, "reduced .* tolerance"),
        ("reduced model, fixed steps", "(o)", BLUE, "reduced .* fixed"),
        ("either model, some trajectory lost", "x", SKY, "failing"),
        ("full model, tolerances", "s", RED, "full step 1 times tolerance"),
        ("full model, fixed steps", "(s)", RED, "full step 1 times fixed"),
        ("full model, coarser grids", "^", GREEN, "full step .* times (tolerance|fixed)"),
        ("either model, stationary at each time", "D", PINK, ".* stationary")],
}


def draw(out, regime, width):
    """The picture of trade.csv."""
    with open(f"{out}/trade.csv", newline="") as source:
        lines = [{**row, **{key: float(row[key] or "nan") for key in HEADER[3:]}} for row in csv.DictReader(source)]
    figure, axes = pictures.page(width, 0.8 * width)
    panel(axes, lines, regime)
    pictures.save(figure, f"{out}/trade.png")


def panel(axes, lines, regime):
    """Deviation of the central film against time, from the worst scene (mark) down to the median (end of the bar)."""
    lowest = 1e-9 if regime == "stationary" else 1e-5  # where the reference is drawn, and what deviates even less
    shown = {label_and_mark: [] for label_and_mark in SERIES[regime]}
    for entry in lines:
        name = "failing " * (entry["failures"] > 0) + f"{entry['alternative']} {entry['position']}"
        which = next((series for series in SERIES[regime] if re.match(series[3], name)), None)
        if which and entry["seconds"] > 0 and not np.isnan(entry["worst"]):
            shown[which].append([entry["seconds"], *(max(entry[key], lowest) for key in ("worst", "median"))])
    for (label, mark, colour, _), points in shown.items():
        seconds, worst, median = np.array(points).reshape(-1, 3).T
        if mark != "x":
            axes.vlines(seconds, median, worst, color=colour, linewidth=1.6)
        axes.plot(seconds, worst, mark.strip("()"), color=colour, markersize=4 if mark == "x" else 6, label=label,
                  markerfacecolor="none" if "(" in mark else colour, markeredgewidth=1.3)
    for entry in lines:
        if entry["alternative"] == "reference" and entry["position"] == "step":
            for key, style, side in (("worst", "--", "bottom"), ("median", ":", "top")):
                axes.axhline(entry[key], linestyle=style, color="#666666")
                axes.annotate(f"the grid itself, {key} ", (1, entry[key]), xycoords=("axes fraction", "data"), ha="right",
                              va=side, color="#444444")
    axes.annotate(" none (or less): the reference", (0, lowest), xycoords=("axes fraction", "data"), va="bottom",
                  color="#444444")
    formulas = sorted((entry for entry in lines if entry["alternative"] == "formula"), key=lambda entry: -entry["worst"])
    axes.text(0.012, 0.4, "film formulas, worst:\n" + "\n".join(
        re.sub("-central|-minimum", "", entry["position"]) + f" {100 * entry['worst']:.0f} %"
        + ", minimum" * (entry["quantity"] == "minimum") for entry in formulas), transform=axes.transAxes, va="top", fontsize=9)
    axes.set(xscale="log", yscale="log", ylim=(lowest / 2, 2), xlim=(1e-8, 1) if regime == "stationary" else (1e-5, 200),
             xlabel="time of a solution / s" if regime == "stationary" else "time of a trajectory / s",
             ylabel="deviation of $H_c$: worst (mark), median (end of the bar)")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncol=2, frameon=False)


def main():
    parser = argparse.ArgumentParser(prog="trade.py")
    parser.add_argument("command", choices=["measure", "draw"])
    parser.add_argument("out")
    parser.add_argument("regime", choices=list(SERIES))
    parser.add_argument("--stretches", nargs="*", type=float, default=[])
    parser.add_argument("--tolerances", nargs="*", default=[])
    parser.add_argument("--steps", nargs="*", default=[])
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--width", type=float, default=1000)
    given = parser.parse_args()
    if given.command == "draw":
        draw(given.out, given.regime, given.width)
    else:
        measure(given.out, given.regime, given.stretches, given.tolerances, given.steps, given.repeat)


main()
