# SPDX-License-Identifier: GPL-3.0-or-later
"""A list of models for parts of a region beside one model of all of it (README.md):

    study.py costs FOLDER SCENES MODELS.yml MODEL.h5...    sizes, memory and time online, of random scenes
    study.py border FOLDER PICTURE.png MODELS.yml          the central film where the contact passes from one part to the next

MODELS.yml is the list.
"""
import os
import resource
import subprocess
import sys

import numpy as np

import results

SCENE = "whole/scene.yml"
DENSITIES = {"dowson-higginson": "compressible", "incompressible": "incompressible"}


def solve_cases(model, cases, table, *options):
    """Columns of the table that romrun makes of the cases, and the largest memory that it had, in MB."""
    command = [os.path.join(os.environ["BIN"], "romrun"), SCENE, "--cases", cases, "--model", model, "-o", table,
               "--force", "--quiet", "--jobs", "1", "--allow-untrusted", *options]
    run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    said = run.stderr.read().decode()
    _, code, used = os.wait4(run.pid, 0)
    if os.waitstatus_to_exitcode(code) not in (results.SOLVED, results.NOT_CONVERGED):
        sys.exit(said)
    lines = results.read_csv(table)
    return {name: np.array([float(line[name]) for line in lines])
            for name in ("status", "central_film_thickness", "solve_seconds [s]") if name in lines[0]}, used.ru_maxrss / 1024


def draw(file, count, models):
    """Random scenes of the region, in the extent of the training: M even in its logarithm, L, and alpha p_H."""
    names = ("state_moes_M", "state_alpha_p_H")
    trained = [results.printed(model, *names) for model in results.listed_models(models)]
    M, rise = (np.concatenate([part[name] for part in trained]) for name in names)
    L = rise / np.sqrt(M / (2 * np.pi))
    random = np.random.default_rng(1)
    scenes = []
    while len(scenes) < count:
        drawn = np.exp(random.uniform(np.log(M.min()), np.log(M.max()))), random.uniform(L.min(), L.max())
        if drawn[1] * np.sqrt(drawn[0] / (2 * np.pi)) <= rise.max():
            scenes.append([f"{of:.12g}" for of in drawn])
    results.write_csv(file, ["moes.M", "moes.L"], scenes)


def costs(folder, count, models, *files):
    """Of each model and, last, of the list: what it was trained on, its sizes, its files, and online memory and time."""
    rows = [["", "points", "modes", "rows", "files, MB", "memory, MB", "a solution, ms: median", "95 %"], None]
    cases = f"{folder}/cases.csv"
    draw(cases, int(count), models)
    for model in (*files, models):
        parts = results.listed_models(model)
        sizes = [results.model_sizes(file) for file in parts]
        columns, memory = solve_cases(model, cases, f"{folder}/solved.csv")
        seconds = 1e3 * columns["solve_seconds [s]"][columns["status"] == 0]
        rows.append([model, *(" or ".join(str(size[key]) for size in sizes) for key in ("states", "pressure_modes", "rows")),
                     f"{sum(map(os.path.getsize, parts)) / 1e6:.0f}", f"{memory:.0f}",
                     f"{np.median(seconds):.3f}", f"{np.quantile(seconds, 0.95):.3f}"])
    results.table(rows)


def border(folder, picture, models):
    """The central film over M across the border, off the full model, of the list and of both parts alone."""
    import pictures

    M = np.geomspace(30, 80, 41)
    lower, higher = results.listed_models(models)
    figure, axes = pictures.page(900, 620, 2, 1, sharex=True)
    for (density, name), colour in zip(DENSITIES.items(), pictures.COLOURS):
        cases, plan = f"{folder}/border.csv", f"{folder}/border.yml"
        results.write_csv(cases, ["moes.M", "lubricant.density.law"], [[f"{m:.12g}", density] for m in M])
        results.write_changed(plan, f"groups:\n  - scene: ../{SCENE}\n    points: border.csv\n")
        results.run("snapgen", plan, "-o", f"{folder}/full.h5", "--force", "--quiet", "--set", "output.resolution=false")
        full = results.printed(f"{folder}/full.h5", "central_film_thickness")["central_film_thickness"]
        axes[0].loglog(M, full, color=colour, label=f"full model, {name}")
        for file, mark, size, label in ((lower, "v", 4, "lower"), (higher, "^", 4, "higher"), (models, "o", 7, "list")):
            film = solve_cases(file, cases, f"{folder}/{density}.csv")[0]["central_film_thickness"]
            axes[1].plot(M, 1e3 * np.abs(film / full - 1), mark, color=colour, fillstyle="none", markersize=size,
                         label=f"{label}, {name}")
            if file == models:
                axes[0].loglog(M, film, "o", color=colour, fillstyle="none", label=f"list, {name}")
    axes[0].set_ylabel("central film H")
    axes[1].set(xlabel="M", ylabel="off the full model, ‰", yscale="log", xscale="log")
    for plot in axes:
        for edge in (40, 60):
            plot.axvline(edge, color="#999999", linewidth=1)
        plot.legend(fontsize=8, ncols=2)
    pictures.plain_logarithms(axes[1].xaxis)
    pictures.save(figure, picture)


if __name__ == "__main__":
    results.commands(costs, border)
