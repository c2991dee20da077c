# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the contact between a cam and a flat-faced tappet during one lift.

    cam.py history > HISTORY.csv
    cam.py picture PICTURE.png FULL.h5 REDUCED.h5

Columns of the history: time, load, speed, radius, modulus, with their units in the header; angle of the cam (degrees
from the nose) and lift (mm).

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
import numpy as np

import results

BASE_RADIUS = 0.018    # m, r_b
LIFT = 0.006           # m, h
DURATION = 240         # degrees of the cam, beta
PRELOAD = 1200         # N, F_0
SPRING = 100e3         # N/m, k
MASS = 0.3             # kg, m, of all parts that move with the tappet
WIDTH = 0.012          # m, b
CAM_SPEED = 1500       # revolutions a minute
MODULUS = 226          # GPa, of steel on steel
SOFTENING = 0.05       # part of the modulus that is lost at the largest distance from the axis
NUM_INTERVALS = 480


def history():
    """Prints the history."""
    beta, omega = np.radians(DURATION), 2 * np.pi * CAM_SPEED / 60

    x = np.arange(NUM_INTERVALS + 1) / NUM_INTERVALS
    s = 64 * LIFT * (x * (1 - x)) ** 3
    ds = 64 * LIFT * 3 * (x * (1 - x)) ** 2 * (1 - 2 * x) / beta
    dds = 64 * LIFT * (6 * x - 36 * x ** 2 + 60 * x ** 3 - 30 * x ** 4) / beta ** 2
    columns = {"time [s]": x * beta / omega,
               "load [N/m]": (PRELOAD + SPRING * s + MASS * omega ** 2 * dds) / WIDTH,
               "speed [m/s]": omega * (BASE_RADIUS + s + 2 * dds) / 2,
               "radius [mm]": 1000 * (BASE_RADIUS + s + dds),
               "modulus [GPa]": MODULUS * (1 - SOFTENING * (ds / max(ds)) ** 2),
               "angle": DURATION * (x - 0.5), "lift [mm]": 1000 * s}
    print(",".join(columns))
    for values in zip(*columns.values()):
        print(",".join(f"{value:.10g}" for value in values))


def picture(picture, full, reduced):
    """Draws the history, the pressure and the film over the angle of the cam."""
    import pictures
    table = np.loadtxt("out/history.csv", delimiter=",", skiprows=1, unpack=True)
    time, *varying, table_angle, _ = table
    (T, _, pressure, centre, smallest), fewer = pictures.in_time(full), pictures.in_time(reduced)
    figure, (history_axes, pressure_axes, film_axes) = pictures.page(1000, 1000, 3, sharex=True)

    time *= T[-1] / time[-1]  # both end with the lift
    angle, fewer_angles = (np.interp(times, time, table_angle) for times in (T, fewer[0]))
    for values, label in zip(varying, ("load", "mean speed", "radius of curvature", "modulus")):
        history_axes.plot(table_angle, values / values[0], label=label)
    pictures.pair(pressure_axes, (angle, 1e-9 * pressure), (fewer_angles, 1e-9 * fewer[2]))
    pictures.pair(film_axes, (angle, 1e6 * centre), (fewer_angles, 1e6 * fewer[3]), label="centre, ")
    pictures.pair(film_axes, (angle, 1e6 * smallest), (fewer_angles, 1e6 * fewer[4]), colour=pictures.RED, mark="s",
                  label="smallest, ")
    history_axes.set(ylabel="relative to the base circle", ylim=(0, 2.5), xlim=(-DURATION / 2, DURATION / 2),
                     xticks=range(-120, 121, 30))
    pressure_axes.set(ylabel="central pressure / GPa", ylim=(0, 0.7))
    film_axes.set(ylabel="film thickness / µm", ylim=(0, 0.45), xlabel="angle of the cam from the nose / degrees")
    for axes in figure.axes:
        axes.legend(loc="upper center", ncols=2)
    pictures.save(figure, picture)


results.commands(history, picture)
