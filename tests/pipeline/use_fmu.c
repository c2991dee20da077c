/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Imports FMUs of both versions of FMI, for fmu.bats:
 *
 *     use_fmu 2|3 FOLDER run STEPS [SAVED AT]   makes steps, prints all outputs after each; saves the state after step AT
 *     use_fmu 2|3 FOLDER restore STEPS SAVED AT restores the state and makes the steps after AT
 *     use_fmu 2|3 FOLDER parts                  compares a long step with its internal steps
 *     use_fmu 2|3 FOLDER calls NAME…            makes all supported calls, in and out of order; unsupported ones by name
 *     use_fmu 2|3 FOLDER derivatives            compares derivatives with differences
 *     use_fmu 2|3 FOLDER far                    makes steps that cannot succeed
 *     use_fmu 2|3 FOLDER apart                  parts the bodies and brings them together again
 *     use_fmu 2|3 FOLDER tolerances             makes steps with tolerances down to 1e-9
 *     use_fmu library FOLDER STEPS [LOAD SPEED RADIUS [slide]]  like run, by ehdrom.h; the values are those of the scene;
 *                                               with `slide` also traction and inlet heating
 *
 * FOLDER is an unpacked FMU. The exit code is 0 if all is as expected. */
#include "romrun/fmu/fmi2.h"
#include "romrun/fmu/fmi3.h"
#include "romrun/library/ehdrom.h"

#include <dlfcn.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPECT(condition)                                                                          \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: found it not: %s\n", __FILE__, __LINE__, #condition);          \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

enum { MAX_VARIABLES = 64 };

/* A variable of modelDescription.xml. */
typedef struct variable {
    char name[64], causality[16], type[16];
    unsigned reference;
} variable;

static int version;
static void *object;
static void *instance;
static char folder[PATH_MAX], token[64];
static variable variables[MAX_VARIABLES];
static size_t num_variables;
static int num_errors, num_notes, num_discarded;

// ---- modelDescription.xml, read line by line; enough for this FMU only

static void take_attribute(char *value, size_t size, const char *line, const char *name) {
    char start[64];

    snprintf(start, sizeof start, " %s=\"", name);
    const char *found = strstr(line, start);
    value[0] = '\0';
    if (!found) return;
    found += strlen(start);
    snprintf(value, size, "%.*s", (int)strcspn(found, "\""), found);
}

static void read_description(void) {
    char path[PATH_MAX + 64], line[1024], number[16];

    snprintf(path, sizeof path, "%s/modelDescription.xml", folder);
    FILE *file = fopen(path, "r");
    EXPECT(file);
    while (fgets(line, sizeof line, file)) {
        variable *one = &variables[num_variables];
        if (strstr(line, "<fmiModelDescription"))
            take_attribute(token, sizeof token, line, version == 2 ? "guid" : "instantiationToken");
        if (!strstr(line, " valueReference=") || !strstr(line, " causality=")) continue;
        take_attribute(one->name, sizeof one->name, line, "name");
        take_attribute(one->causality, sizeof one->causality, line, "causality");
        take_attribute(number, sizeof number, line, "valueReference");
        one->reference = (unsigned)atoi(number);
        snprintf(one->type, sizeof one->type, "%s",
                 strstr(line, "<Boolean")                             ? "Boolean"
                 : strstr(line, "<Integer") || strstr(line, "<Int32") ? "Integer"
                                                                      : "Real");
        num_variables++;
    }
    fclose(file);
}

static const variable *find(const char *name, const char *causality) {
    for (size_t i = 0; i < num_variables; i++)
        if (strcmp(variables[i].name, name) == 0 &&
            (!causality || strcmp(variables[i].causality, causality) == 0))
            return &variables[i];
    fprintf(stderr, "%s: found no such variable\n", name);
    exit(1);
}

// ---- calls of either version

static bool has(const char *name) {
    for (size_t i = 0; i < num_variables; i++)
        if (strcmp(variables[i].name, name) == 0) return true;
    return false;
}

static void *symbol(const char *name) {
    char whole[64];

    snprintf(whole, sizeof whole, "fmi%d%s", version, name);
    void *found = dlsym(object, whole);
    EXPECT(found);
    return found;
}
#define CALL2(name, ...) (((__typeof__(fmi2##name) *)symbol(#name))(__VA_ARGS__))
#define CALL3(name, ...) (((__typeof__(fmi3##name) *)symbol(#name))(__VA_ARGS__))
/* Calls a function that has the same name and arguments in both versions. */
#define CALL(name, ...)                                                                            \
    (version == 2 ? (int)CALL2(name, __VA_ARGS__) : (int)CALL3(name, __VA_ARGS__))

static void show2(void *to, fmi2String name, fmi2Status status, fmi2String category,
                  fmi2String message, ...) {
    va_list arguments;

    EXPECT(to == &num_errors && strcmp(name, "one") == 0);
    status == fmi2Error ? num_errors++ : status == fmi2Discard ? num_discarded++ : num_notes++;
    fprintf(stderr, "%s: ", category);
    va_start(arguments, message);
    vfprintf(stderr, message, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

static void show3(void *to, fmi3Status status, fmi3String category, fmi3String message) {
    EXPECT(to == &num_errors);
    status == fmi3Error ? num_errors++ : status == fmi3Discard ? num_discarded++ : num_notes++;
    fprintf(stderr, "%s: %s\n", category, message);
}

static void *instantiate(const char *with_token) {
    static const fmi2CallbackFunctions functions = {show2, NULL, NULL, NULL, &num_errors};
    char place[PATH_MAX + 64];

    if (version == 2) {
        // a URI with an escape: %73 is an s
        snprintf(place, sizeof place, "file://%s/re%%73ources", folder);
        return CALL2(Instantiate, "one", fmi2CoSimulation, with_token, place, &functions, 0, 1);
    }
    snprintf(place, sizeof place, "%s/resources/", folder);
    return CALL3(InstantiateCoSimulation, "one", with_token, place, false, true, false, true, NULL,
                 0, &num_errors, show3, NULL);
}

static void load(void) {
    char path[PATH_MAX + 64];

    read_description();
    snprintf(path, sizeof path, "%s/binaries/%s/ehdrom_contact.so", folder,
             version == 2 ? "linux64" : "x86_64-linux");
    object = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!object) fprintf(stderr, "%s\n", dlerror());
    EXPECT(object);
    instance = instantiate(token);
    EXPECT(instance);
}

static int enter(double tolerance, double stop) {
    if (version == 3)
        return CALL3(EnterInitializationMode, instance, tolerance > 0, tolerance, 0, stop > 0,
                     stop);
    const int status =
        CALL2(SetupExperiment, instance, tolerance > 0, tolerance, 0, stop > 0, stop);
    return status ? status : (int)CALL2(EnterInitializationMode, instance);
}

static void begin(double tolerance) {
    EXPECT(enter(tolerance, 0) == 0);
    EXPECT(CALL(ExitInitializationMode, instance) == 0);
}

static int set(const char *name, double value) {
    const unsigned reference = find(name, NULL)->reference;

    return version == 2 ? (int)CALL2(SetReal, instance, &reference, 1, &value)
                        : (int)CALL3(SetFloat64, instance, &reference, 1, &value, 1);
}

static double get(const variable *of) {
    const unsigned reference = of->reference;
    double value = NAN;
    int whole = 0;
    bool is = false;
    int status = 0;

    if (strcmp(of->type, "Real") == 0)
        status = version == 2 ? (int)CALL2(GetReal, instance, &reference, 1, &value)
                              : (int)CALL3(GetFloat64, instance, &reference, 1, &value, 1);
    else if (strcmp(of->type, "Integer") == 0)
        status = version == 2 ? (int)CALL2(GetInteger, instance, &reference, 1, &whole)
                              : (int)CALL3(GetInt32, instance, &reference, 1, &whole, 1);
    else
        status = version == 2 ? (int)CALL2(GetBoolean, instance, &reference, 1, &whole)
                              : (int)CALL3(GetBoolean, instance, &reference, 1, &is, 1);
    EXPECT(status == 0);
    if (strcmp(of->type, "Real") == 0) return value;
    return strcmp(of->type, "Boolean") == 0 && version == 3 ? is : whole;
}

static double output(const char *name) {
    return get(find(name, "output"));
}

static int step(double time, double length) {
    bool event = true, end = true, early = true;
    double last = NAN;

    if (version == 2) return CALL2(DoStep, instance, time, length, 1);
    const int status = CALL3(DoStep, instance, time, length, true, &event, &end, &early, &last);
    EXPECT(!event && !end && !early && last == (status ? get(find("time", NULL)) : time + length));
    return status;
}

// ---- a trajectory: load or approach, and speed, oscillate

static const double duration = 250e-6; // s, about one a/u of the scene

static double swing(double part) {
    return 1 + 0.1 * sin(2 * 3.14159265358979 * part);
}

static double given_start, speed_start;
static const char *given_name;

static void look_at_start(void) {
    given_name = "load";
    for (size_t i = 0; i < num_variables; i++)
        if (strcmp(variables[i].name, "approach") == 0 &&
            strcmp(variables[i].causality, "input") == 0)
            given_name = "approach";
    given_start = get(find(given_name, "input"));
    speed_start = get(find("surface_speed_1", "input"));
}

static double given_at(double part) {
    return strcmp(given_name, "load") == 0
               ? given_start * swing(part)
               : given_start + 0.1 * fabs(given_start) * (swing(part) - 1);
}

static void set_inputs(double part) {
    EXPECT(set(given_name, given_at(part)) == 0);
    EXPECT(set("surface_speed_1", speed_start * swing(2 * part) + 0.25) == 0);
    EXPECT(set("surface_speed_2", speed_start * swing(2 * part) - 0.25) == 0);
}

static void print_outputs(size_t number) {
    printf("%zu", number);
    for (size_t i = 0; i < num_variables; i++)
        if (strcmp(variables[i].causality, "output") == 0)
            printf(" %s=%a", variables[i].name, get(&variables[i]));
    printf("\n");
}

static void save(const char *path) {
    size_t size = 0, size_again = 1;
    void *state = NULL;

    EXPECT(version == 2 ? !CALL2(GetFMUstate, instance, &state)
                        : !CALL3(GetFMUState, instance, &state));
    EXPECT(version == 2 ? !CALL2(SerializedFMUstateSize, instance, state, &size)
                        : !CALL3(SerializedFMUStateSize, instance, state, &size));
    char *bytes = malloc(size);
    EXPECT(bytes);
    EXPECT(version == 2 ? !CALL2(SerializeFMUstate, instance, state, bytes, size)
                        : !CALL3(SerializeFMUState, instance, state, (uint8_t *)bytes, size));
    EXPECT(version == 2 ? CALL2(SerializeFMUstate, instance, state, bytes, size - 1) == fmi2Error
                        : CALL3(SerializeFMUState, instance, state, (uint8_t *)bytes, size - 1) ==
                              fmi3Error);
    // overwrites the same memory with the state again
    EXPECT(version == 2 ? !CALL2(GetFMUstate, instance, &state)
                        : !CALL3(GetFMUState, instance, &state));
    EXPECT(version == 2 ? !CALL2(SerializedFMUstateSize, instance, state, &size_again)
                        : !CALL3(SerializedFMUStateSize, instance, state, &size_again));
    EXPECT(size == size_again);
    FILE *file = fopen(path, "wb");
    EXPECT(file && fwrite(bytes, 1, size, file) == size && fclose(file) == 0);
    EXPECT(version == 2 ? !CALL2(FreeFMUstate, instance, &state)
                        : !CALL3(FreeFMUState, instance, &state));
    EXPECT(!state);
    free(bytes);
}

static int put_back(const char *path, size_t cut) {
    static char bytes[1 << 20];
    void *state = NULL;
    FILE *file = fopen(path, "rb");

    EXPECT(file);
    const size_t size = fread(bytes, 1, sizeof bytes, file) - cut;
    fclose(file);
    int status = version == 2
                     ? (int)CALL2(DeSerializeFMUstate, instance, bytes, size, &state)
                     : (int)CALL3(DeserializeFMUState, instance, (uint8_t *)bytes, size, &state);
    if (!status)
        status = version == 2 ? (int)CALL2(SetFMUstate, instance, state)
                              : (int)CALL3(SetFMUState, instance, state);
    if (state)
        EXPECT(version == 2 ? !CALL2(FreeFMUstate, instance, &state)
                            : !CALL3(FreeFMUState, instance, &state));
    return status;
}

static void finish(void) {
    EXPECT(CALL(Terminate, instance) == 0);
    version == 2 ? CALL2(FreeInstance, instance) : CALL3(FreeInstance, instance);
    EXPECT(dlclose(object) == 0);
}

static void march(size_t from, size_t steps, bool print, const char *saved, size_t at) {
    const double length = duration / (double)steps;

    for (size_t i = from; i < steps; i++) {
        set_inputs((double)(i + 1) / (double)steps);
        EXPECT(step((double)i * length, length) == 0);
        if (print) print_outputs(i + 1);
        if (saved && i + 1 == at) save(saved);
    }
}

static void run(int argc, char **argv) {
    const size_t steps = strtoul(argv[4], NULL, 10);

    look_at_start();
    begin(0);
    print_outputs(0);
    march(0, steps, true, argc > 6 ? argv[5] : NULL, argc > 6 ? strtoul(argv[6], NULL, 10) : 0);
    finish();
}

static void restore(char **argv) {
    look_at_start();
    EXPECT(put_back(argv[5], 8) == 3 && put_back(argv[5], 3) == 3);
    EXPECT(put_back(argv[5], 0) == 0);
    march(strtoul(argv[6], NULL, 10), strtoul(argv[4], NULL, 10), true, NULL, 0);
    finish();
}

/* Checks that a step that is much longer than the previous one is divided into three internal
 * steps. The film must equal the film after the same three steps, requested one by one. */
static void parts(void) {
    static const double ends[] = {0, 2e-6, 4e-6, 8e-6};
    double film = 0;

    look_at_start();
    const double end = given_at(0.03);
    for (int by_one = 0; by_one < 2; by_one++) {
        begin(0);
        EXPECT(set(given_name, given_start) == 0 && step(0, 1e-6) == 0);
        for (size_t i = 1; by_one && i < 4; i++) {
            const double part = ends[i] / ends[3];
            EXPECT(set(given_name, part == 1 ? end : given_start + (end - given_start) * part) ==
                   0);
            EXPECT(step(1e-6 + ends[i - 1], ends[i] - ends[i - 1]) == 0);
        }
        EXPECT(set(given_name, end) == 0 && (by_one || step(1e-6, ends[3]) == 0));
        EXPECT(output("internal_steps") == (by_one ? 1 : 3));
        EXPECT(by_one == 0 || output("central_film_thickness") == film);
        film = output("central_film_thickness");
        EXPECT(CALL(Reset, instance) == 0);
    }
}

// ---- all calls of the interface

static void try_others(char **names, int count) {
    static double room[64];

    // an unsupported call uses only its instance, so the other arguments may have any value
    for (int i = 0; i < count; i++) {
        int (*call)(void *, void *, size_t, void *, void *, void *) =
            (int (*)(void *, void *, size_t, void *, void *, void *))dlsym(object, names[i]);
        if (!call) fprintf(stderr, "%s\n", names[i]);
        EXPECT(call);
        EXPECT(call(instance, room, 0, room, room, room) == 3);
    }
}

static void calls_of_2(void) {
    fmi2Status status = fmi2OK;
    fmi2Real last = NAN;
    fmi2Boolean ended = 1;

    EXPECT(strcmp(CALL2(GetTypesPlatform), "default") == 0);
    EXPECT(CALL2(GetRealStatus, instance, fmi2LastSuccessfulTime, &last) == fmi2OK && last == 0);
    EXPECT(CALL2(GetRealStatus, instance, fmi2PendingStatus, &last) == fmi2Error);
    EXPECT(CALL2(GetBooleanStatus, instance, fmi2Terminated, &ended) == fmi2OK && !ended);
    EXPECT(CALL2(GetStatus, instance, fmi2DoStepStatus, &status) == fmi2Error);
    EXPECT(CALL2(SetInteger, instance, NULL, 0, NULL) == fmi2OK);
    EXPECT(CALL2(SetBoolean, instance, NULL, 0, NULL) == fmi2OK);
    EXPECT(!CALL2(Instantiate, "one", fmi2ModelExchange, token, folder, NULL, 0, 0));
}

static void calls_of_3(void) {
    EXPECT(!CALL3(InstantiateModelExchange, "one", token, folder, 0, 0, &num_errors, show3));
    EXPECT(!CALL3(InstantiateScheduledExecution, "one", token, folder, 0, 0, &num_errors, show3,
                  NULL, NULL, NULL));
    EXPECT(!CALL3(InstantiateCoSimulation, "one", token, folder, 0, 0, true, false, NULL, 0,
                  &num_errors, show3, NULL));
    EXPECT(num_errors == 4); // three errors here, and one before in the function `calls`
    EXPECT(CALL3(SetInt32, instance, NULL, 0, NULL, 0) == fmi3OK);
    EXPECT(CALL3(SetBoolean, instance, NULL, 0, NULL, 0) == fmi3OK);
    const unsigned reference = 0;
    double two[2] = {0};
    EXPECT(CALL3(GetFloat64, instance, &reference, 1, two, 2) == fmi3Error);
}

static void calls(char **names, int count) {
    char version_text[8];

    snprintf(version_text, sizeof version_text, "%d.0", version);
    EXPECT(strcmp(version == 2 ? CALL2(GetVersion) : CALL3(GetVersion), version_text) == 0);
    EXPECT(!instantiate("{another}") && num_errors == 1);
    version == 2 ? calls_of_2() : calls_of_3();
    try_others(names, count);
    EXPECT(CALL(SetDebugLogging, instance, 1, 0, NULL) == 0);
    // out of order
    EXPECT(step(0, 1e-6) == 3 && CALL(Terminate, instance) == 3);
    EXPECT(CALL(ExitInitializationMode, instance) == 3);
    EXPECT(enter(-0.0, -1) == 0); // neither tolerance nor stop time
    EXPECT(enter(0, 0) == 3);
    EXPECT(set("modulus", 200e9) == 0 && set("modulus", NAN) == 3 && set("force", 1) == 3);
    const double soft = output("half_width");
    EXPECT(set("modulus", 226e9) == 0);
    const double hard = output("half_width");
    EXPECT(soft > hard && hard > 0);
    EXPECT(CALL(ExitInitializationMode, instance) == 0);
    EXPECT(set("modulus", 200e9) == 3);
    EXPECT(step(1, 1e-6) == 3 && step(0, -1e-6) == 3 && step(0, INFINITY) == 3);
    EXPECT(step(0, 1e-6) == 0 && get(find("time", NULL)) == 1e-6);
    EXPECT(output("internal_steps") == 1);
    // a step that is a thousand times as long is divided into several, each at most twice as long
    // as the previous one
    EXPECT(step(1e-6, 1e-3) == 0 && output("internal_steps") > 9);
    EXPECT(CALL(Terminate, instance) == 0 && step(1.001e-3, 1e-6) == 3);
    EXPECT(CALL(Reset, instance) == 0);
    EXPECT(get(find("time", NULL)) == 0);
    EXPECT(enter(0, 1e-5) == 0 && CALL(ExitInitializationMode, instance) == 0);
    EXPECT(output("half_width") == hard && step(0, 1e-4) == 3 && step(0, 1e-5) == 0);
    // with FMI's tolerance
    EXPECT(CALL(Reset, instance) == 0);
    EXPECT(enter(1e-6, 0) == 0 && CALL(ExitInitializationMode, instance) == 0);
    EXPECT(get(find("step_accuracy", NULL)) == 1e-6);
    EXPECT(num_notes > 0);
    EXPECT(step(0, 2e-6) == 0);
    finish();
}

// ---- derivatives

static int directional(const variable *of, const variable *by, double *found) {
    const double one = 1;

    return version == 2 ? (int)CALL2(GetDirectionalDerivative, instance, &of->reference, 1,
                                     &by->reference, 1, &one, found)
                        : (int)CALL3(GetDirectionalDerivative, instance, &of->reference, 1,
                                     &by->reference, 1, &one, 1, found, 1);
}

/* Returns the derivative of an output with respect to an input by a central difference. Both steps
 * start from the saved state `before`. */
static double difference(void *before, const variable *of, const variable *by, double time,
                         double length) {
    const double value = get(by), small = 2e-3 * value;
    double at[2];

    for (int i = 0; i < 2; i++) {
        EXPECT(version == 2 ? !CALL2(SetFMUstate, instance, before)
                            : !CALL3(SetFMUState, instance, before));
        EXPECT(set(by->name, value + (i ? small : -small)) == 0);
        EXPECT(step(time, length) == 0);
        at[i] = get(of);
    }
    return (at[1] - at[0]) / (2 * small);
}

static void derivatives(void) {
    enum { MOST_OUTPUTS = 4, NUM_INPUTS = 3 };
    static const char *const outputs[MOST_OUTPUTS] = {"force", "central_film_thickness",
                                                      "peak_pressure", "friction_force"};
    const size_t num_outputs = has("friction_force") ? MOST_OUTPUTS : MOST_OUTPUTS - 1;
    const char *inputs[NUM_INPUTS] = {NULL, "surface_speed_1", "radius"};
    // the training never changed the radius, so the selected equations are less accurate for it
    const double near[NUM_INPUTS] = {1e-4, 1e-4, 1e-2};
    const double length = duration / 100;
    void *before = NULL, *behind = NULL;

    look_at_start();
    inputs[0] = given_name;
    begin(0);
    march(0, 100, false, NULL, 0);
    EXPECT(version == 2 ? !CALL2(GetFMUstate, instance, &before)
                        : !CALL3(GetFMUState, instance, &before));
    set_inputs(1.01);
    EXPECT(step(duration, length) == 0);
    EXPECT(version == 2 ? !CALL2(GetFMUstate, instance, &behind)
                        : !CALL3(GetFMUState, instance, &behind));
    const double film = output("central_film_thickness");
    for (size_t i = 0; i < NUM_INPUTS; i++)
        for (size_t k = 0; k < num_outputs; k++) {
            const variable *of = find(outputs[k], "output"), *by = find(inputs[i], "input");
            double found = NAN, again = NAN;
            EXPECT(version == 2 ? !CALL2(SetFMUstate, instance, behind)
                                : !CALL3(SetFMUState, instance, behind));
            EXPECT(directional(of, by, &found) == 0 && directional(of, by, &again) == 0);
            EXPECT(found == again && output("central_film_thickness") == film);
            const double expected = difference(before, of, by, duration, length);
            printf("d %s / d %s = %.10g, differences %.10g\n", of->name, by->name, found, expected);
            // the FMU's derivative of friction is itself a difference, with another increment
            const double both = k == MOST_OUTPUTS - 1 ? 5e-2 : 0;
            EXPECT(fabs(found - expected) <=
                   (near[i] + both) * fabs(expected) + 1e-4 * fabs(get(of) / get(by)));
        }
    double none = 0;
    EXPECT(directional(find("force", NULL), find("accuracy", NULL), &none) == 3);
    EXPECT(version == 2 ? !CALL2(FreeFMUstate, instance, &before)
                        : !CALL3(FreeFMUState, instance, &before));
    EXPECT(version == 2 ? !CALL2(FreeFMUstate, instance, &behind)
                        : !CALL3(FreeFMUState, instance, &behind));
    finish();
}

/* Checks that a failed step leaves the outputs as they were, and that a later step gives the same
 * film, to the last bit, as without the failed steps. */
static void far(void) {
    enum { NUM_TRIES = 3 };
    double film[2] = {0}, last = NAN;

    look_at_start();
    for (int with = 0; with < 2; with++) {
        begin(0);
        for (int i = 0; i < 2; i++)
            EXPECT(set(given_name, given_at(0.01 * i)) == 0 && step(i * 1e-6, 1e-6) == 0);
        for (int i = 0; with && i < NUM_TRIES; i++) {
            const double before = output("peak_pressure");
            const bool by_speed = i == 1; // otherwise by a load or approach that no step can reach
            EXPECT(set("surface_speed_1", by_speed ? -100 : speed_start) == 0);
            const double far_off = strcmp(given_name, "load") == 0 ? 1e6 : -1e6;
            EXPECT(set(given_name, by_speed ? given_start : far_off * fabs(given_start)) == 0);
            EXPECT(step(2e-6, 1e-6) == 2);
            EXPECT(num_errors == 0 && num_discarded == i + 1);
            EXPECT(get(find("time", NULL)) == 2e-6 && output("peak_pressure") == before);
            EXPECT(version == 3 ||
                   (CALL2(GetRealStatus, instance, fmi2LastSuccessfulTime, &last) == 0 &&
                    last == 2e-6));
        }
        EXPECT(set("surface_speed_1", speed_start) == 0);
        EXPECT(set(given_name, given_at(0.02)) == 0 && step(2e-6, 1e-6) == 0);
        film[with] = output("central_film_thickness");
        EXPECT(CALL(Reset, instance) == 0);
    }
    EXPECT(film[0] == film[1]);
    begin(0);
    EXPECT(step(0, 1e-6) == 0);
    finish();
}

/* Checks that an error is accepted if no step length reduces it to FMI's tolerance, and that the
 * number of internal steps is bounded. */
static void tolerances(void) {
    static const double all[] = {1e-4, 1e-5, 1e-6, 1e-7, 1e-9};
    enum { NUM_STEPS = 20, MOST_PARTS = 600 };
    double film[sizeof all / sizeof *all];

    look_at_start();
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        double parts = 0;
        begin(all[i]);
        EXPECT(get(find("step_accuracy", NULL)) == all[i]);
        for (size_t k = 0; k < NUM_STEPS; k++) {
            set_inputs((double)(k + 1) / NUM_STEPS);
            EXPECT(step((double)k * duration / NUM_STEPS, duration / NUM_STEPS) == 0);
            parts += output("internal_steps");
        }
        EXPECT(parts < MOST_PARTS * NUM_STEPS);
        film[i] = output("central_film_thickness");
        printf("%g %g %.10g\n", all[i], parts, film[i]);
        EXPECT(num_errors == 0 && num_discarded == 0);
        EXPECT(fabs(film[i] / film[0] - 1) < 5e-4);
        EXPECT(CALL(Reset, instance) == 0);
    }
    EXPECT(num_notes > 0);
    begin(0);
    EXPECT(step(0, 1e-6) == 0);
    finish();
}

/* Moves the bodies out of contact and back three times. Checks that the force is never negative,
 * and that it vanishes and returns three times. */
static void apart(void) {
    enum { NUM_STEPS = 150, PERIOD = 50 };
    size_t num_lost = 0, num_found = 0;
    double before = NAN;
    void *state = NULL;

    look_at_start();
    begin(0);
    const double width = output("half_width"), unit = width * width / get(find("radius", NULL));
    const double length = 0.02 * width / speed_start;
    for (int i = 0; i < NUM_STEPS; i++) {
        const double out = 1 - cos(2 * 3.14159265358979 * (i + 1) / PERIOD);
        EXPECT(set("approach", given_start + 1.2 * unit * out) == 0);
        EXPECT(step(i * length, length) == 0);
        const double force = output("force"), peak = output("peak_pressure");
        EXPECT(force >= 0 && (force > 0) == (peak > 0) && output("central_film_thickness") >= 0);
        num_lost += before > 0 && force == 0;
        num_found += before == 0 && force > 0;
        before = force;
        EXPECT(version == 2 ? !CALL2(GetFMUstate, instance, &state)
                            : !CALL3(GetFMUState, instance, &state));
        EXPECT(version == 2 ? !CALL2(SetFMUstate, instance, state)
                            : !CALL3(SetFMUState, instance, state));
        EXPECT(output("force") == force);
    }
    printf("lost %zu times, found %zu times\n", num_lost, num_found);
    EXPECT(num_lost == 3 && num_found == 3);
    EXPECT(version == 2 ? !CALL2(FreeFMUstate, instance, &state)
                        : !CALL3(FreeFMUState, instance, &state));
    finish();
}

// ---- the same by ehdrom.h

/* Returns stiffness and damping of the stationary contact under a force, at the conditions `at`. */
static ehdrom_response respond(double *heating, ehdrom_contact *contact, double force,
                               const ehdrom_conditions *at) {
    ehdrom_result result = EHDROM_RESULT_INIT;
    ehdrom_response response = EHDROM_RESPONSE_INIT;

    EXPECT(!ehdrom_contact_set_number(contact, "physical.load", force) &&
           !ehdrom_contact_set_number(contact, "physical.speed", at->speed) &&
           !ehdrom_contact_set_number(contact, "physical.radius", at->radius));
    EXPECT(!EHDROM_FAILED(ehdrom_solve(contact, &result)));
    EXPECT(!ehdrom_respond(contact, &response));
    *heating = result.inlet_heating_factor;
    return response;
}

static void by_library(int argc, char **argv) {
    const size_t steps = strtoul(argv[3], NULL, 10);
    const double length = duration / (double)steps;
    char path[PATH_MAX + 64];
    ehdrom_model *model = NULL;
    ehdrom_contact *contact = NULL, *stationary = NULL;
    ehdrom_result result = EHDROM_RESULT_INIT;
    ehdrom_conditions at = EHDROM_CONDITIONS_INIT;
    ehdrom_traction traction = EHDROM_TRACTION_INIT;

    snprintf(path, sizeof path, "%s/resources/model.ehdrom", folder);
    EXPECT(!ehdrom_model_open(&model, path, NULL) && !ehdrom_contact_create(&contact, model));
    snprintf(path, sizeof path, "%s/resources/contact.yml", folder);
    EXPECT(!ehdrom_contact_create(&stationary, model));
    EXPECT(!ehdrom_contact_read(contact, path) && !ehdrom_contact_read(stationary, path));
    at.given = EHDROM_LOAD | EHDROM_SPEED | EHDROM_RADIUS;
    at.load = given_start = argc > 4 ? strtod(argv[4], NULL) : 300e3;
    at.speed = speed_start = argc > 5 ? strtod(argv[5], NULL) : 0.8;
    at.radius = argc > 6 ? strtod(argv[6], NULL) : 0.0125;
    given_name = "load";
    EXPECT(!EHDROM_FAILED(ehdrom_start(contact, &at, &result)));
    for (size_t i = 0; i <= steps; i++) {
        const double part = (double)i / (double)steps, v = speed_start * swing(2 * part);
        at.load = given_at(part);
        at.speed = ((v + 0.25) + (v - 0.25)) / 2;
        if (i > 0)
            EXPECT(!EHDROM_FAILED(ehdrom_step(contact, &at, length, &result)) &&
                   !ehdrom_accept(contact));
        double heating = NAN;
        const ehdrom_response response = respond(&heating, stationary, result.load, &at);
        EXPECT(response.stiffness > 0 && response.damping_bound > 0);
        printf("%zu force=%a approach=%a central_film_thickness=%a minimum_film_thickness=%a "
               "central_pressure=%a peak_pressure=%a exit_position=%a half_width=%a "
               "indicated_deviation=%a indicated_deviation_minimum=%a local_error=%a trusted=%a "
               "iterations=%a internal_steps=%a stationary_stiffness=%a stationary_damping=%a "
               "stationary_damping_bound=%a",
               i, result.load, result.approach, result.central_film_thickness,
               result.minimum_film_thickness, result.central_pressure, result.peak_pressure,
               result.exit_position, result.half_width, result.indicated_deviation,
               result.indicated_deviation_minimum, result.local_error, (double)result.trusted,
               (double)result.iterations, i > 0 ? 1. : 0., response.stiffness, response.damping,
               response.damping_bound);
        // the library returns the traction of the last accepted state at this slide speed; the FMU
        // returns the traction at the end of its step
        EXPECT(argc <= 7 || !ehdrom_slide(contact, i > 0 ? (v + 0.25) - (v - 0.25) : 0, &traction));
        if (argc > 7)
            printf(" friction_force=%a friction_coefficient=%a power_loss=%a rolling_resistance=%a "
                   "rolling_moment=%a mean_shear_stress=%a largest_shear_stress=%a "
                   "stationary_inlet_heating_factor=%a",
                   traction.friction_force, traction.friction_coefficient, traction.power_loss,
                   traction.rolling_resistance, traction.rolling_moment, traction.mean_shear_stress,
                   traction.largest_shear_stress, heating);
        printf("\n");
    }
    ehdrom_contact_free(contact);
    ehdrom_contact_free(stationary);
    ehdrom_model_close(model);
}

int main(int argc, char **argv) {
    EXPECT(argc > 3 && realpath(argv[2], folder));
    if (strcmp(argv[1], "library") == 0) {
        by_library(argc, argv);
        return 0;
    }
    version = atoi(argv[1]);
    load();
    const char *what = argv[3];
    if (strcmp(what, "run") == 0)
        run(argc, argv);
    else if (strcmp(what, "restore") == 0)
        restore(argv);
    else if (strcmp(what, "parts") == 0)
        parts();
    else if (strcmp(what, "calls") == 0)
        calls(argv + 4, argc - 4);
    else if (strcmp(what, "derivatives") == 0)
        derivatives();
    else if (strcmp(what, "far") == 0)
        far();
    else if (strcmp(what, "apart") == 0)
        apart();
    else if (strcmp(what, "tolerances") == 0)
        tolerances();
    else
        return 1;
    return 0;
}
