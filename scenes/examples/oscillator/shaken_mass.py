# SPDX-License-Identifier: GPL-3.0-or-later
"""The integrator of shaken_mass.h, operation by operation: with the same forces it takes the same steps to the last bit.

A contact has start(), step(approach, step), both of which return a Reply, and accept(); all is dimensionless."""
import math
import typing

MASS = 0.0138
EXCITATION, EXCITATION_PERIOD = 0.008, 1.0
STEP, NUM_STEPS = 0.01, 1200
TOLERANCE, MAX_TRIALS = 1e-8, 20


class Reply(typing.NamedTuple):
    approach: float
    force: float
    film: float


def acceleration(force, time):
    return (force - 1 - EXCITATION * math.sin(2 * math.pi * time / EXCITATION_PERIOD)) / MASS


def run(contact):
    """Yields time and reply of the start and of each step."""
    now, time, velocity, before = contact.start(), 0.0, 0.0, 0.0
    position = now.approach
    yield time, now
    for _ in range(NUM_STEPS):
        time += STEP
        drift = position + STEP * velocity
        position = drift + STEP * STEP / 2 * before
        defect, slope = 0.0, 1.0
        for trial in range(MAX_TRIALS):
            now = contact.step(position, STEP)
            last_defect, correction = defect, defect / slope
            after = acceleration(now.force, time)
            defect = position - drift - STEP * STEP / 4 * (before + after)
            if abs(defect) < TOLERANCE:
                break
            if trial > 0:
                slope = (last_defect - defect) / correction
            position -= defect / slope
        else:
            raise RuntimeError(f"T = {time:.6g}: found no equilibrium, expected one")
        contact.accept()
        velocity += STEP / 2 * (before + after)
        before = after
        yield time, now


def write(contact, path):
    with open(path, "w", encoding="ascii") as file:
        file.write("time,approach,force,central_film_thickness\n")
        for time, now in run(contact):
            file.write("%.17g,%.17g,%.17g,%.17g\n" % (time, *now))
