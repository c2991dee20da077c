/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Streams, resumes and finishes files. */
#include "common/artefact/internal.h"
#include "common/settings/scene.h"

#include <stdlib.h>
#include <string.h>

// ---- streaming

/* Reports a missing item. Returns EHD_DATA for a resumed file, because another process wrote it,
 * and EHD_INTERNAL otherwise. */
static ehd_status not_written(const artefact *file, const char *name, ehd_error *error) {
    return ehd_fail(error, file->history_line ? EHD_DATA : EHD_INTERNAL,
                    "%s: found no %s, expected it in every %s", shown_name(file), name,
                    file->schema->name);
}

/* Checks that a file has all fields or attributes of a list that it must have. `own`: also NEED_OWN
 * items. */
static ehd_status check_written(const artefact *file, const artefact_field *list, bool own,
                                ehd_error *error) {
    for (; list->name; list++) {
        const bool needed = list->need == NEED_ALWAYS || (list->need == NEED_OWN && own);
        if (needed && !field_exists(file, list)) return not_written(file, list->name, error);
    }
    return EHD_OK;
}

ehd_status artefact_flush(artefact *file, ehd_error *error) {
    hdf5_start();
    if (H5Fflush(file->id, H5F_SCOPE_GLOBAL) < 0) return hdf5_write_failed(file, "file", error);
    return EHD_OK;
}

ehd_status artefact_sync(artefact *file, ehd_error *error) {
    const ehd_status status = artefact_flush(file, error);
    return status == EHD_OK ? sync_file(file, error) : status;
}

/* Closes the file and opens it again for streaming. H5Fstart_swmr_write would start streaming in
 * the open file, but then HDF5 reads damaged metadata a hundred times, with waits that never end
 * (READ_ATTEMPTS). All data are on disk before the file is closed. */
static ehd_status reopen_streaming(artefact *file, ehd_error *error) {
    const ehd_status status = artefact_sync(file, error);
    if (status != EHD_OK) return status;
    const herr_t outcome = H5Fclose(file->id);
    file->id = -1;
    if (outcome >= 0)
        file->id = hdf5_open(written_name(file), H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE, false);
    return file->id < 0 ? hdf5_write_failed(file, "file", error) : EHD_OK;
}

ehd_status artefact_begin_streaming(artefact *file, ehd_error *error) {
    if (file->streaming) return EHD_OK;
    ehd_status status = check_written(file, file->schema->fields, !file->copied, error);
    if (status == EHD_OK) status = check_written(file, file->schema->attributes, false, error);
    if (status != EHD_OK) return hdf5_blame(status, file->path, error);
    status = reopen_streaming(file, error);
    if (status == EHD_OK) status = sync_file(file, error);
    if (status == EHD_OK && file->on_copy) status = keep_copy(file, error);
    if (status != EHD_OK) return status;
    file->streaming = true;
    file->keep = true;
    artefact_save(file);
    return EHD_OK;
}

ehd_status artefact_end_streaming(artefact *file, ehd_error *error) {
    if (!file->streaming) return EHD_OK;
    herr_t outcome = H5Fclose(file->id); // also closes the datasets that were kept open
    file->id = -1;
    file->streaming = false;
    if (outcome < 0) return hdf5_write_failed(file, "file", error);
    ehd_status status = use_copy(file, error);
    if (status != EHD_OK) return status;
    file->id = hdf5_open(file->copy, H5F_ACC_RDWR, false);
    if (file->id < 0) return hdf5_write_failed(file, "file", error);
    return EHD_OK;
}

// ---- resume

static ehd_status not_resumable(const artefact *file, const char *found, ehd_error *error) {
    return ehd_fail(error, EHD_DATA,
                    "%s: found %s, expected what an interrupted run of the same settings left "
                    "(or --force, without --resume)",
                    file->partial, found);
}

static ehd_status check_same_settings(const artefact *file, const char *settings_text,
                                      ehd_error *error) {
    char *found = hdf5_get_text(file->id, "settings");
    char *expected = utf8_copy(settings_text ? settings_text : "");
    const bool memory = expected != NULL;
    const bool same = found && expected && scene_text_matches(found, expected);
    free(expected);
    free(found);
    if (!memory) return ehd_no_memory(error, file->partial);
    return same ? EHD_OK : not_resumable(file, "other settings", error);
}

static ehd_status resume_streaming(artefact *file, const program *caller, const char *settings_text,
                                   ehd_error *error) {
    const artefact_schema *const schemas[] = {file->schema, NULL};
    if (!has_begun(file))
        return ehd_fail(error, EHD_NOINPUT,
                        "%s: found nothing to continue, expected what an "
                        "interrupted run left",
                        file->partial);
    file->history_line = history_line(caller);
    if (!file->history_line) return ehd_no_memory(error, file->path);
    ehd_status status = use_copy(file, error);
    if (status != EHD_OK) return status;
    file->id = hdf5_open(file->copy, H5F_ACC_RDWR, true);
    if (file->id < 0) return not_resumable(file, "no whole HDF5 file", error);
    file->growing = find_growing(file);
    status = examine(file, schemas, error);
    if (status == EHD_OK) status = check_same_settings(file, settings_text, error);
    if (status == EHD_OK && !file->growing) status = read_everything(file, true, error);
    if (status != EHD_OK) return status;

    // `complete` is 1 after a run whose last rename failed
    if (completeness(file) != 0 && !put_complete(file->id, 0))
        return hdf5_write_failed(file, "complete", error);
    return file->growing ? EHD_OK : artefact_begin_streaming(file, error);
}

ehd_status artefact_resume(artefact **result, const char *path, const artefact_schema *schema,
                           const program *caller, const char *settings_text, ehd_error *error) {
    *result = NULL;
    artefact *file = NULL;
    ehd_status status = writer_new(&file, path, schema, caller, 0, error);
    if (status != EHD_OK) return status;
    file->keep = true;
    status = hdf5_blame(resume_streaming(file, caller, settings_text, error), path, error);
    if (status != EHD_OK) artefact_close(&file);
    *result = file;
    return status;
}

ehd_status artefact_check_input(artefact *file, const char *what, const char *path,
                                ehd_error *error) {
    char identity[65];
    char found[512];
    hdf5_start();
    ehd_status status = artefact_file_identity(identity, path, error);
    if (status != EHD_OK || had_input(file->id, path, identity)) return status;
    snprintf(found, sizeof found, "a run with another %s than %s is now", what, path);
    return hdf5_blame(not_resumable(file, found, error), file->partial, error);
}

static ehd_status cut_dataset(artefact *file, const char *name, size_t length, ehd_error *error) {
    hid_t dataset = open_dataset(file, name);
    if (dataset < 0) return hdf5_read_failed(file, name, error);

    ehd_status status = EHD_OK;
    size_t found = dataset_length(dataset);
    if (!is_extendible(dataset)) {
        status = ehd_fail(error, EHD_DATA, "%s: %s: found a fixed length, expected one that grows",
                          file->partial, name);
    } else if (found < length) {
        status = ehd_fail(error, EHD_DATA, "%s: %s: found %zu entries, expected at least %zu",
                          file->partial, name, found, length);
    } else if (found > length && !set_dataset_length(dataset, length)) {
        status = hdf5_write_failed(file, name, error);
    }
    hdf5_release(dataset);
    return status;
}

ehd_status artefact_cut_axis(artefact *file, const char *name, size_t length, ehd_error *error) {
    if (file->history_line && !file->growing)
        return not_resumable(file, "axes of which none grows", error);
    if (file->history_line && strcmp(name, file->growing) != 0)
        return not_resumable(file, "another axis that grows", error);
    if (file->streaming || !file->growing || strcmp(name, file->growing) != 0)
        return ehd_fail(error, EHD_INTERNAL,
                        "%s: found axis %s, expected the one that grows, before streaming",
                        file->path, name);
    ehd_status status = EHD_OK;
    for (const file_dataset *of = file->datasets; of->field.name && status == EHD_OK; of++)
        if (field_grows(file, &of->field) && field_exists(file, &of->field))
            status = cut_dataset(file, of->field.name, length, error);
    find_dataset(file, name)->length = length;
    if (status == EHD_OK) status = read_everything(file, true, error);
    return status == EHD_OK ? artefact_begin_streaming(file, error) : status;
}

// ---- finish

static ehd_status add_resumed_history(artefact *file, ehd_error *error) {
    if (!file->history_line) return EHD_OK;
    char *before = hdf5_get_text(file->id, "history");
    bool written = put_history(file->id, before ? before : "", file->history_line);
    ehd_status status = written ? EHD_OK : hdf5_write_failed(file, "history", error);
    free(before);
    return status == EHD_OK ? artefact_flush(file, error) : status;
}

static ehd_status write_last(artefact *file, ehd_error *error) {
    if (file->failed)
        return ehd_fail(error, EHD_IO, "%s: found an earlier write failure, expected a whole file",
                        file->partial);
    if (file->growing && artefact_length(file, file->growing) == 0)
        return ehd_fail(error, EHD_INTERNAL, "%s: %s: found no entry, expected at least one",
                        file->partial, file->growing);
    const bool own = !file->copied; // the copy of another program's file may lack NEED_OWN items
    ehd_status status = artefact_end_streaming(file, error);
    if (status == EHD_OK) status = check_written(file, file->schema->fields, own, error);
    if (status == EHD_OK) status = check_written(file, file->schema->attributes, own, error);
    if (status == EHD_OK) status = add_resumed_history(file, error);
    if (status == EHD_OK) status = put_digests(file, error);
    if (status == EHD_OK) status = artefact_flush(file, error);
    if (status != EHD_OK) return status;

    if (!put_complete(file->id, 1)) return hdf5_write_failed(file, "complete", error);
    status = artefact_flush(file, error);
    if (status != EHD_OK) return status;
    herr_t outcome = H5Fclose(file->id);
    file->id = -1;
    return outcome < 0 ? hdf5_write_failed(file, "file", error) : EHD_OK;
}

ehd_status artefact_finish(artefact **file, ehd_error *error) {
    if (program_interrupted()) {
        ehd_fail(error, EHD_INTERRUPTED, "%s: interrupted, not written", (*file)->path);
        artefact_close(file);
        return EHD_INTERRUPTED;
    }
    ehd_status status = hdf5_blame(write_last(*file, error), (*file)->path, error);
    if (status != EHD_OK) {
        artefact_close(file); // removes a partial file that cannot be resumed
        return status;
    }
    status = give_final_name(*file, error);
    artefact_delete(*file);
    *file = NULL;
    return status;
}
