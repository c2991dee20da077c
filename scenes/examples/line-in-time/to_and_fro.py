# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws speed, exit and film over time, and the film across the contact on one stroke:
to_and_fro.py PICTURE.png RESULT.h5"""
import re
import sys

import numpy as np

import pictures
import results

TURN, STEP, COUNT = 12, 1.5, 4  # T at the start of the drawn stroke; T between the drawn films; their number

picture, file = sys.argv[1:]
settings = str(results.printed(file, "settings")["settings"][0])
mean, amplitude, period = (float(re.search(rf"^transient\.speed\.{key}: (.*)$", settings, re.MULTILINE)[1])
                           for key in ("mean", "amplitude", "period"))
scalars = results.printed(file, "time", "central_film_thickness", "minimum_film_thickness", "film_unit")
T, centre, smallest, unit = scalars.values()
exits = results.farthest_exits(results.printed(file, "time", "exit", "exit_position"))["exit_position"]
fields = results.printed(file, "time", "x", "film_thickness")
kept = fields["time"][np.isfinite(fields["film_thickness"])]

figure, (speed_axes, film_axes, profile_axes) = pictures.page(1000, 1150, 3)
speed_axes.plot(T, mean + amplitude * np.sin(2 * np.pi * T / period), label="speed $u/u_{ref}$")
speed_axes.plot(T, exits, ".", markersize=3, color=pictures.RED, label="exit $x/a$")
speed_axes.set(ylim=(-2, 2), xlim=(T[0], T[-1]))
film_axes.plot(T, 1e6 * unit * centre, label="centre")
film_axes.plot(T, 1e6 * unit * smallest, color=pictures.RED, label="smallest")
film_axes.set(ylabel="film thickness / µm", xlabel="time  $T = ut/a$", xlim=(T[0], T[-1]), ylim=(0, 0.5))
for k in range(COUNT):
    time = kept[np.argmin(np.abs(kept - TURN - k * STEP))]
    columns = results.of_time(fields, time)
    profile_axes.plot(columns["x"], 1e6 * unit[0] * columns["film_thickness"], color=pictures.COLOURS[k],
                      label=f"T = {time:.1f}")
profile_axes.set(ylabel="film thickness / µm", xlabel="position $x/a$", xlim=(-1.5, 1.5), ylim=(0, 0.6))
for axes in speed_axes, film_axes, profile_axes:
    axes.legend(loc="upper right")
pictures.save(figure, picture)
