# SPDX-License-Identifier: GPL-3.0-or-later
"""What is left at the centre of a waviness on one of the surfaces, in pure rolling (README.md):

    study.py measure FOLDER AMPLITUDE OPTIONS...   a table of all cases; AMPLITUDE: over the central film
    study.py draw TABLE.txt PICTURE.png

The film at X = 0 is fitted by a wave over the last two units of T, whole waves, when the waviness's end has left.
"""
import numpy as np

import results

# Settings of scene.yml for each contact. The waves of the point contact are as long across as the contact is wide; its grid
# has 129 by 129 nodes.
CONTACTS = {"line": {},
            "point": {"contact": "point", "grid.x_min": -3, "grid.x_max": 1.5, "grid.step": 0.03515625, "grid.y_max": 2.25,
                      "transient.end_time": 7, "transient.fixed_step": 0.03515625}}

# M, L and wavelengths over the half width
CASES = {"line": [(100, 11, (2, 1, 0.5, 0.25, 0.125)), (200, 5, (1, 0.5, 0.25)), (50, 5, (2, 1, 0.5)),
                  (20, 10, (2, 1, 0.5))],
         "point": [(100, 10, (2, 1, 0.5))]}

# Computed values of C. H. Venner, F. Couhier, A. A. Lubrecht, J. A. Greenwood, Tribology Series 32 (1997) 103-112, Table
# 1, with an amplitude of a tenth of the central film.
PUBLISHED = {(100, 11, 2): 0.073, (100, 11, 1): 0.183, (100, 11, 0.5): 0.394, (100, 11, 0.25): 0.660,
             (100, 11, 0.125): 0.839}


def argument(contact, M, L, wavelength):
    return wavelength * (M**0.75 / L**0.5 if contact == "line" else (M / L)**0.5)


def curve(contact, argument):
    """The published fits: lines by Venner et al. (1997), eq. 5; circular contacts with waves across the entrainment."""
    first, second = (0.17, 0.03) if contact == "line" else (0.15, 0.015)
    return 1 / (1 + first * argument + second * argument**2)


def left(file, wavelength, amplitude):
    columns = results.printed(file, "time", "central_film_thickness")
    time, film = columns["time"], columns["central_film_thickness"]
    last = time > time[-1] - max(1, np.floor(2 / wavelength)) * wavelength - 1e-9
    phase = 2 * np.pi * time[last] / wavelength
    waves = np.stack([np.ones_like(phase), np.cos(phase), np.sin(phase)], axis=1)
    _, *wave = np.linalg.lstsq(waves, film[last], rcond=None)[0]
    return np.hypot(*wave) / amplitude


def central_film(settings, file, options):
    """Of smooth surfaces: the start."""
    results.run("fullrun", "scene.yml", "-o", file, "--force", "--quiet", *options,
                *results.sets({**settings, "transient.end_time": 1e-3, "transient.fixed_step": 1e-3}))
    return results.printed(file, "central_film_thickness")["central_film_thickness"][0]


def measure(folder, amplitude, *options):
    print(f"{'contact':8}{'M':>5}{'L':>4}{'wavelength':>12}{'argument':>10}{'left':>8}{'curve':>8}{'off':>9}"
          f"{'computed 1997':>15}{'off':>9}")
    file = f"{folder}/wave.h5"
    for contact, cases in CASES.items():
        changed = [*results.sets(CONTACTS[contact]), *options]
        for M, L, wavelengths in cases:
            settings = {"moes.M": M, "moes.L": L}
            film = central_film(settings, file, changed)
            for wavelength in wavelengths:
                height = float(amplitude) * film
                results.run("fullrun", "scene.yml", "-o", file, "--force", "--quiet", *changed, *results.sets(
                    {**settings, "surface.wavelength": wavelength, "surface.amplitude": height}))
                x, found = argument(contact, M, L, wavelength), left(file, wavelength, height)
                fit, then = curve(contact, x), PUBLISHED.get((M, L, wavelength), np.nan)
                print(f"{contact:8}{M:5}{L:4}{wavelength:12g}{x:10.2f}{found:8.4f}{fit:8.4f}{100 * (found / fit - 1):+8.1f} %"
                      + ("" if np.isnan(then) else f"{then:15.3f}{100 * (found / then - 1):+8.1f} %"), flush=True)


def draw(table, picture):
    import pictures

    with open(table, encoding="utf-8") as file:
        lines = [line.split() for line in file][1:]
    figure, axes = pictures.page(900, 380, 1, 2, sharey=True)
    for plot, contact, label in zip(axes, CASES, ("(λ/b) M$^{3/4}$/L$^{1/2}$", "(λ/a) (M/L)$^{1/2}$")):
        x = np.geomspace(0.5, 30)
        plot.semilogx(x, curve(contact, x), color="#666666", label="published fit")
        for (M, L, _), mark, colour in zip(CASES[contact], pictures.MARKS, pictures.COLOURS):
            of_case = np.array([line[4:6] for line in lines if line[:3] == [contact, str(M), str(L)]], dtype=float)
            plot.plot(*of_case.T, mark, color=colour, fillstyle="none", label=f"M = {M}, L = {L}")
        if contact == "line":
            known = [(argument(contact, *case), value) for case, value in PUBLISHED.items()]
            plot.plot(*np.array(known).T, "x", color="black", label="computed 1997, M = 100, L = 11")
        plot.set(title=f"{contact} contact", xlabel=label, ylim=(0, 1.1))
        plot.legend(fontsize=8)
        pictures.plain_logarithms(plot.xaxis)
    axes[0].set_ylabel("amplitude left at the centre")
    pictures.save(figure, picture)


if __name__ == "__main__":
    results.commands(measure, draw)
