# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares films and friction of reduced models with the full model on unseen scenes, and measures their cost
(README.md):

    study.py plan FOLDER/KIND-FLOW.yml                  writes the plan of a model; FLOW: thinned, newton
    study.py flow FOLDER SCENES SEED OPTIONS...         models of flows that sliding thins
    study.py friction FOLDER SCENES SEED OPTIONS...     friction of flows that sliding does not thin, all shear laws
"""
import csv
import os
import re
import subprocess
import sys

import numpy as np

import results

# Contacts of steel bodies: lines of the scene, load in N or N/m, radius and speed, grid, and bounds of load and speed
# in the training.
KINDS = {
    # a cylinder on a flat
    "line": ("contact: line", 1.5e5, "radius: 0.01, speed: 1", "x_min: -4, x_max: 2, step: 0.01", (1e5, 3e5), (0.5, 2)),
    # a ball on a flat
    "point": ("contact: point", 60, "radius: 0.0127, speed: 0.8",
              "x_min: -3, x_max: 1.5, step: 0.0625, y_max: 2, half: true", (30, 90), (0.4, 1.2)),
    # the ball under small loads
    "light": ("contact: point", 7, "radius: 0.0127, speed: 0.8",
              "x_min: -4, x_max: 2, step: 0.0625, y_max: 2.5, half: true", (4, 12), (0.4, 1.2)),
    # a barrel on a flat, three times as long across as along
    "ellipse": ("contact: ellipse\nellipticity: 3", 180, "radius: 0.0127, speed: 0.8",
                "x_min: -3, x_max: 1.5, step: 0.0625, y_max: 1.5, half: true", (90, 270), (0.4, 1.2)),
}
# Bounds of further settings that the plan of a flow varies. Without further settings the flow is Newtonian.
FLOWS = {"thinned": {"slide_roll": (0.1, 1), "lubricant.shear.tau0": (3e6, 10e6)}, "newton": {}}

NAMES = {"central film": "central_film_thickness", "minimum film": "minimum_film_thickness",
         "friction": "friction_coefficient"}
NEWTONIAN = {"lubricant.shear.in_film": "false"}
COUNTED, COUNTED_SLIDING = 5, 2  # scenes whose instructions are counted
LAWS = {"newtonian": {"law": "newtonian"}, "eyring 3 MPa": {"law": "eyring", "tau0": 3e6},
        "eyring 10 MPa": {"law": "eyring", "tau0": 10e6}, "limiting 0.05 p": {"law": "limiting", "limit": 0.05},
        "carreau 5 MPa, 0.5": {"law": "carreau", "G": 5e6, "n": 0.5}}
LOW_M = 10  # below this M, Newtonian friction is more sensitive to errors of the pressure


def scene_text(kind):
    """Returns a scene with a mineral oil whose flow is thinned by sliding."""
    contact, load, body, grid, *_ = KINDS[kind]
    return (f"{contact}\nregime: stationary\nphysical: {{load: {load}, {body}, modulus: 2.3e11, viscosity: 0.05}}\n"
            "slide_roll: 0.3\nlubricant:\n  viscosity: {law: barus, alpha: 18e-9}\n  density: {law: dowson-higginson}\n"
            f"  shear: {{law: eyring, tau0: 5e6, in_film: true}}\ngrid: {{{grid}}}\n")


def region(kind, flow):
    """Returns the bounds of what a plan varies."""
    load, speed = KINDS[kind][-2:]
    return {"physical.load": load, "physical.speed": speed, **FLOWS[flow]}


def plan_text(kind, flow):
    scene = re.sub("^", " " * 6, scene_text(kind), flags=re.M).rstrip()
    bounds = ", ".join(f"{key}: [{low:g}, {high:g}]" for key, (low, high) in region(kind, flow).items())
    newtonian = "" if FLOWS[flow] else "    vary: {lubricant.shear.in_film: ['false']}\n"
    return f"groups:\n  - scene:\n{scene}\n    region: {{{bounds}}}\n{newtonian}"


def plan(file):
    kind, flow = os.path.splitext(os.path.basename(file))[0].split("-")
    results.write_changed(file, plan_text(kind, flow))


def scene_file(kind, folder):
    """Writes a scene; returns its file."""
    file = f"{folder}/{kind}.yml"
    results.write_changed(file, scene_text(kind))
    return file


def solved(program, scene, file, settings, *options):
    """Runs a program. Returns values of its result, and whether the result is trusted."""
    done = results.run(program, scene, "-o", file, "--force", "--quiet", *options, *results.sets(settings))
    columns = results.printed(file, *NAMES.values())
    return {"trusted": done.returncode == results.SOLVED,
            **{name: float(columns[field][0]) for name, field in NAMES.items()}}


def instructions(scene, model, file, settings, options, functions=("online_solve",)):
    """Returns the number of instructions of some functions in a run, counted by callgrind."""
    done = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={file}.callgrind",
                           *(f"--toggle-collect={name}" for name in functions),
                           os.path.join(os.environ["BIN"], "romrun"), scene,
                           "--model", model, "-o", file, "--force", "--quiet", *map(str, options),
                           *results.sets(settings)],
                          capture_output=True, text=True)
    return int(re.search(r"Collected : (\d+)", done.stderr)[1])


def compare(kind, folder, scenes, options):
    model, newton = f"{folder}/{kind}-thinned.h5", f"{folder}/{kind}-newton.h5"
    contact, file = scene_file(kind, folder), f"{folder}/solution.h5"
    full = [solved("fullrun", contact, file, scene, *options) for scene in scenes]
    reduced = [solved("romrun", contact, file, scene, "--model", model, *options) for scene in scenes]
    newtonian = [solved("fullrun", contact, file, {**scene, **NEWTONIAN}, *options) for scene in scenes]
    sizes = results.model_sizes(newton)
    for name, of in ("thinned", results.model_sizes(model)), ("Newtonian", sizes):
        print(f"{kind}, {name}: {of['nodes']} nodes, {of['states']} points, {of['pressure_modes']} modes, "
              f"{of['rows']} rows")
    print(f"{len(scenes)} scenes, {sum(r['trusted'] for r in reduced)} to be trusted")
    print(f"{'':14}{'median off':>12}{'worst off':>12}{'thinning, median':>18}{'most':>9}")
    for name in NAMES:
        off = np.abs([r[name] / f[name] - 1 for r, f in zip(reduced, full)])
        moved = np.abs([n[name] / f[name] - 1 for n, f in zip(newtonian, full)])
        print(f"{name:14}{np.median(off):12.1e}{off.max():12.1e}{np.median(moved):18.1e}{moved.max():9.1e}")
    cut = ["--pressure-modes", sizes["pressure_modes"], "--rows", sizes["rows"], "--allow-untrusted"]
    runs = {"thinned": (model, {}, []), "thinned, cut to the size of": (model, {}, cut),
            "the Newtonian one": (newton, NEWTONIAN, [])}
    print(f"{'':28}{'instructions':>14}{'iterations':>12}{'an iteration':>14}")
    for name, (of, settings, more) in runs.items():
        counted = [(instructions(contact, of, file, {**scene, **settings}, [*more, *options]),
                    results.value(file, "newton_iterations")) for scene in scenes[:COUNTED]]
        cost, steps = np.mean(counted, axis=0)
        print(f"{name:28}{cost:14.3g}{steps:12.2f}{cost / steps:14.3g}")
    print()


def drawn(bounds, count, seed):
    """Returns random scenes between bounds, distributed evenly in the logarithms."""
    random = np.random.default_rng(int(seed))
    return [{key: f"{low * (high / low) ** random.random():.6g}" for key, (low, high) in bounds.items()}
            for _ in range(int(count))]


def flow(folder, count, seed, *options):
    for kind in "line", "point":
        compare(kind, folder, drawn(region(kind, "thinned"), count, seed), options)


# ---- Friction of a flow that is not thinned


def share_of_friction(contact, model, file, scenes, options):
    """Returns the instructions of a solution without sliding, and the relative increase by sliding, by its friction,
    and by the error estimate of the friction."""
    still = {"slide_roll": "", "lubricant.shear.law": "", "lubricant.shear.tau0": "", "lubricant.shear.in_film": ""}
    solution = ["online_solve"]
    costs = []
    for scene in scenes[:COUNTED_SLIDING]:
        counts = [instructions(contact, model, file, {**scene, **settings}, options, functions) for settings, functions in
                  ((still, solution), (NEWTONIAN, solution), (NEWTONIAN, solution + ["online_traction"]),
                   (NEWTONIAN, solution + ["online_traction", "online_indicate_friction"]))]
        costs.append([counts[0], *(count / counts[0] - 1 for count in counts[1:])])
    return np.mean(costs, axis=0)


def told(contact, settings, *options):
    """Runs the full model. Returns friction coefficient and M from its output."""
    text = results.run("fullrun", contact, "--quiet", *options, *results.sets(settings)).stdout
    return float(re.search(r"^friction coefficient +(\S+)", text, re.M)[1]), float(re.search(r"M = ([^,]+)", text)[1])


def of_law(settings):
    return {"lubricant.shear.tau0": "", "lubricant.shear.in_film": "",
            **{f"lubricant.shear.{key}": value for key, value in settings.items()}}


def frictions(kind, folder, scenes, options):
    model, film, cases, table = (f"{folder}/{kind}-newton.h5", *(f"{folder}/{name}" for name in
                                                                 ("film.h5", "cases.csv", "table.csv")))
    contact = scene_file(kind, folder)
    full = {law: [] for law in LAWS}
    for scene in scenes:
        M = told(contact, {**scene, **NEWTONIAN}, "-o", film, "--force", *options)[1]
        for law, settings in LAWS.items():  # all with the same film
            full[law].append((told(contact, {**scene, **of_law(settings)}, "--start", film, *options)[0], M))
    M = np.array([M for _, M in full["newtonian"]])
    with open(cases, "w", newline="") as file:
        writer = csv.DictWriter(file, scenes[0])
        writer.writeheader()
        writer.writerows(scenes)
    sizes = results.model_sizes(model)
    print(f"{kind}: {sizes['nodes']} nodes, {sizes['states']} points, {sizes['pressure_modes']} modes, "
          f"{sizes['rows']} rows; {len(scenes)} scenes, M of {M.min():.3g} to {M.max():.3g}, {(M < LOW_M).sum()} below {LOW_M}")
    print(f"{'friction off':20}{'median':>10}{'worst':>10}{f'M < {LOW_M}':>10}{'indicated':>11}{'trusted':>9}")
    for law, settings in LAWS.items():
        results.run("romrun", "cases", contact, cases, "--model", model, "-o", table, "--force", "--quiet",
                    *options, *results.sets(of_law(settings)))
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        off = np.abs([float(row["friction_coefficient"]) / there[0] - 1 for row, there in zip(rows, full[law])])
        indicated = np.median([float(row["indicated_deviation_friction"]) for row in rows])
        # a friction above the load, as of a Newtonian fluid, says nothing about the model
        trusted = sum(row["status"] == "0" or row["reason"].startswith("a friction above") for row in rows)
        print(f"{law:20}{np.median(off):10.1e}{off.max():10.1e}{max(off[M < LOW_M], default=np.nan):10.1e}"
              f"{indicated:11.1e}{trusted:9}")
    cost, solution, traction, indicated = share_of_friction(contact, model, table + ".h5", scenes, options)
    print(f"instructions: {cost:.3g} a solution that does not slide; one that does {100 * solution:+.2f} %, with its "
          f"friction {100 * traction:+.2f} %, and what is indicated of that {100 * indicated:+.2f} %\n", flush=True)


def friction(folder, count, seed, *options):
    for kind in "line", "light", "point", "ellipse":
        scenes = drawn({**region(kind, "newton"), "slide_roll": (1e-3, 1)}, count, seed)
        frictions(kind, folder, scenes, options)


if __name__ == "__main__":
    results.commands(plan, flow, friction)
