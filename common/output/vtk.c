/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/vtk.h"

#include "common/output/si_units.h"
#include "common/program/arena.h"
#include "common/program/output_file.h"
#include "common/program/text.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUM_FIELDS = 2, NUM_LAYERS = 2 };

static const char *const field_names[NUM_FIELDS] = {"pressure", "film_thickness"};

/* A field. `values` is NULL if the file does not have the field. */
typedef struct field {
    const char *name;
    si_units si;
    double *values; // [lines, nodes of a line] at one point in time
} field;

typedef struct images {
    artefact *file;
    const program *caller;
    size_t num_times, num_x, num_lines; // num_lines: lines of the file, 1 for a line contact
    double *x, *y, *time;
    si_units of_x, of_y, of_time;
    field fields[NUM_FIELDS];
} images;

// ---- reading

static ehd_status read_axis(double **values, const images *self, const char *name, size_t length,
                            ehd_error *error) {
    *values = array_new(length, 1, sizeof **values);
    if (!*values) return ehd_no_memory(error, artefact_path(self->file));
    return artefact_get_axis(self->file, name, *values, length, error);
}

static ehd_status read_axes(images *self, ehd_error *error) {
    artefact *file = self->file;
    const size_t num_y = artefact_length(file, "y");

    self->num_times = artefact_length(file, "time");
    self->num_x = artefact_length(file, "x");
    self->num_lines = num_y > 0 ? num_y : 1;
    ehd_status status = read_axis(&self->x, self, "x", self->num_x, error);
    if (!status && num_y > 0) status = read_axis(&self->y, self, "y", num_y, error);
    if (!status) status = read_axis(&self->time, self, "time", self->num_times, error);
    if (!status) status = si_units_read(&self->of_x, file, "x", true, error);
    if (!status) status = si_units_read(&self->of_y, file, "y", true, error);
    return status ? status : si_units_read(&self->of_time, file, "time", true, error);
}

static ehd_status prepare(images *self, ehd_error *error) {
    bool any = false;
    ehd_status status = EHD_OK;

    for (int f = 0; f < NUM_FIELDS; f++)
        any = any || artefact_has(self->file, field_names[f]);
    if (!any || artefact_kind(self->file) != &schema_result)
        return ehd_fail(error, EHD_DATA,
                        "%s: found no fields, expected a result with pressure or film_thickness "
                        "(output.fields: true)",
                        artefact_path(self->file));
    status = read_axes(self, error);
    if (!status && self->num_x < 2)
        return ehd_fail(error, EHD_DATA, "%s: x: found %zu nodes, expected at least 2",
                        artefact_path(self->file), self->num_x);
    for (int f = 0; f < NUM_FIELDS && !status; f++) {
        field *one = &self->fields[f];
        one->name = field_names[f];
        if (!artefact_has(self->file, one->name)) continue;
        one->values = array_new(self->num_x, self->num_lines, sizeof *one->values);
        status = one->values ? si_units_read(&one->si, self->file, one->name, true, error)
                             : ehd_no_memory(error, artefact_path(self->file));
    }
    return status;
}

static void release(images *self) {
    free(self->x);
    free(self->y);
    free(self->time);
    si_units_free(&self->of_x);
    si_units_free(&self->of_y);
    si_units_free(&self->of_time);
    for (int f = 0; f < NUM_FIELDS; f++) {
        free(self->fields[f].values);
        si_units_free(&self->fields[f].si);
    }
}

/* Reads the fields at entry `time` of the time axis, in SI units. *any is true if there are fields
 * at this point in time. A field that was not written is NaN at all nodes. */
static ehd_status read_time(bool *any, images *self, size_t time, ehd_error *error) {
    const size_t count = self->num_x * self->num_lines;
    ehd_status status = EHD_OK;

    *any = false;
    for (int f = 0; f < NUM_FIELDS && !status; f++) {
        field *one = &self->fields[f];
        if (!one->values) continue;
        const double factor = si_units_at(&one->si, time);
        status = artefact_get_part(self->file, one->name, time, 1, one->values, count, error);
        for (size_t i = 0; i < count && !status; i++) {
            *any = *any || !isnan(one->values[i]);
            one->values[i] *= factor;
        }
    }
    return status;
}

// ---- an image

/* Returns the number of lines of the image, 2 for a line contact. */
static size_t image_lines(const images *self) {
    return self->num_lines > 1 ? self->num_lines : 2;
}

/* Writes a block of appended data: the number of bytes, then each layer. */
static void write_block(const images *self, const field *one, FILE *stream) {
    const size_t lines = image_lines(self), repeats = lines / self->num_lines;
    const uint64_t bytes = NUM_LAYERS * lines * self->num_x * sizeof *one->values;

    fwrite(&bytes, sizeof bytes, 1, stream);
    for (size_t i = 0; i < NUM_LAYERS * (repeats > 1 ? repeats : 1); i++)
        fwrite(one->values, sizeof *one->values, self->num_lines * self->num_x, stream);
}

static void write_header(const images *self, size_t time, FILE *stream) {
    const double unit = si_units_at(&self->of_x, time), unit_y = si_units_at(&self->of_y, time);
    const double step = (self->x[self->num_x - 1] - self->x[0]) / (double)(self->num_x - 1) * unit;
    const size_t lines = image_lines(self);
    const double step_y = self->y ? (self->y[1] - self->y[0]) * unit_y : step;
    const double first_y = self->y ? self->y[0] * unit_y : -0.5 * step;
    char extent[80];

    snprintf(extent, sizeof extent, "0 %zu 0 %zu 0 %d", self->num_x - 1, lines - 1, NUM_LAYERS - 1);
    fprintf(stream,
            "<?xml version=\"1.0\"?>\n"
            "<!-- pressure in Pa, film_thickness in m, places in m, time in s -->\n"
            "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"%s\" "
            "header_type=\"UInt64\">\n"
            "<ImageData WholeExtent=\"%s\" Origin=\"%.17g %.17g 0\" "
            "Spacing=\"%.17g %.17g %.17g\">\n"
            "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
            "format=\"ascii\">%.17g</DataArray></FieldData>\n"
            "<Piece Extent=\"%s\">\n<PointData Scalars=\"%s\">\n",
            __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? "LittleEndian" : "BigEndian", extent,
            self->x[0] * unit, first_y, step, step_y, step,
            self->time[time] * si_units_at(&self->of_time, time), extent,
            self->fields[0].values ? field_names[0] : field_names[1]);
}

static void write_image(const images *self, size_t time, FILE *stream) {
    const size_t block =
        sizeof(uint64_t) + NUM_LAYERS * image_lines(self) * self->num_x * sizeof(double);
    size_t offset = 0;

    write_header(self, time, stream);
    for (int f = 0; f < NUM_FIELDS; f++) {
        if (!self->fields[f].values) continue;
        fprintf(stream,
                "<DataArray type=\"Float64\" Name=\"%s\" format=\"appended\" offset=\"%zu\"/>\n",
                self->fields[f].name, offset);
        offset += block;
    }
    fputs("</PointData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_", stream);
    for (int f = 0; f < NUM_FIELDS; f++)
        if (self->fields[f].values) write_block(self, &self->fields[f], stream);
    fputs("\n</AppendedData>\n</VTKFile>\n", stream);
}

static ehd_status put_image(const images *self, size_t time, const char *path, ehd_error *error) {
    output_file out;
    ehd_status status = output_file_create(&out, path, self->caller->force, error);
    if (status) return status;

    write_image(self, time, out.stream);
    return output_file_finish(&out, error);
}

// ---- one time

static ehd_status put_one(images *self, const char *path, ehd_error *error) {
    size_t found = 0, count = 0;
    bool any;
    ehd_status status = output_file_check(path, self->caller->force, error);

    for (size_t time = 0; time < self->num_times && !status; time++) {
        status = read_time(&any, self, time, error);
        if (any) found = time;
        count += any;
    }
    if (!status && count != 1)
        status = ehd_fail(error, EHD_DATA,
                          "%s: found fields of %zu times, expected 1 for %s (a name.pvd takes all)",
                          artefact_path(self->file), count, path);
    if (!status) status = read_time(&any, self, found, error);
    return status ? status : put_image(self, found, path, error);
}

// ---- a time series

/* Returns the path of an image in the folder of the collection `path`, which ends with ".pvd". Free
 * the path of the image with free(). */
static char *image_path(const char *path, size_t number) {
    char *name = NULL;
    const int base = (int)(strlen(path) - strlen(".pvd"));

    return asprintf(&name, "%.*s_%04zu.vti", base, path, number) < 0 ? NULL : name;
}

static ehd_status put_entry(images *self, size_t time, size_t number, FILE *collection,
                            ehd_error *error) {
    char *path = image_path(self->caller->output, number);
    if (!path) return ehd_no_memory(error, artefact_path(self->file));
    const char *slash = strrchr(path, '/');
    const ehd_status status = put_image(self, time, path, error);

    fprintf(collection, "<DataSet timestep=\"%.17g\" part=\"0\" file=\"",
            self->time[time] * si_units_at(&self->of_time, time));
    text_print_xml(slash ? slash + 1 : path, collection);
    fputs("\"/>\n", collection);
    free(path);
    return status;
}

static ehd_status put_entries(images *self, FILE *collection, ehd_error *error) {
    ehd_status status = EHD_OK;
    size_t number = 0;
    progress shown;
    bool any;

    progress_start(&shown, self->caller, self->num_times);
    for (size_t time = 0; time < self->num_times && !status; time++) {
        status = read_time(&any, self, time, error);
        if (!status && any) status = put_entry(self, time, number++, collection, error);
        if (!status && program_interrupted())
            status = ehd_fail(error, EHD_INTERRUPTED, "%s: interrupted after %zu images",
                              self->caller->output, number);
        progress_show(&shown, time + 1, "images");
    }
    progress_finish(&shown);
    if (!status && number == 0)
        status = ehd_fail(error, EHD_DATA, "%s: found fields of no time, expected some",
                          artefact_path(self->file));
    return status;
}

/* Writes each image before its entry, so that a collection never names a missing image. */
static ehd_status put_series(images *self, ehd_error *error) {
    output_file out;
    ehd_status status = output_file_create(&out, self->caller->output, self->caller->force, error);
    if (status) return status;

    fputs("<?xml version=\"1.0\"?>\n<!-- timestep in s -->\n"
          "<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n",
          out.stream);
    status = put_entries(self, out.stream, error);
    fputs("</Collection>\n</VTKFile>\n", out.stream);
    if (!status) return output_file_finish(&out, error);
    output_file_drop(&out);
    return status;
}

// ---- all

static bool ends_with(const char *text, const char *ending) {
    const size_t length = strlen(text), size = strlen(ending);

    return length > size && strcmp(text + length - size, ending) == 0;
}

ehd_status vtk_write(artefact *file, const program *caller, ehd_error *error) {
    const char *path = caller->output;
    images self = {.file = file, .caller = caller};
    const bool series = ends_with(path, ".pvd");
    ehd_status status = EHD_OK;

    if (!series && !ends_with(path, ".vti"))
        return ehd_fail(error, EHD_USAGE,
                        "--output: found %s, expected NAME.vti or, of a time series, NAME.pvd",
                        path);
    status = prepare(&self, error);
    if (!status) status = series ? put_series(&self, error) : put_one(&self, path, error);
    release(&self);
    return status;
}

ehd_status output_vtk(const program *self, ehd_error *error) {
    artefact *file = NULL;
    const char *const inputs[] = {self->vtk, NULL};
    ehd_status status = output_file_check_inputs(self->output, inputs, error);

    if (!status) status = artefact_open_unfinished(&file, self->vtk, artefact_schemas, error);
    if (!status) status = vtk_write(file, self, error);
    artefact_close(&file);
    return status;
}
