# SPDX-License-Identifier: GPL-3.0-or-later
# The curve as a table, by number of points.
BEGIN {
    FS = ","
    print "                                                central film: deviation from the full model"
    print "training        points  modes   rows  failures    median      95 %     worst      ms"
}
NR > 1 { printf "%-14s %7d %6d %6d %9d  %8.1e  %8.1e  %8.1e  %6.2f\n", $1, $2, $3, $4, $5, $6, $7, $8, $9 }
