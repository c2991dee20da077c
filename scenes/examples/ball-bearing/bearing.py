# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the contact at the inner race of a 6206 deep groove ball bearing, and draws film and traction over speed.

    bearing.py numbers                  prints radii, loads and speeds for scene.yml, plan.yml and cases.csv
    bearing.py speeds                   prints a table for romrun cases, with a row for each speed of the shaft
    bearing.py picture PICTURE TABLE    draws film and forces over the speed, from the table that romrun cases writes
"""
import csv
import sys

import numpy as np

# Boundary dimensions of a 6206 (ISO 15); diameter and number of its balls, from makers' tables.
BORE, OUTSIDE, BALL, BALLS = 30e-3, 62e-3, 9.525e-3, 9
# Assumptions, since makers do not publish these dimensions: the pitch circle is half way between bore and outside, and
# the groove radius is 0.52 times the ball diameter (0.515 to 0.53 are usual).
PITCH, CONFORMITY = (BORE + OUTSIDE) / 2, 0.52

GAMMA = BALL / PITCH  # for a contact angle of zero
RADIUS = BALL / 2 * (1 - GAMMA)  # along the rolling direction: 1/R_x = 2/D + 2/(d_m - D)
RADIUS_ACROSS = 1 / (2 / BALL - 1 / (CONFORMITY * BALL))  # the groove is concave


def ball_load(radial):
    """Returns the load of the most loaded ball, with the usual clearance (Stribeck)."""
    return 5 * radial / BALLS


def speed(rpm):
    """Returns the mean speed of both surfaces at the inner race, for balls without slip and an outer ring at rest."""
    return np.pi * rpm / 60 * PITCH / 2 * (1 - GAMMA**2)


def numbers():
    print(f"radius {RADIUS:.5g} m, radius_across {RADIUS_ACROSS:.5g} m")
    for radial in 250, 500, 750:
        print(f"{radial} N on the bearing: {ball_load(radial):.4g} N on the ball")
    for rpm in 1000, 3000, 6000:
        print(f"{rpm} rpm: {speed(rpm):.4g} m/s")


def speeds():
    print("physical.speed")
    for rpm in np.linspace(1000, 6000, 101):
        print(f"{speed(rpm):.9g}")


def picture(file, table):
    import pictures

    with open(table, newline="") as lines:
        rows = list(csv.DictReader(lines))
    rpm = [float(row["physical.speed"]) / speed(1) for row in rows]
    figure, (films, forces) = pictures.page(900, 800, 2, sharex=True)
    for name, color in ("central", pictures.BLUE), ("minimum", pictures.RED):
        film = [1e6 * float(row[f"{name}_film_thickness [m]"]) for row in rows]
        films.plot(rpm, film, color=color, label=f"{name} film")
    films.set(ylabel="film, µm", ylim=(0, None), title="Inner race of a 6206, 278 N on the most loaded ball")
    for name, color in ("friction_force", pictures.GREEN), ("rolling_resistance", pictures.ORANGE):
        force = [float(row[f"point_{name} [N]"]) for row in rows]
        forces.plot(rpm, force, color=color, label=name.replace("_", " "))
    forces.set(xlabel="speed of the shaft, rpm", ylabel="force, N", ylim=(0, None))
    for axes in films, forces:
        axes.legend()
    pictures.save(figure, file)


if __name__ == "__main__":
    {"numbers": numbers, "speeds": speeds, "picture": picture}[sys.argv[1]](*sys.argv[2:])
