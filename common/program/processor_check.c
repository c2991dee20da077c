/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/processor.h"

#include "common/program/status.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Runs as a constructor, because main itself may use instructions that the processor lacks. glibc
 * calls it with the arguments of main. */
ON_ANY_PROCESSOR __attribute__((constructor)) void processor_check(int argc, char **argv,
                                                                   char **environment) {
    const char *refusal = processor_refusal(), *slash = argc > 0 ? strrchr(argv[0], '/') : NULL;
    (void)environment;
    if (!refusal) return;
    dprintf(STDERR_FILENO, "%s: %s\n", slash ? slash + 1 : argc > 0 ? argv[0] : "ehdrom", refusal);
    _exit(EHD_INTERNAL);
}
