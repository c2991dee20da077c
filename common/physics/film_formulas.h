/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Published film formulas of the stationary contact, as H = h R/a^2. */
#ifndef EHD_FILM_FORMULAS_H
#define EHD_FILM_FORMULAS_H

#include "common/physics/contact.h"
#include <stdbool.h>

/* The dimensionless numbers that film formulas are written in. */
typedef struct film_numbers {
    double moes_M, moes_L;
    double speed;      // U = eta0 u_m/(E'R)
    double material;   // G = alpha E', 0: isoviscous
    double load;       // W = w/(E'R), of a point contact w/(E'R^2)
    double half_width; // a/R
} film_numbers;

typedef struct film_formula film_formula;

/* One formula. The power laws among them are h/R = factor U^a G^b W^c. */
struct film_formula {
    const char *name;
    const char *source; // authors, year, place
    int dimensions;     // of the contact's kind: 1 for a line, 2 for a point
    bool of_minimum;    // it gives the minimum film, not the central film
    double factor, speed_power, material_power, load_power;
    double (*film)(const film_formula *self, const film_numbers *numbers); // H
};

extern const film_formula film_formulas[]; // ends with a row whose name is NULL

/* Central film by the function fit of Moes (1992), from the four asymptotes rigid or elastic,
 * isoviscous or piezoviscous. More precisely, it is the film where the pressure gradient is zero,
 * which in the rigid isoviscous limit is at the exit. */
double film_moes(double moes_M, double moes_L);

/* Central film of the circular contact by the function fit of Nijenbanning, Venner and Moes
 * (1994), from the four asymptotes. Their film in Moes units is divided by (3 M/2)^(2/3), which
 * gives H. */
double film_nijenbanning(double moes_M, double moes_L);

/* The numbers of a contact as it is now. Its film depends on M and alpha p_H alone, and so do
 * most formulas (optimum similarity); those of Pan and Hamrock and of Hamrock and Dowson also
 * depend on E', by 1 % or less for 20 % of E'. E' is known in a physical scene only; else that of
 * steel on steel is assumed. */
film_numbers film_numbers_of(const ehd_contact *contact);

#endif
