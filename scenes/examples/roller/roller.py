# SPDX-License-Identifier: GPL-3.0-or-later
"""The program roller.c in Python: roller.py SCENE.yml MODEL OUT.csv

MODEL is a reduced model, for the Python package (make python), or an FMU whose input is the approach (romrun fmu with
closure: approach), with an instance for each slice. The integrator makes the operations of roller.c in the same order,
so that equal forces give equal steps to the last bit."""
import math
import os
import re
import sys
import time
import typing

scene, model, out = sys.argv[1:]
of_fmu = model.endswith(".fmu")
if of_fmu:
    import fmu as library
else:
    import ehdrom as library

NUM_SLICES = 8
LENGTH = 0.02
LOAD = 6000
SPEED = 0.8
MASS = 2.5
INERTIA = 7.5e-4
RAIL_STEP = 1e-6
RAMP = 0.4e-3
SKEW = 0.1
BEFORE = 1.5e-3
BEHIND = 4.5e-3
POSITION_ERROR = 2e-11
FILM_ERROR = 1e-3
EQUILIBRIUM = 1e-14
MAX_TRIALS = 12
PLACES = [LENGTH * ((k + 0.5) / NUM_SLICES - 0.5) for k in range(NUM_SLICES)]


class NotConverged(Exception):
    """A step has not converged; a shorter step has to be tried."""


class Reply(typing.NamedTuple):
    approach: float
    load: float
    minimum_film: float
    peak_pressure: float
    local_error: float
    distrust: str  # why the result is not trusted, or ""


def track(travel, across):
    part = min(max((travel - SKEW * across) / RAMP, 0), 1)
    return RAIL_STEP * part * part * (3 - 2 * part)


def force_of(replies):
    force = 0.0
    for reply in replies:
        force += reply.load * LENGTH / NUM_SLICES
    return force


def moment_of(replies):
    moment = 0.0
    for reply, place in zip(replies, PLACES):
        moment += reply.load * LENGTH / NUM_SLICES * place
    return moment


class Slide:
    def __init__(self, contacts):
        self.contacts, self.now = contacts, contacts.start()
        self.time, self.shortest = 0.0, contacts.time_scale / 100
        self.length = self.shortest  # length of the next step
        self.position, self.velocity, self.acceleration = 3 * [(0.0, 0.0)]  # height, tilt
        self.rest, self.load = self.now[0].approach, force_of(self.now)
        self.stiffness = NUM_SLICES * [contacts.stiffness]
        self.num_steps = self.num_trials = self.num_rejected = self.num_untrusted = 0

    def try_there(self, step, position, before):
        """Solves the contacts for a position; returns their replies. `before`: replies of the last trial, from which
        the stiffness of the slices is computed, or None."""
        travel = SPEED * (self.time + step) - BEFORE
        self.num_trials += 1
        replies = self.contacts.step([self.rest + position[0] + position[1] * place - track(travel, place) for place in PLACES],
                                     step)
        for k in range(NUM_SLICES if before else 0):
            moved = replies[k].approach - before[k].approach
            if abs(moved) > EQUILIBRIUM and (before[k].load - replies[k].load) / moved > 0:
                self.stiffness[k] = (before[k].load - replies[k].load) / moved
        return replies

    def correct(self, position, defect, step):
        part = step * step / 4 * LENGTH / NUM_SLICES
        a, b, c, d = 1.0, 0.0, 0.0, 1.0
        for stiffness, z in zip(self.stiffness, PLACES):
            spring = part * stiffness
            a += spring / MASS
            b += spring * z / MASS
            c += spring * z / INERTIA
            d += spring * z * z / INERTIA
        return (position[0] - (d * defect[0] - b * defect[1]) / (a * d - b * c),
                position[1] - (a * defect[1] - c * defect[0]) / (a * d - b * c))

    def try_step(self, step):
        """Tries a step of the trapezoidal rule. Returns position, acceleration and replies at its end."""
        drift = [x + step * v for x, v in zip(self.position, self.velocity)]
        position = [x + step * step / 2 * a for x, a in zip(drift, self.acceleration)]
        replies = None
        for _ in range(MAX_TRIALS):
            replies = self.try_there(step, position, replies)
            acceleration = (force_of(replies) - self.load) / MASS, moment_of(replies) / INERTIA
            defect = [position[i] - drift[i] - step * step / 4 * (self.acceleration[i] + acceleration[i]) for i in range(2)]
            if abs(defect[0]) + LENGTH * abs(defect[1]) < EQUILIBRIUM:
                return position, acceleration, replies
            position = self.correct(position, defect, step)
        raise NotConverged("found no place where the slices carry the slide, expected one")

    def error_of(self, acceleration, replies, step):
        off = step * step / 12 * (abs(acceleration[0] - self.acceleration[0]) +
                                  LENGTH / 2 * abs(acceleration[1] - self.acceleration[1]))
        films = [reply.local_error / FILM_ERROR for reply in replies] if step > self.shortest else []
        return max([off / POSITION_ERROR, *films])

    def accept(self, position, acceleration, replies, step):
        distrusted = [(k, reply.distrust) for k, reply in enumerate(replies) if reply.distrust]
        if distrusted and self.num_untrusted == 0:
            print(f"{os.path.basename(sys.argv[0])}: slice {distrusted[0][0]}: {distrusted[0][1]}", file=sys.stderr)
        self.num_untrusted += bool(distrusted)
        self.contacts.accept()
        self.velocity = [self.velocity[i] + step / 2 * (self.acceleration[i] + acceleration[i]) for i in range(2)]
        self.position, self.acceleration, self.now = position, acceleration, replies
        self.time += step
        self.num_steps += 1

    def advance(self):
        while True:
            step = self.length
            try:
                found = self.try_step(step)
                error = self.error_of(*found[1:], step)
            except NotConverged as reason:
                found, error, why = None, 64, reason
            self.length *= min(max(0.9 / math.cbrt(error), 0.25), 2)
            if error <= 1:
                return self.accept(*found, step)
            self.num_rejected += 1
            if not self.length > self.shortest / 1000:
                raise why if found is None else NotConverged("found no step that is exact enough, expected one")

    def state(self):
        return (self.time, SPEED * self.time - BEFORE, *self.position, min(reply.minimum_film for reply in self.now),
                max(reply.peak_pressure for reply in self.now), self.length, *(reply.load for reply in self.now))


def roll(contacts, path):
    """Writes the same table as roller.c. Returns the exit code."""
    started = time.monotonic()
    slide = Slide(contacts)
    with open(path, "w", encoding="ascii") as file:
        loads = [f"load_{k}" for k in range(NUM_SLICES)]
        print("time", "travel", "height", "tilt", "minimum_film_thickness", "peak_pressure", "step", *loads, sep=",", file=file)
        print(*("%.9g" % value for value in slide.state()), sep=",", file=file)
        while slide.time < (BEFORE + BEHIND) / SPEED:
            slide.advance()
            print(*("%.9g" % value for value in slide.state()), sep=",", file=file)
    print(f"{slide.num_steps} steps, {slide.num_rejected} repeated, {slide.num_trials} trials of {NUM_SLICES} contacts: "
          f"{time.monotonic() - started:.2f} s; {slide.num_untrusted} steps not to be trusted")
    return 4 if slide.num_untrusted else 0


# The contacts (one for each slice) have the functions start() and step(approaches, step), which return a list of
# replies, and accept(). After start() they have time_scale and stiffness. All quantities are in SI units. A step that
# does not converge raises NotConverged.


class OnPackage:
    def __init__(self, scene, model):
        model = library.Model(model)
        self.contacts = [library.Contact(model, scene) for _ in range(NUM_SLICES)]

    def reply(self, approach, result):
        return Reply(approach, result.load, result.minimum_film_thickness, result.peak_pressure,
                                  result.local_error, result.reason)

    def start(self):
        load = LOAD / LENGTH
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
        except library.NotConverged as error:
            raise NotConverged(str(error)) from error

    def accept(self):
        for contact in self.contacts:
            contact.accept()


class OnFMU:
    def __init__(self, scene, path):
        contact = library.FMU(path)
        self.contacts = [library.Instance(contact) for _ in range(NUM_SLICES)]
        with open(scene, encoding="utf-8") as file:
            given = dict(re.findall(r"(\w+): ([\d.e+-]+)", next(line for line in file if line.startswith("physical:"))))
        load, radius, speed, modulus = (float(given[name]) for name in ("load", "radius", "speed", "modulus"))
        self.time_scale = math.sqrt(8 * load * radius / (math.pi * modulus)) / speed

    def reply(self, approach, contact):
        distrust = "" if contact.get_boolean("trusted") else "found a result that is not trusted"
        numbers = contact.get("force", "minimum_film_thickness", "peak_pressure", "local_error")
        return Reply(approach, *numbers, distrust)

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


try:
    sys.exit(roll((OnFMU if of_fmu else OnPackage)(scene, model), out))
except (library.Error, NotConverged) as error:
    sys.exit(f"roller.py: {error}")
