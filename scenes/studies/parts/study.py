# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares a list of models for parts of a region, and a model of the whole region if it exists (README.md):

    study.py costs FOLDER PLAN.yml MODELS.yml [MODEL.h5]                training, sizes, files and memory of each model
    study.py draw FOLDER PLAN.yml SEED COUNT MODELS.yml [MODEL.h5]      random scenes at 1 permille: time, deviation, flags
    study.py border FOLDER PLAN.yml PICTURE.png MODELS.yml              the film where the ranges of two models overlap

A plan defines the region. `scene`, `region` and `vary` of its groups have to be one line each.
"""
import os
import re
import subprocess
import sys

import numpy as np

import results

ACCURACY = 1e-3
REPEATS = 5
DATA = 65  # exit code if a model cannot solve the scene with the given options
FILMS = ["central_film_thickness", "minimum_film_thickness"]
EFFECTS = ["step_effect", "step_effect_minimum", "inlet_effect"]


# ---- The region


class Group:
    """A group of a plan: its scene, the bounds of its settings (key to pair of numbers), the values of other settings
    (key to texts), and the bounds of M and alpha p_H (where)."""

    def __init__(self, text):
        lists = {line: re.findall(r"([\w.]+): \[(.*?)\]", found[0]) if (found := re.findall(rf"^ +(?:- )?{line}: (.*)", text, re.M))
                 else [] for line in ("region", "vary", "where")}
        self.scene = re.search(r"scene: ({.*})", text)[1]
        self.bounds, self.where = ({key: [float(bound) for bound in pair.split(",")] for key, pair in lists[line]}
                                   for line in ("region", "where"))
        self.choices = {key: choices.split(", ") for key, choices in lists["vary"]}

    @property
    def keys(self):
        return [*self.bounds, *self.choices]

    def draw(self, random):
        """Draws the values of all keys for a scene. Numbers other than L are distributed evenly in their logarithms."""
        values = [random.uniform(*pair) if key == "moes.L" else np.exp(random.uniform(*np.log(pair)))
                  for key, pair in self.bounds.items()]
        return [f"{value:.12g}" for value in values] + [texts[random.integers(len(texts))] for texts in self.choices.values()]


def read_plan(file):
    with open(file) as source:
        return [Group(text) for text in re.split(r"^(?=  - scene)", source.read(), flags=re.M)[1:]]


def write_scenes(folder, drawn):
    """Writes a scene and a table of points for each group with drawn values. Returns both names for each group. The
    scenes have no grid, so they are solved on the grid of the model."""
    files = []
    for i, (group, points) in enumerate(drawn):
        scene, table = f"{folder}/scene-{i}.yml", f"{folder}/points-{i}.csv"
        results.write_changed(scene, group.scene + "\n")
        results.write_csv(table, group.keys, points)
        files.append((scene, table))
    return files


# ---- Solutions


def solve_reduced(model, files, table, *options):
    """Solves all scenes of all files with a model. Returns status, M, alpha p_H, films, part and time (s)."""
    names = ["status", "moes_M", "alpha_p_H", *FILMS, "part", "solve_seconds [s]"]
    columns = {name: [] for name in names}
    for scene, points in files:
        results.run("romrun", "cases", scene, points, "--model", model, "-o", table, "--force", "--quiet", "--jobs", "1", *options)
        for line in results.read_csv(table):
            for name in names:
                columns[name].append(float(line.get(name, 0)))
    return {name.split()[0]: np.array(values) for name, values in columns.items()}


def solve_full(found, folder, drawn, model, part, wanted):
    """Solves the wanted scenes with the full model on the grid of a model. Stores their status and films in `found`."""
    plan, first = f"{folder}/plan-{part}.yml", 0
    with open(plan, "w") as target:
        target.write("groups:\n")
        for i, (group, points) in enumerate(drawn):
            mine = [point for point, want in zip(points, wanted[first:]) if want]
            first += len(points)
            if mine:
                results.write_csv(f"{folder}/points-{part}-{i}.csv", group.keys, mine)
                target.write(f"  - scene: scene-{i}.yml\n    points: points-{part}-{i}.csv\n")
    x = results.printed(model, "x")["x"]
    grid = {"grid.x_min": x[0], "grid.x_max": x[-1], "grid.step": results.value(model, "step"), "output.resolution": "false"}
    results.run("snapgen", plan, "-o", f"{folder}/full.h5", "--force", "--quiet", "--allow-failures", sum(wanted), *results.sets(grid))
    for name, values in results.printed(f"{folder}/full.h5", *found).items():
        found[name][wanted] = values


def reference(folder, drawn, models, part):
    """Returns status and films of the full model, on the grid of the part that has solved the scene. `part` is NaN, and
    the result as well, if no part is to be compared."""
    found = {name: np.full(len(part), np.nan) for name in ("status", *FILMS)}
    for p in np.unique(part[~np.isnan(part)]).astype(int):
        solve_full(found, folder, drawn, models[p], p, part == p)
    return found


# ---- Tables


def part_name(model):
    return os.path.basename(os.path.dirname(model))


def extent(model):
    """Returns the lowest and highest M of a model, from the name of its folder."""
    return [float(edge) for edge in part_name(model).split("-")]


def memory_of(scene, model):
    """Returns the memory in MB of a run with one scene, converged or not."""
    run = subprocess.Popen([os.path.join(os.environ["BIN"], "romrun"), scene, "--model", model, "--quiet"],
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, code, used = os.wait4(run.pid, 0)
    if os.waitstatus_to_exitcode(code) not in (results.SOLVED, results.NOT_CONVERGED, results.NOT_TRUSTED):
        sys.exit(os.waitstatus_to_exitcode(code))
    return used.ru_maxrss / 1024


def costs(folder, plan, models, *whole):
    """Prints the training, size, file and memory of each model, and the largest effects of the step and the inlet of
    its grid on the films of its training. The line `list` has the sums of the parts."""
    rows = [["M", "nodes", "points", "rounds, min", "modes", "rows", "model, MB", "a run, MB", "step's effect: H_c", "H_m", "inlet's: H_c"],
            None]
    scene, parts = f"{folder}/scene.yml", results.listed_models(models)
    group = read_plan(plan)[0]
    middle = {key: np.sqrt(np.prod(pair)) for key, pair in group.bounds.items()}
    settings = {**middle, **{key: texts[0] for key, texts in group.choices.items()}}
    results.write_changed(scene, group.scene[:-1] + "".join(f", {key}: {value}" for key, value in settings.items()) + "}\n")
    points = minutes = size = 0
    for model in (*parts, *whole):
        trained = os.path.join(os.path.dirname(model), "snapshots.h5")
        sizes, solved = results.model_sizes(model), results.printed(trained, "status", *EFFECTS)
        effects = [np.abs(solved[name][solved["status"] == 0]).max() for name in EFFECTS]
        own = sizes["states"], results.printed(trained, "round_seconds")["round_seconds"][-1] / 60, os.path.getsize(model) / 1e6
        rows.append([part_name(model), sizes["nodes"], own[0], f"{own[1]:.1f}", sizes["pressure_modes"], sizes["rows"],
                     f"{own[2]:.1f}", f"{memory_of(scene, model):.0f}", *(f"{effect:.1e}" for effect in effects)])
        if model in parts:
            points, minutes, size = points + own[0], minutes + own[1], size + own[2]
    rows.insert(2 + len(parts), ["list", "", points, f"{minutes:.1f}", "", "", f"{size:.1f}", f"{memory_of(scene, models):.0f}", *[""] * 3])
    results.table(rows)


def summary(name, solved, full, mine):
    """Returns a row of the table of draw, for some of the scenes."""
    known = mine & (full["status"] == 0)
    off = np.max([np.abs(solved[film] / full[film] - 1) for film in FILMS], axis=0)
    quiet, flagged = known & (solved["status"] == 0), known & (solved["status"] == results.NOT_TRUSTED)
    worst = [f"{np.max(np.abs(solved[film] / full[film] - 1)[quiet], initial=0):.1e}" for film in FILMS]
    ms = 1e3 * solved["solve_seconds"][mine]
    return [name, mine.sum(), (mine & ~known).sum(), (known & (solved["status"] == 1)).sum(), flagged.sum(),
            (flagged & (off <= ACCURACY)).sum(), (quiet & (off > ACCURACY)).sum(), *worst,
            *(f"{of:.3f}" for of in (np.median(ms), ms.mean(), *np.quantile(ms, (0.9, 0.95, 1))))]


def solve_timed(model, files, table, *options):
    """Like solve_reduced, with the least time of REPEATS runs."""
    solved = solve_reduced(model, files, table, *options)
    for _ in range(REPEATS - 1):
        again = solve_reduced(model, files, table, *options)["solve_seconds"]
        solved["solve_seconds"] = np.minimum(solved["solve_seconds"], again)
    return solved


def serves(model, scene, settings, *options):
    """Returns whether a model has a size for the given options."""
    return results.run("romrun", scene, *results.sets(settings), "--model", model, "--quiet", *options,
                       outcomes=range(256)).returncode != DATA


def draw(folder, plan, seed, count, models, *whole):
    """Solves random scenes with an accuracy of 1 permille. Prints a row for each part with the scenes that it has
    solved, and a row for the list with all scenes. Scenes that the plan excludes are left out."""
    header = ["M", "scenes", "full has none", "not solved", "flagged", "of these good", "silent", "H_c, worst", "H_m, worst",
              "ms: median", "mean", "90 %", "95 %", "worst"]
    random, groups, parts = np.random.default_rng(int(seed)), read_plan(plan), results.listed_models(models)
    drawn = [(group, [group.draw(random) for _ in range(int(count) // len(groups))]) for group in groups]
    files, asked = write_scenes(folder, drawn), ["--accuracy", ACCURACY]
    solved = solve_timed(models, files, f"{folder}/solved.csv", *asked)
    inside = np.ones(len(solved["status"]), bool)
    for key, (low, high) in groups[0].where.items():
        inside &= (solved[key] >= low) & (solved[key] <= high)
    full = reference(folder, drawn, parts, np.where(inside, solved["part"], np.nan))
    rows = [summary(part_name(model), solved, full, inside & (solved["part"] == p)) for p, model in enumerate(parts)
            if np.any(inside & (solved["part"] == p))]
    rows.append(summary("list", solved, full, inside))
    for model in whole:
        served = serves(model, files[0][0], dict(zip(groups[0].keys, drawn[0][1][0])), *asked)
        solved = solve_timed(model, files, f"{folder}/solved.csv", *asked if served else [])
        full = reference(folder, drawn, [model], np.where(inside, 0, np.nan))
        rows.append(summary(part_name(model) if served else f"{part_name(model)}, all of it", solved, full, inside))
    print(f"seed {seed}, --accuracy {ACCURACY:g}, time: least of {REPEATS} runs\n")
    results.table([header, None, *rows])


# ---- Picture


def path(group, count):
    """Returns values of the keys on a path through the region on which M increases. Settings that do not change M have
    the middle of their range."""
    middle = {key: np.full(count, np.sqrt(np.prod(pair))) for key, pair in group.bounds.items()}
    for key in ("moes.M", "physical.load", "physical.speed"):
        if key in group.bounds:
            middle[key] = np.geomspace(*group.bounds[key], count)[::-1 if key == "physical.speed" else 1]
    if "moes.L" in middle:
        middle["moes.L"][:] = 6
    return [[f"{value:.12g}" for value in values] for values in zip(*middle.values())]


def border(folder, plan, picture, models):
    """Draws the central film of the list over M, and the deviations of the list and of each part from the full model on
    the grid of the part that the list uses. The scenes are those of the first group, with a curve for each value of the
    setting that it varies."""
    import pictures

    group, parts, off, jumps = read_plan(plan)[0], results.listed_models(models), [], []
    figure, axes = pictures.page(900, 720, 2, 1, sharex=True)
    for texts, colour in zip(next(iter(group.choices.values()), [""]), pictures.COLOURS):
        drawn = [(group, [values + [texts] * len(group.choices) for values in path(group, 161)])]
        files = write_scenes(folder, drawn)
        solved = solve_reduced(models, files, f"{folder}/solved.csv")
        M = solved["moes_M"]
        full = reference(folder, drawn, parts, solved["part"])
        axes[0].loglog(M, solved[FILMS[0]], color=colour, label=f"list {texts}".strip())
        off.append(np.abs(solved[FILMS[0]] / full[FILMS[0]] - 1))
        axes[1].loglog(M, off[-1], color=colour, label=f"list {texts}".strip())
        for p, model in enumerate(parts):
            low, high = extent(model)
            near = (M >= 0.999 * low) & (M <= 1.001 * high)
            points = [point for point, is_near in zip(drawn[0][1], near) if is_near]
            alone = solve_reduced(model, write_scenes(folder, [(group, points)]), f"{folder}/solved.csv")[FILMS[0]]
            axes[1].loglog(M[near], np.abs(alone / full[FILMS[0]][near] - 1), pictures.MARKS[p % len(pictures.MARKS)], color=colour,
                           fillstyle="none", markersize=4)
            both = np.abs(solved["part"][near] - p) == 1
            jumps.append(np.abs(alone / solved[FILMS[0]][near] - 1)[both].max(initial=0))
    print(f"the list's central film is {np.max(off):.1e} at most off the full model on the grid of the part")
    print(f"where two parts overlap their central films, each on its own grid, differ by {max(jumps):.1e} at most")
    axes[0].set_ylabel("central film H")
    axes[1].set(xlabel="M; lines at the ends of the parts", ylabel="off the full model (marks: a part alone)")
    for plot in axes:
        for model in parts:
            for edge in extent(model):
                plot.axvline(edge, color="#999999", linewidth=0.7)
        plot.legend(fontsize=8)
    pictures.plain_logarithms(axes[1].xaxis)
    pictures.save(figure, picture)


if __name__ == "__main__":
    results.commands(costs, draw, border)
