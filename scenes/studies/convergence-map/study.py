# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows where the full model converges, and the errors due to grid and inlet (README.md):

    study.py plan PLAN.yml ROWS LAW-DENSITY-REGION     writes the plan of a piece of the map on its published grid
    study.py collect MAP.csv PIECE.h5...               writes the states of all pieces as a table
    study.py own-grids MAP.csv FOLDER PUBLISHED.csv    solves the points of such a table again, each on its default grid
    study.py summary MAP.csv LEAST                     prints failed points and a line for each lubricant; exit code 1
                                                       if a point fails or there are fewer than LEAST points
    study.py draw MAP.csv                              draws the picture
    study.py estimate OUT LOW HIGH L SET               estimates and measures errors at points (lists): estimates.csv
    study.py compare ESTIMATES.csv                     compares estimated and measured errors
"""
import os
import shlex
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import results

# M goes up to 2000 and L up to 25, as far as the viscosity law holds. The laws of Barus and Roelands hold everywhere,
# WLF no. 1 up to 11.5 GPa, which is alpha p_H = 271. LAWS: the largest alpha p_H. REGIONS: M and the published step.
LAWS = {"barus": ("law: barus, alpha: 20e-9", 450), "roelands": ("law: roelands, eta0: 0.04, alpha: 20e-9", 450),
        "wlf": ("law: wlf, preset: no1", 270)}
REGIONS = {
    "low": ("1, 1.4, 2, 2.8, 4, 5, 7, 10, 14, 20, 28, 40", 0.005),
    "high": ("50, 70, 100, 140, 200, 280, 400, 560, 800, 1130, 1600, 2000", 0.002)}
ALL_L = "0, 0.5, 1, 2.5, 5, 7.5, 10, 12.5, 15, 17.5, 20, 22.5, 25"
LONG_INLET = {"low": -32, "high": -16}

# Columns of map.csv after the names of the laws, with the datasets of a piece from which they are taken.
COLUMNS = {
    "M": "moes_M", "L": "moes_L", "alpha_p_H": "alpha_p_H", "p_H": "hertz_pressure", "step": "step", "status": "status",
    "newton_iterations": "newton_iterations", "residual": "residual_norm", "complementarity": "complementarity",
    "exit_X": "exit_position", "H_c": "central_film_thickness", "H_min": "minimum_film_thickness"}

LIMIT = 1  # per cent: fullrun prints a note if inlet or step change H_c by more


def pieces(name):
    """Returns law, density and region of LAW-DENSITY-REGION. The name of a density may contain a dash."""
    return name.split("-")[0], "-".join(name.split("-")[1:-1]), name.split("-")[-1]


def numbers(file):
    """Returns the lines of a CSV file. All columns but the names of laws are numbers."""
    return [{key: text if key in ("law", "density") else float(text or "nan") for key, text in line.items()}
            for line in results.read_csv(file)]


# ---- The map


def plan(file, rows, piece):
    law, density, region = pieces(piece)
    M, step = REGIONS[region]
    results.write_changed(file, plan_text(rows, law, density, M, ALL_L, f"grid: {{x_min: -4, x_max: 2, step: {step}}}"))


def plan_text(rows, law, density, M, L, grid=""):
    viscosity, highest = LAWS[law]
    return f"""groups:
  - scene:
      contact: line
      regime: stationary
      discretization: {rows}
      lubricant: {{viscosity: {{{viscosity}}}, density: {{law: {density}}}}}
      output: {{resolution: false}}
      {grid}
    vary:
      moes.M: [{M}]
      moes.L: [{L}]
    where: {{alpha_p_H: [0, {highest}]}}
"""


def states(piece):
    """Returns the states of all points of a piece, with values in the order of COLUMNS."""
    return [[f"{x:.12g}" for x in state] for state in zip(*results.printed(piece, *COLUMNS.values()).values())]


def collect(file, *files):
    lines = []
    for piece in files:
        laws = pieces(os.path.splitext(os.path.basename(piece))[0])[:2]
        lines += [[*laws, *state] for state in states(piece)]
    results.write_csv(file, ["law", "density", *COLUMNS], lines)


def own_grids(file, folder, published):
    """Solves all points, two at a time. Each point is a plan of its own, because a plan has one grid for all its
    points. An interrupted map continues where it was."""
    def line(point):
        laws = point["law"], point["density"]
        name = "{}/{}-{}-{:g}-{:g}".format(folder, *laws, point["M"], point["L"])

        def solve():
            results.write_changed(f"{name}.yml", plan_text("accurate", *laws, *(f"{point[x]:.12g}" for x in "ML")))
            results.run("snapgen", "--cold", f"{name}.yml", "-o", f"{name}.h5", "--force", "--jobs", 1, "-q")
            state = [f"{point[key]:.12g}" if key in ("M", "L", "alpha_p_H", "p_H") else "" for key in COLUMNS]
            if os.path.exists(f"{name}.h5"):
                [state] = states(f"{name}.h5")
                os.remove(f"{name}.h5")
            os.remove(f"{name}.yml")
            return [*laws, *state]
        return results.kept(f"{name}.json", solve, os.path.join(os.environ["BIN"], "snapgen"))
    os.makedirs(folder, exist_ok=True)
    with ThreadPoolExecutor(2) as two:
        results.write_csv(file, ["law", "density", *COLUMNS], two.map(line, numbers(published)))


def good(point):
    """Returns whether a point converged, its scaled residual is below 1e-8, no node has a negative pressure or
    multiplier, and the exit lies inside of the domain."""
    return (point["status"] == 0 and point["residual"] < 1e-8 and point["complementarity"] <= 0
            and 0 < point["exit_X"] < 2)


def summary(file, least):
    points = numbers(file)
    failed = [point for point in points if not good(point)]
    for point in failed:
        print("failed:", ",".join(x if isinstance(x, str) else f"{x:g}" for x in point.values()))
    print("{:27} {:>6} {:>6}  {:>9}  {:>12} {:>9}  {}".format(
        "cold starts", "points", "failed", "alpha p_H", "residual", "last exit", "Newton mean, most"))
    for lubricant in dict.fromkeys((point["law"], point["density"]) for point in points):
        mine = [point for point in points if (point["law"], point["density"]) == lubricant]
        solved = [point for point in mine if good(point)]
        hardest, residual, last, most = (max((point[key] for point in solved), default=np.nan)
                                         for key in ("alpha_p_H", "residual", "exit_X", "newton_iterations"))
        mean = sum(point["newton_iterations"] for point in solved) / max(len(solved), 1)
        print(f"{lubricant[0]:9} {lubricant[1]:17} {len(mine):6} {len(mine) - len(solved):6}  {hardest:9.1f}  "
              f"{residual:12.1e} {last:9.3f}  {mean:6.1f} {most:8.0f}")
    print(f"{len(points)} points, {len(failed)} failed")
    if failed or len(points) < int(least):
        sys.exit(1)


def draw(file):
    """Draws the Newton iterations of cold starts over M and L, with a panel for each lubricant."""
    import matplotlib

    import pictures

    colours = matplotlib.colors.LinearSegmentedColormap.from_list("iterations", list(zip(
        (0, 0.35, 0.6, 0.8, 1), (pictures.BLUE, pictures.SKY, "#f0e442", pictures.ORANGE, "#8b1a1a"))))
    points = numbers(file)
    densities = list(dict.fromkeys(point["density"] for point in points))
    laws = list(dict.fromkeys(point["law"] for point in points))
    figure, panels = pictures.page(1300, 800, len(densities), len(laws), sharex=True, sharey=True, squeeze=False)
    figure.suptitle("Cold starts of the full model: Newton iterations on the finest grid")
    for panel, (density, law) in zip(panels.flat, ((density, law) for density in densities for law in laws)):
        mine = [point for point in points if (point["law"], point["density"]) == (law, density)]
        solved, failed = ([point for point in mine if (point["status"] != 0) == lost] for lost in (False, True))
        marks = panel.scatter(*([point[key] for point in solved] for key in ("M", "L")), s=36, cmap=colours,
                              c=[point["newton_iterations"] for point in solved],
                              norm=matplotlib.colors.LogNorm(2, 320))
        panel.plot(*([point[key] for point in failed] for key in ("M", "L")), "kx", markersize=9, markeredgewidth=3)
        panel.set(title=f"{law}, {density}", xscale="log", xlim=(0.8, 2500), ylim=(-1.5, 26.5))
    for panel in panels[-1]:
        panel.set_xlabel("M")
    for panel in panels[:, 0]:
        panel.set_ylabel("L")
    figure.colorbar(marks, ax=panels)
    pictures.save(figure, os.path.splitext(file)[0] + ".png")


# ---- Estimates


def measure(M, L, region, more):
    """Solves a point on the published grid (scene.yml), with a long inlet, and with a half and a quarter of the step.
    Returns a line of estimates.csv, in which unknown values are empty."""
    step = REGIONS[region][1]
    films, attributes = [], ["observed_order", "inlet_nodes", "spike_nodes", "outlet_nodes"]
    with tempfile.TemporaryDirectory() as work:
        for changes in {}, {"grid.x_min": LONG_INLET[region]}, {"grid.step": step / 2}, {"grid.step": step / 4}:
            file = f"{work}/{len(films)}.h5"
            results.run("fullrun", "scene.yml", "-q", "--allow-untrusted", "-o", file, *more,
                        *results.sets({"moes.M": M, "moes.L": L, "grid.step": step, **changes}),
                        outcomes=(results.SOLVED, results.NOT_CONVERGED))
            found = results.solution(file)
            films.append(found["H_c"] if found["status"] != results.NOT_CONVERGED else np.nan)
        inlet, effect, *others = (results.value(f"{work}/0.h5", name)
                                  for name in ["inlet_effect", "step_effect", *attributes])
    published, long, half, quarter = films
    line = {"M": float(M), "L": float(L), "step": step, "H_c": published, "inlet_estimated": inlet,
            "inlet_measured": long / published - 1, "step_estimated": effect,
            "step_measured": (quarter + (quarter - half) / 3) / published - 1, **dict(zip(attributes, others))}
    return {key: "" if np.isnan(x) else f"{x:.{10 if key == 'H_c' else 6}g}" for key, x in line.items()}


def estimate(out, low, high, all_L, settings):
    """Measures all points, two at a time."""
    points = [(M, L, region) for region, all_M in (("low", low), ("high", high))
              for M in all_M.split() for L in all_L.split()]
    sources = ["scene.yml", f"{out}/estimates.options", os.path.join(os.environ["BIN"], "fullrun")]

    def line(point):
        return results.kept(f"{out}/estimate-{'-'.join(point)}.json", lambda: measure(*point, shlex.split(settings)),
                            *sources)
    with ThreadPoolExecutor(2) as two:
        lines = list(two.map(line, points))
    results.write_csv(f"{out}/estimates.csv", list(lines[0]), [line.values() for line in lines])


def compare(file):
    """Prints estimated and measured changes of H_c in per cent, and the numbers of right and wrong notes."""
    lines = numbers(file)
    layout = "{:>6} {:>5} {:>6} {:>12}  {:>10} {:>10}  {:>10} {:>10} {:>6}  {:>6} {:>6} {:>6}"
    print(layout.format("", "", "", "", "inlet", "inlet", "step", "step", "order", "nodes:", "", ""))
    print(layout.format("M", "L", "step", "H_c", *("estimated", "measured") * 2, "", "inlet", "spike", "outlet"))
    formats = ["g", "g", "g", ".10g", *4 * [".3g"], ".2f", *3 * ["g"]]  # of the columns; effects are shown in per cent
    for line in lines:
        shown = [x * (100 if key.endswith(("estimated", "measured")) else 1) for key, x in line.items()]
        print(layout.format(*("none" if np.isnan(x) else f"{x:{form}}" for x, form in zip(shown, formats))))
    print()
    for effect in "inlet", "step":
        estimated, measured = (100 * np.array([line[f"{effect}_{what}"] for line in lines])
                               for what in ("estimated", "measured"))
        known = ~np.isnan(measured)
        noted = (np.isnan(estimated) | (abs(estimated) > LIMIT))[known]  # also a note: no estimate
        true = abs(measured[known]) > LIMIT
        # ratios only for changes that are estimated and not small
        ratios = (estimated / measured)[~np.isnan(estimated) & (abs(measured) >= LIMIT / 5)]
        lowest, highest = min(ratios, default=np.nan), max(ratios, default=np.nan)
        print(f"{effect:6} noted and true {sum(noted & true)}, not noted and true {sum(~noted & ~true)}, noted though "
              f"less {sum(noted & ~true)}, missed {sum(~noted & true)}; estimated/measured {lowest:.2f} to "
              f"{highest:.2f} at the {len(ratios)} points above {LIMIT / 5:g} %")


if __name__ == "__main__":
    results.commands(plan, collect, own_grids, summary, draw, estimate, compare)
