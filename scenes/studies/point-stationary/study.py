# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws exit lines, and measures speed and growth of the stationary point contact (Makefile)."""
import os
import shlex

import numpy as np

import results


def exit_line(file):
    """Returns X and Y of the exit line."""
    columns = results.printed(file, "exit_position", "y")
    return columns["exit_position"], columns["y"]


def exits(picture, folder, model, *names):
    """Draws the exit lines of some cases."""
    import pictures
    figure, axes = pictures.page(980, 700)
    for i, case in enumerate(results.find_cases(names)):
        for kind, style in ("full", "-"), (model, pictures.MARKS[i % 6]):
            axes.plot(*exit_line(case.file(folder, kind)), style, color=pictures.COLOURS[i % 6],
                      fillstyle="none", label=case.label if kind == "full" else None)
    axes.set(xlabel="exit $X = x/a$", ylabel="$Y = y/a$", ylim=(0, None))
    axes.legend(loc="upper right")
    pictures.save(figure, picture)


def speed(folder, model, settings, sizes):
    """Prints times and deviations of both models for each case, on one thread: the least time of three cold starts of
    the full model, the median time of many online solutions, the deviations of central and minimum film, and the mean
    and largest distance of the exit lines in nodes. The last line has the worst values of all cases inside the
    training. settings: options of both programs; sizes: options of romrun only, such as --pressure-modes 50."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    print(f"{'':12}      full   reduced     full/  iterations        H_c        H_m    exit, nodes")
    print(f"{'case':12}         s        ms   reduced  full, red.   permille   permille  mean, largest", flush=True)
    trusted = []
    for case in results.read_cases():
        options = ["scene.yml", "--force", "--quiet", *shlex.split(settings), *case.options]
        files = [f"{folder}/speed-full-{attempt}.h5" for attempt in (1, 2, 3)]
        for file in files:
            results.run("fullrun", *options, "-o", file)
        online = f"{folder}/speed-reduced.h5"
        results.run("romrun", *options, "--model", f"{folder}/{model}.h5", *shlex.split(sizes), "--repeat", 201,
                    "--set", "output.fields=true", "-o", online)
        full, reduced = results.solution(files[0]), results.solution(online)
        seconds = min(results.solution(file)["seconds"] for file in files)
        central, minimum = (1000 * (reduced[film] / full[film] - 1) for film in ("H_c", "H_min"))
        apart = np.abs(exit_line(online)[0] - exit_line(files[0])[0]) / results.value(online, "step")
        line = [1e3 * reduced["seconds"], seconds / reduced["seconds"], reduced["iterations"], central, minimum,
                np.mean(apart), np.max(apart)]
        outside = reduced["status"] == results.NOT_TRUSTED
        print(f"{case.name:12} {seconds:9.3f} {line[0]:9.3f} {line[1]:9.0f} {full['iterations']:6.0f} {line[2]:4.0f} "
              f"{central:10.4f} {minimum:10.4f} {line[5]:8.2f} {line[6]:5.0f}"
              f"{'  not trusted' if outside else ''}", flush=True)
        if not outside:
            trusted.append(line)
    if trusted:
        most, least, mean = (function(np.abs(trusted), axis=0) for function in (np.max, np.min, np.mean))
        print(f"{'worst':22} {most[0]:9.3f} {least[1]:9.0f} {most[2]:11.0f} {most[3]:10.4f} {most[4]:10.4f} "
              f"{mean[5]:8.2f} {most[6]:5.0f}")


def growth(folder, step, modes, rows):
    """Prints the cost of an online solution on a grid. The numbers of modes and rows are the same on all grids.
    Columns: lines of the half grid, nodes, unknowns, rows, needed nodes, iterations, milliseconds, microseconds per
    iteration. Reads FOLDER/growth-STEP-snapshots.h5."""
    snapshots, basis, residuals, model, result = (f"{folder}/growth-{step}-{part}.h5" for part in (
        "snapshots", "basis", "residuals", "model", "result"))
    grid = ["--force", "--set", f"grid.step={step}"]
    results.run("podbuild", snapshots, "-o", basis, "--pressure-modes", modes, "--weight", "row-norm", "--plan",
                f"{folder}/growth-plan.yml", *grid, outcomes=[0])
    results.run("snapgen", f"{folder}/growth-plan.yml", "--basis", basis, "-o", residuals, "--quiet", *grid, outcomes=[0])
    results.run("deimselect", residuals, "--no-check", "--basis", basis, "-o", model, "--force", "--method", "exits", "--rows", rows,
                outcomes=[0])
    solved = []
    for M, L in (17, 4.5), (19.5, 5.5), (22, 6.5), (26, 5), (27, 6):
        # solutions outside of the small training count too
        results.run("romrun", "scene.yml", "--model", model, "--allow-untrusted", "--repeat", 201, "-o", result, *grid,
                    *results.sets({"moes.M": M, "moes.L": L}), outcomes=[0])
        solved.append(results.solution(result))
    iterations, seconds = (sum(part[name] for part in solved) for name in ("iterations", "seconds"))
    size = results.model_sizes(model)
    lines = len(np.unique(results.printed(model, "y")["y"]))
    print(f"{lines:6} {size['nodes']:8} {size['pressure_modes'] + size['deformation_modes'] + 1:6} {size['rows']:6} "
          f"{size['needed_nodes']:8} {iterations / len(solved):6.1f} {1e3 * seconds / len(solved):10.3f} "
          f"{1e6 * seconds / iterations:10.1f}")


results.commands(exits, speed, growth)
