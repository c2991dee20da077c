# SPDX-License-Identifier: GPL-3.0-or-later
"""Does a reduced model know when it is wrong (README.md)?

    study.py draw FOLDER SEED COUNT MODEL.h5 SCENE.yml [own|region]
                                                                random scenes around the training points of the model,
                                                                trained on SCENE.yml: FOLDER/plan.yml and more
    study.py run FOLDER MODEL.h5 SETTINGS PROMISE...            solves them with a calibrated model: FOLDER/runs.csv
    study.py table RUNS.csv SEED CALIBRATION_SEED               counts; exit code 1 where a run ended otherwise

Half of the scenes lie inside of the hull of the training points in ln M and ln(alpha p_H), half outside but within a rectangle
of twice its extent; with `own` all are inside and of the lubricant that the model was trained with. With `region` they are
SCENE.yml with settings within the bounds of the first region of the plan beside it, by turns evenly distributed and so in
their logarithms. Kind of contact, grid and the lubricant called its own are those of the scene that was trained on. MODEL.h5 may be
a list of models.
"""
import json
import os
import re
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np

import results

# Laws that are always drawn: alpha in 1/Pa, None: drawn between 1e-8 and 3e-8; the highest Hertz pressure in Pa, so
# that the spike stays below that of the law.
LAWS = {"law: wlf, preset: no1": (23.60e-9, 9e9), "law: wlf, preset: no2": (12.51e-9, 4e9),
        "law: wlf, preset: no3": (18.05e-9, 3.8e9), "law: barus": (None, 1e12),
        "law: roelands, eta0: 0.04": (None, 1e12)}
DENSITIES = ["dowson-higginson", "incompressible"]
MOST_L = 40

FILMS = ["central", "minimum"]
RUN = ["promise", "where", "whose", "code", "central", "minimum", "indicated_central", "indicated_minimum", "fields",
       "full_central", "full_minimum"]
LEAST_OFF = 1e-7  # below, deviations are no longer those of the model


# ---- Scenes


def read_scene(file):
    """Kind of contact, lines of discretisation and grid, viscosity, and line of physical settings (or empty) of a scene."""
    with open(file) as source:
        lines = {line.split(":")[0].strip(): line.rstrip() for line in source}
    return (re.sub(" *#.*", "", lines["contact"].split(":")[1]).strip(),
            "\n".join(lines[key] for key in ("discretization", "grid") if key in lines),
            re.sub("^[^{]*{|}.*", "", lines["viscosity"]), lines.get("physical", ""))


def read_region(file):
    """Bounds of the settings of the first region of a plan."""
    with open(file) as source:
        region = re.search(r"^ *region: *{(.*)}", source.read(), flags=re.M)
    bounds = dict(re.findall(r"([\w.]+): *\[(.*?)\]", region[1])) if region else {}
    if not bounds:
        results.stop(f"{file}: found no region in one line, expected one")
    return {key: [float(bound) for bound in pair.split(",")] for key, pair in bounds.items()}


def laws_of(viscosity):
    """All laws, that of the scene that was trained on first."""
    if "preset: no1" in viscosity:
        return LAWS
    alpha = re.search(r"alpha: *([-+.0-9e]+)", viscosity)
    if not alpha:
        results.stop(f"found viscosity {viscosity}, expected an alpha")
    return {viscosity: (float(alpha[1]), 1e12), **LAWS}


def hull_edges(points):
    """Pairs of points that have all others on their left, or on their line."""
    to = points[None] - points[:, None]
    turns = to[:, :, None, 0] * to[:, None, :, 1] - to[:, :, None, 1] * to[:, None, :, 0]
    rounding = 1e-12 * np.ptp(points, axis=0).prod()
    return [(points[i], points[j]) for i, j in np.argwhere(np.all(turns >= -rounding, axis=2)) if i != j]


def is_inside(edges, place):
    return all((b[0] - a[0]) * (place[1] - a[1]) >= (b[1] - a[1]) * (place[0] - a[0]) for a, b in edges)


def drawn_in_region(bounds, count, random):
    """Entries of scenes.json by (number of the law, of the density): settings within bounds, by turns even and even in the
    logarithm."""
    def settings(logarithmic):
        return {key: f"{np.exp(random.uniform(*np.log(pair))) if logarithmic else random.uniform(*pair):.12g}"
                for key, pair in bounds.items()}

    return {(0, 0): [{"where": "inside", "whose": "own", "settings": settings(i % 2 == 1)} for i in range(count)]}


def drawn_around_hull(contact, laws, model, count, own, random):
    """The same inside and outside of the hull of a model's training points."""
    trained = np.concatenate([np.array(list(results.printed(part, "state_moes_M", "state_alpha_p_H").values())).T
                              for part in results.listed_models(model)])
    edges = hull_edges(np.log(trained))
    middle, extent = (trained.min(axis=0) + trained.max(axis=0)) / 2, np.ptp(trained, axis=0)

    def moes_L(M, alpha_p_H):
        return alpha_p_H / ((1.5 * M) ** (1 / 3) / np.pi if contact == "point" else (M / (2 * np.pi)) ** 0.5)

    def place(inside):
        while True:
            M, alpha_p_H = middle + (0.5 if inside else 1) * extent * random.uniform(-1, 1, 2)
            if (M >= 1 and alpha_p_H > 0 and moes_L(M, alpha_p_H) <= MOST_L
                    and is_inside(edges, np.log((M, alpha_p_H))) == inside):
                return M, alpha_p_H

    groups = {}
    for i in range(count):
        inside = own or i % 2 == 0
        while True:
            M, alpha_p_H = place(inside)
            which, density = (0, 0) if own else (random.integers(len(laws)), random.integers(len(DENSITIES)))
            alpha, limit = laws[which][1]
            settings = {"moes.M": f"{M:.12g}", "moes.L": f"{moes_L(M, alpha_p_H):.12g}"}
            if alpha is None:
                alpha = random.uniform(1e-8, 3e-8)
                settings["lubricant.viscosity.alpha"] = f"{alpha:.12g}"
            if alpha_p_H / alpha <= limit:
                break
        groups.setdefault((which, density), []).append(
            {"where": "inside" if inside else "outside", "whose": "other" if which or density else "own",
             "settings": settings})
    return groups


def draw(folder, seed, count, model, scene_file, of=""):
    """Random scenes: plan.yml, scenes.json with an entry each in the plan's order, and the scene files of it."""
    contact, grid, viscosity, physical = read_scene(scene_file)
    laws = list(laws_of(viscosity).items())
    random = np.random.default_rng(int(seed))
    if of == "region":
        groups = drawn_in_region(read_region(f"{os.path.dirname(scene_file)}/plan.yml"), int(count), random)
    else:
        groups = drawn_around_hull(contact, laws, model, int(count), of == "own", random)

    os.makedirs(folder, exist_ok=True)
    plan, scenes = "groups:\n", []
    for (which, density), group in sorted(groups.items()):
        scene = f"{folder}/scene-{which + 1}-{density + 1}.yml"
        text = (f"contact: {contact}\nregime: stationary\nlubricant:\n  viscosity: {{{laws[which][0]}}}\n"
                f"  density: {{law: {DENSITIES[density]}}}\n{grid}\n" + (f"{physical}\n" if of == "region" else ""))
        results.write_changed(scene, text)
        plan += "  - scene:\n" + re.sub("^", " " * 6, text, flags=re.M).rstrip() + "\n    combine: list\n    vary:\n"
        for key in group[0]["settings"]:
            plan += f"      {key}: [{', '.join(entry['settings'][key] for entry in group)}]\n"
        scenes += [{"scene": scene, **entry} for entry in group]
    results.write_changed(f"{folder}/scenes.json", json.dumps(scenes, indent=0))
    results.write_changed(f"{folder}/plan.yml", plan)


# ---- Runs


def beyond_neighbours(field, other):
    """How far a field [x] or [y, x] is at most outside of the range of the other at the node and its neighbours, and the
    other of its: what is shifted by less than a node is not."""
    def once(a, b):
        padded = np.pad(b, 1, mode="edge")
        around = [padded[tuple(slice(s, s + n) for s, n in zip(shift, b.shape))] for shift in np.ndindex(*[3] * b.ndim)]
        return max(np.max(a - np.max(around, axis=0)), np.max(np.min(around, axis=0) - a))
    return max(once(field, other), once(other, field))


def fields_off(file, pressure, film, central):
    """The larger deviation of both fields: of P in Hertz pressures, of H over the central film where there is P. A result has
    both halves of a point contact, pressure and film maybe the one with y >= 0 alone."""
    pressure, film = np.squeeze(pressure), np.squeeze(film)
    found = [np.squeeze(file[name][()])[-len(pressure):] for name in ("pressure", "film_thickness")]
    inside = pressure > 0
    film_off = beyond_neighbours(np.where(inside, found[1], 0), np.where(inside, film, 0))
    return max(beyond_neighbours(found[0], pressure), film_off / central)


def read_run(file, full, i):
    """Films, indicated deviations and deviation of the fields of a result: texts, empty where there is none."""
    if not os.path.exists(file):
        return [""] * 5
    with h5py.File(file) as result:
        numbers = [f"{kind}{which}{end}" for kind, end in (("", "_film_thickness"), ("indicated", ""))
                   for which in FILMS]
        names = dict(zip(numbers[2:], ("indicated_deviation", "indicated_deviation_minimum")))
        found = [repr(float(np.squeeze(result[name][()]))) if name in result else ""
                 for name in (names.get(number, number) for number in numbers)]
        off = ""
        if full["status"][i] == results.SOLVED and int(np.squeeze(result["status"][()])) != results.NOT_CONVERGED:
            off = repr(float(fields_off(result, full["pressure"][i], full["film_thickness"][i],
                                        full["central_film_thickness"][i])))
    return found + [off]


def run(folder, model, settings, *promises):
    """Solves the scenes with promises, two at a time: exit code of romrun, what read_run finds, and H_c and H_min of the
    full model, or empty. A promise that is none asks for nothing, so that 1 % holds. Settings: more options of romrun."""
    with open(f"{folder}/scenes.json") as source:
        scenes = json.load(source)
    with h5py.File(f"{folder}/full.h5") as file:
        full = {name: file[name][()] for name in
                ("status", "central_film_thickness", "minimum_film_thickness", "pressure", "film_thickness")}
    films = [[repr(float(full[f"{which}_film_thickness"][i])) if full["status"][i] == results.SOLVED else ""
              for which in FILMS] for i in range(len(scenes))]

    def solve(promise, i, place):
        asked = [] if promise == "none" else ["--accuracy", promise]
        file = f"{place}/{promise}-{i}.h5"
        done = results.run("romrun", scenes[i]["scene"], "--model", model, *asked, "--quiet", "-o", file,
                           "--set", "output.fields=true", *settings.split(), *results.sets(scenes[i]["settings"]),
                           outcomes=range(-255, 256))
        found = read_run(file, full, i)
        if os.path.exists(file):
            os.remove(file)
        return done.returncode, *found

    runs = []
    with ThreadPoolExecutor(2) as two, tempfile.TemporaryDirectory() as place:
        for promise in promises:
            solved = two.map(solve, [promise] * len(scenes), range(len(scenes)), [place] * len(scenes))
            runs += [[promise, scene["where"], scene["whose"], *reduced, *full_films]
                     for scene, reduced, full_films in zip(scenes, solved, films)]
    results.write_csv(f"{folder}/runs.csv", RUN, runs)


# ---- Table


def promised(run):
    return 0.01 if run["promise"] == "none" else float(run["promise"])


def off_of(run, which):
    return abs(float(run[which]) / float(run[f"full_{which}"]) - 1)


def outcome(run):
    """A scene is good where both films deviate by no more than promised, and flagged with exit code 4. One that does
    not converge, exit code 3, has no result that could be wrong. Returns what it is, and the larger deviation."""
    code = int(run["code"])
    if not run["full_central"]:
        return "no reference", 0
    if code == results.NOT_CONVERGED:
        return "not solved", 0
    if code not in (results.SOLVED, results.NOT_TRUSTED):
        return "error", 0
    off = max(off_of(run, film) for film in FILMS)
    flagged = "flagged" if code == results.NOT_TRUSTED else "not flagged"
    return f"{'good' if off <= promised(run) else 'bad'} {flagged}", off


def print_fields(runs):
    """Fields of results that are not flagged, over what was promised of the films."""
    quiet = [float(run["fields"]) / promised(run) for run in runs if run["code"] == "0" and run["fields"]]
    if quiet:
        far = sum(off > 3 for off in quiet)
        print(f"  fields off by more than 3 times that, not flagged: {far} of {len(quiet)}; "
              f"the worst {max(quiet):.2g} times")


def print_effectivity(runs):
    """Indicated over true deviation of those inside that are solved."""
    for which in FILMS:
        over = [float(run[f"indicated_{which}"]) / off_of(run, which) for run in runs
                if run["where"] == "inside" and outcome(run)[0].startswith(("good", "bad"))
                and run[f"indicated_{which}"] and off_of(run, which) > LEAST_OFF]
        if over:
            median, most = np.quantile(over, [0.5, 0.95])
            print(f"  indicated over true deviation inside, {which} film: {sum(one < 1 for one in over)} of {len(over)} "
                  f"below 1, least {min(over):.2g}, median {median:.2g}, 95 % {most:.2g}")


def table(file, seed, calibration):
    """What was flagged and what was not."""
    groups = {"inside own": "inside, own lubricant", "inside other": "inside, other lubricants",
              "outside": "outside, any lubricant"}
    lines = list(results.read_csv(file))
    runs = [(run["promise"], f"{run['where']} {run['whose']}", *outcome(run)) for run in lines]
    print(f"seed {seed}, calibrated on seed {calibration}\n")
    layout = "{:24} {:>8} {:>8} {:>12} {:>16} {:>8} {:>10} {:>12}"
    print(layout.format("", "good,", "good,", "of the good", "bad, not", "bad,", "not", "full model"))
    print(layout.format("", "quiet", "flagged", "flagged", "flagged: silent", "flagged", "solved", "has none"))
    for promise in dict.fromkeys(run[0] for run in runs):
        print("no promise asked for" if promise == "none" else f"promise {float(promise):g}")
        for group, name in groups.items():
            mine = [run[2] for run in runs if run[0] == promise and run[1].startswith(group)]
            quiet, loud, *others = (mine.count(what) for what in (
                "good not flagged", "good flagged", "bad not flagged", "bad flagged", "not solved", "no reference"))
            print(layout.format(f"  {name}", quiet, loud, f"{100 * loud / max(quiet + loud, 1):.1f} %", *others))
        mine = [run for run in lines if run["promise"] == promise]
        print_fields(mine)
        print_effectivity(mine)
    silent = [off for *_, what, off in runs if what == "bad not flagged"]
    errors = sum(what == "error" for *_, what, _ in runs)
    print(f"\nsilent failures: {len(silent)}" + (f", the worst {max(silent):.2g} off" if silent else ""))
    if errors:
        print(f"found {errors} runs that ended otherwise, expected none")
        sys.exit(1)


if __name__ == "__main__":
    results.commands(draw, run, table)
