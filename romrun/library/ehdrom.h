/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Elastohydrodynamic contacts for other programs: the reduced model of ehdrom.
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
 * Units are SI: loads in N/m for a line contact and in N for a point contact or an ellipse; m, s,
 * m/s, Pa, Pa s. ehdrom_contact_set_units chooses dimensionless quantities.
 *
 * An open model does not change: any number of contacts in any number of threads may use it. A
 * contact is used by one thread at a time. Several threads may open models, but HDF5 files must
 * not be opened while the program itself is in HDF5 or in FFTW's planner. HDF5 is loaded when the
 * first HDF5 file is opened; libehdrom.so.0 then needs the file libehdrom-hdf5.so.0 in the same
 * folder. Flat models need neither HDF5 nor this file. The library prints nothing and does not end
 * the process. It does not change the locale, the signals or the threads of the process.
 *
 * Functions return one of
 *   - EHDROM_OK: success, and the result is filled in;
 *   - EHDROM_NOT_CONVERGED: there is no solution. The result is filled in;
 *   - EHDROM_UNTRUSTED: there is a solution, and the result is filled in. The error text gives a
 *     reason not to rely on the solution;
 *   - an error (EHDROM_FAILED): the result is unchanged.
 * ehdrom_model_error and ehdrom_contact_error return the error text: what was found and what was
 * expected.
 *
 * Later versions may add functions, settings, and members at the end of structs. The first member
 * of each struct is therefore the size of the struct in the caller's program. */
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

/* Returns the version of the running library, "0.3.0". EHDROM_VERSION is the header's version. */
EHDROM_API const char *ehdrom_version(void);

/* Outcomes and errors. The numbers are the exit codes of romrun. */
typedef int ehdrom_status;
enum {
    EHDROM_OK = 0,
    EHDROM_NOT_CONVERGED = 3, /* outcome: there is no solution */
    EHDROM_UNTRUSTED = 4,     /* outcome: solved, but not to be relied on */
    EHDROM_DATA = 65,         /* bad data or setting */
    EHDROM_NOINPUT = 66,      /* file missing or unreadable */
    EHDROM_INTERNAL = 70,     /* calls in a wrong order, or a fault of the library */
    EHDROM_MEMORY = 71,       /* out of memory */
    EHDROM_IO = 74            /* reading failed midway */
};
#define EHDROM_FAILED(status) ((status) >= EHDROM_DATA)

/* ---- models */

typedef struct ehdrom_model ehdrom_model;

/* Selects the modes, rows and data of a model that are loaded. */
typedef struct ehdrom_model_options {
    size_t size;              /* sizeof(ehdrom_model_options) */
    size_t pressure_modes;    /* number of pressure modes, beginning with the first; 0: all modes */
    size_t deformation_modes; /* number of deformation modes; 0: all modes */
    size_t rows;              /* number of rows (selected equations); 0: all rows */
    int stationary;           /* 1: the data for steps in time are not loaded */
} ehdrom_model_options;
#define EHDROM_MODEL_OPTIONS_INIT                                                                  \
    { sizeof(ehdrom_model_options), 0, 0, 0, 0 }

/* Opens a model. `options` NULL: the whole model. The file is one of
 *   - a model in HDF5;
 *   - a flat model (romrun export), which opens in milliseconds and has the sizes with which it
 *     was exported; the file must not be changed while it is open;
 *   - a list of models for parts of a region (schemas/models.md), whose name ends with .yml. All
 *     modes and rows of these models are loaded; sizes in `options` give EHDROM_DATA.
 * Close *model in any case; after an error it holds the text for ehdrom_model_error. *model is
 * NULL if there is no memory for it, or if the processor lacks instructions that the library was
 * built with (EHDROM_INTERNAL). EHDROM_DATA: the file is no model, or it is in HDF5 and
 * libehdrom-hdf5.so.0 or HDF5 is missing. Checksums are checked unless the environment variable
 * EHDROM_DIGEST is `no`. The check takes half of the time of opening a flat model. */
EHDROM_API ehdrom_status ehdrom_model_open(ehdrom_model **model, const char *path,
                                           const ehdrom_model_options *options);
/* Closes a model. Accepts NULL. Free the model's contacts before. */
EHDROM_API void ehdrom_model_close(ehdrom_model *model);
/* Returns why the model was not opened, or "". */
EHDROM_API const char *ehdrom_model_error(const ehdrom_model *model);

typedef struct ehdrom_model_info {
    size_t size;    /* sizeof(ehdrom_model_info) */
    int dimensions; /* 1: line contact; 2: point contact or ellipse */
    /* Nodes along and across the whole contact; num_y is 1 for a line contact. For a list of
     * models on different grids, num_x, num_y, x_min and step are those of the grid with the most
     * nodes. */
    size_t num_x, num_y;
    double x_min, y_min; /* position of the first node, half widths */
    double step;         /* node distance along x, half widths; along y: this times (b/a)^(-1/3) */
    size_t pressure_modes, deformation_modes, unknowns, rows, states;
    int checked;         /* 1: results have error estimates, since the model was checked with these
                            numbers of modes and rows */
    int checked_in_time; /* 1: the model was also checked on trajectories */
    int in_time;         /* 1: loaded for steps in time. Always 0 for a list of models on different
                            grids, which only line contacts may have */
    double ellipticity;  /* b/a, half width across over half width along; 1 for a line or point
                            contact */
    size_t parts;        /* number of models in a list; 1 for a single model. The numbers of modes,
                            unknowns and rows are those of the model with the most unknowns;
                            `states` is the sum over all models */
} ehdrom_model_info;
#define EHDROM_MODEL_INFO_INIT                                                                     \
    { sizeof(ehdrom_model_info), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

/* Describes a model. EHDROM_DATA: the struct has no size; EHDROM_INTERNAL: the model was not
 * opened. */
EHDROM_API ehdrom_status ehdrom_model_describe(const ehdrom_model *model, ehdrom_model_info *info);

/* ---- contacts and their settings */

typedef struct ehdrom_contact ehdrom_contact;

/* Creates a contact. It has only the settings that are taken from the model: the kind of contact
 * and the discretisation. For an ellipse the model's ellipticity is used if neither "ellipticity"
 * nor "physical.radius_across" is set; another ellipticity gives EHDROM_DATA. Free *contact in any
 * case; after an error it holds the text for ehdrom_contact_error. The model must outlive the
 * contact. */
EHDROM_API ehdrom_status ehdrom_contact_create(ehdrom_contact **contact, const ehdrom_model *model);
/* Frees a contact. Accepts NULL. */
EHDROM_API void ehdrom_contact_free(ehdrom_contact *contact);
/* Returns the error text of the last call with this contact, or "". The text is valid until the
 * next call. */
EHDROM_API const char *ehdrom_contact_error(const ehdrom_contact *contact);

/* Takes all settings from a scene file. Histories in the file, such as transient.load, have no
 * effect: the caller gives the conditions of each step to ehdrom_step. */
EHDROM_API ehdrom_status ehdrom_contact_read(ehdrom_contact *contact, const char *path);

/* Sets a setting by its key in scenes ("lubricant.viscosity.law", "physical.load"; romrun --help
 * lists all). `value`: the text that the setting has in scenes, independent of the locale; NULL
 * unsets the setting. Settings take effect with the next ehdrom_solve or ehdrom_start. */
EHDROM_API ehdrom_status ehdrom_contact_set(ehdrom_contact *contact, const char *key,
                                            const char *value);
EHDROM_API ehdrom_status ehdrom_contact_set_number(ehdrom_contact *contact, const char *key,
                                                   double value);
/* Writes the text of a setting to `text`; numbers have all digits. Writes "" if the setting is not
 * set. Defaults that depend on other settings are not filled in. EHDROM_DATA: no such key, or the
 * text does not fit into `size` characters. */
EHDROM_API ehdrom_status ehdrom_contact_get(ehdrom_contact *contact, const char *key, char *text,
                                            size_t size);

enum {
    EHDROM_SI = 0,
    /* Quantities are divided by scales: film and approach by a^2/R, pressure by p_H, length by a,
     * load by the load in the settings, time by a/u, and speed, radius and modulus by their values
     * in the settings. A scene with moes.M and moes.L has only dimensionless quantities. */
    EHDROM_DIMENSIONLESS = 1
};
EHDROM_API ehdrom_status ehdrom_contact_set_units(ehdrom_contact *contact, int units);

/* Sets the accuracy; default 0.01. A result whose error estimate is larger is EHDROM_UNTRUSTED.
 * With INFINITY neither an error estimate nor a model that was never checked makes a result
 * untrusted. Results outside of the training, and steps of a contact that changes faster than any
 * contact in training, are untrusted in any case. */
EHDROM_API ehdrom_status ehdrom_contact_set_accuracy(ehdrom_contact *contact, double accuracy);

/* Sets the tolerance of ehdrom_solve; default 1e-8. The iteration ends when the next iteration is
 * expected to change the central film by less than this fraction. */
EHDROM_API ehdrom_status ehdrom_contact_set_tolerance(ehdrom_contact *contact, double tolerance);
/* Sets the relative error of the central film that all time steps together may cause. With
 * transport along the path, the iterations of a step then have a tolerance of a tenth of the error
 * that is allowed for this step. Otherwise they have the default tolerance of ehdrom_solve. */
EHDROM_API ehdrom_status ehdrom_contact_set_step_tolerance(ehdrom_contact *contact,
                                                           double tolerance);

/* Scales of the contact's dimensionless quantities, SI. If the scene gives M and L, all other
 * members are NaN. */
typedef struct ehdrom_scales {
    size_t size;              /* sizeof(ehdrom_scales) */
    double half_width;        /* a, m */
    double film;              /* a^2/R, m */
    double hertz_pressure;    /* p_H, Pa */
    double load;              /* N/m or N */
    double speed;             /* u, m/s */
    double time;              /* a/u, s */
    double moes_M, moes_L;    /* dimensionless */
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
    double time;          /* s; 0 for a stationary solution */
    double load;          /* N/m or N, force between the bodies */
    /* m, H0 a^2/R: gap between the undeformed bodies at the centre, negative if they overlap. In a
     * line contact deflections, and thereby the approach, are relative to a point. The point lies
     * at 1 half width for ehdrom_solve, and at approach_length half widths (10 unless set) for
     * steps in time. */
    double approach;
    double central_film_thickness; /* m */
    double minimum_film_thickness; /* m */
    double central_pressure;       /* Pa */
    double peak_pressure; /* Pa, largest pressure at the nodes that the reduced model evaluates */
    double exit_position; /* m behind the centre: end of the pressure at y = 0 */
    double half_width;    /* m, of the dry contact at this time */
    /* Relative error estimates of central and minimum film, against the full model with the same
     * grid and steps; NaN: the model was not checked for this regime. */
    double indicated_deviation, indicated_deviation_minimum;
    /* Local error of this step, relative to the central film; 0: the error is not known yet. With
     * transport along the path, a short step may be computed as the end of a longer step. The value
     * is then this step's share of the error of the longer step. */
    double local_error;
    double residual; /* of the reduced equations */
    size_t iterations;
    /* Factor by which shear heating of the inlet thins the films, which are isothermal here.
     * ehdrom_solve sets it if lubricant.thermal_conductivity is set. NaN: the factor is not known,
     * the result is a step in time, or the contact lies outside of the formula's range. */
    double inlet_heating_factor;
} ehdrom_result;
#define EHDROM_RESULT_INIT                                                                         \
    { sizeof(ehdrom_result), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

/* Solves the stationary contact of the settings. */
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
 * Steps use BDF2 and may have any lengths. The first step, and any step much longer than the
 * previous steps, use BDF1. The settings are the reference: a condition that is not given keeps the
 * value in the settings.
 *
 * The approach of a line contact is relative to a point at approach_length half widths (10 unless
 * set). If the approach is given, approach_length must be at least half of the grid's length.
 *
 * If the approach is given, the bodies may separate. Their force is then neglected: the load is 0,
 * and the film is the gap between the bodies. The result is untrusted if the neglected force may
 * exceed 1 % of the reference load. With a given load of 0 the bodies are apart too, and the film
 * is NaN. */

enum {
    EHDROM_LOAD = 1,
    EHDROM_APPROACH = 2, /* instead of the load, which is then an outcome */
    EHDROM_SPEED = 4,
    EHDROM_RADIUS = 8,
    EHDROM_MODULUS = 16
};

/* Conditions at the end of a step. */
typedef struct ehdrom_conditions {
    size_t size;     /* sizeof(ehdrom_conditions) */
    unsigned given;  /* members that are given: EHDROM_LOAD | … */
    double load;     /* N/m or N */
    double approach; /* m */
    double speed;    /* m/s, the mean of both surfaces; not negative */
    double radius;   /* m */
    double modulus;  /* Pa */
} ehdrom_conditions;
#define EHDROM_CONDITIONS_INIT                                                                     \
    { sizeof(ehdrom_conditions), 0, 0, 0, 0, 0, 0 }

/* Computes the stationary state of the conditions at time 0 and accepts it. `conditions` NULL:
 * the conditions of the settings. */
EHDROM_API ehdrom_status ehdrom_start(ehdrom_contact *contact, const ehdrom_conditions *conditions,
                                      ehdrom_result *result);
/* Computes the state `step` seconds after the last accepted state. EHDROM_NOT_CONVERGED: try a
 * shorter step. */
EHDROM_API ehdrom_status ehdrom_step(ehdrom_contact *contact, const ehdrom_conditions *conditions,
                                     double step, ehdrom_result *result);
/* Takes a step with each of `count` contacts, like ehdrom_step, one after the other in this thread.
 * The contacts may have different models. `conditions`, [count], NULL: the conditions of the
 * settings. Returns the largest status. Each result has its own status and each contact its error
 * text. If a step returns an error, the other members of its result are unchanged, and the other
 * contacts are not affected. */
EHDROM_API ehdrom_status ehdrom_step_many(ehdrom_contact *const *contacts,
                                          const ehdrom_conditions *conditions, double step,
                                          ehdrom_result *results, size_t count);
/* Accepts the last step. EHDROM_INTERNAL: there is no step to accept, or it did not converge. */
EHDROM_API ehdrom_status ehdrom_accept(ehdrom_contact *contact);
/* Makes the next step first order: it uses only the last accepted state. Call it after a jump of
 * the conditions. */
EHDROM_API ehdrom_status ehdrom_restart(ehdrom_contact *contact);

/* Save the accepted state, and restore it in any contact of the same model and settings, even in
 * another process. The steps after the restored state are bit-identical. EHDROM_DATA: the number of
 * doubles is wrong, or they are no saved state or a state of other settings; the contact must then
 * be started or restored anew. */
EHDROM_API ehdrom_status ehdrom_state_size(ehdrom_contact *contact, size_t *count);
EHDROM_API ehdrom_status ehdrom_state_save(ehdrom_contact *contact, double *state, size_t count);
EHDROM_API ehdrom_status ehdrom_state_restore(ehdrom_contact *contact, const double *state,
                                              size_t count);

/* ---- derivatives of the last ehdrom_solve, ehdrom_start or ehdrom_step, whichever came last. A
 * step has derivatives until it is accepted.
 *
 *     ehdrom_conditions direction = EHDROM_CONDITIONS_INIT;
 *     ehdrom_derivatives by_approach = EHDROM_DERIVATIVES_INIT;
 *
 *     direction.given = EHDROM_APPROACH;
 *     direction.approach = 1;
 *     // by_approach.load becomes dF/dh, N/m^2 or N/m
 *     ehdrom_differentiate(contact, &direction, &by_approach); */

/* Derivatives of results along a direction, in the units of the results. */
typedef struct ehdrom_derivatives {
    size_t size; /* sizeof(ehdrom_derivatives) */
    double load;
    /* For a line contact this approach is relative to a point at approach_length half widths (10
     * unless set), even after ehdrom_solve. The approach in the result of ehdrom_solve is relative
     * to a point at 1 half width, so differences of results differ from this derivative. */
    double approach;
    double central_film_thickness;
    double minimum_film_thickness;
    double central_pressure;
    double peak_pressure; /* at the node with the largest pressure */
    double exit_position; /* NaN if only the node of the exit is known */
    double half_width;
} ehdrom_derivatives;
#define EHDROM_DERIVATIVES_INIT                                                                    \
    { sizeof(ehdrom_derivatives), 0, 0, 0, 0, 0, 0, 0, 0 }

/* Computes derivatives along a direction.
 *
 * The bits in direction->given select the conditions that change. Their members are the rates of
 * change, in the members' units. Other conditions stay constant.
 *
 * The direction prescribes either the load or the approach, whichever bit is set; the value 0 holds
 * it constant. The other quantity is an outcome. If neither bit is set, the quantity that was given
 * for the solution stays constant.
 *
 * After ehdrom_solve and ehdrom_start the derivatives are those of stationary solutions. After
 * ehdrom_step they are the change of the result with the conditions at the end of the step, from
 * the same accepted state.
 *
 * The derivatives follow from the Jacobian of the reduced equations. The first direction takes the
 * time of about two iterations, further directions half of this time. The contact does not change.
 * EHDROM_DATA: the direction is not finite, has both load and approach, or has the approach of a
 * line contact whose approach_length is less than half of the grid's length. EHDROM_INTERNAL: there
 * is no solution, or a start at rest. EHDROM_NOT_CONVERGED: a derivative is not finite. */
EHDROM_API ehdrom_status ehdrom_differentiate(ehdrom_contact *contact,
                                              const ehdrom_conditions *direction,
                                              ehdrom_derivatives *derivatives);

/* Response of the force of a stationary contact to a small slow change of the approach, dF =
 * -(stiffness + s damping) dh for s -> 0, at constant speed. Steps have no response. */
typedef struct ehdrom_response {
    size_t size;      /* sizeof(ehdrom_response) */
    double stiffness; /* -dF/dh, N/m^2 for a line contact, N/m for a point contact */
    double damping;   /* N s/m^2 or N s/m, due to the squeeze term */
    /* In the unit of the damping. Effect on the damping of the part of the squeeze term that the
     * modes do not contain. For ten models the error of the damping was 2 to 8 times this value.
     * Modes of line contacts trained in time contain this part. Modes of stationary solutions often
     * do not contain it. */
    double damping_bound;
} ehdrom_response;
#define EHDROM_RESPONSE_INIT                                                                       \
    { sizeof(ehdrom_response), 0, 0, 0 }

/* Computes the response of the last ehdrom_solve or ehdrom_start. Errors: as ehdrom_differentiate,
 * and EHDROM_INTERNAL if a step came last. */
EHDROM_API ehdrom_status ehdrom_respond(ehdrom_contact *contact, ehdrom_response *response);

/* ---- traction of the last ehdrom_solve or the accepted state, whichever came last. After a state
 * was restored, traction is available from the next accepted step on. */

typedef struct ehdrom_traction {
    size_t size;                 /* sizeof(ehdrom_traction) */
    double friction_coefficient; /* friction over load, with the sign of the sliding */
    /* N/m or N, force that the sliding causes: on surface 2 along x, on surface 1 against x */
    double friction_force;
    double rolling_resistance;   /* N/m or N, acts on each surface against x */
    double rolling_moment;       /* N or N m, moment of the pressures against the rolling */
    double power_loss;           /* W/m or W, power that both surfaces put into the film */
    double mean_shear_stress;    /* Pa, mean magnitude over the dry contact */
    double largest_shear_stress; /* Pa, largest at the nodes that the model evaluates */
    /* Relative error estimate of the friction force, against the full model. The value is NAN for a
     * step, for an unchecked model, and for a model from before version 0.3.0. */
    double indicated_deviation_friction;
} ehdrom_traction;
#define EHDROM_TRACTION_INIT                                                                       \
    { sizeof(ehdrom_traction), 0, 0, 0, 0, 0, 0, 0, 0 }

/* Computes the traction of surfaces that slide at u1 - u2 = `sliding`, m/s. NAN: the mean speed
 * times the slide-roll ratio of the settings (slide_roll, or the ratio from both speeds). This
 * ratio and the law lubricant.shear are taken from the settings with which the contact was last
 * solved or started. The sliding does not change the films, except with lubricant.shear.in_film. A
 * model of this version computes the traction as a sum over few nodes; with other models the cost
 * grows with the grid. Returns EHDROM_UNTRUSTED if the friction exceeds the load, which no
 * lubricant carries. Returns EHDROM_DATA if the scene is given by moes.M and moes.L, if no sliding
 * is known, if surfaces slide and lubricant.shear.law is not set, or if `sliding` differs from the
 * sliding that has thinned the film (lubricant.shear.in_film). Returns EHDROM_INTERNAL if there is
 * no solution yet. */
EHDROM_API ehdrom_status ehdrom_slide(ehdrom_contact *contact, double sliding,
                                      ehdrom_traction *traction);

/* Like ehdrom_slide, but for the state at the end of the last ehdrom_step. You may call it before
 * you accept the step. The call does not change the following steps. Returns EHDROM_DATA also if
 * the model has no nodes for traction. */
EHDROM_API ehdrom_status ehdrom_slide_step(ehdrom_contact *contact, double sliding,
                                           ehdrom_traction *traction);

/* ---- fields, of the last solution or the accepted state, whichever came last */

/* Returns the numbers of the solution's nodes along and across. Usually these are the numbers of
 * ehdrom_model_info. After a solution with a list of models on different grids, they are the
 * numbers of the model that has solved the contact. The arrays below then have NaN behind these
 * nodes, up to the lengths of ehdrom_model_info. Either pointer may be NULL. */
EHDROM_API ehdrom_status ehdrom_nodes(ehdrom_contact *contact, size_t *num_x, size_t *num_y);
/* Returns the positions of the nodes, [num_x] and [num_y]. Either array may be NULL. */
EHDROM_API ehdrom_status ehdrom_axes(ehdrom_contact *contact, double *x, double *y);
/* Returns pressure and film at all nodes, [num_y, num_x]. Either array may be NULL. The cost grows
 * with the grid, as for ehdrom_shear_stresses. */
EHDROM_API ehdrom_status ehdrom_fields(ehdrom_contact *contact, double *pressure, double *film);
/* Returns the stresses of the fluid on surface 1 and on surface 2 along x, Pa, at all nodes,
 * [num_y, num_x]: -tau - h/2 dp/dx and tau - h/2 dp/dx; 0 where the pressure is zero. `sliding`,
 * settings and errors: as ehdrom_slide. Either array may be NULL. */
EHDROM_API ehdrom_status ehdrom_shear_stresses(ehdrom_contact *contact, double sliding,
                                               double *stress_1, double *stress_2);

#ifdef __cplusplus
}
#endif

#endif
