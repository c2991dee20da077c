# SPDX-License-Identifier: GPL-3.0-or-later
"""How accurate elliptical contacts are on as many nodes as a point contact (README.md):

    study.py full FILE.csv RATIOS ALL_M ALL_L [--set key=value ...]
                                     films of contacts of the full model on equal numbers of nodes, and in the limit
    study.py summary FILE.csv        deviations and time over b/a
    study.py reduced FOLDER FILE.csv RATIOS MODES ROWS [--set key=value ...]
                                     models of as many nodes, modes and rows, and their deviations from the full model
"""
import csv
import math
import os
import sys
import tempfile

import numpy as np

import results

X_MIN, X_MAX = -4, 2
NODES = 4753  # of the half of a point contact's domain, 97 by 49, a step of 0.0625
LIMIT = 20, 40  # steps to a half width, from which the limit is extrapolated with order 2

# Of the reduced models: M and L of the training and of the contacts they are tried on.
TRAINED = [15, 18, 21, 25, 30, 35, 42, 50, 55, 60], [4, 5, 6, 7, 8, 9, 10]
UNSEEN = [(M, L) for M in (19.5, 32, 52) for L in (4.6, 8.4)]

COLUMNS = "ratio", "M", "L", "nodes", "H_c", "H_m", "H_c_limit", "H_m_limit", "iterations", "seconds"


def halves(ratio):
    """A and B of the dry ellipse (common/physics/README.md), by the trapezoidal rule with t = tan(angle)^2."""
    angle = np.linspace(0, math.pi / 2, 20001)
    cos, sin = np.cos(angle) ** 2, np.sin(angle) ** 2

    def integral(of):
        return float((of[1:] + of[:-1]).sum() / 2 * angle[1])

    return (integral(2 * cos / np.sqrt(ratio**2 * cos + sin)),
            integral(2 * cos / (ratio**2 * cos + sin) ** 1.5))


class Contact:
    """The ellipse with p_H, R_x, speed and lubricant of the point contact of these M and L."""

    def __init__(self, ratio, M, L, changes):
        along, across = halves(ratio)
        self.M, self.L, self.changes = M * ratio**3 * (2 * along / math.pi) ** 2, L, changes
        self.shape = f"contact: ellipse\nellipticity: {ratio!r}" if ratio != 1 else "contact: point"
        self.y_max = 0.75 * -X_MIN / math.sqrt(ratio**2 * across / along)  # as a grid that is chosen
        self.cell = ratio ** (-1 / 3)

    def steps(self):
        """So many along that there are NODES."""
        return round(math.sqrt(NODES * (X_MAX - X_MIN) * self.cell / self.y_max))

    def lines(self, steps):
        """So many beside Y = 0."""
        return math.ceil(self.y_max * steps / (X_MAX - X_MIN) / self.cell - 0.3)

    def scene(self, steps):
        step = (X_MAX - X_MIN) / steps
        # of an ellipse the lines go on to the first one beyond
        y_max = self.lines(steps) * self.cell * step - (1e-9 if self.cell != 1 else 0)
        return f"""{self.shape}
regime: stationary
moes: {{M: {self.M!r}, L: {self.L}}}
lubricant: {{viscosity: {{law: barus, alpha: 20e-9}}, density: {{law: dowson-higginson}}}}
grid: {{x_min: {X_MIN}, x_max: {X_MAX}, step: {step!r}, y_max: {y_max!r}}}
output: {{fields: false, resolution: false}}
"""

    def solve(self, steps):
        """Films, nodes of the half that is solved, iterations and seconds of processor time."""
        with tempfile.TemporaryDirectory() as work:
            scene, file = f"{work}/scene.yml", f"{work}/result.h5"
            results.write_changed(scene, self.scene(steps))
            before = os.times()
            code = results.run("fullrun", scene, "-q", "-o", file, *self.changes).returncode
            after = os.times()
            if code != results.SOLVED:
                results.stop(f"found M = {self.M:.4g}, L = {self.L}, {steps} steps not solved, expected a solution")
            found = results.solution(file)
        return {"H_c": found["H_c"], "H_m": found["H_min"], "nodes": (steps + 1) * (self.lines(steps) + 1),
                "iterations": found["iterations"],
                "seconds": after.children_user + after.children_system - before.children_user - before.children_system}


def full(path, ratios, all_M, all_L, changes):
    with open(path, "w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS)
        table.writeheader()
        for ratio in ratios:
            for L in all_L:
                for M in all_M:
                    contact = Contact(ratio, M, L, changes)
                    found = contact.solve(contact.steps())
                    coarse, fine = (contact.solve(n * (X_MAX - X_MIN)) for n in LIMIT)
                    table.writerow({"ratio": ratio, "M": M, "L": L, **found,
                                    **{f"{film}_limit": fine[film] + (fine[film] - coarse[film]) / 3
                                       for film in ("H_c", "H_m")}})
                    file.flush()


def summary(path):
    rows = list(csv.DictReader(open(path)))
    print("   b/a   nodes   H_c, per mille: rms, worst   H_m, per mille: rms, worst   iterations   seconds")
    for ratio in dict.fromkeys(row["ratio"] for row in rows):
        of = [{key: float(value) for key, value in row.items()} for row in rows if row["ratio"] == ratio]
        off = {film: np.array([1e3 * (row[film] / row[f"{film}_limit"] - 1) for row in of]) for film in ("H_c", "H_m")}
        texts = [f"{np.sqrt(np.mean(off[film]**2)):15.2f}{off[film][np.abs(off[film]).argmax()]:+13.2f}" for film in off]
        print(f"{float(ratio):6g}{np.mean([row['nodes'] for row in of]):8.0f}{texts[0]}{texts[1]}"
              f"{sum(row['iterations'] for row in of):13.0f}{sum(row['seconds'] for row in of):10.2f}")


def reduced(folder, path, ratios, modes, rows, changes):
    """Models of 70 contacts each, with so many modes and rows, on UNSEEN ones."""
    with open(path, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(("ratio", "H_c_rms", "H_c_worst", "H_m_rms", "H_m_worst", "iterations"))
        for ratio in ratios:
            middle = Contact(ratio, 30, 7, changes)
            steps, name = middle.steps(), f"{folder}/{ratio:g}"
            results.write_changed(f"{name}.yml", middle.scene(steps))
            all_M = [round(middle.M / 30 * M, 6) for M in TRAINED[0]]
            results.write_changed(f"{name}-plan.yml", f"groups:\n  - scene: {os.path.basename(name)}.yml\n"
                                  f"    vary: {{moes.M: {all_M}, moes.L: {TRAINED[1]}}}\n")
            for program, *options in (("snapgen", f"{name}-plan.yml", "-o", f"{name}-s.h5", *changes),
                                      ("podbuild", f"{name}-s.h5", f"--pressure-modes={modes}", "-o", f"{name}-b.h5"),
                                      ("snapgen", f"{name}-plan.yml", "--basis", f"{name}-b.h5", "-o", f"{name}-r.h5",
                                       *changes),
                                      ("deimselect", f"{name}-r.h5", "--basis", f"{name}-b.h5", f"--rows={rows}",
                                       "--no-check", "-o", f"{name}.h5")):
                if results.run(program, *options, "-q", "-f").returncode != results.SOLVED:
                    results.stop(f"{program} {name}: found a failure, expected a file")
            off, iterations = [], 0
            for M, L in UNSEEN:
                settings = [*results.sets({"moes.M": repr(middle.M / 30 * M), "moes.L": L}), "-q", "-f", *changes]
                results.run("fullrun", f"{name}.yml", "-o", f"{name}-full.h5", *settings)
                results.run("romrun", f"{name}.yml", "--model", f"{name}.h5", "--allow-untrusted", "-o",
                            f"{name}-reduced.h5", *settings)
                there, here = (results.solution(f"{name}-{model}.h5") for model in ("full", "reduced"))
                off.append([1e3 * (here[film] / there[film] - 1) for film in ("H_c", "H_min")])
                iterations += here["iterations"]
            off = np.array(off)
            table.writerow([ratio, *(f"{of:.3f}" for film in off.T for of in (
                np.sqrt(np.mean(film**2)), film[np.abs(film).argmax()])), iterations])
            file.flush()


def main():
    command, path, *rest = sys.argv[1:]
    if command == "full":
        ratios, all_M, all_L = ([float(text) for text in texts.split()] for texts in rest[:3])
        full(path, ratios, all_M, all_L, rest[3:])
    elif command == "reduced":
        reduced(path, rest[0], [float(text) for text in rest[1].split()], *rest[2:4], rest[4:])
    else:
        summary(path)


if __name__ == "__main__":
    main()
