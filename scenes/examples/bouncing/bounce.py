# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulates a mass that falls on a contact and bounces: bounce.py SCENE.yml MODEL OUT.csv

The integrator is the trapezoidal rule. The secant method finds the position at the end of a step. If the contact does
not solve a step, the step is halved.
"""
import csv
import sys

import ehdrom

MASS, GRAVITY = 1430.0, 9.81  # kg/m, m/s^2
DROP, END, STEP = 3e-6, 15e-3, 5e-6  # m, s, s
NEAR = 1e-16  # m, tolerance of the position
MAX_TRIALS, MAX_HALVINGS = 30, 12


class Mass:
    def __init__(self, scene, model):
        # only the force matters here, so films may be 10 % off
        self.contact = ehdrom.Contact(ehdrom.Model(model), scene, accuracy=0.1)
        self.contact.start(approach=DROP)
        self.time, self.position, self.velocity, self.force, self.film = 0.0, DROP, 0.0, 0.0, DROP

    def try_step(self, step):
        """Tries a step. Returns position and state at its end, or None if the contact does not solve it."""
        ease = step**2 / (4 * MASS)
        drift = self.position + step * self.velocity + ease * (self.force - 2 * MASS * GRAVITY)
        position, slope, before = drift + ease * self.force, 1.0, None
        for _ in range(MAX_TRIALS):
            try:
                state = self.contact.step(step, approach=position)
            except ehdrom.NotConverged:
                return None
            defect = position - drift - ease * state.load
            if abs(defect) < NEAR:
                return position, state
            if before and position != before[0]:
                slope = (defect - before[1]) / (position - before[0])
            if abs(slope) < 0.05:  # the last trial crossed the jump at which the force starts
                slope = 1.0
            before = position, defect
            position -= defect / slope
        return None

    def step(self):
        """Makes one step. Returns the impulse of force and weight in this step."""
        for halvings in range(MAX_HALVINGS):
            step = STEP / 2**halvings
            found = self.try_step(step)
            if found:
                break
        else:
            sys.exit(f"bounce.py: no step at {self.time:.6g} s")
        self.contact.accept()
        position, state = found
        impulse = step * ((self.force + state.load) / 2 - MASS * GRAVITY)
        self.velocity = 2 * (position - self.position) / step - self.velocity
        self.time, self.position, self.force = self.time + step, position, state.load
        self.film = state.central_film_thickness
        return impulse


def main(scene, model, out):
    mass = Mass(scene, model)
    rows, touches = [], None
    print("   touches   at speed      leaves   at speed   largest force   momentum less impulse")
    while mass.time < END:
        before = mass.velocity, mass.force, mass.time
        impulse = mass.step()
        rows.append((mass.time, mass.position, mass.force, mass.film))
        if mass.force > 0 and before[1] == 0:
            touches, speed, sum_, most = mass.time, before[0], 0.0, 0.0
        if touches:
            sum_, most = sum_ + impulse, max(most, mass.force)
        if mass.force == 0 and before[1] > 0:
            off = (MASS * (mass.velocity - speed) - sum_) / (MASS * mass.velocity)
            print(f"{1e3 * touches:8.3f} ms {1e3 * speed:7.3f} mm/s {1e3 * mass.time:8.3f} ms {1e3 * mass.velocity:7.3f} mm/s"
                  f" {1e-3 * most:10.2f} kN/m {off:12.1e}")
            touches = None
    with open(out, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("time", "position", "force", "central_film_thickness"))
        writer.writerows(rows)


try:
    main(*sys.argv[1:])
except ehdrom.Error as error:
    sys.exit(f"bounce.py: {error}")
