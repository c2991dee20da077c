# SPDX-License-Identifier: GPL-3.0-or-later
# Sums up the output of sweeps as tables with one row for each run. The lines may begin with the "# " of a log:
#
#     awk -f tests/fault/counts.awk build/release/test-logs/long_{fault,kills}.bats.tap

{ sub(/^# /, "") }

!/ wrong / { next }

{
    name = $1
    if (!(name in seen)) names[++num_names] = name
    seen[name]
}

/ kills of / {
    often[name] += $4
    runs[name] += $7
    wrong_kills[name] += $9
    next
}

# NAME KIND HOW N injected N failed N right N foreign ends N wrong PROGRAM
$3 == "kill" || $3 == "tear" || $3 == "power" {
    ends[name, $3] += $4
    wrong_kills[name] += $13
    killed[name]
    next
}

{
    what = $2 == "memory" ? "memory" : "file"
    faults[name, what] += $4
    right[name, what] += $8
    foreign[name] += $10
    wrong[name] += $13
    faulty[name]
}

# Prints a dash for a run that was not swept.
function cell(count) { return count ? count : "–" }

function row(name, a, b, c, d, e, f, kills) {
    print "| " name " | " cell(a) " | " cell(b) " | " cell(c) " | " cell(d) " | " (kills ? cell(e) : e + 0) " | " f + 0 " |"
}

END {
    print "| run | calls of files that fail | right | allocations refused | right | foreign ends | wrong |\n|---|---|---|---|---|---|---|"
    for (i = 1; i <= num_names; i++) {
        n = names[i]
        if (!(n in faulty)) continue
        row("`" n "`", faults[n, "file"], right[n, "file"], faults[n, "memory"], right[n, "memory"], foreign[n], wrong[n])
        a += faults[n, "file"]; b += right[n, "file"]; c += faults[n, "memory"]; d += right[n, "memory"]; e += foreign[n]; f += wrong[n]
    }
    row("all", a, b, c, d, e, f)
    a = b = c = d = e = f = 0
    print "\n| run | killed at a call | torn writes | power cuts | killed over and over | runs of these | lost |\n|---|---|---|---|---|---|---|"
    for (i = 1; i <= num_names; i++) {
        n = names[i]
        if (!(n in killed) && !(n in often)) continue
        row("`" n "`", ends[n, "kill"], ends[n, "tear"], ends[n, "power"], often[n], runs[n], wrong_kills[n], 1)
        a += ends[n, "kill"]; b += ends[n, "tear"]; c += ends[n, "power"]; d += often[n]; e += runs[n]; f += wrong_kills[n]
    }
    row("all", a, b, c, d, e, f, 1)
}
