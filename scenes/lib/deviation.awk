# SPDX-License-Identifier: GPL-3.0-or-later
# Relative deviations of a run over time from another one, both as trajectory.sh prints them:
#     awk -f common.awk -f deviation.awk OTHER.dat RUN.dat                     a line each time: T dP_c dH_c in per cent
#     awk -f common.awk -f deviation.awk -v largest=1 OTHER.dat RUN.dat        the largest ones: dP_c T dH_c T TIMES
# The other run is interpolated by a cubic through four times around, which at its own times are its own
# values; times that it does not cover are left out.
# Value of a column of the other run at time t; place is its last time at or before t.
function other(column, t,    first, i, j, weight, sum) {
    first = place - 1
    if (first > num_other - 3) first = num_other - 3
    if (first < 1) first = 1
    sum = 0
    for (i = first; i < first + 4; i++) {
        weight = 1
        for (j = first; j < first + 4; j++)
            if (j != i) weight *= (t - time[j]) / (time[i] - time[j])
        sum += weight * value[i, column]
    }
    return sum
}

/^#/ { next }

NR == FNR {
    time[++num_other] = $1
    value[num_other, 3] = $3
    value[num_other, 4] = $4
    next
}

num_other >= 4 && $1 >= time[1] && $1 <= time[num_other] {
    if (!place) place = 1
    while (place < num_other && time[place + 1] <= $1) place++
    count++
    for (column = 3; column <= 4; column++) {
        deviation[column] = 100 * ($column / other(column, $1) - 1)
        if (abs(deviation[column]) >= worst[column]) {
            worst[column] = abs(deviation[column])
            at[column] = $1
        }
    }
    if (!largest) printf "%.12g %.8g %.8g\n", $1, deviation[3], deviation[4]
}

END { if (largest) print worst[3] + 0, at[3] + 0, worst[4] + 0, at[4] + 0, count + 0 }
