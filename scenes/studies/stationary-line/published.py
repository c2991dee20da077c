# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables 2 to 4 and figure 3 as published, of the stationary line contact in both regions (published.mk).

    published.py tables FOLDER 'SIZES' MODEL...      SIZES: of the published model, as results.model_sizes
    published.py point FOLDER KIND-PRESSURE-DEFORMATION CASE [--set KEY=VALUE...]
    published.py figure3 PICTURE CASE PRESSURE DEFORMATION 'SIZES' POINT.txt...
"""
import tempfile

import results


def tables(folder, sizes, *models):
    """Prints sizes, iterations, times and films of the full and of all reduced models, beside the published ones."""
    cases = results.read_cases()
    full, *reduced = [[results.solution(f"{folder}/{kind}/{case.name}.h5") for case in cases]
                      for kind in ("full", *models)]
    heads = "".join(f" {name:>12}" for name in (*models, "published"))

    print("Table 2: sizes\n")
    print(f"{'':12} {'n':>6} {'2n+1':>6} {'m':>5}  unknowns   n_p  n_delta   rows  needed nodes")
    print(results.rule(79))
    for name, size in [*((model, results.model_sizes(f"{folder}/{model}.h5").values()) for model in models),
                       *([("published", map(int, sizes.split()))] if sizes else [])]:
        n, pressure, deformation, rows, needed, states = size
        print(f"{name:12} {n:6} {2 * n + 1:6} {states:5} {pressure + deformation + 1:9} {pressure:5} "
              f"{deformation or '-':>8} {rows:6} {needed:13}")

    def section(head, columns, width, line):
        """A table of lines for each case, under a head and the columns of the full model, so wide with the case."""
        print(f"\n{head}\n\n{columns:>{width}}{heads}\n{results.rule(width + len(heads))}")
        for i, case in enumerate(cases):
            where = case.settings
            label = (f"{where['lubricant.viscosity.preset']:9} {where['moes.M']:>4} {where['moes.L']:>3} "
                     f"{float(where.get('hertz_pressure', 0)) / 1e9:5g}")
            print(f"{label:24}" + line(full[i], [part[i] for part in reduced], case.published))

    def mark(part):
        return {1: "*", 4: "+"}.get(part["status"], "")

    def iterations(full, reduced, published):
        return (f" {full['iterations']:10.0f} {published.get('iterations_full', '-'):>10} "
                + "".join(f" {part['iterations']:.0f}{mark(part)}".rjust(13) for part in reduced)
                + f" {published.get('iterations_reduced', '-'):>12}")

    def milliseconds(published, kind):
        return f"{1000 * float(published[f'seconds_{kind}']):.0f}" if f"seconds_{kind}" in published else "-"

    def times(full, reduced, published):
        return (f" {1000 * full['seconds']:10.1f} {milliseconds(published, 'full'):>10} "
                + "".join(f" {1000 * part['seconds']:12.2f}" for part in reduced)
                + f" {milliseconds(published, 'reduced'):>12}")

    def permille(full, part):
        return 1000 * abs(part["H_c"] / full["H_c"] - 1)

    def films(full, reduced, published):
        return (f" {full['H_c']:11.8f} {published.get('H_c_full', ''):>11}"
                + "".join(f" {part['H_c']:12.8f}" for part in reduced)
                + f" {published.get('H_c_reduced', ''):>12}\n{'':48}"
                + "".join(f" {permille(full, part):.4f}{mark(part)}".rjust(13) for part in reduced)
                + f" {published.get('deviation_permille', ''):>12}")

    section("Table 3: Newton iterations (* not converged, + outside of the trained range)",
            "full  published ", 47, iterations)
    section("Table 3: time of the solution in ms; last line: speed-up over the full model, mean of the cases",
            "full  published ", 47, times)
    known = [case.published for case in cases if "seconds_reduced" in case.published]
    ratios = [[a["seconds"] / b["seconds"] for a, b in zip(full, part)] for part in reduced]
    ratios.append([float(part["seconds_full"]) / float(part["seconds_reduced"]) for part in known])
    print(results.rule(47 + len(heads)))
    print(f"{'speed-up':47}" + "".join(f" {sum(part) / max(1, len(part)):12.0f}" for part in ratios))

    section("Table 4: central film thickness H_c, and deviations of the reduced models from the full one in permille",
            "H_c full   published", 48, films)
    off = max([abs(a["H_c"] - float(case.published["H_c_full"])) for a, case in zip(full, cases)
               if "H_c_full" in case.published], default=0)
    print(results.rule(48 + len(heads)))
    print(f"{'worst: |full - published|':24} {off:22.1e}  ", end="")
    for part in reduced:
        worst = max([permille(a, b) for a, b in zip(full, part) if b["status"] != 1], default=0)
        print(f" {worst:.4f}{'*' if any(b['status'] == 1 for b in part) else ''}".rjust(13), end="")
    print(f" {max([float(part['deviation_permille']) for part in known], default=0):12.4f}")


def point(folder, name, case, *settings):
    """One point of figure 3, a model of these sizes. Prints KIND PRESSURE_MODES DEFORMATION_MODES ROWS STATUS PERMILLE;
    the status of a model that does not converge is 1."""
    kind, pressure, deformation = name.split("-")
    rows = 2 * (int(pressure) + int(deformation) + 1)
    options = next(known.options for known in results.read_cases() if known.name == case)
    with tempfile.TemporaryDirectory() as work:
        basis, residuals, model, result = (f"{work}/{part}.h5" for part in ("basis", "residuals", "model", "result"))
        results.run("podbuild", f"{folder}/snapshots.h5", "--quiet", "--deformation", kind, "--pressure-modes",
                    pressure, *(() if kind == "coupled" else ("--deformation-modes", deformation)), "-o", basis,
                    outcomes=[0])
        results.run("snapgen", "plan.yml", "--quiet", "--basis", basis, "-o", residuals, *settings, outcomes=[0])
        results.run("deimselect", residuals, "--quiet", "--basis", basis, "--rows", rows,
                    "--weights", "quadrature" if kind == "coupled" else "plain", "-o", model, outcomes=[0])
        done = results.run("romrun", "scene.yml", "--quiet", "--allow-untrusted", "--model", model, "-o", result,
                           *settings, *options, outcomes=[results.SOLVED, results.NOT_CONVERGED])
        off = abs(results.solution(result)["H_c"] / results.solution(f"{folder}/full/{case}.h5")["H_c"] - 1)
    print(kind, pressure, deformation, rows, int(done.returncode != 0), f"{1000 * off:.6g}")


def figure3(picture, name, fixed_pressure, fixed_deformation, sizes, *files):
    """Deviation of the central film against the sizes of the bases, one of which stays while the other one varies."""
    import pictures
    lines = [open(file).read().split() for file in files]
    points = sorted((line[0], *map(float, line[1:])) for line in lines)
    case = next(known for known in results.read_cases() if known.name == name)
    fixed, label = (int(fixed_pressure), int(fixed_deformation)), ("n_p", "n_\\delta")
    published = sizes.split()[1:3]
    figure, both = pictures.page(1000, 1000, 2)
    both[0].set_title(case.title)
    for varied, axes in enumerate(both):
        for kind, size, style, bottom in ("independent", fixed[1 - varied], "o-", 4e-6), ("coupled", 0, "s-", 2e-6):
            if kind == "coupled" and varied == 1:
                continue
            chosen = [point for point in points if point[0] == kind and point[2 - varied] == size]
            converged = [point for point in chosen if point[4] == 0]
            failed = [point[1 + varied] for point in chosen if point[4] == 1]
            colour = pictures.BLUE if kind == "independent" else pictures.RED
            axes.plot([point[1 + varied] for point in converged], [point[5] for point in converged], style,
                      color=colour, label=f"{kind} basis" + (f", ${label[1 - varied]}$ = {size}" if size else ""))
            axes.plot(failed, [bottom] * len(failed), "x", color=colour)
        axes.plot([], [], "x", color=pictures.BLUE, label="not converged (at the bottom)")
        if published and "deviation_permille" in case.published:
            axes.plot(int(published[varied]), float(case.published["deviation_permille"]), "kD", fillstyle="none",
                      label="published, " + " + ".join(published))
        axes.set(xlabel=f"number of {('pressure', 'deformation')[varied]} basis functions ${label[varied]}$",
                 xlim=(0, None), yscale="log", ylim=(1e-6, 1e4), ylabel="deviation of $H_c$ / permille")
        axes.legend(loc="upper right")
    pictures.save(figure, picture)


results.commands(tables, point, figure3)
