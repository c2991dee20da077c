#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A plan of NUM_M times NUM_L points of a region, M in equal ratios, L in equal steps: `ends` with those of the
# region's edges, as one would train, `middles` in the middle of as many cells, as one would check.
#     plan.sh SCENE M_FROM M_TO L_FROM L_TO MOST_ALPHA_P_H NUM_M NUM_L ends|middles
awk -v scene="$1" -v m_from="$2" -v m_to="$3" -v l_from="$4" -v l_to="$5" -v most="$6" \
    -v num_m="$7" -v num_l="$8" -v which="$9" '
    function part(i, count) { return which == "middles" ? (i + 0.5) / count : i / (count - 1) }
    BEGIN {
        printf "groups:\n  - scene: %s\n    vary:\n      moes.M: [", scene
        for (i = 0; i < num_m; i++)
            printf "%s%.9g", i ? ", " : "", m_from * exp(log(m_to / m_from) * part(i, num_m))
        printf "]\n      moes.L: ["
        for (i = 0; i < num_l; i++) printf "%s%.9g", i ? ", " : "", l_from + (l_to - l_from) * part(i, num_l)
        printf "]\n    where: {alpha_p_H: [0, %s]}\n", most
    }'
