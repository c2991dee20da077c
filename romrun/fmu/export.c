/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/fmu/export.h"

#include "common/settings/settings_table.h"
#include "romrun/fmu/description.h"
#include "romrun/fmu/instance.h"
#include "romrun/fmu/package.h"
#include "romrun/library/ehdrom.h"
#include "romrun/online/online.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <nettle/sha2.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MAX_ENTRIES = 64, NAME_SIZE = 320 };

enum { CONTENTS, SCENE, MODEL, NUM_RESOURCES };
static const char *const resources[] = {"contact.txt", "contact.yml", "model.ehdrom"};
static const char shared_object[] = "fmu.so";

/* Contents of an FMU, and the data from which they are made. */
typedef struct export_job {
    const program *caller;
    const fmu_request *request;
    char installed[PATH_MAX];                // folder of the shared object and the licences
    char shared_object[PATH_MAX];            // path
    char folder[PATH_MAX];                   // temporary folder of the resources
    char resources[NUM_RESOURCES][PATH_MAX]; // paths
    fmu_contents contents;
    double step; // s
    char *description, *page;
    size_t description_size, page_size;
    package_entry entries[MAX_ENTRIES];
    char names[MAX_ENTRIES][NAME_SIZE];
    char paths[MAX_ENTRIES][PATH_MAX];
    size_t num_entries;
} export_job;

// ---- paths

/* Finds ../lib/ehdrom relative to the program, in the build's folder or after installation. */
static ehd_status find_installed(export_job *job, ehd_error *error) {
    char self[PATH_MAX];
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);

    self[length > 0 ? length : 0] = '\0';
    for (int up = 0; up < 2; up++) {
        char *slash = strrchr(self, '/');
        if (slash) *slash = '\0';
    }
    if (snprintf(job->installed, PATH_MAX, "%s/lib/ehdrom", self) < PATH_MAX &&
        snprintf(job->shared_object, PATH_MAX, "%s/%s", job->installed, shared_object) < PATH_MAX &&
        access(job->shared_object, R_OK) == 0)
        return EHD_OK;
    return ehd_fail(error, EHD_NOINPUT,
                    "%s/%s: found %s, expected the shared object of FMUs, which is made on x86-64",
                    job->installed, shared_object, strerror(errno));
}

static ehd_status path_in(char path[PATH_MAX], const char *folder, const char *name,
                          ehd_error *error) {
    if (snprintf(path, PATH_MAX, "%s/%s", folder, name) < PATH_MAX) return EHD_OK;
    return ehd_fail(error, EHD_DATA, "%s: found a path of more than %d bytes", name, PATH_MAX);
}

// ---- resources

/* Replaces the speeds of both surfaces by their mean and slide_roll. The start values of the inputs
 * follow from these values. */
static scene with_mean_speed(const scene *given) {
    scene own = *given;

    if (isnan(given->physical.speed_1)) return own;
    own.physical.speed = (given->physical.speed_1 + given->physical.speed_2) / 2;
    own.slide_roll = scene_slide_roll(given);
    own.physical.speed_1 = own.physical.speed_2 = NAN;
    return own;
}

/* Copies only the settings of the contact, without paths. */
static void strip(scene *settings, const scene *given) {
    *settings = with_mean_speed(given);
    for (const setting *row = scene_settings(); row->key; row++)
        if (strncmp(row->key, "output.", 7) == 0 || strcmp(row->key, "approach") == 0 ||
            (strncmp(row->key, "transient.", 10) == 0 &&
             strcmp(row->key, "transient.smoothing") != 0))
            setting_clear(row, settings);
    if (strcmp(settings->regime, "transient") == 0)
        scene_set(settings, "transient.end_time", "1", NULL, NULL); // required if transient
}

static ehd_status open_to_write(FILE **file, const char *path, ehd_error *error) {
    *file = fopen(path, "wbe");
    return *file ? EHD_OK
                 : ehd_fail(error, EHD_CANTCREATE, "%s: found %s, expected to create it", path,
                            strerror(errno));
}

/* Closes a file and checks that all of it was written. */
static ehd_status close_written(FILE *file, const char *name, ehd_error *error) {
    const bool failed = ferror(file) != 0;

    if (fclose(file) == 0 && !failed) return EHD_OK;
    return ehd_fail(error, EHD_IO, "%s: found %s, expected to write it", name, strerror(errno));
}

static ehd_status write_scene(const export_job *job, ehd_error *error) {
    scene settings;
    FILE *file = NULL;

    strip(&settings, job->request->given);
    char *text = scene_text(&settings);
    ehd_status status =
        text ? open_to_write(&file, job->resources[SCENE], error) : ehd_no_memory(error, "fmu");
    if (!status) {
        fputs(text, file);
        status = close_written(file, resources[SCENE], error);
    }
    free(text);
    return status;
}

/* Writes the model as a flat file, since FMUs have no HDF5. */
static ehd_status write_model(const export_job *job, ehd_error *error) {
    const fmu_request *request = job->request;
    online_model *model = NULL;
    ehd_status status = online_open(&model, request->model, request->sizes, error);

    if (!status) status = online_export(model, job->resources[MODEL], false, error);
    online_close(model);
    return status;
}

/* Makes a token from all data on which the FMU's results depend. */
static ehd_status make_token(export_job *job, ehd_error *error) {
    const char *const files[] = {job->resources[SCENE], job->resources[MODEL], job->shared_object};
    struct sha256_ctx context;
    uint8_t piece[1 << 16], digest[16];
    ehd_status status = EHD_OK;

    sha256_init(&context);
    for (size_t i = 0; i < sizeof files / sizeof *files && !status; i++) {
        size_t count = 0;
        FILE *file = fopen(files[i], "rbe");
        if (!file)
            return ehd_fail(error, EHD_NOINPUT, "%s: found %s, expected it", files[i],
                            strerror(errno));
        while ((count = fread(piece, 1, sizeof piece, file)) > 0)
            sha256_update(&context, count, piece);
        if (ferror(file))
            status = ehd_fail(error, EHD_IO, "%s: found a failure, expected to read it", files[i]);
        fclose(file);
    }
    sha256_update(&context, sizeof job->contents.start, (const uint8_t *)job->contents.start);
    sha256_digest(&context, sizeof digest, digest);
    char *at = job->contents.token;
    *at++ = '{';
    for (size_t i = 0; i < sizeof digest; i++)
        at += sprintf(at, "%s%02x", i == 4 || i == 6 || i == 8 || i == 10 ? "-" : "", digest[i]);
    *at = '}';
    return status;
}

// ---- start values

static ehd_status library_failed(const export_job *job, const ehdrom_contact *contact,
                                 ehdrom_status status, ehd_error *error) {
    return ehd_fail(error, (ehd_status)status, "%s: at the start of the FMU: %s",
                    job->caller->arguments[0], ehdrom_contact_error(contact));
}

/* Starts the contact of the resources, and reads its approach at the start and its time scale. */
static ehd_status ask_contact(export_job *job, ehdrom_contact *contact, ehd_error *error) {
    ehdrom_result result = EHDROM_RESULT_INIT;
    ehdrom_scales scales = EHDROM_SCALES_INIT;
    ehdrom_status found = ehdrom_contact_read(contact, job->resources[SCENE]);

    if (!found) found = ehdrom_contact_scales(contact, &scales);
    if (!found) found = ehdrom_start(contact, NULL, &result);
    if (found && found != EHDROM_UNTRUSTED) return library_failed(job, contact, found, error);
    job->step = scales.time / 100;
    job->contents.start[FMU_APPROACH] = result.approach;
    if (found == EHDROM_UNTRUSTED)
        program_note(job->caller, "%s: at the start of the FMU, which is made all the same: %s",
                     job->caller->arguments[0], ehdrom_contact_error(contact));
    return EHD_OK;
}

static ehd_status find_approach(export_job *job, ehd_error *error) {
    ehdrom_model *model = NULL;
    ehdrom_contact *contact = NULL;
    const ehdrom_status opened = ehdrom_model_open(&model, job->resources[MODEL], NULL);
    ehd_status status = EHD_OK;

    if (opened)
        status = ehd_fail(error, (ehd_status)opened, "%s: %s", job->request->model,
                          ehdrom_model_error(model));
    if (!status && ehdrom_contact_create(&contact, model)) status = ehd_no_memory(error, "fmu");
    if (!status) status = ask_contact(job, contact, error);
    ehdrom_contact_free(contact);
    ehdrom_model_close(model);
    return status;
}

static double number_of(const setting *row, const scene *of) {
    double value = 0;

    memcpy(&value, (const char *)of + row->offset, sizeof value);
    return value;
}

/* Chooses the variables and takes their start values from the scene. */
static ehd_status fill_contents(export_job *job, ehd_error *error) {
    const scene own = with_mean_speed(job->request->given), *const given = &own;
    fmu_contents *contents = &job->contents;

    if (isnan(given->physical.load))
        return ehd_fail(error, EHD_DATA,
                        "%s: found moes.M and moes.L, expected physical.load and the others",
                        job->caller->arguments[0]);
    contents->ellipse = strcmp(given->contact, "ellipse") == 0;
    contents->point = contents->ellipse || strcmp(given->contact, "point") == 0;
    contents->approach_given = strcmp(given->closure, "approach") == 0;
    contents->slides = !isnan(given->slide_roll);
    if (contents->slides && !*given->lubricant.shear.law)
        return ehd_fail(
            error, EHD_DATA,
            "%s: slide_roll: found a value without lubricant.shear.law, expected a law, "
            "because the speeds of both surfaces are inputs",
            job->caller->arguments[0]);
    contents->ratio = scene_thins_flow(given) ? given->slide_roll : NAN;
    contents->heated = !isnan(given->lubricant.thermal_conductivity);
    for (size_t i = 0; i < FMU_NUM_VARIABLES; i++) {
        const fmu_variable *variable = &fmu_variables[i];
        const setting *row = variable->key ? setting_find(variable->key) : NULL;
        contents->has[i] =
            fmu_variable_fits(variable, contents) && (!row || setting_is_given(row, given));
        if (row && contents->has[i]) contents->start[i] = number_of(row, given);
    }
    contents->start[FMU_ACCURACY] = job->request->accuracy;
    if (contents->slides) {
        const double half = given->slide_roll / 2 * given->physical.speed;
        contents->start[FMU_SPEED_1] += half;
        contents->start[FMU_SPEED_2] -= half;
    }
    return find_approach(job, error);
}

static ehd_status write_contents(const export_job *job, ehd_error *error) {
    FILE *file = NULL;
    const ehd_status status = open_to_write(&file, job->resources[CONTENTS], error);

    if (status) return status;
    fmu_contents_write(file, &job->contents);
    return close_written(file, resources[CONTENTS], error);
}

static void keep_failure(void *to, fmu_outcome of, const char *text) {
    if (of != FMU_DONE) ehd_fail(to, EHD_INTERNAL, "fmu: %s", text);
}

/* Takes one step as an importer does, with an FMU that reads the files just written. */
static ehd_status try_out(const export_job *job, ehd_error *error) {
    ehd_no_memory(error, "fmu");
    errno = 0;
    fmu_instance *trial = fmu_create(job->contents.token, job->folder, keep_failure, error);
    const ehd_status otherwise = trial ? EHD_NOT_CONVERGED : EHD_IO;
    const bool works = trial && fmu_setup(trial, 0, INFINITY, 0) &&
                       fmu_enter_initialization(trial) && fmu_exit_initialization(trial) &&
                       fmu_step(trial, 0, job->step) == FMU_DONE;
    const bool refused = errno == ENOMEM;

    fmu_free(trial);
    return works ? EHD_OK : refused ? EHD_MEMORY : otherwise;
}

// ---- the package

/* Adds an entry, whose name in the zip is `folder` and `name` together. */
static package_entry *add(export_job *job, const char *folder, const char *name) {
    if (job->num_entries == MAX_ENTRIES) return NULL;
    package_entry *entry = &job->entries[job->num_entries];
    char *own = job->names[job->num_entries++];

    snprintf(own, NAME_SIZE, "%s%s", folder, name);
    *entry = (package_entry){.name = own};
    return entry;
}

static ehd_status add_file(export_job *job, const char *folder, const char *name, const char *from,
                           const char *file, ehd_error *error) {
    package_entry *entry = add(job, folder, name);

    if (!entry) return ehd_no_memory(error, "fmu");
    entry->path = job->paths[job->num_entries - 1];
    return path_in(job->paths[job->num_entries - 1], from, file, error);
}

static ehd_status add_text(export_job *job, const char *name, const char *text, size_t size,
                           ehd_error *error) {
    package_entry *entry = add(job, "", name);

    if (!entry) return ehd_no_memory(error, "fmu");
    entry->bytes = text;
    entry->size = size;
    return EHD_OK;
}

static ehd_status add_licences(export_job *job, ehd_error *error) {
    char folder[PATH_MAX];
    ehd_status status = path_in(folder, job->installed, "licenses", error);
    DIR *open = status ? NULL : opendir(folder);

    if (!open)
        return ehd_fail(error, EHD_NOINPUT, "%s: found %s, expected licences", folder,
                        strerror(errno));
    for (const struct dirent *one = readdir(open); one && !status; one = readdir(open))
        if (one->d_name[0] != '.')
            status =
                add_file(job, "documentation/licenses/", one->d_name, folder, one->d_name, error);
    closedir(open);
    return status;
}

/* Reads the environment variable SOURCE_DATE_EPOCH. Sets *when to 0 if the variable is not set. */
static ehd_status source_date_epoch(time_t *when, ehd_error *error) {
    const char *text = getenv("SOURCE_DATE_EPOCH");
    size_t seconds = 0;
    // a zip can store times up to 2107
    const ehd_status status = text ? parse_count(&seconds, text, 315532800, 4354819199,
                                                 "SOURCE_DATE_EPOCH", EHD_USAGE, error)
                                   : EHD_OK;

    *when = (time_t)seconds;
    return status;
}

static ehd_status write_texts(export_job *job, time_t when, ehd_error *error) {
    char name[NAME_SIZE], generated[32];
    const char *slash = strrchr(job->caller->output, '/');
    struct tm at;

    snprintf(name, sizeof name, "%s", slash ? slash + 1 : job->caller->output);
    char *dot = strrchr(name, '.');
    if (dot && dot > name) *dot = '\0';
    text_make_printable(name, ""); // XML allows no control characters
    if (when) strftime(generated, sizeof generated, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&when, &at));
    const fmu_description of = {.contents = &job->contents,
                                .name = name,
                                .generated = when ? generated : NULL,
                                .step = job->step,
                                .stop = 1000 * job->step};
    FILE *file = open_memstream(&job->description, &job->description_size);
    if (!file) return ehd_no_memory(error, "fmu");
    fmu_describe(file, &of, job->request->fmi);
    if (fclose(file)) return ehd_no_memory(error, "fmu");
    file = open_memstream(&job->page, &job->page_size);
    if (!file) return ehd_no_memory(error, "fmu");
    fmu_document(file, &of);
    return fclose(file) ? ehd_no_memory(error, "fmu") : EHD_OK;
}

static ehd_status pack(export_job *job, ehd_error *error) {
    const bool fmi2 = job->request->fmi == 2;
    char binary[NAME_SIZE];
    time_t when = 0;
    ehd_status status = source_date_epoch(&when, error);

    if (!status) status = write_texts(job, when, error);
    if (!status)
        status =
            add_text(job, "modelDescription.xml", job->description, job->description_size, error);
    if (!status)
        status = add_text(job, "documentation/index.html", job->page, job->page_size, error);
    snprintf(binary, sizeof binary, "binaries/%s/%s.so", fmi2 ? "linux64" : "x86_64-linux",
             fmu_identifier);
    if (!status) status = add_file(job, "", binary, job->installed, shared_object, error);
    for (size_t i = 0; i < NUM_RESOURCES && !status; i++)
        status = add_file(job, "resources/", resources[i], job->folder, resources[i], error);
    if (!status) status = add_licences(job, error);
    return status ? status
                  : package_write(job->caller->output, job->entries, job->num_entries, when,
                                  job->caller->force, error);
}

// ---- the whole export

static ehd_status make_folder(export_job *job, ehd_error *error) {
    const char *given = getenv("TMPDIR"), *parent = given && *given ? given : "/tmp";
    ehd_status status = path_in(job->folder, parent, "ehdrom-fmu-XXXXXX", error);

    if (!status && !mkdtemp(job->folder))
        status = ehd_fail(error, EHD_CANTCREATE, "%s: found %s, expected to make a folder in it",
                          parent, strerror(errno));
    if (status) job->folder[0] = '\0';
    for (size_t i = 0; i < NUM_RESOURCES && !status; i++)
        status = path_in(job->resources[i], job->folder, resources[i], error);
    return status;
}

static void remove_folder(const export_job *job) {
    if (!job->folder[0]) return;
    for (size_t i = 0; i < NUM_RESOURCES; i++)
        unlink(job->resources[i]);
    rmdir(job->folder);
}

ehd_status fmu_export(const program *caller, const fmu_request *request, ehd_error *error) {
    export_job *job = calloc(1, sizeof *job);

    if (!job) return ehd_no_memory(error, "fmu");
    job->caller = caller;
    job->request = request;
    ehd_status status = find_installed(job, error);
    if (!status) status = make_folder(job, error);
    if (!status) status = write_scene(job, error);
    if (!status) status = write_model(job, error);
    if (!status) status = fill_contents(job, error);
    if (!status) status = make_token(job, error);
    if (!status) status = write_contents(job, error);
    if (!status) status = try_out(job, error);
    if (!status) status = pack(job, error);
    remove_folder(job);
    free(job->description);
    free(job->page);
    free(job);
    return status;
}
