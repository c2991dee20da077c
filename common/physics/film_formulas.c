/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/physics/film_formulas.h"

#include <math.h>
#include <stddef.h>

// Assumption for a contact without a modulus: both bodies are of steel, with E = 206 GPa and nu =
// 0.3. The constant is their reduced modulus E', Pa. If E' is in fact 180 GPa, the formulas' films
// change by at most 1.2 % (test_film_formulas.c, the_modulus_hardly_matters).
static const double STEEL_MODULUS = 226e9;

double film_moes(double moes_M, double moes_L) {
    double rigid_iso = 3 / moes_M;
    double elastic_iso = 2.621 * pow(moes_M, -0.2);
    double rigid_piezo = 1.287 * pow(moes_L, 2. / 3);
    double elastic_piezo = 1.311 * pow(moes_M, -0.125) * pow(moes_L, 0.75);
    double s = (7 + 8 * exp(-2 * elastic_iso / rigid_iso)) / 5;
    double iso = pow(pow(rigid_iso, 7. / 3) + pow(elastic_iso, 7. / 3), 3. / 7);
    double piezo = 0;

    if (moes_L > 0) piezo = pow(pow(rigid_piezo, -3.5) + pow(elastic_piezo, -3.5), -2. / 7);
    return M_PI / (8 * moes_M) * pow(pow(iso, s) + pow(piezo, s), 1 / s);
}

double film_nijenbanning_ellipse(double moes_M, double moes_L, double radius_ratio) {
    // written so that the formula for a circle (ratio = 1) contains exactly the numbers 1.796, 1.63
    // and 1.691
    const double ratio = 1 / radius_ratio; // lambda of the fit
    const double elastic = 1.63 + 0.63 * (pow(ratio, 4. / 7) - 1) + 0.006 * log(ratio);
    const double rigid_iso =
        145 * pow(1.796 + 0.796 * (pow(ratio, 14. / 15) - 1), -15. / 7) / (moes_M * moes_M) / ratio;
    const double elastic_iso =
        3.18 * pow(elastic, -14. / 25) * pow(moes_M, -2. / 15) * pow(ratio, -1. / 15);
    const double rigid_piezo =
        1.29 * pow(1.691 + 0.691 * (ratio - 1), -2. / 3) * pow(moes_L, 2. / 3);
    const double elastic_piezo = 1.48 * pow(elastic, -7. / 20) * pow(moes_M, -1. / 12) *
                                 pow(moes_L, 0.75) * pow(ratio, -1. / 24);
    const double zero_load = 1.8 / ratio;
    double iso = pow(rigid_iso, 1.5) + pow(pow(elastic_iso, -4) + pow(zero_load, -4), -3. / 8);
    double s = 1.5, piezo = 0;

    if (moes_L > 0) {
        s = 1.5 * (1 + exp(-1.2 * elastic_iso / elastic_piezo));
        piezo = pow(pow(rigid_piezo, -8) + pow(elastic_piezo, -8), -s / 8);
    }
    return pow(pow(iso, 2 * s / 3) + piezo, 1 / s);
}

double film_nijenbanning(double moes_M, double moes_L) {
    return film_nijenbanning_ellipse(moes_M, moes_L, 1) / pow(1.5 * moes_M, 2. / 3);
}

static double nijenbanning(const film_formula *self, const film_numbers *numbers) {
    const double width = numbers->width_ratio;

    (void)self;
    return film_nijenbanning_ellipse(numbers->moes_M, numbers->moes_L, numbers->radius_ratio) /
           (pow(1.5 * numbers->moes_M, 2. / 3) * width * width);
}

static double moes(const film_formula *self, const film_numbers *numbers) {
    (void)self;
    return film_moes(numbers->moes_M, numbers->moes_L);
}

/* Returns the factor by which side leakage reduces a film. */
static double left_of_leakage(const film_leakage *leakage, const film_numbers *numbers) {
    const double x =
        leakage->power > 0 ? pow(numbers->radius_ratio, leakage->power) : numbers->ellipticity;

    return 1 - leakage->share * exp(-leakage->rate * x);
}

/* Returns H = h R/a^2 = (h/R) (R/a)^2. */
static double power_law(const film_formula *self, const film_numbers *numbers) {
    if (!(numbers->material > 0)) return 0; // power laws are for piezoviscous lubricants
    return self->factor * left_of_leakage(&self->leakage, numbers) *
           pow(numbers->speed, self->speed_power) * pow(numbers->material, self->material_power) *
           pow(numbers->load, self->load_power) / (numbers->half_width * numbers->half_width);
}

// Sources of the constants for point contacts: README.md, film formulas.
// clang-format off
#define NO_SIDES {0, 0, 0}, 0, INFINITY

const film_formula film_formulas[] = {
    // columns: name, source, dimensions, of the minimum, factor, powers of U, G, W, function, leakage, b/a from, to
    {"ertel-grubin", "Grubin, Central Research Institute TsNIITMASH, book 30, Moscow 1949, after Ertel", 1, false,
     1.95, 8. / 11, 8. / 11, -1. / 11, power_law, NO_SIDES},
    {"dowson-toyoda", "Dowson and Toyoda, 5th Leeds-Lyon Symposium on Tribology, 1979", 1, false,
     3.06, 0.69, 0.56, -0.10, power_law, NO_SIDES},
    {"pan-hamrock-central", "Pan and Hamrock, J. Tribology 111, 1989", 1, false,
     2.922, 0.692, 0.470, -0.166, power_law, NO_SIDES},
    {"moes", "Moes, Wear 159, 1992", 1, false, 0, 0, 0, 0, moes, NO_SIDES},
    {"dowson-higginson", "Dowson and Higginson, exponents of Dowson, Proc. IMechE 182 (3A), 1968", 1, true,
     2.65, 0.70, 0.54, -0.13, power_law, NO_SIDES},
    {"pan-hamrock-minimum", "Pan and Hamrock, J. Tribology 111, 1989", 1, true,
     1.714, 0.694, 0.568, -0.128, power_law, NO_SIDES},
    {"nijenbanning", "Nijenbanning, Venner and Moes, Wear 176, 1994", 2, false,
     0, 0, 0, 0, nijenbanning, {0, 0, 0}, 1, INFINITY},
    {"hamrock-dowson-central", "Hamrock and Dowson, J. Lubrication Technology 99, 1977", 2, false,
     2.69, 0.67, 0.53, -0.067, power_law, {0.61, 0.73, 0}, 1, 8},
    {"hamrock-dowson-minimum", "Hamrock and Dowson, J. Lubrication Technology 99, 1977", 2, true,
     3.63, 0.68, 0.49, -0.073, power_law, {1, 0.68, 0}, 1, 8},
    {"chittenden-central", "Chittenden, Dowson, Dunn and Taylor, Proc. R. Soc. A 397, 1985", 2, false,
     4.31, 0.68, 0.49, -0.073, power_law, {1, 1.23, 2. / 3}, 0, INFINITY},
    {"chittenden-minimum", "Chittenden, Dowson, Dunn and Taylor, Proc. R. Soc. A 397, 1985", 2, true,
     3.68, 0.68, 0.49, -0.073, power_law, {1, 0.67, 2. / 3}, 0, INFINITY},
    {NULL, NULL, 0, false, 0, 0, 0, 0, NULL, NO_SIDES}};
// clang-format on

film_numbers film_numbers_of(const ehd_contact *contact) {
    const contact_kind *kind = contact->kind;
    const contact_shape *shape = &contact->grid.shape;
    const double width = contact->half_width;
    // the load is proportional to this power of the half width
    const int power = kind->dimensions + 1;
    const double modulus =
        isnan(width)
            ? STEEL_MODULUS
            : pow(kind->half_width(shape, contact->load, contact->radius, 1) / width, power);
    const double ratio = contact->hertz_pressure / modulus;
    film_numbers numbers = {.moes_M = contact->moes_M,
                            .radius_ratio = ellipse_radius_ratio(shape->ellipticity),
                            .ellipticity = shape->ellipticity,
                            .width_ratio = cbrt(shape->compliance)};

    numbers.moes_L = contact_moes_L(contact);
    if (!(contact->alpha_p_H > 0)) return numbers;
    // p_H = w/(a^dimensions b/a kind->load), and L = G (2 U)^(1/4)
    numbers.load = pow(ratio * shape->ellipticity * kind->load *
                           pow(kind->half_width(shape, 1, 1, 1), power - 1),
                       power);
    numbers.half_width = kind->half_width(shape, numbers.load, 1, 1);
    numbers.material = contact->alpha_p_H / ratio;
    numbers.speed = pow(numbers.moes_L / numbers.material, 4) / 2;
    return numbers;
}

double film_central(const ehd_contact *contact) {
    const film_numbers numbers = film_numbers_of(contact);

    return (contact->kind->dimensions > 1 ? nijenbanning : moes)(NULL, &numbers);
}
