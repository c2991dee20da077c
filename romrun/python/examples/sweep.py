# SPDX-License-Identifier: GPL-3.0-or-later
"""Film thickness over speed: sweep.py MODEL SCENE.yml LEAST MOST PICTURE.png (speeds in m/s)"""
import sys

import ehdrom
import matplotlib.pyplot as plt
import numpy

if len(sys.argv) != 6:
    print("usage: sweep.py MODEL SCENE.yml LEAST MOST PICTURE.png (speeds in m/s)", file=sys.stderr)
    sys.exit(64)
model, scene, least, most, picture = sys.argv[1:]
contact = ehdrom.Contact(ehdrom.Model(model, stationary=True), scene)
films = {}
for speed in numpy.linspace(float(least), float(most), 20):
    contact["physical.speed"] = speed
    films[speed] = contact.solve().central_film_thickness
plt.loglog(list(films), 1e6 * numpy.array(list(films.values())))
plt.xlabel("speed, m/s")
plt.ylabel("central film, µm")
plt.savefig(picture)
