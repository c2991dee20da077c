# SPDX-License-Identifier: GPL-3.0-or-later
"""Central film of point contacts on three grids and extrapolated, against a published fit (README.md):

    study.py plan PLAN.yml CELLS M L ALPHA     writes the plan on one grid; M and L: lists, as in a plan
    study.py film FILM.csv 4h.h5 2h.h5 h.h5    compares its states on three grids
    study.py table FILM.csv                    the table for people; exit code 1 where a point has no solution

Films are in Moes units, H (3M/2)^(2/3). They are extrapolated by Richardson with the order that is observed, from 1 to
2. The difference from the fit is shown for the film and for its mass, density times film, as an incompressible
lubricant would have it: the law is that of Dowson and Higginson.
"""
import os
import sys
import tempfile
import textwrap

import numpy as np

import results

HEADER = "M,L,H_4h,H_2h,H_h,order,H_0,fit,difference,difference_of_mass,p_H_GPa,complementarity".split(",")
EXPECTED = 0.1  # differences beyond are counted

SCENE = """contact: point
regime: stationary
lubricant: {{viscosity: {{law: roelands, eta0: 0.04, alpha: {alpha}}}, density: {{law: dowson-higginson}}}}
grid: {{x_min: {x_min!r}, x_max: {x_max!r}, y_max: {y_max!r}{step}}}
boundary: zero
"""


def plan(file, cells, M, L, alpha):
    """X in -4.5 ... 1.5, Y in -3 ... 3, boundary nodes on these ends, so many cells along and half of them across."""
    step = 6 / int(cells)
    scene = SCENE.format(alpha=alpha, x_min=-4.5 + step, x_max=1.5 - step, y_max=3 - step, step=f", step: {step!r}")
    results.write_changed(file, "groups:\n  - scene:\n" + textwrap.indent(scene, 6 * " ")
                          + f"    vary:\n      moes.M: [{M}]\n      moes.L: [{L}]\n")


def fit(M, L, work):
    """H_c of the fit of Nijenbanning, Venner and Moes, Wear 176 (1994) 217, of the circular contact. It goes by M and L
    alone; fullrun prints it beside a solution, so on the coarsest grid that has one."""
    scene = f"{work}/scene.yml"
    results.write_changed(scene, SCENE.format(alpha="20e-9", x_min=-4.25, x_max=1.25, y_max=2.75, step=""))
    for step in 0.25, 0.125, 0.0625, 0.03125, 0.015625:
        done = results.run("fullrun", scene, "-o", f"{work}/fit.h5", "--force", "--quiet", "--formulas",
                           *results.sets({"moes.M": M, "moes.L": L, "grid.step": step,
                                          "output.resolution": "false"}), outcomes=range(256))
        if done.returncode == results.SOLVED:
            return next(float(line.split()[3]) for line in done.stdout.splitlines()
                        if line.startswith("formula nijenbanning"))
    return np.nan


def density(pressure):
    return (5.9e8 + 1.34 * pressure) / (5.9e8 + pressure)


def extrapolated(films):
    """Observed order and limit of films with steps 4h, 2h, h, NaN where there is none. Without the coarsest one the
    order is that of the scheme, 2."""
    ratio = (films[1] - films[0]) / (films[2] - films[1])
    order = np.log2(ratio) if ratio > 0 else np.nan
    used = 2 if np.isnan(order) else np.clip(order, 1, 2)
    return order, films[2] + (films[2] - films[1]) / (2**used - 1)


def film_line(M, L, fitted, states):
    """The line of a point of film.csv, from its states on the three grids: status, central film and pressure, Hertz
    pressure, complementarity."""
    moes = (1.5 * M) ** (2 / 3)
    films = [moes * state[1] if state[0] == results.SOLVED else np.nan for state in states]
    order, limit = extrapolated(films)
    p_H = states[0][3]
    mass = limit * density(p_H * states[2][2])
    violation = max([0.0, *(state[4] for state in states if state[0] == results.SOLVED)])
    return [f"{x:.7g}" for x in (M, L, *films, order, limit, moes * fitted, limit / (moes * fitted) - 1,
                                 mass / (moes * fitted) - 1, p_H / 1e9, violation)]


def film(file, *grids):
    """The states of one plan on three grids, coarse to fine, compared with the fit."""
    points = results.printed(grids[0], "moes_M", "moes_L").values()
    names = ["status", "central_film_thickness", "central_pressure", "hertz_pressure", "complementarity"]
    states = [np.array(list(results.printed(grid, *names).values())).T for grid in grids]
    with tempfile.TemporaryDirectory(dir=os.path.dirname(file)) as work:
        results.write_csv(file, HEADER, [film_line(M, L, fit(M, L, work), states_of_point)
                                         for M, L, *states_of_point in zip(*points, *states)])


def table(file):
    """The table for people."""
    lines = [{key: float(text) for key, text in line.items()} for line in results.read_csv(file)]
    print("{:>6} {:>5} {:>6}  {:>8} {:>8} {:>8}  {:>6}  {:>9} {:>8}  {}  {}".format(
        "M", "L", "p_H", "4h", "2h", "h", "order", "h to 0", "fit", "difference", "of density times film"))
    for x in lines:
        print("{M:6g} {L:5g} {p_H_GPa:6.2f}  {H_4h:8.4f} {H_2h:8.4f} {H_h:8.4f}  {order:6.2f}".format(**x),
              f" {x['H_0']:9.4f} {x['fit']:8.4f}  {100 * x['difference']:+8.1f} %"
              f"  {100 * x['difference_of_mass']:+8.1f} %")
    off = np.abs([x["difference"] for x in lines])
    lost = np.sum(np.isnan(off))
    print(f"{len(lines)} points, {lost} without a solution; largest difference "
          f"{100 * max(off[~np.isnan(off)], default=0):.1f} %, {np.sum(off > EXPECTED)} beyond {100 * EXPECTED:g} %")
    if lost:
        sys.exit(1)


if __name__ == "__main__":
    results.commands(plan, film, table)
