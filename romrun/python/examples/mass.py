# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the motion of a mass on a contact with scipy: mass.py MODEL SCENE.yml MASS END (kg or kg/m, s)

The mass rests on the contact; from t = 0 on, its weight is 2 % larger. The integrator may try any position and step,
because each trial starts from the last accepted state of the contact. When scipy has taken a step, the program accepts
the state at the end of this step."""
import sys

import ehdrom
from scipy.integrate import RK23

if len(sys.argv) != 5:
    print("usage: mass.py MODEL SCENE.yml MASS END (kg or kg/m, s)", file=sys.stderr)
    sys.exit(64)
model, scene = sys.argv[1:3]
mass, end = map(float, sys.argv[3:])
contact = ehdrom.Contact(ehdrom.Model(model), scene, accuracy=float("inf"))
now = contact.start()
weight, accepted = now.load, 0.0


def motion(time, state):
    position, velocity = state
    step = time - accepted
    try:
        force = contact.step(step, approach=position).load if step > 0 else now.load
    except ehdrom.NotConverged:
        force = float("nan")  # scipy tries a shorter step
    return velocity, (force - 1.02 * weight) / mass


scales = contact.scales()
small = 1e-5 * scales["film"]  # m, tolerance of the position; the film is about a tenth of the scale
solver = RK23(motion, 0, [now.approach, 0], end, rtol=1e-4, atol=[small, small / scales["time"]],
              first_step=scales["time"] / 1000, max_step=scales["time"] / 20)
while solver.status == "running":
    solver.step()
    now = contact.step(solver.t - accepted, approach=solver.y[0])
    contact.accept()
    accepted = solver.t
    print(f"{solver.t:.9g},{now.approach:.9g},{now.load:.9g},{now.central_film_thickness:.9g}")
if solver.status == "failed":
    sys.exit(f"mass.py: found no step that leads on at {solver.t:.9g} s, expected {end:.9g} s")
