# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes tables 2 to 4 and figure 3 of the paper, for the stationary line contact in both regions (published.mk).

    published.py tables FOLDER 'SIZES' MODEL...      SIZES: sizes of the published model, in the order of model_sizes
    published.py point FOLDER KIND-PRESSURE-DEFORMATION CASE [--set KEY=VALUE...]
    published.py figure3 PICTURE CASE PRESSURE DEFORMATION 'SIZES' POINT.txt...
"""
import tempfile

import numpy as np

import results


def published(case, kind):
    """Returns published values of the full or reduced solution of a case, like results.solution; some have none."""
    return {name: float(case.published[f"{name}_{kind}"]) for name in ("H_c", "iterations", "seconds")
            if f"{name}_{kind}" in case.published}


def tables(folder, sizes, *models):
    """Prints sizes, iterations, times and films of the full and of all reduced models, beside the published values."""
    cases = results.read_cases()
    full, *reduced = [[results.solution(case.file(folder, kind)) for case in cases]
                      for kind in ("full", *models)]
    full_published, reduced_published = ([published(case, kind) for case in cases] for kind in ("full", "reduced"))

    print("Table 2: sizes\n")
    rows = [["", "n", "2n+1", "m", "unknowns", "n_p", "n_delta", "rows", "needed nodes"], None]
    for name, size in [*((model, results.model_sizes(f"{folder}/{model}.h5").values()) for model in models),
                       *([("published", map(int, sizes.split()))] if sizes else [])]:
        n, pressure, deformation, selected, needed, states = size
        rows.append([name, n, 2 * n + 1, states, pressure + deformation + 1, pressure, deformation or "-", selected,
                     needed])
    results.table(rows)

    def table(heading, number, form, factor=1, below=None, last=()):
        """Prints a table with a line for each case, an optional second line below it, and an optional last line."""
        print(f"\n{heading}\n")
        rows = [["", "M", "L", "GPa", "full", "published", *models, "published"], None]
        for i, case in enumerate(cases):
            rows.append([case.settings["lubricant.viscosity.preset"], case.settings["moes.M"], case.settings["moes.L"],
                         f"{float(case.settings.get('hertz_pressure', 0)) / 1e9:g}",
                         *(f"{factor * column[i][number]:{form}}{mark(column[i])}" if number in column[i] else "-"
                           for column in (full, full_published, *reduced, reduced_published))])
            rows += [[""] * 6 + below(i)] if below else []
        results.table(rows + ([None, [last[0], *[""] * 5, *last[1:]]] if last else []))

    def mark(solution):
        return {1: "*", 4: "+"}.get(solution.get("status"), "")

    table("Table 3: Newton iterations (* not converged, + outside of the trained range)", "iterations", ".0f")
    ratios = [[a["seconds"] / b["seconds"] for a, b in zip(faster, slower) if "seconds" in b]
              for faster, slower in [*((full, part) for part in reduced), (full_published, reduced_published)]]
    table("Table 3: time of the solution in ms; last line: speed-up over the full model, mean of the cases",
          "seconds", ".2f", 1000, last=["speed-up", *(f"{np.mean(part or 0):.0f}" for part in ratios)])

    off = [[1000 * abs(b["H_c"] / a["H_c"] - 1) for a, b in zip(full, part)] for part in reduced]
    off.append([float(case.published.get("deviation_permille", 0)) for case in cases])
    worst = [max([permille for permille, solution in zip(part, solutions) if solution.get("status") != 1], default=0)
             for part, solutions in zip(off, [*reduced, reduced_published])]
    table("Table 4: central film thickness H_c, and deviations of the reduced models from the full one in permille",
          "H_c", ".8f", below=lambda i: [f"{part[i]:.4f}" for part in off],
          last=["worst", *(f"{part:.4f}" for part in worst)])
    difference = max([abs(a["H_c"] - b["H_c"]) for a, b in zip(full, full_published) if b], default=0)
    print(f"largest difference of the full model's H_c from the published one: {difference:.1e}")


def point(folder, name, case, *settings):
    """Makes a model of the given sizes for one point of figure 3. Prints KIND PRESSURE_MODES DEFORMATION_MODES ROWS
    STATUS PERMILLE; STATUS is 1 if the model does not converge."""
    kind, pressure, deformation = name.split("-")
    rows = 2 * (int(pressure) + int(deformation) + 1)
    case, = results.find_cases([case])
    with tempfile.TemporaryDirectory() as work:
        basis, residuals, model, result = (f"{work}/{part}.h5" for part in ("basis", "residuals", "model", "result"))
        results.run("podbuild", f"{folder}/snapshots.h5", "--quiet", "--deformation", kind, "--pressure-modes",
                    pressure, *(() if kind == "coupled" else ("--deformation-modes", deformation)), "-o", basis,
                    outcomes=[0])
        results.run("snapgen", "plan.yml", "--quiet", "--basis", basis, "-o", residuals, *settings, outcomes=[0])
        results.run("deimselect", residuals, "--quiet", "--no-check", "--basis", basis, "--rows", rows,
                    "--weights", "quadrature" if kind == "coupled" else "plain", "-o", model, outcomes=[0])
        done = results.run("romrun", "scene.yml", "--quiet", "--allow-untrusted", "--model", model, "-o", result,
                           *settings, *case.options, outcomes=[results.SOLVED, results.NOT_CONVERGED])
        off = abs(results.solution(result)["H_c"] / results.solution(case.file(folder, "full"))["H_c"] - 1)
    print(kind, pressure, deformation, rows, int(done.returncode != 0), f"{1000 * off:.6g}")


def figure3(picture, name, fixed_pressure, fixed_deformation, sizes, *files):
    """Draws the deviation of the central film against the size of one basis; the size of the other basis is fixed."""
    import pictures
    lines = [open(file).read().split() for file in files]
    points = sorted((line[0], *map(float, line[1:])) for line in lines)
    case, = results.find_cases([name])
    fixed, label = (int(fixed_pressure), int(fixed_deformation)), ("n_p", "n_\\delta")
    published = sizes.split()[1:3]
    figure, both = pictures.page(1000, 1000, 2)
    both[0].set_title(case.label)
    for varied, axes in enumerate(both):
        for kind, size, style, bottom in ("independent", fixed[1 - varied], "o-", 4e-6), ("coupled", 0, "s-", 2e-6):
            if kind == "coupled" and varied == 1:
                continue
            chosen = [point for point in points if point[0] == kind and point[2 - varied] == size]
            converged = [point for point in chosen if point[4] == 0]
            failed = [point[1 + varied] for point in chosen if point[4] == 1]
            colour = pictures.BLUE if kind == "independent" else pictures.RED
            axes.plot([point[1 + varied] for point in converged], [point[5] for point in converged], style,
                      color=colour, label=f"{kind} basis" + (f", ${label[1 - varied]}$ = {size}" if size else ""))
            axes.plot(failed, [bottom] * len(failed), "x", color=colour)
        axes.plot([], [], "x", color=pictures.BLUE, label="not converged (at the bottom)")
        if published and "deviation_permille" in case.published:
            axes.plot(int(published[varied]), float(case.published["deviation_permille"]), "kD", fillstyle="none",
                      label="published, " + " + ".join(published))
        axes.set(xlabel=f"number of {('pressure', 'deformation')[varied]} basis functions ${label[varied]}$",
                 xlim=(0, None), yscale="log", ylim=(1e-6, 1e4), ylabel="deviation of $H_c$ / permille")
        axes.legend(loc="upper right")
    pictures.save(figure, picture)


results.commands(tables, point, figure3)
