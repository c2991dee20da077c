/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libFuzzer target: whatever the bytes, the scene reader answers, and a scene that it accepts
 * survives the way through its own text.
 *
 *     clang -g -O1 -fsanitize=fuzzer,address,undefined -std=c17 -D_GNU_SOURCE -I. \
 *         tests/fuzz/fuzz_scene.c common/settings/[!pv]*.c common/settings/place.c \
 *         common/program/text.c common/program/status.c -lyaml -lm -o build/fuzz_scene
 *     build/fuzz_scene -max_len=4096 -max_total_time=60 */
#include "common/settings/scene.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_error(const ehd_error *error) {
    if (!*error->text || strchr(error->text, '\n')) abort();
}

static void check_round_trip(const scene *accepted) {
    scene again;
    ehd_error error;
    char *text = scene_text(accepted);
    if (!text || scene_parse(&again, text, strlen(text), "text", NULL, 0, &error)) abort();
    char *second = scene_text(&again);
    if (!second || strcmp(text, second) != 0) abort();
    free(text);
    free(second);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    scene read;
    ehd_error error = {""};
    if (scene_parse(&read, (const char *)data, size, "fuzz", NULL, 0, &error))
        check_error(&error);
    else
        check_round_trip(&read);
    return 0;
}
