# SPDX-License-Identifier: GPL-3.0-or-later
# Cases of a cases.csv (columns lubricant, M, L, p_H_GPa; an empty field leaves what the scene says).
#     awk -f case.awk cases.csv                            their names
#     awk -f case.awk -v want=NAME cases.csv               the settings of one, for a program's command line
#     awk -f case.awk -v want=NAME -v plot=1 cases.csv     its title and published deviation, for gnuplot
BEGIN { FS = "," }
/^[ \t]*(#|$)/ { next }
!head++ { next }
{
    lubricant = $1
    sub(/^no/, "no. ", lubricant)
    name = ($1 == "" ? "" : $1 "-") "M" $2 "-L" $3 ($4 == "" ? "" : "-p" $4)
    if (want == "") print name
    else if (name == want && plot)
        printf "case_title=\"%sM = %s, L = %s%s\"; published_deviation=%s\n", $1 == "" ? "" : "lubricant " lubricant ", ", $2, $3,
            $4 == "" ? "" : ", p_H = " $4 " GPa", $11 == "" ? "NaN" : $11
    else if (name == want)
        print ($1 == "" ? "" : "--set lubricant.viscosity.preset=" $1), "--set moes.M=" $2,
              "--set moes.L=" $3, ($4 == "" ? "" : "--set hertz_pressure=" $4 "e9")
}
