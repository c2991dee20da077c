/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes published film formulas for stationary contacts, as H = h R/a^2 (README.md, Film
 * formulas).
 * Called by contact.c for cold starts, by grid_choice.c, and by fullrun/formulas.c. */
#ifndef EHD_FILM_FORMULAS_H
#define EHD_FILM_FORMULAS_H

#include "common/physics/contact.h"
#include <stdbool.h>

/* Dimensionless numbers that occur in film formulas. */
typedef struct film_numbers {
    double moes_M, moes_L;
    double speed;      // U = eta0 u_m/(E'R)
    double material;   // G = alpha E', 0: isoviscous
    double load;       // W = w/(E'R), for a point contact w/(E'R^2)
    double half_width; // a/R. For an ellipse, R in this and the other numbers is the radius along
                       // the entrainment
    // numbers of an ellipse, all 1 for a circle: R_y/R_x, b/a of the dry contact, and the ratio of
    // a to the radius of the circular contact with the same load, R_x and E'
    double radius_ratio, ellipticity, width_ratio;
} film_numbers;

typedef struct film_formula film_formula;

/* Side leakage of a contact. The leakage multiplies the film by 1 - share exp(-rate x), where x is
 * (R_y/R_x)^power, or b/a if `power` is 0. */
typedef struct film_leakage {
    double share, rate, power;
} film_leakage;

/* One formula. A power law is h/R = factor U^a G^b W^c, multiplied by the effect of the side
 * leakage. */
struct film_formula {
    const char *name;
    const char *source; // authors, publication and year
    int dimensions;     // dimensions of the contact: 1 for a line, 2 for a point
    bool of_minimum;    // true: formula of the minimum film; false: of the central film
    double factor, speed_power, material_power, load_power;
    double (*film)(const film_formula *self, const film_numbers *numbers); // H
    film_leakage leakage;
    double min_ellipticity, max_ellipticity; // range of b/a for which the formula was made
};

extern const film_formula film_formulas[]; // ends with a row whose name is NULL

/* Returns H at the centre by the function fit of Moes (1992), which joins four asymptotes: rigid or
 * elastic, each isoviscous or piezoviscous. Strictly speaking, the fit gives the film where the
 * pressure gradient is zero. In the rigid isoviscous limit this place is the exit. */
double film_moes(double moes_M, double moes_L);

/* Returns the central film of an elliptical contact by the function fit of Nijenbanning, Venner and
 * Moes (1994), from the four asymptotes. The film is in Moes units, (h/R_x)/sqrt(2 U), with M and L
 * computed with R_x. The fit was made for R_y >= R_x. */
double film_nijenbanning_ellipse(double moes_M, double moes_L, double radius_ratio);

/* Returns H of the circular contact: film_nijenbanning_ellipse divided by (3 M/2)^(2/3). */
double film_nijenbanning(double moes_M, double moes_L);

/* Returns H at the centre. For lines it is the result of film_moes. For other contacts it is the
 * result of film_nijenbanning_ellipse, converted from Moes units. */
double film_central(const ehd_contact *contact);

/* Returns the numbers for the film formulas, from the present state of a contact. Most formulas
 * depend only on M and alpha p_H, as the film itself does (optimum similarity). The formulas of Pan
 * and Hamrock, of Hamrock and Dowson and of Chittenden et al. also depend on E', by 1 % or less if
 * E' changes by 20 %. Only a physical scene has E'; otherwise steel on steel is assumed. */
film_numbers film_numbers_of(const ehd_contact *contact);

#endif
