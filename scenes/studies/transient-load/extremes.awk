# SPDX-License-Identifier: GPL-3.0-or-later
# Prints amplitude against period, full and reduced. A line each run:
#     AMPLITUDE-PERIOD dP_c T dH_c T TIMES FIRST_LINE LAST_LINE FIRST_LINE LAST_LINE
# with the first and last line of the full and then of the reduced run (trajectory.sh).
function outcome(code, time) {
    return code == 0 ? "done" : code == 4 ? "not trusted" : sprintf("stopped at T = %.3f", time)
}

BEGIN {
    print "Loads beyond the published range: largest deviations of the reduced from the full model over time in per cent\n"
    printf "%9s %6s   %-20s %6s   %-20s %6s %9s %9s\n", "amplitude", "T_exc", "full model", "steps", "reduced model", "steps", "P_c", "H_c"
    print_rule(92)
}

{
    split($1, run, "-")
    printf "%7d %% %6s   %-20s %6d   %-20s %6d %9.4f %9.4f\n", 100 * run[1] + 0.5, run[2], outcome($9, $18), $11,
        outcome($25, $34), $27, $2, $4
    if ($9 != 0) incomplete++
    if ($25 == 0 && ($2 > 1 || $4 > 1)) silent++
}

END {
    print_rule(92)
    printf "full runs that did not complete: %d; reduced runs more than 1 %% off that say nothing: %d\n", incomplete, silent
}
