# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that the scripts of all scenes use: they run the programs, read results and cases.csv, and print tables.

The environment variable BIN is the folder of the programs (common.mk). Results are read with --print.
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

# Exit codes of programs that have written a result: solved; not converged; not trusted.
SOLVED, NOT_CONVERGED, NOT_TRUSTED = 0, 3, 4


# ---- Programs


def run(program, *options, outcomes=(SOLVED, NOT_CONVERGED, NOT_TRUSTED), limit=None):
    """Runs a program of the toolchain, or a program with a path. Returns the completed process (returncode, and stdout
    and stderr as text). For an exit code outside of `outcomes`, prints the program's message and ends the script.
    After `limit` seconds ends the program and raises subprocess.TimeoutExpired."""
    file = program if "/" in program else os.path.join(os.environ["BIN"], program)
    try:
        done = subprocess.run([file, *map(str, options)], capture_output=True, text=True, timeout=limit)
    except OSError as error:
        stop(f"{file}: found {error.strerror}, expected a program")
    if done.returncode not in outcomes:
        sys.stderr.write(done.stderr)
        sys.exit(done.returncode)
    return done


# ---- Results


def printed(file, *names):
    """Returns datasets, axes and attributes of a file: for each name an array with an entry for each line of --print.
    An array has numbers if all of its entries are numbers, otherwise texts. All names have to exist in the file."""
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
    """Returns a single number of a file, or the default if the file has no number of this name."""
    done = run("fullrun", "--print", file, name, outcomes=range(256))
    lines = done.stdout.split()
    return float(lines[1]) if done.returncode == SOLVED and len(lines) > 1 else default


def model_sizes(file):
    """Returns sizes of a model: nodes, pressure_modes, deformation_modes (0 if coupled), rows, needed_nodes, states."""
    listed = list(csv.reader(io.StringIO(run("romrun", "--print", file, outcomes=(SOLVED,)).stdout)))
    length = {line[0]: int(line[2]) for line in listed if len(line) > 3 and line[0] == line[3]}  # lines of axes
    independent = any(line and line[0] == "elasticity_jacobian" for line in listed)
    return {"nodes": length["x"] * length.get("y", 1), "pressure_modes": length["pressure_mode"],
            "deformation_modes": length["deformation_mode"] if independent else 0, "rows": length["row"],
            "needed_nodes": length["needed_node"], "states": length["state"]}


def listed_models(file):
    """Returns the files of all models of a list (schemas/models.md), or the file itself if it is one model."""
    if not file.endswith((".yml", ".yaml")):
        return [file]
    with open(file) as source:
        names = re.search(r"^models: *\[(.*)\]", source.read(), re.M)
    if not names:
        stop(f"{file}: found no models: [NAME, ...] on a line, expected one")
    return [os.path.join(os.path.dirname(file), name.strip()) for name in names[1].split(",")]


def planned_scenes(model):
    """Returns the scenes (mappings of settings) of the plan on which a model was calibrated, including scenes that the
    conditions of the plan exclude. The model contains the settings of the first scene as text, and for each further
    scene the settings that differ from the scene before (schemas/plan.md)."""
    text = printed(model, "settings")["settings"][0].partition("# calibrated on")[2]
    scenes, scene = [], {"discretization": "published"}  # if the model names no discretisation
    for point in text.split("# point")[1:]:
        lines = (line.partition(":") for line in point.splitlines()[1:] if line and not line.startswith("#"))
        scene = {**scene, **{key: value.strip() for key, _, value in lines}}
        scenes.append({key: value for key, value in scene.items() if value})
    return scenes


def reduced_film(file, model, *size):
    """Runs romrun with a scene; `size` are options, such as the size of the model. Returns exit code and central film
    (None if there is none). The exit code is SOLVED if romrun flags the result only for its estimated error."""
    done = run("romrun", file, "--model", model, "--quiet", *size)
    film = re.search(r"^central film thickness *(\S+)", done.stdout, re.M)
    code = SOLVED if "found an indicated deviation" in done.stderr else done.returncode
    return code, float(film[1]) if film and code != NOT_CONVERGED else None


def solution(file):
    """Returns numbers of a stationary solution: status, iterations, seconds, H_c and H_min (smallest film)."""
    names = {"status": "status", "iterations": "newton_iterations", "seconds": "solve_seconds",
             "H_c": "central_film_thickness", "H_min": "minimum_film_thickness"}
    columns = printed(file, *names.values())
    return {name: float(columns[dataset][0]) for name, dataset in names.items()}


def of_time(columns, time=None):
    """Selects the lines of one time from the columns of printed(); by default the last time. A file without times is
    returned as a whole."""
    if "time" not in columns:
        return columns
    times = columns["time"]
    nearest = times[-1] if time is None else times[np.argmin(np.abs(times - time))]
    if time is not None and abs(nearest - time) > 1e-6:
        stop(f"found no fields at T = {time:g}, expected some: the nearest are at {nearest:g}")
    return {name: values[times == nearest] for name, values in columns.items()}


def profile(file, time=None):
    """Returns X, P and H at a time, by default the last; for a point contact on the line Y = 0."""
    columns = of_time(printed(file, "x", "pressure", "film_thickness"), time)
    keep = columns.get("y", np.zeros(len(columns["x"]))) == 0
    return [columns[name][keep] for name in ("x", "pressure", "film_thickness")]


def farthest_exits(columns):
    """Selects the lines of the exit that lies farthest downstream from the columns of printed() with exit_position.
    This is the first exit. A result has several exits only if the entrainment reverses."""
    keep = columns.get("exit", np.zeros(len(columns["exit_position"]))) == 0
    return {name: values[keep] for name, values in columns.items()}


# ---- In time


def read_trajectory(file):
    """Returns a transient result as attributes: code (exit code of the run), steps, rejected, newton and seconds; over
    time: time, load (a factor), and P_c, H_c, H_min in the reference frame. The run may have stopped early; rejected,
    newton and seconds are then NaN."""
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
    """Runs a transient scene (the first of the options) and writes a result; if the run stops early, this is
    RESULT.partial. Returns read_trajectory with two more attributes: message (text on stderr, usually empty) and
    formulas (the words of each line of --formulas)."""
    done = run(program, *options, "-o", result, "--force", "--quiet")
    found = read_trajectory(f"{result}.partial" if done.returncode == NOT_CONVERGED else result)
    found.code, found.message = done.returncode, done.stderr.strip()
    found.formulas = [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("formula ")]
    return found


def deviations(reference, other, column):
    """Returns the relative deviations of a column of the trajectory `other` from `reference`, at the times of `other`;
    NaN at times that the reference does not have."""
    return getattr(other, column) / at_times(reference.time, getattr(reference, column), other.time) - 1


def at_times(times, values, wanted):
    """Interpolates values at the wanted times, by the cubic through the four times around; NaN outside. At the given
    times the interpolation is exact."""
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
    """Writes a text to a file if the file has another text. Otherwise the file keeps its time, so that make does not
    repeat the work that depends on it."""
    if not os.path.exists(file) or open(file).read() != text:
        with open(file, "w") as target:
            target.write(text)


def kept(file, compute, *sources):
    """Returns the result of compute(). If the file is newer than the sources, the result is read from this file (JSON).
    Otherwise it is computed and written to the file. So an interrupted study continues where it was."""
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
    """Prints rows of cells in columns of the required width. The first `left` columns are aligned left, the others
    right. A row None is a horizontal line."""
    texts = [row if row is None else [str(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*(row for row in texts if row))]
    for row in texts:
        cells = [text.ljust(width) if i < left else text.rjust(width)
                 for i, (text, width) in enumerate(zip(row or (), widths))]
        print(rule(sum(widths) + 2 * len(widths) - 2) if row is None else "  ".join(cells).rstrip())


def read_csv(file):
    """Returns the lines of a CSV file below its header, each as a dictionary of texts."""
    with open(file, newline="") as source:
        return list(csv.DictReader(source))
