# SPDX-License-Identifier: GPL-3.0-or-later
# The look of all pictures, loaded before a picture's own commands (common.mk): each is drawn twice,
#     do for [ending in "png svg"] { eval page(ending, WIDTH, HEIGHT) ... }
page(ending, width, height) = sprintf("set terminal %s size %d, %d font 'sans,14' background 'white'; set output '%s.%s'", \
    ending eq "png" ? "pngcairo" : "svg", width, height, picture, ending)
set grid linetype 1 linewidth 0.7 linecolor "#e0e0e0"
set border linewidth 1.2
set tics nomirror

blue = "#0072b2"; red = "#d55e00"; green = "#009e73"; pink = "#cc79a7"; orange = "#e69f00"; sky = "#56b4e9"
colour(i) = word("#0072b2 #d55e00 #009e73 #cc79a7 #e69f00 #56b4e9", i)
mark(i) = int(word("6 4 8 12 10 14", i))
