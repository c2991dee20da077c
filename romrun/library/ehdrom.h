/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Elastohydrodynamic contacts in other people's programs: the reduced model of ehdrom.
 *
 *     #include <ehdrom.h>
 *
 *     ehdrom_model *model;
 *     ehdrom_contact *contact;
 *     ehdrom_result result = EHDROM_RESULT_INIT;
 *
 *     if (ehdrom_model_open(&model, "model.h5", NULL))             // once
 *         puts(ehdrom_model_error(model));
 *     ehdrom_contact_create(&contact, model);                      // once a contact
 *     ehdrom_contact_read(contact, "scene.yml");                   // or ehdrom_contact_set
 *     ehdrom_contact_set_number(contact, "physical.load", 300e3);
 *     if (ehdrom_solve(contact, &result))                          // as often as wanted
 *         puts(ehdrom_contact_error(contact));
 *     ehdrom_contact_free(contact);
 *     ehdrom_model_close(model);
 *
 * Units are SI unless others are asked for (ehdrom_contact_set_units): N/m of a line contact, N of a
 * point contact or an ellipse, m, s, m/s, Pa, Pa s.
 *
 * A model does not change once it is open; any number of contacts in any number of threads may use
 * it. A contact is used by one thread at a time. Models may be opened in several threads too, of HDF5 files
 * not while the program itself is in HDF5 or in FFTW's planner. HDF5 is loaded with the first of these, of which
 * libehdrom.so.0 needs libehdrom-hdf5.so.0 beside it, and of flat models nothing. Nothing here prints, ends
 * the process, or changes its locale, its signals or its threads.
 *
 * Functions return EHDROM_OK, or an outcome, or an error; ehdrom_model_error and
 * ehdrom_contact_error say what was found and what was expected. With an outcome the result is filled
 * in: not converged, there is no solution; untrusted, there is one, and a reason not to rely on it.
 * With an error (EHDROM_FAILED) it is as before.
 *
 * The interface grows by new functions, new settings, and members at the end of structs, whose first
 * member says how large the caller's are. */
#ifndef EHDROM_H
#define EHDROM_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define EHDROM_API __attribute__((visibility("default")))
#else
#define EHDROM_API
#endif

#define EHDROM_VERSION_MAJOR 0
#define EHDROM_VERSION_MINOR 3
#define EHDROM_VERSION_PATCH 0
#define EHDROM_VERSION       "0.3.0"

/* Version of the library that runs, "0.3.0"; EHDROM_VERSION is that of the header. */
EHDROM_API const char *ehdrom_version(void);

/* The same numbers as the exit codes of romrun. */
typedef int ehdrom_status;
enum {
    EHDROM_OK = 0,
    EHDROM_NOT_CONVERGED = 3, /* outcome: there is no solution */
    EHDROM_UNTRUSTED = 4,     /* outcome: solved, but not to be relied on */
    EHDROM_DATA = 65,         /* bad data or setting */
    EHDROM_NOINPUT = 66,      /* file missing or unreadable */
    EHDROM_INTERNAL = 70,     /* calls in an order that makes no sense, or a fault of the library */
    EHDROM_MEMORY = 71,       /* out of memory */
    EHDROM_IO = 74            /* reading failed midway */
};
#define EHDROM_FAILED(status) ((status) >= EHDROM_DATA)

/* ---- models */

typedef struct ehdrom_model ehdrom_model;

/* What of a model to load. */
typedef struct ehdrom_model_options {
    size_t size;              /* sizeof(ehdrom_model_options) */
    size_t pressure_modes;    /* the first ones; 0: all */
    size_t deformation_modes; /* 0: all */
    size_t rows;              /* 0: all */
    int stationary;           /* 1: not what steps in time need */
} ehdrom_model_options;
#define EHDROM_MODEL_OPTIONS_INIT                                                                  \
    { sizeof(ehdrom_model_options), 0, 0, 0, 0 }

/* Opens a model of HDF5, or a flat one (romrun --export), which is there in milliseconds, has the sizes
 * that it was exported with, and must not be written into while it is open; or a list of models for parts of a region, a
 * file whose name ends with .yml (schemas/models.md), whole. `options` NULL: all of it. *model is to be
 * closed in any case, and tells the error. It is NULL if there is no memory for it, or if the processor lacks instructions
 * that the library was built with (EHDROM_INTERNAL). EHDROM_DATA: no model, or
 * one of HDF5 where libehdrom-hdf5.so.0 or HDF5 is missing. Checksums are looked at,
 * which is half of what opening a flat model takes, unless the environment has EHDROM_DIGEST=no. */
EHDROM_API ehdrom_status ehdrom_model_open(ehdrom_model **model, const char *path,
                                           const ehdrom_model_options *options);
/* Accepts NULL. Contacts of the model have to be freed before. */
EHDROM_API void ehdrom_model_close(ehdrom_model *model);
/* Why it was not opened, or "". */
EHDROM_API const char *ehdrom_model_error(const ehdrom_model *model);

typedef struct ehdrom_model_info {
    size_t size;    /* sizeof(ehdrom_model_info) */
    int dimensions; /* of the pressurised zone: 1 of a line, 2 of a point contact or ellipse */
    /* nodes along and across the whole contact, num_y 1 of a line; of a list of models on different
     * grids these, x_min and step are of the grid with most nodes */
    size_t num_x, num_y;
    double x_min, y_min; /* the first node, in half widths */
    double step;         /* between nodes along, in half widths; across times (b/a)^(-1/3) */
    size_t pressure_modes, deformation_modes, unknowns, rows, states;
    int checked;         /* 1: these sizes were checked, so that deviations are indicated */
    int checked_in_time; /* 1: on trajectories too */
    int in_time;         /* 1: loaded for steps in time; 0 too of a list of models on different
                            grids, which line contacts may have */
    double ellipticity;  /* b/a, half width across over that along; 1 of a line or point contact */
    size_t parts; /* models of a list, for parts of a region; 1 of a model. Sizes are those of
                            the largest, states of all */
} ehdrom_model_info;
#define EHDROM_MODEL_INFO_INIT                                                                     \
    { sizeof(ehdrom_model_info), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

/* EHDROM_DATA: a struct of no size; EHDROM_INTERNAL: the model was not opened. */
EHDROM_API ehdrom_status ehdrom_model_describe(const ehdrom_model *model, ehdrom_model_info *info);

/* ---- contacts and their settings */

typedef struct ehdrom_contact ehdrom_contact;

/* A contact without settings but the model's kind and discretisation. Of an ellipse the model's
 * ellipticity counts where neither "ellipticity" nor "physical.radius_across" is set; another one is
 * EHDROM_DATA. *contact is to be freed in any
 * case, as above. The model must outlive it. */
EHDROM_API ehdrom_status ehdrom_contact_create(ehdrom_contact **contact, const ehdrom_model *model);
/* Accepts NULL. */
EHDROM_API void ehdrom_contact_free(ehdrom_contact *contact);
/* What the last call with this contact found, or "". Stays until the next one. */
EHDROM_API const char *ehdrom_contact_error(const ehdrom_contact *contact);

/* Takes all settings from a scene file. Its transient.load and the like are not followed:
 * ehdrom_step is told the conditions. */
EHDROM_API ehdrom_status ehdrom_contact_read(ehdrom_contact *contact, const char *path);

/* Sets one by its key in scenes ("lubricant.viscosity.law", "physical.load"; romrun --help lists all)
 * from its text there, whatever the locale; NULL unsets it. They count from the next ehdrom_solve or
 * ehdrom_start on. */
EHDROM_API ehdrom_status ehdrom_contact_set(ehdrom_contact *contact, const char *key,
                                            const char *value);
EHDROM_API ehdrom_status ehdrom_contact_set_number(ehdrom_contact *contact, const char *key,
                                                   double value);
/* The text that one is set to, numbers with all digits, "" where it is not; defaults that depend on others are not
 * filled in. EHDROM_DATA: no such key, or no room for it in `size` characters. */
EHDROM_API ehdrom_status ehdrom_contact_get(ehdrom_contact *contact, const char *key, char *text,
                                            size_t size);

enum {
    EHDROM_SI = 0,
    /* film and approach by a^2/R, pressure by p_H, length by a, load by that which is set, time by
     * a/u, and conditions relative to what is set; a scene of moes.M and moes.L knows no other */
    EHDROM_DIMENSIONLESS = 1
};
EHDROM_API ehdrom_status ehdrom_contact_set_units(ehdrom_contact *contact, int units);

/* A result that is indicated to be further off is EHDROM_UNTRUSTED; 0.01 unless set. INFINITY: whatever is
 * indicated, and also by a model that was never checked. What lies outside of the training is untrusted all the
 * same, and so are steps of a contact that changes faster than any in training. */
EHDROM_API ehdrom_status ehdrom_contact_set_accuracy(ehdrom_contact *contact, double accuracy);

/* ehdrom_solve iterates until another iteration is expected to change the central film by a smaller
 * part; 1e-8 unless set. */
EHDROM_API ehdrom_status ehdrom_contact_set_tolerance(ehdrom_contact *contact, double tolerance);
/* What all steps may do to the central film: a step's iteration leaves a tenth of its part. Unless
 * set, steps are iterated as ehdrom_solve does it. */
EHDROM_API ehdrom_status ehdrom_contact_set_step_tolerance(ehdrom_contact *contact,
                                                           double tolerance);

/* What makes the contact's quantities dimensionless, SI; NaN where the scene gives M and L. */
typedef struct ehdrom_scales {
    size_t size;              /* sizeof(ehdrom_scales) */
    double half_width;        /* a, m */
    double film;              /* a^2/R, m */
    double hertz_pressure;    /* p_H, Pa */
    double load;              /* N/m or N */
    double speed;             /* u, m/s */
    double time;              /* a/u, s */
    double moes_M, moes_L;    /* 1 */
    double half_width_across; /* m: b of an ellipse, else a */
} ehdrom_scales;
#define EHDROM_SCALES_INIT                                                                         \
    { sizeof(ehdrom_scales), 0, 0, 0, 0, 0, 0, 0, 0, 0 }
EHDROM_API ehdrom_status ehdrom_contact_scales(ehdrom_contact *contact, ehdrom_scales *scales);

/* ---- solutions */

typedef struct ehdrom_result {
    size_t size;          /* sizeof(ehdrom_result) */
    ehdrom_status status; /* EHDROM_OK, EHDROM_NOT_CONVERGED, EHDROM_UNTRUSTED */
    int trusted;          /* 1 with EHDROM_OK */
    double time;          /* s; 0 of a stationary solution */
    double load;          /* N/m or N: the force between the bodies */
    /* m, H0 a^2/R: how far they are from touching undeformed; of a line contact as measured from 1 half
     * width by ehdrom_solve, in time from approach_length half widths (10 unless set) */
    double approach;
    double central_film_thickness; /* m */
    double minimum_film_thickness; /* m */
    double central_pressure;       /* Pa */
    double peak_pressure;          /* Pa, the largest at nodes that the solution looks at */
    double exit_position;          /* m behind the centre, at which the pressure ends (y = 0) */
    double half_width;             /* m, of the dry contact at this time */
    /* of central and minimum film, relative, from the full model with the same grid and steps; NaN:
     * the model was not checked for that */
    double indicated_deviation, indicated_deviation_minimum;
    double local_error; /* of this step, relative to the central film; 0: not known yet. In a step shorter than the
                           grid's along the path: this step's share in the error of a longer one */
    double residual;    /* of the reduced equations */
    size_t iterations;
    /* of ehdrom_solve, where lubricant.thermal_conductivity is set: the factor by which shear heating of the inlet
     * thins the films, which are isothermal here; NaN: not known, in time too, or outside of its formula's range */
    double inlet_heating_factor;
} ehdrom_result;
#define EHDROM_RESULT_INIT                                                                         \
    { sizeof(ehdrom_result), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

/* The stationary solution of the settings. */
EHDROM_API ehdrom_status ehdrom_solve(ehdrom_contact *contact, ehdrom_result *result);

/* ---- in time
 *
 *     ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT;
 *
 *     ehdrom_start(contact, NULL, &result);
 *     while (…) {
 *         conditions.given = EHDROM_APPROACH;
 *         do {
 *             conditions.approach = …;
 *             // as often as wanted, always from the last accepted state
 *             ehdrom_step(contact, &conditions, step, &result);
 *         } while (…);
 *         ehdrom_accept(contact);
 *     }
 *
 * A step is BDF2. The first one, and one much longer than those before it, are BDF1. Steps may have any lengths.
 * The settings are the reference: what conditions do not give
 * stays as it is set. The approach of a line contact is measured from approach_length half widths, 10
 * unless set; where it is given they have to be at least half the grid's length. If the
 * approach is given, bodies may part: the load is then 0 and the film is their gap. The result is untrusted if the
 * neglected load may exceed 1 % of the reference load. With a given load of 0 the bodies are apart too, and the film is
 * NaN. */

enum {
    EHDROM_LOAD = 1,
    EHDROM_APPROACH = 2, /* instead of the load, which is then an outcome */
    EHDROM_SPEED = 4,
    EHDROM_RADIUS = 8,
    EHDROM_MODULUS = 16
};

/* What holds at the end of a step. */
typedef struct ehdrom_conditions {
    size_t size;     /* sizeof(ehdrom_conditions) */
    unsigned given;  /* EHDROM_LOAD | …: which of these are */
    double load;     /* N/m or N */
    double approach; /* m */
    double speed;    /* m/s, the mean of both surfaces; not negative */
    double radius;   /* m */
    double modulus;  /* Pa */
} ehdrom_conditions;
#define EHDROM_CONDITIONS_INIT                                                                     \
    { sizeof(ehdrom_conditions), 0, 0, 0, 0, 0, 0 }

/* The stationary state of the conditions at time 0 (NULL: of the settings), which is accepted. */
EHDROM_API ehdrom_status ehdrom_start(ehdrom_contact *contact, const ehdrom_conditions *conditions,
                                      ehdrom_result *result);
/* The state `step` seconds after the last accepted one. EHDROM_NOT_CONVERGED: try a shorter one. */
EHDROM_API ehdrom_status ehdrom_step(ehdrom_contact *contact, const ehdrom_conditions *conditions,
                                     double step, ehdrom_result *result);
/* The same of `count` contacts, of any models, one after the other in this thread; conditions NULL: those
 * of the settings. Returns the largest status; each result has its own, of an error too, after which the
 * rest of it is as before, and each contact its text. Without effect on the others is one that fails. */
EHDROM_API ehdrom_status ehdrom_step_many(ehdrom_contact *const *contacts,
                                          const ehdrom_conditions *conditions, double step,
                                          ehdrom_result *results, size_t count);
/* Accepts the last step. EHDROM_INTERNAL: there is none, or it did not converge. */
EHDROM_API ehdrom_status ehdrom_accept(ehdrom_contact *contact);
/* After a jump of the conditions: the next step is first order, from the last state alone. */
EHDROM_API ehdrom_status ehdrom_restart(ehdrom_contact *contact);

/* Saves the accepted state and restores it, in any contact of the same model and settings, also of
 * another process: steps that follow are the same to the last bit. EHDROM_DATA: not as many numbers,
 * no saved state, or one of other settings; the contact has then to be started or restored anew. */
EHDROM_API ehdrom_status ehdrom_state_size(ehdrom_contact *contact, size_t *count);
EHDROM_API ehdrom_status ehdrom_state_save(ehdrom_contact *contact, double *state, size_t count);
EHDROM_API ehdrom_status ehdrom_state_restore(ehdrom_contact *contact, const double *state,
                                              size_t count);

/* ---- derivatives, of the last ehdrom_solve, ehdrom_start or ehdrom_step, whichever came last; of a step until
 * it is accepted
 *
 *     ehdrom_conditions direction = EHDROM_CONDITIONS_INIT;
 *     ehdrom_derivatives by_approach = EHDROM_DERIVATIVES_INIT;
 *
 *     direction.given = EHDROM_APPROACH;
 *     direction.approach = 1;
 *     ehdrom_differentiate(contact, &direction, &by_approach); // by_approach.load: dF/dh, N/m^2 or N/m */

/* How fast results change, in their units. */
typedef struct ehdrom_derivatives {
    size_t size; /* sizeof(ehdrom_derivatives) */
    double load;
    /* of a line contact as measured from approach_length half widths (10), after ehdrom_solve too, whose result has
     * the approach from 1 half width: differences of that are other numbers */
    double approach;
    double central_film_thickness;
    double minimum_film_thickness;
    double central_pressure;
    double peak_pressure; /* of the node where it is largest */
    double exit_position; /* NaN where it is known as a node only */
    double half_width;
} ehdrom_derivatives;
#define EHDROM_DERIVATIVES_INIT                                                                    \
    { sizeof(ehdrom_derivatives), 0, 0, 0, 0, 0, 0, 0, 0 }

/* Derivatives along a direction: its `given` says which conditions change, and their members how
 * fast, in their units; others are held. Either load or approach is given, of which the other is an
 * outcome: the one whose bit is set, with 0 where it is held, or if none is that which the solution
 * was given. Of a solution the derivatives are those of stationary ones; of a step, the tangent at
 * its end: how that changes with the conditions there, from the same accepted state. They follow
 * from the Jacobian of the reduced equations, in about two iterations' time, along further
 * directions in half of that, and leave the contact as it is. EHDROM_DATA: a direction that is not
 * finite, both load and approach, or an approach of a line contact that is measured from within the
 * pressurised zone. EHDROM_INTERNAL: no solution, or a start at rest. EHDROM_NOT_CONVERGED: none
 * that is finite. */
EHDROM_API ehdrom_status ehdrom_differentiate(ehdrom_contact *contact,
                                              const ehdrom_conditions *direction,
                                              ehdrom_derivatives *derivatives);

/* The response of the force to a small slow change of the approach, dF = -(stiffness + s damping) dh for
 * s -> 0, at constant speed: of a stationary contact, not of a step. */
typedef struct ehdrom_response {
    size_t size;      /* sizeof(ehdrom_response) */
    double stiffness; /* -dF/dh, N/m^2 of a line contact, N/m of a point contact */
    double damping;   /* N s/m^2 or N s/m, by the squeeze term */
    /* as damping: by how much what the modes do not have of it moves it; of ten models damping was 2 to 8 times as
     * far off. Modes of lines that were trained in time have it, those of stationary solutions often not. */
    double damping_bound;
} ehdrom_response;
#define EHDROM_RESPONSE_INIT                                                                       \
    { sizeof(ehdrom_response), 0, 0, 0 }

/* Of the last ehdrom_solve or ehdrom_start. Errors as above; EHDROM_INTERNAL: a step came last. */
EHDROM_API ehdrom_status ehdrom_respond(ehdrom_contact *contact, ehdrom_response *response);

/* ---- traction, of the last ehdrom_solve or the accepted state, whichever came last (of a restored
 * state: from the next accepted step on) */

typedef struct ehdrom_traction {
    size_t size;                 /* sizeof(ehdrom_traction) */
    double friction_coefficient; /* friction over load, of the sign of the sliding */
    double
        friction_force; /* N/m or N, by the sliding: on surface 2 along x, on surface 1 against it */
    double rolling_resistance;   /* N/m or N, on either surface against x */
    double rolling_moment;       /* N or N m, of the pressures against the rolling */
    double power_loss;           /* W/m or W, that both surfaces put into the film */
    double mean_shear_stress;    /* Pa, of its magnitude over the dry contact */
    double largest_shear_stress; /* Pa, at nodes that the solution looks at */
    /* relative, of the friction force from that of the full model; NAN: of a step, not checked,
     * or of a model of before version 0.3.0 */
    double indicated_deviation_friction;
} ehdrom_traction;
#define EHDROM_TRACTION_INIT                                                                       \
    { sizeof(ehdrom_traction), 0, 0, 0, 0, 0, 0, 0, 0 }

/* With the surfaces sliding at u1 - u2 = `sliding`, m/s, which films do not depend on, but with
 * lubricant.shear.in_film; NAN: as slide_roll or both speeds say, over the mean speed. These and the
 * law, lubricant.shear, are those of the settings with which the contact was last solved or started.
 * A model of this version has it from few nodes, of others its cost grows with the grid.
 * EHDROM_DATA: a scene of moes.M and moes.L, no sliding, or with in_film another one than the film's;
 * EHDROM_INTERNAL: no solution before. */
EHDROM_API ehdrom_status ehdrom_slide(ehdrom_contact *contact, double sliding,
                                      ehdrom_traction *traction);

/* The same of the last ehdrom_step, which need not be accepted; steps that follow have the same bits. */
EHDROM_API ehdrom_status ehdrom_slide_step(ehdrom_contact *contact, double sliding,
                                           ehdrom_traction *traction);

/* ---- fields, of the last solution or the accepted state, whichever came last */

/* How many nodes the solution has along and across: those of ehdrom_model_info, but of a list of models on
 * different grids those of the model that has solved it. The arrays below are as long as ehdrom_model_info
 * says, with NaN behind these nodes. Before a solution: those of ehdrom_model_info. Either may be NULL. */
EHDROM_API ehdrom_status ehdrom_nodes(ehdrom_contact *contact, size_t *num_x, size_t *num_y);
/* Where the nodes are: [num_x], [num_y]. Either may be NULL. */
EHDROM_API ehdrom_status ehdrom_axes(ehdrom_contact *contact, double *x, double *y);
/* Pressure and film at all of them, [num_y, num_x]. Either may be NULL. Its cost grows with the grid, as that of
 * ehdrom_shear_stresses. */
EHDROM_API ehdrom_status ehdrom_fields(ehdrom_contact *contact, double *pressure, double *film);
/* What the fluid does to surface 1 and to surface 2 along x, Pa, there: -tau - h/2 dp/dx and tau - h/2 dp/dx, 0 where
 * there is no pressure. `sliding`, settings and errors as of ehdrom_slide. Either may be NULL. */
EHDROM_API ehdrom_status ehdrom_shear_stresses(ehdrom_contact *contact, double sliding,
                                               double *stress_1, double *stress_2);

#ifdef __cplusplus
}
#endif

#endif
