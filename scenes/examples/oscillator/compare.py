# SPDX-License-Identifier: GPL-3.0-or-later
"""How far runs of the same mass are from the first: compare.py FIRST.csv OTHER.csv..."""
import sys

import numpy as np

first, *others = sys.argv[1:]
expected = np.genfromtxt(first, delimiter=",", names=True)
for path in others:
    found = np.genfromtxt(path, delimiter=",", names=True)
    print(f"{path}: largest relative deviation from {first}: " + ", ".join(
        f"{name.replace('_', ' ')} {np.max(np.abs(found[name] / expected[name] - 1)):.2g}" for name in expected.dtype.names[1:]))
