# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the film thickness over the speed: sweep.py MODEL SCENE.yml LEAST MOST PICTURE.png (speeds in m/s)"""
import sys

import ehdrom
import matplotlib.pyplot as plt
import numpy

if len(sys.argv) != 6:
    sys.stderr.write("usage: sweep.py MODEL SCENE.yml LEAST MOST PICTURE.png (speeds in m/s)\n")
    sys.exit(64)
contact = ehdrom.Contact(ehdrom.Model(sys.argv[1], stationary=True), sys.argv[2])
speeds, films = numpy.linspace(float(sys.argv[3]), float(sys.argv[4]), 20), []
for speed in speeds:
    contact["physical.speed"] = speed
    films.append(1e6 * contact.solve().central_film_thickness)
plt.loglog(speeds, films)
plt.gca().set(xlabel="speed, m/s", ylabel="central film, µm")
plt.savefig(sys.argv[5])
