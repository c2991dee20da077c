# SPDX-License-Identifier: GPL-3.0-or-later
# Prints steps, times and deviations of the two runs: the first line of the full and of the reduced one
# (trajectory.sh), then the largest deviations (deviation.awk).
function outcome(code) { return code == 0 ? "done" : code == 4 ? "not to be trusted" : "stopped early" }

/^#/ {
    printf "%-14s %5d steps, %8.2f s, %7.3f ms a step: %s\n", NR == 1 ? "full model" : "reduced model", $5, $11, 1000 * $11 / $5, outcome($3)
    next
}

{ printf "reduced from full, at most: central pressure %.4f %%, central film %.4f %%\n", $1, $3 }
