# SPDX-License-Identifier: GPL-3.0-or-later
"""The look of all pictures: each is saved as PNG and as SVG."""
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

# Colours that the colour-blind tell apart (Okabe and Ito), and marks that go with them.
BLUE, RED, GREEN, PINK, ORANGE, SKY = COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]
MARKS = ["o", "s", "^", "D", "v", "P"]

plt.rcParams.update({
    "figure.dpi": 100, "savefig.facecolor": "white", "font.size": 11, "svg.fonttype": "none", "svg.hashsalt": "ehdrom",
    "axes.grid": True, "grid.color": "#e0e0e0", "grid.linewidth": 0.7, "axes.axisbelow": True,
    "legend.framealpha": 0.9, "legend.edgecolor": "#bbbbbb", "lines.linewidth": 1.6,
    "axes.prop_cycle": matplotlib.cycler(color=COLOURS),
})


def page(width, height, rows=1, columns=1, **options):
    """A figure of so many pixels with its axes, as plt.subplots."""
    return plt.subplots(rows, columns, figsize=(width / 100, height / 100), constrained_layout=True, **options)


def save(figure, file):
    """Saves the figure as PNG (the file) and as SVG beside it."""
    figure.savefig(file)
    figure.savefig(os.path.splitext(file)[0] + ".svg", metadata={"Date": None})
    plt.close(figure)
