# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws force, approach and central film over time: picture.py PICTURE.png FULL.csv REDUCED.csv"""
import sys

import numpy as np

import pictures

picture, *files = sys.argv[1:]
full, reduced = (np.genfromtxt(file, delimiter=",", names=True) for file in files)
figure, rows = pictures.page(1000, 1000, 3, sharex=True)
for axes, (column, factor, label) in zip(rows, [("force", 1, "force  $w/w_{ref}$"), ("approach", 1, "approach  $H_0$"),
                                                ("central_film_thickness", 1000, "central film  $1000\\,H_c$")]):
    pictures.pair(axes, *((run["time"], factor * run[column]) for run in (full, reduced)), every=10)
    axes.set(ylabel=label, xlim=(0, full["time"][-1]))
rows[0].set_title("A mass on a lubricated line contact, shaken near its resonance")
rows[0].legend(loc="upper right")
rows[-1].set_xlabel("time  $T = ut/a$")
pictures.save(figure, picture)
