/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the tables of a schema as the pages in schemas/ show them. test_schemas.c compares the
 * pages with these tables, or writes them. */
#ifndef EHD_SCHEMA_PAGE_H
#define EHD_SCHEMA_PAGE_H

#include "common/artefact/artefact.h"
#include <stdio.h>

void schema_page_print(const artefact_schema *schema, FILE *stream);

#endif
