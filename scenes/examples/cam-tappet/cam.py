# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the contact between a cam and a flat-faced tappet during one lift.

    cam.py history SCENE.yml > HISTORY.csv
    cam.py picture PICTURE.png FULL.h5 REDUCED.h5

Columns of the history: T, load, speed, radius, modulus (factors on the scene's `physical` reference, over its time
T = u_ref t / a_ref), angle (of the cam, degrees from the nose), lift (mm).

Lift: the 3-4-5-6 polynomial of a cam with a single dwell (R. L. Norton, Cam Design and Manufacturing Handbook,
Industrial Press), s = 64 h (x (1 - x))^3 with x = theta/beta from 0 to 1 over rise and fall; velocity and acceleration
start and end at zero.
Contact (s', s'': derivatives with respect to the angle): the radius of curvature of the cam is rho = r_b + s + s''. The
distance of the contact from the tappet's axis is s'. Relative to the contact, the cam surface moves with omega rho and
the tappet surface with omega s''. Hence the mean speed is u_m = omega (r_b + s + 2 s'')/2. At the nose s'' is negative.
If the lift is short, u_m changes its sign between flank and nose. This cam is slow and flat, so that u_m stays
positive, at least 0.4 of its value on the base circle.
Load: spring and inertia, w = (F_0 + k s + m omega^2 s'')/b.
Modulus: at the tappet's axis that of steel on steel. With the distance from the axis it decreases quadratically, as if
the facing became softer towards its rim. This law does not describe a particular facing.
"""
import re

import numpy as np

import results

BASE_RADIUS = 0.018    # m, r_b
LIFT = 0.006           # m, h
DURATION = 240         # degrees of the cam, beta
PRELOAD = 1200         # N, F_0
SPRING = 100e3         # N/m, k
MASS = 0.3             # kg, m, of all parts that move with the tappet
WIDTH = 0.012          # m, b
SOFTENING = 0.05       # part of the modulus that is lost at the largest distance from the axis
NUM_INTERVALS = 480


def history(scene):
    """Prints the history. The scene gives the reference in one line:
    physical: {load: ..., radius: ..., speed: ..., modulus: ...}"""
    lines = re.findall(r"^physical:.*", open(scene).read(), re.MULTILINE)
    given = dict(re.findall(r"(\w+): *([0-9][^,} ]*)", lines[0])) if lines else {}
    load, radius, speed, modulus = (float(given.get(name, 0)) for name in ("load", "radius", "speed", "modulus"))
    if not min(load, radius, speed, modulus) > 0:
        results.stop(f"{scene}: found no `physical: {{load: ..., radius: ..., speed: ..., modulus: ...}}`, "
                     "expected one line of it")
    beta, omega = np.radians(DURATION), 2 * speed / BASE_RADIUS  # the reference speed is that of the base circle
    half_width = np.sqrt(8 * load * radius / (np.pi * modulus))

    x = np.arange(NUM_INTERVALS + 1) / NUM_INTERVALS
    s = 64 * LIFT * (x * (1 - x)) ** 3
    ds = 64 * LIFT * 3 * (x * (1 - x)) ** 2 * (1 - 2 * x) / beta
    dds = 64 * LIFT * (6 * x - 36 * x ** 2 + 60 * x ** 3 - 30 * x ** 4) / beta ** 2
    columns = {"T": speed * x * beta / omega / half_width,
               "load": (PRELOAD + SPRING * s + MASS * omega ** 2 * dds) / WIDTH / load,
               "speed": omega * (BASE_RADIUS + s + 2 * dds) / 2 / speed,
               "radius": (BASE_RADIUS + s + dds) / radius,
               "modulus": 1 - SOFTENING * (ds / max(ds)) ** 2,
               "angle": DURATION * (x - 0.5), "lift": 1000 * s}
    print(",".join(columns))
    for values in zip(*columns.values()):
        print(",".join(f"{value:.10g}" for value in values))


def picture(picture, full, reduced):
    """Draws the history, the pressure and the film over the angle of the cam."""
    import pictures
    table = np.genfromtxt("out/history.csv", delimiter=",", names=True)
    (T, _, pressure, centre, smallest), fewer = pictures.in_time(full), pictures.in_time(reduced)
    figure, (history_axes, pressure_axes, film_axes) = pictures.page(1000, 1000, 3, sharex=True)

    angle, fewer_angles = (np.interp(times, table["T"], table["angle"]) for times in (T, fewer[0]))
    for name, label in (("load", "load"), ("speed", "mean speed"), ("radius", "radius of curvature"),
                        ("modulus", "modulus")):
        history_axes.plot(table["angle"], table[name], label=label)
    pictures.pair(pressure_axes, (angle, 1e-9 * pressure), (fewer_angles, 1e-9 * fewer[2]))
    pictures.pair(film_axes, (angle, 1e6 * centre), (fewer_angles, 1e6 * fewer[3]), label="centre, ")
    pictures.pair(film_axes, (angle, 1e6 * smallest), (fewer_angles, 1e6 * fewer[4]), colour=pictures.RED, mark="s",
                  label="smallest, ")
    history_axes.set(ylabel="factor on the reference", ylim=(0, 2.5), xlim=(-DURATION / 2, DURATION / 2),
                     xticks=range(-120, 121, 30))
    pressure_axes.set(ylabel="central pressure / GPa", ylim=(0, 0.7))
    film_axes.set(ylabel="film thickness / µm", ylim=(0, 0.45), xlabel="angle of the cam from the nose / degrees")
    for axes in figure.axes:
        axes.legend(loc="upper center", ncols=2)
    pictures.save(figure, picture)


results.commands(history, picture)
