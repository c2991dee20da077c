# SPDX-License-Identifier: GPL-3.0-or-later
"""Solvers of the reduced least squares on all cases of a region, or on steps in time: measurements, tables, picture."""
import os
import re
import shlex
import statistics
import subprocess
import sys

import numpy as np

import pictures
import results

SOLVERS = "used normal refined qr single single-refined".split()
REGIONS = {"low": "Lower loaded region", "high": "Higher loaded region", "time": "In time"}
VARIANTS = {"stored": "as stored", "without-D": "without D", "single": "bases rounded to single precision",
            "dependent": "last mode apart from that before it by", "rate": "steps of rate"}
ALL, FEW, LEAST = "all rows", "8 rows for 5 modes", "a row for a mode"


def assignments(case):
    """Settings of a case as KEY=VALUE, as the measuring programs take them."""
    return [f"{key}={text}" for key, text in case.settings.items()]


# ---- Measurements


def words(settings):
    """Settings KEY=VALUE of options --set KEY=VALUE."""
    return [word for word in shlex.split(settings) if word != "--set"]


def column(name):
    """A name as a field of CSV without quotes."""
    return re.sub('[",]', "_", name)


def sweep(bench, region, folder, settings, model, sizes, values, dependent=""):
    """Prints lines of CSV: all solvers on all cases of a region (values: how far the last mode is apart from that
    before it, with `dependent` modes), or in time on steps of all rates (values). Rows 0 stand for all."""
    def solve(name, options, modes, rows, variant):
        lines = results.run(bench, model, f"{folder}/scene.yml", modes, rows, variant, *options, outcomes=[0]).stdout
        print("".join(f"{region},{column(name)},{line}\n" for line in lines.splitlines()), end="", flush=True)

    sizes = [int(modes) for modes in sizes.split()]
    if region == "time":
        for modes in sizes:
            for variant in ["stored", *(f"rate={rate}" for rate in values.split())]:
                solve("scene", words(settings), modes, 0, variant)
        return
    for case in results.read_cases(f"{folder}/cases.csv"):
        own = [*words(settings), *assignments(case)]
        for modes in sizes:
            for variant in "stored", "without-D", "single":
                solve(case.name, own, modes, 0, variant)
            for variant in "stored", "without-D":
                for rows in modes * 8 // 5, modes:
                    solve(case.name, own, modes, rows, variant)
        for apart in values.split():
            solve(case.name, own, dependent, 0, f"dependent={apart}")


def read(file):
    """Lines of conditioning.csv, numbers as numbers, and of which table they are: region, kind, rule of the rows."""
    lines = results.read_csv(file)
    most = {}
    for line in lines:
        for key in line.keys() - {"region", "case", "variant", "solver", "status"}:
            line[key] = float(line[key])
        line["kind"], _, line["value"] = line["variant"].partition("=")
        most[line["region"]] = max(most.get(line["region"], 0), line["rows"])
    for line in lines:
        line["rule"] = LEAST if line["modes"] == line["rows"] else ALL if line["rows"] == most[line["region"]] else FEW
    return lines


# ---- Tables


def largest(numbers):
    """The largest absolute number as text, NaN left out: - where there is none, fails where it is infinite."""
    numbers = [abs(x) for x in numbers if not np.isnan(x)]
    return "-" if not numbers else "fails" if np.isinf(max(numbers)) else f"{max(numbers):.1e}"


def size_row(lines):
    """What all cases of one size come to."""
    of = {solver: [line for line in lines if line["solver"] == solver] for solver in [*SOLVERS, "extended"]}
    solved = {solver: [line["status"] == "converged" for line in of[solver]] for solver in of}
    conditions = [line["scaled_condition"] for line in of["extended"]]
    used = [line for line, converged in zip(of["used"], solved["used"]) if converged]
    both = [line for line, *ended in zip(of["used"], solved["used"], solved["extended"]) if all(ended)]
    equations = [int(line["equations"]) for line in lines]
    return [lines[0]["value"], int(lines[0]["modes"]), int(lines[0]["rows"]), f"{min(equations)}-{max(equations)}",
            f"{statistics.median_low(conditions):.1e}", largest(conditions),
            largest(line["condition"] for line in of["extended"]),
            *(largest(line["step_error"] for line in of[solver]) for solver in SOLVERS[1:]),
            *(f"{sum(solved[solver])}/{len(solved[solver])}" for solver in ("extended", "used", "normal", "single")),
            largest(line["from_extended"] for line in both), largest(line["from_full"] for line in used)]


def time_row(lines):
    """Microseconds of each solver at one size."""
    times = ([line["microseconds"] for line in lines if line["solver"] == solver and not np.isnan(line["microseconds"])]
             for solver in SOLVERS)
    return [int(lines[0]["modes"]), *(f"{statistics.median_low(of):.1f}" if of else "fails" for of in times)]


def table(file):
    """Prints what all cases of a region come to, a line for each size or variant."""
    tables = {}
    for line in read(file):
        sizes = tables.setdefault((line["region"], line["kind"], line["rule"]), {})
        sizes.setdefault((line["value"], line["modes"]), []).append(line)
    print("""\
Conditioning of the reduced least squares, over all cases. Condition: of the last iteration's matrix, its columns
scaled unless said. Step error: relative, columns scaled, against QR in extended precision, the largest of all
iterations and cases; "fails": no Cholesky factor. Solved: cases that Newton with this solver brings to an end.
H_c off: the largest relative difference of the solver in use, from Newton in extended precision and the full model.""")
    head = [["", "", "", "", "condition", "", "", "step error", "", "", "", "", "solved", "", "", "", "H_c off", ""],
            ["", "modes", "rows", "equations", "median", "worst", "unscaled", "normal", "refined", "QR", "single",
             "+refined", "extended", "used", "normal", "single", "extended", "full"]]
    titles = {key: f"{REGIONS[key[0]]}, {VARIANTS[key[1]]}, {key[2]}" for key in tables}
    for key, sizes in tables.items():
        print(f"\n{titles[key]}")
        results.table([*head, *map(size_row, sizes.values())])
    for key, sizes in tables.items():
        if key[1:] == ("stored", ALL):
            print(f"\n{titles[key]}: microseconds for a system, median of the cases")
            results.table([["modes", *SOLVERS], *map(time_row, sizes.values())])


# ---- Picture


def picture(file, target):
    """Draws the condition over the number of modes, a mark for each case."""
    hollow = {"color": pictures.RED, "marker": "s", "fillstyle": "none"}
    series = (("without-D", ALL, 0.8, hollow, "all rows, without D"),
              ("stored", FEW, -0.8, {"color": pictures.SKY, "marker": "^"}, "8 rows for 5 modes, D and row weights"),
              ("stored", ALL, 0, {"color": pictures.BLUE, "marker": "o"}, "all rows, D and row weights"))
    lines = [line for line in read(file) if line["solver"] == "extended"]
    figure, panels = pictures.page(1300, 560, 1, 2, sharey=True)
    figure.suptitle("Condition of the reduced Jacobian, columns scaled")
    for axes, region in zip(panels, ("low", "high")):
        axes.axhline(2.2e-16 ** -0.5, color="#555555", linestyle="--", label="Gram matrix singular in double precision")
        axes.axhline(1.2e-7 ** -0.5, color="#aaaaaa", linestyle="--", label="in single precision")
        for kind, rule, aside, style, label in series:
            chosen = [line for line in lines if (line["region"], line["kind"], line["rule"]) == (region, kind, rule)]
            axes.plot([line["modes"] + aside for line in chosen], [line["scaled_condition"] for line in chosen],
                      linestyle="none", markersize=5, label=label, **style)
        count = len({line["case"] for line in lines if line["region"] == region})
        axes.set(title=f"{REGIONS[region]}, {count} cases", xlabel="pressure modes", xlim=(5, 125), yscale="log",
                 ylim=(1, 1e12))
        axes.legend(loc="upper left")
    pictures.save(figure, target)


# ---- Instructions


def costs(*profiles):
    """Prints instructions of each solver for a system, in thousands, from FOLDER/costs-MODES.out of callgrind and
    the CSV beside it."""
    repeats = 21  # of each system, by bench_conditioning
    solvers = [*SOLVERS[:4], "unscaled", *SOLVERS[4:]]
    rows = []
    for profile in profiles:
        base = os.path.splitext(profile)[0]
        with open(f"{base}.csv") as file:
            fails = {line.split(",")[7] for line in file if line.strip().endswith(",nan")}
        text = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", "--show-percs=no", profile],
                              capture_output=True, text=True, check=True).stdout
        found = re.findall(r"^ *([\d,]+) .*:solve_(\w+) ", text, re.M)
        counts = {name.replace("_", "-"): int(count.replace(",", "")) / repeats / 1000 for count, name in found}
        rows.append([base.rsplit("-", 1)[1], *("fails" if solver in fails else f"{counts[solver]:.0f}"
                                               for solver in solvers)])
    results.table([["modes", *solvers], *rows])


# ---- Single precision


def file_size(model):
    """Prints the bytes of a model, and with four bytes less for each of its reals."""
    listed = results.run("romrun", "--print", model, outcomes=[0]).stdout.splitlines()
    reals = sum(np.prod([int(length) for length in line.split(",")[2].split()]) for line in listed
                if re.search("basis|jacobian|weight|factor|state_(pressure|deformation)", line) and line.split(",")[3])
    total = os.path.getsize(model)
    print(f"model.h5: {total} bytes, {total - 4 * reals} with its reals in single precision")


def precision(program, *studies):
    """Prints what bases in single precision do to the models of studies (folder, model and settings of each): all cases
    or, in time, a trajectory of fixed steps; time of an iteration's kernels, which in time are others; size of the file."""
    for folder, model, settings in zip(*3 * [iter(studies)]):
        scene = f"{folder}/scene.yml"
        print(f"\n{os.path.basename(folder)}")
        file_size(model)
        with open(scene) as file:
            in_time = "regime: transient" in file.read()
        cases = [] if in_time else results.read_cases(f"{folder}/cases.csv")
        for options in map(assignments, cases) if cases else [["transient.fixed_step=0.005"]]:
            options = [*words(settings), *options]
            print(results.run(program, "results", model, scene, *options, outcomes=[0]).stdout, end="")
        if not in_time:
            print(results.run(program, "kernels", model, scene, *options, outcomes=[0]).stdout, end="")
        sys.stdout.flush()


if __name__ == "__main__":
    results.commands(sweep, table, picture, costs, precision)
