/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/folder.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

char folder[] = "/tmp/ehdrom-XXXXXX";

int make_folder(void **state) {
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/ehdrom-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

int remove_folder(void **state) {
    char command[64];
    (void)state;
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

int enter_folder(void **state) {
    return make_folder(state) == 0 && chdir(folder) == 0 ? 0 : -1;
}

int leave_folder(void **state) {
    return chdir("/") == 0 ? remove_folder(state) : -1;
}
