# SPDX-License-Identifier: GPL-3.0-or-later
# Functions that several scripts share: awk -f common.awk -f SCRIPT.awk
function abs(x) { return x < 0 ? -x : x }
function larger(x, y) { return x == "" || y > x ? y : x }

# Prints a line of so many dashes.
function print_rule(width,    line) {
    line = sprintf("%" width "s", "")
    gsub(" ", "-", line)
    print line
}

# The columns of a CSV file from its header, the present record: field_of[NAME] is the number of a field.
function read_header(field_of,    i) {
    split("", field_of)
    for (i = 1; i <= NF; i++) field_of[$i] = i
}
