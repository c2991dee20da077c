# SPDX-License-Identifier: GPL-3.0-or-later
# The film table for people; exit code 1 where a point has no solution.
#     awk -f common.awk -f table.awk film.csv
BEGIN {
    FS = ","
    expected = 0.1
    printf "%6s %5s %6s  %8s %8s %8s  %6s  %9s %8s  %s  %s\n", "M", "L", "p_H", "4h", "2h", "h", "order", "h to 0",
        "fit", "difference", "of density times film"
}
FNR > 1 {
    printf "%6g %5g %6.2f  %8.4f %8.4f %8.4f  %6.2f  %9.4f %8.4f  %+8.1f %%  %+8.1f %%\n", $1, $2, $11, $3, $4, $5,
        $6, $7, $8, 100 * $9, 100 * $10
    points++
    if ($9 == "nan") {
        lost++
        next
    }
    if (abs($9) > expected) beyond++
    worst = larger(worst, abs($9))
}
END {
    printf "%d points, %d without a solution; largest difference %.1f %%, %d beyond %g %%\n", points, lost,
        100 * worst, beyond, 100 * expected
    exit lost > 0
}
