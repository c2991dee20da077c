# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws position, force and central film over time: picture.py PICTURE.png BOUNCES.csv"""
import sys

import numpy as np

import pictures

picture, file = sys.argv[1:]
run = np.genfromtxt(file, delimiter=",", names=True)
figure, rows = pictures.page(1000, 900, 3, sharex=True)
for axes, (column, factor, label) in zip(rows, [("position", 1e6, "approach  µm"), ("force", 1e-3, "force  kN/m"),
                                                ("central_film_thickness", 1e6, "central film  µm")]):
    axes.plot(1e3 * run["time"], factor * run[column])
    axes.set(ylabel=label, xlim=(0, 1e3 * run["time"][-1]))
rows[0].axhline(0, color="#808080", linewidth=0.8)
rows[0].set_title("A mass that falls on a lubricated line contact and bounces")
rows[2].set_ylim(0, 1)
rows[-1].set_xlabel("time  ms")
pictures.save(figure, picture)
