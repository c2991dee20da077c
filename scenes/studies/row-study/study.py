# SPDX-License-Identifier: GPL-3.0-or-later
"""Row selections, row factors and weights of the test basis: measurements, tables, picture."""
import math
import os
import re
import shlex

import pictures
import results
import truth

COLUMNS = ("region weight modes method factors rows median p95 worst mean_iterations most_iterations ms failures "
           "sigma_residual sigma_jacobian sigma_exit stability").split()
STANDARD = "mode", "joint", "quadrature"


# ---- Measurements


def header():
    """Prints the first line of study.csv."""
    print(",".join(COLUMNS))


def measure(out, region, weight, modes, method, check, settings, factors):
    """Prints the lines of study.csv of a method with a weight and a number of modes: for each kind of factors, and each
    number of rows of the ladder of romrun --calibrate, what it deviates and how well posed the rows are. Settings: more
    options of the calibration."""
    base = f"{out}/{region}/{weight}/{modes}"
    model, calibrated, posed = (f"{base}/{method}-{kind}.h5" for kind in ("model", "calibrated", "posed"))
    found = {}

    def choose(target, *options):
        return results.run("deimselect", "--no-check", f"{base}-residuals.h5", "--basis", f"{base}-basis.h5", "--method", method,
                           "-o", target, "--force", *options, outcomes=[results.SOLVED]).stdout

    def how_posed(rows):
        """1/sigma_min of both bases and at the worst exit, and the stability, of so many rows."""
        text = choose(posed, "--rows", rows)
        return [*re.search(r"^1/sigma_min: residuals (.*), Jacobian products (.*), worst exit of training (.*)$", text,
                           re.M).groups(), re.search(r"^stability: (\S*)", text, re.M)[1]]

    for kind in factors.split():
        choose(model, "--rows", 2 * int(modes), "--weights", kind)
        results.run("romrun", "--calibrate", check, "--model", model, "-o", calibrated, "--force", "--quiet",
                    *shlex.split(settings), outcomes=[results.SOLVED])
        text = results.run("romrun", "--trade", "--model", calibrated, outcomes=[results.SOLVED]).stdout
        for line in text.split("\nindicated")[0].splitlines():
            words = line.replace("*", " ").split()  # a mark of the best
            if words[:1] == [modes]:
                rows = words[2]
                found[rows] = found.get(rows) or how_posed(rows)
                print(region, weight, modes, method, kind, *words[2:6], *words[15:19], *found[rows], sep=",")
    for file in model, calibrated, posed:
        os.remove(file)


# ---- Distance from the truth


def from_truth(out, region, modes, method, check, settings):
    """Prints how far the default weight's and factors' sizes are from the truth (OUT/REGION-truth), a line a number of
    rows, and before them the full model: scenes, failures, worst and 95 % of the deviation, worst, 95 % and median of the
    distance from the truth."""
    base = f"{out}/{region}/mode/{modes}"
    model, calibrated = (f"{base}/{method}-{kind}.h5" for kind in ("truth-model", "truth-calibrated"))
    results.run("deimselect", "--no-check", f"{base}-residuals.h5", "--basis", f"{base}-basis.h5", "--method", method, "-o", model,
                "--rows", 2 * int(modes), "--force", outcomes=[results.SOLVED])
    results.run("romrun", "--calibrate", check, "--model", model, "-o", calibrated, "--force", "--quiet",
                *shlex.split(settings), outcomes=[results.SOLVED])
    exact, full = truth.truths(f"{out}/{region}-truth"), truth.films(f"{out}/{region}-truth/own.h5")
    scenes = truth.calibrated_scenes(calibrated, full)

    def line(rows, films):
        failures = sum(map(math.isnan, films.values()))
        numbers = truth.distances(films, full)[:2] + truth.distances(films, exact)
        print(f"{region:5} {modes:>5} {method:>6} {rows:>5} {len(films):7} {failures:6}",
              *(f"{number:9.1e}" for number in numbers))

    line("full", full)
    for size, rows in zip(*results.printed(calibrated, "position_pressure_modes", "position_rows").values()):
        if size == int(modes):
            line(int(rows), truth.reduced_films(calibrated, scenes, f"{base}/{method}-scene", "--pressure-modes",
                                                modes, "--rows", int(rows)))
    for file in model, calibrated:
        os.remove(file)


# ---- Tables


def ratio(column, lines, standards, enough):
    """Geometric mean of the ratio to the default over the sizes at which neither fails more than `enough` times."""
    logs = []
    for size, line in lines.items():
        other = standards.get(size)
        if not other or max(float(line["failures"]), float(other["failures"])) > enough:
            continue
        pair = float(line[column]), float(other[column])
        if all(0 < number < math.inf for number in pair):
            logs.append(math.log(pair[0] / pair[1]))
    return f"{math.exp(sum(logs) / len(logs)):.3f}" if logs else "-"


def table(file, enough):
    """Prints study.csv as text: everything, and each variant beside the default of the same size."""
    lines = sorted(results.read_csv(file), key=lambda line: (int(line["modes"]), int(line["rows"])))
    lines.sort(key=lambda line: line["region"], reverse=True)
    rows = [["", "modes", "rows", "weight", "method", "factors", "median", "95 %", "worst", "mean", "most", "ms",
             "fail", "residual", "Jacobian", "exit", "stability"]]
    sizes, variants = {}, {}
    for line in lines:
        size = line["region"], line["modes"], line["rows"]
        variant = line["weight"], line["method"], line["factors"]
        sizes.setdefault(size, []).append([*size, *variant, *(line[name] for name in COLUMNS[6:])])
        variants.setdefault(variant, {})[size] = line
    for of_size in sizes.values():
        rows += [*of_size, ()]
    results.table(rows)

    print(f"over {len(sizes)} sizes; deviations and stability divided by those of {', '.join(STANDARD)} where neither "
          f"has more\nthan {enough} failures, geometric mean; sizes without failures, failures of all")
    rows = [["weight", "method", "factors", "95 %", "worst", "stability", "iterations", "without", "failures"]]
    for variant, lines in variants.items():
        failures = [int(line["failures"]) for line in lines.values()]
        iterations = sum(float(line["mean_iterations"]) for line in lines.values()) / len(lines)
        standards = variants.get(STANDARD, {})
        ratios = (ratio(column, lines, standards, int(enough)) for column in ("p95", "worst", "stability"))
        rows.append([*variant, *ratios, f"{iterations:.2f}", failures.count(0), sum(failures)])
    results.table(rows, left=3)


# ---- Picture


def picture(file, target, regions, modes):
    """Draws deviations over modes for each weight, and the stability over rows, with so many modes, for each method."""
    lines = results.read_csv(file)

    def curve(x, y, **wanted):
        """Columns y over x, sorted by x, of the lines that have all that is wanted; infinite ones are left out."""
        points = sorted((float(line[x]), float(line[y])) for line in lines if line["factors"] == "quadrature"
                        and (x == "rows" or int(line["rows"]) == 2 * int(line["modes"]))
                        and all(line[name] == wish for name, wish in wanted.items()))
        return list(zip(*(point for point in points if math.isfinite(point[1])))) or [[], []]

    regions = regions.split()
    figure, panels = pictures.page(1200, 480 * len(regions), len(regions), 2, squeeze=False)
    for (left, right), region in zip(panels, regions):
        name = "Lower" if region == "low" else "Higher"
        for weight, colour in zip(("mode", "identity", "row-norm"), pictures.COLOURS):
            chosen = {"region": region, "weight": weight, "method": "joint"}
            if curve("modes", "p95", **chosen)[0]:
                left.plot(*curve("modes", "p95", **chosen), color=colour, label=weight)
                left.plot(*curve("modes", "worst", **chosen), "o", color=colour)
        for method, colour in zip(("joint", "qr", "sopt", "exits"), pictures.COLOURS):
            points = curve("rows", "stability", region=region, weight="mode", method=method, modes=modes)
            if points[0]:
                right.plot(*points, "-o", color=colour, label=method)
        left.set(title=f"{name} loaded region: weights, joint, two rows a mode", yscale="log", xlabel="pressure modes",
                 ylabel="deviation of the central film (line: 95 %, marks: worst)")
        right.set(title=f"{name} loaded region: methods, {modes} modes, weight mode", yscale="log", xlabel="rows",
                  ylabel="stability at the worst exit (all rows: 1)")
        pictures.plain_logarithms(right.yaxis)
        left.legend()
        right.legend()
    pictures.save(figure, target)


if __name__ == "__main__":
    results.commands(header, measure, from_truth, table, picture)
