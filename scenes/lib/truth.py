# SPDX-License-Identifier: GPL-3.0-or-later
"""How far stationary scenes of a plan are from the truth, which has neither step nor inlet: extrapolated from a half and
a quarter of the step, times what an inlet four times as long does to the film.

    truth.py solve PLAN FOLDER [OPTION ...]    leaves FOLDER/own.h5, wide.h5, half.h5 and quarter.h5, all scenes of the
                                               plan; options of snapgen, such as --set KEY=VALUE
"""
import os

import numpy as np

import results

FILMS = "moes_M", "moes_L", "status", "central_film_thickness"


def solve(plan, folder, *options):
    """Solves the scenes of a plan on four grids."""
    def snapgen(name, settings=None):
        file = f"{folder}/{name}.h5"
        results.run("snapgen", plan, "-o", file, "--force", "--quiet", "--allow-failures", 10**6, *options,
                    *results.sets(settings or {}), "--set", "output.resolution=false")
        return file

    os.makedirs(folder, exist_ok=True)
    own = snapgen("own")
    step, x_min = results.value(own, "step"), results.value(own, "x_min")
    snapgen("wide", {"grid.x_min": f"{4 * x_min:.12g}", "grid.step": f"{step:.12g}"})
    for name, times in ("half", 0.5), ("quarter", 0.25):
        snapgen(name, {"grid.x_min": f"{x_min:.12g}", "grid.step": f"{times * step:.12g}"})


def key(M, L):
    """A scene's name in films()."""
    return f"{float(M):.8g} {float(L):.8g}"


def films(file):
    """Central films of the scenes of a file of snapgen that are solved."""
    columns = results.printed(file, *FILMS).values()
    return {key(M, L): film for M, L, status, film in zip(*columns) if status == 0}


def truths(folder):
    """Central films of neither step nor inlet of the scenes that are solved on all four grids."""
    own, wide, half, quarter = (films(f"{folder}/{name}.h5") for name in ("own", "wide", "half", "quarter"))
    return {scene: (film + (film - half[scene]) / 3) * wide[scene] / own[scene] for scene, film in quarter.items()
            if scene in half and scene in wide and scene in own}


def distances(of, exact):
    """Distances of films from those of truths(), or from other ones: the largest, 95 %, median."""
    off = np.sort([abs(film / exact[scene] - 1) for scene, film in of.items() if scene in exact and film > 0])
    if not len(off):
        return 3 * [np.nan]
    return [off[-1], *(off[int(np.ceil(part * len(off))) - 1] for part in (0.95, 0.5))]


def calibrated_scenes(model, known):
    """The scenes that a model was calibrated on, of those that are known (a key of films())."""
    scenes = {key(scene["moes.M"], scene["moes.L"]): scene for scene in results.planned_scenes(model)}
    return {name: scene for name, scene in scenes.items() if name in known}


def reduced_films(model, scenes, work, *size):
    """Central films of a reduced model, of the scenes in its trained range; NaN where it does not converge."""
    found = {}
    for name, scene in scenes.items():
        results.write_changed(f"{work}.yml", "".join(f"{key}: {value}\n" for key, value in scene.items()))
        code, film = results.reduced_film(f"{work}.yml", model, *size)
        if code != results.NOT_TRUSTED:
            found[name] = film or np.nan
    os.remove(f"{work}.yml")
    return found


if __name__ == "__main__":
    results.commands(solve)
