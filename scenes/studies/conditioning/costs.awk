# SPDX-License-Identifier: GPL-3.0-or-later
# Instructions of each solver for a system, in thousands, from callgrind's lists of functions (bench_conditioning solves
# each system 21 times).
#     awk -f costs.awk LIST...
BEGIN {
    repeats = 21
    n = split("used normal refined qr unscaled single single_refined", solver, " ")
    printf "%5s", "modes"
    for (s = 1; s <= n; s++) printf " %14s", solver[s]
    print ""
}
FNR == 1 { size[++num_sizes] = $2; next }
$1 == "fails" { gsub("-", "_", $2); fails[num_sizes, $2] = 1; next }
{
    for (s = 1; s <= n; s++)
        if ($0 ~ (":solve_" solver[s] " ")) { gsub(",", "", $1); count[num_sizes, s] = $1 }
}
END {
    for (i = 1; i <= num_sizes; i++) {
        printf "%5d", size[i]
        for (s = 1; s <= n; s++) printf " %14s", (i, solver[s]) in fails ? "fails" : sprintf("%.0f", count[i, s] / repeats / 1000)
        print ""
    }
}
