/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/ellipse.h"

const contact_shape shape_round = {1, 1, 1, 1};
