# SPDX-License-Identifier: GPL-3.0-or-later
"""Film on the centre line of a ball on a disc as a dimple passes, beside published films (README.md):

    study.py table ROLLING.h5 SLIDING.h5             differences, moment by moment
    study.py undisturbed FOLDER OPTIONS...           moment 1 of pure rolling on other grids and with other numbers
    study.py draw PICTURE.png ROLLING.h5 SLIDING.h5
"""
import h5py
import numpy as np

import results

TABLE = "mourier-2006.csv"
WITHIN = 90  # um from the centre: beyond, the digitised films are steep

# Of the published simulations where the middle of the dimple is, um: where it is deepest, in rolling the middle at half
# its depth. None: it has not come in yet.
CASES = {"ssr0": [None, -99.0, -43.5, 21.6, 106.0], "ssr-05": [-128.0, -69.0, -38.0, -8.0, 81.0]}


def published(case, kind, moment):
    """Returns x (um) and film (nm) of a published curve; kind: sim, exp."""
    curve = [(line["x"], line["value"]) for line in results.read_csv(TABLE)
             if (line["case"], line["kind"], line["moment"], line["quantity"]) == (case, kind, str(moment), "film")]
    return np.array(curve, dtype=float).T


def films(file, case):
    """x (um) and for each moment where the dimple is and the film (nm) on Y = 0, of the step nearest to it."""
    with h5py.File(file) as result:
        length, film = 1e6 * result.attrs["half_width"], 1e9 * result.attrs["film_unit"]
        line = np.abs(result["y"][...]).argmin()
        places = length * result["surface_position"][...]
        moments = [0 if place is None else np.abs(places - place).argmin() for place in CASES[case]]
        return length * result["x"][...], [(places[k], film * result["film_thickness"][k, line]) for k in moments]


def table(rolling, sliding):
    """Differences from the published simulation at its points, and from the measured film."""
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


# What the undisturbed film could depend on.
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
    """Film at the start, when the dimple is outside, against the simulation of then."""
    at, given = published("ssr0", "sim", 1)
    inside = np.abs(at) <= WITHIN
    file = f"{folder}/undisturbed.h5"
    print(f"{'':50}{'film at x = 0':>14}   against simulated, |x| <= {WITHIN} um: worst, mean")
    for name, settings in UNDISTURBED.items():
        results.run("fullrun", "scene.yml", "-o", file, "--force", "--quiet", *options, *results.sets(
            {**settings, "transient.end_time": 1e-3, "transient.fixed_step": 1e-3}))
        x, moments = films(file, "ssr0")
        film = moments[0][1]
        off = 100 * (np.interp(at[inside], x, film) / given[inside] - 1)
        print(f"{name:50}{np.interp(0, x, film):11.2f} nm   {np.abs(off).max():5.2f} %  {off.mean():+5.2f} %", flush=True)


def draw(picture, rolling, sliding):
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
    results.commands(table, undisturbed, draw)
