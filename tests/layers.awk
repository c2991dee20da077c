# SPDX-License-Identifier: GPL-3.0-or-later
# Fails on an include that goes up: a layer may include itself and what stands before it.
#   awk -f tests/layers.awk common/*/*.[ch] fullrun/*.[ch] …

BEGIN {
    count = split("common/program common/algebra common/physics common/settings common/artefact common/time " \
                  "common/output common/training fullrun romrun/model romrun/state romrun/solve romrun/trust romrun/online romrun/library romrun/calibrate romrun/fmu romrun " \
                  "podbuild deimselect snapgen", names, " ")
    for (i = 1; i <= count; i++) height[names[i]] = i
}

function layer_of(path) {
    sub("/[^/]*$", "", path)
    return path
}

/^#include "/ {
    included = $2
    gsub(/"/, "", included)
    own = layer_of(FILENAME)
    other = layer_of(included)
    if (!(own in height) || !(other in height)) {
        printf "%s:%d: found \"%s\", expected files of the layers: a folder is missing in tests/layers.awk\n", \
            FILENAME, FNR, included
        failed = 1
    } else if (height[other] > height[own] || included ~ /\/main\./) {
        printf "%s:%d: found \"%s\", expected an include of %s or of a layer before it\n", FILENAME, FNR, \
            included, own
        failed = 1
    }
}

END { exit failed }
