# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scripts of the scenes share: runs of the programs, their results, cases.csv, and tables of text.

The folder of the programs is the environment variable BIN (common.mk). Results are read by --print.
"""
import csv
import io
import json
import os
import re
import subprocess
import sys
from types import SimpleNamespace

import numpy as np

from cases import commands, execute, find_cases, read_cases, sets, stop  # noqa: F401, for scripts too

# Exit codes of the programs that leave a result: solved; not converged; not to be trusted.
SOLVED, NOT_CONVERGED, NOT_TRUSTED = 0, 3, 4


# ---- Programs


def run(program, *options, outcomes=(SOLVED, NOT_CONVERGED, NOT_TRUSTED)):
    """Runs a program of the toolchain, or one by its path. Returns its completed process (returncode, stdout, stderr as text);
    ends the script with the program's own message where the exit code is not among the outcomes."""
    file = program if "/" in program else os.path.join(os.environ["BIN"], program)
    try:
        done = subprocess.run([file, *map(str, options)], capture_output=True, text=True)
    except OSError as error:
        stop(f"{file}: found {error.strerror}, expected a program")
    if done.returncode not in outcomes:
        sys.stderr.write(done.stderr)
        sys.exit(done.returncode)
    return done


# ---- Results


def printed(file, *names):
    """Datasets, axes and attributes of a file: for each name an array along the lines of --print, numbers where all are
    numbers, else text. None of the names may lack."""
    text = run("fullrun", "--print", file, *names, outcomes=(SOLVED,)).stdout
    lines = [line for line in csv.reader(io.StringIO(text)) if line]
    columns = dict(zip(lines[0], zip(*lines[1:]) if len(lines) > 1 else [()] * len(lines[0])))
    return {name: _array(values) for name, values in columns.items()}


def _array(texts):
    try:
        return np.array(texts, dtype=float)
    except ValueError:
        return np.array(texts)


def value(file, name, default=np.nan):
    """A single number of a file, or the default where there is none of that name."""
    done = run("fullrun", "--print", file, name, outcomes=range(256))
    lines = done.stdout.split()
    return float(lines[1]) if done.returncode == SOLVED and len(lines) > 1 else default


def model_sizes(file):
    """Sizes of a model: nodes, pressure_modes, deformation_modes (0 if coupled), rows, needed_nodes, states."""
    listed = list(csv.reader(io.StringIO(run("romrun", "--print", file, outcomes=(SOLVED,)).stdout)))
    length = {line[0]: int(line[2]) for line in listed if len(line) > 3 and line[0] == line[3]}  # of the axes
    independent = any(line and line[0] == "elasticity_jacobian" for line in listed)
    return {"nodes": length["x"] * length.get("y", 1), "pressure_modes": length["pressure_mode"],
            "deformation_modes": length["deformation_mode"] if independent else 0, "rows": length["row"],
            "needed_nodes": length["needed_node"], "states": length["state"]}


def listed_models(file):
    """The models that a list of models names (schemas/models.md), or the one model."""
    if not file.endswith((".yml", ".yaml")):
        return [file]
    with open(file) as source:
        names = re.search(r"^models: *\[(.*)\]", source.read(), re.M)
    if not names:
        stop(f"{file}: found no models: [NAME, ...] on a line, expected one")
    return [os.path.join(os.path.dirname(file), name.strip()) for name in names[1].split(",")]


def planned_scenes(model):
    """The scenes (mappings of settings) of the plan that a model was calibrated on, also those that the plan's conditions
    leave out. The model's text names the settings of the first one, then what changes from one to the next
    (schemas/plan.md)."""
    text = printed(model, "settings")["settings"][0].partition("# calibrated on")[2]
    scenes, scene = [], {"discretization": "published"}  # of models that name none
    for point in text.split("# point")[1:]:
        lines = (line.partition(":") for line in point.splitlines()[1:] if line and not line.startswith("#"))
        scene = {**scene, **{key: value.strip() for key, _, value in lines}}
        scenes.append({key: value for key, value in scene.items() if value})
    return scenes


def reduced_film(file, model, *size):
    """Exit code and central film (None where there is none) of romrun with a scene; options, such as the size. A film
    that is only indicated to be far off counts as solved."""
    done = run("romrun", file, "--model", model, "--quiet", *size)
    film = re.search(r"^central film thickness *(\S+)", done.stdout, re.M)
    code = SOLVED if "found an indicated deviation" in done.stderr else done.returncode
    return code, float(film[1]) if film and code != NOT_CONVERGED else None


def solution(file):
    """The numbers of a stationary solution: status, iterations, seconds, H_c and H_min (central and smallest film)."""
    names = {"status": "status", "iterations": "newton_iterations", "seconds": "solve_seconds",
             "H_c": "central_film_thickness", "H_min": "minimum_film_thickness"}
    columns = printed(file, *names.values())
    return {name: float(columns[dataset][0]) for name, dataset in names.items()}


def of_time(columns, time=None):
    """Of printed() columns the lines of one time, or of the last; all of them where there is one only."""
    if "time" not in columns:
        return columns
    times = columns["time"]
    nearest = times[-1] if time is None else times[np.argmin(np.abs(times - time))]
    if time is not None and abs(nearest - time) > 1e-6:
        stop(f"found no fields at T = {time:g}, expected some: the nearest are at {nearest:g}")
    return {name: values[times == nearest] for name, values in columns.items()}


def profile(file, time=None):
    """X, P and H of a time (the last); of a point contact on the line Y = 0."""
    columns = of_time(printed(file, "x", "pressure", "film_thickness"), time)
    keep = columns.get("y", np.zeros(len(columns["x"]))) == 0
    return [columns[name][keep] for name in ("x", "pressure", "film_thickness")]


def farthest_exits(columns):
    """Of printed() columns with exit_position the lines of the exit that lies farthest downstream, the first one: of
    an entrainment that reverses a result has several, of others one."""
    keep = columns.get("exit", np.zeros(len(columns["exit_position"]))) == 0
    return {name: values[keep] for name, values in columns.items()}


# ---- In time


def read_trajectory(file):
    """A transient result, also of a run that stopped early, as attributes: code (exit code of the run); steps;
    rejected, newton and seconds, NaN of a run that stopped early; and over time: time, load, P_c, H_c, H_min (factors
    and numbers of the reference frame)."""
    columns = printed(file, "time", "load", "central_pressure", "central_film_thickness", "minimum_film_thickness",
                      "status")
    early = value(file, "complete") == 0
    rejected, newton, seconds = [np.nan] * 3 if early else [
        value(file, name) for name in ("rejected_steps", "total_newton_iterations", "solve_seconds")]
    return SimpleNamespace(
        code=NOT_CONVERGED if early else NOT_TRUSTED if NOT_TRUSTED in columns["status"] else SOLVED,
        steps=max(len(columns["time"]) - 1, 0), rejected=rejected, newton=newton, seconds=seconds,
        **dict(zip(("time", "load", "P_c", "H_c", "H_min"), columns.values())))


def trajectory(result, program, *options):
    """Runs a transient scene (the first of the options) into a result, RESULT.partial of a run that stops early.
    Returns read_trajectory with message (on stderr, mostly none) and formulas (words of each line of --formulas)."""
    done = run(program, *options, "-o", result, "--force", "--quiet")
    found = read_trajectory(f"{result}.partial" if done.returncode == NOT_CONVERGED else result)
    found.code, found.message = done.returncode, done.stderr.strip()
    found.formulas = [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("formula ")]
    return found


def deviations(reference, other, column):
    """Relative deviations of a column of a trajectory at its times from another one's, NaN where that has none."""
    return getattr(other, column) / at_times(reference.time, getattr(reference, column), other.time) - 1


def at_times(times, values, wanted):
    """Values at other times, by the cubic through four times around (exact at the times themselves); NaN outside."""
    if len(times) < 4:
        return np.full(len(wanted), np.nan)
    wanted = np.asarray(wanted, dtype=float)
    first = np.clip(np.searchsorted(times, wanted, side="right") - 2, 0, len(times) - 4)
    result = np.zeros(len(wanted))
    for i in range(4):
        weight = np.ones(len(wanted))
        for j in range(4):
            if j != i:
                weight *= (wanted - times[first + j]) / (times[first + i] - times[first + j])
        result += weight * values[first + i]
    result[(wanted < times[0]) | (wanted > times[-1])] = np.nan
    return result


# ---- Tables


def write_csv(file, header, rows):
    with open(file, "w", newline="") as target:
        writer = csv.writer(target, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)


def write_changed(file, text):
    """Writes a text where it is another one than the file's, lest make takes what follows from it for old."""
    if not os.path.exists(file) or open(file).read() != text:
        with open(file, "w") as target:
            target.write(text)


def kept(file, compute, *sources):
    """What compute() returned when the file was written with it as JSON, where that is newer than the sources; else it
    is computed and written now. An interrupted study so goes on where it was."""
    if not os.path.exists(file) or any(os.path.getmtime(file) < os.path.getmtime(source) for source in sources):
        found = compute()
        with open(f"{file}.new", "w") as target:
            json.dump(found, target)
        os.replace(f"{file}.new", file)
    with open(file) as source:
        return json.load(source)


def rule(width):
    return "-" * width


def table(rows, left=1):
    """Prints rows of cells in columns as wide as they need, the first so many to the left; None: a line across."""
    texts = [row if row is None else [str(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*(row for row in texts if row))]
    for row in texts:
        cells = [text.ljust(width) if i < left else text.rjust(width)
                 for i, (text, width) in enumerate(zip(row or (), widths))]
        print(rule(sum(widths) + 2 * len(widths) - 2) if row is None else "  ".join(cells).rstrip())


def read_csv(file):
    """Lines of a CSV file under a header, each a dictionary of texts."""
    with open(file, newline="") as source:
        return list(csv.DictReader(source))
