/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contacts and their settings. */
#include "romrun/library/internal.h"

#include "common/program/text.h"
#include "common/settings/settings_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char no_memory[] = "contact: out of memory";

/* Sets the kind of contact and the discretisation to the model's, by their names in scenes. */
static void take_from_model(scene *settings, const ehdrom_model *model) {
    const online_properties properties = online_describe(model->online);
    const contact_kind *kind = online_kind(model->online);

    scene_defaults(settings);
    scene_set(settings, "contact", kind->name, NULL, NULL);
    scene_set(settings, "regime", "stationary", NULL, NULL);
    scene_set(settings, "discretization", properties.discretization, NULL, NULL);
    if (kind->dimensions > 1) scene_set(settings, "boundary", properties.boundary, NULL, NULL);
}

ehdrom_status ehdrom_contact_create(ehdrom_contact **contact, const ehdrom_model *model) {
    ehdrom_contact *self = calloc(1, sizeof *self);

    *contact = self;
    if (!self) return EHDROM_MEMORY;
    self->accuracy = self->tolerance = self->step_tolerance = NAN;
    if (!model || !model->online)
        return (ehdrom_status)ehd_fail(&self->error, EHD_INTERNAL,
                                       "model: found none, expected one that was opened");
    self->model = model;
    take_from_model(&self->settings, model);
    return EHDROM_OK;
}

void ehdrom_contact_free(ehdrom_contact *self) {
    if (!self) return;
    online_solver_free(self->solver);
    online_transient_free(self->in_time);
    free(self->pressure);
    free(self->film);
    free(self);
}

const char *ehdrom_contact_error(const ehdrom_contact *self) {
    return self ? self->error.text : no_memory;
}

ehd_status library_begin(ehdrom_contact *self) {
    if (!self || !self->model) return EHD_INTERNAL;
    self->error.text[0] = '\0';
    self->locale = library_enter();
    return EHD_OK;
}

ehdrom_status library_end(ehdrom_contact *self, ehd_status status) {
    if (self && self->model) library_leave(self->locale);
    return (ehdrom_status)status;
}

// ---- settings

static bool starts_with(const char *text, const char *start) {
    return strncmp(text, start, strlen(start)) == 0;
}

/* Discards the completed settings. */
static void forget(ehdrom_contact *self) {
    self->is_complete[0] = self->is_complete[1] = self->is_reference = false;
}

ehdrom_status ehdrom_contact_read(ehdrom_contact *self, const char *path) {
    ehd_status status = library_begin(self);
    scene found;

    if (!status && !path)
        status = ehd_fail(&self->error, EHD_DATA, "scene: found no path, expected one");
    if (status) return library_end(self, status);
    status = scene_read(&found, path, NULL, 0, &self->error);
    if (!status) {
        self->settings = found;
        forget(self);
    }
    return library_end(self, status);
}

static ehd_status check_key(const char *key, ehd_error *error) {
    return key ? EHD_OK : ehd_fail(error, EHD_DATA, "settings: found no key, expected one");
}

static ehd_status unset(scene *settings, const char *key, ehd_error *error) {
    const setting *row = setting_find(key);

    if (!row) return setting_unknown(error, (place){0}, key);
    setting_clear(row, settings);
    return EHD_OK;
}

ehdrom_status ehdrom_contact_set(ehdrom_contact *self, const char *key, const char *value) {
    ehd_status status = library_begin(self);

    if (!status) status = check_key(key, &self->error);
    if (status) return library_end(self, status);
    status = value ? scene_set(&self->settings, key, value, NULL, &self->error)
                   : unset(&self->settings, key, &self->error);
    forget(self);
    return library_end(self, status);
}

/* Updates self->complete after one setting has changed. If this setting is a number of the
 * operating point, the other completed settings stay valid and are kept. Keeping them saves 186 of
 * 189 thousand instructions, which matters for contacts that are solved in 50 microseconds. */
static void replace(ehdrom_contact *self, const char *key, const char *text) {
    const bool of_point = starts_with(key, "physical.") || starts_with(key, "moes.");
    const setting *row = setting_find(key);

    self->is_reference = false;
    for (int i = 0; i < 2; i++) {
        scene *complete = &self->complete[i];
        self->is_complete[i] = of_point && self->is_complete[i] &&
                               setting_is_given(row, complete) &&
                               !scene_set(complete, key, text, NULL, NULL);
    }
}

static bool is_set_to(const scene *settings, const char *key, const char *text) {
    const setting *row = setting_find(key);
    char now[NUMBER_TEXT];

    return row && setting_is_given(row, settings) &&
           setting_show(now, sizeof now, row, settings) < sizeof now && strcmp(now, text) == 0;
}

ehdrom_status ehdrom_contact_set_number(ehdrom_contact *self, const char *key, double value) {
    char text[NUMBER_TEXT];
    ehd_status status = library_begin(self);

    if (!status) status = check_key(key, &self->error);
    if (status) return library_end(self, status);
    number_show(text, value); // with all digits, so that reading gives the same bits
    if (!is_set_to(&self->settings, key, text)) {
        status = scene_set(&self->settings, key, text, NULL, &self->error);
        if (!status) replace(self, key, text);
    }
    return library_end(self, status);
}

static ehd_status get(const ehdrom_contact *self, const char *key, char *text, size_t size,
                      ehd_error *error) {
    const setting *row = setting_find(key);

    if (!row) return setting_unknown(error, (place){0}, key);
    if (size == 0) return ehd_fail(error, EHD_DATA, "%s: found no room, expected some", key);
    *text = '\0';
    if (!setting_is_given(row, &self->settings)) return EHD_OK;
    const size_t length = setting_show(text, size, row, &self->settings);
    return length < size
               ? EHD_OK
               : ehd_fail(error, EHD_DATA, "%s: found room for %zu characters, expected %zu", key,
                          size, length + 1);
}

ehdrom_status ehdrom_contact_get(ehdrom_contact *self, const char *key, char *text, size_t size) {
    ehd_status status = library_begin(self);

    if (!status) status = check_key(key, &self->error);
    if (!status) status = get(self, key, text, size, &self->error);
    return library_end(self, status);
}

ehdrom_status ehdrom_contact_set_units(ehdrom_contact *self, int units) {
    ehd_status status = library_begin(self);

    if (!status && units != EHDROM_SI && units != EHDROM_DIMENSIONLESS)
        status = ehd_fail(&self->error, EHD_DATA,
                          "units: found %d, expected EHDROM_SI or EHDROM_DIMENSIONLESS", units);
    if (!status) {
        self->dimensionless = units == EHDROM_DIMENSIONLESS;
        self->is_reference = false;
    }
    return library_end(self, status);
}

/* Sets a tolerance or an accuracy. `infinite`: any value above 0 is allowed. */
static ehd_status set_part(double *member, const char *name, double value, bool infinite,
                           ehd_error *error) {
    if (!(isgreater(value, 0) && (infinite || value < 1)))
        return ehd_fail(error, EHD_DATA, "%s: found %g, expected a number above 0%s", name, value,
                        infinite ? "" : " and below 1");
    *member = value;
    return EHD_OK;
}

ehdrom_status ehdrom_contact_set_accuracy(ehdrom_contact *self, double accuracy) {
    ehd_status status = library_begin(self);

    if (!status) status = set_part(&self->accuracy, "accuracy", accuracy, true, &self->error);
    return library_end(self, status);
}

ehdrom_status ehdrom_contact_set_tolerance(ehdrom_contact *self, double tolerance) {
    ehd_status status = library_begin(self);

    if (!status) status = set_part(&self->tolerance, "tolerance", tolerance, false, &self->error);
    return library_end(self, status);
}

ehdrom_status ehdrom_contact_set_step_tolerance(ehdrom_contact *self, double tolerance) {
    ehd_status status = library_begin(self);

    if (!status)
        status = set_part(&self->step_tolerance, "step tolerance", tolerance, false, &self->error);
    return library_end(self, status);
}

// ---- the contact of the settings

/* Sets the model's ellipticity if the scene does not give it. */
static void take_shape(scene *of, const ehdrom_contact *self) {
    const bool ellipse = online_kind(self->model->online) == &contact_ellipse;

    if (ellipse && isnan(of->ellipticity) && isnan(of->physical.radius_across))
        of->ellipticity = online_grid(self->model->online)->shape.ellipticity;
}

/* Makes a scene of one regime from settings of any regime. Omits the settings for output. Also
 * omits the histories of the conditions, because the caller gives the conditions of each step. */
static void take_regime(scene *of, const ehdrom_contact *self, bool in_time) {
    const online_properties properties = online_describe(self->model->online);

    *of = self->settings;
    for (const setting *row = scene_settings(); row->key; row++) {
        const bool how_carried =
            starts_with(row->key, "transport") || starts_with(row->key, "transient.smoothing");
        if (starts_with(row->key, "output.") || strcmp(row->key, "approach") == 0 ||
            (starts_with(row->key, "transient.") && !(in_time && how_carried)) ||
            (how_carried && !in_time) || (strcmp(row->key, "approach_length") == 0 && !in_time) ||
            (strcmp(row->key, "lubricant.thermal_conductivity") == 0 && in_time))
            setting_clear(row, of);
    }
    take_shape(of, self);
    scene_set(of, "regime", in_time ? "transient" : "stationary", NULL, NULL);
    if (in_time) {
        scene_set(of, "transient.end_time", "1", NULL, NULL); // a transient scene needs an end
        // the caller may give the approach in any step, whatever the scene's closure is
        if (isnan(of->approach_length)) of->approach_length = far_approach_length;
        if (!*of->transport) scene_set(of, "transport", properties.transport, NULL, NULL);
    } else {
        scene_set(of, "closure", "load", NULL, NULL);
    }
    scene_complete(of);
}

static unit_factors units_of(const ehd_contact *contact, const scene *settings,
                             bool dimensionless) {
    if (dimensionless) return (unit_factors){1, 1, 1, 1, 1, 1, 1, 1, 1};
    return (unit_factors){.length = contact->half_width,
                          .length_across = contact_half_width_across(contact),
                          .film = contact_film_scale(contact),
                          .pressure = contact->hertz_pressure,
                          .load = settings->physical.load,
                          .time = contact_time_scale(contact),
                          .speed = contact->speed,
                          .radius = settings->physical.radius,
                          .modulus = settings->physical.modulus};
}

ehd_status library_contact(ehd_contact *contact, unit_factors *units, ehdrom_contact *self,
                           bool in_time, ehd_error *error) {
    scene *of = &self->complete[in_time];
    ehd_status status = EHD_OK;

    if (!self->is_complete[in_time]) {
        take_regime(of, self, in_time);
        status = scene_check_reducible(of, error);
        if (!status) status = scene_validate(of, "settings", error);
        self->is_complete[in_time] = !status;
    }
    if (!status && !self->dimensionless && isnan(of->physical.load))
        status = ehd_fail(error, EHD_DATA,
                          "units: found moes.M and moes.L, expected physical.load and the others, "
                          "or EHDROM_DIMENSIONLESS");
    if (!status)
        status = scene_check_kind(of, online_kind(self->model->online),
                                  online_path(self->model->online), error);
    if (!status) status = scene_contact(contact, of, error);
    if (!status) *units = units_of(contact, of, self->dimensionless);
    return status;
}

ehdrom_status ehdrom_contact_scales(ehdrom_contact *self, ehdrom_scales *scales) {
    ehd_status status = library_begin(self);
    ehd_contact contact;
    unit_factors units;

    if (status) return library_end(self, status);
    const bool dimensionless = self->dimensionless;
    self->dimensionless = true; // allows a scene of M and L, which has no SI units
    // the scales are equal in both regimes, but transient scenes cannot have the discretisation
    // cross-flux
    const bool in_time = !online_check_in_time(self->model->online, NULL);
    status = library_contact(&contact, &units, self, in_time, &self->error);
    self->dimensionless = dimensionless;
    if (!status) {
        units = units_of(&contact, &self->settings, false);
        const ehdrom_scales own = {.half_width = units.length,
                                   .film = units.film,
                                   .hertz_pressure = units.pressure,
                                   .load = units.load,
                                   .speed = units.speed,
                                   .time = units.time,
                                   .moes_M = contact.moes_M,
                                   .moes_L = contact.moes_L,
                                   .half_width_across = units.length_across};
        status = library_give(scales, &own, sizeof own, "scales", &self->error);
    }
    return library_end(self, status);
}
