# SPDX-License-Identifier: GPL-3.0-or-later
"""Distance from the solution of the equations against the time that it takes (README.md):

    study.py measure OUT MODES STEPS    prints a table and leaves OUT/truth.csv
    study.py draw OUT                   draws OUT/truth.png, .svg

Scenes lie between the training points. Their truth is that of the accurate rows on a long inlet, extrapolated from the
two finest steps.
"""
import os
import sys

import numpy as np

import pictures
import results

SCENES = [(M, L) for M in (9.5, 12.5, 17.5, 21, 25.5, 31, 38, 47, 58, 72, 89) for L in (2, 4.8, 7.8, 10.8, 13.5)]
TRUTH = {"discretization": "accurate", "grid.x_min": -16, "grid.x_max": 2}
TRUTH_STEPS = 0.0025, 0.00125
DOMAIN = {"grid.x_min": -8, "grid.x_max": 2}  # of the full model, as the training has it
REPEAT = 5
HEADER = ["way", "position", "film", "scenes", "worst", "median", "seconds"]


def solved(folder, name, program, settings, *options):
    """Films, seconds and formulas of all scenes."""
    def run():
        print(f"  measure    {name}", file=sys.stderr)
        found = []
        for M, L in SCENES:
            done = results.run(program, "scene.yml", "-o", f"{folder}/run.h5", "--force", "--quiet", *options,
                               *results.sets({"moes.M": M, "moes.L": L, "output.fields": "false", **settings}))
            words = [line.split() for line in done.stdout.splitlines() if line.startswith("formula ")]
            found.append({**results.solution(f"{folder}/run.h5"),
                          "formulas": [(word[1], word[2], float(word[3]), 1e-9 * float(word[6])) for word in words]})
        return found
    return results.kept(f"{folder}/{name}.json", run, "scene.yml", f"{folder}/../model.h5",
                        os.path.join(os.environ["BIN"], program))


def errors(records, truth, film):
    """Relative errors of the scenes that are solved."""
    return np.array([abs(record[film] / exact[film] - 1) for record, exact in zip(records, truth)
                     if record["status"] != 1])


def measure(out, modes, steps):
    folder = f"{out}/ways"
    os.makedirs(folder, exist_ok=True)
    coarse, fine = (solved(folder, f"truth-{step}", "fullrun", {**TRUTH, "grid.step": step, "output.resolution": "false"})
                    for step in TRUTH_STEPS)
    truth = [{film: b[film] + (b[film] - a[film]) / 3 for film in ("H_c", "H_min")} for a, b in zip(coarse, fine)]
    sure = max(abs(b[film] / exact[film] - 1) for b, exact in zip(fine, truth) for film in exact)

    ways = {}
    for rows in "published", "accurate":
        for step in steps.split():
            settings = {"discretization": rows, **DOMAIN, "grid.step": step, "output.resolution": "false"}
            ways["full, " + rows, step] = solved(folder, f"{rows}-{step}", "fullrun", settings, "--repeat", REPEAT,
                                                 "--formulas")
    for size in modes.split():
        rows = round(1.6 * int(size))
        ways["reduced", size] = solved(folder, f"reduced-{size}", "romrun", {}, "--model", f"{out}/model.h5",
                                       "--pressure-modes", size, "--rows", rows, "--repeat", REPEAT)
    lines = []
    for (way, position), records in ways.items():
        for film in "H_c", "H_min":
            off = errors(records, truth, film)
            if len(off):
                lines.append([way, position, film, len(off), off.max(), np.median(off),
                              np.median([record["seconds"] for record in records])])
    formulas = {}
    for record, exact in zip(ways["full, accurate", steps.split()[-1]], truth):
        for name, quantity, film, seconds in record["formulas"]:
            key = "H_min" if quantity == "minimum" else "H_c"
            formulas.setdefault((name, key), []).append((abs(film / exact[key] - 1), seconds))
    for (name, film), pairs in formulas.items():
        off, seconds = np.transpose(pairs)
        lines.append(["formula", name, film, len(off), off.max(), np.median(off), np.median(seconds)])
    results.write_csv(f"{out}/truth.csv", HEADER, lines)
    print(f"{len(SCENES)} scenes; the truth is extrapolated by {sure:.1e} at most")
    results.table([["way", "step, modes", "film", "scenes", "worst", "median", "time"], None]
                  + [[*line[:3], str(line[3]), f"{line[4]:.1e}", f"{line[5]:.1e}", f"{1e3 * line[6]:.3g} ms"]
                     for line in lines], 3)


SERIES = [("film formulas", "formula", "o", "black"), ("full model, published rows", "full, published", "s", pictures.RED),
          ("full model, accurate rows", "full, accurate", "^", pictures.GREEN),
          ("reduced model of the accurate rows", "reduced", "D", pictures.BLUE)]


def draw(out):
    lines = results.read_csv(f"{out}/truth.csv")
    figure, panels = pictures.page(1100, 520, columns=2, sharey=True)
    for axes, film, name in zip(panels, ("H_c", "H_min"), ("central film", "smallest film")):
        for label, way, mark, colour in SERIES:
            points = [[float(line[key]) for key in ("seconds", "worst", "median")] for line in lines
                      if line["way"] == way and line["film"] == film]
            if not points:
                continue
            seconds, worst, median = np.transpose(points)
            axes.vlines(seconds, median, worst, color=colour)
            axes.plot(seconds, worst, mark, color=colour, label=label)
        axes.set(xscale="log", yscale="log", xlabel="time of a solution / s", title=name, xlim=(1e-8, 1), ylim=(3e-5, 1))
    panels[0].set_ylabel("distance from the truth: worst scene (mark), median (end)")
    panels[1].legend(loc="lower left", frameon=False, fontsize=9)
    pictures.save(figure, f"{out}/truth.png")


if __name__ == "__main__":
    results.commands(measure, draw)
