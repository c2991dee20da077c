# SPDX-License-Identifier: GPL-3.0-or-later
"""How far contacts on the grids that they choose are from the equations (README.md):

    study.py lines FOLDER ALL_M ALL_L      line contacts on their grids and on others: FOLDER/lines.csv
    study.py points FOLDER LUBRICANTS ALL_M ALL_L
                                           the same of point contacts: FOLDER/points.csv
    study.py summary FILE.csv              the worst over L and both lubricants at each M; exit code 1 above the limits
    study.py draw LINES.csv                errors, nodes and time of lines over M

The reference of a line is on a grid with an inlet that is long, extrapolated from three steps; that of a point is put
together from what step and domain do separately. Its own doubt is a column.
"""
import math
import os
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import results

LUBRICANTS = {"Barus": ("law: barus, alpha: 20e-9", "incompressible"),
              "Roelands": ("law: roelands, eta0: 0.04, alpha: 20e-9", "dowson-higginson")}
FILMS = "H_c", "H_m"
LIMITS = 1, 3  # per cent, of H_c and H_m
LENGTHS = 1.5, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64  # of inlets that contacts choose

# Domain on which the step of a point is varied, up to this M: -x_min, x_max, y_max; and up to which M a quarter of it
# is solved too.
POINT_DOMAIN = {1: (24, 8, 18), 2: (12, 4, 9), 3: (8, 3, 6), 5: (6, 2, 4.5), 20: (4, 2, 3), 2000: (2.5, 1.5, 2)}
FINE_POINTS = 300

# Reference of a line up to this M: length of the inlet, coarsest of three steps.
LINE_REFERENCE = {20: (64, 0.02), 200: (16, 0.005), 2000: (4, 0.001)}


def solve(kind, lubricant, M, L, grid):
    """Films, grid and cost of a contact, whose grid is given as settings, or in part."""
    viscosity, density = LUBRICANTS[lubricant]
    with tempfile.TemporaryDirectory() as work:
        scene, file = f"{work}/scene.yml", f"{work}/result.h5"
        results.write_changed(scene, f"""contact: {kind}
regime: stationary
moes: {{M: {M}, L: {L}}}
lubricant: {{viscosity: {{{viscosity}}}, density: {{law: {density}}}}}
output: {{fields: false, resolution: {str(kind == "point").lower()}}}
""")
        code = results.run("fullrun", scene, "-q", "--allow-untrusted", "-o", file,
                           *results.sets({f"grid.{key}": f"{x:.10g}" for key, x in grid.items()})).returncode
        if code != results.SOLVED:
            results.stop(f"found {kind}, {lubricant}, M = {M}, L = {L}, {grid} not solved, expected a solution")
        found = results.solution(file)
        extent = {name: results.value(file, name) for name in ("x_min", "step")}
        extent["inlet"] = results.value(file, "inlet_effect")
    return {"H_c": found["H_c"], "H_m": found["H_min"], "iterations": found["iterations"],
            "seconds": found["seconds"], **extent}


def films(found):
    return np.array([found[name] for name in FILMS])


def limit(coarse, middle, fine):
    """What films go to with ever smaller steps, of the order of the three, within 1 and 4."""
    with np.errstate(all="ignore"):
        order = np.log2((coarse - middle) / (middle - fine))
    order = np.clip(np.where(np.isfinite(order), order, 2), 1, 4)
    return fine + (fine - middle) / (2**order - 1)


def compared(own, nodes, exact, found):
    """A line of the table: what was found, in per cent of the reference."""
    return {**own, "nodes": nodes, "H_c": exact[0], "H_m": exact[1],
            **{what: list(100 * (of / exact - 1)) for what, of in found.items()}}


def line(lubricant, M, L):
    """A line contact on its own grid, its reference and the doubt of that, and what changes of the grid do."""
    def on(**grid):
        return solve("line", lubricant, M, L, grid)

    own = on()
    length, step = next(grid for most, grid in LINE_REFERENCE.items() if float(M) <= most)
    steps = [films(on(x_min=-length, step=step / 2**i)) for i in range(3)]
    exact = limit(*steps)
    other = LENGTHS.index(round(-own["x_min"], 6))
    return compared(own, round((2 - own["x_min"]) / own["step"]) + 1, exact, {
        "error": films(own), "reference, step": steps[-1],
        "reference, domain": films(on(x_min=-2 * length, step=step)) / steps[0] * exact,
        "twice the step": films(on(step=2 * own["step"])), "half the step": films(on(step=own["step"] / 2)),
        "shorter inlet": films(on(x_min=-LENGTHS[max(other - 1, 0)])),
        "longer inlet": films(on(x_min=-LENGTHS[other + 1]))})


def point(lubricant, M, L):
    """A point contact on its own grid, with the far field around. Its reference has the effect of the step from a
    domain that is small, and that of the domain from one twice as long: of H_c for both films, since the place of nodes
    changes H_m by more. The doubt of the latter is what 1.5 times the length would make of it."""
    def on(**grid):
        return solve("point", lubricant, M, L, grid)

    def domain(length, step):
        return on(x_min=-length, x_max=max(2, math.ceil(length / 3)), y_max=0.75 * length, step=step)

    own = on()
    step, length = own["step"], -own["x_min"]
    small = dict(zip(("x_min", "x_max", "y_max"), next(it for most, it in POINT_DOMAIN.items() if float(M) <= most)))
    small["x_min"] *= -1
    finer = 2 if float(M) <= FINE_POINTS else 1
    twice, here, half, quarter = (films(on(**small, step=min(step * 2**i, 0.25))) for i in (1, 0, -1, -finer))
    stepless = limit(*((here, half, quarter) if finer == 2 else (twice, here, half)))
    long, longer = (films(domain(factor * length, step))[0] / own["H_c"] for factor in (1.5, 2))
    shorter = films(domain(LENGTHS[LENGTHS.index(length) - 1], step))
    exact = films(own) * stepless / here * longer
    nodes = (round((max(2, math.ceil(length / 3)) + length) / step) + 1) * (2 * round(0.75 * length / step) + 1)
    return compared({**own, "of the step": 100 * (here / stepless - 1)[0], "of H_m": 100 * (here / stepless - 1)[1]},
                    nodes, exact, {
        "error": films(own), "reference, step": exact * quarter / stepless,
        "reference, domain": exact * long / longer,
        "twice the step": films(own) * twice / here, "half the step": films(own) * half / here,
        "shorter inlet": shorter})


def lines(folder, all_M, all_L):
    collect(f"{folder}/lines.csv", line, folder, LUBRICANTS, all_M, all_L)


def points(folder, lubricants, all_M, all_L):
    collect(f"{folder}/points.csv", point, folder, lubricants.split(), all_M, all_L)


def collect(file, measure, folder, lubricants, all_M, all_L):
    """A table of all contacts, two measured at a time; those that were measured already are taken from the folder."""
    contacts = [(lubricant, M, L) for lubricant in lubricants for M in all_M.split() for L in all_L.split()]
    sources = [os.path.join(os.environ["BIN"], "fullrun")]

    def known(contact):
        name = "-".join([measure.__name__, *contact])
        return results.kept(f"{folder}/{name}.json", lambda: measure(*contact), *sources)
    with ThreadPoolExecutor(2) as two:
        measured = list(two.map(known, contacts))
    columns = [f"{key}: {film}" if isinstance(of, list) else key
               for key, of in measured[0].items() for film in (FILMS if isinstance(of, list) else "-")]
    results.write_csv(file, ["lubricant", "M", "L", *columns],
                      [[*contact, *(f"{x:.6g}" for of in found.values() for x in np.atleast_1d(of))]
                       for contact, found in zip(contacts, measured)])


def summary(file):
    table = numbers(file)
    effects = [name[:-len(": H_c")] for name in table[0] if name.endswith(": H_c")]

    def worst(of):
        return [" ".join(f"{max((it[f'{effect}: {film}'] for it in of), key=abs):+.2g}" for film in FILMS)
                for effect in effects]
    rows = [["M", "x_min", "step", "nodes", "ms", *effects], None]
    for M in dict.fromkeys(it["M"] for it in table):
        mine = [it for it in table if it["M"] == M]
        spans = ["{:g} … {:g}".format(min(it[key] for it in mine), max(it[key] for it in mine)) for key in
                 ("x_min", "nodes")]
        rows.append([f"{M:g}", spans[0], f"{mine[0]['step']:g}", spans[1],
                     f"{1e3 * np.mean([it['seconds'] for it in mine]):.0f}", *worst(mine)])
    print(f"{len(table)} contacts; effects on H_c and H_m in per cent of the reference, worst over L and lubricant\n")
    results.table([*rows, None, ["all", "", "", "", "", *worst(table)]])
    for film, most in zip(FILMS, LIMITS):
        over = sum(abs(it[f"error: {film}"]) > most for it in table)
        print(f"{film}: {over} contacts are off by more than {most} %")
        if over:
            sys.exit(1)


def numbers(file):
    return [{key: text if key == "lubricant" else float(text) for key, text in it.items()}
            for it in results.read_csv(file)]


def draw(file):
    import pictures

    table = numbers(file)
    figure, (error, cost) = pictures.page(900, 380, 1, 2)
    all_M = list(dict.fromkeys(it["M"] for it in table))
    for film, most, colour in zip(FILMS, LIMITS, pictures.COLOURS):
        for it, effect, style in ((0, "error", "-"), (1, "twice the step", ":"), (2, "shorter inlet", "--")):
            worst = [max(abs(it[f"{effect}: {film}"]) for it in table if it["M"] == M) for M in all_M]
            error.plot(all_M, worst, style, color=colour, label=f"${film}$, {effect}" if it else f"${film}$")
        error.axhline(most, color=colour, linewidth=0.8)
    error.set(ylabel="worst error over L / %", yscale="log")
    error.set_ylim(0.03, 6)
    error.legend(fontsize=7, ncols=2, loc="lower left")
    for lubricant, mark in zip(LUBRICANTS, pictures.MARKS):
        mine = [it for it in table if it["lubricant"] == lubricant]
        cost.plot([it["M"] for it in mine], [it["nodes"] for it in mine], mark, fillstyle="none", label=lubricant)
    cost.set(ylabel="nodes", yscale="log")
    cost.legend()
    pictures.plain_logarithms(cost.yaxis)
    pictures.plain_logarithms(error.yaxis)
    for axes in error, cost:
        axes.set(xlabel="M", xscale="log")
    pictures.save(figure, os.path.splitext(file)[0] + ".png")


if __name__ == "__main__":
    results.commands(lines, points, summary, draw)
