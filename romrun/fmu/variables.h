/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The variables of an FMU, a row each; and which of them one FMU has, with their start values. */
#ifndef EHD_FMU_VARIABLES_H
#define EHD_FMU_VARIABLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Value references, which importers keep: they do not change, and new ones come at the end. */
enum {
    FMU_TIME,
    // what holds at the end of a step
    FMU_LOAD,
    FMU_APPROACH,
    FMU_SPEED_1,
    FMU_SPEED_2,
    FMU_RADIUS,
    // outcomes
    FMU_FORCE,
    FMU_APPROACH_FOUND,
    FMU_CENTRAL_FILM,
    FMU_MINIMUM_FILM,
    FMU_CENTRAL_PRESSURE,
    FMU_PEAK_PRESSURE,
    FMU_EXIT,
    FMU_HALF_WIDTH,
    FMU_DEVIATION,
    FMU_DEVIATION_MINIMUM,
    FMU_LOCAL_ERROR,
    FMU_TRUSTED,
    FMU_ITERATIONS,
    FMU_STEPS,
    // fixed before the start
    FMU_MODULUS,
    FMU_VISCOSITY,
    FMU_PRESSURE_VISCOSITY,
    FMU_ACCURACY,
    FMU_STEP_ACCURACY,
    // outcomes of a stationary contact of the present inputs, made when they are asked for
    FMU_STIFFNESS,
    FMU_DAMPING,
    FMU_DAMPING_BOUND,
    // of the last step's end, made when they are asked for
    FMU_FRICTION,
    FMU_FRICTION_COEFFICIENT,
    FMU_POWER,
    FMU_ROLLING,
    FMU_ROLLING_MOMENT,
    FMU_MEAN_STRESS,
    FMU_LARGEST_STRESS,
    // beside FMU_STIFFNESS
    FMU_INLET_HEATING,
    FMU_NUM_VARIABLES
};

typedef enum fmu_type { FMU_REAL, FMU_INTEGER, FMU_BOOLEAN } fmu_type;
typedef enum fmu_role { FMU_INDEPENDENT, FMU_INPUT, FMU_OUTPUT, FMU_PARAMETER } fmu_role;
typedef enum fmu_when {
    FMU_ALWAYS,
    FMU_LOAD_GIVEN,
    FMU_APPROACH_GIVEN,
    FMU_SLIDING,
    FMU_HEATED
} fmu_when;

typedef struct fmu_variable {
    const char *name;
    fmu_role role;
    fmu_type type;
    const char *unit, *unit_of_point; // of a line and of a point contact; NULL: none
    fmu_when when;                    // in which FMUs it is
    const char *key;                  // of the setting that it starts from; NULL: none
    size_t offset;                    // of an output in ehdrom_result; 0: of none
    size_t derivative;                // of it in ehdrom_derivatives; 0: it has none there
    const char *help;
} fmu_variable;

extern const fmu_variable fmu_variables[FMU_NUM_VARIABLES];

/* Which variables an FMU has: the file resources/contact.txt. */
enum { FMU_TOKEN = 40 };
typedef struct fmu_contents {
    char token[FMU_TOKEN]; // that tells this FMU from others
    bool point;            // a point contact or an ellipse
    bool ellipse;
    bool approach_given; // else the load
    bool slides;         // the scene names slide_roll or both speeds
    double ratio;        // slide_roll of a film that it thins; NaN: films do not go by it
    bool heated;         // the scene names the lubricant's thermal_conductivity
    bool has[FMU_NUM_VARIABLES];
    double start[FMU_NUM_VARIABLES]; // of inputs and parameters
} fmu_contents;

/* Whether a row's variable may be in an FMU of that kind; those with a key only if that is set. */
bool fmu_variable_fits(const fmu_variable *variable, const fmu_contents *contents);

/* The contact's name in scenes. */
const char *fmu_contact(const fmu_contents *contents);

void fmu_contents_write(FILE *file, const fmu_contents *contents);
/* False where it is not such a file; `file` is read to its end. */
bool fmu_contents_read(fmu_contents *contents, FILE *file);

#endif
