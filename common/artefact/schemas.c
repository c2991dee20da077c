/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists what each kind of file holds: one line per field. After a change of this list, update the
 * pages in schemas/ as tests/unit/test_schemas.c describes. */
#include "common/artefact/artefact.h"

#define AXIS(name, units, max, long_name)                                                          \
    { name, units, long_name, max, false, NULL }
#define REAL(name, units, need, values, long_name, ...)                                            \
    { name, ARTEFACT_REAL, {__VA_ARGS__}, units, long_name, need, values, false, NULL }
// a dimensionless real number with a scale for SI units
#define SCALED(name, scale, need, values, long_name, ...)                                          \
    { name, ARTEFACT_REAL, {__VA_ARGS__}, "1", long_name, need, values, false, &(scale) }
#define INTEGER(name, need, values, long_name, ...)                                                \
    { name, ARTEFACT_INTEGER, {__VA_ARGS__}, "1", long_name, need, values, false, NULL }
#define ATTRIBUTE(name, type, units, need, values, long_name)                                      \
    { name, type, units, long_name, need, values, NULL }
// a field of a result with one entry per point in time, which is read entry by entry
#define ENTRIES(name, scale, long_name)                                                            \
    {                                                                                              \
        name, ARTEFACT_REAL, {"time", "y", "x"}, "1", long_name, NEED_OPTIONAL, VALUES_ANY, true,  \
            &(scale)                                                                               \
    }

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
    AXIS("x", "1", MAX_X,                                                                          \
         "inner nodes along the sliding direction, in Hertz contact half widths of the reference")
#define Y_AXIS                                                                                     \
    {                                                                                              \
        "y", "1",                                                                                  \
            "lines of inner nodes across the sliding direction, in Hertz contact half widths of "  \
            "the reference; of a point contact",                                                   \
            MAX_Y, true, NULL                                                                      \
    }
#define FILM_X_AXIS                                                                                \
    AXIS("film_x", "1", MAX_X + 2, "nodes of the film: x and one boundary node at either end")
#define FILM_Y_AXIS                                                                                \
    {                                                                                              \
        "film_y", "1",                                                                             \
            "lines of the film: y and the boundary lines beside it, of which a half domain has "   \
            "one; of a point contact",                                                             \
            MAX_Y + 2, true, NULL                                                                  \
    }
#define STATE_AXIS AXIS("state", "1", MAX_STATES, "index of the training solution")
#define PRESSURE_MODE_AXIS                                                                         \
    AXIS("pressure_mode", "1", MAX_MODES, "index of the pressure mode, strongest first")
#define DEFORMATION_MODE_AXIS                                                                      \
    AXIS("deformation_mode", "1", MAX_MODES, "index of the deformation mode, strongest first")

// `scale` converts the lengths of the grid to SI units; NULL: no scale
#define GRID_ATTRIBUTES(kinds, scale)                                                              \
    ATTRIBUTE("contact", ARTEFACT_TEXT, "1", NEED_ALWAYS, VALUES_ANY, "kind of contact: " kinds),  \
        {"x_min", ARTEFACT_REAL, "1", "first node of x", NEED_ALWAYS, VALUES_FINITE, scale},       \
        {"step",      ARTEFACT_REAL,   "1",  "distance between the nodes of x",                    \
         NEED_ALWAYS, VALUES_POSITIVE, scale},                                                     \
        ATTRIBUTE("discretization", ARTEFACT_TEXT, "1", NEED_OPTIONAL, VALUES_ANY,                 \
                  "of the equations on the grid: accurate, cross-flux or published; published "    \
                  "where missing"),                                                                \
        ATTRIBUTE(                                                                                 \
            "boundary", ARTEFACT_TEXT, "1", NEED_OPTIONAL, VALUES_ANY,                             \
            "what lies around the grid of a point contact: open, the far field, or zero, no "      \
            "pressure; zero where missing"),                                                       \
        ATTRIBUTE("ellipticity", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_POSITIVE,               \
                  "b/a of an ellipse, the half width across over that along, by which y and x "    \
                  "are scaled; needed there")
#define TRANSPORT_ATTRIBUTE                                                                        \
    ATTRIBUTE("transport", ARTEFACT_TEXT, "1", NEED_OPTIONAL, VALUES_ANY,                          \
              "how films are carried on the trajectories of the training: upwind or path; where "  \
              "missing there are none, or upwind"),                                                \
        ATTRIBUTE(                                                                                 \
            "smoothing", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,                            \
            "transient.smoothing of these trajectories, in half widths; where missing it is "      \
            "not known, or films are not carried along their paths")
#define HALF_ATTRIBUTE                                                                             \
    ATTRIBUTE(                                                                                     \
        "half", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_FLAG,                                 \
        "1: y starts at 0, on the mirror line of a point contact that is symmetric across; 0 "     \
        "where missing")
#define DEFORMATION_ATTRIBUTE                                                                      \
    ATTRIBUTE("deformation", ARTEFACT_TEXT, "1", NEED_ALWAYS, VALUES_ANY,                          \
              "deformation basis: independent (of its own) or coupled (deflections of the "        \
              "pressure modes)")
#define BASIS_ATTRIBUTE                                                                            \
    ATTRIBUTE("basis_sha256", ARTEFACT_TEXT, "1", NEED_OWN, VALUES_ANY,                            \
              "identity of the basis file")

// estimates of the errors that the grid causes in a state
#define EFFECT_FIELDS(prefix)                                                                      \
    REAL(prefix "step_effect", "1", NEED_OPTIONAL, VALUES_ANY,                                     \
         "error estimate of the central film by the step, relative; this and the next five are "   \
         "not negative, infinite where the grid is too coarse to tell, NaN where not known",       \
         "state"),                                                                                 \
        REAL(prefix "inlet_effect", "1", NEED_OPTIONAL, VALUES_ANY,                                \
             "error estimate of the central film by the length of the inlet or domain", "state"),  \
        REAL(prefix "step_effect_minimum", "1", NEED_OPTIONAL, VALUES_ANY,                         \
             "the first of the minimum film", "state"),                                            \
        REAL(prefix "inlet_effect_minimum", "1", NEED_OPTIONAL, VALUES_ANY,                        \
             "the second of the minimum film", "state"),                                           \
        REAL(prefix "step_effect_rolling", "1", NEED_OPTIONAL, VALUES_ANY,                         \
             "the first of the rolling resistance", "state"),                                      \
        REAL(prefix "inlet_effect_rolling", "1", NEED_OPTIONAL, VALUES_ANY,                        \
             "the second of the rolling resistance", "state")

// fields that describe a lubricant
#define RISE_FIELDS(prefix, axis)                                                                  \
    REAL(prefix "viscosity_rise", "1", NEED_OPTIONAL, VALUES_KNOWN,                                \
         "logarithm of the viscosity at the Hertz pressure over that at zero; NaN where not "      \
         "known",                                                                                  \
         axis),                                                                                    \
        REAL(prefix "density_rise", "1", NEED_OPTIONAL, VALUES_KNOWN, "the same of the density",   \
             axis),                                                                                \
        REAL(prefix "viscosity_rise_half", "1", NEED_OPTIONAL, VALUES_KNOWN,                       \
             "the first at half the Hertz pressure", axis)

#define THINNING_FIELD(prefix)                                                                     \
    REAL(                                                                                          \
        prefix "thinning", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,                                \
        "Newtonian shear stress of the sliding over Eyring's stress, of the viscosity at zero "    \
        "pressure in a film H = 1, where the sliding thins the flow of the film; 0 where missing", \
        "state"),                                                                                  \
        REAL(prefix "gradient_thinning", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,                  \
             "h/(2 tau0) dp/dx with Eyring's stress tau0 in a film H = 1 where dP/dX = 1, where "  \
             "the flow is thinned; 0 where missing",                                               \
             "state")

// training solutions in the coordinates of a basis
#define STATE_PRESSURE_FIELD                                                                       \
    REAL("state_pressure", "1", NEED_ALWAYS, VALUES_FINITE,                                        \
         "coordinates of the training pressures in the pressure basis", "state", "pressure_mode")
#define STATE_DEFORMATION_FIELD                                                                    \
    REAL("state_deformation", "1", NEED_OPTIONAL, VALUES_FINITE,                                   \
         "coordinates of the training deformations in the deformation basis", "state",             \
         "deformation_mode")
#define STATE_OTHER_FIELDS                                                                         \
    REAL("state_rigid_approach", "1", NEED_ALWAYS, VALUES_FINITE,                                  \
         "rigid approach H0 of the training solutions", "state"),                                  \
        INTEGER(                                                                                   \
            "state_exit_node", NEED_ALWAYS, VALUES_COLUMN,                                         \
            "index into x of the first node without pressure, length of x where there is none",    \
            "state", "y"),                                                                         \
        REAL("state_moes_M", "1", NEED_ALWAYS, VALUES_POSITIVE,                                    \
             "Moes load number M of the training solutions", "state"),                             \
        REAL("state_alpha_p_H", "1", NEED_ALWAYS, VALUES_NOT_NEGATIVE,                             \
             "pressure-viscosity coefficient times Hertz pressure of the training solutions",      \
             "state"),                                                                             \
        REAL("state_central_film_thickness", "1", NEED_OWN, VALUES_POSITIVE_OR_NAN,                \
             "film thickness H at X = 0 of the training solutions", "state"),                      \
        INTEGER(                                                                                   \
            "state_stationary", NEED_OPTIONAL, VALUES_FLAG,                                        \
            "1 for a stationary training solution, 0 for one on a trajectory; 1 where missing",    \
            "state"),                                                                              \
        REAL("state_rate", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,                                \
             "rate of change of the contact at the training solutions; 0 where missing", "state"), \
        REAL("state_load_rate", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,                           \
             "largest rate of change of ln a on their trajectories up to the training solutions; " \
             "as state_rate where missing",                                                        \
             "state"),                                                                             \
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
    {"time", "1", "dimensionless time T of the entries; 0 when stationary", MAX_TIMES, false,
     &time_scale},
    {"y", "1",
     "lines of inner nodes across the sliding direction, in Hertz contact half widths of the "
     "frame; "
     "of a point contact",
     MAX_Y, true, &place_across_in_frame},
    {"exit", "1",
     "index of the exit, the farthest downstream first; where the entrainment reverses", MAX_FEW,
     true, NULL},
    {"x", "1", "inner nodes along the sliding direction, in Hertz contact half widths of the frame",
     MAX_X, false, &place_in_frame},
    AXIS("restart_slot", "1", MAX_FEW, "index of the restart slot"),
    AXIS("restart_entry", "1", MAX_RESTART, "index of the number in a restart slot"),
    {0}};

static const artefact_field result_fields[] = {
    ENTRIES("pressure", pressure_in_frame, "pressure P, in Hertz pressures of the current frame"),
    ENTRIES("film_thickness", film_in_frame, "film thickness H in the current frame"),
    ENTRIES(
        "shear_stress_1", pressure_in_frame,
        "what the fluid does to surface 1 along X, in Hertz pressures of the current frame; where "
        "the scene gives a slide-roll ratio, 0 where there is no pressure"),
    ENTRIES("shear_stress_2", pressure_in_frame, "the same of surface 2"),
    SCALED("central_film_thickness", film_scale, NEED_ALWAYS, VALUES_ANY,
           "film thickness H at X = 0 (Y = 0) in the reference frame; while the bodies are apart, "
           "their gap, or NaN if the load is given",
           "time"),
    SCALED("minimum_film_thickness", film_scale, NEED_ALWAYS, VALUES_ANY,
           "smallest film thickness H in the reference frame: interpolated, with discretization = "
           "published at a node",
           "time"),
    SCALED("central_pressure", pressure_scale, NEED_OWN, VALUES_ANY,
           "pressure P at X = 0 (Y = 0) in the reference frame", "time"),
    SCALED("rigid_approach", film_scale, NEED_ALWAYS, VALUES_ANY,
           "rigid approach H0 in the reference frame", "time"),
    SCALED("load", load_scale, NEED_OWN, VALUES_ANY,
           "load relative to the reference load; 0 while the bodies are apart", "time"),
    SCALED("contact_half_width", length_scale, NEED_OWN, VALUES_ANY,
           "half width that scales the frame, relative to the reference; where the approach is "
           "given, of the expected load",
           "time"),
    SCALED("frame_hertz_pressure", pressure_scale, NEED_OPTIONAL, VALUES_ANY,
           "Hertz pressure that scales the frame, relative to the reference", "time"),
    SCALED("frame_film_unit", film_scale, NEED_OPTIONAL, VALUES_ANY,
           "a^2/R that scales the frame, relative to the reference", "time"),
    SCALED("surface_position", length_scale, NEED_OPTIONAL, VALUES_ANY,
           "X in the reference frame of what the scene's surface has: the end of a waviness, the "
           "middle of a dent, x = 0 of a table",
           "time"),
    SCALED("exit_position", length_scale, NEED_OWN, VALUES_ANY,
           "X at which the pressure ends, where the entrainment reverses of each of its intervals; "
           "NaN "
           "where there is none",
           "time", "y", "exit"),
    REAL(
        "friction_coefficient", "1", NEED_OPTIONAL, VALUES_ANY,
        "friction over the load, positive where surface 1 is the faster one; this and the next six "
        "where the scene gives a slide-roll ratio",
        "time"),
    SCALED("friction_force", load_scale, NEED_OPTIONAL, VALUES_ANY,
           "integral of the shear stress in the middle of the film, over the reference load: on "
           "surface 2 along X, on surface 1 against it",
           "time"),
    SCALED("rolling_resistance", load_scale, NEED_OPTIONAL, VALUES_ANY,
           "integral of h/2 dp/dx, over the reference load: on either surface against X", "time"),
    SCALED("rolling_moment", moment_scale, NEED_OPTIONAL, VALUES_ANY,
           "moment of the pressure against the rolling, over reference load and half width",
           "time"),
    SCALED("power_loss", power_scale, NEED_OPTIONAL, VALUES_ANY,
           "power that both surfaces put into the film, over reference load and mean speed",
           "time"),
    SCALED("mean_shear_stress", pressure_scale, NEED_OPTIONAL, VALUES_ANY,
           "mean of the magnitude of the shear stress in the middle of the film over the dry "
           "contact, in reference Hertz pressures",
           "time"),
    SCALED("largest_shear_stress", pressure_scale, NEED_OPTIONAL, VALUES_ANY,
           "largest magnitude of that stress", "time"),
    INTEGER("newton_iterations", NEED_OWN, VALUES_ANY, "Newton iterations that the entry took",
            "time"),
    REAL("residual_norm", "1", NEED_OWN, VALUES_ANY,
         "norm of the residual when the iteration ended", "time"),
    REAL("indicated_deviation", "1", NEED_OPTIONAL, VALUES_ANY,
         "indicated relative deviation of the central film thickness from the full model, in time "
         "with the same steps; NaN where it cannot be told",
         "time"),
    REAL("indicated_deviation_minimum", "1", NEED_OPTIONAL, VALUES_ANY,
         "the same of the minimum film thickness", "time"),
    REAL("indicated_deviation_central_pressure", "1", NEED_OPTIONAL, VALUES_ANY,
         "the same of the central pressure; stationary", "time"),
    SCALED("indicated_deviation_exit_position", length_scale, NEED_OPTIONAL, VALUES_ANY,
           "indicated deviation of the exit position, in half widths; stationary lines whose exit "
           "lies "
           "within a node",
           "time"),
    REAL("indicated_deviation_load", "1", NEED_OPTIONAL, VALUES_ANY,
         "indicated deviation of the load, over the reference; stationary", "time"),
    SCALED(
        "indicated_deviation_pressure", pressure_scale, NEED_OPTIONAL, VALUES_ANY,
        "indicated largest deviation of the pressure at any node, in Hertz pressures; stationary",
        "time"),
    REAL("indicated_deviation_film", "1", NEED_OPTIONAL, VALUES_ANY,
         "indicated largest deviation of the film thickness at any node with pressure, over the "
         "central film thickness; stationary",
         "time"),
    REAL("indicated_deviation_friction", "1", NEED_OPTIONAL, VALUES_ANY,
         "indicated relative deviation of the friction force, by the law of the scene; stationary",
         "time"),
    INTEGER("status", NEED_OWN, VALUES_ANY, "0 converged, 1 not converged, 4 not to be trusted",
            "time"),
    INTEGER(
        "by_full_model", NEED_OPTIONAL, VALUES_FLAG,
        "1 solved by the full model, since the reduced one was not good enough, 0 by the reduced "
        "one; only with romrun --fallback full",
        "time"),
    SCALED("time_step", time_scale, NEED_OPTIONAL, VALUES_ANY,
           "step in T that led to the entry, 0 at the start; only when transient", "time"),
    REAL("time_effect", "1", NEED_OPTIONAL, VALUES_ANY,
         "estimated relative change of the central film by ever smaller steps in time; NaN where "
         "it cannot be told; only when transient",
         "time"),
    REAL("time_effect_minimum", "1", NEED_OPTIONAL, VALUES_ANY, "the same of the minimum film",
         "time"),
    REAL("restart", "1", NEED_OPTIONAL, VALUES_ANY,
         "what the program that wrote the file needs to resume it, only when transient",
         "restart_slot", "restart_entry"),
    INTEGER("restart_entries", NEED_OPTIONAL, VALUES_ANY,
            "number of entries of time after which the slot resumes, -1 while it is not valid",
            "restart_slot"),
    {0}};

static const artefact_attribute result_attributes[] = {
    GRID_ATTRIBUTES("line, point or ellipse", &length_scale),
    ATTRIBUTE("hertz_pressure", ARTEFACT_REAL, "Pa", NEED_ALWAYS, VALUES_NOT_NEGATIVE,
              "Hertz pressure of the reference"),
    ATTRIBUTE("moes_M", ARTEFACT_REAL, "1", NEED_ALWAYS, VALUES_POSITIVE,
              "Moes load number M of the reference"),
    ATTRIBUTE("moes_L", ARTEFACT_REAL, "1", NEED_OWN, VALUES_NOT_NEGATIVE,
              "Moes material number L of the reference"),
    ATTRIBUTE("alpha_p_H", ARTEFACT_REAL, "1", NEED_ALWAYS, VALUES_NOT_NEGATIVE,
              "pressure-viscosity coefficient times Hertz pressure"),
    ATTRIBUTE("half_width", ARTEFACT_REAL, "m", NEED_OPTIONAL, VALUES_POSITIVE,
              "half width a of the reference, which X = 1 stands for; this and the next five of a "
              "contact given in SI units"),
    ATTRIBUTE("half_width_across", ARTEFACT_REAL, "m", NEED_OPTIONAL, VALUES_POSITIVE,
              "b of an ellipse, which Y = 1 stands for; of a point contact that is half_width"),
    ATTRIBUTE("film_unit", ARTEFACT_REAL, "m", NEED_OPTIONAL, VALUES_POSITIVE,
              "a^2/R of the reference, which H = 1 and an approach of 1 stand for"),
    ATTRIBUTE("time_unit", ARTEFACT_REAL, "s", NEED_OPTIONAL, VALUES_POSITIVE,
              "a/u of the reference, u the mean of both surfaces' speeds, which T = 1 stands for"),
    ATTRIBUTE("line_load", ARTEFACT_REAL, "N m-1", NEED_OPTIONAL, VALUES_POSITIVE,
              "load of the reference, which a load of 1 stands for; of a line contact"),
    ATTRIBUTE("point_load", ARTEFACT_REAL, "N", NEED_OPTIONAL, VALUES_POSITIVE,
              "the same of a point contact"),
    ATTRIBUTE(
        "line_moment", ARTEFACT_REAL, "N", NEED_OPTIONAL, VALUES_POSITIVE,
        "load times half width, which a rolling moment of 1 stands for; of a line contact, this "
        "and the next three where the scene gives a slide-roll ratio"),
    ATTRIBUTE("point_moment", ARTEFACT_REAL, "N m", NEED_OPTIONAL, VALUES_POSITIVE,
              "the same of a point contact"),
    ATTRIBUTE("line_power", ARTEFACT_REAL, "W m-1", NEED_OPTIONAL, VALUES_POSITIVE,
              "load times mean speed, which a power loss of 1 stands for; of a line contact"),
    ATTRIBUTE("point_power", ARTEFACT_REAL, "W", NEED_OPTIONAL, VALUES_POSITIVE,
              "the same of a point contact"),
    ATTRIBUTE("slide_roll", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,
              "slide-roll ratio (u1 - u2)/u_m, where the scene gives one"),
    ATTRIBUTE("thinning", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
              "Newtonian shear stress of the sliding over Eyring's stress, of the viscosity at "
              "zero pressure in a film H = 1; where the sliding thins the flow of the film"),
    ATTRIBUTE(
        "gradient_thinning", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
        "h/(2 tau0) dp/dx with Eyring's stress tau0 in a film H = 1 where dP/dX = 1, where the "
        "flow is thinned"),
    ATTRIBUTE("thermal_loading", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_POSITIVE,
              "thermal loading parameter of the inlet, eta0 beta u^2/k; of a scene that gives the "
              "lubricant's conductivity, when stationary"),
    ATTRIBUTE("inlet_heating_factor", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_POSITIVE,
              "factor by which shear heating of the inlet thins the films, which are isothermal "
              "here; not where its formula does not hold"),
    ATTRIBUTE("solve_seconds", ARTEFACT_REAL, "s", NEED_OWN, VALUES_ANY,
              "time of the solution, without reading and writing"),
    ATTRIBUTE("solve_seconds_rows", ARTEFACT_REAL, "s", NEED_OPTIONAL, VALUES_ANY,
              "part of it for residual and Jacobian rows"),
    ATTRIBUTE("solve_seconds_linear", ARTEFACT_REAL, "s", NEED_OPTIONAL, VALUES_ANY,
              "part of it for linear systems"),
    ATTRIBUTE("solve_seconds_exit", ARTEFACT_REAL, "s", NEED_OPTIONAL, VALUES_ANY,
              "part of it for finding the exit"),
    ATTRIBUTE("solve_seconds_other", ARTEFACT_REAL, "s", NEED_OPTIONAL, VALUES_ANY,
              "the rest of it"),
    ATTRIBUTE(
        "inlet_effect", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,
        "error estimate of the central film by the length of the inlet, of a point contact of the "
        "domain, relative, when stationary; this and the next five are sizes without a sign, "
        "missing where the grid is too coarse to tell, and of a reduced solution interpolated "
        "between those of its training"),
    ATTRIBUTE("step_effect", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,
              "error estimate of the central film by the step"),
    ATTRIBUTE("inlet_effect_minimum", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,
              "the first of the minimum film"),
    ATTRIBUTE("step_effect_minimum", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,
              "the second of the minimum film"),
    ATTRIBUTE("inlet_effect_rolling", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,
              "the first of the rolling resistance and its moment"),
    ATTRIBUTE("step_effect_rolling", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,
              "the second of the rolling resistance and its moment"),
    ATTRIBUTE("observed_order", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,
              "order of convergence of the central film over this grid and those of twice and four "
              "times the step; not where there is none; of the full model, when stationary, like "
              "the three that follow"),
    ATTRIBUTE(
        "inlet_nodes", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_ANY,
        "nodes where the viscous pressure builds up, from 10 to 90 % of it; like the two that "
        "follow at Y = 0"),
    ATTRIBUTE("spike_nodes", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_ANY,
              "nodes above half the height of the pressure spike, 0 where there is none"),
    ATTRIBUTE("outlet_nodes", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_ANY,
              "nodes from the smallest film behind X = 0 to the exit"),
    ATTRIBUTE("steps", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_ANY,
              "accepted time steps, only when transient"),
    ATTRIBUTE("rejected_steps", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_ANY,
              "time steps that were taken again with a shorter one"),
    ATTRIBUTE(
        "full_steps", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_ANY,
        "accepted time steps of the full model; this and the next only with romrun --fallback "
        "full"),
    ATTRIBUTE("full_seconds", ARTEFACT_REAL, "s", NEED_OPTIONAL, VALUES_ANY,
              "part of the time that the full model took"),
    ATTRIBUTE("total_newton_iterations", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_ANY,
              "Newton iterations of all time steps, rejected ones too"),
    {0}};

const artefact_schema schema_result = {"ehdrom-result",
                                       1,
                                       14,
                                       "Solution of an elastohydrodynamic contact",
                                       result_axes,
                                       result_fields,
                                       result_attributes};

// ---- snapshots

static const artefact_axis snapshots_axes[] = {
    STATE_AXIS,
    Y_AXIS,
    X_AXIS,
    AXIS("compressed", "1", MAX_STATES, "index of the compressed snapshot, strongest first"),
    AXIS("round", "1", MAX_STATES, "index of the round of adaptive training"),
    {0}};

static const artefact_field snapshots_fields[] = {
    REAL("pressure", "1", NEED_ALWAYS, VALUES_FINITE, "pressure P, in Hertz pressures", "state",
         "y", "x"),
    REAL("film_thickness", "1", NEED_OWN, VALUES_FINITE, "film thickness H", "state", "y", "x"),
    REAL("rigid_approach", "1", NEED_ALWAYS, VALUES_FINITE, "rigid approach H0", "state"),
    INTEGER(
        "exit_node", NEED_ALWAYS, VALUES_COLUMN,
        "index into x of the first node without pressure, length of x where there is none; of a "
        "line without pressure 0",
        "state", "y"),
    REAL("exit_position", "1", NEED_OWN, VALUES_ANY,
         "X at which the pressure ends; NaN on a line without pressure", "state", "y"),
    REAL("moes_M", "1", NEED_ALWAYS, VALUES_POSITIVE, "Moes load number M", "state"),
    REAL("moes_L", "1", NEED_OWN, VALUES_NOT_NEGATIVE, "Moes material number L", "state"),
    REAL("alpha_p_H", "1", NEED_ALWAYS, VALUES_NOT_NEGATIVE,
         "pressure-viscosity coefficient times Hertz pressure", "state"),
    REAL("hertz_pressure", "Pa", NEED_OWN, VALUES_NOT_NEGATIVE, "Hertz pressure", "state"),
    REAL("central_film_thickness", "1", NEED_OWN, VALUES_ANY, "film thickness H at X = 0 (Y = 0)",
         "state"),
    REAL("minimum_film_thickness", "1", NEED_OWN, VALUES_ANY,
         "smallest film thickness H: interpolated, with discretization = published at a node",
         "state"),
    REAL("central_pressure", "1", NEED_OWN, VALUES_ANY, "pressure P at X = 0 (Y = 0)", "state"),
    INTEGER("newton_iterations", NEED_OWN, VALUES_ANY, "Newton iterations that the state took",
            "state"),
    REAL("residual_norm", "1", NEED_OWN, VALUES_ANY,
         "norm of the residual when the iteration ended", "state"),
    REAL("complementarity", "1", NEED_OPTIONAL, VALUES_ANY,
         "largest violation of P >= 0 and of the multiplier's Lambda >= 0 (scaled as the residual) "
         "at any node of a stationary point",
         "state"),
    THINNING_FIELD(""),
    RISE_FIELDS("", "state"),
    EFFECT_FIELDS(""),
    INTEGER("trajectory", NEED_OPTIONAL, VALUES_INDEX_OR_NONE,
            "index of the trajectory that the state was kept of, -1 for a stationary point",
            "state"),
    REAL("trajectory_time", "1", NEED_OPTIONAL, VALUES_BOUND,
         "dimensionless time T of the state on its trajectory; 0 is the stationary start", "state"),
    REAL("trajectory_rate", "1", NEED_OPTIONAL, VALUES_BOUND,
         "rate of change of the contact: of ln a and of u/u_ref with T, absolute values added",
         "state"),
    REAL("trajectory_load_rate", "1", NEED_OPTIONAL, VALUES_BOUND,
         "largest rate of change of ln a with T, by load, radius or modulus, on the trajectory up "
         "to the state",
         "state"),
    INTEGER("status", NEED_ALWAYS, VALUES_ANY, "0 converged, 1 not converged, -1 not yet computed",
            "state"),
    REAL(
        "compressed_pressure", "1", NEED_OPTIONAL, VALUES_FINITE,
        "pressures of all steps of all trajectories, compressed: the rows have the singular values "
        "and right singular vectors of the snapshots, and serve in their place",
        "compressed", "y", "x"),
    REAL("compressed_singular_values", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "singular values of those snapshots, descending", "compressed"),
    INTEGER("training_point", NEED_OPTIONAL, VALUES_ANY,
            "index of the point of the plan, of those inside of its bounds, that adaptive training "
            "chose",
            "state"),
    INTEGER("training_round", NEED_OPTIONAL, VALUES_ANY,
            "round of adaptive training that the state came in", "state"),
    REAL("training_bound", "1", NEED_OPTIONAL, VALUES_ANY,
         "what the indicator said of the state before it was solved, but for its factor: bound of "
         "the relative deviation of the central film by the reduced model of the rounds before; "
         "infinite where that did not converge, NaN in the first round",
         "state"),
    REAL("training_film", "1", NEED_OPTIONAL, VALUES_ANY,
         "film thickness H at X = 0 by that model; NaN where there is none", "state"),
    REAL("training_bound_minimum", "1", NEED_OPTIONAL, VALUES_ANY,
         "training_bound of the minimum film", "state"),
    REAL("training_film_minimum", "1", NEED_OPTIONAL, VALUES_ANY,
         "minimum film thickness by that model", "state"),
    INTEGER("round_points", NEED_OPTIONAL, VALUES_ANY,
            "converged training solutions up to and with the round, of which its model is made",
            "round"),
    REAL("round_indicated", "1", NEED_OPTIONAL, VALUES_ANY,
         "largest deviation of a film, central or minimum, that is indicated for the remaining "
         "points of the "
         "plan; infinite where the model of the round does not converge, NaN where none remain or "
         "the indicator has no factor yet",
         "round"),
    REAL("round_deviation", "1", NEED_OPTIONAL, VALUES_ANY,
         "largest relative deviation of a film by the model of the round at those points "
         "of the next one that it solves; NaN where there are none",
         "round"),
    REAL("round_seconds", "s", NEED_OPTIONAL, VALUES_ANY,
         "time since the start until the round was judged; NaN in an earlier run", "round"),
    {0}};

static const artefact_attribute snapshots_attributes[] = {
    GRID_ATTRIBUTES("line, point or ellipse", NULL),
    TRANSPORT_ATTRIBUTE,
    HALF_ATTRIBUTE,
    ATTRIBUTE("compressed_snapshots", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_COUNT,
              "number of steps of all trajectories"),
    ATTRIBUTE("compressed_energy_discarded", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,
              "part of the squared singular values that the compression left out, at most"),
    {0}};

const artefact_schema schema_snapshots = {"ehdrom-snapshots",
                                          2,
                                          7,
                                          "Training solutions of an elastohydrodynamic contact",
                                          snapshots_axes,
                                          snapshots_fields,
                                          snapshots_attributes};

// ---- basis

static const artefact_axis basis_axes[] = {
    Y_AXIS,
    X_AXIS,
    FILM_Y_AXIS,
    FILM_X_AXIS,
    PRESSURE_MODE_AXIS,
    DEFORMATION_MODE_AXIS,
    AXIS("pressure_singular_value", "1", MAX_STATES,
         "index of the singular value of the pressure snapshots"),
    AXIS("deformation_singular_value", "1", MAX_STATES,
         "index of the singular value of the deformation snapshots"),
    STATE_AXIS,
    {0}};

static const artefact_field basis_fields[] = {
    REAL("pressure_basis", "1", NEED_ALWAYS, VALUES_FINITE, "pressure modes", "pressure_mode", "y",
         "x"),
    REAL("deformation_basis", "1", NEED_OPTIONAL, VALUES_FINITE,
         "deformation modes, only for deformation = independent", "deformation_mode", "film_y",
         "film_x"),
    REAL("pressure_singular_values", "1", NEED_OWN, VALUES_NOT_NEGATIVE,
         "singular values of the pressure snapshots, descending", "pressure_singular_value"),
    REAL("deformation_singular_values", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "singular values of the deformation snapshots, descending", "deformation_singular_value"),
    REAL("weight", "1", NEED_ALWAYS, VALUES_POSITIVE,
         "diagonal D that weights the residual in the test basis", "y", "x"),
    STATE_FIELDS,
    {0}};

static const artefact_attribute basis_attributes[] = {
    GRID_ATTRIBUTES("line, point or ellipse", NULL),
    TRANSPORT_ATTRIBUTE,
    HALF_ATTRIBUTE,
    DEFORMATION_ATTRIBUTE,
    ATTRIBUTE("pressure_energy_discarded", ARTEFACT_REAL, "1", NEED_OWN, VALUES_ANY,
              "part of the squared singular values of the pressure left out"),
    ATTRIBUTE("deformation_energy_discarded", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,
              "part of the squared singular values of the deformation left out"),
    {0}};

const artefact_schema schema_basis = {"ehdrom-basis",
                                      2,
                                      7,
                                      "Reduced bases of an elastohydrodynamic contact",
                                      basis_axes,
                                      basis_fields,
                                      basis_attributes};

// ---- part

static const artefact_axis part_axes[] = {Y_AXIS, X_AXIS, PRESSURE_MODE_AXIS, STATE_AXIS, {0}};

static const artefact_field part_fields[] = {
    REAL("pressure_basis", "1", NEED_ALWAYS, VALUES_FINITE,
         "pressure modes of the part, of length 1 and orthogonal", "pressure_mode", "y", "x"),
    REAL("pressure_singular_values", "1", NEED_ALWAYS, VALUES_NOT_NEGATIVE,
         "singular values of its snapshots, descending", "pressure_mode"),
    STATE_PRESSURE_FIELD,
    STATE_OTHER_FIELDS,
    {0}};

static const artefact_attribute part_attributes[] = {
    GRID_ATTRIBUTES("line, point or ellipse", NULL),
    TRANSPORT_ATTRIBUTE,
    HALF_ATTRIBUTE,
    ATTRIBUTE("energy", ARTEFACT_REAL, "1", NEED_ALWAYS, VALUES_POSITIVE,
              "sum of the squares of the snapshots, at all nodes"),
    ATTRIBUTE("energy_discarded", ARTEFACT_REAL, "1", NEED_ALWAYS, VALUES_NOT_NEGATIVE,
              "part of it that the squared distances of the snapshots from the modes have at most"),
    ATTRIBUTE("num_snapshots", ARTEFACT_INTEGER, "1", NEED_OWN, VALUES_COUNT,
              "number of the snapshots"),
    ATTRIBUTE("num_left_out", ARTEFACT_INTEGER, "1", NEED_OWN, VALUES_COUNT,
              "number of states that had not converged, and are not in the file"),
    {0}};

const artefact_schema schema_part = {
    "ehdrom-part",
    1,
    2,
    "Compressed part of a training of an elastohydrodynamic contact",
    part_axes,
    part_fields,
    part_attributes};

// ---- residuals

static const artefact_axis residuals_axes[] = {
    AXIS(
        "iteration", "1", MAX_ITERATIONS,
        "index of the Newton iteration, over all stationary states, then of the compressed ones of "
        "trajectories"),
    Y_AXIS,
    X_AXIS,
    STATE_AXIS,
    {0}};

static const artefact_field residuals_fields[] = {
    REAL("weighted_residual", "1", NEED_ALWAYS, VALUES_FINITE,
         "weighted residual D f of the Reynolds rows", "iteration", "y", "x"),
    REAL("weighted_jacobian_step", "1", NEED_ALWAYS, VALUES_FINITE,
         "weighted product D J dz of Jacobian and Newton step", "iteration", "y", "x"),
    INTEGER("iteration_state", NEED_OWN, VALUES_STATE_OR_NONE,
            "index of the state that the iteration belongs to, -1 for a compressed one of "
            "trajectories, which serves in place of many",
            "iteration"),
    INTEGER("state_exit_node", NEED_ALWAYS, VALUES_COLUMN,
            "index into x of the first node without pressure at the end of the state's iteration",
            "state", "y"),
    REAL("state_moes_M", "1", NEED_OWN, VALUES_POSITIVE, "Moes load number M of the states",
         "state"),
    REAL("state_alpha_p_H", "1", NEED_OWN, VALUES_NOT_NEGATIVE,
         "pressure-viscosity coefficient times Hertz pressure of the states", "state"),
    REAL("state_central_film_thickness", "1", NEED_OWN, VALUES_ANY,
         "film thickness H at X = 0 by the projected system", "state"),
    INTEGER("status", NEED_OWN, VALUES_ANY, "0 converged, 1 not converged", "state"),
    INTEGER("newton_iterations", NEED_OWN, VALUES_ANY, "Newton iterations that the state took",
            "state"),
    {0}};

static const artefact_attribute residuals_attributes[] = {
    GRID_ATTRIBUTES("line, point or ellipse", NULL),
    HALF_ATTRIBUTE,
    DEFORMATION_ATTRIBUTE,
    BASIS_ATTRIBUTE,
    ATTRIBUTE("compressed_iterations", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_COUNT,
              "number of Newton iterations of all trajectories"),
    ATTRIBUTE("compressed_energy_discarded", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,
              "part of the squared singular values that their compression left out, at most"),
    {0}};

const artefact_schema schema_residuals = {
    "ehdrom-residuals",
    2,
    2,
    "Residuals and Newton steps of a reduced elastohydrodynamic contact",
    residuals_axes,
    residuals_fields,
    residuals_attributes};

// ---- model

static const artefact_axis model_axes[] = {
    Y_AXIS,
    X_AXIS,
    FILM_Y_AXIS,
    FILM_X_AXIS,
    AXIS("row", "1", MAX_ROWS, "index of the selected row, in order of selection"),
    AXIS("needed_node", "1", MAX_NODES,
         "index of the film node whose pressure and film the selected rows need"),
    AXIS("band_node", "1", MAX_NODES,
         "index of the film node, counted from the first of the exit band"),
    AXIS("control", "1", MAX_ROWS, "index of the control row, in order of choice"),
    AXIS("control_node", "1", MAX_NODES,
         "index of the film node whose pressure and film the control rows need"),
    AXIS("jacobian_mode", "1", MAX_MODES,
         "index of the mode of the weighted Jacobian products, strongest first"),
    AXIS("cubature", "1", MAX_NODES,
         "index of the film node at which shear stresses are evaluated"),
    PRESSURE_MODE_AXIS,
    DEFORMATION_MODE_AXIS,
    STATE_AXIS,
    AXIS("position", "1", MAX_MODES, "index of the measured size of the model, smallest first"),
    AXIS("quantile", "1", MAX_FEW,
         "part of the scenes that deviate by no more: median, 95 %, worst"),
    AXIS("part", "1", MAX_FEW, "part of the scenes that indicate no more: 5 %, median, 90 %, 95 %"),
    AXIS("bounded", "1", MAX_FEW,
         "what is indicated: central film, minimum film, central pressure, exit position, load, "
         "pressure, film, friction; of a model of before schema 2.6 without the last"),
    AXIS("part_in_time", "1", MAX_FEW, "part of the trajectories that indicate no more"),
    AXIS("shown", "1", MAX_STATES, "index of the scene or trajectory of the calibration"),
    {0}};

/* Deviations at each model size: quantiles over the scenes that the model solved. */
#define DEVIATION(quantity, what)                                                                  \
    REAL("deviation_" quantity, "1", NEED_OPTIONAL, VALUES_BOUND,                                  \
         "deviation from the full model: " what, "position", "quantile")

/* Largest deviation at each model size, over all trajectories. */
#define WORST_IN_TIME(quantity, what)                                                              \
    REAL("worst_in_time_" quantity, "1", NEED_OPTIONAL, VALUES_BOUND,                              \
         "largest relative deviation from the full model with the same time steps: " what,         \
         "position")

static const artefact_field model_fields[] = {
    INTEGER("selected_row", NEED_ALWAYS, VALUES_ROW,
            "index of the selected Reynolds rows: into x or, of a point contact, into all nodes of "
            "y and x, "
            "the lines of y one after the other",
            "row"),
    REAL("row_weight", "1", NEED_ALWAYS, VALUES_POSITIVE,
         "weight of the selected rows: D times their factor in the least squares", "row"),
    REAL("row_factor", "1", NEED_OPTIONAL, VALUES_POSITIVE,
         "that factor; a part of the rows or modes has factors of its own", "row"),
    REAL("row_jacobian_modes", "1", NEED_OPTIONAL, VALUES_FINITE,
         "modes of the weighted Jacobian products at the selected rows, orthonormal over all rows; "
         "the factors of a part of the rows follow from them",
         "row", "jacobian_mode"),
    INTEGER("needed_node_index", NEED_ALWAYS, VALUES_FILM_NODE,
            "film nodes that are needed, ascending; film node k + 1 is index k of x, 0 and the "
            "last are the boundary nodes; of a point contact the film nodes of the lines of y, "
            "each with its two boundary nodes, follow one another, and there are boundary lines",
            "needed_node"),
    REAL("needed_pressure_basis", "1", NEED_ALWAYS, VALUES_FINITE,
         "pressure modes at the needed nodes", "needed_node", "pressure_mode"),
    REAL("needed_deformation_basis", "1", NEED_OPTIONAL, VALUES_FINITE,
         "deformation modes at the needed nodes, only for deformation = independent", "needed_node",
         "deformation_mode"),
    REAL("needed_coupled_basis", "1", NEED_OPTIONAL, VALUES_FINITE,
         "deflection at the needed nodes of the pressure modes cut at the first band node, only "
         "for deformation = coupled",
         "needed_node", "pressure_mode"),
    REAL("band_pressure_basis", "1", NEED_ALWAYS, VALUES_FINITE, "pressure modes in the exit band",
         "band_node", "pressure_mode"),
    REAL("band_deformation_basis", "1", NEED_OPTIONAL, VALUES_FINITE,
         "deformation modes in the exit band, only for deformation = independent", "band_node",
         "deformation_mode"),
    REAL("band_coupled_basis", "1", NEED_OPTIONAL, VALUES_FINITE,
         "deflection in the exit band of the pressure modes cut at its first node, only for "
         "deformation = coupled",
         "band_node", "pressure_mode"),
    REAL("band_projected_kernel", "1", NEED_OPTIONAL, VALUES_FINITE,
         "deflection of unit pressure at the band nodes, projected on the deformation modes",
         "band_node", "deformation_mode"),
    INTEGER("band_line_begin", NEED_OPTIONAL, VALUES_FILM_COLUMN,
            "first column of the exit band on each line, counted with the boundary node; this and "
            "the next three only of a point contact, whose band nodes go line after line",
            "y"),
    INTEGER("band_line_end", NEED_OPTIONAL, VALUES_FILM_COLUMN,
            "column behind the last one of the exit band", "y"),
    INTEGER("band_line_least_exit", NEED_OPTIONAL, VALUES_FILM_COLUMN,
            "first column at which the exit may lie", "y"),
    INTEGER("band_line_most_exit", NEED_OPTIONAL, VALUES_FILM_COLUMN,
            "last column at which the exit may lie", "y"),
    INTEGER("control_row", NEED_OPTIONAL, VALUES_ROW,
            "index, as in selected_row, of Reynolds rows that take no part in the solution; what "
            "they are left "
            "with indicates its deviation",
            "control"),
    REAL("control_weight", "1", NEED_OPTIONAL, VALUES_POSITIVE, "weight D of the control rows",
         "control"),
    INTEGER("control_node_index", NEED_OPTIONAL, VALUES_FILM_NODE,
            "film nodes that the control rows need, ascending, as in needed_node_index",
            "control_node"),
    REAL("control_pressure_basis", "1", NEED_OPTIONAL, VALUES_FINITE,
         "pressure modes at these nodes", "control_node", "pressure_mode"),
    REAL("control_deformation_basis", "1", NEED_OPTIONAL, VALUES_FINITE,
         "deformation modes at these nodes, only for deformation = independent", "control_node",
         "deformation_mode"),
    REAL("control_coupled_basis", "1", NEED_OPTIONAL, VALUES_FINITE,
         "deflection at these nodes of the pressure modes cut at the first band node, only for "
         "deformation = coupled",
         "control_node", "pressure_mode"),
    REAL("elasticity_jacobian", "1", NEED_OPTIONAL, VALUES_FINITE,
         "deflection of the pressure modes cut at the first band node, projected on the "
         "deformation modes",
         "deformation_mode", "pressure_mode"),
    REAL("load_jacobian", "1", NEED_ALWAYS, VALUES_FINITE,
         "load of the pressure modes cut at the first band node", "pressure_mode"),
    INTEGER("cubature_node_index", NEED_OPTIONAL, VALUES_FILM_NODE,
            "film nodes at which shear stresses are evaluated, ascending, as in needed_node_index; "
            "a model without them sums over the grid",
            "cubature"),
    REAL("cubature_friction", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "weights of the shear stresses at those of them with pressure, whose sum is the integral "
         "over the nodes with pressure",
         "cubature"),
    REAL("cubature_dry", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "the same of the mean over the dry contact", "cubature"),
    REAL("cubature_pressure_basis", "1", NEED_OPTIONAL, VALUES_FINITE,
         "pressure modes at these nodes", "cubature", "pressure_mode"),
    REAL("cubature_deformation_basis", "1", NEED_OPTIONAL, VALUES_FINITE,
         "deformation modes at these nodes, only for deformation = independent", "cubature",
         "deformation_mode"),
    REAL("cubature_coupled_basis", "1", NEED_OPTIONAL, VALUES_FINITE,
         "deflection at these nodes of the pressure modes cut at the first band node, only for "
         "deformation = coupled",
         "cubature", "pressure_mode"),
    REAL("moment_jacobian", "1", NEED_OPTIONAL, VALUES_FINITE,
         "integral of pressure times X of the pressure modes cut at the first band node",
         "pressure_mode"),
    REAL("pressure_basis", "1", NEED_ALWAYS, VALUES_FINITE, "pressure modes", "pressure_mode", "y",
         "x"),
    REAL("deformation_basis", "1", NEED_OPTIONAL, VALUES_FINITE,
         "deformation modes, only for deformation = independent; for transient scenes",
         "deformation_mode", "film_y", "film_x"),
    STATE_FIELDS,
    REAL("sigma_min_by_exit", "1", NEED_OPTIONAL, VALUES_ANY,
         "smallest singular value of the sampled bases, leading modes and rows before the exit of "
         "the state",
         "state"),
    INTEGER("position_pressure_modes", NEED_OPTIONAL, VALUES_COUNT,
            "pressure modes in use; this and what follows only in a checked or calibrated model",
            "position"),
    INTEGER("position_deformation_modes", NEED_OPTIONAL, VALUES_COUNT,
            "deformation modes in use, 0 for deformation = coupled", "position"),
    INTEGER("position_rows", NEED_OPTIONAL, VALUES_COUNT, "rows in use", "position"),
    DEVIATION("central_film_thickness", "central film thickness, relative"),
    DEVIATION("minimum_film_thickness", "minimum film thickness, relative"),
    DEVIATION("central_pressure", "central pressure, relative"),
    DEVIATION("pressure", "pressure P, largest of all nodes"),
    REAL("position_mean_iterations", "1", NEED_OPTIONAL, VALUES_BOUND,
         "Newton iterations of a scene in the mean", "position"),
    REAL("position_most_iterations", "1", NEED_OPTIONAL, VALUES_BOUND,
         "Newton iterations of a scene at most", "position"),
    REAL("position_seconds", "s", NEED_OPTIONAL, VALUES_BOUND,
         "median processor time of a solution, with the model open", "position"),
    INTEGER("position_failures", NEED_OPTIONAL, VALUES_COUNT,
            "scenes that did not converge or were not to be trusted; they count nowhere else",
            "position"),
    REAL("indicator_factor", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "factor of the indicated deviation of the central film thickness", "position"),
    REAL("indicator_factor_minimum", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "factor of the indicated deviation of the minimum film thickness; where missing, the same",
         "position"),
    REAL("position_largest_residual", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "largest residual of the least squares that a scene ended with", "position"),
    REAL("indicator_factor_central_pressure", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "factor of the indicated deviation of the central pressure; here and in the next ones, "
         "where "
         "missing or 0, it is not indicated",
         "position"),
    REAL("indicator_factor_exit_position", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "the same of the exit position", "position"),
    REAL("indicator_factor_load", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "the same of the load, where the approach is given", "position"),
    REAL("indicator_factor_pressure", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "the same of the largest deviation of the pressure at any node", "position"),
    REAL("indicator_factor_film", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "the same of the largest deviation of the film at any node with pressure", "position"),
    REAL("indicator_factor_friction", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "the same of the friction force, by any law of shear stress", "position"),
    REAL("indicator_share", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "part of the factor that holds for small bounds: of b, (share + growth b) b, offset + "
         "offset_share b, for a bound b, the least times the factor is indicated; where one of "
         "these "
         "is missing, b times the factor",
         "position", "bounded"),
    REAL("indicator_growth", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "by which that part grows with the bound", "position", "bounded"),
    REAL("indicator_offset", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "where exits are nodes, else 0", "position", "bounded"),
    REAL("indicator_offset_share", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "where exits are nodes, else 1", "position", "bounded"),
    REAL("indicated_deviation", "1", NEED_OPTIONAL, VALUES_BOUND,
         "the larger of both films' with the factors for all bounds; infinite for a scene that was "
         "not solved",
         "position", "part"),
    REAL("indicator_effectivity", "1", NEED_OPTIONAL, VALUES_BOUND,
         "indicated over true deviation, of the film of which that is less", "position", "part"),
    REAL("indicator_factor_in_time", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "factor of what is indicated in time of the central film thickness, and of the minimum "
         "film thickness by errors that come with the fluid",
         "position"),
    REAL("indicator_factor_in_time_minimum", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "factor of what is indicated in time of the minimum film thickness by rows and exit",
         "position"),
    REAL("indicator_floor_in_time", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "deviation that is indicated in time of the central film thickness at least", "position"),
    REAL("indicator_floor_in_time_minimum", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "deviation that is indicated in time of the minimum film thickness at least", "position"),
    REAL(
        "indicated_in_time", "1", NEED_OPTIONAL, VALUES_BOUND,
        "largest deviation of both films that is indicated in these trajectories, 1 where they are "
        "lost",
        "position", "part_in_time"),
    WORST_IN_TIME("central_film_thickness", "central film thickness"),
    WORST_IN_TIME("minimum_film_thickness", "minimum film thickness"),
    WORST_IN_TIME("central_pressure", "central pressure"),
    REAL("position_step_iterations", "1", NEED_OPTIONAL, VALUES_BOUND,
         "Newton iterations of a step of a trajectory in the mean", "position"),
    REAL("position_step_seconds", "s", NEED_OPTIONAL, VALUES_BOUND,
         "processor time of a step in the mean", "position"),
    INTEGER("position_lost_trajectories", NEED_OPTIONAL, VALUES_COUNT,
            "trajectories with a step that did not converge or was not to be trusted; they count "
            "nowhere else",
            "position"),
    REAL("shown_alpha_p_H", "1", NEED_OPTIONAL, VALUES_NOT_NEGATIVE,
         "pressure-viscosity coefficient times Hertz pressure of the scenes that the sizes were "
         "measured on; this and the next four say of which lubricants estimates are known, besides "
         "those of the training",
         "shown"),
    RISE_FIELDS("shown_", "shown"),
    INTEGER("shown_in_time", NEED_OPTIONAL, VALUES_COUNT, "1: a trajectory, 0: a stationary scene",
            "shown"),
    {0}};

static const artefact_attribute model_attributes[] = {
    GRID_ATTRIBUTES("line, point or ellipse", NULL),
    TRANSPORT_ATTRIBUTE,
    HALF_ATTRIBUTE,
    DEFORMATION_ATTRIBUTE,
    ATTRIBUTE("band_begin", ARTEFACT_INTEGER, "1", NEED_ALWAYS, VALUES_ANY,
              "first film node of the exit band, of a line contact; so are the next two"),
    ATTRIBUTE("least_exit", ARTEFACT_INTEGER, "1", NEED_ALWAYS, VALUES_ANY,
              "first film node at which the exit may lie"),
    ATTRIBUTE("most_exit", ARTEFACT_INTEGER, "1", NEED_ALWAYS, VALUES_ANY,
              "last film node at which the exit may lie"),
    ATTRIBUTE(
        "first_minimum_line", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_COUNT,
        "first line of the grid, boundary lines counted, on which the film minimum is sought; "
        "this and the next one only of a point contact"),
    ATTRIBUTE("last_minimum_line", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_COUNT,
              "last of these lines"),
    ATTRIBUTE("method", ARTEFACT_TEXT, "1", NEED_OWN, VALUES_ANY,
              "method of row selection; given: the rows are somebody else's"),
    ATTRIBUTE("weights", ARTEFACT_TEXT, "1", NEED_OPTIONAL, VALUES_ANY,
              "method of the rows' factors; missing where these are somebody else's"),
    ATTRIBUTE("sigma_min_residual", ARTEFACT_REAL, "1", NEED_OWN, VALUES_ANY,
              "smallest singular value of the sampled residual basis"),
    ATTRIBUTE("sigma_min_jacobian", ARTEFACT_REAL, "1", NEED_OWN, VALUES_ANY,
              "smallest singular value of the sampled Jacobian basis"),
    ATTRIBUTE("sigma_min_over_exits", ARTEFACT_REAL, "1", NEED_OWN, VALUES_ANY,
              "smallest of both over all exits seen in training"),
    ATTRIBUTE("stability", ARTEFACT_REAL, "1", NEED_OPTIONAL, VALUES_ANY,
              "largest 1/sigma_min of both over these exits, of modes orthonormal over all rows "
              "before the exit"),
    BASIS_ATTRIBUTE,
    ATTRIBUTE("calibration_scenes", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_COUNT,
              "scenes that each position was measured on, none of them a training solution"),
    ATTRIBUTE("calibration_trajectories", ARTEFACT_INTEGER, "1", NEED_OPTIONAL, VALUES_COUNT,
              "trajectories that each position was measured on"),
    {0}};

const artefact_schema schema_model = {"ehdrom-model",
                                      2,
                                      9,
                                      "Reduced model of an elastohydrodynamic contact",
                                      model_axes,
                                      model_fields,
                                      model_attributes};

// ---- cases

static const artefact_scale film_of_case = {{NULL, NULL}, "film_unit"},
                            length_of_case = {{NULL, NULL}, "half_width"},
                            pressure_of_case = {{NULL, NULL}, "hertz_pressure"};

static const artefact_axis cases_axes[] = {
    AXIS("case", "1", MAX_STATES, "index of the row of the table that the scene comes from"), {0}};

static const artefact_field cases_fields[] = {
    INTEGER("status", NEED_ALWAYS, VALUES_ANY, "0 converged, 1 not converged, 4 not to be trusted",
            "case"),
    REAL("moes_M", "1", NEED_OWN, VALUES_POSITIVE, "Moes load number M", "case"),
    REAL("moes_L", "1", NEED_OWN, VALUES_NOT_NEGATIVE, "Moes material number L", "case"),
    REAL("alpha_p_H", "1", NEED_OWN, VALUES_NOT_NEGATIVE,
         "pressure-viscosity coefficient times Hertz pressure", "case"),
    REAL("hertz_pressure", "Pa", NEED_OWN, VALUES_NOT_NEGATIVE, "Hertz pressure", "case"),
    REAL(
        "half_width", "m", NEED_OPTIONAL, VALUES_ANY,
        "half width a of the dry contact; this and the next five NaN where a scene is not given in "
        "SI units, and not there where none is",
        "case"),
    REAL("film_unit", "m", NEED_OPTIONAL, VALUES_ANY,
         "a^2/R, which H = 1 and an approach of 1 stand for", "case"),
    REAL("line_load", "N m-1", NEED_OPTIONAL, VALUES_ANY, "load of a line contact", "case"),
    REAL("point_load", "N", NEED_OPTIONAL, VALUES_ANY, "load of a point contact", "case"),
    REAL("radius", "m", NEED_OPTIONAL, VALUES_ANY, "reduced radius R", "case"),
    REAL("speed", "m s-1", NEED_OPTIONAL, VALUES_ANY, "mean speed of both surfaces", "case"),
    REAL("thermal_loading", "1", NEED_OPTIONAL, VALUES_ANY,
         "thermal loading parameter of the inlet, of scenes with the lubricant's conductivity",
         "case"),
    REAL("inlet_heating_factor", "1", NEED_OPTIONAL, VALUES_ANY,
         "factor by which shear heating of the inlet thins the films, which are isothermal here; "
         "NaN where its formula does not hold",
         "case"),
    SCALED("central_film_thickness", film_of_case, NEED_OWN, VALUES_ANY,
           "film thickness H at X = 0 (Y = 0); this and all that follow up to the indicated "
           "deviations NaN where the scene did not converge",
           "case"),
    SCALED("minimum_film_thickness", film_of_case, NEED_OWN, VALUES_ANY,
           "smallest film thickness H", "case"),
    SCALED("central_pressure", pressure_of_case, NEED_OWN, VALUES_ANY,
           "pressure P at X = 0 (Y = 0)", "case"),
    SCALED("peak_pressure", pressure_of_case, NEED_OWN, VALUES_ANY,
           "largest pressure P at the nodes that the solution looks at", "case"),
    SCALED("rigid_approach", film_of_case, NEED_OWN, VALUES_ANY, "rigid approach H0", "case"),
    SCALED("exit_position", length_of_case, NEED_OWN, VALUES_ANY,
           "X at which the pressure ends, at Y = 0", "case"),
    REAL("indicated_deviation", "1", NEED_OWN, VALUES_ANY,
         "indicated relative deviation of the central film thickness from the full model; NaN "
         "where it cannot be told",
         "case"),
    REAL("indicated_deviation_minimum", "1", NEED_OWN, VALUES_ANY,
         "the same of the minimum film thickness", "case"),
    REAL("friction_coefficient", "1", NEED_OPTIONAL, VALUES_ANY,
         "friction over the load, positive where surface 1 is the faster one; this and the next "
         "eleven NaN where a scene does not slide or did not converge, and not there where none "
         "does",
         "case"),
    REAL("line_friction_force", "N m-1", NEED_OPTIONAL, VALUES_ANY,
         "friction of a line contact: on surface 2 along X, on surface 1 against it", "case"),
    REAL("point_friction_force", "N", NEED_OPTIONAL, VALUES_ANY, "the same of a point contact",
         "case"),
    REAL("line_power_loss", "W m-1", NEED_OPTIONAL, VALUES_ANY,
         "power that both surfaces put into the film of a line contact", "case"),
    REAL("point_power_loss", "W", NEED_OPTIONAL, VALUES_ANY, "the same of a point contact", "case"),
    REAL("line_rolling_resistance", "N m-1", NEED_OPTIONAL, VALUES_ANY,
         "rolling resistance of a line contact, on either surface against X", "case"),
    REAL("point_rolling_resistance", "N", NEED_OPTIONAL, VALUES_ANY, "the same of a point contact",
         "case"),
    REAL("line_rolling_moment", "N", NEED_OPTIONAL, VALUES_ANY,
         "moment of the pressures of a line contact against the rolling", "case"),
    REAL("point_rolling_moment", "N m", NEED_OPTIONAL, VALUES_ANY, "the same of a point contact",
         "case"),
    REAL("mean_shear_stress", "Pa", NEED_OPTIONAL, VALUES_ANY,
         "magnitude of the shear stress of the sliding, mean over the dry contact", "case"),
    REAL("largest_shear_stress", "Pa", NEED_OPTIONAL, VALUES_ANY,
         "the largest of it, at the nodes that the solution looks at", "case"),
    REAL("indicated_deviation_friction", "1", NEED_OPTIONAL, VALUES_ANY,
         "indicated relative deviation of the friction force from the full model", "case"),
    INTEGER("part", NEED_OPTIONAL, VALUES_ANY,
            "of a list of models which of them has solved it, from 0 in its order; models of a "
            "flat file count each",
            "case"),
    INTEGER("newton_iterations", NEED_OWN, VALUES_ANY, "iterations that the solution took", "case"),
    REAL("residual_norm", "1", NEED_OWN, VALUES_ANY,
         "norm of the residual when the iteration ended", "case"),
    REAL("solve_seconds", "s", NEED_OWN, VALUES_ANY, "time of the solution", "case"),
    {0}};

static const artefact_attribute cases_attributes[] = {
    GRID_ATTRIBUTES("line, point or ellipse", NULL), {0}};

const artefact_schema schema_cases = {"ehdrom-cases",
                                      1,
                                      4,
                                      "Solutions of many elastohydrodynamic contacts",
                                      cases_axes,
                                      cases_fields,
                                      cases_attributes};

const artefact_schema *const artefact_schemas[] = {
    &schema_result,    &schema_snapshots, &schema_basis, &schema_part,
    &schema_residuals, &schema_model,     &schema_cases, NULL};
