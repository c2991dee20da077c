# SPDX-License-Identifier: GPL-3.0-or-later
"""Films and friction of reduced models of thinned flows beside the full model, on unseen scenes, and what they cost
(README.md):

    study.py FOLDER SCENES SEED OPTIONS...
"""
import os
import re
import subprocess
import sys

import numpy as np

import results

NAMES = {"central film": "central_film_thickness", "minimum film": "minimum_film_thickness",
         "friction": "friction_coefficient"}
NEWTONIAN = {"lubricant.shear.in_film": "false"}
COUNTED = 5  # scenes whose instructions are counted


def region(plan):
    """Bounds of what varies."""
    text = re.search(r"region: \{(.*)\}", open(plan).read())[1]
    return {key: (float(low), float(high))
            for key, low, high in re.findall(r"([a-z_.0-9]+): \[([^,]*), ([^\]]*)\]", text)}


def solved(program, kind, file, settings, *options):
    """Values of a result, and whether it is to be trusted."""
    done = results.run(program, f"{kind}.yml", "-o", file, "--force", "--quiet", *options, *results.sets(settings))
    found = {name: results.value(file, field) for name, field in NAMES.items()}
    found["trusted"] = done.returncode == results.SOLVED
    found["iterations"] = results.value(file, "newton_iterations")
    return found


def instructions(kind, model, file, settings, options):
    """Those of online_solve, by callgrind."""
    done = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={file}.callgrind",
                           "--toggle-collect=online_solve", os.path.join(os.environ["BIN"], "romrun"), f"{kind}.yml",
                           "--model", model, "-o", file, "--force", "--quiet", *map(str, options),
                           *results.sets(settings)],
                          capture_output=True, text=True)
    return int(re.search(r"Collected : (\d+)", done.stderr)[1])


def compare(kind, folder, scenes, options):
    model, newton = f"{folder}/{kind}-thinned.h5", f"{folder}/{kind}-newton.h5"
    file = f"{folder}/solution.h5"
    full = [solved("fullrun", kind, file, scene, *options) for scene in scenes]
    reduced = [solved("romrun", kind, file, scene, "--model", model, *options) for scene in scenes]
    newtonian = [solved("fullrun", kind, file, {**scene, **NEWTONIAN}, *options) for scene in scenes]
    sizes = results.model_sizes(newton)
    for name, of in ("thinned", results.model_sizes(model)), ("Newtonian", sizes):
        print(f"{kind}, {name}: {of['nodes']} nodes, {of['states']} points, {of['pressure_modes']} modes, "
              f"{of['rows']} rows")
    print(f"{len(scenes)} scenes, {sum(r['trusted'] for r in reduced)} to be trusted")
    print(f"{'':14}{'median off':>12}{'worst off':>12}{'thinning, median':>18}{'most':>9}")
    for name in NAMES:
        off = np.abs([r[name] / f[name] - 1 for r, f in zip(reduced, full)])
        moved = np.abs([n[name] / f[name] - 1 for n, f in zip(newtonian, full)])
        print(f"{name:14}{np.median(off):12.1e}{off.max():12.1e}{np.median(moved):18.1e}{moved.max():9.1e}")
    cut = ["--pressure-modes", sizes["pressure_modes"], "--rows", sizes["rows"], "--allow-untrusted"]
    runs = {"thinned": (model, {}, []), "thinned, cut to the size of": (model, {}, cut),
            "the Newtonian one": (newton, NEWTONIAN, [])}
    print(f"{'':28}{'instructions':>14}{'iterations':>12}{'an iteration':>14}")
    for name, (of, settings, more) in runs.items():
        counted = [(instructions(kind, of, file, {**scene, **settings}, [*more, *options]),
                    results.value(file, "newton_iterations")) for scene in scenes[:COUNTED]]
        cost, steps = np.mean(counted, axis=0)
        print(f"{name:28}{cost:14.3g}{steps:12.2f}{cost / steps:14.3g}")
    print()


def main(folder, count, seed, *options):
    for kind in "line", "point":
        bounds = region(f"{kind}-thinned.yml")
        random = np.random.default_rng(int(seed))
        scenes = [{key: f"{low * (high / low) ** random.random():.6g}" for key, (low, high) in bounds.items()}
                  for _ in range(int(count))]
        compare(kind, folder, scenes, options)


main(*sys.argv[1:])
