# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares films over rough surfaces with published films (README.md):

    study.py waviness FOLDER AMPLITUDE OPTIONS...    remaining amplitude of waves in pure rolling; AMPLITUDE: over film
    study.py draw-waviness TABLE.txt PICTURE.png
    study.py dimple ROLLING.h5 SLIDING.h5            differences of the film on the centre line at each moment
    study.py undisturbed FOLDER OPTIONS...           moment 1 of pure rolling on other grids and with other settings
    study.py draw-dimple PICTURE.png ROLLING.h5 SLIDING.h5
"""
import h5py
import numpy as np

import results

# ---- Waves

# Settings that replace those of waviness.yml for each contact. The wave crests of the point contact are as long as the
# contact is wide; its grid has 129 by 129 nodes.
CONTACTS = {"line": {},
            "point": {"contact": "point", "grid.x_min": -3, "grid.x_max": 1.5, "grid.step": 0.03515625, "grid.y_max": 2.25,
                      "transient.end_time": 7, "transient.fixed_step": 0.03515625}}

# M, L and wavelengths over the half width
WAVES = {"line": [(100, 11, (2, 1, 0.5, 0.25, 0.125)), (200, 5, (1, 0.5, 0.25)), (50, 5, (2, 1, 0.5)),
                  (20, 10, (2, 1, 0.5))],
         "point": [(100, 10, (2, 1, 0.5))]}

# Computed values of C. H. Venner, F. Couhier, A. A. Lubrecht, J. A. Greenwood, Tribology Series 32 (1997) 103-112,
# Table 1, with an amplitude of a tenth of the central film.
COMPUTED = {(100, 11, 2): 0.073, (100, 11, 1): 0.183, (100, 11, 0.5): 0.394, (100, 11, 0.25): 0.660,
             (100, 11, 0.125): 0.839}


def argument(contact, M, L, wavelength):
    return wavelength * (M**0.75 / L**0.5 if contact == "line" else (M / L)**0.5)


def curve(contact, argument):
    """Returns the published fit: for lines Venner et al. (1997), eq. 5; for circular contacts the fit for wave crests
    across the entrainment."""
    first, second = (0.17, 0.03) if contact == "line" else (0.15, 0.015)
    return 1 / (1 + first * argument + second * argument**2)


def left(file, wavelength, amplitude):
    """Returns the remaining part of the amplitude. A wave is fitted to the film at X = 0, over whole waves in the last
    two units of T, when the end of the waviness has left the contact."""
    columns = results.printed(file, "time", "central_film_thickness")
    time, film = columns["time"], columns["central_film_thickness"]
    last = time > time[-1] - max(1, np.floor(2 / wavelength)) * wavelength - 1e-9
    phase = 2 * np.pi * time[last] / wavelength
    waves = np.stack([np.ones_like(phase), np.cos(phase), np.sin(phase)], axis=1)
    _, *wave = np.linalg.lstsq(waves, film[last], rcond=None)[0]
    return np.hypot(*wave) / amplitude


def central_film(settings, file, options):
    """Returns the central film of smooth surfaces, which is the film at the start."""
    results.run("fullrun", "waviness.yml", "-o", file, "--force", "--quiet", *options,
                *results.sets({**settings, "transient.end_time": 1e-3, "transient.fixed_step": 1e-3}))
    return results.printed(file, "central_film_thickness")["central_film_thickness"][0]


def waviness(folder, amplitude, *options):
    print(f"{'contact':8}{'M':>5}{'L':>4}{'wavelength':>12}{'argument':>10}{'left':>8}{'curve':>8}{'off':>9}"
          f"{'computed 1997':>15}{'off':>9}")
    file = f"{folder}/wave.h5"
    for contact, cases in WAVES.items():
        changed = [*results.sets(CONTACTS[contact]), *options]
        for M, L, wavelengths in cases:
            settings = {"moes.M": M, "moes.L": L}
            film = central_film(settings, file, changed)
            for wavelength in wavelengths:
                height = float(amplitude) * film
                results.run("fullrun", "waviness.yml", "-o", file, "--force", "--quiet", *changed, *results.sets(
                    {**settings, "surface.wavelength": wavelength, "surface.amplitude": height}))
                x, found = argument(contact, M, L, wavelength), left(file, wavelength, height)
                fit, then = curve(contact, x), COMPUTED.get((M, L, wavelength), np.nan)
                print(f"{contact:8}{M:5}{L:4}{wavelength:12g}{x:10.2f}{found:8.4f}{fit:8.4f}{100 * (found / fit - 1):+8.1f} %"
                      + ("" if np.isnan(then) else f"{then:15.3f}{100 * (found / then - 1):+8.1f} %"), flush=True)


def draw_waviness(table, picture):
    import pictures

    with open(table, encoding="utf-8") as file:
        lines = [line.split() for line in file][1:]
    figure, axes = pictures.page(900, 380, 1, 2, sharey=True)
    for plot, contact, label in zip(axes, WAVES, ("(λ/b) M$^{3/4}$/L$^{1/2}$", "(λ/a) (M/L)$^{1/2}$")):
        x = np.geomspace(0.5, 30)
        plot.semilogx(x, curve(contact, x), color="#666666", label="published fit")
        for (M, L, _), mark, colour in zip(WAVES[contact], pictures.MARKS, pictures.COLOURS):
            of_case = np.array([line[4:6] for line in lines if line[:3] == [contact, str(M), str(L)]], dtype=float)
            plot.plot(*of_case.T, mark, color=colour, fillstyle="none", label=f"M = {M}, L = {L}")
        if contact == "line":
            known = [(argument(contact, *case), value) for case, value in COMPUTED.items()]
            plot.plot(*np.array(known).T, "x", color="black", label="computed 1997, M = 100, L = 11")
        plot.set(title=f"{contact} contact", xlabel=label, ylim=(0, 1.1))
        plot.legend(fontsize=8)
        pictures.plain_logarithms(plot.xaxis)
    axes[0].set_ylabel("amplitude left at the centre")
    pictures.save(figure, picture)


# ---- A dimple

FILMS = "mourier-2006.csv"
WITHIN = 90  # um from the centre: beyond, the digitised films are steep

# Position of the dimple in the published simulations, um: its deepest point or, in rolling, the middle at half of its
# depth. None: the dimple has not yet entered.
CASES = {"ssr0": [None, -99.0, -43.5, 21.6, 106.0], "ssr-05": [-128.0, -69.0, -38.0, -8.0, 81.0]}


def published(case, kind, moment):
    """Returns x (um) and film (nm) of a published curve; kind: sim, exp."""
    curve = [(line["x"], line["value"]) for line in results.read_csv(FILMS)
             if (line["case"], line["kind"], line["moment"], line["quantity"]) == (case, kind, str(moment), "film")]
    return np.array(curve, dtype=float).T


def films(file, case):
    """Returns x (um) and, for each moment, the position of the dimple and the film (nm) on Y = 0, at the time step at
    which the dimple is nearest to its published position."""
    with h5py.File(file) as result:
        length, film = 1e6 * result.attrs["half_width"], 1e9 * result.attrs["film_unit"]
        line = np.abs(result["y"][...]).argmin()
        places = length * result["surface_position"][...]
        moments = [0 if place is None else np.abs(places - place).argmin() for place in CASES[case]]
        return length * result["x"][...], [(places[k], film * result["film_thickness"][k, line]) for k in moments]


def dimple(rolling, sliding):
    """Prints the differences from the published simulation at its points, and from the measured film."""
    print(f"{'case':8}{'moment':>7}{'dimple at':>11}   film against simulated, |x| <= {WITHIN} um: worst, rms, mean;"
          " measured: rms")
    for case, file in zip(CASES, (rolling, sliding)):
        x, moments = films(file, case)
        for moment, (place, film) in enumerate(moments, 1):
            off = []
            for kind in "sim", "exp":
                at, given = published(case, kind, moment)
                inside = np.abs(at) <= WITHIN
                off.append(100 * (np.interp(at[inside], x, film) / given[inside] - 1))
            print(f"{case:8}{moment:7}{place:8.1f} um   {np.abs(off[0]).max():5.2f} %  "
                  f"{np.sqrt(np.mean(off[0]**2)):5.2f} %  {off[0].mean():+5.2f} %  {np.sqrt(np.mean(off[1]**2)):6.1f} %")


# Settings on which the undisturbed film could depend.
UNDISTURBED = {
    "65 by 65 nodes": {"grid.step": 0.0703125},
    "129 by 129 nodes, as here": {},
    "257 by 257 nodes": {"grid.step": 0.017578125},
    "from X = -5.625 to 2.25, Y to 4.5": {"grid.x_min": -5.625, "grid.x_max": 2.25, "grid.y_max": 4.5},
    "modulus 110.55 GPa, Hertz radius 136.5 um": {"physical.modulus": 110.55e9},
    "incompressible": {"lubricant.density.law": "incompressible"},
    "zero pressure around": {"boundary": "zero"},
    "zero pressure around, 257 by 257 nodes": {"boundary": "zero", "grid.step": 0.017578125},
    "published rows, 65 by 65 nodes": {"discretization": "published", "grid.step": 0.0703125},
    "published rows, 129 by 129 nodes": {"discretization": "published"},
    "published rows, 257 by 257 nodes": {"discretization": "published", "grid.step": 0.017578125},
    "published rows, from -3 to 3, 257 by 257 nodes": {
        "discretization": "published", "grid.step": 0.0234375, "grid.x_min": -2.9765625, "grid.x_max": 2.9765625,
        "grid.y_max": 2.9765625},
}


def undisturbed(folder, *options):
    """Compares the film at the start, when the dimple is outside, with the published simulation of moment 1."""
    at, given = published("ssr0", "sim", 1)
    inside = np.abs(at) <= WITHIN
    file = f"{folder}/undisturbed.h5"
    print(f"{'':50}{'film at x = 0':>14}   against simulated, |x| <= {WITHIN} um: worst, mean")
    for name, settings in UNDISTURBED.items():
        results.run("fullrun", "dimple.yml", "-o", file, "--force", "--quiet", *options, *results.sets(
            {**settings, "transient.end_time": 1e-3, "transient.fixed_step": 1e-3}))
        x, moments = films(file, "ssr0")
        film = moments[0][1]
        off = 100 * (np.interp(at[inside], x, film) / given[inside] - 1)
        print(f"{name:50}{np.interp(0, x, film):11.2f} nm   {np.abs(off).max():5.2f} %  {off.mean():+5.2f} %", flush=True)


def draw_dimple(picture, rolling, sliding):
    import pictures

    figure, axes = pictures.page(1000, 900, 5, 2, sharex=True, sharey=True)
    for column, (case, file) in enumerate(zip(CASES, (rolling, sliding))):
        x, moments = films(file, case)
        for moment, (_, film) in enumerate(moments, 1):
            plot = axes[moment - 1, column]
            plot.plot(x, film, color=pictures.BLUE, label="here")
            plot.plot(*published(case, "sim", moment), "s", color=pictures.RED, fillstyle="none", markersize=4,
                      label="simulated, 2006")
            plot.plot(*published(case, "exp", moment), ".", color="#666666", markersize=3, label="measured, 2006")
            plot.set(xlim=(-160, 160), ylim=(100, 400))
            if column == 0:
                plot.set_ylabel("film [nm]")
        axes[0, column].set_title(["pure rolling", "dimple on the slower surface, 0.5 of the mean speed"][column],
                                  fontsize=11)
        axes[-1, column].set_xlabel("x [µm]")
    axes[0, 0].legend(fontsize=8, loc="upper center", ncol=3)
    pictures.save(figure, picture)


if __name__ == "__main__":
    results.commands(waviness, draw_waviness, dimple, undisturbed, draw_dimple)
