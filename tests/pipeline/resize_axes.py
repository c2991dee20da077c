# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands on copies of a file in which one axis has another length (axes.bats).

    resize_axes.py FILE COMMAND...

In a copy all that lies along the axis is shorter or longer: by one or by a factor of three, and its entries come again in turn.
With EVERY_LENGTH in the environment it also has one entry, half of them or twice as many, and each entry comes several times.
A copy has no digest. Each command may succeed, or say why it does not; anything else ends the script with exit code 1.
"""
import os
import shlex
import subprocess
import sys

import h5py
import numpy as np

EVERY_LENGTH = "EVERY_LENGTH" in os.environ

# Exit codes of a proper end: solved, not converged, not to be trusted, wrong use, bad data, no memory.
MAY_END = {0, 3, 4, 64, 65, 71}


def lengths_of(length):
    lengths = {length - 1, length + 1, 3 * length}
    if EVERY_LENGTH:
        lengths |= {1, length // 2, 2 * length}
    return sorted(lengths - {0, length})


def resized(values, place, length, in_turn):
    index = np.arange(length)
    index = index % values.shape[place] if in_turn else index * values.shape[place] // length
    return np.take(values, index, axis=place)


def copy_resized(name, copy, axis, length, in_turn):
    """Writes a copy without digest, in which the axis has this length."""
    with h5py.File(name) as whole, h5py.File(copy, "w") as changed:
        for key, value in whole.attrs.items():
            if key != "content_sha256":
                changed.attrs[key] = value
        for key, old in whole.items():
            values = old[()]
            for place, scale in enumerate(axes_of(old, whole)):
                if scale == axis:
                    values = resized(values, place, length, in_turn)
            new = changed.create_dataset(key, data=values)
            for attribute in set(old.attrs) - {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME"}:
                new.attrs[attribute] = old.attrs[attribute]
            if is_scale(old):
                new.make_scale(old.attrs["NAME"])
        for key, old in whole.items():
            if not is_scale(old):
                for place, scale in enumerate(axes_of(old, whole)):
                    changed[key].dims[place].attach_scale(changed[scale])


def is_scale(dataset):
    return h5py.h5ds.is_scale(dataset.id)


def axes_of(dataset, file):
    """Names of the scales along a dataset, its own where it is one."""
    if is_scale(dataset):
        return [dataset.name[1:]]
    return [dim[0].name[1:] for dim in dataset.dims]


def run(name, command):
    done = subprocess.run(shlex.split(command), capture_output=True, text=True, timeout=600)
    if done.returncode not in MAY_END or (done.returncode == 65 and not done.stderr):
        print(f"{name}: {command}: exit code {done.returncode}\n{done.stderr[-4000:]}")
        return False
    return True


def main(name, *commands):
    copy = f"copy-{name}"
    good, count = True, 0
    with h5py.File(name) as file:
        axes = {key: len(dataset) for key, dataset in file.items() if is_scale(dataset)}
    for axis, whole in axes.items():
        for length in lengths_of(whole):
            for in_turn in (True, False)[:1 + EVERY_LENGTH]:
                copy_resized(name, copy, axis, length, in_turn)
                for command in commands:
                    good = run(f"{axis} {whole} -> {length}{' in turn' * in_turn}",
                               command.replace(name, copy)) and good
                    count += 1
    os.remove(copy)
    print(f"{name}: {len(axes)} axes, {count} calls")
    return 0 if good and count else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
