# SPDX-License-Identifier: GPL-3.0-or-later
"""How far runs of the same program are from the first: variants.py FIRST.csv OTHER.csv..."""
import sys

import numpy as np

first, *others = sys.argv[1:]
expected = np.genfromtxt(first, delimiter=",", names=True)
for path in others:
    found = np.genfromtxt(path, delimiter=",", names=True)
    if len(found) != len(expected):
        sys.exit(f"variants.py: {path}: found {len(found)} times, expected the {len(expected)} of {first}")
    print(f"{path}: largest deviation from {first}, of the largest value: " + ", ".join(
        f"{name.replace('_', ' ')} {np.max(np.abs(found[name] - expected[name])) / np.max(np.abs(expected[name])):.2g}"
        for name in expected.dtype.names[1:]))
