# SPDX-License-Identifier: GPL-3.0-or-later
# Pressure and film at the last time, of a point contact on the line Y = 0, as columns X P H:
#     fullrun --print RESULT.h5 x pressure film_thickness | awk -f common.awk -f profile.awk
BEGIN { FS = "," }
NR == 1 { read_header(column); next }
"y" in column && $column["y"] != 0 { next }
"time" in column && $column["time"] != last { count = 0; last = $column["time"] }
NF > 1 { line[++count] = $column["x"] " " $column["pressure"] " " $column["film_thickness"] }
END { for (i = 1; i <= count; i++) print line[i] }
