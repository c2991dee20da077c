/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/fuzz/target.h"

#include "common/artefact/artefact.h"
#include "common/settings/csv.h"
#include "common/settings/scene.h"
#include "common/time/history.h"
#include "romrun/library/ehdrom.h"
#include "tests/fuzz/edit.h"
#include "tests/fuzz/flat_edit.h"

#include <fcntl.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define OUTPUT FUZZ_OUTPUT

// ---- complaints

static FILE *report; // the original standard error
static int said;     // a file in memory with the messages of the programs

const char *__lsan_default_suppressions(void);

/* Ignores leaks of HDF5, which leaks memory when it refuses a file. */
const char *__lsan_default_suppressions(void) {
    return "leak:libhdf5";
}

void __sanitizer_set_report_fd(void *descriptor) __attribute__((weak));

void fuzz_start(int standard_error) {
    const int nowhere = open("/dev/null", O_WRONLY);
    said = memfd_create("said", 0);
    report = fdopen(standard_error, "w");
    if (!report || said < 0 || nowhere < 0) abort();
    setvbuf(report, NULL, _IOLBF, 0);
    if (__sanitizer_set_report_fd)
        __sanitizer_set_report_fd((void *)(intptr_t)standard_error); // NOLINT: its type
    dup2(nowhere, STDOUT_FILENO);
    dup2(said, STDERR_FILENO);
}

void fuzz_complain(const char *command, int code, const char *found, const char *text) {
    fprintf(report, "%s: exit code %d: found %s\n%s\n", command, code, found, text);
    abort();
}

const char *fuzz_said(void) {
    static char text[4096];
    const ssize_t length = pread(said, text, sizeof text - 1, 0);
    text[length > 0 ? length : 0] = '\0';
    return text;
}

static void forget_said(void) {
    lseek(said, 0, SEEK_SET);
    if (ftruncate(said, 0)) abort();
}

/* Checks that every line starts with the program's name, and that a failure has printed a line. */
static void check_said(const char *command, int code) {
    const char *text = fuzz_said();
    const size_t name = strcspn(command, " ");
    if (code && !*text) fuzz_complain(command, code, "no line", "");
    for (const char *line = text; *line; line += strcspn(line, "\n") + 1) {
        if (strncmp(line, command, name) != 0 || strncmp(line + name, ": ", 2) != 0)
            fuzz_complain(command, code, "a line that the program did not say", text);
        if (!strchr(line, '\n')) break;
    }
}

static void check_code(const char *command, int code) {
    static const int allowed[] = {EHD_OK,   EHD_NOT_CONVERGED, EHD_UNTRUSTED,
                                  EHD_DATA, EHD_NOINPUT,       EHD_MEMORY};
    for (size_t i = 0; i < sizeof allowed / sizeof *allowed; i++)
        if (code == allowed[i]) return;
    fuzz_complain(command, code, "a code that no file must lead to", fuzz_said());
}

// ---- programs

int fullrun_main(int argc, char **argv);
int snapgen_main(int argc, char **argv);
int podbuild_main(int argc, char **argv);
int deimselect_main(int argc, char **argv);
int romrun_main(int argc, char **argv);
static int library_main(int argc, char **argv);

static const struct {
    const char *name;
    int (*main)(int, char **);
} programs[] = {{"fullrun", fullrun_main},   {"snapgen", snapgen_main},
                {"podbuild", podbuild_main}, {"deimselect", deimselect_main},
                {"romrun", romrun_main},     {"library", library_main}};

static int call(int argc, char **argv) {
    for (size_t i = 0; i < sizeof programs / sizeof *programs; i++)
        if (argc > 0 && strcmp(argv[0], programs[i].name) == 0) return programs[i].main(argc, argv);
    abort();
}

int fuzz_call(const char *command) {
    enum { MAX_ARGUMENTS = 16 };
    char text[256], *argv[MAX_ARGUMENTS + 1], *rest = NULL;
    int argc = 0;
    snprintf(text, sizeof text, "%s", command);
    for (char *word = strtok_r(text, " ", &rest); word && argc < MAX_ARGUMENTS;
         word = strtok_r(NULL, " ", &rest))
        argv[argc++] = word;
    argv[argc] = NULL;
    if (argc == 0) abort();
    forget_said();
    const int code = call(argc, argv);
    fflush(stderr);
    check_said(command, code);
    return code;
}

static int run_command(const char *command) {
    const int code = fuzz_call(command);
    check_code(command, code);
    // the comparison with --against may fail after a transient result is written
    const bool compared = strstr(command, "time.yml") && strstr(command, "--against");
    if (code >= EHD_USAGE && !compared && access(OUTPUT, F_OK) == 0)
        fuzz_complain(command, code, "an output all the same", "");
    unlink(OUTPUT);
    unlink(OUTPUT ".partial");
    return code;
}

// ---- the library, called like a program: library SCENE.yml MODEL

/* Checks that a trusted result has finite numbers; returns `status`. */
static ehdrom_status look_at(ehdrom_status status, const ehdrom_result *result) {
    if (status == EHDROM_OK &&
        !(isfinite(result->central_film_thickness) && isfinite(result->minimum_film_thickness) &&
          isfinite(result->load) && isfinite(result->approach) && isfinite(result->peak_pressure)))
        fuzz_complain("library", status, "a result without numbers", "");
    return status;
}

static const char *edits; // the edits of this run

/* Applies the lines "state INDEX VALUE" to a saved state. */
static void edit_state(double *state, size_t count) {
    for (const char *line = edits; line && *line; line = strchr(line, '\n')) {
        char *value;
        line += *line == '\n';
        if (strncmp(line, "state ", 6) != 0) continue;
        const size_t index = strtoul(line + 6, &value, 10) % count;
        state[index] = strtod(value, NULL);
    }
}

/* Makes some steps. One step starts from a saved and edited state. */
static ehdrom_status steps(ehdrom_contact *contact) {
    ehdrom_conditions conditions = EHDROM_CONDITIONS_INIT;
    ehdrom_result result = EHDROM_RESULT_INIT;
    double state[1 << 12];
    size_t count = 0;
    ehdrom_status status = look_at(ehdrom_start(contact, NULL, &result), &result);
    conditions.given = EHDROM_LOAD | EHDROM_SPEED;
    conditions.speed = 1;
    for (int i = 0; i < 4 && !EHDROM_FAILED(status) && status != EHDROM_NOT_CONVERGED; i++) {
        conditions.load = 1 + 0.01 * i;
        status = look_at(ehdrom_step(contact, &conditions, 0.02, &result), &result);
        if (EHDROM_FAILED(status) || status == EHDROM_NOT_CONVERGED) break;
        if (ehdrom_accept(contact)) abort();
        if (i != 2 || ehdrom_state_size(contact, &count) || count > sizeof state / sizeof *state)
            continue;
        if (ehdrom_state_save(contact, state, count)) abort();
        edit_state(state, count);
        status = ehdrom_state_restore(contact, state, count);
    }
    return status;
}

static ehdrom_status use_contact(ehdrom_contact *contact, const ehdrom_model_info *info,
                                 const char *scene_path) {
    ehdrom_result result = EHDROM_RESULT_INIT;
    double *fields = calloc(info->num_x * info->num_y, sizeof *fields);
    ehdrom_status status = ehdrom_contact_read(contact, scene_path);
    if (!status) status = ehdrom_contact_set_units(contact, EHDROM_DIMENSIONLESS);
    if (!status) status = look_at(ehdrom_solve(contact, &result), &result);
    if (!EHDROM_FAILED(status) && status != EHDROM_NOT_CONVERGED && fields &&
        ehdrom_fields(contact, fields, NULL))
        status = EHDROM_INTERNAL;
    if (!EHDROM_FAILED(status) && info->in_time) status = steps(contact);
    free(fields);
    return status;
}

static int library_main(int argc, char **argv) {
    ehdrom_model *model;
    ehdrom_contact *contact = NULL;
    ehdrom_model_info info = EHDROM_MODEL_INFO_INIT;
    if (argc != 3) abort();
    ehdrom_status status = ehdrom_model_open(&model, argv[2], NULL);
    const bool opened = !status;
    if (opened) status = ehdrom_model_describe(model, &info);
    if (!status) status = ehdrom_contact_create(&contact, model);
    if (!status) status = use_contact(contact, &info, argv[1]);
    if (status)
        fprintf(stderr, "library: %s\n",
                opened ? ehdrom_contact_error(contact) : ehdrom_model_error(model));
    ehdrom_contact_free(contact);
    ehdrom_model_close(model);
    return status;
}

// ---- readers of text

static bool is_line(const ehd_error *error) {
    return *error->text && !strchr(error->text, '\n');
}

/* Reads a scene. An accepted scene must be unchanged after writing and reading. */
static ehd_status read_scene(const char *bytes, size_t length, ehd_error *error) {
    scene read, again;
    const ehd_status status = scene_parse(&read, bytes, length, "fuzz", NULL, 0, error);
    if (status) return status;
    char *text = scene_text(&read);
    if (!text || scene_parse(&again, text, strlen(text), "text", NULL, 0, error)) abort();
    char *second = scene_text(&again);
    if (!second || strcmp(text, second) != 0) abort();
    free(text);
    free(second);
    return EHD_OK;
}

/* Reads a plan. The text of an accepted plan must be readable and give the same number of
 * points. */
static ehd_status read_plan(const char *bytes, size_t length, ehd_error *error) {
    plan read = {0}, again = {0};
    ehd_status status = plan_read(&read, "work.yml", NULL, 0, error);
    (void)bytes, (void)length;
    if (!status) {
        if (plan_parse(&again, read.text, "text", error)) abort();
        if (again.num_points != read.num_points) abort();
    }
    plan_free(&again);
    plan_free(&read);
    return status;
}

/* Reads a transient scene with a table of the load; reads the scene itself only once. */
static ehd_status read_history(scene *given, const char *path, ehd_error *error) {
    ehd_histories *histories = NULL;
    double values[NUM_VARY];
    bool jump;
    if (!given->regime[0] && scene_read(given, path, NULL, 0, error)) abort();
    const ehd_status status = histories_init(&histories, given, error);
    if (status) return status;
    for (double time = 0; time <= 0.06; time += 0.01) {
        histories_at(values, histories, time);
        if (!(values[VARY_LOAD] > 0)) abort();
        if (!(histories_next_kink(histories, time, &jump) > time)) abort();
    }
    histories_free(histories);
    return EHD_OK;
}

static ehd_status read_hdf5_history(const char *bytes, size_t length, ehd_error *error) {
    static scene given;
    (void)bytes, (void)length;
    return read_history(&given, "table-h5.yml", error);
}

static ehd_status read_rows(ehd_error *error) {
    static const char *const row[] = {"row", "rows", NULL}, *const weight[] = {"weight", NULL};
    table_column columns[] = {{.names = row}, {.names = weight, .optional = true}};
    size_t count;
    const ehd_status status = csv_read_table("work.csv", columns, 2, &count, error);
    free(columns[0].values);
    free(columns[1].values);
    return status;
}

/* Reads the bytes as a table: as points of a plan if they name a setting, else as rows. Then reads
 * them as a history, and returns the status of this second reading. */
static ehd_status read_csv(const char *bytes, size_t length, ehd_error *error) {
    static scene given;
    plan points = {0};
    ehd_error own = {""};
    const bool varies = memmem(bytes, length, "moes.", 5) != NULL;
    const ehd_status status =
        varies ? plan_read(&points, "csv-plan.yml", NULL, 0, &own) : read_rows(&own);
    if (status && !is_line(&own)) abort();
    plan_free(&points);
    return read_history(&given, "table-csv.yml", error);
}

// ---- the targets

#define WRITE " -q -o " OUTPUT

const fuzz_target fuzz_targets[] = {
    {.name = "scene", .read = read_scene},
    {.name = "plan", .file = "work.yml", .read = read_plan},
    {.name = "csv", .file = "work.csv", .read = read_csv},
    {.name = "cases",
     .file = "work.csv",
     .commands = {"romrun line.yml --cases work.csv --model m-line.ehdrom -j 1" WRITE}},
    {.name = "table", .file = "work.h5", .bases = {"xf-time.h5"}, .read = read_hdf5_history},
    {.name = "snapshots",
     .file = "work.h5",
     .bases = {"xs-small.h5", "xs-line.h5", "xs-point.h5", "s-line.h5"},
     .schema = &schema_snapshots,
     .commands = {"podbuild --check work.h5", "podbuild work.h5" WRITE,
                  "podbuild work.h5 --deformation independent" WRITE,
                  "podbuild work.h5 --weight row-norm --plan line-plan.yml" WRITE,
                  "podbuild s-line.h5 work.h5 --pressure-modes 5" WRITE,
                  "fullrun line.yml --grid-of work.h5" WRITE, "podbuild --print work.h5 pressure"}},
    {.name = "part",
     .file = "work.h5",
     .bases = {"xp-line.h5", "xp-point.h5", "p-line.h5"},
     .schema = &schema_part,
     .commands = {"podbuild --check work.h5", "podbuild work.h5" WRITE,
                  "podbuild s-line.h5 work.h5 --pressure-modes 5" WRITE,
                  "podbuild work.h5 s-line.h5 --memory 400K --energy 1e-6" WRITE}},
    {.name = "basis",
     .file = "work.h5",
     .bases = {"xb-line.h5", "xb-both.h5", "xb-point.h5", "b-line.h5"},
     .schema = &schema_basis,
     .commands = {"deimselect --check work.h5", "snapgen small-plan.yml --basis work.h5 -j 1" WRITE,
                  "deimselect xr-line.h5 --basis work.h5 --no-check" WRITE,
                  "deimselect xr-both.h5 --basis work.h5 --no-check --method qr" WRITE,
                  "deimselect xr-point.h5 --basis work.h5 --no-check" WRITE,
                  "snapgen point-plan.yml --basis work.h5 -j 1" WRITE,
                  "snapgen line-plan.yml --basis work.h5 -j 1" WRITE}},
    {.name = "residuals",
     .file = "work.h5",
     .bases = {"xr-line.h5", "xr-both.h5", "xr-point.h5", "r-line.h5"},
     .schema = &schema_residuals,
     .commands = {"deimselect --check work.h5",
                  "deimselect work.h5 --basis b-line.h5 --no-check" WRITE,
                  "deimselect work.h5 --basis b-both.h5 --no-check --method qr" WRITE,
                  "deimselect work.h5 --basis b-point.h5 --no-check --method sopt" WRITE,
                  "deimselect work.h5 --basis b-line.h5 -j 1" WRITE,
                  "deimselect work.h5 --basis b-line.h5 --no-check --stability 10" WRITE}},
    {.name = "model",
     .file = "work.h5",
     .bases = {"xm-line.h5", "xm-both.h5", "xm-point.h5", "m-line.h5"},
     .schema = &schema_model,
     .commands = {"romrun --check work.h5", "romrun -q line.yml --model work.h5",
                  "romrun time.yml --model work.h5" WRITE, "romrun --trade --model work.h5",
                  "romrun -q point.yml --model work.h5",
                  "romrun -q line.yml --model work.h5 --accuracy 1e-2",
                  "romrun -q line.yml --model work.h5 --rows 18 --pressure-modes 8",
                  "romrun line.yml --model work.h5 --verify --set output.fields=true" WRITE,
                  "romrun -q time.yml --model work.h5 --fallback full",
                  "fullrun -q line.yml --grid-of work.h5",
                  "deimselect r-line.h5 --basis b-line.h5 --rows-from work.h5 --no-check" WRITE,
                  "romrun --calibrate small-plan.yml --model work.h5 -j 1" WRITE}},
    {.name = "flat",
     .file = "work.ehdrom",
     .bases = {"m-line.ehdrom", "m-both.ehdrom", "m-point.ehdrom", "m-small.ehdrom"},
     .flat = true,
     .commands = {"romrun --check work.ehdrom", "library line.yml work.ehdrom",
                  "library point.yml work.ehdrom", "romrun time.yml --model work.ehdrom" WRITE,
                  "romrun -q line.yml --model work.ehdrom --accuracy 1e-2",
                  "romrun point.yml --model work.ehdrom --set output.fields=true" WRITE,
                  "romrun line.yml --model work.ehdrom --set output.fields=true" WRITE,
                  "romrun -q time.yml --model work.ehdrom --fallback full"}},
    {.name = "result",
     .file = "work.h5",
     .bases = {"xf-line.h5", "xf-time.h5", "xf-point.h5", "f-time.h5"},
     .schema = &schema_result,
     .commands = {"fullrun --check work.h5", "podbuild work.h5" WRITE,
                  "romrun line.yml --model m-line.h5 --against work.h5" WRITE,
                  "romrun time.yml --model m-line.h5 --against work.h5" WRITE,
                  "romrun point.yml --model m-point.h5 --against work.h5" WRITE,
                  "fullrun line.yml --start work.h5" WRITE,
                  "fullrun point.yml --start work.h5" WRITE,
                  "fullrun --print work.h5 film_thickness"}},
    {.name = "resume-snapshots",
     .file = OUTPUT ".partial",
     .bases = {"s-small.h5"},
     .schema = &schema_snapshots,
     .commands = {"snapgen small-plan.yml --resume -j 1" WRITE}},
    {.name = "resume-result",
     .file = OUTPUT ".partial",
     .bases = {"f-time.h5"},
     .schema = &schema_result,
     .commands = {"fullrun time.yml --allow-untrusted --resume" WRITE}},
    {0}};

const fuzz_target *fuzz_find(const char *name) {
    const fuzz_target *target = fuzz_targets;
    while (target->name && strcmp(target->name, name) != 0)
        target++;
    return target->name ? target : NULL;
}

// ---- running a target

/* Returns the number in the first line "WORD N", modulo `count`; `otherwise` if there is no such
 * line. */
static size_t choice(const char *text, const char *word, size_t count, size_t otherwise) {
    const size_t length = strlen(word);
    for (const char *line = text; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        if (strncmp(line, word, length) == 0 && line[length] == ' ')
            return strtoul(line + length, NULL, 10) % count;
    }
    return otherwise;
}

static size_t count_of(const char *const *texts, size_t most) {
    size_t count = 0;
    while (count < most && texts[count])
        count++;
    return count;
}

static void write_bytes(const char *path, const void *bytes, size_t length) {
    const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file < 0 || write(file, bytes, length) != (ssize_t)length) abort();
    close(file);
}

/* Writes a copy of a valid file. The valid file is read only once. */
static void copy_base(const char *base, const char *path) {
    enum { MAX_KNOWN = 32 };
    static struct {
        const char *name;
        char *bytes;
        size_t length;
    } known[MAX_KNOWN];
    size_t i = 0;
    while (i < MAX_KNOWN && known[i].name && strcmp(known[i].name, base) != 0)
        i++;
    if (i == MAX_KNOWN) abort();
    if (!known[i].name) {
        FILE *file = fopen(base, "rb");
        if (!file || fseek(file, 0, SEEK_END)) abort();
        known[i].length = (size_t)ftell(file);
        known[i].bytes = malloc(known[i].length);
        rewind(file);
        if (!known[i].bytes || fread(known[i].bytes, 1, known[i].length, file) != known[i].length)
            abort();
        fclose(file);
        known[i].name = base;
    }
    write_bytes(path, known[i].bytes, known[i].length);
}

static int run_reader(const fuzz_target *target, const char *text, size_t length) {
    ehd_error error = {""};
    const int code = (int)target->read(text, length, &error);
    check_code(target->name, code);
    if (code && !is_line(&error)) fuzz_complain(target->name, code, "no line", error.text);
    return code;
}

int fuzz_run(const fuzz_target *target, const uint8_t *bytes, size_t length) {
    const size_t num_bases = count_of(target->bases, MAX_BASES);
    const size_t num_commands = count_of(target->commands, MAX_COMMANDS);
    char *text = strndup((const char *)bytes, length); // the edits, up to a zero byte
    int code = 0;
    bool edited = true;
    if (!text) abort();
    if (num_bases > 0) {
        copy_base(target->bases[choice(text, "base", num_bases, 0)], target->file);
        // edits of a flat model do not update its checksum, so the checksum is not checked
        if (target->flat) setenv("EHDROM_DIGEST", "no", 1);
        if (target->flat)
            flat_edit_file(target->file, text, strlen(text));
        else
            edited = edit_file(target->file, target->schema, text, strlen(text));
    } else if (target->file) {
        write_bytes(target->file, bytes, length);
    }
    if (!edited)
        code = EHD_INTERNAL;
    else if (target->read)
        code = run_reader(target, (const char *)bytes, length);
    else if (num_commands > 0) {
        edits = text;
        code = run_command(target->commands[choice(text, "run", num_commands, num_commands > 1)]);
        edits = NULL;
    }
    if (target->file) unlink(target->file);
    free(text);
    return code;
}
