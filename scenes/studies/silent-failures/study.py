# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests whether a reduced model flags its wrong results (README.md):

    study.py training NAME FOLDER                               writes FOLDER/scene.yml and plan.yml of a training
    study.py draw FOLDER SEED COUNT MODEL.h5 SCENE.yml [own|region|oils]
                                                                draws random scenes around the training points of the
                                                                model, trained on SCENE.yml: FOLDER/plan.yml and more
    study.py run FOLDER MODEL.h5 SETTINGS PROMISE...            solves them with a calibrated model: FOLDER/runs.csv
    study.py table RUNS.csv SEED CALIBRATION_SEED               prints counts; exit code 1 if a run ended with an error

Half of the scenes lie inside of the convex hull of the training points in ln M and ln(alpha p_H). The other half lies
outside, within a rectangle of twice the extent of the training points. There are three other kinds of scenes:

    own       all scenes are inside, and have the lubricant of the training
    region    SCENE.yml with settings inside of the first region of the plan beside SCENE.yml; by turns they are
              distributed evenly, and evenly in their logarithms
    oils      all scenes are inside, and have other oils: by turns the trained oil with alpha +-8 % and eta0 +-20 %,
              the trained oil with the other density law, and any laws and parameters; half of the scenes slide, with
              any law of shear stress

SCENE.yml gives the kind of contact, the grid, and the lubricant of the training. MODEL.h5 may be a list of models. A
promise is an accuracy for romrun.
"""
import json
import os
import re
import shlex
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np

import results

# Viscosity laws of the scenes: alpha in 1/Pa (None: drawn between 1e-8 and 3e-8), and the highest Hertz pressure in Pa,
# at which the spike stays below the largest pressure of the law.
LAWS = {"law: wlf, preset: no1": (23.60e-9, 9e9), "law: wlf, preset: no2": (12.51e-9, 4e9),
        "law: wlf, preset: no3": (18.05e-9, 3.8e9), "law: barus": (None, 1e12),
        "law: roelands, eta0: 0.04": (None, 1e12)}
DENSITIES = ["dowson-higginson", "incompressible"]
# Viscosity of the presets at 25 degC, Pa s, from eq. 40 (common/physics/README.md).
ETA0 = {"no1": 1e12 * 10 ** (-16.04 * 98.86 / 117.04), "no2": 1e12 * 10 ** (-15.87 * 138.79 / 149.01),
        "no3": 1e7 * 10 ** (-11.84 * 112.46 / 173.05)}
# Reduced radius (m) and modulus (Pa) of contacts in SI units.
RADIUS, MODULUS = 0.01, 230e9
# Laws of shear stress, with bounds of their parameters, which are drawn evenly in their logarithms.
SHEARS = {"law: newtonian": {}, "law: eyring": {"tau0": (2e6, 2e7)}, "law: limiting": {"limit": (0.02, 0.1)},
          "law: carreau": {"G": (1e5, 1e7), "n": (0.3, 0.9)}}
MOST_L = 40

# Trainings on all LAWS, compressible and incompressible: kind of contact and grid; bounds of M and L; candidates for
# each law; the law, M and L of scene.yml; for some laws bounds of alpha p_H. Above these bounds a WLF law does not
# hold, or ../stationary-line-high has no training. Laws without an alpha are trained on the range ALPHAS.
ALPHAS = [1e-8, 3e-8]
LUBRICANTS = {
    "lubricants": {
        "contact": "line", "grid": "x_min: -12, x_max: 2, step: 0.01", "M": [5, 50], "L": [1, 20], "candidates": 300,
        "own": "law: wlf, preset: no1", "moes": "M: 12, L: 12", "alpha_p_H": {"law: wlf, preset: no2": [0, 48]}},
    "lubricants-high": {
        "contact": "line", "grid": "x_min: -4, x_max: 2, step: 0.002", "M": [50, 1000], "L": [1, 20], "candidates": 300,
        "own": "law: wlf, preset: no1", "moes": "M: 100, L: 10",
        "alpha_p_H": {**{law: [4, 80] for law in LAWS}, "law: wlf, preset: no2": [4, 48], "law: wlf, preset: no3": [4, 64]}},
    "lubricants-point": {
        "contact": "point", "grid": "x_min: -8, x_max: 2, step: 0.125, y_max: 6, half: true", "M": [10, 46], "L": [2.5, 13],
        "candidates": 100, "own": "law: barus", "moes": "M: 20, L: 8", "own_alpha": 2.2e-8, "alpha_p_H": {}},
}
# Trainings in SI units on the loads and speeds of one contact with one oil. In the plan of the roller the grid follows
# from M and L; scene.yml has the same grid.
LOADS_AND_SPEEDS = {
    "roller": {
        "contact": "line", "grid": "x_min: -32, x_max: 2, step: 0.01", "chosen_grid": True,
        "bodies": "radius: 0.0125, modulus: 226e9, viscosity: 0.08", "load": [50e3, 400e3], "speed": [0.2, 10],
        "own": "load: 200e3, speed: 2", "viscosity": "law: roelands, eta0: 0.08, alpha: 2.0e-8"},
    "line-oils": {
        "contact": "line", "grid": "x_min: -6, x_max: 2, step: 0.01",
        "bodies": "radius: 0.0125, modulus: 230e9, viscosity: 0.04", "load": [150e3, 400e3], "speed": [0.8, 3],
        "own": "load: 250e3, speed: 1.5", "viscosity": "law: roelands, eta0: 0.04, alpha: 1.8e-8"},
    "point-oils": {
        "contact": "point", "grid": "x_min: -4, x_max: 2, step: 0.125, y_max: 3",
        "bodies": "radius: 0.01, modulus: 230e9, viscosity: 0.06", "load": [15, 60], "speed": [0.3, 1.2],
        "own": "load: 30, speed: 0.6", "viscosity": "law: roelands, eta0: 0.06, alpha: 1.6e-8"},
}

FILMS = ["central", "minimum"]
FORCES = ["friction_coefficient", "rolling_resistance"]  # of scenes that slide
RUN = ["promise", "where", "whose", "code", "central", "minimum", "indicated_central", "indicated_minimum", *FORCES, "fields",
       "full_central", "full_minimum", *(f"full_{force}" for force in FORCES)]
LEAST_OFF = 1e-7  # smaller deviations are not errors of the model


# ---- Trainings


def scene_text(contact, settings, viscosity, grid=""):
    """Returns a scene with lines of settings and the first density law."""
    return (f"contact: {contact}\nregime: stationary\n{settings}\nlubricant:\n  viscosity: {{{viscosity}}}\n"
            f"  density: {{law: {DENSITIES[0]}}}\n" + (f"grid: {{{grid}}}\n" if grid else ""))


def plan_of_lubricants(of):
    """Returns a plan with a group for each law, the law of scene.yml first."""
    plan = "groups:\n"
    for law in sorted(LAWS, key=lambda law: law != of["own"]):
        alpha = f", lubricant.viscosity.alpha: {ALPHAS}" if LAWS[law][0] is None else ""
        plan += (f"  - scene: {{contact: {of['contact']}, regime: stationary, grid: {{{of['grid']}}}, "
                 f"lubricant: {{viscosity: {{{law}}}}}}}\n"
                 f"    region: {{moes.M: {of['M']}, moes.L: {of['L']}{alpha}}}\n"
                 f"    vary: {{lubricant.density.law: [{', '.join(DENSITIES)}]}}\n"
                 f"    candidates: {of['candidates']}\n")
        if law in of["alpha_p_H"]:
            plan += f"    where: {{alpha_p_H: {of['alpha_p_H'][law]}}}\n"
    return plan


def training(name, folder):
    """Writes plan.yml and scene.yml. scene.yml is a trained contact, from which draw takes kind, grid and lubricant."""
    if name in LUBRICANTS:
        of = LUBRICANTS[name]
        own = of["own"] + (f", alpha: {of['own_alpha']}" if "own_alpha" in of else "")
        scene = scene_text(of["contact"], f"moes: {{{of['moes']}}}", own, of["grid"])
        plan = plan_of_lubricants(of)
    elif name in LOADS_AND_SPEEDS:
        of = LOADS_AND_SPEEDS[name]
        scene = scene_text(of["contact"], f"physical: {{{of['own']}, {of['bodies']}}}", of["viscosity"], of["grid"])
        trained = scene_text(of["contact"], f"physical: {{{of['bodies']}}}", of["viscosity"],
                             "" if of.get("chosen_grid") else of["grid"])
        plan = ("groups:\n  - scene:\n" + re.sub("^", " " * 6, trained, flags=re.M).rstrip() +
                f"\n    region: {{physical.load: {of['load']}, physical.speed: {of['speed']}}}\n")
    else:
        results.stop(f"found training '{name}', expected one of: {' '.join([*LUBRICANTS, *LOADS_AND_SPEEDS])}")
    os.makedirs(folder, exist_ok=True)
    results.write_changed(f"{folder}/plan.yml", plan)
    results.write_changed(f"{folder}/scene.yml", scene)


# ---- Scenes


def read_scene(file):
    """Returns kind of contact, lines of discretisation and grid, viscosity, line of physical settings (or empty), and
    density of a scene."""
    with open(file) as source:
        lines = {line.split(":")[0].strip(): line.rstrip() for line in source}
    return (re.sub(" *#.*", "", lines["contact"].split(":")[1]).strip(),
            "\n".join(lines[key] for key in ("discretization", "grid") if key in lines),
            re.sub("^[^{]*{|}.*", "", lines["viscosity"]), lines.get("physical", ""),
            re.sub(".*law: *([-a-z]+).*", r"\1", lines["density"]) if "density" in lines else DENSITIES[0])


def read_region(file):
    """Returns the bounds of the settings of the first region of a plan."""
    with open(file) as source:
        region = re.search(r"^ *region: *{(.*)}", source.read(), flags=re.M)
    bounds = dict(re.findall(r"([\w.]+): *\[(.*?)\]", region[1])) if region else {}
    if not bounds:
        results.stop(f"{file}: found no region in one line, expected one")
    return {key: [float(bound) for bound in pair.split(",")] for key, pair in bounds.items()}


def laws_of(viscosity):
    """Returns all laws, the law of the training first."""
    if "preset: no1" in viscosity:
        return LAWS
    alpha = re.search(r"alpha: *([-+.0-9e]+)", viscosity)
    if not alpha:
        results.stop(f"found viscosity {viscosity}, expected an alpha")
    return {viscosity: (float(alpha[1]), 1e12), **LAWS}


def hull_edges(points):
    """Returns the edges of the convex hull: pairs of points with all other points on their left, or on their line."""
    to = points[None] - points[:, None]
    turns = to[:, :, None, 0] * to[:, None, :, 1] - to[:, :, None, 1] * to[:, None, :, 0]
    rounding = 1e-12 * np.ptp(points, axis=0).prod()
    return [(points[i], points[j]) for i, j in np.argwhere(np.all(turns >= -rounding, axis=2)) if i != j]


def is_inside(edges, place):
    return all((b[0] - a[0]) * (place[1] - a[1]) >= (b[1] - a[1]) * (place[0] - a[0]) for a, b in edges)


def drawn_in_region(bounds, count, random):
    """Returns entries of scenes.json by (number of the law, number of the density). Their settings are inside of
    bounds, by turns distributed evenly, and evenly in the logarithm."""
    def settings(logarithmic):
        return {key: f"{np.exp(random.uniform(*np.log(pair))) if logarithmic else random.uniform(*pair):.12g}"
                for key, pair in bounds.items()}

    return {(0, 0): [{"where": "inside", "whose": "own", "settings": settings(i % 2 == 1)} for i in range(count)]}


def places_around_hull(contact, model, random):
    """Returns two functions: the first draws M and alpha p_H inside or outside of the convex hull of a model's training
    points, the second computes L."""
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

    return place, moes_L


def drawn_around_hull(laws, places, count, own, random):
    """Returns groups of scenes inside and outside, by (number of the law, number of the density)."""
    place, moes_L = places
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


def even_in_logarithm(random, low, high):
    return np.exp(random.uniform(*np.log((low, high))))


def drawn_oil(turn, viscosity, density, random):
    """Returns viscosity law, its parameters, highest Hertz pressure, and density law of an oil: by turns an oil near
    the trained oil, the trained oil with the other density law, and any oil."""
    other = DENSITIES[1 - DENSITIES.index(density)]
    law = re.sub(r"[, ]*(alpha|eta0): *[-+.0-9e]+", "", viscosity).strip()
    own = {key: float(value) for key, value in re.findall(r"(alpha|eta0): *([-+.0-9e]+)", viscosity)}
    if law not in LAWS:
        own = {"eta0": 0.05, **own}
    if turn < 2:
        spread = {"alpha": 0.08, "eta0": 0.2}
        near = {key: value * (1 + spread[key] * random.uniform(-1, 1) * (turn == 0)) for key, value in own.items()}
        return law, near, LAWS.get(law, (0, 1e12))[1], other if turn == 1 else density
    names = [name for name in LAWS if "wlf" in name] + ["law: barus", "law: roelands"] * 2
    law = names[random.integers(len(names))]
    density = DENSITIES[random.integers(len(DENSITIES))]
    if "wlf" in law:
        return law, {}, LAWS[law][1], density
    return law, {"alpha": random.uniform(1e-8, 3e-8), "eta0": even_in_logarithm(random, 0.004, 1)}, 1e12, density


def in_si_units(contact, M, hertz_pressure, eta0):
    """Returns load and speed of a contact of bodies with RADIUS and MODULUS."""
    if contact == "point":
        load = 2 * np.pi ** 3 / 3 * hertz_pressure ** 3 * RADIUS ** 2 / MODULUS ** 2
        speed_number = 0.5 * (load / (MODULUS * RADIUS ** 2) / M) ** (4 / 3)
    else:
        load = 2 * np.pi * hertz_pressure ** 2 * RADIUS / MODULUS
        speed_number = 0.5 * (load / (MODULUS * RADIUS) / M) ** 2
    return {"physical.load": load, "physical.speed": speed_number * MODULUS * RADIUS / eta0}


def drawn_oils(contact, viscosity, density, place, count, random):
    """Returns groups of scenes inside, by (law, density, law of shear stress)."""
    groups = {}
    for i in range(count):
        while True:
            law, drawn, limit, of_density = drawn_oil(i % 3, viscosity, density, random)
            M, alpha_p_H = place(True)
            alpha = drawn.get("alpha") or LAWS[law][0]
            if alpha_p_H / alpha <= limit:
                break
        shear = list(SHEARS)[random.integers(len(SHEARS))] if i % 2 else ""
        eta0 = drawn.get("eta0") or ETA0[law[-3:]]
        settings = in_si_units(contact, M, alpha_p_H / alpha, eta0)
        settings |= {f"lubricant.viscosity.{key}": value for key, value in drawn.items()}
        if shear:
            settings["slide_roll"] = even_in_logarithm(random, 0.01, 1)
            settings |= {f"lubricant.shear.{key}": even_in_logarithm(random, *pair) for key, pair in SHEARS[shear].items()}
        groups.setdefault((law, of_density, shear), []).append(
            {"where": "inside", "whose": ("near", "density", "any")[i % 3],
             "settings": {key: f"{value:.12g}" for key, value in settings.items()}})
    return groups


def draw(folder, seed, count, model, scene_file, of=""):
    """Draws random scenes. Writes plan.yml with its scene files, and scenes.json with an entry for each scene in the
    order of the plan."""
    contact, grid, viscosity, physical, density = read_scene(scene_file)
    laws = list(laws_of(viscosity).items())
    random = np.random.default_rng(int(seed))
    if of == "region":
        groups = drawn_in_region(read_region(f"{os.path.dirname(scene_file)}/plan.yml"), int(count), random)
    else:
        place, moes_L = places_around_hull(contact, model, random)
        groups = (drawn_oils(contact, viscosity, density, place, int(count), random) if of == "oils" else
                  drawn_around_hull(laws, (place, moes_L), int(count), of == "own", random))
    if of == "oils":
        physical = f"physical: {{radius: {RADIUS}, modulus: {MODULUS:g}}}"
    else:
        groups = {(laws[which][0], DENSITIES[of_density], ""): group
                  for (which, of_density), group in sorted(groups.items())}

    os.makedirs(folder, exist_ok=True)
    plan, scenes = "groups:\n", []
    for number, ((law, of_density, shear), group) in enumerate(groups.items()):
        scene = f"{folder}/scene-{number + 1}.yml"
        text = (f"contact: {contact}\nregime: stationary\nlubricant:\n  viscosity: {{{law}}}\n"
                f"  density: {{law: {of_density}}}\n" + (f"  shear: {{{shear}}}\n" if shear else "") + f"{grid}\n"
                + (f"{physical}\n" if of in ("region", "oils") else ""))
        results.write_changed(scene, text)
        plan += "  - scene:\n" + re.sub("^", " " * 6, text, flags=re.M).rstrip() + "\n    combine: list\n    vary:\n"
        for key in group[0]["settings"]:
            plan += f"      {key}: [{', '.join(entry['settings'][key] for entry in group)}]\n"
        scenes += [{"scene": scene, **entry} for entry in group]
    results.write_changed(f"{folder}/scenes.json", json.dumps(scenes, indent=0))
    results.write_changed(f"{folder}/plan.yml", plan)


# ---- Runs


def beyond_neighbours(field, other):
    """Returns the largest distance of a field ([x] or [y, x]) from the range of the other field at the node and its
    neighbours, and vice versa. So a shift by less than a node is no deviation."""
    def once(a, b):
        padded = np.pad(b, 1, mode="edge")
        around = [padded[tuple(slice(s, s + n) for s, n in zip(shift, b.shape))] for shift in np.ndindex(*[3] * b.ndim)]
        return max(np.max(a - np.max(around, axis=0)), np.max(np.min(around, axis=0) - a))
    return max(once(field, other), once(other, field))


def fields_off(file, pressure, film, central):
    """Returns the larger deviation of both fields: of P in Hertz pressures, and of H at nodes with pressure over the
    central film. A result file has both halves of a point contact; `pressure` and `film` may have only one (y >= 0)."""
    pressure, film = np.squeeze(pressure), np.squeeze(film)
    found = [np.squeeze(file[name][()])[-len(pressure):] for name in ("pressure", "film_thickness")]
    inside = pressure > 0
    film_off = beyond_neighbours(np.where(inside, found[1], 0), np.where(inside, film, 0))
    return max(beyond_neighbours(found[0], pressure), film_off / central)


def text_of(file, name):
    """Returns a number of an open file as text, or an empty text."""
    return repr(float(np.squeeze(file[name][()]))) if name in file else ""


def read_run(file, full, i):
    """Returns films, error estimates, forces and deviation of the fields as texts; missing values are empty."""
    if not os.path.exists(file):
        return [""] * (2 * len(FILMS) + len(FORCES) + 1)
    with h5py.File(file) as result:
        numbers = [f"{kind}{which}{end}" for kind, end in (("", "_film_thickness"), ("indicated", ""))
                   for which in FILMS]
        names = dict(zip(numbers[2:], ("indicated_deviation", "indicated_deviation_minimum")))
        found = [text_of(result, name) for name in [*(names.get(number, number) for number in numbers), *FORCES]]
        off = ""
        if full["status"][i] == results.SOLVED and int(np.squeeze(result["status"][()])) != results.NOT_CONVERGED:
            off = repr(float(fields_off(result, full["pressure"][i], full["film_thickness"][i],
                                        full["central_film_thickness"][i])))
    return found + [off]


def run(folder, model, settings, *promises):
    """Solves the scenes with each promise, two at a time. Writes the exit code of romrun, the values of read_run, and
    H_c and H_min of the full model (or empty). With the promise `none`, romrun gets no accuracy, so the limit is 1 %.
    settings: further options of romrun."""
    with open(f"{folder}/scenes.json") as source:
        scenes = json.load(source)
    with h5py.File(f"{folder}/full.h5") as file:
        full = {name: file[name][()] for name in
                ("status", "central_film_thickness", "minimum_film_thickness", "pressure", "film_thickness")}
    films = [[repr(float(full[f"{which}_film_thickness"][i])) if full["status"][i] == results.SOLVED else ""
              for which in FILMS] for i in range(len(scenes))]

    def full_forces(i, place):
        if "slide_roll" not in scenes[i]["settings"] or not films[i][0]:
            return [""] * len(FORCES)
        file = f"{place}/full-{i}.h5"
        results.run("fullrun", scenes[i]["scene"], "--quiet", "-o", file, *shlex.split(settings),
                    *results.sets(scenes[i]["settings"]))
        with h5py.File(file) as result:
            found = [text_of(result, force) for force in FORCES]
        os.remove(file)
        return found

    def solve(promise, i, place):
        asked = [] if promise == "none" else ["--accuracy", promise]
        file = f"{place}/{promise}-{i}.h5"
        done = results.run("romrun", scenes[i]["scene"], "--model", model, *asked, "--quiet", "-o", file,
                           "--set", "output.fields=true", *shlex.split(settings), *results.sets(scenes[i]["settings"]),
                           outcomes=range(-255, 256))
        found = read_run(file, full, i)
        if os.path.exists(file):
            os.remove(file)
        return done.returncode, *found

    runs = []
    with ThreadPoolExecutor(2) as two, tempfile.TemporaryDirectory() as place:
        forces = list(two.map(full_forces, range(len(scenes)), [place] * len(scenes)))
        for promise in promises:
            solved = two.map(solve, [promise] * len(scenes), range(len(scenes)), [place] * len(scenes))
            runs += [[promise, scene["where"], scene["whose"], *reduced, *whole, *whole_forces]
                     for scene, reduced, whole, whole_forces in zip(scenes, solved, films, forces)]
    results.write_csv(f"{folder}/runs.csv", RUN, runs)


# ---- Table


def promised(run):
    return 0.01 if run["promise"] == "none" else float(run["promise"])


def off_of(run, which):
    return abs(float(run[which]) / float(run[f"full_{which}"]) - 1)


def outcome(run):
    """Returns the outcome of a run, and the larger deviation of both films. A run is good if both films deviate by no
    more than the promise, and flagged if the exit code is 4. A run that does not converge (exit code 3) has no result
    that could be wrong."""
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
    """Prints the errors of the fields of results that are not flagged, over the promise for the films."""
    quiet = [float(run["fields"]) / promised(run) for run in runs if run["code"] == "0" and run["fields"]]
    if quiet:
        far = sum(off > 3 for off in quiet)
        print(f"  fields off by more than 3 times that, not flagged: {far} of {len(quiet)}; "
              f"the worst {max(quiet):.2g} times")


def print_forces(runs):
    """Prints the errors of the forces of results that are not flagged, over the promise for the films."""
    for force in FORCES:
        quiet = [off_of(run, force) / promised(run) for run in runs
                 if run["code"] == "0" and run[force] and run[f"full_{force}"]]
        if quiet:
            print(f"  {force.replace('_', ' ')} off by more than that, not flagged: {sum(off > 1 for off in quiet)} of "
                  f"{len(quiet)}; the worst {max(quiet):.2g} times")


def print_effectivity(runs):
    """Prints ratios of error estimate to true error, for solved scenes inside."""
    for which in FILMS:
        over = [float(run[f"indicated_{which}"]) / off_of(run, which) for run in runs
                if run["where"] == "inside" and outcome(run)[0].startswith(("good", "bad"))
                and run[f"indicated_{which}"] and off_of(run, which) > LEAST_OFF]
        if over:
            median, most = np.quantile(over, [0.5, 0.95])
            print(f"  indicated over true deviation inside, {which} film: {sum(one < 1 for one in over)} of {len(over)} "
                  f"below 1, least {min(over):.2g}, median {median:.2g}, 95 % {most:.2g}")


def table(file, seed, calibration):
    """Prints the numbers of flagged and of other results."""
    groups = {"inside own": "inside, own lubricant", "inside other": "inside, other lubricants",
              "outside": "outside, any lubricant", "inside near": "near it", "inside density": "of the other density",
              "inside any": "any oil"}
    lines = list(results.read_csv(file))
    drawn = {f"{line['where']} {line['whose']}" for line in lines}
    groups = {group: name for group, name in groups.items() if any(one.startswith(group) for one in drawn)}
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
        print_forces(mine)
        print_effectivity(mine)
    silent = [off for *_, what, off in runs if what == "bad not flagged"]
    errors = sum(what == "error" for *_, what, _ in runs)
    print(f"\nsilent failures: {len(silent)}" + (f", the worst {max(silent):.2g} off" if silent else ""))
    if errors:
        print(f"found {errors} runs that ended otherwise, expected none")
        sys.exit(1)


if __name__ == "__main__":
    results.commands(training, draw, run, table)
