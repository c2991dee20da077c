# SPDX-License-Identifier: GPL-3.0-or-later
# The picture of some cases: ranges here, the rest is shared.
set xrange [-2:1.5]
film_lowest = 0.02
film_highest = 20
step = 24            # nodes between marks
load shared."profiles.gp"
