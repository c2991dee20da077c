/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Restricts what is read from files of unknown origin: only datasets that lie in the file itself,
 * with filters that are part of HDF5. Otherwise a link or a layout could make the program read any
 * other file that its user may read. */
#include "common/artefact/internal.h"

#include <string.h>

/* Returns the kind of a link as text. Returns NULL for a hard link, which leads to an object of
 * this file. */
static const char *other_link(H5L_type_t type) {
    if (type == H5L_TYPE_SOFT) return "a soft link";
    if (type == H5L_TYPE_EXTERNAL) return "an external link";
    return type == H5L_TYPE_HARD ? NULL : "a link of another kind";
}

/* Returns, as text, the kind of the first link that is not hard in a path such as "group/dataset".
 * Returns NULL if all links are hard. Checks each link before it follows the link. *address is the
 * address of the object at the end of the path. */
static const char *other_step(haddr_t *address, hid_t root, const char *path) {
    char step[512];
    const char *found = NULL;
    const size_t length = strlen(path);

    *address = HADDR_UNDEF;
    if (length >= sizeof step) return "a long name";
    for (size_t end = 1; end <= length && !found; end++) {
        H5L_info_t link;
        if (path[end] != '/' && path[end] != '\0') continue;
        memcpy(step, path, end);
        step[end] = '\0';
        if (strspn(step, "/.") == end) continue; // "/" and "." stay in the same group
        found = H5Lget_info(root, step, &link, H5P_DEFAULT) < 0 ? "nothing" : other_link(link.type);
        if (!found) *address = link.u.address;
    }
    return found;
}

/* Checks whether a dataset has a filter other than gzip, shuffle and Fletcher-32. HDF5 would load
 * other filters as plugins. */
static bool has_other_filter(hid_t properties) {
    const int count = H5Pget_nfilters(properties);

    for (int i = 0; i < count; i++) {
        unsigned flags = 0;
        size_t num_values = 0;
        const H5Z_filter_t filter =
            H5Pget_filter2(properties, (unsigned)i, &flags, &num_values, NULL, 0, NULL, NULL);
        if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE &&
            filter != H5Z_FILTER_FLETCHER32)
            return true;
    }
    return count < 0;
}

/* Returns the layout or filter, as text, because of which a dataset must not be read. NULL: it may
 * be read. *chunk becomes the number of values in a chunk, or 1 without chunks. */
static const char *other_layout(double *chunk, hid_t dataset) {
    const hid_t properties = H5Dget_create_plist(dataset);
    const H5D_layout_t layout = H5Pget_layout(properties);
    const char *found = NULL;
    hsize_t sizes[H5S_MAX_RANK];

    *chunk = 1;
    if (layout == H5D_VIRTUAL)
        found = "a virtual dataset";
    else if (layout != H5D_COMPACT && layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED)
        found = "another layout";
    else if (layout == H5D_CONTIGUOUS && H5Pget_external_count(properties) != 0)
        found = "data in another file";
    else if (has_other_filter(properties))
        found = "a filter beside gzip, shuffle and Fletcher-32";
    else if (layout == H5D_CHUNKED)
        for (int i = H5Pget_chunk(properties, H5S_MAX_RANK, sizes); i > 0; i--)
            *chunk *= (double)sizes[i - 1];
    hdf5_release(properties);
    return found;
}

hid_t hdf5_open_own(own_dataset *about, hid_t root, const char *name) {
    H5O_info_t info;

    about->foreign = other_step(&about->address, root, name);
    if (about->foreign) return -1;
    const hid_t dataset = H5Dopen2(root, name, H5P_DEFAULT);
    if (dataset >= 0) {
        about->foreign = other_layout(&about->chunk, dataset);
        if (!about->foreign) return dataset;
        hdf5_release(dataset);
    } else if (H5Oget_info_by_name2(root, name, &info, H5O_INFO_BASIC, H5P_DEFAULT) >= 0 &&
               info.type != H5O_TYPE_DATASET) {
        about->foreign = "no dataset";
    }
    return -1;
}

ehd_status hdf5_refuse(const char *path, const char *name, const char *found, ehd_error *error) {
    return ehd_fail(error, EHD_DATA, "%s: %s: found %s, expected a dataset of the file itself",
                    path, name, found);
}
