# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures error and time of all alternatives, on the scenes on which a model was calibrated:

    trade.py measure OUT REGIME STRETCHES TOLERANCES STEPS TRUTH REPEAT    writes OUT/trade.csv, for stationary scenes
                                                                           also polish.csv and polish.txt; trade.mk
                                                                           describes the lists
    trade.py draw OUT REGIME WIDTH                                         draws OUT/trade.png, .svg

A *way* is a method of solution with its settings. It is a tuple, which also gives the name of the file in OUT/trade
with its films:

    (cold | neighbour | reduced, STRETCH, TOLERANCE)     full model with STRETCH times the scene's step, started cold,
                                                         from the scene before, or from the reduced model's solution
    (published,)                                         full model with the published discretisation and the grid of
                                                         scene.yml, if scene.yml has this discretisation
    (truth, LONGER, STRETCH)                             full model; factors on inlet length and step of the scene
    (model, MODES, DEFORMATION_MODES, ROWS)              reduced model of this size; deformation modes 0: coupled basis
    (full, STRETCH, STEPS)                               transient; STEPS is a tolerance, fixedLENGTH, or stillN: the
                                                         histories are 10^4 times as slow, in N steps, so that the
                                                         contact is stationary at each time (no tables as histories)
    (published, STEPS)                                   transient, full model, published discretisation, scene's grid
    (reduced, MODES, DEFORMATION_MODES, ROWS, STEPS)     transient
    (truth, STRETCH, fixedLENGTH)                        transient, full model, transport along the path, no smoothing

The files contain films, not deviations, so that any way can be the reference. There are two references: the full model
on the scene's grid, and the converged solution (`truth`). For stationary scenes the converged solution is extrapolated
from two finer steps, and multiplied by the effect of a longer inlet on the film with the scene's step. For transient
scenes it is the solution with a finer grid and shorter time steps, with the same inlet.
"""
import glob
import os
import re
import tempfile

import numpy as np

import pictures
import results
from pictures import BLUE, GREEN, ORANGE, PINK, RED, SKY

HEADER = ("alternative,position,quantity,scenes,failures,worst,deviation_95,median,seconds,"
          "true_worst,true_95,true_median").split(",")
FINEST = "1e-10"  # default of the Newton tolerance here
SLOWER = 1e4      # factor by which histories are slower if each time is taken as stationary
PUBLISHED = "1e-4"  # default tolerance of time steps with the published discretisation

# ---- Scenes


def calibrated_scenes(model, regime):
    """Returns the scenes of a regime on which a model was calibrated, as mappings of settings. Settings that a way
    chooses are left out."""
    scenes = [{key: value for key, value in scene.items() if key != "transient.fixed_step"}
              for scene in results.planned_scenes(model)]
    scenes = [scene for scene in scenes if scene["regime"] == regime]
    kept = "calibration_scenes" if regime == "stationary" else "calibration_trajectories"
    expected = int(results.value(model, kept, 0))
    if len(scenes) != expected or not scenes:
        results.stop(f"check-plan.yml: found {len(scenes)} {regime} scenes, expected the {expected} that the "
                     "calibration kept, inside of the trained range (TRADE_REGIME)")
    return scenes


def write_scenes(folder, scenes):
    """Writes FOLDER/scene-001.yml, ... and deletes other files with such names. Returns the names."""
    for old in glob.glob(f"{folder}/scene-*.yml"):
        os.remove(old)
    files = [f"{folder}/scene-{i + 1:03}.yml" for i in range(len(scenes))]
    for file, scene in zip(files, scenes):
        results.write_changed(file, "".join(f"{key}: {value}\n" for key, value in scene.items()))
    return files


def calibrated_sizes(model):
    """Returns the model sizes that the calibration measured: pressure modes, deformation modes, rows."""
    names = ["position_pressure_modes", "position_deformation_modes", "position_rows"]
    return [tuple(map(int, size)) for size in zip(*results.printed(model, *names).values())]


# ---- Measurements: one record for each scene


def stretched(scene, stretch, longer=1):
    """Returns the settings of a grid with a multiple of the step, on a domain that is larger by the factor `longer`.
    It also grows downstream, because the exit line of a point contact lies farther back far from its middle."""
    times = {"grid.step": stretch, "grid.x_min": longer, "grid.x_max": longer, "grid.y_max": longer}
    return {key: f"{factor * float(scene[key]):.12g}" for key, factor in times.items() if key in scene and factor != 1}


def stationary_films(way, scenes, files, model, repeat, work):
    """Solves stationary scenes. A record has films and time of a scene, film formulas, and errors of the grid."""
    start, stretch, tolerance = way
    common = ["--repeat", repeat, "--force", "--quiet"]
    records, before = [], None
    for i, (scene, file) in enumerate(zip(scenes, files)):
        record = {}
        if start == "reduced":
            guess = f"{work}/reduced.h5"
            done = results.run("romrun", file, "--model", model, "-o", guess, "--set", "output.fields=true", *common)
            record["start"] = results.solution(guess)
            before = None if done.returncode == results.NOT_CONVERGED else guess
        result = f"{work}/{i % 2}.h5"  # another file than that of the start
        done = results.run("fullrun", file, "-o", result, "--allow-untrusted", "--tolerance", tolerance, "--formulas", *common,
                           *results.sets(stretched(scene, stretch)), *(["--start", before] if before else []))
        record.update(results.solution(result))
        solved = done.returncode == results.SOLVED
        if solved:
            words = [line.split() for line in done.stdout.splitlines() if line.startswith("formula ")]
            record["formulas"] = [(word[1], word[2], float(word[3]), 1e-9 * float(word[6])) for word in words]
            if start == "cold":  # cold starts can be the reference
                record["effects"] = {name: results.value(result, f"{name}_effect") for name in ("step", "inlet")}
        before = result if solved and start == "neighbour" else None
        records.append(record)
    return records


def published_films(scenes, repeat, work):
    """Solves stationary scenes with the discretisation and grid of scene.yml."""
    records = []
    for scene in scenes:
        own = {key: value for key, value in scene.items() if not key.startswith(("discretization", "grid."))}
        results.run("fullrun", "scene.yml", "-o", f"{work}/published.h5", "--force", "--quiet", "--repeat", repeat,
                    *results.sets(own))
        records.append(results.solution(f"{work}/published.h5"))
    return records


def truth_films(way, scenes, files, work):
    """Solves stationary scenes on a finer or wider grid."""
    records = []
    for scene, file in zip(scenes, files):
        results.run("fullrun", file, "-o", f"{work}/truth.h5", "--force", "--quiet", *results.sets({
            **stretched(scene, way[2], way[1]), "output.fields": "false", "output.resolution": "false"}))
        records.append(results.solution(f"{work}/truth.h5"))
    return records


def model_films(way, files, model):
    """Solves stationary scenes with a size of the reduced model. A record has the central film, or is empty."""
    modes, more, rows = way[1:]
    size = ["--pressure-modes", modes, "--rows", rows, *(["--deformation-modes", more] if more else [])]
    records = []
    for file in files:
        _, film = results.reduced_film(file, model, *size)
        records.append({} if film is None else {"H_c": film})
    return records


def truths(own, wide, coarse, fine, ratio):
    """Returns the converged films of each scene, from its films on four grids; empty if a grid has no solution. The
    films with the coarse and the fine step are extrapolated with second order; `ratio` is the ratio of both steps."""
    return [{film: (d[film] + (d[film] - c[film]) / (ratio**2 - 1)) * b[film] / a[film] for film in ("H_c", "H_min")}
            if {a["status"], b["status"], c["status"], d["status"]} == {0} else {}
            for a, b, c, d in zip(own, wide, coarse, fine)]


def transient_films(way, scenes, files, model, repeat, work):
    """Runs trajectories; those of the reduced model are repeated. A record has the exit code, times and films of a
    trajectory, the seconds of the fastest run, and the deviations of film formulas."""
    steps = way[-1]
    records = []
    for scene, file in zip(scenes, files):
        settings, slower = {"output.fields": "false"}, 1.0
        if steps.startswith("still"):
            slower = SLOWER
            settings.update((key, slower * float(value)) for key, value in scene.items()
                            if re.fullmatch(r"transient\.(.*\.)?(period|start|duration|at|end_time)", key))
            settings["transient.fixed_step"] = settings["transient.end_time"] / int(steps[len("still"):])
            settings["transport"] = "upwind"  # in such a long time step the fluid would move by hundreds of half widths
        elif steps.startswith("fixed"):
            settings["transient.fixed_step"] = steps[len("fixed"):]
        else:
            settings["transient.tolerance"] = steps
        if way[0] != "reduced":
            if way[0] == "published":
                settings.update({"discretization": "published", "transport": "upwind"})
            else:
                settings.update(stretched(scene, way[1]))
            if way[0] == "truth":
                settings.update({"discretization": "accurate", "transport": "path", "transient.smoothing": 0})
            program, options = "fullrun", ["--formulas"]
        else:
            program, options = "romrun", ["--model", model, "--pressure-modes", way[1], "--rows", way[3]]
            options += ["--deformation-modes", way[2]] if way[2] else []
        runs = [results.trajectory(f"{work}/run.h5", program, file, *options, *results.sets(settings))
                for _ in range(int(repeat) if program == "romrun" else 1)]
        run = runs[0]
        formulas = [(word[0], word[1], *(float(word[i]) / 100 for i in (3, 7, 10)),
                     1e-9 * float(word[12]) * len(run.time)) for word in run.formulas]
        records.append({"code": run.code, "seconds": min(other.seconds for other in runs), "time": list(run.time / slower), "H_c": list(run.H_c),
                        "formulas": formulas})
    return records


def measured(folder, way, films, newer_than):
    """Returns the records of a way: from its file in the folder, if it is newer than the files `newer_than`, otherwise
    from films(way, work)."""
    name = "-".join(f"{part:g}" if isinstance(part, float) else str(part) for part in way)

    def measure_now():
        print(f"  measure    {name}", flush=True)
        with tempfile.TemporaryDirectory(dir=folder) as work:
            return films(way, work)
    return results.kept(f"{folder}/{name}.json", measure_now, *newer_than)


# ---- Tables


def quantiles(values, weights=None):
    """Returns the largest value, the 95 % quantile and the median of weighted values (nearest rank)."""
    if not len(values):
        return np.full(3, np.nan)
    order = np.argsort(values)
    total = np.cumsum(np.ones(len(values)) if weights is None else weights[order])
    return np.array(values)[[order[np.searchsorted(total, part * total[-1])] for part in (1, 0.95, 0.5)]]


def row(name, count, failures, deviations, seconds=np.nan, true=3 * [np.nan]):
    """Returns a row of trade.csv; name: alternative, position, quantity. Rows for errors of the grid have no time."""
    return [*name, count, failures, *("" if np.isnan(x) else f"{x:.4g}" for x in (*deviations, seconds, *true))]


def distances(films, truth, film="H_c"):
    """Returns the quantiles of the errors of films (scene: value) against the converged solution."""
    return quantiles([abs(value / truth[i][film] - 1) for i, value in films.items() if truth[i]])


def stationary_rows(ways, reference, truth):
    """Yields rows for all ways of the full model and for film formulas, compared with one way and with the converged
    solution. Deviations are quantiles over the scenes: of the smallest film for formulas of this film, otherwise of the
    central film. Seconds are the median over the scenes."""
    known = {i: record for i, record in enumerate(ways[reference]) if record["status"] != 1}
    formulas, effects = {}, {}
    for i, record in known.items():
        for name, quantity, film, seconds in record.get("formulas", []):
            off = abs(film / record["H_min" if quantity == "minimum" else "H_c"] - 1)
            formulas.setdefault((name, quantity), []).append((off, seconds, i, film))
        for name, effect in record.get("effects", {}).items():
            if not np.isnan(effect):  # NaN if twice the step has no solution
                effects.setdefault(name, []).append(abs(effect))
    for name, found in formulas.items():
        off, seconds, scenes, films = zip(*found)
        yield row(("formula", *name), len(off), 0, quantiles(off), quantiles(seconds)[2],
                  distances(dict(zip(scenes, films)), truth, "H_min" if name[1] == "minimum" else "H_c"))
    for way, records in ways.items():
        solved = {i: record for i, record in enumerate(records) if record["status"] != 1}
        off = [abs(record["H_c"] / known[i]["H_c"] - 1) for i, record in solved.items() if i in known]
        # if the start is a reduced solution, its time is added
        seconds = [record["seconds"] + record.get("start", {}).get("seconds", 0) for record in solved.values()]
        failures = len(records) - len(solved)
        name = f"full {way[0]}" if way[0] in ("cold", "published") else f"full from {way[0]}"
        position = "step {:.3g} times tolerance {}".format(*way[1:]) if way[1:] else "as the scene says"
        yield row((name, position, "central"), len(off) + failures, failures, quantiles(off), quantiles(seconds)[2],
                  distances({i: record["H_c"] for i, record in solved.items()}, truth))
    for name, values in effects.items():
        yield row(("reference", name, "central"), len(values), 0, quantiles(values))


def size_name(modes, more, rows):
    return f"{modes} modes {f'and {more} ' if more else ''}{rows} rows"


def calibration_rows(model, films, truth):
    """Yields rows for the sizes of a model: the deviations from the full model that the calibration found on the same
    scenes, and the errors of the films against the converged solution. `films` has records of sizes that solve all
    scenes."""
    failures, seconds = results.printed(model, "position_failures", "position_seconds").values()
    off = results.printed(model, "deviation_central_film_thickness")["deviation_central_film_thickness"].reshape(-1, 3)
    scenes = int(results.value(model, "calibration_scenes"))
    for i, size in enumerate(calibrated_sizes(model)):
        solved = {k: record["H_c"] for k, record in enumerate(films.get(size, [])) if record}
        yield row(("reduced", size_name(*size), "central"), scenes, int(failures[i]), off[i, ::-1], seconds[i],
                  distances(solved, truth))


def transient_rows(ways, reference, truth):
    """Yields rows for all transient ways and for film formulas, compared with one way and with the converged solution.
    Deviations are the largest of all trajectories. Seconds are for a whole trajectory, as the mean of all trajectories.
    Formulas are compared at each time."""
    formulas = {way: {} for way in (reference, truth)}
    for way, found in formulas.items():
        for record in ways[way]:
            for name, quantity, *numbers in record["formulas"]:
                found.setdefault((name, quantity), []).append(numbers)
    for name, numbers in formulas[reference].items():
        yield row(("formula", *name), len(numbers), 0, np.max(numbers, axis=0)[:3], np.mean(numbers, axis=0)[3],
                  np.max(formulas[truth][name], axis=0)[:3])
    for way, records in ways.items():
        off, seconds = compared(records, ways[reference])
        position = (size_name(*way[1:4]) if way[0] == "reduced" else
                    "rows as published" if way[0] == "published" else f"step {way[1]:.3g} times")
        kind, number = re.match("(fixed|still|)(.*)", way[-1]).groups()
        steps = {"": "tolerance {}", "fixed": "fixed steps {}", "still": "stationary at {} times"}[kind].format(number)
        name = "full published" if way[0] == "published" else way[0]
        yield row((name, f"{position} {steps}", "central"), len(records), len(records) - len(off), worst(off),
                  np.mean(seconds or np.nan), worst(compared(records, ways[truth])[0]))


def compared(records, references):
    """Returns quantiles of the deviations over time, and seconds, of the trajectories that reached their end. Flagged
    trajectories are included."""
    off, seconds = [], []
    for record, reference in zip(records, references):
        if record["code"] in (results.SOLVED, results.NOT_TRUSTED):
            films = results.at_times(np.array(reference["time"]), np.array(reference["H_c"]), record["time"])
            known = ~np.isnan(films)
            steps = np.diff(np.array(record["time"])[known])
            off.append(quantiles(np.abs(np.array(record["H_c"]) / films - 1)[known],
                                 (np.append(steps, 0) + np.insert(steps, 0, 0)) / 2))
            seconds.append(record["seconds"])
    return off, seconds


def worst(off):
    return np.max(off, axis=0) if off else np.full(3, np.nan)


def polish(cold, started, out):
    """Compares cold starts of the full model with starts from the reduced solution. polish.csv has a line for each
    scene, polish.txt a summary."""
    kinds = {"cold": cold, "reduced": [record["start"] for record in started], "polish": started}
    solved = [i for i in range(len(cold)) if all(records[i]["status"] != 1 for records in kinds.values())]
    if not solved:
        results.stop("polish: found no scene that all three solved, expected some")
    iterations, seconds, films = (
        {kind: np.array([records[i][name] for i in solved]) for kind, records in kinds.items()}
        for name in ("iterations", "seconds", "H_c"))
    off, difference = (np.abs(films[kind] / films["cold"] - 1) for kind in ("reduced", "polish"))
    columns = {f"{kind}_{what}": [f"{x:.{digits}g}" for x in values[kind]] for kind in kinds
               for what, values, digits in (("iterations", iterations, 9), ("seconds", seconds, 4))}
    columns.update({name: [f"{x:.2e}" for x in values]
                    for name, values in (("reduced_deviation", off), ("polish_difference", difference))})
    results.write_csv(f"{out}/polish.csv", ["scene", *columns],
                      zip((f"scene-{i + 1:03}" for i in solved), *columns.values()))

    lost = f" ({len(cold) - len(solved)} more not solved by all)" if len(solved) < len(cold) else ""
    together = seconds["reduced"] + seconds["polish"]
    lines = [f"full model, {len(solved)} scenes{lost}: cold start against start from the reduced solution",
             f"{'':28} {'iterations: mean, most':>22} {'mean time':>12}"]
    for kind, label in (("cold", "cold start"), ("reduced", "reduced solution"), ("polish", "full model from it")):
        lines.append(f"{label:28} {np.mean(iterations[kind]):15.1f} {np.max(iterations[kind]):6.0f} "
                     f"{1000 * np.mean(seconds[kind]):9.2f} ms")
    lines.append(f"time saved: {100 * (1 - np.sum(together) / np.sum(seconds['cold'])):.0f} %; slower than a cold "
                 f"start: {np.sum(together > seconds['cold'])} scenes; H_c moves by at most {np.max(off):.1e} and ends "
                 f"at most {np.max(difference):.1e} from the cold start's")
    results.write_changed(f"{out}/polish.txt", "\n".join(lines) + "\n")


def measure(out, regime, stretches, tolerances, steps, truth, repeat):
    """Measures all ways on all scenes, and writes the tables."""
    folder, model = f"{out}/trade", f"{out}/calibrated.h5"
    stretches, tolerances, steps = [float(x) for x in stretches.split()], tolerances.split(), steps.split()
    os.makedirs(folder, exist_ok=True)
    scenes = calibrated_scenes(model, regime)
    files = write_scenes(folder, scenes)
    stationary = regime == "stationary"
    if stationary:
        settings = [(1, FINEST), *((stretch, FINEST) for stretch in stretches), *((1, x) for x in tolerances)]
        ways = [(start, *setting) for start in ("cold", "neighbour") for setting in settings]
        ways += [("neighbour", stretch, "1e-2") for stretch in stretches[:2]] + [("reduced", 1, FINEST)]
    else:
        fixed = [x for x in steps if x.startswith("fixed")]
        ways = [("full", 1, x) for x in steps] + [("published", x) for x in (PUBLISHED, *fixed[:1])]
        ways += [("full", stretch, x) for stretch in stretches for x in steps[1:3]]
        # every size with the default steps, the whole model with all kinds of steps
        sizes = calibrated_sizes(model)
        ways += [("reduced", *size, steps[1]) for size in sizes]
        ways += [("reduced", *sizes[-1], x) for x in steps if x != steps[1] and not x.startswith("still")]
        # the converged solution, and a solution with twice its steps, which shows the error of the first
        stretch, length = (float(x) for x in truth.split())
        ways += [("truth", times * stretch, f"fixed{times * length:.12g}") for times in (2, 1)]

    newer_than = [model, *(os.path.join(os.environ["BIN"], program) for program in ("fullrun", "romrun"))]
    films_of = stationary_films if stationary else transient_films

    def measure_way(way, work):
        return films_of(way, scenes, files, model, repeat, work)
    films = {way: measured(folder, way, measure_way, newer_than) for way in ways}
    if stationary:
        longer, *finer = (float(x) for x in truth.split())
        grids = [films[ways[0]], *(measured(folder, ("truth", *grid), lambda way, work:
                                            truth_films(way, scenes, files, work), newer_than)
                                   for grid in [(longer, 1.0), *((1.0, stretch) for stretch in finer)])]
        exact = truths(*grids, finer[0] / finer[1])
        failures = results.printed(model, "position_failures")["position_failures"]
        sizes = {size: measured(folder, ("model", *size), lambda way, work: model_films(way, files, model), newer_than)
                 for size, failed in zip(calibrated_sizes(model), failures) if not failed}
        with open("scene.yml") as source:
            if "discretization: published" in source.read():
                films["published",] = measured(folder, ("published",), lambda way, work:
                                               published_films(scenes, repeat, work), [*newer_than, "scene.yml"])
        rows = [*calibration_rows(model, sizes, exact), *stationary_rows(films, ways[0], exact)]
        for record, name in zip(grids[1:], (f"inlet {longer:.3g} times", *(f"step {x:.3g} times" for x in finer))):
            rows.append(row(("truth", name, "central"), len(exact), exact.count({}), 3 * [np.nan],
                            true=distances({i: scene["H_c"] for i, scene in enumerate(record)}, exact)))
        polish(films[ways[0]], films[ways[-1]], out)
    else:
        rows = transient_rows(films, ways[0], ways[-1])
    results.write_csv(f"{out}/trade.csv", HEADER, rows)


# ---- The picture

# Label, mark (in brackets: hollow), colour, and a pattern. A row of trade.csv belongs to the first series whose pattern
# matches "ALTERNATIVE POSITION", or "failing ALTERNATIVE POSITION" if some scenes have no result.
SERIES = {
    "stationary": [
        ("film formulas", "o", "black", "formula"),
        ("reduced model, sizes", "o", BLUE, "reduced"),
        ("reduced model, failing on some scenes", "x", SKY, "failing reduced"),
        ("full model from a neighbour, grids", "^", GREEN, f"full from neighbour .* {FINEST}"),
        ("full model from a neighbour, looser tolerances", "(^)", GREEN, "full from neighbour"),
        ("full model, cold start, grids", "s", RED, f"full cold .* {FINEST}"),
        ("full model, cold start, looser tolerances", "(s)", RED, "full cold"),
        ("full model, failing on some scenes", "x", ORANGE, "failing full"),
        ("full model, published rows and grid", "P", ORANGE, "full published"),
        ("full model from the reduced solution", "D", PINK, "full from reduced")],
    "transient": [
        ("film formulas at each time", "o", "black", "formula"),
        ("reduced model, sizes and tolerances", "o", BLUE, "reduced .* tolerance"),
        ("reduced model, fixed steps", "(o)", BLUE, "reduced .* fixed"),
        ("either model, some trajectory lost", "x", SKY, "failing"),
        ("full model, tolerances", "s", RED, "full step 1 times tolerance"),
        ("full model, fixed steps", "(s)", RED, "full step 1 times fixed"),
        ("full model, published rows", "P", ORANGE, "full published"),
        ("full model, coarser grids", "^", GREEN, "full step .* times (tolerance|fixed)"),
        ("full model, stationary at each time", "D", PINK, "full .* stationary")],
}
GREY = "#444444"


def draw(out, regime, width):
    """Draws trade.csv: deviations from the full model (left) and from the converged solution (right)."""
    lines = [{**line, **{key: float(line[key] or "nan") for key in HEADER[3:]}}
             for line in results.read_csv(f"{out}/trade.csv")]
    figure, (panels,) = pictures.page(float(width), 0.6 * float(width), 1, 2, squeeze=False)
    panel(panels[0], lines, regime)
    panel(panels[1], [{**line, "worst": line["true_worst"], "median": line["true_median"]} for line in lines],
          regime, 1e-5)
    panels[0].set_title("from the full model on the same grid")
    panels[1].set(title="from the truth", ylabel=None)
    handles, labels = panels[0].get_legend_handles_labels()
    half = -(-len(handles) // len(panels))
    for i, axes in enumerate(panels):
        part = slice(i * half, (i + 1) * half)
        axes.legend(handles[part], labels[part], loc="upper center", bbox_to_anchor=(0.5, -0.1), ncol=2, frameon=False,
                    fontsize=9)
    pictures.save(figure, f"{out}/trade.png")


def panel(axes, lines, regime, lowest=None):
    """Draws the deviation of the central film against time, with a bar from the worst scene (mark) to the median.
    Smaller deviations are drawn at `lowest`. Without `lowest` they are from the full model, drawn at the bottom."""
    stationary, of_model = regime == "stationary", lowest is None
    lowest = lowest or (1e-9 if stationary else 1e-5)
    shown = {series: [] for series in SERIES[regime]}
    for line in lines:
        name = "failing " * (line["failures"] > 0) + f"{line['alternative']} {line['position']}"
        series = next((series for series in shown if re.match(series[3], name)), None)
        if series and line["seconds"] > 0 and not np.isnan(line["worst"]):
            shown[series].append([line["seconds"], max(line["worst"], lowest), max(line["median"], lowest)])
    for (label, mark, colour, _), points in shown.items():
        if not points:
            continue
        seconds, high, low = np.transpose(points)
        if mark != "x":
            axes.vlines(seconds, low, high, color=colour)
        axes.plot(seconds, high, mark.strip("()"), color=colour, label=label, markersize=4 if mark == "x" else 6,
                  markerfacecolor="none" if "(" in mark else colour, markeredgewidth=1.3)

    def note(text, place, height, above):
        axes.annotate(text, (place, height), xycoords=("axes fraction", "data"), va="bottom" if above else "top",
                      color=GREY)
    # the error of the reference itself: due to its grid and, in a transient run, due to its time steps
    if of_model:
        line = next(line for line in lines if line["alternative"] == ("full cold" if stationary else "full"))
        for key, style in zip(("true_worst", "true_median"), ("--", ":")):
            axes.axhline(line[key], linestyle=style, color=GREY)
            note(f"the {'grid' if stationary else 'reference'} itself, {'worst' if style == '--' else 'median'}",
                 0.22, line[key], style == "--")
        note("none (or less): the reference", 0.012, lowest, True)
    formulas = sorted((line for line in lines if line["alternative"] == "formula"), key=lambda line: -line["worst"])
    names = [f"{re.sub('-central|-minimum', '', line['position'])} {100 * line['worst']:.0f} %"
             + ", minimum" * (line["quantity"] == "minimum") for line in formulas]
    axes.text(0.012, 0.4, "\n".join(["film formulas, worst:", *names]), transform=axes.transAxes, va="top", fontsize=9)
    axes.set(xscale="log", yscale="log", ylim=(lowest / 2, 2), xlim=(1e-8, 1) if stationary else (1e-5, 200),
             xlabel="time of a solution / s" if stationary else "time of a trajectory / s",
             ylabel="deviation of $H_c$: worst (mark), median (end of the bar)")
    for axis in axes.xaxis, axes.yaxis:
        axis.get_major_locator().set_params(numticks=12)  # a tick for every decade


if __name__ == "__main__":
    results.commands(measure, draw)
