# SPDX-License-Identifier: GPL-3.0-or-later
# Central film in Moes units, H (3M/2)^(2/3), on three grids of steps 4h, 2h, h and extrapolated to none by
# Richardson with the order that is observed, at most 2; and by the fit of Nijenbanning, Venner and Moes,
# Wear 176 (1994) 217, of the circular contact. The difference is shown for the film and for its mass, density
# times film, as an incompressible lubricant would have it: the law is that of Dowson and Higginson.
#     film.sh ... | awk -f film.awk

function density(pressure) {
    return (5.9e8 + 1.34 * pressure) / (5.9e8 + pressure)
}

BEGIN { FS = "," }
$1 == "fit" { fit[$2, $3] = $4 * (1.5 * $2) ^ (2 / 3); next }
{
    if ($1 == 1) { M_of[++last] = $2; L_of[last] = $3 }
    status[$1, $2, $3] = $4
    central[$1, $2, $3] = $5
    central_pressure[$1, $2, $3] = $6
    hertz_pressure[$2, $3] = $7
    complementarity[$1, $2, $3] = $8
}

END {
    print "M,L,H_4h,H_2h,H_h,order,H_0,fit,difference,difference_of_mass,p_H_GPa,complementarity"
    for (i = 1; i <= last; i++) {
        M = M_of[i]
        L = L_of[i]
        known = 1
        violation = 0
        for (g = 1; g <= 3; g++) {
            solved = status[g, M, L] == 0
            film[g] = solved ? central[g, M, L] * (1.5 * M) ^ (2 / 3) : "nan"
            if (!solved) known = g < 3 ? 0 : -1
            if (solved && complementarity[g, M, L] > violation) violation = complementarity[g, M, L]
        }
        order = used = 2
        if (known == 1) {
            ratio = (film[2] - film[1]) / (film[3] - film[2])
            order = ratio > 0 ? log(ratio) / log(2) : "nan"
            if (ratio > 0 && order < 2) used = order > 1 ? order : 1
        } else {
            order = "nan"
        }
        # without the coarsest grid the order is the scheme's
        limit = known == -1 || film[2] == "nan" ? "nan" : film[3] + (film[3] - film[2]) / (2 ^ used - 1)
        difference = limit == "nan" ? "nan" : limit / fit[M, L] - 1
        p_H = hertz_pressure[M, L]
        mass = limit == "nan" ? "nan" : limit * density(p_H * central_pressure[3, M, L]) / fit[M, L] - 1
        printf "%s,%s,%s,%s,%s,%s,%s,%.7g,%s,%s,%.4g,%.3g\n", M, L, film[1], film[2], film[3], order, limit,
            fit[M, L], difference, mass, p_H / 1e9, violation
    }
}
