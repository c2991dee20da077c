# SPDX-License-Identifier: GPL-3.0-or-later
# The film table for people; exit code 1 where a point has no solution or is off by more than expected.
#     awk -f table.awk film.csv
BEGIN {
    FS = ","
    expected = 0.1
    printf "%6s %5s  %8s %8s %8s  %6s  %9s %8s  %s\n", "M", "L", "4h", "2h", "h", "order", "h to 0", "fit", "difference"
}
FNR > 1 {
    printf "%6g %5g  %8.4f %8.4f %8.4f  %6.2f  %9.4f %8.4f  %+8.1f %%\n", $1, $2, $3, $4, $5, $6, $7, $8, 100 * $9
    off = $9 < 0 ? -$9 : $9
    if ($9 == "nan" || off > expected) beyond++
    if ($9 != "nan" && off > worst) worst = off
    points++
}
END {
    printf "%d points, largest difference %.1f %%, %d without a solution or beyond %g %%\n", points, 100 * worst,
        beyond, 100 * expected
    exit beyond > 0
}
