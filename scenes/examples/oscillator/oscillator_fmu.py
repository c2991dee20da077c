# SPDX-License-Identifier: GPL-3.0-or-later
"""The mass on an FMU, whose input is the approach (romrun --fmu, closure: approach): oscillator_fmu.py CONTACT.fmu SCENE.yml OUT.csv"""
import math
import re
import sys

import fmu
import shaken_mass


class Contact:
    """Dimensionless, as the mass wants it; the scales are those of the scene (ehdrom_contact_scales)."""

    def __init__(self, path, scene):
        with open(scene, encoding="utf-8") as file:
            given = dict(re.findall(r"(\w+): ([\d.e+-]+)", next(line for line in file if line.startswith("physical:"))))
        load, radius, speed, modulus = (float(given[name]) for name in ("load", "radius", "speed", "modulus"))
        half_width = math.sqrt(8 * load * radius / (math.pi * modulus))
        self.load, self.film, self.time = load, half_width**2 / radius, half_width / speed
        self.contact = fmu.Instance(fmu.FMU(path))

    def reply(self, approach):
        force, film = self.contact.get("force", "central_film_thickness")
        return shaken_mass.Reply(approach, force / self.load, film / self.film)

    def start(self):
        self.contact.start()
        return self.reply(self.contact.get("approach")[0] / self.film)

    def step(self, approach, step):
        self.contact.step(step * self.time, approach=approach * self.film)
        return self.reply(approach)

    def accept(self):
        self.contact.accept()


path, scene, out = sys.argv[1:]
try:
    shaken_mass.write(Contact(path, scene), out)
except fmu.Error as error:
    sys.exit(f"oscillator_fmu.py: {error}")
