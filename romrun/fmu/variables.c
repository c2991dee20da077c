/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/fmu/variables.h"

#include "romrun/library/ehdrom.h"

#include <locale.h>
#include <string.h>

#define OF(member)   offsetof(ehdrom_result, member), 0
#define BOTH(member) offsetof(ehdrom_result, member), offsetof(ehdrom_derivatives, member)
#define NONE         0, 0

// clang-format off
// columns: name, role, type, unit, unit of a point contact, when, key, offset and derivative, help
const fmu_variable fmu_variables[FMU_NUM_VARIABLES] = {
    [FMU_TIME] = {"time", FMU_INDEPENDENT, FMU_REAL, "s", "s", FMU_ALWAYS, NULL, NONE, "Time"},
    [FMU_LOAD] = {"load", FMU_INPUT, FMU_REAL, "N/m", "N", FMU_LOAD_GIVEN, "physical.load", NONE,
        "Load, of a line contact per length"},
    [FMU_APPROACH] = {"approach", FMU_INPUT, FMU_REAL, "m", "m", FMU_APPROACH_GIVEN, NULL, NONE,
        "How far the bodies are from touching undeformed, negative where they overlap; of a line contact as measured from "
        "10 half widths of the start values' contact, or from approach_length of them where the scene sets it"},
    [FMU_SPEED_1] = {"surface_speed_1", FMU_INPUT, FMU_REAL, "m/s", "m/s", FMU_ALWAYS, "physical.speed", NONE,
        "Speed of the first surface relative to the contact; films go by the mean of both"},
    [FMU_SPEED_2] = {"surface_speed_2", FMU_INPUT, FMU_REAL, "m/s", "m/s", FMU_ALWAYS, "physical.speed", NONE,
        "Speed of the second surface relative to the contact; the mean must not be negative"},
    [FMU_RADIUS] = {"radius", FMU_INPUT, FMU_REAL, "m", "m", FMU_ALWAYS, "physical.radius", NONE,
        "Reduced radius, 1/R = 1/R1 + 1/R2"},
    [FMU_FORCE] = {"force", FMU_OUTPUT, FMU_REAL, "N/m", "N", FMU_ALWAYS, NULL, BOTH(load),
        "Normal force between the bodies, of a line contact per length"},
    [FMU_APPROACH_FOUND] = {"approach", FMU_OUTPUT, FMU_REAL, "m", "m", FMU_LOAD_GIVEN, NULL, BOTH(approach),
        "How far the bodies are from touching undeformed, negative where they overlap; of a line contact as measured from "
        "10 half widths of the start values' contact, or from approach_length of them where the scene sets it"},
    [FMU_CENTRAL_FILM] = {"central_film_thickness", FMU_OUTPUT, FMU_REAL, "m", "m", FMU_ALWAYS, NULL,
        BOTH(central_film_thickness), "Film thickness at the centre"},
    [FMU_MINIMUM_FILM] = {"minimum_film_thickness", FMU_OUTPUT, FMU_REAL, "m", "m", FMU_ALWAYS, NULL,
        BOTH(minimum_film_thickness), "Smallest film thickness"},
    [FMU_CENTRAL_PRESSURE] = {"central_pressure", FMU_OUTPUT, FMU_REAL, "Pa", "Pa", FMU_ALWAYS, NULL,
        BOTH(central_pressure), "Pressure at the centre"},
    [FMU_PEAK_PRESSURE] = {"peak_pressure", FMU_OUTPUT, FMU_REAL, "Pa", "Pa", FMU_ALWAYS, NULL,
        BOTH(peak_pressure), "Largest pressure, at the nodes that the reduced solution looks at"},
    [FMU_EXIT] = {"exit_position", FMU_OUTPUT, FMU_REAL, "m", "m", FMU_ALWAYS, NULL, BOTH(exit_position),
        "How far behind the centre the pressure ends"},
    [FMU_HALF_WIDTH] = {"half_width", FMU_OUTPUT, FMU_REAL, "m", "m", FMU_ALWAYS, NULL, BOTH(half_width),
        "Half width, or radius, of the dry contact"},
    [FMU_DEVIATION] = {"indicated_deviation", FMU_OUTPUT, FMU_REAL, "1", "1", FMU_ALWAYS, NULL,
        OF(indicated_deviation), "How far the central film is indicated to be from that of the full model, "
        "relative; not a number if the model was not checked for that"},
    [FMU_DEVIATION_MINIMUM] = {"indicated_deviation_minimum", FMU_OUTPUT, FMU_REAL, "1", "1", FMU_ALWAYS, NULL,
        OF(indicated_deviation_minimum), "The same of the minimum film"},
    [FMU_LOCAL_ERROR] = {"local_error", FMU_OUTPUT, FMU_REAL, "1", "1", FMU_ALWAYS, NULL, OF(local_error),
        "What the last internal step's length does to the central film, relative; 0 while not known"},
    [FMU_TRUSTED] = {"trusted", FMU_OUTPUT, FMU_BOOLEAN, NULL, NULL, FMU_ALWAYS, NULL, OF(trusted),
        "False: outside of the trained range, indicated to deviate by more than accuracy, or not checked"},
    [FMU_ITERATIONS] = {"iterations", FMU_OUTPUT, FMU_INTEGER, NULL, NULL, FMU_ALWAYS, NULL, OF(iterations),
        "Iterations of the last internal step"},
    [FMU_STEPS] = {"internal_steps", FMU_OUTPUT, FMU_INTEGER, NULL, NULL, FMU_ALWAYS, NULL, NONE,
        "Internal steps of the last communication step: 1, unless that was too long"},
    [FMU_MODULUS] = {"modulus", FMU_PARAMETER, FMU_REAL, "Pa", "Pa", FMU_ALWAYS, "physical.modulus", NONE,
        "Reduced modulus, 2/E' = (1 - nu1^2)/E1 + (1 - nu2^2)/E2"},
    [FMU_VISCOSITY] = {"viscosity", FMU_PARAMETER, FMU_REAL, "Pa.s", "Pa.s", FMU_ALWAYS, "physical.viscosity", NONE,
        "Viscosity at ambient pressure"},
    [FMU_PRESSURE_VISCOSITY] = {"pressure_viscosity_coefficient", FMU_PARAMETER, FMU_REAL, "1/Pa", "1/Pa",
        FMU_ALWAYS, "lubricant.viscosity.alpha", NONE, "Pressure-viscosity coefficient"},
    [FMU_ACCURACY] = {"accuracy", FMU_PARAMETER, FMU_REAL, "1", "1", FMU_ALWAYS, NULL, NONE,
        "An indicated deviation above it is not trusted"},
    [FMU_STEP_ACCURACY] = {"step_accuracy", FMU_PARAMETER, FMU_REAL, "1", "1", FMU_ALWAYS, NULL, NONE,
        "A step with a larger local_error is halved, down to the solver's noise; 0: as long as the importer wants it. FMI's tolerance sets it"},
    [FMU_STIFFNESS] = {"stationary_stiffness", FMU_OUTPUT, FMU_REAL, "N/m2", "N/m", FMU_ALWAYS, NULL, NONE,
        "By how much the force of a stationary contact of these inputs rises as the bodies come nearer"},
    [FMU_DAMPING] = {"stationary_damping", FMU_OUTPUT, FMU_REAL, "N.s/m2", "N.s/m", FMU_ALWAYS, NULL, NONE,
        "By how much more per speed at which they come nearer, slowly"},
    [FMU_DAMPING_BOUND] = {"stationary_damping_bound", FMU_OUTPUT, FMU_REAL, "N.s/m2", "N.s/m", FMU_ALWAYS, NULL, NONE,
        "What the model lacks of the damping, up to a factor of 2 to 8; models trained in time lack little"},
    [FMU_FRICTION] = {"friction_force", FMU_OUTPUT, FMU_REAL, "N/m", "N", FMU_SLIDING, NULL, NONE,
        "Friction by the sliding surface_speed_1 - surface_speed_2, against surface 1 where that is the faster one"},
    [FMU_FRICTION_COEFFICIENT] = {"friction_coefficient", FMU_OUTPUT, FMU_REAL, "1", "1", FMU_SLIDING, NULL, NONE,
        "Friction over the force"},
    [FMU_POWER] = {"power_loss", FMU_OUTPUT, FMU_REAL, "W/m", "W", FMU_SLIDING, NULL, NONE,
        "Power that both surfaces put into the film, by sliding and rolling resistance"},
    [FMU_ROLLING] = {"rolling_resistance", FMU_OUTPUT, FMU_REAL, "N/m", "N", FMU_SLIDING, NULL, NONE,
        "What brakes both surfaces, each by this much, also without sliding"},
    [FMU_ROLLING_MOMENT] = {"rolling_moment", FMU_OUTPUT, FMU_REAL, "N", "N.m", FMU_SLIDING, NULL, NONE,
        "Moment of the pressures about the centre, against the rolling"},
    [FMU_MEAN_STRESS] = {"mean_shear_stress", FMU_OUTPUT, FMU_REAL, "Pa", "Pa", FMU_SLIDING, NULL, NONE,
        "Magnitude of the shear stress of the sliding, mean over the dry contact"},
    [FMU_LARGEST_STRESS] = {"largest_shear_stress", FMU_OUTPUT, FMU_REAL, "Pa", "Pa", FMU_SLIDING, NULL, NONE,
        "The largest of it, at the nodes that the reduced solution looks at"},
    [FMU_INLET_HEATING] = {"stationary_inlet_heating_factor", FMU_OUTPUT, FMU_REAL, "1", "1", FMU_HEATED, NULL, NONE,
        "By which shear heating of the inlet thins the films of a stationary contact of these inputs, which are "
        "isothermal here; not a number where that is not known"},
};
// clang-format on

bool fmu_variable_fits(const fmu_variable *variable, const fmu_contents *contents) {
    if (variable->when == FMU_SLIDING) return contents->slides;
    if (variable->when == FMU_HEATED) return contents->heated;
    return variable->when == FMU_ALWAYS ||
           (variable->when == FMU_APPROACH_GIVEN) == contents->approach_given;
}

// ---- resources/contact.txt: one line for each name and its value

static const char heading[] = "ehdrom-fmu 3";

const char *fmu_contact(const fmu_contents *contents) {
    return contents->ellipse ? "ellipse" : contents->point ? "point" : "line";
}

static bool has_start(const fmu_variable *variable) {
    return variable->role == FMU_INPUT || variable->role == FMU_PARAMETER;
}

void fmu_contents_write(FILE *file, const fmu_contents *contents) {
    fprintf(file, "%s\ntoken %s\ncontact %s\ngiven %s\nslides %s\nthinned %.17g\nheated %s\n",
            heading, contents->token, fmu_contact(contents),
            contents->approach_given ? "approach" : "load", contents->slides ? "yes" : "no",
            contents->ratio, contents->heated ? "yes" : "no");
    for (size_t i = 0; i < FMU_NUM_VARIABLES; i++)
        if (contents->has[i] && has_start(&fmu_variables[i]))
            fprintf(file, "%s %.17g\n", fmu_variables[i].name, contents->start[i]);
}

static bool read_heading(fmu_contents *contents, FILE *file) {
    char line[sizeof heading + 1], contact[8], given[16], slides[4], heated[4];

    if (!fgets(line, sizeof line, file) || strncmp(line, heading, sizeof heading - 1) != 0)
        return false;
    if (fscanf(file, " token %39s contact %7s given %15s slides %3s thinned %lf heated %3s",
               contents->token, contact, given, slides, &contents->ratio, heated) != 6)
        return false;
    contents->ellipse = strcmp(contact, "ellipse") == 0;
    contents->point = contents->ellipse || strcmp(contact, "point") == 0;
    contents->approach_given = strcmp(given, "approach") == 0;
    contents->slides = strcmp(slides, "yes") == 0;
    contents->heated = strcmp(heated, "yes") == 0;
    return (contents->point || strcmp(contact, "line") == 0) &&
           (contents->approach_given || strcmp(given, "load") == 0) &&
           (contents->slides || strcmp(slides, "no") == 0) &&
           (contents->heated || strcmp(heated, "no") == 0);
}

static bool take_start(fmu_contents *contents, const char *name, double value) {
    for (size_t i = 0; i < FMU_NUM_VARIABLES; i++) {
        const fmu_variable *variable = &fmu_variables[i];
        if (!has_start(variable) || !fmu_variable_fits(variable, contents) ||
            strcmp(variable->name, name) != 0)
            continue;
        contents->has[i] = true;
        contents->start[i] = value;
        return true;
    }
    return false;
}

static bool read_contents(fmu_contents *contents, FILE *file) {
    char name[64];
    double value = 0;
    int found = 0;

    if (!read_heading(contents, file)) return false;
    for (size_t i = 0; i < FMU_NUM_VARIABLES; i++)
        contents->has[i] =
            !has_start(&fmu_variables[i]) && fmu_variable_fits(&fmu_variables[i], contents);
    while ((found = fscanf(file, " %63s %lf", name, &value)) == 2)
        if (!take_start(contents, name, value)) return false;
    return found == EOF && !ferror(file);
}

bool fmu_contents_read(fmu_contents *contents, FILE *file) {
    // numbers have a decimal point, whatever the importer's locale is
    const locale_t before = uselocale(newlocale(LC_ALL_MASK, "C", (locale_t)0));

    *contents = (fmu_contents){0};
    const bool read = read_contents(contents, file);
    uselocale(before);
    return read;
}
