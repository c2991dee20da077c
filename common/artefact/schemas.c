/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists what each kind of file holds: one entry per axis, dataset and attribute. After a change of
 * this list, update the pages in schemas/ as tests/unit/test_schemas.c describes. */
#include "common/artefact/artefact.h"

// In the tables, types, needs and ranges stand without ARTEFACT_, NEED_ and VALUES_.
#define AXIS(name, max, long_name) ANY_AXIS(name, max, false, NULL, long_name)
#define ANY_AXIS(name, max, optional, scale, long_name)                                            \
    { name, "1", long_name, max, optional, scale }

// the last argument is ON("axis", …) for a dataset, ROOT for an attribute
#define FIELD(name, type, units, need, values, long_name, by_entry, scale, ...)                    \
    {                                                                                              \
        name, ARTEFACT_##type, __VA_ARGS__, units, long_name, NEED_##need, VALUES_##values,        \
            by_entry, scale                                                                        \
    }
#define ON(...)                                                                                    \
    { __VA_ARGS__ }
#define ROOT                                                                                       \
    { NULL }
#define TEXT(name, need, long_name) FIELD(name, TEXT, "1", need, ANY, long_name, false, NULL, ROOT)
#define INTEGER(name, axes, need, values, long_name)                                               \
    FIELD(name, INTEGER, "1", need, values, long_name, false, NULL, axes)
#define REAL(name, axes, need, values, long_name)                                                  \
    FIELD(name, REAL, "1", need, values, long_name, false, NULL, axes)
#define QUANTITY(name, axes, units, need, values, long_name)                                       \
    FIELD(name, REAL, units, need, values, long_name, false, NULL, axes)
// a dimensionless real number with a scale for SI units; NULL: no scale
#define SCALED(name, axes, scale, need, values, long_name)                                         \
    FIELD(name, REAL, "1", need, values, long_name, false, scale, axes)
// a field of a result with one entry per point in time, which is read entry by entry
#define ENTRIES(name, scale, long_name)                                                            \
    FIELD(name, REAL, "1", OPTIONAL, ANY, long_name, true, scale, ON("time", "y", "x"))
// a quantity per length of a line contact, and of a point contact
#define LINE_AND_POINT(name, axes, line_units, point_units, values, long_name)                     \
    QUANTITY("line_" name, axes, line_units, OPTIONAL, values, long_name),                         \
        QUANTITY("point_" name, axes, point_units, OPTIONAL, values,                               \
                 "the same of a point contact")

#define SCHEMA(kind, major, minor, title)                                                          \
    const artefact_schema schema_##kind = {                                                        \
        "ehdrom-" #kind, major, minor, title, kind##_axes, kind##_fields, kind##_attributes}

/* Largest lengths of the axes. They limit the memory that a file can make a program take. The
 * product of two lengths and the bytes of a number does not overflow. Numbers of nodes and rows fit
 * into LAPACK's integers. */
enum {
    MAX_X = 1000000,
    MAX_Y = 100000,
    MAX_NODES = ARTEFACT_MAX_NODES,
    MAX_ROWS = 100000,
    MAX_MODES = 100000,
    MAX_STATES = 10000000,
    MAX_ITERATIONS = 100000000,
    MAX_TIMES = 100000000,
    MAX_RESTART = 1000000000,
    MAX_FEW = 1000
};

// ---- table entries that several kinds of file share

#define X_AXIS                                                                                     \
    AXIS("x", MAX_X,                                                                               \
         "inner nodes along the sliding direction, in Hertz contact half widths of the reference")
#define Y_AXIS                                                                                     \
    ANY_AXIS("y", MAX_Y, true, NULL,                                                               \
             "lines of inner nodes across the sliding direction, in Hertz contact half widths of " \
             "the reference; of a point contact")
#define FILM_X_AXIS                                                                                \
    AXIS("film_x", MAX_X + 2, "nodes of the film: x and one boundary node at either end")
#define FILM_Y_AXIS                                                                                \
    ANY_AXIS("film_y", MAX_Y + 2, true, NULL,                                                      \
             "lines of the film: y and the boundary lines beside it, of which a half domain has "  \
             "one; of a point contact")
#define STATE_AXIS AXIS("state", MAX_STATES, "index of the training solution")
#define PRESSURE_MODE_AXIS                                                                         \
    AXIS("pressure_mode", MAX_MODES, "index of the pressure mode, strongest first")
#define DEFORMATION_MODE_AXIS                                                                      \
    AXIS("deformation_mode", MAX_MODES, "index of the deformation mode, strongest first")

// `scale` converts the lengths of the grid to SI units; NULL: no scale
#define GRID_ATTRIBUTES(scale)                                                                     \
    TEXT("contact", ALWAYS, "kind of contact: line, point or ellipse"),                            \
        SCALED("x_min", ROOT, scale, ALWAYS, FINITE, "first node of x"),                           \
        SCALED("step", ROOT, scale, ALWAYS, POSITIVE, "distance between the nodes of x"),          \
        TEXT("discretization", OPTIONAL,                                                           \
             "of the equations on the grid: accurate, cross-flux or published; published where "   \
             "missing"),                                                                           \
        TEXT("boundary", OPTIONAL,                                                                 \
             "what lies around the grid of a point contact: open, the far field, or zero, no "     \
             "pressure; zero where missing"),                                                      \
        REAL("ellipticity", ROOT, OPTIONAL, POSITIVE,                                              \
             "b/a of an ellipse, the half width across over that along, by which y and x are "     \
             "scaled; needed there")
#define TRANSPORT_ATTRIBUTE                                                                        \
    TEXT("transport", OPTIONAL,                                                                    \
         "how films are carried on the trajectories of the training: upwind or path; where "       \
         "missing there are none, or upwind"),                                                     \
        REAL("smoothing", ROOT, OPTIONAL, ANY,                                                     \
             "transient.smoothing of these trajectories, in half widths; where missing it is not " \
             "known, or films are not carried along their paths")
#define HALF_ATTRIBUTE                                                                             \
    INTEGER("half", ROOT, OPTIONAL, FLAG,                                                          \
            "1: y starts at 0, on the mirror line of a point contact that is symmetric across; 0 " \
            "where missing")
#define DEFORMATION_ATTRIBUTE                                                                      \
    TEXT("deformation", ALWAYS,                                                                    \
         "deformation basis: independent (of its own) or coupled (deflections of the pressure "    \
         "modes)")
#define BASIS_ATTRIBUTE TEXT("basis_sha256", OWN, "identity of the basis file")

// estimates of the errors that the grid causes in a state
#define EFFECT(name, long_name) REAL(name, ON("state"), OPTIONAL, ANY, long_name)
#define EFFECT_FIELDS(prefix)                                                                      \
    EFFECT(prefix "step_effect",                                                                   \
           "error estimate of the central film by the step, relative; this and the next five are " \
           "not negative, infinite where the grid is too coarse to tell, NaN where not known"),    \
        EFFECT(prefix "inlet_effect",                                                              \
               "error estimate of the central film by the length of the inlet or domain"),         \
        EFFECT(prefix "step_effect_minimum", "the first of the minimum film"),                     \
        EFFECT(prefix "inlet_effect_minimum", "the second of the minimum film"),                   \
        EFFECT(prefix "step_effect_rolling", "the first of the rolling resistance"),               \
        EFFECT(prefix "inlet_effect_rolling", "the second of the rolling resistance")

// fields that describe a lubricant
#define RISE_FIELDS(prefix, axis)                                                                  \
    REAL(prefix "viscosity_rise", ON(axis), OPTIONAL, KNOWN,                                       \
         "logarithm of the viscosity at the Hertz pressure over that at zero; NaN where not "      \
         "known"),                                                                                 \
        REAL(prefix "density_rise", ON(axis), OPTIONAL, KNOWN, "the same of the density"),         \
        REAL(prefix "viscosity_rise_half", ON(axis), OPTIONAL, KNOWN,                              \
             "the first at half the Hertz pressure")

#define THINNING_FIELD(prefix)                                                                     \
    REAL(prefix "thinning", ON("state"), OPTIONAL, NOT_NEGATIVE,                                   \
         "Newtonian shear stress of the sliding over Eyring's stress, of the viscosity at zero "   \
         "pressure in a film H = 1, where the sliding thins the flow of the film; 0 where "        \
         "missing"),                                                                               \
        REAL(prefix "gradient_thinning", ON("state"), OPTIONAL, NOT_NEGATIVE,                      \
             "h/(2 tau0) dp/dx with Eyring's stress tau0 in a film H = 1 where dP/dX = 1, where "  \
             "the flow is thinned; 0 where missing")

// training solutions in the coordinates of a basis
#define STATE_PRESSURE_FIELD                                                                       \
    REAL("state_pressure", ON("state", "pressure_mode"), ALWAYS, FINITE,                           \
         "coordinates of the training pressures in the pressure basis")
#define STATE_DEFORMATION_FIELD                                                                    \
    REAL("state_deformation", ON("state", "deformation_mode"), OPTIONAL, FINITE,                   \
         "coordinates of the training deformations in the deformation basis")
#define STATE_OTHER_FIELDS                                                                         \
    REAL("state_rigid_approach", ON("state"), ALWAYS, FINITE,                                      \
         "rigid approach H0 of the training solutions"),                                           \
        INTEGER(                                                                                   \
            "state_exit_node", ON("state", "y"), ALWAYS, COLUMN,                                   \
            "index into x of the first node without pressure, length of x where there is none"),   \
        REAL("state_moes_M", ON("state"), ALWAYS, POSITIVE,                                        \
             "Moes load number M of the training solutions"),                                      \
        REAL("state_alpha_p_H", ON("state"), ALWAYS, NOT_NEGATIVE,                                 \
             "pressure-viscosity coefficient times Hertz pressure of the training solutions"),     \
        REAL("state_central_film_thickness", ON("state"), OWN, POSITIVE_OR_NAN,                    \
             "film thickness H at X = 0 of the training solutions"),                               \
        INTEGER(                                                                                   \
            "state_stationary", ON("state"), OPTIONAL, FLAG,                                       \
            "1 for a stationary training solution, 0 for one on a trajectory; 1 where missing"),   \
        REAL("state_rate", ON("state"), OPTIONAL, NOT_NEGATIVE,                                    \
             "rate of change of the contact at the training solutions; 0 where missing"),          \
        REAL("state_load_rate", ON("state"), OPTIONAL, NOT_NEGATIVE,                               \
             "largest rate of change of ln a on their trajectories up to the training solutions; " \
             "as state_rate where missing"),                                                       \
        THINNING_FIELD("state_"), RISE_FIELDS("state_", "state"), EFFECT_FIELDS("state_")
#define STATE_FIELDS STATE_PRESSURE_FIELD, STATE_DEFORMATION_FIELD, STATE_OTHER_FIELDS

// ---- result

// Scales that convert the numbers of a result to SI units. Fields and coordinates are scaled with
// the half width, film unit and Hertz pressure at the time of the entry (the current frame). All
// other numbers are scaled with the units of the reference contact (the reference frame).
static const artefact_scale time_scale = {{"time_unit", NULL}, NULL},
                            length_scale = {{"half_width", NULL}, NULL},
                            film_scale = {{"film_unit", NULL}, NULL},
                            pressure_scale = {{"hertz_pressure", NULL}, NULL},
                            load_scale = {{"line_load", "point_load"}, NULL},
                            moment_scale = {{"line_moment", "point_moment"}, NULL},
                            power_scale = {{"line_power", "point_power"}, NULL},
                            place_in_frame = {{"half_width", NULL}, "contact_half_width"},
                            place_across_in_frame = {{"half_width_across", "half_width"},
                                                     "contact_half_width"},
                            film_in_frame = {{"film_unit", NULL}, "frame_film_unit"},
                            pressure_in_frame = {{"hertz_pressure", NULL}, "frame_hertz_pressure"};

static const artefact_axis result_axes[] = {
    ANY_AXIS("time", MAX_TIMES, false, &time_scale,
             "dimensionless time T of the entries; 0 when stationary"),
    ANY_AXIS("y", MAX_Y, true, &place_across_in_frame,
             "lines of inner nodes across the sliding direction, in Hertz contact half widths of "
             "the frame; of a point contact"),
    ANY_AXIS("exit", MAX_FEW, true, NULL,
             "index of the exit, the farthest downstream first; where the entrainment reverses"),
    ANY_AXIS("x", MAX_X, false, &place_in_frame,
             "inner nodes along the sliding direction, in Hertz contact half widths of the frame"),
    AXIS("restart_slot", MAX_FEW, "index of the restart slot"),
    AXIS("restart_entry", MAX_RESTART, "index of the number in a restart slot"),
    {0}};

static const artefact_field result_fields[] = {
    ENTRIES("pressure", &pressure_in_frame, "pressure P, in Hertz pressures of the current frame"),
    ENTRIES("film_thickness", &film_in_frame, "film thickness H in the current frame"),
    ENTRIES("shear_stress_1", &pressure_in_frame,
            "what the fluid does to surface 1 along X, in Hertz pressures of the current frame; "
            "where the scene gives a slide-roll ratio, 0 where there is no pressure"),
    ENTRIES("shear_stress_2", &pressure_in_frame, "the same of surface 2"),
    SCALED("central_film_thickness", ON("time"), &film_scale, ALWAYS, ANY,
           "film thickness H at X = 0 (Y = 0) in the reference frame; while the bodies are apart, "
           "their gap, or NaN if the load is given"),
    SCALED("minimum_film_thickness", ON("time"), &film_scale, ALWAYS, ANY,
           "smallest film thickness H in the reference frame: interpolated, with discretization = "
           "published at a node"),
    SCALED("central_pressure", ON("time"), &pressure_scale, OWN, ANY,
           "pressure P at X = 0 (Y = 0) in the reference frame"),
    SCALED("rigid_approach", ON("time"), &film_scale, ALWAYS, ANY,
           "rigid approach H0 in the reference frame"),
    SCALED("load", ON("time"), &load_scale, OWN, ANY,
           "load relative to the reference load; 0 while the bodies are apart"),
    SCALED("contact_half_width", ON("time"), &length_scale, OWN, ANY,
           "half width that scales the frame, relative to the reference; where the approach is "
           "given, of the expected load"),
    SCALED("frame_hertz_pressure", ON("time"), &pressure_scale, OPTIONAL, ANY,
           "Hertz pressure that scales the frame, relative to the reference"),
    SCALED("frame_film_unit", ON("time"), &film_scale, OPTIONAL, ANY,
           "a^2/R that scales the frame, relative to the reference"),
    SCALED("surface_position", ON("time"), &length_scale, OPTIONAL, ANY,
           "X in the reference frame of what the scene's surface has: the end of a waviness, the "
           "middle of a dent, x = 0 of a table"),
    SCALED("exit_position", ON("time", "y", "exit"), &length_scale, OWN, ANY,
           "X at which the pressure ends, where the entrainment reverses of each of its intervals; "
           "NaN where there is none"),
    REAL("friction_coefficient", ON("time"), OPTIONAL, ANY,
         "friction over the load, positive where surface 1 is the faster one; this and the next "
         "six where the scene gives a slide-roll ratio"),
    SCALED("friction_force", ON("time"), &load_scale, OPTIONAL, ANY,
           "integral of the shear stress in the middle of the film, over the reference load: on "
           "surface 2 along X, on surface 1 against it"),
    SCALED("rolling_resistance", ON("time"), &load_scale, OPTIONAL, ANY,
           "integral of h/2 dp/dx, over the reference load: on either surface against X"),
    SCALED("rolling_moment", ON("time"), &moment_scale, OPTIONAL, ANY,
           "moment of the pressure against the rolling, over reference load and half width"),
    SCALED("power_loss", ON("time"), &power_scale, OPTIONAL, ANY,
           "power that both surfaces put into the film, over reference load and mean speed"),
    SCALED("mean_shear_stress", ON("time"), &pressure_scale, OPTIONAL, ANY,
           "mean of the magnitude of the shear stress in the middle of the film over the dry "
           "contact, in reference Hertz pressures"),
    SCALED("largest_shear_stress", ON("time"), &pressure_scale, OPTIONAL, ANY,
           "largest magnitude of that stress"),
    INTEGER("newton_iterations", ON("time"), OWN, ANY, "Newton iterations that the entry took"),
    REAL("residual_norm", ON("time"), OWN, ANY, "norm of the residual when the iteration ended"),
    REAL("indicated_deviation", ON("time"), OPTIONAL, ANY,
         "indicated relative deviation of the central film thickness from the full model, in time "
         "with the same steps; NaN where it cannot be told"),
    REAL("indicated_deviation_minimum", ON("time"), OPTIONAL, ANY,
         "the same of the minimum film thickness"),
    REAL("indicated_deviation_central_pressure", ON("time"), OPTIONAL, ANY,
         "the same of the central pressure; stationary"),
    SCALED("indicated_deviation_exit_position", ON("time"), &length_scale, OPTIONAL, ANY,
           "indicated deviation of the exit position, in half widths; stationary lines whose exit "
           "lies within a node"),
    REAL("indicated_deviation_load", ON("time"), OPTIONAL, ANY,
         "indicated deviation of the load, over the reference; stationary"),
    SCALED(
        "indicated_deviation_pressure", ON("time"), &pressure_scale, OPTIONAL, ANY,
        "indicated largest deviation of the pressure at any node, in Hertz pressures; stationary"),
    REAL("indicated_deviation_film", ON("time"), OPTIONAL, ANY,
         "indicated largest deviation of the film thickness at any node with pressure, over the "
         "central film thickness; stationary"),
    REAL("indicated_deviation_friction", ON("time"), OPTIONAL, ANY,
         "indicated relative deviation of the friction force, by the law of the scene; stationary"),
    INTEGER("status", ON("time"), OWN, ANY, "0 converged, 1 not converged, 4 not to be trusted"),
    INTEGER("by_full_model", ON("time"), OPTIONAL, FLAG,
            "1 solved by the full model, since the reduced one was not good enough, 0 by the "
            "reduced one; only with romrun --fallback full"),
    SCALED("time_step", ON("time"), &time_scale, OPTIONAL, ANY,
           "step in T that led to the entry, 0 at the start; only when transient"),
    REAL("time_effect", ON("time"), OPTIONAL, ANY,
         "estimated relative change of the central film by ever smaller steps in time; NaN where "
         "it cannot be told; only when transient"),
    REAL("time_effect_minimum", ON("time"), OPTIONAL, ANY, "the same of the minimum film"),
    REAL("restart", ON("restart_slot", "restart_entry"), OPTIONAL, ANY,
         "what the program that wrote the file needs to resume it, only when transient"),
    INTEGER("restart_entries", ON("restart_slot"), OPTIONAL, ANY,
            "number of entries of time after which the slot resumes, -1 while it is not valid"),
    {0}};

static const artefact_field result_attributes[] = {
    GRID_ATTRIBUTES(&length_scale),
    QUANTITY("hertz_pressure", ROOT, "Pa", ALWAYS, NOT_NEGATIVE, "Hertz pressure of the reference"),
    REAL("moes_M", ROOT, ALWAYS, POSITIVE, "Moes load number M of the reference"),
    REAL("moes_L", ROOT, OWN, NOT_NEGATIVE, "Moes material number L of the reference"),
    REAL("alpha_p_H", ROOT, ALWAYS, NOT_NEGATIVE,
         "pressure-viscosity coefficient times Hertz pressure"),
    QUANTITY("half_width", ROOT, "m", OPTIONAL, POSITIVE,
             "half width a of the reference, which X = 1 stands for; this and the next five of a "
             "contact given in SI units"),
    QUANTITY("half_width_across", ROOT, "m", OPTIONAL, POSITIVE,
             "b of an ellipse, which Y = 1 stands for; of a point contact that is half_width"),
    QUANTITY("film_unit", ROOT, "m", OPTIONAL, POSITIVE,
             "a^2/R of the reference, which H = 1 and an approach of 1 stand for"),
    QUANTITY("time_unit", ROOT, "s", OPTIONAL, POSITIVE,
             "a/u of the reference, u the mean of both surfaces' speeds, which T = 1 stands for"),
    LINE_AND_POINT("load", ROOT, "N m-1", "N", POSITIVE,
                   "load of the reference, which a load of 1 stands for; of a line contact"),
    LINE_AND_POINT("moment", ROOT, "N", "N m", POSITIVE,
                   "load times half width, which a rolling moment of 1 stands for; of a line "
                   "contact, this and the next three where the scene gives a slide-roll ratio"),
    LINE_AND_POINT("power", ROOT, "W m-1", "W", POSITIVE,
                   "load times mean speed, which a power loss of 1 stands for; of a line contact"),
    REAL("slide_roll", ROOT, OPTIONAL, ANY,
         "slide-roll ratio (u1 - u2)/u_m, where the scene gives one"),
    REAL("thinning", ROOT, OPTIONAL, NOT_NEGATIVE,
         "Newtonian shear stress of the sliding over Eyring's stress, of the viscosity at zero "
         "pressure in a film H = 1; where the sliding thins the flow of the film"),
    REAL("gradient_thinning", ROOT, OPTIONAL, NOT_NEGATIVE,
         "h/(2 tau0) dp/dx with Eyring's stress tau0 in a film H = 1 where dP/dX = 1, where the "
         "flow is thinned"),
    REAL("thermal_loading", ROOT, OPTIONAL, POSITIVE,
         "thermal loading parameter of the inlet, eta0 beta u^2/k; of a scene that gives the "
         "lubricant's conductivity, when stationary"),
    REAL("inlet_heating_factor", ROOT, OPTIONAL, POSITIVE,
         "factor by which shear heating of the inlet thins the films, which are isothermal here; "
         "not where its formula does not hold"),
    QUANTITY("solve_seconds", ROOT, "s", OWN, ANY,
             "time of the solution, without reading and writing"),
    QUANTITY("solve_seconds_rows", ROOT, "s", OPTIONAL, ANY,
             "part of it for residual and Jacobian rows"),
    QUANTITY("solve_seconds_linear", ROOT, "s", OPTIONAL, ANY, "part of it for linear systems"),
    QUANTITY("solve_seconds_exit", ROOT, "s", OPTIONAL, ANY, "part of it for finding the exit"),
    QUANTITY("solve_seconds_other", ROOT, "s", OPTIONAL, ANY, "the rest of it"),
    REAL("inlet_effect", ROOT, OPTIONAL, ANY,
         "error estimate of the central film by the length of the inlet, of a point contact of the "
         "domain, relative, when stationary; this and the next five are sizes without a sign, "
         "missing where the grid is too coarse to tell, and of a reduced solution interpolated "
         "between those of its training"),
    REAL("step_effect", ROOT, OPTIONAL, ANY, "error estimate of the central film by the step"),
    REAL("inlet_effect_minimum", ROOT, OPTIONAL, ANY, "the first of the minimum film"),
    REAL("step_effect_minimum", ROOT, OPTIONAL, ANY, "the second of the minimum film"),
    REAL("inlet_effect_rolling", ROOT, OPTIONAL, ANY,
         "the first of the rolling resistance and its moment"),
    REAL("step_effect_rolling", ROOT, OPTIONAL, ANY,
         "the second of the rolling resistance and its moment"),
    REAL("observed_order", ROOT, OPTIONAL, ANY,
         "order of convergence of the central film over this grid and those of twice and four "
         "times the step; not where there is none; of the full model, when stationary, like the "
         "three that follow"),
    INTEGER("inlet_nodes", ROOT, OPTIONAL, ANY,
            "nodes where the viscous pressure builds up, from 10 to 90 % of it; like the two that "
            "follow at Y = 0"),
    INTEGER("spike_nodes", ROOT, OPTIONAL, ANY,
            "nodes above half the height of the pressure spike, 0 where there is none"),
    INTEGER("outlet_nodes", ROOT, OPTIONAL, ANY,
            "nodes from the smallest film behind X = 0 to the exit"),
    INTEGER("steps", ROOT, OPTIONAL, ANY, "accepted time steps, only when transient"),
    INTEGER("rejected_steps", ROOT, OPTIONAL, ANY,
            "time steps that were taken again with a shorter one"),
    INTEGER("full_steps", ROOT, OPTIONAL, ANY,
            "accepted time steps of the full model; this and the next only with romrun --fallback "
            "full"),
    QUANTITY("full_seconds", ROOT, "s", OPTIONAL, ANY, "part of the time that the full model took"),
    INTEGER("total_newton_iterations", ROOT, OPTIONAL, ANY,
            "Newton iterations of all time steps, rejected ones too"),
    {0}};

SCHEMA(result, 1, 14, "Solution of an elastohydrodynamic contact");

// ---- snapshots

static const artefact_axis snapshots_axes[] = {
    STATE_AXIS,
    Y_AXIS,
    X_AXIS,
    AXIS("compressed", MAX_STATES, "index of the compressed snapshot, strongest first"),
    AXIS("round", MAX_STATES, "index of the round of adaptive training"),
    {0}};

static const artefact_field snapshots_fields[] = {
    REAL("pressure", ON("state", "y", "x"), ALWAYS, FINITE, "pressure P, in Hertz pressures"),
    REAL("film_thickness", ON("state", "y", "x"), OWN, FINITE, "film thickness H"),
    REAL("rigid_approach", ON("state"), ALWAYS, FINITE, "rigid approach H0"),
    INTEGER("exit_node", ON("state", "y"), ALWAYS, COLUMN,
            "index into x of the first node without pressure, length of x where there is none; of "
            "a line without pressure 0"),
    REAL("exit_position", ON("state", "y"), OWN, ANY,
         "X at which the pressure ends; NaN on a line without pressure"),
    REAL("moes_M", ON("state"), ALWAYS, POSITIVE, "Moes load number M"),
    REAL("moes_L", ON("state"), OWN, NOT_NEGATIVE, "Moes material number L"),
    REAL("alpha_p_H", ON("state"), ALWAYS, NOT_NEGATIVE,
         "pressure-viscosity coefficient times Hertz pressure"),
    QUANTITY("hertz_pressure", ON("state"), "Pa", OWN, NOT_NEGATIVE, "Hertz pressure"),
    REAL("central_film_thickness", ON("state"), OWN, ANY, "film thickness H at X = 0 (Y = 0)"),
    REAL("minimum_film_thickness", ON("state"), OWN, ANY,
         "smallest film thickness H: interpolated, with discretization = published at a node"),
    REAL("central_pressure", ON("state"), OWN, ANY, "pressure P at X = 0 (Y = 0)"),
    INTEGER("newton_iterations", ON("state"), OWN, ANY, "Newton iterations that the state took"),
    REAL("residual_norm", ON("state"), OWN, ANY, "norm of the residual when the iteration ended"),
    REAL("complementarity", ON("state"), OPTIONAL, ANY,
         "largest violation of P >= 0 and of the multiplier's Lambda >= 0 (scaled as the residual) "
         "at any node of a stationary point"),
    THINNING_FIELD(""),
    RISE_FIELDS("", "state"),
    EFFECT_FIELDS(""),
    INTEGER("trajectory", ON("state"), OPTIONAL, INDEX_OR_NONE,
            "index of the trajectory that the state was kept of, -1 for a stationary point"),
    REAL("trajectory_time", ON("state"), OPTIONAL, BOUND,
         "dimensionless time T of the state on its trajectory; 0 is the stationary start"),
    REAL("trajectory_rate", ON("state"), OPTIONAL, BOUND,
         "rate of change of the contact: of ln a and of u/u_ref with T, absolute values added"),
    REAL("trajectory_load_rate", ON("state"), OPTIONAL, BOUND,
         "largest rate of change of ln a with T, by load, radius or modulus, on the trajectory up "
         "to the state"),
    INTEGER("status", ON("state"), ALWAYS, ANY,
            "0 converged, 1 not converged, -1 not yet computed"),
    REAL("compressed_pressure", ON("compressed", "y", "x"), OPTIONAL, FINITE,
         "pressures of all steps of all trajectories, compressed: the rows have the singular "
         "values and right singular vectors of the snapshots, and serve in their place"),
    REAL("compressed_singular_values", ON("compressed"), OPTIONAL, NOT_NEGATIVE,
         "singular values of those snapshots, descending"),
    INTEGER("training_point", ON("state"), OPTIONAL, ANY,
            "index of the point of the plan, of those inside of its bounds, that adaptive training "
            "chose"),
    INTEGER("training_round", ON("state"), OPTIONAL, ANY,
            "round of adaptive training that the state came in"),
    REAL("training_bound", ON("state"), OPTIONAL, ANY,
         "what the indicator said of the state before it was solved, but for its factor: bound of "
         "the relative deviation of the central film by the reduced model of the rounds before; "
         "infinite where that did not converge, NaN in the first round"),
    REAL("training_film", ON("state"), OPTIONAL, ANY,
         "film thickness H at X = 0 by that model; NaN where there is none"),
    REAL("training_bound_minimum", ON("state"), OPTIONAL, ANY,
         "training_bound of the minimum film"),
    REAL("training_film_minimum", ON("state"), OPTIONAL, ANY,
         "minimum film thickness by that model"),
    INTEGER("round_points", ON("round"), OPTIONAL, ANY,
            "converged training solutions up to and with the round, of which its model is made"),
    REAL("round_indicated", ON("round"), OPTIONAL, ANY,
         "largest deviation of a film, central or minimum, that is indicated for the remaining "
         "points of the plan; infinite where the model of the round does not converge, NaN where "
         "none remain or the indicator has no factor yet"),
    REAL("round_deviation", ON("round"), OPTIONAL, ANY,
         "largest relative deviation of a film by the model of the round at those points of the "
         "next one that it solves; NaN where there are none"),
    QUANTITY("round_seconds", ON("round"), "s", OPTIONAL, ANY,
             "time since the start until the round was judged; NaN in an earlier run"),
    {0}};

static const artefact_field snapshots_attributes[] = {
    GRID_ATTRIBUTES(NULL),
    TRANSPORT_ATTRIBUTE,
    HALF_ATTRIBUTE,
    INTEGER("compressed_snapshots", ROOT, OPTIONAL, COUNT, "number of steps of all trajectories"),
    REAL("compressed_energy_discarded", ROOT, OPTIONAL, ANY,
         "part of the squared singular values that the compression left out, at most"),
    {0}};

SCHEMA(snapshots, 2, 7, "Training solutions of an elastohydrodynamic contact");

// ---- basis

static const artefact_axis basis_axes[] = {
    Y_AXIS,
    X_AXIS,
    FILM_Y_AXIS,
    FILM_X_AXIS,
    PRESSURE_MODE_AXIS,
    DEFORMATION_MODE_AXIS,
    AXIS("pressure_singular_value", MAX_STATES,
         "index of the singular value of the pressure snapshots"),
    AXIS("deformation_singular_value", MAX_STATES,
         "index of the singular value of the deformation snapshots"),
    STATE_AXIS,
    {0}};

static const artefact_field basis_fields[] = {
    REAL("pressure_basis", ON("pressure_mode", "y", "x"), ALWAYS, FINITE, "pressure modes"),
    REAL("deformation_basis", ON("deformation_mode", "film_y", "film_x"), OPTIONAL, FINITE,
         "deformation modes, only for deformation = independent"),
    REAL("pressure_singular_values", ON("pressure_singular_value"), OWN, NOT_NEGATIVE,
         "singular values of the pressure snapshots, descending"),
    REAL("deformation_singular_values", ON("deformation_singular_value"), OPTIONAL, NOT_NEGATIVE,
         "singular values of the deformation snapshots, descending"),
    REAL("weight", ON("y", "x"), ALWAYS, POSITIVE,
         "diagonal D that weights the residual in the test basis"),
    STATE_FIELDS,
    {0}};

static const artefact_field basis_attributes[] = {
    GRID_ATTRIBUTES(NULL),
    TRANSPORT_ATTRIBUTE,
    HALF_ATTRIBUTE,
    DEFORMATION_ATTRIBUTE,
    REAL("pressure_energy_discarded", ROOT, OWN, ANY,
         "part of the squared singular values of the pressure left out"),
    REAL("deformation_energy_discarded", ROOT, OPTIONAL, ANY,
         "part of the squared singular values of the deformation left out"),
    {0}};

SCHEMA(basis, 2, 7, "Reduced bases of an elastohydrodynamic contact");

// ---- part

static const artefact_axis part_axes[] = {Y_AXIS, X_AXIS, PRESSURE_MODE_AXIS, STATE_AXIS, {0}};

static const artefact_field part_fields[] = {
    REAL("pressure_basis", ON("pressure_mode", "y", "x"), ALWAYS, FINITE,
         "pressure modes of the part, of length 1 and orthogonal"),
    REAL("pressure_singular_values", ON("pressure_mode"), ALWAYS, NOT_NEGATIVE,
         "singular values of its snapshots, descending"),
    STATE_PRESSURE_FIELD,
    STATE_OTHER_FIELDS,
    {0}};

static const artefact_field part_attributes[] = {
    GRID_ATTRIBUTES(NULL),
    TRANSPORT_ATTRIBUTE,
    HALF_ATTRIBUTE,
    REAL("energy", ROOT, ALWAYS, POSITIVE, "sum of the squares of the snapshots, at all nodes"),
    REAL("energy_discarded", ROOT, ALWAYS, NOT_NEGATIVE,
         "part of it that the squared distances of the snapshots from the modes have at most"),
    INTEGER("num_snapshots", ROOT, OWN, COUNT, "number of the snapshots"),
    INTEGER("num_left_out", ROOT, OWN, COUNT,
            "number of states that had not converged, and are not in the file"),
    {0}};

SCHEMA(part, 1, 2, "Compressed part of a training of an elastohydrodynamic contact");

// ---- residuals

static const artefact_axis residuals_axes[] = {
    AXIS("iteration", MAX_ITERATIONS,
         "index of the Newton iteration, over all stationary states, then of the compressed ones "
         "of trajectories"),
    Y_AXIS,
    X_AXIS,
    STATE_AXIS,
    {0}};

static const artefact_field residuals_fields[] = {
    REAL("weighted_residual", ON("iteration", "y", "x"), ALWAYS, FINITE,
         "weighted residual D f of the Reynolds rows"),
    REAL("weighted_jacobian_step", ON("iteration", "y", "x"), ALWAYS, FINITE,
         "weighted product D J dz of Jacobian and Newton step"),
    INTEGER("iteration_state", ON("iteration"), OWN, STATE_OR_NONE,
            "index of the state that the iteration belongs to, -1 for a compressed one of "
            "trajectories, which serves in place of many"),
    INTEGER("state_exit_node", ON("state", "y"), ALWAYS, COLUMN,
            "index into x of the first node without pressure at the end of the state's iteration"),
    REAL("state_moes_M", ON("state"), OWN, POSITIVE, "Moes load number M of the states"),
    REAL("state_alpha_p_H", ON("state"), OWN, NOT_NEGATIVE,
         "pressure-viscosity coefficient times Hertz pressure of the states"),
    REAL("state_central_film_thickness", ON("state"), OWN, ANY,
         "film thickness H at X = 0 by the projected system"),
    INTEGER("status", ON("state"), OWN, ANY, "0 converged, 1 not converged"),
    INTEGER("newton_iterations", ON("state"), OWN, ANY, "Newton iterations that the state took"),
    {0}};

static const artefact_field residuals_attributes[] = {
    GRID_ATTRIBUTES(NULL),
    HALF_ATTRIBUTE,
    DEFORMATION_ATTRIBUTE,
    BASIS_ATTRIBUTE,
    INTEGER("compressed_iterations", ROOT, OPTIONAL, COUNT,
            "number of Newton iterations of all trajectories"),
    REAL("compressed_energy_discarded", ROOT, OPTIONAL, ANY,
         "part of the squared singular values that their compression left out, at most"),
    {0}};

SCHEMA(residuals, 2, 2, "Residuals and Newton steps of a reduced elastohydrodynamic contact");

// ---- model

static const artefact_axis model_axes[] = {
    Y_AXIS,
    X_AXIS,
    FILM_Y_AXIS,
    FILM_X_AXIS,
    AXIS("row", MAX_ROWS, "index of the selected row, in order of selection"),
    AXIS("needed_node", MAX_NODES,
         "index of the film node whose pressure and film the selected rows need"),
    AXIS("band_node", MAX_NODES, "index of the film node, counted from the first of the exit band"),
    AXIS("control", MAX_ROWS, "index of the control row, in order of choice"),
    AXIS("control_node", MAX_NODES,
         "index of the film node whose pressure and film the control rows need"),
    AXIS("jacobian_mode", MAX_MODES,
         "index of the mode of the weighted Jacobian products, strongest first"),
    AXIS("cubature", MAX_NODES, "index of the film node at which shear stresses are evaluated"),
    PRESSURE_MODE_AXIS,
    DEFORMATION_MODE_AXIS,
    STATE_AXIS,
    AXIS("position", MAX_MODES, "index of the measured size of the model, smallest first"),
    AXIS("quantile", MAX_FEW, "part of the scenes that deviate by no more: median, 95 %, worst"),
    AXIS("part", MAX_FEW, "part of the scenes that indicate no more: 5 %, median, 90 %, 95 %"),
    AXIS("bounded", MAX_FEW,
         "what is indicated: central film, minimum film, central pressure, exit position, load, "
         "pressure, film, friction; of a model of before schema 2.6 without the last"),
    AXIS("part_in_time", MAX_FEW, "part of the trajectories that indicate no more"),
    AXIS("shown", MAX_STATES, "index of the scene or trajectory of the calibration"),
    {0}};

/* Deviations at each model size: quantiles over the scenes that the model solved. */
#define DEVIATION(quantity, what)                                                                  \
    REAL("deviation_" quantity, ON("position", "quantile"), OPTIONAL, BOUND,                       \
         "deviation from the full model: " what)

/* Largest deviation at each model size, over all trajectories. */
#define WORST_IN_TIME(quantity, what)                                                              \
    REAL("worst_in_time_" quantity, ON("position"), OPTIONAL, BOUND,                               \
         "largest relative deviation from the full model with the same time steps: " what)

// modes at a set of film nodes; `first` names the node at which coupled modes are cut
#define BASES_AT(prefix, axis, need, where, first)                                                 \
    REAL(prefix "_pressure_basis", ON(axis, "pressure_mode"), need, FINITE,                        \
         "pressure modes " where),                                                                 \
        REAL(prefix "_deformation_basis", ON(axis, "deformation_mode"), OPTIONAL, FINITE,          \
             "deformation modes " where ", only for deformation = independent"),                   \
        REAL(prefix "_coupled_basis", ON(axis, "pressure_mode"), OPTIONAL, FINITE,                 \
             "deflection " where " of the pressure modes cut at " first                            \
             ", only for deformation = coupled")

/* Numbers from which the error of each model size is estimated. */
#define ESTIMATE(name, long_name) REAL(name, ON("position"), OPTIONAL, NOT_NEGATIVE, long_name)

static const artefact_field model_fields[] = {
    INTEGER("selected_row", ON("row"), ALWAYS, ROW,
            "index of the selected Reynolds rows: into x or, of a point contact, into all nodes of "
            "y and x, the lines of y one after the other"),
    REAL("row_weight", ON("row"), ALWAYS, POSITIVE,
         "weight of the selected rows: D times their factor in the least squares"),
    REAL("row_factor", ON("row"), OPTIONAL, POSITIVE,
         "that factor; a part of the rows or modes has factors of its own"),
    REAL("row_jacobian_modes", ON("row", "jacobian_mode"), OPTIONAL, FINITE,
         "modes of the weighted Jacobian products at the selected rows, orthonormal over all rows; "
         "the factors of a part of the rows follow from them"),
    INTEGER("needed_node_index", ON("needed_node"), ALWAYS, FILM_NODE,
            "film nodes that are needed, ascending; film node k + 1 is index k of x, 0 and the "
            "last are the boundary nodes; of a point contact the film nodes of the lines of y, "
            "each with its two boundary nodes, follow one another, and there are boundary lines"),
    BASES_AT("needed", "needed_node", ALWAYS, "at the needed nodes", "the first band node"),
    BASES_AT("band", "band_node", ALWAYS, "in the exit band", "its first node"),
    REAL("band_projected_kernel", ON("band_node", "deformation_mode"), OPTIONAL, FINITE,
         "deflection of unit pressure at the band nodes, projected on the deformation modes"),
    INTEGER("band_line_begin", ON("y"), OPTIONAL, FILM_COLUMN,
            "first column of the exit band on each line, counted with the boundary node; this and "
            "the next three only of a point contact, whose band nodes go line after line"),
    INTEGER("band_line_end", ON("y"), OPTIONAL, FILM_COLUMN,
            "column behind the last one of the exit band"),
    INTEGER("band_line_least_exit", ON("y"), OPTIONAL, FILM_COLUMN,
            "first column at which the exit may lie"),
    INTEGER("band_line_most_exit", ON("y"), OPTIONAL, FILM_COLUMN,
            "last column at which the exit may lie"),
    INTEGER("control_row", ON("control"), OPTIONAL, ROW,
            "index, as in selected_row, of Reynolds rows that take no part in the solution; what "
            "they are left with indicates its deviation"),
    REAL("control_weight", ON("control"), OPTIONAL, POSITIVE, "weight D of the control rows"),
    INTEGER("control_node_index", ON("control_node"), OPTIONAL, FILM_NODE,
            "film nodes that the control rows need, ascending, as in needed_node_index"),
    BASES_AT("control", "control_node", OPTIONAL, "at these nodes", "the first band node"),
    REAL("elasticity_jacobian", ON("deformation_mode", "pressure_mode"), OPTIONAL, FINITE,
         "deflection of the pressure modes cut at the first band node, projected on the "
         "deformation modes"),
    REAL("load_jacobian", ON("pressure_mode"), ALWAYS, FINITE,
         "load of the pressure modes cut at the first band node"),
    INTEGER("cubature_node_index", ON("cubature"), OPTIONAL, FILM_NODE,
            "film nodes at which shear stresses are evaluated, ascending, as in needed_node_index; "
            "a model without them sums over the grid"),
    REAL("cubature_friction", ON("cubature"), OPTIONAL, NOT_NEGATIVE,
         "weights of the shear stresses at those of them with pressure, whose sum is the integral "
         "over the nodes with pressure"),
    REAL("cubature_dry", ON("cubature"), OPTIONAL, NOT_NEGATIVE,
         "the same of the mean over the dry contact"),
    BASES_AT("cubature", "cubature", OPTIONAL, "at these nodes", "the first band node"),
    REAL("moment_jacobian", ON("pressure_mode"), OPTIONAL, FINITE,
         "integral of pressure times X of the pressure modes cut at the first band node"),
    REAL("pressure_basis", ON("pressure_mode", "y", "x"), ALWAYS, FINITE, "pressure modes"),
    REAL("deformation_basis", ON("deformation_mode", "film_y", "film_x"), OPTIONAL, FINITE,
         "deformation modes, only for deformation = independent; for transient scenes"),
    STATE_FIELDS,
    REAL("sigma_min_by_exit", ON("state"), OPTIONAL, ANY,
         "smallest singular value of the sampled bases, leading modes and rows before the exit of "
         "the state"),
    INTEGER("position_pressure_modes", ON("position"), OPTIONAL, COUNT,
            "pressure modes in use; this and what follows only in a checked or calibrated model"),
    INTEGER("position_deformation_modes", ON("position"), OPTIONAL, COUNT,
            "deformation modes in use, 0 for deformation = coupled"),
    INTEGER("position_rows", ON("position"), OPTIONAL, COUNT, "rows in use"),
    DEVIATION("central_film_thickness", "central film thickness, relative"),
    DEVIATION("minimum_film_thickness", "minimum film thickness, relative"),
    DEVIATION("central_pressure", "central pressure, relative"),
    DEVIATION("pressure", "pressure P, largest of all nodes"),
    REAL("position_mean_iterations", ON("position"), OPTIONAL, BOUND,
         "Newton iterations of a scene in the mean"),
    REAL("position_most_iterations", ON("position"), OPTIONAL, BOUND,
         "Newton iterations of a scene at most"),
    QUANTITY("position_seconds", ON("position"), "s", OPTIONAL, BOUND,
             "median processor time of a solution, with the model open"),
    INTEGER("position_failures", ON("position"), OPTIONAL, COUNT,
            "scenes that did not converge or were not to be trusted; they count nowhere else"),
    ESTIMATE("indicator_factor", "factor of the indicated deviation of the central film thickness"),
    ESTIMATE(
        "indicator_factor_minimum",
        "factor of the indicated deviation of the minimum film thickness; where missing, the same"),
    REAL("position_largest_residual", ON("position"), OPTIONAL, NOT_NEGATIVE,
         "largest residual of the least squares that a scene ended with"),
    ESTIMATE("indicator_factor_central_pressure",
             "factor of the indicated deviation of the central pressure; here and in the next "
             "ones, where missing or 0, it is not indicated"),
    ESTIMATE("indicator_factor_exit_position", "the same of the exit position"),
    ESTIMATE("indicator_factor_load", "the same of the load, where the approach is given"),
    ESTIMATE("indicator_factor_pressure",
             "the same of the largest deviation of the pressure at any node"),
    ESTIMATE("indicator_factor_film",
             "the same of the largest deviation of the film at any node with pressure"),
    ESTIMATE("indicator_factor_friction",
             "the same of the friction force, by any law of shear stress"),
    REAL("indicator_share", ON("position", "bounded"), OPTIONAL, NOT_NEGATIVE,
         "part of the factor that holds for small bounds: of b, (share + growth b) b, offset + "
         "offset_share b, for a bound b, the least times the factor is indicated; where one of "
         "these is missing, b times the factor"),
    REAL("indicator_growth", ON("position", "bounded"), OPTIONAL, NOT_NEGATIVE,
         "by which that part grows with the bound"),
    REAL("indicator_offset", ON("position", "bounded"), OPTIONAL, NOT_NEGATIVE,
         "where exits are nodes, else 0"),
    REAL("indicator_offset_share", ON("position", "bounded"), OPTIONAL, NOT_NEGATIVE,
         "where exits are nodes, else 1"),
    REAL("indicated_deviation", ON("position", "part"), OPTIONAL, BOUND,
         "the larger of both films' with the factors for all bounds; infinite for a scene that was "
         "not solved"),
    REAL("indicator_effectivity", ON("position", "part"), OPTIONAL, BOUND,
         "indicated over true deviation, of the film of which that is less"),
    ESTIMATE("indicator_factor_in_time",
             "factor of what is indicated in time of the central film thickness, and of the "
             "minimum film thickness by errors that come with the fluid"),
    ESTIMATE("indicator_factor_in_time_minimum",
             "factor of what is indicated in time of the minimum film thickness by rows and exit"),
    ESTIMATE("indicator_floor_in_time",
             "deviation that is indicated in time of the central film thickness at least"),
    ESTIMATE("indicator_floor_in_time_minimum",
             "deviation that is indicated in time of the minimum film thickness at least"),
    REAL("indicated_in_time", ON("position", "part_in_time"), OPTIONAL, BOUND,
         "largest deviation of both films that is indicated in these trajectories, 1 where they "
         "are lost"),
    WORST_IN_TIME("central_film_thickness", "central film thickness"),
    WORST_IN_TIME("minimum_film_thickness", "minimum film thickness"),
    WORST_IN_TIME("central_pressure", "central pressure"),
    REAL("position_step_iterations", ON("position"), OPTIONAL, BOUND,
         "Newton iterations of a step of a trajectory in the mean"),
    QUANTITY("position_step_seconds", ON("position"), "s", OPTIONAL, BOUND,
             "processor time of a step in the mean"),
    INTEGER("position_lost_trajectories", ON("position"), OPTIONAL, COUNT,
            "trajectories with a step that did not converge or was not to be trusted; they count "
            "nowhere else"),
    REAL("shown_alpha_p_H", ON("shown"), OPTIONAL, NOT_NEGATIVE,
         "pressure-viscosity coefficient times Hertz pressure of the scenes that the sizes were "
         "measured on; this and the next four say of which lubricants estimates are known, besides "
         "those of the training"),
    RISE_FIELDS("shown_", "shown"),
    INTEGER("shown_in_time", ON("shown"), OPTIONAL, COUNT,
            "1: a trajectory, 0: a stationary scene"),
    {0}};

static const artefact_field model_attributes[] = {
    GRID_ATTRIBUTES(NULL),
    TRANSPORT_ATTRIBUTE,
    HALF_ATTRIBUTE,
    DEFORMATION_ATTRIBUTE,
    INTEGER("band_begin", ROOT, ALWAYS, ANY,
            "first film node of the exit band, of a line contact; so are the next two"),
    INTEGER("least_exit", ROOT, ALWAYS, ANY, "first film node at which the exit may lie"),
    INTEGER("most_exit", ROOT, ALWAYS, ANY, "last film node at which the exit may lie"),
    INTEGER("first_minimum_line", ROOT, OPTIONAL, COUNT,
            "first line of the grid, boundary lines counted, on which the film minimum is sought; "
            "this and the next one only of a point contact"),
    INTEGER("last_minimum_line", ROOT, OPTIONAL, COUNT, "last of these lines"),
    TEXT("method", OWN, "method of row selection; given: the rows are somebody else's"),
    TEXT("weights", OPTIONAL,
         "method of the rows' factors; missing where these are somebody else's"),
    REAL("sigma_min_residual", ROOT, OWN, ANY,
         "smallest singular value of the sampled residual basis"),
    REAL("sigma_min_jacobian", ROOT, OWN, ANY,
         "smallest singular value of the sampled Jacobian basis"),
    REAL("sigma_min_over_exits", ROOT, OWN, ANY,
         "smallest of both over all exits seen in training"),
    REAL("stability", ROOT, OPTIONAL, ANY,
         "largest 1/sigma_min of both over these exits, of modes orthonormal over all rows before "
         "the exit"),
    BASIS_ATTRIBUTE,
    INTEGER("calibration_scenes", ROOT, OPTIONAL, COUNT,
            "scenes that each position was measured on, none of them a training solution"),
    INTEGER("calibration_trajectories", ROOT, OPTIONAL, COUNT,
            "trajectories that each position was measured on"),
    {0}};

SCHEMA(model, 2, 9, "Reduced model of an elastohydrodynamic contact");

// ---- cases

static const artefact_scale film_of_case = {{NULL, NULL}, "film_unit"},
                            length_of_case = {{NULL, NULL}, "half_width"},
                            pressure_of_case = {{NULL, NULL}, "hertz_pressure"};

static const artefact_axis cases_axes[] = {
    AXIS("case", MAX_STATES, "index of the row of the table that the scene comes from"), {0}};

static const artefact_field cases_fields[] = {
    INTEGER("status", ON("case"), ALWAYS, ANY, "0 converged, 1 not converged, 4 not to be trusted"),
    REAL("moes_M", ON("case"), OWN, POSITIVE, "Moes load number M"),
    REAL("moes_L", ON("case"), OWN, NOT_NEGATIVE, "Moes material number L"),
    REAL("alpha_p_H", ON("case"), OWN, NOT_NEGATIVE,
         "pressure-viscosity coefficient times Hertz pressure"),
    QUANTITY("hertz_pressure", ON("case"), "Pa", OWN, NOT_NEGATIVE, "Hertz pressure"),
    QUANTITY("half_width", ON("case"), "m", OPTIONAL, ANY,
             "half width a of the dry contact; this and the next five NaN where a scene is not "
             "given in SI units, and not there where none is"),
    QUANTITY("film_unit", ON("case"), "m", OPTIONAL, ANY,
             "a^2/R, which H = 1 and an approach of 1 stand for"),
    QUANTITY("line_load", ON("case"), "N m-1", OPTIONAL, ANY, "load of a line contact"),
    QUANTITY("point_load", ON("case"), "N", OPTIONAL, ANY, "load of a point contact"),
    QUANTITY("radius", ON("case"), "m", OPTIONAL, ANY, "reduced radius R"),
    QUANTITY("speed", ON("case"), "m s-1", OPTIONAL, ANY, "mean speed of both surfaces"),
    REAL("thermal_loading", ON("case"), OPTIONAL, ANY,
         "thermal loading parameter of the inlet, of scenes with the lubricant's conductivity"),
    REAL("inlet_heating_factor", ON("case"), OPTIONAL, ANY,
         "factor by which shear heating of the inlet thins the films, which are isothermal here; "
         "NaN where its formula does not hold"),
    SCALED("central_film_thickness", ON("case"), &film_of_case, OWN, ANY,
           "film thickness H at X = 0 (Y = 0); this and all that follow up to the indicated "
           "deviations NaN where the scene did not converge"),
    SCALED("minimum_film_thickness", ON("case"), &film_of_case, OWN, ANY,
           "smallest film thickness H"),
    SCALED("central_pressure", ON("case"), &pressure_of_case, OWN, ANY,
           "pressure P at X = 0 (Y = 0)"),
    SCALED("peak_pressure", ON("case"), &pressure_of_case, OWN, ANY,
           "largest pressure P at the nodes that the solution looks at"),
    SCALED("rigid_approach", ON("case"), &film_of_case, OWN, ANY, "rigid approach H0"),
    SCALED("exit_position", ON("case"), &length_of_case, OWN, ANY,
           "X at which the pressure ends, at Y = 0"),
    REAL("indicated_deviation", ON("case"), OWN, ANY,
         "indicated relative deviation of the central film thickness from the full model; NaN "
         "where it cannot be told"),
    REAL("indicated_deviation_minimum", ON("case"), OWN, ANY,
         "the same of the minimum film thickness"),
    REAL("friction_coefficient", ON("case"), OPTIONAL, ANY,
         "friction over the load, positive where surface 1 is the faster one; this and the next "
         "eleven NaN where a scene does not slide or did not converge, and not there where none "
         "does"),
    LINE_AND_POINT("friction_force", ON("case"), "N m-1", "N", ANY,
                   "friction of a line contact: on surface 2 along X, on surface 1 against it"),
    LINE_AND_POINT("power_loss", ON("case"), "W m-1", "W", ANY,
                   "power that both surfaces put into the film of a line contact"),
    LINE_AND_POINT("rolling_resistance", ON("case"), "N m-1", "N", ANY,
                   "rolling resistance of a line contact, on either surface against X"),
    LINE_AND_POINT("rolling_moment", ON("case"), "N", "N m", ANY,
                   "moment of the pressures of a line contact against the rolling"),
    QUANTITY("mean_shear_stress", ON("case"), "Pa", OPTIONAL, ANY,
             "magnitude of the shear stress of the sliding, mean over the dry contact"),
    QUANTITY("largest_shear_stress", ON("case"), "Pa", OPTIONAL, ANY,
             "the largest of it, at the nodes that the solution looks at"),
    REAL("indicated_deviation_friction", ON("case"), OPTIONAL, ANY,
         "indicated relative deviation of the friction force from the full model"),
    INTEGER("part", ON("case"), OPTIONAL, ANY,
            "of a list of models which of them has solved it, from 0 in its order; models of a "
            "flat file count each"),
    INTEGER("newton_iterations", ON("case"), OWN, ANY, "iterations that the solution took"),
    REAL("residual_norm", ON("case"), OWN, ANY, "norm of the residual when the iteration ended"),
    QUANTITY("solve_seconds", ON("case"), "s", OWN, ANY, "time of the solution"),
    {0}};

static const artefact_field cases_attributes[] = {GRID_ATTRIBUTES(NULL), {0}};

SCHEMA(cases, 1, 4, "Solutions of many elastohydrodynamic contacts");

const artefact_schema *const artefact_schemas[] = {
    &schema_result,    &schema_snapshots, &schema_basis, &schema_part,
    &schema_residuals, &schema_model,     &schema_cases, NULL};
