/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of all variables of FMUs, and the variables that one FMU has, with their start
 * values. */
#ifndef EHD_FMU_VARIABLES_H
#define EHD_FMU_VARIABLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Value references. Importers store these numbers, so they never change. New numbers are added at
 * the end. */
enum {
    FMU_TIME,
    // conditions at the end of a step
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
    // parameters, fixed before the start
    FMU_MODULUS,
    FMU_VISCOSITY,
    FMU_PRESSURE_VISCOSITY,
    FMU_ACCURACY,
    FMU_STEP_ACCURACY,
    // outcomes of a stationary contact with the present inputs, computed when they are read
    FMU_STIFFNESS,
    FMU_DAMPING,
    FMU_DAMPING_BOUND,
    // traction at the end of the last step, computed when it is read
    FMU_FRICTION,
    FMU_FRICTION_COEFFICIENT,
    FMU_POWER,
    FMU_ROLLING,
    FMU_ROLLING_MOMENT,
    FMU_MEAN_STRESS,
    FMU_LARGEST_STRESS,
    // computed like FMU_STIFFNESS
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
    const char *unit, *unit_of_point; // units for line and point contacts; NULL: no unit
    fmu_when when;                    // which FMUs have the variable
    const char *key;                  // setting that gives the start value; NULL: no such setting
    size_t offset;                    // offset of an output in ehdrom_result; 0: not in this struct
    size_t derivative;                // offset of the output's derivative in ehdrom_derivatives; 0:
                                      // there is no such derivative
    const char *help;
} fmu_variable;

extern const fmu_variable fmu_variables[FMU_NUM_VARIABLES];

/* Content of the file resources/contact.txt: the variables of an FMU and their start values. */
enum { FMU_TOKEN = 40 };
typedef struct fmu_contents {
    char token[FMU_TOKEN]; // text that distinguishes this FMU from all others
    bool point;            // true: a point contact or an ellipse
    bool ellipse;
    bool approach_given; // false: the load is given
    bool slides;         // true: the scene has slide_roll or both speeds
    double ratio;        // slide_roll of the scene if the sliding thins the film, otherwise NaN
    bool heated;         // true: the scene has the lubricant's thermal_conductivity
    bool has[FMU_NUM_VARIABLES];
    double start[FMU_NUM_VARIABLES]; // start values of inputs and parameters
} fmu_contents;

/* Checks whether an FMU with these contents can have the variable. A variable with a key also needs
 * this setting in the scene, which the caller checks. */
bool fmu_variable_fits(const fmu_variable *variable, const fmu_contents *contents);

/* Returns the name of the kind of contact in scenes. */
const char *fmu_contact(const fmu_contents *contents);

void fmu_contents_write(FILE *file, const fmu_contents *contents);
/* Reads resources/contact.txt to its end. Returns false if the content is not valid. */
bool fmu_contents_read(fmu_contents *contents, FILE *file);

#endif
