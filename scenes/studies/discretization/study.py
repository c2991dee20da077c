# SPDX-License-Identifier: GPL-3.0-or-later
"""Distance of both discretisations from the solution of the equations (README.md):

    study.py stationary FOLDER LINE_STEPS POINT_STEPS    errors of the films of line and point contacts
    study.py in-time FOLDER SCENE.yml STEPS END          of the films of an oscillating load

STEPS of a grid go from coarse to fine, a list in one word. The reference is of the accurate rows: stationary,
extrapolated from the last two steps; in time, of the last step with time steps of half of it.
"""
import os

import numpy as np

import results

# Name, kind of contact, M, L, viscosity, density.
BARUS, ROELANDS = "law: barus, alpha: 20e-9", "law: roelands, eta0: 0.04, alpha: 20e-9"
CASES = [("line", 20, 10, BARUS, "incompressible"), ("line", 120, 10, BARUS, "incompressible"),
         ("line", 100, 3, BARUS, "dowson-higginson"), ("line", 40, 9, ROELANDS, "dowson-higginson"),
         ("line", 200, 12, ROELANDS, "dowson-higginson"), *(("point", M, 10, BARUS, "incompressible")
                                                             for M in (10, 20, 50, 100))]
DOMAINS = {"line": "x_min: -4, x_max: 2", "point": "x_min: -4.5, x_max: 1.5, y_max: 3"}


def films(folder, case, step, discretization):
    """Central and smallest film of a case."""
    kind, M, L, viscosity, density = case
    file = f"{folder}/{kind}-{M}-{L}-{discretization}-{step}"
    results.write_changed(f"{file}.yml", f"""contact: {kind}
regime: stationary
moes: {{M: {M}, L: {L}}}
lubricant: {{viscosity: {{{viscosity}}}, density: {{law: {density}}}}}
grid: {{{DOMAINS[kind]}, step: {step}}}
discretization: {discretization}
""")

    def solve():
        results.run("fullrun", f"{file}.yml", "-q", "-o", f"{file}.h5", "--force", outcomes=(results.SOLVED,))
        return results.solution(f"{file}.h5")
    found = results.kept(f"{file}.json", solve, f"{file}.yml", os.path.join(os.environ["BIN"], "fullrun"))
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


if __name__ == "__main__":
    results.commands(stationary, in_time)
