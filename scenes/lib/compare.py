# SPDX-License-Identifier: GPL-3.0-or-later
"""The cases of cases.csv for make, and full and reduced results of all of them beside each other.

    compare.py cases > CASES.mk
    compare.py table FOLDER MODEL        reads FOLDER/MODEL.h5, FOLDER/full/CASE.h5 and FOLDER/MODEL/CASE.h5
"""
import shlex

import results

OPTIONAL = ["film_unit", "inlet_effect", "step_effect"]
HEADER = ["case", "status", "iterations_full", "iterations_reduced", "milliseconds_full", "milliseconds_reduced",
          "H_c_full", "H_c_reduced", "H_min_full", "H_min_reduced", *OPTIONAL]


def cases():
    """Prints variables of make: CASES, all names, and settings.NAME, the options of each."""
    known = results.read_cases()
    if not known:
        results.stop("cases.csv: found no cases, expected a line each below the header")
    print("CASES :=", *(case.name for case in known))
    for case in known:
        print(f"settings.{case.name} :=", shlex.join(case.options).replace("$", "$$").replace("#", "\\#"))


def effect(label, part):
    """What inlet or step do to the full model's own central film, where it is more than 1 %."""
    return f"{label} {100 * part:+.0f} %" if part != "" and abs(part) > 0.01 else ""


def cells(full, reduced, permille):
    """The columns of the table behind case and film, of two solutions or of what was published of them."""
    (H, iterations, seconds), (H_reduced, iterations_reduced, seconds_reduced) = (
        [float(part[name]) for name in ("H_c", "iterations", "seconds")] for part in (full, reduced))
    return [f"{H:.8f}", f"{H_reduced:.8f}", f"{permille:.3f}", f"{iterations:.0f}", f"{iterations_reduced:.0f}",
            f"{1000 * seconds:.1f}", f"{1000 * seconds_reduced:.2f}", f"{seconds / seconds_reduced:.0f}"]


def table(folder, model):
    """Prints the table, below each case the published figures where cases.csv has some, and films in um where a result
    says what unit they have. Also writes FOLDER/results.csv."""
    cases = results.read_cases()
    size = results.model_sizes(f"{folder}/{model}.h5")
    solved = {kind: [results.solution(f"{folder}/{kind}/{case.name}.h5") for case in cases] for kind in ("full", model)}
    optional = [[results.value(f"{folder}/full/{case.name}.h5", name, "") for name in OPTIONAL] for case in cases]

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
    print(f"\nFull model: {size['nodes']} nodes, {2 * size['nodes'] + 1} unknowns. Reduced model: "
          f"{size['pressure_modes'] + size['deformation_modes'] + 1} unknowns, {size['rows']} Reynolds rows, "
          f"{size['states']} training solutions.")
    print(f"H_c: film thickness at the centre.{' The second line of a case: as published.' if published else ''}\n")
    empty = [i for i in (1, 10) if not any(row and row[i] for row in rows[2:])]  # no column without films or notes
    longest = max(len(row[-1]) for row in rows if row)
    results.table([row and [cell for i, cell in enumerate([*row[:-1], row[-1].ljust(longest)]) if i not in empty]
                   for row in [*rows, None]])
    flagged = f", of those not trusted {worst_flagged[0]:.3f} ({worst_flagged[1]})" if worst_flagged[1] else ""
    print(f"worst deviation: {worst[0]:.3f} permille ({worst[1]}){flagged}{published}; slowest reduced solution: "
          f"{1000 * max(reduced['seconds'] for reduced in solved[model]):.2f} ms")
    if coarse:
        print("inlet, step: what the domain's start and the grid's step do to the full model's own central film")


results.commands(cases, table)
