# SPDX-License-Identifier: GPL-3.0-or-later
# Central film in Moes units, H (3M/2)^(2/3), on three grids of steps 4h, 2h, h and extrapolated to none by
# Richardson with the order that is observed, at most 2; and by the fit of Nijenbanning, Venner and Moes,
# Wear 176 (1994) 217, of the circular contact. The difference is shown for the film and for its mass, density
# times film, as an incompressible lubricant would have it: the law is that of Dowson and Higginson.
#     awk -f film.awk   (from film.sh)

# From the asymptotes of rigid or elastic bodies and an isoviscous or piezoviscous lubricant.
function fit(M, L,    rigid_iso, elastic_iso, rigid_piezo, elastic_piezo, iso, piezo, s) {
    rigid_iso = 145 * 1.796 ^ (-15 / 7) * M ^ -2
    elastic_iso = 3.18 * 1.63 ^ (-14 / 25) * M ^ (-2 / 15)
    rigid_piezo = 1.29 * 1.691 ^ (-2 / 3) * L ^ (2 / 3)
    elastic_piezo = 1.48 * 1.63 ^ (-7 / 20) * M ^ (-1 / 12) * L ^ 0.75
    s = 1.5 * (1 + exp(-1.2 * elastic_iso / elastic_piezo))
    iso = rigid_iso ^ 1.5 + (elastic_iso ^ -4 + 1.8 ^ -4) ^ (-3 / 8)
    piezo = (rigid_piezo ^ -8 + elastic_piezo ^ -8) ^ (-s / 8)
    return (iso ^ (2 * s / 3) + piezo) ^ (1 / s)
}

function density(pressure) {
    return (5.9e8 + 1.34 * pressure) / (5.9e8 + pressure)
}

/^HDF5/ { grid++ }
/^DATASET/ { item = $2; gsub("[\"/]", "", item); number = 0 }
/^ *[-+.0-9a-z]+,?$/ {
    sub(",", "")
    value[grid, item, ++number] = $1
    if (number > last) last = number
}

END {
    print "M,L,H_4h,H_2h,H_h,order,H_0,fit,difference,difference_of_mass,p_H_GPa,complementarity"
    for (i = 1; i <= last; i++) {
        M = value[1, "moes_M", i]
        L = value[1, "moes_L", i]
        known = 1
        violation = 0
        for (g = 1; g <= 3; g++) {
            solved = value[g, "status", i] == 0
            film[g] = solved ? value[g, "central_film_thickness", i] * (1.5 * M) ^ (2 / 3) : "nan"
            if (!solved) known = g < 3 ? 0 : -1
            if (solved && value[g, "complementarity", i] > violation) violation = value[g, "complementarity", i]
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
        difference = limit == "nan" ? "nan" : limit / fit(M, L) - 1
        p_H = value[3, "hertz_pressure", i]
        mass = limit == "nan" ? "nan" : limit * density(p_H * value[3, "central_pressure", i]) / fit(M, L) - 1
        printf "%s,%s,%s,%s,%s,%s,%s,%.7g,%s,%s,%.4g,%.3g\n", M, L, film[1], film[2], film[3], order, limit,
            fit(M, L), difference, mass, p_H / 1e9, violation
    }
}
