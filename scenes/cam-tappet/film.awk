# SPDX-License-Identifier: GPL-3.0-or-later
# A run over the cam's angle: degrees from the nose, central pressure in GPa, central and smallest film in um.
#     awk -f film.awk scene.yml history.csv RUN.dat
/^physical:/ {
    gsub("[{},:]", " ")
    for (i = 2; i < NF; i += 2) reference[$i] = $(i + 1)
    pi = atan2(0, -1)
    half_width = sqrt(8 * reference["load"] * reference["radius"] / (pi * reference["modulus"]))
    hertz_pressure = 2 * reference["load"] / (pi * half_width)
    film_unit = half_width ^ 2 / reference["radius"]
}

# The angle is a linear function of time.
FILENAME ~ /\.csv$/ && FNR > 1 {
    split($0, field, ",")
    if (FNR == 2) { start = field[1]; first = field[6] }
    end = field[1]
    last = field[6]
}

FILENAME ~ /\.dat$/ && !/^#/ {
    print first + (last - first) * ($1 - start) / (end - start), $3 * hertz_pressure / 1e9, $4 * film_unit * 1e6, $5 * film_unit * 1e6
}
