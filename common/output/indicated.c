/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/indicated.h"

const indicated_entry indicated_entries[NUM_INDICATED] = {
    [INDICATED_CENTRAL_PRESSURE] = {"central_pressure", "indicated_deviation_central_pressure",
                                    "central pressure", ""},
    [INDICATED_EXIT_POSITION] = {"exit_position", "indicated_deviation_exit_position",
                                 "exit position", " half widths"},
    [INDICATED_LOAD] = {"load", "indicated_deviation_load", "load", ""},
    [INDICATED_PRESSURE] = {"pressure", "indicated_deviation_pressure", "pressure", " p_H"},
    [INDICATED_FILM] = {"film_thickness", "indicated_deviation_film", "film", " H_c"},
    [INDICATED_FRICTION] = {"friction", "indicated_deviation_friction", "friction", ""}};
