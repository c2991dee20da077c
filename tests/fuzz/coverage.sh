#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints on one line, for each folder, how many per cent of its lines of code are run by the corpus of a target and the
# findings of fuzzing.
#
#     tests/fuzz/coverage.sh TARGET
set -eu -o pipefail

target=$1
cd "$(dirname "$0")/../.."
root=$PWD
find build/cov -name '*.gcda' -delete
mapfile -t files < <(find "$root/tests/fuzz/corpus/$target" "$root/build/found/$target" -type f 2>/dev/null)
# for a file that fails, the lines up to the failure count too
tests/fuzz/with-bases.sh "$root/build/cov/fuzz/replay" "$target" "${files[@]}" >/dev/null 2>&1 || true
gcovr --root . --object-directory build/cov $(printf -- '--filter %s/ ' common fullrun snapgen podbuild deimselect romrun) --csv |
    awk -F, -v target="$target" '
        NR == 1 { next }
        { room = $1; sub("/[^/]*$", "", room); if (!(room in lines)) order[++count] = room; lines[room] += $2; run[room] += $3 }
        END {
            printf "%s:", target
            for (i = 1; i <= count; i++)
                if (run[order[i]]) printf " %s %.0f", order[i], 100 * run[order[i]] / lines[order[i]]
            print ""
        }'
