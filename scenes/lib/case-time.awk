# SPDX-License-Identifier: GPL-3.0-or-later
# Trajectories of cases.csv:
#     awk -f case-time.awk cases.csv                           their periods
#     awk -f case-time.awk -v want=STEPS-PERIOD cases.csv      the settings of one, for a program's command line:
#                                                         STEPS is adaptive, tenth (of the tolerance) or fixed
BEGIN {
    FS = ","
    split(want, wanted, "-")
    steps["tenth"] = " --set transient.tolerance=1e-5"
}

NR == 1 || NF < 2 { next }
want == "" { print $1 }

$1 == wanted[2] {
    steps["fixed"] = " --set transient.fixed_step=" $3
    print "--set transient.load.period=" $1 " --set transient.end_time=" $2 steps[wanted[1]]
}
