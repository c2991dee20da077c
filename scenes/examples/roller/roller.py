# SPDX-License-Identifier: GPL-3.0-or-later
"""roller.c in Python, on the package (make python): roller.py SCENE.yml MODEL OUT.csv"""
import sys

import ehdrom
import sliced_slide


class Contacts:
    def __init__(self, scene, model):
        model = ehdrom.Model(model)
        self.contacts = [ehdrom.Contact(model, scene) for _ in range(sliced_slide.NUM_SLICES)]

    def reply(self, approach, result):
        return sliced_slide.Reply(approach, result.load, result.minimum_film_thickness, result.peak_pressure,
                                  result.local_error, result.reason)

    def start(self):
        load = sliced_slide.LOAD / sliced_slide.LENGTH
        approaches = [contact.start(load=load).approach for contact in self.contacts]
        replies = [self.reply(approach, contact.start(approach=approach))
                   for contact, approach in zip(self.contacts, approaches)]
        self.time_scale = self.contacts[0].scales()["time"]
        self.stiffness = self.contacts[0].respond()["stiffness"]
        return replies

    def step(self, approaches, step):
        try:
            return [self.reply(approach, contact.step(step, approach=approach))
                    for contact, approach in zip(self.contacts, approaches)]
        except ehdrom.NotConverged as error:
            raise sliced_slide.NotConverged(str(error)) from error

    def accept(self):
        for contact in self.contacts:
            contact.accept()


scene, model, out = sys.argv[1:]
try:
    sys.exit(sliced_slide.roll(Contacts(scene, model), out))
except (ehdrom.Error, sliced_slide.NotConverged) as error:
    sys.exit(f"roller.py: {error}")
