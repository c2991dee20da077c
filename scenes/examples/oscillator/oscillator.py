# SPDX-License-Identifier: GPL-3.0-or-later
"""The program oscillator.c in Python: oscillator.py SCENE.yml MODEL OUT.csv

MODEL is a reduced model, for the Python package (make python), or an FMU whose input is the approach (romrun fmu with
closure: approach). The integrator makes the operations of shaken_mass.h in the same order, so that equal forces give
equal steps to the last bit."""
import math
import re
import sys
import typing

scene, model, out = sys.argv[1:]
of_fmu = model.endswith(".fmu")
if of_fmu:
    import fmu as library
else:
    import ehdrom as library

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


# A contact has the functions start() and step(approach, step), which return a Reply, and accept(). All quantities are
# dimensionless.


class OnPackage:
    def __init__(self, scene, model):
        # only the force matters here, so films may be 10 % off
        self.contact = library.Contact(library.Model(model), scene, dimensionless=True, accuracy=0.1)

    def reply(self, approach, result):
        result.check()  # a result that is not trusted ends the program
        return Reply(approach, result.load, result.central_film_thickness)

    def start(self):
        approach = self.contact.start().approach
        return self.reply(approach, self.contact.start(approach=approach))

    def step(self, approach, step):
        return self.reply(approach, self.contact.step(step, approach=approach))

    def accept(self):
        self.contact.accept()


class OnFMU:
    """Converts the SI units of an FMU to dimensionless quantities, with the scales of the scene
    (ehdrom_contact_scales)."""

    def __init__(self, scene, path):
        with open(scene, encoding="utf-8") as file:
            given = dict(re.findall(r"(\w+): ([\d.e+-]+)", next(line for line in file if line.startswith("physical:"))))
        load, radius, speed, modulus = (float(given[name]) for name in ("load", "radius", "speed", "modulus"))
        half_width = math.sqrt(8 * load * radius / (math.pi * modulus))
        self.load, self.film, self.time = load, half_width**2 / radius, half_width / speed
        self.contact = library.Instance(library.FMU(path))

    def reply(self, approach):
        force, film = self.contact.get("force", "central_film_thickness")
        return Reply(approach, force / self.load, film / self.film)

    def start(self):
        self.contact.start()
        return self.reply(self.contact.get("approach")[0] / self.film)

    def step(self, approach, step):
        self.contact.step(step * self.time, approach=approach * self.film)
        return self.reply(approach)

    def accept(self):
        self.contact.accept()


try:
    write((OnFMU if of_fmu else OnPackage)(scene, model), out)
except library.Error as error:
    sys.exit(f"oscillator.py: {error}")
