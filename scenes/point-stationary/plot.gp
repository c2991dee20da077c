# SPDX-License-Identifier: GPL-3.0-or-later
# The picture of some cases on the line Y = 0: ranges here, the rest is shared.
set xrange [-3:1.8]
film_lowest = 0.05
film_highest = 20
step = 3             # nodes between marks
load shared."profiles.gp"
