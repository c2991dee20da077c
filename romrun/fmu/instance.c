/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/fmu/instance.h"

#include "romrun/library/ehdrom.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

typedef enum fmu_mode {
    MODE_INSTANTIATED,
    MODE_INITIALIZATION,
    MODE_STEP,
    MODE_TERMINATED
} fmu_mode;

/* Inputs at one point in time, in the form that the contact takes. */
typedef struct conditions {
    double given; // load or approach
    double speed, radius;
    double sliding; // speed of surface 1 minus speed of surface 2
} conditions;

/* State of the instance at one point in time, without the numbers that ehdrom_state_save saves. */
typedef struct moment {
    char mark[8];
    char token[FMU_TOKEN];
    fmu_mode mode;
    double time, stop;
    double values[FMU_NUM_VARIABLES];
    bool solved;      // during initialization: the outputs belong to the present inputs
    double pending;   // s, length of the step that is not accepted yet; 0: there is no such step
    double last;      // s, length of the last internal step; 0: no step was taken yet
    double noise;     // magnitude of recent local errors that were accepted as noise
    bool noisy;       // the noise has been logged
    conditions held;  // conditions of the contact's last accepted state
    conditions aimed; // conditions at the end of the pending step
} moment;

static const char state_mark[8] = "ehdfmu4";

struct fmu_instance {
    fmu_log log;
    void *log_to;
    bool verbose;
    fmu_contents contents;
    char *resources; // folder of the resources
    ehdrom_model *model;
    ehdrom_contact *contact;
    ehdrom_contact *stationary; // contact for the stationary outputs; NULL: not needed yet
    bool has_stationary;        // the stationary outputs are up to date
    bool slid;                  // the traction outputs are up to date
    void *before;               // saved state before the last communication step
    moment now;
};

// ---- messages

const char *const fmu_categories[] = {
    [FMU_DONE] = "logAll", [FMU_DISCARDED] = "logStatusDiscard", [FMU_FAILED] = "logStatusError"};

static void say(const fmu_instance *self, fmu_outcome of, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void say(const fmu_instance *self, fmu_outcome of, const char *format, ...) {
    char text[1024];
    va_list arguments;

    if (!self->log || !(of != FMU_DONE || self->verbose)) return;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    self->log(self->log_to, of, text);
}

#define fail(self, ...) (say(self, FMU_FAILED, __VA_ARGS__), false)

bool fmu_refuse(fmu_instance *self, const char *function) {
    return fail(self,
                "%s: found a call that this FMU does not offer, expected those of "
                "modelDescription.xml",
                function);
}

void fmu_set_verbose(fmu_instance *self, bool verbose) {
    self->verbose = verbose;
}

static const char *const mode_names[] = {"instantiated", "initialization", "step", "terminated"};

static bool in_mode(const fmu_instance *self, fmu_mode mode, const char *what) {
    if (self->now.mode == mode) return true;
    return fail(self, "%s: found it in %s mode, expected %s", what, mode_names[self->now.mode],
                mode_names[mode]);
}

// ---- creation

static void set_to_start(fmu_instance *self) {
    self->now = (moment){.mode = MODE_INSTANTIATED, .stop = INFINITY};
    memcpy(self->now.mark, state_mark, sizeof state_mark);
    memcpy(self->now.token, self->contents.token, sizeof self->now.token);
    memcpy(self->now.values, self->contents.start, sizeof self->now.values);
}

static bool find_resource(char path[PATH_MAX], const fmu_instance *self, const char *name) {
    const size_t length = strlen(self->resources);
    const char *slash = length && self->resources[length - 1] == '/' ? "" : "/";

    return snprintf(path, PATH_MAX, "%s%s%s", self->resources, slash, name) < PATH_MAX ||
           fail(self, "%s: found a path of more than %d bytes", name, PATH_MAX);
}

static bool read_contents(fmu_instance *self, const char *token) {
    char path[PATH_MAX];

    if (!find_resource(path, self, "contact.txt")) return false;
    FILE *file = fopen(path, "re");
    const bool read = file && fmu_contents_read(&self->contents, file);

    if (file) fclose(file);
    if (!read)
        return fail(self, "%s: found %s, expected the list of this FMU's variables", path,
                    file ? "another content" : "no file");
    if (!token || strcmp(token, self->contents.token) != 0)
        return fail(self, "token: found %s, expected %s of modelDescription.xml",
                    token ? token : "none", self->contents.token);
    return true;
}

static bool read_contact(const fmu_instance *self, ehdrom_contact **contact) {
    char path[PATH_MAX];

    if (!find_resource(path, self, "contact.yml")) return false;
    if (ehdrom_contact_create(contact, self->model) || ehdrom_contact_read(*contact, path))
        return fail(self, "%s", ehdrom_contact_error(*contact));
    return true;
}

static bool open_contact(fmu_instance *self) {
    char path[PATH_MAX];

    if (!find_resource(path, self, "model.ehdrom")) return false;
    if (ehdrom_model_open(&self->model, path, NULL))
        return fail(self, "%s", ehdrom_model_error(self->model));
    return read_contact(self, &self->contact);
}

fmu_instance *fmu_create(const char *token, const char *resources, fmu_log log, void *log_to) {
    fmu_instance *self = calloc(1, sizeof *self);

    if (!self) return NULL;
    self->log = log;
    self->log_to = log_to;
    self->resources = strdup(resources);
    if (!self->resources || !read_contents(self, token) || !open_contact(self)) {
        fmu_free(self);
        return NULL;
    }
    set_to_start(self);
    return self;
}

void fmu_free(fmu_instance *self) {
    if (!self) return;
    ehdrom_contact_free(self->contact);
    ehdrom_contact_free(self->stationary);
    ehdrom_model_close(self->model);
    free(self->before);
    free(self->resources);
    free(self);
}

// ---- variables

static const fmu_variable *find(const fmu_instance *self, unsigned reference, fmu_type type) {
    static const char *const types[] = {"real", "integer", "Boolean"};

    if (reference < FMU_NUM_VARIABLES && self->contents.has[reference] &&
        fmu_variables[reference].type == type)
        return &fmu_variables[reference];
    say(self, FMU_FAILED, "value reference: found %u, expected one of a variable that is %s",
        reference, types[type]);
    return NULL;
}

static bool start(fmu_instance *self);
static bool update_stationary(fmu_instance *self);
static bool slide_now(fmu_instance *self);

static bool is_stationary(unsigned reference) {
    return (reference >= FMU_STIFFNESS && reference <= FMU_DAMPING_BOUND) ||
           reference == FMU_INLET_HEATING;
}

static bool is_friction(unsigned reference) {
    return reference >= FMU_FRICTION && reference <= FMU_LARGEST_STRESS;
}

bool fmu_get(fmu_instance *self, unsigned reference, fmu_type type, double *value) {
    const fmu_variable *variable = find(self, reference, type);

    if (!variable) return false;
    if (variable->role == FMU_OUTPUT && self->now.mode == MODE_INITIALIZATION && !start(self))
        return false;
    const bool early = self->now.mode < MODE_INITIALIZATION;
    if (is_stationary(reference) && !early && !update_stationary(self)) return false;
    if (is_friction(reference) && !early && !slide_now(self)) return false;
    *value = reference == FMU_TIME ? self->now.time : self->now.values[reference];
    return true;
}

bool fmu_set(fmu_instance *self, unsigned reference, fmu_type type, double value) {
    const fmu_variable *variable = find(self, reference, type);

    if (!variable) return false;
    if (!isfinite(value))
        return fail(self, "%s: found %g, expected a finite number", variable->name, value);
    const bool early = self->now.mode <= MODE_INITIALIZATION;
    if (!(variable->role == FMU_PARAMETER && early) &&
        !(variable->role == FMU_INPUT && (early || self->now.mode == MODE_STEP)))
        return fail(self,
                    "%s: found it set in %s mode, expected inputs, and parameters before the "
                    "end of initialization",
                    variable->name, mode_names[self->now.mode]);
    self->now.values[reference] = value;
    self->now.solved = false;
    return true;
}

/* Copies the outputs that are members of ehdrom_result. */
static void take_outputs(double values[FMU_NUM_VARIABLES], const ehdrom_result *result) {
    for (size_t i = 0; i < FMU_NUM_VARIABLES; i++) {
        const fmu_variable *variable = &fmu_variables[i];
        const char *member = (const char *)result + variable->offset;
        if (variable->role != FMU_OUTPUT || variable->offset == 0) continue;
        if (variable->type == FMU_REAL)
            values[i] = *(const double *)(const void *)member;
        else if (variable->type == FMU_INTEGER)
            values[i] = (double)*(const size_t *)(const void *)member;
        else
            values[i] = *(const int *)(const void *)member;
    }
}

// ---- the contact

static conditions conditions_of(const double values[FMU_NUM_VARIABLES], bool approach_given) {
    return (conditions){.given = values[approach_given ? FMU_APPROACH : FMU_LOAD],
                        .speed = (values[FMU_SPEED_1] + values[FMU_SPEED_2]) / 2,
                        .radius = values[FMU_RADIUS],
                        .sliding = values[FMU_SPEED_1] - values[FMU_SPEED_2]};
}

static conditions between(const conditions *from, const conditions *to, double part) {
    if (part == 1) return *to;
    return (conditions){.given = from->given + (to->given - from->given) * part,
                        .speed = from->speed + (to->speed - from->speed) * part,
                        .radius = from->radius + (to->radius - from->radius) * part,
                        .sliding = from->sliding + (to->sliding - from->sliding) * part};
}

static ehdrom_conditions for_library(const fmu_instance *self, const conditions *at) {
    ehdrom_conditions whole = EHDROM_CONDITIONS_INIT;

    whole.given = EHDROM_SPEED | EHDROM_RADIUS |
                  (self->contents.approach_given ? EHDROM_APPROACH : EHDROM_LOAD);
    whole.load = whole.approach = at->given;
    whole.speed = at->speed;
    whole.radius = at->radius;
    return whole;
}

/* Repeats the last internal step, or the start if there was no step, with the inputs `at`. */
static ehdrom_status repeat(fmu_instance *self, const conditions *at, ehdrom_result *result) {
    const ehdrom_conditions whole = for_library(self, at);

    return self->now.pending > 0 ? ehdrom_step(self->contact, &whole, self->now.pending, result)
                                 : ehdrom_start(self->contact, &whole, result);
}

static bool took(const fmu_instance *self, ehdrom_status status) {
    if (status == EHDROM_OK || status == EHDROM_UNTRUSTED) return true;
    return fail(self, "%s", ehdrom_contact_error(self->contact));
}

/* Checks the ratio of sliding to mean speed. If the sliding thins the film, this ratio must be the
 * scene's slide_roll at any speed. `at`: conditions, or their rates of change. */
static bool keeps_ratio(const fmu_instance *self, const conditions *at, const char *what) {
    const double expected = self->contents.ratio * at->speed;

    return isnan(expected) || fabs(at->sliding - expected) <= 1e-9 * fabs(expected) ||
           fail(self,
                "%s: found %g as the difference of the surfaces' speeds, expected %g: the film is "
                "thinned by the sliding (lubricant.shear.in_film) of the scene's slide_roll",
                what, at->sliding, expected);
}

/* Sets the FMU's parameters in the contact. */
static bool take_parameters(const fmu_instance *self, ehdrom_contact *contact) {
    ehdrom_status status = EHDROM_OK;

    for (size_t i = 0; i < FMU_NUM_VARIABLES && !status; i++) {
        const fmu_variable *variable = &fmu_variables[i];
        if (variable->role == FMU_PARAMETER && variable->key && self->contents.has[i])
            status = ehdrom_contact_set_number(contact, variable->key, self->now.values[i]);
    }
    if (!status) status = ehdrom_contact_set_accuracy(contact, self->now.values[FMU_ACCURACY]);
    return status ? fail(self, "%s", ehdrom_contact_error(contact)) : true;
}

static void tell_trust(const fmu_instance *self, const ehdrom_result *result) {
    if (!result->trusted && self->now.values[FMU_TRUSTED] != 0)
        say(self, FMU_DONE, "from %g s on: %s", self->now.time,
            ehdrom_contact_error(self->contact));
}

/* Solves the stationary contact of the inputs, unless the outputs already belong to them. */
static bool start(fmu_instance *self) {
    moment *now = &self->now;
    ehdrom_result result = EHDROM_RESULT_INIT;

    if (now->solved) return true;
    now->pending = now->last = 0;
    now->held = now->aimed = conditions_of(now->values, self->contents.approach_given);
    if (!keeps_ratio(self, &now->aimed, "start") || !take_parameters(self, self->contact) ||
        !took(self, repeat(self, &now->aimed, &result)))
        return false;
    now->values[FMU_TRUSTED] = 1;
    tell_trust(self, &result);
    take_outputs(now->values, &result);
    now->solved = true;
    self->has_stationary = self->slid = false;
    return true;
}

// ---- the stationary response

/* Sets parameters and conditions in self->stationary, the contact that computes the stationary
 * outputs such as the stiffness. The load of this contact is `force`, even if the FMU has the
 * approach and not the load as an input. */
static bool set_stationary(fmu_instance *self, const conditions *at, double force) {
    ehdrom_contact *contact = self->stationary;
    const struct {
        const char *key;
        double value;
    } settings[] = {
        {"physical.load", force}, {"physical.speed", at->speed}, {"physical.radius", at->radius}};
    ehdrom_status status = EHDROM_OK;

    if (!take_parameters(self, contact)) return false;
    for (size_t i = 0; i < sizeof settings / sizeof *settings && !status; i++)
        status = ehdrom_contact_set_number(contact, settings[i].key, settings[i].value);
    return status ? fail(self, "%s", ehdrom_contact_error(contact)) : true;
}

/* Computes the stationary outputs. They are NaN if the mean speed or the force is not above zero,
 * or if there is no solution. */
static bool respond(fmu_instance *self, const conditions *at, double force,
                    double values[FMU_NUM_VARIABLES]) {
    ehdrom_result result = EHDROM_RESULT_INIT;
    ehdrom_response response = EHDROM_RESPONSE_INIT;
    const bool moves = at->speed > 0 && force > 0;

    if (!self->stationary && !read_contact(self, &self->stationary)) return false;
    response.stiffness = response.damping = response.damping_bound = NAN;
    result.inlet_heating_factor = NAN;
    if (moves) {
        if (!set_stationary(self, at, force)) return false;
        ehdrom_status status = ehdrom_solve(self->stationary, &result);
        if (status == EHDROM_OK || status == EHDROM_UNTRUSTED)
            status = ehdrom_respond(self->stationary, &response);
        if (status) say(self, FMU_DONE, "stationary: %s", ehdrom_contact_error(self->stationary));
    }
    values[FMU_STIFFNESS] = response.stiffness;
    values[FMU_DAMPING] = response.damping;
    values[FMU_DAMPING_BOUND] = response.damping_bound;
    values[FMU_INLET_HEATING] = result.inlet_heating_factor;
    return true;
}

/* Computes the stationary outputs that belong to the present outputs, unless they are known. */
static bool update_stationary(fmu_instance *self) {
    moment *now = &self->now;

    if (!self->has_stationary)
        self->has_stationary = respond(self, &now->aimed, now->values[FMU_FORCE], now->values);
    return self->has_stationary;
}

// ---- traction

/* Computes the traction of the last step (or of the start) with the sliding at the step's end. */
static bool slide(fmu_instance *self, const conditions *at, double values[FMU_NUM_VARIABLES]) {
    ehdrom_traction traction = EHDROM_TRACTION_INIT;

    traction.size = offsetof(ehdrom_traction, indicated_deviation_friction); // no error estimate
    if (!took(self, self->now.pending > 0 ? ehdrom_slide_step(self->contact, at->sliding, &traction)
                                          : ehdrom_slide(self->contact, at->sliding, &traction)))
        return false;
    values[FMU_FRICTION] = traction.friction_force;
    values[FMU_FRICTION_COEFFICIENT] = traction.friction_coefficient;
    values[FMU_POWER] = traction.power_loss;
    values[FMU_ROLLING] = traction.rolling_resistance;
    values[FMU_ROLLING_MOMENT] = traction.rolling_moment;
    values[FMU_MEAN_STRESS] = traction.mean_shear_stress;
    values[FMU_LARGEST_STRESS] = traction.largest_shear_stress;
    return true;
}

/* Computes the traction that belongs to the present outputs, unless it is known. */
static bool slide_now(fmu_instance *self) {
    if (!self->slid) self->slid = slide(self, &self->now.aimed, self->now.values);
    return self->slid;
}

// ---- modes

bool fmu_setup(fmu_instance *self, double start_time, double stop, double tolerance) {
    if (!in_mode(self, MODE_INSTANTIATED, "setup")) return false;
    if (!isfinite(start_time) || !(stop >= start_time) || !(tolerance >= 0))
        return fail(self,
                    "setup: found start %g s, stop %g s, tolerance %g, expected a finite start, a "
                    "later stop and a tolerance that is not negative",
                    start_time, stop, tolerance);
    self->now.time = start_time;
    self->now.stop = stop;
    if (tolerance > 0) self->now.values[FMU_STEP_ACCURACY] = tolerance;
    return true;
}

bool fmu_enter_initialization(fmu_instance *self) {
    if (!in_mode(self, MODE_INSTANTIATED, "initialization")) return false;
    self->now.mode = MODE_INITIALIZATION;
    return true;
}

bool fmu_exit_initialization(fmu_instance *self) {
    if (!in_mode(self, MODE_INITIALIZATION, "end of initialization") || !start(self)) return false;
    self->now.mode = MODE_STEP;
    return true;
}

bool fmu_terminate(fmu_instance *self) {
    if (!in_mode(self, MODE_STEP, "terminate")) return false;
    self->now.mode = MODE_TERMINATED;
    return true;
}

bool fmu_reset(fmu_instance *self) {
    set_to_start(self);
    return true;
}

// ---- steps

static bool accept(fmu_instance *self) {
    moment *now = &self->now;

    if (!(now->pending > 0)) return true;
    if (ehdrom_accept(self->contact)) return fail(self, "%s", ehdrom_contact_error(self->contact));
    now->last = now->pending;
    now->held = now->aimed;
    now->pending = 0;
    return true;
}

/* Largest number of halvings of a step that does not converge. The step is then a millionth of the
 * communication step, and the communication step is discarded (fmu.bats, "a step that cannot be
 * done changes nothing"). */
enum { MOST_HALVINGS = 20 };

/* A communication step is discarded if it hardly proceeds. This is checked after every
 * WATCHED_ATTEMPTS attempts. At the rate of these attempts, the rest of the step must not take more
 * than MOST_ATTEMPTS attempts. Without this check one step of fmu.bats, "a step that cannot be done
 * changes nothing", took more than 17 minutes. In this test the given load changes to a value that
 * no contact can have, but steps of a millionth may still converge. */
enum { WATCHED_ATTEMPTS = 100, MOST_ATTEMPTS = 100000 };

/* Largest number of halvings of a step whose local error is too large. After these halvings the
 * error is taken as noise. A local error is proportional to the third power of the step; after a
 * kink of the inputs, to the second or first power. For the line contact of fmu.bats, "a tolerance
 * below the solver's noise", errors stop falling after 6 to 10 halvings, at 2e-8 to 8e-8 of the
 * film. */
enum { MOST_FOR_ERROR = 10 };

// Factor by which the accepted noise falls from one step to the next, as NOISE_KEPT in march.c
// (fmu.bats, "a tolerance below the solver's noise is no error")
static const double NOISE_KEPT = 0.9;

/* A communication step. It is divided into fractions that are powers of 1/2, so that their sum is
 * exact. */
typedef struct stretch {
    double step;         // s
    conditions from, to; // inputs at its beginning and end
    double done, part;   // fractions of the communication step: finished, and in the next attempt
    size_t steps, attempts;
    double mark; // value of `done` when the present WATCHED_ATTEMPTS attempts began
    // of the attempts since `done` last increased:
    int halvings;
    double error; // local error of the last attempt, which was twice as long; 0: there was no
                  // attempt, or it did not converge
    int idle;     // halvings in a row that hardly reduced the error
} stretch;

/* Checks whether the next attempt would be more than twice as long as the last step. */
static bool grows_too_much(const moment *now, const stretch *of) {
    return now->last > 0 && of->part * of->step > 2 * now->last;
}

static fmu_outcome halve(stretch *of) {
    of->part /= 2;
    of->halvings++;
    return FMU_DONE;
}

/* Checks whether a local error is noise of the solver, which shorter steps do not reduce. If so,
 * errors of this size are accepted for some steps, as in march_run. */
static bool is_noise(fmu_instance *self, stretch *of, double error, double accuracy) {
    moment *now = &self->now;

    // halving a step at least halves its error, also after a kink of the inputs, unless the error
    // is noise
    of->idle = of->error > 0 && error > 0.75 * of->error ? of->idle + 1 : 0;
    of->error = error;
    if (of->idle < 2 && of->part > ldexp(1, -MOST_FOR_ERROR)) return false;
    if (!now->noisy)
        say(self, FMU_DONE,
            "from %g s on: found a local error of %.2g that shorter steps do not make smaller, "
            "expected %g (step_accuracy)",
            now->time + of->step * of->done, error, accuracy);
    now->noise = error;
    now->noisy = true;
    return true;
}

static void take_part(moment *now, stretch *of, const conditions *at) {
    now->pending = of->step * of->part;
    now->aimed = *at;
    now->noise *= NOISE_KEPT;
    of->done += of->part;
    of->steps++;
    of->halvings = of->idle = 0;
    of->error = 0;
    // doubles the next part if the rest is a multiple of the doubled part
    if (fmod(of->done, 2 * of->part) == 0) of->part *= 2;
}

/* Takes one internal step, or halves the part for the next attempt. */
static fmu_outcome go_on(fmu_instance *self, stretch *of, ehdrom_result *result) {
    moment *now = &self->now;
    const conditions at = between(&of->from, &of->to, of->done + of->part);
    const ehdrom_conditions whole = for_library(self, &at);
    const double accuracy = now->values[FMU_STEP_ACCURACY];
    const ehdrom_status status = ehdrom_step(self->contact, &whole, of->step * of->part, result);

    if (EHDROM_FAILED(status)) {
        // inputs that are refused discard the step, since the importer may try other inputs
        const fmu_outcome outcome = status == EHDROM_DATA ? FMU_DISCARDED : FMU_FAILED;
        say(self, outcome, "step to %g s: %s", now->time + of->step,
            ehdrom_contact_error(self->contact));
        return outcome;
    }
    if (status == EHDROM_NOT_CONVERGED) {
        of->error = 0;
        if (of->halvings < MOST_HALVINGS) return halve(of);
        say(self, FMU_DISCARDED, "step to %g s: %s, also in a step of %g s", now->time + of->step,
            ehdrom_contact_error(self->contact), of->step * of->part);
        return FMU_DISCARDED;
    }
    const double accepted = fmax(accuracy, 2 * now->noise);
    if (accuracy > 0 && result->local_error > accepted &&
        !is_noise(self, of, result->local_error, accuracy))
        return halve(of);
    take_part(now, of, &at);
    return FMU_DONE;
}

/* Checks whether the last attempts have hardly advanced. */
static bool stands_still(fmu_instance *self, stretch *of) {
    const double done = of->done - of->mark;

    if (++of->attempts % WATCHED_ATTEMPTS != 0) return false;
    of->mark = of->done;
    if (done / WATCHED_ATTEMPTS * MOST_ATTEMPTS >= 1 - of->done) return false;
    say(self, FMU_DISCARDED,
        "step to %g s: found %d attempts between %.10g and %.10g s, expected them to get further",
        self->now.time + of->step, WATCHED_ATTEMPTS, self->now.time + of->step * (of->done - done),
        self->now.time + of->step * of->done);
    return true;
}

static fmu_outcome cross(fmu_instance *self, stretch *of, ehdrom_result *result) {
    fmu_outcome outcome = FMU_DONE;

    while (of->done < 1 && outcome == FMU_DONE) {
        if (!accept(self)) return FMU_FAILED;
        while (grows_too_much(&self->now, of))
            of->part /= 2;
        outcome = go_on(self, of, result);
        if (outcome == FMU_DONE && stands_still(self, of)) outcome = FMU_DISCARDED;
    }
    return outcome;
}

/* Checks begin and end of a step. Allows for round-off, since importers may add up steps. */
static bool check_times(const fmu_instance *self, double time, double step) {
    const double slack = 1e-6 * step + 1e-12 * fabs(time);

    if (!(step > 0) || isinf(step))
        return fail(self, "step: found %g s, expected a positive number", step);
    if (!(fabs(time - self->now.time) <= slack))
        return fail(self, "step: found %.17g s as its begin, expected %.17g s", time,
                    self->now.time);
    if (!(time + step <= self->now.stop + slack))
        return fail(self, "step: found %.17g s as its end, expected at most the stop time %.17g s",
                    time + step, self->now.stop);
    return true;
}

/* Restores the state before a step that failed or was discarded. */
static void go_back(fmu_instance *self) {
    if (!fmu_state_set(self, self->before)) self->now.mode = MODE_TERMINATED;
}

fmu_outcome fmu_step(fmu_instance *self, double time, double step) {
    moment *now = &self->now;
    ehdrom_result result = EHDROM_RESULT_INIT;

    if (!in_mode(self, MODE_STEP, "step") || !check_times(self, time, step)) return FMU_FAILED;
    stretch of = {.step = step,
                  .from = now->pending > 0 ? now->aimed : now->held,
                  .to = conditions_of(now->values, self->contents.approach_given),
                  .part = 1};
    if (!keeps_ratio(self, &of.to, "step") || !fmu_state_get(self, &self->before))
        return FMU_FAILED;
    const fmu_outcome outcome = cross(self, &of, &result);
    if (outcome != FMU_DONE) {
        go_back(self);
        return outcome;
    }
    now->time = time + step;
    tell_trust(self, &result);
    take_outputs(now->values, &result);
    now->values[FMU_STEPS] = (double)of.steps;
    self->has_stationary = self->slid = false;
    return FMU_DONE;
}

double fmu_time(const fmu_instance *self) {
    return self->now.time;
}

// ---- derivatives

/* Relative change of the inputs for central differences (README.md, Directional derivatives). */
static const double relative_change = 1e-3;

/* Returns the scale of an input. In a central difference the change of the input is proportional to
 * this scale. */
static double scale_of(const fmu_instance *self, unsigned reference) {
    const double *values = self->now.values;

    if (reference == FMU_APPROACH) return values[FMU_CENTRAL_FILM];
    if (reference == FMU_SPEED_1 || reference == FMU_SPEED_2)
        return fabs(values[FMU_SPEED_1] + values[FMU_SPEED_2]);
    return fabs(values[reference]);
}

/* Returns the change of the inputs on each side of a central difference, as a multiple of the
 * direction. 0: the direction is zero; -1: an input that should change has no scale. */
static double reach(const fmu_instance *self, const fmu_direction *of) {
    double most = 0;

    for (size_t i = 0; i < of->num_knowns; i++) {
        const double scale = scale_of(self, of->knowns[i]);
        if (of->along[i] == 0) continue;
        if (!(scale > 0)) {
            say(self, FMU_FAILED, "derivative: found %s at rest, expected a value to change",
                fmu_variables[of->knowns[i]].name);
            return -1;
        }
        most = fmax(most, fabs(of->along[i]) / scale);
    }
    return most > 0 ? relative_change / most : 0;
}

/* Returns the rates of change of the conditions along a direction. */
static conditions rate_of(const fmu_instance *self, const fmu_direction *of) {
    double rates[FMU_NUM_VARIABLES] = {0};

    for (size_t i = 0; i < of->num_knowns; i++)
        rates[of->knowns[i]] += of->along[i];
    return conditions_of(rates, self->contents.approach_given);
}

/* Computes the outputs for the inputs plus `length` times the direction. */
static bool outputs_at(fmu_instance *self, double outputs[FMU_NUM_VARIABLES],
                       const fmu_direction *of, double length, bool stationary, bool friction) {
    ehdrom_result result = EHDROM_RESULT_INIT;
    const conditions rate = rate_of(self, of);
    conditions at = self->now.aimed;

    at.given += rate.given * length;
    at.speed += rate.speed * length;
    at.radius += rate.radius * length;
    at.sliding += rate.sliding * length;
    if (!took(self, repeat(self, &at, &result))) return false;
    take_outputs(outputs, &result);
    return (!friction || slide(self, &at, outputs)) &&
           (!stationary || respond(self, &at, result.load, outputs));
}

/* Computes the derivatives that are still NaN. Repeats the last step (or the start) with other
 * inputs (`repeat`) and takes central differences of the outputs. */
static bool by_differences(fmu_instance *self, const fmu_direction *of, double derivative[]) {
    double before[FMU_NUM_VARIABLES] = {0}, behind[FMU_NUM_VARIABLES] = {0};
    const double length = reach(self, of);
    ehdrom_result result = EHDROM_RESULT_INIT;
    bool stationary = false, friction = false;

    if (length < 0) return false;
    for (size_t k = 0; k < of->num_unknowns; k++) {
        stationary |= is_stationary(of->unknowns[k]);
        friction |= is_friction(of->unknowns[k]);
    }
    const bool found = outputs_at(self, behind, of, length, stationary, friction) &&
                       outputs_at(self, before, of, -length, stationary, friction);
    // goes back to the present inputs, with bit-identical outputs
    if (!took(self, repeat(self, &self->now.aimed, &result)) || !found) return false;
    for (size_t k = 0; k < of->num_unknowns; k++) {
        const unsigned unknown = of->unknowns[k];
        if (isnan(derivative[k]))
            derivative[k] = length > 0 ? (behind[unknown] - before[unknown]) / (2 * length) : 0;
    }
    return true;
}

/* Computes the derivatives by the library's tangent. A derivative is NaN if its output has no
 * tangent, or if the library fails. */
static void by_tangent(fmu_instance *self, const fmu_direction *of, double derivative[]) {
    ehdrom_derivatives found = EHDROM_DERIVATIVES_INIT;
    const conditions rate = rate_of(self, of);
    const ehdrom_conditions whole = for_library(self, &rate);
    const bool there = ehdrom_differentiate(self->contact, &whole, &found) == EHDROM_OK;
    for (size_t k = 0; k < of->num_unknowns; k++) {
        const size_t offset = fmu_variables[of->unknowns[k]].derivative;
        const char *member = (const char *)&found + offset;
        derivative[k] = there && offset > 0 ? *(const double *)(const void *)member : NAN;
    }
}

/* Checks that the unknowns are outputs, the knowns are inputs, and that there is a solution. */
static bool can_derive(fmu_instance *self, const fmu_direction *of) {
    for (size_t k = 0; k < of->num_unknowns; k++) {
        const fmu_variable *variable = find(self, of->unknowns[k], FMU_REAL);
        if (!variable) return false;
        if (variable->role != FMU_OUTPUT)
            return fail(self, "derivative: found of %s, expected of an output", variable->name);
    }
    if (self->now.mode == MODE_INITIALIZATION ? !start(self)
                                              : !in_mode(self, MODE_STEP, "derivative"))
        return false;
    for (size_t i = 0; i < of->num_knowns; i++) {
        const fmu_variable *variable = find(self, of->knowns[i], FMU_REAL);
        if (!variable) return false;
        if (variable->role != FMU_INPUT || !isfinite(of->along[i]))
            return fail(self, "derivative: found by %s in direction %g, expected by an input",
                        variable->name, of->along[i]);
    }
    return true;
}

bool fmu_derivative(fmu_instance *self, const fmu_direction *of, double derivative[]) {
    if (!can_derive(self, of)) return false;
    const conditions rate = rate_of(self, of);
    if (!keeps_ratio(self, &rate, "derivative")) return false;
    by_tangent(self, of, derivative);
    bool whole = true;
    for (size_t k = 0; k < of->num_unknowns; k++)
        whole = whole && !isnan(derivative[k]);
    return whole || by_differences(self, of, derivative);
}

// ---- states

static bool has_contact(const moment *of) {
    return of->mode >= MODE_STEP;
}

static bool count_numbers(fmu_instance *self, size_t *count) {
    *count = 0;
    return took(self, ehdrom_state_size(self->contact, count));
}

/* A saved state: the bytes of a struct `moment`, followed, from step mode on, by the numbers of
 * ehdrom_state_save. */
typedef struct fmu_state {
    size_t size; // number of bytes
    unsigned char bytes[];
} fmu_state;

static double *numbers_of(fmu_state *state) {
    return (double *)(void *)(state->bytes + sizeof(moment));
}

size_t fmu_state_size(const void *state) {
    return state ? ((const fmu_state *)state)->size : 0;
}

/* Allocates `*state` for `size` bytes, unless it has this size. Returns NULL if there is no
 * memory. */
static fmu_state *make_state(fmu_instance *self, void **state, size_t size) {
    if (fmu_state_size(*state) != size || !*state) {
        fmu_state *made = realloc(*state, sizeof *made + size);
        if (!made) {
            say(self, FMU_FAILED, "state: out of memory");
            return NULL;
        }
        made->size = size;
        *state = made;
    }
    return *state;
}

bool fmu_state_get(fmu_instance *self, void **state) {
    const moment *now = &self->now;
    size_t count = 0;

    if (has_contact(now) && !count_numbers(self, &count)) return false;
    fmu_state *made = make_state(self, state, sizeof *now + count * sizeof(double));
    if (!made) return false;
    memcpy(made->bytes, now, sizeof *now);
    return count == 0 || took(self, ehdrom_state_save(self->contact, numbers_of(made), count));
}

/* Checks bytes that the importer supplies. They must belong to this FMU, and contain numbers of a
 * contact exactly if the state's mode has a contact. */
static bool check_state(const fmu_instance *self, const void *bytes, size_t size) {
    moment of;

    if (bytes && size >= sizeof of) {
        memcpy(&of, bytes, sizeof of);
        if (memcmp(of.mark, state_mark, sizeof of.mark) == 0 &&
            memcmp(of.token, self->contents.token, sizeof of.token) == 0 &&
            of.mode <= MODE_TERMINATED && (size - sizeof of) % sizeof(double) == 0 &&
            has_contact(&of) == (size > sizeof of))
            return true;
    }
    return fail(self, "state: found another content, expected one that this FMU has saved");
}

static bool restore(fmu_instance *self, fmu_state *state) {
    const size_t count = (state->size - sizeof self->now) / sizeof(double);
    ehdrom_result result = EHDROM_RESULT_INIT;

    self->has_stationary = self->slid = false;
    // repeats the step that was not accepted yet (or the start), with bit-identical results
    return take_parameters(self, self->contact) &&
           took(self, ehdrom_state_restore(self->contact, numbers_of(state), count)) &&
           took(self, repeat(self, &self->now.aimed, &result));
}

bool fmu_state_set(fmu_instance *self, void *state) {
    fmu_state *saved = state;

    if (!saved || !check_state(self, saved->bytes, saved->size)) return false;
    memcpy(&self->now, saved->bytes, sizeof self->now);
    if (has_contact(&self->now)) return restore(self, saved);
    self->has_stationary = self->slid = false;
    self->now.solved = false; // the contact may be in another state and must be solved again
    return true;
}

bool fmu_state_write(fmu_instance *self, const void *state, void *bytes, size_t size) {
    const fmu_state *saved = state;

    if (!saved || size < saved->size)
        return fail(self, "state: found room for %zu bytes, expected %zu", size,
                    fmu_state_size(saved));
    memcpy(bytes, saved->bytes, saved->size);
    return true;
}

bool fmu_state_read(fmu_instance *self, void **state, const void *bytes, size_t size) {
    fmu_state *made = check_state(self, bytes, size) ? make_state(self, state, size) : NULL;

    if (made) memcpy(made->bytes, bytes, size);
    return made;
}
