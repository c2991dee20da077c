# SPDX-License-Identifier: GPL-3.0-or-later
# Prints the functions of a callgrind output: name, calls, and instructions including called functions. Calls of
# a function by itself are left out. The first line is the total.
#     awk -f calls.awk callgrind.out

# Returns the name of a function by its number; callgrind writes the name only once.
function named(text,   id) {
    match(text, /\([0-9]+\)/)
    id = substr(text, RSTART, RLENGTH)
    if (length(text) > RSTART + RLENGTH) name[id] = substr(text, RSTART + RLENGTH + 1)
    return name[id]
}

/^fn=/ { caller = named($0); next }
/^cfn=/ { callee = named($0); next }
/^calls=/ {
    if (callee != caller) calls[callee] += substr($1, 7)
    of_call = 1
    next
}
of_call {
    if (callee != caller) cost[callee] += $2
    of_call = 0
}
/^(summary|totals):/ { total = $2 }

END {
    print "total", 1, total
    for (f in calls) print f, calls[f], cost[f]
}
