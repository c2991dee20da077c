# SPDX-License-Identifier: GPL-3.0-or-later
"""What adaptive training saves: plans of a region, the curve of deviations over training points, its picture."""
import json
import os

import matplotlib
import numpy as np

import pictures
import results
import truth


def plan(file, scene, m_from, m_to, l_from, l_to, most_alpha_p_H, num_m, num_l, which):
    """Writes a plan of num_m times num_l points of a region, M in equal ratios, L in equal steps: `ends` with those of
    the region's edges, as one would train, `middles` in the middle of as many cells, as one would check."""
    def points(spaced, low, high, count):
        if which == "middles":
            return spaced(float(low), float(high), 2 * int(count) + 1)[1::2]
        return spaced(float(low), float(high), int(count))

    M, L = (", ".join(f"{value:.9g}" for value in values) for values in
            (points(np.geomspace, m_from, m_to, num_m), points(np.linspace, l_from, l_to, num_l)))
    results.write_changed(file, f"""groups:
  - scene: {json.dumps(os.path.abspath(scene))}
    vary:
      moes.M: [{M}]
      moes.L: [{L}]
    where: {{alpha_p_H: [0, {most_alpha_p_H}]}}
""")


def curve(folder, *models):
    """Prints a line of CSV for each calibrated model FOLDER/TRAINING-calibrated.h5: of the last of its sizes, which has
    all modes and rows, and the distance from the truth (of the films in the folder) of this one and of the full model."""
    exact, full = truth.truths(folder), truth.films(f"{folder}/own.h5")
    lines = []
    for model in models:
        training = os.path.basename(model).split("-")[0]
        points = len(results.printed(model, "state_moes_M")["state_moes_M"])
        size = results.printed(model, "position_pressure_modes", "position_rows", "position_failures",
                               "position_seconds")
        modes, rows, failures, seconds = (column[-1] for column in size.values())
        deviations = results.printed(model, "deviation_central_film_thickness")["deviation_central_film_thickness"][-3:]
        own = truth.reduced_films(model, truth.calibrated_scenes(model, full), f"{folder}/scene")
        distances = [*truth.distances(own, exact), *truth.distances({name: full[name] for name in own}, exact)]
        lines.append([training, points, *map(int, (modes, rows, failures)),
                      *(f"{number:.3g}" for number in (*deviations, 1e3 * seconds, *distances))])
    print("training,points,modes,rows,failures,median,p95,worst,milliseconds,"
          "true_worst,true_p95,true_median,full_worst,full_p95,full_median")
    for line in sorted(lines, key=lambda line: line[:2]):
        print(*line, sep=",")


def picture(file, trained, target):
    """Draws deviations over the number of training points, and where the adaptive training put its points."""
    lines = results.read_csv(file)
    figure, (left, right) = pictures.page(1300, 640, 1, 2)
    for training, style, title in (("regular", {"color": pictures.RED, "marker": "s"}, "regular grid"),
                                   ("adaptive", {"color": pictures.BLUE, "marker": "o"}, "adaptive"),
                                   ("published", {"color": "black", "marker": "*"}, "published grid")):
        of = [line for line in lines if line["training"] == training]
        points, p95, worst = ([float(line[name]) for line in of] for name in ("points", "p95", "worst"))
        left.plot(points, worst, label=f"{title}: worst", **style)
        left.plot(points, p95, "--", linewidth=1, fillstyle="none", label=f"{title}: 95 %", **style)
        left.plot(points, [float(line["true_worst"]) for line in of], ":", linewidth=1.6, color=style["color"],
                  label=f"{title}: worst from the truth")
        adaptive = training == "adaptive"  # below its lower curve, the others above their upper ones
        for x, y, line in zip(points, p95 if adaptive else worst, of):
            if line["failures"] != "0":
                left.annotate(line["failures"], (x, y), (0, -14 if adaptive else 5), ha="center",
                              textcoords="offset points", color=style["color"], fontsize=9)
    left.axhline(max(float(line["full_worst"]) for line in lines), color="#888888", linewidth=1,
                 label="full model: worst from the truth")
    left.set(title="All modes that the points support; numbers: scenes that fail", yscale="log", xlim=(0, None),
             xlabel="training points", ylabel="deviation of the central film")
    left.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncol=2, frameon=False, fontsize=9)
    points = results.printed(trained, "moes_M", "moes_L", "training_round")
    shades = matplotlib.colors.LinearSegmentedColormap.from_list("rounds", ["#f0e442", "#56b4e9", "#00306b"])
    shown = right.scatter(points["moes_M"], points["moes_L"], c=points["training_round"], cmap=shades, s=28)
    figure.colorbar(shown, ax=right, label="round")
    right.set(title="Where the adaptive training put its points", xscale="log", xlabel="M", ylabel="L")
    pictures.plain_logarithms(right.xaxis)
    pictures.save(figure, target)


if __name__ == "__main__":
    results.commands(plan, curve, picture)
