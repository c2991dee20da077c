# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the errors of both discretisations against the converged solution (README.md):

    study.py stationary FOLDER LINE_STEPS POINT_STEPS    errors of the films of line and point contacts
    study.py random FOLDER KIND COUNT SEED LIMIT         errors of random scenes, estimated by fullrun and true
    study.py in-time FOLDER SCENE.yml STEPS END          errors of the films under an oscillating load
    study.py estimates FOLDER STEPS ALL_M ALL_L          errors due to the step, estimated by fullrun and true
    study.py interpolated FOLDER STEP                    estimates that romrun interpolates, and estimates of fullrun
    study.py indicated FOLDER                            errors of the reduction, estimated by romrun and true (run
                                                         interpolated before)
    study.py inlets FOLDER STEP ALL_M ALL_L              effect of an inlet from X = -4 on both films
    study.py point-inlets FOLDER STEP ALL_M ALL_L        effect of a domain from X = -8 on point contacts, estimated by
                                                         fullrun and true
    study.py truth FOLDER MODES STEPS                    errors and times of formulas and models: truth.csv
    study.py draw FOLDER                                 draws FOLDER/truth.png, .svg

STEPS of a grid are a list in one argument, from coarse to fine. The reference has the accurate discretisation. In
stationary scenes it is extrapolated from the last two steps. In transient scenes it has the last step, and time steps
of half this length.
"""
import math
import os
import random as draws
import re
import subprocess
import sys

import numpy as np

import pictures
import results

# kind of contact, M, L, viscosity, density
BARUS, ROELANDS = "law: barus, alpha: 20e-9", "law: roelands, eta0: 0.04, alpha: 20e-9"
CASES = [("line", 20, 10, BARUS, "incompressible"), ("line", 120, 10, BARUS, "incompressible"),
         ("line", 100, 3, BARUS, "dowson-higginson"), ("line", 40, 9, ROELANDS, "dowson-higginson"),
         ("line", 200, 12, ROELANDS, "dowson-higginson"), *(("point", M, 10, BARUS, "incompressible")
                                                             for M in (10, 20, 50, 100))]
DOMAINS = {"line": "x_min: -4, x_max: 2", "point": "x_min: -4.5, x_max: 1.5, y_max: 3"}


EFFECTS = ["step_effect", "step_effect_minimum"]
INLETS = ["inlet_effect", "inlet_effect_minimum"]
BOTH = {"Barus": (BARUS, "incompressible"), "Roelands": (ROELANDS, "dowson-higginson")}
LIMITS = 0.01, 0.03  # errors of central and smallest film above which fullrun prints a note
LEAST = 1e-4         # smaller effects are not counted


def solve(folder, case, step, discretization, domain=None):
    """Returns the solution of a case, with the estimates of fullrun for step and inlet."""
    kind, M, L, viscosity, density = case
    domain = domain or DOMAINS[kind]
    boundary = f"boundary: {os.environ['POINT_BOUNDARY']}\n" if kind == "point" else ""  # for both discretisations
    where = "" if domain == DOMAINS[kind] else "-" + "".join(c for c in domain if c in "-.0123456789")
    file = f"{folder}/{kind}-{M}-{L}-{viscosity.split(',')[0].split()[-1]}-{discretization}-{step}{where}"
    results.write_changed(f"{file}.yml", f"""contact: {kind}
regime: stationary
moes: {{M: {M}, L: {L}}}
lubricant: {{viscosity: {{{viscosity}}}, density: {{law: {density}}}}}
grid: {{{domain}, step: {step}}}
discretization: {discretization}
{boundary}output: {{fields: false}}
""")

    def run():
        results.run("fullrun", f"{file}.yml", "-q", "-o", f"{file}.h5", "--force", "--allow-untrusted",
                    outcomes=(results.SOLVED, results.NOT_CONVERGED))
        return {**results.solution(f"{file}.h5"), **{name: results.value(f"{file}.h5", name) for name in EFFECTS + INLETS}}
    return results.kept(f"{file}.json", run, f"{file}.yml", os.path.join(os.environ["BIN"], "fullrun"))


def films(folder, case, step, discretization, domain=None):
    """Returns central and smallest film of a case. Stops if it does not converge."""
    found = solve(folder, case, step, discretization, domain)
    if found["status"] == results.NOT_CONVERGED:
        results.stop(f"found {case} not converged with {discretization} rows and step {step}, expected a solution")
    return np.array([found["H_c"], found["H_min"]])


def stationary(folder, line_steps, point_steps):
    rows = [["contact", "M", "L", "viscosity", "density", "rows", "step", "H_c", "H_min"], None]
    for case in CASES:
        steps = {"line": line_steps, "point": point_steps}[case[0]].split()
        coarse, fine = (films(folder, case, step, "accurate") for step in steps[-2:])
        exact = fine + (fine - coarse) / 3
        for discretization in "published", "accurate":
            for step in steps[:-2]:
                off = films(folder, case, step, discretization) / exact - 1
                rows.append([*case[:3], case[3].split(",")[0].split()[-1], case[4], discretization, step,
                             *(f"{x:+.1e}" for x in off)])
    print("relative errors of central and smallest film, against the extrapolated film of the accurate rows\n")
    results.table([*rows, None], left=0)


def limit(folder, case, steps):
    """Returns the films to which the accurate discretisation converges, extrapolated from the last three steps. The
    order is that of these steps, limited to 1 … 4."""
    coarse, middle, fine = (films(folder, case, step, "accurate") for step in steps)
    with np.errstate(all="ignore"):
        order = np.log2((coarse - middle) / (middle - fine))
    order = np.clip(np.where(np.isfinite(order), order, 2), 1, 4)
    return fine + (fine - middle) / (2**order - 1)


def estimates(folder, steps, all_M, all_L):
    """Compares estimated and true effects of the step at all points, with both lubricants. The last three steps give
    the reference."""
    *steps, third, second, last = steps.split()
    cases = [("line", M, L, *lubricant) for lubricant in BOTH.values() for M in all_M.split() for L in all_L.split()]
    exact = [limit(folder, case, (third, second, last)) for case in cases]
    rows = [["rows", "step", "film", "solved", "too coarse", "counted", "below 1/3", "below 1/2", "above 2", "above 3",
             "10 %", "median", "90 %", "notes wrong", "missed"], None]
    for discretization in "published", "accurate":
        for step in steps:
            found = [solve(folder, case, step, discretization) for case in cases]
            found, limits = zip(*((it, of) for it, of in zip(found, exact) if it["status"] != results.NOT_CONVERGED))
            for i, film in enumerate(("H_c", "H_min")):
                estimated = np.abs([it[EFFECTS[i]] for it in found])
                true = np.abs([of[i] / it[film] - 1 for of, it in zip(limits, found)])
                known = ~np.isnan(estimated)
                counted = known & (np.fmax(estimated, true) > LEAST)
                ratios = estimated[counted] / true[counted]
                rows.append([discretization, step, film, len(found), sum(~known), sum(counted), sum(ratios < 1 / 3),
                             sum(ratios < 0.5), sum(ratios > 2), sum(ratios > 3),
                             *(f"{x:.2g}" for x in np.percentile(ratios if len(ratios) else np.nan, [10, 50, 90])),
                             sum((estimated > LIMITS[i]) & (true <= LIMITS[i])),
                             sum(known & (estimated <= LIMITS[i]) & (true > LIMITS[i]))])
    print("estimated over true effect of the step, where one of them is above 1e-4\n")
    results.table([*rows, None])


def interpolated(folder, step):
    """Compares the estimates of a model of 70 points with those of fullrun, for 35 scenes between the points."""
    names = ["step_effect", "step_effect_minimum", "inlet_effect", "inlet_effect_minimum"]
    scene, plan = f"{folder}/between.yml", f"{folder}/between-plan.yml"
    results.write_changed(scene, f"""contact: line
regime: stationary
moes: {{M: 20, L: 7}}
lubricant: {{viscosity: {{{BARUS}}}, density: {{law: dowson-higginson}}}}
grid: {{{DOMAINS["line"]}, step: {step}}}
""")
    results.write_changed(plan, """groups:
  - scene: between.yml
    vary:
      moes.M: [8, 10, 12, 15, 18, 22, 27, 33, 40, 50]
      moes.L: [2, 3.5, 5, 6.5, 8, 9.5, 11]
""")
    rows = [["rows", "effect", "least", "10 %", "median", "90 %", "most", "within 2"], None]
    for discretization in "published", "accurate":
        file, options = f"{folder}/between-{discretization}", ["--set", f"discretization={discretization}", "-q", "-f"]
        results.run("snapgen", plan, "-o", f"{file}-s.h5", *options, outcomes=(results.SOLVED,))
        results.run("podbuild", f"{file}-s.h5", "-o", f"{file}-b.h5", "-f", outcomes=(results.SOLVED,))
        results.run("snapgen", plan, "--basis", f"{file}-b.h5", "-o", f"{file}-r.h5", *options,
                    outcomes=(results.SOLVED,))
        results.run("deimselect", f"{file}-r.h5", "--basis", f"{file}-b.h5", "-o", f"{file}.h5", "-f", "--no-check",
                    outcomes=(results.SOLVED,))
        ratios = []
        for M in 9, 11, 14, 20, 25, 30, 45:
            for L in 2.6, 4.2, 5.8, 7.3, 10.3:
                here = [*options, *results.sets({"moes.M": M, "moes.L": L})]
                results.run("fullrun", scene, "-o", f"{file}-full.h5", *here, outcomes=(results.SOLVED,))
                results.run("romrun", scene, "--model", f"{file}.h5", "-o", f"{file}-reduced.h5", "--allow-untrusted", *here,
                            outcomes=(results.SOLVED,))
                ratios.append([abs(results.value(f"{file}-reduced.h5", name) / results.value(f"{file}-full.h5", name))
                               for name in names])
        for name, of in zip(names, np.transpose(ratios)):
            rows.append([discretization, name, *(f"{x:.2f}" for x in np.percentile(of, [0, 10, 50, 90, 100])),
                         f"{sum((of > 0.5) & (of < 2))} of {len(of)}"])
    print("interpolated over own estimate\n")
    results.table([*rows, None], left=2)


def indicated(folder):
    """Compares estimated and true errors of the model of interpolated(), which is calibrated here on 20 scenes. Uses 35
    other scenes and every sixth size of the model."""
    scene, model = f"{folder}/between.yml", f"{folder}/between-calibrated.h5"
    results.write_changed(f"{folder}/between-check.yml", """groups:
  - scene: between.yml
    vary:
      moes.M: [9, 13.5, 20, 30, 45]
      moes.L: [2.6, 5.8, 7.3, 10.3]
""")
    results.run("romrun", "calibrate", f"{folder}/between-check.yml", "--model", f"{folder}/between-accurate.h5",
                "-o", model, "-q", "-f", outcomes=(results.SOLVED,))
    sizes = results.printed(model, "position_pressure_modes", "position_rows", "indicator_factor")
    full, films = f"{folder}/indicated-full.h5", ("central_film_thickness", "minimum_film_thickness")
    rows = [["modes", "rows", "film", "solved", "deviation", "least", "5 %", "median", "95 %", "below"], None]
    for modes, count, factor in list(zip(*sizes.values()))[5::6]:
        found = []
        for M in 9.7, 11, 14, 22, 25, 33, 42:
            for L in 2.9, 4.2, 6.4, 8.1, 10:
                here = ["-q", "-f", *results.sets({"moes.M": M, "moes.L": L})]
                results.run("fullrun", scene, "--grid-of", model, "-o", full, *here, outcomes=(results.SOLVED,))
                done = results.run("romrun", scene, "--model", model, "-o", f"{folder}/indicated.h5", *here,
                                   "--pressure-modes", int(modes), "--rows", int(count))
                far_off = "found an indicated deviation" in done.stderr
                if (done.returncode == results.SOLVED or far_off) and factor > 0:
                    found.append([(abs(results.value(f"{folder}/indicated.h5", film) / results.value(full, film) - 1),
                                   results.value(f"{folder}/indicated.h5", name))
                                  for film, name in zip(films, ("indicated_deviation", "indicated_deviation_minimum"))])
        for i, film in enumerate(("H_c", "H_min") if found else ()):
            true, said = np.transpose([it[i] for it in found])
            ratios = said / true
            rows.append([int(modes), int(count), film, len(found), f"{np.median(true):.1e}", f"{ratios.min():.2f}",
                         *(f"{x:.2g}" for x in np.percentile(ratios, [5, 50, 95])), sum(ratios < 1)])
    print("indicated over true deviation from the full model\n")
    results.table([*rows, None], left=0)


def inlets(folder, step, all_M, all_L):
    """Prints the relative change of the central film that an inlet from X = -32 causes, and the ratio of the change of
    the smallest film to that of the central film."""
    rows = [["viscosity", "M", *(f"L = {L}" for L in all_L.split())], None]
    for name, lubricant in BOTH.items():
        for M in all_M.split():
            cases = [("line", M, L, *lubricant) for L in all_L.split()]
            changes = [films(folder, case, step, "accurate", "x_min: -32, x_max: 2") /
                       films(folder, case, step, "accurate") - 1 for case in cases]
            rows.append([name, M, *(f"{central:.1e}, {minimum / central:.2f}" for central, minimum in changes)])
    print("change of H_c by a long inlet, and that of the smallest film over it\n")
    results.table([*rows, None], left=1)


def point_inlets(folder, step, all_M, all_L):
    """Prints the relative change of both films that an infinite domain causes, and the estimates of fullrun. The change
    is proportional to 1/length. It is extrapolated from two long domains on grids of twice the step."""
    def domain(length):
        return f"x_min: -{length}, x_max: {length / 4}, y_max: {0.75 * length}"

    rows = [["M", *(f"L = {L}" for L in all_L.split())], None]
    for M in all_M.split():
        cells = [M]
        for L in all_L.split():
            case = ("point", M, L, BARUS, "incompressible")
            short, long, longer = (films(folder, case, 2 * float(step), "accurate", domain(x)) for x in (8, 24, 48))
            found = solve(folder, case, step, "accurate", domain(8))
            true = (2 * longer - long) / short - 1
            cells.append(", ".join(f"{100 * found[name]:.2g} ({100 * of:.2g})" for name, of in zip(INLETS, true)))
        rows.append(cells)
    print("estimated (true) effect of a domain from -8 on in per cent, of H_c and of the smallest film\n")
    results.table([*rows, None], left=1)


class RandomScene:
    """A random contact on its default grid or, in 64 % of the draws, on a coarser or shorter grid."""

    def __init__(self, folder, kind, numbers, limit):
        self.limit = limit  # of the time of a solution, s
        most = 400 if kind == "line" else 100
        viscosity, density = numbers.choice(list(BOTH.values()))
        self.is_line = kind == "line"
        self.settings = {"moes.M": f"{math.exp(numbers.uniform(math.log(0.7), math.log(most))):.4g}",
                         "moes.L": f"{0 if numbers.random() < 0.15 else numbers.uniform(0, numbers.choice((10, 25))):.3g}"}
        if kind == "ellipse":
            self.settings["ellipticity"] = f"{math.exp(numbers.uniform(math.log(0.3), math.log(5))):.3g}"
        self.coarser, self.shorter = numbers.choice((1, 1, 1, 2, 4)), numbers.choice((1, 1, 1, 0.7, 0.5))
        self.file = f"{folder}/random-{kind}"
        results.write_changed(f"{self.file}.yml", f"""contact: {kind}
regime: stationary
moes: {{M: 1, L: 1}}
lubricant: {{viscosity: {{{viscosity}}}, density: {{law: {density}}}}}
output: {{fields: false}}
""")

    def run(self, grid, resolution=False):
        """Returns the output of fullrun, or an empty text if there is no solution."""
        done = results.run("fullrun", f"{self.file}.yml", "-q", "-o", f"{self.file}.h5", "-f", "--allow-untrusted",
                           *results.sets({**self.settings, "output.resolution": str(resolution).lower(),
                                          **{f"grid.{key}": f"{x:.12g}" for key, x in grid.items()}}), outcomes=range(256),
                           limit=self.limit)
        return done.stdout if done.returncode == results.SOLVED else ""

    def films(self, grid):
        solved = self.run(grid) and results.solution(f"{self.file}.h5")
        return np.array([solved["H_c"], solved["H_min"]]) if solved else np.full(2, np.nan)

    def choose_grid(self):
        """Chooses the grid. Returns False if there is no solution on the default grid."""
        found = re.search(r"^grid +(?:\d+ by )?(\d+) nodes from (\S+) to (\S+) by ([\d.e-]+)", self.run({}), re.M)
        if not found:
            return False
        self.x_min, self.x_max, self.step = (float(x) for x in found.groups()[1:])
        self.cell = float(self.settings.get("ellipticity", 1)) ** (-1 / 3)  # width of a cell in b over its length in a
        self.y_max = (int(found[1]) - 1) / 2 * self.cell * self.step
        self.step *= self.coarser
        if not self.is_line:
            self.step = min(self.step, 0.25)
        return True

    def grid(self, length=1, step=None):
        """Returns the grid of a domain that is longer and wider by a factor, of whole steps."""
        length, step = length * self.shorter, step or self.step
        x_max = self.x_max * max(1, length)  # on wide domains some exits of points lie downstream
        x_min = x_max - math.ceil((x_max - min(length * self.x_min, -1.25)) / step - 1e-6) * step
        if self.is_line:
            return {"x_min": x_min, "x_max": x_max, "step": step}
        sides = math.ceil(max(length, 0.7) * self.y_max / (step * self.cell) - 1e-6) * step * self.cell
        return {"x_min": x_min, "x_max": x_max, "y_max": max(sides, 1.5), "step": step}

    def domain_effects(self, finer):
        """Returns the relative change of both films that an infinite domain causes. finer: films with half the step."""
        short, long, longer = (self.films(self.grid(by)) for by in (1, 2, 4))
        changes = (longer + (longer - long) / 3 - short) / short
        if self.is_line:
            return changes
        # The place of the minimum film of a point contact jumps from node to node. So its change is measured only for
        # twice the domain, with half the step. It is multiplied by the ratio of the changes of the central film for an
        # infinite domain and for twice the domain. If the central film hardly changes, this ratio has no meaning. It is
        # therefore limited to 2, which is the ratio if the effect falls with the first power of the size.
        beyond = np.clip(changes[0] / (long[0] / short[0] - 1), 1, 2)
        return beyond * (self.films(self.grid(2, self.step / 2)) / finer - 1)

    def compare(self):
        """Returns estimated and true errors of both films due to step and inlet; None: the grid is too coarse."""
        own = self.grid()
        text = self.run(own, resolution=True)
        said = np.array([results.value(f"{self.file}.h5", name) for name in EFFECTS + INLETS]) if text else None
        if said is None or "too coarse" in text:
            return None
        finer = [self.films({**own, "step": self.step / by}) for by in (1, 2, 4)]
        exact = finer[2] + (finer[2] - finer[1]) / 3  # at most of second order
        return np.array([said, np.abs([*(exact / finer[0] - 1), *self.domain_effects(finer[1])])])


def random(folder, kind, count, seed, limit):
    """Compares estimates and errors of COUNT random scenes of a kind. The reference of a point contact needs sixteen
    times as many nodes as its own grid. A scene is left out if one of its solutions takes more than LIMIT seconds."""
    numbers, compared, coarse, left_out = draws.Random(int(seed)), [], 0, 0
    while len(compared) + coarse + left_out < int(count):
        scene = RandomScene(folder, kind, numbers, float(limit))
        try:
            if scene.choose_grid():
                found = scene.compare()
                coarse += found is None
                compared += [] if found is None else [found]
        except subprocess.TimeoutExpired:
            left_out += 1
    if not compared:
        results.stop(f"found none of {count} scenes to compare, expected some")
    said, true = np.moveaxis(compared, 1, 0)
    rows = [["error", "scenes", "below 1", "least", "5 %", "median", "95 %"], None]
    for name, over in [*zip(["step: H_c", "H_m", "inlet: H_c", "H_m"], (said / true).T),
                       *((f"both: {film}", (said[:, i] + said[:, 2 + i]) / (true[:, i] + true[:, 2 + i]))
                         for i, film in enumerate(("H_c", "H_m")))]:
        over = over[np.isfinite(over)]
        rows.append([name, len(over), sum(over < 1), *(f"{x:.2g}" for x in np.percentile(over, [0, 5, 50, 95]))])
    print(f"{kind}: estimate over error; {coarse} of {count} scenes too coarse to tell, {left_out} too slow\n")
    results.table([*rows, None], left=1)


def in_time(folder, scene, steps, end):
    *steps, finest = steps.split()

    def run(discretization, step, *options):
        file = f"{folder}/in-time-{discretization}-{step}{len(options)}.h5"
        return results.trajectory(file, "fullrun", scene, *options, *results.sets({
            "discretization": discretization, "grid.step": step, "transient.end_time": end,
            "transient.load.period": 0.5, "output.fields": "false"}))

    fixed = ("--set", f"transient.fixed_step={float(finest) / 2}")
    exact = run("accurate", finest, *fixed)
    rows = [["rows", "step", "time steps", "H_c worst", "rms", "H_min worst", "rms"], None]
    at = np.linspace(0, float(end), 1001)
    for discretization, step, options in [*((d, s, ()) for d in ("published", "accurate") for s in steps),
                                          ("published", finest, fixed)]:
        found = run(discretization, step, *options)
        row = [discretization, step, found.steps]
        for column in "H_c", "H_min":
            films = [results.at_times(it.time, getattr(it, column), at) for it in (found, exact)]
            off = films[0] / films[1] - 1
            row += [f"{np.nanmax(abs(off)):.1e}", f"{np.sqrt(np.nanmean(off**2)):.1e}"]
        rows.append(row)
    print(f"relative deviations over T = 0 to {end} from the accurate rows with step {finest}, {exact.steps} time steps\n")
    results.table([*rows, None])


# ---- Models and formulas, error against time

# M and L of the scenes: between the training points of the Makefile.
SCENES = [(M, L) for M in (9.5, 12.5, 17.5, 21, 25.5, 31, 38, 47, 58, 72, 89) for L in (2, 4.8, 7.8, 10.8, 13.5)]
TRUTH = {"discretization": "accurate", "grid.x_min": -16, "grid.x_max": 2}
TRUTH_STEPS = 0.0025, 0.00125
DOMAIN = {"grid.x_min": -8, "grid.x_max": 2}  # of the full model, as in the training
REPEAT = 5
HEADER = ["way", "position", "film", "scenes", "worst", "median", "seconds"]


def solved(folder, name, program, settings, *options):
    """Returns films, seconds and film formulas of all scenes."""
    def run():
        print(f"  measure    {name}", file=sys.stderr)
        found = []
        for M, L in SCENES:
            done = results.run(program, "scene.yml", "-o", f"{folder}/run.h5", "--force", "--quiet", *options,
                               *results.sets({"moes.M": M, "moes.L": L, "output.fields": "false", **settings}))
            words = [line.split() for line in done.stdout.splitlines() if line.startswith("formula ")]
            found.append({**results.solution(f"{folder}/run.h5"),
                          "formulas": [(word[1], word[2], float(word[3]), 1e-9 * float(word[6])) for word in words]})
        return found
    return results.kept(f"{folder}/{name}.json", run, "scene.yml", f"{folder}/../model.h5", __file__,
                        os.path.join(os.environ["BIN"], program))


def errors(records, truth, film):
    """Returns the relative errors of the scenes that are solved."""
    return np.array([abs(record[film] / exact[film] - 1) for record, exact in zip(records, truth)
                     if record["status"] != 1])


def truth(out, modes, steps):
    """Prints errors and times of film formulas and of all models. The reference has the accurate discretisation and a
    long inlet, and is extrapolated from the two finest steps."""
    folder = f"{out}/ways"
    os.makedirs(folder, exist_ok=True)
    coarse, fine = (solved(folder, f"truth-{step}", "fullrun", {**TRUTH, "grid.step": step, "output.resolution": "false"})
                    for step in TRUTH_STEPS)
    exact_films = [{film: b[film] + (b[film] - a[film]) / 3 for film in ("H_c", "H_min")} for a, b in zip(coarse, fine)]
    sure = max(abs(b[film] / exact[film] - 1) for b, exact in zip(fine, exact_films) for film in exact)

    ways = {}
    for rows in "published", "accurate":
        for step in steps.split():
            settings = {"discretization": rows, **DOMAIN, "grid.step": step, "output.resolution": "false"}
            ways["full, " + rows, step] = solved(folder, f"{rows}-{step}", "fullrun", settings, "--repeat", REPEAT,
                                                 "--formulas")
    for size in modes.split():
        rows = round(1.6 * int(size))
        ways["reduced", size] = solved(folder, f"reduced-{size}", "romrun", {}, "--model", f"{out}/model.h5",
                                       "--pressure-modes", size, "--rows", rows, "--repeat", REPEAT)
    lines = []
    for (way, position), records in ways.items():
        for film in "H_c", "H_min":
            off = errors(records, exact_films, film)
            if len(off):
                lines.append([way, position, film, len(off), off.max(), np.median(off),
                              np.median([record["seconds"] for record in records])])
    formulas = {}
    for record, exact in zip(ways["full, accurate", steps.split()[-1]], exact_films):
        for name, quantity, film, seconds in record["formulas"]:
            key = "H_min" if quantity == "minimum" else "H_c"
            formulas.setdefault((name, key), []).append((abs(film / exact[key] - 1), seconds))
    for (name, film), pairs in formulas.items():
        off, seconds = np.transpose(pairs)
        lines.append(["formula", name, film, len(off), off.max(), np.median(off), np.median(seconds)])
    results.write_csv(f"{out}/truth.csv", HEADER, lines)
    print(f"{len(SCENES)} scenes; the truth is extrapolated by {sure:.1e} at most")
    results.table([["way", "step, modes", "film", "scenes", "worst", "median", "time"], None]
                  + [[*line[:3], str(line[3]), f"{line[4]:.1e}", f"{line[5]:.1e}", f"{1e3 * line[6]:.3g} ms"]
                     for line in lines], 3)


SERIES = [("film formulas", "formula", "o", "black"), ("full model, published rows", "full, published", "s", pictures.RED),
          ("full model, accurate rows", "full, accurate", "^", pictures.GREEN),
          ("reduced model of the accurate rows", "reduced", "D", pictures.BLUE)]


def draw(out):
    lines = results.read_csv(f"{out}/truth.csv")
    figure, panels = pictures.page(1100, 520, columns=2, sharey=True)
    for axes, film, name in zip(panels, ("H_c", "H_min"), ("central film", "smallest film")):
        for label, way, mark, colour in SERIES:
            points = [[float(line[key]) for key in ("seconds", "worst", "median")] for line in lines
                      if line["way"] == way and line["film"] == film]
            if not points:
                continue
            seconds, worst, median = np.transpose(points)
            axes.vlines(seconds, median, worst, color=colour)
            axes.plot(seconds, worst, mark, color=colour, label=label)
        axes.set(xscale="log", yscale="log", xlabel="time of a solution / s", title=name, xlim=(1e-8, 1), ylim=(3e-5, 1))
    panels[0].set_ylabel("distance from the truth: worst scene (mark), median (end)")
    panels[1].legend(loc="lower left", frameon=False, fontsize=9)
    pictures.save(figure, f"{out}/truth.png")


if __name__ == "__main__":
    results.commands(stationary, in_time, estimates, interpolated, indicated, inlets, point_inlets, random, truth, draw)
