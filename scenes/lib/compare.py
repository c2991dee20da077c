# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares results.

    compare.py table FOLDER MODEL_FILE      compares full and reduced results of all cases of cases.csv; reads the model
                                            (NAME.h5 or NAME.yml), FOLDER/full/NUMBER.h5 and FOLDER/NAME/NUMBER.h5
    compare.py runs FIRST.csv OTHER.csv...  prints the deviations of the other runs of a program from the first run
"""
import os

import numpy as np

import results

OPTIONAL = ["film_unit", "inlet_effect", "step_effect"]
HEADER = ["case", "status", "iterations_full", "iterations_reduced", "milliseconds_full", "milliseconds_reduced",
          "H_c_full", "H_c_reduced", "H_min_full", "H_min_reduced", *OPTIONAL]


def effect(label, part):
    """Returns the text for an error of the full model's central film due to inlet or step, if it exceeds 1 %."""
    return f"{label} {100 * part:+.0f} %" if part != "" and abs(part) > 0.01 else ""


def cells(full, reduced, permille):
    """Returns the columns of the table after case and film, for full and reduced solutions, computed or published."""
    (H, iterations, seconds), (H_reduced, iterations_reduced, seconds_reduced) = (
        [float(part[name]) for name in ("H_c", "iterations", "seconds")] for part in (full, reduced))
    return [f"{H:.8f}", f"{H_reduced:.8f}", f"{permille:.3f}", f"{iterations:.0f}", f"{iterations_reduced:.0f}",
            f"{1000 * seconds:.1f}", f"{1000 * seconds_reduced:.2f}", f"{seconds / seconds_reduced:.0f}"]


def describe(model):
    """Returns a text with the sizes of a model, or of all models of a list."""
    sizes = [results.model_sizes(file) for file in results.listed_models(model)]
    nodes, unknowns, rows = ("; ".join(str(number) for number in numbers) for numbers in zip(
        *((size["nodes"], size["pressure_modes"] + size["deformation_modes"] + 1, size["rows"]) for size in sizes)))
    full = f"{sizes[0]['nodes']} nodes, {2 * sizes[0]['nodes'] + 1} unknowns" if len(sizes) == 1 else f"{nodes} nodes"
    of_parts = f" of {len(sizes)} parts" if len(sizes) > 1 else ""
    return (f"Full model: {full}. Reduced model{of_parts}: {unknowns} unknowns, {rows} Reynolds rows, "
            f"{sum(size['states'] for size in sizes)} training solutions.")


def table(folder, file):
    """Prints the table and writes FOLDER/results.csv. If cases.csv has published values of a case, they stand below the
    case. If a result has the unit of films, the table has films in um."""
    cases = results.read_cases()
    model = os.path.splitext(os.path.basename(file))[0]
    solved = {kind: [results.solution(case.file(folder, kind)) for case in cases] for kind in ("full", model)}
    optional = [[results.value(case.file(folder, "full"), name, "") for name in OPTIONAL] for case in cases]

    rows = [["", "film", "H_c", "H_c", "deviation", "iterations", "", "time / ms", "", "speed-up", ""],
            ["case", "um", "full", "reduced", "permille", "full", "reduced", "full", "reduced", "", ""], None]
    worst, worst_flagged, worst_published, coarse, lines = (0, ""), (0, ""), None, False, []
    for case, full, reduced, (unit, inlet, step) in zip(cases, solved["full"], solved[model], optional):
        permille = 1000 * abs(reduced["H_c"] / full["H_c"] - 1)
        trust = ("not converged" if 1 in (full["status"], reduced["status"]) else
                 "not trusted" if reduced["status"] == 4 else "")
        if not trust:
            worst = max(worst, (permille, case.name))
        elif trust == "not trusted":
            worst_flagged = max(worst_flagged, (permille, case.name))
        grid = [effect("inlet", inlet), effect("step", step)]
        coarse = coarse or any(grid)
        film = f"{1e6 * unit * full['H_c']:.4f}" if unit != "" else ""
        rows.append([case.name, film, *cells(full, reduced, permille), "  ".join(filter(None, [trust, *grid]))])
        if "H_c_full" in case.published:
            was = [{name: case.published[f"{name}_{kind}"] for name in ("H_c", "iterations", "seconds")}
                   for kind in ("full", "reduced")]
            permille = float(case.published["deviation_permille"])
            worst_published = max(worst_published or 0, permille)
            rows.append(["  published", "", *cells(*was, permille), ""])
        lines.append([case.name, int(reduced["status"]), int(full["iterations"]), int(reduced["iterations"]),
                      f"{1000 * full['seconds']:.4g}", f"{1000 * reduced['seconds']:.4g}", full["H_c"], reduced["H_c"],
                      full["H_min"], reduced["H_min"], unit, inlet, step])
    results.write_csv(f"{folder}/results.csv", HEADER, lines)

    published = "" if worst_published is None else f", published {worst_published:.3f}"
    print(f"\n{describe(file)}")
    print(f"H_c: film thickness at the centre.{' The second line of a case: as published.' if published else ''}\n")
    empty = [i for i in (1, 10) if not any(row and row[i] for row in rows[2:])]  # empty columns, left out
    longest = max(len(row[-1]) for row in rows if row)
    results.table([row and [cell for i, cell in enumerate([*row[:-1], row[-1].ljust(longest)]) if i not in empty]
                   for row in [*rows, None]])
    flagged = f", of those not trusted {worst_flagged[0]:.3f} ({worst_flagged[1]})" if worst_flagged[1] else ""
    print(f"worst deviation: {worst[0]:.3f} permille ({worst[1]}){flagged}{published}; slowest reduced solution: "
          f"{1000 * max(reduced['seconds'] for reduced in solved[model]):.2f} ms")
    if coarse:
        print("inlet, step: what the domain's start and the grid's step do to the full model's own central film")


def runs(first, *others):
    """Prints the largest deviation of each column from the first file."""
    expected = np.genfromtxt(first, delimiter=",", names=True)
    for path in others:
        found = np.genfromtxt(path, delimiter=",", names=True)
        if len(found) != len(expected):
            results.stop(f"{path}: found {len(found)} times, expected the {len(expected)} of {first}")
        print(f"{path}: largest deviation from {first}, of the largest value: " + ", ".join(
            f"{name.replace('_', ' ')} {np.max(np.abs(found[name] - expected[name])) / np.max(np.abs(expected[name])):.2g}"
            for name in expected.dtype.names[1:]))


results.commands(table, runs)
