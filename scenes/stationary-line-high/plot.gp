# SPDX-License-Identifier: GPL-3.0-or-later
# The picture of some cases: ranges here, the rest is shared.
set xrange [-1.4:1.2]
film_lowest = 0.001
film_highest = 1
step = 45            # nodes between marks
load shared."profiles.gp"
