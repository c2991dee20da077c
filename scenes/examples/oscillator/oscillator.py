# SPDX-License-Identifier: GPL-3.0-or-later
"""oscillator.c in Python, on the package (make python): oscillator.py SCENE.yml MODEL OUT.csv"""
import sys

import ehdrom
import shaken_mass


class Contact:
    def __init__(self, scene, model):
        # forces are wanted: films may be so far off
        self.contact = ehdrom.Contact(ehdrom.Model(model), scene, dimensionless=True, accuracy=0.1)

    def reply(self, approach, result):
        result.check()  # an answer that is not to be trusted ends it
        return shaken_mass.Reply(approach, result.load, result.central_film_thickness)

    def start(self):
        approach = self.contact.start().approach
        return self.reply(approach, self.contact.start(approach=approach))

    def step(self, approach, step):
        return self.reply(approach, self.contact.step(step, approach=approach))

    def accept(self):
        self.contact.accept()


scene, model, out = sys.argv[1:]
try:
    shaken_mass.write(Contact(scene, model), out)
except ehdrom.Error as error:
    sys.exit(f"oscillator.py: {error}")
