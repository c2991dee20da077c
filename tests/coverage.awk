# SPDX-License-Identifier: GPL-3.0-or-later
# Lines and branches run by folder, then the files of which less than 90 % of the lines are, from gcovr --csv.
NR == 1 { next }
{
    folder = $1
    sub("/[^/]*$", "", folder)
    if (!(folder in lines)) order[++count] = folder
    lines[folder] += $2; lines_run[folder] += $3
    branches[folder] += $5; branches_run[folder] += $6
    lines["all"] += $2; lines_run["all"] += $3
    branches["all"] += $5; branches_run["all"] += $6
    if ($3 < 0.9 * $2) low[++num_low] = sprintf("%s: %.1f %% of %d lines", $1, 100 * $3 / $2, $2)
}
function show(folder) {
    printf "%-24s %6d %6.1f %% %8d %6.1f %%\n", folder, lines[folder], 100 * lines_run[folder] / lines[folder],
        branches[folder], branches[folder] ? 100 * branches_run[folder] / branches[folder] : 100
}
END {
    printf "%-24s %6s %8s %8s %8s\n", "folder", "lines", "run", "branches", "run"
    for (i = 1; i <= count; i++) show(order[i])
    show("all")
    print num_low ? "files below 90 % of lines:" : "no file is below 90 % of lines"
    for (i = 1; i <= num_low; i++) print "  " low[i]
}
