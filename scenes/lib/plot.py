# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a file of the programs, for their option --plot:

    plot.py FORMAT FILE [COLUMN COLUMN] > PICTURE

FORMAT is png, svg or pdf. A result becomes pressure and film, in time also histories; a training its points; a basis
also its singular values; a model also its selected equations, and its errors over the computing time. Of a table of
cases, HDF5 or CSV, two columns are drawn. Units are SI units if the file has them. Exit codes: 65 (the file has nothing
to draw), 69 (a Python package is missing).
"""
import csv
import sys

try:
    import h5py
    import numpy as np

    import pictures
except ImportError as missing:
    sys.stderr.write(f"found no Python package {missing.name}, expected it (Debian: python3-{missing.name.lower()})\n")
    sys.exit(69)

DATA = 65


def stop(code, text):
    sys.stderr.write(text + "\n")
    sys.exit(code)


class Units:
    """Factors and labels of lengths, films, pressures and times: SI units, or dimensionless without a length."""

    def __init__(self, file):
        def get(name):
            return float(file.attrs.get(name, np.nan))
        self.si = np.isfinite(get("half_width"))
        si = self.si
        self.length, self.x = (1e3 * get("half_width"), "x / mm") if si else (1, "$X = x/a$")
        self.film, self.h = (1e6 * get("film_unit"), "film / µm") if si else (1, "film $H = hR/a^2$")
        self.pressure, self.p = (1e-9 * get("hertz_pressure"), "pressure / GPa") if si else (1, "pressure $p/p_H$")
        self.time, self.t = (1e3 * get("time_unit"), "time / ms") if si else (1, "time $T = ut/a$")


# ---- results


def line(file, units):
    """Pressure and film of a stationary line contact, with the spike enlarged."""
    figure, (above, below) = pictures.page(900, 800, 2, sharex=True)
    x, pressure, film = (file[name][...].squeeze() for name in ("x", "pressure", "film_thickness"))
    exit_position = float(file["exit_position"][...].flat[0]) * units.length
    x, pressure, film = x * units.length, pressure * units.pressure, film * units.film
    shown = (x >= -2 * units.length) & (x <= max(1.5 * units.length, 1.2 * exit_position))
    above.plot(x[shown], pressure[shown])
    below.plot(x[shown], film[shown], color=pictures.RED)
    for axes in above, below:
        axes.axvline(exit_position, color="#808080", linestyle=":")
    above.annotate("exit", (exit_position, 0.9 * pressure.max()), color="#606060", rotation=90, ha="right", va="top")
    above.set(ylabel=units.p, ylim=(0, 1.15 * pressure.max()))
    below.set(ylabel=units.h, xlabel=units.x, ylim=(0, min(3 * film[np.abs(x).argmin()], film[shown].max())))
    spike = (x > 0.5 * units.length) & (x < exit_position)
    if spike.any():
        top = x[spike][pressure[spike].argmax()]
        near = np.abs(x - top) < 0.1 * units.length
        inset = above.inset_axes((0.05, 0.5, 0.26, 0.4))
        inset.plot(x[near], pressure[near], ".-", markersize=3)
        inset.set_title("spike", fontsize=9)
        inset.tick_params(labelsize=7)
    return figure


def area(file, units):
    """Film of a stationary point contact as a map, and both quantities along both axes."""
    figure, panels = pictures.page(1100, 900, 2, 2)
    x, y = (file[name][...] * units.length for name in ("x", "y"))
    ellipticity = float(file.attrs.get("ellipticity", 1))
    y = y * ellipticity if units.si else y
    pressure, film = (file[name][...].reshape(len(y), len(x)) * factor for name, factor in
                      (("pressure", units.pressure), ("film_thickness", units.film)))
    least = film.min()
    for axes, values, label, limits in ((panels[0, 0], film, units.h, (least, 3 * least)),
                                        (panels[0, 1], pressure, units.p, (0, pressure.max()))):
        image = axes.pcolormesh(x, y, values, shading="nearest", vmin=limits[0], vmax=limits[1], rasterized=True)
        axes.contour(x, y, values, np.linspace(*limits, 13)[1:], colors="#303030", linewidths=0.6)
        axes.set(xlabel=units.x, ylabel=units.x.replace("x", "y").replace("X", "Y"),
                 xlim=(-1.8 * units.length, 1.6 * units.length))
        axes.set_ylim(-1.6 * units.length * (ellipticity if units.si else 1),
                      1.6 * units.length * (ellipticity if units.si else 1))
        axes.set_aspect("equal")
        axes.grid(False)
        figure.colorbar(image, ax=axes, label=label)
    middle, centre = np.abs(y).argmin(), np.abs(x).argmin()
    for axes, values, label, colour in ((panels[1, 0], film, units.h, pictures.RED),
                                        (panels[1, 1], pressure, units.p, pictures.BLUE)):
        axes.plot(x, values[middle], color=colour, label="along the entrainment")
        axes.plot(y, values[:, centre], "--", color=colour, label="across")
        axes.set(xlabel="x, y / mm" if units.si else "$X$, $Y$", ylabel=label, xlim=(-1.8 * units.length, 1.8 * units.length))
        axes.legend()
    panels[1, 0].set_ylim(0, 3 * film[middle, centre])
    panels[1, 1].set_ylim(0, None)
    return figure


def in_time(file, units):
    """Load, central pressure and films over time, and the film of a line contact over place and time."""
    time = file["time"][...] * units.time
    has_map = "film_thickness" in file and "y" not in file and file["film_thickness"].shape[0] == len(time)
    figure, panels = pictures.page(900, 1150 if has_map else 850, 4 if has_map else 3, sharex=True)
    panels[0].plot(time, file["load"][...])
    panels[0].set(ylabel="load / reference", ylim=(0, None))
    panels[1].plot(time, file["central_pressure"][...] * units.pressure)
    panels[1].set(ylabel="central " + units.p, ylim=(0, None))
    for name, label in (("central_film_thickness", "centre"), ("minimum_film_thickness", "smallest")):
        panels[2].plot(time, file[name][...] * units.film, label=label)
    panels[2].set(ylabel=units.h, ylim=(0, None))
    panels[2].legend()
    if has_map:
        # fields are in the units of the contact at each time
        width, unit = (file[name][...][:, None] for name in ("contact_half_width", "frame_film_unit"))
        x = file["x"][...] * width * units.length
        film = file["film_thickness"][...] * unit * units.film
        least = np.nanmin(film)
        image = panels[3].pcolormesh(np.broadcast_to(time[:, None], x.shape), x, film, shading="nearest", vmin=least,
                                     vmax=3 * least, rasterized=True)
        panels[3].set(ylabel=units.x, ylim=(-1.5 * units.length, 1.5 * units.length))
        panels[3].grid(False)
        figure.colorbar(image, ax=panels[3], label=units.h)
    panels[-1].set_xlabel(units.t)
    return figure


# ---- trainings and models


def draw_points(figure, axes, M, pressure, colour, label):
    """Points of a training in the plane of M and alpha p_H, in which its range is a convex hull."""
    if colour is None:
        axes.plot(M, pressure, "o")
    else:
        points = axes.scatter(M, pressure, c=np.log10(np.maximum(np.abs(colour), 1e-12)), cmap="viridis")
        figure.colorbar(points, ax=axes, label=f"log10 of {label}")
    axes.set(xlabel="Moes load number M", ylabel=r"$\alpha p_H$", xscale="log")
    axes.set_title(f"{len(M)} training points")


def training(file):
    """Points of snapshots, with the effect of the grid on the central film."""
    figure, axes = pictures.page(800, 600)
    effect = file["step_effect"][...] if "step_effect" in file else None
    draw_points(figure, axes, file["moes_M"][...], file["alpha_p_H"][...], effect, "the grid's effect on the film")
    return figure


def model(file):
    """Points, singular values, selected equations, and errors over computing time: those that the file has."""
    parts = ["points"] if "state_moes_M" in file else []
    parts += ["values"] if "pressure_singular_values" in file else []
    parts += ["rows"] if "selected_row" in file and "x" in file and "y" not in file else []
    parts += ["trade"] if "position_seconds" in file else []
    if not parts:
        stop(DATA, "found nothing to draw in this file, expected points, singular values, rows or errors")
    figure, panels = pictures.page(900, 420 * len(parts), len(parts), squeeze=False)
    for axes, part in zip(panels[:, 0], parts):
        if part == "points":
            effect = file["state_step_effect"][...] if "state_step_effect" in file else None
            draw_points(figure, axes, file["state_moes_M"][...], file["state_alpha_p_H"][...], effect,
                        "the grid's effect on the film")
        elif part == "values":
            values = file["pressure_singular_values"][...]
            axes.semilogy(np.arange(1, len(values) + 1), values / values[0], ".-")
            axes.set(xlabel="mode", ylabel="singular value / first")
        elif part == "rows":
            rows, x = file["selected_row"][...], file["x"][...]
            weights = file["row_weight"][...] if "row_weight" in file else np.ones(len(rows))
            axes.vlines(x[rows], 0, weights)
            axes.set(xlabel="$X = x/a$", ylabel="weight", ylim=(0, None))
            axes.set_title(f"{len(rows)} selected equations")
        else:
            seconds = file["position_seconds"][...] * 1e3
            for name, label in (("deviation_central_film_thickness", "central film"),
                                ("deviation_minimum_film_thickness", "minimum film"),
                                ("deviation_pressure", "pressure")):
                if name in file:
                    axes.loglog(seconds, file[name][..., -1], "o", fillstyle="none", label=label)
            axes.set(xlabel="time of a solution / ms", ylabel="largest error of a check scene")
            axes.legend()
    return figure


# ---- tables


def read_table(path):
    """Returns the header and the rows of a CSV file, by the rules of the programs (csv.h)."""
    with open(path, newline="", encoding="utf-8-sig") as file:
        lines = [line for line in file if line.strip() and not line.lstrip().startswith("#")]
    separator = next((mark for mark in ",;\t" if lines and mark in lines[0]), ",")
    known, *rows = [[field.strip() for field in row] for row in csv.reader(lines, delimiter=separator)] or [[]]
    return known, [row for row in rows if len(row) == len(known)]


def find(name, known):
    """Returns the column of a name, which may lack the unit in brackets and the first part of a key."""
    for short in (lambda column: column, lambda column: column.split(" [")[0],
                  lambda column: column.split(" [")[0].split(".")[-1]):
        for column in known:
            if short(column) == name:
                return column
    stop(DATA, f"found no column {name}, expected one of {', '.join(known)}")


def number(text):
    try:
        return float(text.replace(",", "."))
    except ValueError:
        return np.nan


def table(path, names):
    """Draws the second column over the first."""
    if path.endswith((".h5", ".hdf5")):
        with h5py.File(path) as file:
            known = [name for name in file if file[name].ndim == 1 and file[name].dtype.kind in "fi"]
            names = [find(name, known) for name in names]
            columns = {name: file[name][...] for name in names}
    else:
        known, rows = read_table(path)
        names = [find(name, known) for name in names]
        columns = {name: np.array([number(row[known.index(name)]) for row in rows]) for name in names}
    figure, axes = pictures.page(900, 600)
    axes.plot(columns[names[0]], columns[names[1]], "o", fillstyle="none")
    axes.set(xlabel=names[0], ylabel=names[1])
    return figure


def draw(path, names):
    if names:
        return table(path, names)
    with h5py.File(path) as file:
        kind = str(file.attrs.get("schema_name", b""), "ascii") if isinstance(
            file.attrs.get("schema_name"), bytes) else str(file.attrs.get("schema_name", ""))
        if kind == "ehdrom-result":
            units = Units(file)
            if len(file["time"]) > 1:
                return in_time(file, units)
            if "pressure" not in file:
                stop(DATA, "found no fields, expected a result with output.fields = true")
            return area(file, units) if "y" in file else line(file, units)
        if kind == "ehdrom-snapshots":
            return training(file)
        if kind in ("ehdrom-basis", "ehdrom-model"):
            return model(file)
        if kind == "ehdrom-cases":
            stop(DATA, "found a table of cases, expected also the names of two of its columns")
        stop(DATA, f"found {kind or 'no schema_name'}, expected a result, snapshots, a basis or a model")


def main(format, path, *names):
    try:
        figure = draw(path, names)
    except OSError:
        stop(DATA, "found no HDF5 file, expected a result, snapshots, a basis or a model")
    except (KeyError, ValueError, IndexError, UnicodeDecodeError) as error:
        stop(DATA, f"found a file that cannot be drawn ({error}), expected one that the programs have written")
    figure.savefig(sys.stdout.buffer, format=format, metadata={"Date": None} if format == "svg" else None)


main(*sys.argv[1:])
