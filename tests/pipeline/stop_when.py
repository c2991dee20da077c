#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stops a program while it writes: stop_when.py SIGNAL CONDITION OUTPUT COMMAND...

Sends the signal as soon as the condition holds:
    exists         OUTPUT.partial exists
    bytes NUMBER   OUTPUT.partial has at least so many bytes
    marks NUMBER   OUTPUT.resume, of a table of cases, has at least so many marks
    says PATTERN   the file "log" matches a regular expression
    EXPRESSION     a Python expression of OUTPUT.partial: `states`, the finished points of a training, `time`, the
                   times of a run, and `checkpoint`, how many of these a resumed run keeps

A run that ends before the signal, because the machine is busy, is repeated. What a reader sees of a growing file is
checked on the way.

The exit code is the program's, 128 + N after a deadly signal N. After the signal STOP the program
stays as it is, and its process id is printed.
"""
import os
import re
import shutil
import signal
import subprocess
import sys
import time as clock

os.environ["HDF5_USE_FILE_LOCKING"] = "FALSE"
import h5py
import numpy

LIMIT = 900  # s, enough on a busy machine


def read(path):
    with h5py.File(path, "r", libver="latest", swmr=True) as file:
        seen = {"states": int((file["status"][...] >= 0).sum())}
        if "restart_entries" in file:
            seen["time"] = file["time"][...]
            seen["film"] = file["central_film_thickness"][...][: len(seen["time"])]
            seen["checkpoint"] = int(file["restart_entries"][...].max())
        return seen


def holds(condition, path, before):
    if condition == "exists":
        return os.path.exists(path)
    if condition.startswith("bytes "):
        return os.path.exists(path) and os.path.getsize(path) >= int(condition.split()[1])
    if condition.startswith("marks "):
        marks = path.replace(".partial", ".resume")
        if not os.path.exists(marks):
            return False
        with open(marks) as file:
            return len(re.findall(r"^[0-9]+ [0-9a-f]{64}$", file.read(), re.M)) >= int(condition.split()[1])
    if condition.startswith("says "):
        with open("log") as log:
            return re.search(condition[len("says "):], log.read()[before["said"]:])
    try:
        seen = read(path)
    except (OSError, KeyError, RuntimeError):
        return False  # the file does not exist yet, or is being written
    if "time" in seen:
        assert len(seen["film"]) == len(seen["time"]) >= before["times"]
        assert numpy.isfinite(seen["time"]).all() and numpy.isfinite(seen["film"]).all()
        before["times"] = len(seen["time"])
    return eval(condition, {}, seen)


def attempt(number, condition, partial, command):
    """The program, stopped; None when it ended before."""
    # the caller reads this script's output to its end, so a halted program must not hold it open
    quiet = subprocess.DEVNULL if number == signal.SIGSTOP else None
    said = os.path.getsize("log") if condition.startswith("says ") else 0
    program = subprocess.Popen(command, stdout=quiet)
    before = {"times": 0, "said": said}
    while program.poll() is None:
        if holds(condition, partial, before):
            program.send_signal(number)
            break
        clock.sleep(0.005)
    if number == signal.SIGSTOP and program.poll() is None:
        return program
    if program.wait() == 0:
        return None
    return program


def main():
    number = getattr(signal, "SIG" + sys.argv[1])
    condition, output, command = sys.argv[2], sys.argv[3], sys.argv[4:]
    partial, kept = output + ".partial", output + ".kept"
    start = clock.monotonic()
    if os.path.exists(partial):
        shutil.copy(partial, kept)
    while clock.monotonic() - start < LIMIT:
        program = attempt(number, condition, partial, command)
        if program:
            break
        os.remove(output)
        if os.path.exists(kept):
            shutil.copy(kept, partial)
    else:
        sys.exit(f"stop_when.py: found no moment in {LIMIT} s at which {condition}")
    if os.path.exists(kept):
        os.remove(kept)
    if program.returncode is None:
        print(program.pid)
        sys.stdout.flush()
        os._exit(0)
    sys.exit(program.returncode if program.returncode >= 0 else 128 - program.returncode)


main()
