/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fullrun/formulas.h"

#include "common/output/grid_file.h"
#include "common/output/time_result.h"
#include "common/physics/film_formulas.h"
#include "common/physics/traction_formula.h"
#include "common/program/program.h"
#include "common/time/frame.h"
#include "common/time/history.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double seconds_of(const film_formula *formula, const film_numbers *numbers) {
    enum { TIMES = 2000 };
    const double before = program_seconds();
    volatile double film; // volatile, so that the compiler does not remove the loop

    for (int i = 0; i < TIMES; i++)
        film = formula->film(formula, numbers);
    (void)film;
    return (program_seconds() - before) / TIMES;
}

static void print_head(const film_formula *formula) {
    printf("formula %-20s %-8s", formula->name, formula->of_minimum ? "minimum" : "central");
}

/* Prints the range of b/a for which a formula was made, if this range is known. Also prints whether
 * the contact lies outside of the range. */
static void print_range(const film_formula *formula, double ellipticity) {
    const double min = formula->min_ellipticity, max = formula->max_ellipticity;

    if (min > 0) printf("; b/a from %g", min);
    if (min > 0 && isfinite(max)) printf(" to %g", max);
    if (!(min <= ellipticity && ellipticity <= max)) printf(", here outside: %.3g", ellipticity);
}

static void print_tail(const film_formula *formula, const film_numbers *numbers) {
    printf("  %4.0f ns  %s", seconds_of(formula, numbers) * 1e9, formula->source);
    print_range(formula, numbers->ellipticity);
    putchar('\n');
}

void formulas_print(const contact_scalars *solution, const ehd_contact *contact) {
    const film_numbers numbers = film_numbers_of(contact);

    for (const film_formula *formula = film_formulas; formula->name; formula++) {
        if (formula->dimensions != contact->kind->dimensions) continue;
        double film = formula->film(formula, &numbers);
        double of_solution = formula->of_minimum ? solution->minimum_film_thickness
                                                 : solution->central_film_thickness;
        print_head(formula);
        printf("  %-11.6g %+8.3f %%", film, 100 * (film / of_solution - 1));
        print_tail(formula, &numbers);
    }
}

/* Prints friction coefficients for some slide-roll ratios, with the film of the film formula. */
static void print_curve(const ehd_contact *contact) {
    static const double curve[] = {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1};
    const double film = film_central(contact);

    printf("slide-roll: friction");
    for (size_t i = 0; i < sizeof curve / sizeof *curve; i++)
        printf("%s %g: %.4g", i ? "," : "", curve[i],
               traction_at_mean_pressure(contact, film, curve[i]).coefficient);
    putchar('\n');
}

static void print_traction_head(void) {
    printf("traction %-20s %-8s", "evans-johnson", "friction");
}

void formulas_print_traction(const contact_traction *solution, const ehd_contact *contact) {
    const double film = film_central(contact);
    const traction_estimate own = traction_at_mean_pressure(contact, film, contact->slide_roll);
    const bool within = own.excess >= TRACTION_MIN_EXCESS;

    if (isnan(own.coefficient)) return;
    print_traction_head();
    printf("  %-11.6g", own.coefficient);
    // in pure rolling both coefficients are 0
    if (solution->coefficient != 0)
        printf(" %+8.3f %%", 100 * (own.coefficient / solution->coefficient - 1));
    printf("  %s; viscous stress from %g Eyring stresses on, %s: %.3g\n", traction_formula_source,
           TRACTION_MIN_EXCESS, within ? "here" : "here outside", own.excess);
    printf("traction ");
    print_curve(contact);
}

// ---- transient results

/* A deviation, and the duration for which it holds. The duration is the weight in quantiles. */
typedef struct weighted {
    double deviation, weight;
} weighted;

static int compare_deviations(const void *left, const void *right) {
    double a = ((const weighted *)left)->deviation, b = ((const weighted *)right)->deviation;

    return (a > b) - (a < b);
}

/* Returns the deviation that is not exceeded during the fraction `quantile` of the time. `values`
 * are in ascending order. */
static double quantile_in_time(const weighted *values, size_t count, double quantile) {
    double total = 0, sum = 0;
    size_t i = 0;

    for (size_t k = 0; k < count; k++)
        total += values[k].weight;
    while (i + 1 < count && (sum += values[i].weight) < quantile * total)
        i++;
    return values[i].deviation;
}

/* Returns the duration that a stored time stands for: half of the interval before it and half of
 * the interval after it. */
static double duration_of(const time_series *series, size_t i) {
    const size_t last = series->num_times - 1;

    return (series->time[i < last ? i + 1 : i] - series->time[i > 0 ? i - 1 : 0]) / 2;
}

static void print_deviations(weighted *deviations, size_t count) {
    qsort(deviations, count, sizeof *deviations, compare_deviations);
    printf("  worst %.3f %%, 95 %% %.3f %%, median %.3f %%", 100 * deviations[count - 1].deviation,
           100 * quantile_in_time(deviations, count, 0.95),
           100 * quantile_in_time(deviations, count, 0.5));
}

/* Returns the contact at a stored time. The contact is taken as stationary. *film_scale is the film
 * scale of its frame. The load comes from the result, because the scene may give the approach
 * instead of the load. */
static ehd_contact contact_at(double *film_scale, const time_series *series, size_t i,
                              const ehd_histories *histories, const ehd_contact *reference) {
    double values[NUM_VARY];
    ehd_contact contact;

    histories_at(values, histories, series->time[i]);
    values[VARY_LOAD] = series->load[i];
    const contact_frame frame = frame_at(reference->kind, series->time[i], values, NAN);
    frame_contact(&contact, &frame, reference);
    *film_scale = frame.film_scale;
    return contact;
}

/* Returns the index of the first stored time at which the bodies are in contact, or num_times if
 * the bodies never touch. */
static size_t first_contact(const time_series *series) {
    size_t first = 0;

    while (first < series->num_times && series->load[first] == 0)
        first++;
    return first;
}

static void print_formula_in_time(weighted *deviations, const film_formula *formula,
                                  const time_series *series, const ehd_histories *histories,
                                  const ehd_contact *reference) {
    double scale;
    ehd_contact contact;
    size_t count = 0;

    for (size_t i = 0; i < series->num_times; i++) {
        if (series->load[i] == 0) continue; // bodies apart
        contact = contact_at(&scale, series, i, histories, reference);
        const film_numbers numbers = film_numbers_of(&contact);
        double film = scale * formula->film(formula, &numbers);
        double of_solution = formula->of_minimum ? series->minimum_film_thickness[i]
                                                 : series->central_film_thickness[i];
        deviations[count++] = (weighted){fabs(film / of_solution - 1), duration_of(series, i)};
    }
    print_head(formula);
    print_deviations(deviations, count);
    contact = contact_at(&scale, series, first_contact(series), histories, reference);
    const film_numbers at_start = film_numbers_of(&contact);
    print_tail(formula, &at_start);
}

/* Prints how much the friction coefficient of the traction formula deviates from a transient
 * result. The contact at each time is taken as stationary. Its film is the film of the film
 * formula. */
static void print_traction_in_time(weighted *deviations, const time_series *series,
                                   const ehd_histories *histories, const ehd_contact *reference) {
    double scale, least = INFINITY, most = 0, outside = 0, total = 0;
    const size_t first = first_contact(series);
    ehd_contact contact = contact_at(&scale, series, first, histories, reference);
    const ehd_contact at_start = contact;
    size_t count = 0;

    if (isnan(traction_at_mean_pressure(&contact, 1, contact.slide_roll).coefficient)) return;
    for (size_t i = 0; i < series->num_times; i++) {
        if (series->load[i] == 0) continue; // bodies apart
        contact = contact_at(&scale, series, i, histories, reference);
        const traction_estimate own =
            traction_at_mean_pressure(&contact, film_central(&contact), contact.slide_roll);
        const double duration = duration_of(series, i);

        least = fmin(least, own.excess);
        most = fmax(most, own.excess);
        total += duration;
        if (!(own.excess >= TRACTION_MIN_EXCESS)) outside += duration;
        // in pure rolling, and at zero entrainment, both coefficients are 0
        if (series->friction_coefficient[i] != 0)
            deviations[count++] =
                (weighted){fabs(own.coefficient / series->friction_coefficient[i] - 1), duration};
    }
    print_traction_head();
    if (count > 0)
        print_deviations(deviations, count);
    else
        printf("  0 at all times");
    printf("  %s; viscous stress from %g Eyring stresses on, here %.3g to %.3g",
           traction_formula_source, TRACTION_MIN_EXCESS, least, most);
    if (outside > 0) printf(", outside for %.3g %% of the time", 100 * outside / total);
    printf("\ntraction at T = %g, ", series->time[first]);
    print_curve(&at_start);
}

ehd_status formulas_print_in_time(const char *path, const scene *given,
                                  const ehd_contact *reference, ehd_error *error) {
    time_series series = {0};
    ehd_histories *histories = NULL;
    weighted *deviations = NULL;
    ehd_status status = time_series_read(&series, path, reference->kind, error);

    if (!status)
        status = grid_check_shape(&series.grid, path, &reference->grid, "the scene", error);
    if (!status) status = histories_init(&histories, given, error);
    if (!status) deviations = malloc((series.num_times + 1) * sizeof *deviations);
    if (!status && !deviations) status = ehd_no_memory(error, path);
    const bool touch = !status && first_contact(&series) < series.num_times;
    for (const film_formula *formula = film_formulas; formula->name && touch; formula++)
        if (formula->dimensions == reference->kind->dimensions)
            print_formula_in_time(deviations, formula, &series, histories, reference);
    if (!status && !touch) printf("formulas: the bodies are apart at all times\n");
    if (touch) print_traction_in_time(deviations, &series, histories, reference);
    free(deviations);
    histories_free(histories);
    time_series_free(&series);
    return status;
}
