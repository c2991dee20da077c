/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs files of a corpus without libFuzzer, each in its own process:
 *
 *     replay TARGET FILE...
 *
 * A file "refused-..." has to be refused, a file "accepted-..." has to be read; any other file may
 * be refused or read, but must do no harm. Prints the files that fail. The exit code is 1 if a file
 * failed. */
#include "tests/fuzz/target.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MAX_BYTES = 1 << 20, MAX_SECONDS = 60 };

static int expected_of(const char *path, int code) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    if (strncmp(name, "refused-", 8) == 0) return EHD_DATA;
    if (strncmp(name, "accepted-", 9) == 0) return EHD_OK;
    return code;
}

/* Runs a file in the child process. */
static _Noreturn void run_file(const fuzz_target *target, const char *path) {
    static uint8_t bytes[MAX_BYTES];
    FILE *file = fopen(path, "rb");
    if (!file) {
        perror(path);
        exit(1);
    }
    const size_t length = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    alarm(MAX_SECONDS);
    fuzz_start(dup(STDERR_FILENO));
    exit(fuzz_run(target, bytes, length));
}

int main(int argc, char **argv) {
    const fuzz_target *target = fuzz_find(argc > 1 ? argv[1] : "");
    int num_failed = 0;
    if (!target) {
        fprintf(stderr, "replay: found no target %s, expected one\n", argc > 1 ? argv[1] : "");
        return EHD_USAGE;
    }
    for (int i = 2; i < argc; i++) {
        int outcome;
        const pid_t child = fork();
        if (child < 0) return EHD_INTERNAL;
        if (child == 0) run_file(target, argv[i]);
        if (waitpid(child, &outcome, 0) != child) return EHD_INTERNAL;
        const int code = WIFEXITED(outcome) ? WEXITSTATUS(outcome) : 128 + WTERMSIG(outcome);
        if (WIFEXITED(outcome) && code == expected_of(argv[i], code)) continue;
        printf("%s: found %s %d, expected %d\n", argv[i],
               WIFEXITED(outcome) ? "exit code" : "signal", WIFEXITED(outcome) ? code : code - 128,
               expected_of(argv[i], EHD_OK));
        num_failed++;
    }
    return num_failed > 0;
}
