/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/algebra/rounding.h"
#include "common/program/text.h"
#include "common/settings/scene_source.h"
#include <math.h>
#include <string.h>

// ---- groups of keys

/* Numbers of given keys and of all keys of a group, and a list of the missing keys. */
typedef struct key_count {
    size_t given;
    size_t all;
    char missing[256];
} key_count;

static void count_key(key_count *count, const setting *row, const scene *of) {
    const size_t used = strlen(count->missing);
    count->all++;
    if (setting_is_given(row, of))
        count->given++;
    else
        snprintf(count->missing + used, sizeof count->missing - used, "%s%s", used ? ", " : "",
                 row->key);
}

static key_count count_below(const char *prefix, const scene *of) {
    key_count count = {0};
    for (const setting *row = scene_settings(); row->key; row++)
        if (strncmp(row->key, prefix, strlen(prefix)) == 0 && !row->when[0].key)
            count_key(&count, row, of);
    return count;
}

static place place_of_key(const scene_source *source, const char *key) {
    const place known = source->places[setting_index(setting_find(key))];
    return known.file ? known : (place){source->file, 0};
}

static place place_of_file(const scene_source *source) {
    return (place){source->file, 0};
}

static ehd_status check_whole(const scene_source *source, const char *name, const key_count *count,
                              ehd_error *error) {
    if (count->given == 0 || count->given == count->all) return EHD_OK;
    return place_fail(error, place_of_file(source),
                      "%s: found %zu of its %zu keys, expected also %s", name, count->given,
                      count->all, count->missing);
}

/* Checks whether the viscosity law has the viscosity that `physical` lacks. Also returns true for
 * an invalid lubricant, because another check reports its error. */
static bool has_viscosity_of_law(const scene *of) {
    ehd_lubricant lubricant;
    return isnan(of->physical.viscosity) &&
           (lubricant_init(&lubricant, &of->lubricant, NULL) || !isnan(lubricant.eta0));
}

/* Counts the keys of `physical` that every contact needs. If the speed of one surface is given, the
 * speeds of both count in place of the mean speed. physical.viscosity does not count if the law has
 * a viscosity of its own. */
static key_count count_physical(bool *both_speeds, bool viscosity_of_law, const scene *of) {
    static const char *const own[] = {"physical.speed_1", "physical.speed_2"};
    const setting *mean = setting_find("physical.speed");
    const setting *surfaces[] = {setting_find(own[0]), setting_find(own[1])};
    const setting *known = viscosity_of_law ? setting_find("physical.viscosity") : NULL;
    key_count count = {0};

    *both_speeds = setting_is_given(surfaces[0], of) || setting_is_given(surfaces[1], of);
    for (const setting *row = scene_settings(); row->key; row++) {
        const bool of_surface = row == surfaces[0] || row == surfaces[1];
        if (strncmp(row->key, "physical.", strlen("physical.")) != 0 || row->when[0].key) continue;
        if (row == known) continue;
        if (row == mean ? !*both_speeds : of_surface ? *both_speeds : true)
            count_key(&count, row, of);
    }
    return count;
}

static ehd_status check_speeds(const scene_source *source, bool both_speeds, ehd_error *error) {
    const scene *of = &source->values;
    const place where = place_of_key(source, "physical.speed_1");

    if (both_speeds && !isnan(of->physical.speed))
        return place_fail(
            error, where,
            "physical.speed_1: found beside physical.speed, expected only one of them");
    if (both_speeds && !isnan(of->slide_roll))
        return place_fail(error, where,
                          "physical.speed_1: found beside slide_roll, expected only one of them");
    // if one speed is missing, scene_speed is NaN, and check_whole reports the missing key
    if (both_speeds && scene_speed(of) < setting_find("physical.speed")->min)
        return place_fail(error, where,
                          "physical.speed_1: found %g with physical.speed_2 of %g m/s, expected a "
                          "mean above 0",
                          of->physical.speed_1, of->physical.speed_2);
    return EHD_OK;
}

/* Checks that the load of a line contact was not given as a force, and that of a point contact not
 * per length. */
static ehd_status check_load(const scene_source *source, ehd_error *error) {
    const scene *of = &source->values;
    const char *expected = strcmp(of->contact, "line") == 0 ? "N/m" : "N";

    if (!*of->physical.load_unit || strcmp(of->physical.load_unit, expected) == 0) return EHD_OK;
    return place_fail(
        error, place_of_key(source, "physical.load"),
        "physical.load: found a load in multiples of %s, expected multiples of %s in a "
        "%s contact",
        of->physical.load_unit, expected, of->contact);
}

static ehd_status check_operating_point(const scene_source *source, ehd_error *error) {
    const key_count moes = count_below("moes.", &source->values);
    bool both_speeds;
    const bool viscosity_of_law = moes.given == 0 && has_viscosity_of_law(&source->values);
    const key_count physical = count_physical(&both_speeds, viscosity_of_law, &source->values);
    const place where = place_of_file(source);
    if (moes.given == 0 && physical.given == 0)
        return place_fail(error, where, "moes: found neither moes nor physical, expected one");
    if (moes.given > 0 && physical.given > 0)
        return place_fail(error, where, "moes: found moes and physical, expected only one");
    ehd_status status = check_whole(source, "moes", &moes, error);
    if (!status) status = check_speeds(source, both_speeds, error);
    if (!status) status = check_whole(source, "physical", &physical, error);
    return status ? status : check_load(source, error);
}

/* Checks the settings of the traction. The stresses are in pascals, so the traction needs
 * `physical`. A law of shear stress is allowed only with the traction. */
static ehd_status check_traction(const scene_source *source, ehd_error *error) {
    const scene *of = &source->values;
    const bool has_law = *of->lubricant.shear.law;
    const setting *law = setting_find("lubricant.shear.law");

    if (!isnan(of->slide_roll) && isnan(of->physical.load))
        return place_fail(error, place_of_key(source, "slide_roll"),
                          "slide_roll: found with moes, expected it with physical");
    if (has_law && isnan(scene_slide_roll(of)))
        return place_fail(error, place_of_key(source, law->key),
                          "%s: found a value, expected slide_roll, or physical.speed_1 and "
                          "speed_2, with it",
                          law->key);
    if (strcmp(of->discretization, "accurate") != 0 && scene_thins_flow(of))
        return place_fail(error, place_of_key(source, "lubricant.shear.in_film"),
                          "lubricant.shear.in_film: found true with the discretization %s, "
                          "expected accurate",
                          of->discretization);
    for (const setting *row = law; !has_law && row->key; row++)
        if (strncmp(row->key, "lubricant.shear.", strlen("lubricant.shear.")) == 0 &&
            setting_is_given(row, of))
            return place_fail(error, place_of_key(source, row->key),
                              "%s: found a value, expected %s too", row->key, law->key);
    // in pure rolling there is no shear stress that depends on a law
    if (!has_law && isgreater(fabs(scene_slide_roll(of)), 0))
        return place_fail(
            error, place_of_key(source, isnan(of->slide_roll) ? "physical.speed_1" : "slide_roll"),
            "slide_roll: found %g without %s, expected a law: eyring with tau0 (often "
            "2e6 to 1e7 Pa), limiting with limit (0.04 to 0.12), carreau with G and "
            "n, or newtonian",
            scene_slide_roll(of), law->key);
    return EHD_OK;
}

/* Checks that the discretization cross-flux is used only for a stationary contact with flow across
 * the entrainment. Line contacts and transient contacts are refused. */
static ehd_status check_cross_flux(const scene_source *source, ehd_error *error) {
    const scene *of = &source->values;
    const bool line = strcmp(of->contact, "line") == 0;

    if (strcmp(of->discretization, "cross-flux") != 0) return EHD_OK;
    if (!line && strcmp(of->regime, "stationary") == 0) return EHD_OK;
    return place_fail(error, place_of_key(source, "discretization"),
                      "discretization: found cross-flux of a %s, expected accurate|published",
                      line ? "line contact" : "contact in time");
}

/* Checks that exactly one of two keys gives the shape of an ellipse. */
static ehd_status check_ellipse(const scene_source *source, ehd_error *error) {
    const scene *of = &source->values;
    const bool by_radius = !isnan(of->physical.radius_across);

    if (strcmp(of->contact, "ellipse") != 0) return EHD_OK;
    if (by_radius && isnan(of->physical.radius))
        return place_fail(error, place_of_key(source, "physical.radius_across"),
                          "physical.radius_across: found a value with moes, expected ellipticity");
    if (by_radius && !isnan(of->ellipticity))
        return place_fail(error, place_of_key(source, "ellipticity"),
                          "ellipticity: found it and physical.radius_across, expected only one");
    if (!by_radius && isnan(of->ellipticity))
        return place_fail(error, place_of_key(source, "contact"),
                          "contact: found ellipse without its shape, expected ellipticity or "
                          "physical.radius_across");
    return EHD_OK;
}

// ---- conditions

/* Checks whether two keys are required because of the same condition. */
static bool same_reason(const setting *left, const setting *right) {
    const char *a = left->when[0].key, *b = right->when[0].key;
    return a && b ? strcmp(a, b) == 0 : a == b;
}

/* Checks whether the scene's law needs a key that other laws may do without. */
static bool law_needs(const setting *row, const scene *of) {
    for (int i = 0; row->when[0].key && i < NUM_LAW_GROUPS; i++) {
        const size_t length = strlen(law_groups[i].key);
        if (strncmp(row->key, law_groups[i].key, length) != 0 || row->key[length] != '.') continue;
        const lubricant_law *law = law_group_choice(&law_groups[i], of);
        const law_parameter *parameter = law ? law_key(law, row->key + length + 1) : NULL;
        return parameter && parameter->need == LAW_REQUIRED;
    }
    return false;
}

static bool is_missing(const setting *row, const scene *of) {
    return !setting_is_given(row, of) && (row->required || law_needs(row, of)) &&
           !setting_unmet(row, of);
}

static ehd_status check_needed(const scene_source *source, ehd_error *error) {
    const scene *of = &source->values;
    const setting *first = scene_settings();
    char shown[SHOWN_TEXT];
    key_count count = {0};
    while (first->key && !is_missing(first, of))
        first++;
    if (!first->key) return EHD_OK;
    for (const setting *row = first; row->key; row++)
        if (is_missing(row, of) && same_reason(row, first)) count_key(&count, row, of);
    if (count.all == 1 && first->choices)
        return place_fail(error, place_of_file(source), "%s: found nothing, expected %s",
                          count.missing, first->choices);
    if (!first->when[0].key)
        return place_fail(error, place_of_file(source), "%s: found nothing, expected a value",
                          count.missing);
    setting_show_condition(shown, &first->when[0], of);
    return place_fail(error, place_of_key(source, first->when[0].key),
                      "%s: found nothing, expected a value with the %s", count.missing, shown);
}

/* Checks that the scene uses each given key. If a condition refers to a key that is not given, the
 * check is left to check_needed. */
static ehd_status check_used(const scene_source *source, ehd_error *error) {
    const scene *of = &source->values;
    char shown[SHOWN_TEXT];
    for (const setting *row = scene_settings(); row->key; row++) {
        if (!setting_is_given(row, of)) continue;
        const setting_condition *unmet = setting_unmet(row, of);
        if (!unmet || !setting_is_given(setting_find(unmet->key), of)) continue;
        setting_show_condition(shown, unmet, of);
        // the file alone is consistent: the conflict is due to --set
        if (source_is_overridden(source, setting_find(unmet->key)) &&
            !source_is_overridden(source, row))
            return place_fail(error, place_of_key(source, row->key),
                              "%s: found a value, expected none with the %s (--set %s= unsets it)",
                              row->key, shown, row->key);
        return place_fail(error, place_of_key(source, row->key),
                          "%s: found a value, expected none with the %s", row->key, shown);
    }
    return EHD_OK;
}

// ---- lubricant

enum { SHOWN_LIST = 256 };

/* Appends a name to a list such as "A1, A2". */
static void add_name(char list[SHOWN_LIST], const char *name) {
    const size_t used = strlen(list);
    snprintf(list + used, SHOWN_LIST - used, "%s%s", used ? ", " : "", name);
}

/* Checks that a law with presets is given either a preset or all of its constants. */
static ehd_status check_preset(const scene_source *source, const law_group *laws,
                               ehd_error *error) {
    const lubricant_law *law = law_group_choice(laws, &source->values);
    const char *group = laws->key;
    char key[MAX_KEY], presets[SHOWN_LIST] = "", constants[SHOWN_LIST] = "";
    key_count preset = {0}, constant = {0};
    if (!law) return EHD_OK; // there is no law, or lubricant_init refuses it
    snprintf(key, sizeof key, "%s.law", group);
    const place where = place_of_key(source, key);
    for (size_t i = 0; i < law_num_parameters(law); i++) {
        const law_parameter *parameter = &law->parameters[i];
        const bool is_preset = parameter->need == LAW_PRESET;
        if (!is_preset && parameter->need != LAW_CONSTANT) continue;
        snprintf(key, sizeof key, "%s.%s", group, parameter->key);
        const setting *row = setting_find(key);
        if (!row) continue; // lubricant_init refuses the law
        count_key(is_preset ? &preset : &constant, row, &source->values);
        add_name(is_preset ? presets : constants, parameter->key);
    }
    if (preset.given > 0 && constant.given > 0)
        return place_fail(error, where, "%s: found %s and constants, expected only one", group,
                          presets);
    if (preset.all > 0 && preset.given == 0 && constant.given == 0)
        return place_fail(error, where,
                          "%s: found neither %s nor constants, expected %s or %s with the law %s",
                          group, presets, presets, constants, law->name);
    return preset.given > 0 ? EHD_OK : check_whole(source, group, &constant, error);
}

static ehd_status check_lubricant(const scene_source *source, ehd_error *error) {
    ehd_status status = EHD_OK;

    for (int i = 0; i < NUM_LAW_GROUPS && !status; i++)
        status = check_preset(source, &law_groups[i], error);
    return status;
}

// ---- grid

static bool is_point(const scene *of) {
    return strcmp(of->contact, "line") != 0;
}

/* Returns the allowed grid step that divides the extent and is nearest to the given grid step. */
static double nearest_step(double extent, double step) {
    const setting *row = setting_find("grid.step");
    double count = round(extent / step);
    if (extent / count > row->max) count++;
    return extent / count;
}

static ehd_status check_extent(const scene_source *source, ehd_error *error) {
    const scene *of = &source->values;
    if (isgreaterequal(of->grid.x_min, -1))
        return place_fail(error, place_of_key(source, "grid.x_min"),
                          "grid.x_min: found %g, expected less than -1, so that the dry contact "
                          "lies inside",
                          of->grid.x_min);
    if (islessequal(of->grid.x_max, 1))
        return place_fail(error, place_of_key(source, "grid.x_max"),
                          "grid.x_max: found %g, expected more than 1, so that the dry contact "
                          "lies inside",
                          of->grid.x_max);
    if (is_point(of) && islessequal(of->grid.y_max, 1))
        return place_fail(error, place_of_key(source, "grid.y_max"),
                          "grid.y_max: found %g, expected more than 1, so that the dry contact "
                          "lies inside",
                          of->grid.y_max);
    return EHD_OK;
}

static bool is_whole(double steps) {
    return fabs(steps - round(steps)) <= ROUNDING * steps;
}

/* Returns the number of inner lines of nodes; 1 if the scene does not give it. */
static double count_lines(const scene *of) {
    if (!is_point(of) || isnan(of->grid.y_max)) return 1;
    const double beside = of->grid.y_max / of->grid.step;
    return of->grid.half ? beside + 1 : 2 * beside + 1;
}

static ehd_status check_grid(const scene_source *source, ehd_error *error) {
    const scene *of = &source->values;
    const double step = of->grid.step, extent = of->grid.x_max - of->grid.x_min,
                 steps = extent / step;
    const double nodes = (steps + 1) * count_lines(of);
    const int most = is_point(of) ? MAX_NODES : MAX_LINE_NODES;
    char found[NUMBER_TEXT], valid[NUMBER_TEXT];
    const ehd_status status = check_extent(source, error);
    // settings that are not given are later chosen so that the grid fits
    if (status || isnan(steps)) return status;
    if (!(nodes <= most))
        return place_fail(error, place_of_key(source, "grid.step"),
                          "grid.step: found %g, which makes %.0f nodes, expected at most %d", step,
                          nodes, most);
    number_show(found, step);
    if (!is_whole(steps)) {
        number_show(valid, nearest_step(extent, step));
        return place_fail(error, place_of_key(source, "grid.step"),
                          "grid.step: found %s, expected a whole number of steps from %g to %g, "
                          "such as with %s",
                          found, of->grid.x_min, of->grid.x_max, valid);
    }
    // an ellipse has its own spacing of grid lines; the last line lies at y_max or just beyond
    const bool square = is_point(of) && strcmp(of->contact, "ellipse") != 0;
    if (!square || isnan(of->grid.y_max) || is_whole(of->grid.y_max / step)) return EHD_OK;
    number_show(valid, step * ceil(of->grid.y_max / step));
    return place_fail(error, place_of_key(source, "grid.y_max"),
                      "grid.y_max: found %g, expected a whole number of steps of %s, such as %s",
                      of->grid.y_max, found, valid);
}

// ---- all

ehd_status source_validate(const scene_source *source, ehd_error *error) {
    ehd_status status = check_used(source, error);
    if (!status) status = check_needed(source, error);
    if (!status) status = check_operating_point(source, error);
    if (!status) status = check_traction(source, error);
    if (!status) status = check_ellipse(source, error);
    if (!status) status = check_cross_flux(source, error);
    if (!status) status = check_lubricant(source, error);
    if (!status) status = check_grid(source, error);
    return status;
}

ehd_status scene_validate(const scene *of, const char *where, ehd_error *error) {
    const scene_source source = {.values = *of, .file = where};
    return source_validate(&source, error);
}
