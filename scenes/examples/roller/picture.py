# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws forces, positions and the smallest film along the track: picture.py PICTURE.png ROLLER.csv"""
import sys

import matplotlib.pyplot as plt
import numpy as np

import pictures

picture, file = sys.argv[1:]
run = np.genfromtxt(file, delimiter=",", names=True)
travel = 1000 * run["travel"]
figure, (loads, positions, films) = pictures.page(1000, 1000, 3, sharex=True)
slices = [name for name in run.dtype.names if name.startswith("load_")]
for i, name in enumerate(slices):
    loads.plot(travel, run[name] / 1000, color=plt.cm.viridis(i / len(slices)), linewidth=1,
               label=f"slice {i + 1}" if i in (0, len(slices) - 1) else None)
loads.set(ylabel="load of each slice, N/mm", title="A roller on the oblique joint of two rails")
loads.legend(loc="upper right")
positions.plot(travel, 1e6 * run["height"], color=pictures.BLUE, label="height, µm")
positions.plot(travel, 1e6 * run["tilt"] * 0.02, color=pictures.RED, label="tilt, µm over the roller's length")
positions.legend(loc="upper left")
films.plot(travel, 1e6 * run["minimum_film_thickness"], color=pictures.GREEN)
films.set(ylabel="smallest film, µm", xlabel="travel behind the joint, mm", xlim=(travel[0], travel[-1]))
pictures.save(figure, picture)
