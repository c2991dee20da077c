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
    double half_width; // a/R, of an ellipse along the entrainment, like R and all of these
    // of an ellipse, each 1 of a circle: R_y/R_x, b/a of the dry contact, and a over the radius of
    // the circular contact of the same load, R_x and E'
    double radius_ratio, ellipticity, width_ratio;
} film_numbers;

typedef struct film_formula film_formula;

/* What leaks to the sides of a contact: a film is 1 - share exp(-rate x) times as thick, x the power
 * of R_y/R_x or, where that is 0, b/a. */
typedef struct film_leakage {
    double share, rate, power;
} film_leakage;

/* One formula. The power laws among them are h/R = factor U^a G^b W^c, and what leaks. */
struct film_formula {
    const char *name;
    const char *source; // authors, year, place
    int dimensions;     // of the contact's kind: 1 for a line, 2 for a point
    bool of_minimum;    // it gives the minimum film, not the central film
    double factor, speed_power, material_power, load_power;
    double (*film)(const film_formula *self, const film_numbers *numbers); // H
    film_leakage leakage;
    double min_ellipticity, max_ellipticity; // b/a for which it was made
};

extern const film_formula film_formulas[]; // ends with a row whose name is NULL

/* Central film by the function fit of Moes (1992), from the four asymptotes rigid or elastic,
 * isoviscous or piezoviscous. More precisely, it is the film where the pressure gradient is zero,
 * which in the rigid isoviscous limit is at the exit. */
double film_moes(double moes_M, double moes_L);

/* Central film of an elliptical contact by the function fit of Nijenbanning, Venner and Moes
 * (1994), from the four asymptotes, with M and L of R_x: their film in Moes units, (h/R_x)/sqrt(2 U).
 * Made for R_y >= R_x. */
double film_nijenbanning_ellipse(double moes_M, double moes_L, double radius_ratio);

/* That of the circular contact, divided by (3 M/2)^(2/3), which gives H. */
double film_nijenbanning(double moes_M, double moes_L);

/* H at the centre by the fits of Moes (lines) and of Nijenbanning, Venner and Moes. */
double film_central(const ehd_contact *contact);

/* The numbers of a contact as it is now. Its film depends on M and alpha p_H alone, and so do most
 * formulas (optimum similarity); those of Pan and Hamrock, of Hamrock and Dowson and of Chittenden
 * et al. also depend on E', by 1 % or less for 20 % of E'. E' is known in a physical scene only;
 * else that of steel on steel is assumed. */
film_numbers film_numbers_of(const ehd_contact *contact);

#endif
