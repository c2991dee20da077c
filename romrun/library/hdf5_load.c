/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the table of hdf5_calls.h for libehdrom.so.0. */
#include "romrun/library/ehdrom.h"
#include "romrun/library/hdf5_calls.h"

#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Chooses the plug-in beside this library, or else the plug-in that the system finds by name. A
 * RUNPATH does not suffice, since the dlopen of a sanitizer ignores it. */
static void choose_plugin(char *name, size_t size) {
    static const char here;
    Dl_info own;

    if (dladdr(&here, &own) && strchr(own.dli_fname, '/')) {
        const int folder = (int)(strrchr(own.dli_fname, '/') - own.dli_fname);
        const int length = snprintf(name, size, "%.*s/" HDF5_PLUGIN, folder, own.dli_fname);
        if (length > 0 && (size_t)length < size && access(name, F_OK) == 0) return;
    }
    snprintf(name, size, HDF5_PLUGIN);
}

ehd_status hdf5_load(const hdf5_calls **calls, const char *path, ehd_error *error) {
    char name[PATH_MAX];
    ehd_status status = EHD_OK;

    *calls = NULL;
    choose_plugin(name, sizeof name);
    void *plugin = dlopen(name, RTLD_NOW | RTLD_LOCAL); // stays loaded, as HDF5 does
    const hdf5_calls *found = plugin ? dlsym(plugin, HDF5_TABLE) : NULL;
    if (!found)
        status = ehd_fail(error, EHD_DATA,
                          "%s: found no flat model and no " HDF5_PLUGIN
                          " (%s), expected that beside the library for a model of HDF5, or a flat "
                          "model of romrun export",
                          path, dlerror());
    else if (strcmp(found->version, EHDROM_VERSION) != 0 || found->size != sizeof *found)
        status =
            ehd_fail(error, EHD_DATA,
                     "%s: found %s of version %s, expected that of the library, " EHDROM_VERSION
                     ", for a model of HDF5",
                     path, name, found->version);
    else
        *calls = found;
    if (status && plugin) dlclose(plugin);
    return status;
}
