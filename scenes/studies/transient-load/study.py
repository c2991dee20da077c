# SPDX-License-Identifier: GPL-3.0-or-later
"""Loads beyond the published range; pressure and film at one time (paper, Fig. 5)."""
import pictures
import results
import trajectories


def extremes(out, model, *runs):
    """Prints full and reduced model beside each other for runs AMPLITUDE-PERIOD."""
    def outcome(run):
        return {results.SOLVED: "done", results.NOT_TRUSTED: "not trusted"}.get(
            run.code, f"stopped at T = {run.time[-1]:.3f}" if run.steps else "stopped at its start")

    rows = [["amplitude", "T_exc", "full model", "steps", "reduced model", "steps", "P_c", "H_c"], None]
    print("Loads beyond the published range: largest deviations of the reduced from the full model over time in %\n")
    incomplete = silent = 0
    for run in runs:
        amplitude, period = run.split("-")
        full, reduced = (results.read_trajectory(f"{out}/{kind}/extreme-{run}.h5") for kind in ("full", model))
        pressure, film = (trajectories.largest(full, reduced, column) for column in ("P_c", "H_c"))
        rows.append([f"{100 * float(amplitude):.0f} %", period, outcome(full), full.steps, outcome(reduced),
                     reduced.steps, f"{pressure:.4f}", f"{film:.4f}"])
        incomplete += full.code != results.SOLVED
        silent += reduced.code == results.SOLVED and (pressure > 1 or film > 1)
    results.table([*rows, None], left=0)
    print(f"full runs that did not complete: {incomplete}; reduced runs more than 1 % off that say nothing: {silent}")


def figure5(full, reduced, target, period, time):
    """Draws pressure and film at the last time and a zoom of the outlet; lines: full model, marks: reduced one."""
    figure, panels = pictures.page(1200, 620, 1, 2, gridspec_kw={"width_ratios": [1.5, 1]})
    (x, P, H), (reduced_x, reduced_P, reduced_H) = map(results.profile, (full, reduced))
    for axes, (left, right), most_P, most_H, every in zip(panels, ((-1.5, 1.5), (0.85, 1.05)), (1.2, 0.6), (0.06, 0.03),
                                                          (12, 1)):
        film = axes.twinx()
        pictures.pair(axes, (x, P), (reduced_x, reduced_P), every, label="$P$, ")
        pictures.pair(film, (x, H), (reduced_x, reduced_H), every, pictures.RED, "s", "$H$, ")
        axes.set(xlim=(left, right), ylim=(0, most_P), xlabel="position $X$, current frame")
        film.set(ylim=(0, most_H))
        film.grid(False)
    panels[0].set_ylabel("pressure $P$", color=pictures.BLUE)
    film.set_ylabel("film thickness $H$", color=pictures.RED)
    panels[1].set_title("outlet")
    handles = [handle for axes in (panels[1], film) for handle in axes.get_legend_handles_labels()[0]]
    panels[0].legend(handles=handles, title=f"$T_{{exc}}$ = {period},  $T$ = {time}", loc="lower center",
                     bbox_to_anchor=(0.5, 1), ncol=2, frameon=False)
    pictures.save(figure, target)


if __name__ == "__main__":
    results.commands(extremes, figure5)
