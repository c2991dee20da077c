# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the pictures that several scenes need (--help), and sets the style of all pictures.

Each picture is saved as PNG and as SVG. Lines are the full model, marks are the reduced model.
"""
import argparse
import os

import matplotlib
from PIL import Image

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib import ticker  # noqa: E402

import results  # noqa: E402

# Colours that colour-blind people can distinguish (Okabe and Ito), and the marks that are used with them.
BLUE, RED, GREEN, PINK, ORANGE, SKY = COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]
MARKS = ["o", "s", "^", "D", "v", "P"]

plt.rcParams.update({
    "figure.dpi": 100, "savefig.facecolor": "white", "font.size": 11, "svg.fonttype": "none", "svg.hashsalt": "ehdrom",
    "axes.grid": True, "grid.color": "#e0e0e0", "grid.linewidth": 0.7, "axes.axisbelow": True,
    "legend.framealpha": 0.9, "legend.edgecolor": "#bbbbbb", "lines.linewidth": 1.6, "lines.markersize": 5,
    "axes.prop_cycle": matplotlib.cycler(color=COLOURS),
})


def page(width, height, rows=1, columns=1, **options):
    """Returns a figure and its axes, like plt.subplots; width and height are in pixels."""
    return plt.subplots(rows, columns, figsize=(width / 100, height / 100), constrained_layout=True, **options)


def save(figure, file):
    """Saves the figure as a PNG file with 256 colours, and as an SVG file beside it."""
    figure.savefig(file)
    Image.open(file).convert("RGB").quantize().save(file, optimize=True)
    figure.savefig(os.path.splitext(file)[0] + ".svg", metadata={"Date": None})
    plt.close(figure)


def plain_logarithms(axis):
    """Sets the ticks of a logarithmic axis: 1, 2 and 5 in each decade, without exponents."""
    axis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(ticker.NullFormatter())


def pair(axes, full, reduced, every=25, colour=BLUE, mark="o", label=""):
    """Draws two curves of one quantity, each given as x, y: the full model as a line, the reduced model as marks.
    `every` is the number of points from mark to mark (or any markevery of matplotlib)."""
    axes.plot(*full, color=colour, label=f"{label}full model")
    axes.plot(*reduced, mark, color=colour, fillstyle="none", markevery=every, label=f"{label}reduced model")


# ---- Pressure and film of some cases


def profiles(picture, folder, model, cases, x=(-2, 1.5), film=None, step=24):
    """Draws pressure (above) and film (below) of some cases, by default of the first three. x and film are the ranges
    of the axes (film None: automatic), step is the number of nodes between marks."""
    figure, (pressure_axes, film_axes) = page(980, 900, 2, sharex=True)
    for i, case in enumerate(results.find_cases(cases) if cases else results.read_cases()[:3]):
        for kind, style in ("full", "-"), (model, MARKS[i % 6]):
            X, P, H = results.profile(case.file(folder, kind))
            shown = (X >= x[0]) & (X <= x[1])
            for axes, values in (pressure_axes, P), (film_axes, H):
                axes.plot(X[shown], values[shown], style, color=COLOURS[i % 6], fillstyle="none",
                          markevery=(i * step // 3, step), label=case.label if kind == "full" else None)
    film_axes.plot([], [], "k-", label="line: full model")
    film_axes.plot([], [], "ko", fillstyle="none", label="marks: reduced model")
    pressure_axes.set(ylabel="pressure $p/p_H$", xlim=x, ylim=(0, None))
    film_axes.set(xlabel="position $X = x/a$   ($a$: half width of the dry contact)",
                  ylabel="film thickness $H = hR/a^2$", yscale="log", ylim=film)
    film_axes.legend(loc="upper center")
    save(figure, picture)


# ---- A point contact as a map

QUANTITIES = {"pressure": "pressure $p/p_H$", "film_thickness": "film thickness $hR/a^2$"}


def maps(picture, files, title=None, case=None, times=(), width=1200):
    """Draws maps of pressure and film, or of the film at some times: the full model above, the reduced model below.
    `files` are both results or, with a case, the folder of the results and the model. The white line is the exit line.
    The colours of the film range from its smallest value in the first panel of the full model to 2.5 times as much."""
    if case:
        drawn, (folder, model) = results.find_cases([case])[0], files
        title, files = drawn.label, [drawn.file(folder, kind) for kind in ("full", model)]
    panels = [("film_thickness", time) for time in times] or [(name, None) for name in QUANTITIES]
    figure, grid = page(1200, 180 + 1700 / len(panels) if times else 1000, 2, len(panels), sharex=True, sharey=True,
                        dpi=width / 12)
    figure.suptitle(title)
    levels = {"pressure": np.arange(13) / 10}
    for row, file, kind in zip(grid, files, ("full", "reduced")):
        fields = results.printed(file, "x", "y", *QUANTITIES)
        exits = results.farthest_exits(results.printed(file, "exit_position", "y"))
        widths = results.printed(file, "time", "contact_half_width")
        across = "a" if np.isnan(results.value(file, "ellipticity")) else "b"
        row[0].set(ylabel=f"{kind} model      $Y = y/{across}$", xlim=(-2, 1.6), ylim=(-1.7, 1.7))
        for axes, (name, time) in zip(row, panels):
            field, line, half_width = (results.of_time(columns, time) for columns in (fields, exits, widths))
            x, y = np.unique(field["x"]), np.unique(field["y"])
            values = field[name].reshape(len(y), len(x))
            if name not in levels:
                levels[name] = ticker.MaxNLocator(20).tick_values(values.min(), 2.5 * values.min())
            lines = levels[name]
            image = axes.pcolormesh(x, y, values, shading="nearest", vmin=lines[0], vmax=lines[-1], rasterized=True)
            axes.contour(x, y, values, lines[lines > 0], colors="#303030", linewidths=0.8)
            axes.plot(line["exit_position"] / half_width["contact_half_width"], line["y"], "w", linewidth=2.5)
            axes.set_aspect("equal")
            axes.grid(False)
            heading = f"{QUANTITIES[name]}, lines every {lines[1] - lines[0]:.3g}"
            if kind == "full":
                axes.set_title(f"T = {time:g}" if times else heading)
                if not times:
                    figure.colorbar(image, ax=grid[:, panels.index((name, time))], aspect=40, shrink=0.9)
    if times:
        figure.colorbar(image, ax=grid, aspect=40, label=heading)
    for axes in grid[1]:
        axes.set_xlabel("$X = x/a$")
    save(figure, picture)


# ---- A scene in time, in SI units


def in_time(file):
    """Returns times and load of a result, and in SI units central pressure, central film and smallest film."""
    columns = results.printed(file, "time", "load", "central_pressure", "central_film_thickness",
                              "minimum_film_thickness", "hertz_pressure", "film_unit")
    time, load, pressure, centre, smallest, pressure_unit, film_unit = columns.values()
    return time, load, pressure * pressure_unit, centre * film_unit, smallest * film_unit


def scene_in_time(picture, files):
    """Draws load, central pressure and film over time; files: results of the full and of the reduced model."""
    (T, load, pressure, centre, smallest), reduced = map(in_time, files)
    figure, (load_axes, pressure_axes, film_axes) = page(1000, 1000, 3, sharex=True)
    pair(load_axes, (T, load), (reduced[0], reduced[1]))
    pair(pressure_axes, (T, 1e-9 * pressure), (reduced[0], 1e-9 * reduced[2]))
    pair(film_axes, (T, 1e6 * centre), (reduced[0], 1e6 * reduced[3]), label="centre, ")
    pair(film_axes, (T, 1e6 * smallest), (reduced[0], 1e6 * reduced[4]), colour=RED, mark="s", label="smallest, ")
    load_axes.set(ylabel="load / reference", xlim=(T[0], T[-1]))
    pressure_axes.set(ylabel="central pressure / GPa")
    film_axes.set(ylabel="film thickness / µm", xlabel="time  $T = ut/a$")
    for axes in load_axes, film_axes:
        axes.legend()
    save(figure, picture)


# ---- Tables of programs


def runs(picture, files, over, panels, title):
    """Draws columns of a table against the column `over`; files: one table, or the tables of the full and of the
    reduced model. `over` and each panel consist of a column, a factor and a label. A panel may also have the range of
    its axis."""
    tables = [np.genfromtxt(file, delimiter=",", names=True) for file in files]
    name, factor, label = over
    x = [float(factor) * table[name] for table in tables]
    figure, rows = page(1000, 300 * len(panels), len(panels), sharex=True)
    for axes, (name, factor, panel_label, *limits) in zip(rows, panels):
        curves = [(of_x, float(factor) * table[name]) for of_x, table in zip(x, tables)]
        if len(curves) > 1:
            pair(axes, *curves, every=10)
        else:
            axes.plot(*curves[0])
        axes.set(ylabel=panel_label, xlim=(0, x[0][-1]))
        if limits:
            axes.set_ylim(*map(float, limits))
    rows[0].set_title(title)
    if len(files) > 1:
        rows[0].legend(loc="upper right")
    rows[-1].set_xlabel(label)
    save(figure, picture)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    kinds = parser.add_subparsers(required=True)

    kind = kinds.add_parser("profiles", help="pressure and film of some cases")
    kind.add_argument("picture")
    kind.add_argument("folder", help="of full/NUMBER.h5 and MODEL/NUMBER.h5")
    kind.add_argument("model")
    kind.add_argument("cases", nargs="*", help="names or numbers: the first three")
    kind.add_argument("--x", nargs=2, type=float, default=(-2, 1.5), help="range of X")
    kind.add_argument("--film", nargs=2, type=float, help="range of H")
    kind.add_argument("--step", type=int, default=24, help="nodes between marks")
    kind.set_defaults(draw=profiles)

    kind = kinds.add_parser("maps", help="pressure and film of a point contact, or its film at some times")
    kind.add_argument("picture")
    kind.add_argument("files", nargs=2, help="results of full and reduced model; with --case, folder and model")
    kind.add_argument("--title", help="heading, or")
    kind.add_argument("--case", help="the case of cases.csv that it is of, its name or number")
    kind.add_argument("--times", nargs="*", type=float, default=())
    kind.add_argument("--width", type=int, default=1200, help="in pixels")
    kind.set_defaults(draw=maps)

    kind = kinds.add_parser("in-time", help="load, central pressure and film over time")
    kind.add_argument("picture")
    kind.add_argument("files", nargs=2, help="results of full and reduced model")
    kind.set_defaults(draw=scene_in_time)

    kind = kinds.add_parser("runs", help="columns of tables that programs have written")
    kind.add_argument("picture")
    kind.add_argument("files", nargs="+", help="CSV: one, or those of full and reduced model")
    kind.add_argument("--over", nargs=3, metavar=("COLUMN", "FACTOR", "LABEL"), required=True)
    kind.add_argument("--panel", nargs="+", action="append", dest="panels", required=True,
                      help="COLUMN FACTOR LABEL, and the range LOW HIGH if it is given")
    kind.add_argument("--title")
    kind.set_defaults(draw=runs)

    options = vars(parser.parse_args())
    options.pop("draw")(**options)


if __name__ == "__main__":
    main()
