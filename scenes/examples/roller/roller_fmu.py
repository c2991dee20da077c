# SPDX-License-Identifier: GPL-3.0-or-later
"""The roller on eight instances of an FMU, whose input is the approach (romrun --fmu, closure: approach): roller_fmu.py CONTACT.fmu
SCENE.yml OUT.csv"""
import math
import re
import sys

import fmu
import sliced_slide


class Contacts:
    def __init__(self, path, scene):
        contact = fmu.FMU(path)
        self.contacts = [fmu.Instance(contact) for _ in range(sliced_slide.NUM_SLICES)]
        with open(scene, encoding="utf-8") as file:
            given = dict(re.findall(r"(\w+): ([\d.e+-]+)", next(line for line in file if line.startswith("physical:"))))
        load, radius, speed, modulus = (float(given[name]) for name in ("load", "radius", "speed", "modulus"))
        self.time_scale = math.sqrt(8 * load * radius / (math.pi * modulus)) / speed

    def reply(self, approach, contact):
        distrust = "" if contact.get_boolean("trusted") else "found a result that is not trusted"
        numbers = contact.get("force", "minimum_film_thickness", "peak_pressure", "local_error")
        return sliced_slide.Reply(approach, *numbers, distrust)

    def start(self):
        for contact in self.contacts:
            contact.start()
        self.stiffness = self.contacts[0].get("stationary_stiffness")[0]
        return [self.reply(contact.get("approach")[0], contact) for contact in self.contacts]

    def step(self, approaches, step):
        for contact, approach in zip(self.contacts, approaches):
            contact.step(step, approach=approach)
        return [self.reply(*both) for both in zip(approaches, self.contacts)]

    def accept(self):
        for contact in self.contacts:
            contact.accept()


path, scene, out = sys.argv[1:]
try:
    sys.exit(sliced_slide.roll(Contacts(path, scene), out))
except (fmu.Error, sliced_slide.NotConverged) as error:
    sys.exit(f"roller_fmu.py: {error}")
