/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/fmu/description.h"

#include "common/program/text.h"
#include "romrun/library/ehdrom.h"

#include <string.h>

const char fmu_identifier[] = "ehdrom_contact";

// oldest glibc that has all functions of the shared object: 2.35 because of hypot; if built with
// headers of 2.38 or newer, 2.38 because of fmod and strtoull
#if __GLIBC_PREREQ(2, 38)
#define NEEDED_GLIBC "2.38"
#else
#define NEEDED_GLIBC "2.35"
#endif

/* Writes an attribute, with a space before it. */
static void put(FILE *file, const char *name, const char *value) {
    fprintf(file, " %s=\"", name);
    text_print_xml(value, file);
    fputc('"', file);
}

static void put_number(FILE *file, const char *name, double value) {
    char text[NUMBER_TEXT];

    number_show(text, value);
    put(file, name, text);
}

static const char *unit_of(const fmu_variable *variable, const fmu_contents *contents) {
    return contents->point ? variable->unit_of_point : variable->unit;
}

// ---- units

typedef struct unit_powers {
    const char *name;
    int kg, m, s;
} unit_powers;

static const unit_powers units[] = {{"1", 0, 0, 0},      {"s", 0, 0, 1},      {"m", 0, 1, 0},
                                    {"m/s", 0, 1, -1},   {"N", 1, 1, -2},     {"N/m", 1, 0, -2},
                                    {"Pa", 1, -1, -2},   {"Pa.s", 1, -1, -1}, {"1/Pa", -1, 1, 2},
                                    {"N/m2", 1, -1, -2}, {"N.s/m", 1, 0, -1}, {"N.s/m2", 1, -1, -1},
                                    {"W", 1, 2, -3},     {"W/m", 1, 1, -3},   {"N.m", 1, 2, -2}};

static bool is_used(const unit_powers *unit, const fmu_contents *contents) {
    for (size_t i = 0; i < FMU_NUM_VARIABLES; i++) {
        const char *own = unit_of(&fmu_variables[i], contents);
        if (contents->has[i] && own && strcmp(own, unit->name) == 0) return true;
    }
    return false;
}

static void put_units(FILE *file, const fmu_contents *contents) {
    fputs("  <UnitDefinitions>\n", file);
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        const unit_powers *unit = &units[i];
        if (!is_used(unit, contents)) continue;
        fprintf(file, "    <Unit name=\"%s\"><BaseUnit", unit->name);
        if (unit->kg) fprintf(file, " kg=\"%d\"", unit->kg);
        if (unit->m) fprintf(file, " m=\"%d\"", unit->m);
        if (unit->s) fprintf(file, " s=\"%d\"", unit->s);
        fputs("/></Unit>\n", file);
    }
    fputs("  </UnitDefinitions>\n", file);
}

// ---- variables

static const char *const causalities[] = {"independent", "input", "output", "parameter"};

static const char *variability(const fmu_variable *variable) {
    if (variable->role == FMU_PARAMETER) return "fixed";
    return variable->type == FMU_REAL ? "continuous" : "discrete";
}

/* Writes the attributes of a variable that both versions of FMI have. */
static void put_common(FILE *file, size_t reference) {
    const fmu_variable *variable = &fmu_variables[reference];

    put(file, "name", variable->name);
    fprintf(file, " valueReference=\"%zu\"", reference);
    put(file, "description", variable->help);
    put(file, "causality", causalities[variable->role]);
    put(file, "variability", variability(variable));
}

static void put_value(FILE *file, size_t reference, const fmu_contents *contents) {
    const fmu_variable *variable = &fmu_variables[reference];
    const char *unit = unit_of(variable, contents);

    if (unit) put(file, "unit", unit);
    if (variable->role == FMU_INPUT || variable->role == FMU_PARAMETER)
        put_number(file, "start", contents->start[reference]);
}

static void put_variables(FILE *file, const fmu_contents *contents, int fmi) {
    static const char *const types_2[] = {"Real", "Integer", "Boolean"};
    static const char *const types_3[] = {"Float64", "Int32", "Boolean"};

    fputs("  <ModelVariables>\n", file);
    for (size_t i = 0; i < FMU_NUM_VARIABLES; i++) {
        const fmu_type type = fmu_variables[i].type;
        if (!contents->has[i]) continue;
        fprintf(file, "    <%s", fmi == 2 ? "ScalarVariable" : types_3[type]);
        put_common(file, i);
        if (fmi == 2) fprintf(file, "><%s", types_2[type]);
        put_value(file, i, contents);
        fputs(fmi == 2 ? "/></ScalarVariable>\n" : "/>\n", file);
    }
    fputs("  </ModelVariables>\n", file);
}

/* Lists all outputs. The list names no dependencies, so FMI's default applies: each output depends
 * on all inputs and on the past. */
static void put_outputs(FILE *file, const fmu_contents *contents, int fmi, const char *element) {
    size_t index = 0; // index among all variables, from 1

    for (size_t i = 0; i < FMU_NUM_VARIABLES; i++) {
        if (!contents->has[i]) continue;
        index++;
        if (fmu_variables[i].role == FMU_OUTPUT)
            fprintf(file, "    <%s %s=\"%zu\"/>\n", element, fmi == 2 ? "index" : "valueReference",
                    fmi == 2 ? index : i);
    }
}

static void put_structure(FILE *file, const fmu_contents *contents, int fmi) {
    fputs("  <ModelStructure>\n", file);
    if (fmi == 2) fputs("    <Outputs>\n", file);
    put_outputs(file, contents, fmi, fmi == 2 ? "Unknown" : "Output");
    fputs(fmi == 2 ? "    </Outputs>\n    <InitialUnknowns>\n" : "", file);
    put_outputs(file, contents, fmi, fmi == 2 ? "Unknown" : "InitialUnknown");
    if (fmi == 2) fputs("    </InitialUnknowns>\n", file);
    fputs("  </ModelStructure>\n", file);
}

// ---- the whole file

/* Writes the capabilities of the FMU, by their names in each version. */
static void put_abilities(FILE *file, int fmi) {
    fputs("  <CoSimulation", file);
    put(file, "modelIdentifier", fmu_identifier);
    put(file, "canHandleVariableCommunicationStepSize", "true");
    put(file, fmi == 2 ? "canGetAndSetFMUstate" : "canGetAndSetFMUState", "true");
    put(file, fmi == 2 ? "canSerializeFMUstate" : "canSerializeFMUState", "true");
    put(file, fmi == 2 ? "providesDirectionalDerivative" : "providesDirectionalDerivatives",
        "true");
    if (fmi == 2) put(file, "canNotUseMemoryManagementFunctions", "true");
    fputs("/>\n", file);
}

void fmu_describe(FILE *file, const fmu_description *of, int fmi) {
    const fmu_contents *contents = of->contents;

    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription", file);
    put(file, "fmiVersion", fmi == 2 ? "2.0" : "3.0");
    put(file, "modelName", of->name);
    put(file, fmi == 2 ? "guid" : "instantiationToken", contents->token);
    put(file, "description",
        contents->ellipse ? "Elastohydrodynamic elliptical contact"
        : contents->point ? "Elastohydrodynamic point contact"
                          : "Elastohydrodynamic line contact");
    put(file, "generationTool", "ehdrom " EHDROM_VERSION);
    if (of->generated) put(file, "generationDateAndTime", of->generated);
    if (fmi == 2) put(file, "numberOfEventIndicators", "0");
    fputs(">\n", file);
    put_abilities(file, fmi);
    put_units(file, contents);
    fputs(
        "  <LogCategories>\n"
        "    <Category name=\"logStatusError\" description=\"Why a call failed\"/>\n"
        "    <Category name=\"logStatusDiscard\" description=\"Why a step was discarded\"/>\n"
        "    <Category name=\"logAll\" description=\"When results are no longer to be trusted\"/>\n"
        "  </LogCategories>\n"
        "  <DefaultExperiment startTime=\"0\"",
        file);
    put_number(file, "stopTime", of->stop);
    put_number(file, "stepSize", of->step);
    fputs("/>\n", file);
    put_variables(file, contents, fmi);
    put_structure(file, contents, fmi);
    fputs("</fmiModelDescription>\n", file);
}

static void put_cell(FILE *file, const char *text) {
    fputs("<td>", file);
    text_print_xml(text, file);
    fputs("</td>", file);
}

void fmu_document(FILE *file, const fmu_description *of) {
    const fmu_contents *contents = of->contents;

    fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>", file);
    text_print_xml(of->name, file);
    fputs("</title></head><body>\n<h1>", file);
    text_print_xml(of->name, file);
    fprintf(file,
            "</h1>\n<p>A reduced elastohydrodynamic %s contact, exported by ehdrom " EHDROM_VERSION
            ", for co-simulation. A communication step is one step of BDF2 to the inputs that were "
            "set before it, which hold at its end; where that is too long it is halved inside. "
            "<b>trusted</b> says whether the result is to be relied on; the calls' status does "
            "not. Linux, x86-64, glibc " NEEDED_GLIBC
            " or newer. Licences: folder licenses.</p>\n<table>\n"
            "<tr><th>Variable</th><th>Unit</th><th>Kind</th><th>Start</th><th>Meaning</th></tr>\n",
            contents->ellipse ? "elliptical" : fmu_contact(contents));
    for (size_t i = 0; i < FMU_NUM_VARIABLES; i++) {
        const fmu_variable *variable = &fmu_variables[i];
        const char *unit = unit_of(variable, contents);
        char start[NUMBER_TEXT] = "";
        if (!contents->has[i]) continue;
        if (variable->role == FMU_INPUT || variable->role == FMU_PARAMETER)
            number_show(start, contents->start[i]);
        fputs("<tr>", file);
        put_cell(file, variable->name);
        put_cell(file, unit ? unit : "");
        put_cell(file, causalities[variable->role]);
        put_cell(file, start);
        put_cell(file, variable->help);
        fputs("</tr>\n", file);
    }
    fputs("</table>\n</body></html>\n", file);
}
