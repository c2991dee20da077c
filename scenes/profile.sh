#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Pressure and film of a result as columns: X P H
#     profile.sh RESULT.h5
h5dump -A 0 -y -w 1 -m %.8g -d /x -d /pressure -d /film_thickness "$1" | tr -d ',' | awk '
    /^DATASET/ { item = $2; count = 0 }
    /^ *[-+.0-9e]+$/ { value[item, count++] = $1 }
    END { for (i = 0; i < count; i++) print value["\"/x\"", i], value["\"/pressure\"", i], value["\"/film_thickness\"", i] }'
