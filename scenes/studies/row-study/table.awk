# SPDX-License-Identifier: GPL-3.0-or-later
# study.csv as text: everything, and each variant beside the default (joint, mode, quadrature) of the same size.
BEGIN { FS = ","; line = "%-6s %5s %5s  %-8s %-6s %-10s  %8s %8s %8s  %5s %4s %6s %4s  %8s %8s %9s %9s\n" }

NR == 1 {
    printf line, "", "modes", "rows", "weight", "method", "factors", "median", "95 %", "worst", "mean", "most", "ms",
        "fail", "residual", "Jacobian", "exit", "stability"
    next
}

{
    size = $1 " " $3 " " $6
    variant = $2 " " $4 " " $5
    if (size != last && NR > 2) print ""
    last = size
    printf line, $1, $3, $6, $2, $4, $5, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17
    if (!(variant in known)) {
        known[variant] = 1
        variants[++num_variants] = variant
    }
    p95[variant, size] = $8
    worst[variant, size] = $9
    stable[variant, size] = $17
    failed[variant, size] = $13
    if ($13 == 0) without[variant]++
    failures[variant] += $13
    iterations[variant] += $10
    measured[variant]++
    sizes[size] = 1
}

# Geometric mean of the ratio to the default over the sizes at which neither fails more than `enough` times.
function ratio(values, variant,   size, sum, count, one, other) {
    for (size in sizes) {
        one = values[variant, size]
        other = values[standard, size]
        if (failed[variant, size] > enough || failed[standard, size] > enough) continue
        if (!(one > 0 && other > 0) || one == "inf" || other == "inf") continue
        sum += log(one / other)
        count++
    }
    return count ? exp(sum / count) : 0
}

END {
    standard = "mode joint quadrature"
    for (size in sizes) num_sizes++
    printf "\nover %d sizes; deviations and stability divided by those of mode, joint, quadrature where neither has more\n", num_sizes
    printf "than %d failures, geometric mean; sizes without failures, failures of all\n", enough
    printf "%-8s %-6s %-10s  %8s %8s %9s  %10s %8s %8s\n", "weight", "method", "factors", "95 %", "worst", "stability",
        "iterations", "without", "failures"
    for (i = 1; i <= num_variants; i++) {
        split(variants[i], part, " ")
        printf "%-8s %-6s %-10s  %8.3f %8.3f %9.3f  %10.2f %8d %8d\n", part[1], part[2], part[3], ratio(p95, variants[i]),
            ratio(worst, variants[i]), ratio(stable, variants[i]), iterations[variants[i]] / measured[variants[i]],
            without[variants[i]], failures[variants[i]]
    }
}
